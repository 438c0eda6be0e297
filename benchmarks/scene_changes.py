"""Changes of a scene that do not change its physics, and their effect on the results.

A change maps the tables of a scene. It also maps the results of the changed scene back, so that
they equal the results of the original scene. For axes and signs, see docs/theory/conventions.md:

- `MIRROR` replaces y by -y: lateral components, moment, spin and angles change sign.
- `EXCHANGE` exchanges the bodies, z becomes -z: a quantity that acted on A now acts on B, so
  tractions, slip and both creepages change sign. Spin and moment also change sign, because x and y
  do not change. The positions of the fields do not change.
- `Units` uses other units of length and stress; every key changes according to its dimension.
- `AXES` exchanges e1 and e2; the angle changes by 90 degrees.
- `STEP` halves the step of a transient, and `SAVE` selects other records with stored fields.
"""

import math
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np

import tractive_sam as ts
from tractive_sam.results.column_table import storable_fields

BODIES = {"A": "B", "B": "A"}

UNCHECKED = re.compile(
    r"seconds|operator_applications|(inclusion_)?(convolutions|iterations)|over_application|solves"
    r"|jump|residual|next_step|stretch|.*_at|.*_error|revolution|distance|converged|rolled_block"
)
"""Columns that count work or steps, and positions: a symmetric scene may have several."""


@dataclass(frozen=True)
class Outcome:
    """The results of a computation.

    Attributes ---------- scene : Scene
        The computed scene.
    status, message : str
        Status and message at the end.
    at, saved : ndarray
        Coordinates of all records, and of the records with stored fields.
    values : dict of str to ndarray
        Columns, one row per record, and fields, one row per stored record.
    dims, units : dict
        Further dimensions and unit of each quantity.
    """

    scene: ts.Scene
    status: str
    message: str
    at: np.ndarray
    saved: np.ndarray
    values: dict[str, np.ndarray]
    dims: dict[str, tuple[str, ...]]
    units: dict[str, str]

    @classmethod
    def of(cls, scene: ts.Scene) -> "Outcome":
        """Compute a scene."""
        history = ts.roll(scene)
        columns = {
            n: column
            for n, column in history.columns.items()
            if not UNCHECKED.fullmatch(n.removeprefix("block_"))
        }
        values = {name: np.asarray(history[name], float) for name in columns}
        dims = {name: column.dims for name, column in columns.items()}
        units = {name: column.unit for name, column in columns.items()}
        blocks = ("block",) if scene.duty else ()
        slid = _rolled(scene, history.saved)
        for name, rows in history.fields.items():
            values[name] = np.array([rows[k] for k in range(len(rows))])
            if name in ("slip_x", "slip_y"):
                values[name][~slid] = np.nan
            dims[name] = (*blocks, "x", "y")
            units[name] = storable_fields(scene)[name].unit
        if "heat_into_A" in values:
            power = [values[f"traction_{k}"] * values[f"slip_{k}"] for k in "xy"]
            values["heat_into_B"] = -scene.creepage.speed * sum(power) - values["heat_into_A"]
            dims["heat_into_B"], units["heat_into_B"] = dims["heat_into_A"], units["heat_into_A"]
        at = history[history.coordinate.name].astype(float)
        saved = np.asarray(history.saved, float)
        return cls(scene, history.status, history.message, at, saved, values, dims, units)

    def rows(self, name: str) -> np.ndarray:
        """Return the coordinates of the rows of a quantity."""
        return self.saved if "x" in self.dims[name] else self.at


def _rolled(scene: ts.Scene, saved: np.ndarray) -> np.ndarray:
    """Return which records have slip per distance: not the start of a transient, nor jumps."""
    if scene.transient is None or scene.schedule.shifts:
        return np.ones(len(saved), bool)
    knots = np.asarray(scene.transient.distance)
    jumps = [knots[0], *knots[1:][np.diff(knots) == 0.0]]
    return ~np.isclose(np.asarray(saved, float)[:, None], jumps, rtol=1e-12).any(axis=1)


def sub_tables(tables: dict) -> Iterator[dict]:
    """Yield all tables with load, creepage and friction: the scene, its courses and its blocks."""
    yield tables
    if "transient" in tables:
        yield tables["transient"]
    yield from tables.get("duty", ())


def map_numbers(value, by: Callable[[float], float]):
    """Apply a function to a number, or to each number of a list."""
    return tuple(map_numbers(v, by) for v in value) if np.iterable(value) else by(value)


def change_sign(tables: dict, *keys: str) -> None:
    """Change the sign of keys of load, creepage and friction in all tables."""
    for tables_here in sub_tables(tables):
        for key in keys:
            table, name = key.split(".")
            inner = tables_here.get(table)
            if inner and inner.get(name) is not None:
                inner[name] = map_numbers(inner[name], lambda number: -number)


def gaps(tables: dict) -> Iterator[dict]:
    """Yield the separations of a scene."""
    if "gap" in tables:
        yield tables["gap"]
    yield from tables.get("transient", {}).get("profile", {}).values()


@dataclass(frozen=True)
class Change:
    """A change of a scene.

    Attributes ---------- name : str
        Name in the tables of results.
    tables : callable
        Changes the tables of a scene in place.
    negative : pattern
        Quantities that change sign.
    flips_y, swaps_bodies : bool
        Effect on the dimensions of a quantity.
    applies : callable
        Whether the change applies to a scene.
    """

    name: str
    tables: Callable[[dict, ts.Scene], None]
    negative: re.Pattern = field(default_factory=lambda: re.compile(r"(?!)"))
    flips_y: bool = False
    swaps_bodies: bool = False
    applies: Callable[[ts.Scene], bool] = lambda scene: True

    def scene(self, scene: ts.Scene) -> ts.Scene:
        """Return the changed scene."""
        tables = deep(scene.entries())
        self.tables(tables, scene)
        return ts.Scene(**tables)

    def back(self, outcome: Outcome) -> Outcome:
        """Return results of the changed scene in the frame and the units of the scene."""
        values = {}
        for name, rows in outcome.values.items():
            values[self.partner(name)] = self.value(name, rows, outcome)
        return replace(outcome, values=values, **self.coordinates(outcome))

    def coordinates(self, outcome: Outcome) -> dict[str, np.ndarray]:
        """Return the coordinates that change."""
        return {}

    def partner(self, name: str) -> str:
        """Return the quantity of the scene that corresponds to a quantity of the changed scene."""
        if self.swaps_bodies and name[-2:] in ("_A", "_B"):
            return name[:-1] + BODIES[name[-1]]
        return name

    def value(self, name: str, rows: np.ndarray, outcome: Outcome) -> np.ndarray:
        """Return the values of a quantity of the scene."""
        if self.negative.fullmatch(name.removeprefix("block_")):
            rows = -rows
        dims = ("record", *outcome.dims[name])
        if self.flips_y and "y" in dims:
            rows = np.flip(rows, dims.index("y"))
        if self.flips_y and name == "creepage_found":
            rows = rows * np.array([1.0, -1.0])
        if self.swaps_bodies and "body" in dims:
            rows = np.flip(rows, dims.index("body"))
        if self.swaps_bodies and name == "heat_share":
            rows = 1.0 - rows
        return rows


def deep(value):
    """Return a copy of tables that may be changed."""
    if isinstance(value, dict):
        return {key: deep(item) for key, item in value.items()}
    if isinstance(value, list | tuple) and any(isinstance(item, dict) for item in value):
        return [deep(item) for item in value]
    return value


def reflect_stiffness(tables: dict, axis: int) -> None:
    """Reflect stiffnesses along an axis.

    Components change sign whose indices contain this axis an odd number of times.
    """
    odd = {1: (4, 6), 2: (4, 5)}[axis]  # numbers of the shears with this axis
    for body in tables["body"].values():
        for key in body.get("stiffness") or {}:
            if key[0] == "C" and (int(key[1]) in odd) != (int(key[2]) in odd):
                body["stiffness"][key] = -body["stiffness"][key]


def _mirrored(tables: dict, scene: ts.Scene) -> None:
    reflect_stiffness(tables, 1)
    for inclusion in tables.get("inclusion", ()):
        x, y, depth = inclusion["at"]
        inclusion["at"] = (x, -y, depth)
        if np.iterable(strain := inclusion.get("eigenstrain", 0.0)):
            inclusion["eigenstrain"] = np.multiply(strain, (1, 1, 1, -1, 1, -1)).tolist()
    if tables.get("conformal"):
        tables["conformal"]["angle"] = -tables["conformal"].get("angle", 0.0)
    change_sign(tables, "creepage.lateral", "creepage.spin", "load.force_y", "friction.angle")
    for block in tables.get("duty", ()):
        block["shift_y"] = -block.get("shift_y", 0.0)
    for gap in gaps(tables):
        gap["y"] = -np.asarray(gap["y"])[::-1]
        gap["separation"] = np.asarray(gap["separation"])[:, ::-1]


MIRROR = Change(
    "mirror",
    _mirrored,
    re.compile(r"Qy|Qy_over_P|Fy|M[xz]|tilt|xi_y|spin|shift_y|turn|traction_y|slip_y"),
    flips_y=True,
)


def _exchanged(tables: dict, scene: ts.Scene) -> None:
    change_sign(tables, "creepage.longitudinal", "creepage.lateral", "creepage.spin")
    change_sign(tables, "load.force_x", "load.force_y")
    reflect_stiffness(tables, 2)
    for inclusion in tables.get("inclusion", ()):
        inclusion["body"] = BODIES[inclusion.get("body", "A")]

    def swap(table: dict) -> None:
        both = {BODIES[body]: table.pop(body) for body in "AB" if body in table}
        table |= both

    swap(tables["body"])
    for path in ("wear.coefficient", "wear.law", "wear.set", "heat.bulk", "transient.profile"):
        table = tables
        for name in path.split("."):
            table = table.get(name, {}) if isinstance(table, dict) else {}
        if isinstance(table, dict):
            swap(table)
    for name in ("fatigue", "subsurface"):
        if "bodies" in tables.get(name, {}):
            tables[name]["bodies"] = tuple(BODIES[body] for body in tables[name]["bodies"])


def _counts_alike(scene: ts.Scene) -> bool:
    """Return whether both bodies have an equal number of revolutions."""
    radii = scene.body.A.radius_x, scene.body.B.radius_x
    equal = scene.wear is not None and scene.wear.turns == "equal"
    counted = scene.wear is not None or scene.fatigue is not None
    return not counted or equal or radii[0] == radii[1] or math.inf in radii


EXCHANGE = Change(
    "exchange",
    _exchanged,
    re.compile(
        r"Q[xy](_over_P)?|Fy|Mz|xi_[xy]|spin|shift_[xy]|turn|traction_[xy]|slip_[xy]|creepage_found"
    ),
    swaps_bodies=True,
    applies=_counts_alike,
)


def _renamed(tables: dict, scene: ts.Scene) -> None:
    mu1, mu2 = scene.friction.mu
    for inner in sub_tables(tables):
        friction = inner.get("friction") or {}
        for key in ("mu", "static", "kinetic"):
            value = friction.get(key)
            if value is not None and inner is tables.get("transient"):
                friction[key] = tuple(v * mu2 / mu1 for v in value)
            elif np.iterable(value):
                friction[key] = tuple(reversed(value))
        if "angle" in friction or inner is tables:
            angle = friction.get("angle", 0.0)
            friction["angle"] = angle + (90.0 if angle < 0.0 else -90.0)
    for key in ("intensity", "coefficient"):
        value = tables.get("wear", {}).get(key)
        if isinstance(value, tuple | list):
            tables["wear"][key] = tuple(reversed(value))


AXES = Change("axes", _renamed, applies=lambda scene: scene.friction is not None)

# Exponents of length and of stress. Time, temperature and density keep their units.
PURE, LENGTH, STRESS = (0, 0), (1, 0), (0, 1)
DIMENSIONS: dict[str, tuple[int, int]] = {
    **dict.fromkeys(("body.young", "body.shear", "load.pressure", "friction.strength"), STRESS),
    **dict.fromkeys(("fatigue.shear_yield", "fatigue.yield_strength", "fatigue.limit"), STRESS),
    **dict.fromkeys(("body.radius_x", "body.radius_y", "body.width"), LENGTH),
    **dict.fromkeys(("load.approach", "grid.half_length", "duty.shift_y"), LENGTH),
    **dict.fromkeys(("gap.x", "gap.y", "gap.separation"), LENGTH),
    **dict.fromkeys(("profile.x", "profile.y", "profile.separation"), LENGTH),
    **dict.fromkeys(("creepage.speed", "friction.half_speed", "friction.memory"), LENGTH),
    **dict.fromkeys(("load.normal", "load.force_x", "load.force_y"), (2, 1)),
    **dict.fromkeys(("body.layer.young", "body.layer.shear", "inclusion.young"), STRESS),
    **dict.fromkeys(("body.layer.thickness", "inclusion.at", "inclusion.radii"), LENGTH),
    **dict.fromkeys(("profile.drop", "profile.radius", "profile.flat", "profile.chamfer"), LENGTH),
    **dict.fromkeys(("body.layer.shear_compliance", "body.layer.normal_compliance"), (1, -1)),
    **dict.fromkeys(("body.layer.poisson", "inclusion.poisson", "inclusion.eigenstrain"), PURE),
    **dict.fromkeys(("body.relaxation.ratio", "body.relaxation.time"), PURE),
    **dict.fromkeys(("conformal.angle", "inclusion.cells", "profile.load_factor"), PURE),
    "profile.load": (2, 1),
    "creepage.spin": (-1, 0),
    "friction.B": (-1, 0),
    "friction.layer": (1, -1),
    "wear.intensity": (0, -1),
    "wear.coefficient": (0, -1),
    "body.thermal.conductivity": (2, 1),
    "body.thermal.heat_capacity": STRESS,
    **dict.fromkeys(("transient.distance", "transient.save", "transient.step"), LENGTH),
    **dict.fromkeys(("body.poisson", "body.hardness", "body.density", "grid.elements"), PURE),
    **dict.fromkeys(("body.thermal.density", "heat.bulk", "friction.temperature"), PURE),
    **dict.fromkeys(("creepage.longitudinal", "creepage.lateral", "friction.mu"), PURE),
    **dict.fromkeys(("friction.static", "friction.kinetic", "friction.A"), PURE),
    **dict.fromkeys(("friction.angle", "wear.tolerance", "wear.temperature"), PURE),
    **dict.fromkeys(("wear.revolutions", "wear.save", "duty.revolutions"), PURE),
    **dict.fromkeys(("fatigue.sensitivity", "fatigue.cycles", "fatigue.exponent"), PURE),
    **dict.fromkeys(("fatigue.depth", "fatigue.elements", "fatigue.tolerance"), PURE),
    **dict.fromkeys(("subsurface.loaded_bodies", "subsurface.elements"), PURE),
    **dict.fromkeys(("solver.tolerance", "transient.tolerance"), PURE),
}


@dataclass(frozen=True)
class Units(Change):
    """Other units of length and stress: numbers change by these factors."""

    length: float = 1.0
    stress: float = 1.0

    def factor(self, dimension: tuple[int, int]) -> float:
        """Return the factor of numbers of a dimension."""
        return self.length ** dimension[0] * self.stress ** dimension[1]

    def scene(self, scene: ts.Scene) -> ts.Scene:
        """Return the scene in these units."""

        def scaled(value, path: str):
            if isinstance(value, dict):
                return {key: scaled(item, f"{path}.{key}") for key, item in value.items()}
            if isinstance(value, list | tuple) and any(isinstance(v, dict) for v in value):
                return [scaled(item, path) for item in value]
            if path == ".wear.law.table":
                return tuple((work * self.stress, rate) for work, rate in value)
            numbers = np.asarray(value).dtype.kind in "if" and not isinstance(value, bool)
            if not numbers:
                return value
            times = self.factor(self.dimension(path, scene))
            return value if times == 1.0 else map_numbers(value, lambda number: number * times)

        return ts.Scene(**scaled(deep(scene.entries()), ""))

    def dimension(self, path: str, scene: ts.Scene) -> tuple[int, int]:
        """Return the dimension of a key of a scene."""
        key = re.sub(r"\b(body|coefficient|bulk|profile)\.[AB]\b", r"\1", path.lstrip("."))
        key = re.sub(r"^(transient|duty)\.(?=load|creepage|friction|profile)", "", key)
        if scene.line and key in ("load.normal", "load.force_x", "load.force_y"):
            return (1, 1)
        if scene.schedule.shifts and path.startswith(".transient.creepage"):
            return PURE if path.endswith("spin") else LENGTH
        if scene.schedule.shifts and path in (
            ".transient.distance",
            ".transient.save",
            ".transient.step",
        ):
            return PURE
        if key.startswith("body.stiffness.C"):
            return STRESS
        return DIMENSIONS[key.removeprefix("body.") if "profile" in key else key]

    def value(self, name: str, rows: np.ndarray, outcome: Outcome) -> np.ndarray:
        """Return the values of a quantity in the units of the scene."""
        return rows / self.factor(dimension_of_unit(outcome.units[name]))

    def coordinates(self, outcome: Outcome) -> dict[str, np.ndarray]:
        """Return distances in the units of the scene."""
        if outcome.scene.transient is None or outcome.scene.schedule.shifts:
            return {}
        return {"at": outcome.at / self.length, "saved": outcome.saved / self.length}


def dimension_of_unit(unit: str) -> tuple[int, int]:
    """Return the exponents of length and stress of a unit of results."""
    dimensions = {"N": (2, 1), "mm": LENGTH, "MPa": STRESS, "mg": (3, 0), "mW": (3, 1)}
    over, _, under = unit.partition("/")
    total = np.zeros(2, int)
    for text, sign in ((over, 1), (under, -1)):
        for name, power in re.findall(r"([A-Za-z]+)(\d*)", text):
            if name not in ("degC", "rad", "mrad"):
                total += sign * int(power or 1) * np.array(dimensions[name])
    return int(total[0]), int(total[1])


def _same_dimensions(scene: ts.Scene) -> bool:
    """Return whether no law has coefficients in fixed units."""
    laws = {} if scene.wear is None else scene.wear.laws
    return not {"usfd", "brr", "jendel"} & set(laws.values())


def _without_memory(scene: ts.Scene) -> bool:
    """Return whether friction also has no memory, which fades at 1 mm/s in stick."""
    return _same_dimensions(scene) and not (scene.friction and scene.friction.memory)


LENGTHS = Units("lengths", lambda *_: None, length=1e3, applies=_without_memory)
STRESSES = Units("stresses", lambda *_: None, stress=1e-3, applies=_same_dimensions)


def _half_step(tables: dict, scene: ts.Scene) -> None:
    transient = tables["transient"]
    if transient.get("stepping") == "adaptive":
        transient["tolerance"] = transient.get("tolerance", 1e-3) / 4.0
        return
    stretch = np.diff(transient["distance"]).max() / 10.0
    element = 2.0 * scene.grid.half_length[0] / scene.grid.elements[0]
    default = stretch if scene.schedule.shifts else element
    transient["step"] = transient.get("step", default) / 2.0


STEP = Change("step", _half_step, applies=lambda scene: scene.transient is not None)


def _saved_more(tables: dict, scene: ts.Scene) -> None:
    if scene.transient is not None:
        knots = scene.transient.distance
        more = knots[0] + np.array([0.137, 0.411, 0.79]) * (knots[-1] - knots[0])
        tables["transient"]["save"] = tuple(sorted({*scene.transient.save, *more.tolist()}))
        return
    last = scene.wear.revolutions
    tables["wear"]["save"] = tuple(sorted({*scene.wear.save, last // 3, 2 * last // 3}))


SAVE = Change("save", _saved_more, applies=lambda s: s.transient is not None or s.wear is not None)

EXACT = (MIRROR, EXCHANGE, LENGTHS, STRESSES, AXES)
"""Changes that also leave the discrete problem unchanged."""

CHANGES = (*EXACT, STEP, SAVE)
