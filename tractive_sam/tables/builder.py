"""Refine a table: add nodes near check points with too large errors."""

import itertools
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from time import process_time
from typing import Any

import numpy as np
import scipy  # its parts are loaded when first used
from scipy.stats import qmc

from tractive_sam.lookup import (
    MIRROR,
    REVERSED,
    Coordinates,
    CreepTable,
    Hermite,
    cell_of,
    share_of_bar,
)
from tractive_sam.schema import Fault
from tractive_sam.tables.design import Solved, TableError
from tractive_sam.tables.solving import NODE_SHARE, Point, TableContacts

HEADING, TILT = 0, 1
"""Indices of heading and tilt among the last three axes: heading, tilt, u."""


def coefficients(
    axes: Sequence[np.ndarray],
    values: np.ndarray,
    slopes: np.ndarray,
    full_range: bool = False,
    apart: Sequence[int] = (),
) -> np.ndarray:
    """Return the mixed derivatives at the nodes of a table, for Hermite interpolation.

    Along axes other than creepages only values are known; slopes follow from the cubic spline
    through them. A mixed derivative is the mean of the differences of lower derivatives along each
    of its axes; beyond the ends of heading and tilt, values follow from the symmetries of the
    table. At rest forces are linear in the creepages: the derivatives are known functions of
    heading and tilt.

    Parameters
    ----------
    axes : sequence of ndarray
        Nodes along the axes of a table, the last ones heading, tilt and u.
    values : ndarray, shape (n_1, ..., n_N, 3)
        Forces.
    slopes : ndarray, shape (n_1, ..., n_N, 3, 3)
        Derivatives (force, coordinate) by heading, tilt and u.
    full_range : bool
        Whether the table contains all headings and tilts.
    apart : sequence of int
        Discrete axes, along which values are not interpolated.

    Returns
    -------
    ndarray, shape (n_1, ..., n_N, 2**N, 3)
    """
    count = len(axes)
    flat = {k for k in range(count) if len(axes[k]) == 1 or k in apart}
    derivatives: dict[frozenset[int], np.ndarray] = {frozenset(): values}
    for size in range(1, count + 1):
        for some in map(frozenset, itertools.combinations(range(count), size)):
            if some & flat:
                derivatives[some] = np.zeros_like(values)
            elif size == 1 and min(some) >= count - 3:
                derivatives[some] = slopes[..., min(some) - (count - 3)]
            else:
                parts = {
                    k: _slope(axes, derivatives[some - {k}], k, some - {k}, full_range)
                    for k in sorted(some)
                }
                derivatives[some] = np.mean(list(parts.values()), axis=0)
                _use_slopes_at_nodes(derivatives[some], parts, count - 3, full_range)
                # Those by u and axes of the table at u = 0 follow from the exact slopes there;
                # others are zero at rest, and their differences along u are less accurate.
                further = [part[..., 0, :] for axis, part in parts.items() if axis < count - 3]
                if count - 1 in parts and further and not {count - 3, count - 2} & parts.keys():
                    derivatives[some][..., 0, :] = np.mean(further, axis=0)
    places = [
        frozenset(k for k in range(count) if d >> (count - 1 - k) & 1) for d in range(2**count)
    ]
    return np.stack([derivatives[some] for some in places], axis=-2)


def _use_slopes_at_nodes(values: np.ndarray, parts: dict, heading: int, full_range: bool) -> None:
    """Replace mixed derivatives, in place, by exact ones at nodes at rest or at a pole."""
    for axis in (heading + HEADING, heading + TILT):
        if axis in parts:
            for place in _smooth_nodes(values.ndim, axis, heading, full_range):
                values[place] = parts[axis][place]
            return


def _smooth_nodes(dims: int, axis: int, heading: int, full_range: bool) -> list[tuple]:
    """Return indices of nodes, at rest or at a pole, that follow from 1, cos and sin of `axis`."""
    every = [slice(None)] * dims
    places = []
    for end_axis, end in ((heading + 2, 0), (heading + TILT, -1), (heading + TILT, 0)):
        if end_axis == axis or (axis != heading and end_axis != heading + 2):
            continue
        if end_axis == heading + TILT and end == 0 and not full_range:
            continue  # zero spin
        places.append((*every[:end_axis], end, *every[end_axis + 1 :]))
    return places


def _slope(
    axes: Sequence[np.ndarray],
    values: np.ndarray,
    axis: int,
    taken: frozenset[int],
    full_range: bool,
) -> np.ndarray:
    """Return the derivative along an axis of nodal values (derivatives by the axes `taken`)."""
    nodes, count = axes[axis], len(axes)
    kind = axis - (count - 3)
    if kind < 0:
        if len(nodes) == 2:
            step = np.diff(values, axis=axis) / np.diff(nodes)
            return np.repeat(step, 2, axis=axis)
        return scipy.interpolate.CubicSpline(nodes, values, axis=axis)(nodes, 1)
    if kind not in (HEADING, TILT):
        return np.gradient(values, nodes, axis=axis, edge_order=2 if len(nodes) > 2 else 1)
    beyond = _beyond_full_range if full_range else _beyond_quarter
    first, last = beyond(values, kind, count - 3, taken)
    padded = np.concatenate([first, values, last], axis=axis)
    around = np.concatenate([[2.0 * nodes[0] - nodes[1]], nodes, [2.0 * nodes[-1] - nodes[-2]]])
    inner = np.take(np.gradient(padded, around, axis=axis), range(1, len(nodes) + 1), axis=axis)
    basis = np.stack([np.ones_like(nodes), np.cos(nodes), np.sin(nodes)], axis=1)
    slopes = np.stack([np.zeros_like(nodes), -np.sin(nodes), np.cos(nodes)], axis=1)
    exact = np.moveaxis(
        np.tensordot(slopes @ np.linalg.pinv(basis), values, axes=(1, axis)), 0, axis
    )
    for place in _smooth_nodes(values.ndim, axis, count - 3, full_range):
        inner[place] = exact[place]
    return inner


Pair = tuple[np.ndarray, np.ndarray]


def _beyond_quarter(values: np.ndarray, kind: int, heading: int, taken: frozenset[int]) -> Pair:
    """Return values one node before and one behind an axis, by both symmetries of forces."""
    first, last = _ends(values, heading + kind)
    turned = -1.0 if heading in taken else 1.0
    if kind == HEADING:  # f(pi - heading) = REVERSED f(heading)
        return REVERSED * turned * first, REVERSED * turned * last
    # f(heading, -tilt) = MIRROR f(-heading, tilt), and so on at the pole
    sign = turned * (-1.0 if heading + TILT in taken else 1.0)
    return MIRROR * sign * np.flip(first, heading), REVERSED * sign * np.flip(last, heading)


def _beyond_full_range(values: np.ndarray, kind: int, heading: int, taken: frozenset[int]) -> Pair:
    """Return values one node before and one behind an axis that covers all directions."""
    first, last = _ends(values, heading + kind)
    if kind == HEADING:
        return last, first
    sign, count = -1.0 if heading + TILT in taken else 1.0, values.shape[heading]
    across = (np.arange(count) + (count - 1) // 2) % (count - 1)
    return sign * np.take(first, across, heading), sign * np.take(last, across, heading)


def _ends(values: np.ndarray, axis: int) -> Pair:
    """Return values at the second and at the last but one node of an axis."""
    return np.take(values, [1], axis), np.take(values, [values.shape[axis] - 2], axis)


@dataclass(frozen=True, eq=False)
class GradientChecks:
    """Solved gradients at check points, with which a table is compared.

    Attributes
    ----------
    points : ndarray, shape (P, N)
        Points along the axes of the table.
    w : ndarray, shape (P, 3)
        Scaled creepages of the points.
    ratio : ndarray, shape (P,)
        Values of a/b of the points.
    gradients : ndarray, shape (P, 3, 3)
        Derivatives of scaled forces by scaled creepages there.
    bars : ndarray, shape (P, 3, 3)
        Error bars of these derivatives.
    """

    points: np.ndarray
    w: np.ndarray
    ratio: np.ndarray
    gradients: np.ndarray
    bars: np.ndarray

    def errors(self, table: CreepTable) -> np.ndarray:
        """Return errors of a table's gradients (>= their bars) over slopes at rest, (P, 3, 3)."""
        where = Coordinates.of(self.w.T, self.ratio, table.whole)
        points = (*self.points.T[: len(table.names)], *where.points)
        gradients = np.moveaxis(table.gradient_at(points, where), -1, 0)
        size = np.sqrt(table.slopes_at_rest(points, where.r0)).T
        errors = np.maximum(np.abs(gradients - self.gradients), self.bars)
        return errors / (size[:, :, None] * size[:, None, :])


@dataclass(frozen=True, eq=False)
class GradientBars:
    """Error bars of a table's gradients by interval of u, with statistics of their checks.

    Attributes
    ----------
    values : ndarray, shape (n_u, 3, 3)
        Error bars at rest, and within each interval of u.
    about : dict
        Number of checks, their median and largest error, the largest one at rest, and the share of
        checks within the bars.
    """

    values: np.ndarray
    about: dict[str, float]

    @classmethod
    def from_errors(
        cls,
        nodes: np.ndarray,
        u: np.ndarray,
        errors: np.ndarray,
        at_rest: np.ndarray,
        *,
        inside: float = 0.98,
        shared: float = 0.05,
    ) -> "GradientBars":
        """Return error bars that cover the share `inside` of the errors at check points.

        Each check is compared with the bars of the others. At rest contacts are solved on many
        meshes, and the bar is the largest error.

        Parameters
        ----------
        nodes : ndarray, shape (n_u,)
            Nodes along u.
        u : ndarray, shape (P,)
            Values of u of the checks; several in each interval.
        errors : ndarray, shape (P, 3, 3)
            Errors of the checks.
        at_rest : ndarray, shape (R, 3, 3)
            Errors at rest.
        inside : float
            Share of the checks within the bars: more than the required 95 of 100 new points, as
            the share scatters.
        shared : float
            Smallest bar of a derivative, over the largest of the nine.
        """
        cells, rest = cell_of(nodes, u), at_rest.max(axis=0)
        count = np.bincount(cells, minlength=len(nodes) - 1)
        sums = np.zeros((len(nodes) - 1, 3, 3))
        np.add.at(sums, cells, errors**2)
        without = (sums[cells] - errors**2) / np.maximum(count[cells] - 1, 1)[:, None, None]
        beyond = np.maximum(errors - rest, 0.0) / _spread(without, shared)
        shares = beyond.max(axis=(1, 2)) / share_of_bar(nodes, u)
        factor = max(1.0, float(np.quantile(shares, inside)))
        bars = factor * _spread(sums / np.maximum(count, 1)[:, None, None], shared)
        worst = errors.max(axis=(1, 2))
        about = {
            "gradient_checks": len(errors),
            "gradient_median": float(np.median(worst)),
            "gradient_worst": float(worst.max()),
            "gradient_at_rest": float(rest.max()),
            "gradient_inside": float(np.mean(shares <= factor)),
        }
        return cls(np.concatenate([rest[None], bars]), about)


def _spread(squares: np.ndarray, shared: float) -> np.ndarray:
    """Return square roots of mean squares (..., 3, 3), at least a share of the largest."""
    roots = np.sqrt(squares)
    return np.maximum(roots, shared * roots.max(axis=(-2, -1), keepdims=True) + 1e-12)


@dataclass(eq=False)
class TableBuilder:
    """Adaptive construction of a creep-force table: its nodes, solved contacts and errors."""

    contacts: TableContacts
    middles: dict[tuple[int, float, float], list[Point]] = field(default_factory=dict)
    check_points: list[Point] = field(default_factory=list)
    previous_seconds: float = 0.0

    def __post_init__(self) -> None:
        self.design, self.refinement = self.contacts.design, self.contacts.refinement
        design, self.began = self.design, process_time()
        self.grid, self.lead = self.contacts.grid, self.contacts.lead
        self.axes = [*design.first_nodes, *self.grid.first, np.array(self.refinement.first_u)]
        self.discrete = [design.names.index(name) for name in design.apart]
        self.random = np.random.default_rng(design.seed)
        self.anywhere = qmc.Halton(len(self.axes), rng=np.random.default_rng(design.seed))

    def build(self) -> CreepTable:
        """Refine the grid until errors are tolerated (TableError at limits); return the table."""
        while True:
            table = self.make_table([np.zeros((max(len(a) - 1, 0), 3)) for a in self.axes])
            between = self.interval_errors(table)
            wanted = NODE_SHARE * self.design.tolerance
            split = [np.flatnonzero(errors.max(axis=1, initial=0.0) > wanted) for errors in between]
            if not any(map(len, split)):
                split = self._choose_splits(table)
            if not any(map(len, split)):
                checked = self._measure_errors(between)
                if checked.about["held_out_worst"] <= self.design.tolerance:
                    return self._with_gradient_bars(checked)
                self.check_points += map(tuple, checked.about["check_points"])
                continue
            self.contacts.round += 1
            self.axes = [self._refine(k, some) for k, some in enumerate(split)]
            count = math.prod(map(len, self.axes))
            if count > self.design.most or self.contacts.round > self.refinement.rounds:
                needs = (
                    f"{count} nodes in {self.contacts.round} rounds, more than {self.design.most}"
                )
                fault = Fault(
                    "tolerance",
                    f"{self.design.tolerance:g}, which needs {needs}",
                    "a larger tolerance, more nodes (most), or fewer values of the axes",
                )
                raise TableError([fault])

    def update(self, previous: CreepTable) -> CreepTable:
        """Return a table rebuilt from the nodes of a previous one, with error bars of gradients."""
        self.axes, coefficients = list(previous.law.axes), previous.law.coefficients
        self.contacts.number = int(previous.about.get("contacts", 0))
        self.previous_seconds = float(previous.about.get("cpu_seconds", 0.0))
        by_heading_tilt_u = np.moveaxis(coefficients[..., [4, 2, 1], :], -2, -1)
        for place in np.ndindex(previous.bars.shape[:-1]):
            point = tuple(float(axis[k]) for axis, k in zip(self.axes, place, strict=True))
            if point[-1] > 0.0:
                force = coefficients[place][0]
                self.contacts.nodes[point] = Solved(
                    force, previous.bars[place], by_heading_tilt_u[place]
                )
        return self._with_gradient_bars(self.make_table(previous.between, previous.about))

    def _refine(self, axis: int, split: np.ndarray) -> np.ndarray:
        """Return the nodes of an axis with the intervals `split`, and their images, halved."""
        nodes = self.axes[axis]
        split = self.grid.alike(axis - self.lead, split, len(nodes) - 1)
        middles = 0.5 * (nodes[split] + nodes[split + 1]) if len(split) else np.empty(0)
        return np.sort(np.concatenate([nodes, middles]))

    def _measure_errors(self, between: list[np.ndarray]) -> CreepTable:
        """Return the table with errors at random points, and bars widened to cover 97 % of them."""
        table = self.make_table(between)
        count = min(self.refinement.checks, table.nodes)
        points = self.points_at_shares(self.random.random((count, len(self.axes))))
        errors_by_force = np.abs(self.errors_at(table, points))
        reported = table.error_at(list(np.array(points).T)).T
        shares, errors = (
            (errors_by_force / (reported + 1e-12)).max(axis=1),
            errors_by_force.max(axis=1),
        )
        # The error bars of 95 of 100 points, and of the contact, are sufficient.
        widening = max(1.0, float(np.quantile(shares, 0.97)))
        design = self.design
        about = {
            "title": design.title,
            "design": design.to_toml(),
            "files": json.dumps(design.files),
            "tolerance": design.tolerance,
            "rounds": self.contacts.round,
            "held_out": len(errors),
            "held_out_median": float(np.median(errors)),
            "held_out_worst": float(np.max(errors)),
            "held_out_inside": float(np.mean(shares <= widening)),
            "widened": widening,
        }
        checks = {"check_points": np.array(points), "check_errors": errors_by_force}
        checks["check_told"] = widening * reported
        return self.make_table([widening * errors for errors in between], about | checks, widening)

    def _with_gradient_bars(self, table: CreepTable) -> CreepTable:
        """Return a table with error bars of its gradients, and its cost in contacts."""
        axis, lead = self.axes[-1], self.lead
        # A place needs about as many contacts as twenty nodes: at most a tenth of the work.
        number, random = np.clip(table.nodes // 200, 4, 24), np.random.default_rng(self.design.seed)
        shares = random.random((number, len(axis) - 1, len(self.axes)))
        shares[..., :lead] = shares[:, :1, :lead]  # a point in each interval of u, at each place
        steps = np.arange(len(axis) - 1) + shares[..., -1]
        shares[..., -1] = np.interp(steps, np.arange(len(axis)), axis)
        points = self.points_at_shares(shares.reshape(-1, len(self.axes)))
        places = {point[:lead] for point in (*points, *itertools.product(*self.axes[:lead]))}
        moving = self._solve_gradients(points, table, finer=True)
        at_rest = self._solve_gradients(
            [(*place, 0.0, 0.0, 0.0) for place in sorted(places)], table
        )
        bars = GradientBars.from_errors(
            axis, moving.points[:, -1], moving.errors(table), at_rest.errors(table)
        )
        made = {
            "contacts": self.contacts.number,
            "cpu_seconds": self.previous_seconds
            + max(self.contacts.seconds, process_time() - self.began),
        }
        about = {**table.about, **bars.about, **made}
        return replace(table, about=about, gradient_bars=bars.values)

    def _solve_gradients(
        self, points: list[Point], table: CreepTable, finer: bool = False
    ) -> GradientChecks:
        """Solve gradients at points, on finer meshes if `finer`, to compare the table with."""
        lead = self.lead
        contacts = self.contacts
        jobs = [replace(contacts.job(point[:lead], point[lead:]), finer=finer) for point in points]
        contacts.solve(jobs, table.nodes)
        return GradientChecks(
            np.array(points),
            np.array([job.w for job in jobs]),
            np.array([self.design.ratio(job.place) for job in jobs]),
            np.array([contacts.solved[job].gradient for job in jobs]),
            np.array([contacts.solved[job].gradient_bar for job in jobs]),
        )

    def make_table(
        self,
        between: Sequence[np.ndarray],
        about: Mapping[str, Any] | None = None,
        widening: float = 1.0,
    ) -> CreepTable:
        """Solve nodes that are not solved yet; return the table that interpolates all nodes."""
        shape = tuple(map(len, self.axes))
        places = list(itertools.product(*map(range, shape)))
        points = [
            tuple(float(axis[k]) for axis, k in zip(self.axes, place, strict=True))
            for place in places
        ]
        nodes = self.contacts.solve_nodes(points)
        values = np.array([node.force for node in nodes]).reshape(*shape, 3)
        bars = np.array([node.bar for node in nodes]).reshape(*shape, 3)
        slopes = np.array([node.gradient for node in nodes]).reshape(*shape, 3, 3)
        # Slopes by u at full slip, from the last two nodes.
        u = self.axes[-1]
        rise = (values[..., -1, :] - values[..., -2, :]) / (u[-1] - u[-2])
        slopes[..., -1, :, 2] = 2.0 * rise - slopes[..., -2, :, 2]
        derivatives = coefficients(self.axes, values, slopes, self.grid.full_range, self.discrete)
        design = self.design
        return CreepTable(
            Hermite(tuple(self.axes), derivatives),
            design.names,
            widening * bars,
            tuple(between),
            about or {},
            design.apart,
            self.grid.full_range,
            design.contact,
        )

    def points_at_shares(self, shares: np.ndarray) -> list[Point]:
        """Return points at shares (0 to 1) of each axis; of a discrete axis at a node."""
        return [
            tuple(
                float(axis[int(share * len(axis))] if k in self.discrete
                      else axis[0] + share * (axis[-1] - axis[0]))
                for k, (axis, share) in enumerate(zip(self.axes, point, strict=True))
            )
            for point in shares
        ]  # fmt: skip

    def errors_at(self, table: CreepTable, points: list[Point]) -> np.ndarray:
        """Solve contacts at points; return the table's forces minus the solved ones, (P, 3)."""
        exact = self.contacts.forces(points, table.nodes)
        return table.law(list(np.array(points).T)).T - exact

    def interval_errors(self, table: CreepTable) -> list[np.ndarray]:
        """Return the largest errors (intervals, 3) at points in mid-interval, one array an axis.

        The points of an interval do not change between rounds: among new ones some would be worse.
        """
        largest, points, where = [], [], []
        for k, nodes in enumerate(self.axes):
            largest.append(np.zeros((max(len(nodes) - 1, 0), 3)))
            if k in self.discrete:
                continue
            for cell, (low, high) in enumerate(itertools.pairwise(map(float, nodes))):
                if (k, low, high) not in self.middles:
                    middle = 0.5 * (low + high)
                    self.middles[k, low, high] = [
                        self._random_point(k, middle) for _ in range(self.refinement.samples)
                    ]
                points += self.middles[k, low, high]
                where += self.refinement.samples * [(k, cell)]
        for (k, cell), error in zip(where, np.abs(self.errors_at(table, points)), strict=True):
            largest[k][cell] = np.maximum(largest[k][cell], error)
        for k, errors in enumerate(largest):
            for interval in range(len(errors)):
                alike = self.grid.alike(k - self.lead, np.array([interval]), len(errors))
                errors[alike] = errors[alike].max(axis=0)
        return largest

    def _random_point(self, axis: int, x: float) -> Point:
        """Return a random node with its coordinate along one axis replaced by x."""
        at = [float(self.random.choice(nodes)) for nodes in self.axes]
        if axis != len(self.axes) - 1:  # neither at rest nor in full slip
            at[-1] = float(self.random.choice(self.axes[-1][1:-1]))
        return (*at[:axis], x, *at[axis + 1 :])

    def _choose_splits(self, table: CreepTable) -> list[np.ndarray]:
        """Return the intervals to divide along each axis, by errors at random points.

        These are the check points so far. If their errors are small, as many new ones follow, from
        the sequence of Halton, which leaves no gap in several dimensions. At a point anywhere the
        axis with the largest error is divided, over the share of nodes that are added; the other
        coordinates are taken from the nearest node.
        """
        split: list[set[int]] = [set() for _ in self.axes]
        missed = self._find_missed(table)
        if not missed:
            number = min(self.refinement.anywhere, table.nodes)
            self.check_points += self.points_at_shares(self.anywhere.random(number))
            missed = self._find_missed(table)
        if not missed:
            return [np.empty(0, int) for _ in split]
        free = [k for k, axis in enumerate(self.axes) if len(axis) > 1 and k not in self.discrete]
        probes: list[Point] = []
        for point in missed:
            node = [float(axis[np.abs(axis - x).argmin()])
                    for axis, x in zip(self.axes, point, strict=True)]  # fmt: skip
            node[-1] = min(max(node[-1], self.axes[-1][1]), self.axes[-1][-2])
            probes += [(*node[:k], point[k], *node[k + 1 :]) for k in free]
        along = np.abs(self.errors_at(table, probes)).max(axis=1).reshape(len(missed), len(free))
        for point, seen in zip(missed, along, strict=True):
            # The interval of each axis that contains the point, and its images.
            cells = [
                self.grid.alike(k - self.lead, cell_of(axis, np.array([point[k]])), len(axis) - 1)
                for k, axis in ((k, self.axes[k]) for k in free)
            ]
            planes = [len(some) / len(self.axes[k]) for k, some in zip(free, cells, strict=True)]
            worst = int((seen / planes).argmax())
            split[free[worst]].update(cells[worst].tolist())
        return [np.array(sorted(some), int) for some in split]

    def _find_missed(self, table: CreepTable) -> list[Point]:
        """Return random check points at which the errors of a table are too large."""
        if not self.check_points:
            return []
        errors = np.abs(self.errors_at(table, self.check_points)).max(axis=1)
        bound = max(
            self.refinement.miss * self.design.tolerance, self.refinement.worst * errors.max()
        )
        return [
            point for point, error in zip(self.check_points, errors, strict=True) if error > bound
        ]
