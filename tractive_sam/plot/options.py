"""Options of all figures: units, titles, size and measured points."""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, replace
from typing import Any, Literal

from tractive_sam.plot.measured import Measurements

UNITS = ("hertz", "si-mm")
"""Units of lengths and pressures in figures: over Hertz's, or in mm and MPa."""


@dataclass(frozen=True)
class FigureOptions:
    """Options of figures: units, titles, scale of the sizes, and measured points to draw.

    Attributes
    ----------
    units : str
        One of `UNITS`.
    titles : bool
        Whether figures have titles.
    scale : float
        Width over the usual one; fonts shrink with it, to 60 % at most.
    measured : Measurements, optional
        Points that are drawn with the columns of a history.

    Raises
    ------
    ValueError
        If the units are unknown.
    """

    units: str = "hertz"
    titles: bool = True
    scale: float = 1.0
    measured: Measurements | None = None

    def __post_init__(self) -> None:
        if self.units not in UNITS:
            raise ValueError(f"units is {self.units!r}; allowed: {', '.join(UNITS)}")

    @property
    def font_scale(self) -> float:
        """Size of fonts over the default size, at least 0.6."""
        return max(self.scale, 0.6)


_CURRENT: ContextVar[FigureOptions] = ContextVar("options of figures")


def current_options() -> FigureOptions:
    """Return the figure options in effect."""
    return _CURRENT.get(None) or FigureOptions()


@contextmanager
def change_options(**changes: Any) -> Iterator[None]:
    """Return a context in which figures are drawn with changed options."""
    token = _CURRENT.set(replace(current_options(), **changes))
    try:
        yield
    finally:
        _CURRENT.reset(token)


@contextmanager
def units(name: Literal["hertz", "si-mm"]) -> Iterator[None]:
    """Return a context in which figures use units "hertz" (relative) or "si-mm" (mm, MPa).

    Parameters
    ----------
    name : str
        "hertz", the default, or "si-mm".

    Raises
    ------
    ValueError
        If the units are unknown.

    Examples
    --------
    >>> with plot.units("si-mm"):
    ...     plot.pressure(contact).axes[0].get_ylabel()
    '$y$ (mm)'
    """
    with change_options(units=name):
        yield
