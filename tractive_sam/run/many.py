"""Solve many similar contacts, each from the solution of a neighbouring one."""

import math
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any

import numpy as np

from tractive_sam import interrupt
from tractive_sam.compute import numeric_settings
from tractive_sam.contact import (
    Model,
    check_jacobian,
    equilibrium,
    jacobian_of,
    solve_on_fitted_mesh,
)
from tractive_sam.extra_packages import xarray
from tractive_sam.extras import check_extra
from tractive_sam.results import History, Quantity, State, Status, columns
from tractive_sam.rolling import process_of, start_passage
from tractive_sam.run import inputs, memory
from tractive_sam.run.inputs import read_measured_gap, warn_of_gap
from tractive_sam.run.pipeline import roll
from tractive_sam.run.recording import Recording
from tractive_sam.scene import Scene
from tractive_sam.schema import Fault, SceneError, shorten

Values = Mapping[str | tuple[str, ...], Sequence[Any]] | Mapping[str, Sequence[Any]]
"""Lists of values of keys of a scene, or rows of values of several keys together."""


@numeric_settings()
def solve_many(scene: Scene, over: Values, *, jacobian: bool = False) -> "xarray.Dataset":
    """Solve all combinations of values; return an xarray Dataset, nan where a contact is unsolved.

    Creepages cost least: a scene under other creepages is not checked again, shares mesh, gap and
    operators, and starts from the contact solved before it, which is a neighbour. For any other
    entry, for example ``load.normal``, the scene is checked and set up once for each of its values.

    Parameters
    ----------
    scene : Scene
        Scene with all other entries; its [wear] and [[duty]] are not rolled.
    over : mapping of str to sequence
        Values by dotted key, ``{"creepage.longitudinal": [-1e-3, -2e-3], "friction.mu": [0.2]}``.
        Several keys as a tuple vary together, with a row of values for each case:
        ``{("load.normal", "creepage.spin"): [(100.0, 0.0), (200.0, 1e-3)]}``.
    jacobian : bool
        Whether to compute the derivatives too, as ``jacobian``; see `State.jacobian`.

    Returns
    -------
    xarray.Dataset
        Dimensions: the keys of `over`; "case" for keys that vary together. Variables: forces,
        creepages and all other recorded numbers of a contact, nan for cases that were not solved;
        ``converged``, ``status`` and ``message`` of each case. Units and descriptions are
        attributes.

    Raises
    ------
    TypeError
        If `scene` is not a Scene.
    SceneError
        With the faults of the entries and their values; if no mesh can be chosen, or the memory
        does not suffice.
    ValueError
        If the scene has [accuracy], or `jacobian` is True for a scene without friction.
    ImportError
        If xarray is not installed; the extra ``study`` installs it.
    GapError
        If the measured gap cannot be read.

    Examples
    --------
    >>> import tractive_sam as ts
    >>> coarse = ts.Scene.builtin("spheres").with_set(["grid.elements=[15, 15]"])
    >>> results = ts.solve_many(coarse, {"creepage.longitudinal": [-1e-3, -2e-3, -3e-3]})
    >>> results["Qx"].dims, bool(results["converged"].all())
    (('creepage.longitudinal',), True)
    >>> bool((results["Qx"].diff("creepage.longitudinal") > 0.0).all())
    True
    """
    check_extra("xarray", "solve_many")
    inputs.check_scene(scene)
    if scene.accuracy is not None:
        raise ValueError("solve_many: one mesh is needed; give the scene [grid], not [accuracy]")
    scene = scene.with_current_files(fix=True).without_blocks
    axes = _check_values(scene, over)
    cases, noted = _CaseTable(axes), set[tuple[int, int]]()
    for place, model, contact in _solve_cases(scene, axes, jacobian):
        if model.grid.elements not in noted:  # once for all loads and creepages on a mesh
            noted.add(model.grid.elements)
            warn_of_gap(model)
        cases.add(place, contact)
        if jacobian and contact.converged:
            cases.derivatives[place] = jacobian_of(model, contact)
    return cases.dataset(scene.title)


class _CaseTable:
    """Arrays of results over the axes of `solve_many`, filled case by case.

    Parameters
    ----------
    axes : sequence of _Axis
        The axes.
    """

    def __init__(self, axes: "Sequence[_Axis]") -> None:
        self.axes, self.shape = axes, tuple(len(axis.rows) for axis in axes)
        self.numbers: dict[str, np.ndarray] = {}
        self.quantities: dict[str, Quantity] = {}
        self.texts = {name: np.full(self.shape, "", dtype=object) for name in ("status", "message")}
        self.derivatives: dict[tuple[int, ...], xarray.DataArray] = {}

    def add(self, place: tuple[int, ...], contact: State) -> None:
        """Store status and message of a contact, and its values if solved, at its indices."""
        self.texts["status"][place] = str(contact.status.value)
        self.texts["message"][place] = contact.message
        if not contact.converged:
            return
        for name, quantity in columns(contact.scene).items():
            if quantity.of is None or quantity.dims:
                continue
            if name not in self.numbers:
                self.numbers[name] = np.full(self.shape, math.nan)
                self.quantities[name] = quantity
            self.numbers[name][place] = quantity.read(contact)

    def dataset(self, title: str) -> "xarray.Dataset":
        """Return all results as an xarray Dataset over the axes; nan where not solved."""
        dims = [axis.name for axis in self.axes]
        variables: dict[str, Any] = {
            name: (dims, values, self.quantities[name].attributes)
            for name, values in self.numbers.items()
        }
        solved = self.texts["status"] == Status.CONVERGED.value
        variables["converged"] = (dims, solved.astype(bool))
        variables |= {name: (dims, values.astype(str)) for name, values in self.texts.items()}
        coordinates: dict[str, Any] = {
            key: (axis.name, _as_array(values), {"long_name": Scene.find_field(key).title or key})
            for axis in self.axes
            for key, values in zip(axis.keys, zip(*axis.rows, strict=True), strict=True)
        }
        if self.derivatives:
            first = next(iter(self.derivatives.values()))
            values = np.full((*self.shape, *first.shape), math.nan)
            for place, derivative in self.derivatives.items():
                values[place] = derivative.values
            variables["jacobian"] = ([*dims, *first.dims], values)
            coordinates |= {str(name): first[name].values for name in first.dims}
        return xarray.Dataset(variables, coordinates, {"title": title})


def _as_array(values: tuple[Any, ...]) -> np.ndarray:
    """Return values as an array of numbers, or of texts if they are no numbers."""
    numbers = all(isinstance(v, int | float) and not isinstance(v, bool) for v in values)
    return np.array(values if numbers else [str(value) for value in values])


@dataclass(frozen=True)
class _Axis:
    """Axis of `solve_many`: keys that vary together, with their rows of values."""

    name: str
    keys: tuple[str, ...]
    rows: tuple[tuple[Any, ...], ...]

    def changes(self, k: int) -> dict[str, Any]:
        """Return the values of row k by key."""
        return dict(zip(self.keys, self.rows[k], strict=True))


def _check_values(scene: Scene, over: Values) -> list[_Axis]:
    """Check all values in a scene; return the axes, or raise a SceneError with all faults."""
    allowed = "entries of a scene and a list of values of each"
    if not isinstance(over, Mapping) or not over:
        raise SceneError([Fault("over", shorten(over), allowed)])
    axes, faults = list[_Axis](), list[Fault]()
    for key_or_keys, values in over.items():
        keys = key_or_keys if isinstance(key_or_keys, tuple) else (key_or_keys,)
        label = ", ".join(map(str, keys))
        if isinstance(values, str | Mapping) or not np.iterable(values) or not list(values):
            faults.append(Fault(f"over.{label}", shorten(values), "a list of at least one value"))
            continue
        rows = [tuple(row) if isinstance(key_or_keys, tuple) else (row,) for row in values]
        if any(len(row) != len(keys) for row in rows):
            cure = f"rows of {len(keys)} values, one for each key"
            faults.append(Fault(f"over.{label}", shorten(values), cure))
            continue
        try:
            for key in keys:
                Scene.find_field(key)
        except SceneError as error:
            faults += error.faults
            continue
        paired = sum(len(axis.keys) > 1 for axis in axes)
        name = keys[0] if len(keys) == 1 else "case" + (f"_{paired + 1}" if paired else "")
        items = (tuple(v.item() if isinstance(v, np.generic) else v for v in row) for row in rows)
        axes.append(_Axis(name, keys, tuple(items)))
    if faults:
        raise SceneError(faults)
    with warnings.catch_warnings():  # they are issued again when the case is made
        warnings.simplefilter("ignore")
        cases = [axis.changes(k) for axis in axes for k in range(len(axis.rows))]
        _scenes_of_cases(scene, axes, cases)
    return axes


def _scenes_of_cases(
    scene: Scene, axes: Sequence[_Axis], cases: Sequence[Mapping[str, Any]]
) -> list[Scene]:
    """Return the scene of each case; a key that a case leaves out has its axis's first value.

    Raises
    ------
    SceneError
        With the faults of all cases, each with the values that led to it.
    """
    first = {key: value for axis in axes for key, value in axis.changes(0).items()}
    scenes, faults = [], list[Fault]()
    for case in cases:
        try:
            scenes.append(scene.replace(**{**first, **case}))
        except SceneError as error:
            faults += [_add_values(case, first, fault) for fault in error.faults]
    if faults:
        raise SceneError([*dict.fromkeys(faults)])
    return scenes


def _add_values(case: Mapping[str, Any], first: Mapping[str, Any], fault: Fault) -> Fault:
    """Return a fault that also names the other values of the case, unless one key is set."""
    if len(case) == 1 and any(key in fault.key for key in case):
        return fault
    further = {key: value for key, value in {**first, **case}.items() if key not in fault.key}
    note = ", ".join(f"{key} = {shorten(value)}" for key, value in further.items())
    return replace(fault, given=f"{fault.given} with {note}") if note else fault


def _solve_cases(
    scene: Scene, axes: Sequence[_Axis], jacobian: bool
) -> Iterator[tuple[tuple[int, ...], Model, State]]:
    """Yield (indices, model, contact) of every case, in an order of neighbours."""
    # Entries that change the rigid slip alone: operators are made, and a scene is checked, once.
    creepages = ("creepage.longitudinal", "creepage.lateral", "creepage.spin")
    moving = [axis for axis in axes if set(axis.keys) <= set(creepages)]
    fixed = [axis for axis in axes if axis not in moving]
    places = list(neighbouring_places(tuple(len(axis.rows) for axis in fixed)))
    start = None
    scenes = _scenes_of_cases(scene, axes, [_changes(fixed, place) for place in places])
    for outer, changed in zip(places, scenes, strict=True):
        chosen = Model(changed, read_measured_gap(changed))
        memory.check_solve(chosen)
        if jacobian:
            check_jacobian(chosen)
        for inner in neighbouring_places(tuple(len(axis.rows) for axis in moving)):
            interrupt.raise_if_interrupted()
            under = with_creepages(chosen, _changes(moving, inner))
            model, contact = solve_from_nearby(under, start)  # the mesh may be wider
            start = contact if contact.converged else None
            at = dict(zip((axis.name for axis in (*fixed, *moving)), outer + inner, strict=True))
            yield tuple(at[axis.name] for axis in axes), model, contact


def _changes(axes: Sequence[_Axis], place: Sequence[int]) -> dict[str, Any]:
    """Return the values of all axes at the indices of a case, by key."""
    each = zip(axes, place, strict=True)
    return {key: value for axis, k in each for key, value in axis.changes(k).items()}


def with_creepages(model: Model, creepages: Mapping[str, float]) -> Model:
    """Return a copy of a model under other creepages, by key; operators are shared.

    The values are not checked.
    """
    if not creepages:
        return model
    values = {key.rpartition(".")[2]: float(value) for key, value in creepages.items()}
    moved = model.scene.creepage.model_copy(update=values)
    return _share_operators(model, model.scene.model_copy(update={"creepage": moved}))


def _share_operators(model: Model, scene: Scene) -> Model:
    """Return a model for a scene with other creepages only, which shares operators."""
    # Parts of a model that are expensive and do not depend on the creepages.
    shared_names = ("undeformed_gap", "operators", "units")
    shared = Model(scene, model.measured, model.grid, model.laws)
    for name in shared_names:
        shared.__dict__[name] = getattr(model, name)
    return shared


def solve_from_nearby(model: Model, start: State | None) -> tuple[Model, State]:
    """Return (model, contact), solved from a similar contact, else on a newly fitted mesh.

    Nor from it if there may be several solutions, since the initial guess would choose one.
    """
    several = model.scene.heat is not None or model.friction_law.falls
    if start is not None and start.grid == model.grid and not several:
        contact = equilibrium(model, model.initial_wear, start)
        if contact.converged:
            return model, contact
    model, (contact,) = solve_on_fitted_mesh(model)
    return model, contact


def neighbouring_places(shape: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
    """Yield all indices of an array so that successive ones are neighbours."""
    if not shape:
        yield ()
        return
    inner = list(neighbouring_places(shape[1:]))
    for k in range(shape[0]):
        yield from ((k, *rest) for rest in (reversed(inner) if k % 2 else inner))


class SequentialRuns:
    """Runs of scenes in memory; a steady contact starts from the one before.

    Scenes that differ only by creepages share mesh, gap and operators. If the mesh does not change,
    the previous contact is the initial guess. Results agree with `roll` to the tolerance of the
    solver: the mesh is always the one that the scene alone would have. A scene that is rolled
    further, or that may have several solutions, starts without an initial guess.
    """

    def __init__(self) -> None:
        self._model: Model | None = None
        self._contact: State | None = None

    @numeric_settings()
    def roll(self, scene: Scene) -> History:
        """Return the history of a scene, computed in memory."""
        tables = scene.wear, scene.accuracy, scene.transient, scene.spectrum, scene.wheelset
        if any(table is not None for table in (*tables, scene.process)):  # no single contact
            return roll(scene, progress=False)
        began = perf_counter()
        chosen = self._model_with_last_operators(scene)
        memory.check_roll(chosen, in_memory=True)
        model, contact = solve_from_nearby(chosen, self._contact)
        self._model, self._contact = chosen, contact if contact.converged else None
        run = Recording(scene, chosen.measured, Model, None, False, None, (), began)
        return run.begin(process_of(model), start_passage(model, (contact,)))[0]

    def _model_with_last_operators(self, scene: Scene) -> Model:
        """Return the model of a scene, with operators of the last one if only creepages differ."""
        if self._model is not None:
            before = self._model.scene
            if scene == before.model_copy(update={"creepage": scene.creepage}):
                return _share_operators(self._model, scene)
        return Model(scene, read_measured_gap(scene))
