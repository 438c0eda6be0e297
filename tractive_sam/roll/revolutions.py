"""Rolling: the sequence of revolutions, one record each."""

from collections.abc import Iterator

from tractive_sam.contact import Model
from tractive_sam.record import Record, record
from tractive_sam.roll.passage import Passage, next_passage, unworn


def passages(model: Model, start: Passage | None = None) -> Iterator[Passage]:
    """Roll the revolutions of a scene one after another (``stepping = "every-revolution"``).

    Stops after the first contact that is not solved.

    Parameters
    ----------
    model : Model
        The scene in numbers; without [wear] only the new bodies are solved.
    start : Passage, optional
        Where to go on; by default with the new bodies, which are then the first one yielded.
    """
    last = start
    if last is None:
        last = unworn(model)
        yield last
    wear = model.scene.wear
    while wear is not None and last.contact.converged and last.revolution < wear.revolutions:
        last = next_passage(model, last)
        yield last


def recorded(passage: Passage) -> Record:
    """The record of a passage, with its fields where the scene saves them or the roll ends."""
    scene = passage.contact.scene
    keep = scene.wear is None or passage.revolution in scene.wear.save
    return record(
        passage.contact, passage.revolution, with_fields=keep or not passage.contact.converged
    )
