"""Compare the error bars of a contact with the accuracy that its scene requires."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from tractive_sam.results import History, State
from tractive_sam.run.accuracy.error_bars import (
    Name,
    Sample,
    deviations_from_prescribed,
    error_bars,
    relative_error_bars,
)
from tractive_sam.run.accuracy.levels import Levels
from tractive_sam.scene import Scene
from tractive_sam.schema import required


@dataclass(frozen=True)
class Assessment:
    """Error bars of one contact, and a note if they are wider than the tolerance.

    Attributes
    ----------
    error_bars : mapping of str to float
        See `State`; empty if too few meshes were solved.
    missed : str
        The error bar that is too wide, and what to do; empty if all are within the tolerance.
    """

    error_bars: Mapping[str, Any]
    missed: str


def assess(contact: State, samples: Sequence[Sample | None], peak: bool) -> Assessment:
    """Estimate the error bars of a contact from its samples on coarser meshes.

    Parameters
    ----------
    contact : State
        Contact on the finest mesh.
    samples : sequence of Sample or None
        Samples on this and coarser meshes, the finest last; None for a mesh that was not solved.
    peak : bool
        Whether the peak contact pressure must be within the tolerance as well.
    """
    solved = [sample for sample in samples[-Levels.needed :] if sample is not None]
    if len(solved) < Levels.needed:
        note = f"error bars need {Levels.needed} meshes, and only {len(solved)} could be solved"
        return Assessment({}, _add_advice(contact.scene, note))
    relative = relative_error_bars(*solved)
    worst, name = worst_error_bar(relative, peak)
    bars = (
        error_bars(relative, solved[-1]) | deviations_from_prescribed(contact) | {"relative": worst}
    )
    if worst <= required(contact.scene.accuracy, "accuracy").tolerance:
        return Assessment(bars, "")
    if math.isinf(worst):
        note = f"{name} grows with every finer mesh and may have no limit: round sharp edges"
        return Assessment(bars, note)
    note = f"{name} has a relative error bar of {worst:.1e}"
    return Assessment(bars, _add_advice(contact.scene, note))


def worst_error_bar(relative: Mapping[Name, float], peak: bool) -> tuple[float, str]:
    """Return the widest relative error bar among the quantities that decide the mesh, and its name.

    `peak` includes the peak pressure.
    """
    # Quantities that must be within the tolerance; for unworn bodies the peak pressure as well.
    governing = ("P", "Qx", "Qy", "Mz", "xi_x", "xi_y", "wear_max")
    names = (*governing, "p_max") if peak else governing
    return max((relative[name], name) for name in names)


def describe_missed_accuracy(history: History, scene: Scene) -> str:
    """Describe the last stored revolution with too wide error bars; empty if there is none.

    Parameters
    ----------
    history : History
        History of this scene, complete or not.
    scene : Scene
        Scene with [accuracy].
    """
    if "relative_error" not in history.columns:
        return ""
    missed, saved = "", scene.schedule
    tolerance = required(scene.accuracy, "accuracy").tolerance
    for revolution, worst in zip(history["revolution"], history["relative_error"], strict=True):
        # Not "greater": the error bar is nan if coarser meshes could not be solved.
        if int(revolution) in saved and not worst <= tolerance:
            bar = "no error bars" if math.isnan(worst) else f"a relative error bar of {worst:.1e}"
            missed = f"revolution {revolution:.0f} has {bar}"
    return missed and _add_advice(scene, missed)


def _add_advice(scene: Scene, note: str) -> str:
    """Return a note followed by advice how to reach the requested accuracy."""
    accuracy = required(scene.accuracy, "accuracy")
    return (
        f"{note}; accuracy.tolerance is {accuracy.tolerance:.1e}, and accuracy.elements "
        f"allows no more than {accuracy.elements} elements: raise one of them"
    )
