"""Rolling: the sequence of revolutions, one record each."""

from collections.abc import Iterator

from tractive_sam.contact import Model
from tractive_sam.record import Record, record
from tractive_sam.rolling.adaptive import adaptive_passages
from tractive_sam.rolling.passage import Passage, next_passage, unworn


def passages(model: Model, start: Passage | None = None) -> Iterator[Passage]:
    """Roll a scene through its revolutions.

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
    if wear is None or not last.contact.converged:
        return
    if wear.stepping == "adaptive":
        yield from adaptive_passages(model, last)
    else:
        yield from every_passage(model, last)


def every_passage(model: Model, start: Passage) -> Iterator[Passage]:
    """Roll one revolution after another to the end, the paper's way."""
    last = start
    while last.contact.converged and last.revolution < model.scene.wear.revolutions:
        last = next_passage(model, last)
        yield last


def recorded(passage: Passage) -> Record:
    """The record of a passage, with its fields where the scene saves them or the roll ends."""
    scene = passage.contact.scene
    keep = scene.wear is None or passage.revolution in scene.wear.save
    return record(
        passage.contact, passage.revolution, with_fields=keep or not passage.contact.converged
    )
