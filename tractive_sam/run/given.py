"""What is given to the front doors: errors name it, and the cure."""

import hashlib
from collections.abc import Callable, Iterable
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from tractive_sam.contact import Gap, Laws, Model, Worn
from tractive_sam.results import (
    BESIDE,
    COLUMNS,
    DIMS,
    FIELDS,
    LABELS,
    WARM,
    Grid,
    Quantity,
    State,
    stress_columns,
)
from tractive_sam.rolling import Observer
from tractive_sam.scene import Scene
from tractive_sam.schema import LARGEST, shorten
from tractive_sam.solvers import Solver
from tractive_sam.store import read_gap

DEEPEST = 1e6
"""Depth of wear, mm, beyond which rounding would take the gap beside it."""


def check_scene(scene: Scene) -> None:
    """See that it is a scene."""
    if not isinstance(scene, Scene):
        cure = "Scene.builtin(name), Scene.from_toml(path) or Scene(...) makes one"
        raise TypeError(f"scene: a Scene is needed, not {type(scene).__name__}; {cure}")


def model_of(
    laws: Laws | None, solver: Solver | None, began: Worn | None = None
) -> Callable[..., Model]:
    """Makes models with laws, a method and worn bodies of one's own, if there are any."""
    if not isinstance(laws, Laws | None):
        cure = "Laws.of(scene).replace(friction=...) makes them"
        raise TypeError(f"laws: Laws are needed, not {type(laws).__name__}; {cure}")
    if solver is not None and not callable(getattr(solver, "solve", None)):
        needed = "an object with solve(problem, tolerance, start), such as solvers.Newton()"
        raise TypeError(f"solver: {needed} is needed, not {type(solver).__name__}")
    return partial(Model, laws=laws, solver=solver, began=began)


def columns_of(columns: Iterable[Quantity], laws: Laws | None = None) -> tuple[Quantity, ...]:
    """Return user-defined columns, if they can be recorded besides the package's."""
    own, taken = tuple(columns), _taken_names(laws)
    for one in own:
        _check_name("columns", one, taken)
        if one.dims not in DIMS or not callable(one.of) or one.role:
            needed = (
                f"of, which reads it off a contact, dims of {', '.join(map(str, DIMS))}, no role"
            )
            raise ValueError(f"columns: {one.name!r} needs {needed}")
    return own


def check_observers(observers: Iterable[Observer], columns: Iterable[Quantity] = ()) -> None:
    """Raise an error unless all observers of a run can record what they say they record.

    Raises
    ------
    TypeError
        If one is no Observer, or what it records no Quantity.
    ValueError
        If a name is taken, or dimensions cannot be.
    """
    taken = _taken_names(None) | {one.name for one in columns}
    # Names of observers of the package, and beginnings of what else is stored to resume from.
    names = {"damage", "heat", "stress", "worn", "gained", "before", "traction", "slip"}
    for seen in observers:
        if not isinstance(seen, Observer):
            raise TypeError(f"observers: a ts.Observer is needed, not {shorten(seen)}")
        if seen.key:  # of this package
            continue
        if not seen.name.isidentifier() or seen.name in names:
            cure = "letters, digits and _ that no other observer is called"
            raise ValueError(f"observers: a name is needed of {cure}, not {seen.name!r}")
        names.add(seen.name)
        where = f"observers: {seen.name}"
        for one in (*seen.columns, *seen.fields):
            _check_name(where, one, taken)
        wrong = [one.name for one in seen.columns if one.dims not in DIMS or one.role]
        wrong += [one.name for one in seen.fields if one.dims or one.role]
        if wrong:
            needed = f"dims of {', '.join(map(str, DIMS))}, and none of a field; no role"
            raise ValueError(f"{where}: {wrong[0]!r} needs {needed}")


def _taken_names(laws: Laws | None) -> set[str]:
    judged = () if laws is None else stress_columns(laws.criterion)
    taken = {"status", "message", "record", "saved", "x", "y", *FIELDS, *WARM, *LABELS, *BESIDE}
    return taken | {one.name for one in (*COLUMNS, *judged)}


def _check_name(where: str, one: Quantity, taken: set[str]) -> None:
    """Raise an error unless a quantity has a name that is not taken; add it to those taken."""
    if not isinstance(one, Quantity):
        raise TypeError(f"{where}: a Quantity is needed, not {type(one).__name__}")
    if not one.name.isidentifier() or one.name in taken:
        cure = "letters, digits and _ that no other column or field is called"
        raise ValueError(f"{where}: a name is needed of {cure}, not {one.name!r}")
    taken.add(one.name)


def measured_gap(scene: Scene) -> Gap | None:
    """The measured separation of a scene, read from its file where it names one."""
    return None if scene.gap is None else read_gap(scene.gap)


def travelling(scene: Scene) -> tuple[Gap, ...]:
    """The profiles that a [transient] has fixed to the bodies, read likewise."""
    return tuple(read_gap(one, table) for table, one in scene.schedule.profiles.items())


def hash_of(model: Model) -> str:
    """SHA-256 of the numbers of a model's measured gap and profiles; empty without them."""
    found = [one for one in (model.measured, *model.profiles) if one is not None]
    numbers = b"".join(np.ascontiguousarray(part).tobytes() for one in found for part in one)
    return hashlib.sha256(numbers).hexdigest() if found else ""


def depths_of(wear: ArrayLike, grid: Grid) -> np.ndarray:
    """Depths of wear given from outside, mm."""
    needed = f"wear: numbers up to {DEEPEST:g} mm of the shape {grid.elements} are needed"
    try:
        depths = np.asarray(wear)
    except ValueError:  # rows of different lengths
        raise ValueError(needed) from None
    # "not all" rather than "any": nan must fail, too
    if (
        depths.dtype.kind not in "fiu"
        or depths.shape != grid.elements
        or np.ma.is_masked(wear)
        or not (np.abs(depths) <= DEEPEST).all()
    ):
        raise ValueError(needed)
    return depths.astype(float)


def check_start(start: State, grid: Grid) -> None:
    """See that a first guess is a contact on the mesh."""
    if not isinstance(start, State):
        raise TypeError(f"start: a State is needed, as of solve, not {type(start).__name__}")
    if start.grid != grid:
        raise ValueError(
            f"start: a contact on the mesh of the scene is needed, {grid.elements} elements "
            f"over {grid.half_length} mm; not {start.grid.elements} over {start.grid.half_length}: "
            "give both scenes the same [grid]"
        )
    shape = grid.elements
    for name, field, wanted in (
        ("pressure", start.pressure, shape),
        ("traction", start.traction, (2, *shape)),
        ("approach", start.approach, ()),
        ("creepages", (start.xi_x, start.xi_y), (2,)),
    ):
        if np.shape(field) != wanted or not (np.abs(field) <= LARGEST).all():
            raise ValueError(f"start: its {name} are to be finite numbers of the shape {wanted}")
