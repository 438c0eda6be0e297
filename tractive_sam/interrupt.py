"""Signals that stop the program, deferred until a safe moment.

A KeyboardInterrupt that Python raises wherever it happens to be is lost where nothing can be raised
(in a callback of the garbage collector), or ends as a traceback of whatever was being imported. So
the command line only notes that it was asked, and all that takes long looks at the note: every
transform does (`operators.fft`), and so does every loop over records, cases and figures. A program
that imports this package keeps its own handlers: there, nothing is ever noted.
"""

import os
import signal
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress

SIGNALS = tuple(
    getattr(signal, name)
    for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGBREAK")
    if hasattr(signal, name)
)
"""What asks: Ctrl-C, the system or a batch queue, a terminal that closes."""

STOPPED = 3
"""Exit status of a program that was stopped, see `cli.output.Status`."""

_asked: list[str] = []
"""Names of the signals that came; of the process, as signals are."""


class _Patience:
    """How long the program may take to end after a signal; of the process, as signals are.

    Attributes
    ----------
    seconds : float
        Time after which it is ended where nothing looks at the note; 0: never.
    protected : int
        Number of blocks in progress that have something to put away first.
    deferring : bool
        Whether a block is in progress that an exception must not leave.
    raised : bool
        Whether the exception that ends the program is on its way.
    reported : bool
        Whether the program has printed why it ends.
    """

    seconds = 0.0
    protected = 0
    deferring = False
    raised = False
    reported = False


_patience = _Patience()


def heed() -> None:
    """Stop here if the program was asked to.

    Raises
    ------
    KeyboardInterrupt
        With the name of the signal.
    """
    if _asked:
        _patience.raised = True
        raise KeyboardInterrupt(_asked[0])


def note_signals(seconds: float, early: Iterable[int] = ()) -> None:
    """Note signals that ask to stop, until the process ends; to be called in the main thread.

    What takes long without a look at the note, as imports and drawing do, is ended at once when
    so much time is over. In a `protected` block a KeyboardInterrupt is raised instead.

    Parameters
    ----------
    seconds : float
        Time from the signal.
    early : iterable of int
        Signals that came before.
    """
    for number in SIGNALS:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _note)
    _patience.seconds = seconds
    for number in early:
        _note(number, None)


@contextmanager
def protected() -> Iterator[None]:
    """Leave the block by an exception if it is interrupted: it has something to put away."""
    _patience.protected += 1
    try:
        yield
    finally:
        _patience.protected -= 1


@contextmanager
def kept() -> Iterator[None]:
    """Note signals that ask to stop, for `heed`; a second one ends the process at once.

    Those that the process ignores (SIGHUP under nohup) stay ignored. To be used in the main thread.
    """
    before = {one: signal.getsignal(one) for one in SIGNALS}
    for one, handler in before.items():
        if handler is not signal.SIG_IGN:
            signal.signal(one, _note)
    try:
        yield
    finally:
        for one, handler in before.items():
            if handler is not None:  # None: a handler that is not Python's, and cannot be put back
                signal.signal(one, handler)
        _asked.clear()


@contextmanager
def deferred() -> Iterator[None]:
    """Let Ctrl-C wait until the block ends, in programs that keep Python's own handler.

    What is not Python cannot always be left by an exception. Threads other than the main one are
    never interrupted.
    """
    came: list[int] = []
    before, _patience.deferring = _patience.deferring, True
    try:
        if signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
            raise ValueError
        signal.signal(signal.SIGINT, lambda number, _frame: came.append(number))
    except ValueError:
        try:
            yield
        finally:
            _patience.deferring = before
        return
    try:
        yield
    finally:
        _patience.deferring = before
        signal.signal(signal.SIGINT, signal.default_int_handler)
    if came:
        raise KeyboardInterrupt


def mark_reported() -> None:
    """Note that the program has printed why it ends: if it ends at once, it prints nothing more."""
    _patience.reported = True


def ignore() -> None:
    """Ignore signals while the process ends: the exit status is that of what it has done."""
    _patience.seconds = 0.0
    _asked.clear()
    for one in SIGNALS:
        signal.signal(one, signal.SIG_IGN)


def _note(number: int, _frame) -> None:
    if _asked:
        _end_at_once("ended at once")
    _asked.append(signal.Signals(number).name)
    _wait()


def _wait() -> None:
    """Have the system call `_overdue` when patience ends; Windows has no such timer."""
    if _patience.seconds and hasattr(signal, "setitimer"):
        signal.signal(signal.SIGALRM, _overdue)
        signal.setitimer(signal.ITIMER_REAL, _patience.seconds)


def _overdue(_number: int, _frame) -> None:
    if not _patience.seconds:
        return
    if not _patience.protected:
        _end_at_once("interrupted")
    if _patience.deferring or _patience.raised:
        _wait()
        return
    _patience.raised = True
    _wait()
    raise KeyboardInterrupt(_asked[0])


def _end_at_once(message: str) -> None:
    # Nothing is cleaned up: a results file is whole at every moment.
    with suppress(OSError):
        show_cursor = b"\x1b[?25h" if os.isatty(2) else b""  # a progress bar hides it
        line = "" if _patience.reported else f"error: {message}\n"
        os.write(2, show_cursor + line.encode())
    os._exit(STOPPED)
