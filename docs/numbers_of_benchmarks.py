"""Tables of numbers for the manual, each from the CSV file of a benchmark."""

import math
import statistics
from collections import defaultdict
from collections.abc import Callable, Mapping

from tables import format_columns, format_table, number, read_rows

PER_CENT = number(".3f", 100.0)


def solvers() -> str:
    """Return applications and seconds of each method for each mesh."""
    rows = {(row["n"], row["method"]): row for row in read_rows("solvers.csv")}
    meshes = list(dict.fromkeys(n for n, _ in rows))
    methods = ("newton", "anderson", "uzawa")

    def cell(n: str, method: str) -> str:
        row = rows.get((n, method))
        if row is None:
            return "-"
        return f"{float(row['applications']):,.0f}, {float(row['seconds']):.2g} s"

    head = ("elements", *methods)
    return format_table(
        head, ((f"{n} x {n}", *(cell(n, method) for method in methods)) for n in meshes)
    )


def layered_spheres() -> str:
    """Return errors of the contact of a sphere on a coating, for each mesh."""
    columns = {
        "$E_1/E_2$": ("E1/E2", str),
        "thickness / $a_H$": ("h/a_H", number(".4g")),
        "elements": ("elements", str),
        "error of the pressure at the vertex": ("pressure", number(".1e")),
        "error of the approach": ("approach", number(".1e")),
    }
    return format_columns(read_rows("layers.csv"), columns)


def layered_cylinders() -> str:
    """Return errors of coated cylinders that roll or are pushed, for each mesh."""
    columns = {
        "$E_1/E_2$": ("E1/E2", str),
        "elements": ("elements", str),
        "half width": ("half width", number(".1e")),
        "pressure": ("pressure", number(".1e")),
        "force in rolling": ("Carter force", number(".1e")),
        "stick area under a force": ("Cattaneo stick", number(".1e")),
    }
    return format_columns(read_rows("layers_line.csv"), columns)


def relaxing_cylinders() -> str:
    """Return errors of cylinders that relax, for each mesh."""
    columns = {
        "$f$": ("f", str),
        r"$V\tau/a$": ("V tau/a", str),
        "elements": ("elements", str),
        "half width": ("half width", number(".1e")),
        "peak pressure": ("pressure", number(".1e")),
        "moment": ("moment", number(".1e")),
    }
    return format_columns(read_rows("relaxation_line.csv"), columns)


def relaxing_spheres() -> str:
    """Return errors of spheres that relax, for each mesh."""
    columns = {
        "$f$": ("f", str),
        r"$V\tau/a$": ("V tau/a", str),
        "elements": ("elements", str),
        "peak pressure": ("pressure", number(".1e")),
        "approach": ("approach", number(".1e")),
        "moment": ("moment", number(".1e")),
    }
    return format_columns(read_rows("relaxation_sphere.csv"), columns)


def relaxing_polyamide() -> str:
    """Return peak pressures and creepages of cylinders of polyamide, and those of CONTACT."""
    columns = {
        r"$\tau$, s": ("tau, s", str),
        "peak pressure, MPa": ("p_max", number(".2f")),
        "CONTACT": ("p_max, CONTACT", number(".2f")),
        "creepage, %": ("creepage", number(".4f")),
        "CONTACT, %": ("creepage, CONTACT", number(".4g")),
    }
    return format_columns(read_rows("relaxation_contact.csv"), columns)


def relaxing_cost() -> str:
    """Return the time of bodies that relax over that of elastic ones."""
    columns = {
        "scene": ("scene", str),
        r"terms ($f$, $V\tau/a$)": ("terms", str),
        "time / time of elastic bodies": ("ratio", number(".2f")),
        "first solution on a mesh": ("first ratio", number(".2f")),
    }
    return format_columns(read_rows("relaxation_cost.csv"), columns)


def anisotropic_cost() -> str:
    """Return the median and the largest cost of anisotropic bodies over that of isotropic ones."""
    rows, lines = read_rows("anisotropy_cost.csv"), []
    for other in ("the same", "steel"):
        cells = [other]
        for name in ("time over isotropic", "applications over isotropic"):
            values = [float(row[name]) for row in rows if row["other"] == other]
            cells += [f"{statistics.median(values):.2f}", f"{max(values):.2f}"]
        lines.append(cells)
    head = ("other body", "time, median", "largest", "applications, median", "largest")
    return format_table(head, lines)


def solvers_steady() -> str:
    """Return the work and the time of complete steady solutions."""
    columns = {
        "elements": ("elements", str),
        "applications": ("applications", number(".3g")),
        "preconditioner": ("preconditioner", number(".3g")),
        "convolutions": ("convolutions", number(".3g")),
        "CPU time / CPU time of an application": ("over_application", number(".3g")),
    }
    return format_columns(read_rows("solvers_steady.csv"), columns)


def solvers_growth() -> str:
    """Return the work of steady solutions of several scenes for each mesh."""
    columns = {"scene": ("scene", str), "elements": ("elements", str)}
    columns |= {
        name: (name, number(".3g")) for name in ("applications", "preconditioner", "convolutions")
    }
    columns["CPU time / CPU time of an application"] = ("over_application", number(".3g"))
    return format_columns(read_rows("solvers_growth.csv"), columns)


def preconditioners() -> str:
    """Return the iterations for one Newton step by preconditioner."""
    columns = {name: (name, str) for name in ("elements", "preconditioner", "unknowns")}
    columns["condition number"] = ("condition number", number(".3g"))
    columns |= {
        f"iterations to {goal}": (f"to {goal}", str) for goal in ("1e-02", "1e-04", "1e-08")
    }
    return format_columns(read_rows("preconditioners.csv"), columns)


def large_threads() -> str:
    """Return wall times on large meshes for several numbers of threads."""
    columns = {
        "elements": ("n", lambda n: f"{n} x {n}"),
        "threads": ("threads", str),
        "application, ms": ("application s", number(".3g", 1e3)),
        "solution, s": ("solution s", number(".3g")),
    }
    return format_columns(read_rows("large_threads.csv"), columns)


def large() -> str:
    """Return time and memory of large meshes."""
    columns = {
        "elements": ("n", lambda n: f"{n} x {n}"),
        "applications": ("applications", number(".0f")),
        "first solution, s": ("first s", number(".2g")),
        "second solution, s": ("again s", number(".2g")),
        "memory, GiB": ("GiB", number(".2f")),
    }
    return format_columns(read_rows("large.csv"), columns)


def wheel_rail() -> str:
    """Return computed and printed results of positions of a wheelset."""
    columns = {"y, mm": ("y", number(".1f")), "contact angle, degrees": ("angle", number(".1f"))}
    columns |= {"patches": ("patches", number(".0f")), "planes": ("planes", str)}
    columns |= _computed_and_printed()
    columns |= {"p_max, MPa, elements of 0.1 mm": ("p_max fine", number(".1f"))}
    return format_columns(read_rows("wheel_rail.csv"), columns)


def _computed_and_printed() -> Mapping[str, tuple[str, Callable[[str], str]]]:
    """Return the columns of forces, by this program and by CONTACT."""
    forms = {
        "P, N": ".0f",
        "p_max, MPa": ".1f",
        "approach, mm": ".5f",
        "Qx, N": ".1f",
        "Qy, N": ".0f",
    }
    columns = {}
    for heading, form in forms.items():
        name = heading.partition(",")[0]
        columns |= {
            heading: (name, number(form)),
            f"{heading}, CONTACT": (f"{name} printed", number(form)),
        }
    return columns


def wheel_rail_patches() -> str:
    """Return computed and printed results of two patches of one wheel."""
    columns = {"contact angle, degrees": ("angle", number(".1f")), "mu": ("mu", number(".4f"))}
    return format_columns(
        read_rows("wheel_rail_patches.csv"), {**columns, **_computed_and_printed()}
    )


def wheel_rail_crossing() -> str:
    """Return computed and printed results of a wheel on the nose and wing rail of a crossing."""
    columns = {"contact angle, degrees": ("angle", number(".1f"))}
    columns |= {"element, mm": ("element", number(".2f")), "sampling": ("sampling", str)}
    columns |= _computed_and_printed()
    return format_columns(read_rows("wheel_rail_crossing.csv"), columns)


def wheel_rail_parts() -> str:
    """Return computed and printed results on a rail beside which another one begins."""
    columns = {"x, mm": ("x", number(".1f"))} | _computed_and_printed()
    rows = read_rows("wheel_rail_parts.csv")
    return format_columns(rows, {k: v for k, v in columns.items() if v[0] in rows[0]})


def wheel_rail_spin() -> str:
    """Return forces of the central position of a wheelset for different points of the spin."""
    columns = {
        "plane": ("plane", str),
        "element, mm": ("element", number(".1f")),
        "scheme": ("scheme", str),
        "spin taken ahead of the centre, mm": ("ahead", number(".3f")),
        "Qy, N": ("Qy", number(".1f")),
        "Mz, N mm": ("Mz", number(".0f")),
    }
    return format_columns(read_rows("wheel_rail_spin.csv"), columns)


def wheel_rail_pitch() -> str:
    """Return the convolutions of a prescribed and of a free pitch."""
    columns = {
        "y, mm": ("y", number(".1f")),
        "yaw, mrad": ("yaw", number(".0f")),
        "wheels": ("wheels", str),
        "prescribed": ("prescribed", number(".0f")),
        "free": ("free", number(".0f")),
        "ratio": ("free / prescribed", number(".2f")),
    }
    return format_columns(read_rows("wheel_rail_pitch.csv"), columns)


def normal() -> str:
    """Return time and error of the normal problem."""
    columns = {
        "elements": ("n", lambda n: f"{n} x {n}"),
        "applications": ("applications", number(".0f")),
        "seconds": ("seconds", number(".2g")),
        "seconds / seconds of the FFTs": ("over its FFTs", number(".2f")),
        "relative error of the peak contact pressure": ("p_max/p0 - 1", number(".1e")),
        "Tamaas, seconds": ("Tamaas seconds", number(".2g")),
        "seconds of Tamaas / seconds of tractive_sam": ("Tamaas/this", number(".0f")),
    }
    return format_columns(read_rows("normal.csv"), columns)


def spheres() -> str:
    """Return the convergence of the scene `spheres` with the mesh."""
    wanted = {"41", "61", "91", "121", "181", "241", "321"}
    columns = {
        "elements": ("n", lambda n: f"{n} x {n}"),
        "relative error of the peak contact pressure": ("p_max/p0 - 1", number(".1e")),
        "relative error of the approach": ("approach error", number(".1e")),
        "mean error of the pressure, divided by $p_0$": ("mean |p - Hertz|/p0", number(".1e")),
        r"$Q_x/(\mu P)$": ("Qx/muP", number(".5f")),
        r"$Q_x/(\mu P)$, CONTACT": ("CONTACT", number(".4f")),
    }
    return format_columns(read_rows("spheres_convergence.csv", lambda r: r["n"] in wanted), columns)


def creep_forces() -> str:
    """Return the creep-force curve."""
    columns = {
        "scaled creepage": ("xi~", number("g")),
        "tractive_sam, 91 x 91": ("n = 91", number(".4f")),
        "tractive_sam, extrapolated": ("extrapolated", number(".4f")),
        "CONTACT, 91 x 91": ("CONTACT n = 91", number(".4f")),
        "CONTACT, extrapolated": ("CONTACT extrapolated", number(".4f")),
        "Vermeulen and Johnson": ("Vermeulen-Johnson", number(".4f")),
        "Kalker (1967), simplified theory": ("Kalker (42)", number(".4f")),
    }
    return format_columns(read_rows("creep_force_curve.csv"), columns)


def published_sets() -> str:
    """Return each published set with its number of values and their agreement."""
    by_set: dict[tuple[str, str], list[Mapping[str, str]]] = defaultdict(list)
    for row in read_rows("published_sets.csv"):
        by_set[row["set"], row["source"]].append(row)

    def cells(title: str, source: str, rows: list[Mapping[str, str]]) -> tuple[str, ...]:
        sizes = [abs(float(row["published"])) for row in rows]
        largest = max(
            (abs(float(row["difference"])) / size for row, size in zip(rows, sizes, strict=True)
             if size > 1e-6),
            default=0.0,
        )  # fmt: skip
        agree = sum(row["verdict"] == "agrees" for row in rows)
        return title, source, f"{agree} of {len(rows)}", f"{largest:.2%}", rows[0]["CPU s"]

    head = ("set", "source", "values that agree", "largest difference", "CPU s")
    return format_table(head, (cells(*key, rows) for key, rows in by_set.items()))


def orthotropic() -> str:
    """Return forces for each friction angle."""
    columns = {
        r"$\beta$, degrees": ("beta", number("g")),
        "$Q_x/P$": ("Qx/P", number(".4f")),
        "$Q_y/P$": ("Qy/P", number("z.4f")),
        "stick fraction": ("stick", number(".2f")),
        "$Q_x/P$ in full slip": ("full slip Qx/P", number(".4f")),
        "closed form of $Q_x/P$": ("closed form x", number(".4f")),
        "$Q_y/P$ in full slip": ("full slip Qy/P", number("z.4f")),
        "closed form of $Q_y/P$": ("closed form y", number(".4f")),
    }
    return format_columns(read_rows("orthotropic_angles.csv"), columns)


def twin_discs() -> str:
    """Return the states of the worn discs."""
    columns = {
        r"$\beta$, degrees": ("beta", number("g")),
        "revolution": ("revolution", number(",.0f")),
        "half-width in x, mm": ("a", number(".3f")),
        "half-width in y, mm": ("b", number(".3f")),
        "wear depth, mm": ("wear_max", number(".4g")),
        "peak contact pressure, MPa": ("p_max", number(".0f")),
        "$Q_x/P$": ("Qx/P", number(".4f")),
        "$Q_y/P$": ("Qy/P", number("z.4f")),
        "stick fraction": ("stick", number(".2f")),
    }
    return format_columns(read_rows("twin_discs.csv"), columns)


def twin_discs_mesh() -> str:
    """Return the convergence of the worn discs with the mesh."""
    columns = {
        "mesh": ("mesh", str),
        "contact solutions": ("solves", str),
        "wear depth, mm": ("wear_max", number(".5f")),
        "$Q_x/P$": ("Qx/P", number(".4f")),
        "half-width in y, mm": ("b", number(".3f")),
        "pressure at y = 0, MPa": ("pressure at y = 0", number(".1f")),
        "peak contact pressure, MPa": ("p_max", number(".0f")),
    }
    return format_columns(read_rows("twin_discs_mesh.csv"), columns)


def giwm() -> str:
    """Return wear and the global incremental wear model (GIWM)."""
    columns = {
        "revolution": ("revolution", number(",.0f")),
        "wear depth, mm": ("depth", number(".3g")),
        "wear depth of GIWM, mm": ("GIWM depth", number(".3g")),
        "ratio of the depths": ("depth/GIWM", number(".3f")),
        "half-width in y, mm": ("b", number(".3f")),
        "half-width in y of GIWM, mm": ("GIWM b", number(".3f")),
    }
    return format_columns(read_rows("twin_discs_giwm.csv"), columns)


def wear() -> str:
    """Return cost and error of 15,000 revolutions for each tolerance."""
    columns = {
        "tolerance": ("tolerance", str),
        "contact solutions": ("solves", str),
        "seconds": ("seconds", number(".1f")),
        "time of the scheme of the paper / time of tractive_sam": ("paper/this", number(",.0f")),
        "error of the profile, % of its depth": ("profile error at 15000", PER_CENT),
        "error of $Q_x/P$, %": ("Qx_over_P error at 15000", number("+.4f", 100.0)),
    }
    return format_columns(read_rows("wear.csv"), columns)


def stepping() -> str:
    """Return cost and error of the stepping schemes."""
    columns = {
        "stepping": ("stepping", str),
        "tolerance": ("tolerance", number("g")),
        "contact solutions": ("solves", number(",.0f")),
        "error of the profile, % of its depth": ("profile error", PER_CENT),
        "error of p_max, %": ("p_max error", number(".2f", 100.0)),
        "ripple of the pressure": ("ripple", number(".1e")),
    }
    return format_columns(read_rows("stepping.csv"), columns)


def conservation() -> str:
    """Return the largest errors of the balances of every process."""
    columns = {
        "process": ("process", str),
        "balance": ("balance", str),
        "largest error": ("error", number(".0e")),
        "tolerance": ("tolerance", number("g")),
    }
    return format_columns(read_rows("conservation.csv"), columns)


def conservation_wheels() -> str:
    """Return the largest errors of the laws of random wheel scenes."""
    columns = {
        "law": ("law", str),
        "scenes": ("scenes", str),
        "largest error": ("largest error", number(".0e")),
        "tolerance": ("tolerance", number("g")),
    }
    return format_columns(read_rows("conservation_wheels.csv"), columns)


def balance() -> str:
    """Return the worn cross-section divided by i/mu times the frictional work."""
    wanted = {"16", "64"}
    columns = {
        "friction": ("friction", str),
        "creepage": ("creepage", str),
        "creepage / creepage of full slip": ("of full slip", number("g")),
        "elements across": ("across", str),
        "law in terms of work": ("by work", number(".4f")),
        "law in terms of pressure": ("by pressure", number(".2f")),
    }
    return format_columns(read_rows("wear_balance.csv", lambda r: r["across"] in wanted), columns)


def peaks() -> str:
    """Return errors of peak values in per cent for each mesh, and their order."""
    by_case = defaultdict(dict)
    for row in read_rows("peaks.csv"):
        if not row["case"].startswith("worn"):
            case = row["case"], row["quantity"], row["estimate"]
            by_case[case][int(row["across"])] = abs(100.0 * float(row["error"]))
    lines = []
    for case, errors in by_case.items():
        order = -statistics.linear_regression(*map(_logs, zip(*errors.items(), strict=True))).slope
        lines.append((*case, *(f"{errors[n]:.2g}" for n in PEAK_MESHES), f"{order:.1f}"))
    across = (f"{n} across" for n in PEAK_MESHES)
    return format_table(("case", "quantity", "evaluation", *across, "order"), lines)


PEAK_MESHES = (16, 32, 96)


def _logs(values: tuple[float, ...]) -> list[float]:
    return [math.log(value) for value in values]


def peaks_worn() -> str:
    """Return scatter and mean error of the peaks of worn discs, in per cent, for each mesh."""
    by_case = defaultdict(list)
    for row in read_rows("peaks.csv", lambda r: r["case"].startswith("worn")):
        by_case[row["quantity"], row["estimate"], row["across"]].append(100.0 * float(row["error"]))
    head = (
        "quantity",
        "evaluation",
        "elements in x",
        "scatter",
        "mean, relative to the finest mesh",
    )
    return format_table(
        head, ((*case, f"{zigzag:.2f}", f"{mean:+.2f}") for case, (zigzag, mean) in by_case.items())
    )


def hard_scenes() -> str:
    """Return the random scenes that each method solves in each family, and the median cost."""
    by_method = defaultdict(list)
    for row in read_rows("hard_scenes.csv"):
        by_method[row["family"], row["method"]].append(row)
    lines = []
    for (family, method), rows in by_method.items():
        counts = [float(row["applications"]) for row in rows if row["converged"] == "True"]
        median = f"{statistics.median(counts):,.0f}" if counts else "-"
        lines.append((family, method, len(rows), len(counts), median))
    return format_table(
        ("family", "method", "scenes", "solved", "median of the applications"), lines
    )


def invariance() -> str:
    """Return the largest difference of each group of quantities for each change, over all kinds."""
    rows = read_rows("invariance.csv")
    changes = list(dict.fromkeys(row["change"] for row in rows))
    lines = []
    for group in dict.fromkeys(row["group"] for row in rows):
        values = {
            change: [
                float(row["difference"])
                for row in rows
                if (row["group"], row["change"]) == (group, change)
            ]
            for change in changes
        }
        lines.append(
            (group, *(f"{max(largest):.0e}" if largest else "-" for largest in values.values()))
        )
    return format_table(("largest difference of", *changes), lines)


def invariance_scenes() -> str:
    """Return the scenes of each kind, and the comparisons that exceeded their bound."""
    rows = read_rows("invariance.csv")
    lines = []
    for kind in dict.fromkeys(row["kind"] for row in rows):
        of_kind = [row for row in rows if row["kind"] == kind]
        broken = sum(int(row["broken"]) for row in of_kind)
        lines.append((kind, max(int(row["scenes"]) for row in of_kind), broken))
    return format_table(("kind", "scenes", "differences above the bound"), lines)


def falling() -> str:
    """Return results of random scenes with falling friction, and their cost ratio."""
    rows = read_rows("falling.csv")
    ended = [row["ended"] for row in rows]
    ratios = sorted(
        float(row["ratio"]) for row in rows if row["ended"] == row["constant_ended"] == "converged"
    )
    head = (
        "scenes",
        "converged",
        "rejected",
        "applications / constant law, median",
        "90th percentile",
    )
    cells = (
        len(rows),
        ended.count("converged"),
        ended.count("refused"),
        f"{statistics.median(ratios):.2f}",
        f"{ratios[int(0.9 * len(ratios))]:.2f}",
    )
    return format_table(head, [cells])


def heat() -> str:
    """Return the cost of temperatures relative to the contact, per mesh and Peclet number."""
    head = (
        "elements",
        "V a/(2 κ)",
        "tables, computed once",
        "heat partition, equal bodies",
        "heat partition, different bodies",
        "applications, temperature-dependent friction",
    )
    lines = [
        (
            f"{row['elements']} x {row['elements']}",
            f"{float(row['peclet']):g}",
            *(f"{100.0 * float(row[key]):.2g} %" for key in ("kernels", "alike", "unlike")),
            f"{float(row['answering']):.1f} times",
        )
        for row in read_rows("heat.csv")
    ]
    return format_table(head, lines)


def heat_contact() -> str:
    """Return forces and temperatures of CONTACT's examples, here and there."""
    head = (
        "example: $F_x/(\\mu P)$, largest temperature",
        "tractive_sam",
        "march along rows",
        "with CONTACT's own heat and memory",
        "CONTACT",
    )
    lines = []
    for row in read_rows("heat_contact.csv"):
        pairs = [
            (row[f"{name}force"], row[f"{name}hottest"])
            for name in ("", "march_", "changed_", "contact_")
        ]
        cells = [f"{float(q):.4f}, {float(t):.1f} °C" if q else "" for q, t in pairs]
        lines.append((row["case"], *cells))
    return format_table(head, lines)


def error_bars() -> str:
    """Return how often the error bar of each quantity holds."""
    by_quantity = defaultdict(list)
    for row in read_rows("error_bars.csv"):
        by_quantity[row["quantity"]].append(row)
    lines = []
    for name, rows in by_quantity.items():
        holding = sum(row["holds"] == "True" for row in rows)
        ratios = [
            float(row["relative error"]) / float(row["relative bar"])
            for row in rows
            if row["relative error"] and float(row["relative bar"] or 0.0) > 0.0
        ]
        lines.append((f"`{name}`", len(rows), holding, f"{statistics.median(ratios):.2f}"))
    return format_table(
        ("quantity", "scenes", "error bars that hold", "median of error / error bar"), lines
    )


def subsurface() -> str:
    """Return time and memory of the stress."""
    columns = {
        "problem": ("what", str),
        "seconds": ("seconds", number(".2g")),
        "seconds / seconds of the FFTs": ("over its FFTs", number(".1f")),
        "memory, MiB": ("MiB", number(".1f")),
    }
    return format_columns(read_rows("subsurface.csv"), columns)


def whole_roll() -> str:
    """Return the time of each part of a run."""
    columns = {
        "part": ("part", str),
        "seconds": ("seconds", number(".2f")),
        "seconds / seconds of the contacts": ("over contacts", number(".2f")),
        "fraction of the total, %": ("share of the total", number(".0f", 100.0)),
    }
    return format_columns(read_rows("whole_roll.csv"), columns)


def largest_stress() -> str:
    """Return errors of the largest stress inside a body."""
    columns = {
        "disc": ("body", str),
        "records": ("records", str),
        "records with a maximum inside": ("with a largest stress inside", str),
        "median error": ("median error", number(".0e")),
        "largest error": ("largest error", number(".0e")),
    }
    return format_columns(read_rows("largest_stress.csv"), columns)


def jacobian() -> str:
    """Return operator applications of derivatives and of central differences."""
    columns = {
        "scene": ("scene", str),
        "solution": ("solve", number(".0f")),
        "Jacobian": ("jacobian", number(".0f")),
        "central differences": ("differences", number(".0f")),
        "difference": ("apart", number(".0e")),
    }
    return format_columns(read_rows("jacobian.csv"), columns)


def fatigue() -> str:
    """Return the damage of body A of the twin discs with and without wear."""
    three = number(".3g")
    columns = {
        r"$\beta$, degrees": ("beta", str),
        "mesh": ("mesh", str),
        "tolerance": ("tolerance", number("g")),
        "D without wear": ("without wear A", three),
        "largest D": ("most A", three),
        "D at the end": ("damage A", three),
        "error of D at the end": ("error A", number(".1g")),
        "revolution of the first crack": (
            "crack at A",
            lambda text: "none" if text == "nan" else three(text),
        ),
        "removed damage, %": ("removed A", number(".1f", 100.0)),
        "contacts": ("contacts", number(".0f")),
        "seconds": ("seconds", number(".0f")),
    }
    return format_columns(read_rows("fatigue.csv"), columns)


def block_order() -> str:
    """Return the error bars of damage and the effect of the block order for each seed."""
    columns = {
        "random seed": ("seed", str),
        "bodies": ("bodies", str),
        "difference within `damage_error`": ("within", str),
        "smallest ratio of `damage_error` to the difference": ("least", number(".2f")),
        "median ratio": ("median", number(".1f")),
    }
    return format_columns(read_rows("block_order_ratios.csv"), columns)


def roller() -> str:
    """Return the pressure along a roller by profile and tilt."""
    columns = {
        "profile": ("profile", str),
        "tilt (mrad)": ("tilt", number(".1f")),
        "least pressure over 80 % of the length": ("least", number(".3f")),
        "largest pressure there": ("most", number(".3f")),
        "largest pressure": ("largest", number(".3f")),
        "moment (N mm)": ("moment", number(".0f")),
    }
    return format_columns(read_rows("roller.csv"), columns)


def conformal_bores() -> str:
    """Return the errors of a disc in a bore, and of Hertz for the same patch."""
    columns = {
        "half angle (degrees)": ("degrees", number(".0f")),
        "error of the half angle": ("angle", number(".0e")),
        "error of the peak pressure": ("peak", number(".0e")),
        "half-space: load (%)": ("hertz_load", number("+.1f", 100.0)),
        "half-space: peak pressure (%)": ("hertz_peak", number("+.1f", 100.0)),
    }
    return format_columns(read_rows("conformal_bores.csv"), columns)


def conformal_grooves() -> str:
    """Return contacts of balls in grooves beside the values that CONTACT prints."""
    columns = {
        "groove (mm)": ("groove", number(".2f")),
        "response": ("response", str),
        "half angle (degrees)": ("half_angle", number(".1f")),
        "p_max (MPa)": ("p_max", number(".1f")),
        "CONTACT": ("p_max_contact", number(".1f")),
        "P (N)": ("P", number(".0f")),
        "CONTACT ": ("P_contact", number(".0f")),
        "free creepage (1e-4)": ("creepage", number(".2f", 1e4)),
        "CONTACT  ": ("creepage_contact", number(".2f", 1e4)),
    }
    return format_columns(read_rows("conformal_grooves.csv"), columns)


def free_ends() -> str:
    """Return the displacement near a free end over that of a half-space, and by the factor."""
    columns = {
        r"$\nu$": ("poisson", number(".1f")),
        "$d$": ("distance", number(".0f")),
        "centre, free": ("centre", number(".3f")),
        "centre, quick": ("quick_centre", number(".3f")),
        "end, free": ("end", number(".2f")),
        "end, quick": ("quick_end", number(".2f")),
        "error of quick at the end, %": ("quick_error", number(".0f")),
    }
    return format_columns(read_rows("free_ends.csv"), columns)


def steel_rolled() -> str:
    """Return the residual stress that rolling leaves, by depth, for several peak pressures."""
    columns = {
        "$p_0/k$": ("p0_k", number(".1f")),
        "depth / $a$": ("z_a", number(".1f")),
        r"$\rho_{xx}/p_0$": ("xx", number(".4f")),
        r"$\rho_{yy}/p_0$": ("yy", number(".4f")),
    }
    rows = read_rows("steel_rolled.csv", lambda row: row["p0_k"] != "3.2")
    return format_columns(rows, columns)


def inclusions_spheres() -> str:
    """Return errors of the stress in and next to spheres, for each number of cells."""
    columns = {
        "cells across": ("cells", str),
        "sphere": ("inclusion", str),
        "error inside, over the stress without inclusion": ("inside", number(".1e")),
        "error of the largest von Mises stress": ("next to it", number(".1e")),
    }
    return format_columns(read_rows("inclusions_spheres.csv"), columns)


def inclusions_lift() -> str:
    """Return errors of the rise of the surface above a dilating sphere."""
    columns = {
        "depth over radius": ("depth", number(".4g")),
        "cells across": ("cells", str),
        "largest error of the rise": ("rise", number(".1e")),
    }
    return format_columns(read_rows("inclusions_lift.csv"), columns)


def steel_case() -> str:
    """Return utilisation and load factors of a roller by criterion and material."""
    columns = {
        "criterion": ("criterion", str),
        "material": ("material", str),
        "utilisation": ("utilisation", number(".3f")),
        "at depth (mm)": ("depth", number(".3f")),
        "`shakedown_lower`": ("shakedown", number(".3f")),
        "largest von Mises stress (MPa)": ("von_mises", number(".0f")),
    }
    return format_columns(read_rows("steel_case.csv"), columns)


def fatigue_spread() -> str:
    """Return the differences of the damage of body A due to meshes and tolerances."""
    rows = {(row["mesh"], row["tolerance"], row["beta"]): row for row in read_rows("fatigue.csv")}
    usual, loose, strict = "41 x 121", "0.001", "0.0001"
    head = ("compared runs", "largest D", "D at the end")
    compared = {
        "21 x 61 and 41 x 121 elements": (("21 x 61", loose), (usual, loose)),
        "41 x 121 and 81 x 241 elements": ((usual, loose), ("81 x 241", loose)),
        "tolerances 1e-3 and 1e-4, 21 x 61": (("21 x 61", loose), ("21 x 61", strict)),
        "tolerances 1e-3 and 1e-4, 41 x 121": ((usual, loose), (usual, strict)),
        "tolerances 1e-3 and 1e-4, 81 x 241": (("81 x 241", loose), ("81 x 241", strict)),
    }

    def largest_difference(first: tuple[str, str], second: tuple[str, str], column: str) -> str:
        pairs = (
            (float(rows[*first, beta][column]), float(rows[*second, beta][column]))
            for beta in ("0", "45", "90")
            if (*first, beta) in rows and (*second, beta) in rows
        )
        return f"{max((abs(a / b - 1.0) for a, b in pairs), default=math.nan) * 100.0:.1f} %"

    return format_table(
        head,
        (
            (name, *(largest_difference(*pair, column) for column in ("most A", "damage A")))
            for name, pair in compared.items()
        ),
    )


def fatigue_cost() -> str:
    """Return the cost of a run with fatigue relative to a run without, per mesh and tolerance."""
    rows = defaultdict(list)
    for row in read_rows("fatigue.csv"):
        rows[row["mesh"], row["tolerance"]].append(row)

    def ratios(several: list[dict], column: str, without: str) -> str:
        each = [float(row[column]) / float(row[without]) for row in several]
        return f"{min(each):.1f} to {max(each):.1f}"

    head = ("mesh", "tolerance", "ratio of the contacts", "ratio of the times")
    return format_table(
        head,
        (
            (
                *run,
                ratios(several, "contacts", "contacts without"),
                ratios(several, "seconds", "without"),
            )
            for run, several in rows.items()
        ),
    )


def jacobian_carter() -> str:
    """Return errors of the slope of Carter's curve for each mesh."""
    columns = {
        "elements across": ("n", str),
        "relative error of the slope": ("slope", number(".1e")),
        "relative error of the force": ("force", number(".1e")),
    }
    return format_columns(read_rows("jacobian_carter.csv"), columns)


def tables() -> str:
    """Return time and error of creep forces from tables and from other methods."""
    columns = {
        "method": ("method", str),
        "time per point, µs": ("s", number(".2g", 1e6)),
        r"median error / $(\mu P)$": ("median", number(".1e")),
        r"largest error / $(\mu P)$": ("worst", number(".1e")),
        r"median error of the moment / $(\mu P c)$": ("moment", number(".1e")),
    }
    about = read_rows("tables_about.csv")[0]
    summary = (
        f"The test has {about['points']} points. At {100.0 * float(about['inside']):.1f} % of "
        f"them, the error is within the error bar of the table. The table has {about['nodes']} "
        f"nodes for a tolerance of {float(about['tolerance']):g}, and its construction took "
        f"{float(about['cpu_seconds']):.0f} s on one core."
    )
    return summary + "\n\n" + format_columns(read_rows("tables.csv"), columns)


def table_gradients() -> str:
    """Return slopes of the table `steel` at zero creepage, and gradients at random points."""
    names = ("C11", "C22", "C23, force", "C23, moment", "C33")
    rows = read_rows("table_slopes.csv")
    small = number(".2f")
    body = [
        (
            number(".3g")(row["a/b"]),
            *(f"{float(row[name]):+.2f} ({small(row[f'bar of {name}'])})" for name in names),
        )
        for row in rows
    ]
    about = read_rows("table_gradients.csv")[0]
    share = number(".2g", 100.0)
    return (
        "The next table gives the errors of the slopes at zero creepage of the table `steel`, in "
        "per cent. The reference is the limit of 22 meshes with up to 131 elements across the "
        "contact. The numbers in brackets are the error bars of the table "
        "(`python benchmarks/table_gradients.py`):"
        f"\n\n{format_table(('a/b', *names), body)}\n\n"
        f"The error of the derivatives of a force, divided by "
        rf"$\sqrt{{K_{{ii}} K_{{jj}}}}$, was computed at "
        f"{about['points']} random points. Its median is {share(about['forces median'])} %, its "
        f"95th percentile {share(about['forces 95%'])} %, and its maximum "
        f"{share(about['forces largest'])} %. For the moment, these values are "
        f"{share(about['moment median'])} %, {share(about['moment 95%'])} % and "
        f"{share(about['moment largest'])} %. At {100.0 * float(about['inside']):.0f} % of the "
        "points, the errors are within their bars."
    )


def table_cluster() -> str:
    """Return the construction of a table by one process and by workers, one of them killed."""
    columns = {
        "build": ("build", str),
        "contacts": ("contacts", str),
        "seconds": ("s", number(".0f")),
        "core-hours": ("core-hours", number(".1e")),
        "largest difference": ("largest difference", number(".0e")),
    }
    return format_columns(read_rows("table_cluster.csv"), columns)


def study_scaling() -> str:
    """Return the time of studies on workers, and the estimate for a large study."""
    columns = {
        "study": ("study", str),
        "workers": ("workers", str),
        "seconds": ("s", number(".1f")),
    }
    rows = read_rows("study_scaling.csv")
    seconds = {(row["study"], row["workers"]): float(row["s"]) for row in rows}
    ratios = [
        seconds[study, "2"] / seconds[study, "1"] for study, number in seconds if number == "1"
    ]
    engine = read_rows("study_engine.csv")[0]
    large = read_rows("study_on_paper.csv")[-1]
    summary = (
        f"Two workers need {100.0 * min(ratios):.0f} to {100.0 * max(ratios):.0f} % of the time of "
        f"one worker, and the scheduler needs {float(engine['ms of scheduler']):.1f} ms per case "
        "(`python benchmarks/study.py`). As an estimate, "
        f"{int(large['cases']):,} wear scenes of 15,000 revolutions occupy {large['cores']} cores "
        f"for {float(large['s of the cores']):.0f} s and the scheduler for "
        f"{float(large['s of the scheduler']):.0f} s. Their files need "
        f"{float(large['GB in files']):.0f} GB."
    )
    return summary + "\n\n" + format_columns(rows, columns)


def transient_order() -> str:
    """Return the force after a linear increase of the creepage, for each mesh and each step."""
    rows = read_rows("transient_order.csv")
    meshes = dict.fromkeys(row["n"] for row in rows if row["over"] == "mesh")
    forces = {(row["slip"], row["n"]): row["Qx"] for row in rows if row["over"] == "mesh"}
    head = ("elements", *(f"{n} x {n}" for n in meshes))
    force = number(".5f")
    body = [
        (label, *(force(forces[slip, n]) for n in meshes))
        for label, slip in (
            (r"$Q_x/(\mu P)$, second order", "auto"),
            (r"$Q_x/(\mu P)$, first order", "upwind"),
        )
    ]
    steps = [row for row in rows if row["over"] == "step"]
    length = number(".3g")
    over_steps = format_table(
        ("step, mm", *(length(row["step"]) for row in steps)),
        [(r"$Q_x/(\mu P)$", *(force(row["Qx"]) for row in steps))],
    )
    meshes_text = (
        "The tables give the force between two spheres with a = 3.5 mm. The spheres start from "
        "rest, and the creepage increases linearly to -0.004 over 3 mm. In the first table, the "
        "mesh varies, and each step is one element long:"
    )
    steps_text = "In the second table, the step length varies, on 85 x 85 elements:"
    return f"{meshes_text}\n\n{format_table(head, body)}\n{steps_text}\n\n{over_steps}"


def transient_steps() -> str:
    """Return the work of the steps of transients."""
    columns = {"course": ("course", str)}
    slips = {"auto": "second order", "upwind": "first order"}
    values = {"median": "median", "most": "maximum", "convolutions": "convolutions"}
    columns |= {
        f"{order}, {label}": (f"{slip} {value}", number(".2g"))
        for slip, order in slips.items()
        for value, label in values.items()
    }
    rows = defaultdict(dict)
    for row in read_rows("transient_steps.csv"):
        rows[row["course"]] |= {"course": row["course"]}
        rows[row["course"]] |= {f"{row['slip']} {value}": row[value] for value in values}
    return format_columns(rows.values(), columns)


def transient_cost() -> str:
    """Return the work and the time of a step of a transient on several meshes."""
    columns = {
        "elements": ("elements", str),
        "applications": ("applications", number(".3g")),
        "convolutions": ("convolutions", number(".3g")),
        "CPU time, ms": ("milliseconds", number(".2g")),
        "CPU time / CPU time of an application": ("over_application", number(".3g")),
    }
    return format_columns(read_rows("transient_cost.csv"), columns)


def transient_wear() -> str:
    """Return errors of the wear depth of transients."""
    errors = {
        (row["case"], row["slip"], row["n"], row["steps"]): row["error"]
        for row in read_rows("transient_wear.csv")
    }
    slips = (
        ("law in terms of work (default)", "auto"),
        ("law in terms of pressure (`upwind`)", "upwind"),
    )
    small, tables = number(".2g"), []
    for case, first in (("pass", "elements"), ("fretting", "elements, steps per stroke")):
        places = list(dict.fromkeys(", ".join(filter(None, k[2:])) for k in errors if k[0] == case))
        body = [
            (label, *(small(value) for key, value in errors.items() if key[:2] == (case, slip)))
            for label, slip in slips
        ]
        tables.append(format_table((first, *places), body))
    rolling = (
        "The tables give the largest error of the depth, divided by the largest depth (spheres). "
        "The first table compares a pass with constant creepage with a steady revolution; each "
        "step is one element long:"
    )
    fretting = "The second table compares an oscillating ball with the closed form:"
    return f"{rolling}\n\n{tables[0]}\n{fretting}\n\n{tables[1]}"


def duty() -> str:
    """Return the error and cost of jumps of duty cycles, relative to every revolution."""
    columns = {
        "blocks": ("blocks", str),
        "error of the profile, % of the depth": ("error", PER_CENT),
        "wear of a cycle, %": ("cycle", PER_CENT),
        "contacts": ("contacts", str),
        "contacts / contacts of a single load": ("over single", number(".2f")),
        "contacts if every revolution is computed": ("one by one", str),
    }
    return format_columns(read_rows("duty.csv"), columns)


def duty_cores() -> str:
    """Return the possible gain of parallel blocks."""
    columns = {
        "elements": ("elements", str),
        "seconds per contact": ("seconds", number(".2g")),
        "time in transforms and kernels, %": ("free", number(".0f", 100.0)),
        "largest possible speed-up with two threads": ("threads", number(".1f")),
        "seconds to start a process": ("process", number(".1f")),
        "contacts solved in this time": ("contacts", number(".0f")),
    }
    return format_columns(read_rows("duty_cores.csv"), columns)


def fit_powers() -> str:
    """Return the coefficients of measured twin discs, and the minimum of chi-square on a grid."""
    columns = {
        "key": ("key", str),
        "fit": ("fit", number(".3g")),
        "standard deviation": ("sd", number(".2g")),
        "standard deviation from the scatter": ("sd by scatter", number(".2g")),
        "minimum on the grid": ("grid", number(".3g")),
        "standard deviation on the grid": ("sd of grid", number(".2g")),
        "correlation": ("correlation", number(".2f")),
        "correlation on the grid": ("of grid", number(".2f")),
    }
    return format_columns(read_rows("fit_powers.csv"), columns)


def fit_exact() -> str:
    """Return the errors of estimates from data without noise."""
    columns = {
        "key": ("key", str),
        "true value": ("truth", number("g")),
        "relative error": ("error", number(".0e")),
        "contacts of the fit": ("contacts", number(".0f")),
        "runs": ("rolls", number(".0f")),
    }
    return format_columns(read_rows("fit_exact.csv"), columns)


def fit_ratios() -> str:
    """Return the ratio of predicted to measured work, with and without a layer."""
    columns = {
        "slip, %": ("slip", number("g", 100.0)),
        "predicted / measured without layer": ("without layer", number(".2f")),
        "predicted / measured with the fitted layer": ("fitted", number(".2f")),
    }
    return format_columns(read_rows("fit_ratios.csv"), columns)


def fit_repeats() -> str:
    """Return how often intervals contain the true values."""
    columns = {
        "test": ("test", str),
        "key": ("key", str),
        "true value within the interval, %": ("covered %", number(".1f")),
        "chi-square within its range, %": ("chi-square expected %", number(".1f")),
        "contacts of a fit": ("contacts", number(".0f")),
        "runs": ("rolls", number(".0f")),
    }
    return format_columns(read_rows("fit_repeats.csv"), columns)


def fit_coverage() -> str:
    """Return how often intervals contain the true values, for each kind of noise and setting."""
    columns = {
        "noise": ("noise", str),
        "standard deviation": ("s", str),
        "points": ("n", str),
        "settings": ("settings", str),
        "key": ("key", str),
        "median estimate / truth": ("median", number(".3f")),
        "true value within the interval, %": ("covered %", number(".1f")),
    }
    return format_columns(read_rows("fit_coverage.csv"), columns)


def fit_posterior() -> str:
    """Return posterior samples of a creep curve, beside the linearised fit."""
    columns = {
        "key": ("key", str),
        "fit": ("fit", number(".4g")),
        "standard deviation": ("sd", number(".3g")),
        "95 % interval from": ("low", number(".4g")),
        "to": ("high", number(".4g")),
        "mean of the samples": ("mean", number(".4g")),
        "their standard deviation": ("sd of samples", number(".3g")),
        "95 % of the samples from": ("quantile low", number(".4g")),
        "up to": ("quantile high", number(".4g")),
        "autocorrelation time, steps": ("autocorrelation", number(".0f")),
    }
    return format_columns(read_rows("fit_posterior.csv"), columns)


def spread_indices() -> str:
    """Return the table of Sobol indices of outcomes that no model describes."""
    columns = {
        "outcome": ("outcome", str),
        "samples": ("samples", number(".0f")),
        "runs": ("runs", number(".0f")),
        "largest error (root mean square)": ("largest error", number(".3f")),
        "index within the interval, %": ("covered %", number(".0f")),
    }
    return format_columns(read_rows("spread_indices.csv"), columns)


def spread_bearing() -> str:
    """Return the table of total indices of the life of a roller."""
    rows = read_rows("spread_bearing.csv")
    sizes = [name for name in rows[0] if name.isdigit()]
    lines = []
    for row in rows:
        cells = [f"{float(row[n]):.3f} ± {float(row[f'{n} half']):.3f}" if row["key"] != "CPU s"
                 else f"{float(row[n]):.0f}" for n in sizes]  # fmt: skip
        lines.append([f"`{row['key']}`" if "." in row["key"] else row["key"], *cells])
    return format_table(["key", *(f"{n} samples" for n in sizes)], lines)


def spread() -> str:
    """Return errors of percentiles and Sobol indices, and how often intervals contain them."""
    columns = {
        "outcome": ("outcome", str),
        "samples": ("samples", number(".0f")),
        "of them on the fine mesh": ("fine", number(".0f")),
        "error of percentiles, %": ("error of percentiles %", number(".2g")),
        "percentile within the interval, %": ("covered %", number(".1f")),
        "error of indices": ("error of indices", number(".1g")),
        "index within the interval, %": ("indices covered %", number(".1f")),
    }
    return format_columns(read_rows("spread.csv"), columns)


def design() -> str:
    """Return the number of runs of designs of twin discs."""
    columns = {
        "aim": ("design", str),
        "keys": ("keys", number(".0f")),
        "limits": ("limits", number(".0f")),
        "points": ("points", number(".0f")),
        "runs": ("rolls", number(".0f")),
        "change of the aim, %": ("change %", number(".0f")),
        "active limits": ("active", number(".0f")),
    }
    return format_columns(read_rows("design.csv"), columns)


def fit_cost() -> str:
    """Return the cost of fits."""
    columns = {
        "fit": ("fit", str),
        "evaluations": ("iterations", number(".0f")),
        "contacts": ("contacts", number(".0f")),
        "runs": ("rolls", number(".0f")),
        "convolutions": ("convolutions", number(".0f")),
    }
    return format_columns(read_rows("fit_cost.csv"), columns)


def experiment() -> str:
    """Return measured and predicted frictional work of twin discs."""
    columns = {
        "slip, %": ("slip", number("g", 100.0)),
        "measured T-gamma/A, N/mm²": ("measured", number(".3g")),
        "predicted T-gamma/A, N/mm²": ("predicted", number(".3g")),
        "predicted with minimum friction": ("least", number(".3g")),
        "predicted with maximum friction": ("most", number(".3g")),
        "predicted / measured": ("over", number(".2f")),
        "wear law at the measured work, µg/(m mm²)": ("wear measured", number(".3g")),
        "wear law at the predicted work": ("wear predicted", number(".3g")),
        "wear law with minimum friction": ("wear least", number(".3g")),
        "wear law with maximum friction": ("wear most", number(".3g")),
    }
    return format_columns(read_rows("experiment.csv"), columns)


TABLES = {
    table.__name__: table
    for table in (
        solvers,
        solvers_steady,
        solvers_growth,
        preconditioners,
        large_threads,
        large,
        normal,
        wheel_rail,
        wheel_rail_patches,
        wheel_rail_crossing,
        wheel_rail_parts,
        wheel_rail_spin,
        wheel_rail_pitch,
        conservation,
        conservation_wheels,
        spheres,
        creep_forces,
        published_sets,
        orthotropic,
        twin_discs,
        twin_discs_mesh,
        giwm,
        wear,
        fatigue,
        fatigue_spread,
        block_order,
        fatigue_cost,
        roller,
        conformal_bores,
        conformal_grooves,
        inclusions_spheres,
        inclusions_lift,
        free_ends,
        steel_rolled,
        steel_case,
        stepping,
        balance,
        peaks,
        peaks_worn,
        hard_scenes,
        invariance,
        layered_spheres,
        layered_cylinders,
        relaxing_cylinders,
        relaxing_spheres,
        relaxing_polyamide,
        relaxing_cost,
        anisotropic_cost,
        invariance_scenes,
        falling,
        heat,
        heat_contact,
        error_bars,
        subsurface,
        whole_roll,
        largest_stress,
        jacobian,
        jacobian_carter,
        tables,
        table_gradients,
        table_cluster,
        study_scaling,
        transient_order,
        transient_steps,
        transient_cost,
        transient_wear,
        duty,
        duty_cores,
        experiment,
        fit_powers,
        fit_ratios,
        fit_exact,
        fit_repeats,
        fit_coverage,
        fit_cost,
        fit_posterior,
        spread,
        spread_indices,
        spread_bearing,
        design,
    )
}
