"""Choose the process of a scene, and its observers."""

from collections.abc import Iterable, Iterator
from typing import Any

from tractive_sam.contact import Model
from tractive_sam.rolling.observers import AroundInclusions, Damage, LargestStress
from tractive_sam.rolling.process import Observer, Process, Step
from tractive_sam.rolling.revolutions import DutyCycle, Revolutions
from tractive_sam.rolling.transient import TransientProcess
from tractive_sam.rolling.wheel_rail import ProfileWear, WheelRailPatches
from tractive_sam.scene import Scene
from tractive_sam.schema import Fault, SceneError, build_law, load_law_class


def process_type(scene: Scene) -> type[Process[Any]]:
    """Return the class of the process that a scene names, or that follows from its tables.

    Raises
    ------
    SceneError
        If the scene names a process that may not be used, see `load_law_class`.
    """
    if scene.process is not None:
        return load_law_class("process.name", scene.process.name, Process)
    if scene.wheelset is not None:
        return WheelRailPatches if scene.wear is None else ProfileWear
    if not scene.schedule.revolves:
        return TransientProcess
    return DutyCycle if scene.spectrum else Revolutions


def process_of(model: Model, further: Iterable[Observer] = ()) -> Process[Any]:
    """Return the process of a model, with the observers of its scene and further ones.

    Raises
    ------
    SceneError
        If the scene names a process or an observer that may not be used or does not take its
        parameters, or has a table with an observer that does not follow the process.
    """
    scene = model.scene
    if scene.process is not None:
        process = build_law("process.name", scene.process.name, Process, {"model": model})
    else:
        process = process_type(scene)(model)
    if Damage.applies_to(scene) and all(kind.key != Damage.key for kind in process.observers):
        cure = f"nothing: {type(process).__name__} has no Damage among its observers"
        raise SceneError([Fault(Damage.key, "with this process", cure)])
    stress = [kind() for kind in (LargestStress, AroundInclusions) if kind.applies_to(scene)]
    named = (
        build_law(f"observer[{k}].name", table.name, Observer)
        for k, table in enumerate(scene.observer)
    )
    return process.with_observers((*stress, *named, *further))


def steps(model: Model, start: Step | None = None) -> Iterator[Any]:
    """Yield the steps of a model's process that follow a step; by default all of them."""
    return process_of(model).steps(start)
