"""The bodies of a contact under its tractions: stress in layers, volumes, planes and points."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol, cast

import numpy as np
from numpy.typing import ArrayLike

from tractive_sam.contact import Laws
from tractive_sam.mechanics import Elasticity
from tractive_sam.results import COMPONENTS, Grid, PlaneStress, State, widen_field
from tractive_sam.scene import Plane, Scene, Subsurface
from tractive_sam.subsurface.sources import SIGNS, StressSource, stress_source


class Loading(Protocol):
    """Protocol of a loaded surface: scene, grid and tractions, as `State` has them.

    Attributes
    ----------
    scene : Scene
        Scene with the materials.
    grid : Grid
        The mesh.
    pressure, traction : ndarray
        See `State`.
    """

    @property
    def scene(self) -> Scene:
        """Scene of the contact."""

    @property
    def grid(self) -> Grid:
        """Mesh of the surface."""

    @property
    def pressure(self) -> np.ndarray:
        """Pressure, shape (n_x, n_y), MPa."""

    @property
    def traction(self) -> np.ndarray:
        """Tractions (p_x, p_y) on body A, shape (2, n_x, n_y), MPa."""


@dataclass(frozen=True, eq=False)
class LoadedBodies:
    """Bodies of a contact as half-spaces z >= 0, with their tractions and stress solver.

    Attributes
    ----------
    names : tuple of str
        "A" or "B".
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) acting on the half-space of body A, MPa.
    bodies : tuple of Elasticity
        Elastic laws of the bodies, see `Elasticity.single_body`.
    source : StressSource
        Solver of the stress in them.
    """

    names: tuple[str, ...]
    tractions: np.ndarray
    bodies: tuple[Elasticity, ...]
    source: StressSource

    @classmethod
    def from_contact(
        cls, contact: Loading, names: Sequence[str], laws: Laws | None = None, beyond: int = 0
    ) -> LoadedBodies:
        """Return the loaded bodies of a contact, with the elastic law of its solution.

        Parameters
        ----------
        contact : Loading
            The contact.
        names : sequence of str
            "A" or "B".
        laws : Laws, optional
            Laws of the bodies.
        beyond : int
            Elements without load that are added to the mesh before and behind the contact.

        Raises
        ------
        ValueError
            If a body is neither "A" nor "B", or its law does not give the stress.
        """
        for name in names:
            if name not in SIGNS:
                raise ValueError(f'a body is "A" or "B", not {name!r}')
        tractions = np.concatenate((contact.traction, contact.pressure[None]))
        grid = contact.grid.lengthened(beyond) if beyond else contact.grid
        tractions = widen_field(tractions, grid.elements)
        # Without laws the contact is a state: stored fields have none.
        elasticity = (laws or Laws.of_contact(cast(State, contact))).elasticity
        bodies = tuple(elasticity.single_body(name) for name in names)
        signs = tuple(SIGNS[name] for name in names)
        source = stress_source(bodies[0], bodies, signs, grid, tractions)
        return cls(tuple(names), tractions, bodies, source)

    def in_contact_axes(self, stress: np.ndarray) -> np.ndarray:
        """Change half-spaces' stresses (bodies, 6, ...), in place, to contact axes; return them."""
        for tensor, name in zip(stress, self.names, strict=True):
            tensor[4:] *= SIGNS[name]
        return stress


def depths(subsurface: Subsurface, a: float) -> np.ndarray:
    """Return the depths of [subsurface], mm, graded towards the surface.

    z_i = depth a (i / (n - 1))^(3/2): friction causes a second maximum at the surface, with steeper
    gradients. With the default 64 points to 1.5 a the spacing is 0.003 a at the
    surface and 0.036 a at the bottom.

    Parameters
    ----------
    subsurface : Subsurface
        [subsurface] of the scene.
    a : float
        Semi-axis of the unworn contact in the rolling direction, mm.

    Returns
    -------
    ndarray, shape (subsurface.elements,)
        Ascending, from exactly 0, mm.

    Examples
    --------
    >>> depths(ts.Subsurface(planes=("y=0",), depth=1.0, elements=3), a=2.0)
    array([0.        , 0.70710678, 2.        ])
    """
    return subsurface.depth * a * np.linspace(0.0, 1.0, subsurface.elements) ** 1.5


def semi_axes(contact: State) -> tuple[float, float]:
    """Return the semi-axes a, b of the unworn Hertz contact, or the half widths without it, mm.

    Examples
    --------
    >>> semi_axes(contact)[0] == contact.scene.hertz.a
    True
    """
    hertz = contact.scene.hertz
    if hertz is None:
        return contact.half_width_x, contact.half_width_y
    return hertz.a, hertz.b


def default_depths(contact: State) -> np.ndarray:
    """Return the depths of the scene's [subsurface], or default ones, mm."""
    subsurface = contact.scene.subsurface or Subsurface(planes=(Plane("y", 0.0),))
    return depths(subsurface, semi_axes(contact)[0])


def check_depths(values: ArrayLike) -> np.ndarray:
    """Return depths as an array; raise a ValueError if one is negative or not finite.

    Raises
    ------
    ValueError
        If a depth is negative or not finite, or if `values` is no sequence.

    Examples
    --------
    >>> from tractive_sam.subsurface import check_depths
    >>> check_depths([0, 0.5])
    array([0. , 0.5])
    """
    values = np.asarray(values, dtype=float)
    if values.ndim != 1:
        raise ValueError("depths must be a sequence of numbers")
    if not (np.isfinite(values) & (values >= 0.0)).all():
        raise ValueError("depths must be finite and at least 0, the surface")
    return values


def stress_layers(
    contact: Loading,
    depths: ArrayLike,
    bodies: Sequence[str] = ("A",),
    beyond: int = 0,
    threads: int = 1,
    laws: Laws | None = None,
) -> Iterator[tuple[float, np.ndarray]]:
    """Yield (depth, stress (bodies, 6, n_x + 2 beyond, n_y)) at element centres, by depth.

    Along x a layer contains the stress path of the material at (y, depth) through the contact. The
    stress is computed by FFT, exactly for constant tractions on the elements. Two bodies cost
    little more than one. Coefficients that depend on mesh and depth only are cached for the next
    contact on the mesh (`operators.StressLayers`).

    Parameters
    ----------
    contact : State or Loading
        The solved contact, or its scene, grid and tractions.
    depths : array_like, shape (n,)
        Depths, in any order, 0 at the surface, mm.
    bodies : sequence of str
        "A" or "B".
    beyond : int
        Elements by which the layers extend before and behind the mesh in the rolling direction, at
        the x of ``contact.grid.lengthened(beyond)``.
    threads : int
        Number of threads.
    laws : Laws, optional
        Laws of the bodies; by default the laws of the solution.

    Yields
    ------
    (float, ndarray of shape (bodies, 6, n_x + 2 beyond, n_y))
        Depth, and xx, yy, zz, xy, xz, yz of each body in the axes of the contact, MPa.

    Raises
    ------
    ValueError
        If the body is not "A" or "B", or depths are negative or not finite.

    Examples
    --------
    >>> for depth, stress in stress_layers(contact, [0.0, 0.5]):
    ...     print(depth, stress.shape == (1, 6, *contact.grid.elements))
    0.0 True
    0.5 True
    """
    # Checked at the call, not at the first layer.
    return _layers(
        LoadedBodies.from_contact(contact, bodies, laws, beyond), check_depths(depths), threads
    )


def _layers(
    load: LoadedBodies, depths: np.ndarray, threads: int
) -> Iterator[tuple[float, np.ndarray]]:
    """Yield (depth, stress of the bodies) depth by depth, in the axes of the contact."""
    for depth, stress in zip(depths, load.source.layers(depths, threads), strict=True):
        yield float(depth), load.in_contact_axes(stress)


def stress_volume(
    contact: Loading, depths: ArrayLike, body: str = "A", threads: int = 1, laws: Laws | None = None
) -> Iterator[tuple[float, np.ndarray]]:
    """Yield (depth, stress (6, n_x, n_y)) at the element centres, one depth after another.

    Parameters
    ----------
    contact : State or Loading
        The solved contact, or its scene, grid and tractions.
    depths : array_like, shape (n,)
        Depths, in any order, mm.
    body : "A" or "B"
        The body.
    threads : int
        Number of threads.
    laws : Laws, optional
        Laws of the bodies; by default the laws of the solution.

    Yields
    ------
    (float, ndarray of shape (6, n_x, n_y))
        Depth, and xx, yy, zz, xy, xz, yz in the axes of the contact, MPa.

    Raises
    ------
    ValueError
        If the body is not "A" or "B", or depths are negative or not finite.

    Examples
    --------
    >>> for depth, stress in ts.stress_volume(contact, [0.5, 1.0]):
    ...     print(depth, stress.shape)
    0.5 (6, 91, 91)
    1.0 (6, 91, 91)
    """
    layers = stress_layers(contact, depths, (body,), threads=threads, laws=laws)
    return ((depth, stress[0]) for depth, stress in layers)


def stress_at(
    contact: State, points: ArrayLike, body: str = "A", laws: Laws | None = None
) -> np.ndarray:
    """Return the stress (n, 6) of a body at points (n, 3), an exact sum over the elements.

    The cost is about 0.1 microseconds per point and loaded element. At the surface, on the edge
    between elements with different tangential traction, the stress is infinite; the infinite part
    is omitted there (see `kernels.stress`).

    Parameters
    ----------
    contact : State
        The solved contact.
    points : array_like, shape (n, 3)
        x, y and depth, mm.
    body : "A" or "B"
        The body.
    laws : Laws, optional
        Laws of the bodies; by default the laws of the solution.

    Returns
    -------
    ndarray, shape (n, 6)
        xx, yy, zz, xy, xz, yz in the axes of the contact, MPa.

    Raises
    ------
    ValueError
        If the body is not "A" or "B", or if points have another shape, are not finite or above the
        surface.

    Examples
    --------
    >>> sigma = ts.stress_at(contact, [(0.0, 0.0, 0.5 * scene.hertz.a)])
    >>> sigma.shape
    (1, 6)
    """
    points = np.ascontiguousarray(points, dtype=float)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError(f"points must have the shape (n, 3), not {points.shape}")
    if not np.isfinite(points).all() or (points[:, 2] < 0.0).any():
        raise ValueError("points must be finite, with a depth of at least 0")
    load = LoadedBodies.from_contact(contact, (body,), laws)
    return load.in_contact_axes(load.source.at(points))[0].T


def stress_path(
    contact: State,
    y: float,
    depth: float,
    body: str = "A",
    x: ArrayLike | None = None,
    laws: Laws | None = None,
    number: int = 401,
    reach: float = 4.0,
) -> dict[str, np.ndarray]:
    """Return x and six stresses, by name, of a material point on its path through the contact.

    It is exact for the constant tractions of the elements, as `stress_at`. At the surface give x
    within the elements: between elements with different tangential traction the stress is
    infinite.

    Parameters
    ----------
    contact : State
        The solved contact.
    y, depth : float
        Position of the point, mm.
    body : "A" or "B"
        The body.
    x : array_like, shape (n,), optional
        Positions in x, mm; by default `number` points from `reach` semi-axes a before the contact,
        on the leading side x > 0, to `reach` behind it.
    laws : Laws, optional
        Laws of the bodies; by default the laws of the solution.
    number : int
        Number of points without `x`.
    reach : float
        Largest distance without `x`, over the semi-axis a.

    Returns
    -------
    dict of str to ndarray, shape (n,)
        x in mm, and xx, yy, zz, xy, xz, yz in MPa, in this order.

    Raises
    ------
    ValueError
        If the body is not "A" or "B", x is not a sequence, or a point is not finite or above
        the surface.

    Examples
    --------
    >>> cycle = ts.stress_path(contact, y=0.0, depth=0.35 * scene.hertz.a)
    >>> list(cycle)
    ['x', 'xx', 'yy', 'zz', 'xy', 'xz', 'yz']
    >>> round(float(np.ptp(cycle["xz"]) / scene.hertz.p0), 1)  # range of the orthogonal shear
    0.4
    """
    if x is None:
        distance = reach * semi_axes(contact)[0]
        x = np.linspace(distance, -distance, number)
    x = np.asarray(x, dtype=float)
    if x.ndim != 1:
        raise ValueError("x must be a sequence of numbers")
    points = np.stack(np.broadcast_arrays(x, y, depth), axis=-1)
    return {"x": x} | dict(zip(COMPONENTS, stress_at(contact, points, body, laws).T, strict=True))


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
