"""A duty cycle: blocks of load, creepage, friction and lateral place, repeated in their order."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from tractive_sam.schema import (
    Check,
    Fault,
    OptionalOrthotropicPositive,
    Positive,
    Real,
    Row,
    SceneError,
    Table,
    ValidEntries,
    entry,
    not_both,
)

from .describe import format_pair
from .override import override

if TYPE_CHECKING:
    from .scene import Scene


class BlockLoad(Table):
    """What a block changes of [load]; one of the alternatives removes the others.

    Examples
    --------
    >>> ts.BlockLoad(normal=450.0).normal
    450.0
    """

    normal: Positive | None = entry("normal load P, N; of a line contact N/mm", default=None)
    approach: Positive | None = entry(
        "approach of the bodies, mm, from the first touch of the unworn ones", default=None
    )
    pressure: Positive | None = entry("peak contact pressure p0 by Hertz, MPa", default=None)
    force_x: Real | None = entry("prescribed force Q_x on body A, N or N/mm", default=None)
    force_y: Real | None = entry("prescribed force Q_y on body A, N or N/mm", default=None)
    checks: ClassVar[tuple[Check, ...]] = (not_both("normal", "approach", "pressure"),)


class BlockCreepage(Table):
    """What a block changes of [creepage].

    Examples
    --------
    >>> ts.BlockCreepage(longitudinal=-0.002).longitudinal
    -0.002
    """

    longitudinal: Real | None = entry("longitudinal creepage xi_x", default=None)
    lateral: Real | None = entry("lateral creepage xi_y", default=None)
    spin: Real | None = entry("spin creepage phi, 1/mm", default=None)
    speed: Positive | None = entry("rolling speed V, mm/s", default=None)


class BlockFriction(Table):
    """What a block changes of [friction].

    Examples
    --------
    >>> ts.BlockFriction(mu=0.1).mu
    (0.1, 0.1)
    """

    mu: OptionalOrthotropicPositive = entry(
        "friction coefficients along the axes e1, e2", "a number above 0, or a pair of them", None
    )
    angle: Real | None = entry(
        "angle from x to e1, degrees", "a number from -360 to 360", None, ge=-360, le=360
    )


class Block(Table):
    """A block of a duty cycle, [[duty]]: what it changes of the scene, and for how long.

    Examples
    --------
    >>> heavy = ts.Block(revolutions=100, load={"normal": 450.0})
    >>> light = ts.Block(revolutions=900, creepage={"longitudinal": -0.001})
    >>> spectrum = discs.replace(duty=(heavy, light), **{"wear.revolutions": 5000})
    >>> [one.normal_load for one in spectrum.blocks]
    [450.0, 300.0]
    """

    name: str = entry("what the block is called", "a text", "")
    revolutions: int = entry(
        "revolutions of the block in a cycle", "a whole number from 1 to 1e12", ge=1, le=10**12
    )
    load: BlockLoad = entry("what it changes of the load", default=BlockLoad())
    creepage: BlockCreepage = entry("what it changes of the creepage", default=BlockCreepage())
    friction: BlockFriction = entry("what it changes of friction", default=BlockFriction())
    shift_y: Real = entry(
        "lateral place of the running band on both bodies, mm: contact and radii are centred there",
        default=0.0,
    )

    @classmethod
    def describe_array(cls, tables: tuple[Table, ...], scene: Any) -> Iterator[Row]:
        """Yield a row for each of the first blocks of the array, as `Table.describe` does."""
        for k, block in enumerate(scene.duty[: SceneError.most_listed]):
            share = f"{block.revolutions} of {scene.spectrum.cycle} revolutions"
            yield Row(label(scene, k), f"{share}: {block.describe_changes()}", brief=True)
        if len(tables) > SceneError.most_listed:
            yield Row("other blocks", f"{len(tables) - SceneError.most_listed} more", brief=True)

    def describe_changes(self) -> str:
        """Describe what it changes of the scene."""
        changes = [
            f"{key} = {format_pair(*value) if isinstance(value, tuple) else format(value, 'g')}"
            for key, value in self.changes.items()
        ]
        changes += [f"shift_y = {self.shift_y:g} mm"] if self.shift_y else []
        return ", ".join(changes) or "as the other tables of the scene"

    @property
    def changes(self) -> dict[str, Any]:
        """What it changes of a scene, by dotted key."""
        given = self.entries()
        return {
            f"{table}.{key}": value
            for table in ("load", "creepage", "friction")
            for key, value in given.get(table, {}).items()
        }


@dataclass(frozen=True)
class Spectrum:
    """The blocks of a scene, each different one once.

    Attributes
    ----------
    scenes : tuple of Scene
        Of the different ones.
    shifts : tuple of float
        Their lateral places, mm.
    revolutions : tuple of int
        What each is rolled in a cycle.
    places : tuple of int
        Which of them each block of the scene is.
    each : tuple of int
        Revolutions of each block of the scene.
    """

    scenes: tuple[Scene, ...]
    shifts: tuple[float, ...]
    revolutions: tuple[int, ...]
    places: tuple[int, ...]
    each: tuple[int, ...]

    @classmethod
    def of(cls, blocks: tuple[Block, ...], scenes: tuple[Scene, ...]) -> Spectrum:
        """The spectrum of blocks and their scenes."""
        seen: dict[str, int] = {}
        places = [
            seen.setdefault(json.dumps([scene.fingerprint(), block.shift_y]), len(seen))
            for block, scene in zip(blocks, scenes, strict=True)
        ]
        first = [places.index(k) for k in range(len(seen))]
        each = tuple(block.revolutions for block in blocks)
        counts = [
            sum(n for n, k in zip(each, places, strict=True) if k == j) for j in range(len(seen))
        ]
        shifts = tuple(blocks[k].shift_y for k in first)
        return cls(tuple(scenes[k] for k in first), shifts, tuple(counts), tuple(places), each)

    @property
    def cycle(self) -> int:
        """Revolutions of a cycle."""
        return sum(self.each)

    def block_at(self, revolution: int) -> int:
        """Which of the different ones a revolution is of, counted from 1."""
        left = (revolution - 1) % self.cycle
        for n, place in zip(self.each, self.places, strict=True):
            if left < n:
                return place
            left -= n
        raise AssertionError


def block_scenes(scene: Scene) -> tuple[Scene, ...]:
    """The scene of each block, which stands alone.

    Raises
    ------
    SceneError
        With the faults of each, by its place in [[duty]].
    """
    entries = scene.entries()
    for key in ("duty", "load_history"):
        entries.pop(key, None)
    scenes, faults = [], []
    for k, block in enumerate(scene.duty):
        try:
            scenes.append(type(scene)(**override(entries, _titled(scene, k) | block.changes)))
        except SceneError as error:
            faults += [_of_block(fault, k, block) for fault in error.faults]
    if faults:
        raise SceneError(faults)
    return tuple(scenes)


def _titled(scene: Scene, k: int) -> dict[str, Any]:
    return {"title": ", ".join(filter(None, (scene.title, label(scene, k))))}


def label(scene: Scene, k: int) -> str:
    """What a block is called."""
    return scene.duty[k].name or f"duty[{k}]"


def _of_block(fault: Fault, k: int, block: Block) -> Fault:
    """A fault of its scene as one of the block, where it is of what the block gives."""
    table = fault.key.split(".")[0]
    if table in ("load", "creepage", "friction"):
        return Fault(f"duty[{k}].{fault.key}", fault.given, fault.allowed)
    return Fault(f"duty[{k}]", f"{fault.key}: {fault.given}", fault.allowed)


def _named_apart(blocks: tuple[Block, ...]) -> Iterator[Fault]:
    seen: set[str] = set()
    for k, block in enumerate(blocks):
        if block.name and block.name in seen:
            yield Fault(f"duty[{k}].name", block.name, "a name that no other block has")
        seen.add(block.name)


def duty_fits(entries: ValidEntries) -> Iterator[Fault]:
    """Check what the blocks need of the other tables."""
    duty: tuple[Block, ...] = entries["duty"]
    if not duty:
        return
    yield from _named_apart(duty)
    if entries["transient"] is not None:
        yield Fault("duty", "with [transient]", "one of them: blocks are of steady rolling")
        return
    wear = entries["wear"]
    if wear is None:
        yield Fault("duty", "without [wear]", "only with a [wear] table: blocks are rolled")
    elif (cycle := sum(block.revolutions for block in duty)) > wear.revolutions:
        given = f"a cycle of {cycle} revolutions"
        yield Fault("duty", given, f"at most the {wear.revolutions} of wear.revolutions")
    gap, line = entries["gap"], entries["body"].infinitely_long
    for k, block in enumerate(duty):
        if block.shift_y and (gap is not None or line):
            what = "with a [gap], which is that of one place" if gap else "in a line contact"
            yield Fault(f"duty[{k}].shift_y", f"{block.shift_y:g} {what}", "0, or radii in y")


def off_the_mesh(scene: Scene, scenes: tuple[Scene, ...]) -> Iterator[Fault]:
    """Find blocks whose contact does not lie on the given mesh."""
    given = None if scene.grid is None else scene.grid.half_length
    if given is None:
        return
    half = given[-1]  # in a line contact, which has none in y, no block shifts
    for k, (block, one) in enumerate(zip(scene.duty, scenes, strict=True)):
        reach = abs(block.shift_y) + (0.0 if one.hertz is None else one.hertz.b)
        if block.shift_y and reach > half:
            cure = f"at most {half - reach + abs(block.shift_y):.4g}, or a wider grid.half_length"
            yield Fault(
                f"duty[{k}].shift_y", f"{block.shift_y:g}: off the mesh of +-{half:g}", cure
            )
