"""Show the progress of a computation in a terminal or a notebook."""

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

DELAY = 2.0
"""Seconds before a bar appears by default: most rolls are finished by then."""


class Bar(Protocol):
    """Protocol of a progress bar in a terminal or a notebook."""

    def show(self, text: str, done: float, total: float | None, remaining: str) -> None:
        """Show a text, work done of a total (None if unknown), and the remaining time."""

    def close(self) -> None:
        """Remove the bar."""


@contextmanager
def show_roll_progress(
    scene: Scene,
    progress: bool | Callable[[Record], None] | None = None,
    terminal: Console | None = None,
) -> Iterator[Callable[[Record], None] | None]:
    """Show a progress bar; yield the function to call with each record, None without a bar.

    Parameters
    ----------
    scene : Scene
        Scene that is rolled.
    progress : bool or callable, optional
        Function to call instead. True shows a bar, False none. By default a bar appears in a
        terminal or a notebook if the roll takes long.
    terminal : Console, optional
        Terminal for the bar; by default the standard error.
    """
    if callable(progress):
        yield progress
        return
    forecast = Forecast(scene)
    if progress is False or (progress is None and not forecast.end):
        yield None
        return
    bar = open_bar(terminal or Console(stderr=True))
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
    """Progress bar of a roll, with the forecast of the remaining time."""

    def __init__(self, scene: Scene, forecast: Forecast, bar: Bar, at_once: bool) -> None:
        self.scene, self.forecast, self.bar, self.at_once = scene, forecast, bar, at_once
        self.began, self.first = perf_counter(), "solving the unworn bodies"
        if scene.accuracy is not None and forecast.end:
            self.first = "rolling on coarser meshes"

    def show_iteration(self, mesh: tuple[int, int], residual: float) -> None:
        """Show mesh and residual of the first contact, if the bar was requested."""
        if self.at_once and not self.forecast.done:
            self.bar.show(f"{self.first}, {_solving(mesh, residual)}", 0.0, None, "")

    def show_record(self, record: Record) -> None:
        """Update the bar after a record: coordinate, wear depth, remaining time."""
        forecast = self.forecast
        jump, solves, seconds = (
            float(record.values.get(name, 1.0)) for name in ("jump", "solves", "seconds")
        )
        wear, approach = (float(np.max(record.values[name])) for name in ("wear_max", "approach"))
        worn = wear / approach if approach > 0.0 else 0.0
        forecast.add(float(record.at), jump, solves, seconds, worn=worn)
        if self.at_once or perf_counter() - self.began > DELAY:
            along, total = record.coordinate, None
            place, end = (format(value, along.format) for value in (record.at, forecast.end))
            text, remaining = f"{along.name} {place}", ""
            if self.scene.schedule.ends_there:
                text, total = f"{text} of {end}", forecast.done + forecast.left
                remaining = format_remaining_time(forecast.remaining_seconds)
            if self.scene.has("wear"):
                text += f", wear {1e3 * wear:.3g} µm"
            self.bar.show(text, forecast.done, total, remaining)


@contextmanager
def show_solving(progress: bool | None = None, terminal: Console | None = None) -> Iterator[None]:
    """Show a progress bar while the block solves, if it takes long (True: at once, False: never).

    Parameters
    ----------
    progress : bool, optional
        True shows a bar, False none. By default a bar appears in a terminal or a notebook if the
        solve takes long.
    terminal : Console, optional
        Terminal for the bar; by default the standard error.
    """
    if progress is False:
        yield
        return
    began, bars = perf_counter(), list[Bar]()

    def show(mesh: tuple[int, int], residual: float) -> None:
        if not (progress or perf_counter() - began > DELAY):
            return
        if not bars and (bar := open_bar(terminal or Console(stderr=True))) is not None:
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
    """Describe the mesh and the residual of a running solve."""
    return f"{' x '.join(map(str, mesh))} elements, residual {residual:.1g}"


def format_remaining_time(seconds: float) -> str:
    """Format a time as "1:05" or "2:00:00"."""
    minutes, seconds = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{seconds:02}" if hours else f"{minutes}:{seconds:02}"


def open_bar(terminal: Console) -> Bar | None:
    """Return a new bar for the notebook or the terminal; None for other outputs."""
    shell = sys.modules.get("IPython")
    running = None if shell is None else shell.get_ipython()
    if getattr(running, "kernel", None) is not None:
        return _Notebook()
    return _Terminal(terminal) if terminal.is_terminal else None


class _Terminal:
    """Progress bar in a terminal (rich)."""

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

    def show(self, text: str, done: float, total: float | None, duration: str) -> None:
        """Show a text, work done of a total (None if unknown), and the remaining time."""
        remaining = f"left {duration}" if duration else ""
        self._bar.update(self._task, description=text, completed=done, total=total, left=remaining)
        self._bar.start()

    def close(self) -> None:
        """Remove the bar."""
        self._bar.stop()


class _Notebook:
    """Progress bar in a notebook: a line of HTML, updated at most five times a second."""

    def __init__(self) -> None:
        self._shown: Any = None
        self._last = 0.0

    def show(self, text: str, done: float, total: float | None, remaining: str) -> None:
        """Show text, work done and remaining time, at most five times a second."""
        if perf_counter() - self._last < 0.2:
            return
        self._last = perf_counter()
        share = "" if total is None else f' value="{done / max(total, 1e-9):.4f}"'
        label = escape(f"{text}, {remaining} left" if remaining else text)
        self._put({"text/html": f"<progress{share}></progress> {label}", "text/plain": label})

    def close(self) -> None:
        """Remove the bar."""
        if self._shown is not None:
            self._put({"text/html": "", "text/plain": ""})

    def _put(self, bundle: dict[str, str]) -> None:
        """Display a MIME bundle, or replace the displayed one."""
        from IPython.display import display  # noqa: PLC0415 - available inside a notebook

        if self._shown is None:
            self._shown = display(bundle, raw=True, display_id=True)
        else:
            self._shown.update(bundle, raw=True)
