"""Rolling: the sequence of revolutions, one record each."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from time import perf_counter
from typing import Any, Protocol

import numpy as np

from tractive_sam.contact import Gap, Laws, Model, across, grown, with_heat
from tractive_sam.results import (
    PARTS,
    ROLLED,
    SHARE,
    Maximum,
    Quantity,
    Record,
    State,
    cycle_record,
    stress_columns,
)
from tractive_sam.rolling.adaptive import adaptive_passages
from tractive_sam.rolling.damage import (
    Damage,
    block_columns,
    fatigue_columns,
    followed,
    life_bars,
    volume_bars,
)
from tractive_sam.rolling.passage import Passage, next_passage, off_grid, unworn
from tractive_sam.rolling.transient import Moment, Transient
from tractive_sam.scene import Schedule, Spectrum
from tractive_sam.subsurface import stress_maxima, stress_on_planes

GROWTHS = 16
"""Most enlargements of a mesh: to 35 times its width."""


def passages(model: Model, start: Passage | Moment | None = None) -> Iterator[Passage | Moment]:
    """Roll a scene through its revolutions, or through the distance of its [transient].

    A mesh that the scene leaves to us grows with the contact; passages from there on are on the
    wider mesh. Stops after the first contact that is not solved.

    Parameters
    ----------
    model : Model
        The scene in numbers.
    start : Passage, optional
        Where to go on; by default with the unworn bodies, which are then the first one yielded.
    """
    begin, onward = _course(model)
    last, growths = start, 0
    if last is None:
        last = begin()
        yield last
    while True:
        for passage in onward(last):
            if off_grid(passage) and not model.scene.bounded and growths < GROWTHS:
                growths += 1
                model = model.on(grown(model.grid, passage.contact.at_edge))
                last = last.on(model.grid)
                _, onward = _course(model)
                break
            if passage.continues:
                last = passage
            yield passage
        else:
            return


def _course(model: Model) -> tuple[Callable[[], Any], Callable[[Any], Iterator[Any]]]:
    """What begins a roll on a mesh, and what goes on to its end or to an unsolved contact."""
    if model.scene.transient is not None:
        transient = Transient(model)
        return transient.start, transient.moments
    return partial(_unworn, model), partial(_revolutions, model)


def _unworn(model: Model) -> Passage:
    return followed(model, unworn(model))


def _revolutions(model: Model, last: Passage) -> Iterator[Passage]:
    schedule = model.scene.schedule
    last = replace(last, contacts=tuple(map(with_heat, model.blocks, last.contacts)))
    steps = adaptive_passages if schedule.adaptive else every_passage
    yield from steps(model, last, schedule)


def every_passage(model: Model, start: Passage, schedule: Schedule) -> Iterator[Passage]:
    """Roll one revolution after another to the end, the paper's way."""
    last = start
    while last.converged and last.revolution < schedule.end:
        last = followed(model, next_passage(model, last), last)
        yield last


class ErrorEstimator(Protocol):
    """Gives passages their error bars."""

    missed: str
    """Which of them was last too wide, and what to do; or empty."""

    def __call__(
        self, passage: Passage, maxima: Mapping[str, Maximum], block: int = 0
    ) -> Mapping[str, Any]:
        """The error bars of `State`, given the largest stresses in the bodies of a block."""


def recorded(
    passage: Passage | Moment,
    model: Model,
    began: float,
    estimator: ErrorEstimator | None = None,
    own: Iterable[Quantity] = (),
    measured: Gap | None = None,
) -> Record:
    """The record of a passage.

    With its fields, and the stress on the planes of the scene, where the scene saves them or the
    roll ends; the largest stress of each body goes with every record of a scene with [subsurface].
    Of a duty cycle that of each block, put together (`results.cycle`).

    Parameters
    ----------
    passage : Passage or Moment
        What was rolled.
    model : Model
        What it was rolled with, and what its stress is judged by.
    began : float
        When work on it began, as by `time.perf_counter`.
    estimator : ErrorEstimator, optional
        Where its error bars come from; by default they are those of the contact.
    own : iterable of Quantity
        Columns beside the package's.
    measured : Gap, optional
        The measured separation of the scene.
    """
    spectrum, damage = model.scene.spectrum, _damage(passage)
    of_material, kept = _of_material(passage, model), ()
    if isinstance(passage, Passage) and passage.damage is not None:
        kept = passage.damage.fields  # of a contact that was not solved, as before
    if spectrum is None:
        record = _of_contact(passage, passage.told(), model.laws, estimator, own, measured)
        if not record.fields:
            kept = ()
        known = {k: v for k, v in of_material.items() if k in record.columns}
        if "damage_error" in known:  # that of the jumps, and that of the mesh
            mesh = record.values["damage_error"]
            known["damage_error"] = {
                k: v + mesh.get(k, 0.0) for k, v in known["damage_error"].items()
            }
        if "fatigue_life" in known and "fatigue_life_error" in record.columns:
            bars = record.values["utilisation_error"]
            known["fatigue_life_error"] = life_bars(known, bars, model.laws.life)
        if "stressed_volume" in known and "stressed_volume_error" in record.columns:
            mesh = record.values["stressed_volume_error"]
            for name, bars in volume_bars(of_material, mesh, model.laws.volume).items():
                if f"{name}_error" in record.columns:
                    known[f"{name}_error"] = bars
        values = {**record.values, **known, "seconds": perf_counter() - began}
        return replace(record, values=values, cycles=kept)
    records = [
        _of_contact(passage, passage.told(k), one.laws, estimator, own, measured, k)
        for k, one in enumerate(model.blocks)
    ]
    records = [
        replace(one, values={**one.values, **block_columns(damage, k)})
        for k, one in enumerate(records)
    ]
    _, stepped, _ = passage.told()
    stepped |= {k: v for k, v in of_material.items() if not k.startswith("utilisation")}
    del stepped["wear_max"]
    lost = np.stack((passage.lost, passage.lost + passage.gained_by))[:, list(spectrum.places)]
    lost *= _share_of_alike(spectrum)
    stepped[PARTS.name] = lost[0]
    sections = lost[1].sum(axis=(1, 2))
    stepped[SHARE.name] = sections / (sections.sum() or 1.0)
    stepped[ROLLED.name] = -1 if passage.rolled is None else passage.rolled
    stepped["seconds"] = perf_counter() - began
    each = [records[k] for k in spectrum.places]
    put = cycle_record(each, spectrum.each, stepped, model.scene, (*own, PARTS, ROLLED, SHARE))
    return replace(put, cycles=kept if put.fields else ())


def _damage(passage: Passage | Moment) -> Damage | None:
    """What rolling has done to the material, where it is known with its contact."""
    return passage.damage if isinstance(passage, Passage) and passage.converged else None


def _of_material(passage: Passage | Moment, model: Model) -> dict[str, Any]:
    damage = _damage(passage)
    return {} if damage is None else fatigue_columns(damage, model)


def _share_of_alike(spectrum: Spectrum) -> np.ndarray:
    """Part of each block in what those that are alike wear together."""
    each = zip(spectrum.each, spectrum.places, strict=True)
    share = [n / spectrum.revolutions[k] for n, k in each]
    return np.reshape(share, (-1, 1, 1))


def _of_contact(
    passage: Passage | Moment,
    told: tuple[State, dict[str, Any], bool],
    laws: Laws,
    estimator: ErrorEstimator | None,
    own: Iterable[Quantity],
    measured: Gap | None,
    block: int = 0,
) -> Record:
    """The record of one contact, that of a block in a duty cycle."""
    contact, given, last = told
    keep = (last and passage.place in contact.scene.schedule) or not passage.converged
    maxima = stress_maxima(contact, laws)
    stress = stress_on_planes(contact, laws=laws) if keep and maxima else ()
    if estimator is not None:
        contact = replace(contact, error_bars=estimator(passage, maxima, block))
    if measured is not None:
        given["measured_profile"] = across(measured, contact.grid)
    if PARTS.name in given:
        own = (*own, PARTS)
    stresses = stress_columns(laws.criterion)
    for one, found in zip(stresses, ("value", "interior", "surface", "at"), strict=False):
        given[one.name] = {body: getattr(largest, found) for body, largest in maxima.items()}
    return Record.of(contact, given, own=(*own, *stresses), with_fields=keep, stress=stress)
