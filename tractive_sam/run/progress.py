"""Bars that show how far a roll is, in a terminal and in a notebook."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from html import escape
from time import perf_counter
from typing import Any, Protocol

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from tractive_sam.results import Record
from tractive_sam.rolling import Forecast
from tractive_sam.scene import Scene
from tractive_sam.solvers import report_to

AT_FIRST = 2.0
"""Seconds before anything is shown, unless it is asked for: most rolls are over by then."""


class Bar(Protocol):
    """A bar somewhere."""

    def show(self, text: str, done: float, total: float | None, left: str) -> None:
        """Show how much is done of a total, where that is known, and the time left."""

    def close(self) -> None:
        """Take it away."""


@contextmanager
def progress_shown(
    scene: Scene,
    progress: bool | Callable[[Record], None] | None = None,
    terminal: Console | None = None,
) -> Iterator[Callable[[Record], None] | None]:
    """What is to be called with each record of a roll.

    Parameters
    ----------
    scene : Scene
        What is rolled.
    progress : bool or callable, optional
        What to call; True for a bar, False for none. By default, a bar where somebody sees it, of
        a roll that takes longer.
    terminal : Console, optional
        Where to; by default the standard error.
    """
    if callable(progress):
        yield progress
        return
    forecast = Forecast(scene)
    if progress is False or (progress is None and not forecast.end):
        yield None
        return
    bar = _bar(terminal or Console(stderr=True))
    if bar is None:
        yield None
        return
    shown = _RollProgress(scene, forecast, bar, at_once=bool(progress))
    try:
        if progress:
            bar.show(shown.first, 0.0, None, "")
        with report_to(shown.show_iteration):
            yield shown.show_record
    finally:
        bar.close()


class _RollProgress:
    """The bar of a roll."""

    def __init__(self, scene: Scene, forecast: Forecast, bar: Bar, at_once: bool) -> None:
        self.scene, self.forecast, self.bar, self.at_once = scene, forecast, bar, at_once
        self.began, self.first = perf_counter(), "solving the unworn bodies"
        if scene.accuracy is not None and forecast.end:
            self.first = "rolling on coarser meshes"

    def show_iteration(self, mesh: tuple[int, int], residual: float) -> None:
        """Show the residual of the first contact."""
        if self.at_once and not self.forecast.done:
            self.bar.show(f"{self.first}, {_solving(mesh, residual)}", 0.0, None, "")

    def show_record(self, record: Record) -> None:
        """Show how far the roll is, and the time left."""
        forecast = self.forecast
        numbers = (float(record.values.get(name, 1.0)) for name in ("jump", "solves", "seconds"))
        wear, approach = (float(np.max(record.values[of])) for of in ("wear_max", "approach"))
        worn = wear / approach if approach > 0.0 else 0.0
        forecast.add(float(record.at), *numbers, worn=worn)
        if self.at_once or perf_counter() - self.began > AT_FIRST:
            along = record.coordinate
            place, end = (format(one, along.format) for one in (record.at, forecast.end))
            text = f"{along.name} {place} of {end}"
            if self.scene.has("wear"):
                text += f", wear {1e3 * wear:.3g} µm"
            left = duration(forecast.seconds_left)
            self.bar.show(text, forecast.done, forecast.done + forecast.left, left)


@contextmanager
def solving_shown(progress: bool | None = None, terminal: Console | None = None) -> Iterator[None]:
    """Show how far the contact is that is solved in the block.

    Parameters
    ----------
    progress : bool, optional
        True for a bar, False for none. By default, a bar where somebody sees it, of what takes
        longer.
    terminal : Console, optional
        Where to; by default the standard error.
    """
    if progress is False:
        yield
        return
    began, bars = perf_counter(), list[Bar]()

    def show(mesh: tuple[int, int], residual: float) -> None:
        if not (progress or perf_counter() - began > AT_FIRST):
            return
        if not bars and (bar := _bar(terminal or Console(stderr=True))) is not None:
            bars.append(bar)
        for bar in bars:
            bar.show(f"solving, {_solving(mesh, residual)}", 0.0, None, "")

    try:
        with report_to(show):
            yield
    finally:
        for bar in bars:
            bar.close()


def _solving(mesh: tuple[int, int], residual: float) -> str:
    return f"{' x '.join(map(str, mesh))} elements, residual {residual:.1g}"


def duration(seconds: float) -> str:
    """Time left, "1:05" or "2:00:00"."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"


def _bar(terminal: Console) -> Bar | None:
    """A bar where somebody sees it."""
    if _in_notebook():
        return _Notebook()
    return _Terminal(terminal) if terminal.is_terminal else None


def _in_notebook() -> bool:
    shell = sys.modules.get("IPython")
    running = None if shell is None else shell.get_ipython()
    return getattr(running, "kernel", None) is not None


class _Terminal:
    def __init__(self, terminal: Console) -> None:
        self._bar = Progress(
            SpinnerColumn(),
            TextColumn("{task.description}"),
            BarColumn(),
            TimeElapsedColumn(),
            TextColumn("{task.fields[left]}"),
            console=terminal,
            transient=True,
        )
        self._task = self._bar.add_task("", total=None, left="")

    def show(self, text: str, done: float, total: float | None, left: str) -> None:
        told = f"left {left}" if left else ""
        self._bar.update(self._task, description=text, completed=done, total=total, left=told)
        self._bar.start()

    def close(self) -> None:
        self._bar.stop()


class _Notebook:
    """A line of HTML that is replaced as it goes on, at most some times a second."""

    def __init__(self) -> None:
        self._shown: Any = None
        self._last = 0.0

    def show(self, text: str, done: float, total: float | None, left: str) -> None:
        if perf_counter() - self._last < 0.2:
            return
        self._last = perf_counter()
        share = "" if total is None else f' value="{done / max(total, 1e-9):.4f}"'
        told = escape(f"{text}, {left} left" if left else text)
        self._put({"text/html": f"<progress{share}></progress> {told}", "text/plain": told})

    def close(self) -> None:
        if self._shown is not None:
            self._put({"text/html": "", "text/plain": ""})

    def _put(self, bundle: dict[str, str]) -> None:
        from IPython.display import display  # noqa: PLC0415 - it is there, as we are in it

        if self._shown is None:
            self._shown = display(bundle, raw=True, display_id=True)
        else:
            self._shown.update(bundle, raw=True)
