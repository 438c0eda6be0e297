"""Two equal spheres: tractions and stress with isotropic and orthotropic friction.

Figs. 5 (isotropic), 7 and 8 (orthotropic at three angles).
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import Self

import numpy as np

from tractive_sam import plot
from tractive_sam.paper.page import (
    ANGLES,
    Finding,
    FindingTable,
    Picture,
    Statement,
    Verdict,
    Work,
    format_deviation,
    friction_of,
    hertz_of,
    join,
    orthotropic_spheres,
    spheres,
)
from tractive_sam.plot import StressMaximum
from tractive_sam.results import BODIES, Maximum, State
from tractive_sam.run import solve
from tractive_sam.subsurface import stress_maximum, stress_on_plane

NUMBER = 0.01
"""Relative distance within which a number agrees."""

PLANES = {"y=0": "y = 0", "y=0.75a": "y = 0.75 a_0"}
"""Planes of the figure, and their names in the paper."""


def sphere_findings(work: Work) -> Iterator[Finding]:
    """Yield the statements and figures on two spheres (Fig. 5) with the computed results."""
    work.report("two spheres")
    contact = solve(spheres(work.size))
    yield _compare_with_hertz(contact)
    yield _compare_force(contact)
    p_x = contact.traction[0].max() / (
        friction_of(contact.scene).mu[0] * hertz_of(contact.scene).p0
    )
    yield Statement(
        "Fig. 5(b)",
        "p_x along y = 0 and y = 0.75 a_0 correlates well with Manyo's solution.",
        f"The text has no numbers of these curves. Our p_x rises to {p_x:.3f} times µ p_0.",
        Verdict.OPEN,
    )
    yield _zones(contact)
    yield from _maxima(contact)
    yield Picture(
        "fig-05b", partial(plot.traction_sections, contact), "Fig. 5(b). Tractions on body A."
    )
    yield Picture("fig-05c", partial(plot.pressure, contact), "Fig. 5(c). Pressure.")
    yield Picture(
        "fig-05d",
        partial(plot.traction, contact),
        "Fig. 5(d). Traction; dashed: the stick-slip boundary.",
    )
    for letter, (plane, name) in zip("ef", PLANES.items(), strict=True):
        yield Picture(
            f"fig-05{letter}",
            partial(plot.von_mises_sections, contact, plane),
            f"Fig. 5({letter}). Equivalent stress of both bodies on {name}.",
        )


def _compare_with_hertz(contact: State) -> Statement:
    """Return the statement that compares pressure and radius with the theory of Hertz."""
    hertz, area = hertz_of(contact.scene), contact.grid.element_area
    radius = float(np.sqrt(np.count_nonzero(contact.touching) * area / np.pi))
    return Statement(
        "Sec. 8.1.1",
        "By Hertz, P = 0.4705 N gives p_0 = 0.01834 MPa over a radius a_0 = 3.5 mm.",
        f"Hertz' closed form: p_0 = {hertz.p0:.5f} MPa, a_0 = {hertz.a:.4f} mm. Computed: "
        f"p_max = {contact.p_max:.5f} MPa, and a circle of the area in contact has a radius of "
        f"{radius:.3f} mm.",
        Verdict.from_conditions(
            abs(contact.p_max / 0.01834 - 1) < NUMBER, abs(radius / 3.5 - 1) < NUMBER
        ),
        f"if within {NUMBER:.0%}",
    )


def _compare_force(contact: State, expected: float = 0.657) -> Statement:
    """Return the statement that compares Q_x/(mu P), also by upwind slip, with the paper."""
    bound = friction_of(contact.scene).mu[0] * contact.P
    force = contact.Qx / bound
    upwind = solve(contact.scene.with_set(['solver.slip="upwind"'])).Qx / bound
    return Statement(
        "Sec. 8.1.1",
        f"ξ_x = -0.0031 transmits Q_x = {expected} µP.",
        f"Q_x = {force:.4f} µP ({format_deviation(force, expected)}). With the paper's upwind slip "
        f"on this mesh {upwind:.4f} µP ({format_deviation(upwind, expected)}).",
        Verdict.from_conditions(abs(force / expected - 1) < NUMBER),
        f"if within {NUMBER:.0%}",
    )


def _zones(contact: State) -> Statement:
    """Return the statement that slip is at the back of the contact and stick at the front."""
    x = np.broadcast_to(contact.grid.x[:, None] / hertz_of(contact.scene).a, contact.pressure.shape)
    stick, slip = x[contact.sticking].mean(), x[contact.sliding].mean()
    last = [column.argmax() for column in contact.touching.T if column.any()]
    columns = np.flatnonzero(contact.touching.any(axis=0))
    trailing = np.mean(contact.sliding[last, columns])
    return Statement(
        "Fig. 5(d)",
        "The sliding zone is at the back of the contact, the adhesion zone at the front.",
        f"Centre of the stick zone at x = {stick:+.2f} a_0, of the slip zone at {slip:+.2f} a_0; "
        f"{trailing:.0%} of the trailing edge slips; {contact.stick_fraction:.0%} of the contact "
        "sticks.",
        Verdict.from_conditions(stick > slip and trailing > 0.99),
    )


@dataclass(frozen=True)
class _SectionMaxima:
    """Maxima of the von Mises stress of one body on one plane; coordinates over a.

    Attributes
    ----------
    name : str
        Plane and body.
    interior : StressMaximum or None
        Maximum inside the body.
    surface : StressMaximum
        Maximum at the surface.
    stick_end : float
        Trailing end of the stick zone.
    """

    name: str
    interior: StressMaximum | None
    surface: StressMaximum
    stick_end: float

    @classmethod
    def from_contact(cls, contact: State, plane: str, body: str) -> Self:
        """Return maxima of von Mises stress of a body on a plane, inside and surface; stick end."""
        hertz = hertz_of(contact.scene)
        p0, a = hertz.p0, hertz.a
        stress = stress_on_plane(contact, plane, body)
        axes = stress.axes["x"] / a, stress.axes["depth"] / a
        maxima = {top.kind: top for top in plot.stress_maxima(stress.von_mises / p0, axes)}
        # The trailing end of the stick zone in the nearest row; nan if no element sticks.
        row = contact.sticking[:, np.abs(contact.grid.y - stress.position).argmin()]
        end = contact.grid.x[row.argmax()] - 0.5 * contact.grid.dx if row.any() else np.nan
        name = f"{PLANES[plane]}, body {body}"
        return cls(name, maxima.get("interior"), maxima["surface"], float(end) / a)

    @property
    def cells(self) -> tuple[str, ...]:
        """Texts of the maxima and of the end of stick: a row of the table."""
        inside = self.interior
        cells = ("none", "", "")
        if inside is not None:
            cells = (f"{inside.value:.3f}", f"{inside.at[0]:+.2f}", f"{inside.at[1]:.2f}")
        surface = (f"{self.surface.value:.3f}", f"{self.surface.at[0]:+.2f}")
        return (self.name, *cells, *surface, f"{self.stick_end:+.2f}")


def _maxima(contact: State, same_place: float = 0.1) -> Iterator[Finding]:
    """Yield statements and a table on stress maxima of both planes and the stick end (Fig. 5).

    Places within a distance of `same_place` half widths a count as one.
    """
    maxima = [
        _SectionMaxima.from_contact(contact, plane, body) for plane in PLANES for body in BODIES
    ]
    both = [section.interior is not None for section in maxima]
    yield Statement(
        "Fig. 5(e-f)",
        "On y = 0 and on y = 0.75 a_0 the equivalent stress has two maxima, one inside the solid "
        "and one at its surface.",
        f"It has both in {sum(both)} of the {len(both)} sections of the table below.",
        Verdict.from_conditions(*both),
    )
    near = [abs(section.surface.at[0] - section.stick_end) < same_place for section in maxima]
    names = [section.name for section, is_near in zip(maxima, near, strict=True) if is_near]
    driven, braked = (section.cells for section in maxima[:2])
    yield Statement(
        "Fig. 5(e-f)",
        "The one at the surface is at the boundary between adhesion and sliding.",
        f"It is at the boundary on {'; '.join(names) or 'neither plane'}. On y = 0 it is at x = "
        f"{driven[5]} a_0 in body A, which friction drives, and at {braked[5]} a_0 in body B, "
        f"which it brakes; stick ends at {driven[6]} a_0.",
        Verdict.from_conditions(*near),
        f"if within {same_place} a_0",
    )
    yield FindingTable(
        "Maxima of the equivalent stress over p_0, and their places in a_0. Values at the "
        "surface depend on the mesh.",
        ("section", "inside", "at x", "at depth", "at the surface", "at x", "stick ends at x"),
        [section.cells for section in maxima],
    )


def orthotropic_findings(work: Work) -> Iterator[Finding]:
    """Yield statements, table and figures on orthotropic friction (Figs. 7, 8), as computed."""
    contacts = {}
    for angle in ANGLES:
        work.report(f"two spheres, β = {angle:g}°")
        contacts[angle] = solve(orthotropic_spheres(work.size, angle))
    yield _lateral(contacts)
    maxima = {angle: stress_maximum(contact, "A") for angle, contact in contacts.items()}
    p0 = hertz_of(contacts[0.0].scene).p0
    yield from _inside_and_surface(maxima, p0)
    yield _sides(contacts)
    yield _table(contacts, maxima)
    for draw, name, caption in (
        (plot.traction, "fig-07-map", "Fig. 7. Traction ‖p_t‖ over p_0"),
        (plot.traction_sections, "fig-07-sections", "Fig. 7. Components of the traction"),
    ):
        for angle, contact in contacts.items():
            yield Picture(
                f"{name}-{angle:.0f}", partial(draw, contact), f"{caption}, β = {angle:g}°."
            )
    for plane, name in (("y=0", "xz"), ("x=0", "yz")):
        for angle, contact in contacts.items():
            yield Picture(
                f"fig-08-{name}-{angle:.0f}",
                partial(plot.von_mises_section, contact, "A", plane),
                f"Fig. 8. Equivalent stress in body A, {name} plane, β = {angle:g}°.",
            )


def _lateral(contacts: dict[float, State]) -> Statement:
    """Return the statement that p_y is larger for β = 45° than for 0° and 90° (Fig. 7)."""
    p_y = [
        float(abs(contact.traction[1]).max() / hertz_of(contact.scene).p0)
        for contact in contacts.values()
    ]
    along, turned, across = p_y
    return Statement(
        "Fig. 7",
        "For 0° < β < 90° the traction has a component p_y.",
        f"The largest |p_y|/p_0 is {turned:.3f} for β = 45°, and {along:.3f} and {across:.3f} for "
        "0° and 90°, where only the curvature of the slip causes it.",
        Verdict.from_conditions(turned > 2 * max(along, across)),
    )


def _inside_and_surface(
    maxima: dict[float, Maximum], p0: float, expected: float = 0.6, same: float = 0.05
) -> Iterator[Finding]:
    """Yield two statements on the largest stresses: inside, and at the surface (Fig. 8).

    The paper has one digit of the stress inside over p_0; values within a relative distance of
    `same` count as unchanged.
    """
    inside = np.array([top.interior for top in maxima.values()]) / p0
    surface = np.array([top.surface for top in maxima.values()]) / p0
    yield Statement(
        "Fig. 8",
        f"The largest equivalent stress inside remains approximately the same, {expected} p_0, "
        "as β increases.",
        f"{join(inside, '.3f')} p_0: the same within {np.ptp(inside) / inside.mean():.1%}, but "
        f"nearer to {inside.mean():.2f} p_0.",
        Verdict.from_conditions(
            bool(np.ptp(inside) / inside.mean() < same),
            bool(np.all(np.round(inside, 1) == expected)),
        ),
        f"if the same within {same:.0%}, and {expected} p_0 when rounded",
    )
    yield Statement(
        "Fig. 8",
        "At the surface the stress clearly decreases as β increases; in the end only the maximum "
        "inside is left.",
        f"{join(surface, '.3f')} p_0 at the surface: for β = 90° it is "
        f"{surface[-1] / inside[-1]:.2f} of the maximum inside.",
        Verdict.from_conditions(bool(np.all(np.diff(surface) < 0)), bool(surface[-1] < inside[-1])),
    )


def _sides(contacts: dict[float, State], symmetric: float = 1e-3) -> Statement:
    """Return the statement that only β = 45° makes stress on x = 0 asymmetric in y (Fig. 8)."""
    differences = []
    for contact in contacts.values():
        values = stress_on_plane(contact, "x=0", "A").von_mises
        differences.append(float(abs(values - values[::-1]).max() / values.max()))
    along, turned, across = differences
    return Statement(
        "Fig. 8",
        "In the yz plane the stress for β = 45° is not symmetric about the xz plane.",
        f"Its two sides differ by up to {turned:.1%} of its largest value; for 0° and 90° by "
        f"{along:.0e} and {across:.0e}.",
        Verdict.from_conditions(turned > 0.01, max(along, across) < symmetric),
    )


def _table(contacts: dict[float, State], maxima: dict[float, Maximum]) -> FindingTable:
    """Return a table of the forces and the maxima of stress at each angle."""
    rows = []
    for angle, contact in contacts.items():
        top, hertz = maxima[angle], hertz_of(contact.scene)
        x, _, depth = (length / hertz.a for length in top.interior_at)
        x_surface, y_surface, _ = (length / hertz.a for length in top.surface_at)
        rows.append(
            (
                f"{angle:g}°",
                f"{contact.Qx / contact.P:.4f}",
                f"{contact.Qy / contact.P:z.4f}",
                f"{contact.stick_fraction:.0%}",
                f"{top.interior / hertz.p0:.3f}",
                f"{x:+.2f}, {depth:.2f}",
                f"{top.surface / hertz.p0:.3f}",
                f"{x_surface:+.2f}, {y_surface:z.2f}",
            )
        )
    return FindingTable(
        "Forces on body A, and the maxima of its equivalent stress over p_0; places in a_0.",
        ("β", "Q_x/P", "Q_y/P", "sticks", "inside", "at x, depth", "surface", "at x, y"),
        rows,
    )
