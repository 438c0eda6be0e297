"""Print tables of results on the standard output, and notes and errors on the standard error."""

import codecs
import os
import sys
import warnings
from collections.abc import Callable, Iterator, Sequence
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

from tractive_sam.description import TextTable
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
    from tractive_sam.run import format_remaining_time, open_bar

    bar, began = open_bar(console(stderr=True)), monotonic()
    if bar is None:
        yield lambda _share, _description, line: print_message(line) if line else None
        return

    def update(share: float, text: str, _line: str) -> None:
        left = (monotonic() - began) * (1.0 - share) / share if share else 0.0
        bar.show(text, share, 1.0, format_remaining_time(left) if left else "")

    try:
        bar.show("starting", 0.0, 1.0, "")
        yield update
    finally:
        bar.close()


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


def print_table(table: TextTable) -> None:
    """Print a table of texts on the standard output; of labels and texts, without lines."""
    if not (table.headings or table.numbers):
        printed = Table.grid(padding=(0, 2))
    else:
        printed = Table(
            box=box.SIMPLE_HEAD, show_header=bool(table.headings), pad_edge=not table.headings
        )
        styles = ("",) * len(table.headings) or ("bold", "", "", "dim")
        is_wide = len(max(table.to_text().splitlines(), key=len)) > console().width
        for number, style in enumerate(styles):
            printed.add_column(
                table.headings[number] if table.headings else "",
                justify="right" if number in table.numbers else "left",
                no_wrap=number in table.numbers and not is_wide,
                style=style,
            )
    for row in table.rows:
        printed.add_row(*row)
    printed.caption = table.caption or None
    console().print(printed)
