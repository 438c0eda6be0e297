"""Signals that stop the program, deferred until a safe moment.

Python raises a KeyboardInterrupt at any line. It is lost in code that cannot raise (a callback of
the garbage collector), and it ends as a traceback if it interrupts an import. So the command line
only notes a signal. Every long computation checks the note with `raise_if_interrupted`: each
transform (`compute.fft`) and each loop over records, cases and figures. A program that imports
this package has its own signal handlers: no signal is noted there.
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
"""Signals that stop the program: from Ctrl-C, a batch queue, a terminal that closes."""

_received: list[str] = []
"""Names of the signals received. Global, because signals belong to the process."""


class _SignalState:
    """State of the signal handling of the process (one for all threads).

    Attributes
    ----------
    seconds : float
        Time from the signal after which the program is ended without a check; 0: never.
    protected : int
        Number of active `protect_cleanup` blocks.
    deferring : bool
        Whether a `delay_interrupt` block is active.
    raised : bool
        Whether the KeyboardInterrupt that ends the program has been raised.
    reported : bool
        Whether the program has printed why it ends.
    """

    seconds = 0.0
    protected = 0
    deferring = False
    raised = False
    reported = False


_state = _SignalState()


def raise_if_interrupted() -> None:
    """Raise KeyboardInterrupt if a signal to stop has been received.

    Raises
    ------
    KeyboardInterrupt
        With the name of the signal.
    """
    if _received:
        _state.raised = True
        raise KeyboardInterrupt(_received[0])


def note_signals(seconds: float, early: Iterable[int] = ()) -> None:
    """Note signals that stop the program, instead of stopping it at once; for the main thread.

    Some code runs long without checking the note (imports, drawing). The process is ended if it
    still runs `seconds` after the signal. In a `protect_cleanup` block a KeyboardInterrupt is
    raised instead.

    Parameters
    ----------
    seconds : float
        Longest time from the signal to the end of the process.
    early : iterable of int
        Signals received before this call.
    """
    for number in SIGNALS:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _note_signal)
    _state.seconds = seconds
    for number in early:
        _note_signal(number, None)


@contextmanager
def protect_cleanup() -> Iterator[None]:
    """Let signals stop the block only by an exception, so that the block can clean up."""
    _state.protected += 1
    try:
        yield
    finally:
        _state.protected -= 1


@contextmanager
def delay_interrupt() -> Iterator[None]:
    """Delay Ctrl-C until the block ends, in programs that use Python's default handler.

    An exception must not interrupt a library that is not written in Python, for example HDF5.
    Threads other than the main thread are never interrupted.
    """
    delayed: list[int] = []
    before, _state.deferring = _state.deferring, True
    try:
        if signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
            raise ValueError
        signal.signal(signal.SIGINT, lambda number, _frame: delayed.append(number))
    except ValueError:
        try:
            yield
        finally:
            _state.deferring = before
        return
    try:
        yield
    finally:
        _state.deferring = before
        signal.signal(signal.SIGINT, signal.default_int_handler)
    if delayed:
        raise KeyboardInterrupt


def mark_reported() -> None:
    """Note that the program has printed why it ends, so that nothing more is printed."""
    _state.reported = True


def ignore_signals() -> None:
    """Ignore signals while the process ends, so that they do not change the exit status."""
    _state.seconds = 0.0
    if hasattr(signal, "setitimer"):
        # Python removes the handler of the timer at its end; the signal would kill the process.
        signal.setitimer(signal.ITIMER_REAL, 0.0)
    _received.clear()
    for number in SIGNALS:
        signal.signal(number, signal.SIG_IGN)


def _note_signal(number: int, _frame) -> None:
    """Note a signal and start the timer; at the second signal, end the process."""
    if _received:
        _end_at_once("ended at once")
    _received.append(signal.Signals(number).name)
    _start_timer()


def _start_timer() -> None:
    """Start a timer that ends the process after the grace period; not available on Windows."""
    if _state.seconds and hasattr(signal, "setitimer"):
        signal.signal(signal.SIGALRM, _end_overdue)
        signal.setitimer(signal.ITIMER_REAL, _state.seconds)


def _end_overdue(_number: int, _frame) -> None:
    """End a process that has not ended in time; in `protect_cleanup`, raise KeyboardInterrupt."""
    if not _state.seconds:
        return
    if not _state.protected:
        _end_at_once("interrupted")
    if _state.deferring or _state.raised:
        _start_timer()
        return
    _state.raised = True
    _start_timer()
    raise KeyboardInterrupt(_received[0])


def _end_at_once(message: str) -> None:
    """Print a message, unless one was printed, and end the process at once with status 3."""
    # Exit status of a program that was stopped, see `cli.output.Status`.
    stopped = 3
    # No cleanup is needed: a results file is complete at every moment.
    with suppress(OSError):
        show_cursor = b"\x1b[?25h" if os.isatty(2) else b""  # a progress bar hides it
        line = "" if _state.reported else f"error: {message}\n"
        os.write(2, show_cursor + line.encode())
    os._exit(stopped)
