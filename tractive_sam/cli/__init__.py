"""The command line: scenes in, results files, tables and figures out.

A command imports numerical packages only when it runs, so that its help appears at once. This
module imports almost nothing: `main` handles signals before it loads any other module.
"""

__all__ = ["app", "main"]

OBJECTS = 10_000
"""New objects after which Python looks for what has no use any more, while the program runs. At its
own 700 it does so hundreds of times while modules are loaded, for a tenth of that time."""


PATIENCE = 1.0
"""Seconds after a signal in which the program may end as it does, before it is ended."""


def main() -> None:
    """Run the program; SIGINT, SIGTERM and SIGHUP end it within the time of `PATIENCE`."""
    early = _note_at_once()
    from tractive_sam.interrupt import ignore_signals, note_signals

    note_signals(PATIENCE, early)
    import atexit
    import gc

    try:
        gc.set_threshold(OBJECTS)
        from tractive_sam.cli.program import run_program

        run_program()
    finally:
        ignore_signals()
        atexit.register(gc.freeze)  # what is left goes with the process: a fifth of a second


def _note_at_once() -> list[int]:
    """Note signals by what Python has loaded already; the list holds those that came."""
    # The part of `signal` that is in C, without the modules that `signal` loads.
    import _signal  # type: ignore[import-not-found]

    came: list[int] = []
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):
        number = getattr(_signal, name, None)
        if number is not None and _signal.getsignal(number) != _signal.SIG_IGN:
            _signal.signal(number, lambda number, _frame: came.append(number))
    return came


def __getattr__(name: str):
    if name == "app":
        from tractive_sam.cli.program import app

        return app
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
