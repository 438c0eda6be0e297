"""Many similar contacts at the cost of their Newton steps."""

import math
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from time import perf_counter
from typing import Any

import numpy as np

from tractive_sam import interrupt
from tractive_sam.contact import Model, check_jacobian, equilibrium, fitted, jacobian_of
from tractive_sam.extras import check_extra
from tractive_sam.operators import one_blas_thread
from tractive_sam.optional import xarray
from tractive_sam.results import History, Quantity, State, Status, columns
from tractive_sam.rolling import begun, process_of
from tractive_sam.run import given, memory
from tractive_sam.run.gap_notes import warn_of_gap
from tractive_sam.run.given import measured_gap
from tractive_sam.run.pipeline import roll
from tractive_sam.run.recording import Recording
from tractive_sam.scene import Scene
from tractive_sam.schema import Fault, SceneError, shorten

CREEPAGES = ("creepage.longitudinal", "creepage.lateral", "creepage.spin")
"""What changes nothing but the rigid slip: a scene is checked, and operators are made, once."""


@one_blas_thread()
def solve_many(
    scene: Scene, over: Mapping[str, Sequence[Any]], *, jacobian: bool = False
) -> "xarray.Dataset":
    """Solve one steady state for every combination of some entries of a scene.

    Creepages cost least: a scene under other creepages is not checked again, shares mesh, gap and
    operators, and starts from the contact solved before it, which is a neighbour. For any other
    entry, such as ``load.normal``, the scene is checked and set up once for each of its values.

    Parameters
    ----------
    scene : Scene
        What does not vary; its [wear] and [[duty]] are not rolled.
    over : mapping of str to sequence
        Values by dotted key, ``{"creepage.longitudinal": [-1e-3, -2e-3], "friction.mu": [0.2]}``.
    jacobian : bool
        Whether to compute the derivatives too, as ``jacobian``; see `State.jacobian`.

    Returns
    -------
    xarray.Dataset
        Over the keys: forces, creepages and all other recorded numbers of a contact, nan where it
        was not solved, and ``converged``, ``status`` and ``message`` of each case. Units and
        descriptions are attributes.

    Raises
    ------
    TypeError
        If `scene` is no Scene.
    SceneError
        With the faults of the entries and their values; if no mesh can be chosen, or the memory
        does not suffice.
    ValueError
        If the scene has [accuracy], or a Jacobian is asked for without friction.
    ImportError
        Without xarray, which comes with the extra ``study``.
    GapError
        If the measured gap cannot be read.

    Examples
    --------
    >>> import tractive_sam as ts
    >>> coarse = ts.Scene.builtin("spheres").with_set(["grid.elements=[23, 23]"])
    >>> found = ts.solve_many(coarse, {"creepage.longitudinal": [-1e-3, -2e-3, -3e-3]})
    >>> found["Qx"].dims, bool(found["converged"].all())
    (('creepage.longitudinal',), True)
    >>> bool((found["Qx"].diff("creepage.longitudinal") > 0.0).all())
    True
    """
    check_extra("xarray", "solve_many")
    given.check_scene(scene)
    if scene.accuracy is not None:
        raise ValueError("solve_many: one mesh is needed; give the scene [grid], not [accuracy]")
    scene = scene.without_blocks
    columns_over = _checked(scene, over)
    shape = tuple(map(len, columns_over.values()))
    numbers: dict[str, np.ndarray] = {}
    described: dict[str, Quantity] = {}
    told = {name: np.full(shape, "", dtype=object) for name in ("status", "message")}
    derivatives: dict[tuple[int, ...], Any] = {}
    noted = set[tuple[int, int]]()
    for place, model, contact in _solved(scene, columns_over, jacobian):
        if model.grid.elements not in noted:  # once for all loads and creepages on a mesh
            noted.add(model.grid.elements)
            warn_of_gap(model)
        told["status"][place], told["message"][place] = str(contact.status.value), contact.message
        if not contact.converged:
            continue
        for name, one in columns(contact.scene).items():
            if one.of is None or one.dims:
                continue
            if name not in numbers:
                numbers[name], described[name] = np.full(shape, math.nan), one
            numbers[name][place] = one.of(contact)
        if jacobian:
            derivatives[place] = jacobian_of(model, contact)

    dims = [*columns_over]
    variables: dict[str, Any] = {
        name: (dims, values, _attributes(described[name])) for name, values in numbers.items()
    }
    solved = told["status"] == Status.CONVERGED.value
    variables["converged"] = (dims, solved.astype(bool))
    variables |= {name: (dims, texts.astype(str)) for name, texts in told.items()}
    coordinates: dict[str, Any] = {
        key: (key, _as_array(values), {"long_name": Scene.find_field(key).title or key})
        for key, values in columns_over.items()
    }
    if derivatives:
        first = next(iter(derivatives.values()))
        values = np.full((*shape, *first.shape), math.nan)
        for place, one in derivatives.items():
            values[place] = one.values
        variables["jacobian"] = ([*dims, *first.dims], values)
        coordinates |= {name: first[name].values for name in first.dims}
    return xarray.Dataset(variables, coordinates, {"title": scene.title})


def _attributes(quantity: Quantity) -> dict[str, str]:
    return {"units": quantity.unit, "long_name": quantity.long_name}


def _as_array(values: tuple[Any, ...]) -> np.ndarray:
    numbers = all(isinstance(one, int | float) and not isinstance(one, bool) for one in values)
    return np.array(values if numbers else [str(one) for one in values])


def _checked(scene: Scene, over: Mapping[str, Sequence[Any]]) -> dict[str, tuple[Any, ...]]:
    """The values by key, each of them valid beside the first ones of the others."""
    allowed = "entries of a scene and a list of values of each"
    if not isinstance(over, Mapping) or not over:
        raise SceneError([Fault("over", shorten(over), allowed)])
    faults, found = [], {}
    for key, values in over.items():
        if isinstance(values, str | Mapping) or not np.iterable(values) or not list(values):
            faults.append(Fault(f"over.{key}", shorten(values), "a list of at least one value"))
            continue
        try:
            Scene.find_field(key)
        except SceneError as error:
            faults += error.faults
            continue
        found[key] = tuple(v.item() if isinstance(v, np.generic) else v for v in values)
    if faults:
        raise SceneError(faults)
    with warnings.catch_warnings():  # they come again where the case is made
        warnings.simplefilter("ignore")
        _replaced(scene, found, [{key: one} for key, values in found.items() for one in values])
    return found


def _replaced(
    scene: Scene, over: Mapping[str, tuple[Any, ...]], cases: Sequence[Mapping[str, Any]]
) -> list[Scene]:
    """The scene of each case; what that does not change has its first value.

    Raises
    ------
    SceneError
        With the faults of all of them, and the values that led to those of other entries.
    """
    first = {key: values[0] for key, values in over.items()}
    scenes, faults = [], list[Fault]()
    for case in cases:
        try:
            scenes.append(scene.replace(**first | case))
        except SceneError as error:
            faults += [_told_with(case, first, one) for one in error.faults]
    if faults:
        raise SceneError([*dict.fromkeys(faults)])
    return scenes


def _told_with(case: Mapping[str, Any], first: Mapping[str, Any], fault: Fault) -> Fault:
    """A fault with the other values that led to it, unless it is of the only one of the case."""
    if len(case) == 1 and any(key in fault.key for key in case):
        return fault
    others = {key: value for key, value in (first | case).items() if key not in fault.key}
    told = ", ".join(f"{key} = {shorten(value)}" for key, value in others.items())
    return replace(fault, given=f"{fault.given} with {told}") if told else fault


def _solved(
    scene: Scene, over: dict[str, tuple[Any, ...]], jacobian: bool
) -> Iterator[tuple[tuple[int, ...], Model, State]]:
    """Every case by its place, neighbours one after another."""
    keys = [*over]
    moving = [key for key in keys if key in CREEPAGES]
    others = [key for key in keys if key not in CREEPAGES]
    places = list(snake(tuple(len(over[key]) for key in others)))
    cases = [{key: over[key][k] for key, k in zip(others, one, strict=True)} for one in places]
    start = None
    for outer, changed in zip(places, _replaced(scene, over, cases), strict=True):
        chosen = Model(changed, measured_gap(changed))
        memory.check_solve(chosen)
        if jacobian:
            check_jacobian(chosen)
        for inner in snake(tuple(len(over[key]) for key in moving)):
            interrupt.raise_if_interrupted()
            creepages = {key: over[key][k] for key, k in zip(moving, inner, strict=True)}
            model, contact = nearby(under(chosen, creepages), start)  # maybe on a wider mesh
            start = contact if contact.converged else None
            at = dict(zip(others, outer, strict=True)) | dict(zip(moving, inner, strict=True))
            yield tuple(at[key] for key in keys), model, contact


def under(model: Model, creepages: Mapping[str, float]) -> Model:
    """A model under other creepages, by their dotted keys; it shares all that they do not change.

    The values are not checked.
    """
    if not creepages:
        return model
    values = {key.rpartition(".")[2]: float(value) for key, value in creepages.items()}
    moved = model.scene.creepage.model_copy(update=values)
    return _of_scene(model, model.scene.model_copy(update={"creepage": moved}))


SHARED = ("undeformed_gap", "operators", "units")
"""What of a model costs time and does not change with the creepages."""


def _of_scene(model: Model, scene: Scene) -> Model:
    """A model of a scene that differs from its own by creepages alone."""
    other = Model(scene, model.measured, model.grid, model.laws)
    for name in SHARED:
        other.__dict__[name] = getattr(model, name)
    return other


def nearby(model: Model, start: State | None) -> tuple[Model, State]:
    """Solve from a contact nearby, and from none where that leads nowhere.

    Nor where there may be several solutions, of which the first guess would choose.
    """
    several = model.scene.heat is not None or model.friction_law.falls
    if start is not None and start.grid == model.grid and not several:
        contact = equilibrium(model, model.worn_before, start)
        if contact.converged:
            return model, contact
    return fitted(model)


def snake(shape: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
    """All places of an array, each beside the one before it."""
    if not shape:
        yield ()
        return
    inner = list(snake(shape[1:]))
    for k in range(shape[0]):
        yield from ((k, *rest) for rest in (reversed(inner) if k % 2 else inner))


class InTurn:
    """Rolls scenes in memory, one after another, each from the contact before it.

    Scenes that differ by creepages alone share mesh, gap and operators. Where the mesh is the same,
    the contact solved before is the first guess. What is found is that of `roll` to the tolerance
    of the solver: the mesh is always the one that the scene has by itself, and a scene whose
    solution might hang on its first guess, or that is rolled on, begins from none.
    """

    def __init__(self) -> None:
        self._model: Model | None = None
        self._contact: State | None = None

    @one_blas_thread()
    def roll(self, scene: Scene) -> History:
        """The history of a scene, as of `roll` without a file."""
        if not _is_one_contact(scene):
            return roll(scene, progress=False)
        began = perf_counter()
        chosen = self._model_of(scene)
        memory.check_roll(chosen, in_memory=True)
        model, contact = nearby(chosen, self._contact)
        self._model, self._contact = chosen, contact if contact.converged else None
        run = Recording(scene, chosen.measured, Model, None, False, None, (), began)
        return run.begun(process_of(model), begun(model, (contact,)))

    def _model_of(self, scene: Scene) -> Model:
        if self._model is not None:
            before = self._model.scene
            if scene == before.model_copy(update={"creepage": scene.creepage}):
                return _of_scene(self._model, scene)
        return Model(scene, measured_gap(scene))


def _is_one_contact(scene: Scene) -> bool:
    """Whether nothing is rolled or refined."""
    asked = scene.wear, scene.accuracy, scene.transient, scene.spectrum
    return all(one is None for one in asked)
