"""One number of several computations over their course, in the same axes."""

from __future__ import annotations

from collections.abc import Mapping

from numpy.typing import ArrayLike

from tractive_sam.plot.figure import Figure
from tractive_sam.plot.style import GREY, MICRON, WIDTH, along, styled
from tractive_sam.results import History, Quantity

Points = tuple[ArrayLike, ArrayLike]


@styled
def compared(
    histories: Mapping[str, History], name: str, reference: Mapping[str, Points] | None = None
) -> Figure:
    """One recorded number of several histories over the course, a column of one's own, too.

    Parameters
    ----------
    histories : mapping of str to History
        What the legend says of each.
    name : str
        The name of a column of one number a record: "Qx_over_P", "p_max".
    reference : mapping of str to pair of array_like, optional
        Revolutions, or what the histories go along, and values of other models or of measurements,
        in the unit of the record.

    Raises
    ------
    ValueError
        If there is no such number, no history, or histories along several coordinates, or both line
        contacts and others and the number is per length in line contacts.

    Examples
    --------
    >>> plot.compared({"twin discs": history}, "Qx_over_P")
    <Figure size ...>
    """
    if not histories:
        raise ValueError("nothing to draw: at least one history is needed")
    known = set.intersection(*(set(history.of_dims()) for history in histories.values()))
    if name not in known:
        raise ValueError(f"name: one of {', '.join(sorted(known))} is needed, not {name!r}")
    quantity, factor = _common(name, histories), 1.0
    unit = "" if quantity.unit == "1" else f" ({quantity.unit})"
    if name == "wear_max":
        factor, unit = MICRON, r" ($\mathrm{\mu m}$)"
    figure = Figure(figsize=(WIDTH, 0.66 * WIDTH))
    axes = figure.add_subplot()
    for label, history in histories.items():
        (line,) = axes.plot(history[history.coordinate.name], factor * history[name], label=label)
        line.set_clip_on(False)
    for label, (at, value) in (reference or {}).items():
        values = [factor * one for one in value]
        axes.plot(at, values, "--", color=GREY, label=label)
    along(axes, *histories.values())
    axes.set_ylabel(f"{quantity.long_name}{unit}", wrap=True)
    axes.legend(loc="best")
    return figure


def _common(name: str, histories: Mapping[str, History]) -> Quantity:
    """The number as all histories have it."""
    coordinates = {history.coordinate for history in histories.values()}
    if len(coordinates) > 1:
        told = " and ".join(sorted(one.name for one in coordinates))
        raise ValueError(f"histories along one coordinate are needed, not along {told}")
    first, *others = {history.columns[name] for history in histories.values()}
    if others:
        cure = "histories of one kind are needed"
        raise ValueError(f"{name} of line contacts is another quantity than of others; {cure}")
    return first
