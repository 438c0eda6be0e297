"""Open any file of this package: its texts and tables, its figures, its page, its model.

`open_any` recognises results files, fits, creep-force tables and folders of studies, and also the
files that request them: scenes, and designs of fits, tables and studies. A kind of file is one
subclass of `Document`; the commands show, plot, report and explain use nothing else.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping
from os import PathLike
from pathlib import Path
from typing import Any, ClassVar, Generic, TypeVar

from tractive_sam import (
    compute,
    fitting,
    lookup,
    pages,
    plot,
    results,
    run,
    scene,
    schema,
    store,
    studies,
    tables,
)
from tractive_sam.description import Description, TextTable, format_setting, without_nan
from tractive_sam.interrupt import raise_if_interrupted
from tractive_sam.output_file import omit_failing_figure, write_file
from tractive_sam.safe_text import Html, fill

Content = TypeVar("Content")

RESULTS = (".h5", ".hdf5")
"""Endings that distinguish a results file from a scene."""


class Document(ABC, Generic[Content]):
    """A file or folder of this package that was opened.

    Parameters
    ----------
    path : path-like
        The file or folder.
    content : object
        What it contains: a `History`, `FitResult`, `CreepTable`, `StudyResults`, `Scene`, ...

    Attributes
    ----------
    noun : str
        Its kind, as "a fit".
    block_names : tuple of str
        Names of the blocks of a duty cycle, which figures may select.

    Examples
    --------
    >>> document = ts.open_any("steel")
    >>> document.noun, document.status
    ('a table of creep forces', 'done')
    >>> [path.name for path in document.save_figures("figures")]
    ['errors.png']
    """

    noun: ClassVar[str]
    block_names: tuple[str, ...] = ()
    status: str = "done"
    message: str = ""
    is_complete: bool = True

    def __init__(self, path: str | PathLike[str], content: Content):
        self.path, self.content = Path(path), content

    @staticmethod
    @abstractmethod
    def read(path: str | PathLike[str]) -> Any:
        """Return the content of a file of this kind; raise the errors of `open_any`."""

    def __repr__(self) -> str:
        return f"{self.noun}: {self.path}\n\n{self.content!r}"

    @property
    @abstractmethod
    def title(self) -> str:
        """Title from the file; may be empty."""

    @abstractmethod
    def tables(self) -> dict[str, TextTable]:
        """Return its tables by title."""

    def notes(self) -> list[str]:
        """Return caveats of the content, as sentences."""
        return []

    def to_dict(self) -> dict[str, Any]:
        """Return the content as JSON types; ValueError for a file that holds no results."""
        raise ValueError(self._refusal("prints no JSON"))

    def columns(self) -> Mapping[str, Iterable[Any]]:
        """Return the numbers of each record or case by name; ValueError for other files."""
        raise ValueError(self._refusal("has no rows of numbers (--csv)", "use --json"))

    def drawings(self) -> Iterator[plot.Drawing]:
        """Yield the figures that apply; ValueError if there are none."""
        raise ValueError(self._refusal("has no figures"))

    def save_figures(
        self,
        folder: str | PathLike[str],
        format: str = "png",
        *,
        dpi: int | None = None,
        width: float | None = None,
        titles: bool = True,
        **options: Any,
    ) -> list[Path]:
        """Draw the figures that apply into a folder, which is created; return their paths.

        A figure that cannot be drawn is omitted with a warning.

        Parameters
        ----------
        folder : path-like
            Folder of the figures.
        format : str
            One of `plot.FORMATS`.
        dpi : int, optional
            Dots per inch of PNG.
        width : float, optional
            Width of every figure, mm.
        titles : bool
            Whether figures have titles.
        **options
            Options of figures of results files, see `plot.save_all`.

        Raises
        ------
        ValueError
            If there is nothing to draw, or for an option that this kind of file does not have.
        """
        self._refuse_options(options)
        return plot.save_drawings(
            self.drawings(), folder, format, dpi=dpi, width=width, titles=titles
        )

    def save_page(self, path: str | PathLike[str], **options: Any) -> Path:
        """Write an HTML page that needs no other file and no network; return its path.

        Parameters
        ----------
        path : path-like
            The page; an existing one is replaced.
        **options
            ``measured`` of results files, see `report`.

        Raises
        ------
        ValueError
            If there is nothing to show, or for an option that this kind of file does not have.
        OSError
            If the page cannot be written; an existing one is unchanged.
        """
        self._refuse_options(options)
        template = "<h2>$title</h2>\n$table\n"
        page = pages.fill_page(
            "tractive_sam.pages",
            "document",
            title=self.title or self.noun.capitalize(),
            status=self.status,
            kind="good" if self.is_complete else "bad",
            message=self.message,
            notes=(fill('<p class="notice">$text</p>\n', text=text) for text in self.notes()),
            tables=(
                fill(template, title=title, table=table.to_html())
                for title, table in self.tables().items()
            ),
            pictures=self._cards(),
            source=self.source(),
            noun=self.noun,
            version=self.version(),
        )
        return write_file(path, page)

    def _cards(self) -> Iterator[Html]:
        """Yield the figures as HTML, with captions."""
        card = "<figure><figcaption>$caption</figcaption>$image</figure>\n"
        for drawing in self.drawings():
            raise_if_interrupted()
            with omit_failing_figure(drawing.name):
                yield fill(card, caption=drawing.caption, image=drawing.draw().to_html(460.0))

    def source(self) -> str:
        """Return the text of the file that requested the content (TOML); may be empty."""
        return ""

    def version(self) -> str:
        """Return the version of the program that wrote the file; may be empty."""
        return ""

    @abstractmethod
    def explain(self, workers: int | None = None) -> Description:
        """Return what the model includes, its memory and its time.

        Parameters
        ----------
        workers : int, optional
            Number of processes that run a study; by default, one for each core.
        """

    def _refusal(self, lack: str, cure: str = "") -> str:
        """Return a message that this kind of file lacks something, with a cure."""
        return f"{self.path} is {self.noun} and {lack}{cure and '; '}{cure}"

    def _refuse_options(self, options: Mapping[str, Any]) -> None:
        """Raise a ValueError for options that only results files have."""
        if options:
            names = ", ".join(options)
            raise ValueError(self._refusal(f"has no {names}; only results files have", "omit it"))


class ResultsDocument(Document["results.History"]):
    """A results file (.h5) of a scene, which may be incomplete."""

    noun = "a results file"

    def __init__(self, path: str | PathLike[str], content: results.History):
        super().__init__(path, content)
        self.status, self.message = content.status, content.message
        self.is_complete, self.block_names = content.finished, tuple(content.block_names)

    @staticmethod
    def read(path: str | PathLike[str]) -> Any:
        """Open a results file; ResultsError if it is none."""
        return store.open_history(path)

    @property
    def title(self) -> str:
        """Title of the scene."""
        return self.content.title

    def tables(self) -> dict[str, TextTable]:
        """Return the tables of the run, of its records, and of the last record."""
        history = self.content
        about = {"status": history.status, "message": history.message}
        tables = {"Run": TextTable.from_labels(about | results.describe_history(history))}
        if len(history) > 1:
            tables["Records"] = results.record_table(history)
        if len(history):
            tables["Last record"] = results.last_record(history)
        return tables

    def to_dict(self) -> dict[str, Any]:
        """Return every record, see `History.to_dict`."""
        return self.content.to_dict()

    def columns(self) -> Mapping[str, Iterable[Any]]:
        """Return the columns of the records, see `History.numbers`."""
        return {name: values.tolist() for name, values in self.content.numbers().items()}

    def save_figures(
        self,
        folder: str | PathLike[str],
        format: str = "png",
        *,
        dpi: int | None = None,
        width: float | None = None,
        **options: Any,
    ) -> list[Path]:
        """Draw the figures that apply into a folder; return their paths.

        See `Document.save_figures`. The options ``units``, ``blocks`` (``["all"]`` for every
        block), ``titles`` and ``measured`` are those of `plot.save_all`; ``animate`` adds the
        animation evolution.gif.
        """
        history, animated = self.content, options.pop("animate", False)
        self._check_records()
        blocks = options.pop("blocks", ())
        try:
            every = range(len(history.block_names))
            options["blocks"] = every if blocks == ["all"] else [*map(history.place_of, blocks)]
        except LookupError as error:
            raise ValueError(str(error)) from None
        paths = plot.save_all(history, folder, format, dpi=dpi, width=width, **options)
        return (
            [*paths, plot.animate(history, Path(folder) / "evolution.gif")] if animated else paths
        )

    def save_page(self, path: str | PathLike[str], **options: Any) -> Path:
        """Write the interactive page of the history, see `report`."""
        self._check_records()
        return pages.report(self.content, path, **options)

    def _check_records(self) -> None:
        """Raise a ValueError if the file contains no record."""
        if not len(self.content):
            raise ValueError(f"{self.path} contains no record to draw; resume its run")

    def explain(self, workers: int | None = None) -> Description:
        """Explain the scene of the results."""
        return run.explain.explain(self.content.scene)


class AnswerDocument(Document[Any]):
    """The file of a fit or of a question to a scene (.nc), which may be incomplete."""

    def __init__(self, path: str | PathLike[str], content: Any):
        super().__init__(path, content)
        self.status, self.message = content.status, str(content.dataset.attrs["message"])
        self.is_complete = content.status == "done"

    @property
    def title(self) -> str:
        """Title of the question, or of its scene."""
        return self.content.title

    def tables(self) -> dict[str, TextTable]:
        """Return the tables of the result, if it is complete, and its status and cost."""
        rows = self.content.tables() if self.content.finished else {}
        tables = {name: TextTable.from_dicts(table) for name, table in rows.items()}
        return tables | {"Summary": TextTable.from_labels(self.content.summary())}

    def notes(self) -> list[str]:
        """Return what the result rests on and leaves open."""
        return [*self.content.notes]

    def to_dict(self) -> dict[str, Any]:
        """Return all numbers by name."""
        return self.content.to_dict()

    def drawings(self) -> Iterator[plot.Drawing]:
        """Yield the figures of the result."""
        if not self.content.finished:
            name = self.content.kind()
            raise ValueError(f"{self.path} is not complete yet; tractive-sam {name} resumes it")
        return self.content.drawings()

    def source(self) -> str:
        """Return the file of the question."""
        return self.content.design.to_toml()

    def version(self) -> str:
        """Return the version that computed it."""
        return str(self.content.dataset.attrs.get("version", ""))


class FitDocument(AnswerDocument):
    """The file of a fit (.nc), which may be incomplete."""

    noun = "a fit"

    @staticmethod
    def read(path: str | PathLike[str]) -> Any:
        """Open the file of a fit; ResultsError if it is none."""
        return fitting.open_fit(path)

    def tables(self) -> dict[str, TextTable]:
        """Return estimates, correlation and next tests, if there are estimates, and the summary."""
        fit, tables = self.content, {}
        if fit.finished:
            tables = {name: TextTable.from_dicts(rows) for name, rows in fit.tables().items()}
        shown = (*fit.keys, "title")
        rows = {name: text for name, text in fit.summary().items() if name not in shown}
        return tables | {"Agreement and cost": TextTable.from_labels(rows)}

    def notes(self) -> list[str]:
        """Return what the data do not determine, and caveats."""
        return [*self.content.undetermined, *self.content.notes]

    def drawings(self) -> Iterator[plot.Drawing]:
        """Yield data with the model, ellipses and profile likelihood."""
        if not self.content.finished:
            raise ValueError(f"{self.path} holds no estimates yet; tractive-sam fit resumes it")
        return fitting.fit_figures(self.content)

    def explain(self, workers: int | None = None) -> Description:
        """Explain the design of the fit."""
        return fitting.explain_fit(self.content.design)


class SpreadDocument(AnswerDocument):
    """The file of a spread."""

    noun = "a spread"

    @staticmethod
    def read(path: str | PathLike[str]) -> Any:
        """Open the file of a spread; ResultsError if it is none."""
        return fitting.open_spread(path)

    def explain(self, workers: int | None = None) -> Description:
        """Describe the design of the spread."""
        return fitting.explain_spread(self.content.design)


class DesignDocument(AnswerDocument):
    """The file of a design."""

    noun = "a design"

    @staticmethod
    def read(path: str | PathLike[str]) -> Any:
        """Open the file of a design; ResultsError if it is none."""
        return fitting.open_design(path)

    def explain(self, workers: int | None = None) -> Description:
        """Describe the file of the design."""
        return fitting.explain_design(self.content.design)


class TableDocument(Document[Any]):
    """A creep-force table, a file (.nc) or a built-in one."""

    noun = "a table of creep forces"
    content: lookup.CreepTable

    @staticmethod
    def read(path: str | PathLike[str]) -> Any:
        """Open a creep-force table; ResultsError if it is none."""
        return tables.open_table(path)

    @property
    def title(self) -> str:
        """Title of the table."""
        return self.content.title

    def tables(self) -> dict[str, TextTable]:
        """Return the sections of its description."""
        return {section.title: TextTable(section.rows) for section in self.explain()}

    def to_dict(self) -> dict[str, Any]:
        """Return its description, axes and errors."""
        return tables.table_as_dict(self.content)

    def columns(self) -> Mapping[str, Iterable[Any]]:
        """Refuse: nodes have a separate format."""
        cure = f"tractive-sam table {self.path} --text FILE.txt writes its nodes"
        raise ValueError(self._refusal("has no rows of numbers (--csv)", cure))

    def drawings(self) -> Iterator[plot.Drawing]:
        """Yield the errors at the check points; ValueError if the file has none."""
        table = self.content
        if "check_errors" not in table.about:
            raise ValueError(f"{self.path} has no check points to draw; build the table again")
        caption = "Errors at the check points against the reported errors, and their distribution."
        yield plot.Drawing("errors", caption, lambda: plot.table_errors(table))

    def source(self) -> str:
        """Return the design of the table."""
        return str(self.content.about.get("design", ""))

    def version(self) -> str:
        """Return the version that built the table."""
        return str(self.content.about.get("version", ""))

    def explain(self, workers: int | None = None) -> Description:
        """Describe axes, errors and a call."""
        return tables.explain_table(self.content)


class StudyDocument(Document["studies.StudyResults"]):
    """The folder of a study, which may be incomplete."""

    noun = "a study"

    def __init__(self, path: str | PathLike[str], content: studies.StudyResults):
        super().__init__(path, content)
        self.is_complete = content.complete
        self.status = "done" if content.complete else "not complete"
        counts = (f"{count} {status}" for status, count in content.counts.items() if count)
        self.message = f"{len(content)} cases: {', '.join(counts)}"

    @staticmethod
    def read(path: str | PathLike[str]) -> Any:
        """Open the folder of a study; ResultsError if it is none."""
        return studies.open_study(path)

    @property
    def title(self) -> str:
        """Title of the study, or of its scene."""
        return self.content.study.title or self.content.study.scene.title

    def tables(self) -> dict[str, TextTable]:
        """Return the table of all cases: changed keys, status and results of the last record."""
        study = self.content.study
        keys = [key for dimension in study.dimensions for key in dimension.columns]
        model = study.scene
        shown = [
            column
            for column in results.select_columns(results.columns(model))
            if column.name != "residual" and not (model.line and "_y" in column.name)
        ]
        rows = []
        for row in self.content.rows:
            changes = [format_setting(row.case.changes[key]) for key in keys]
            numbers = [
                column.format_value(row.last[column.name]) if column.name in row.last else ""
                for column in shown
            ]
            rows.append([str(row.case.number), *changes, row.status, *numbers])
        names = ["case", *(key.replace(".", ".\n") for key in keys), "status"]
        headings = (*names, *(column.heading for column in shown))
        numbers_at = frozenset(range(len(headings))) - {len(keys) + 1}
        return {"Cases": TextTable(rows, headings, numbers_at)}

    def notes(self, max_failures: int = 10) -> list[str]:
        """Return failed cases with their messages, several versions, and damage of the log."""
        found = self.content
        failed = [row for row in found.rows if row.status == "failed"]
        notes = [f"{row.case} failed: {row.message}" for row in failed[:max_failures]]
        if len(failed) > max_failures:
            notes.append(f"{len(failed) - max_failures} more cases failed")
        if len(found.versions) > 1:
            counts = ", ".join(f"{count} by {name}" for name, count in found.versions.items())
            cure = "to compute them again, remove the files of one version (see study-show --csv)"
            if found.study.keep == "scalars":
                cure = "in a new folder this version computes all of them"
            notes.append(f"several versions computed the cases: {counts}; {cure}")
        return [*notes, *filter(None, [found.damage_note])]

    def to_dict(self) -> dict[str, Any]:
        """Return the columns of `StudyResults.columns` as lists, with None for nan."""
        about = {"status": self.status, "message": self.message}
        return without_nan({**about, **self.content.columns()})

    def columns(self) -> Mapping[str, Iterable[Any]]:
        """Return the last records of all cases, see `StudyResults.columns`."""
        return self.content.columns()

    def drawings(self) -> Iterator[plot.Drawing]:
        """Yield quantities over one or two axes; ValueError if more axes vary."""
        return studies.study_figures(self.content)

    def source(self) -> str:
        """Return the file of the study."""
        return self.content.study.to_toml()

    def explain(self, workers: int | None = None) -> Description:
        """Describe the cases, memory and time of the study."""
        return _explain_study(self.content.study, workers)


class Request(Document[Content]):
    """A file that requests a computation: it has no results to show or draw.

    Attributes
    ----------
    command : str
        The command that computes it.
    table : str
        The table of the file that has the title; empty if the title is above all tables.
    """

    command: ClassVar[str]
    table: ClassVar[str] = ""

    @property
    def title(self) -> str:
        """Title from the file."""
        return str(getattr(getattr(self.content, self.table, self.content), "title", ""))

    def tables(self) -> dict[str, TextTable]:
        """Refuse: there are no results."""
        raise ValueError(self._refusal("holds no results", self._cure))

    def drawings(self) -> Iterator[plot.Drawing]:
        """Refuse: there are no results."""
        raise ValueError(self._refusal("holds no results to draw", self._cure))

    def to_dict(self) -> dict[str, Any]:
        """Refuse: there are no results."""
        raise ValueError(self._refusal("holds no results", self._cure))

    @property
    def _cure(self) -> str:
        command = self.command.format(self.path)
        return f"{command} computes it, tractive-sam explain {self.path} describes it"


class SceneRequest(Request["scene.Scene"]):
    """A scene file or a built-in scene."""

    noun, command = "a scene", "tractive-sam run {}"

    @staticmethod
    def read(path: str | PathLike[str]) -> Any:
        """Read a scene; SceneError with every fault."""
        return scene.Scene.from_name(str(path))

    def explain(self, workers: int | None = None) -> Description:
        """Explain the scene, see `explain`."""
        return run.explain.explain(self.content)


class StudyRequest(Request["studies.Study"]):
    """The file of a study."""

    noun, command = "the file of a study", "tractive-sam study {} -o DIR"

    @staticmethod
    def read(path: str | PathLike[str]) -> Any:
        """Read the file of a study; StudyError with every fault."""
        return studies.Study.from_toml(path)

    def notes(self) -> list[str]:
        """Return a note if the file could also be the design of a creep-force table."""
        try:
            tables.TableDesign.from_toml(self.path)
        except schema.SceneError:
            return []
        cure = "for a table of creep forces write its tolerance into the file: tolerance = 0.02"
        return [f"{self.path} is read as a study; {cure}"]

    def explain(self, workers: int | None = None) -> Description:
        """Describe the cases, memory and time of the study."""
        return _explain_study(self.content, workers)


class FitRequest(Request["fitting.FitDesign"]):
    """The file that requests a fit."""

    noun, command = "the file of a fit", "tractive-sam fit {} -o FILE.nc"
    table = "fit"

    @staticmethod
    def read(path: str | PathLike[str]) -> Any:
        """Read the file of a fit; FitError with every fault."""
        return fitting.FitDesign.from_toml(path)

    def explain(self, workers: int | None = None) -> Description:
        """Describe parameters, data and cost of the fit."""
        return fitting.explain_fit(self.content)


class SpreadRequest(Request["fitting.SpreadDesign"]):
    """The file that requests a spread."""

    noun, command = "the file of a spread", "tractive-sam spread {} -o FILE.nc"
    table = "spread"

    @staticmethod
    def read(path: str | PathLike[str]) -> Any:
        """Read the file of a spread; SpreadError with every fault."""
        return fitting.SpreadDesign.from_toml(path)

    def explain(self, workers: int | None = None) -> Description:
        """Describe uncertain keys, outcomes and cost of the spread."""
        return fitting.explain_spread(self.content)


class DesignRequest(Request["fitting.OptimumDesign"]):
    """The file that requests a design."""

    noun, command = "the file of a design", "tractive-sam design {} -o FILE.nc"
    table = "design"

    @staticmethod
    def read(path: str | PathLike[str]) -> Any:
        """Read the file of a design; DesignError with every fault."""
        return fitting.OptimumDesign.from_toml(path)

    def explain(self, workers: int | None = None) -> Description:
        """Describe free keys, aims, limits and cost of the design."""
        return fitting.explain_design(self.content)


class TableRequest(Request["tables.TableDesign"]):
    """The design of a creep-force table."""

    noun, command = "the design of a table", "tractive-sam table {} -o FILE.nc"

    @staticmethod
    def read(path: str | PathLike[str]) -> Any:
        """Read the design of a table; TableError with every fault."""
        return tables.TableDesign.from_toml(path)

    def explain(self, workers: int | None = None) -> Description:
        """Describe axes, accuracy and work of the table."""
        return tables.explain_design(self.content)


def find_kind(path: str | PathLike[str]) -> type[Document[Any]]:
    """Return the kind of a file, folder, built-in scene or built-in table, by its content.

    Parameters
    ----------
    path : path-like
        The file, which may not exist: then its ending determines the kind.
    """
    if Path(path).is_dir():
        return StudyDocument
    if tables.is_table(path):
        format = store.netcdf_format(path) if str(path).endswith(".nc") else ""
        answers: dict[str, type[Document[Any]]] = {
            "fit": FitDocument,
            "spread": SpreadDocument,
            "design": DesignDocument,
        }
        return answers.get(format.partition(" ")[0], TableDocument)
    if Path(path).suffix in RESULTS:
        return ResultsDocument
    if tables.is_design(path):
        return TableRequest
    if question := fitting.question_of(path):
        requests: dict[str, type[Document[Any]]] = {
            "fit": FitRequest,
            "spread": SpreadRequest,
            "design": DesignRequest,
        }
        return requests[question]
    return StudyRequest if studies.is_study(path) else SceneRequest


def open_any(path: str | PathLike[str]) -> Document[Any]:
    """Open any file of this package: results, a fit, a table, a study, or what requests one.

    Parameters
    ----------
    path : path-like
        A file, the folder of a study, or the name of a built-in scene or table.

    Returns
    -------
    Document
        Its content with its tables, figures, page and description.

    Raises
    ------
    ResultsError
        If the file does not exist or is damaged.
    SceneError
        With every fault of a scene, or of a file that requests a fit, study or table.

    Examples
    --------
    >>> ts.open_any("steel").noun
    'a table of creep forces'
    >>> print(ts.open_any("spheres").explain()[0].title)
    Bodies
    """
    kind = find_kind(path)
    return kind(path, kind.read(path))


def _explain_study(study: studies.Study, workers: int | None) -> Description:
    """Describe a study on as many workers, or on one for each core."""
    return studies.explain_study(study, workers or compute.cores())
