"""The command line: scenes in, results files, tables and figures out.

Modules of commands import what computes only when they are run, so that help comes at once. This
one imports next to nothing: `main` heeds signals before anything else is loaded.
"""

import atexit
import gc

from tractive_sam import interrupt

__all__ = ["app", "main"]

OBJECTS = 10_000
"""New objects after which Python looks for what has no use any more, while the program runs. At its
own 700 it does so hundreds of times while modules are loaded, for a tenth of that time."""


def main() -> None:
    """Run the program; SIGINT, SIGTERM and SIGHUP end it after the work at hand."""
    try:
        gc.set_threshold(OBJECTS)
        with interrupt.kept():
            from tractive_sam.cli.program import run_program

            run_program()
    finally:
        atexit.register(gc.freeze)  # what is left goes with the process: a fifth of a second
        atexit.register(interrupt.ignore)  # the last one registered is the first one called


def __getattr__(name: str):
    if name == "app":
        from tractive_sam.cli.program import app

        return app
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
