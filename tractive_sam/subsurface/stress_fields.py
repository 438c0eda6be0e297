"""Stress, displacement and elastic energy of the bodies of a contact, and their largest stress."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Protocol, cast

import numpy as np
from numpy.typing import ArrayLike

from tractive_sam.contact import Laws
from tractive_sam.kernels import half_space as formula
from tractive_sam.kernels.tops import ENDED, GOES_ON, climb, find_tops, last_steps, stencil
from tractive_sam.mechanics import Elasticity, HalfSpaces, LinearHalfSpaces, Steel, Strips
from tractive_sam.operators import Lattice, transform_quadrants
from tractive_sam.results import COMPONENTS, Grid, Maximum, PlaneStress, Point, State, widen_field
from tractive_sam.scene import Plane, Scene, Subsurface
from tractive_sam.subsurface import anisotropic  # noqa: F401, registers its stress solver
from tractive_sam.subsurface.layered import LayeredLevels, StressOfEach, with_interfaces
from tractive_sam.subsurface.sources import (
    SIGNS,
    MultiLevel,
    StressSource,
    StressWithResidual,
    StripLevels,
    stress_source,
    tractions_on_bodies,
)


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
        cls,
        contact: Loading,
        names: Sequence[str],
        laws: Laws | None = None,
        beyond: int = 0,
        residual: bool = True,
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
        residual : bool
            Whether the solver adds the residual stress of the scene.

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
        each = bodies, signs, grid, tractions
        linear = any(isinstance(body, LinearHalfSpaces) for body in bodies)
        source = StressOfEach(*each) if linear else stress_source(bodies[0], *each)
        if residual and contact.scene.residual is not None:
            steel = [contact.scene.steel.get(name, Steel()) for name in names]
            worn = np.stack([worn_depth(contact, name) for name in names])
            source = StressWithResidual(source, steel, grid.y, worn)
        return cls(tuple(names), tractions, bodies, source)

    def in_contact_axes(self, stress: np.ndarray) -> np.ndarray:
        """Change half-spaces' stresses (bodies, 6, ...), in place, to contact axes; return them."""
        for tensor, name in zip(stress, self.names, strict=True):
            tensor[4:] *= SIGNS[name]
        return stress


def worn_depth(contact: Loading, body: str) -> np.ndarray:
    """Return the depth worn off a body before it enters a contact, shape (n_y,), mm."""
    wear = getattr(contact, "wear", None)
    if wear is None:  # stored tractions have none
        return np.zeros(contact.grid.elements[1])
    return contact.scene.turns.share_of_entering(body) * wear[-1]


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
    layered = contact.scene.body.responses
    return with_interfaces(
        depths(subsurface, semi_axes(contact)[0]), [layered[name] for name in subsurface.bodies]
    )


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
    residual: bool = True,
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
    residual : bool
        Whether to add the residual stress of the scene.

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
        LoadedBodies.from_contact(contact, bodies, laws, beyond, residual),
        check_depths(depths),
        threads,
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
    contact: State,
    points: ArrayLike,
    body: str = "A",
    laws: Laws | None = None,
    residual: bool = True,
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
    residual : bool
        Whether to add the residual stress of the scene.

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
    load = LoadedBodies.from_contact(contact, (body,), laws, residual=residual)
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


def displacement(
    contact: State, body: str = "A", depth: float = 0.0, laws: Laws | None = None
) -> np.ndarray:
    """Return the elastic displacement (3, n_x, n_y) of one body at a depth, mm.

    It is relative to distant points of the body, in the axes of the contact, for both bodies: z
    points into body A. Rigid motion by approach and creepage is not part of it.

    Parameters
    ----------
    contact : State
        The solved contact.
    body : "A" or "B"
        The body.
    depth : float
        Depth below the surface, mm.
    laws : Laws, optional
        Laws of the bodies; by default the laws of the solution.

    Returns
    -------
    ndarray, shape (3, n_x, n_y)
        (u_x, u_y, u_z), mm.

    Raises
    ------
    ValueError
        If the body is not "A" or "B", the depth is negative or not finite, the bodies are not
        homogeneous half-spaces, or the contact is a line contact: its displacement relative to
        distant points is infinite.

    Examples
    --------
    >>> from tractive_sam.subsurface import displacement
    >>> contact.grid.elements, displacement(contact, "B", depth=0.1).shape
    ((91, 91), (3, 91, 91))
    """
    (depth,) = check_depths([depth])
    material = _half_spaces(contact, body, laws)
    grid, modulus = contact.grid, getattr(material, body).shear
    lattice = Lattice(grid.elements, grid.dx, grid.dy)
    tractions = np.concatenate((contact.traction, contact.pressure[None]))
    (on_body,) = tractions_on_bodies(tractions, (SIGNS[body],))
    px, py = lattice.padded
    table = formula.displacement_quadrant(
        (px // 2 + 1, py // 2 + 1), grid.dx, grid.dy, depth, getattr(material, body).poisson
    )
    kernels = {
        name: transform_quadrants([(values, formula.PARITY[name])], lattice.padded)
        for name, values in table.items()
    }
    kernels["yx"] = kernels["xy"]
    spectra = np.fft.rfft2(on_body, lattice.padded)
    moved = [sum(kernels[a + b] * spectra[k] for k, b in enumerate("xyz")) for a in "xyz"]
    nx, ny = grid.elements
    field = np.fft.irfft2(np.stack(moved), lattice.padded)[:, :nx, :ny] / modulus
    field[2] *= SIGNS[body]
    return field


def elastic_energy(contact: State, laws: Laws | None = None) -> float:
    """Return the elastic energy of both bodies and of an interfacial layer, N mm.

    It is half the work of the tractions on the displacements of the surfaces, which is the mean
    over the elements.

    Parameters
    ----------
    contact : State
        The solved contact.
    laws : Laws, optional
        Laws of the bodies; by default the laws of the solution.

    Raises
    ------
    ValueError
        See `displacement`.

    Examples
    --------
    >>> from tractive_sam.subsurface import elastic_energy
    >>> frictionless = ts.solve(scene.replace(friction=None, creepage=None))
    >>> hertz = scene.hertz  # its energy is 2/5 of the load times the approach
    >>> round(elastic_energy(frictionless) / (0.4 * hertz.load * hertz.approach), 3)
    1.0
    """
    work = 0.0
    for body, sign in SIGNS.items():
        moved = displacement(contact, body, 0.0, laws)
        tangential = (contact.traction * moved[:2]).sum()
        work += sign * float(tangential + (contact.pressure * moved[2]).sum())
    layer = (laws or Laws.of_contact(contact)).elasticity.layer
    work += layer * float((contact.traction**2).sum())
    return 0.5 * work * contact.grid.element_area


def _half_spaces(contact: State, body: str, laws: Laws | None) -> HalfSpaces:
    """Return the bodies of a contact as HalfSpaces; ValueError for strips and other laws."""
    if body not in SIGNS:
        raise ValueError(f'a body is "A" or "B", not {body!r}')
    elasticity = (laws or Laws.of_contact(contact)).elasticity
    elasticity.single_body(body)  # raises for a law that does not give the stress
    bodies = getattr(elasticity, "bodies", elasticity)
    if isinstance(bodies, Strips):
        raise ValueError(
            "the displacement of a line contact relative to distant points is infinite: give a "
            "body a finite radius_y"
        )
    if not isinstance(bodies, HalfSpaces):
        raise ValueError(f"the law {bodies!r} gives no displacement inside bodies; use HalfSpaces")
    return bodies


_NOWHERE: Point = (np.nan, np.nan, np.nan)


@dataclass(frozen=True)
class MaximumSearch:
    """Settings of the search for the largest stress below the surface.

    Attributes
    ----------
    shallowest : float
        Depth of the first layer over the longer side of an element. Steps of the traction between
        elements change the stress by (1 + k z) exp(-k z), k = 2 pi over the side: at the depth of
        one element by a per cent, which causes local maxima, at two by 5e-5.
    deepest : float
        Smallest depth of the last layer over half of the shorter side of the contact: the maximum
        of a Hertz contact is at 0.45 to 0.79.
    candidates : int
        Local maxima that are refined.
    steps : int
        Largest number of Newton steps: longer searches oscillate between elements near the surface.
    rise : float
        Largest ratio of a maximum to the start of its search. For a Hertz contact it is 1.07 from
        half a layer above and a quarter of the depth aside.
    close : float
        Part of the stress at the surface: a search path that ends at the first layer below it
        cannot exceed the surface.
    """

    shallowest: float = 2.0
    deepest: float = 0.8
    candidates: int = 6
    steps: int = 6
    rise: float = 1.1
    close: float = 0.99


_SEARCH = MaximumSearch()


def stress_maximum(contact: State, body: str = "A", laws: Laws | None = None) -> Maximum:
    """Return the largest equivalent stress inside and at the surface of a body, with positions.

    The search starts in layers at depths in a geometric sequence, with elements combined in blocks
    with sides up to the depth. The largest local maxima are refined with blocks that grow with
    their distance. For constant tractions on the elements the error of the value is 6e-4, of the
    position a hundredth of its depth (`benchmarks/whole_roll.py`). If two maxima are nearer than
    the layers, the result may be the smaller one.

    At the surface the stress is computed between the elements, at the edge of the contact and at
    the border of stick and slip, from differences of displacements: on a mesh the stress is
    infinite on every edge with a jump of the tangential traction (`subsurface.sources`). Depths
    of less than two elements are not searched: if elements are longer than about a quarter of the
    smaller half width of the contact, the result for the interior is too small.

    Parameters
    ----------
    contact : State
        The solved contact.
    body : "A" or "B"
        The body.
    laws : Laws, optional
        Criterion and bodies; by default the laws of the solution.

    Returns
    -------
    Maximum
        Zero without position if there is no contact.

    Raises
    ------
    ValueError
        If the body is not "A" or "B".

    Examples
    --------
    >>> top = ts.stress_maximum(contact, "A")
    >>> round(top.interior / scene.hertz.p0, 2), round(top.interior_at[2] / scene.hertz.a, 1)
    (0.67, 0.5)
    """
    return _maxima(contact, (body,), laws)[body]


def maxima_by_body(contact: State, laws: Laws | None = None) -> dict[str, Maximum]:
    """Return the largest stress in each body of [subsurface], by body; {} without the table.

    Examples
    --------
    >>> list(maxima_by_body(contact))
    ['A', 'B']
    """
    subsurface = contact.scene.subsurface
    return {} if subsurface is None else _maxima(contact, subsurface.bodies, laws)


def _maxima(contact: State, bodies: Sequence[str], laws: Laws | None) -> dict[str, Maximum]:
    """Return the largest stress in and on each of several bodies, by body; 0 without load."""
    laws = laws or Laws.of_contact(contact, ("elasticity", "criterion"))
    load, criterion = LoadedBodies.from_contact(contact, bodies, laws), laws.criterion
    if not load.tractions.any():
        nothing = Maximum(criterion, 0.0, _NOWHERE, np.nan, _NOWHERE, 0.0, _NOWHERE)
        return dict.fromkeys(load.names, nothing)
    levels = load.source.levels(criterion)
    surface = levels.surface(contact.sliding)
    tops = [top[0] for top in surface]
    layered = isinstance(levels, LayeredLevels)
    interior = levels.interior(tops) if layered else _interior(levels, tops)
    faces = levels.interfaces() if layered else [()] * len(tops)
    maxima = {}
    for name, above, below, of_layers in zip(load.names, surface, interior, faces, strict=True):
        larger = below if below[0] > above[0] else above
        maximum = Maximum(criterion, *larger, *below, *above)
        maxima[name] = replace(maximum, interfaces=of_layers)
    return maxima


def _interior(levels: MultiLevel | StripLevels, surface: list[float]) -> list[tuple[float, Point]]:
    """Return (value, position) of the largest stress below each body's surface; nan if none."""
    # Depths in geometric sequence, mm, of the layers in which the search starts.
    first, deepest = _SEARCH.shallowest * levels.side, _SEARCH.deepest * levels.half_width
    count = max(3, int(np.ceil(np.log(deepest / first) / np.log(levels.growth))) + 1)
    depths = first * levels.growth ** np.arange(count)
    bound, floor = np.array(surface), float(depths[0])
    bodies, tops, values = _climb_to_maxima(levels, *_starts(levels, depths), floor, bound)
    # A search path that ends at the floor would continue to the surface, unless that is lower.
    below = (tops[:, 2] > floor) | (values > bound[bodies])
    maxima: list[tuple[float, Point]] = [(np.nan, _NOWHERE)] * len(surface)
    for k in np.flatnonzero(below)[np.argsort(values[below])]:
        x, y, depth = tops[k].tolist()
        maxima[bodies[k]] = float(values[k]), (x, y, depth)
    return maxima


def _starts(levels: MultiLevel | StripLevels, depths: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return bodies (n,) and points (n, 3) of each body's largest local maxima in stress layers."""
    layers = [levels.layer(depth) for depth in depths]
    none = np.empty((len(layers[0].values), 0, 0))
    values = [*(layer.values for layer in layers), none]
    # The second layer is not compared with the first, where the stress of the surface may end.
    higher = [none, none, *values[1:]]
    starts = []
    for layer, above, here, below in zip(layers, higher, values, values[1:], strict=False):
        body, value, i, j, deeper = find_tops(here, above, below).T
        starts.append((body.astype(int), value, layer.points(i, j, levels.growth**deeper)))
    bodies, value, at = (np.concatenate(each) for each in zip(*starts, strict=True))
    order = np.argsort(-value)
    chosen = [order[bodies[order] == body][: _SEARCH.candidates] for body in range(len(none))]
    return bodies[np.concatenate(chosen)], at[np.concatenate(chosen)]


def _climb_to_maxima(
    levels: MultiLevel | StripLevels,
    bodies: np.ndarray,
    at: np.ndarray,
    floor: float,
    surface: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Climb from points to local maxima of stress; return bodies, points and values.

    A search path is abandoned if it ends at or below another one, or at the floor below a larger
    stress at the surface.

    Returns
    -------
    bodies, points, values : ndarray, shapes (n,), (n, 3) and (n,)
        Body, position and stress of each maximum.
    """
    barred, best = np.zeros(len(bodies), dtype=bool), np.zeros(len(surface))
    threshold = _SEARCH.close * surface[bodies]
    ended = []
    for step in range(_SEARCH.steps):
        values = levels.stress_around(bodies, stencil(at), at)
        if step == 0:
            highest = _SEARCH.rise * values[:, 0]
        fates = climb(at, barred, best, values, bodies, highest, threshold, floor, step == 0)
        last, on = fates == ENDED, fates == GOES_ON
        ended.append((bodies[last], at[last]))
        if not on.any():
            break
        bodies, at, barred, highest, threshold = (
            each[on] for each in (bodies, at, barred, highest, threshold)
        )
    bodies, at = (np.concatenate(each) for each in zip(*ended, strict=True))
    values = levels.stress_around(bodies, stencil(at), at, closely=True)
    return bodies, at, last_steps(at, values, floor)
