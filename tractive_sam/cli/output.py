"""What the program says: tables on the standard output, notes and errors beside it."""

import codecs
import os
import sys
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from enum import IntEnum
from io import TextIOWrapper
from typing import TYPE_CHECKING, Annotated, TextIO, TypeAlias

import typer
from rich.console import Console
from rich.text import Text

from tractive_sam.interrupt import mark_reported
from tractive_sam.safe_text import printable_text

if TYPE_CHECKING:
    from rich.progress import Progress

PIPE_WIDTH = 120
"""Columns where the output is no terminal."""


class Status(IntEnum):
    """Exit statuses."""

    DONE = 0
    INVALID = 2
    INCOMPLETE = 3


class _Console(Console):
    """A console that falls silent when its reader leaves, like `head` after the first lines.

    What titles, messages and names hold that would command the terminal does not get there.
    """

    def render_str(self, text: str, **options) -> Text:
        """A cell or a line as it is printed."""
        return super().render_str(printable_text(text), **options)

    def on_broken_pipe(self) -> None:
        """Write what is left to nowhere; the exit status is that of the command."""
        silence(sys.stderr if self.stderr else sys.stdout)


def spell_what_has_no_sign() -> None:
    """Have streams whose encoding lacks a sign write it in other ones, as um for µm."""

    def spelt(error: UnicodeError) -> tuple[str, int]:
        if not isinstance(error, UnicodeEncodeError):
            raise error
        lacking = error.object[error.start : error.end]
        return "".join(_SPELT.get(sign, "?") for sign in lacking), error.end

    codecs.register_error("spelt", spelt)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="spelt")


_SPELT = {"µ": "u", "±": "+-", "²": "2", "³": "3", "…": "...", "°": "deg", "–": "-", "’": "'"}


def silence(stream: TextIO) -> None:
    """Have a stream lead nowhere from here on."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, stream.fileno())
    os.close(nowhere)


def console(stderr: bool = False, error: bool = False) -> Console:
    """Console of this moment's standard output, or of the standard error.

    After `--quiet` the standard error takes errors alone.
    """
    if stderr and not error and _running().quiet:
        return _Console(stderr=True, quiet=True, force_terminal=False)
    found = _Console(stderr=stderr, highlight=False, markup=False)
    if not found.is_terminal:
        found.width = PIPE_WIDTH
    return found


@dataclass
class _Command:
    """State of the running command.

    Attributes
    ----------
    quiet : bool
        Whether it prints errors alone.
    notes : set of str
        Notes that it has printed.
    """

    quiet: bool = False
    notes: set[str] = field(default_factory=set)


_RUNNING: ContextVar[_Command] = ContextVar("_RUNNING")


@contextmanager
def running_command() -> Iterator[None]:
    """Begin a command: it is not quiet, and has printed no note."""
    token = _RUNNING.set(_Command())
    try:
        yield
    finally:
        _RUNNING.reset(token)


def _running() -> _Command:
    """Return the state of the running command, or of one that begins."""
    return _RUNNING.get(None) or _Command()


def _be_quiet(quiet: bool) -> bool:
    _running().quiet = quiet
    return quiet


Quiet: TypeAlias = Annotated[
    bool,
    typer.Option(
        "--quiet",
        "-q",
        help="Print errors alone: no progress, notes or results.",
        callback=_be_quiet,
        is_eager=True,
    ),
]


def note(text: str) -> None:
    """Print a note, once in a command, also where it is of a block and of the whole scene."""
    printed = _running().notes
    if (content := text.removeprefix("duty: ")) not in printed:
        printed.add(content)
        say(("note: ", "bold yellow"), text)


def say(*parts: str | tuple[str, str], error: bool = False) -> None:
    """Print a line on the standard error; parts are text, or pairs of text and style.

    Where that is full, or its terminal is gone, there is nobody to tell it to. After `--quiet`
    errors alone are printed.
    """
    try:
        pairs = ((one, "") if isinstance(one, str) else one for one in parts)
        line = Text.assemble(*((printable_text(text), style) for text, style in pairs))
        console(stderr=True, error=error).print(line, soft_wrap=True)
    except OSError:
        silence(sys.stderr)


def tell(text: object) -> None:
    """Print a line on the standard output, whole and without styles."""
    console().print(Text(printable_text(str(text), max_length=None)), soft_wrap=True)


@contextmanager
def progress_bar() -> Iterator["Progress | None"]:
    """A bar on the standard error, with the time taken and left; None where that is no terminal."""
    terminal = console(stderr=True)
    if not terminal.is_terminal:
        yield None
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
        yield bar


def stop(status: Status, *parts: str | tuple[str, str]) -> typer.Exit:
    """Print an error; returns what is to be raised."""
    say(("error: ", "bold red"), *parts, error=True)
    mark_reported()
    return typer.Exit(status)


@contextmanager
def warnings_told() -> Iterator[list[warnings.WarningMessage]]:
    """Print warnings as notes, each once; yields those so far."""
    with warnings.catch_warnings(record=True) as notes:
        warnings.simplefilter("always")
        yield notes
    for text in dict.fromkeys(str(note.message) for note in notes):
        note(text)


@contextmanager
def compiling_told() -> Iterator[None]:
    """Print a note that the first run takes longer, once it does."""
    from tractive_sam.kernels.compiled import compiling_told as told

    line = "compiling kernels for this machine, once: 10 to 30 seconds; later runs load them"
    with told(lambda: note(line)):
        yield


@contextmanager
def bad_input_told() -> Iterator[None]:
    """Turn errors that the user can cure into messages and an exit status."""
    from tractive_sam.extras import MissingExtraError
    from tractive_sam.output_file import OutputError, OutputPlaceError
    from tractive_sam.schema import SceneError
    from tractive_sam.store import GapError, ResultsError, StorageError

    try:
        yield
    except SceneError as error:
        raise _faults(error.faults, error.subject) from None
    except GapError as error:
        raise _faults([error]) from None
    except OutputPlaceError as error:
        raise stop(Status.INVALID, str(error)) from None
    except (StorageError, OutputError) as error:
        raise stop(Status.INCOMPLETE, str(error)) from None
    except (ResultsError, MissingExtraError) as error:
        raise stop(Status.INVALID, str(error)) from None
    except OSError as error:
        if error.filename is None:
            raise  # of the output itself
        told = f"{error.filename} cannot be used: {error.strerror}; choose another, or ask for it"
        raise stop(Status.INVALID, told) from None
    except MemoryError:
        cure = "a coarser [grid]; tractive-sam explain tells what a scene takes"
        raise stop(Status.INVALID, f"the memory does not suffice; choose {cure}") from None


def _faults(faults: Sequence, subject: str = "scene") -> typer.Exit:
    """List faults: anything with key, given and allowed."""
    from tractive_sam.schema import SceneError

    count = f"{len(faults)} faults" if len(faults) > 1 else "1 fault"
    leave = stop(Status.INVALID, f"{count} in the {subject}")
    for fault in faults[: SceneError.most_listed]:
        told = f": given {fault.given}; allowed: {fault.allowed}"
        say("  ", (fault.key, "bold"), told, error=True)
    if len(faults) > SceneError.most_listed:
        say(f"  and {len(faults) - SceneError.most_listed} more", error=True)
    return leave
