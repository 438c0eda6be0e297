"""Orthotropic friction at three angles: tractions and stress (Figs. 7 and 8)."""

from collections.abc import Iterator

import numpy as np

from tractive_sam import plot
from tractive_sam.paper.finding import Finding, Picture, Statement, Table, Verdict, Work, listed
from tractive_sam.paper.scenes import ANGLES, orthotropic_spheres
from tractive_sam.results import Maximum, State
from tractive_sam.run import solve
from tractive_sam.subsurface import stress_maximum, stress_on_plane

PAPER_INTERIOR = 0.6
"""Largest equivalent stress inside, over p_0, of the paper: given to one digit."""

SAME = 0.05
"""Relative spread of values that remain approximately the same."""

SYMMETRIC = 1e-3
"""Share of the largest stress by which the two sides of a symmetric field may differ."""


def find(work: Work) -> Iterator[Finding]:
    """Yield what the paper says of Figs. 7 and 8, and what we find."""
    contacts = {}
    for angle in ANGLES:
        work.tell(f"two spheres, β = {angle:g}°")
        contacts[angle] = solve(orthotropic_spheres(work.size, angle))
    yield _lateral(contacts)
    maxima = {angle: stress_maximum(contact, "A") for angle, contact in contacts.items()}
    p0 = contacts[0.0].scene.hertz.p0
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
                plot.von_mises(contact, "A", plane),
                f"Fig. 8. Equivalent stress in body A, {name} plane, β = {angle:g}°.",
            )


def _lateral(contacts: dict[float, State]) -> Statement:
    p_y = [
        float(abs(contact.traction[1]).max() / contact.scene.hertz.p0)
        for contact in contacts.values()
    ]
    along, turned, across = p_y
    return Statement(
        "Fig. 7",
        "For 0° < β < 90° the traction has a component p_y.",
        f"The largest |p_y|/p_0 is {turned:.3f} for β = 45°, and {along:.3f} and {across:.3f} for "
        "0° and 90°, where only the curvature of the slip makes it.",
        Verdict.of(turned > 2 * max(along, across)),
    )


def _inside_and_surface(maxima: dict[float, Maximum], p0: float) -> Iterator[Finding]:
    inside = np.array([top.interior for top in maxima.values()]) / p0
    surface = np.array([top.surface for top in maxima.values()]) / p0
    yield Statement(
        "Fig. 8",
        "The largest equivalent stress inside remains approximately the same, 0.6 p_0, as β "
        "increases.",
        f"{listed(inside, '.3f')} p_0: the same within {np.ptp(inside) / inside.mean():.1%}, but "
        f"nearer to {inside.mean():.2f} p_0.",
        Verdict.of(
            bool(np.ptp(inside) / inside.mean() < SAME),
            bool(np.all(np.round(inside, 1) == PAPER_INTERIOR)),
        ),
        f"if the same within {SAME:.0%}, and {PAPER_INTERIOR} p_0 when rounded",
    )
    yield Statement(
        "Fig. 8",
        "At the surface the stress clearly decreases as β increases; in the end only the maximum "
        "inside is left.",
        f"{listed(surface, '.3f')} p_0 at the surface: for β = 90° it is "
        f"{surface[-1] / inside[-1]:.2f} of the maximum inside.",
        Verdict.of(bool(np.all(np.diff(surface) < 0)), bool(surface[-1] < inside[-1])),
    )


def _sides(contacts: dict[float, State]) -> Statement:
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
        Verdict.of(turned > 0.01, max(along, across) < SYMMETRIC),
    )


def _table(contacts: dict[float, State], maxima: dict[float, Maximum]) -> Table:
    rows = []
    for angle, contact in contacts.items():
        top, hertz = maxima[angle], contact.scene.hertz
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
    return Table(
        "Forces on body A, and the maxima of its equivalent stress over p_0; places in a_0.",
        ("β", "Q_x/P", "Q_y/P", "sticks", "inside", "at x, depth", "surface", "at x, y"),
        rows,
    )
