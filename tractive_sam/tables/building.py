"""Makes a table: solves its nodes, and adds nodes where points that are held out ask for them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from os import PathLike
from time import process_time

import numpy as np

from tractive_sam import interrupt
from tractive_sam.lookup import MIRROR, CreepTable, Hermite, by_coordinates, creepages_at
from tractive_sam.reference import full_slip_with_spin
from tractive_sam.scene import Fault
from tractive_sam.tables.coefficients import coefficients
from tractive_sam.tables.contacts import Contacts, Solved
from tractive_sam.tables.design import TableDesign, TableError

HEADINGS, TILTS = 5, 4
FIRST_U = (0.0, 0.2, 0.4, 0.55, 0.7, 0.85, 1.0)
"""Nodes to begin with."""

SAMPLES = 5
"""Points held out in the middle of every interval of every axis."""

HELD_OUT = 100
"""Points held out anywhere in the end."""

ROUNDS = 12
"""Most times that nodes are added."""

SHARE = 0.4
"""Of the tolerance, what an error bar of a node may take, and an interpolation along one axis: of
three axes along which a table is curved most the errors seldom add up."""

STEP = 1e-4
"""Of differences of closed forms by heading and tilt."""


@dataclass(frozen=True)
class Progress:
    """How far a table is.

    Attributes
    ----------
    nodes, done : int
        Nodes of the grid as it is now, and those solved.
    round : int
        How often nodes were added.
    """

    nodes: int
    done: int
    round: int


def build_table(
    design: TableDesign | str | PathLike[str],
    path: str | PathLike[str] | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> CreepTable:
    """Make a table of creep forces.

    Parameters
    ----------
    design : TableDesign or path-like
        What it is to hold, or its file (TOML).
    path : path-like, optional
        File to write, netCDF; see `open_table`.
    progress : callable, optional
        Called with each node.

    Raises
    ------
    TableError
        With the faults of the design; or if the tolerance takes more nodes or elements than it
        allows.
    RuntimeError
        If a contact is not solved.

    Examples
    --------
    >>> rough = ts.TableDesign(ellipticity=1.0, tolerance=0.2, elements=15)
    >>> table = ts.build_table(rough, "rough.nc")
    >>> f = table(-1e-3, 0.0, 0.0, a=1.0, b=1.0, load=1e3, mu=0.3, shear=8e4)
    >>> bool(f.Qx > 0.0)
    True
    >>> ts.open_table("rough.nc").nodes == table.nodes
    True
    """
    design = design if isinstance(design, TableDesign) else TableDesign.from_toml(design)
    table = _Builder(design, progress or (lambda _: None)).built()
    if path is not None:
        from tractive_sam.tables.file import write_table  # noqa: PLC0415 - of an extra

        write_table(table, path)
    return table


@dataclass(eq=False)
class _Builder:
    design: TableDesign
    tell: Callable[[Progress], None]
    axes: list[np.ndarray] = field(default_factory=list)
    nodes: dict[tuple[float, ...], Solved] = field(default_factory=dict)
    solved: dict[tuple[float, ...], Solved] = field(default_factory=dict)
    contacts: dict[tuple[float, float], Contacts] = field(default_factory=dict)
    round: int = 0

    def built(self) -> CreepTable:
        """The table of the design."""
        design, began = self.design, process_time()
        self.axes = [
            np.log(np.array(design.ellipticity, float)),
            np.array(design.poisson, float),
            np.linspace(-0.5 * math.pi, 0.5 * math.pi, HEADINGS),
            np.linspace(0.0, 0.5 * math.pi, TILTS),
            np.array(FIRST_U),
        ]
        random = np.random.default_rng(design.seed)
        while True:
            table = self._table([np.zeros((max(len(a) - 1, 0), 3)) for a in self.axes])
            between = self._between(table, random)
            split = [
                np.flatnonzero(errors.max(axis=1, initial=0.0) > SHARE * design.tolerance)
                for errors in between
            ]
            if not any(map(len, split)):
                break
            self.round += 1
            self.axes = [self._refined(k, some) for k, some in enumerate(split)]
            count = math.prod(map(len, self.axes))
            if count > design.most or self.round > ROUNDS:
                needs = f"{count} nodes after {self.round} rounds, more than {design.most}"
                fault = Fault(
                    "tolerance",
                    f"{design.tolerance:g}, which takes {needs}",
                    "a larger tolerance, more nodes (most), or a narrower ellipticity",
                )
                raise TableError([fault])
        return self._checked(between, random, began)

    def _refined(self, axis: int, split: np.ndarray) -> np.ndarray:
        """The nodes of an axis with intervals divided; those of heading stay symmetric."""
        nodes = self.axes[axis]
        if axis == 2:
            split = np.union1d(split, len(nodes) - 2 - split)
        middles = 0.5 * (nodes[split] + nodes[split + 1]) if len(split) else np.empty(0)
        return np.sort(np.concatenate([nodes, middles]))

    def _checked(self, between: list[np.ndarray], random, began: float) -> CreepTable:
        """The table with what points held out anywhere say of its errors."""
        table = self._table(between)
        shares, errors, points = [], [], []
        for _ in range(HELD_OUT):
            point = tuple(float(random.uniform(axis[0], axis[-1])) for axis in self.axes)
            solved = self._solved(point, gradient=False)
            error = np.abs(self._at(table, point) - solved.force)
            told = table.error_at(_column(point))[:, 0]
            shares.append((error / (told + 1e-12)).max())
            errors.append(error.max())
            points.append(point)
        # So wide that 95 of 100 of them, and the contact's own bar, are within.
        wider = max(1.0, float(np.quantile(shares, 0.97)))
        design = self.design
        about = {
            "title": design.title,
            "design": design.to_toml(),
            "tolerance": design.tolerance,
            "rounds": self.round,
            "contacts": sum(one.solved for one in self.contacts.values()),
            "cpu_seconds": process_time() - began,
            "held_out": len(errors),
            "held_out_median": float(np.median(errors)),
            "held_out_worst": float(np.max(errors)),
            "held_out_inside": float(np.mean(np.array(shares) <= wider)),
            "widened": wider,
        }
        checks = {"check_points": np.array(points), "check_errors": np.array(errors)}
        return self._table([wider * one for one in between], about | checks, wider)

    def _table(self, between, about=None, wider: float = 1.0) -> CreepTable:
        shape = tuple(map(len, self.axes))
        values, bars = np.zeros((*shape, 3)), np.zeros((*shape, 3))
        slopes = np.zeros((*shape, 3, 3))
        places = list(itertools.product(*map(range, shape)))
        for number, place in enumerate(places):
            point = tuple(float(axis[k]) for axis, k in zip(self.axes, place, strict=True))
            if point not in self.nodes:
                self.nodes[point] = self._node(point)
                self.tell(Progress(len(places), number + 1, self.round))
            node = self.nodes[point]
            values[place], bars[place], slopes[place] = node.force, node.bar, node.gradient
        self._end_slopes(values, slopes)
        law = Hermite(tuple(self.axes), coefficients(self.axes, values, slopes))
        return CreepTable(law, wider * bars, tuple(between), about or {})

    def _end_slopes(self, values: np.ndarray, slopes: np.ndarray) -> None:
        """Slopes by u in full slip: of the parabola through the last two nodes and its slope."""
        u = self.axes[-1]
        rise = (values[..., -1, :] - values[..., -2, :]) / (u[-1] - u[-2])
        slopes[..., -1, :, 2] = 2.0 * rise - slopes[..., -2, :, 2]

    def _node(self, point: tuple[float, ...]) -> Solved:
        """A node: its gradient is by heading, tilt and u."""
        log_ratio, _, heading, tilt, u = point
        ratio = math.exp(log_ratio)
        if u == 1.0:
            return _in_full_slip(ratio, heading, tilt)
        if tilt == 0.0 and heading < 0.0 < u:  # (w_1, -w_2, 0) of (w_1, w_2, 0)
            there = self._solved_at((*point[:2], -heading, tilt, u))
            by_w = MIRROR[:, None] * there.gradient * MIRROR
            found = Solved(MIRROR * there.force, there.bar, by_w)
        else:
            # At rest, and of spin alone, the heading does not count.
            same = 0.0 if u == 0.0 or tilt == self.axes[3][-1] else heading
            found = self._solved_at((*point[:2], same, 0.0 if u == 0.0 else tilt, u))
        by = found.gradient @ by_coordinates(ratio, heading, tilt, u)
        return Solved(found.force, found.bar, by)

    def _solved_at(self, point: tuple[float, ...]) -> Solved:
        """A contact, solved once; its gradient is by scaled creepages."""
        if point not in self.solved:
            self.solved[point] = self._solved(point)
        return self.solved[point]

    def _solved(self, point: tuple[float, ...], gradient: bool = True) -> Solved:
        interrupt.heed()
        log_ratio, poisson, heading, tilt, u = point
        ratio = math.exp(log_ratio)
        if (ratio, poisson) not in self.contacts:
            self.contacts[ratio, poisson] = Contacts(ratio, poisson)
        w = creepages_at(ratio, heading, tilt, u) if u else np.zeros(3)
        design, wanted = self.design, SHARE * self.design.tolerance
        contacts = self.contacts[ratio, poisson]
        found = contacts.solve(w, design.elements, design.finest, wanted, gradient)
        if found.bar.max() > design.tolerance:
            fault = Fault(
                "tolerance",
                f"{design.tolerance:g}, but an error bar of "
                f"{found.bar.max():.2g} on {design.finest} elements",
                "a larger tolerance, or a larger finest",
            )
            raise TableError([fault])
        return found

    def _between(self, table: CreepTable, random) -> list[np.ndarray]:
        """Largest errors of interpolation seen in the middle of every interval of every axis."""
        found = []
        for k, nodes in enumerate(self.axes):
            errors = np.zeros((max(len(nodes) - 1, 0), 3))
            for cell in range(len(nodes) - 1):
                for _ in range(SAMPLES):
                    at = [float(random.choice(axis)) for axis in self.axes]
                    if k != len(self.axes) - 1:  # neither at rest nor in full slip
                        at[-1] = float(random.choice(self.axes[-1][1:-1]))
                    at[k] = float(0.5 * (nodes[cell] + nodes[cell + 1]))
                    solved = self._solved(tuple(at), gradient=False)
                    error = np.abs(self._at(table, at) - solved.force)
                    errors[cell] = np.maximum(errors[cell], error)
            if k == 2:  # the symmetry between headings
                errors = np.maximum(errors, errors[::-1])
            found.append(errors)
        return found

    @staticmethod
    def _at(table: CreepTable, point) -> np.ndarray:
        return table.law(_column(point))[:, 0]


def _column(point) -> list[np.ndarray]:
    return [np.array([one]) for one in point]


def _in_full_slip(ratio: float, heading: float, tilt: float) -> Solved:
    """The closed form, and its derivatives by heading and tilt by differences."""

    def force(heading: float, tilt: float) -> np.ndarray:
        w = creepages_at(ratio, heading, tilt, 1.0)
        w[np.abs(w) < 1e-15] = 0.0
        return np.array(full_slip_with_spin(ratio, (w[0], w[1]), w[2]))

    by_heading = (force(heading + STEP, tilt) - force(heading - STEP, tilt)) / (2.0 * STEP)
    by_tilt = (force(heading, tilt + STEP) - force(heading, tilt - STEP)) / (2.0 * STEP)
    slopes = np.stack([by_heading, by_tilt, np.zeros(3)], axis=1)
    return Solved(force(heading, tilt), np.zeros(3), slopes)
