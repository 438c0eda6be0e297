"""Load spectrum: blocks of changed keys, repeated in order, and changes of a scene by key."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from tractive_sam.schema import (
    Check,
    Fault,
    InnerTable,
    OptionalOrthotropicPositive,
    Positive,
    Real,
    Row,
    SceneError,
    Table,
    ValidEntries,
    copy_tables,
    entry,
    not_both,
    optional,
    remove_key,
    set_key,
    shorten,
    split_key,
    toml,
)

from .steel import rolled_pressures
from .tables import format_pair
from .wear import BY_COEFFICIENT

_ALTERNATIVES: tuple[tuple[tuple[str, ...], ...], ...] = (
    (("body.A.young",), ("body.A.shear",)),
    (("body.B.young",), ("body.B.shear",)),
    (("load.normal",), ("load.approach",), ("load.pressure",)),
    (("load.force_x",), ("creepage.longitudinal",)),
    (("load.force_y",), ("creepage.lateral",)),
    (("friction.mu",), ("friction.static",)),
    (("friction.kinetic", "friction.half_speed"), ("friction.A", "friction.B")),
    (("load.tilt",), ("load.moment",)),
    (("rail.gauge",), ("rail.origin",)),
    (("wheelset.load",), ("wheelset.normal_load",)),
    (("gap.file",), ("gap.x", "gap.y", "gap.separation")),
    (("fatigue.shear_yield",), ("fatigue.yield_strength",)),
    *(
        (
            (f"residual.{body}.file",),
            tuple(f"residual.{body}.{key}" for key in ("depth", "xx", "yy")),
            (f"residual.{body}.from", f"residual.{body}.pressure"),
        )
        for body in "AB"
    ),
    *(
        (
            (f"fatigue.{body}.file",),
            tuple(f"fatigue.{body}.{key}" for key in ("depth", "hardness", "limit", "shear_yield")),
        )
        for body in "AB"
    ),
    (("wear.intensity",), ("wear.coefficient", "wear.coefficient.A", "wear.coefficient.B")),
    (
        ("accuracy", "accuracy.tolerance", "accuracy.elements"),
        ("grid", "grid.half_length", "grid.elements"),
    ),
)
"""Groups of keys: a key of one group of a line excludes all keys of the other groups."""


def excluded_keys(key: str) -> tuple[str, ...]:
    """Return the keys that a scene cannot have beside a key, as they are alternatives to it."""
    excluded = tuple(
        alternative
        for groups in _ALTERNATIVES
        if any(key in group for group in groups)
        for group in groups
        if key not in group
        for alternative in group
    )
    if key in ("wear.coefficient.A", "wear.coefficient.B"):  # they give the shares in the wear
        return (*excluded, "body.A.hardness", "body.B.hardness")
    return excluded


def parse_settings(settings: Iterable[str]) -> dict[str, Any]:
    """Return values by dotted key from texts "table.key=value"; values are written as in TOML.

    Raises
    ------
    SceneError
        With a fault for each setting of another form.
    """
    pairs = [(text, *text.partition("=")) for text in settings]
    faults = [
        Fault(shorten(text), "a setting without key or value", "table.key=value")
        for text, key, equals, _ in pairs
        if not (equals and key.strip())
    ]
    if faults:
        raise SceneError(faults)
    return {key.strip(): toml.parse_value(value.strip()) for _, key, _, value in pairs}


def override(tables: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return tables changed by values at dotted keys; alternatives of a new key are removed.

    Parameters
    ----------
    tables : mapping
        Nested tables; they are not changed.
    changes : mapping
        New values by dotted key, as ``load.normal`` or ``duty[0].load.normal``. Missing tables are
        added; None removes an entry. Setting one of two alternatives (young/shear, normal/approach,
        creepage/force, gap file/arrays, load history/blocks) removes the other, unless it is set as
        well. A wear law removes the coefficients of another law. Values of `wear.save` above a new
        `wear.revolutions` are removed, and the last revolution is added.

    Raises
    ------
    SceneError
        If a key leads through an entry that is not a table, or to a place that a list does not
        have.
    """
    result = copy_tables(tables)
    faults = [fault for key, value in changes.items() for fault in set_key(result, key, value)]
    if faults:
        raise SceneError(faults)
    for key, value in changes.items():
        block, bracket, entry = key.rpartition("].")
        for alternative in excluded_keys(entry) if value is not None else ():
            rival = f"{block}{bracket}{alternative}"
            if not any(f"{change}.".startswith(f"{rival}.") for change in changes):
                remove_key(result, rival)
    changed = {split_key(change)[0] for change in changes}
    for key, alternative in (("load_history", "duty"), ("duty", "load_history")):
        if key in changed and alternative not in changed:
            remove_key(result, alternative)
    if changes.get("wear.law", "archard") not in BY_COEFFICIENT:
        for key in ("wear.intensity", "wear.coefficient"):
            if not any(f"{change}.".startswith(f"{key}.") for change in changes):
                remove_key(result, key)
    if "wear.revolutions" in changes and "wear.save" not in changes:
        _shorten_save(result)
    return result


def _shorten_save(tables: dict[str, Any]) -> None:
    """End the stored revolutions in a scene's tables with the last revolution, in place."""
    match tables:
        case {"wear": {"revolutions": last, "save": (list() | tuple()) as save} as wear}:
            # The checks of the scene report values that are not integers.
            are_integers = all(type(n) is int for n in (last, *save))
            if are_integers and 1 <= last < max(save, default=0):
                wear["save"] = sorted({n for n in save if n < last} | {last})


_CHANGED = ("load", "creepage", "friction", "wheelset")
"""Tables of the scene that a block may change."""


class BlockLoad(Table):
    """Load (normal, approach or pressure) and forces that a block sets in place of the scene's.

    Examples
    --------
    >>> ts.BlockLoad(normal=450.0).normal
    450.0
    """

    normal: Positive | None = optional("normal load P, N; in a line contact, N/mm")
    approach: Real | None = optional("approach of the bodies, mm; see load.approach")
    pressure: Positive | None = optional("peak contact pressure p0 according to Hertz, MPa")
    force_x: Real | None = optional("prescribed force Q_x on body A, N or N/mm")
    force_y: Real | None = optional("prescribed force Q_y on body A, N or N/mm")
    checks: ClassVar[tuple[Check, ...]] = (not_both("normal", "approach", "pressure"),)


class BlockCreepage(Table):
    """Creepages of a block of [[duty]], in place of the scene's.

    Examples
    --------
    >>> ts.BlockCreepage(longitudinal=-0.002).longitudinal
    -0.002
    """

    longitudinal: Real | None = optional("longitudinal creepage xi_x")
    lateral: Real | None = optional("lateral creepage xi_y")
    spin: Real | None = optional("spin creepage phi, 1/mm")
    speed: Positive | None = optional("rolling speed V, mm/s")


class BlockFriction(Table):
    """Friction coefficients and angle that a block of [[duty]] sets in place of the scene's.

    Examples
    --------
    >>> ts.BlockFriction(mu=0.1).mu
    (0.1, 0.1)
    """

    mu: OptionalOrthotropicPositive = optional("friction coefficients along the axes e1, e2")
    angle: Real | None = optional("angle from x to e1, degrees", ge=-360, le=360)


class BlockWheelset(Table):
    """Position of the wheelset in a block of [[duty]], in place of the scene's.

    Examples
    --------
    >>> ts.BlockWheelset(y=4.0, load=9e4).y
    4.0
    """

    y: Real | None = optional("lateral position, mm, positive to the right")
    yaw: Real | None = optional("yaw angle, mrad", ge=-100, le=100)
    load: Positive | None = optional("vertical force on this wheel, N")
    side: Literal["right", "left"] | None = optional("wheel that is computed")


class Block(Table):
    """A block of a load spectrum, [[duty]]: its revolutions and the entries that it changes.

    Examples
    --------
    >>> heavy = ts.Block(revolutions=100, load={"normal": 450.0})
    >>> light = ts.Block(revolutions=900, creepage={"longitudinal": -0.001})
    >>> spectrum = discs.replace(duty=(heavy, light), **{"wear.revolutions": 5000})
    >>> [block.normal_load for block in spectrum.blocks]
    [450.0, 300.0]
    """

    name: str = entry("name of the block", default="")
    revolutions: int = entry("number of revolutions of the block in each cycle", ge=1, le=10**12)
    load: InnerTable[BlockLoad] = entry("load of the block", default=BlockLoad())
    creepage: InnerTable[BlockCreepage] = entry("creepage of the block", default=BlockCreepage())
    friction: InnerTable[BlockFriction] = entry("friction of the block", default=BlockFriction())
    wheelset: InnerTable[BlockWheelset] = entry("position of the wheelset", default=BlockWheelset())
    shift_y: Real = entry(
        "lateral position of the running band on both bodies, mm; the centre of the radii moves "
        "with it",
        default=0.0,
    )

    @classmethod
    def describe_array(cls, tables: tuple[Table, ...], scene: Any) -> Iterator[Row]:
        """Yield a row (label, text) for each of the first blocks, for reports of a scene."""
        for k, block in enumerate(scene.duty[: SceneError.max_listed]):
            share = f"{block.revolutions} of {scene.spectrum.cycle} revolutions"
            yield Row(block_label(scene, k), f"{share}: {block.describe_changes()}", brief=True)
        if len(tables) > SceneError.max_listed:
            yield Row("other blocks", f"{len(tables) - SceneError.max_listed} more", brief=True)

    def describe_changes(self) -> str:
        """Describe the entries of the scene that the block changes, as text."""
        changes = [
            f"{key} = {format_pair(*value) if isinstance(value, tuple) else shorten(value)}"
            for key, value in self.changes.items()
        ]
        changes += [f"shift_y = {self.shift_y:g} mm"] if self.shift_y else []
        return ", ".join(changes) or "no changes of the scene"

    @property
    def changes(self) -> dict[str, Any]:
        """Entries of the scene that the block changes: values by dotted key."""
        entries = self.entries()
        return {
            f"{table}.{key}": value
            for table in _CHANGED
            for key, value in entries.get(table, {}).items()
        }


@dataclass(frozen=True)
class Spectrum:
    """Load spectrum of a scene with [[duty]]: its different blocks and their revolutions.

    Attributes
    ----------
    scenes : tuple of Scene
        Scenes of the different blocks.
    shifts : tuple of float
        Lateral positions of the blocks, mm.
    revolutions : tuple of int
        Revolutions of each different block in a cycle.
    places : tuple of int
        For each block of the scene its index among the different blocks.
    each : tuple of int
        Revolutions of each block of the scene.
    """

    scenes: tuple[Any, ...]
    shifts: tuple[float, ...]
    revolutions: tuple[int, ...]
    places: tuple[int, ...]
    each: tuple[int, ...]

    @classmethod
    def from_blocks(cls, blocks: tuple[Block, ...], scenes: tuple[Any, ...]) -> Spectrum:
        """Return the spectrum of blocks and of their scenes; equal blocks are merged."""
        different: dict[str, int] = {}
        places = [
            different.setdefault(json.dumps([scene.fingerprint(), block.shift_y]), len(different))
            for block, scene in zip(blocks, scenes, strict=True)
        ]
        first = [places.index(k) for k in range(len(different))]
        each = tuple(block.revolutions for block in blocks)
        counts = [
            sum(n for n, k in zip(each, places, strict=True) if k == j)
            for j in range(len(different))
        ]
        shifts = tuple(blocks[k].shift_y for k in first)
        return cls(tuple(scenes[k] for k in first), shifts, tuple(counts), tuple(places), each)

    @property
    def cycle(self) -> int:
        """Number of revolutions of a cycle through all blocks."""
        return sum(self.each)

    def block_at(self, revolution: int) -> int:
        """Return the index, among the different blocks, of the one rolled in a revolution."""
        remaining = (revolution - 1) % self.cycle
        for n, place in zip(self.each, self.places, strict=True):
            if remaining < n:
                return place
            remaining -= n
        raise AssertionError


def block_scenes(scene: Any) -> tuple[Any, ...]:
    """Return the scene of each block: the scene without [[duty]], changed by the block.

    Raises
    ------
    SceneError
        With the faults of all blocks, by their places in [[duty]].
    """
    entries = scene.entries()
    for key in ("duty", "load_history"):
        entries.pop(key, None)
    scenes, faults = [], []
    for k, block in enumerate(scene.duty):
        try:
            title = ", ".join(filter(None, (scene.title, block_label(scene, k))))
            scenes.append(type(scene)(**override(entries, {"title": title} | block.changes)))
        except SceneError as error:
            faults += [_block_fault(fault, k) for fault in error.faults]
    if faults:
        raise SceneError(faults)
    if pressures := rolled_pressures(scene, scenes):
        scenes = [block.replace(**pressures) for block in scenes]
    return tuple(scenes)


def block_label(scene: Any, k: int) -> str:
    """Return the name of block k, or its key "duty[k]" if it has no name."""
    return scene.duty[k].name or f"duty[{k}]"


def _block_fault(fault: Fault, k: int) -> Fault:
    """Return a fault of a block's scene as a fault of the block, under its key."""
    table = fault.key.split(".")[0]
    if table in _CHANGED:
        return Fault(f"duty[{k}].{fault.key}", fault.given, fault.allowed)
    return Fault(f"duty[{k}]", f"{fault.key}: {fault.given}", fault.allowed)


def _check_block_names(blocks: tuple[Block, ...]) -> Iterator[Fault]:
    """Report blocks with the name of another block."""
    names: set[str] = set()
    for k, block in enumerate(blocks):
        if block.name and block.name in names:
            yield Fault(f"duty[{k}].name", block.name, "a name that no other block has")
        names.add(block.name)


def check_blocks(entries: ValidEntries) -> Iterator[Fault]:
    """Report [[duty]] with equal names, wrong tables, cycles beyond the revolutions, bad shifts."""
    duty: tuple[Block, ...] = entries["duty"]
    if not duty:
        return
    yield from _check_block_names(duty)
    if entries["transient"] is not None:
        return
    wear, cycle = entries["wear"], sum(block.revolutions for block in duty)
    if wear is None and entries["fatigue"] is None:
        cure = "a [wear] table with the revolutions to roll, or a [fatigue] table for the life"
        yield Fault("duty", "without [wear] and [fatigue]", cure)
    elif wear is not None and cycle > wear.revolutions:
        value = f"a cycle of {cycle} revolutions"
        yield Fault("duty", value, f"at most {wear.revolutions} revolutions, as wear.revolutions")
    reasons = {
        "with a [gap], which holds at one position": entries["gap"] is not None,
        "with friction.across, which holds at one position": entries["friction.across"] is not None,
        "in a line contact": entries["body"].infinitely_long,
    }
    reason = next((text for text, holds in reasons.items() if holds), None)
    for k, block in enumerate(duty):
        if block.shift_y and reason:
            allowed = "0; a shift needs radii in y and friction that does not vary across"
            yield Fault(f"duty[{k}].shift_y", f"{block.shift_y:g} {reason}", allowed)


def cycle_notes(scene: Any, largest_error: float = 0.01) -> Iterator[str]:
    """Yield notes on an incomplete last cycle, and on work changed by the levels of loads.

    Parameters
    ----------
    scene : Scene
        A scene with [[duty]].
    largest_error : float
        Relative error of the work above which there is a note.
    """
    cycle, revolutions = scene.spectrum.cycle, scene.schedule.end
    if revolutions % cycle:
        yield f"duty: the last of {revolutions} / {cycle} cycles is incomplete"
    error = scene.load_history.work_error if scene.load_history else None
    if error is not None and error > largest_error:
        change = f"the mean of load x creepage by {error:.1%}"
        yield f"load_history: the levels change {change}; increase load_history.levels"


def check_blocks_on_mesh(scene: Any, scenes: tuple[Any, ...]) -> Iterator[Fault]:
    """Report blocks of [[duty]] whose lateral shift moves their contact outside the given mesh."""
    half_length = None if scene.grid is None else scene.grid.half_length
    if half_length is None:
        return
    half, centre = half_length[-1], scene.grid.place[1]  # a line contact has no shifts
    for k, (block, block_scene) in enumerate(zip(scene.duty, scenes, strict=True)):
        half_width = 0.0 if block_scene.hertz is None else block_scene.hertz.b
        reach = abs(block.shift_y - centre) + half_width
        if block.shift_y and reach > half:
            low, high = centre - half, centre + half
            cure = f"a contact from y = {low:.4g} to {high:.4g}, or a wider grid.half_length"
            outside = f"{block.shift_y:g}: outside the mesh"
            yield Fault(f"duty[{k}].shift_y", outside, cure)
