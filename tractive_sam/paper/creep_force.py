"""Transmitted force against creepage, isotropic and orthotropic friction (Fig. 6)."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from tractive_sam import plot
from tractive_sam.mechanics import full_slip_force
from tractive_sam.paper.finding import (
    Finding,
    Picture,
    Statement,
    Table,
    Verdict,
    Work,
    listed,
)
from tractive_sam.paper.scenes import ANGLES, ANGLES_TOLD, orthotropic_spheres, spheres
from tractive_sam.reference import (
    creep_parameter,
    kalker_simplified,
    linear_creep_forces,
    vermeulen_johnson,
)
from tractive_sam.results import State
from tractive_sam.run import solve
from tractive_sam.scene import Scene

LAST = 1.3
"""Largest creep parameter: full slip is reached at about 1."""

AT = (0.05, 0.2, 0.5, 0.8)
"""Creep parameters of the table over meshes."""

VERY_HIGH = 0.01
"""Relative distance of two curves that agree very well."""

STICKS = 0.01
"""Share of the contact below which nothing sticks."""

NOTHING = 1e-6
"""Force over mu1 P that is zero: far above what the solver leaves."""


def find(work: Work) -> Iterator[Finding]:
    """Yield what the paper says of Fig. 6, and what we find."""
    yield from _isotropic(work)
    yield from _orthotropic(work)


def _isotropic(work: Work) -> Iterator[Finding]:
    scene = spheres(work.size)
    xi = np.linspace(0.05, LAST, work.size.creepages)
    work.tell("creep-force curve, isotropic")
    Q_x, Q_y, _ = _curve(scene, xi)
    rises = np.all(np.diff(Q_x[xi < 1]) > 0) and abs(Q_x[-1] - 1) < 1e-2
    yield Statement(
        "Fig. 6(a)",
        "Q_x increases with the creep parameter ξ until it reaches a constant value; Q_y = 0.",
        f"Q_x rises at every step to {Q_x[-1]:.4f} µP at ξ = {LAST}; the largest |Q_y| is "
        f"{abs(Q_y).max():.0e} µP.",
        Verdict.of(rises and abs(Q_y).max() < NOTHING),
    )
    below = np.linspace(0.0, 1.0, 101)[1:-1]
    above = vermeulen_johnson(below) / kalker_simplified(below) - 1
    yield Statement(
        "Sec. 8.1.1",
        "Vermeulen & Johnson predict more than Kalker for every ξ (after Zaazaa & Schwab).",
        f"Eq. (41) is above eq. (42) at all of {below.size} points between 0 and 1, by up to "
        f"{above.max():.1%}.",
        Verdict.of(np.all(above > 0)),
    )
    yield _against_kalker(scene, xi, Q_x)
    yield _over_meshes(work)
    yield Picture(
        "fig-06a",
        plot.creep_force_curve({"computed": (xi, Q_x)}),
        f"Fig. 6(a). Creep-force curve of two equal spheres, {work.size.spheres} × "
        f"{work.size.spheres} elements.",
    )


def _against_kalker(scene: Scene, xi: np.ndarray, Q_x: np.ndarray) -> Statement:
    partial = xi < 1
    deviation = Q_x[partial] / kalker_simplified(xi[partial]) - 1
    worst = abs(deviation).argmax()
    material, mu, a = scene.material, scene.friction.mu[0], scene.hertz.a
    small = 1e-3
    linear = linear_creep_forces(a, a, material.shear, material.poisson, xi_x=-small / _unit(scene))
    slope = kalker_simplified(small) * mu * scene.load.normal / linear.Fx
    return Statement(
        "Fig. 6(a)",
        "Our numerical results agree very well with Kalker's curve, eq. (42).",
        f"They lie {deviation[worst]:+.1%} from it at ξ = {xi[worst]:.2f}, and come nearer up to "
        f"{deviation[-1]:+.1%} at ξ = {xi[partial][-1]:.2f}. Eq. (42) is a simplified theory: its "
        f"slope at the origin is {slope:.3f} of that of Kalker's own exact linear theory (his "
        f"coefficient C_11), to which the solution on the half-space tends.",
        Verdict.of(abs(deviation[worst]) < VERY_HIGH),
        f"if within {VERY_HIGH:.0%}",
    )


def _over_meshes(work: Work) -> Table:
    columns = []
    for elements in work.size.meshes:
        work.tell(f"creep-force curve, {elements} × {elements} elements")
        columns.append(_curve(spheres(work.size, elements), np.array(AT))[0])
    formulas = kalker_simplified(AT), vermeulen_johnson(AT)
    rows = zip((f"{xi:g}" for xi in AT), *(_cells(c) for c in (*columns, *formulas)), strict=True)
    heads = (f"{n} × {n}" for n in work.size.meshes)
    return Table(
        "Q_x/(µP): the mesh-converged curve beside both formulas.",
        ("ξ", *heads, "eq. (42)", "eq. (41)"),
        list(rows),
    )


def _cells(values: Sequence[float]) -> list[str]:
    return [f"{value:.4f}" for value in values]


def _orthotropic(work: Work) -> Iterator[Finding]:
    xi = np.linspace(0.05, LAST, work.size.creepages)
    curves, share, sliding_from = {}, {}, {}
    for angle in ANGLES:
        work.tell(f"creep-force curve, β = {angle:g}°")
        scene = orthotropic_spheres(work.size, angle)
        *forces, stick = _curve(scene, xi)
        curves[angle] = forces
        mu, P = scene.friction.mu, scene.load.normal
        full = full_slip_force(P, mu, np.radians(angle), (-1.0, 0.0))
        share[angle] = np.array(full) / (mu[0] * P)
        sliding_from[angle] = float(xi[np.argmax(stick < STICKS)])
    ends = {angle: np.array(forces)[:, -1] for angle, forces in curves.items()}
    starts = list(sliding_from.values())
    yield Statement(
        "Fig. 6(b)",
        "The lower the effective friction (the larger β), the sooner the contact slides.",
        f"Less than {STICKS:.0%} of it sticks from ξ = {listed(starts, '.2f')} on, for β = "
        f"{ANGLES_TOLD}, at the {work.size.creepages} points computed.",
        Verdict.of(all(first > second for first, second in pairwise(starts))),
    )
    last = np.array(curves[45.0])[:, -2:]
    yield Statement(
        "Fig. 6(b)",
        "In all cases Q_x increases until it reaches a constant value, as the contact slides.",
        f"At ξ = {LAST}, Q_x is {listed([ends[one][0] / share[one][0] for one in ANGLES], '.4f')} "
        f"of the closed form for uniform sliding, for β = {ANGLES_TOLD}. For 45° the elastic slip "
        "still turns the direction of sliding from place to place: over the last step, Q_x changes "
        f"by {last[0, 1] / last[0, 0] - 1:+.2%} and Q_y by {last[1, 1] / last[1, 0] - 1:+.2%}.",
        Verdict.of(*(ends[one][0] / share[one][0] > 1 - VERY_HIGH for one in ANGLES)),
        f"if within {VERY_HIGH:.0%} of it",
    )
    values = [ends[angle][0] for angle in ANGLES]
    yield Statement(
        "Fig. 6(b)",
        "Q_x decreases with the effective friction coefficient in the rolling direction.",
        f"Q_x/(µ_1 P) = {listed(values, '.3f')} at ξ = {LAST} for β = {ANGLES_TOLD}; uniform "
        f"sliding in the closed form gives {listed([share[angle][0] for angle in ANGLES], '.3f')}.",
        Verdict.of(values[0] > values[1] > values[2]),
    )
    ratio = ends[90.0][0] / ends[0.0][0]
    yield Statement(
        "Sec. 8.1.2",
        "At full slip, Q_x(β = 90°) = Q_x(β = 0°)/2.",
        f"The ratio is {ratio:.5f}.",
        Verdict.of(abs(ratio / 0.5 - 1) < VERY_HIGH),
        f"if within {VERY_HIGH:.0%}",
    )
    lateral = {angle: float(abs(curves[angle][1]).max()) for angle in ANGLES}
    yield Statement(
        "Sec. 8.1.2",
        "Q_y is zero for β = 0° and 90°, and not for 45°.",
        f"The largest |Q_y|/(µ_1 P) is {lateral[0.0]:.0e} and {lateral[90.0]:.0e}, and "
        f"{lateral[45.0]:.3f} for 45° (uniform sliding in the closed form: {share[45.0][1]:.3f}).",
        Verdict.of(max(lateral[0.0], lateral[90.0]) < NOTHING, lateral[45.0] > 1e-2),
    )
    series = {f"$Q_x$, {angle:g}°": (xi, curves[angle][0]) for angle in ANGLES}
    series["$Q_y$, 45°"] = xi, curves[45.0][1]
    yield Picture(
        "fig-06b",
        plot.creep_force_curve(series, theory=False),
        "Fig. 6(b). Creep-force curves with orthotropic friction for three angles β; µ stands for "
        "µ_1. Q_y is zero for 0° and 90°.",
    )


def _unit(scene: Scene) -> float:
    """Creep parameter, eq. (40), of a creepage of -1."""
    material = scene.material
    return float(
        creep_parameter(
            -1.0,
            shear=material.shear,
            a=scene.hertz.a,
            mu=scene.friction.mu[0],
            load=scene.load.normal,
            poisson=material.poisson,
        )
    )


def _curve(scene: Scene, xi: np.ndarray) -> np.ndarray:
    """Forces Q_x, Q_y over mu1 P at creep parameters, and what sticks, shape (3, n)."""
    unit, scale = _unit(scene), scene.friction.mu[0] * scene.load.normal
    forces, neighbour = [], None
    for parameter in xi:
        at = scene.replace(**{"creepage.longitudinal": -parameter / unit})
        neighbour: State = solve(at, start=neighbour)
        forces.append((neighbour.Qx / scale, neighbour.Qy / scale, neighbour.stick_fraction))
    return np.transpose(forces)
