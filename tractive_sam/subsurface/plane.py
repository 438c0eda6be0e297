"""Stress on the planes that a scene names."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike

from tractive_sam.contact import Laws
from tractive_sam.kernels.stress import COMPONENTS
from tractive_sam.results import PlaneStress, State
from tractive_sam.scene import Plane
from tractive_sam.subsurface.depth import check_depths, default_depths, semi_axes
from tractive_sam.subsurface.loaded import LoadedBodies


def stress_on_plane(
    contact: State,
    plane: Plane | str,
    body: str = "A",
    depths: ArrayLike | None = None,
    laws: Laws | None = None,
) -> PlaneStress:
    """Return the stress tensor of one body over one plane, x, y or z = constant.

    Parameters
    ----------
    contact : State
        The solved contact.
    plane : Plane or str
        As in a scene: "y=0", "x=-0.3" (mm), "y=0.75a", "z=0.48a"; a, b are the semi-axes of the
        unworn Hertz contact, or the half widths of the contact without it.
    body : "A" or "B"
        The body.
    depths : array_like, optional
        Depths of a vertical plane, mm; by default from [subsurface].
    laws : Laws, optional
        Laws of the bodies; by default the laws of the solution.

    Raises
    ------
    ValueError
        If the plane cannot be read or has no position, the body is not "A" or "B", or depths are
        negative or not finite.

    Examples
    --------
    >>> stress = ts.stress_on_plane(contact, "y=0.5a", "B")
    >>> stress.von_mises.shape
    (91, 64)
    """
    return next(stress_on_planes(contact, (plane,), (body,), depths, laws))


def stress_on_planes(
    contact: State,
    planes: Sequence[Plane | str] | None = None,
    bodies: Sequence[str] | None = None,
    depths: ArrayLike | None = None,
    laws: Laws | None = None,
) -> Iterator[PlaneStress]:
    """Yield the stress tensor of each body on each plane, plane by plane.

    Two bodies cost little more than one: they share most of the work.

    Parameters
    ----------
    contact : State
        The solved contact.
    planes : sequence of Plane or str, optional
        See `stress_on_plane`; by default the planes of [subsurface].
    bodies : sequence of str, optional
        By default the bodies of [subsurface].
    depths, laws : optional
        See `stress_on_plane`.

    Raises
    ------
    ValueError
        See `stress_on_plane`; or if planes or bodies are not given and the scene has no
        [subsurface].

    Examples
    --------
    >>> stresses = ts.stress_on_planes(contact, ("y=0",), ("A", "B"))
    >>> [f"{stress.body}, {stress.plane}" for stress in stresses]
    ['A, y=0', 'B, y=0']
    """
    table = contact.scene.subsurface
    if table is not None:
        planes = table.planes if planes is None else planes
        bodies = table.bodies if bodies is None else bodies
    if planes is None or bodies is None:
        raise ValueError("the scene has no [subsurface]: give planes and bodies")
    load = LoadedBodies.from_contact(contact, bodies, laws)
    depths = default_depths(contact) if depths is None else check_depths(depths)
    # Checked at the call, not at the first plane.
    placed = [(plane, _position(contact, plane)) for plane in map(Plane.parse, planes)]
    return (stress for place in placed for stress in _on_plane(contact, *place, load, depths))


def _position(contact: State, plane: Plane) -> float:
    """Return the position of a plane in mm; raise a ValueError if it is infinite."""
    position = plane.value_in(*semi_axes(contact))
    if not np.isfinite(position):
        raise ValueError(f"{plane}: the semi-axis b of a line contact is infinite; use mm or a")
    return position


def _on_plane(
    contact: State, plane: Plane, position: float, load: LoadedBodies, depths: np.ndarray
) -> Iterator[PlaneStress]:
    """Yield the stress of each body on one plane."""
    grid = contact.grid
    if plane.axis == "z":
        axes = {"x": grid.x, "y": grid.y}
    else:
        axes = {"y": grid.y} if plane.axis == "x" else {"x": grid.x}
        axes["depth"] = depths
    stress = load.source.on_plane(plane.axis, position, depths)
    for body, tensor in zip(load.names, load.in_contact_axes(stress), strict=True):
        yield PlaneStress(body, plane, position, axes, dict(zip(COMPONENTS, tensor, strict=True)))
