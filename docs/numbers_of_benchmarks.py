"""The tables of numbers in the manual, each from a CSV file that a benchmark has written."""

import math
import statistics
from collections import defaultdict

from tables import markdown, number, of_columns, rows_of

PER_CENT = number(".3f", 100.0)


def solvers() -> str:
    """Applications and seconds of each method, over meshes."""
    rows = {(row["n"], row["method"]): row for row in rows_of("solvers.csv")}
    meshes = list(dict.fromkeys(n for n, _ in rows))
    methods = ("newton", "anderson", "uzawa")

    def cell(n: str, method: str) -> str:
        row = rows.get((n, method))
        if row is None:
            return "-"
        return f"{float(row['applications']):,.0f}, {float(row['seconds']):.2g} s"

    head = ("elements", *methods)
    return markdown(head, ((f"{n} x {n}", *(cell(n, one) for one in methods)) for n in meshes))


def large() -> str:
    """Time and memory of large meshes."""
    columns = {
        "elements": ("n", lambda n: f"{n} x {n}"),
        "applications": ("applications", number(".0f")),
        "first solve, s": ("first s", number(".2g")),
        "again, s": ("again s", number(".2g")),
        "GiB": ("GiB", number(".2f")),
    }
    return of_columns(rows_of("large.csv"), columns)


def normal() -> str:
    """The normal problem alone."""
    columns = {
        "elements": ("n", lambda n: f"{n} x {n}"),
        "applications": ("applications", number(".0f")),
        "seconds": ("seconds", number(".2g")),
        "seconds over those of its FFTs": ("over its FFTs", number(".2f")),
        "error of the peak contact pressure": ("p_max/p0 - 1", number(".1e")),
        "Tamaas, seconds": ("Tamaas seconds", number(".2g")),
        "Tamaas over this": ("Tamaas/this", number(".0f")),
    }
    return of_columns(rows_of("normal.csv"), columns)


def spheres() -> str:
    """Convergence of the scene `spheres` over the mesh."""
    wanted = {"41", "61", "91", "121", "181", "241", "321"}
    columns = {
        "elements": ("n", lambda n: f"{n} x {n}"),
        "peak contact pressure over Hertz - 1": ("p_max/p0 - 1", number(".1e")),
        "error of the approach": ("approach error", number(".1e")),
        "mean error of the pressure / p0": ("mean |p - Hertz|/p0", number(".1e")),
        "Q_x/(mu P)": ("Qx/muP", number(".5f")),
        "Q_x/(mu P), CONTACT": ("CONTACT", number(".4f")),
    }
    return of_columns(rows_of("spheres_convergence.csv", lambda r: r["n"] in wanted), columns)


def creep_forces() -> str:
    """The creep-force curve."""
    columns = {
        "scaled creepage": ("xi~", number("g")),
        "91 x 91": ("n = 91", number(".4f")),
        "extrapolated": ("extrapolated", number(".4f")),
        "CONTACT, 91 x 91": ("CONTACT n = 91", number(".4f")),
        "CONTACT, extrapolated": ("CONTACT extrapolated", number(".4f")),
        "Vermeulen and Johnson": ("Vermeulen-Johnson", number(".4f")),
        "paper, eq. (42)": ("Kalker (42)", number(".4f")),
    }
    return of_columns(rows_of("creep_force_curve.csv"), columns)


def kalker() -> str:
    """Creep coefficients beside Kalker's table."""
    columns = {"a/b": ("a/b", number("g")), "nu": ("nu", number("g"))}
    for name in ("C11", "C22", "C23", "C33"):
        columns |= {
            name: (name, number(".3f")),
            f"{name}, Kalker": (f"{name} Kalker", number(".3g")),
            f"{name}, %": (f"{name} %", number("+.2f")),
        }
    return of_columns(rows_of("kalker_coefficients.csv"), columns)


def orthotropic() -> str:
    """Forces over the angle of friction."""
    columns = {
        "beta": ("beta", number("g")),
        "Q_x/P": ("Qx/P", number(".4f")),
        "Q_y/P": ("Qy/P", number("z.4f")),
        "stick": ("stick", number(".2f")),
        "Q_x/P in full slip": ("full slip Qx/P", number(".4f")),
        "closed form": ("closed form x", number(".4f")),
        "Q_y/P in full slip": ("full slip Qy/P", number("z.4f")),
        "closed form ": ("closed form y", number(".4f")),
    }
    return of_columns(rows_of("orthotropic_angles.csv"), columns)


def twin_discs() -> str:
    """States of the worn discs."""
    columns = {
        "beta": ("beta", number("g")),
        "revolution": ("revolution", number(",.0f")),
        "half width x, mm": ("a", number(".3f")),
        "half width y, mm": ("b", number(".3f")),
        "wear depth, mm": ("wear_max", number(".4g")),
        "peak contact pressure, MPa": ("p_max", number(".0f")),
        "Q_x/P": ("Qx/P", number(".4f")),
        "Q_y/P": ("Qy/P", number("z.4f")),
        "stick": ("stick", number(".2f")),
    }
    return of_columns(rows_of("twin_discs.csv"), columns)


def twin_discs_mesh() -> str:
    """Convergence of the worn discs over the mesh."""
    columns = {
        "mesh": ("mesh", str),
        "contact solves": ("solves", str),
        "wear depth, mm": ("wear_max", number(".5f")),
        "Q_x/P": ("Qx/P", number(".4f")),
        "half width y, mm": ("b", number(".3f")),
        "pressure at y = 0, MPa": ("pressure at y = 0", number(".1f")),
        "peak contact pressure, MPa": ("p_max", number(".0f")),
    }
    return of_columns(rows_of("twin_discs_mesh.csv"), columns)


def giwm() -> str:
    """Wear beside the global incremental wear model."""
    columns = {
        "revolution": ("revolution", number(",.0f")),
        "wear depth, mm": ("depth", number(".3g")),
        "GIWM, mm": ("GIWM depth", number(".3g")),
        "ratio": ("depth/GIWM", number(".3f")),
        "half width y, mm": ("b", number(".3f")),
        "GIWM, mm ": ("GIWM b", number(".3f")),
    }
    return of_columns(rows_of("twin_discs_giwm.csv"), columns)


def wear() -> str:
    """What 15,000 revolutions take, over the tolerance."""
    columns = {
        "tolerance": ("tolerance", str),
        "contact solves": ("solves", str),
        "seconds": ("seconds", number(".1f")),
        "paper's scheme over this": ("paper/this", number(",.0f")),
        "error of the profile, % of its depth": ("profile error at 15000", PER_CENT),
        "error of Q_x/P, %": ("Qx_over_P error at 15000", number("+.4f", 100.0)),
    }
    return of_columns(rows_of("wear.csv"), columns)


def stepping() -> str:
    """Ways of stepping."""
    columns = {
        "stepping": ("stepping", str),
        "tolerance": ("tolerance", number("g")),
        "contact solves": ("solves", number(",.0f")),
        "error of the profile, % of its depth": ("profile error", PER_CENT),
        "error of p_max, %": ("p_max error", number(".2f", 100.0)),
        "ripple of the pressure": ("ripple", number(".1e")),
    }
    return of_columns(rows_of("stepping.csv"), columns)


def balance() -> str:
    """Worn section over work."""
    wanted = {"16", "64"}
    columns = {
        "friction": ("friction", str),
        "creepage": ("creepage", str),
        "of that of full slip": ("of full slip", number("g")),
        "elements across": ("across", str),
        "by work": ("by work", number(".4f")),
        "by pressure": ("by pressure", number(".2f")),
    }
    return of_columns(rows_of("wear_balance.csv", lambda r: r["across"] in wanted), columns)


def peaks() -> str:
    """Errors of peak values in per cent, over the mesh, and their order."""
    found = defaultdict(dict)
    for row in rows_of("peaks.csv"):
        if not row["case"].startswith("worn"):
            of = row["case"], row["quantity"], row["way"]
            found[of][int(row["across"])] = abs(100.0 * float(row["error"]))
    lines = []
    for of, errors in found.items():
        order = -statistics.linear_regression(*map(_logs, zip(*errors.items(), strict=True))).slope
        lines.append((*of, *(f"{errors[n]:.2g}" for n in PEAK_MESHES), f"{order:.1f}"))
    across = (f"{n} across" for n in PEAK_MESHES)
    return markdown(("case", "quantity", "way", *across, "order"), lines)


PEAK_MESHES = (16, 32, 96)


def _logs(values: tuple[float, ...]) -> list[float]:
    return [math.log(value) for value in values]


def peaks_worn() -> str:
    """How the peaks of worn discs stray, in per cent, over the mesh."""
    found = defaultdict(list)
    for row in rows_of("peaks.csv", lambda r: r["case"].startswith("worn")):
        found[row["quantity"], row["way"], row["across"]].append(100.0 * float(row["error"]))
    head = ("quantity", "way", "elements in x", "zigzag", "mean, to the finest mesh")
    return markdown(
        head, ((*of, f"{zigzag:.2f}", f"{off:+.2f}") for of, (zigzag, off) in found.items())
    )


def hard_scenes() -> str:
    """How many random scenes each method solves, by family, and at what median cost."""
    found = defaultdict(list)
    for row in rows_of("hard_scenes.csv"):
        found[row["family"], row["method"]].append(row)
    lines = []
    for (family, method), rows in found.items():
        done = [float(row["applications"]) for row in rows if row["converged"] == "True"]
        median = f"{statistics.median(done):,.0f}" if done else "-"
        lines.append((family, method, len(rows), len(done), median))
    return markdown(("family", "method", "scenes", "solved", "median of applications"), lines)


def invariance() -> str:
    """The largest difference of each group of quantities under each change, over all kinds."""
    rows = rows_of("invariance.csv")
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
        lines.append((group, *(f"{max(of):.0e}" if of else "-" for of in values.values())))
    return markdown(("largest difference of", *changes), lines)


def invariance_scenes() -> str:
    """How many scenes of each kind were compared, and how many comparisons broke their bound."""
    rows = rows_of("invariance.csv")
    lines = []
    for kind in dict.fromkeys(row["kind"] for row in rows):
        of = [row for row in rows if row["kind"] == kind]
        broken = sum(int(row["broken"]) for row in of)
        lines.append((kind, max(int(row["scenes"]) for row in of), broken))
    return markdown(("kind", "scenes", "differences above their bound"), lines)


def falling() -> str:
    """How random scenes with falling friction end, and at what cost beside the constant law."""
    rows = rows_of("falling.csv")
    ended = [row["ended"] for row in rows]
    ratios = sorted(
        float(row["ratio"]) for row in rows if row["ended"] == row["constant_ended"] == "converged"
    )
    head = ("scenes", "converged", "refused", "applications over the constant law, median", "90 %")
    cells = (
        len(rows),
        ended.count("converged"),
        ended.count("refused"),
        f"{statistics.median(ratios):.2f}",
        f"{ratios[int(0.9 * len(ratios))]:.2f}",
    )
    return markdown(head, [cells])


def heat() -> str:
    """What temperatures cost beside the contact, over mesh and Peclet number."""
    head = (
        "elements",
        "V a/(2 κ)",
        "tables, once",
        "shared, alike bodies",
        "unlike",
        "applications, friction answers",
    )
    lines = [
        (
            f"{row['elements']}²",
            f"{float(row['peclet']):g}",
            *(f"{100.0 * float(row[key]):.2g} %" for key in ("kernels", "alike", "unlike")),
            f"{float(row['answering']):.1f} times",
        )
        for row in rows_of("heat.csv")
    ]
    return markdown(head, lines)


def error_bars() -> str:
    """How often error bars hold, by quantity."""
    found = defaultdict(list)
    for row in rows_of("error_bars.csv"):
        found[row["quantity"]].append(row)
    lines = []
    for name, rows in found.items():
        held = sum(row["holds"] == "True" for row in rows)
        ratios = [
            float(row["relative error"]) / float(row["relative bar"])
            for row in rows
            if row["relative error"] and float(row["relative bar"] or 0.0) > 0.0
        ]
        lines.append((f"`{name}`", len(rows), held, f"{statistics.median(ratios):.2f}"))
    return markdown(("quantity", "scenes", "bars that hold", "median of error over bar"), lines)


def subsurface() -> str:
    """Time of the stress."""
    columns = {
        "what": ("what", str),
        "seconds": ("seconds", number(".2g")),
        "seconds over those of its FFTs": ("over its FFTs", number(".1f")),
        "MiB": ("MiB", number(".1f")),
    }
    return of_columns(rows_of("subsurface.csv"), columns)


def whole_roll() -> str:
    """Where the time of a roll goes."""
    columns = {
        "part": ("part", str),
        "seconds": ("seconds", number(".2f")),
        "over contacts": ("over contacts", number(".2f")),
        "of the whole, %": ("over the whole", number(".0f", 100.0)),
    }
    return of_columns(rows_of("whole_roll.csv"), columns)


def largest_stress() -> str:
    """Errors of the largest stress inside."""
    columns = {
        "disc": ("body", str),
        "records": ("records", str),
        "with one inside": ("with a largest stress inside", str),
        "median error": ("median error", number(".0e")),
        "largest error": ("largest error", number(".0e")),
    }
    return of_columns(rows_of("largest_stress.csv"), columns)


def jacobian() -> str:
    """Work of derivatives beside that of central differences."""
    columns = {
        "scene": ("scene", str),
        "solve": ("solve", number(".0f")),
        "Jacobian": ("jacobian", number(".0f")),
        "central differences": ("differences", number(".0f")),
        "apart": ("apart", number(".0e")),
    }
    return of_columns(rows_of("jacobian.csv"), columns)


def fatigue() -> str:
    """Damage of the twin discs' body A with and without wear."""
    three = number(".3g")
    columns = {
        "beta": ("beta", str),
        "mesh": ("mesh", str),
        "tolerance": ("tolerance", number("g")),
        "D without wear": ("without wear A", three),
        "largest D": ("most A", three),
        "D at the end": ("damage A", three),
        "its error": ("error A", number(".1g")),
        "crack at": ("crack at A", lambda text: "none" if text == "nan" else three(text)),
        "removed, %": ("removed A", number(".1f", 100.0)),
        "contacts": ("contacts", number(".0f")),
        "s": ("seconds", number(".0f")),
    }
    return of_columns(rows_of("fatigue.csv"), columns)


def block_order() -> str:
    """Error bars of damage beside the effect of the order of blocks, by seed."""
    columns = {
        "random seed": ("seed", str),
        "bodies": ("bodies", str),
        "difference within `damage_error`": ("within", str),
        "smallest ratio of `damage_error` to the difference": ("least", number(".2f")),
        "median ratio": ("median", number(".1f")),
    }
    return of_columns(rows_of("block_order_ratios.csv"), columns)


def fatigue_spread() -> str:
    """How far damage of the twin discs' body A differs over meshes and tolerances."""
    rows = {(one["mesh"], one["tolerance"], one["beta"]): one for one in rows_of("fatigue.csv")}
    usual, loose, strict = "41 x 121", "0.001", "0.0001"
    head = ("between", "largest D", "D at the end")
    apart = {
        "21 × 61 and 41 × 121 elements": (("21 x 61", loose), (usual, loose)),
        "41 × 121 and 81 × 241 elements": ((usual, loose), ("81 x 241", loose)),
        "tolerances 1e-3 and 1e-4, 21 × 61": (("21 x 61", loose), ("21 x 61", strict)),
        "tolerances 1e-3 and 1e-4, 41 × 121": ((usual, loose), (usual, strict)),
        "tolerances 1e-3 and 1e-4, 81 × 241": (("81 x 241", loose), ("81 x 241", strict)),
    }

    def most(one: tuple[str, str], other: tuple[str, str], column: str) -> str:
        pairs = (
            (float(rows[*one, beta][column]), float(rows[*other, beta][column]))
            for beta in ("0", "45", "90")
            if (*one, beta) in rows and (*other, beta) in rows
        )
        return f"{max((abs(a / b - 1.0) for a, b in pairs), default=math.nan):.1%}"

    return markdown(
        head,
        (
            (name, *(most(*pair, column) for column in ("most A", "damage A")))
            for name, pair in apart.items()
        ),
    )


def fatigue_cost() -> str:
    """Time of a roll with fatigue beside the roll without, of each mesh and tolerance."""
    rows = defaultdict(list)
    for one in rows_of("fatigue.csv"):
        rows[one["mesh"], one["tolerance"]].append(one)

    def ratios(several: list[dict], column: str, without: str) -> str:
        each = [float(one[column]) / float(one[without]) for one in several]
        return f"{min(each):.1f} to {max(each):.1f}"

    head = ("mesh", "tolerance", "contacts over those without", "time over that without")
    return markdown(
        head,
        (
            (
                *of,
                ratios(several, "contacts", "contacts without"),
                ratios(several, "seconds", "without"),
            )
            for of, several in rows.items()
        ),
    )


def jacobian_carter() -> str:
    """Errors of the slope of Carter's curve over the mesh."""
    columns = {
        "elements across": ("n", str),
        "error of the slope": ("slope", number(".1e")),
        "error of the force": ("force", number(".1e")),
    }
    return of_columns(rows_of("jacobian_carter.csv"), columns)


def tables() -> str:
    """Creep forces by a table and by other ways."""
    columns = {
        "by": ("way", str),
        "time of one, µs": ("s", number(".2g", 1e6)),
        "median error over µP": ("median", number(".1e")),
        "largest": ("worst", number(".1e")),
        "median of the moment over µPc": ("moment", number(".1e")),
    }
    about = rows_of("tables_about.csv")[0]
    told = (
        f"{about['points']} points; {float(about['inside']):.1%} of them are within the error that "
        f"the table tells. It has {about['nodes']} nodes for a tolerance of "
        f"{float(about['tolerance']):g} and took {float(about['cpu_seconds']):.0f} s of one core, "
        f"{float(about['cpu_seconds']) / 3600.0:.2g} core-hours."
    )
    return told + "\n\n" + of_columns(rows_of("tables.csv"), columns)


def table_gradients() -> str:
    """Slopes at rest of the table of steel over a/b, and gradients at random points."""
    names = ("C11", "C22", "C23, force", "C23, moment", "C33")
    rows = rows_of("table_slopes.csv")
    small = number(".2f")
    body = [
        (
            number(".3g")(row["a/b"]),
            *(f"{float(row[name]):+.2f} ({small(row[f'bar of {name}'])})" for name in names),
        )
        for row in rows
    ]
    about = rows_of("table_gradients.csv")[0]
    share = number(".2g", 100.0)
    return (
        "Errors of the slopes at rest of the table of steel in percent, against limits of 22 "
        "meshes of up to 131 elements, and in brackets the error bars that the table reports "
        "(`python benchmarks/table_gradients.py`):"
        f"\n\n{markdown(('a/b', *names), body)}\n\n"
        f"At {about['points']} random points the largest error of the derivatives of a force is "
        f"{share(about['forces median'])} % of sqrt(K_ii K_jj) in the median, "
        f"{share(about['forces 95%'])} % at 95 of 100, {share(about['forces largest'])} % at most; "
        f"of the moment {share(about['moment median'])} %, {share(about['moment 95%'])} % and "
        f"{share(about['moment largest'])} %. {float(about['inside']):.0%} of the points "
        "are within their error bars."
    )


def table_cluster() -> str:
    """A table by one process, and by workers of which one was killed."""
    columns = {
        "by": ("way", str),
        "contacts": ("contacts", str),
        "s": ("s", number(".0f")),
        "core-hours": ("core-hours", number(".1e")),
        "largest difference": ("largest difference", number(".0e")),
    }
    return of_columns(rows_of("table_cluster.csv"), columns)


def study_scaling() -> str:
    """A study on one and two workers."""
    columns = {
        "study": ("study", str),
        "workers": ("workers", str),
        "seconds": ("s", number(".1f")),
    }
    return of_columns(rows_of("study_scaling.csv"), columns)


def transient_order() -> str:
    """Force after a ramp of creepage, over the mesh and over the step."""
    rows = rows_of("transient_order.csv")
    meshes = dict.fromkeys(row["n"] for row in rows if row["over"] == "mesh")
    forces = {(row["slip"], row["n"]): row["Qx"] for row in rows if row["over"] == "mesh"}
    head = ("elements", *(f"{n} x {n}" for n in meshes))
    force = number(".5f")
    body = [
        (told, *(force(forces[slip, n]) for n in meshes))
        for told, slip in (("Q_x/(mu P), second order", "auto"), ("first order", "upwind"))
    ]
    steps = [row for row in rows if row["over"] == "step"]
    length = number(".3g")
    over_steps = markdown(
        ("step, mm", *(length(row["step"]) for row in steps)),
        [("Q_x/(mu P)", *(force(row["Qx"]) for row in steps))],
    )
    told = (
        "From rest, after a ramp of creepage to -0.004 over 3 mm (spheres, a = 3.5 mm); over the "
        "mesh, in steps of one element,"
    )
    also = "and, on 85 x 85 elements, over the step:"
    return f"{told}\n\n{markdown(head, body)}\n{also}\n\n{over_steps}"


def transient_steps() -> str:
    """Work of the steps of courses."""
    columns = {"course": ("course", str)}
    slips = {"auto": "second order", "upwind": "first order"}
    columns |= {
        f"{told}, {of}": (f"{slip} {of}", number(".2g"))
        for slip, told in slips.items()
        for of in ("median", "most", "convolutions")
    }
    rows = defaultdict(dict)
    for row in rows_of("transient_steps.csv"):
        rows[row["course"]] |= {"course": row["course"]}
        of_slip = ("median", "most", "convolutions")
        rows[row["course"]] |= {f"{row['slip']} {of}": row[of] for of in of_slip}
    return of_columns(rows.values(), columns)


def transient_wear() -> str:
    """Errors of the depth that transients wear."""
    errors = {
        (row["case"], row["slip"], row["n"], row["steps"]): row["error"]
        for row in rows_of("transient_wear.csv")
    }
    slips = (("by the work of friction (default)", "auto"), ("by pressure (`upwind`)", "upwind"))
    small, tables = number(".2g"), []
    for case, first in (("pass", "elements"), ("fretting", "elements, steps a stroke")):
        places = list(dict.fromkeys(", ".join(filter(None, k[2:])) for k in errors if k[0] == case))
        body = [
            (told, *(small(value) for key, value in errors.items() if key[:2] == (case, slip)))
            for told, slip in slips
        ]
        tables.append(markdown((first, *places), body))
    told = (
        "Largest error of the depth over the largest depth (spheres). A pass of a constant course "
        "against a steady revolution, in steps of one element:"
    )
    also = "A ball that slides to and fro against the closed form:"
    return f"{told}\n\n{tables[0]}\n{also}\n\n{tables[1]}"


def duty() -> str:
    """Jumps of duty cycles against every revolution."""
    columns = {
        "blocks": ("blocks", str),
        "error of the profile, % of the depth": ("error", PER_CENT),
        "wear of a cycle, %": ("cycle", PER_CENT),
        "contacts": ("contacts", str),
        "over those of a single load": ("over single", number(".2f")),
        "one by one": ("one by one", str),
    }
    return of_columns(rows_of("duty.csv"), columns)


def duty_cores() -> str:
    """What blocks side by side could win."""
    columns = {
        "elements": ("elements", str),
        "seconds a contact": ("seconds", number(".2g")),
        "of it in transforms and kernels, %": ("free", number(".0f", 100.0)),
        "two threads, at most times as fast": ("threads", number(".1f")),
        "seconds until a process is ready": ("process", number(".1f")),
        "as long as so many contacts": ("contacts", number(".0f")),
    }
    return of_columns(rows_of("duty_cores.csv"), columns)


def experiment() -> str:
    """Frictional work of twin discs, measured and predicted."""
    columns = {
        "slip, %": ("slip", number("g", 100.0)),
        "T-gamma/A, measured, N/mm²": ("measured", number(".3g")),
        "predicted": ("predicted", number(".3g")),
        "by the least and": ("least", number(".3g")),
        "the most friction": ("most", number(".3g")),
        "over measured": ("over", number(".2f")),
        "wear by the law at the measured work, µg/(m mm²)": ("wear measured", number(".3g")),
        "at the predicted": ("wear predicted", number(".3g")),
        "least": ("wear least", number(".3g")),
        "most": ("wear most", number(".3g")),
    }
    return of_columns(rows_of("experiment.csv"), columns)


TABLES = {
    one.__name__: one
    for one in (
        solvers,
        large,
        normal,
        spheres,
        creep_forces,
        kalker,
        orthotropic,
        twin_discs,
        twin_discs_mesh,
        giwm,
        wear,
        fatigue,
        fatigue_spread,
        block_order,
        fatigue_cost,
        stepping,
        balance,
        peaks,
        peaks_worn,
        hard_scenes,
        invariance,
        invariance_scenes,
        falling,
        heat,
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
        transient_wear,
        duty,
        duty_cores,
        experiment,
    )
}
