"""The result of a fit, and its file."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from tractive_sam.description import html_columns, html_table, text_table
from tractive_sam.extra_packages import xarray
from tractive_sam.fitting.design import FitDesign, changes_of
from tractive_sam.safe_text import Html, as_html, fill
from tractive_sam.scene import Scene

DONE = "done"
"""Status of a fit that is complete."""


@dataclass(frozen=True, eq=False)
class Gain:
    """Candidate test with its gain in certainty, and the standard deviations after the test.

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
    """Low and high ends and standard deviations of the parameters, and likelihood curves.

    Attributes
    ----------
    low, high, sd : ndarray, shape (n,)
        Ends and standard deviations; nan and infinite if the data set none.
    curves : tuple of ndarray, shape (m, 3)
        Profile likelihood: parameter, its value, and the rise of chi-square.
    """

    low: np.ndarray
    high: np.ndarray
    sd: np.ndarray
    curves: tuple[np.ndarray, ...] = ()


@dataclass(frozen=True, eq=False)
class FitResult:
    """Result of a fit: estimates, intervals, residuals, caveats and cost, as stored in its file.

    Attributes
    ----------
    dataset : "xarray.Dataset"
        All numbers: values, intervals and correlation over ``parameter``; measured values,
        predictions, residuals and errors over ``point``; the answers of all computations.

    Examples
    --------
    >>> coarse = ts.Scene.builtin("spheres").with_set(["grid.elements=[15, 15]"])
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
        return text_table("Fit", self.summary() | self._remarks())

    def _repr_html_(self) -> Html:
        """Return the tables and the first figure of a fit as HTML, for notebooks."""
        # Figures read results; they are taken from the public package, as a user does.
        from tractive_sam.fitting import fit_figures  # noqa: PLC0415

        facts = {k: text for k, text in self.summary().items() if k not in self.keys}
        facts |= self._remarks()
        if not self.finished:
            return html_table(facts)
        figure = next(fit_figures(self)).draw()
        tables = as_html(
            fill("<b>$title</b>$table", title=title, table=html_columns(rows))
            for title, rows in self.tables().items()
        )
        return as_html((tables, html_table(facts, figure.to_html(380))))

    @cached_property
    def design(self) -> FitDesign:
        """The fit file that was fitted, with its [fit] table."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return FitDesign.from_toml_text(str(self.dataset["design"].values))

    @property
    def status(self) -> str:
        """State of the fit: "done", "running" (also if interrupted) or "not converged"."""
        return str(self.dataset.attrs["status"])

    @property
    def finished(self) -> bool:
        """Whether the fit has estimates, as the search has ended."""
        return "value" in self.dataset

    @property
    def title(self) -> str:
        """Title of the fit, or else of its scene."""
        return self.design.fit.title or self.design.fit.scene.title

    @property
    def keys(self) -> tuple[str, ...]:
        """Dotted keys of the scene that were fitted."""
        return self.design.fit.free

    def _by_key(self, name: str) -> dict[str, float]:
        """Return the values of a variable of the file, by key of the parameter."""
        return dict(zip(self.keys, self.dataset[name].values.tolist(), strict=True))

    @property
    def values(self) -> dict[str, float]:
        """Estimates of the parameters by key."""
        return self._by_key("value")

    @property
    def sd(self) -> dict[str, float]:
        """Standard deviations of the estimates by key; inf for undetermined parameters."""
        return self._by_key("sd")

    def interval(self, key: str) -> tuple[float, float]:
        """Return (low, high) of the interval of a parameter; nan where the data set no end."""
        return self._by_key("low")[key], self._by_key("high")[key]

    @property
    def correlation(self) -> np.ndarray:
        """Correlation matrix of the parameters (n, n); nan for undetermined ones."""
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
        """A sentence on each combination of parameters that the data do not determine."""
        return self._texts("undetermined")

    @property
    def notes(self) -> list[str]:
        """Caveats of the fit, as sentences."""
        return self._texts("notes")

    def _texts(self, name: str) -> list[str]:
        """Return the lines of text of a variable of the file; none if it is missing."""
        variable = self.dataset.get(name)
        return [] if variable is None else [str(text) for text in variable.values]

    @property
    def chi2(self) -> float:
        """Sum of the squares of the residuals over the noise, chi-square."""
        return float(self.dataset.attrs["chi2"])

    @property
    def data_chi2(self) -> list[tuple[float, int]]:
        """Chi-square and number of measured values of each data set; empty in earlier files."""
        if "data_chi2" not in self.dataset:
            return []
        counts = np.bincount(self.dataset["series"].values.astype(int))
        return list(zip(self.dataset["data_chi2"].values.tolist(), counts.tolist(), strict=True))

    @property
    def chi2_range(self) -> tuple[float, float]:
        """Range (low, high) in which `chi2` is expected; nan without degrees of freedom."""
        return float(self.dataset.attrs["chi2_low"]), float(self.dataset.attrs["chi2_high"])

    @property
    def points(self) -> int:
        """Number of measured values of all data sets."""
        return int(self.dataset.attrs["points"])

    @property
    def solves(self) -> int:
        """Number of contacts solved, also those within rolls."""
        return int(self.dataset.attrs["solves"])

    @property
    def rolls(self) -> int:
        """Number of scenes rolled."""
        return int(self.dataset.attrs["rolls"])

    @cached_property
    def scene(self) -> Scene:
        """The scene with the fitted values."""
        return self.rounded_scene(17)

    def rounded_scene(self, digits: int = 6) -> Scene:
        """Return the scene with the fitted values, rounded to a number of significant digits."""
        values = {key: float(f"{value:.{digits}g}") for key, value in self.values.items()}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            scene = self.design.fit.scene
            return scene.replace(**changes_of(scene, values))

    def next_tests(self) -> list[dict[str, Any]]:
        """Return the candidate tests with their gains, the best one first; empty if not ranked.

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
        """Return a row of text for each parameter: value, deviation, interval, mesh error.

        The error of the mesh is the change of the estimate on a finer mesh, over the standard
        deviation.
        """
        names = ("value", "sd", "low", "high", "mesh_shift")
        columns = {name: self._by_key(name) for name in names}
        level = f"{self.design.fit.level:.0%}"
        rows = []
        for key in self.keys:
            value, sd, low, high, shift = (columns[name][key] for name in names)
            texts = {
                "value": f"{value:.4g}",
                "sd": f"{sd:.2g}" if sd < 99.5 else f"{sd:.3g}",
                f"{level} from": f"{low:.4g}",
                f"{level} to": f"{high:.4g}",
                "finer mesh / sd": f"{shift / sd:.1g}" if math.isfinite(sd) else "",
            }
            rows.append({"parameter": key} | {
                name: "" if text in ("nan", "inf") else text for name, text in texts.items()
            })  # fmt: skip
        return rows

    def tables(self) -> dict[str, list[dict[str, str]]]:
        """Return tables of a fit as rows of text: estimates, correlation and next tests."""
        tables = {"Estimates": self.estimates()}
        if len(self.keys) > 1:
            tables["Correlation"] = [
                {"": key} | {
                    column: "" if math.isnan(number) else f"{number:.2f}"
                    for column, number in zip(self.keys, numbers, strict=True)
                }
                for key, numbers in zip(self.keys, self.correlation, strict=True)
            ]  # fmt: skip
        if tests := self.next_tests():
            tables["Next test"] = [
                {"next test": test["test"], "gain": f"{test['gain']:.3g}"}
                | {f"sd of {key}": f"{sd:.3g}" for key, sd in test["sd"].items()}
                for test in tests
            ]
        return tables

    def _remarks(self) -> dict[str, str]:
        """Return undetermined parameters and caveats, if any, as rows of a description."""
        rows = {"not determined": "; ".join(self.undetermined), "notes": "; ".join(self.notes)}
        return {name: text for name, text in rows.items() if text}

    def summary(self) -> dict[str, str]:
        """Return the result as text by name: estimates, chi-square, model error, cost."""
        rows = {"title": self.title, "status": f"{self.status}; {self.dataset.attrs['message']}"}
        if not self.finished:
            return rows
        for key in self.keys:
            low, high = self.interval(key)
            level = self.design.fit.level
            interval = f", {level:.0%} from {low:.4g} to {high:.4g}" if low <= high else ""
            rows[key] = f"{self.values[key]:.4g}{interval or ', not determined'}"
        if self.positions:
            numbers = (f"{name} {value:.3g}" for name, value in self.positions.items())
            rows["position (mm, tilt: 1)"] = ", ".join(numbers)
        low, high = self.chi2_range
        expected = "" if math.isnan(low) else f", expected {low:.3g} to {high:.3g}"
        rows["chi-square"] = f"{self.chi2:.4g} of {self.points} points{expected}"
        if len(self.data_chi2) > 1:
            parts = zip(self.design.fit.names, self.data_chi2, strict=True)
            rows["by data set"] = ", ".join(f"{name} {c:.3g} of {n}" for name, (c, n) in parts)
        rows["model error"] = _describe_model_error(self.dataset)
        rows["cost"] = f"{self.solves} contacts, {self.rolls} rolls"
        return {name: text for name, text in rows.items() if text}

    def to_dict(self) -> dict[str, Any]:
        """Return the result as ``tractive-sam show --json`` prints it; None for unknown numbers."""
        if not self.finished:
            return {"status": self.status, "message": str(self.dataset.attrs["message"])}
        names = ("value", "low", "high", "sd", "mesh_shift")
        columns = {name: self._by_key(name) for name in names}
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
            "data_chi2": [{"chi2": value, "points": points} for value, points in self.data_chi2],
            "chi2_expected": [_number(limit) for limit in self.chi2_range],
            "positions": self.positions,
            "points": self.points,
            "solves": self.solves,
            "rolls": self.rolls,
            "next_tests": self.next_tests(),
        }


def _number(value: float) -> float | None:
    """Return a finite number as float, and None for nan and inf."""
    return float(value) if math.isfinite(value) else None


def _describe_model_error(dataset: xarray.Dataset) -> str:
    """Return the error of the mesh relative to the noise as text; "" if not computed."""
    if "model_error" not in dataset:
        return ""
    error, noise = np.abs(dataset["model_error"].values), dataset["noise"].values
    if not np.isfinite(error).all():
        return "not known: the finer mesh was not solved"
    share = float(np.sqrt(np.mean(np.square(error / noise))))
    return f"{share:.2g} of the noise by the mesh (root mean square)"
