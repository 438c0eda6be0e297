"""The design of a table of creep forces, and the contacts at scaled creepages behind it.

At rest all of the contact sticks. Its tractions are singular at the trailing edge, and their
resultants depend on how the elements cover the contact: by 1 % to 2 % with fifteen elements across
it, irregularly from mesh to mesh. Most of this error depends on the second moments of the covered
area, which are known for an ellipse. A fit over many meshes

    slope = limit + c_1 / n + c_2 (moment of x² - exact) + c_3 (moment of y² - exact)

over n elements across the contact yields the limit, and its scatter yields the error bar.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from itertools import pairwise, product
from os import PathLike
from pathlib import Path
from typing import Annotated, Any, ClassVar

import numpy as np
import scipy  # its parts are loaded when first used
from pydantic import AfterValidator, BeforeValidator, Field

from tractive_sam.compute import numeric_settings
from tractive_sam.contact import Model, jacobian_of, solve_on_fitted_mesh
from tractive_sam.lookup import CONTACT, RATIO, check_axis_name
from tractive_sam.mechanics import HertzContact, HertzLine
from tractive_sam.results import State
from tractive_sam.run import read_measured_gap, solve_from_nearby, warn_of_gap, with_creepages
from tractive_sam.scene import Friction, Scene, hashes_of, resolve_parametric_files
from tractive_sam.schema import (
    Check,
    Fault,
    SceneError,
    TomlTable,
    ValidEntries,
    entry,
    optional,
    required,
    shorten,
)
from tractive_sam.studies import Axis, Study


def rest_meshes(
    elements: int, finest: int, wanted: float, *, number: int = 16, spread: float = 3.2
) -> np.ndarray:
    """Return the numbers of elements across the contact on which slopes at rest are solved.

    Parameters
    ----------
    elements, finest : int
        First and largest number of elements of the table.
    wanted : float
        Error bar of forces over mu P; slopes at rest must have a tenth of this error, or less.
    number : int
        Meshes: four times the unknowns of the fit.
    spread : float
        Elements of the finest over elements of the coarsest mesh.
    """
    # From 101 elements slopes are within 0.3 % if forces are wanted within 0.8 % of mu P.
    largest = min(finest, max(2 * elements, 0.8 / wanted))
    across = np.geomspace(largest / spread, largest, number)
    return np.unique(2 * np.rint(0.5 * (across - 1.0)).astype(int) + 1)


def extrapolate_slopes(
    meshes: np.ndarray, slopes: np.ndarray, moments: np.ndarray, *, confidence: float = 0.95
) -> tuple[np.ndarray, np.ndarray]:
    """Extrapolate slopes at rest to an infinitely fine mesh; return (limit, error bar).

    Parameters
    ----------
    meshes : ndarray, shape (M,)
        Elements across the contact.
    slopes : ndarray, shape (M, ...)
        Slopes on each mesh.
    moments : ndarray, shape (M, K)
        Excess moments of the area, on which the slopes depend; zero in the limit.
    confidence : float
        Probability that a slope is within its error bar if scatter is normal.

    Returns
    -------
    limit, bar : ndarray, shape (...)
        Slopes of the limit and half widths of their intervals.
    """
    # The scatter decreases faster than 1/n, as the number of elements at the edge increases.
    weights = meshes[:, None] ** 1.5
    basis = weights * np.column_stack([np.ones(len(meshes)), 1.0 / meshes, moments])
    values = weights * slopes.reshape(len(meshes), -1)
    # Both moments of a circle are equal: the rest of a singular value is rounding.
    inverse = np.linalg.pinv(basis, rcond=1e-6)
    fitted = inverse @ values
    free = max(len(meshes) - np.linalg.matrix_rank(basis, tol=1e-6 * np.abs(basis).max()), 1)
    scatter = np.sqrt(np.sum((values - basis @ fitted) ** 2, axis=0) / free)
    bar = scipy.special.stdtrit(free, 0.5 + 0.5 * confidence) * np.linalg.norm(inverse[0]) * scatter
    return fitted[0].reshape(slopes.shape[1:]), bar.reshape(slopes.shape[1:])


YOUNG, MU, PRESSURE, RADIUS = 2e5, 0.3, 1e3, 1e3
"""Parameters of the scenes that are solved; no scaled result depends on them."""


@dataclass(frozen=True, eq=False)
class Solved:
    """Solution at scaled creepages: scaled forces, their gradient, and error bars.

    Attributes
    ----------
    force : ndarray, shape (3,)
        Q_x, Q_y, M_z.
    bar : ndarray, shape (3,)
        Error bars of the forces.
    gradient : ndarray, shape (3, 3)
        Derivatives of the three by scaled creepages.
    gradient_bar : ndarray, shape (3, 3)
        Error bars of the derivatives at rest; zero elsewhere, since checks of the table find them.
    """

    force: np.ndarray
    bar: np.ndarray
    gradient: np.ndarray
    gradient_bar: np.ndarray = field(default_factory=lambda: np.zeros((3, 3)))


def required_hertz(scene: Scene) -> HertzContact | HertzLine:
    """Return the Hertz contact of a scene; raise a SceneError if its radii form none."""
    if scene.hertz is None:
        raise SceneError(
            [Fault("body", "radii without a closed contact", "radii that close in x and y")]
        )
    return scene.hertz


def required_friction(scene: Scene) -> Friction:
    """Return the friction of a scene; raise a SceneError without [friction], as tables need it."""
    return required(scene.friction, "friction")


class Contacts:
    """Solver of one scene at any scaled creepages, which stores models and last solutions.

    Parameters
    ----------
    scene : Scene
        Scene without a mesh and creepages.
    contact : tuple of float, optional
        a, b, load, mu and shear that scale creepages and forces; by default the scene's.
    """

    keys = ("creepage.longitudinal", "creepage.lateral", "creepage.spin")

    def __init__(self, scene: Scene, contact: tuple[float, ...] | None = None):
        self.scene = scene
        if contact is None:
            hertz, mu = required_hertz(scene), required_friction(scene).mu[0]
            load = required(scene.normal_load, "load.normal")
            contact = hertz.a, hertz.b, load, mu, scene.material.shear
        a, b, load, mu, shear = contact
        c, bound = (a * b) ** 0.5, mu * load
        self._unit = bound * np.array([1.0, 1.0, c])
        self._creepage = bound / (shear * c**2) * np.array([1.0, 1.0, 1.0 / c])
        self._models: dict[int, Model] = {}
        self._last: dict[int, State] = {}
        self.solved = 0

    @numeric_settings()
    def solve(
        self, w: np.ndarray, elements: int, finest: int, wanted: float, gradient: bool = True
    ) -> Solved:
        """Return forces, bars and gradient at w, on meshes refined until bars <= `wanted`.

        At rest there are no forces; the gradient is extrapolated there.

        Raises
        ------
        RuntimeError
            If a contact is not solved.
        """
        meshes = [odd(elements / 2.0), odd(elements / 2.0**0.5), elements]
        states = [self.solve_on_mesh(w, n) for n in meshes]
        forces = [self._scaled(state) for state in states]
        while (bar := _error_bar(*forces[-3:])).max() > wanted and odd(
            meshes[-1] * 2.0**0.5
        ) <= finest:
            meshes.append(odd(meshes[-1] * 2.0**0.5))
            states.append(self.solve_on_mesh(w, meshes[-1]))
            forces.append(self._scaled(states[-1]))
        if not gradient:
            return Solved(forces[-1], bar, np.zeros((3, 3)))
        if np.any(w):
            return Solved(forces[-1], bar, self._gradient(states[-1], meshes[-1]))
        return Solved(forces[-1], bar, *self.slopes_at_rest(rest_meshes(elements, finest, wanted)))

    def slopes_at_rest(self, meshes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the gradient at zero creepage, extrapolated over meshes, and its error bars.

        Parameters
        ----------
        meshes : ndarray, shape (M,)
            Elements across the contact of the meshes to extrapolate from.
        """
        slopes, moments = [], []
        for n in map(int, meshes):
            is_used = n in self._models
            contact = self.solve_on_mesh(np.zeros(3), n)
            slopes.append(self._gradient(contact, n))
            moments.append(self._excess_moments(contact, n))
            if not is_used:  # fine meshes are used once, and their operators are large
                del self._models[n], self._last[n]
        return extrapolate_slopes(meshes, np.array(slopes), np.array(moments))

    def forces(self, w: np.ndarray, elements: int) -> np.ndarray:
        """Return the scaled forces at scaled creepages w, solved on one mesh, shape (3,)."""
        return self._scaled(self.solve_on_mesh(w, elements))

    def _model(self, elements: int) -> Model:
        """Return the model with a number of elements across the contact, cached."""
        if elements not in self._models:
            scene = with_mesh(self.scene, elements, self._reach)
            self._models[elements] = Model(scene, read_measured_gap(scene))
        return self._models[elements]

    @cached_property
    def _reach(self) -> tuple[float, float]:
        """Largest distances in x and y of the contact from the centre, mm."""
        if not self.scene.has_gap:
            hertz = required_hertz(self.scene)
            return float(hertz.a), float(hertz.b)
        smooth = self.scene.replace(friction=None, creepage=None)
        model, (contact,) = solve_on_fitted_mesh(Model(smooth, read_measured_gap(smooth)))
        if not contact.converged:
            raise RuntimeError(f"a contact without friction was not solved: {contact.message}")
        warn_of_gap(model)
        grid, touches = model.grid, contact.pressure > 0.0
        x, y = np.abs(grid.x)[touches.any(axis=1)], np.abs(grid.y)[touches.any(axis=0)]
        return float(x.max() + 0.5 * grid.dx), float(y.max() + 0.5 * grid.dy)

    def _scaled(self, contact: State) -> np.ndarray:
        """Return Q_x/(mu P), Q_y/(mu P) and M_z/(mu P c) of a contact, shape (3,)."""
        # The load of the mesh equals the prescribed one, within the tolerance of the solver.
        return np.array([contact.Qx, contact.Qy, contact.Mz]) / self._unit

    def _excess_moments(self, contact: State, elements: int) -> np.ndarray:
        """Return the relative error of the second moments of the meshed contact area, (2,).

        Shape (2,), x² first, or (0,) for contacts that are no ellipses.
        """
        if self.scene.has_gap:
            return np.empty(0)
        grid, touches = self._model(elements).grid, contact.pressure > 0.0
        a, b = self._reach
        moments = np.array([touches.sum(axis=1) @ grid.x**2, touches.sum(axis=0) @ grid.y**2])
        exact = 0.25 * np.pi * a * b * np.array([a**2, b**2])
        return moments * grid.dx * grid.dy / exact - 1.0

    def solve_on_mesh(self, w: np.ndarray, elements: int) -> State:
        """Return the solved contact at scaled creepages w on one mesh; RuntimeError if it fails.

        Parameters
        ----------
        w : ndarray, shape (3,)
            Longitudinal and lateral creepage and spin, scaled.
        elements : int
            Elements across the contact.

        Raises
        ------
        RuntimeError
            If the contact is not solved.
        """
        model = self._model(elements)
        creepages = dict(zip(self.keys, w * self._creepage, strict=True))
        _, contact = solve_from_nearby(with_creepages(model, creepages), self._last.get(elements))
        self.solved += 1
        if not contact.converged:
            raise RuntimeError(
                f"a contact was not solved: {self.scene.title}, w = {w}: {contact.message}"
            )
        self._last[elements] = contact
        return contact

    def _gradient(self, contact: State, elements: int) -> np.ndarray:
        """Return the derivatives of scaled forces by scaled creepages, shape (3, 3)."""
        creepages = (contact.xi_x, contact.xi_y, contact.spin)
        model = with_creepages(self._model(elements), dict(zip(self.keys, creepages, strict=True)))
        jacobian = jacobian_of(model, contact, only=("xi_x", "xi_y", "spin"))
        slopes = jacobian.loc[["Qx", "Qy", "Mz"], ["xi_x", "xi_y", "spin"]].values
        return slopes / self._unit[:, None] * self._creepage


def _error_bar(
    coarse: np.ndarray,
    middle: np.ndarray,
    fine: np.ndarray,
    *,
    safety: float = 3.0,
    previous: float = 0.7,
    shared: float = 0.4,
) -> np.ndarray:
    """Return error bars of forces solved on three meshes, as with [accuracy], shape (3,).

    Parameters
    ----------
    coarse, middle, fine : ndarray, shape (3,)
        Forces on the meshes.
    safety : float
        Bar over the difference of the last two meshes.
    previous : float
        Weight of the difference of the first two.
    shared : float
        Smallest bar over the largest of the three.
    """
    bars = safety * np.maximum(np.abs(fine - middle), previous * np.abs(middle - coarse))
    return np.maximum(bars, shared * bars.max())


def odd(number: float) -> int:
    """Return the nearest odd integer."""
    return 2 * round(0.5 * (number - 1.0)) + 1


@lru_cache(maxsize=64)
def unit_scene(ratio: float, poisson: float) -> Scene:
    """Return the scene of a Hertz contact with a given a/b and Poisson's ratio, without mesh."""
    # 1/R_x over 1/R_y of an ellipse, see `mechanics.hertz_contact`.
    integral = scipy.special.elliprd
    curvatures = integral(0.0, 1.0 / ratio, ratio) / integral(0.0, ratio, 1.0 / ratio)
    body = {"young": YOUNG, "poisson": poisson}
    flat = {"radius_x": np.inf, "radius_y": np.inf}
    curved = {"radius_x": RADIUS / curvatures**0.5, "radius_y": RADIUS * curvatures**0.5}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # its numbers need not be plausible
        return Scene(
            title=f"Contact of a/b = {ratio:g}",
            body={"A": body | curved, "B": body | flat},
            load={"pressure": PRESSURE},
            creepage=dict.fromkeys(("longitudinal", "lateral", "spin"), 0.0),
            friction={"mu": MU},
        )


def with_mesh(
    scene: Scene,
    elements: int,
    reach: tuple[float, float],
    *,
    margin: int = 2,
    longest: float = 2.0,
) -> Scene:
    """Return the scene with a mesh of `elements` across the shorter of the contact's two sides.

    Parameters
    ----------
    scene : Scene
        The scene.
    elements : int
        Elements across the contact.
    reach : (float, float)
        Half widths of the contact in x and y, mm.
    margin : int
        Additional elements outside of the contact.
    longest : float
        Largest ratio of the sides of an element.
    """
    a, b = reach
    across = [odd(elements * max(1.0, side / cross / longest)) for side, cross in ((a, b), (b, a))]
    half = [side * (1.0 + margin / n) for side, n in zip((a, b), across, strict=True)]
    grid = {"half_length": tuple(half), "elements": tuple(n + margin for n in across)}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return scene.replace(grid=grid)


def _check_name(entries: ValidEntries) -> Iterator[Fault]:
    """Report an axis of a table with an invalid name."""
    name = entries["name"] or _default_name(entries["key"])
    try:
        check_axis_name(name, further=True)
    except ValueError as error:
        yield Fault("name", shorten(name), str(error))


def _default_name(key: str) -> str:
    """Return the name of an axis from its key: the last part (wheelset.y: wheelset_y)."""
    return "wheelset_y" if key == "wheelset.y" else key.rpartition(".")[2]


def _check_positions(entries: ValidEntries) -> Iterator[Fault]:
    """Report an axis of a table whose values lack ascending numeric positions, one for each."""
    values, at = entries["values"], entries["at"]
    if values is None:  # a range of numbers
        return
    if at is None:
        if not all(map(_is_number, values)):
            needed = "a number for each of the values, ascending: their places along the axis"
            yield Fault("at", "nothing, with values that are not numbers", needed)
        elif _does_not_ascend(values):
            yield Fault("values", shorten(values), "ascending numbers, each once")
    elif len(at) != len(values):
        yield Fault("at", f"{len(at)} numbers", f"{len(values)}, as many as there are values")


def _check_order(entries: ValidEntries) -> Iterator[Fault]:
    """Report positions or ranges of an axis that do not ascend."""
    start, stop = entries["start"], entries["stop"]
    if entries["at"] is not None and _does_not_ascend(entries["at"]):
        yield Fault("at", shorten(entries["at"]), "ascending numbers, each once")
    if start is not None and stop is not None and stop < start:
        yield Fault("stop", shorten(stop), "more than start")


def _does_not_ascend(values: tuple[float, ...]) -> bool:
    """Return whether numbers do not ascend strictly."""
    return any(low >= high for low, high in pairwise(values))


def _is_number(value: object) -> bool:
    """Return whether a value is a number and not a bool."""
    return isinstance(value, int | float) and not isinstance(value, bool)


class TableAxis(Axis):
    """Axis of a creep-force table: keys that vary together; numbers are interpolated, files not.

    Numbers, and lists of them, are interpolated, and nodes are added between them. Other values,
    for example files of gaps, are discrete.

    Examples
    --------
    >>> from tractive_sam.tables import TableAxis
    >>> ratio = {"name": "mu2_over_mu1", "at": [0.5, 1.0]}
    >>> axis = TableAxis(key="friction.mu", values=[[0.3, 0.15], [0.3, 0.3]], **ratio)
    >>> axis.entries_at(0.75)["friction.mu"]
    [0.3, 0.225]
    """

    name: str | None = optional(
        "what a table calls it", "a name; by default the last part of the key"
    )
    at: tuple[float, ...] | None = optional(
        "places of the values along the axis", "ascending numbers; the values by default"
    )
    checks: ClassVar[tuple[Check, ...]] = (
        *Axis.checks,
        _check_name,
        _check_positions,
        _check_order,
    )

    @property
    def label(self) -> str:
        """Name of the axis in a table."""
        return self.name or _default_name(self.key)

    @property
    def nodes(self) -> np.ndarray:
        """Positions of the values along the axis, the first nodes of the table."""
        return np.array(self.column() if self.at is None else self.at, float)

    @property
    def apart(self) -> bool:
        """Whether the values are discrete (files), so that none are interpolated."""
        return not all(map(_is_interpolated, self.dimension().columns.items()))

    def entries_at(self, x: float) -> dict[str, Any]:
        """Return the values of the scene keys at a position x along the axis, by key."""
        columns, nodes = self.dimension().columns, self.nodes
        near = int(np.abs(nodes - x).argmin())
        if nodes[near] == x or self.apart:
            return {key: column[near] for key, column in columns.items()}
        return {key: _interpolate(x, nodes, column) for key, column in columns.items()}


def _is_interpolated(item: tuple[str, tuple[Any, ...]]) -> bool:
    """Return whether the values of a non-integer key are numbers, or number lists of one length."""
    key, column = item
    if Scene.find_field(key).annotation is int:
        return False
    lists = [value for value in column if isinstance(value, list | tuple)]
    if lists:
        alike = len(lists) == len(column) and len(set(map(len, lists))) == 1
        return alike and all(_is_number(x) for row in lists for x in row)
    return all(map(_is_number, column))


def _interpolate(x: float, nodes: np.ndarray, column: tuple[Any, ...]) -> Any:
    """Return the value of a key, a number or a list, interpolated at a position x."""
    if isinstance(column[0], list | tuple):
        return [float(np.interp(x, nodes, values)) for values in zip(*column, strict=True)]
    return float(np.interp(x, nodes, column))


class TableError(SceneError):
    """Error that lists every fault of a creep-force table that cannot be built.

    Examples
    --------
    >>> try:
    ...     ts.TableDesign(ellipticity=[1.0, -2.0])
    ... except ts.TableError as error:
    ...     print(error.faults[0].key)
    ellipticity
    """

    subject: ClassVar[str] = "table"


def _as_tuple(value: object) -> object:
    """Return (x,) for a number x; other values unchanged."""
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return (value,) if number else value


def _require_ascending(values: tuple[float, ...]) -> tuple[float, ...]:
    """Return numbers unchanged; raise a ValueError unless they ascend."""
    if _does_not_ascend(values):
        raise ValueError("ascending numbers, each once")
    return values


Ratios = Annotated[
    tuple[Annotated[float, Field(ge=0.1, le=10.0)], ...],
    BeforeValidator(_as_tuple),
    AfterValidator(_require_ascending),
    Field(min_length=1),
]
Poissons = Annotated[
    tuple[Annotated[float, Field(ge=0.0, le=0.5)], ...],
    BeforeValidator(_as_tuple),
    AfterValidator(_require_ascending),
    Field(min_length=1),
]


def _check_finest(entries: ValidEntries) -> Iterator[Fault]:
    """Report a finest mesh that is coarser than the first one."""
    if entries["finest"] < entries["elements"]:
        cure = f"at least {entries['elements']}, as elements is"
        yield Fault("finest", shorten(entries["finest"]), cure)


def _check_keys(entries: ValidEntries) -> Iterator[Fault]:
    """Report ellipticity or Poisson's ratio in a table of one scene."""
    if entries["scene"] is not None:
        for key in ("ellipticity", "poisson"):
            if key in entries.given:
                cure = "an [[axis]] of the scene, for example body.B.radius_y"
                yield Fault(key, "a table of one scene", cure)


def _check_axes(entries: ValidEntries) -> Iterator[Fault]:
    """Report axes with equal names or keys."""
    for what in ("label", "key"):
        names = [getattr(axis, what) for axis in entries["axis"]]
        for name in {name for name in names if names.count(name) > 1}:
            yield Fault("axis", f"{name} {names.count(name)} times", "each once")


def _check_axes_without_scene(entries: ValidEntries) -> Iterator[Fault]:
    """Report axes of other tables than [friction] in a table without a scene."""
    # Keys that do not change the scaling of contacts of Hertz, by mu1 P.
    scaled = ("friction.mu", "friction.angle")
    if entries["scene"] is not None:
        return
    for k, axis in enumerate(entries["axis"]):
        for key in axis.dimension().columns:
            if key not in scaled:
                cure = f"{' or '.join(scaled)}; of others, the [scene] in which they vary"
                yield Fault(f"axis[{k}].key", shorten(key), cure)


def _check_scene(entries: ValidEntries) -> Iterator[Fault]:
    """Report a scene that is not one steady Hertz contact with friction and a normal load."""
    scene = entries["scene"]
    if scene is None:
        return
    for key in ("process", "transient", "duty"):
        if getattr(scene, key):
            yield Fault(f"scene.{key}", "a table", "none: the contact of a table is steady")
    for key, reason in scene.find_exclusions("tables").items():
        yield Fault(f"scene.{key}", "a table", f"none: {reason}")
    if scene.friction is None:
        yield Fault("scene.friction", "nothing", "friction, or there are no creep forces")
    for key in ("force_x", "force_y"):
        if getattr(scene.load, key) is not None:
            yield Fault(f"scene.load.{key}", "a value", "none: creepages are the axes of a table")
    if scene.wheelset is not None and scene.wheelset.normal_load is None:
        cure = "wheelset.normal_load: the contacts of a table have one normal force"
        yield Fault("scene.wheelset.load", f"{scene.wheelset.load:g} N", cure)
    if scene.normal_load is None:
        yield Fault("scene.load", "no normal load", "load.normal or load.pressure")
    if scene.hertz is None or scene.body.infinitely_long:
        yield Fault("scene.body", "no contact of Hertz", "radii that close in x and y")


class TableDesign(TomlTable):
    """Design of a creep-force table: its scene or range of Hertz contacts, axes, tolerance.

    Raises
    ------
    TableError
        With every fault of the design.

    Examples
    --------
    >>> ts.TableDesign(ellipticity=[0.5, 1.0, 2.0], tolerance=0.01).poisson
    (0.3,)
    >>> angle = {"key": "friction.angle", "values": [0, 45, 90]}
    >>> ts.TableDesign(scene="spheres-orthotropic", axis=[angle]).names
    ('angle',)
    """

    title: str = entry("title", default="")
    scene: Scene | None = optional(
        "the scene of the contact, instead of any contact of Hertz of alike bodies",
        "a built-in name, a scene file, or the tables of a scene",
    )
    axis: tuple[TableAxis, ...] = entry("further axes", "a list of tables", ())
    ellipticity: Ratios = entry(
        "a/b, semi-axes in rolling over lateral direction",
        "ascending numbers from 0.1 to 10; values are added between them",
        (1.0,),
    )
    poisson: Poissons = entry(
        "Poisson's ratio", "a number from 0 to 0.5, or several ascending ones", (0.3,)
    )
    tolerance: float = entry(
        "error bar and error of interpolation of forces over mu P", default=0.01, ge=1e-3, le=0.2
    )
    elements: int = entry("elements across a contact to begin with", default=21, ge=15, le=101)
    finest: int = entry("elements across a contact at most", default=101, ge=15, le=401)
    most: int = entry("nodes at most", default=50_000, ge=300, le=10**6)
    seed: int = entry("seed of the points that are held out", default=0, ge=0)
    checks: ClassVar[tuple[Check, ...]] = (
        _check_finest,
        _check_keys,
        _check_axes,
        _check_axes_without_scene,
        _check_scene,
    )
    error_class: ClassVar[type[SceneError]] = TableError

    @classmethod
    def prepare(cls, entries: dict[str, Any], faults: list[Fault]) -> dict[str, Any]:
        """Read the scene that the entries name."""
        if isinstance(entries.get("scene"), str):
            try:
                entries["scene"] = Scene.from_name(entries["scene"])
            except SceneError as error:
                raise TableError(_move_faults(error)) from None
        return entries

    def check_complete(self) -> None:
        """Check the scene at the ends of all axes; TableError with its faults."""
        faults: list[Fault] = []
        for entries in self._each_entry():
            try:
                self._scene_with(entries)
            except SceneError as error:
                faults += [
                    fault for fault in _move_faults(error) if str(fault) not in map(str, faults)
                ]
        if faults:
            raise TableError(faults)

    @classmethod
    def resolve_files(cls, folder: Path, tables: dict[str, Any]) -> dict[str, Any]:
        """Make relative paths in the tables of a design start from a folder; return the tables."""
        return resolve_parametric_files(folder, tables)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the axes other than creepages: log_ratio, poisson (no scene), then others."""
        further = tuple(axis.label for axis in self.axis)
        return further if self.scene is not None else (RATIO, "poisson", *further)

    @property
    def first_nodes(self) -> list[np.ndarray]:
        """First nodes of the axes `names`: ln(a/b) and Poisson's ratio (no scene), then others."""
        further = [axis.nodes for axis in self.axis]
        if self.scene is not None:
            return further
        return [np.log(np.array(self.ellipticity)), np.array(self.poisson, float), *further]

    @property
    def apart(self) -> tuple[str, ...]:
        """Names of the discrete axes, along which forces are not interpolated."""
        return tuple(axis.label for axis in self.axis if axis.apart)

    @property
    def contact(self) -> dict[str, float] | None:
        """Quantities (a, b, load, mu, shear) that scale a table of one scene; else None."""
        if self.scene is None:
            return None
        hertz, mu = required_hertz(self.scene), required_friction(self.scene).mu[0]
        load = required(self.scene.normal_load, "load.normal")
        values = (hertz.a, hertz.b, load, mu, self.scene.material.shear)
        return dict(zip(CONTACT, map(float, values), strict=True))

    @cached_property
    def symmetries(self) -> tuple[bool, bool]:
        """Whether forces mirror at y = 0 with creepages, and whether they reverse with them."""
        places = [
            sorted({*nodes, *(() if name in self.apart else 0.5 * (nodes[1:] + nodes[:-1]))})
            for name, nodes in zip(self.names, self.first_nodes, strict=True)
        ]
        scenes = [self.scene_at(place) for place in product(*places)]
        coupled = (
            scene.body.elasticity(scene).coupled or _has_named_law(scene) for scene in scenes
        )
        return all(map(_is_mirror_symmetric, scenes)), not any(coupled)

    @property
    def files(self) -> dict[str, str]:
        """SHA-256 of the files that its scenes name, by path."""
        if self.scene is None:
            return {}
        return hashes_of([self.scene, *map(self._scene_with, self._each_entry())])

    def ratio(self, place: tuple[float, ...]) -> float:
        """Return a/b at a point of the axes `names`."""
        if self.scene is not None:
            hertz = required_hertz(self.scene)
            return float(hertz.a / hertz.b)
        return float(np.exp(place[0]))

    def contacts(self, place: tuple[float, ...]) -> Contacts:
        """Return the solver of contacts at a point of the axes `names`."""
        scene = self.scene_at(place)
        return Contacts(scene, None if self.contact is None else tuple(self.contact.values()))

    def scene_at(self, place: tuple[float, ...]) -> Scene:
        """Return the scene at a point of the axes `names`, without mesh, at zero creepages."""
        further = place if self.scene is not None else place[2:]
        entries: dict[str, Any] = {}
        for axis, x in zip(self.axis, further, strict=True):
            entries |= axis.entries_at(x)
        return self._scene_with(entries, place)

    def _scene_with(self, entries: dict[str, Any], place: tuple[float, ...] = (0.0, 0.3)) -> Scene:
        """Return the scene at a point with `entries`, zero creepages, and no unused tables."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # its numbers may be of no steel
            if self.scene is None:
                scene = unit_scene(float(np.exp(place[0])), place[1])
            else:
                rolls = {"longitudinal": 0.0, "lateral": 0.0, "spin": 0.0}
                speed = None if self.scene.creepage is None else self.scene.creepage.speed
                rolls |= {} if speed is None else {"speed": speed}
                answers = required_friction(self.scene).temperature is not None
                # These affect neither the creep forces nor the meshes of a table.
                omitted = ["wear", "subsurface", "fatigue", "residual", "accuracy", "grid"]
                omitted += [] if answers else ["heat"]
                scene = self.scene.replace(**dict.fromkeys(omitted), creepage=rolls)
            scene = scene.replace(**entries) if entries else scene
        if scene.wheelset is not None and len(patches := scene.wheel_rail.patches) > 1:
            given = f"y = {scene.wheelset.y:g} mm, {len(patches)} patches"
            raise SceneError([Fault("wheelset", given, "positions with one patch in a table")])
        return scene

    def _each_entry(self) -> Iterator[dict[str, Any]]:
        """Yield scene entries for each value of each axis, the other axes at their first value."""
        first: dict[str, Any] = {}
        for axis in self.axis:
            first |= axis.entries_at(axis.nodes[0])
        for axis in self.axis:
            for x in axis.nodes:
                yield first | axis.entries_at(x)


def is_design(path: str | PathLike[str]) -> bool:
    """Return whether a TOML file has keys of a table design that studies and scenes lack.

    A file with a scene and axes alone may be a study as well, and is not regarded as a design.
    """
    try:
        tables = TableDesign.read_tables(path)
    except SceneError:
        return False
    keys = TableDesign.model_fields.keys() - Study.model_fields.keys() - Scene.model_fields.keys()
    axis_keys = TableAxis.model_fields.keys() - Axis.model_fields.keys()
    axes = tables.get("axis")
    axes = axes if isinstance(axes, list) else []
    return bool(keys & tables.keys()) or any(
        isinstance(axis, dict) and axis_keys & axis.keys() for axis in axes
    )


def _move_faults(error: SceneError) -> list[Fault]:
    """Return the faults of a scene with the prefix "scene" of the design."""
    return [fault.under("scene") for fault in error.faults]


def _is_mirror_symmetric(scene: Scene) -> bool:
    """Return whether friction, gap and laws of a scene are symmetric about y = 0."""
    friction = required_friction(scene)
    mu1, mu2 = friction.mu
    aligned = mu1 == mu2 or friction.angle % 90.0 == 0.0
    uneven = scene.has_gap or friction.across is not None
    return aligned and not uneven and not _has_named_law(scene)


def _has_named_law(scene: Scene) -> bool:
    """Return whether a scene has a user-defined law: its symmetry is unknown."""
    tables = (scene.friction, scene.elasticity)
    return any(table is not None and table.named_law is not None for table in tables)
