"""Makes a table: solves its nodes, and adds nodes where points that are held out ask for them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, field, replace
from os import PathLike
from time import process_time

import numpy as np
from scipy.stats import qmc

from tractive_sam.extras import require_extra
from tractive_sam.lookup import CreepTable, Hermite, by_coordinates, cell_of, creepages_at
from tractive_sam.reference import full_slip_with_spin
from tractive_sam.schema import Fault
from tractive_sam.store import ResultsError
from tractive_sam.studies import check_installed, local_cluster
from tractive_sam.tables.coefficients import coefficients
from tractive_sam.tables.contacts import Solved
from tractive_sam.tables.design import TableDesign, TableError
from tractive_sam.tables.gradient_errors import GradientBars, GradientChecks
from tractive_sam.tables.grid import CreepageGrid
from tractive_sam.tables.opening import is_table, open_table
from tractive_sam.tables.solving import SHARE, Job, Solve, elsewhere, here

FIRST_U = (0.0, 0.2, 0.4, 0.475, 0.55, 0.625, 0.7, 0.85, 1.0)
"""Nodes to begin with: closest where the whole contact begins to slip, and forces bend sharply."""

FULL = 1e4
"""r over r_0 that is solved for full slip where it has no closed form: what still sticks there is
as small."""

SAMPLES = 5
"""Points held out in the middle of every interval of every axis."""

ANYWHERE = 1000
"""Points held out anywhere that ask for nodes, or as many as there are nodes. Those that have done
so tell less of the others: a table ends only when so many new ones find nothing, either. Where
three in a thousand exceed `MISS`, a thousand at random find one in 95 of 100 cases; these are
spread more evenly."""

MISS = 0.5
"""Of the tolerance, error of such a point for which a node is added beside it."""

WORST = 0.5
"""Of the worst such error, as well: what is less the nodes for the worst ones often mend."""

HELD_OUT = 200
"""Points held out anywhere in the end, to tell the errors by, or as many as there are nodes."""

ROUNDS = 24
"""Most times that nodes are added."""

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
    *,
    scheduler: str | None = None,
    workers: int = 0,
    say: Callable[[str], None] | None = None,
) -> CreepTable:
    """Make a table of creep forces, or add to one what it lacks.

    Parameters
    ----------
    design : TableDesign or path-like
        What it is to hold, or its file (TOML). The file or the name of a table gives the same table
        with slopes at rest of fine meshes and error bars of gradients, which files from before
        these were computed lack; the other contacts are not solved again.
    path : path-like, optional
        File to write, netCDF; see `open_table`.
    progress : callable, optional
        Called whenever contacts have been solved.
    scheduler : str, optional
        Address of a scheduler of dask.distributed whose workers solve the contacts; what one that
        dies was at is handed to others.
    workers : int
        Without a scheduler: number of processes on this machine. With 0 the contacts are solved in
        this process. A script that asks for some does so under ``if __name__ == "__main__":``, as
        the workers import it.
    say : callable, optional
        Called with a word about what is waited for.

    Raises
    ------
    TableError
        With the faults of the design; or if the tolerance takes more nodes or elements than it
        allows.
    RuntimeError
        If a contact is not solved, or all workers die of it.
    ResultsError
        If dask is not installed, or the address is none.
    SchedulerLostError
        If there is no scheduler, or none any more.

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
    previous: CreepTable | None = None
    if not isinstance(design, TableDesign):
        previous = open_table(design) if is_table(design) else None
        design = TableDesign.from_toml(design) if previous is None else _design_of(previous)
    with _solver(design, scheduler, workers, say or (lambda _: None)) as solve:
        builder = _Builder(design, solve, progress or (lambda _: None))
        table = builder.built() if previous is None else builder.updated(previous)
    if path is not None:
        with require_extra("build_table"):
            from tractive_sam.tables.file import write_table  # noqa: PLC0415 - of an extra

        write_table(table, path)
    return table


@contextmanager
def _solver(
    design: TableDesign, scheduler: str | None, workers: int, say: Callable[[str], None]
) -> Iterator[Solve]:
    """What solves contacts: this process, processes of this machine, or a scheduler's workers."""
    chosen: AbstractContextManager = nullcontext((scheduler, None))
    if scheduler is not None or workers:
        check_installed()
        chosen = chosen if scheduler is not None else local_cluster(workers)
    with chosen as (address, security):
        yield here(design) if address is None else elsewhere(design, address, security, say)


def _design_of(table: CreepTable) -> TableDesign:
    if "design" not in table.about:
        raise ResultsError("design: the table's file lacks it; make the table from a design (TOML)")
    return TableDesign.from_toml_text(str(table.about["design"]))


@dataclass(frozen=True, eq=False)
class _Node:
    """A point of the grid, and the contact by which it is known: w = signs w of the contact."""

    job: Job
    signs: np.ndarray


@dataclass(eq=False)
class _Builder:
    design: TableDesign
    solve: Solve
    tell: Callable[[Progress], None]
    solved: dict[Job, Solved] = field(default_factory=dict)
    nodes: dict[tuple[float, ...], Solved] = field(default_factory=dict)
    middles: dict[tuple[int, float, float], list[tuple[float, ...]]] = field(default_factory=dict)
    held_out: list[tuple[float, ...]] = field(default_factory=list)
    round: int = 0
    contacts: int = 0
    seconds: float = 0.0
    previous_seconds: float = 0.0

    def __post_init__(self) -> None:
        design, self.began = self.design, process_time()
        self.grid = CreepageGrid(*design.symmetries)
        self.lead = len(design.names)
        self.axes = [*design.first_nodes, *self.grid.first, np.array(FIRST_U)]
        self.apart = [design.names.index(name) for name in design.apart]
        self.random = np.random.default_rng(design.seed)
        self.anywhere = qmc.Halton(len(self.axes), rng=np.random.default_rng(design.seed))

    def built(self) -> CreepTable:
        """The table of the design."""
        while True:
            table = self._table([np.zeros((max(len(a) - 1, 0), 3)) for a in self.axes])
            between = self._between(table)
            wanted = SHARE * self.design.tolerance
            split = [np.flatnonzero(one.max(axis=1, initial=0.0) > wanted) for one in between]
            if not any(map(len, split)):
                split = self._misses(table)
            if not any(map(len, split)):
                checked = self._checked(between)
                if checked.about["held_out_worst"] <= self.design.tolerance:
                    return self._with_gradient_bars(checked)
                self.held_out += map(tuple, checked.about["check_points"])
                continue
            self.round += 1
            self.axes = [self._refined(k, some) for k, some in enumerate(split)]
            count = math.prod(map(len, self.axes))
            if count > self.design.most or self.round > ROUNDS:
                needs = f"{count} nodes after {self.round} rounds, more than {self.design.most}"
                fault = Fault(
                    "tolerance",
                    f"{self.design.tolerance:g}, which takes {needs}",
                    "a larger tolerance, more nodes (most), or less along the axes",
                )
                raise TableError([fault])

    def updated(self, previous: CreepTable) -> CreepTable:
        """The table of the nodes of a previous one: rest is solved again, gradients are checked."""
        self.axes, coefficients = list(previous.law.axes), previous.law.coefficients
        self.contacts = int(previous.about.get("contacts", 0))
        self.previous_seconds = float(previous.about.get("cpu_seconds", 0.0))
        by_heading_tilt_u = np.moveaxis(coefficients[..., [4, 2, 1], :], -2, -1)
        for place in np.ndindex(previous.bars.shape[:-1]):
            point = tuple(float(axis[k]) for axis, k in zip(self.axes, place, strict=True))
            if point[-1] > 0.0:
                force = coefficients[place][0]
                self.nodes[point] = Solved(force, previous.bars[place], by_heading_tilt_u[place])
        return self._with_gradient_bars(self._table(previous.between, previous.about))

    def _refined(self, axis: int, split: np.ndarray) -> np.ndarray:
        """The nodes of an axis with intervals divided; those of creepages stay symmetric."""
        nodes = self.axes[axis]
        split = self.grid.alike(axis - self.lead, split, len(nodes) - 1)
        middles = 0.5 * (nodes[split] + nodes[split + 1]) if len(split) else np.empty(0)
        return np.sort(np.concatenate([nodes, middles]))

    def _checked(self, between: list[np.ndarray]) -> CreepTable:
        """The table with what points held out anywhere say of its errors."""
        table = self._table(between)
        count = min(HELD_OUT, table.nodes)
        points = self._at_shares(self.random.random((count, len(self.axes))))
        off = np.abs(self._errors(table, points))
        told = table.error_at(list(np.array(points).T)).T
        shares, errors = (off / (told + 1e-12)).max(axis=1), off.max(axis=1)
        # So wide that 95 of 100 of them, and the contact's own bar, are within.
        wider = max(1.0, float(np.quantile(shares, 0.97)))
        design = self.design
        about = {
            "title": design.title,
            "design": design.to_toml(),
            "tolerance": design.tolerance,
            "rounds": self.round,
            "held_out": len(errors),
            "held_out_median": float(np.median(errors)),
            "held_out_worst": float(np.max(errors)),
            "held_out_inside": float(np.mean(shares <= wider)),
            "widened": wider,
        }
        checks = {"check_points": np.array(points), "check_errors": off, "check_told": wider * told}
        return self._table([wider * one for one in between], about | checks, wider)

    def _with_gradient_bars(self, table: CreepTable) -> CreepTable:
        """The table with error bars of its gradients, and what making it took."""
        axis, lead = self.axes[-1], self.lead
        # A place takes about as many contacts as twenty nodes: a tenth of the work, or less.
        number, random = np.clip(table.nodes // 200, 4, 24), np.random.default_rng(self.design.seed)
        shares = random.random((number, len(axis) - 1, len(self.axes)))
        shares[..., :lead] = shares[:, :1, :lead]  # a point in each interval of u, at each place
        steps = np.arange(len(axis) - 1) + shares[..., -1]
        shares[..., -1] = np.interp(steps, np.arange(len(axis)), axis)
        points = self._at_shares(shares.reshape(-1, len(self.axes)))
        places = {one[:lead] for one in (*points, *itertools.product(*self.axes[:lead]))}
        moving = self._checks(points, table, finer=True)
        at_rest = self._checks([(*place, 0.0, 0.0, 0.0) for place in sorted(places)], table)
        bars = GradientBars.from_errors(
            axis, moving.points[:, -1], moving.errors(table), at_rest.errors(table)
        )
        made = {
            "contacts": self.contacts,
            "cpu_seconds": self.previous_seconds + max(self.seconds, process_time() - self.began),
        }
        about = {**table.about, **bars.about, **made}
        return replace(table, about=about, gradient_bars=bars.values)

    def _checks(
        self, points: list[tuple[float, ...]], table: CreepTable, finer: bool = False
    ) -> GradientChecks:
        """Gradients solved at points, where asked on finer meshes than those of the nodes."""
        lead = self.lead
        jobs = [replace(self._job(point[:lead], point[lead:]), finer=finer) for point in points]
        self._solve(jobs, table.nodes)
        return GradientChecks(
            np.array(points),
            np.array([job.w for job in jobs]),
            np.array([self.design.ratio(job.place) for job in jobs]),
            np.array([self.solved[job].gradient for job in jobs]),
            np.array([self.solved[job].gradient_bar for job in jobs]),
        )

    def _table(self, between, about=None, wider: float = 1.0) -> CreepTable:
        shape = tuple(map(len, self.axes))
        places = list(itertools.product(*map(range, shape)))
        points = [
            tuple(float(axis[k]) for axis, k in zip(self.axes, place, strict=True))
            for place in places
        ]
        new = {point: self._of(point) for point in points if point not in self.nodes}
        self._solve([one.job for one in new.values() if one is not None], len(points))
        for point, one in new.items():
            self.nodes[point] = self._node(point, one)
        found = [self.nodes[point] for point in points]
        values = np.array([one.force for one in found]).reshape(*shape, 3)
        bars = np.array([one.bar for one in found]).reshape(*shape, 3)
        slopes = np.array([one.gradient for one in found]).reshape(*shape, 3, 3)
        self._end_slopes(values, slopes)
        derivatives = coefficients(self.axes, values, slopes, self.grid.whole, self.apart)
        design = self.design
        return CreepTable(
            Hermite(tuple(self.axes), derivatives),
            design.names,
            wider * bars,
            tuple(between),
            about or {},
            design.apart,
            self.grid.whole,
            design.contact,
        )

    def _end_slopes(self, values: np.ndarray, slopes: np.ndarray) -> None:
        """Slopes by u in full slip: of the parabola through the last two nodes and its slope."""
        u = self.axes[-1]
        rise = (values[..., -1, :] - values[..., -2, :]) / (u[-1] - u[-2])
        slopes[..., -1, :, 2] = 2.0 * rise - slopes[..., -2, :, 2]

    def _of(self, point: tuple[float, ...]) -> _Node | None:
        """The contact by which a node is known, None in full slip that has a closed form."""
        if point[-1] == 1.0 and self.design.closed_form:
            return None
        place = point[: self.lead]
        creepages, signs = self.grid.canonical(point[self.lead :])
        return _Node(self._job(place, creepages), signs)

    def _job(self, place: tuple[float, ...], creepages, gradient: bool = True) -> Job:
        heading, tilt, u = creepages
        w = creepages_at(self.design.ratio(place), heading, tilt, min(u, FULL / (1.0 + FULL)))
        return Job(place, (float(w[0]), float(w[1]), float(w[2])), gradient)

    def _node(self, point: tuple[float, ...], node: _Node | None) -> Solved:
        """A node: its gradient is by heading, tilt and u."""
        ratio = self.design.ratio(point[: self.lead])
        heading, tilt, u = point[self.lead :]
        if node is None:
            return _in_full_slip(ratio, heading, tilt)
        found = self.solved[node.job]
        by_w = node.signs[:, None] * found.gradient * node.signs
        by = by_w @ by_coordinates(ratio, heading, tilt, min(u, FULL / (1.0 + FULL)))
        return Solved(node.signs * found.force, found.bar, by)

    def _solve(self, jobs: Iterable[Job], nodes: int) -> None:
        """Solve contacts that are not solved yet, neighbours one after another."""
        new = dict.fromkeys(job for job in jobs if job not in self.solved)
        left = sorted(new, key=lambda job: job.place)
        done = 0
        for first, batch in self.solve(left):
            self.solved.update(zip(left[first:], batch.found, strict=False))
            self.contacts += batch.contacts
            self.seconds += batch.seconds
            done += len(batch.found)
            self.tell(Progress(nodes, nodes - len(left) + done, self.round))
            for found in batch.found:
                self._check_bar(found)

    def _check_bar(self, found: Solved) -> None:
        design = self.design
        if found.bar.max() > design.tolerance:
            fault = Fault(
                "tolerance",
                f"{design.tolerance:g}, but an error bar of "
                f"{found.bar.max():.2g} on {design.finest} elements",
                "a larger tolerance, or a larger finest",
            )
            raise TableError([fault])

    def _at_shares(self, shares: np.ndarray) -> list[tuple[float, ...]]:
        """Points at shares of each axis; where nothing is known between nodes, at one of them."""
        return [
            tuple(
                float(axis[int(share * len(axis))] if k in self.apart
                      else axis[0] + share * (axis[-1] - axis[0]))
                for k, (axis, share) in enumerate(zip(self.axes, point, strict=True))
            )
            for point in shares
        ]  # fmt: skip

    def _errors(self, table: CreepTable, points: list[tuple[float, ...]]) -> np.ndarray:
        """What a table is off at points, shape (P, 3)."""
        jobs = [self._job(point[: self.lead], point[self.lead :], False) for point in points]
        self._solve(jobs, table.nodes)
        exact = np.array([self.solved[job].force for job in jobs])
        return table.law(list(np.array(points).T)).T - exact

    def _between(self, table: CreepTable) -> list[np.ndarray]:
        """Largest errors of interpolation seen in the middle of every interval of every axis.

        An interval keeps its points from round to round: of ever new ones some would be worse.
        """
        found, points, where = [], [], []
        for k, nodes in enumerate(self.axes):
            found.append(np.zeros((max(len(nodes) - 1, 0), 3)))
            if k in self.apart:
                continue
            for cell, (low, high) in enumerate(itertools.pairwise(map(float, nodes))):
                if (k, low, high) not in self.middles:
                    middle = 0.5 * (low + high)
                    self.middles[k, low, high] = [self._at(k, middle) for _ in range(SAMPLES)]
                points += self.middles[k, low, high]
                where += SAMPLES * [(k, cell)]
        for (k, cell), error in zip(where, np.abs(self._errors(table, points)), strict=True):
            found[k][cell] = np.maximum(found[k][cell], error)
        for k, errors in enumerate(found):
            for one in range(len(errors)):
                alike = self.grid.alike(k - self.lead, np.array([one]), len(errors))
                errors[alike] = errors[alike].max(axis=0)
        return found

    def _at(self, axis: int, x: float) -> tuple[float, ...]:
        """A random node moved along one axis to x."""
        at = [float(self.random.choice(nodes)) for nodes in self.axes]
        if axis != len(self.axes) - 1:  # neither at rest nor in full slip
            at[-1] = float(self.random.choice(self.axes[-1][1:-1]))
        return (*at[:axis], x, *at[axis + 1 :])

    def _misses(self, table: CreepTable) -> list[np.ndarray]:
        """Intervals to divide as points anywhere are too far off.

        They are those held out so far; where all of these are within, so many others between them,
        of the sequence of Halton, which leaves no gap of several axes. Of the axes of such a point
        it is the one along which the table is furthest off, with the others at the nearest of their
        nodes, for the share of nodes that are added.
        """
        split: list[set[int]] = [set() for _ in self.axes]
        missed = self._missed(table)
        if not missed:
            number = min(ANYWHERE, table.nodes)
            self.held_out += self._at_shares(self.anywhere.random(number))
            missed = self._missed(table)
        if not missed:
            return [np.empty(0, int) for _ in split]
        free = [k for k, axis in enumerate(self.axes) if len(axis) > 1 and k not in self.apart]
        probes: list[tuple[float, ...]] = []
        for point in missed:
            node = [float(axis[np.abs(axis - x).argmin()])
                    for axis, x in zip(self.axes, point, strict=True)]  # fmt: skip
            node[-1] = min(max(node[-1], self.axes[-1][1]), self.axes[-1][-2])
            probes += [(*node[:k], point[k], *node[k + 1 :]) for k in free]
        along = np.abs(self._errors(table, probes)).max(axis=1).reshape(len(missed), len(free))
        for point, seen in zip(missed, along, strict=True):
            cells = [self._cells(k, point[k]) for k in free]
            planes = [len(some) / len(self.axes[k]) for k, some in zip(free, cells, strict=True)]
            worst = int((seen / planes).argmax())
            split[free[worst]].update(cells[worst].tolist())
        return [np.array(sorted(some), int) for some in split]

    def _missed(self, table: CreepTable) -> list[tuple[float, ...]]:
        """The points held out that ask for nodes."""
        if not self.held_out:
            return []
        errors = np.abs(self._errors(table, self.held_out)).max(axis=1)
        least = max(MISS * self.design.tolerance, WORST * errors.max())
        return [one for one, error in zip(self.held_out, errors, strict=True) if error > least]

    def _cells(self, axis: int, x: float) -> np.ndarray:
        """The interval of an axis that x is in, with those that symmetries make of it."""
        nodes = self.axes[axis]
        return self.grid.alike(axis - self.lead, cell_of(nodes, np.array([x])), len(nodes) - 1)


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
