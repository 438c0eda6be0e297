"""Which process a scene takes."""

from collections.abc import Iterator

from tractive_sam.contact import Model
from tractive_sam.rolling.process import Process, Step
from tractive_sam.rolling.revolutions import DutyCycle, Revolutions
from tractive_sam.rolling.transient import Transient
from tractive_sam.scene import Scene


def process_type(scene: Scene) -> type[Process]:
    """Return the process that the schedule and the blocks of a scene ask for."""
    if not scene.schedule.revolves:
        return Transient
    return DutyCycle if scene.spectrum else Revolutions


def process_of(model: Model) -> Process:
    """Return the process of a model."""
    return process_type(model.scene)(model)


def steps(model: Model, start: Step | None = None) -> Iterator[Step]:
    """Yield the steps of a model after one; by default all of them."""
    return process_of(model).steps(start)
