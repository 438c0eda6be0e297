"""Figures of a fit: data with the model, confidence ellipses, profile likelihood."""

from collections.abc import Iterator
from functools import partial

import numpy as np
from scipy.stats import norm

from tractive_sam.fitting.design import Parameters
from tractive_sam.fitting.results import FitResult
from tractive_sam.plot import (
    Drawing,
    Figure,
    FittedCurve,
    Variable,
    confidence_ellipses,
    fitted_curve,
    profile_likelihood,
)
from tractive_sam.results import COLUMNS, index_by_name
from tractive_sam.scene import Scene
from tractive_sam.schema import SceneError


def fit_figures(result: FitResult) -> Iterator[Drawing]:
    """Yield data with the model, ellipses and profile likelihood, to be drawn.

    Parameters
    ----------
    result : FitResult
        A fit with estimates.

    Examples
    --------
    >>> from tractive_sam import fitting
    >>> found = ts.fit({"scene": coarse, "free": ["friction.mu"], "data": [data]})
    >>> [drawing.name for drawing in fitting.fit_figures(found)]
    ['data0-Qx_over_P']
    """
    data = result.dataset
    series, names = data["series"].values, data["observation"].values
    for number in np.unique(series):
        for name in map(str, dict.fromkeys(names[series == number])):
            rows = np.flatnonzero((series == number) & (names == name))
            label = result.design.fit.names[number]
            caption = f"{label}: measured {name} with one standard deviation, and the model."
            title = "\n".join(filter(None, (result.title, label)))
            file = f"data{number}-{name.replace(' ', '-')}"
            yield Drawing(file, caption, partial(_draw_curve, result, rows, name, title))
    determined = np.flatnonzero(np.isfinite(data["sd"].values))
    if determined.size > 1:
        caption = "Ellipses of 68 and 95 % of each pair of parameters, with its correlation."
        if left_out := [result.keys[k] for k in determined[5:]]:
            caption += f" Not drawn: {', '.join(left_out)}."
        yield Drawing("ellipses", caption, partial(_draw_ellipses, result, determined))
    if "likelihood" in data:
        for k in np.unique(data["likelihood"].values[:, 0]).astype(int):
            key = result.keys[k]
            caption = f"Profile likelihood of {key}."
            yield Drawing(f"likelihood-{key}", caption, partial(_draw_likelihood, result, k))


def _draw_ellipses(result: FitResult, determined: np.ndarray) -> Figure:
    """Draw the confidence ellipses of the parameters with these indices."""
    data = result.dataset
    values, deviations = (data[name].values[determined] for name in ("value", "sd"))
    limits = Parameters.of(result.design.fit).limits(np.array([*result.values.values()]))
    lower, upper = (limit[determined] for limit in limits)
    return confidence_ellipses(
        [result.keys[k] for k in determined], values, deviations,
        result.correlation[np.ix_(determined, determined)], title=result.title,
        limits=(lower, upper),
    )  # fmt: skip


def _draw_curve(result: FitResult, rows: np.ndarray, name: str, title: str) -> Figure:
    """Draw the measured and fitted values of one column of a data set."""
    data, plain = result.dataset, name.partition(" ")
    quantity = index_by_name(COLUMNS)[plain[0]].with_units_of(result.design.fit.scene)
    body = f" of body {plain[2]}" if plain[2] else ""
    columns = {key: data[key].values[rows] for key in ("noise", "predicted", "band", "residual")}
    observed = data["observed"].values[rows]
    number = data["series"].values[rows[0]]
    factor = result.design.fit.data[number].uncertainty.factor
    if factor:  # error bars of a factor are as long as each other on a logarithmic axis
        columns["noise"] = np.abs(observed) * np.array([[1.0 - 1.0 / factor], [factor - 1.0]])
    key = str(data["abscissa_name"].values[rows[0]])
    x = Variable(key, data["abscissa"].values[rows], _meaning(key))
    label = quantity.label or plain[0].replace("_", " ")
    if quantity.symbol and not quantity.label and not body:
        label = f"${quantity.symbol}$"
    y = Variable(name, observed, label + body, quantity.unit)
    curve = FittedCurve(x, y, **columns, between=_curve_between(result, number, name))
    return fitted_curve(curve, title=title)


def _curve_between(result: FitResult, number: int, name: str) -> np.ndarray | None:
    """Return (x, prediction, standard deviation) between measured points; None if not stored."""
    if "curve" not in result.dataset:
        return None
    numbers = result.dataset["curve"].values
    chosen = (numbers[:, 0] == number) & (result.dataset["curve_column"].values == name)
    return numbers[chosen, 1:].T


def _meaning(key: str) -> str:
    """Return the axis label of a varied key or coordinate: its description."""
    if key in index_by_name(COLUMNS):
        return key.replace("_", " ")
    try:
        return Scene.find_field(key).title or key
    except SceneError:
        return {"y": "y (mm)"}.get(key, key)


def _draw_likelihood(result: FitResult, k: int) -> Figure:
    """Draw the profile likelihood of the parameter with an index."""
    numbers, level = result.dataset["likelihood"].values, result.design.fit.level
    limit = float(result.dataset.attrs.get("scatter", 1.0) * norm.ppf(0.5 + 0.5 * level)) ** 2
    limit = float(result.dataset.attrs.get("likelihood_limit", limit))  # absent in earlier files
    _, values, rise = numbers[numbers[:, 0] == k].T
    return profile_likelihood(result.keys[k], values, rise, limit, title=result.title)
