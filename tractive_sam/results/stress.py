"""Stress below the surface: on planes, its largest value, fatigue by its cycles, and columns."""

import math
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np

from tractive_sam.description import ShortArrays
from tractive_sam.mechanics import (
    VON_MISES,
    Criterion,
    CycleCriterion,
    Steel,
    StressCriterion,
    max_shear,
    principal_stresses,
    von_mises,
)
from tractive_sam.results.quantity import (
    MESH_AXES,
    Quantity,
    Rows,
    Table,
    Variable,
    error_bar_column,
    index_by_name,
)
from tractive_sam.scene import Plane, Scene
from tractive_sam.schema import required

COMPONENTS = ("xx", "yy", "zz", "xy", "xz", "yz")
"""Components of a stress, in the order of all arrays of stress."""

_stress = partial(Quantity, unit="MPa", outside=math.nan)  # it is not zero outside the mesh

STRESS = index_by_name(
    (
        _stress(VON_MISES.name, long_name=VON_MISES.long_name),
        *(_stress(2 * axis, long_name=f"normal stress in {axis}") for axis in "xyz"),
        *(_stress(axes, long_name=f"shear stress {axes}") for axes in ("xy", "xz", "yz")),
    )
)
"""Functions on a plane below the surface, stored with the fields."""

FATIGUE_FIELDS = index_by_name(
    (
        Quantity("utilisation", "1", "ratio of the equivalent stress of the cycle to its limit",
                 dims=("y", "depth")),
        Quantity("residual_shear", "MPa",
                 "sqrt(J2) of the cycle with the residual stress due to rolling that minimises it",
                 dims=("y", "depth")),
        Quantity("path_radius", "MPa",
                 "sqrt(J2) of the cycle minus the constant deviator that minimises it",
                 dims=("y", "depth")),
        Quantity("inverse_yield_factor", "1",
                 "1 over the load factor at which the cycle with the residual stress of the "
                 "material first yields", dims=("y", "depth")),
        Quantity("residual_xx", "MPa", "residual stress of the material in x", dims=("y", "depth")),
        Quantity("residual_yy", "MPa", "residual stress of the material in y", dims=("y", "depth")),
        Quantity("local_limit", "MPa", "fatigue limit of the material", dims=("y", "depth")),
        Quantity("local_yield", "MPa", "yield stress in shear of the material",
                 dims=("y", "depth")),
        Quantity("local_layer", "1", "number of the layer, from the surface down, from 0",
                 dims=("y", "depth")),
        Quantity("damage", "1", "damage of the material", dims=("y", "zeta")),
        Quantity("worn", "mm", "depth worn off the body", dims=("y",)),
    )
)  # fmt: skip
"""Functions over the section of a body, from fatigue, stored with the fields."""


@dataclass(frozen=True, eq=False, repr=False)
class PlaneStress(ShortArrays):
    """Full stress (six components) of one body at the points of a section plane, MPa.

    Attributes
    ----------
    body : "A" or "B"
        The body.
    plane : Plane
        The plane; its text is `str(plane)`.
    position : float
        The constant x, y or depth of the plane, mm.
    axes : dict of str to ndarray
        Names and coordinates of the two axes of the arrays, in their order, mm: "y" and "depth"
        at constant x, "x" and "depth" at constant y, "x" and "y" at constant depth; "along" and
        "depth" around an inclusion, the first from its centre.
    components : dict of str to ndarray
        xx, yy, zz, xy, xz, yz in the axes of the contact, MPa.
    block : int, optional
        Block of a duty cycle, from 0.

    Examples
    --------
    >>> stress = ts.stress_on_plane(contact, "x=0")
    >>> list(stress.axes), list(stress.components)
    (['y', 'depth'], ['xx', 'yy', 'zz', 'xy', 'xz', 'yz'])
    >>> bool(stress.von_mises.max() < scene.hertz.p0)
    True
    """

    body: str
    plane: Plane
    position: float
    axes: dict[str, np.ndarray]
    components: dict[str, np.ndarray]
    block: int | None = None

    @property
    def path(self) -> str:
        """Path of its table: "stress/[block-k/]body/plane"."""
        block = "" if self.block is None else f"block-{self.block}/"
        return f"stress/{block}{self.body}/{self.plane}"

    @property
    def table(self) -> Table:
        """The stress as a table, with the equivalent stress of von Mises."""
        depth = Quantity("depth", "mm", "depth below the surface of the body")
        along = Quantity("along", "mm", "distance from the centre of an inclusion along x")
        about = {**MESH_AXES, "depth": depth, "along": along}
        axes = {name: Variable(about[name], (name,), values) for name, values in self.axes.items()}
        values = self.components | {VON_MISES.name: self.by(VON_MISES)}
        variables = {name: Variable(STRESS[name], tuple(axes), values[name]) for name in STRESS}
        return Table(variables, axes, {"position": self.position})

    @classmethod
    def from_table(
        cls, rows: Rows[Table], body: str, plane: str, block: int | None, row: int
    ) -> "PlaneStress":
        """Return the stress of a record in a sequence of tables."""
        table = rows[row]
        axes = {name: axis.data for name, axis in table.axes.items()}
        components = {name: table[name] for name in COMPONENTS}
        position = table.attributes["position"]
        named = Plane("y", position, label=plane) if "along" in axes else Plane.parse(plane)
        return cls(body, named, position, axes, components, block)

    @property
    def along(self) -> tuple[str, np.ndarray]:
        """Name ("x" or "y") and coordinates, mm, of the first axis of the plane."""
        return next(iter(self.axes.items()))

    @property
    def depth(self) -> np.ndarray:
        """Depths of the plane's points, mm: its second axis, or one depth if it is horizontal."""
        return self.axes.get("depth", np.array([self.position]))

    @cached_property
    def _tensor(self) -> np.ndarray:
        """Stress components stacked in the order of `COMPONENTS`, shape (6, ...), MPa."""
        return np.stack([self.components[name] for name in COMPONENTS])

    def by(self, criterion: StressCriterion) -> np.ndarray:
        """Return the value of a stress criterion at each point of the plane, in its unit."""
        return criterion(self._tensor)

    @cached_property
    def von_mises(self) -> np.ndarray:
        """Equivalent stress of von Mises at each point of the plane, MPa."""
        return von_mises(self._tensor)

    @cached_property
    def max_shear(self) -> np.ndarray:
        """Largest shear stress (sigma_1 - sigma_3)/2 of the three-dimensional stress, MPa."""
        return max_shear(self._tensor)

    @cached_property
    def principal(self) -> np.ndarray:
        """Principal stresses, the largest first, shape (3, ...), MPa."""
        return principal_stresses(self._tensor)


@dataclass(frozen=True, eq=False, repr=False)
class InclusionPassage(ShortArrays):
    """Contact and stress while an inclusion passes, by its position.

    Attributes
    ----------
    body : "A" or "B"
        The body that contains it.
    inclusion : str
        Its name: "inclusion-1" is the first one in [[inclusion]].
    place : ndarray, shape (n,)
        Positions of its centre in x, descending, mm.
    p_max : ndarray, shape (n,)
        Peak contact pressure, MPa; nan at positions where the contact is not solved, and if the
        lift does not change it.
    lift : ndarray, shape (n,)
        Displacement of the surface above its centre, out of the body, mm.
    von_mises : ndarray, shape (n,)
        Largest equivalent stress of von Mises in the body beside it, MPa.
    block : int, optional
        Block of a duty cycle, from 0.

    Examples
    --------
    >>> hole = ts.Inclusion(at=[0.0, 0.0, 1.5], radii=0.1, young=0.0, cells=5)
    >>> passage = ts.roll(scene.replace(inclusion=[hole])).passage("A", "inclusion-1")
    >>> passage.von_mises.shape, bool(abs(passage.place[passage.von_mises.argmax()]) < 0.5)
    ((101,), True)
    """

    body: str
    inclusion: str
    place: np.ndarray
    p_max: np.ndarray
    lift: np.ndarray
    von_mises: np.ndarray
    block: int | None = None

    quantities: ClassVar = index_by_name(
        Quantity(name, unit, text, dims=("moment",))
        for name, unit, text in (
            ("place", "mm", "position of the centre of the inclusion in x"),
            ("p_max", "MPa", "peak contact pressure above the lifted surface"),
            ("lift", "mm", "displacement of the surface above the inclusion, out of the body"),
            ("von_mises", "MPa", "largest von Mises stress of the body next to the inclusion"),
        )
    )

    @property
    def path(self) -> str:
        """Path of its table: "passage/body/inclusion-1"."""
        return f"passage/{self.body}/{self.inclusion}"

    @property
    def table(self) -> Table:
        """The passage as a table."""
        variables = {
            name: Variable(quantity, quantity.dims, getattr(self, name))
            for name, quantity in self.quantities.items()
        }
        moment = Quantity("moment", "1", "number of the position during the passage")
        numbers = np.arange(float(self.place.size))
        return Table(variables, {"moment": Variable(moment, ("moment",), numbers)})

    @classmethod
    def from_table(
        cls, rows: Rows[Table], body: str, inclusion: str, block: int | None, row: int
    ) -> Self:
        """Return the passage of a record in a sequence of tables."""
        table = rows[row]
        return cls(body, inclusion, **{k: table[k] for k in cls.quantities}, block=block)


Point = tuple[float, float, float]
"""(x, y, depth), mm."""


_on_interface = partial(Quantity, needs=("subsurface", "body.is_layered"), bodies_of="subsurface")


@dataclass(frozen=True)
class InterfaceStress:
    """Largest stress on an interface of a body with layers, which may detach them, in MPa.

    Attributes
    ----------
    shear, shear_at : float, tuple of float
        Largest shear stress on the interface, and its position (x, y, depth), mm.
    tension, tension_at : float, tuple of float
        Largest normal stress on the interface, positive in tension, and its position.

    Examples
    --------
    >>> coated = ts.Scene.builtin("coated-roller").replace(grid={"elements": [9, 9]})
    >>> (face,) = ts.stress_maximum(ts.solve(coated), "A").interfaces
    >>> face.shear_at[2], face.shear > face.tension
    (1.0, True)
    """

    shear: float
    shear_at: Point
    tension: float
    tension_at: Point
    columns: ClassVar[tuple[Quantity, ...]] = tuple(
        column
        for name, text in (("shear", "shear stress"), ("tension", "normal stress, tension above 0"))
        for column in (
            _on_interface(
                f"interface_{name}",
                "MPa",
                f"largest {text}, on the interfaces of layers",
                dims=("body",),
                over_blocks="largest",
            ),
            _on_interface(
                f"interface_{name}_at",
                "mm",
                f"position (x, y, depth) of interface_{name}",
                dims=("body", "position"),
                place_of=f"interface_{name}",
            ),
        )
    )
    """Columns of the largest values in each body."""


@dataclass(frozen=True)
class Maximum:
    """Largest stress in a body by a criterion, inside and at the surface, with positions in mm.

    Attributes
    ----------
    criterion : StressCriterion or CycleCriterion
        Criterion that gives one number of the stress, in the unit of the values. For a cycle, which
        covers all x, the place has no x.
    value, at : float, tuple of float
        The larger of the two below.
    interior, interior_at : float, tuple of float
        The largest local maximum at least two elements below the surface; nan if the stress falls
        monotonically from the surface. A maximum exactly two elements deep is a bound: the actual
        one is closer to the surface.
    surface, surface_at : float, tuple of float
        The largest value at the surface; see `subsurface.sources.largest_at_surface`.
    interfaces : tuple of InterfaceStress
        Largest stresses on the interfaces of a body with layers, from the surface down.

    Examples
    --------
    >>> top = ts.stress_maximum(contact)
    >>> top.value == max(top.interior, top.surface)
    True
    """

    criterion: Criterion | None
    value: float
    at: Point
    interior: float
    interior_at: Point
    surface: float
    surface_at: Point
    interfaces: tuple[InterfaceStress, ...] = field(default=(), repr=False)


def _empty() -> np.ndarray:
    """Return an empty array, the default of a field."""
    return np.zeros(0)


@dataclass(frozen=True, eq=False, repr=False)
class BodyFatigue(ShortArrays):
    """Fatigue of the material of one body in a pass: utilisation, shakedown and damage over (y, z).

    Fields have the shape (n_y, n); the first depth is the surface, the next one element deep. At
    the surface they follow from displacements between the elements, as the largest stress does.

    Attributes
    ----------
    body : str
        "A" or "B".
    y, depth : ndarray
        Lateral place, shape (n_y,), and depth below the present surface, shape (n,), mm.
    utilisation : ndarray
        Equivalent stress of the criterion over its limit, at least 0; nan without a limit.
    residual_shear : ndarray
        sqrt(J2) that remains of the cycle with the best residual stress that rolling can leave:
        rho_xx of each point and rho_yy of each depth, MPa (Melan).
    path_radius : ndarray
        sqrt(J2) that remains with the best constant deviator, MPa: a lower bound for any residual
        stress.
    criterion : CycleCriterion or None
        Criterion of the utilisation.
    shear_yield : float
        k, MPa; nan without a yield stress.
    inverse_yield_factor : ndarray, shape (n_y, n)
        1 over the load factor at which the cycle first yields, with the residual stress of the
        material; of scenes with [residual] and a yield stress. Other bodies have an empty array
        here, and in the next ones.
    residual_xx, residual_yy : ndarray, shape (n_y, n)
        Residual stress of the material, MPa; of bodies with residual stress.
    local_limit, local_yield : ndarray, shape (n_y, n)
        Fatigue limit, and yield stress in shear, MPa; of bodies whose strength depends on depth.
    local_layer : ndarray, shape (n_y, n)
        Number of the layer, from the surface down, from 0; of bodies with strengths of layers.
    zeta : ndarray, shape (m,)
        Depths of the material below the *unworn* surface, mm; of a roll with a limit.
    damage : ndarray, shape (n_y, m)
        Miner's sum so far: at 1 a crack starts. Material with zeta < worn is worn off; its value
        is its last one.
    worn : ndarray, shape (n_y,)
        Depth worn off this body, mm.
    steel : Steel
        Material of all depths; a file does not contain it.

    Examples
    --------
    >>> settings = {"shear_yield": 300.0, "sensitivity": 0.333, "limit": 250.0}
    >>> cycled = ts.fatigue(ts.solve(scene.replace(fatigue=settings)))["A"]
    >>> cycled.shakedown_lower <= cycled.shakedown_upper
    True
    """

    body: str
    y: np.ndarray
    depth: np.ndarray
    utilisation: np.ndarray
    residual_shear: np.ndarray
    path_radius: np.ndarray
    criterion: CycleCriterion | None
    shear_yield: float
    inverse_yield_factor: np.ndarray = field(default_factory=_empty)
    residual_xx: np.ndarray = field(default_factory=_empty)
    residual_yy: np.ndarray = field(default_factory=_empty)
    local_limit: np.ndarray = field(default_factory=_empty)
    local_yield: np.ndarray = field(default_factory=_empty)
    local_layer: np.ndarray = field(default_factory=_empty)
    zeta: np.ndarray = field(default_factory=_empty)
    damage: np.ndarray = field(default_factory=_empty)
    worn: np.ndarray = field(default_factory=_empty)
    steel: Steel = field(default_factory=Steel, repr=False)

    largest_log: ClassVar[float] = 690.0
    """Logarithm of the largest damage that is extrapolated to the surface; e^710 overflows."""

    @property
    def table(self) -> Table:
        """The fatigue as a table; it lacks damage and wear without a limit."""
        axes = {
            "y": Variable(MESH_AXES["y"], ("y",), self.y),
            "depth": Variable(
                Quantity("depth", "mm", "depth below the present surface"), ("depth",), self.depth
            ),
            "zeta": Variable(
                Quantity("zeta", "mm", "depth below the unworn surface"), ("zeta",), self.zeta
            ),
        }
        values = {name: getattr(self, name) for name in FATIGUE_FIELDS}
        variables = {
            name: Variable(quantity, quantity.dims, values[name])
            for name, quantity in FATIGUE_FIELDS.items()
            if values[name].size
        }
        used = {name: axis for name, axis in axes.items() if axis.data.size}
        return Table(variables, used, {"criterion": self.criterion})

    @classmethod
    def from_table(cls, rows: Rows[Table], body: str, shear_yield: float, row: int) -> Self:
        """Return the fatigue of a record in a sequence of tables; those of a file lack the law."""
        table = rows[row]
        names = ("y", "depth", "zeta", *FATIGUE_FIELDS)
        arrays = {name: table[name] if name in table else _empty() for name in names}
        named: dict[str, Any] = arrays | {"criterion": table.attributes.get("criterion")}
        return cls(body, shear_yield=shear_yield, **named)

    def with_damage(self, zeta: np.ndarray, damage: np.ndarray, worn: np.ndarray) -> Self:
        """Return a copy with damage at depths zeta below the new surface, and the wear depth."""
        return replace(self, zeta=zeta, damage=damage, worn=worn)

    @property
    def damage_max(self) -> tuple[float, tuple[float, float, float]]:
        """Largest damage of the remaining material, and its place (nan, y, zeta), mm.

        At the surface it is extrapolated exponentially from the two depths below; inside it is
        refined by a parabola.
        """
        return self.largest_damage()

    def largest_damage(
        self, layer: np.ndarray | None = None
    ) -> tuple[float, tuple[float, float, float]]:
        """Return `damage_max`; no parabola joins material with different numbers `layer` (n_y, m).

        Both sides of each interface are among the depths zeta: `layer` is needed for others only.
        """
        if not self.damage.size:
            return math.nan, (math.nan,) * 3
        remaining = self.zeta >= self.worn[:, None]
        inside = np.where(remaining, self.damage, 0.0)
        if not inside.any():
            return 0.0, (math.nan,) * 3
        j, k = (int(index) for index in np.unravel_index(np.argmax(inside), inside.shape))
        value, at = float(inside[j, k]), (math.nan, float(self.y[j]), float(self.zeta[k]))
        if k and remaining[j, k - 1]:
            row_layer = None if layer is None else layer[j]
            depth, more = _parabola_tops(self.zeta, inside[j], row_layer)
            value, at = value + float(more[k]), (math.nan, at[1], float(depth[k]))
        first = np.minimum(np.argmax(remaining, axis=1), self.zeta.size - 2)
        row = np.arange(self.y.size)
        here, below = self.damage[row, first], self.damage[row, first + 1]
        gap = self.zeta[first + 1] - self.zeta[first]
        step = (self.worn - self.zeta[first]) / gap
        step = np.where(gap < 1e-8 * self.zeta[first], 0.0, step)  # sides of an interface
        log = np.log(np.maximum((here, below), 1e-300))
        reached = remaining.any(axis=1) & (here > 0.0)
        log = np.minimum(log[0] + step * (log[1] - log[0]), self.largest_log)
        surface = np.where(reached, np.exp(log), 0.0)
        j = int(np.argmax(surface))
        if surface[j] > value:
            return float(surface[j]), (math.nan, float(self.y[j]), float(self.worn[j]))
        return value, at

    def largest(
        self,
        name: str = "utilisation",
        within: tuple[float, float] = (0.0, math.inf),
        layer: int | None = None,
    ) -> Maximum:
        """Return the largest value of a field by its name; places are (nan, y, depth), mm.

        Below the surface it is refined by parabolas through the neighbouring points. If the yield
        stress depends on the depth, the shear stresses `residual_shear` and `path_radius` are taken
        times `shear_yield` over it, so that the largest one determines shakedown. `within` limits
        the depths, both included. `layer` is the number of a layer with a strength, from 0 at the
        surface; the result is nan if wear has removed it.

        Raises
        ------
        ValueError
            If `layer` is given and the scene has no strengths of the layers of this body.
        """
        values, numbers = getattr(self, name), self.local_layer
        inside = (self.depth >= within[0]) & (self.depth <= within[1])
        if layer is not None:
            if not numbers.size:
                raise ValueError(
                    f"body {self.body} has no strengths of layers, [[fatigue.{self.body}.layer]]"
                )
            inside &= (numbers == layer).any(axis=0)
            values = np.where(numbers == layer, values, 0.0)  # no parabola joins other layers
        if name in ("residual_shear", "path_radius") and self.local_yield.size:
            values = values * (self.shear_yield / self.local_yield)
        depth, values = self.depth[inside], values[:, inside]
        if np.isnan(values).all():  # also without any
            nowhere = (math.nan,) * 3
            return Maximum(self.criterion, *(math.nan, nowhere) * 3)
        row = int(np.argmax(values[:, 0]))
        surface, surface_at = float(values[row, 0]), (math.nan, float(self.y[row]), 0.0)
        if depth[0] > 0.0:
            surface, surface_at = math.nan, (math.nan,) * 3
        numbers = numbers[:, inside] if numbers.size else 0.0 * values
        below = depth > 0.0
        interior, interior_at = self._interior(depth[below], values[:, below], numbers[:, below])
        higher = not (surface >= interior or math.isnan(interior))
        value, at = (interior, interior_at) if higher else (surface, surface_at)
        return Maximum(self.criterion, value, at, interior, interior_at, surface, surface_at)

    def _interior(
        self, depth: np.ndarray, below: np.ndarray, layer: np.ndarray
    ) -> tuple[float, tuple[float, float, float]]:
        """Return the largest value below the surface and (nan, y, depth), by parabolas in a layer.

        A parabola through the largest value alone would not suffice: the best residual stress of a
        depth makes two rows equal, so that rounding would choose between their parabolas.
        """
        if not depth.size:
            return math.nan, (math.nan,) * 3
        y, gain_y = _parabola_tops(self.y, below, layer)
        depth, gain_z = (array.T for array in _parabola_tops(depth, below.T, layer.T))
        total = below + gain_y + gain_z
        at = np.unravel_index(np.argmax(total), total.shape)
        return float(total[at]), (math.nan, float(y[at]), float(depth[at]))

    @property
    def utilisation_max(self) -> float:
        """Largest utilisation, inside or at the surface."""
        return self.largest().value

    @property
    def shakedown_lower(self) -> float:
        """Load factor up to which elastic shakedown is certain; nan without a yield stress."""
        return self.load_factor(self.largest("residual_shear").value)

    @property
    def shakedown_upper(self) -> float:
        """Load factor from which elastic shakedown is impossible; nan without a yield stress."""
        return self.load_factor(self.largest("path_radius").value)

    def load_factor(self, shear: float) -> float:
        """Return k over a shear stress, the load factor at which it yields; inf without stress."""
        return math.inf if shear == 0.0 else self.shear_yield / shear


def _parabola_tops(
    x: np.ndarray, values: np.ndarray, layer: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Return places of local parabola tops, and their heights above the values (0 if not near).

    Parameters
    ----------
    x : ndarray, shape (n,)
        Ascending places.
    values : ndarray, shape (n, ...)
        Values there.
    layer : ndarray, shape (n, ...), optional
        Number of the layer there.

    Returns
    -------
    place, gain : ndarray, shape (n, ...)
        Place of each top, and its height above the value. At an end, and if the top is farther
        away than the neighbours, the place itself and 0; so also on both sides of an interface, and
        next to another layer.
    """
    places = x.reshape(-1, *(1,) * (values.ndim - 1))
    place, gain = np.broadcast_to(places, values.shape).copy(), np.zeros(values.shape)
    before, after = places[1:-1] - places[:-2], places[2:] - places[1:-1]
    down, up = (values[1:-1] - values[:-2]) / before, (values[2:] - values[1:-1]) / after
    curvature = (down - up) / (0.5 * (before + after))
    slope = (down * after + up * before) / (before + after)
    step = np.divide(slope, curvature, out=np.full_like(slope, np.inf), where=curvature > 0.0)
    near = (-before <= step) & (step <= after)
    near &= (before > 1e-6 * after) & (after > 1e-6 * before)  # an interface: values may jump
    if layer is not None:
        near &= (layer[1:-1] == layer[:-2]) & (layer[1:-1] == layer[2:])
    place[1:-1] += np.where(near, step, 0.0)
    gain[1:-1] = 0.5 * slope * np.where(near, step, 0.0)
    return place, gain


class StressColumns(NamedTuple):
    """Columns of a stress criterion, by the names of `Maximum`, and the error bar of `value`."""

    value: Quantity
    interior: Quantity
    surface: Quantity
    at: Quantity
    value_error: Quantity

    @property
    def of_maximum(self) -> tuple[Quantity, ...]:
        """The columns without error bar."""
        return self.value, self.interior, self.surface, self.at


def stress_columns(criterion: StressCriterion) -> StressColumns:
    """Return the columns of the largest stress by a criterion in each body."""
    name, unit, text = criterion.name, criterion.unit, f"largest {criterion.long_name}"
    stressed = partial(Quantity, needs=("subsurface",), bodies_of="subsurface")
    of_body = partial(
        stressed, unit=unit, dims=("body",), symbol=criterion.symbol, over_blocks="largest"
    )
    of_position = partial(stressed, unit="mm", dims=("body", "position"), place_of=f"{name}_max")
    largest, interior, surface, position = (
        column(f"{name}_{part}", long_name=meaning, role=f"stress_{part}")
        for column, part, meaning in (
            (of_body, "max", f"{text}, inside or at the surface"),
            (of_body, "interior", f"{text} inside the body"),
            (of_body, "surface", f"{text} at the surface"),
            (of_position, "max_at", f"position (x, y, depth) of the {text}"),
        )
    )
    error_bar = replace(error_bar_column(largest), role="stress_max_error")
    return StressColumns(largest, interior, surface, position, error_bar)


def _bars_of_damage(contact: Any) -> Any:
    """Return the error bars of the damage of a contact, by body; empty if there are none."""
    return contact.error_bars.get("damage", {})


def _has_fatigue(body: str, scene: Scene) -> bool:
    """Return whether [fatigue] of a scene covers a body."""
    return body in required(scene.fatigue, "fatigue").bodies


def _surface_fatigue_index(contact: Any) -> float:
    """Return the surface fatigue index: the largest |p_t|/p_n - k/p_n in contact; nan without."""
    common = required(contact.scene.fatigue, "fatigue").shear_yield_stress
    of_bodies = [steel.at("shear_yield", 0.0) for steel in contact.scene.steel.values()]
    k = min(float(value) for value in (common, *of_bodies) if value is not None)
    touching = contact.touching
    if not touching.any():
        return math.nan
    shear = np.hypot(*contact.traction[:, touching]) - k
    return float((shear / contact.pressure[touching]).max())


_of_bodies = partial(Quantity, dims=("body",), bodies_of="fatigue")
_fatigue = partial(_of_bodies, needs=("fatigue.limit",))
_volume = partial(_of_bodies, needs=("fatigue.volume",))
_shakedown = partial(_of_bodies, needs=("fatigue.shear_yield_stress",))
_layer = partial(
    _of_bodies, unit="1", format="g", needs=("fatigue.limit", "fatigue.has_layer_strengths")
)
_position = partial(_fatigue, dims=("body", "position"))


def _has_lifts(scene: Scene) -> bool:
    """Return whether the lift of an inclusion of a scene changes the contact."""
    return any(inclusion.lifts for inclusion in scene.inclusion)


_inclusion = partial(Quantity, dims=("body",), needs=("inclusion",), over_blocks="largest")
_by_inclusion = partial(_inclusion, needs=("inclusion", "fatigue.limit"))
_by_lift = partial(_inclusion, when=_has_lifts)
_places: dict[str, Any] = {"dims": ("body", "position"), "over_blocks": "mean"}

# fmt: off
FATIGUE_COLUMNS = (
    _shakedown("shakedown_lower", "1", "load factor up to which elastic shakedown is certain",
               symbol=r"\lambda_-", format=".3f", over_blocks="smallest"),
    _shakedown("shakedown_upper", "1", "load factor from which elastic shakedown is impossible",
               symbol=r"\lambda_+", format=".3f", over_blocks="smallest"),
    _shakedown("shakedown_interior", "1", "load factor up to which elastic shakedown is certain "
                                          "inside the body",
               format=".3f", over_blocks="smallest"),
    _shakedown("shakedown_surface", "1", "load factor up to which elastic shakedown is certain "
                                         "at the surface",
               format=".3f", over_blocks="smallest"),
    _shakedown("shakedown_lower_at", "mm",
               "position (x is nan, y, depth) that determines shakedown_lower",
               dims=("body", "position"), place_of="shakedown_lower"),
    _of_bodies("yield_factor", "1", "load factor at which the material first yields, with its "
                                    "residual stress", symbol=r"\lambda_y", format=".3f",
               needs=("residual", "fatigue.shear_yield_stress"), over_blocks="smallest"),
    Quantity("fi_surf", "1", "surface fatigue index, the largest |p_t|/p_n - k/p_n",
             _surface_fatigue_index, symbol=r"FI_\mathrm{surf}", format=".4f",
             needs=("fatigue.shear_yield_stress", "friction"), over_blocks="largest"),
    _fatigue("utilisation", "1", "largest ratio of the equivalent stress of the cycle to its limit",
             symbol="u", format=".3f", over_blocks="largest"),
    _fatigue("utilisation_interior", "1", "largest utilisation inside the body",
             format=".3f", over_blocks="largest"),
    _fatigue("utilisation_surface", "1", "largest utilisation at the surface",
             format=".3f", over_blocks="largest"),
    _position("utilisation_at", "mm", "position of the largest utilisation (x only in a "
                                      "transient, y, depth)", place_of="utilisation"),
    _layer("utilisation_layer", long_name="layer with the largest utilisation, 0 at the surface"),
    _layer("failing_layer", long_name="layer with the shortest fatigue_life, 0 at the surface"),
    _fatigue("damage", "1", "largest damage of the remaining material; at 1 a crack starts",
             symbol="D", format=".3g"),
    _position("damage_at", "mm", "position of the largest damage (x only in a transient, y, "
                                 "depth below the unworn surface)", place_of="damage"),
    _fatigue("damage_error", "1", "error of the damage due to the length of jumps, the order of "
                                  "blocks and the points of stress paths; with [accuracy], also "
                                  "due to the mesh", _bars_of_damage,
             format=".1g", error_of="damage"),
    _fatigue("initiation", "1", "revolution at which the damage reached 1", format=".4g"),
    _fatigue("fatigue_life", "1", "revolutions, or repetitions of a transient, until a crack "
                                  "starts under the stress of this record, without wear",
             format=".4g"),
    _fatigue("wear_margin", "1", "smallest ratio across the track of the wear to the wear that "
                                 "balances fatigue; below 1, cracks start; nan without wear",
             format=".3g"),
    _volume("stressed_volume", "1", "integral of the stress over the volume, in N and mm with "
                                    "the exponents of fatigue.volume; for a flat body, over 1 "
                                    "mm of track", format=".4g"),
    _of_bodies("volume_life", "1", "revolutions that the complete volume survives under the "
                                   "stress of this record, with the probability "
                                   "fatigue.volume.survival", format=".4g",
               needs=("fatigue.volume.constant",)),
    _volume("volume_at_top", "1", "integrand at a depth of one element divided by its largest "
                                  "value; near 1, the volume grows as the mesh is refined",
            format=".2g"),
    Quantity("balancing_wear_A", "mm", "wear of body A per revolution that balances fatigue",
             dims=("y",), needs=("fatigue.limit",), when=partial(_has_fatigue, "A")),
    Quantity("balancing_wear_B", "mm", "wear of body B per revolution that balances fatigue",
             dims=("y",), needs=("fatigue.limit",), when=partial(_has_fatigue, "B")),
    _inclusion("inclusion_von_mises", "MPa", "largest von Mises stress next to an inclusion"),
    _inclusion("inclusion_von_mises_at", "mm",
               "position (x, y, depth) of the largest von Mises stress next to an inclusion",
               place_of="inclusion_von_mises", **_places),
    _inclusion("inclusion_tension", "MPa", "largest tension in an inclusion"),
    _inclusion("inclusion_lift", "mm", "largest displacement of the surface above an inclusion, in "
                                       "either direction", format=".3g"),
    _by_lift("inclusion_p_max", "MPa", "largest peak pressure while inclusions pass"),
    _by_lift("inclusion_p_min", "MPa", "smallest peak pressure while inclusions pass",
             over_blocks="smallest"),
    _by_lift("inclusion_iterations", "1", "most contacts solved at a position of inclusions until "
                                          "their lift and the pressure agree", format="g"),
    _by_lift("inclusion_residual", "1", "largest change of the lift in the last iteration over the "
                                        "largest lift", format=".0e"),
    _by_inclusion("inclusion_utilisation", "1", "largest utilisation next to an inclusion",
                  symbol="u", format=".3f"),
    _by_inclusion("inclusion_utilisation_at", "mm",
                  "position (y, depth) of the largest utilisation next to an inclusion",
                  place_of="inclusion_utilisation", **_places),
    Quantity("inclusion_convolutions", "1", "convolutions for the stress around inclusions and the "
                                            "contacts above them, in units of one tangential "
                                            "application", needs=("inclusion",),
             over_blocks="sum"),
)
# fmt: on
"""Columns of scenes with [fatigue] or [[inclusion]]."""
