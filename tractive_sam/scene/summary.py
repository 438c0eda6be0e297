"""A scene in a few lines, and as a table for notebooks."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tractive_sam.markup import Html, as_html, html_table
from tractive_sam.plain import text_table

from .told import friction_told, load_told, wear_told

if TYPE_CHECKING:
    from .scene import Scene

SIDE = 190
"""Of the picture, pixels."""


def rows(scene: Scene) -> dict[str, str]:
    """What a scene asks, a line each, by what is told."""
    found = {"title": scene.title or "none"}
    for name in ("A", "B"):
        body, material = getattr(scene.body, name), scene.materials[name]
        radii = f"R_x = {body.radius_x:g} mm, R_y = {body.radius_y:g} mm"
        found[f"body {name}"] = f"E = {material.young:g} MPa, nu = {material.poisson:g}, {radii}"
    found["load"] = load_told(scene)
    moved = scene.creepage.settings() | scene.load.settings()
    driven = ("longitudinal", "lateral", "spin", "force_x", "force_y")
    creeping = [f"{key} = {moved[key]:g}" for key in driven if moved.get(key)]
    found["rolling"] = ", ".join(creeping) or "free"
    if scene.friction is not None:
        found["friction"] = friction_told(scene)
    if scene.wear is not None:
        rolled = "" if scene.transient else f"; {scene.wear.revolutions} revolutions"
        found["wear"] = wear_told(scene) + rolled
    others = [key for key in sorted(scene.model_fields_set) if key not in _TOLD]
    tables = [f"[{key}]" for key in others if getattr(scene, key) is not None]
    if tables:
        found["and"] = ", ".join(tables)
    return found


_TOLD = {"title", "body", "load", "creepage", "friction", "wear"}


def text(scene: Scene) -> str:
    """The same in lines."""
    return text_table("Scene", rows(scene))


def html(scene: Scene) -> Html:
    """The same as a table, beside the contact ellipse by Hertz."""
    return html_table(rows(scene), _ellipse(scene))


def _ellipse(scene: Scene) -> Html:
    """The unworn contact by Hertz as vectors, true to scale; x, the rolling direction, upwards."""
    hertz = scene.hertz
    if hertz is None or scene.line:
        return Html()
    largest = max(hertz.a, hertz.b)
    rx, ry, half = 0.33 * SIDE * hertz.b / largest, 0.33 * SIDE * hertz.a / largest, SIDE / 2
    told = as_html(f"2a = {2 * hertz.a:.3g} mm, 2b = {2 * hertz.b:.3g} mm")
    size, blue = 'font-size="12"', "#0072b2"
    parts = (
        f'<svg width="{SIDE}" height="{SIDE + 18}" role="img" aria-label="{told}">',
        f'<path d="M{half} {SIDE - 6}V6m-4 7 4-7 4 7M6 {half}H{SIDE - 6}" stroke="#999" ',
        f'fill="none"/><ellipse cx="{half}" cy="{half}" rx="{rx:.1f}" ry="{ry:.1f}" fill="{blue}" ',
        f'fill-opacity=".3" stroke="{blue}"/><text x="{half + 7}" y="15" {size}>x</text>',
        f'<text x="{SIDE - 14}" y="{half - 6}" {size}>y</text>',
        f'<text x="{half}" y="{SIDE + 13}" text-anchor="middle" {size}>{told}</text></svg>',
    )
    return Html("".join(parts))
