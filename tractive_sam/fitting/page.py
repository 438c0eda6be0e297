"""Figures and the page of a fit: estimates, what is not determined, residuals."""

from collections.abc import Iterator
from os import PathLike
from pathlib import Path

import numpy as np
from scipy.stats import norm

from tractive_sam import interrupt
from tractive_sam.description import html_columns
from tractive_sam.fitting.design import Parameters, base_of
from tractive_sam.fitting.results import DONE, FitResult
from tractive_sam.output_file import make_folder, omit_failing_figure, write_file
from tractive_sam.pages import fill_page
from tractive_sam.plot import (
    DPI,
    Figure,
    FittedCurve,
    Variable,
    confidence_ellipses,
    fitted_curve,
    profile_likelihood,
)
from tractive_sam.results import COLUMNS, index_by_name
from tractive_sam.safe_text import Html, fill
from tractive_sam.scene import Scene
from tractive_sam.schema import SceneError


def save_fit_figures(
    result: FitResult, directory: str | PathLike[str], *, format: str = "png", dpi: int = DPI
) -> list[Path]:
    """Save the figures of a fit in a folder: data and model, ellipses, profile likelihood.

    Parameters
    ----------
    result : FitResult
        A complete fit.
    directory : path-like
        Folder of the figures; made if it does not exist.
    format : str
        One of `plot.FORMATS`.
    dpi : int
        Dots per inch.

    Returns
    -------
    list of Path
        The files.

    Examples
    --------
    >>> from tractive_sam import fitting
    >>> found = ts.fit({"scene": coarse, "free": ["friction.mu"], "data": [data]})
    >>> [path.name for path in fitting.save_fit_figures(found, "fit-figures")]
    ['data0-Qx_over_P.png']
    """
    directory = Path(directory)
    make_folder(directory)
    paths = []
    for name, _, figure in fit_figures(result):
        interrupt.raise_if_interrupted()
        path = directory / f"{name}.{format}"
        with omit_failing_figure(path.name):
            figure.savefig(path, dpi=dpi)
            paths.append(path)
    return paths


def fit_figures(result: FitResult) -> Iterator[tuple[str, str, Figure]]:
    """Yield (name, caption, figure) of data with the model, ellipses and profile likelihood."""
    data = result.dataset
    series, names = data["series"].values, data["observation"].values
    for number in np.unique(series):
        for name in dict.fromkeys(names[series == number]):
            rows = np.flatnonzero((series == number) & (names == name))
            label = result.design.fit.data[number].name or f"data set {number}"
            title = "\n".join(filter(None, (result.title, label)))
            caption = f"{label}: measured {name} with one standard deviation, and the model."
            file = f"data{number}-{str(name).replace(' ', '-')}"
            with omit_failing_figure(file):
                curve = _curve(result, rows, str(name))
                yield file, caption, fitted_curve(curve, title=title)
    determined = np.flatnonzero(np.isfinite(data["sd"].values))
    if determined.size > 1:
        keys = [result.keys[k] for k in determined]
        values, deviations = (data[name].values[determined] for name in ("value", "sd"))
        correlation = result.correlation[np.ix_(determined, determined)]
        limits = Parameters.of(result.design.fit).limits(np.array([*result.values.values()]))
        lower, upper = (limit[determined] for limit in limits)
        with omit_failing_figure("ellipses"):
            figure = confidence_ellipses(
                keys, values, deviations, correlation, title=result.title, limits=(lower, upper)
            )
            yield "ellipses", "Ellipses of 68 and 95 % of each pair of parameters.", figure
    if "likelihood" in data:
        yield from _likelihoods(result)


def _curve(result: FitResult, rows: np.ndarray, name: str) -> FittedCurve:
    """Return the measured and fitted values of one column of a data set, for a figure."""
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
    return FittedCurve(
        x, Variable(name, observed, label + body, quantity.unit), **columns,
        between=_curve_between(result, number, name),
    )  # fmt: skip


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


def _likelihoods(result: FitResult) -> Iterator[tuple[str, str, Figure]]:
    """Yield (name, caption, figure) of the profile likelihood of each parameter."""
    numbers, level = result.dataset["likelihood"].values, result.design.fit.level
    limit = float(result.dataset.attrs.get("scatter", 1.0) * norm.ppf(0.5 + 0.5 * level)) ** 2
    limit = float(result.dataset.attrs.get("likelihood_limit", limit))  # absent in earlier files
    for k in np.unique(numbers[:, 0]).astype(int):
        _, values, rise = numbers[numbers[:, 0] == k].T
        key = result.keys[k]
        with omit_failing_figure(f"likelihood-{key}"):
            figure = profile_likelihood(key, values, rise, limit, title=result.title)
            yield f"likelihood-{key}", f"Profile likelihood of {key}.", figure


def report_fit(result: FitResult, path: str | PathLike[str]) -> Path:
    """Write a fit as one HTML page that needs no other file and no network.

    Parameters
    ----------
    result : FitResult
        A complete fit.
    path : path-like
        The page; replaced if it is there.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    OutputError
        If the page cannot be written.

    Examples
    --------
    >>> from tractive_sam import fitting
    >>> found = ts.fit({"scene": coarse, "free": ["friction.mu"], "data": [data]})
    >>> fitting.report_fit(found, "fit.html").stat().st_size < 1e6
    True
    """
    page = fill_page(
        __package__,
        "page",
        title=result.title or "A fit",
        status=result.status,
        kind="good" if result.status == DONE else "bad",
        message=str(result.dataset.attrs["message"]),
        notes=(
            fill('<p class="notice">$text</p>\n', text=text)
            for text in (*result.undetermined, *result.notes)
        ),
        facts=(
            fill("<tr><th>$name</th><td>$text</td></tr>\n", name=name, text=text)
            for name, text in result.summary().items()
            if name not in (*result.keys, "title", "status")
        ),
        tables=_tables(result),
        pictures=_pictures(result),
        design=result.design.to_toml(),
        version=str(result.dataset.attrs.get("version", "")),
    )
    return write_file(path, page)


def _pictures(result: FitResult) -> Iterator[Html]:
    """Yield the figures of a fit as HTML, with captions."""
    # Width of a picture, pixels.
    width = 460.0
    card = "<figure><figcaption>$caption</figcaption>$image</figure>\n"
    for name, caption, figure in fit_figures(result):
        interrupt.raise_if_interrupted()
        with omit_failing_figure(name):
            yield fill(card, caption=caption, image=figure.to_html(width))


def _tables(result: FitResult) -> Iterator[Html]:
    """Yield the tables of a fit as HTML, the estimates with the meaning of each key."""
    tables = result.tables()
    for row in tables["Estimates"]:
        row["meaning"] = Scene.find_field(base_of(row["parameter"])).title or ""
    for title, rows in tables.items():
        yield fill("<h2>$title</h2>\n$table\n", title=title, table=html_columns(rows))
