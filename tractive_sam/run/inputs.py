"""Check the arguments and measured maps of the entry points; errors name the cause and the remedy.

Warnings state what of a map the mesh does not resolve, and what steady rolling leaves out.
"""

import hashlib
import math
from collections.abc import Callable, Iterable, Iterator
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from tractive_sam.contact import (
    Gap,
    Laws,
    Model,
    Roughness,
    Worn,
    describe_grid_entries,
    rough_maps,
    standing_roughness,
    uncovered_axes,
)
from tractive_sam.results import (
    COLUMNS,
    DERIVED,
    DIMS,
    LABELS,
    PACKAGE_FIELDS,
    Grid,
    Quantity,
    State,
    stress_columns,
)
from tractive_sam.rolling import Observer
from tractive_sam.run import memory
from tractive_sam.scene import Scene
from tractive_sam.schema import LARGEST, shorten, warn
from tractive_sam.solvers import ProblemSolver
from tractive_sam.store import read_gap


def check_scene(scene: Scene) -> None:
    """Raise a TypeError unless the argument is a scene."""
    if not isinstance(scene, Scene):
        cure = "Scene.builtin(name), Scene.from_toml(path) or Scene(...) makes one"
        raise TypeError(f"scene: must be a Scene, not {type(scene).__name__}; {cure}")


def model_of(
    laws: Laws | None, solver: ProblemSolver | None, began: Worn | None = None
) -> Callable[..., Model]:
    """Return a function that builds models with user-defined laws, solver and worn bodies."""
    if not isinstance(laws, Laws | None):
        cure = "Laws.of(scene).replace(friction=...) makes them"
        raise TypeError(f"laws: must be a Laws, not {type(laws).__name__}; {cure}")
    if solver is not None and not callable(getattr(solver, "solve", None)):
        needed = "an object with solve(problem, tolerance, start), for example solvers.Newton()"
        raise TypeError(f"solver: must be {needed}, not {type(solver).__name__}")
    return partial(Model, laws=laws, solver=solver, began=began)


def check_columns(columns: Iterable[Quantity], laws: Laws | None = None) -> tuple[Quantity, ...]:
    """Return user-defined columns as a tuple; raise an error if they cannot be recorded."""
    columns, taken = tuple(columns), _reserved_names(laws)
    for column in columns:
        _check_name("columns", column, taken)
        if column.dims not in DIMS or not callable(column.of) or column.role:
            needed = f"of, a function of a contact, dims of {', '.join(map(str, DIMS))}, no role"
            raise ValueError(f"columns: {column.name!r} needs {needed}")
    return columns


def check_observer_columns(observers: Iterable[Observer], columns: Iterable[Quantity] = ()) -> None:
    """Raise an error unless the columns and fields of all observers of a run can be recorded.

    Raises
    ------
    TypeError
        If an observer is no Observer, or a column or field is no Quantity.
    ValueError
        If a name is taken, or dimensions are not allowed.
    """
    taken = _reserved_names(None) | {column.name for column in columns}
    # Names of observers of the package, and prefixes of what else is stored to resume.
    names = {"damage", "heat", "stress", "worn", "gained", "before", "traction", "slip"}
    for seen in observers:
        if not isinstance(seen, Observer):
            raise TypeError(f"observers: each must be a ts.Observer, not {shorten(seen)}")
        if seen.key:  # of this package
            continue
        if not seen.name.isidentifier() or seen.name in names:
            allowed = "an identifier (letters, digits, _) that no other observer has"
            raise ValueError(f"observers: the name must be {allowed}, not {seen.name!r}")
        names.add(seen.name)
        where = f"observers: {seen.name}"
        for quantity in (*seen.columns, *seen.fields):
            _check_name(where, quantity, taken)
        wrong = [column.name for column in seen.columns if column.dims not in DIMS or column.role]
        wrong += [field.name for field in seen.fields if field.dims or field.role]
        if wrong:
            needed = f"dims of {', '.join(map(str, DIMS))} (none for a field) and no role"
            raise ValueError(f"{where}: {wrong[0]!r} needs {needed}")


def _reserved_names(laws: Laws | None) -> set[str]:
    """Return the names that user-defined columns and fields cannot have.

    `laws` add the columns of their stress criterion.
    """
    stress = () if laws is None else stress_columns(laws.criterion)
    taken = {"status", "message", "record", "saved", "x", "y"}
    columns = {column.name for column in (*COLUMNS, *stress)}
    return taken.union(columns, PACKAGE_FIELDS, LABELS, DERIVED)


def _check_name(where: str, quantity: Quantity, taken: set[str]) -> None:
    """Raise an error if the name of a quantity is in `taken`; else add it there."""
    if not isinstance(quantity, Quantity):
        raise TypeError(f"{where}: must be a Quantity, not {type(quantity).__name__}")
    if not quantity.name.isidentifier() or quantity.name in taken:
        allowed = "an identifier (letters, digits, _) that no other column or field has"
        raise ValueError(f"{where}: the name must be {allowed}, not {quantity.name!r}")
    taken.add(quantity.name)


def read_measured_gap(scene: Scene) -> Gap | None:
    """Return the measured separation of a scene, read from its file if it names one."""
    return None if scene.gap is None else read_gap(scene.gap)


def read_profiles(scene: Scene) -> tuple[Gap, ...]:
    """Return the moving profiles of a [transient], read from their files."""
    return tuple(read_gap(profile, key) for key, profile in scene.schedule.profiles.items())


def hash_measurements(model: Model) -> str:
    """Return the SHA-256 of a model's measured gap and profiles; empty without them."""
    maps = [map_ for map_ in (model.measured, *model.profiles) if map_ is not None]
    numbers = b"".join(np.ascontiguousarray(part).tobytes() for map_ in maps for part in map_)
    return hashlib.sha256(numbers).hexdigest() if maps else ""


def depths_of(wear: ArrayLike, grid: Grid) -> np.ndarray:
    """Return user-defined wear depths as floats on the mesh, mm; raise an error for others."""
    # Largest depth of wear, mm: beyond it rounding errors would exceed the gap.
    deepest = 1e6
    needed = f"wear: must be numbers up to {deepest:g} mm in the shape {grid.elements}"
    try:
        depths = np.asarray(wear)
    except ValueError:  # rows of different lengths
        raise ValueError(needed) from None
    # "not all" rather than "any": nan must fail, too
    if (
        depths.dtype.kind not in "fiu"
        or depths.shape != grid.elements
        or np.ma.is_masked(wear)
        or not (np.abs(depths) <= deepest).all()
    ):
        raise ValueError(needed)
    return depths.astype(float)


def check_start(start: State, grid: Grid) -> None:
    """Raise an error unless an initial guess is a contact on this mesh."""
    if not isinstance(start, State):
        raise TypeError(f"start: must be a State (solve returns one), not {type(start).__name__}")
    if start.grid != grid:
        raise ValueError(
            f"start: its mesh must equal the scene's, {grid.elements} elements "
            f"over {grid.half_length} mm, not {start.grid.elements} over {start.grid.half_length}: "
            "give both scenes one [grid]"
        )
    shape = grid.elements
    for name, field, wanted in (
        ("pressure", start.pressure, shape),
        ("traction", start.traction, (2, *shape)),
        ("approach", start.approach, ()),
        ("creepages", (start.xi_x, start.xi_y), (2,)),
    ):
        if np.shape(field) != wanted or not (np.abs(field) <= LARGEST).all():
            raise ValueError(f"start: its {name} must be finite numbers in the shape {wanted}")


def warn_of_gap(model: Model) -> None:
    """Issue warnings on gap maps that the mesh does not resolve, or that do not roll."""
    for note in gap_notes(model):
        warn(note)


def gap_notes(model: Model) -> Iterator[str]:
    """Yield notes on the gap maps of a model: [gap], and moving profiles of a [transient]."""
    measured, grid = model.measured, model.grid
    short = [] if measured is None else uncovered_axes(measured, grid)
    if short:
        yield (
            f"gap: the measured separation covers less than the grid in {' and '.join(short)}; "
            "beyond its edge it is continued as a constant. Measure a larger area, or reduce "
            "grid.half_length"
        )
    for table, roughness in rough_maps(model.scene, measured, model.profiles, grid.half_length):
        if any(roughness.unresolved(grid)):
            yield f"{table}: {unresolved_note(model, roughness)}"
    rolls = model.transmits or bool(model.scene.schedule.end)
    if measured is not None and rolls and (rest := standing_roughness(measured, grid)):
        yield (
            f"gap: it varies along x by {rest:.2g} mm rms in addition to a round form. In steady "
            "rolling a gap is fixed in space: asperities and waves do not travel through the "
            "contact. Only ridges along x belong to bodies that turn"
        )


def unresolved_note(model: Model, map_: Roughness) -> str:
    """Describe the roughness that the mesh does not resolve, and the cost to resolve it."""
    grid, parts, finer = model.grid, map_.unresolved_parts(model.grid), map_.resolving(model.grid)
    axes = [k for k, n in enumerate(grid.elements) if n > 1]
    sides, shortest = (grid.dx, grid.dy), (finer.dx, finer.dy)
    samples = " x ".join(f"{max(parts[k].samples, 0.0):.2g}" for k in axes)
    waves = " x ".join(f"{2.0 * sides[k]:.2g}" for k in axes)
    height = math.hypot(*(part.height for part in parts))
    pressure = math.hypot(*map(map_.flattening, parts))
    more = math.prod(finer.elements) / math.prod(grid.elements)
    mib = memory.contact_bytes(model) * more / 2**20
    resolved = " x ".join(f"{2.0 * shortest[k]:.2g}" for k in axes)
    return (
        f"an element has {samples} samples of it, and the mesh resolves no waves shorter than two "
        f"elements, {waves} mm: it misses {height:.2g} mm rms of the map, which take "
        f"{pressure:.2g} MPa to flatten, {pressure / map_.pressure:.2g} times the pressure of the "
        "contact. The gap is sampled at the centres of elements, so that p_max and the contact "
        f"area depend on the mesh. {describe_grid_entries(finer)} resolves waves of {resolved} mm: "
        f"{math.prod(finer.elements)} elements, {mib:.0f} MiB and about {more:.2g} times the time "
        "of this mesh. Or smooth the measurement"
    )
