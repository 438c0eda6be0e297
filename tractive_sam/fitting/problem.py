"""Predictions of all data sets with derivatives at values of the parameters, and their losses."""

import math
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import Any

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.stats import chi2 as chi2_distribution

from tractive_sam.fitting.case import (
    Evaluations,
    FitCase,
    Reply,
    SharedRecords,
    Y,
    check_places,
    drop_tables,
    exact_columns,
    fix_mesh,
    is_steady,
    merge_cases,
    on_finer_mesh,
    scale_steps,
)
from tractive_sam.fitting.data import Measured, NoiseModel, check_signs, describe_improbable
from tractive_sam.fitting.design import (
    COORDINATES,
    Data,
    FitError,
    Parameters,
    changes_of,
    column_of,
    value_of,
)
from tractive_sam.results import COLUMNS, index_by_name
from tractive_sam.scene import Scene, scene_notes
from tractive_sam.schema import Fault, SceneError


@dataclass(frozen=True, eq=False)
class ProfilePosition:
    """Unknown lateral offset, tilt and level with which a profile was measured, and their fit.

    The measured depth is d(y - offset) + tilt (y - middle) + level, of those that are unknown.
    Coordinates: offset over the width of the measurement, tilt times this width and level over the
    range of depths.

    Attributes
    ----------
    unknown : tuple of str
        Which of "offset", "tilt", "level" are unknown, in the order of the coordinates.
    y, depth : ndarray, shape (n,)
        Measured places and depths, mm.
    """

    trials = 81
    """Offsets that are tried for the first alignment."""

    unknown: tuple[str, ...]
    y: np.ndarray
    depth: np.ndarray

    @property
    def units(self) -> np.ndarray:
        """Values of offset, tilt or level that one unit of each coordinate stands for."""
        width, height = float(np.ptp(self.y)) or 1.0, float(np.ptp(self.depth)) or 1e-3
        units = {"offset": width, "tilt": height / width, "level": height}
        return np.array([units[name] for name in self.unknown])

    def values(self, position: np.ndarray) -> dict[str, float]:
        """Return offset (mm), tilt and level (mm) at coordinates, by name."""
        return dict(zip(self.unknown, (self.units * position).tolist(), strict=True))

    def predict(self, y: np.ndarray, depth: np.ndarray, position: np.ndarray) -> np.ndarray:
        """Return a computed profile as it would be measured at a position, mm, shape (n,)."""
        values = self.values(position)
        line = values.get("tilt", 0.0) * self._arm + values.get("level", 0.0)
        return _depth(y, depth)(self.y - values.get("offset", 0.0)) + line

    def slopes(self, y: np.ndarray, depth: np.ndarray, position: np.ndarray) -> np.ndarray:
        """Return the derivatives of `predict` by the coordinates of the position, (n, unknown)."""
        offset = self.values(position).get("offset", 0.0)
        columns = {
            "offset": lambda: -_depth(y, depth, 1)(self.y - offset),
            "tilt": lambda: self._arm,
            "level": lambda: np.ones_like(self.y),
        }
        slopes = [
            unit * columns[name]() for name, unit in zip(self.unknown, self.units, strict=True)
        ]
        return np.stack(slopes, axis=1) if slopes else np.empty((self.y.size, 0))

    def align(self, y: np.ndarray, depth: np.ndarray) -> np.ndarray:
        """Return the position at which a computed profile, times any factor, fits best."""
        position = np.zeros(len(self.unknown))
        lines = [column for name, column in (("tilt", self._arm), ("level", np.ones_like(self.y)))
                 if name in self.unknown]  # fmt: skip
        trials = [0.0]
        if "offset" in self.unknown:
            half = 0.5 * float(np.ptp(self.y))
            middle = 0.5 * float(self.y.min() + self.y.max())
            trials = [*np.linspace(middle - half, middle + half, self.trials), 0.0]
        best = np.inf
        for offset in trials:
            shape = _depth(y, depth)(self.y - offset)
            columns = np.stack([shape, *lines], axis=1)
            factors, *_ = np.linalg.lstsq(columns, self.depth, rcond=None)
            misfit = float(np.square(columns @ factors - self.depth).sum())
            if misfit < best and factors[0] > 0.0:
                best = misfit
                names = [name for name in ("tilt", "level") if name in self.unknown]
                values = {"offset": offset} | dict(zip(names, factors[1:], strict=True))
                position = np.array([values[name] for name in self.unknown]) / self.units
        return position

    @property
    def _arm(self) -> np.ndarray:
        """Lateral distances of the measured points from the middle of the profile, mm."""
        return self.y - 0.5 * (self.y.min() + self.y.max())


def _depth(y: np.ndarray, depth: np.ndarray, order: int = 0):
    """Return the depth, or its derivative, as a function of y: monotone cubic, 0 off the mesh."""
    step = y[1] - y[0]
    places = np.concatenate(([y[0] - step], y, [y[-1] + step]))
    curve = PchipInterpolator(places, np.pad(depth, 1), extrapolate=False)
    curve = curve.derivative(order) if order else curve
    return lambda at: np.nan_to_num(curve(at))


@dataclass(frozen=True, eq=False)
class Series:
    """One data set with its scenes, and the predictions for its rows at any parameter values.

    Attributes
    ----------
    name : str
        Name of the data set in messages.
    measured : Measured
        The measurements.
    base : Scene
        The scene with the entries of the data set.
    columns : tuple of str
        Columns of a record, one for each observation.
    groups : tuple of (tuple of int, mapping)
        Rows that share a computation, and the entries that set it and fix its mesh and steps.
    exact : mapping of str to str
        Free keys with exact derivatives, and their column of the Jacobian.
    unworn : bool
        Whether [wear] is left out once the parameters are set.
    notes : tuple of str
        Doubts about the rows, and what the data set leaves open.
    """

    name: str
    measured: Measured
    base: Scene
    columns: tuple[str, ...]
    groups: tuple[tuple[tuple[int, ...], Mapping[str, Any]], ...]
    exact: Mapping[str, str]
    unworn: bool
    notes: tuple[str, ...] = ()

    @classmethod
    def of(
        cls,
        key: str,
        name: str,
        measured: Measured,
        scene: Scene,
        start: Parameters,
        done: Evaluations | None,
        shared: SharedRecords | None = None,
    ) -> "Series":
        """Prepare a data set at the first values: check its scenes, and fix meshes and steps.

        Parameters
        ----------
        key, name : str
            Key of the data set in faults, and its name in notes.
        measured : Measured
            The measurements.
        scene : Scene
            The scene of the fit.
        start : Parameters
            First values.
        done : Evaluations, optional
            Stores the steps of rolls; without it the scenes are checked, and nothing is rolled.
        shared : SharedRecords, optional
            Records that all data sets observe.

        Raises
        ------
        FitError
            If its scenes are not valid, or cannot be computed there.
        """
        data = measured.data
        columns = tuple(column_of(name, data.body) for name in data.observe)
        shared = shared or SharedRecords()
        try:
            base = scene.replace(**data.set) if data.set else scene
            is_creep_curve = _is_creep_curve(data, base, columns)
            bare = cls(name, measured, base, columns, (), {}, data.at == 0.0 or is_creep_curve)
            scenes = {}  # faults, before anything is rolled
            source = next((name for name in data.vary if name in COORDINATES), "at")
            for rows, settings in groups_of(measured):
                scenes[rows] = bare.scene_at(start.values_by_key(np.ones(len(start))), settings)
                places = [float(measured.places[row]) for row in rows]
                check_places(scenes[rows], source, places)
            check_signs(measured, scenes)
            notes = [*_implausible_rows(name, scene, scenes), *describe_improbable(name, measured)]
            if is_creep_curve:
                cure = "at = 0 says so, at = N chooses the bodies after N revolutions"
                notes.append(f"{name}: compared with the unworn bodies, revolution 0; {cure}")
            groups, exact = [], {}
            for rows, settings in groups_of(measured):
                first, *neighbours = bare._scenes_near(start, settings)
                shared.add(first, [float(measured.places[row]) for row in rows])
                if done is None or not shared.complete:
                    continue
                changes = fix_mesh(first, neighbours, shared.of_scene(first), done.remember)
                groups.append((rows, {**settings, **changes}))
                is_contact = is_steady(first)
                exact = exact_columns(first, columns, start.keys) if is_contact else {}
        except SceneError as error:
            raise FitError(fault.under(key) for fault in error.faults) from None
        return replace(bare, groups=tuple(groups), exact=exact, notes=tuple(notes))

    def _scenes_near(self, start: Parameters, settings: Mapping[str, Any]) -> list[Scene]:
        """Return the scene at the start, and valid ones with each parameter raised some 5 %."""
        values = start.values_by_key(np.ones(len(start)))
        scenes = [self.scene_at(values, settings)]
        for k in range(len(start)):
            u = np.ones(len(start))
            u[k] += 0.05
            try:
                scenes.append(self.scene_at(start.values_by_key(u), settings))
            except SceneError:  # beyond what the scene allows
                continue
        return scenes

    def scene_at(self, values: Mapping[str, float], settings: Mapping[str, Any]) -> Scene:
        """Return the scene of rows with given settings, at values of the parameters.

        Raises
        ------
        SceneError
            If it is not valid.
        """
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            base = self.base.replace(**settings) if settings else self.base
            changes = scale_steps(base, changes_of(base, values))
            return drop_tables(base.replace(**changes), self.columns, self.unworn)

    def cases(self, values: Mapping[str, float], number: int, derivatives: bool) -> list[FitCase]:
        """Return the computation for each group of rows with equal settings.

        Parameters
        ----------
        values : mapping of str to float
            Values of the parameters.
        number : int
            Place of the data set among all.
        derivatives : bool
            Whether the exact derivatives are wanted, too.
        """
        wanted = tuple(self.exact.values()) if derivatives else ()
        cases = []
        for k, (rows, settings) in enumerate(self.groups):
            places = tuple(float(self.measured.places[row]) for row in rows)
            scene = self.scene_at(values, settings)
            places = (
                (math.nan,) if is_steady(scene) else tuple({repr(at): at for at in places}.values())
            )
            cases.append(FitCase(scene, self.columns, places, wanted, (number, k)))
        return cases

    def label_of(self, group: int) -> str:
        """Return the name of the data set with the settings of a group of rows."""
        settings = self.measured.settings[self.groups[group][0][0]]
        return ", ".join([self.name, *(f"{key} = {value:.4g}" for key, value in settings.items())])

    def predictions(self, replies: list[Reply], position: np.ndarray, of: str = "") -> np.ndarray:
        """Return predicted values of the rows from replies, or their derivative ("/parameter").

        Parameters
        ----------
        replies : list of Reply
            The answers of `cases`.
        position : ndarray
            Offset, tilt and level of a profile, as the data set has them.
        of : str
            Suffix of the numbers: "/P" gives derivatives with respect to P.
        """
        if self.measured.data.profile:
            return self.position.predict(*self.profile_of(replies[0]), position)[:, None]
        predictions = np.full(self.measured.observed.shape, math.nan)
        for (rows, _), reply in zip(self.groups, replies, strict=True):
            if not reply.failed:
                places = [float(self.measured.places[row]) for row in rows]
                for column, name in enumerate(self.columns):
                    predictions[list(rows), column] = reply.at(name + of, places)
        return predictions

    def profile_of(self, reply: Reply) -> tuple[np.ndarray, np.ndarray]:
        """Return lateral places and depths of the predicted profile, each of shape (n_y,)."""
        (at,) = (float(place) for place in self.measured.places)
        return reply.answer.numbers[Y], reply.at(self.columns[0], [at])[0]

    @cached_property
    def position(self) -> ProfilePosition:
        """Lateral offset, tilt and level of the measured profile, to be fitted."""
        measured = self.measured
        return ProfilePosition(measured.data.nuisance, measured.y, measured.observed[:, 0])


def _is_creep_curve(data: Data, scene: Scene, columns: Iterable[str]) -> bool:
    """Return whether a data set of a scene with wear varies contacts without naming a revolution.

    It is one if the scene rolls revolutions, which no entry names, and all columns are those of
    unworn bodies, too.
    """
    wears = scene.schedule.end and scene.schedule.save_key == "wear.save" and not scene.duty
    names_revolution = {*COORDINATES} & {*data.vary} or data.at is not None
    names_wear = any(key.partition(".")[0] == "wear" for key in data.vary)
    if not wears or names_revolution or names_wear or not data.vary:
        return False
    unworn, quantities = scene.replace(wear=None), index_by_name(COLUMNS)
    wanted = [quantities[name.partition(" ")[0]] for name in columns]
    return all(quantity.applies(unworn) and quantity.of is not None for quantity in wanted)


def _implausible_rows(
    name: str, scene: Scene, scenes: Mapping[tuple[int, ...], Scene]
) -> Iterator[str]:
    """Yield a note for each key with improbable values in rows, unless the scene has it, too.

    Parameters
    ----------
    name : str
        Name of the data set.
    scene : Scene
        Scene of the fit.
    scenes : mapping of tuple of int to Scene
        Scenes at the first values, by their rows.
    """
    known = {*scene_notes(scene)}
    total = sum(map(len, scenes))
    found: dict[str, list[tuple[int, str]]] = {}
    for rows, one in scenes.items():
        for note in scene_notes(one):
            if note not in known:
                found.setdefault(note.partition(":")[0], []).extend((row, note) for row in rows)
    for notes in found.values():
        yield f"{name}: {len(notes)} of {total} rows, as row {notes[0][0] + 1}: {notes[0][1]}"


def groups_of(measured: Measured) -> list[tuple[tuple[int, ...], Mapping[str, float]]]:
    """Return (indices, settings) of each group of rows with equal settings; a profile is one."""
    groups: dict[tuple, list[int]] = {}
    for k, settings in enumerate(measured.settings):
        groups.setdefault(tuple(settings.items()), []).append(k)
    return [(tuple(rows), dict(settings)) for settings, rows in groups.items()]


@dataclass(frozen=True, eq=False)
class FitProblem:
    """Data sets and parameters of a fit: predictions, residuals and derivatives at coordinates u.

    Coordinates belong to the parameters, and after them to the positions of the profiles.

    Attributes
    ----------
    parameters : Parameters
        The free parameters.
    series : tuple of Series
        The data sets.
    evaluations : Evaluations
        Source of answers.
    step : float or None
        Relative step of differences.
    """

    roll_step = 1e-2
    """Relative step of differences of rolls. Fixed steps leave a noise of some 1e-6 of the wear, so
    that a derivative has an error of 1e-4 by it, and of about half the step by curvature."""

    slope_accuracy = 1e-4
    """Relative error of derivatives."""

    parameters: Parameters
    series: tuple[Series, ...]
    evaluations: Evaluations
    step: float | None = None

    @cached_property
    def positions(self) -> list[slice]:
        """Slice of the coordinates that position each data set; empty except for profiles."""
        slices, first = [], len(self.parameters)
        for series in self.series:
            count = len(series.measured.data.nuisance) if series.measured.data.profile else 0
            slices.append(slice(first, first + count))
            first += count
        return slices

    @property
    def size(self) -> int:
        """Number of coordinates: parameters, and positions of profiles."""
        return self.positions[-1].stop

    @cached_property
    def observed(self) -> np.ndarray:
        """All measured values, shape (points,)."""
        return np.concatenate([series.measured.observed.ravel() for series in self.series])

    @cached_property
    def noise(self) -> NoiseModel:
        """Noise of all measured values, each array of shape (points,)."""
        return NoiseModel.join([series.measured.noise for series in self.series])

    def deviation(self, predicted: np.ndarray) -> np.ndarray:
        """Return the standard deviations of all measured values at predictions, (points,)."""
        return self.noise.deviation(predicted, self.observed)

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper bounds of the coordinates, each of shape (size,)."""
        low, high = (np.full(self.size, bound) for bound in (-np.inf, np.inf))
        n = len(self.parameters)
        low[:n], high[:n] = self.parameters.bounds
        return low, high

    @property
    def priors(self) -> int:
        """Number of parameters with a prior."""
        return int(np.isfinite(self.parameters.prior[:, 0]).sum())

    def residuals(
        self,
        u: np.ndarray,
        predicted: np.ndarray,
        deviation: np.ndarray | None = None,
        scatter: float = 1.0,
    ) -> np.ndarray:
        """Return (predicted - measured)/noise at all points, then the residuals of the priors.

        Parameters
        ----------
        u : ndarray, shape (size,)
            Coordinates.
        predicted : ndarray, shape (points,)
            Predictions there.
        deviation : ndarray, shape (points,), optional
            Stated standard deviations of the measured values; by default those at the predictions.
        scatter : float
            Factor on the stated noise.
        """
        deviation = self.deviation(predicted) if deviation is None else deviation
        misfit = self.noise.residuals(predicted, self.observed, deviation)
        return np.concatenate([misfit / scatter, self.prior_residuals(u)])

    def chi2(self, predicted: np.ndarray) -> float:
        """Return chi-square of the data at predictions, for the stated noise at these."""
        misfit = self.noise.residuals(predicted, self.observed, self.deviation(predicted))
        return float(np.square(misfit).sum())

    def residual_slopes(
        self,
        u: np.ndarray,
        predicted: np.ndarray,
        slopes: np.ndarray,
        deviation: np.ndarray,
        scatter: float = 1.0,
    ) -> np.ndarray:
        """Return the derivatives of `residuals` by u, at constant standard deviations."""
        is_log = self.noise.logarithmic > 0.0
        scale = scatter * np.where(is_log, self.noise.logarithmic * predicted, deviation)
        return np.concatenate([slopes / scale[:, None], self.prior_jacobian(u)])

    def slope_errors(self, predicted: np.ndarray, slopes: np.ndarray) -> np.ndarray:
        """Return the errors of derivatives of the predictions, shape (points, size).

        They are `slope_accuracy` of the derivative, or of the prediction for those by differences,
        of each data set separately. A value that does not depend on a parameter has none.
        """
        errors, n = np.abs(slopes), len(self.parameters)
        first = 0
        for series in self.series:
            rows = slice(first, first + series.measured.points)
            first = rows.stop
            differs = np.array([key not in series.exact for key in self.parameters.keys])
            sizes = np.abs(predicted[rows])[:, None] * (slopes[rows, :n] != 0.0) * differs
            errors[rows, :n] = np.maximum(errors[rows, :n], sizes)
        return self.slope_accuracy * errors

    def prior_residuals(self, u: np.ndarray) -> np.ndarray:
        """Return (value - mean) / standard deviation of each parameter that has a prior."""
        mean, sd = self.parameters.prior.T
        residuals = (self.parameters.values(u) - mean) / sd
        return residuals[np.isfinite(mean)]

    def prior_jacobian(self, u: np.ndarray) -> np.ndarray:
        """Return the derivatives of `prior_residuals` by the coordinates, shape (priors, size)."""
        mean, sd = self.parameters.prior.T
        rows = np.zeros((len(self.parameters), self.size))
        np.fill_diagonal(rows, self.parameters.slopes(u) / sd)
        return rows[np.isfinite(mean)]

    def predict(self, u: np.ndarray, derivatives: bool = False) -> np.ndarray:
        """Return predicted values, shape (points,); nan if a computation failed.

        Parameters
        ----------
        u : ndarray, shape (size,)
            Coordinates.
        derivatives : bool
            Whether exact derivatives are computed as well, for a `jacobian` there.
        """
        replies = self._replies({"": u}, derivatives)
        if replies is None:
            return np.full(self.observed.size, math.nan)
        return self._collect(replies, u)

    def jacobian(self, u: np.ndarray) -> np.ndarray:
        """Return derivatives of predictions by coordinates, (points, size); FitError if one fails.

        Raises
        ------
        FitError
            If a computation that they need fails.
        """
        u = np.asarray(u, float)
        moved = {key: (k, self._moved(u, k)) for k, key in enumerate(self.parameters.keys)}
        replies = self._replies({"": u} | {key: at for key, (_, at) in moved.items()})
        failed = {name[1] for name, reply in (replies or {}).items() if reply.failed} - {""}
        if replies and failed:  # a step to the other side may be solved
            moved |= {key: (k, self._moved(u, k, -1.0)) for key, (k, _) in moved.items()
                      if key in failed}  # fmt: skip
            opposite = self._replies({"": u} | {key: moved[key][1] for key in failed})
            replies = None if opposite is None else {**replies, **opposite}
        if replies is None:
            raise FitError(
                [Fault("fit.step", "a step to values that the scene forbids", "a smaller step")]
            )
        slopes = self.parameters.slopes(u)
        rows = []
        for n, (series, place) in enumerate(zip(self.series, self.positions, strict=True)):
            block = np.zeros((series.measured.points, self.size))
            base = [replies[n, "", k] for k in range(len(series.groups))]
            here = series.predictions(base, u[place]).ravel()
            for key, (k, at) in moved.items():
                if key in series.exact:
                    by = series.predictions(base, u[place], f"/{series.exact[key]}")
                    block[:, k] = by.ravel() * slopes[k]
                else:
                    changed = [replies[n, key, g] for g in range(len(series.groups))]
                    change = series.predictions(changed, u[place]).ravel() - here
                    block[:, k] = change / (at[k] - u[k])
            if series.measured.data.profile:
                block[:, place] = series.position.slopes(*series.profile_of(base[0]), u[place])
            rows.append(block)
        jacobian = np.concatenate(rows)
        if not np.isfinite(jacobian).all():
            value = f"a step at which the computation failed ({[*self.failures.values()][-1]})"
            raise FitError([Fault("fit.step", value, "another step, or other starts")])
        return jacobian

    def align_profiles(self, u: np.ndarray) -> np.ndarray:
        """Return coordinates whose profile positions fit the predicted profiles best."""
        replies = self._replies({"": u})
        aligned = np.array(u, float)
        for n, (series, place) in enumerate(zip(self.series, self.positions, strict=True)):
            here = None if replies is None else replies[n, "", 0]
            if series.measured.data.profile and here is not None and not here.failed:
                aligned[place] = series.position.align(*series.profile_of(here))
        return aligned

    def predict_finer(self, u: np.ndarray) -> np.ndarray:
        """Return predicted values (points,) on a finer mesh; nan if a computation failed."""
        cases: dict[tuple, FitCase] = {}
        values = self.parameters.values_by_key(u)
        try:
            for n, series in enumerate(self.series):
                for k, case in enumerate(series.cases(values, n, False)):
                    with warnings.catch_warnings():
                        warnings.simplefilter("ignore")
                        scene = on_finer_mesh(case.scene)
                    cases[n, "", k] = FitCase(scene, case.columns, case.places, seat=(n, k, 1))
        except SceneError:
            return np.full(self.observed.size, math.nan)
        return self._collect(self._replies_of(cases), u)

    def _moved(self, u: np.ndarray, k: int, side: float = 1.0) -> np.ndarray:
        """Return coordinates with the k-th one changed by a difference step within its bounds.

        The step is up unless it leaves the bounds; with `side` -1, it is the other way.
        """
        step = self.step or self._default_step
        if self.parameters.integer[k]:
            step = max(step, 1.0 / self.parameters.values(u)[k])
        at = u.copy()
        beyond = u[k] + step > self.parameters.bounds[1][k]
        at[k] += -side * step if beyond else side * step
        if self.parameters.integer[k]:  # the integer used at these coordinates
            values = self.parameters.values(at)
            values[k] = round(values[k])
            at[k] = self.parameters.coordinates(values)[k]
        return at

    @cached_property
    def _default_step(self) -> float:
        """Relative step of finite differences: larger if any data set is rolled."""
        rolled = any(not is_steady(drop_tables(series.base, series.columns, series.unworn))
                     for series in self.series)  # fmt: skip
        tolerance = max(series.base.solver.tolerance for series in self.series)
        return self.roll_step if rolled else max(1e-4, tolerance**0.5)

    def _replies(
        self, points: Mapping[str, np.ndarray], derivatives: bool = True
    ) -> dict[tuple, Reply] | None:
        """Return replies at named points by (series, point, group); None if a scene is invalid.

        Exact derivatives are computed at the point "", and there only if they are wanted. At other
        points, only what has no exact derivative is computed.
        """
        cases: dict[tuple, FitCase] = {}
        try:
            for n, series in enumerate(self.series):
                for point, u in points.items():
                    if not (point and point in series.exact):
                        wanted = derivatives and not point
                        series_cases = series.cases(self.parameters.values_by_key(u), n, wanted)
                        cases |= {(n, point, k): case for k, case in enumerate(series_cases)}
        except SceneError as error:
            self.refusals.append(str(error.faults[0]))
            return None
        order = sorted(cases, key=lambda name: (name[0], name[2], name[1]))  # neighbours in turn
        near = {(n, k): case for (n, point, k), case in cases.items() if not point}
        return self._replies_of(
            {
                name: replace(cases[name], near=near.get((name[0], name[2])))
                if name[1]
                else cases[name]
                for name in order
            }
        )

    def _replies_of(self, cases: Mapping[tuple, FitCase]) -> dict[tuple, Reply]:
        """Return the replies of cases by name; cases of the same scene are computed once."""
        together = merge_cases(cases.values())
        answers = self.evaluations.answers(together)
        names = {name: case.scene.fingerprint() for name, case in cases.items()}
        replies = {name: Reply(together[key], answers[key]) for name, key in names.items()}
        for (n, _, k), reply in replies.items():
            if reply.failed:
                where = self.series[n].label_of(k)
                for key in self.parameters.keys:
                    value = value_of(reply.case.scene, key)  # None for wear of unworn bodies
                    where += "" if value is None else f", {key} = {np.mean(value):.4g}"
                self.failures[reply.case.digest] = f"{where}: {reply.answer.message}"
        return replies

    def find_several_solutions(self, u: np.ndarray) -> tuple[int, list[str]]:
        """Return how many computations may have other solutions, and the rows at u that may."""
        rows = []
        for (n, _, k), reply in (self._replies({"": u}) or {}).items():
            if reply.answer.message and not reply.failed:
                rows.append(self.series[n].label_of(k))
        answers = self.evaluations.stored.values()
        return sum(bool(answer.message and answer.numbers) for answer in answers), rows

    @cached_property
    def refusals(self) -> list[str]:
        """Faults of values that the scene does not allow, at which the search turned back."""
        return []

    @cached_property
    def failures(self) -> dict[str, str]:
        """Places and messages of the computations that failed so far, by their digest."""
        return {}

    def _collect(self, replies: Mapping[tuple, Reply], u: np.ndarray) -> np.ndarray:
        """Return the predictions of all data sets from the replies at u, shape (points,)."""
        predictions = []
        for n, (series, place) in enumerate(zip(self.series, self.positions, strict=True)):
            each = [replies[n, "", k] for k in range(len(series.groups))]
            if series.measured.data.profile and each[0].failed:
                predictions.append(np.full(series.measured.points, math.nan))
                continue
            predictions.append(series.predictions(each, np.asarray(u)[place]).ravel())
        return np.concatenate(predictions)


LOSSES: Mapping[str, Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]] = {
    "linear": lambda z: (z, np.ones_like(z), np.zeros_like(z)),
    "soft_l1": lambda z: (
        2.0 * (np.sqrt(1.0 + z) - 1.0), (1.0 + z) ** -0.5, -0.5 * (1.0 + z) ** -1.5
    ),
    "huber": lambda z: (
        np.where(z <= 1.0, z, 2.0 * np.sqrt(z) - 1.0),
        np.maximum(z, 1.0) ** -0.5,
        np.where(z <= 1.0, 0.0, -0.5 * np.maximum(z, 1.0) ** -1.5),
    ),
    "cauchy": lambda z: (np.log1p(z), 1.0 / (1.0 + z), -((1.0 + z) ** -2.0)),
    "arctan": lambda z: (
        np.arctan(z), 1.0 / (1.0 + z**2), -2.0 * z / np.square(1.0 + z**2)
    ),
}  # fmt: skip
"""Losses of squared residuals z and their two derivatives, see `scipy.optimize.least_squares`."""


@dataclass(frozen=True)
class Loss:
    """Loss of the residuals of data by its name in `LOSSES`; priors stay quadratic.

    In a cost, the loss is divided by the expected rise of twice itself at one standard deviation of
    the estimate. Data and priors then count by their information, and the rise of twice the cost
    is distributed as that of chi-square.

    Attributes
    ----------
    name : str
        Name of the loss.
    """

    name: str

    def terms(self, squares: np.ndarray, points: int) -> np.ndarray:
        """Return twice the costs of squared residuals, and two derivatives, (3, residuals).

        Parameters
        ----------
        squares : ndarray, shape (residuals,)
            Squared residuals: first those of `points` measured values, then those of priors.
        points : int
            Number of measured values.
        """
        terms = np.stack([squares, np.ones_like(squares), np.zeros_like(squares)])
        terms[:, :points] = np.stack(LOSSES[self.name](squares[:points])) / self.rise
        return terms

    def cost(self, residuals: np.ndarray, points: int) -> float:
        """Return the cost of residuals of `points` measured values, then of priors."""
        return 0.5 * float(self.terms(np.square(residuals), points)[0].sum())

    def roots(self, residuals: np.ndarray, points: int) -> np.ndarray:
        """Return the factors of residuals in the equivalent least squares, see `cost`."""
        return np.sqrt(self.terms(np.square(residuals), points)[1])

    def weights(self, residuals: np.ndarray) -> np.ndarray:
        """Return the weights of residuals of data: 1 for those that are small."""
        return LOSSES[self.name](np.square(residuals))[1]

    def inflation(self, residuals: np.ndarray, unknowns: int) -> float:
        """Return the variance of an estimate over the inverse of its weighted information.

        An M-estimate has the variance E(psi^2) / E(psi')^2 over the information of unit weights,
        with psi = w r. Weighted least squares would give 1 / E(w). The expectations are those of
        the residuals with outliers, but not below those of a normal residual, for which
        E(psi') = E(r psi) (Huber, Robust Statistics (1981), section 7.6, with the factor of few
        points, which belongs to the estimate from the residuals).

        Parameters
        ----------
        residuals : ndarray, shape (points,)
            Residuals over the noise.
        unknowns : int
            Number of fitted coordinates.
        """
        if self.name == "linear":
            return 1.0
        weights, squares, slopes = _normal_moments(self)
        share, z = unknowns / residuals.size, np.square(residuals)
        _, weight, change = LOSSES[self.name](z)
        bends = weight + 2.0 * z * change
        bend = max(float(bends.mean()), 0.2)  # all residuals may be outliers
        of_data = float(np.square(weight * residuals).mean() * weight.mean()) / bend**2
        of_data /= max(1.0 - share, share)
        few = (1.0 + share * float(bends.var()) / bend**2) ** 2
        return max(few * of_data, squares * weights / slopes**2)

    @property
    def rise(self) -> float:
        """Expected rise of the sum of losses at one standard deviation: 1 for least squares."""
        _, squares, slopes = _normal_moments(self)
        return squares / slopes

    def scatter(self, residuals: np.ndarray, degrees: float) -> float:
        """Return the scale s of residuals r: sum of (r/s)^2 is the degrees of freedom.

        For robust losses, squares are bounded by 1, and so are those expected (Huber's Proposal 2,
        Robust Statistics (1981), section 6.4): otherwise, one outlier would determine the scale.
        """
        squares = np.sort(np.square(residuals))
        if self.name == "linear":
            return math.sqrt(squares.sum() / degrees)
        expected = chi2_distribution.cdf(1.0, 3) + chi2_distribution.sf(1.0, 1)
        # Counting any k largest squares as 1 is an upper limit, so that the scale is the least one.
        left = degrees * expected - np.arange(squares.size)[::-1]
        return math.sqrt((np.cumsum(squares)[left > 0.0] / left[left > 0.0]).min())


@cache
def _normal_moments(loss: Loss) -> tuple[float, float, float]:
    """Return the expectations of w, (w r)^2 and w r^2 for a standard normal residual r."""
    nodes, shares = np.polynomial.hermite_e.hermegauss(99)
    shares = shares / shares.sum()
    weights = loss.weights(nodes)
    moments = (weights, np.square(weights * nodes), weights * np.square(nodes))
    means = [float(shares @ moment) for moment in moments]
    return means[0], means[1], means[2]
