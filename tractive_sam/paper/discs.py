"""Twin discs with orthotropic friction and wear, at three angles (Figs. 9-14, 16-18).

Their wear depth is compared with the global incremental wear model (Fig. 15, Table 1).
"""

from collections.abc import Callable, Iterator, Mapping
from functools import partial

import numpy as np

from tractive_sam import plot
from tractive_sam.paper.page import (
    ANGLE_TEXT,
    ANGLES,
    Finding,
    FindingTable,
    Picture,
    Statement,
    Verdict,
    Work,
    discs,
    flat_discs,
    format_deviation,
    hertz_of,
    join,
)
from tractive_sam.reference import giwm
from tractive_sam.results import History, Record
from tractive_sam.run import roll
from tractive_sam.scene import Scene
from tractive_sam.schema import required


def roll_into_file(work: Work, scene: Scene, name: str) -> History:
    """Roll a scene, store the results in the file `name`.h5 (overwritten), and return the history.

    Raises
    ------
    RuntimeError
        If a contact was not solved.
    """

    def report(record: Record) -> None:
        work.report(f"{name}, revolution {record.revolution} of {work.size.revolutions}")

    path = work.results / f"{name}.h5"
    history = roll(scene, path, overwrite=True, progress=report)
    if not history.finished:
        raise RuntimeError(f"{path}: {history.status}; {history.message}")
    return history


def read_saved(history: History, name: str) -> np.ndarray:
    """Return a column of a history at the revolutions with stored fields."""
    return history[name][np.isin(history["revolution"], history.field_revolutions)]


def wear_depth_findings(work: Work, good: float = 0.1) -> Iterator[Finding]:
    """Yield statement, figure and table on wear depth against GIWM (Fig. 15, Table 1).

    Depths within a relative distance of `good` agree well.
    """
    scene = flat_discs(work.size)
    history = roll_into_file(work, scene, "twin-discs-isotropic")
    A, B, hertz = scene.body.A, scene.body.B, hertz_of(scene)
    course = giwm(
        load=required(scene.normal_load, "load.normal"),
        e_star=scene.material.E_star,
        radii_x=(A.radius_x, B.radius_x),
        radius_y=A.radius_y,  # B is a cylinder
        semi_axes=(hertz.a, hertz.b),
        creepage=scene.creepage.longitudinal,
        intensity=required(scene.wear, "wear").intensities[0],
        revolutions=work.size.revolutions,
    )
    saved = [N for N in history.field_revolutions.tolist() if N]
    depth = read_saved(history, "wear_max")[1:]
    both = depth / course.depth[saved] - 1
    single = 0.5 * depth / course.depth[saved] - 1
    first, last = saved[0], saved[-1]
    yield Statement(
        "Fig. 15",
        "The wear depth agrees well with the global incremental wear model (GIWM).",
        f"Of both discs together {1e3 * depth[-1]:.2f} µm at N = {last}, GIWM "
        f"{1e3 * course.depth[last]:.2f} µm ({both[-1]:+.0%}; {both[0]:+.0%} at N = {first}). "
        f"Of a single disc, half of it: {single[0]:+.0%} at N = {first}, {single[-1]:+.0%} at N = "
        f"{last}. GIWM has a mean pressure, full slip, and a half width in x that falls "
        f"to {course.a[1] / course.a[0]:.0%} in the first revolution.",
        Verdict.from_conditions(bool(np.all(abs(both) < good)), bool(np.all(abs(single) < good))),
        f"if within {good:.0%} at every stored N",
    )
    b = read_saved(history, "half_width_y")[1:]
    yield FindingTable(
        "Wear depth of both discs and half width b of the contact, computed and by GIWM (Table 1).",
        ("N", "depth, µm", "GIWM, µm", "difference", "b, mm", "GIWM, mm"),
        [
            (
                f"{N:,}",
                f"{1e3 * depth[k]:.4g}",
                f"{1e3 * course.depth[N]:.4g}",
                format_deviation(depth[k], course.depth[N]),
                f"{b[k]:.3f}",
                f"{course.b[N]:.3f}",
            )
            for k, N in enumerate(saved)
        ],
    )
    N = np.arange(course.depth.size)
    yield Picture(
        "fig-15",
        partial(plot.compare, {"computed": history}, "wear_max", {"GIWM": (N, course.depth)}),
        "Fig. 15. Largest wear depth of both discs together.",
    )
    yield Picture(
        "fig-15-half-width",
        partial(plot.compare, {"computed": history}, "half_width_y", {"GIWM": (N, course.b)}),
        "Table 1. Half width across the rolling direction, computed and by GIWM.",
    )


Histories = Mapping[float, History]
"""Histories by the angle, degrees."""


def disc_findings(work: Work) -> Iterator[Finding]:
    """Yield the statements, tables and figures on the twin discs, with the computed results."""
    histories = {
        angle: roll_into_file(work, discs(work.size, angle), f"twin-discs-{angle:.0f}")
        for angle in ANGLES
    }
    yield from _wear(histories)
    yield from _contact(histories)
    yield _slip(histories)
    yield from _forces_and_stress(histories)
    for angle, history in histories.items():
        yield _table(angle, history)
    yield from _compare_angles(histories)
    yield from _draw_each_angle(histories)


def _wear(histories: Histories, closed: float = 5e-3) -> Iterator[Finding]:
    """Yield two statements: on wear depth (Fig. 16), and on the balances of work and wear."""
    last = _last_revolution(histories)
    depth = _stack_column(histories, "wear_max")[:, 1:]
    yield Statement(
        "Fig. 16",
        "The wear depth is higher for β = 0° than for 45° or 90°.",
        f"{join(1e3 * depth[:, -1], '.2f')} µm at N = {last} for β = {ANGLE_TEXT}; "
        f"deepest for 0° at {np.sum(depth.argmax(axis=0) == 0)} of {depth.shape[1]} stored "
        "revolutions.",
        Verdict.from_conditions(bool(np.all(depth.argmax(axis=0) == 0))),
    )
    missed, unworn = (
        max(np.nanmax(abs(getattr(history, balance) - 1)) for history in histories.values())
        for balance in ("energy_balance", "wear_balance")
    )
    yield Statement(
        "Sec. 5",
        "The wear depth follows from the pressure and the slip, eq. (19).",
        "Friction must dissipate the work that drives the discs. The error of the balance of work "
        f"is at most {missed:.0e} in any computed revolution, of the worn section {unworn:.0e}.",
        Verdict.from_conditions(max(missed, unworn) < closed),
        f"if within {closed:.1%}",
    )


def _contact(histories: Histories) -> Iterator[Finding]:
    """Yield statements on half widths of the worn contact, and then on its pressure (Fig. 17)."""
    last = _last_revolution(histories)
    a, b = _stack_column(histories, "half_width_x"), _stack_column(histories, "half_width_y")
    yield Statement(
        "Fig. 17",
        "With N, the half width a in the rolling direction decreases and b across it increases.",
        f"From a = {a[0, 0]:.3f} mm, b = {b[0, 0]:.3f} mm to a = {join(a[:, -1], '.3f')} mm, "
        f"b = {join(b[:, -1], '.3f')} mm at N = {last} for β = {ANGLE_TEXT}.",
        Verdict.from_conditions(
            bool(np.all(np.diff(a) <= 0) and np.all(a[:, -1] < a[:, 0])),
            bool(np.all(np.diff(b) >= 0) and np.all(b[:, -1] > b[:, 0])),
        ),
    )
    yield Statement(
        "Fig. 17",
        "The contact is widest for β = 0°, where the wear is severest.",
        f"b is largest for 0° at {np.sum(b.argmax(axis=0) == 0)} of {b.shape[1]} stored "
        "revolutions; it is counted in full elements.",
        Verdict.from_conditions(bool(np.all(b[0] >= b[1:]) and np.all(b[0, -1] > b[1:, -1]))),
    )
    yield from _pressure(histories, b)


def _pressure(
    histories: Histories, b: np.ndarray, similar: float = 0.2, edge: float = 0.9
) -> Iterator[Finding]:
    """Yield two statements: how the pressure evolves and where its peak is (Fig. 17).

    Pressures are similar within a relative distance, and a place beyond a share of the half width
    b is at the edge.
    """
    last = _last_revolution(histories)
    # The peak contact pressure itself depends on one element at the edge.
    p = _stack_column(histories, "p_95") / histories[0.0].p0
    spread = np.ptp(p, axis=0) / p.mean(axis=0)
    worst = spread.argmax()
    yield Statement(
        "Fig. 17",
        "The pressure evolves very similarly for all three angles.",
        f"The pressure that 5 % of the load exceeds falls from {p[0, 0]:.3f} p_0 to "
        f"{join(p[:, -1], '.3f')} p_0 for β = {ANGLE_TEXT}. The three differ "
        f"by at most {spread[worst]:.0%}, at N = {_saved_revolutions(histories)[worst]}.",
        Verdict.from_conditions(bool(spread.max() < similar)),
        f"if within {similar:.0%}",
    )
    places = np.abs(_stack_column(histories, "p_max_at")[..., 1]) / b
    yield Statement(
        "Fig. 17",
        "By N = 15000 the peak contact pressure has moved from y = 0 to the edges y = ±b.",
        f"It is at |y|/b = {join(places[:, 0], '.2f')} for N = 0 and at "
        f"{join(places[:, -1], '.2f')} for N = {last}. At the edge it is a peak as "
        "wide as an element: its height depends on the mesh.",
        Verdict.from_conditions(*(bool(at[0] < 1 - edge and at[-1] > edge) for at in places)),
        f"if |y|/b is above {edge}",
    )


def _slip(histories: Histories) -> Statement:
    """Return the statement that compares the largest slip of the three angles (Fig. 18)."""
    last = _last_revolution(histories)
    saved = _saved_revolutions(histories)
    largest = np.zeros((len(histories), len(saved)))
    for row, history in zip(largest, histories.values(), strict=True):
        for k, N in enumerate(saved):
            slip = np.hypot(history.field("slip_x", N), history.field("slip_y", N))
            row[k] = slip[history.field("pressure", N) > 0.0].max()
    return Statement(
        "Fig. 18",
        "The slip |s|/V is greatest for β = 0°.",
        f"Its largest value is {join(1e3 * largest[:, 0], '.2f')} × 10⁻³ at N = 0 and "
        f"{join(1e3 * largest[:, -1], '.2f')} × 10⁻³ at N = {last}, for β = "
        f"{ANGLE_TEXT}; greatest for 0° at {np.sum(largest.argmax(axis=0) == 0)} of "
        f"{largest.shape[1]} stored revolutions.",
        Verdict.from_conditions(bool(np.all(largest.argmax(axis=0) == 0))),
    )


def _forces_and_stress(histories: Histories) -> Iterator[Finding]:
    """Yield three statements on how wear changes forces and subsurface stresses."""
    # Relative difference that is a change.
    changed = 0.02
    last = _last_revolution(histories)
    Q_x, Q_y = _stack_column(histories, "Qx_over_P"), _stack_column(histories, "Qy_over_P")
    yield Statement(
        "Abstract",
        "Wear modifies the tangential forces, and so does the angle of the tribological axes.",
        f"From N = 0 to {last}, Q_x/P goes from {join(Q_x[:, 0], '.3f')} to "
        f"{join(Q_x[:, -1], '.3f')} for β = {ANGLE_TEXT}; "
        f"for 45°, Q_y/P goes from {Q_y[1, 0]:.3f} to {Q_y[1, -1]:.3f}.",
        Verdict.from_conditions(bool(np.all(Q_x[:2, -1] / Q_x[:2, 0] - 1 > changed))),
    )
    p0 = histories[0.0].p0
    stress = _stack_column(histories, "von_mises_max") / p0
    yield Statement(
        "Abstract",
        "Wear modifies the stresses below the surface, and the place of the largest one.",
        f"The largest equivalent stress of body A goes from {join(stress[:, 0, 0], '.3f')} to "
        f"{join(stress[:, -1, 0], '.3f')} p_0 for β = {ANGLE_TEXT}, of body B from "
        f"{join(stress[:, 0, 1], '.3f')} to {join(stress[:, -1, 1], '.3f')} p_0; the tables "
        "list the places.",
        Verdict.from_conditions(bool(np.all(abs(stress[:, -1] / stress[:, 0] - 1) > changed))),
    )
    yield Statement(
        "Figs. 9-14",
        "The worn profiles, pressures, forces and stresses over the revolutions are drawn.",
        "Their curves were not compared; ours below show these quantities.",
        Verdict.OPEN,
    )


def _table(angle: float, history: History) -> FindingTable:
    """Return a table of the results at the stored revolutions for one angle of friction."""
    names = ("wear_max", "half_width_x", "half_width_y", "p_max", "p_max_at", "Qx_over_P")
    depth, a, b, p, p_at, Q_x = (read_saved(history, name) for name in names)
    Q_y = read_saved(history, "Qy_over_P")
    stress, places = (read_saved(history, name) for name in ("von_mises_max", "von_mises_max_at"))
    sizes = (history.a0, history.b0, history.a0)
    rows = [
        (
            f"{N:,}",
            f"{1e3 * depth[k]:.3g}",
            f"{a[k] / history.a0:.3f}",
            f"{b[k] / history.b0:.3f}",
            f"{p[k] / history.p0:.3f}",
            f"{abs(p_at[k, 1]) / b[k]:.2f}",
            f"{Q_x[k]:.4f}",
            f"{Q_y[k]:z.4f}",
            *(
                f"{value:.3f} at {x:z.2f}, {y:z.2f}, {depth:.2f}"
                for value, (x, y, depth) in zip(
                    stress[k] / history.p0, places[k] / sizes, strict=True
                )
            ),
        )
        for k, N in enumerate(history.field_revolutions.tolist())
    ]
    return FindingTable(
        f"Twin discs, β = {angle:g}°. Last columns: largest equivalent stress over p_0, and its "
        "place: x/a_0, y/b_0, depth/a_0; at the surface it depends on the mesh.",
        (
            "N",
            "depth, µm",
            "a/a_0",
            "b/b_0",
            "p_max/p_0",
            "at |y|/b",
            "Q_x/P",
            "Q_y/P",
            "stress in A",
            "stress in B",
        ),
        rows,
    )


def _compare_angles(histories: Histories) -> Iterator[Picture]:
    """Yield figures that compare the three angles of the friction axes."""
    named = {f"β = {angle:g}°": history for angle, history in histories.items()}
    for name, what in (
        ("wear_max", "Largest wear depth of both discs"),
        ("Qx_over_P", "Longitudinal force"),
        ("Qy_over_P", "Lateral force"),
        ("p_95", "Pressure that 5 % of the load exceeds"),
        ("half_width_x", "Half width in the rolling direction"),
        ("half_width_y", "Half width across it"),
    ):
        yield Picture(
            f"figs-09-14-{name.replace('_', '-')}",
            partial(plot.compare, named, name),
            f"Figs. 9-14. {what} over the revolutions.",
        )


def _draw_each_angle(histories: Histories) -> Iterator[Picture]:
    """Yield figures of each angle: worn profiles, pressure, stress and wear, one angle each."""
    last = _last_revolution(histories)
    draws: tuple[tuple[str, Callable, str], ...] = (
        ("figs-09-14-profiles", plot.worn_profiles, "Figs. 9-14. Worn cross-sections"),
        ("figs-09-14-pressure", plot.pressure_profiles, "Figs. 9-14. Pressure across the track"),
        ("figs-09-14-stress", plot.stress_course, "Figs. 9-14. Largest equivalent stress"),
        ("figs-09-14-stress-new", _section_at(0), "Figs. 9-14. Equivalent stress, N = 0"),
        ("figs-09-14-stress-worn", _section_at(last), f"Figs. 9-14. Equivalent stress, N = {last}"),
        ("fig-16", plot.wear_over_revolutions, "Fig. 16. Wear depth of both discs"),
        ("fig-17", plot.pressure_over_revolutions, "Fig. 17. Pressure"),
        ("fig-18", plot.slip_over_revolutions, "Fig. 18. Slip"),
    )
    for name, draw, caption in draws:
        for angle, history in histories.items():
            yield Picture(
                f"{name}-{angle:.0f}", partial(draw, history), f"{caption}, β = {angle:g}°."
            )


def _section_at(revolution: int) -> Callable:
    """Return a function that draws von Mises on x = 0 of a history at a revolution."""
    return lambda history: plot.von_mises_sections(history, "x=0", revolution=revolution)


def _stack_column(histories: Histories, name: str) -> np.ndarray:
    """Return a column of all histories at the stored revolutions, one row for each angle."""
    return np.stack([read_saved(history, name) for history in histories.values()])


def _saved_revolutions(histories: Histories) -> list[int]:
    """Return the revolutions with stored fields of the history for β = 0; all share them."""
    return histories[0.0].field_revolutions.tolist()


def _last_revolution(histories: Histories) -> int:
    """Return the last revolution with stored fields."""
    return _saved_revolutions(histories)[-1]
