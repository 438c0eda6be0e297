"""Predictions between the measured points of a creep curve, for figures."""

from dataclasses import replace

import numpy as np

from tractive_sam.fitting.case import is_steady
from tractive_sam.fitting.data import Measured, NoiseModel
from tractive_sam.fitting.design import Fit, FitError, Noise
from tractive_sam.fitting.estimate import Estimate
from tractive_sam.fitting.fit_file import Variables
from tractive_sam.fitting.series import Series


def curve_variables(best: Estimate, fit: Fit) -> Variables:
    """Return variables of predictions between points of single contacts that vary one key.

    Only data sets of single contacts that differ in one key have them: a roll for each point would
    cost more than the fit.

    Parameters
    ----------
    best : Estimate
        The minimum.
    fit : Fit
        The scene, and the number of points.
    """
    n = len(best.problem.parameters)
    rows: list[np.ndarray] = []
    names: list[str] = []
    for number, series in enumerate(best.problem.series):
        places = _places_between(series, best, fit.curve)
        if not places.size:
            continue
        (key,) = series.measured.data.vary
        shape = (places.size, len(series.columns))
        measured = Measured(
            series.measured.data, tuple({key: float(x)} for x in places),
            np.full(places.size, np.nan), np.ones(shape), NoiseModel.from_table(Noise(absolute=1.0),
            shape), np.empty(0),
        )  # fmt: skip
        try:
            curve = Series.of(
                series.key, measured, fit.scene, best.problem.parameters, best.problem.evaluations
            )
            problem = replace(best.problem, series=(curve,))
            predicted = problem.predict(best.u[:n], derivatives=True)
            slopes = problem.jacobian(best.u[:n])
        except FitError:  # a value between the measured ones that cannot be computed
            continue
        wide = np.pad(slopes, ((0, 0), (0, best.u.size - n)))
        x = np.repeat(places, len(series.columns))
        rows.append(np.column_stack([np.full(x.size, number), x, predicted, best.spread(wide)]))
        names += [*series.columns] * places.size
    if not rows:
        return {}
    meaning = "data set, abscissa, prediction, its standard deviation"
    return {
        "curve": (("curve_point", "of_curve"), np.concatenate(rows), "1", meaning),
        "curve_column": (("curve_point",), names, "1", "predicted column"),
    }


def _places_between(series: Series, best: Estimate, points: int) -> np.ndarray:
    """Return x values between the measured ones; none for profiles, rolls or several keys."""
    x = np.unique(series.measured.abscissa[1])
    same_keys = list(series.measured.data.vary) == list(series.measured.settings[0])
    if series.measured.data.profile or not same_keys or len(series.measured.data.vary) != 1:
        return np.empty(0)
    values = best.problem.parameters.values_by_key(best.u)
    scene = series.scene_at(values, series.measured.settings[0])
    if not is_steady(scene) or not 1 < x.size < points:
        return np.empty(0)
    shares = np.linspace(0.0, x.size - 1.0, points)
    return np.setdiff1d(np.interp(shares, np.arange(x.size), x), x)
