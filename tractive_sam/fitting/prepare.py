"""Scenes of a data set on one mesh and with fixed steps, whatever the parameters are.

A mesh that follows the contact, and steps that follow the error, jump while parameters vary: sums
of squares would have steps. Both are chosen once, at the first values of the parameters.
"""

import math
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from tractive_sam.contact import Model, extend_to, solve_on_fitted_mesh
from tractive_sam.fitting.case import Answer, is_steady
from tractive_sam.fitting.design import is_integer
from tractive_sam.results import COLUMNS, Grid, index_by_name
from tractive_sam.run import read_measured_gap, roll
from tractive_sam.scene import Scene
from tractive_sam.schema import Fault, SceneError

Remember = Callable[[str, Callable[[], Answer]], Answer]
"""Returns the answer of a digest; computes it if it is not known."""


@dataclass
class SharedRecords:
    """Records (revolutions or distances) that data sets observe of each scene, rolled once for all.

    Attributes
    ----------
    complete : bool
        Whether all data sets have added theirs.
    """

    complete: bool = True
    _places: dict[str, dict[str, float]] = field(default_factory=dict)

    def add(self, scene: Scene, places: list[float]) -> None:
        """Add revolutions or distances that are observed of a scene; nan is its last record."""
        places_of_scene = self._places.setdefault(scene.fingerprint(), {})
        places_of_scene |= {repr(at): at for at in places}

    def of_scene(self, scene: Scene) -> list[float]:
        """Return all revolutions or distances that are observed of a scene."""
        return list(self._places[scene.fingerprint()].values())


def drop_tables(scene: Scene, columns: Iterable[str], unworn: bool) -> Scene:
    """Return a scene without [subsurface] and [fatigue] if unneeded, and [wear] if `unworn`.

    Parameters
    ----------
    scene : Scene
        A scene.
    columns : iterable of str
        Columns of a record; "worn_mass A" is a column of body A.
    unworn : bool
        Whether the bodies are observed before they wear: then [wear] is left out as well.

    Raises
    ------
    SceneError
        If records of the scene lack a column.
    """
    # Tables that are left out if no observation needs them.
    costly = ("subsurface", "fatigue")
    quantities = index_by_name(COLUMNS)
    wanted = [quantities[name.partition(" ")[0]] for name in columns]
    if unworn and scene.wear is not None:
        scene = scene.replace(wear=None, duty=None, load_history=None)
    for name in costly:
        if getattr(scene, name) is not None:
            without = scene.replace(**{name: None})
            if all(quantity.applies(without) for quantity in wanted):
                scene = without
    for quantity in wanted:
        if not quantity.applies(scene) or (quantity.of is None and is_steady(scene)):
            needs = " and ".join(f"[{name}]" for name in quantity.needs) or "[wear] or [transient]"
            raise SceneError([Fault("observe", quantity.name, f"only with {needs} in the scene")])
    return scene


def check_places(scene: Scene, source: str, places: Iterable[float]) -> None:
    """Raise a SceneError if a scene has no record of observed revolutions or distances.

    Parameters
    ----------
    scene : Scene
        Scene of the rows.
    source : str
        What states the places: "at", "revolution" or "distance".
    places : iterable of float
        The places; nan stands for the last record.
    """
    observed = [at for at in places if not math.isnan(at)]
    key = "at" if source == "at" else "vary"
    along = {"wear.save": "revolution", "transient.save": "distance"}.get(scene.schedule.save_key)
    if is_steady(scene):
        along, observed = "", [at for at in observed if at or source != "at"]
    if not observed:
        return
    if not along or source not in ("at", along):
        records = f"records are by {along}" if along else "the scene is one contact"
        cure = f"{along or 'a scene with [wear] or [transient]'}: {records}"
        raise SceneError([Fault(key, f"{source} {observed[0]:g}", cure)])
    first = scene.transient.knots[0] if scene.transient else 0.0
    last = scene.schedule.end
    for at in observed:
        if along == "revolution" and at != round(at):
            raise SceneError([Fault(key, f"revolution {at:g}", "whole numbers of revolutions")])
        if along == "distance" and not first <= at <= last:
            reach = f"distances of [transient], {first:g} to {last:g} mm"
            raise SceneError([Fault(key, f"{at:g} mm", reach)])


def fix_mesh(
    scene: Scene, neighbours: Iterable[Scene], places: Sequence[float], remember: Remember
) -> dict[str, Any]:
    """Return the changes of a scene that fix its mesh and its steps while parameters vary.

    Parameters
    ----------
    scene : Scene
        Scene at the first values of the parameters.
    neighbours : iterable of Scene
        At other values of each: a mesh that these share is left to the scene.
    places : sequence of float
        Revolutions or distances that are observed, which the scene then records; nan stands for
        the last one.
    remember : callable
        Stores the steps, see `Remember`.

    Raises
    ------
    SceneError
        If the scene cannot be computed at the first values.
    """
    # Half lengths of a fixed mesh over the half axes of the contact at the first values.
    margin = 1.25
    changes: dict[str, Any] = {}
    observed = {at for at in places if not math.isnan(at)}
    if scene.transient is not None:
        changes = {"transient.save": tuple(sorted({*scene.transient.save, *observed}))}
    stated = sorted(map(round, observed))
    if scene.wear is not None and scene.wear.revolutions:
        last = any(map(math.isnan, places)) or not stated
        end = max([*stated, *([scene.wear.revolutions] if last else [])])
        saved = [n for n in scene.wear.save if n < end and scene.schedule.fixed]
        save = tuple(sorted({0, *saved, *stated, end}))
        changes = {"wear.revolutions": end, "wear.save": save}
    if changes:
        scene = scene.replace(**changes)
    grid = None
    if scene.wear is not None and scene.wear.stepping == "adaptive" and not is_steady(scene):
        steps, grid = _steps_of(scene, remember)
        changes |= {"wear.stepping": "saved", "wear.save": steps}
    if any(_mesh(neighbour) != _mesh(scene) for neighbour in neighbours):
        if grid is None:
            grid = solve_on_fitted_mesh(Model(scene, read_measured_gap(scene)))[1].grid
        x, y = grid.half_length
        wider = extend_to(grid, (margin * x, margin * y))
        changes |= grid_entries(wider)
    return changes


def _mesh(scene: Scene) -> tuple[Any, ...]:
    """Return half length, elements and centre of the mesh that a scene chooses."""
    grid = Model(scene, read_measured_gap(scene)).grid
    return grid.half_length, grid.elements, grid.centre


def grid_entries(grid: Grid) -> dict[str, Any]:
    """Return the [grid] entries of a scene that define a mesh, by dotted key."""
    axes = slice(grid.directions)
    entries = {"grid.half_length": grid.half_length[axes], "grid.elements": grid.elements[axes]}
    return entries | ({"grid.centre": grid.centre[axes]} if any(grid.centre) else {})


def on_finer_mesh(scene: Scene) -> Scene:
    """Return a scene on a mesh of equal extent with 1.5 times as many elements along each axis."""
    # Ratio of the numbers of elements of the finer mesh and the mesh, along each axis.
    refinement = 1.5
    grid = Model(scene, read_measured_gap(scene)).grid
    n_x, n_y = (2 * round(0.5 * (refinement * n - 1)) + 1 if n > 1 else 1 for n in grid.elements)
    return scene.replace(**grid_entries(replace(grid, elements=(n_x, n_y))))


def _steps_of(scene: Scene, remember: Remember) -> tuple[tuple[int, ...], Grid]:
    """Return (revolutions, last mesh) of a roll with adaptive steps, computed once and stored."""
    numbers = remember(f"steps {scene.fingerprint()}", lambda: _roll_adaptively(scene)).numbers
    (x, y), (n_x, n_y) = numbers["half_length"].tolist(), numbers["elements"].tolist()
    steps = tuple(round(n) for n in numbers["steps"])
    centre = (0.0, 0.0) if scene.grid is None else scene.grid.place
    return steps, Grid((x, y), (round(n_x), round(n_y)), centre=centre)


def _roll_adaptively(scene: Scene) -> Answer:
    """Roll a scene with adaptive steps; return its revolutions and last mesh as an answer."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        history = roll(scene, progress=False)
    if not history.finished:
        cure = f"a scene that can be rolled to its end; {history.message}"
        raise SceneError([Fault("scene", "a roll that ends early", cure)])
    numbers = {
        "steps": history["revolution"].astype(float),
        "half_length": np.array(history.grid.half_length),
        "elements": np.array(history.grid.elements, float),
    }
    contacts = int(history.totals["contact_solves"])
    return Answer(numbers, contacts, 1, float(np.nansum(history["convolutions"])))


def scale_steps(scene: Scene, changes: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return changes of a scene with the fixed steps scaled to a fitted number of revolutions."""
    end, steps = changes.get("wear.revolutions"), scene.wear.save if scene.wear else ()
    if end is None or not steps or steps[-1] == end or not is_integer(scene, "wear.revolutions"):
        return changes
    save = tuple(sorted({round(n * end / steps[-1]) for n in steps}))
    return {**changes, "wear.save": save}
