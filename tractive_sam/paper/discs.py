"""Twin discs with orthotropic friction and wear, at three angles (Figs. 9-14, 16-18)."""

from collections.abc import Callable, Iterator, Mapping

import numpy as np

from tractive_sam import plot
from tractive_sam.paper.finding import Finding, Picture, Statement, Table, Verdict, Work, listed
from tractive_sam.paper.rolled import at_saved, rolled
from tractive_sam.paper.scenes import ANGLES, ANGLES_TOLD, discs
from tractive_sam.results import History

SIMILAR = 0.2
"""Relative spread of peak contact pressures that are very similar."""

AT_EDGE = 0.9
"""Share of the half width b beyond which a place is at the edge."""

CLOSED = 5e-3
"""Part of the work that may be missed."""

CHANGED = 0.02
"""Relative change that is one."""

Histories = Mapping[float, History]


def find(work: Work) -> Iterator[Finding]:
    """Yield what the paper says of the twin discs, and what we find."""
    histories = {
        angle: rolled(work, discs(work.size, angle), f"twin-discs-{angle:.0f}") for angle in ANGLES
    }
    yield from _wear(histories)
    yield from _contact(histories)
    yield _slip(histories)
    yield from _forces_and_stress(histories)
    for angle, history in histories.items():
        yield _table(angle, history)
    yield from _compared(histories)
    yield from _one_by_one(histories)


def _wear(histories: Histories) -> Iterator[Finding]:
    depth = _of_all(histories, "wear_max")[:, 1:]
    yield Statement(
        "Fig. 16",
        "The depth worn is higher for β = 0° than for 45° or 90°.",
        f"{listed(1e3 * depth[:, -1], '.2f')} µm at N = {_last(histories)} for β = {ANGLES_TOLD}; "
        f"deepest for 0° at {np.sum(depth.argmax(axis=0) == 0)} of {depth.shape[1]} stored "
        "revolutions.",
        Verdict.of(bool(np.all(depth.argmax(axis=0) == 0))),
    )
    missed, unworn = (
        max(np.nanmax(abs(getattr(history, balance) - 1)) for history in histories.values())
        for balance in ("energy_balance", "wear_balance")
    )
    yield Statement(
        "Sec. 5",
        "The depth worn follows from the pressure and the slip, eq. (19).",
        "Friction must dissipate the work that drives the discs. It misses at most "
        f"{missed:.0e} of it in any revolution computed, and the worn section {unworn:.0e} of what "
        "that work wears.",
        Verdict.of(max(missed, unworn) < CLOSED),
        f"if within {CLOSED:.1%}",
    )


def _contact(histories: Histories) -> Iterator[Finding]:
    a, b = _of_all(histories, "half_width_x"), _of_all(histories, "half_width_y")
    yield Statement(
        "Fig. 17",
        "With N, the half width a in the rolling direction decreases and b across it increases.",
        f"From a = {a[0, 0]:.3f} mm, b = {b[0, 0]:.3f} mm to a = {listed(a[:, -1], '.3f')} mm, "
        f"b = {listed(b[:, -1], '.3f')} mm at N = {_last(histories)} for β = {ANGLES_TOLD}.",
        Verdict.of(
            bool(np.all(np.diff(a) <= 0) and np.all(a[:, -1] < a[:, 0])),
            bool(np.all(np.diff(b) >= 0) and np.all(b[:, -1] > b[:, 0])),
        ),
    )
    yield Statement(
        "Fig. 17",
        "The contact is widest for β = 0°, where the wear is severest.",
        f"b is largest for 0° at {np.sum(b.argmax(axis=0) == 0)} of {b.shape[1]} stored "
        "revolutions; it counts whole elements.",
        Verdict.of(bool(np.all(b[0] >= b[1:]) and np.all(b[0, -1] > b[1:, -1]))),
    )
    # The peak contact pressure itself hinges on one element at the rim.
    p = _of_all(histories, "p_95") / histories[0.0].p0
    spread = np.ptp(p, axis=0) / p.mean(axis=0)
    worst = spread.argmax()
    yield Statement(
        "Fig. 17",
        "The pressure evolves very similarly for all three angles.",
        f"The pressure that 5 % of the load exceeds falls from {p[0, 0]:.3f} p_0 to "
        f"{listed(p[:, -1], '.3f')} p_0 for β = {ANGLES_TOLD}. The three differ "
        f"by at most {spread[worst]:.0%}, at N = {_saved(histories)[worst]}.",
        Verdict.of(bool(spread.max() < SIMILAR)),
        f"if within {SIMILAR:.0%}",
    )
    places = np.abs(_of_all(histories, "p_max_at")[..., 1]) / b
    yield Statement(
        "Fig. 17",
        "By N = 15000 the peak contact pressure has moved from y = 0 to the edges y = ±b.",
        f"It is at |y|/b = {listed(places[:, 0], '.2f')} for N = 0 and at "
        f"{listed(places[:, -1], '.2f')} for N = {_last(histories)}. At the edge it is a peak as "
        "wide as an element: its height depends on the mesh.",
        Verdict.of(
            *(bool(at[0] < 1 - AT_EDGE and at[-1] > AT_EDGE) for at in places),
        ),
        f"if |y|/b is above {AT_EDGE}",
    )


def _slip(histories: Histories) -> Statement:
    largest = np.array(
        [[_largest_slip(history, N) for N in _saved(histories)] for history in histories.values()]
    )
    return Statement(
        "Fig. 18",
        "The slip |s|/V is greatest for β = 0°.",
        f"Its largest value is {listed(1e3 * largest[:, 0], '.2f')} × 10⁻³ at N = 0 and "
        f"{listed(1e3 * largest[:, -1], '.2f')} × 10⁻³ at N = {_last(histories)}, for β = "
        f"{ANGLES_TOLD}; greatest for 0° at {np.sum(largest.argmax(axis=0) == 0)} of "
        f"{largest.shape[1]} stored revolutions.",
        Verdict.of(bool(np.all(largest.argmax(axis=0) == 0))),
    )


def _largest_slip(history: History, revolution: int) -> float:
    touching = history.field("pressure", revolution) > 0.0
    slip = np.hypot(history.field("slip_x", revolution), history.field("slip_y", revolution))
    return float(slip[touching].max())


def _forces_and_stress(histories: Histories) -> Iterator[Finding]:
    Q_x, Q_y = _of_all(histories, "Qx_over_P"), _of_all(histories, "Qy_over_P")
    yield Statement(
        "Abstract",
        "Wear modifies the tangential forces, and so does the angle of the tribological axes.",
        f"From N = 0 to {_last(histories)}, Q_x/P goes from {listed(Q_x[:, 0], '.3f')} to "
        f"{listed(Q_x[:, -1], '.3f')} for β = {ANGLES_TOLD}; "
        f"for 45°, Q_y/P goes from {Q_y[1, 0]:.3f} to {Q_y[1, -1]:.3f}.",
        Verdict.of(bool(np.all(Q_x[:2, -1] / Q_x[:2, 0] - 1 > CHANGED))),
    )
    p0 = histories[0.0].p0
    stress = _of_all(histories, "von_mises_max") / p0
    yield Statement(
        "Abstract",
        "Wear modifies the stresses below the surface, and where they are largest.",
        f"The largest equivalent stress of body A goes from {listed(stress[:, 0, 0], '.3f')} to "
        f"{listed(stress[:, -1, 0], '.3f')} p_0 for β = {ANGLES_TOLD}, that of body B from "
        f"{listed(stress[:, 0, 1], '.3f')} to {listed(stress[:, -1, 1], '.3f')} p_0; the tables "
        "say where.",
        Verdict.of(bool(np.all(abs(stress[:, -1] / stress[:, 0] - 1) > CHANGED))),
    )
    yield Statement(
        "Figs. 9-14",
        "The worn profiles, pressures, forces and stresses over the revolutions are drawn.",
        "Their curves were not compared; ours below show the same quantities.",
        Verdict.OPEN,
    )


def _table(angle: float, history: History) -> Table:
    names = ("wear_max", "half_width_x", "half_width_y", "p_max", "p_max_at", "Qx_over_P")
    depth, a, b, p, p_at, Q_x = (at_saved(history, name) for name in names)
    Q_y = at_saved(history, "Qy_over_P")
    stress, places = (at_saved(history, name) for name in ("von_mises_max", "von_mises_max_at"))
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
                _stressed(history, value, at)
                for value, at in zip(stress[k], places[k], strict=True)
            ),
        )
        for k, N in enumerate(history.field_revolutions.tolist())
    ]
    return Table(
        f"Twin discs, β = {angle:g}°. Last columns: largest equivalent stress over p_0, and where: "
        "x/a_0, y/b_0, depth/a_0; at the surface it depends on the mesh.",
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


def _stressed(history: History, value: float, at: np.ndarray) -> str:
    x, y, depth = at / (history.a0, history.b0, history.a0)
    return f"{value / history.p0:.3f} at {x:z.2f}, {y:z.2f}, {depth:.2f}"


def _compared(histories: Histories) -> Iterator[Picture]:
    named = {f"β = {angle:g}°": history for angle, history in histories.items()}
    for name, what in (
        ("wear_max", "Largest depth worn off both discs"),
        ("Qx_over_P", "Longitudinal force"),
        ("Qy_over_P", "Lateral force"),
        ("p_95", "Pressure that 5 % of the load exceeds"),
        ("half_width_x", "Half width in the rolling direction"),
        ("half_width_y", "Half width across it"),
    ):
        yield Picture(
            f"figs-09-14-{name.replace('_', '-')}",
            plot.compare(named, name),
            f"Figs. 9-14. {what} over the revolutions.",
        )


def _one_by_one(histories: Histories) -> Iterator[Picture]:
    """Figures of one angle each."""
    last = _last(histories)
    draws: tuple[tuple[str, Callable, str], ...] = (
        ("figs-09-14-profiles", plot.worn_profiles, "Figs. 9-14. Worn cross-sections"),
        ("figs-09-14-pressure", plot.pressure_profiles, "Figs. 9-14. Pressure across the track"),
        ("figs-09-14-stress", plot.stress_course, "Figs. 9-14. Largest equivalent stress"),
        ("figs-09-14-stress-new", _section(0), "Figs. 9-14. Equivalent stress, N = 0"),
        ("figs-09-14-stress-worn", _section(last), f"Figs. 9-14. Equivalent stress, N = {last}"),
        ("fig-16", plot.wear_over_revolutions, "Fig. 16. Depth worn off both discs"),
        ("fig-17", plot.pressure_over_revolutions, "Fig. 17. Pressure"),
        ("fig-18", plot.slip_over_revolutions, "Fig. 18. Slip"),
    )
    for name, draw, caption in draws:
        for angle, history in histories.items():
            yield Picture(f"{name}-{angle:.0f}", draw(history), f"{caption}, β = {angle:g}°.")


def _section(revolution: int) -> Callable:
    return lambda history: plot.von_mises_sections(history, "x=0", revolution=revolution)


def _of_all(histories: Histories, name: str) -> np.ndarray:
    """What was recorded under a name at the stored revolutions, one row an angle."""
    return np.stack([at_saved(history, name) for history in histories.values()])


def _saved(histories: Histories) -> list[int]:
    return histories[0.0].field_revolutions.tolist()


def _last(histories: Histories) -> int:
    return _saved(histories)[-1]
