"""Export the stress in a volume, and the surface over a history, to files for ParaView."""

from collections.abc import Iterator
from os import PathLike
from pathlib import Path

import numpy as np

from tractive_sam import interrupt
from tractive_sam.mechanics import CRITERIA
from tractive_sam.results import History, State
from tractive_sam.scene import Plane, Subsurface
from tractive_sam.store import Image, check_volume, write_surface, write_volume
from tractive_sam.subsurface import stress_volume


def export_volume(
    source: State | History,
    path: str | PathLike,
    *,
    body: str = "A",
    revolution: float | None = None,
    depth: float | None = None,
    elements: int | None = None,
    overwrite: bool = False,
    threads: int = 1,
) -> Path:
    """Write the stress in a volume of one body to a VTKHDF file (ParaView); return its path.

    Points are the centres of the elements at equally spaced depths from the surface on; body A is
    at z >= 0, B at z <= 0. Layers are computed and written one after another, so that memory does
    not grow with their number.

    Parameters
    ----------
    source : State or History
        A solved contact, or a history that stored fields.
    path : path-like
        The file, with the suffix ``.vtkhdf``.
    body : "A" or "B"
        The body concerned.
    revolution : float, optional
        For a history: one of its `saved`, in the unit of its coordinate; the last by default.
    depth : float, optional
        Depth in units of the semi-axis a of the unworn contact, or of the half width in x if Hertz
        does not apply; by default the depth of [subsurface], or 1.5.
    elements : int, optional
        Points over the depth; by default the elements of [subsurface], or 64.
    overwrite : bool
        Whether a file of this function may be replaced.
    threads : int
        Threads to use.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    ValueError
        If the body, the depth or the number of points is not allowed, or the bodies do not touch.
    LookupError
        If the history stored no fields of the revolution; the message lists what it stored.
    ResultsError
        If the file cannot be written.

    Examples
    --------
    >>> ts.export_volume(contact, "spheres.vtkhdf", elements=4).name
    'spheres.vtkhdf'
    """
    path = Path(path)
    check_volume(path, overwrite)
    about: dict[str, str | float] = {"body": body}
    if isinstance(source, History):
        about[source.coordinate.name] = source.saved[source.row_of(revolution)]
        source = source.state(revolution)
    elif revolution is not None:
        raise ValueError("revolution: only a history has revolutions; omit it")
    if not source.pressure.any():
        raise ValueError("the bodies do not touch: no stress to export; increase the load")
    depths = _depths(source, depth, elements)
    layers = stress_volume(source, depths if body == "A" else depths[::-1], body, threads)
    grid, lowest = source.grid, 0.0 if body == "A" else -float(depths[-1])
    image = Image(
        points=(*grid.elements, depths.size),
        origin=(float(grid.x[0]), float(grid.y[0]), lowest),
        spacing=(grid.dx, grid.dy, float(depths[1])),
    )
    arrays = (
        {"stress": stress} | {name: invariant(stress) for name, invariant in CRITERIA.items()}
        for _, stress in layers
    )
    write_volume(path, image, arrays, source.scene, about, overwrite)
    return path


def export_surface(
    source: State | History, path: str | PathLike, *, overwrite: bool = False
) -> Path:
    """Write the surface fields of one or all stored contacts to a VTKHDF file; return its path.

    Points are the centres of the elements. Each of the `saved` of a history is a step, which
    ParaView shows as a time.

    Parameters
    ----------
    source : State or History
        A solved contact, or a history that stored fields.
    path : path-like
        The file, with the suffix ``.vtkhdf``.
    overwrite : bool
        Whether to replace a file that this function or `export_volume` wrote.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    ValueError
        If the history stored no fields, or its contact is a line contact.
    ResultsError
        If the file cannot be written.

    Examples
    --------
    >>> ts.export_surface(history, "surface.vtkhdf").name
    'surface.vtkhdf'
    """
    path = Path(path)
    check_volume(path, overwrite)
    if isinstance(source, History):
        steps = source.saved
        states: Iterator[State] = map(source.state, steps.tolist())
    else:
        steps, states = np.zeros(1), iter([source])
    if not steps.size:
        raise ValueError(
            f"the history stored no fields; set {source.scene.schedule.save_key} to store them"
        )
    grid = source.grid
    if source.scene.line:
        raise ValueError("a line contact has no map: tractive-sam plot draws its sections")
    origin = (float(grid.x[0]), float(grid.y[0]), 0.0)
    image = Image((*grid.elements, 1), origin, (grid.dx, grid.dy, 1.0))
    write_surface(path, image, steps, map(_surface_fields, states), source.scene, overwrite)
    return path


def _surface_fields(state: State) -> dict[str, np.ndarray]:
    """Return the surface fields of a contact by name: pressure, traction, slip, wear, gap."""
    interrupt.raise_if_interrupted()
    return {
        "pressure": state.pressure,
        "traction": state.traction,
        "slip": state.slip,
        "wear": state.wear,
        "gap": state.gap,
    }


def _depths(source: State, depth: float | None, elements: int | None) -> np.ndarray:
    """Return depths from 0 to `depth` semi-axes a, mm; by default those of [subsurface]."""
    # Depth and points for a scene without [subsurface].
    default = Subsurface(planes=(Plane("y", 0.0),))
    settings = source.scene.subsurface or default
    depth = settings.depth if depth is None else depth
    elements = settings.elements if elements is None else elements
    if not 0.0 < depth < np.inf:
        raise ValueError(f"depth: a positive number of semi-axes a is needed, not {depth}")
    if elements < 2:
        raise ValueError(f"elements: at least 2 points over the depth are needed, not {elements}")
    hertz = source.scene.hertz
    return np.linspace(0.0, depth * (source.half_width_x if hertz is None else hertz.a), elements)
