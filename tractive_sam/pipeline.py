"""From a scene to its results: the two front doors, `solve` and `roll`."""

from collections.abc import Callable
from os import PathLike

import numpy as np

from tractive_sam.contact import Contact, Gap, Model, NotConverged, equilibrium
from tractive_sam.record import History, Record
from tractive_sam.scene import Scene
from tractive_sam.store import read_gap


def measured_gap(scene: Scene) -> Gap | None:
    """The measured separation of a scene, read from its file where it names one."""
    gap = scene.gap
    if gap is None:
        return None
    if gap.file is not None:
        return read_gap(gap.file)
    return gap.x, gap.y, gap.separation


def solve(
    scene: Scene,
    *,
    wear: np.ndarray | None = None,
    start: Contact | None = None,
    throw: bool = True,
) -> Contact:
    """Solve one steady state of a scene.

    Parameters
    ----------
    scene : Scene
        What is asked; its [wear] is not rolled, see `roll`.
    wear : ndarray, shape (n_x, n_y), optional
        Depth worn off both bodies together, mm.
    start : Contact, optional
        Contact of a similar scene on the same mesh, as first guess.
    throw : bool
        Whether to raise where the solve did not converge.

    Returns
    -------
    Contact
        Fields, resultants, residual and cost.

    Raises
    ------
    NotConverged
        If `throw` and the contact conditions do not hold to the scene's tolerance.
    """
    contact = equilibrium(Model(scene, measured_gap(scene)), wear, start)
    if throw and not contact.converged:
        raise NotConverged(contact)
    return contact
