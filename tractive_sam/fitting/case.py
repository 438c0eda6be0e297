"""One computation of a fit: a scene, the numbers that are compared, and their derivatives."""

import hashlib
import math
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from operator import itemgetter
from typing import Any

import numpy as np

from tractive_sam.compute import ConvolutionMeter, numeric_settings
from tractive_sam.contact import LinearSolver, Model, jacobian_of
from tractive_sam.fitting.design import base_of
from tractive_sam.results import BODIES, COLUMNS, History, State, index_by_name
from tractive_sam.run import read_measured_gap, roll, solve_from_nearby
from tractive_sam.scene import Scene

RESULTS = ("Qx", "Qy", "Mz", "approach", "P", "xi_x", "xi_y", "spin")
"""Rows and columns of the Jacobian, see `State.jacobian`."""

FORMULAS: Mapping[str, Callable[[Mapping[str, complex]], complex]] = {
    **{name: itemgetter(name) for name in RESULTS},
    "Qx_over_P": lambda of: of["Qx"] / of["P"],
    "Qy_over_P": lambda of: of["Qy"] / of["P"],
    "t_gamma": lambda of: -(of["Qx"] * of["xi_x"] + of["Qy"] * of["xi_y"] + of["Mz"] * of["spin"]),
}
"""Columns of a record with derivatives that follow from the Jacobian."""


def derivatives_of(
    columns: Sequence[str], wanted: Sequence[str], contact: State, jacobian: Any
) -> dict[str, np.ndarray]:
    """Return derivatives of columns by Jacobian parameters, "column/parameter", by complex steps.

    Parameters
    ----------
    columns : sequence of str
        Columns; those without a formula are left out.
    wanted : sequence of str
        Columns of the Jacobian.
    contact : State
        The contact.
    jacobian : "xarray.DataArray"
        Jacobian of the contact.

    Returns
    -------
    dict of str to ndarray, shape (1,)
        "Qx/P" is the derivative of Qx with respect to P.
    """
    tiny = 1e-30
    rows = [str(name) for name in jacobian.coords["result"].values]
    values = {name: float(getattr(contact, name)) for name in RESULTS}
    derivatives = {}
    for parameter in wanted:
        change = dict.fromkeys(RESULTS, 0.0)
        if parameter in change:
            change[parameter] = 1.0
        column = jacobian.loc[:, parameter].values
        change |= {row: float(value) for row, value in zip(rows, column, strict=True)}
        moved = {name: values[name] + 1j * tiny * change[name] for name in RESULTS}
        for name in filter(FORMULAS.__contains__, columns):
            slope = complex(FORMULAS[name](moved)).imag / tiny
            derivatives[f"{name}/{parameter}"] = np.array([slope])
    return derivatives


def exact_columns(scene: Scene, columns: tuple[str, ...], keys: tuple[str, ...]) -> dict[str, str]:
    """Return the Jacobian column of keys with exact derivatives; {} if a column has no formula."""
    # Columns of the Jacobian by the keys of their parameters.
    columns_of = {
        "creepage.longitudinal": "xi_x",
        "creepage.lateral": "xi_y",
        "creepage.spin": "spin",
        "load.normal": "P",
        "friction.mu": "mu",
        "friction.mu[0]": "mu1",
        "friction.mu[1]": "mu2",
    }
    law = scene.friction
    if law is None or any(name not in FORMULAS for name in columns):
        return {}
    coulomb = law.law == "constant" and law.strength is None and law.temperature is None
    load = scene.load
    sought = {name for name, force in (("xi_x", load.force_x), ("xi_y", load.force_y))
              if force is not None}  # fmt: skip
    exact = {}
    for key in keys:
        column = columns_of.get(key, "")
        is_exact = column not in sought and (coulomb or base_of(key) != "friction.mu")
        if column and is_exact and (column != "P" or load.normal is not None):
            exact[key] = column
    return exact


Y = "y"
"""Name of the lateral places of a profile among the numbers of an answer."""


@dataclass(frozen=True, eq=False)
class FitCase:
    """One computation of a fit: a scene, and the columns and records that the fit reads from it.

    Attributes
    ----------
    scene : Scene
        Scene to compute.
    columns : tuple of str
        Requested columns of its records; "worn_mass A" is a column of body A.
    places : tuple of float
        Revolutions or distances of the records; nan stands for the last one.
    derivatives : tuple of str
        Requested columns of the Jacobian, if the scene is one contact.
    seat : tuple of int
        Cases of one seat are similar.
    near : FitCase, optional
        Case whose contact is the initial guess, if it is steady; it has none itself, so that the
        answer does not depend on the cases that were computed before.
    """

    scene: Scene
    columns: tuple[str, ...]
    places: tuple[float, ...] = (math.nan,)
    derivatives: tuple[str, ...] = ()
    seat: tuple[int, ...] = ()
    near: "FitCase | None" = None

    @property
    def is_steady(self) -> bool:
        """Whether the scene of the case is a single contact, so that nothing is rolled."""
        return is_steady(self.scene)

    @cached_property
    def digest(self) -> str:
        """Hash of scene, columns, places and derivatives, which determine the answer."""
        parts = (self.scene.fingerprint(), self.columns, self.places, self.derivatives)
        return hashlib.sha256(repr(parts).encode()).hexdigest()[:32]


@dataclass(frozen=True, eq=False)
class Answer:
    """Computed numbers of a case by column, its cost, and why it failed if it did.

    Attributes
    ----------
    numbers : mapping of str to ndarray
        Column: shape (places,), of a profile (places, n_y), and its `Y`; "Qx/P": the derivative of
        Qx with respect to P. Empty if the computation failed.
    contacts, rolls, convolutions : float
        Contacts solved, rolls, and transforms.
    message : str
        The reason, if the computation failed.
    """

    numbers: Mapping[str, np.ndarray] = field(default_factory=dict)
    contacts: int = 0
    rolls: int = 0
    convolutions: float = 0.0
    message: str = ""


@dataclass(frozen=True, eq=False)
class Reply:
    """A case together with its computed answer."""

    case: FitCase
    answer: Answer

    @property
    def failed(self) -> bool:
        """Whether the computation of the case failed: the answer has no numbers."""
        return not self.answer.numbers

    def at(self, name: str, places: Sequence[float]) -> np.ndarray:
        """Return a column at requested revolutions or distances; a lone record serves all.

        Parameters
        ----------
        name : str
            Its name in `Answer.numbers`.
        places : sequence of float
            Places of the case.
        """
        numbers = self.answer.numbers[name]
        names = list(map(repr, self.case.places))
        return numbers[[names.index(repr(at)) if len(numbers) > 1 else 0 for at in places]]


def merge_cases(cases: Iterable[FitCase]) -> dict[str, FitCase]:
    """Return one case for each scene, by its fingerprint, with all requested columns and places."""
    by_fingerprint: dict[str, FitCase] = {}
    for case in cases:
        name = case.scene.fingerprint()
        earlier = by_fingerprint.get(name, case)
        places = {repr(at): at for at in (*earlier.places, *case.places)}
        by_fingerprint[name] = FitCase(
            case.scene,
            tuple(dict.fromkeys((*earlier.columns, *case.columns))),
            tuple(places.values()),
            tuple(dict.fromkeys((*earlier.derivatives, *case.derivatives))),
            earlier.seat,
            earlier.near,
        )
    return by_fingerprint


def is_steady(scene: Scene) -> bool:
    """Return whether a scene is a single contact: nothing is rolled."""
    return not scene.schedule.end and not scene.duty


@numeric_settings()
def compute(case: FitCase, start: State | None = None) -> tuple[Answer, State | None]:
    """Solve or roll the scene of a case; return (answer, contact), None for a roll or failure.

    Parameters
    ----------
    case : Case
        The case.
    start : State, optional
        The contact of a similar case: the initial guess if the meshes are equal.

    Returns
    -------
    answer : Answer
        The numbers.
    contact : State or None
        The contact of a case of one contact, if it was solved.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # reported when the fit begins
        return _solve(case, start) if case.is_steady else (_roll(case), None)


def _solve(case: FitCase, start: State | None) -> tuple[Answer, State | None]:
    """Solve the single contact of a case; return (answer, contact), None instead if it failed."""
    model, contact = solve_from_nearby(Model(case.scene, read_measured_gap(case.scene)), start)
    if not contact.converged:
        return Answer({}, 1, 0, contact.cost.convolutions, contact.message), None
    numbers = {name: np.array([read_quantity(contact, name)]) for name in case.columns}
    meter = ConvolutionMeter(model.operators.lattice.padded)
    if case.derivatives:
        # Derivatives choose the direction of a search and the intervals, to three digits.
        solver = LinearSolver(tolerance=1e-3)
        jacobian = jacobian_of(model, contact, case.derivatives, solver)
        numbers |= derivatives_of(case.columns, case.derivatives, contact, jacobian)
    return Answer(numbers, 1, 0, contact.cost.convolutions + meter.convolutions), contact


def _roll(case: FitCase) -> Answer:
    """Roll the scene of a case and return columns at its places, or why the run failed."""
    history = roll(case.scene, progress=False)
    cost = int(history.totals["contact_solves"]), 1, float(np.nansum(history["convolutions"]))
    if not history.finished:
        return Answer({}, *cost, history.message)
    places = history[history.coordinate.name]
    rows = []
    for at in case.places:
        row = len(places) - 1 if math.isnan(at) else int(np.abs(places - at).argmin())
        if abs(places[row] - at) > 1e-9 * max(1.0, abs(at)):
            return Answer({}, *cost, f"no record at {history.coordinate.name} {at:g}")
        rows.append(row)
    numbers = {name: _column(history, name)[rows] for name in case.columns}
    if any(column.ndim == 2 for column in numbers.values()):
        numbers[Y] = history.y
    return Answer(numbers, *cost)


def read_quantity(contact: State, name: str) -> float:
    """Return a scalar result of a contact by column name; "name A" reads the column of body A."""
    plain, _, body = name.partition(" ")
    of = index_by_name(COLUMNS)[plain].of
    value: Any = math.nan if of is None else of(contact)
    return float(value[body] if body else value)


def _column(history: History, name: str) -> np.ndarray:
    """Return a column of a history, one value or row a record; "name A" is the column of body A."""
    plain, _, body = name.partition(" ")
    column = history[plain]
    return column[:, BODIES.index(body)] if body else column
