"""Print tables of results on the standard output, and notes and errors on the standard error."""

import codecs
import math
import os
import sys
import warnings
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from enum import IntEnum
from io import TextIOWrapper
from pathlib import Path
from time import monotonic
from typing import Annotated, Any, TextIO, TypeAlias

import typer
from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

import tractive_sam as ts
from tractive_sam.interrupt import mark_reported
from tractive_sam.safe_text import printable_text


class ExitStatus(IntEnum):
    """Exit statuses of the program: done, invalid input, not converged or stopped early."""

    DONE = 0
    INVALID = 2
    INCOMPLETE = 3


class _Console(Console):
    """Console that discards its output once the reader of a pipe has left, as `head` does.

    Control characters in titles, messages and names do not reach the terminal.
    """

    def render_str(self, text: str, **options: Any) -> Text:
        """Return a cell or line of text without control characters, as it is printed."""
        return super().render_str(printable_text(text), **options)

    def on_broken_pipe(self) -> None:
        """Discard the rest of the output if its reader has left, with an unchanged exit status."""
        discard_output(sys.stderr if self.stderr else sys.stdout)


def replace_missing_signs() -> None:
    """Set stdout and stderr to replace signs that their encoding lacks, as µm by um."""
    signs = {
        "µ": "u",
        "±": "+-",
        "²": "2",
        "³": "3",
        "…": "...",
        "°": "deg",
        "ö": "oe",
        "–": "-",
        "’": "'",
    }

    def replace(error: UnicodeError) -> tuple[str, int]:
        if not isinstance(error, UnicodeEncodeError):
            raise error
        missing = error.object[error.start : error.end]
        return "".join(signs.get(sign, "?") for sign in missing), error.end

    codecs.register_error("replace_signs", replace)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="replace_signs")


def discard_output(stream: TextIO) -> None:
    """Discard everything that is written to a stream from now on."""
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, stream.fileno())
    os.close(null)


def console(stderr: bool = False, error: bool = False, width: int = 120) -> Console:
    """Return a console on standard output or error; after --quiet it prints only errors there.

    Parameters
    ----------
    stderr : bool
        Whether to print on the standard error; after `--quiet` it prints nothing.
    error : bool
        Whether to print an error, also after `--quiet`.
    width : int
        Columns of an output that is no terminal.
    """
    if stderr and not error and _running().quiet:
        return _Console(stderr=True, quiet=True, force_terminal=False)
    rich_console = _Console(stderr=stderr, highlight=False, markup=False)
    if not rich_console.is_terminal:
        rich_console.width = width
    return rich_console


@dataclass
class _Command:
    """State of the running command: whether it is quiet, and the notes it has printed.

    Attributes
    ----------
    quiet : bool
        Whether it prints only errors.
    notes : set of str
        Notes that it has printed.
    """

    quiet: bool = False
    notes: set[str] = field(default_factory=set)


_RUNNING: ContextVar[_Command] = ContextVar("_RUNNING")


@contextmanager
def running_command() -> Iterator[None]:
    """Mark the block as a new command: not quiet, no notes printed yet."""
    token = _RUNNING.set(_Command())
    try:
        yield
    finally:
        _RUNNING.reset(token)


def _running() -> _Command:
    """Return the state of the running command; a new state outside of commands."""
    return _RUNNING.get(None) or _Command()


def _set_quiet(quiet: bool) -> bool:
    """Set whether the command prints only errors, and return that value (callback of --quiet)."""
    _running().quiet = quiet
    return quiet


Quiet: TypeAlias = Annotated[
    bool,
    typer.Option(
        "--quiet",
        "-q",
        help="Print only errors, without progress, notes and results.",
        callback=_set_quiet,
        is_eager=True,
    ),
]


def print_note(text: str) -> None:
    """Print a note on the standard error, unless the command has already printed it."""
    printed = _running().notes
    if (content := text.removeprefix("duty: ")) not in printed:
        printed.add(content)
        print_message(("note: ", "bold yellow"), text)


def print_message(*parts: str | tuple[str, str], error: bool = False) -> None:
    """Print a line on the standard error; after `--quiet` only if it is an error.

    If the disk is full or the terminal is closed, the line is lost.

    Parameters
    ----------
    *parts : str or (str, str)
        Text, or pairs of text and style.
    error : bool
        Whether it is an error.
    """
    try:
        pairs = ((part, "") if isinstance(part, str) else part for part in parts)
        line = Text.assemble(*((printable_text(text), style) for text, style in pairs))
        console(stderr=True, error=error).print(line, soft_wrap=True)
    except OSError:
        discard_output(sys.stderr)


def print_line(text: object) -> None:
    """Print a line on the standard output, without wrapping and styles."""
    console().print(Text(printable_text(str(text), max_length=None)), soft_wrap=True)


def error_exit(status: ExitStatus, *parts: str | tuple[str, str]) -> typer.Exit:
    """Print an error message, and return an exception that ends the command with an exit status."""
    print_message(("error: ", "bold red"), *parts, error=True)
    mark_reported()
    return typer.Exit(status)


def invalid_exit(*parts: str | tuple[str, str]) -> typer.Exit:
    """Print an error of the input; return the exception that ends the command with status 2."""
    return error_exit(ExitStatus.INVALID, *parts)


def incomplete_exit(*parts: str | tuple[str, str]) -> typer.Exit:
    """Print why a result is missing; return the exception that ends the command with status 3."""
    return error_exit(ExitStatus.INCOMPLETE, *parts)


def check_folder(path: Path) -> None:
    """End with an error if the folder of an output file does not exist."""
    if not path.absolute().parent.is_dir():
        raise invalid_exit(f"{path}: the folder {path.parent} does not exist; create it first")


@contextmanager
def show_progress() -> Iterator[Callable[[float, str, str], None]]:
    """Show the progress of the block on the standard error; yield the function that updates it.

    Yields
    ------
    callable
        Function of the share that is done, a description for the progress bar of a terminal, and
        a line that is printed if the standard error is no terminal, unless it is empty.
    """
    terminal = console(stderr=True)
    if not terminal.is_terminal:
        yield lambda _share, _description, line: print_message(line) if line else None
        return
    from rich import progress as bars

    columns = (
        bars.SpinnerColumn(),
        bars.TextColumn("{task.description}"),
        bars.BarColumn(),
        bars.TimeElapsedColumn(),
        bars.TextColumn("left"),
        bars.TimeRemainingColumn(),
    )
    with bars.Progress(*columns, console=terminal, transient=True) as bar:
        task = bar.add_task("starting", total=1.0)
        yield lambda share, text, _line: bar.update(task, completed=share, description=text)


@contextmanager
def report_warnings() -> Iterator[list[warnings.WarningMessage]]:
    """Print the warnings of the block as notes, each once; yield the list that records them."""
    with warnings.catch_warnings(record=True) as recorded:
        warnings.simplefilter("always")
        yield recorded
    for text in dict.fromkeys(str(warning.message) for warning in recorded):
        print_note(text)


@contextmanager
def report_compiling() -> Iterator[None]:
    """Print notes while the block compiles kernels, as in a first run, with their number so far."""
    from tractive_sam.kernels import compiled

    interval, next_time = 5.0, 0.0  # seconds

    def report(number: int, most: int) -> None:
        nonlocal next_time
        if monotonic() >= next_time:
            next_time = monotonic() + interval
            print_note(f"compiling kernels, once: {number} of at most {most}")

    with compiled.notify_compilation(report):
        yield


def exit_after(error: Exception) -> typer.Exit | None:
    """Print an error that the user can correct; return the exception that ends the command.

    Returns None after any other error.
    """
    from tempfile import gettempdir

    from tractive_sam.extras import MissingExtraError
    from tractive_sam.output_file import (
        OutputError,
        OutputPlaceError,
        describe_os_error,
        is_disk_failure,
    )
    from tractive_sam.schema import SceneError
    from tractive_sam.store import GapError, ResultsError, StorageError

    status, text = ExitStatus.INVALID, str(error)
    match error:
        case SceneError():
            return _fault_exit(error.faults, error.subject)
        case GapError():
            return _fault_exit([error])
        case StorageError():
            status = ExitStatus.INCOMPLETE
        case OutputPlaceError() | ResultsError() | MissingExtraError():
            pass
        case OutputError():
            status = ExitStatus.INCOMPLETE
        case OSError() if error.filename is not None:  # without one, it is of the output itself
            place = error.filename2 or error.filename  # of a copy: the new file
            reason = f"{error.strerror}; choose another file, or change its permissions"
            if is_disk_failure(error):
                temporary = str(place).startswith(gettempdir())
                reason = describe_os_error(error) + ("; TMPDIR names the folder" * temporary)
            text = f"{place} cannot be used: {reason}"
        case MemoryError():
            cure = "choose a coarser [grid]; tractive-sam explain estimates the memory of a scene"
            text = f"the memory is too small; {cure}"
        case _:
            return None
    return error_exit(status, text)


@contextmanager
def refuse(*errors: type[Exception], status: ExitStatus = ExitStatus.INVALID) -> Iterator[None]:
    """End the command with the message of such an error if the block raises it."""
    try:
        yield
    except errors as error:
        raise error_exit(status, str(error)) from None


@contextmanager
def report_interrupt(note: str) -> Iterator[None]:
    """End the command with a note if a signal interrupts the block."""
    try:
        yield
    except KeyboardInterrupt:
        raise incomplete_exit(f"interrupted; {note}") from None


def _fault_exit(faults: Sequence[Any], subject: str = "scene") -> typer.Exit:
    """Print faults (key, given, allowed), and return the exception that ends the command."""
    from tractive_sam.schema import SceneError

    count = f"{len(faults)} faults" if len(faults) > 1 else "1 fault"
    leave = invalid_exit(f"{count} in the {subject}")
    for fault in faults[: SceneError.max_listed]:
        text = f": given {fault.given}; allowed: {fault.allowed}"
        print_message("  ", (fault.key, "bold"), text, error=True)
    if len(faults) > SceneError.max_listed:
        print_message(f"  and {len(faults) - SceneError.max_listed} more", error=True)
    return leave


@dataclass(frozen=True)
class Column:
    """A column of the printed table of records: quantity, heading, number format and factor.

    Attributes
    ----------
    name : str
        Column of the history.
    heading : str
        Heading, with the unit in the second line.
    format : str
        Format of its numbers.
    factor : float
        Factor of the numbers.
    """

    name: str
    heading: str
    format: str = ".4g"
    factor: float = 1

    def format_value(self, value: float) -> str:
        """Return a value of the quantity as text, times the factor of the column."""
        value *= self.factor
        return format(int(value) if self.format == "d" else value, self.format)


def select_columns(columns: Collection[str], creepages: bool = False) -> list[Column]:
    """Return the columns of the printed table of records, by the columns that a history has.

    Parameters
    ----------
    columns : collection of str
        Columns of the history; shifts of a transient replace the half widths, and patches of a
        wheel have their place and forces.
    creepages : bool
        Whether to print the creepages, which follow from prescribed forces.
    """
    # Columns of the table of records, in groups.
    ends = (
        Column("wear_max", "wear\nµm", factor=1e3),
        Column("stick_fraction", "stick\n%", ".1f", 100),
        Column("residual", "residual", ".0e"),
    )
    shifts = (
        Column("shift_x", "shift x\nµm", factor=1e3),
        Column("shift_y", "shift y\nµm", factor=1e3),
        Column("friction_work", "friction\nN mm"),
    )
    widths = (Column("half_width_x", "half x\nmm"), Column("half_width_y", "half y\nmm"))
    pressures = (Column("p_max", "p_max\nMPa"), Column("p_95", "p_95\nMPa"))
    creepage_columns = (Column("xi_x", "xi_x", ".3e"), Column("xi_y", "xi_y", ".3e"))
    forces = (Column("Qx_over_P", "Qx/P", "z.4f"), Column("Qy_over_P", "Qy/P", "z.4f"))
    shown_creepages = creepage_columns if creepages else ()
    if "shift_x" in columns:
        return [*forces, *shown_creepages, pressures[0], *shifts, pressures[1], *ends]
    if "contact_angle" in columns:
        patch = (Column("contact_y", "y\nmm", ".5g"), Column("contact_angle", "angle\ndeg", ".2f"))
        newtons = (Column(name, f"{name}\nN", "z.0f") for name in ("P", "Qx", "Qy"))
        return [*patch, *newtons, pressures[0], *widths, *ends]
    return [*forces, *shown_creepages, *pressures, *widths, *ends]


def run_table(history: "ts.History") -> Table:
    """Return a terminal table of a history: scene, status, balances and cost."""
    from tractive_sam.results import describe_history

    rows = {"scene": history.title, "status": history.status, "message": history.message}
    return _label_table(rows | describe_history(history))


def load_table(history: "ts.History") -> Table:
    """Return a terminal table of the load and the wear law of a scene, in several units."""
    from tractive_sam.scene import describe_load

    return _label_table(describe_load(history.scene))


def _label_table(rows: Mapping[str, str]) -> Table:
    """Return a terminal table of labels and texts."""
    table = Table.grid(padding=(0, 2))
    for label, text in rows.items():
        table.add_row(label, text)
    return table


def last_record(history: "ts.History", solver: bool = False) -> Table:
    """Return a terminal table of the last record, one quantity a row.

    Parameters
    ----------
    history : History
        At least one record.
    solver : bool
        Whether to include the quantities of the solver, which the totals summarize.
    """
    from tractive_sam.results import format_values

    hidden: set[str] = set() if solver else {
        "operator_applications", "convolutions", "over_application", "jump", "converged", "solves",
        "seconds", "next_step", "stretch",
    }  # fmt: skip
    return _quantity_table(row for row in format_values(history, -1) if row[0] not in hidden)


def main_results(history: "ts.History", max_rows: int = 15) -> Table:
    """Return a terminal table of the main results of the last record that are not zero.

    Parameters
    ----------
    history : History
        At least one record.
    max_rows : int
        Most rows: they fit a terminal of 24 lines together with the load.
    """
    from tractive_sam.results import format_values

    order = (
        "contact_y", "P", "Qx", "Qy", "Mz", "Qx_over_P", "worn_mass", "fatigue_life", "shift_x",
        "friction_work", "p_max", "p_95", "half_width_x", "half_width_y", "stick_fraction",
        "wear_max", "temperature_max", "stress_max", "von_mises_max", "utilisation", "xi_x", "xi_y",
    )  # fmt: skip
    rows = [row for row in format_values(history, -1) if row[1] not in ("0", "nan", "none")]
    table = _quantity_table(
        [row for name in order for row in rows if row[2].name == name][:max_rows]
    )
    table.caption = "run --verbose prints all quantities, show FILE all of every record"
    return table


def _quantity_table(rows: "Iterable[tuple[str, str, ts.Quantity]]") -> Table:
    """Return a terminal table of quantities: name, value, unit and meaning."""
    table = Table(box=box.SIMPLE_HEAD, show_header=False)
    table.add_column(style="bold")
    table.add_column(justify="right")
    table.add_column()
    table.add_column(style="dim")
    for name, text, quantity in rows:
        table.add_row(name, text, _unit_of(quantity), quantity.long_name)
    return table


def record_table(history: "ts.History", max_rows: int = 20) -> Table:
    """Return a terminal table of at most `max_rows` records, at about equal distances."""
    count, coordinate = len(history), history.coordinate
    heading = "\n".join(filter(None, (coordinate.symbol or coordinate.name, _unit_of(coordinate))))
    has_creepages = "creepage_found" in history.columns and any(map(math.isfinite, history["xi_x"]))
    columns = select_columns(history.columns, creepages=has_creepages)
    columns = [Column(coordinate.name, heading, coordinate.format), *columns]
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for column in columns:
        table.add_column(column.heading, justify="right", no_wrap=True)
    shown = _select_spaced(history[coordinate.name].tolist(), max_rows)
    for row in shown:
        table.add_row(*(column.format_value(history[column.name][row]) for column in columns))
    if len(shown) < count:
        table.caption = f"{len(shown)} of {count} records; show --json prints all"
    return table


def _unit_of(quantity: "ts.Quantity") -> str:
    """Return the unit of a quantity, or "" if it is dimensionless."""
    return "" if quantity.unit == "1" else quantity.unit


def _select_spaced(places: list[float], count: int) -> list[int]:
    """Return the indices of at most `count` of ascending values, at about equal distances."""
    if len(places) <= count:
        return list(range(len(places)))
    first, last = places[0], places[-1]
    aims = (first + k * (last - first) / (count - 1) for k in range(count))
    return sorted({min(range(len(places)), key=lambda n: abs(places[n] - aim)) for aim in aims})
