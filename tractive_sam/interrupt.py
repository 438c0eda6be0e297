"""What asks the program to stop, kept until a safe moment.

A KeyboardInterrupt that Python raises wherever it happens to be is lost where nothing can be raised
(in a callback of the garbage collector), or ends as a traceback of whatever was being imported. So
the command line only notes that it was asked, and all that takes long looks at the note: every
transform does (`operators.fft`), and so does every loop over records, cases and figures. A program
that imports this package keeps its own handlers: there, nothing is ever noted.
"""

import os
import signal
from collections.abc import Iterator
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


def heed() -> None:
    """Stop here if the program was asked to.

    Raises
    ------
    KeyboardInterrupt
        With the name of the signal.
    """
    if _asked:
        raise KeyboardInterrupt(_asked[0])


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
    try:
        if signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
            raise ValueError
        signal.signal(signal.SIGINT, lambda number, _frame: came.append(number))
    except ValueError:
        yield
        return
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    if came:
        raise KeyboardInterrupt


def ignore() -> None:
    """Ignore signals while the process ends: the exit status is that of what it has done."""
    for one in SIGNALS:
        signal.signal(one, signal.SIG_IGN)


def _note(number: int, _frame) -> None:
    if _asked:
        _end_at_once()
    _asked.append(signal.Signals(number).name)


def _end_at_once() -> None:
    # Nothing is cleaned up: a results file is whole at every moment.
    with suppress(OSError):
        show_cursor = b"\x1b[?25h" if os.isatty(2) else b""  # a progress bar hides it
        os.write(2, show_cursor + b"\nerror: ended at once\n")
    os._exit(STOPPED)
