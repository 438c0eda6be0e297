"""Progress of a solve: the mesh and its residual, reported to what shows them."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

Reporter = Callable[[tuple[int, int], float], None]
"""Takes the mesh that is solved on, and the residual there."""

_reporter: ContextVar[Reporter | None] = ContextVar("reporter", default=None)


@contextmanager
def report_to(reporter: Reporter) -> Iterator[None]:
    """Within the block, call a function with the mesh and residual of every iteration."""
    before = _reporter.set(reporter)
    try:
        yield
    finally:
        _reporter.reset(before)


def report_progress(mesh: tuple[int, int], residual: float) -> None:
    """Call the function of `report_to`, if there is one, with a mesh and a residual."""
    if (reporter := _reporter.get()) is not None:
        reporter(mesh, residual)
