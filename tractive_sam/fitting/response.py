"""Numbers of a scene as functions of some of its keys, and the files of questions about them.

A question evaluates many points, with the computations, stores and workers of a fit. A point that
cannot be computed has no numbers and a message; it is never left out.
"""

from __future__ import annotations

import json
import math
import re
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Any, ClassVar, TypeVar

import numpy as np

from tractive_sam.description import format_with_unit, html_columns, html_table, text_table
from tractive_sam.extra_packages import xarray
from tractive_sam.extras import check_extra
from tractive_sam.fitting.case import (
    Answer,
    Evaluations,
    FitCase,
    Reply,
    check_places,
    compute_with,
    drop_tables,
    exact_columns,
    fix_mesh,
    is_steady,
    scale_steps,
)
from tractive_sam.fitting.design import (
    QuestionDocument,
    changes_of,
    column_of,
    is_profile,
    observation_faults,
)
from tractive_sam.plot import Drawing
from tractive_sam.results import COLUMNS, Quantity, index_by_name
from tractive_sam.run import describe_differences
from tractive_sam.safe_text import Html, as_html, fill
from tractive_sam.scene import Scene, describe_changes, hashes_of
from tractive_sam.schema import Fault, SceneError, ValidEntries
from tractive_sam.store import DamagedError, ResultsError, read_netcdf, versions, write_netcdf


def make_dataset(
    variables: Mapping[str, tuple[Sequence[str], Any, str, str]], attributes: Mapping[str, Any]
) -> xarray.Dataset:
    """Return an xarray Dataset from variables (dimensions, values, unit, description).

    Parameters
    ----------
    variables : mapping of str to tuple
        Dimensions, values, unit and description by name.
    attributes : mapping
        Attributes of the dataset.
    """
    check_extra("xarray", "netCDF files")
    data_variables = {}
    for name, (dims, values, unit, meaning) in variables.items():
        array = np.asarray(values)
        plain = array.astype(object) if array.dtype.kind == "U" else array
        data_variables[name] = (dims, plain, {"units": unit, "long_name": meaning})
    return xarray.Dataset(data_variables, attrs=dict(attributes))


def restore_answers(data: Any) -> dict[str, Answer]:
    """Return the answers by digest from the variables of a dataset."""
    flat, answers, first = data["answer_numbers"].values, {}, 0
    names = ("answer", "answer_layout", "answer_message", "answer_cost")
    for digest, layout, message, cost in zip(*(data[name].values for name in names), strict=True):
        numbers = arrays_of(str(layout), flat[first:])
        first += sum(array.size for array in numbers.values())
        contacts, rolls, convolutions = cost.tolist()
        answers[str(digest)] = Answer(
            numbers, int(contacts), int(rolls), convolutions, str(message)
        )
    return answers


def answer_variables(answers: Mapping[str, Answer]) -> dict[str, tuple]:
    """Return the variables that store the answers of all computations; {} without any."""
    if not answers:
        return {}
    numbers = [np.ravel(array) for answer in answers.values() for array in answer.numbers.values()]
    layouts = [
        json.dumps([[name, list(np.shape(array))] for name, array in answer.numbers.items()])
        for answer in answers.values()
    ]
    messages = [answer.message for answer in answers.values()]
    costs = [(answer.contacts, answer.rolls, answer.convolutions) for answer in answers.values()]
    flat = np.concatenate([np.zeros(0), *numbers, np.zeros(1)])
    return {
        "answer": (("answers",), [*answers], "1", "hash of a computation"),
        "answer_layout": (("answers",), layouts, "1", "names and shapes of its numbers"),
        "answer_message": (("answers",), messages, "1", "why it failed"),
        "answer_cost": (("answers", "cost"), costs, "1", "contacts, rolls, transforms"),
        "answer_numbers": (("numbers",), flat, "1", "numbers of all computations"),
    }


def arrays_of(layout: str, flat: np.ndarray) -> dict[str, np.ndarray]:
    """Return arrays by name from their layout and all their numbers in one flat array."""
    arrays, first = {}, 0
    for name, shape in json.loads(layout):
        count = math.prod(shape)
        arrays[name] = flat[first : first + count].reshape(shape)
        first += count
    return arrays


@dataclass(frozen=True)
class Outcome:
    """Number of a record of a scene.

    Attributes
    ----------
    column : str
        Column of a record; "worn_mass A" is a column of body A.
    place : float
        Revolution or distance of the record; nan: the last one.
    """

    column: str
    place: float = math.nan

    def __str__(self) -> str:
        return self.column if math.isnan(self.place) else f"{self.column} at {self.place:g}"


def quantity_of(name: str, scene: Scene) -> Quantity:
    """Return the quantity of an outcome, as "p_max at 5, scene 2", with its unit in a scene."""
    return index_by_name(COLUMNS)[re.split("[ ,]", name)[0]].with_units_of(scene)


def name_with_unit(name: str, scene: Scene) -> str:
    """Return the name of an outcome and its unit, as "p_max at 5 (MPa)"."""
    return format_with_unit(name, quantity_of(name, scene).unit)


def label_of(name: str, scene: Scene) -> str:
    """Return the axis label of an outcome, as "worn_mass A at 5, scene 2", with its unit."""
    quantity = quantity_of(name, scene)
    symbol, rest = quantity.symbol, name.removeprefix(quantity.name)
    label = f"${symbol}$" if symbol and not quantity.dims else quantity.name.replace("_", " ")
    return format_with_unit(label + re.sub("^ (?=[AB])", " of body ", rest), quantity.unit)


def check_observed(entries: ValidEntries) -> Iterator[Fault]:
    """Yield faults of the columns that a table observes."""
    observed = entries["observe"]
    for text in [observed] if isinstance(observed, str) else observed:
        yield from outcome_faults(text)


def outcome_faults(text: str) -> Iterator[Fault]:
    """Yield faults of a text that names no number of a record, as "worn_mass A"."""
    name, _, body = text.partition(" ")
    faults = [*observation_faults(name, body or None)]
    if body not in ("", "A", "B"):
        faults.append(Fault("observe", text, 'a column, or one of a body as "worn_mass A"'))
    elif body and not faults and index_by_name(COLUMNS)[name].dims != ("body",):
        faults.append(Fault("observe", text, f"{name} without a body"))
    elif not faults and is_profile(name):
        faults.append(Fault("observe", text, "a number of a record"))
    for fault in faults:
        cure = f'the column of a body, as "{name} A"'
        yield Fault("observe", text, cure) if fault.key == "body" else fault


def read_outcome(text: str, place: float | None) -> Outcome:
    """Return the outcome that a valid text names, at a place; None: the last record."""
    name, _, body = text.partition(" ")
    return Outcome(column_of(name, body or None), math.nan if place is None else place)


@dataclass(frozen=True, eq=False)
class Response:
    """Outcomes of scenes as functions of the values of keys.

    Attributes
    ----------
    scenes : tuple of Scene
        The S scenes, with the records that the outcomes need and fixed steps.
    keys : tuple of str
        Dotted keys that vary.
    outcomes : tuple of Outcome
        Numbers of each scene: m for all scenes, those of the first scene first.
    done : Evaluations
        Store of all answers.
    """

    groups: ClassVar[int] = 64
    """Groups of contacts that are distributed: enough for all workers, each of several contacts."""

    scenes: tuple[Scene, ...]
    keys: tuple[str, ...]
    outcomes: tuple[Outcome, ...]
    done: Evaluations

    @classmethod
    def prepare(
        cls,
        scenes: Sequence[Scene],
        keys: Sequence[str],
        start: np.ndarray,
        outcomes: Sequence[Outcome],
        done: Evaluations,
    ) -> Response:
        """Check the outcomes at first values of the keys, and fix the steps of a roll there.

        The mesh is left to each scene, so that its error varies little and no contact outgrows it.

        Raises
        ------
        SceneError
            If a scene is not valid there, or does not have these outcomes.
        """
        given = cls(tuple(scenes), tuple(keys), tuple(outcomes), done)
        places, fixed = [*given.places], list[Scene]()
        for number, scene in enumerate(scenes):
            first = given.scene_at(start, number)
            check_places(first, "at", places)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                changes = {} if is_steady(first) else fix_mesh(first, (), places, done.remember)
                fixed.append(scene.replace(**changes))
        return replace(given, scenes=tuple(fixed))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all m outcomes."""
        several = len(self.scenes) > 1
        return tuple(f"{one}, scene {number + 1}" if several else str(one)
                     for number in range(len(self.scenes)) for one in self.outcomes)  # fmt: skip

    @property
    def places(self) -> tuple[float, ...]:
        """Revolutions or distances of the outcomes."""
        return tuple({repr(one.place): one.place for one in self.outcomes}.values())

    @property
    def columns(self) -> tuple[str, ...]:
        """Columns of records that the outcomes need."""
        return tuple(dict.fromkeys(one.column for one in self.outcomes))

    def on_mesh(self, change: Callable[[Scene], Scene], start: np.ndarray) -> Response:
        """Return the response with the number of elements that a function gives each scene.

        Parameters
        ----------
        change : callable
            Returns a scene on another mesh.
        start : ndarray, shape (d,)
            Values of the keys at which the mesh is chosen.
        """
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            meshes = [change(self.scene_at(start, n)).settings()["grid"]["elements"]
                      for n in range(len(self.scenes))]  # fmt: skip
            pairs = zip(self.scenes, meshes, strict=True)
            scenes = tuple(one.replace(**{"grid.elements": mesh}) for one, mesh in pairs)
        return replace(self, scenes=scenes)

    def scene_at(self, point: np.ndarray, number: int = 0) -> Scene:
        """Return a scene at values of the keys, without tables that no outcome needs.

        Raises
        ------
        SceneError
            If it is not valid.
        """
        values = dict(zip(self.keys, np.asarray(point, float).tolist(), strict=True))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            scene = self.scenes[number]
            changes = scale_steps(scene, changes_of(scene, values))
            unworn = all(one.place == 0.0 for one in self.outcomes)
            return drop_tables(scene.replace(**changes), self.columns, unworn)

    def evaluate(self, points: np.ndarray) -> tuple[np.ndarray, list[str]]:
        """Return the outcomes at points, and why they could not be computed.

        Parameters
        ----------
        points : ndarray, shape (n, d)
            Values of the keys.

        Returns
        -------
        values : ndarray, shape (n, m)
            Outcomes; nan for points that could not be computed.
        messages : list of str
            Reason for each point; empty if it was computed.
        """
        cases = dict[tuple[int, int], FitCase]()
        messages = [""] * len(points)
        for k, point in enumerate(points):
            try:
                cases |= {(k, n): self._case(point, (k, n)) for n in range(len(self.scenes))}
            except SceneError as error:
                messages[k] = str(error.faults[0])
        values = np.full((len(points), len(self.scenes), len(self.outcomes)), math.nan)
        for (k, n), answer in self.done.answers(cases).items():
            values[k, n], message = self._read(cases[k, n], answer)
            messages[k] = messages[k] or message
        return values.reshape(len(points), -1), messages

    def _case(
        self, point: np.ndarray, seat: tuple[int, int], derivatives: tuple[str, ...] = ()
    ) -> FitCase:
        """Return the computation of point k of scene n, the `seat`; similar ones form a group."""
        k, n = seat
        scene = self.scene_at(point, n)
        places = (math.nan,) if is_steady(scene) else self.places
        return FitCase(scene, self.columns, places, derivatives, (k % self.groups, n))

    def _read(self, case: FitCase, answer: Answer) -> tuple[np.ndarray, str]:
        """Return the outcomes of an answer, and why it has none."""
        reply = Reply(case, answer)
        if reply.failed:
            return np.full(len(self.outcomes), math.nan), answer.message
        values = np.array([reply.at(one.column, [one.place])[0] for one in self.outcomes])
        infinite = [str(one) for one, x in zip(self.outcomes, values, strict=True)
                    if not math.isfinite(x)]  # fmt: skip
        if infinite:
            return np.full(values.size, math.nan), f"{', '.join(infinite)} has no finite value"
        return values, ""

    def exact_slopes(self, point: np.ndarray) -> np.ndarray:
        """Return derivatives of the outcomes by the keys, (m, d); nan where none are exact."""
        shape = len(self.scenes), len(self.outcomes), len(self.keys)
        slopes, cases, columns = np.full(shape, math.nan), {}, {}
        for n in range(len(self.scenes)):
            scene = self.scene_at(point, n)
            if is_steady(scene):
                columns[n] = exact_columns(scene, self.columns, self.keys)
            if columns.get(n):
                cases[n] = self._case(point, (0, n), tuple(columns[n].values()))
        for n, answer in self.done.answers(cases).items():
            for j, key in enumerate(self.keys):
                for i, one in enumerate(self.outcomes):
                    name = f"{one.column}/{columns[n].get(key)}"
                    slopes[n, i, j] = answer.numbers.get(name, [math.nan])[0]
        return slopes.reshape(-1, len(self.keys))


@dataclass(frozen=True, eq=False)
class QuestionResult:
    """Result of a question, as its file stores it.

    Attributes
    ----------
    dataset : "xarray.Dataset"
        All numbers, and the answers of all computations.
    """

    document: ClassVar[type[QuestionDocument]]
    """Class of the file of the question."""
    variables: ClassVar[Mapping[str, tuple[str, str, str]]] = {}
    """Dimensions, unit ("": text) and meaning of the variables of a complete result, by name."""

    dataset: xarray.Dataset

    @classmethod
    def kind(cls) -> str:
        """Return the name of the question: its command, its table, and its format."""
        return cls.document.error_class.subject

    def __repr__(self) -> str:
        rows = self.summary() | {"notes": "; ".join(self.notes)}
        return text_table(self.kind().capitalize(), {k: text for k, text in rows.items() if text})

    def _repr_html_(self) -> Html:
        """Return the tables and the first figure as HTML, for notebooks."""
        if not self.finished:
            return html_table(self.summary())
        tables = as_html(
            fill("<b>$title</b>$table", title=title, table=html_columns(rows))
            for title, rows in self.tables().items()
        )
        figure = next(self.drawings()).draw()
        facts = self.summary() | {"notes": "; ".join(self.notes)}
        return as_html((tables, html_table(facts, figure.to_html(380))))

    @cached_property
    def design(self) -> Any:
        """The file of the question."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return self.document.from_toml_text(str(self.dataset["design"].values))

    @property
    def status(self) -> str:
        """State: "done", "running" (also if interrupted), or why it is not done."""
        return str(self.dataset.attrs["status"])

    @property
    def message(self) -> str:
        """How it ended."""
        return str(self.dataset.attrs["message"])

    @property
    def finished(self) -> bool:
        """Whether the file has a result, and not only computations."""
        return self.status != "running"

    @property
    def title(self) -> str:
        """Title of the question, or else of its scene."""
        table = getattr(self.design, self.kind())
        return table.title or table.scene.title

    @property
    def keys(self) -> tuple[str, ...]:
        """Keys that are varied."""
        return self.texts("input") if self.finished else ()

    @property
    def notes(self) -> tuple[str, ...]:
        """What the result rests on and leaves open, as sentences."""
        return self.texts("notes")

    def texts(self, name: str) -> tuple[str, ...]:
        """Return the lines of a variable of the file; none if it is missing."""
        return tuple(map(str, self.dataset[name].values)) if name in self.dataset else ()

    def numbers(self, name: str) -> np.ndarray:
        """Return a variable of the file as an array."""
        return self.dataset[name].values

    def summary(self) -> dict[str, str]:
        """Return status and cost as text by name."""
        rows = {"title": self.title, "status": f"{self.status}; {self.message}"}
        cost = self.dataset.attrs.get("cost", "")
        return rows | ({"cost": str(cost)} if cost else {})

    def tables(self) -> dict[str, list[dict[str, str]]]:
        """Return the tables of the result as rows of text, by title."""
        raise NotImplementedError

    def drawings(self) -> Iterator[Drawing]:
        """Yield the figures, to be drawn."""
        raise NotImplementedError

    def to_dict(self) -> dict[str, Any]:
        """Return the result as ``tractive-sam show --json`` prints it; None for unknown numbers."""
        content: dict[str, Any] = {"status": self.status, "message": self.message}
        shown = {name: self.dataset[name] for name in self.variables if name in self.dataset}
        return content | {
            name: _plain(variable.values.tolist()) for name, variable in shown.items()
        }

    def check(self) -> None:
        """Raise a ValueError or SceneError unless the file has what its design needs."""
        data, design = self.dataset, self.design
        getattr(design, self.kind())
        if not self.finished:
            return
        for name, (dims, unit, _) in self.variables.items():
            if name not in data:
                raise ValueError(f"it lacks {name}")
            kinds = "biuf" if unit else "OSU"
            if data[name].dims != tuple(dims.split()) or data[name].dtype.kind not in kinds:
                raise ValueError(f"{name}: another shape or type")


def _plain(value: Any) -> Any:
    """Return nested lists with None for numbers that are not finite."""
    if isinstance(value, list):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


Result = TypeVar("Result", bound=QuestionResult)


def open_question(path: str | PathLike[str], kind: type[Result]) -> Result:
    """Return the result of a question from its file, also of one that was interrupted.

    Raises
    ------
    ResultsError
        If the file does not exist, is damaged, or has another content.
    """
    name = kind.kind()
    command = f"tractive-sam {name} {name.upper()}.toml -o {path}"
    if not Path(path).is_file():
        raise ResultsError(f"{path} does not exist; {command} writes it")
    dataset = read_netcdf(path, f"remove it; {command} writes it again")
    found = str(dataset.attrs.get("format", ""))
    if found != f"{name} 1":
        raise ResultsError(f"{path} has the format {found or 'none'}, not {name} 1; {command}")
    result = kind(dataset)
    try:
        if missing := ({"status", "message"} - dataset.attrs.keys()) | ({"design"} - {*dataset}):
            raise ValueError(f"it lacks {', '.join(sorted(missing))}")
        result.check()
    except (SceneError, TypeError, ValueError, KeyError) as error:
        raise DamagedError(f"{path} is damaged ({error}): remove it; {command}") from error
    return result


Progress = Callable[[Evaluations], None]
"""Called after each computation."""


def run_question(
    kind: type[Result],
    document: Any,
    path: str | PathLike[str] | None,
    answer: Callable[[Any, Evaluations], tuple[dict[str, Any], dict[str, Any]]],
    *,
    workers: int,
    scheduler: str | None,
    overwrite: bool,
    progress: Progress | None,
) -> Result:
    """Answer a question with the stored computations of an earlier run, and store the result.

    Parameters
    ----------
    kind : type
        Class of the result.
    document : QuestionDocument
        The question.
    path : path-like or None
        Its file, to which computations are streamed.
    answer : callable
        Returns variables and attributes of the result from the document and the evaluations.
    workers, scheduler, overwrite, progress
        See `tractive_sam.spread`.

    Raises
    ------
    ResultsError
        If the file is that of another question, or of another scene.
    """
    for name in ("xarray", "h5netcdf"):
        check_extra(name, kind.kind())
    document = document.fix_files()
    files = hashes_of(document.scenes)
    stored = {} if path is None else _read_stored(kind, path, document.scenes, files, overwrite)
    with compute_with(workers, scheduler) as compute:
        done = Evaluations(compute, stored, interval=5.0, progress=progress)
        design = {"design": ((), document.to_toml(), "1", "the file of the question")}
        shared = {"format": f"{kind.kind()} 1", "version": versions()["tractive-sam"]}
        shared |= {"files": json.dumps(files)}

        def write(values: Mapping[str, Any], attributes: Mapping[str, Any]) -> Result:
            contacts, rolls, _ = done.cost
            variables = {name: (dims.split(), values[name], unit, meaning)
                         for name, (dims, unit, meaning) in kind.variables.items()
                         if name in values}  # fmt: skip
            numbers = design | variables | answer_variables(done.stored)
            cost = {"cost": f"{contacts} contacts, {rolls} rolls"}
            result = kind(make_dataset(numbers, shared | cost | dict(attributes)))
            if path is not None:
                write_netcdf(path, result.dataset)
            return result

        def save() -> None:
            text = f"computations stored: {len(done.stored)}; run it again to resume"
            write({}, {"status": "running", "message": text})

        done.save = None if path is None else save
        return write(*answer(document, done))


def _read_stored(
    kind: type[Result],
    path: Any,
    scenes: tuple[Scene, ...],
    files: Mapping[str, str],
    overwrite: bool,
) -> dict[str, Answer]:
    """Return the answers in a file by digest; {} if it is missing or of another version."""
    if not Path(path).exists():
        return {}
    before = open_question(path, kind)
    changed = describe_changes(files, json.loads(str(before.dataset.attrs.get("files", "{}"))))
    of_file = before.design.scenes
    if changed or of_file != scenes:
        if overwrite:
            return {}
        different = "; ".join(describe_differences(one, new, free=())
                              for one, new in zip(of_file, scenes, strict=False))  # fmt: skip
        reason = "; ".join(filter(None, (different, changed and f"{changed} has changed")))
        cure = "-o FILE.nc gives this one another file, --overwrite replaces it"
        raise ResultsError(f"{path} holds the {kind.kind()} of another scene ({reason}); {cure}")
    if before.dataset.attrs.get("version") != versions()["tractive-sam"]:
        return {}  # another version may compute other numbers
    try:
        return restore_answers(before.dataset) if "answer" in before.dataset else {}
    except Exception as error:  # of numbers and texts that were changed
        raise DamagedError(f"{path} is damaged ({error}): remove it, and run it again") from error
