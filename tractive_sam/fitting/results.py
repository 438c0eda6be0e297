"""The result of a fit, and its file."""

from __future__ import annotations

import json
import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tractive_sam.description import text_table
from tractive_sam.extras import require_extra
from tractive_sam.fitting.design import FitDesign
from tractive_sam.fitting.entries import changes_of
from tractive_sam.scene import Scene
from tractive_sam.store import ResultsError, netcdf_format, read_netcdf, write_netcdf

if TYPE_CHECKING:
    import xarray

FIT_FORMAT = "fit 1"
"""What a file says of itself; another number is another version."""

DONE = "done"
"""Status of a fit that is complete."""


@dataclass(frozen=True, eq=False)
class Gain:
    """Gain of one candidate of the next test.

    Attributes
    ----------
    label : str
        The test, in words.
    deviation : ndarray, shape (n,)
        Standard deviations of the parameters after it, as `FitResult.sd`.
    gain : float
        Fall of the logarithm of the determinant of the covariance, of the target alone or of all
        parameters (D-optimal).
    """

    label: str
    deviation: np.ndarray
    gain: float


@dataclass(frozen=True, eq=False)
class Intervals:
    """Intervals of the parameters.

    Attributes
    ----------
    low, high, sd : ndarray, shape (n,)
        Ends and standard deviations; nan and infinite where the data set none.
    curves : tuple of ndarray, shape (m, 3)
        Of the profile likelihood: parameter, its value, and the rise of chi-square.
    """

    low: np.ndarray
    high: np.ndarray
    sd: np.ndarray
    curves: tuple[np.ndarray, ...] = ()


@dataclass(frozen=True, eq=False)
class FitResult:
    """The result of a fit.

    Attributes
    ----------
    dataset : xarray.Dataset
        All numbers: values, intervals and correlation over ``parameter``; measured values,
        predictions, residuals and errors over ``point``; the answers of all computations.

    Examples
    --------
    >>> coarse = ts.Scene.builtin("spheres").with_set(["grid.elements=[23, 23]"])
    >>> creep = {"creepage.longitudinal": [-1e-3, -4e-3], "Qx_over_P": [0.1, 0.27]}
    >>> data = {"values": creep, "vary": "creepage.longitudinal", "observe": "Qx_over_P"}
    >>> data["noise"] = 0.05
    >>> found = ts.fit({"scene": coarse, "free": ["friction.mu"], "data": [data]})
    >>> found.status, found.points
    ('done', 2)
    >>> low, high = found.interval("friction.mu")
    >>> low < found.values["friction.mu"] < high
    True
    """

    dataset: xarray.Dataset

    def __repr__(self) -> str:
        return text_table("Fit", self.summary())

    @cached_property
    def design(self) -> FitDesign:
        """What was fitted."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return FitDesign.from_toml_text(str(self.dataset["design"].values))

    @property
    def status(self) -> str:
        """Done, running (also of an interrupted fit), or not converged at most iterations."""
        return str(self.dataset.attrs["status"])

    @property
    def finished(self) -> bool:
        """Whether there are estimates."""
        return "value" in self.dataset

    @property
    def title(self) -> str:
        """The title of the fit, or of its scene."""
        return self.design.fit.title or self.design.fit.scene.title

    @property
    def keys(self) -> tuple[str, ...]:
        """The free keys."""
        return self.design.fit.free

    def _named(self, name: str) -> dict[str, float]:
        """Return the values of a variable by the names of the parameters."""
        return dict(zip(self.keys, self.dataset[name].values.tolist(), strict=True))

    @property
    def values(self) -> dict[str, float]:
        """Estimates by key."""
        return self._named("value")

    @property
    def sd(self) -> dict[str, float]:
        """Standard deviations by key; infinite where the data do not determine a parameter."""
        return self._named("sd")

    def interval(self, key: str) -> tuple[float, float]:
        """Return the interval of a parameter; nan where the data set no end."""
        return self._named("low")[key], self._named("high")[key]

    @property
    def correlation(self) -> np.ndarray:
        """Correlation of the parameters, shape (n, n); nan of those that are not determined."""
        return self.dataset["correlation"].values

    @property
    def positions(self) -> dict[str, float]:
        """Offset (mm), tilt and level (mm) of measured profiles, by data set and name."""
        if "position" not in self.dataset:
            return {}
        names = map(str, self.dataset["position"].values)
        return dict(zip(names, self.dataset["position_value"].values.tolist(), strict=True))

    @property
    def undetermined(self) -> list[str]:
        """What the data do not determine, in words."""
        return self._texts("undetermined")

    @property
    def notes(self) -> list[str]:
        """What is doubtful about the fit."""
        return self._texts("notes")

    def _texts(self, name: str) -> list[str]:
        """Return the texts of a variable."""
        found = self.dataset.get(name)
        return [] if found is None else [str(one) for one in found.values]

    @property
    def chi2(self) -> float:
        """Sum of the squares of the residuals over the noise."""
        return float(self.dataset.attrs["chi2"])

    @property
    def chi2_range(self) -> tuple[float, float]:
        """Range in which `chi2` is expected; nan where points are no more than parameters."""
        return float(self.dataset.attrs["chi2_low"]), float(self.dataset.attrs["chi2_high"])

    @property
    def points(self) -> int:
        """Number of measured values."""
        return int(self.dataset.attrs["points"])

    @property
    def solves(self) -> int:
        """Contacts solved, those of rolls included."""
        return int(self.dataset.attrs["solves"])

    @property
    def rolls(self) -> int:
        """Scenes rolled."""
        return int(self.dataset.attrs["rolls"])

    @cached_property
    def scene(self) -> Scene:
        """The scene with the fitted values."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            scene = self.design.fit.scene
            return scene.replace(**changes_of(scene, self.values))

    def next_tests(self) -> list[dict[str, Any]]:
        """Return the candidates of the next test, the best one first.

        Returns
        -------
        list of dict
            ``test``, ``gain`` (fall of the logarithm of the determinant of the covariance), and
            ``sd`` by key.
        """
        if "test_gain" not in self.dataset:
            return []
        columns = (self.dataset[name].values for name in ("test", "test_gain", "test_sd"))
        return [
            {
                "test": str(test),
                "gain": float(gain),
                "sd": dict(zip(self.keys, sd.tolist(), strict=True)),
            }
            for test, gain, sd in zip(*columns, strict=True)
        ]

    def estimates(self) -> list[dict[str, str]]:
        """Return a row of text for each parameter: value, deviation, interval, error of the mesh.

        The error of the mesh is the change of the estimate on a finer mesh, over the standard
        deviation.
        """
        names = ("value", "sd", "low", "high", "mesh_shift")
        columns = {name: self._named(name) for name in names}
        level = f"{self.design.fit.level:.0%}"
        rows = []
        for key in self.keys:
            value, sd, low, high, shift = (columns[name][key] for name in names)
            texts = {
                "value": f"{value:.4g}",
                "sd": f"{sd:.2g}",
                f"{level} from": f"{low:.4g}",
                f"{level} to": f"{high:.4g}",
                "finer mesh / sd": f"{shift / sd:.1g}",
            }
            known = ("value",) if not math.isfinite(sd) else tuple(texts)
            rows.append({"parameter": key} | {
                name: text if name in known and text not in ("nan", "inf") else ""
                for name, text in texts.items()
            })  # fmt: skip
        return rows

    def summary(self) -> dict[str, str]:
        """Return what the fit found, in words."""
        rows = {"title": self.title, "status": f"{self.status}; {self.dataset.attrs['message']}"}
        if not self.finished:
            return rows
        for key in self.keys:
            low, high = self.interval(key)
            level = self.design.fit.level
            known = f", {level:.0%} from {low:.4g} to {high:.4g}" if low <= high else ""
            rows[key] = f"{self.values[key]:.4g}{known or ', not determined'}"
        if self.positions:
            numbers = (f"{name} {value:.3g}" for name, value in self.positions.items())
            rows["position (mm, tilt: 1)"] = ", ".join(numbers)
        low, high = self.chi2_range
        expected = "" if math.isnan(low) else f", expected {low:.3g} to {high:.3g}"
        rows["chi-square"] = f"{self.chi2:.4g} of {self.points} points{expected}"
        rows["model error"] = _describe_model_error(self.dataset)
        rows["cost"] = f"{self.solves} contacts, {self.rolls} rolls"
        return {name: text for name, text in rows.items() if text}

    def to_dict(self) -> dict[str, Any]:
        """Return the result as ``tractive-sam show --json`` prints it: None for what is unknown."""
        if not self.finished:
            return {"status": self.status, "message": str(self.dataset.attrs["message"])}
        names = ("value", "low", "high", "sd", "mesh_shift")
        columns = {name: self._named(name) for name in names}
        parameters = {
            key: {name: _number(columns[name][key]) for name in names} for key in self.keys
        }
        rows = zip(self.keys, self.correlation, strict=True)
        return {
            "status": self.status,
            "message": str(self.dataset.attrs["message"]),
            "parameters": parameters,
            "correlation": {
                key: dict(zip(self.keys, map(_number, row), strict=True)) for key, row in rows
            },
            "undetermined": self.undetermined,
            "notes": self.notes,
            "chi2": self.chi2,
            "chi2_expected": [_number(one) for one in self.chi2_range],
            "positions": self.positions,
            "points": self.points,
            "solves": self.solves,
            "rolls": self.rolls,
            "next_tests": self.next_tests(),
        }


def _number(value: float) -> float | None:
    """Return a finite number; None otherwise."""
    return float(value) if math.isfinite(value) else None


def _describe_model_error(dataset: xarray.Dataset) -> str:
    """Describe the error of the mesh, relative to the noise."""
    if "model_error" not in dataset:
        return ""
    error, noise = np.abs(dataset["model_error"].values), dataset["noise"].values
    if not np.isfinite(error).all():
        return "not known: the finer mesh was not solved"
    share = float(np.sqrt(np.mean(np.square(error / noise))))
    return f"{share:.2g} of the noise by the mesh (root mean square)"


def is_fit(path: str | PathLike[str]) -> bool:
    """Whether a file is the result of a fit.

    Examples
    --------
    >>> from tractive_sam import fitting
    >>> fitting.is_fit("twin-discs.h5")
    False
    """
    return str(path).endswith(".nc") and netcdf_format(path).startswith("fit ")


def open_fit(path: str | PathLike[str]) -> FitResult:
    """Open the result of a fit, also of one that was interrupted.

    Raises
    ------
    ResultsError
        If the file does not exist, is damaged, or no fit of this version.

    Examples
    --------
    >>> coarse = ts.Scene.builtin("spheres").with_set(["grid.elements=[23, 23]"])
    >>> creep = {"creepage.longitudinal": [-1e-3, -4e-3], "Qx_over_P": [0.1, 0.27]}
    >>> data = {"values": creep, "vary": "creepage.longitudinal", "observe": "Qx_over_P"}
    >>> data["noise"] = 0.05
    >>> found = ts.fit({"scene": coarse, "free": ["friction.mu"], "data": [data]}, "mu.nc")
    >>> ts.open_fit("mu.nc").values == found.values
    True
    """
    if not Path(path).is_file():
        raise ResultsError(f"{path} does not exist; tractive-sam fit FIT.toml -o {path} writes it")
    dataset = read_netcdf(path)
    kind = str(dataset.attrs.get("format", ""))
    if kind != FIT_FORMAT:
        raise ResultsError(
            f"{path} is no fit of this version ({FIT_FORMAT}): {kind or 'no format'}"
        )
    if missing := {"status", "message"} - dataset.attrs.keys() or {"design"} - {*dataset}:
        raise ResultsError(f"{path} is damaged: it lacks {', '.join(missing)}; fit again")
    return FitResult(dataset)


def write_fit(path: str | PathLike[str], result: FitResult) -> None:
    """Write the result of a fit; a file that is there is replaced as a whole."""
    write_netcdf(path, result.dataset)


def make_dataset(
    variables: Mapping[str, tuple[tuple[str, ...], Any, str, str]], attributes: Mapping[str, Any]
) -> xarray.Dataset:
    """Return a dataset.

    Parameters
    ----------
    variables : mapping of str to tuple
        Dimensions, values, unit and description by name.
    attributes : mapping
        Attributes of the dataset.
    """
    with require_extra("fit"):
        import xarray  # noqa: PLC0415 - of an extra

    found = {}
    for name, (dims, values, unit, meaning) in variables.items():
        array = np.asarray(values)
        plain = array.astype(object) if array.dtype.kind == "U" else array
        found[name] = (dims, plain, {"units": unit, "long_name": meaning})
    return xarray.Dataset(found, attrs={"format": FIT_FORMAT, **attributes})


def layout_of(numbers: Mapping[str, np.ndarray]) -> str:
    """Return the names and shapes of arrays as text."""
    return json.dumps([[name, list(np.shape(one))] for name, one in numbers.items()])


def arrays_of(layout: str, flat: np.ndarray) -> dict[str, np.ndarray]:
    """Return arrays by a layout, from their numbers one after another."""
    found, first = {}, 0
    for name, shape in json.loads(layout):
        count = math.prod(shape)
        found[name] = flat[first : first + count].reshape(shape)
        first += count
    return found
