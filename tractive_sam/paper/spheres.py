"""Two equal spheres with isotropic friction: tractions and the stress they cause (Fig. 5)."""

from collections.abc import Iterator

import numpy as np

from tractive_sam import plot
from tractive_sam.paper.finding import Finding, Picture, Statement, Table, Verdict, Work, percent
from tractive_sam.paper.scenes import spheres
from tractive_sam.plot import stress_maxima
from tractive_sam.results import State
from tractive_sam.run import solve
from tractive_sam.subsurface import stress_on_plane

PAPER_FORCE = 0.657
"""Q_x/(mu P) of the paper."""

NUMBER = 0.01
"""Relative distance within which a number agrees."""

RULE = f"if within {NUMBER:.0%}"

NEARBY = 0.1
"""Distance, in half widths a, within which two places are the same."""

PLANES = {"y=0": "y = 0", "y=0.75a": "y = 0.75 a_0"}
"""Planes of the figure, and how they are written."""


def find(work: Work) -> Iterator[Finding]:
    """Yield what the paper says of Fig. 5, and what we find."""
    scene = spheres(work.size)
    work.tell("two spheres")
    contact = solve(scene)
    mu, hertz = scene.friction.mu[0], scene.hertz
    force = contact.Qx / (mu * contact.P)
    upwind = solve(scene.with_set(['solver.slip="upwind"']))
    force_upwind = upwind.Qx / (mu * upwind.P)

    radius = float(np.sqrt(np.count_nonzero(contact.touching) * contact.grid.element_area / np.pi))
    yield Statement(
        "Sec. 8.1.1",
        "By Hertz, P = 0.4705 N gives p_0 = 0.01834 MPa over a radius a_0 = 3.5 mm.",
        f"Hertz' closed form: p_0 = {hertz.p0:.5f} MPa, a_0 = {hertz.a:.4f} mm. Computed: "
        f"p_max = {contact.p_max:.5f} MPa, and a circle of the area in contact has a radius of "
        f"{radius:.3f} mm.",
        Verdict.of(
            abs(contact.p_max / 0.01834 - 1) < NUMBER,
            abs(radius / 3.5 - 1) < NUMBER,
        ),
        RULE,
    )
    yield Statement(
        "Sec. 8.1.1",
        "ξ_x = -0.0031 transmits Q_x = 0.657 µP.",
        f"Q_x = {force:.4f} µP ({percent(force, PAPER_FORCE)}). With the paper's upwind slip on "
        f"the same mesh {force_upwind:.4f} µP "
        f"({percent(force_upwind, PAPER_FORCE)}).",
        Verdict.of(abs(force / PAPER_FORCE - 1) < NUMBER),
        RULE,
    )
    p_x = contact.traction[0].max() / (mu * hertz.p0)
    yield Statement(
        "Fig. 5(b)",
        "p_x along y = 0 and y = 0.75 a_0 correlates well with Manyo's solution.",
        f"The text has no numbers of these curves. Our p_x rises to {p_x:.3f} times µ p_0.",
        Verdict.OPEN,
    )
    yield _zones(contact)
    yield from _maxima(contact)

    yield Picture("fig-05b", plot.traction_sections(contact), "Fig. 5(b). Tractions on body A.")
    yield Picture("fig-05c", plot.pressure(contact), "Fig. 5(c). Pressure.")
    yield Picture(
        "fig-05d", plot.traction(contact), "Fig. 5(d). Traction; dashed: the stick-slip boundary."
    )
    for letter, (plane, told) in zip("ef", PLANES.items(), strict=True):
        yield Picture(
            f"fig-05{letter}",
            plot.von_mises_sections(contact, plane),
            f"Fig. 5({letter}). Equivalent stress of both bodies on {told}.",
        )


def _zones(contact: State) -> Statement:
    x = np.broadcast_to(contact.grid.x[:, None] / contact.scene.hertz.a, contact.pressure.shape)
    stick, slip = x[contact.sticking].mean(), x[contact.sliding].mean()
    last = [column.argmax() for column in contact.touching.T if column.any()]
    columns = np.flatnonzero(contact.touching.any(axis=0))
    trailing = np.mean(contact.sliding[last, columns])
    return Statement(
        "Fig. 5(d)",
        "The sliding zone is at the back of the contact, that of adhesion at the front.",
        f"Centre of the stick zone at x = {stick:+.2f} a_0, of the slip zone at {slip:+.2f} a_0; "
        f"{trailing:.0%} of the trailing edge slips; {contact.stick_fraction:.0%} of the contact "
        "sticks.",
        Verdict.of(stick > slip and trailing > 0.99),
    )


def _maxima(contact: State) -> Iterator[Finding]:
    """Maxima on both planes, inside and at the surface, and where stick ends there."""
    p0, a = contact.scene.hertz.p0, contact.scene.hertz.a
    rows, both, at_border = [], [], {}
    for plane, told in PLANES.items():
        for body in "AB":
            stress = stress_on_plane(contact, plane, body)
            axes = stress.axes["x"] / a, stress.axes["depth"] / a
            found = {top.kind: top for top in stress_maxima(stress.von_mises / p0, axes)}
            inside, surface = found.get("interior"), found["surface"]
            border = _border(contact, stress.position) / a
            where = f"{told}, body {body}"
            both.append(inside is not None)
            at_border[where] = abs(surface.at[0] - border) < NEARBY
            cells = ("none", "", "")
            if inside is not None:
                cells = (f"{inside.value:.3f}", f"{inside.at[0]:+.2f}", f"{inside.at[1]:.2f}")
            at_surface = (f"{surface.value:.3f}", f"{surface.at[0]:+.2f}")
            rows.append((where, *cells, *at_surface, f"{border:+.2f}"))
    yield Statement(
        "Fig. 5(e-f)",
        "On y = 0 and on y = 0.75 a_0 the equivalent stress has two maxima, one inside the solid "
        "and one at its surface.",
        f"So it has in {sum(both)} of the {len(both)} sections tabled below.",
        Verdict.of(*both),
    )
    there = [where for where, near in at_border.items() if near]
    yield Statement(
        "Fig. 5(e-f)",
        "The one at the surface is at the boundary between adhesion and sliding.",
        f"It is there on {'; '.join(there) or 'neither plane'}. On "
        f"y = 0 it is at x = {rows[0][5]} a_0 in body A, which friction drives, and at "
        f"{rows[1][5]} a_0 in body B, which it brakes; stick ends at {rows[0][6]} a_0.",
        Verdict.of(*at_border.values()),
        f"if within {NEARBY} a_0",
    )
    yield Table(
        "Maxima of the equivalent stress over p_0, and where they are, in a_0. Values at the "
        "surface depend on the mesh.",
        ("section", "inside", "at x", "at depth", "at the surface", "at x", "stick ends at x"),
        rows,
    )


def _border(contact: State, y: float) -> float:
    """The trailing end of the stick zone in the row nearest to y, mm."""
    row = contact.sticking[:, np.abs(contact.grid.y - y).argmin()]
    return float(contact.grid.x[row.argmax()] - 0.5 * contact.grid.dx) if row.any() else np.nan
