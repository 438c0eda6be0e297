"""Predictions of all data sets, and their derivatives, at any values of the parameters."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from tractive_sam.fitting import prepare
from tractive_sam.fitting.case import FitCase, Reply, Y, is_one_contact, merged
from tractive_sam.fitting.data import Measured
from tractive_sam.fitting.derivatives import exact_columns
from tractive_sam.fitting.design import FitError
from tractive_sam.fitting.entries import changes_of
from tractive_sam.fitting.evaluations import Evaluations
from tractive_sam.fitting.parameters import Parameters
from tractive_sam.fitting.profile import ProfilePosition
from tractive_sam.fitting.tables import column_of
from tractive_sam.scene import Scene
from tractive_sam.schema import Fault, SceneError

ROLL_STEP = 1e-2
"""Relative step of differences of rolls. Fixed steps leave a noise of some 1e-6 of the wear, so
that a derivative has an error of 1e-4 by it, and of about half the step by curvature."""


@dataclass(frozen=True, eq=False)
class Series:
    """One data set: its scenes, and how the numbers of their records are compared.

    Attributes
    ----------
    key : str
        Its key in messages.
    measured : Measured
        The measurements.
    base : Scene
        The scene with the entries of the data set.
    columns : tuple of str
        Columns of a record, one for each observation.
    groups : tuple of (tuple of int, mapping)
        Rows that share a computation, and the entries that set it and fix its mesh and steps.
    exact : mapping of str to tuple of str
        Free keys whose derivatives are exact, with their columns of the Jacobian.
    unworn : bool
        Whether [wear] is left out once the parameters are set.
    """

    key: str
    measured: Measured
    base: Scene
    columns: tuple[str, ...]
    groups: tuple[tuple[tuple[int, ...], Mapping[str, Any]], ...]
    exact: Mapping[str, tuple[str, ...]]
    unworn: bool

    @classmethod
    def of(
        cls,
        key: str,
        measured: Measured,
        scene: Scene,
        start: Parameters,
        done: Evaluations | None,
        shared: prepare.SharedPlaces | None = None,
    ) -> Series:
        """Prepare a data set at the first values of the parameters.

        Parameters
        ----------
        key : str
            Its key in messages.
        measured : Measured
            The measurements.
        scene : Scene
            The scene of the fit.
        start : Parameters
            First values.
        done : Evaluations, optional
            Stores the steps of rolls; without it the scenes are checked, and nothing is rolled.
        shared : SharedPlaces, optional
            Records that all data sets observe.

        Raises
        ------
        FitError
            If its scenes are not valid, or cannot be computed there.
        """
        data = measured.data
        columns = tuple(column_of(name, data.body) for name in data.observe)
        shared = shared or prepare.SharedPlaces()
        try:
            base = scene.replace(**data.set) if data.set else scene
            bare = cls(key, measured, base, columns, (), {}, data.at == 0.0)
            for _, settings in _groups_of(measured):  # faults, before anything is rolled
                bare.scene_at(start.named(np.ones(len(start))), settings)
            groups, exact = [], {}
            for rows, settings in _groups_of(measured):
                first, *others = bare._scenes_near(start, settings)
                shared.add(first, [float(measured.places[row]) for row in rows])
                if done is None or not shared.complete:
                    continue
                changes = prepare.fixed(first, others, shared.of(first), done.remember)
                groups.append((rows, {**settings, **changes}))
                one = is_one_contact(first)
                exact = exact_columns(first, columns, start.keys) if one else {}
        except SceneError as error:
            raise FitError(one.under(key) for one in error.faults) from None
        return replace(bare, groups=tuple(groups), exact=exact)

    def _scenes_near(self, start: Parameters, settings: Mapping[str, Any]) -> list[Scene]:
        """Return the scene at the first values, and with each parameter changed."""
        values = start.named(np.ones(len(start)))
        scenes = [self.scene_at(values, settings)]
        for k in range(len(start)):
            u = np.ones(len(start))
            u[k] += 0.05
            try:
                scenes.append(self.scene_at(start.named(u), settings))
            except SceneError:  # beyond what the scene allows
                continue
        return scenes

    def scene_at(self, values: Mapping[str, float], settings: Mapping[str, Any]) -> Scene:
        """Return the scene of some rows at values of the parameters.

        Raises
        ------
        SceneError
            If it is not valid.
        """
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            base = self.base.replace(**settings) if settings else self.base
            changes = prepare.scaled_steps(base, changes_of(base, values))
            return prepare.trimmed(base.replace(**changes), self.columns, self.unworn)

    def cases(self, values: Mapping[str, float], number: int, derivatives: bool) -> list[FitCase]:
        """Return the computation of each group of rows.

        Parameters
        ----------
        values : mapping of str to float
            Values of the parameters.
        number : int
            Place of the data set among all.
        derivatives : bool
            Whether the exact derivatives are wanted, too.
        """
        names = (name for names in self.exact.values() for name in names)
        wanted = tuple(dict.fromkeys(names)) if derivatives else ()
        found = []
        for k, (rows, settings) in enumerate(self.groups):
            places = tuple(float(self.measured.places[row]) for row in rows)
            scene = self.scene_at(values, settings)
            places = (
                (math.nan,)
                if is_one_contact(scene)
                else tuple({repr(at): at for at in places}.values())
            )
            found.append(FitCase(scene, self.columns, places, wanted, (number, k)))
        return found

    def predictions(self, replies: list[Reply], position: np.ndarray, of: str = "") -> np.ndarray:
        """Return predicted values of the rows, or a derivative of them.

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
        found = np.full(self.measured.observed.shape, math.nan)
        for (rows, _), reply in zip(self.groups, replies, strict=True):
            if not reply.failed:
                places = [float(self.measured.places[row]) for row in rows]
                for column, name in enumerate(self.columns):
                    found[list(rows), column] = reply.at(name + of, places)
        return found

    def profile_of(self, reply: Reply) -> tuple[np.ndarray, np.ndarray]:
        """Return lateral places and depths of the predicted profile, each of shape (n_y,)."""
        (at,) = (float(place) for place in self.measured.places)
        return reply.answer.numbers[Y], reply.at(self.columns[0], [at])[0]

    @cached_property
    def position(self) -> ProfilePosition:
        """The unknown position of a profile."""
        measured = self.measured
        return ProfilePosition(measured.data.nuisance, measured.y, measured.observed[:, 0])


def _groups_of(measured: Measured) -> list[tuple[tuple[int, ...], Mapping[str, float]]]:
    """Return rows of the same settings together, with these; a profile is one group."""
    groups: dict[tuple, list[int]] = {}
    for k, settings in enumerate(measured.settings):
        groups.setdefault(tuple(settings.items()), []).append(k)
    return [(tuple(rows), dict(settings)) for settings, rows in groups.items()]


@dataclass(frozen=True, eq=False)
class FitProblem:
    """All data sets and parameters together.

    Coordinates are those of the parameters, and after them the positions of the profiles.

    Attributes
    ----------
    parameters : Parameters
        The free parameters.
    series : tuple of Series
        The data sets.
    evaluations : Evaluations
        Where answers come from.
    step : float or None
        Relative step of differences.
    """

    parameters: Parameters
    series: tuple[Series, ...]
    evaluations: Evaluations
    step: float | None = None

    @cached_property
    def positions(self) -> list[slice]:
        """Coordinates of each data set beyond the parameters; empty of other than profiles."""
        found, first = [], len(self.parameters)
        for one in self.series:
            count = len(one.measured.data.nuisance) if one.measured.data.profile else 0
            found.append(slice(first, first + count))
            first += count
        return found

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return self.positions[-1].stop

    @cached_property
    def observed(self) -> np.ndarray:
        """All measured values, shape (points,)."""
        return np.concatenate([one.measured.observed.ravel() for one in self.series])

    @cached_property
    def noise(self) -> np.ndarray:
        """Their standard deviations."""
        return np.concatenate([one.measured.noise.ravel() for one in self.series])

    def prior_residuals(self, u: np.ndarray) -> np.ndarray:
        """Return deviations from the priors over their standard deviations."""
        mean, sd = self.parameters.prior.T
        residuals = (self.parameters.values(u) - mean) / sd
        return residuals[np.isfinite(mean)]

    def prior_jacobian(self, u: np.ndarray) -> np.ndarray:
        """Return the derivatives of `prior_residuals` by the coordinates."""
        mean, sd = self.parameters.prior.T
        rows = np.zeros((len(self.parameters), self.size))
        np.fill_diagonal(rows, self.parameters.slopes(u) / sd)
        return rows[np.isfinite(mean)]

    def predict(self, u: np.ndarray) -> np.ndarray:
        """Return predicted values, shape (points,); nan where a computation failed."""
        replies = self._replies({"": u})
        if replies is None:
            return np.full(self.observed.size, math.nan)
        return self._collect(replies, "", u)

    def jacobian(self, u: np.ndarray) -> np.ndarray:
        """Return derivatives of the predicted values by the coordinates, shape (points, size).

        Raises
        ------
        FitError
            If a computation that they need fails.
        """
        u = np.asarray(u, float)
        moved = {key: (k, self._moved(u, k)) for k, key in enumerate(self.parameters.keys)}
        replies = self._replies({"": u} | {key: at for key, (_, at) in moved.items()})
        if replies is None:
            raise FitError(
                [Fault("fit.step", "a difference that leaves the scene", "a smaller step")]
            )
        slopes = self.parameters.slopes(u)
        rows = []
        for n, (one, place) in enumerate(zip(self.series, self.positions, strict=True)):
            block = np.zeros((one.measured.points, self.size))
            base = [replies[n, "", k] for k in range(len(one.groups))]
            here = one.predictions(base, u[place]).ravel()
            for key, (k, at) in moved.items():
                if key in one.exact:
                    parts = [one.predictions(base, u[place], f"/{name}") for name in one.exact[key]]
                    block[:, k] = np.sum(parts, axis=0).ravel() * slopes[k]
                else:
                    there = [replies[n, key, g] for g in range(len(one.groups))]
                    change = one.predictions(there, u[place]).ravel() - here
                    block[:, k] = change / (at[k] - u[k])
            if one.measured.data.profile:
                block[:, place] = one.position.slopes(*one.profile_of(base[0]), u[place])
            rows.append(block)
        found = np.concatenate(rows)
        if not np.isfinite(found).all():
            raise FitError([Fault("fit.step", "a computation that failed", self.failures[-1])])
        return found

    def aligned(self, u: np.ndarray) -> np.ndarray:
        """Return coordinates with the positions of profiles that fit the predictions there best."""
        replies = self._replies({"": u})
        found = np.array(u, float)
        for n, (one, place) in enumerate(zip(self.series, self.positions, strict=True)):
            here = None if replies is None else replies[n, "", 0]
            if one.measured.data.profile and here is not None and not here.failed:
                found[place] = one.position.align(*one.profile_of(here))
        return found

    def predict_finer(self, u: np.ndarray) -> np.ndarray:
        """Return predicted values on a finer mesh; nan where that fails."""
        cases: dict[tuple, FitCase] = {}
        values = self.parameters.named(u)
        try:
            for n, one in enumerate(self.series):
                for k, case in enumerate(one.cases(values, n, False)):
                    with warnings.catch_warnings():
                        warnings.simplefilter("ignore")
                        scene = prepare.finer(case.scene)
                    cases[n, "", k] = FitCase(scene, case.columns, case.places, seat=(n, k, 1))
        except SceneError:
            return np.full(self.observed.size, math.nan)
        return self._collect(self._replies_of(cases), "", u)

    def _moved(self, u: np.ndarray, k: int) -> np.ndarray:
        """Return coordinates with one parameter changed by the step of differences."""
        step = self.step or self._default_step
        if self.parameters.whole[k]:
            step = max(step, 1.0 / self.parameters.values(u)[k])
        at = u.copy()
        beyond = u[k] + step > self.parameters.bounds[1][k]
        at[k] += -step if beyond else step
        if self.parameters.whole[k]:  # where the whole number is
            values = self.parameters.values(at)
            values[k] = round(values[k])
            at[k] = self.parameters.coordinates(values)[k]
        return at

    @cached_property
    def _default_step(self) -> float:
        """Step of differences: where something is rolled, that of rolls."""
        rolled = any(not is_one_contact(prepare.trimmed(one.base, one.columns, one.unworn))
                     for one in self.series)  # fmt: skip
        tolerance = max(one.base.solver.tolerance for one in self.series)
        return ROLL_STEP if rolled else max(1e-4, tolerance**0.5)

    def _replies(self, points: Mapping[str, np.ndarray]) -> dict[tuple, Reply] | None:
        """Return answers by series, point and group; None where a scene is not valid.

        At points other than "" only what has no exact derivative is computed.
        """
        cases: dict[tuple, FitCase] = {}
        try:
            for n, one in enumerate(self.series):
                for point, u in points.items():
                    if not (point and point in one.exact):
                        found = one.cases(self.parameters.named(u), n, not point)
                        cases |= {(n, point, k): case for k, case in enumerate(found)}
        except SceneError as error:
            self.failures.append(str(error.faults[0]))
            return None
        order = sorted(cases, key=lambda name: (name[0], name[2], name[1]))  # neighbours in turn
        return self._replies_of({name: cases[name] for name in order})

    def _replies_of(self, cases: Mapping[tuple, FitCase]) -> dict[tuple, Reply]:
        """Return the answers of cases; those of one scene are computed together."""
        together = merged(cases.values())
        answers = self.evaluations.answers(together)
        self.failures.extend(one.message for one in answers.values() if one.message)
        names = {name: case.scene.fingerprint() for name, case in cases.items()}
        return {name: Reply(together[one], answers[one]) for name, one in names.items()}

    @cached_property
    def failures(self) -> list[str]:
        """Reasons of computations that failed."""
        return []

    def _collect(self, replies: Mapping[tuple, Reply], point: str, u: np.ndarray) -> np.ndarray:
        """Return the computed values of all series at a point."""
        found = []
        for n, (one, place) in enumerate(zip(self.series, self.positions, strict=True)):
            each = [replies[n, point, k] for k in range(len(one.groups))]
            if one.measured.data.profile and each[0].failed:
                found.append(np.full(one.measured.points, math.nan))
                continue
            found.append(one.predictions(each, np.asarray(u)[place]).ravel())
        return np.concatenate(found)
