"""One contact and what it is drawn against."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Self, TypeAlias

import numpy as np
from scipy.ndimage import binary_opening

from tractive_sam.plot.scale import Scale
from tractive_sam.plot.style import friction_label, place, told
from tractive_sam.results import REVOLUTION, History, Quantity, State


@dataclass(frozen=True, eq=False)
class Drawn:
    r"""One contact and what it is drawn against.

    Attributes
    ----------
    contact : State
        The contact.
    scale : Scale
        Half widths and pressure that stand for one.
    coordinate : Quantity
        What its history goes along.
    at : float
        Where it is in its history.
    history : History, optional
        The history that it is a record of.

    Examples
    --------
    >>> drawn = plot.Drawn.of(history, revolution=2)
    >>> drawn.caption, drawn.isotropic
    ('Twin discs, orthotropic friction and wear, N\xa0=\xa02', False)
    """

    contact: State
    scale: Scale
    coordinate: Quantity = REVOLUTION
    at: float = 0
    history: History | None = None

    @classmethod
    def of(cls, source: "Source", at: float | None = None, **named: float) -> Self:
        """What is drawn of a contact, or of a record of a history, by default the last stored.

        Raises
        ------
        TypeError
            If it is neither.
        LookupError
            If the history did not store the fields of the record.
        """
        if isinstance(source, Drawn):
            return source
        if not isinstance(source, History | State):
            kind = type(source).__name__
            raise TypeError(f"source: a contact or a history is needed, not {kind}")
        if isinstance(source, History):
            saved = source.saved[source.row_of(at, **named)]
            scale = Scale.of_history(source)
            return cls(source.state(saved), scale, source.coordinate, saved, source)
        return cls(source, Scale.of_contact(source), at=source.revolution)

    @property
    def x(self) -> np.ndarray:
        """Centres of the elements in the rolling direction, mm."""
        return self.contact.grid.x

    @property
    def y(self) -> np.ndarray:
        """Centres of the elements in the lateral direction, mm."""
        return self.contact.grid.y

    @property
    def columns(self) -> Mapping[str, Quantity]:
        """Columns of its history."""
        return {} if self.history is None else self.history.columns

    @property
    def title(self) -> str:
        """Title of the scene, with a mark on what is not a solution."""
        mark = "" if self.contact.converged else f"not converged: {self.contact.status}"
        return ", ".join(filter(None, (self.contact.scene.title, mark)))

    @property
    def caption(self) -> str:
        """Title of the scene and, where something was rolled, the place in its course."""
        rolled = self.place.replace("$", "").replace(" ", "\u00a0") if self.at else ""
        return ", ".join(filter(None, (self.title, rolled)))

    def told(self, quantity: str, scaled: bool = True) -> str:
        """Title of a figure: of the scene, and what is drawn, where, and over which scale."""
        in_course = self.history is not None and len(self.history) > 1
        return told(
            self.title,
            quantity,
            self.place if self.at or in_course else "",
            friction_label(self.contact.frame),
            self.scale.told if scaled else "",
        )

    @property
    def ahead(self) -> str:
        """Where the leading edge is, told after the name of x; of shifts nowhere."""
        return "" if self.contact.scene.schedule.shifts else ", leading edge right"

    @property
    def place(self) -> str:
        """Where it is in its history, as math text."""
        return place(self.coordinate, self.at)

    @property
    def isotropic(self) -> bool:
        """Whether friction is the same in all directions."""
        frame = self.contact.frame
        return frame is None or frame.mu[0] == frame.mu[1]

    @property
    def x_over_a(self) -> np.ndarray:
        """Centres in the rolling direction in half widths a, or mm, shape (n_x,)."""
        return self.x / self.scale.length

    @property
    def y_over_a(self) -> np.ndarray:
        """Centres in the lateral direction in half widths a, or mm, shape (n_y,)."""
        return self.y / self.scale.length

    @cached_property
    def slip_zone(self) -> np.ndarray:
        """Elements that slip together with the next one in x, bool.

        On a mesh the steps of the leading edge slip, where the bound nearly vanishes; a layer of
        one element is no zone.
        """
        return binary_opening(self.contact.sliding, [[True], [True]])

    @property
    def bounds(self) -> tuple[float, float]:
        """Largest |p_x|/p_n and |p_y|/p_n that friction allows."""
        if self.contact.frame is None:
            return 0.0, 0.0
        return tuple(np.linalg.norm(self.contact.frame.matrix, axis=0).tolist())


def chosen(saved: np.ndarray, most: int = 8) -> np.ndarray:
    """Return at most so many of the values, the first and the last among them.

    Examples
    --------
    >>> plot.chosen(np.arange(100), 4).tolist()
    [0, 33, 66, 99]
    """
    if len(saved) <= most:
        return saved
    return saved[np.linspace(0, len(saved) - 1, most).round().astype(int)]


Source: TypeAlias = "Drawn | State | History"
"""What holds a contact; a history holds one of each record whose fields it stored."""
