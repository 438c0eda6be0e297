"""Computations of a fit: scenes on one mesh, the compared numbers, and stored answers.

A mesh that follows the contact, and steps that follow the error, jump while parameters vary: sums
of squares would have steps. Both are chosen once, at the first values of the parameters.
"""

import hashlib
import math
import warnings
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cached_property
from operator import itemgetter
from statistics import median
from time import monotonic, process_time
from typing import Any, TypeVar

import numpy as np

from tractive_sam import interrupt
from tractive_sam.compute import ConvolutionMeter, numeric_settings
from tractive_sam.contact import LinearSolver, Model, extend_to, jacobian_of, solve_on_fitted_mesh
from tractive_sam.fitting.design import base_of, is_integer
from tractive_sam.results import BODIES, COLUMNS, Grid, History, State, index_by_name
from tractive_sam.run import read_measured_gap, roll, solve_from_nearby
from tractive_sam.scene import Scene
from tractive_sam.schema import Fault, SceneError, SeveralSolutionsWarning
from tractive_sam.studies import Workers, computed, open_workers

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
    if law is None or scene.find_exclusions("jacobian") or not set(columns) <= FORMULAS.keys():
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
        """Whether the scene is a single contact with all columns, so that nothing is rolled."""
        quantities = index_by_name(COLUMNS)
        known = (quantities[name.partition(" ")[0]].of for name in self.columns)
        return is_steady(self.scene) and None not in known

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
        The reason, if the computation failed; of one with numbers, why it may have others.
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
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("ignore")  # reported when the fit begins
        warnings.simplefilter("always", SeveralSolutionsWarning)
        answer, contact = _solve(case, start) if case.is_steady else (_roll(case), None)
    if caught and answer.numbers:
        answer = replace(answer, message=str(caught[0].message))
    return answer, contact


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


Name = TypeVar("Name", bound=Hashable)

Compute = Callable[[Sequence[FitCase]], Iterator[tuple[int, Answer]]]
"""Computes cases; yields their places and answers as they end."""


class InProcess:
    """Computes cases in this process; a contact starts from the contact of its case `near`.

    Attributes
    ----------
    seconds : list of float
        CPU times of the cases so far.
    """

    def __init__(self) -> None:
        # The last contact that had no initial guess, and its scene, of each seat.
        self._contacts: dict[tuple[int, ...], tuple[str, State | None]] = {}
        self.seconds: list[float] = []

    def __call__(self, cases: Sequence[FitCase]) -> Iterator[tuple[int, Answer]]:
        """Yield (index, answer) of each case as it is computed (`Compute`)."""
        for k, case in enumerate(cases):
            interrupt.raise_if_interrupted()
            began = process_time()
            answer, contact = compute(case, self._start_of(case))
            self.seconds.append(process_time() - began)
            if case.near is None:
                self._contacts[case.seat] = case.scene.fingerprint(), contact
            yield k, answer

    def _start_of(self, case: FitCase) -> State | None:
        """Return the initial guess of a case, solved again if a stored answer stands for it."""
        if case.near is None or not case.is_steady:
            return None
        scene, contact = self._contacts.get(case.seat, ("", None))
        if scene != case.near.scene.fingerprint():
            scene = case.near.scene.fingerprint()
            _, contact = compute(replace(case.near, derivatives=()), None)
            self._contacts[case.seat] = scene, contact
        return contact


def compute_in_turn(cases: Sequence[FitCase]) -> list[Answer]:
    """Return the answers of similar cases; runs in workers."""
    return [answer for _, answer in InProcess()(cases)]


@dataclass
class InWorkers:
    """Computes cases in worker processes, short ones in this process.

    A worker computes all contacts of one seat, which start from the same contact.

    Attributes
    ----------
    workers : Workers
        Worker processes.
    worthwhile : float
        Least CPU time of all cases that are computed together, s, in this process: shorter ones
        take longer in workers, which need time to start and know no contact to start from.
    here : InProcess
        Computes what is not worthwhile, and what comes first.
    """

    workers: Workers
    worthwhile: float = 2.0
    here: InProcess = field(default_factory=InProcess)

    def __call__(self, cases: Sequence[FitCase]) -> Iterator[tuple[int, Answer]]:
        """Yield (index, answer) of each case as it is computed (`Compute`)."""
        times = self.here.seconds
        if not times or median(times) * len(cases) < self.worthwhile:
            yield from self.here(cases)
            return
        groups: dict[tuple, list[int]] = {}
        for k, case in enumerate(cases):
            groups.setdefault(case.seat if case.is_steady else (k,), []).append(k)
        places = list(groups.values())
        calls = [(compute_in_turn, [cases[k] for k in group]) for group in places]
        for n, answers in computed(calls, self.workers):
            yield from zip(places[n], answers, strict=True)


@contextmanager
def compute_with(number: int, scheduler: str | None = None) -> Iterator[Compute]:
    """Yield what computes cases: this process, `number` processes, or workers of a scheduler.

    Parameters
    ----------
    number : int
        Processes; 0: this one.
    scheduler : str, optional
        Address of a scheduler of dask.distributed; its workers compute what is worthwhile.
    """
    if not number and scheduler is None:
        yield InProcess()
        return
    with open_workers(number, scheduler) as workers:
        yield InWorkers(workers)


@dataclass
class Evaluations:
    """Store of the answers of all cases, which computes missing ones and writes them to the file.

    Attributes
    ----------
    compute : Compute
        Computes answers that are not known.
    known : dict of str to Answer
        Answers by the digest of the case; answers of an earlier run come from its file.
    save : callable, optional
        Writes the file; called at most every `interval` seconds, and when the fit is interrupted.
    interval : float
        Least time between two writings, s. An interruption loses no more, unless one case takes
        longer.
    progress : callable, optional
        Called after each case that was computed, and after each iteration of the search.
    searched : list of (float, float)
        Time, s, and chi-square of the data of each iteration of the search.
    share : float
        Share of the cases of the last call of `answers` that are known, 0 to 1.
    part : str
        What is computed after the search; "" before.
    """

    compute: Compute
    stored: dict[str, Answer] = field(default_factory=dict)
    save: Callable[[], None] | None = None
    interval: float = 2.0
    progress: Callable[["Evaluations"], None] | None = None
    searched: list[tuple[float, float]] = field(default_factory=list)
    share: float = 0.0
    part: str = ""
    _saved: float = field(default_factory=monotonic)

    def answers(self, cases: Mapping[Name, FitCase]) -> dict[Name, Answer]:
        """Return the answers of cases, by name; those not stored yet are computed."""
        missing = {c.digest: c for c in cases.values() if c.digest not in self.stored}
        if missing:
            digests = list(missing)
            try:
                for number, (k, answer) in enumerate(self.compute(list(missing.values()))):
                    self.share = (len(cases) - len(missing) + number + 1) / len(cases)
                    self.add(digests[k], answer)
            except BaseException:
                self.write()
                raise
        return {name: self.stored[case.digest] for name, case in cases.items()}

    def remember(self, digest: str, compute: Callable[[], Answer]) -> Answer:
        """Return the stored answer of a digest, or compute it with a function and store it."""
        if digest not in self.stored:
            self.add(digest, compute())
        return self.stored[digest]

    @property
    def cost(self) -> tuple[int, int, float]:
        """Contacts, rolls and convolutions of all stored answers, earlier runs included."""
        answers = self.stored.values()
        contacts, rolls = (
            sum(getattr(answer, name) for answer in answers) for name in ("contacts", "rolls")
        )
        return contacts, rolls, sum(answer.convolutions for answer in answers)

    def begin(self, part: str) -> None:
        """Begin a part after the search, and report progress."""
        self.part = part
        if self.progress is not None:
            self.progress(self)

    def add_iteration(self, chi2: float) -> None:
        """Store the chi-square of an iteration of the search, and report progress."""
        if self.part:
            return
        self.searched.append((monotonic(), chi2))
        if self.progress is not None:
            self.progress(self)

    def seconds_left(self, small: float = 1e-3) -> float:
        """Return the expected time of the search until chi-square falls by less than `small`, s.

        Chi-square is assumed to fall by equal factors, on average over the search; nan while this
        is unknown.
        """
        if len(self.searched) < 3 or self.part:
            return math.nan
        times, chi2 = np.transpose(self.searched)
        falls = -np.diff(chi2)
        if falls[-1] <= small:
            return 0.0
        if falls[-1] >= falls[0] or falls[-2] <= 0.0:  # the standard deviations have changed
            return math.nan
        rate = math.log(falls[0] / falls[-1]) / (len(falls) - 1)
        left = math.log(falls[-1] / small) / rate
        return float(left * (times[-1] - times[0]) / len(falls))

    def add(self, digest: str, answer: Answer) -> None:
        """Store an answer in memory, report progress, and write the file at intervals."""
        self.stored[digest] = answer
        if self.progress is not None:
            self.progress(self)
        if monotonic() - self._saved > self.interval:
            self.write()

    def write(self) -> None:
        """Write the file of the fit, if it has one, with all stored answers."""
        if self.save is not None:
            self.save()
        self._saved = monotonic()


Remember = Callable[[str, Callable[[], Answer]], Answer]
"""Returns the answer of a digest; computes it if it is not known."""


@dataclass
class SharedRecords:
    """Records (revolutions or distances) that data sets observe of each scene, rolled once for all.

    Attributes
    ----------
    complete : bool
        Whether all data sets have added theirs.
    """

    complete: bool = True
    _places: dict[str, dict[str, float]] = field(default_factory=dict)

    def add(self, scene: Scene, places: list[float]) -> None:
        """Add revolutions or distances that are observed of a scene; nan is its last record."""
        places_of_scene = self._places.setdefault(scene.fingerprint(), {})
        places_of_scene |= {repr(at): at for at in places}

    def of_scene(self, scene: Scene) -> list[float]:
        """Return all revolutions or distances that are observed of a scene."""
        return list(self._places[scene.fingerprint()].values())


def drop_tables(scene: Scene, columns: Iterable[str], unworn: bool) -> Scene:
    """Return a scene without [subsurface] and [fatigue] if unneeded, and [wear] if `unworn`.

    Parameters
    ----------
    scene : Scene
        A scene.
    columns : iterable of str
        Columns of a record; "worn_mass A" is a column of body A.
    unworn : bool
        Whether the bodies are observed before they wear: then [wear] is left out as well.

    Raises
    ------
    SceneError
        If records of the scene lack a column.
    """
    # Tables that are left out if no observation needs them; steady contacts have them, too.
    costly = ("subsurface", "inclusion", "fatigue")
    quantities = index_by_name(COLUMNS)
    wanted = [quantities[name.partition(" ")[0]] for name in columns]
    if unworn and scene.wear is not None:
        scene = scene.replace(wear=None, duty=None, load_history=None)
    for name in costly:
        # Residual stress of rolling needs the yield stress of [fatigue].
        needed = name == "fatigue" and scene.subsurface is not None and scene.residual is not None
        if scene.has(name) and not needed:
            unused = {"residual": None} if name == "fatigue" else {}
            without = scene.replace(**{name: None}, **unused)
            if all(quantity.applies(without) for quantity in wanted):
                scene = without
    for quantity in wanted:
        is_of_roll = quantity.of is None and not "".join(quantity.needs).startswith(costly)
        if not quantity.applies(scene) or (is_of_roll and is_steady(scene)):
            needs = " and ".join(f"[{name}]" for name in quantity.needs) or "[wear] or [transient]"
            raise SceneError([Fault("observe", quantity.name, f"only with {needs} in the scene")])
    return scene


def check_places(scene: Scene, source: str, places: Iterable[float]) -> None:
    """Raise a SceneError if a scene has no record of observed revolutions or distances.

    Parameters
    ----------
    scene : Scene
        Scene of the rows.
    source : str
        What states the places: "at", "revolution" or "distance".
    places : iterable of float
        The places; nan stands for the last record.
    """
    observed = [at for at in places if not math.isnan(at)]
    key = "at" if source == "at" else "vary"
    along = {"wear.save": "revolution", "transient.save": "distance"}.get(scene.schedule.save_key)
    if is_steady(scene):
        along, observed = "", [at for at in observed if at or source != "at"]
    if not observed:
        return
    if not along or source not in ("at", along):
        records = f"records are by {along}" if along else "the scene is one contact"
        cure = f"{along or 'a scene with [wear] or [transient]'}: {records}"
        raise SceneError([Fault(key, f"{source} {observed[0]:g}", cure)])
    first = scene.transient.knots[0] if scene.transient else 0.0
    last = scene.schedule.end
    for at in observed:
        if along == "revolution" and at != round(at):
            raise SceneError([Fault(key, f"revolution {at:g}", "whole numbers of revolutions")])
        if along == "distance" and not first <= at <= last:
            reach = f"distances of [transient], {first:g} to {last:g} mm"
            raise SceneError([Fault(key, f"{at:g} mm", reach)])


def fix_mesh(
    scene: Scene, neighbours: Iterable[Scene], places: Sequence[float], remember: Remember
) -> dict[str, Any]:
    """Return the changes of a scene that fix its mesh and its steps while parameters vary.

    Parameters
    ----------
    scene : Scene
        Scene at the first values of the parameters.
    neighbours : iterable of Scene
        At other values of each: a mesh that these share is left to the scene.
    places : sequence of float
        Revolutions or distances that are observed, which the scene then records; nan stands for
        the last one.
    remember : callable
        Stores the steps, see `Remember`.

    Raises
    ------
    SceneError
        If the scene cannot be computed at the first values.
    """
    # Half lengths of a fixed mesh over the half axes of the contact at the first values.
    margin = 1.25
    changes: dict[str, Any] = {}
    observed = {at for at in places if not math.isnan(at)}
    if scene.transient is not None:
        changes = {"transient.save": tuple(sorted({*scene.transient.save, *observed}))}
    stated = sorted(map(round, observed))
    if scene.wear is not None and scene.wear.revolutions:
        last = any(map(math.isnan, places)) or not stated
        end = max([*stated, *([scene.wear.revolutions] if last else [])])
        saved = [n for n in scene.wear.save if n < end and scene.schedule.fixed]
        save = tuple(sorted({0, *saved, *stated, end}))
        changes = {"wear.revolutions": end, "wear.save": save}
    if changes:
        scene = scene.replace(**changes)
    grid = None
    if scene.wear is not None and scene.wear.stepping == "adaptive" and not is_steady(scene):
        steps, grid = _steps_of(scene, remember)
        changes |= {"wear.stepping": "saved", "wear.save": steps}
    if any(_mesh(neighbour) != _mesh(scene) for neighbour in neighbours):
        if grid is None:
            grid = solve_on_fitted_mesh(Model(scene, read_measured_gap(scene)))[1][0].grid
        x, y = grid.half_length
        wider = extend_to(grid, (margin * x, margin * y))
        changes |= grid_entries(wider)
    return changes


def _mesh(scene: Scene) -> tuple[Any, ...]:
    """Return half length, elements and centre of the mesh that a scene chooses."""
    grid = Model(scene, read_measured_gap(scene)).grid
    return grid.half_length, grid.elements, grid.centre


def grid_entries(grid: Grid) -> dict[str, Any]:
    """Return the [grid] entries of a scene that define a mesh, by dotted key."""
    axes = slice(grid.directions)
    entries = {"grid.half_length": grid.half_length[axes], "grid.elements": grid.elements[axes]}
    return entries | ({"grid.centre": grid.centre[axes]} if any(grid.centre) else {})


def on_finer_mesh(scene: Scene, refinement: float = 1.5) -> Scene:
    """Return a scene on an equally large mesh, `refinement` times as many elements per axis."""
    grid = Model(scene, read_measured_gap(scene)).grid
    n_x, n_y = (2 * round(0.5 * (refinement * n - 1)) + 1 if n > 1 else 1 for n in grid.elements)
    return scene.replace(**grid_entries(replace(grid, elements=(n_x, n_y))))


def _steps_of(scene: Scene, remember: Remember) -> tuple[tuple[int, ...], Grid]:
    """Return (revolutions, last mesh) of a roll with adaptive steps, computed once and stored."""
    numbers = remember(f"steps {scene.fingerprint()}", lambda: _roll_adaptively(scene)).numbers
    (x, y), (n_x, n_y) = numbers["half_length"].tolist(), numbers["elements"].tolist()
    steps = tuple(round(n) for n in numbers["steps"])
    centre = (0.0, 0.0) if scene.grid is None else scene.grid.place
    return steps, Grid((x, y), (round(n_x), round(n_y)), centre=centre)


def _roll_adaptively(scene: Scene) -> Answer:
    """Roll a scene with adaptive steps; return its revolutions and last mesh as an answer."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        history = roll(scene, progress=False)
    if not history.finished:
        cure = f"first values with which it can be rolled to its end; {history.message}"
        raise SceneError([Fault("scene", "a roll that ends early", cure)])
    numbers = {
        "steps": history["revolution"].astype(float),
        "half_length": np.array(history.grid.half_length),
        "elements": np.array(history.grid.elements, float),
    }
    contacts = int(history.totals["contact_solves"])
    return Answer(numbers, contacts, 1, float(np.nansum(history["convolutions"])))


def scale_steps(scene: Scene, changes: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return changes of a scene with the fixed steps scaled to a fitted number of revolutions."""
    end, steps = changes.get("wear.revolutions"), scene.wear.save if scene.wear else ()
    if end is None or not steps or steps[-1] == end or not is_integer(scene, "wear.revolutions"):
        return changes
    # The first jump has the rate of the unworn bodies only if it is one revolution.
    save = tuple(sorted({round(n * end / steps[-1]) for n in steps} | ({1} & {*steps})))
    return {**changes, "wear.save": save}
