"""Build a table: solve its nodes, and add nodes where errors at check points are too large."""

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
from tractive_sam.tables.solving import NODE_SHARE, Job, Solve, solve_here, solve_on_workers

FIRST_U = (0.0, 0.2, 0.4, 0.475, 0.55, 0.625, 0.7, 0.85, 1.0)
"""First nodes along u: closest at the onset of full slip, where forces change abruptly."""


@dataclass(frozen=True)
class Refinement:
    """Settings of the refinement of a table.

    Attributes
    ----------
    full : float
        r over r_0 that is solved for full slip if it has no closed form: the share of stick is
        as small.
    samples : int
        Check points in the middle of every interval of every axis.
    anywhere : int
        Check points anywhere, at most as many as nodes. The points that led to a refinement say
        less about others: a table is complete only if as many new ones have small errors. If three
        in a thousand exceed `miss`, a thousand random points find one in 95 of 100 cases; these
        are distributed more evenly.
    miss : float
        Error over the tolerance from which such a point leads to a refinement.
    worst : float
        The same over the largest error: nodes for the worst points often reduce smaller errors.
    checks : int
        Final check points anywhere, which measure the errors; at most as many as nodes.
    rounds : int
        Largest number of refinements.
    step : float
        Step of differences of closed forms along heading and tilt.
    """

    full: float = 1e4
    samples: int = 5
    anywhere: int = 1000
    miss: float = 0.5
    worst: float = 0.5
    checks: int = 200
    rounds: int = 24
    step: float = 1e-4

    @property
    def last_u(self) -> float:
        """Largest u that is solved: that of `full`."""
        return self.full / (1.0 + self.full)


REFINEMENT = Refinement()


@dataclass(frozen=True)
class Progress:
    """Progress of a table.

    Attributes
    ----------
    nodes, done : int
        Number of nodes of the present grid, and of those that are solved.
    round : int
        Number of refinements.
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
    """Build a table of creep forces, or add missing error bars to one.

    Parameters
    ----------
    design : TableDesign or path-like
        Its design, or the file (TOML) of the design. The file or the name of a table yields the
        same table with slopes at rest of fine meshes and error bars of gradients, which older files
        lack; other contacts are not solved again.
    path : path-like, optional
        File to write, netCDF; `open_table` reads it.
    progress : callable, optional
        Called whenever contacts have been solved.
    scheduler : str, optional
        Address of a scheduler of dask.distributed whose workers solve the contacts; others take
        over the contacts of a worker that dies.
    workers : int
        Without a scheduler: number of processes on this machine. With 0 the contacts are solved in
        this process. A script with workers calls it under ``if __name__ == "__main__":``, as the
        workers import the script.
    say : callable, optional
        Called with a message about what is waited for.

    Raises
    ------
    TableError
        With the faults of the design; or if the tolerance needs more nodes or elements than the
        design allows.
    RuntimeError
        If a contact is not solved, or all its workers die.
    ResultsError
        If dask is not installed, or the address is invalid.
    SchedulerLostError
        If the scheduler does not exist or was lost.

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
        table = builder.build() if previous is None else builder.update(previous)
    if path is not None:
        with require_extra("build_table"):
            from tractive_sam.tables.file import write_table  # noqa: PLC0415 - of an extra

        write_table(table, path)
    return table


@contextmanager
def _solver(
    design: TableDesign, scheduler: str | None, workers: int, say: Callable[[str], None]
) -> Iterator[Solve]:
    """Yield a solver of contacts: this process, processes of this machine, or workers."""
    chosen: AbstractContextManager = nullcontext((scheduler, None))
    if scheduler is not None or workers:
        check_installed()
        chosen = chosen if scheduler is not None else local_cluster(workers)
    with chosen as (address, security):
        yield (
            solve_here(design)
            if address is None
            else solve_on_workers(design, address, security, say)
        )


def _design_of(table: CreepTable) -> TableDesign:
    """Return the design from which a table was built."""
    if "design" not in table.about:
        raise ResultsError(
            "design: the file of the table has none; build the table from a design (TOML)"
        )
    return TableDesign.from_toml_text(str(table.about["design"]))


@dataclass(frozen=True, eq=False)
class _Node:
    """The contact of a node and the signs of its creepages: w = signs * w of the contact."""

    job: Job
    signs: np.ndarray


@dataclass(eq=False)
class _Builder:
    """The grid of a table while it is refined, with the contacts that are solved."""

    design: TableDesign
    solve: Solve
    report: Callable[[Progress], None]
    solved: dict[Job, Solved] = field(default_factory=dict)
    nodes: dict[tuple[float, ...], Solved] = field(default_factory=dict)
    middles: dict[tuple[int, float, float], list[tuple[float, ...]]] = field(default_factory=dict)
    check_points: list[tuple[float, ...]] = field(default_factory=list)
    round: int = 0
    contacts: int = 0
    seconds: float = 0.0
    previous_seconds: float = 0.0

    def __post_init__(self) -> None:
        design, self.began = self.design, process_time()
        self.grid = CreepageGrid(*design.symmetries)
        self.lead = len(design.names)
        self.axes = [*design.first_nodes, *self.grid.first, np.array(FIRST_U)]
        self.discrete = [design.names.index(name) for name in design.apart]
        self.random = np.random.default_rng(design.seed)
        self.anywhere = qmc.Halton(len(self.axes), rng=np.random.default_rng(design.seed))

    def build(self) -> CreepTable:
        """Build the table of the design."""
        while True:
            table = self._table([np.zeros((max(len(a) - 1, 0), 3)) for a in self.axes])
            between = self._interval_errors(table)
            wanted = NODE_SHARE * self.design.tolerance
            split = [np.flatnonzero(one.max(axis=1, initial=0.0) > wanted) for one in between]
            if not any(map(len, split)):
                split = self._choose_splits(table)
            if not any(map(len, split)):
                checked = self._measure_errors(between)
                if checked.about["held_out_worst"] <= self.design.tolerance:
                    return self._with_gradient_bars(checked)
                self.check_points += map(tuple, checked.about["check_points"])
                continue
            self.round += 1
            self.axes = [self._refine(k, some) for k, some in enumerate(split)]
            count = math.prod(map(len, self.axes))
            if count > self.design.most or self.round > REFINEMENT.rounds:
                needs = f"{count} nodes after {self.round} rounds, more than {self.design.most}"
                fault = Fault(
                    "tolerance",
                    f"{self.design.tolerance:g}, which needs {needs}",
                    "a larger tolerance, more nodes (most), or fewer values of the axes",
                )
                raise TableError([fault])

    def update(self, previous: CreepTable) -> CreepTable:
        """Return a table with the nodes of a previous one: solve rest again, check gradients."""
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

    def _refine(self, axis: int, split: np.ndarray) -> np.ndarray:
        """Return the nodes of an axis with divided intervals; those of creepages stay symmetric."""
        nodes = self.axes[axis]
        split = self.grid.alike(axis - self.lead, split, len(nodes) - 1)
        middles = 0.5 * (nodes[split] + nodes[split + 1]) if len(split) else np.empty(0)
        return np.sort(np.concatenate([nodes, middles]))

    def _measure_errors(self, between: list[np.ndarray]) -> CreepTable:
        """Return the table with its errors at new check points anywhere."""
        table = self._table(between)
        count = min(REFINEMENT.checks, table.nodes)
        points = self._points_at_shares(self.random.random((count, len(self.axes))))
        errors_by_force = np.abs(self._errors(table, points))
        reported = table.error_at(list(np.array(points).T)).T
        shares, errors = (
            (errors_by_force / (reported + 1e-12)).max(axis=1),
            errors_by_force.max(axis=1),
        )
        # The error bars of 95 of 100 points, with those of the contact, are sufficient.
        widening = max(1.0, float(np.quantile(shares, 0.97)))
        design = self.design
        about = {
            "title": design.title,
            "design": design.to_toml(),
            "tolerance": design.tolerance,
            "rounds": self.round,
            "held_out": len(errors),
            "held_out_median": float(np.median(errors)),
            "held_out_worst": float(np.max(errors)),
            "held_out_inside": float(np.mean(shares <= widening)),
            "widened": widening,
        }
        checks = {"check_points": np.array(points), "check_errors": errors_by_force}
        checks["check_told"] = widening * reported
        return self._table([widening * errors for errors in between], about | checks, widening)

    def _with_gradient_bars(self, table: CreepTable) -> CreepTable:
        """Return the table with error bars of its gradients, and its cost."""
        axis, lead = self.axes[-1], self.lead
        # A place needs about as many contacts as twenty nodes: at most a tenth of the work.
        number, random = np.clip(table.nodes // 200, 4, 24), np.random.default_rng(self.design.seed)
        shares = random.random((number, len(axis) - 1, len(self.axes)))
        shares[..., :lead] = shares[:, :1, :lead]  # a point in each interval of u, at each place
        steps = np.arange(len(axis) - 1) + shares[..., -1]
        shares[..., -1] = np.interp(steps, np.arange(len(axis)), axis)
        points = self._points_at_shares(shares.reshape(-1, len(self.axes)))
        places = {one[:lead] for one in (*points, *itertools.product(*self.axes[:lead]))}
        moving = self._solve_gradients(points, table, finer=True)
        at_rest = self._solve_gradients(
            [(*place, 0.0, 0.0, 0.0) for place in sorted(places)], table
        )
        bars = GradientBars.from_errors(
            axis, moving.points[:, -1], moving.errors(table), at_rest.errors(table)
        )
        made = {
            "contacts": self.contacts,
            "cpu_seconds": self.previous_seconds + max(self.seconds, process_time() - self.began),
        }
        about = {**table.about, **bars.about, **made}
        return replace(table, about=about, gradient_bars=bars.values)

    def _solve_gradients(
        self, points: list[tuple[float, ...]], table: CreepTable, finer: bool = False
    ) -> GradientChecks:
        """Return gradients that are solved at points, if `finer` on finer meshes than nodes."""
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

    def _table(self, between, about=None, widening: float = 1.0) -> CreepTable:
        """Return the table of the present nodes."""
        shape = tuple(map(len, self.axes))
        places = list(itertools.product(*map(range, shape)))
        points = [
            tuple(float(axis[k]) for axis, k in zip(self.axes, place, strict=True))
            for place in places
        ]
        new = {point: self._canonical_node(point) for point in points if point not in self.nodes}
        self._solve([one.job for one in new.values() if one is not None], len(points))
        for point, one in new.items():
            self.nodes[point] = self._node(point, one)
        found = [self.nodes[point] for point in points]
        values = np.array([one.force for one in found]).reshape(*shape, 3)
        bars = np.array([one.bar for one in found]).reshape(*shape, 3)
        slopes = np.array([one.gradient for one in found]).reshape(*shape, 3, 3)
        self._end_slopes(values, slopes)
        derivatives = coefficients(self.axes, values, slopes, self.grid.whole, self.discrete)
        design = self.design
        return CreepTable(
            Hermite(tuple(self.axes), derivatives),
            design.names,
            widening * bars,
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

    def _canonical_node(self, point: tuple[float, ...]) -> _Node | None:
        """Return the node of a contact; None if full slip has a closed form."""
        if point[-1] == 1.0 and self.design.closed_form:
            return None
        place = point[: self.lead]
        creepages, signs = self.grid.canonical(point[self.lead :])
        return _Node(self._job(place, creepages), signs)

    def _job(self, place: tuple[float, ...], creepages, gradient: bool = True) -> Job:
        """Return the job to solve the contact at a place."""
        heading, tilt, u = creepages
        w = creepages_at(
            self.design.ratio(place),
            heading,
            tilt,
            min(u, REFINEMENT.last_u),
        )
        return Job(place, (float(w[0]), float(w[1]), float(w[2])), gradient)

    def _node(self, point: tuple[float, ...], node: _Node | None) -> Solved:
        """Return a node with its gradient by heading, tilt and u."""
        ratio = self.design.ratio(point[: self.lead])
        heading, tilt, u = point[self.lead :]
        if node is None:
            return _full_slip_node(ratio, heading, tilt)
        found = self.solved[node.job]
        by_w = node.signs[:, None] * found.gradient * node.signs
        by = by_w @ by_coordinates(ratio, heading, tilt, min(u, REFINEMENT.last_u))
        return Solved(node.signs * found.force, found.bar, by)

    def _solve(self, jobs: Iterable[Job], nodes: int) -> None:
        """Solve the contacts that are not solved yet, neighbours one after another."""
        new = dict.fromkeys(job for job in jobs if job not in self.solved)
        left = sorted(new, key=lambda job: job.place)
        done = 0
        for first, batch in self.solve(left):
            self.solved.update(zip(left[first:], batch.found, strict=False))
            self.contacts += batch.contacts
            self.seconds += batch.seconds
            done += len(batch.found)
            self.report(Progress(nodes, nodes - len(left) + done, self.round))
            for found in batch.found:
                self._check_bar(found)

    def _check_bar(self, found: Solved) -> None:
        """Raise an error if the error bar of a contact exceeds the tolerance."""
        design = self.design
        if found.bar.max() > design.tolerance:
            fault = Fault(
                "tolerance",
                f"{design.tolerance:g}, but an error bar of "
                f"{found.bar.max():.2g} on {design.finest} elements",
                "a larger tolerance, or a larger finest",
            )
            raise TableError([fault])

    def _points_at_shares(self, shares: np.ndarray) -> list[tuple[float, ...]]:
        """Return points at shares of each axis; of a discrete axis at one of its nodes."""
        return [
            tuple(
                float(axis[int(share * len(axis))] if k in self.discrete
                      else axis[0] + share * (axis[-1] - axis[0]))
                for k, (axis, share) in enumerate(zip(self.axes, point, strict=True))
            )
            for point in shares
        ]  # fmt: skip

    def _errors(self, table: CreepTable, points: list[tuple[float, ...]]) -> np.ndarray:
        """Return the errors of a table at points, shape (P, 3)."""
        jobs = [self._job(point[: self.lead], point[self.lead :], False) for point in points]
        self._solve(jobs, table.nodes)
        exact = np.array([self.solved[job].force for job in jobs])
        return table.law(list(np.array(points).T)).T - exact

    def _interval_errors(self, table: CreepTable) -> list[np.ndarray]:
        """Return the largest errors of interpolation in the middle of every interval, by axis.

        An interval has the same points in every round: among new ones some would be worse.
        """
        found, points, where = [], [], []
        for k, nodes in enumerate(self.axes):
            found.append(np.zeros((max(len(nodes) - 1, 0), 3)))
            if k in self.discrete:
                continue
            for cell, (low, high) in enumerate(itertools.pairwise(map(float, nodes))):
                if (k, low, high) not in self.middles:
                    middle = 0.5 * (low + high)
                    self.middles[k, low, high] = [
                        self._random_point(k, middle) for _ in range(REFINEMENT.samples)
                    ]
                points += self.middles[k, low, high]
                where += REFINEMENT.samples * [(k, cell)]
        for (k, cell), error in zip(where, np.abs(self._errors(table, points)), strict=True):
            found[k][cell] = np.maximum(found[k][cell], error)
        for k, errors in enumerate(found):
            for one in range(len(errors)):
                alike = self.grid.alike(k - self.lead, np.array([one]), len(errors))
                errors[alike] = errors[alike].max(axis=0)
        return found

    def _random_point(self, axis: int, x: float) -> tuple[float, ...]:
        """Return a random node, moved along one axis to x."""
        at = [float(self.random.choice(nodes)) for nodes in self.axes]
        if axis != len(self.axes) - 1:  # neither at rest nor in full slip
            at[-1] = float(self.random.choice(self.axes[-1][1:-1]))
        return (*at[:axis], x, *at[axis + 1 :])

    def _choose_splits(self, table: CreepTable) -> list[np.ndarray]:
        """Return the intervals to divide because errors at points anywhere are too large.

        These are the check points so far. If their errors are small, as many new ones follow, from
        the sequence of Halton, which leaves no gap in several dimensions. At such a point the axis
        with the largest error is divided, over the share of nodes that are added; the other
        coordinates are those of the nearest node.
        """
        split: list[set[int]] = [set() for _ in self.axes]
        missed = self._find_missed(table)
        if not missed:
            number = min(REFINEMENT.anywhere, table.nodes)
            self.check_points += self._points_at_shares(self.anywhere.random(number))
            missed = self._find_missed(table)
        if not missed:
            return [np.empty(0, int) for _ in split]
        free = [k for k, axis in enumerate(self.axes) if len(axis) > 1 and k not in self.discrete]
        probes: list[tuple[float, ...]] = []
        for point in missed:
            node = [float(axis[np.abs(axis - x).argmin()])
                    for axis, x in zip(self.axes, point, strict=True)]  # fmt: skip
            node[-1] = min(max(node[-1], self.axes[-1][1]), self.axes[-1][-2])
            probes += [(*node[:k], point[k], *node[k + 1 :]) for k in free]
        along = np.abs(self._errors(table, probes)).max(axis=1).reshape(len(missed), len(free))
        for point, seen in zip(missed, along, strict=True):
            cells = [self._symmetric_cells(k, point[k]) for k in free]
            planes = [len(some) / len(self.axes[k]) for k, some in zip(free, cells, strict=True)]
            worst = int((seen / planes).argmax())
            split[free[worst]].update(cells[worst].tolist())
        return [np.array(sorted(some), int) for some in split]

    def _find_missed(self, table: CreepTable) -> list[tuple[float, ...]]:
        """Return the check points whose errors are too large."""
        if not self.check_points:
            return []
        errors = np.abs(self._errors(table, self.check_points)).max(axis=1)
        least = max(REFINEMENT.miss * self.design.tolerance, REFINEMENT.worst * errors.max())
        return [one for one, error in zip(self.check_points, errors, strict=True) if error > least]

    def _symmetric_cells(self, axis: int, x: float) -> np.ndarray:
        """Return the interval of an axis that contains x, with its images by symmetry."""
        nodes = self.axes[axis]
        return self.grid.alike(axis - self.lead, cell_of(nodes, np.array([x])), len(nodes) - 1)


def _full_slip_node(ratio: float, heading: float, tilt: float) -> Solved:
    """Return the closed form of full slip, with its derivatives by differences."""

    def force(heading: float, tilt: float) -> np.ndarray:
        w = creepages_at(ratio, heading, tilt, 1.0)
        w[np.abs(w) < 1e-15] = 0.0
        return np.array(full_slip_with_spin(ratio, (w[0], w[1]), w[2]))

    step = REFINEMENT.step
    by_heading = (force(heading + step, tilt) - force(heading - step, tilt)) / (2.0 * step)
    by_tilt = (force(heading, tilt + step) - force(heading, tilt - step)) / (2.0 * step)
    slopes = np.stack([by_heading, by_tilt, np.zeros(3)], axis=1)
    return Solved(force(heading, tilt), np.zeros(3), slopes)
