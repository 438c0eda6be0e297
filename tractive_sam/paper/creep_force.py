"""Transmitted force against creepage, isotropic and orthotropic friction (Fig. 6)."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np

from tractive_sam import plot
from tractive_sam.mechanics import full_slip_force
from tractive_sam.paper.page import (
    ANGLE_TEXT,
    ANGLES,
    Finding,
    FindingTable,
    Picture,
    Statement,
    Verdict,
    Work,
    friction_bound,
    friction_of,
    hertz_of,
    join,
    orthotropic_spheres,
    spheres,
)
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

VERY_WELL = 0.01
"""Relative distance of two curves that agree very well."""

NOTHING = 1e-6
"""Force over mu1 P that is zero: far above the errors of the solver."""


def creep_force_findings(work: Work) -> Iterator[Finding]:
    """Yield the statements and figures for Fig. 6 of the paper with the computed results."""
    yield from _isotropic(work)
    yield from _orthotropic(work)


def _isotropic(work: Work) -> Iterator[Finding]:
    """Solve isotropic creep-force curves; yield statements, a table of meshes and Fig. 6(a)."""
    scene = spheres(work.size)
    xi = np.linspace(0.05, LAST, work.size.creepages)
    work.report("creep-force curve, isotropic")
    Q_x, Q_y, _ = _solve_curve(scene, xi)
    rises = np.all(np.diff(Q_x[xi < 1]) > 0) and abs(Q_x[-1] - 1) < 1e-2
    yield Statement(
        "Fig. 6(a)",
        "Q_x increases with the creep parameter ξ until it reaches a constant value; Q_y = 0.",
        f"Q_x rises at every step to {Q_x[-1]:.4f} µP at ξ = {LAST}; the largest |Q_y| is "
        f"{abs(Q_y).max():.0e} µP.",
        Verdict.from_conditions(rises and abs(Q_y).max() < NOTHING),
    )
    below = np.linspace(0.0, 1.0, 101)[1:-1]
    above = vermeulen_johnson(below) / kalker_simplified(below) - 1
    yield Statement(
        "Sec. 8.1.1",
        "Vermeulen & Johnson predict more than Kalker for every ξ (after Zaazaa & Schwab).",
        f"Eq. (41) is above eq. (42) at all of {below.size} points between 0 and 1, by up to "
        f"{above.max():.1%}.",
        Verdict.from_conditions(np.all(above > 0)),
    )
    yield _compare_with_kalker(scene, xi, Q_x)
    yield _compare_meshes(work)
    yield Picture(
        "fig-06a",
        partial(plot.creep_force_curve, {"computed": (xi, Q_x)}),
        f"Fig. 6(a). Creep-force curve of two equal spheres, {work.size.spheres} × "
        f"{work.size.spheres} elements.",
    )


def _compare_with_kalker(scene: Scene, xi: np.ndarray, Q_x: np.ndarray) -> Statement:
    """Return the statement comparing Q_x for xi < 1 with Kalker's simplified curve, eq. (42)."""
    partial = xi < 1
    deviation = Q_x[partial] / kalker_simplified(xi[partial]) - 1
    worst = abs(deviation).argmax()
    material, a, bound = scene.material, hertz_of(scene).a, friction_bound(scene)
    small = 1e-3
    linear = linear_creep_forces(
        a, a, material.shear, material.poisson, xi_x=-small / _creep_unit(scene)
    )
    slope = kalker_simplified(small) * bound / linear.Fx
    return Statement(
        "Fig. 6(a)",
        "Our numerical results agree very well with Kalker's curve, eq. (42).",
        f"The deviation is {deviation[worst]:+.1%} at ξ = {xi[worst]:.2f}, and decreases to "
        f"{deviation[-1]:+.1%} at ξ = {xi[partial][-1]:.2f}. Eq. (42) is a simplified theory: its "
        f"slope at the origin is {slope:.3f} of the slope of Kalker's exact linear theory (his "
        f"coefficient C_11), to which the solution on the half-space tends.",
        Verdict.from_conditions(abs(deviation[worst]) < VERY_WELL),
        f"if within {VERY_WELL:.0%}",
    )


def _compare_meshes(work: Work) -> FindingTable:
    """Return a table of the creep-force curve on several meshes beside both formulas."""
    parameters, columns = (0.05, 0.2, 0.5, 0.8), []
    for elements in work.size.meshes:
        work.report(f"creep-force curve, {elements} × {elements} elements")
        columns.append(_solve_curve(spheres(work.size, elements), np.array(parameters))[0])
    formulas = kalker_simplified(parameters), vermeulen_johnson(parameters)
    cells = [[f"{value:.4f}" for value in column] for column in (*columns, *formulas)]
    rows = zip((f"{xi:g}" for xi in parameters), *cells, strict=True)
    heads = (f"{n} × {n}" for n in work.size.meshes)
    return FindingTable(
        "Q_x/(µP): the mesh-converged curve and both formulas.",
        ("ξ", *heads, "eq. (42)", "eq. (41)"),
        list(rows),
    )


@dataclass(frozen=True, eq=False)
class _AngleCurve:
    """Creep-force curve of orthotropic friction at one angle of its axes.

    Attributes
    ----------
    forces : ndarray, shape (2, n)
        Q_x and Q_y over mu1 P.
    full_slip : ndarray, shape (2,)
        Forces of uniform sliding over mu1 P, in closed form.
    sliding_from : float
        First creep parameter at which less than 1 % of the contact sticks.
    """

    forces: np.ndarray
    full_slip: np.ndarray
    sliding_from: float

    @property
    def share(self) -> float:
        """Ratio of the last Q_x of the curve to Q_x of uniform sliding."""
        return self.forces[0, -1] / self.full_slip[0]


def _orthotropic(work: Work) -> Iterator[Finding]:
    """Solve creep-force curves for three friction angles; yield statements and Fig. 6(b)."""
    xi, curves = np.linspace(0.05, LAST, work.size.creepages), {}
    for angle in ANGLES:
        work.report(f"creep-force curve, β = {angle:g}°")
        scene = orthotropic_spheres(work.size, angle)
        Q_x, Q_y, stick = _solve_curve(scene, xi)
        mu, P = friction_of(scene).mu, hertz_of(scene).load
        force = full_slip_force(P, mu, np.radians(angle), (-1.0, 0.0))
        sliding_from = float(xi[np.argmax(stick < 0.01)])
        curves[angle] = _AngleCurve(
            np.array([Q_x, Q_y]), np.array(force) / (mu[0] * P), sliding_from
        )
    yield from _compare_sliding(curves, work.size.creepages)
    yield from _compare_angles(curves)
    series = {f"$Q_x$, {angle:g}°": (xi, curves[angle].forces[0]) for angle in ANGLES}
    series["$Q_y$, 45°"] = xi, curves[45.0].forces[1]
    yield Picture(
        "fig-06b",
        partial(plot.creep_force_curve, series, theory=False),
        "Fig. 6(b). Creep-force curves with orthotropic friction for three angles β; µ stands for "
        "µ_1. Q_y is zero for 0° and 90°.",
    )


def _compare_sliding(curves: Mapping[float, _AngleCurve], points: int) -> Iterator[Statement]:
    """Yield the statements on the creepage at which the contact slides, at three angles."""
    starts = [curve.sliding_from for curve in curves.values()]
    yield Statement(
        "Fig. 6(b)",
        "The lower the effective friction (the larger β), the sooner the contact slides.",
        f"Less than 1% of it sticks from ξ = {join(starts, '.2f')} on, for β = "
        f"{ANGLE_TEXT}, at the {points} points computed.",
        Verdict.from_conditions(all(first > second for first, second in pairwise(starts))),
    )
    (x_before, x_last), (y_before, y_last) = curves[45.0].forces[:, -2:]
    shares = [curve.share for curve in curves.values()]
    yield Statement(
        "Fig. 6(b)",
        "In all cases Q_x increases until it reaches a constant value, as the contact slides.",
        f"At ξ = {LAST}, Q_x is {join(shares, '.4f')} of the closed form for uniform "
        f"sliding, for β = {ANGLE_TEXT}. For 45° the direction of sliding still varies over the "
        f"contact, due to the elastic slip: over the last step, Q_x changes by "
        f"{x_last / x_before - 1:+.2%} and Q_y by {y_last / y_before - 1:+.2%}.",
        Verdict.from_conditions(*(share > 1 - VERY_WELL for share in shares)),
        f"if within {VERY_WELL:.0%} of it",
    )


def _compare_angles(curves: Mapping[float, _AngleCurve]) -> Iterator[Statement]:
    """Yield the statements that compare Q_x and Q_y at the three angles of friction."""
    values = [curve.forces[0, -1] for curve in curves.values()]
    uniform = [curve.full_slip[0] for curve in curves.values()]
    yield Statement(
        "Fig. 6(b)",
        "Q_x decreases with the effective friction coefficient in the rolling direction.",
        f"Q_x/(µ_1 P) = {join(values, '.3f')} at ξ = {LAST} for β = {ANGLE_TEXT}; uniform "
        f"sliding in the closed form gives {join(uniform, '.3f')}.",
        Verdict.from_conditions(values[0] > values[1] > values[2]),
    )
    ratio = values[2] / values[0]
    yield Statement(
        "Sec. 8.1.2",
        "At full slip, Q_x(β = 90°) = Q_x(β = 0°)/2.",
        f"The ratio is {ratio:.5f}.",
        Verdict.from_conditions(abs(ratio / 0.5 - 1) < VERY_WELL),
        f"if within {VERY_WELL:.0%}",
    )
    lateral = {angle: float(abs(curve.forces[1]).max()) for angle, curve in curves.items()}
    yield Statement(
        "Sec. 8.1.2",
        "Q_y is zero for β = 0° and 90°, and not for 45°.",
        f"The largest |Q_y|/(µ_1 P) is {lateral[0.0]:.0e} and {lateral[90.0]:.0e}, and "
        f"{lateral[45.0]:.3f} for 45° (uniform sliding in the closed form: "
        f"{curves[45.0].full_slip[1]:.3f}).",
        Verdict.from_conditions(max(lateral[0.0], lateral[90.0]) < NOTHING, lateral[45.0] > 1e-2),
    )


def _creep_unit(scene: Scene) -> float:
    """Return the creep parameter xi, eq. (40), of a creepage of -1 in a scene."""
    material = scene.material
    parameter = creep_parameter(
        -1.0,
        shear=material.shear,
        a=hertz_of(scene).a,
        mu=friction_of(scene).mu[0],
        load=hertz_of(scene).load,
        poisson=material.poisson,
    )
    return float(parameter)


def _solve_curve(scene: Scene, xi: np.ndarray) -> np.ndarray:
    """Solve a scene at creep parameters; return rows Q_x/(mu1 P), Q_y/(mu1 P), stick fraction."""
    unit, scale = _creep_unit(scene), friction_bound(scene)
    rows: list[tuple[float, float, float]] = []
    contact: State | None = None
    for parameter in xi:
        creeping = scene.replace(**{"creepage.longitudinal": -parameter / unit})
        contact = solve(creeping, start=contact)
        rows.append((contact.Qx / scale, contact.Qy / scale, contact.stick_fraction))
    return np.transpose(rows)
