"""The best design: values of free keys of a scene with the least or largest result within limits.

Free keys are searched in coordinates from 0 to 1 between their bounds, of the logarithm if both
bounds are positive. Each step minimises a model of all outcomes within a reach (convex
approximation: C. Fleury, Struct. Optim. 1 (1989) 81-89), by sequential quadratic programming
(D. Kraft, DFVLR-FB 88-28 (1988)). Derivatives are exact where `State.jacobian` has them, else
differences that are computed together.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property, partial
from itertools import chain
from os import PathLike
from typing import Any, ClassVar, Literal

import numpy as np

from tractive_sam.fitting.case import Evaluations, on_finer_mesh
from tractive_sam.fitting.design import Names, QuestionDocument, changes_of, start_of
from tractive_sam.fitting.response import (
    Outcome,
    Progress,
    QuestionResult,
    Response,
    check_observed,
    label_of,
    name_with_unit,
    open_question,
    outcome_faults,
    read_outcome,
    run_question,
)
from tractive_sam.plot import Drawing, design_search, pareto_front
from tractive_sam.scene import Scene
from tractive_sam.schema import (
    Check,
    Fault,
    NotNegative,
    Real,
    SceneError,
    Table,
    ValidEntries,
    entry,
    exactly_one,
    optional,
    shorten,
)


class DesignError(SceneError):
    """Error of a design that cannot be computed; lists every fault that was found.

    Examples
    --------
    >>> try:
    ...     ts.OptimumDesign(design={"scene": "spheres", "minimise": "p_max", "free": []})
    ... except ts.DesignError as error:
    ...     print(error.faults[0].key)
    design.free
    """

    subject: ClassVar[str] = "design"


def _check_free(entries: ValidEntries) -> Iterator[Fault]:
    """Yield a fault of bounds of a free key that do not rise."""
    if not entries["lower"] < entries["upper"]:
        yield Fault("upper", f"{entries['upper']:g}", f"above lower, {entries['lower']:g}")


class FreeKey(Table):
    """A [[design.free]] table: a free key with its bounds."""

    key: str = entry("the free entry of the scene", "a dotted key")
    lower: Real = entry("lower bound")
    upper: Real = entry("upper bound")
    start: Real | None = optional("first value; by default the value in the scene")
    checks: ClassVar[tuple[Check, ...]] = (_check_free,)


class Limit(Table):
    """A [[design.limit]] table: a bound on a number of a record."""

    observe: str = entry("column of a record", 'a column, of a body as "worn_mass A"')
    at: Real | None = optional("revolution or distance of the record; by default the last one")
    at_most: Real | None = optional("largest allowed value")
    at_least: Real | None = optional("smallest allowed value")
    checks: ClassVar[tuple[Check, ...]] = (exactly_one("at_most", "at_least"), check_observed)

    @property
    def sign(self) -> float:
        """Sign of a rise of the outcome that the limit allows less: 1 for at_most."""
        return 1.0 if self.at_least is None else -1.0

    @property
    def bound(self) -> float:
        """The stated value."""
        return float(self.at_most if self.at_least is None else self.at_least)  # type: ignore[arg-type]

    @property
    def outcome(self) -> Outcome:
        """The limited number."""
        return read_outcome(self.observe, self.at)

    def __str__(self) -> str:
        text = "at most" if self.at_least is None else "at least"
        return f"{self.outcome} {text} {self.bound:g}"


class Target(Table):
    """The table ``target``: a value that a number of a record is to have."""

    observe: str = entry("column of a record", 'a column, of a body as "worn_mass A"')
    value: Real = entry("the wanted value")
    checks: ClassVar[tuple[Check, ...]] = (check_observed,)


def _check_aims(entries: ValidEntries) -> Iterator[Fault]:
    """Yield faults of aims and limits, of free keys, and of a scene whose mesh is not fixed."""
    aims, target = [*entries["minimise"], *entries["maximise"]], entries["target"]
    if len(aims) > 2 or bool(target) == bool(aims):
        allowed = "one of minimise, maximise and target, or two aims of the first two"
        yield Fault("minimise", shorten(aims) if aims else "no aim", allowed)
    for fault in chain.from_iterable(map(outcome_faults, aims)):
        yield Fault("minimise", fault.given, fault.allowed)
    keys = [one.key for one in entries["free"]]
    scenes = (entries["scene"], *entries["further"])
    for k, one in enumerate(entries["free"]):
        if keys.count(one.key) > 1:
            yield Fault(f"free[{k}].key", f"{one.key} {keys.count(one.key)} times", "each key once")
        try:
            value = start_of(entries["scene"], one.key, one.start)
            for scene in entries["further"]:
                start_of(scene, one.key, value)
        except SceneError as error:
            yield from (Fault(f"free[{k}].key", f"{one.key}: {f.given}", f.allowed)
                        for f in error.faults)  # fmt: skip
            continue
        if one.lower < one.upper and not one.lower <= value <= one.upper:
            allowed = f"a scene with {one.lower:g} to {one.upper:g}, or start"
            yield Fault(f"free[{k}].start", f"{value:g} in the scene", allowed)
    if entries["weights"] and len(entries["weights"]) != len(scenes):
        yield Fault("weights", shorten(entries["weights"]), f"{len(scenes)}, one of each scene")
    if any(scene.accuracy is not None for scene in scenes):
        cure = "a [grid] or none: all designs have the same number of elements"
        yield Fault("scene.accuracy", "a table", cure)


class Design(Table):
    """The [design] table: scene, free keys, aims, limits, and settings of the search."""

    title: str = entry("title", default="")
    scene: Scene = entry(
        "the scene, or a list of scenes, whose limits all of them keep",
        "a built-in name, a scene file, or the tables of a scene",
    )
    further: tuple[Scene, ...] = entry("scenes after the first one", "a list of scenes", ())
    weights: tuple[NotNegative, ...] = entry(
        "weights of the scenes in the sum of an aim; by default their mean", "a list of numbers", ()
    )
    free: tuple[FreeKey, ...] = entry("the free keys", "at least one table", min_length=1)
    minimise: Names = entry("columns of a record to minimise", "a name, or two", ())
    maximise: Names = entry("columns of a record to maximise", "a name, or two", ())
    target: Target | None = optional("number that is to have a value")
    at: Real | None = optional("revolution or distance of the aims; by default the last record")
    limit: tuple[Limit, ...] = entry("limits", "a list of tables", ())
    search: Literal["local", "global"] = entry(
        "local: from the start; global: differential evolution before, for few keys",
        default="local",
    )
    starts: int = entry(
        "starts of the search; further ones are spread evenly", default=1, ge=1, le=100
    )
    seed: int = entry("seed of further starts", "an integer from 0", 0, ge=0)
    iterations: int = entry("most iterations of a search", default=30, ge=1, le=1000)
    tolerance: float = entry("relative change of the aim that ends it", default=1e-3, gt=0, le=0.1)
    step: float = entry("step of differences, over the range of a key", default=0.01, gt=0, le=0.2)
    front: int = entry("points of the front of two aims", default=7, ge=3, le=100)
    mesh_check: bool = entry("whether start and optimum are computed on a finer mesh", default=True)
    checks: ClassVar[tuple[Check, ...]] = (_check_aims,)


class OptimumDesign(QuestionDocument):
    """A design file: the table [design] with free keys, aims and limits.

    Raises
    ------
    DesignError
        With every fault.

    Examples
    --------
    >>> free = [{"key": "body.A.radius_x", "lower": 100.0, "upper": 500.0}]
    >>> table = {"scene": "spheres", "minimise": "p_max", "free": free}
    >>> ts.OptimumDesign(design=table).design.search
    'local'
    """

    design: Design = entry("the design")
    several: ClassVar[bool] = True
    error_class: ClassVar[type[SceneError]] = DesignError


@dataclass(frozen=True, eq=False)
class Sum:
    """Weighted sum of outcomes that is an aim or has a limit.

    Attributes
    ----------
    weights : ndarray, shape (m,)
        Weights of the outcomes.
    sign : float
        1 if a fall is better, or -1.
    goal : float, optional
        The wanted value of an aim, or a limit.
    name : str
        Name of the outcome.
    """

    weights: np.ndarray
    sign: float = 1.0
    goal: float | None = None
    name: str = ""

    def total(self, outcomes: np.ndarray) -> Any:
        """Return the sum for outcomes of shape (..., m)."""
        return outcomes @ self.weights


class Aim(Sum):
    """Sum to minimise: sign * weights . outcomes, or the square of its distance from a goal."""

    def value(self, outcomes: np.ndarray) -> float:
        """Return the number that is minimised."""
        y = float(self.total(outcomes))
        return self.sign * y if self.goal is None else (y - self.goal) ** 2

    def slope(self, outcomes: np.ndarray) -> np.ndarray:
        """Return its derivatives by the outcomes."""
        change = self.sign if self.goal is None else 2.0 * (self.total(outcomes) - self.goal)
        return self.weights * change


class Bound(Sum):
    """Limit of a sum of outcomes: sign * (goal - weights . outcomes) >= 0."""

    def margin(self, outcomes: np.ndarray) -> float:
        """Return how far the sum is from its limit, over the limit; negative beyond it."""
        return self.sign * float((self.goal or 0.0) - self.total(outcomes)) / self.size

    @property
    def size(self) -> float:
        """Scale of the limit."""
        return abs(self.goal or 1.0)


def find_merit(
    aim: Aim, bounds: list[Bound], outcomes: np.ndarray, *, scale: float, price: float
) -> float:
    """Return the aim over a scale, plus a price times what is beyond the limits; inf if unknown."""
    beyond = sum(max(-one.margin(outcomes), 0.0) for one in bounds)
    value = aim.value(outcomes) / scale + price * beyond
    return value if math.isfinite(value) else math.inf


@dataclass(eq=False)
class Search:
    """Search in coordinates v, from 0 to 1 between the bounds of the keys.

    Attributes
    ----------
    table : Design
        The [design] table.
    response : Response
        Outcomes as functions of the keys.
    trace : dict of bytes to (ndarray, ndarray)
        Coordinates and outcomes of all points of the searches, in their order.
    failures : list of str
        Why points could not be computed.
    """

    table: Design
    response: Response
    trace: dict[bytes, tuple[np.ndarray, np.ndarray]] = field(default_factory=dict)
    failures: list[str] = field(default_factory=list)

    @cached_property
    def limits(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Lower and upper bounds of the keys, and whether their logarithm is searched."""
        lower, upper = np.array([(one.lower, one.upper) for one in self.table.free]).T
        return lower, upper, lower > 0.0

    def point(self, v: np.ndarray) -> np.ndarray:
        """Return the values of the keys at coordinates."""
        lower, upper, log = self.limits
        ratio = np.divide(upper, lower, out=np.ones_like(upper), where=log)
        return np.where(log, np.abs(lower) * ratio**v, lower + (upper - lower) * v)

    def coordinates(self, point: np.ndarray) -> np.ndarray:
        """Return the coordinates of values of the keys."""
        lower, upper, log = self.limits
        ratio = np.log(np.divide(point, lower, out=np.ones_like(point), where=log))
        width = np.log(np.divide(upper, lower, out=np.full_like(upper, math.e), where=log))
        return np.where(log, ratio / width, (point - lower) / (upper - lower))

    def outcomes(self, v: np.ndarray) -> np.ndarray:
        """Return the outcomes at coordinates (n, d), shape (n, m); nan where they fail."""
        v = np.clip(v, 0.0, 1.0).round(12)
        values, messages = self.response.evaluate(np.array([self.point(one) for one in v]))
        self.failures += [text for text in messages if text]
        return values

    def at(self, v: np.ndarray) -> np.ndarray:
        """Return the outcomes at one point, which the trace lists."""
        v = np.clip(v, 0.0, 1.0).round(12)
        if v.tobytes() not in self.trace:
            self.trace[v.tobytes()] = v, self.outcomes(v[None])[0]
        return self.trace[v.tobytes()][1]

    def slopes(self, v: np.ndarray) -> np.ndarray:
        """Return derivatives of the outcomes by the coordinates, shape (m, d)."""
        v = np.clip(v, 0.0, 1.0)
        step = np.where(v + self.table.step <= 1.0, self.table.step, -self.table.step)
        rates = (self.point(v + 1e-6) - self.point(v - 1e-6)) / 2e-6
        slopes = self.response.exact_slopes(self.point(v)) * rates
        missing = np.flatnonzero(~np.isfinite(slopes).all(axis=0))
        moved = v + np.diag(step)[missing]
        values = self.outcomes(np.concatenate([v[None], moved]))
        slopes[:, missing] = (values[1:] - values[0]).T / step[missing]
        return np.nan_to_num(slopes)  # a point that fails has no slope

    def minimise(
        self, aim: Aim, bounds: list[Bound], v: np.ndarray, price: float = 20.0
    ) -> tuple[np.ndarray, bool]:
        """Return the coordinates of a local minimum within bounds, and whether it converged.

        A model gives the next point within a reach, which shrinks if the point is no better. The
        merit is the aim over its first value, plus `price` times what is beyond the limits: one
        per cent beyond a limit is worse than a loss of `price` per cent.
        """
        y, reach = self.at(v), 0.5
        scale = abs(aim.value(y)) or 1.0
        merit = partial(find_merit, aim, bounds, scale=scale, price=price)
        slopes = self.slopes(v)
        for _ in range(self.table.iterations):
            new = self._next(aim, bounds, v, y, slopes, (reach, scale, price))
            trial = self.at(new)
            step, gain = float(np.abs(new - v).max()), merit(y) - merit(trial)
            if gain <= 0.0:
                reach = 0.3 * step
                if step < self.table.tolerance:
                    return v, True
                continue
            v, y, reach = new, trial, min(0.5, max(reach, 2.0 * step))
            if gain <= self.table.tolerance * abs(merit(y)):
                return v, True
            slopes = self.slopes(v)
        return v, False

    def _next(
        self, aim: Aim, bounds: list[Bound], v: np.ndarray, y: np.ndarray, slopes: np.ndarray,
        size: tuple[float, float, float],
    ) -> np.ndarray:  # fmt: skip
        """Return the minimum of a model within a reach: outcomes are exponentials, zeros linear.

        Powers of loads, radii and coefficients are exact in it. A slack variable, which costs its
        price, keeps it solvable where the limits cannot be met.
        """
        from scipy.optimize import minimize  # noqa: PLC0415 - opening results needs no search

        reach, scale, price = size
        rates = slopes / np.where(y, y, 1.0)[:, None]

        def model(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            factor = np.where(y, np.exp(np.clip(rates @ x[:-1], -3.0, 3.0)), 1.0)
            return np.where(y, y * factor, slopes @ x[:-1]), slopes * factor[:, None]

        def cost(x: np.ndarray) -> tuple[float, np.ndarray]:
            outcomes, by_v = model(x)
            slope = aim.slope(outcomes) @ by_v / scale
            return aim.value(outcomes) / scale + price * x[-1], np.append(slope, price)

        def margins(x: np.ndarray) -> list[float]:
            return [one.margin(model(x)[0]) + x[-1] for one in bounds]

        def margin_slopes(x: np.ndarray) -> np.ndarray:
            return np.array([np.append(-one.sign * one.weights @ model(x)[1] / one.size, 1.0)
                             for one in bounds])  # fmt: skip

        slack = max([0.0, *(-one.margin(y) for one in bounds)])
        ranges = [(max(-reach, -a), min(reach, 1.0 - a)) for a in v]
        found = minimize(
            cost, np.append(0.0 * v, slack), jac=True, method="SLSQP",
            bounds=[*ranges, (0.0, None)],
            constraints=[{"type": "ineq", "fun": margins, "jac": margin_slopes}] if bounds else [],
            options={"maxiter": 200, "ftol": 1e-10},
        )  # fmt: skip
        return np.clip(v + found.x[:-1], 0.0, 1.0)

    def explore(self, aim: Aim, bounds: list[Bound], scale: float) -> np.ndarray:
        """Return the best point of differential evolution, whose generations are computed at once.

        The aim is of the size of `scale`; limits are penalties. R. Storn and K. Price, J. Global
        Optim. 11 (1997) 341-359.
        """
        from scipy.optimize import differential_evolution  # noqa: PLC0415 - as above

        def cost(v: np.ndarray) -> np.ndarray:
            outcomes = self.outcomes(np.atleast_2d(v.T))
            return np.array([min(merit(one), 1e9) for one in outcomes])

        merit = partial(find_merit, aim, bounds, scale=scale, price=1e3)
        d = len(self.table.free)
        found = differential_evolution(
            cost, [(0.0, 1.0)] * d, rng=np.random.default_rng(self.table.seed), vectorized=True,
            updating="deferred", polish=False, popsize=8, maxiter=self.table.iterations, tol=1e-2,
        )  # fmt: skip
        return np.asarray(found.x)

    def multipliers(
        self, aim: Aim, bounds: list[Bound], v: np.ndarray, near: float = 1e-3
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return relative multipliers of limits, and of the bounds of the keys.

        They are the non-negative factors with which the gradients of active limits add up to that
        of the aim; a multiplier of 0.8 means that 1 % more of a limit gains .8 % of the aim.
        """
        from scipy.optimize import nnls  # noqa: PLC0415 - as above

        outcomes, slopes = self.at(v), self.slopes(v)
        size = abs(aim.value(outcomes)) or 1.0
        gradient = aim.slope(outcomes) @ slopes / size
        of_limits, of_keys = np.zeros(len(bounds)), np.zeros(v.size)
        active = [k for k, one in enumerate(bounds) if one.margin(outcomes) < 10.0 * near]
        ends = [k for k in range(v.size) if not near < v[k] < 1.0 - near]
        columns = [-bounds[k].sign * bounds[k].weights @ slopes / bounds[k].size for k in active]
        columns += [np.eye(v.size)[k] * (1.0 if v[k] < 0.5 else -1.0) for k in ends]
        if columns:
            factors, _ = nnls(np.array(columns).T, gradient)
            of_limits[active] = factors[: len(active)]
            rates = (self.point(v + 1e-6) - self.point(v - 1e-6)) / 2e-6
            width = np.abs(rates / np.where(self.point(v), self.point(v), 1.0))
            of_keys[ends] = factors[len(active) :] / width[ends]
        return of_limits, of_keys


def design(
    design: OptimumDesign | Mapping[str, Any] | str | PathLike[str],
    path: str | PathLike[str] | None = None,
    *,
    workers: int = 0,
    scheduler: str | None = None,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> OptimumResult:
    """Find the values of free keys with the least or largest result of a scene within limits.

    Parameters
    ----------
    design : OptimumDesign, mapping or path-like
        A design file, or its tables.
    path : path-like, optional
        The result (netCDF), to which computations are streamed: an interrupted search resumes from
        those in the file.
    workers : int
        Processes on this machine; 0: this one. They compute the differences of one step.
    scheduler : str, optional
        Address of a scheduler of dask.distributed, whose workers compute instead.
    overwrite : bool
        Whether to replace a file that holds the design of another scene.
    progress : callable, optional
        Called after each computation.

    Returns
    -------
    OptimumResult
        The optimum, its active limits, gain and error of the mesh; the front of two aims.

    Raises
    ------
    DesignError
        With every fault of the design, or if the start cannot be computed.
    ResultsError
        If the file is no design, or one of another scene.

    Examples
    --------
    >>> coarse = ts.Scene.builtin("spheres").with_set(["grid.elements=[15, 15]"])
    >>> free = [{"key": "load.normal", "lower": 0.3, "upper": 0.5}]
    >>> table = {"scene": coarse, "minimise": "p_max", "free": free, "mesh_check": False}
    >>> ts.design(table).values
    {'load.normal': 0.3}
    """
    return run_question(
        OptimumResult, OptimumDesign.read(design), path, _answer,
        workers=workers, scheduler=scheduler, overwrite=overwrite, progress=progress,
    )  # fmt: skip


def prepare_search(
    table: Design, done: Evaluations
) -> tuple[Search, list[Aim], list[Bound], np.ndarray]:
    """Return search, aims, limits, and the coordinates of the start."""
    aims: list[tuple[str, float, float | None]] = [(name, 1.0, None) for name in table.minimise]
    aims += [(name, -1.0, None) for name in table.maximise]
    aims += [(one.observe, 1.0, one.value) for one in (table.target,) if one]
    of_aims = [read_outcome(name, table.at) for name, *_ in aims]
    of_limits = [one.outcome for one in table.limit]
    outcomes = [*{str(one): one for one in (*of_aims, *of_limits)}.values()]
    start = np.array([start_of(table.scene, one.key, one.start) for one in table.free])
    keys, scenes = [one.key for one in table.free], (table.scene, *table.further)
    try:
        response = Response.prepare(scenes, keys, start, outcomes, done)
    except SceneError as error:
        raise DesignError(fault.under("design") for fault in error.faults) from None
    # Rows: the outcome of each scene, of the first scene first.
    place = np.array([[str(one) == str(other) for other in outcomes]
                      for one in (*of_aims, *of_limits)], float)  # fmt: skip
    weights = np.array(table.weights or [1.0 / len(scenes)] * len(scenes))
    mark = ", weighted" * (len(scenes) > 1)
    goals = [Aim(np.kron(weights, row), sign, goal, str(one) + mark)
             for row, one, (_, sign, goal) in zip(place, of_aims, aims, strict=False)]  # fmt: skip
    bounds = [
        Bound(np.kron(of_scene, row), one.sign, one.bound,
              f"{one} in scene {n + 1}" if mark else str(one))
        for n, of_scene in enumerate(np.eye(len(scenes)))
        for row, one in zip(place[len(aims) :], table.limit, strict=True)
    ]  # fmt: skip
    search = Search(table, response)
    return search, goals, bounds, search.coordinates(start)


def _answer(document: OptimumDesign, done: Evaluations) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return variables and attributes of the result of a design."""
    table = document.design
    search, aims, bounds, start = prepare_search(table, done)
    before = search.at(start)
    if not np.isfinite(before).all():
        cure = "a start at which the scene can be computed"
        raise DesignError([Fault("design.free", f"the start: {search.failures[-1]}", cure)])
    found = _search_from_starts(search, aims[0], bounds, start)
    best, converged = found[0]
    front = _front(search, aims, bounds, best) if len(aims) > 1 else np.empty((0, start.size))
    after = search.at(best)
    of_limits, of_keys = search.multipliers(aims[0], bounds, best)
    finer = np.full((2, before.size), math.nan)
    if table.mesh_check:
        response = search.response.on_mesh(on_finer_mesh, search.point(start))
        finer = response.evaluate(np.stack([search.point(start), search.point(best)]))[0]
    margins = np.array([one.margin(after) for one in bounds])
    notes = [*_describe_gain(aims[0], before, after, finer)]
    notes += _describe_limits(table, aims[0], bounds, margins, of_limits, of_keys, best)
    others = [v for v, _ in found[1:] if np.abs(v - best).max() > 0.02]
    if others:
        texts = (f"{search.response.keys[k]} = {x:.4g}" for v in others[:1]
                 for k, x in enumerate(search.point(v)))  # fmt: skip
        notes.append(f"{len(others)} further optima: {', '.join(texts)}, see further_optima")
    if search.failures:
        notes.append(f"{len(search.failures)} points could not be computed: {search.failures[0]}")

    def values(coordinates: Iterable[np.ndarray]) -> np.ndarray:
        return np.reshape([search.point(v) for v in coordinates], (-1, start.size))

    points, courses = zip(*search.trace.values(), strict=True)
    outcomes = np.reshape([search.at(v) for v in front], (-1, before.size))
    variables = {
        "input": [*search.response.keys],
        "start": search.point(start),
        "value": search.point(best),
        "lower": search.limits[0],
        "upper": search.limits[1],
        "key_multiplier": of_keys,
        "outcome": [*search.response.names],
        "aim": [one.name for one in aims],
        "before": before,
        "after": after,
        "finer": finer,
        "margin": margins,
        "multiplier": of_limits,
        "search": values(points),
        "search_outcome": np.array(courses),
        "further_optima": values(others),
        "front": values(front),
        "front_outcome": outcomes,
        "front_aim": np.stack([one.total(outcomes) for one in aims], axis=-1),
        "notes": notes,
    }
    return variables, {"status": "limits not met" if min(margins, default=0.0) < -0.01
                       else "done" if converged else "not converged",
                       "message": f"{len(search.trace)} points"}  # fmt: skip


def _search_from_starts(
    search: Search, aim: Aim, bounds: list[Bound], start: np.ndarray
) -> list[tuple[np.ndarray, bool]]:
    """Return (coordinates, converged) of the minima from all starts, the best one first."""
    from scipy.stats import qmc  # noqa: PLC0415 - half a second, which reading need not wait for

    table, starts = search.table, [start]
    if table.search == "global":
        starts.append(search.explore(aim, bounds, abs(aim.value(search.at(start))) or 1.0))
    if table.starts > 1:
        points = qmc.Halton(start.size, rng=np.random.default_rng(table.seed))
        starts += [*points.random(table.starts - 1)]
    known = [v for v in starts if np.isfinite(search.at(v)).all()]
    found = [search.minimise(aim, bounds, v) for v in known]
    scale = abs(aim.value(search.at(start))) or 1.0
    return sorted(found, key=lambda one: find_merit(aim, bounds, search.at(one[0]), scale=scale,
                                                    price=1e3))  # fmt: skip


def _front(search: Search, aims: list[Aim], bounds: list[Bound], best: np.ndarray) -> np.ndarray:
    """Return coordinates of the front of two aims, from the best of the first to the second.

    Between the ends, the first aim is minimal with the second one below equal steps; each search
    begins at the point before.
    """
    first, second = aims
    other, _ = search.minimise(second, bounds, best)
    first_end, last_end = (second.value(search.at(v)) for v in (best, other))
    points = [best]
    for level in np.linspace(first_end, last_end, search.table.front)[1:-1].tolist():
        more = Bound(second.weights, second.sign, second.sign * level)
        points.append(search.minimise(first, [*bounds, more], points[-1])[0])
    return np.array([*points, other])


def _describe_gain(
    aim: Aim, before: np.ndarray, after: np.ndarray, finer: np.ndarray
) -> Iterator[str]:
    """Yield the gain of the optimum beside the error of the mesh."""
    old, gain = aim.total(before), aim.total(after - before)
    share = f" ({gain / abs(old):+.2%})" if old else ""
    yield f"{aim.name} changes from {old:.4g} to {old + gain:.4g}{share}"
    change = float(np.diff(aim.total(finer))[0])
    if math.isfinite(change):
        verdict = "is larger than" if abs(gain / 2.0) > abs(change - gain) else "hardly exceeds"
        yield f"this gain {verdict} the error of the mesh: on a finer mesh, it is {change:.3g}"


def _describe_limits(
    table: Design,
    goal: Aim,
    bounds: list[Bound],
    margins: np.ndarray,
    of_limits: np.ndarray,
    of_keys: np.ndarray,
    best: np.ndarray,
) -> Iterator[str]:
    """Yield which limits and bounds are active or not met, and what they cost."""
    aim = f"the squared distance of {goal.name} from its target" if table.target else goal.name
    sign = int(goal.sign)
    for limit, margin, factor in zip(bounds, margins, of_limits, strict=True):
        if margin < -0.01:
            yield f"the limit {limit.name} is not met: it is exceeded by {-margin:.1%}"
        elif margin < 0.01:
            change = -sign * limit.sign * factor * math.copysign(1.0, limit.goal or 0.0)
            cost = f"1 % more of it would change {aim} by {change:+.2g} %"
            yield f"the limit {limit.name} is active; {cost}"
    for one, v, factor in zip(table.free, best, of_keys, strict=True):
        if factor > 0.0 and (margins >= -0.01).all():
            end, more = ("upper", 1) if v > 0.5 else ("lower", -1)
            bound = one.upper if v > 0.5 else one.lower
            change = -sign * more * factor * math.copysign(1.0, bound)
            cost = f"1 % more of it would change {aim} by {change:+.2g} %"
            yield f"{one.key} is at its {end} bound, {bound:g}; {cost}"


@dataclass(frozen=True, eq=False, repr=False)
class OptimumResult(QuestionResult):
    """Result of a design: the optimum with active limits, its gain, and the front of two aims.

    Attributes
    ----------
    dataset : "xarray.Dataset"
        All numbers: keys over ``input``, outcomes over ``outcome``, the search over ``step``, the
        front over ``point``; the answers of all computations.

    Examples
    --------
    >>> coarse = ts.Scene.builtin("spheres").with_set(["grid.elements=[15, 15]"])
    >>> free = [{"key": "load.normal", "lower": 0.3, "upper": 0.5}]
    >>> table = {"scene": coarse, "minimise": "p_max", "free": free, "mesh_check": False}
    >>> found = ts.design(table, "light.nc")
    >>> found.status, found.scene.load.normal
    ('done', 0.3)
    """

    document = OptimumDesign
    variables: ClassVar[Mapping[str, tuple[str, str, str]]] = {
        "input": ("input", "", "free keys"),
        "start": ("input", "1", "first values"),
        "value": ("input", "1", "values of the optimum"),
        "lower": ("input", "1", "lower bounds"),
        "upper": ("input", "1", "upper bounds"),
        "key_multiplier": ("input", "1", "gain by the bound of a key, relative"),
        "outcome": ("outcome", "", "outcomes"),
        "aim": ("aim", "", "aims"),
        "before": ("outcome", "1", "outcomes at the start"),
        "after": ("outcome", "1", "outcomes at the optimum"),
        "finer": ("end outcome", "1", "outcomes of both on a finer mesh"),
        "margin": ("limit", "1", "distance from a limit, relative"),
        "multiplier": ("limit", "1", "gain by a limit, relative"),
        "search": ("step input", "1", "keys of the search"),
        "search_outcome": ("step outcome", "1", "outcomes of the search"),
        "further_optima": ("optimum input", "1", "keys of further optima"),
        "front": ("point input", "1", "keys of the front"),
        "front_outcome": ("point outcome", "1", "outcomes of the front"),
        "front_aim": ("point aim", "1", "aims of the front"),
        "notes": ("note", "", "notes"),
    }

    @property
    def values(self) -> dict[str, float]:
        """Values of the free keys at the optimum."""
        values = map(float, self.numbers("value"))
        return {key: float(f"{x:.6g}") for key, x in zip(self.keys, values, strict=True)}

    @property
    def scenes(self) -> tuple[Scene, ...]:
        """The scenes of the optimum, with values of six digits."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return tuple(one.replace(**changes_of(one, self.values)) for one in self.design.scenes)

    @property
    def scene(self) -> Scene:
        """The first scene of the optimum."""
        return self.scenes[0]

    def tables(self) -> dict[str, list[dict[str, str]]]:
        """Return tables of keys, outcomes and front as rows of text."""
        names, outcomes = ("start", "value", "lower", "upper"), self.texts("outcome")
        keys = [{"key": key} | {name: f"{self.numbers(name)[k]:.6g}" for name in names}
                for k, key in enumerate(self.keys)]  # fmt: skip
        ends = zip(self.numbers("before"), self.numbers("after"), strict=True)
        scene = self.design.scenes[0]
        rows = [{"outcome": name_with_unit(one, scene), "start": f"{x:.5g}", "optimum": f"{y:.5g}"}
                for one, (x, y) in zip(outcomes, ends, strict=True)]  # fmt: skip
        pairs = zip(self.numbers("front"), self.numbers("front_outcome"), strict=True)
        front = [dict(zip((*outcomes, *self.keys), (f"{x:.5g}" for x in (*y, *point)), strict=True))
                 for point, y in pairs]  # fmt: skip
        return {"Free keys": keys, "Outcomes": rows} | ({"Front": front} if front else {})

    def drawings(self) -> Iterator[Drawing]:
        """Yield the history of the search, and the front of two aims."""
        outcomes, table = self.texts("outcome"), self.design.design
        label = partial(label_of, scene=table.scene)
        bounds = {label(name): one.bound for one in table.limit for name in outcomes
                  if name.partition(", scene")[0] == str(one.outcome)}  # fmt: skip
        by_label = dict(zip(map(label, outcomes), self.numbers("search_outcome").T, strict=True))
        draw = partial(design_search, by_label, bounds, title=self.title)
        yield Drawing("search", "Outcomes of the search, with their limits.", draw)
        if len(front := self.numbers("front_aim")):
            two = dict(zip(map(label, self.texts("aim")), front.T, strict=True))
            caption = "Designs that are best in one of both aims for a given value of the other."
            yield Drawing("front", caption, partial(pareto_front, two, title=self.title))


def open_design(path: str | PathLike[str]) -> OptimumResult:
    """Return the result of a design from its file, also of an interrupted one.

    Raises
    ------
    ResultsError
        If the file does not exist, is damaged, or no design.

    Examples
    --------
    >>> coarse = ts.Scene.builtin("spheres").with_set(["grid.elements=[15, 15]"])
    >>> free = [{"key": "load.normal", "lower": 0.3, "upper": 0.5}]
    >>> table = {"scene": coarse, "minimise": "p_max", "free": free, "mesh_check": False}
    >>> found = ts.design(table, "light.nc")
    >>> ts.open_design("light.nc").values == found.values
    True
    """
    return open_question(path, OptimumResult)
