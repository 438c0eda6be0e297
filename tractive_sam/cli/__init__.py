"""The command line: reads scenes and writes results files, tables and figures.

The modules of commands import what computes only when they run, so that help appears at once. This
module imports next to nothing: `main` handles signals before anything else is loaded.
"""

__all__ = ["app", "main"]


def main(grace: float = 1.0, objects: int = 10_000) -> None:
    """Run the program `tractive-sam`; SIGINT, SIGTERM and SIGHUP end it within a grace period, s.

    Parameters
    ----------
    grace : float
        Seconds after a signal in which the program may end in an orderly way.
    objects : int
        New objects after which Python searches for unused ones. At its default of 700 it does so
        hundreds of times while modules are loaded, for a tenth of that time.
    """
    early = _record_signals()
    from tractive_sam.interrupt import ignore_signals, note_signals

    note_signals(grace, early)
    import atexit
    import gc

    try:
        gc.set_threshold(objects)
        from tractive_sam.cli.program import run_program

        run_program()
    finally:
        ignore_signals()
        atexit.register(gc.freeze)  # the process frees its memory anyway: saves 0.2 s


def _record_signals() -> list[int]:
    """Handle signals early, without slow imports; return the list that collects their numbers."""
    # The part of `signal` that is in C, without the modules that `signal` loads.
    import _signal  # type: ignore[import-not-found]

    received: list[int] = []
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):
        number = getattr(_signal, name, None)
        if number is not None and _signal.getsignal(number) != _signal.SIG_IGN:
            _signal.signal(number, lambda number, _frame: received.append(number))
    return received


def __getattr__(name: str):
    if name == "app":
        from tractive_sam.cli.program import app

        return app
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
