"""Orthotropic friction at three angles: tractions and stress (Figs. 7 and 8)."""

from collections.abc import Iterator

import numpy as np

from tractive_sam import plot
from tractive_sam.paper.page import (
    Finding,
    FindingTable,
    Picture,
    Statement,
    Verdict,
    Work,
    join,
)
from tractive_sam.paper.scenes import ANGLES, hertz_of, orthotropic_spheres
from tractive_sam.results import Maximum, State
from tractive_sam.run import solve
from tractive_sam.subsurface import stress_maximum, stress_on_plane


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
            yield Picture(f"{name}-{angle:.0f}", draw(contact), f"{caption}, β = {angle:g}°.")
    for plane, name in (("y=0", "xz"), ("x=0", "yz")):
        for angle, contact in contacts.items():
            yield Picture(
                f"fig-08-{name}-{angle:.0f}",
                plot.von_mises_section(contact, "A", plane),
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
