"""A column of several histories over their course, in one figure."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from tractive_sam.description import format_with_unit
from tractive_sam.plot.figure import Figure
from tractive_sam.plot.style import LOOK, MICRON, apply_style, label_course, new_axes
from tractive_sam.results import History, Quantity

Points = tuple[ArrayLike, ArrayLike]
"""Abscissae and ordinates of points."""


@apply_style
def compare(
    histories: Mapping[str, History], name: str, reference: Mapping[str, Points] | None = None
) -> Figure:
    """Draw a column of several histories over the course, also a user-defined one.

    Parameters
    ----------
    histories : mapping of str to History
        Histories by their label in the legend.
    name : str
        Name of a column with one number a record, for example "Qx_over_P" or "p_max".
    reference : mapping of str to pair of array_like, optional
        Values of other models or of measurements by their label: coordinates, and values in the
        unit of the column.

    Raises
    ------
    ValueError
        If there is no history, a history lacks the column, the coordinates of the histories differ,
        or the column is per length in some of them, as in line contacts.

    Examples
    --------
    >>> plot.compare({"twin discs": history}, "Qx_over_P")
    <Figure size ...>
    """
    if not histories:
        raise ValueError("nothing to draw: at least one history is needed")
    common = set.intersection(*(set(history.of_dims()) for history in histories.values()))
    if name not in common:
        raise ValueError(f"name: one of {', '.join(sorted(common))} is needed, not {name!r}")
    quantity, factor = _common_quantity(name, histories), 1.0
    label = format_with_unit(quantity.long_name, quantity.unit)
    if name == "wear_max":
        factor, label = MICRON, rf"{quantity.long_name} ($\mathrm{{\mu m}}$)"
    figure, axes = new_axes()
    for title, history in histories.items():
        coordinates = history[history.coordinate.name]
        axes.plot(coordinates, factor * history[name], label=title, clip_on=False)
    for title, (places, values) in (reference or {}).items():
        axes.plot(places, factor * np.asarray(values), "--", color=LOOK.grey, label=title)
    label_course(axes, *histories.values())
    axes.set_ylabel(label, wrap=True)
    axes.legend(loc="best")
    return figure


def _common_quantity(name: str, histories: Mapping[str, History]) -> Quantity:
    """Return the column of this name; ValueError if histories differ in it or their coordinate."""
    coordinates = {history.coordinate.name for history in histories.values()}
    if len(coordinates) > 1:
        different = " and ".join(sorted(coordinates))
        raise ValueError(f"histories along one coordinate are needed, not along {different}")
    first, *conflicting = {history.columns[name] for history in histories.values()}
    if conflicting:
        raise ValueError(
            f"{name} of line contacts is per length, and of other contacts it is not; compare "
            "histories of one kind"
        )
    return first
