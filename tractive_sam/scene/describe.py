"""Summaries of a scene, made from the rows of its tables (`Table.describe`)."""

import math
from collections.abc import Iterable
from typing import Any

from tractive_sam.description import html_table, text_table
from tractive_sam.markup import Html, as_html
from tractive_sam.schema import describe_tables


def describe_load(
    scene: Any, keys: Iterable[str] = ("load", "wheelset", "wear", "load_history", "duty")
) -> dict[str, str]:
    """Describe load, wear and blocks of a scene in a few rows, text by label.

    Parameters
    ----------
    scene : Scene
        The scene.
    keys : iterable of str
        Tables with the rows to return.

    Returns
    -------
    dict of str to str
        Text of the brief rows by their label.
    """
    rows = describe_tables(scene)
    return {row.label: row.text for key in keys for row in rows[key] if row.brief}


def summarize(scene: Any) -> dict[str, str]:
    """Return a short description of a scene, text by label."""
    summary, further, entries = {"title": scene.title or "none"}, [], scene.entries()
    for key, rows in describe_tables(scene).items():
        brief = {row.label: row.text for row in rows if row.brief}
        summary |= brief
        if not brief and entries.get(key) is not None:
            further.append(f"[{key}]")
    if further:
        summary["other tables"] = ", ".join(sorted(further))
    return summary


def format_summary(scene: Any) -> str:
    """Return the summary of a scene as text."""
    return text_table("Scene", summarize(scene))


def draw_summary(scene: Any) -> Html:
    """Return the summary of a scene as HTML for notebooks, with the contact ellipse."""
    return html_table(summarize(scene), _ellipse(scene.hertz))


def format_pair(first: float, second: float) -> str:
    """Return one number if both are equal, else both in parentheses."""
    return f"{first:g}" if first == second else f"({first:g}, {second:g})"


def _ellipse(hertz: Any, side: int = 190) -> Html:
    """Return a drawing (SVG) of the Hertz contact ellipse, true to scale, x upwards.

    Parameters
    ----------
    hertz : HertzContact or HertzLine or None
        The contact; the result is empty for None and for a line contact.
    side : int
        Side of the drawing, pixels.
    """
    if hertz is None or math.isinf(hertz.b):
        return Html()
    largest = max(hertz.a, hertz.b)
    rx, ry, half = 0.33 * side * hertz.b / largest, 0.33 * side * hertz.a / largest, side / 2
    axes = as_html(f"2a = {2 * hertz.a:.3g} mm, 2b = {2 * hertz.b:.3g} mm")
    size, blue = 'font-size="12"', "#0072b2"
    parts = (
        f'<svg width="{side}" height="{side + 18}" role="img" aria-label="{axes}">',
        f'<path d="M{half} {side - 6}V6m-4 7 4-7 4 7M6 {half}H{side - 6}" stroke="#999" ',
        f'fill="none"/><ellipse cx="{half}" cy="{half}" rx="{rx:.1f}" ry="{ry:.1f}" fill="{blue}" ',
        f'fill-opacity=".3" stroke="{blue}"/><text x="{half + 7}" y="15" {size}>x</text>',
        f'<text x="{side - 14}" y="{half - 6}" {size}>y</text>',
        f'<text x="{half}" y="{side + 13}" text-anchor="middle" {size}>{axes}</text></svg>',
    )
    return Html("".join(parts))
