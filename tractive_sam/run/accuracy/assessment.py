"""Whether a contact is as accurate as its scene asks for."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from tractive_sam.results import History, State
from tractive_sam.run.accuracy.error_bars import (
    Name,
    Sample,
    error_bars,
    off_given,
    relative_error_bars,
)
from tractive_sam.run.accuracy.levels import NEEDED
from tractive_sam.scene import Scene

GOVERNING = ("P", "Qx", "Qy", "Mz", "xi_x", "xi_y", "wear_max")
"""What has to be within the tolerance; of unworn bodies the peak contact pressure as well."""


@dataclass(frozen=True)
class Assessment:
    """Error bars of a contact, and what is wrong with them.

    Attributes
    ----------
    error_bars : mapping of str to float
        As of `State`; empty where too few meshes were solved.
    missed : str
        Which of them is too wide, and what to do; empty where all are as asked for.
    """

    error_bars: Mapping[str, Any]
    missed: str


def assess(contact: State, samples: Sequence[Sample | None], peak: bool) -> Assessment:
    """Assess a contact by coarser ones.

    Parameters
    ----------
    contact : State
        On the finest mesh.
    samples : sequence of Sample or None
        Of this and coarser meshes, the finest last; None where a mesh could not be solved.
    peak : bool
        Whether the peak contact pressure has to be within the tolerance as well.
    """
    solved = [sample for sample in samples[-NEEDED:] if sample is not None]
    if len(solved) < NEEDED:
        told = f"error bars take {NEEDED} meshes, of which {len(solved)} could be solved"
        return Assessment({}, _advised(contact.scene, told))
    relative = relative_error_bars(*solved)
    worst, name = worst_of(relative, peak)
    bars = error_bars(relative, solved[-1]) | off_given(contact) | {"relative": worst}
    if worst <= contact.scene.accuracy.tolerance:
        return Assessment(bars, "")
    if math.isinf(worst):
        told = f"{name} grows with every finer mesh and may have no limit: round what is sharp"
        return Assessment(bars, told)
    told = f"{name} has a relative error bar of {worst:.1e}"
    return Assessment(bars, _advised(contact.scene, told))


def worst_of(relative: Mapping[Name, float], peak: bool) -> tuple[float, str]:
    """The widest of the relative error bars that govern, and its name."""
    names = (*GOVERNING, "p_max") if peak else GOVERNING
    return max((relative[name], name) for name in names)


def missed_before(history: History, scene: Scene) -> str:
    """Which saved revolution of a history was last not accurate enough, and what to do; or empty.

    Parameters
    ----------
    history : History
        Of this scene, complete or not.
    scene : Scene
        With [accuracy].
    """
    if "relative_error" not in history.columns:
        return ""
    missed, saved = "", scene.schedule
    for revolution, worst in zip(history["revolution"], history["relative_error"], strict=True):
        # Not "greater": there may be none, where coarser meshes could not be solved.
        if int(revolution) in saved and not worst <= scene.accuracy.tolerance:
            bar = "no error bars" if math.isnan(worst) else f"a relative error bar of {worst:.1e}"
            missed = f"revolution {revolution:.0f} has {bar}"
    return missed and _advised(scene, missed)


def _advised(scene: Scene, told: str) -> str:
    accuracy = scene.accuracy
    return (
        f"{told}; accuracy.tolerance asks for {accuracy.tolerance:.1e}, and accuracy.elements "
        f"allows no more than {accuracy.elements} elements: raise one of them"
    )
