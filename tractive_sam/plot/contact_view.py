"""A contact with its scale and its place in a history, as figures draw it."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Self, TypeAlias

import numpy as np

from tractive_sam.deprecation import renamed_attributes
from tractive_sam.description import math_value
from tractive_sam.plot.scale import Scale
from tractive_sam.plot.style import describe_friction, format_title
from tractive_sam.results import REVOLUTION, History, Quantity, State


@renamed_attributes(
    of="from_source", told="describe", place="position", ahead="edge_note", bounds="bound_ratios"
)
@dataclass(frozen=True, eq=False)
class ContactView:
    r"""Contact as figures draw it: with its scale and its position in a history.

    Attributes
    ----------
    contact : State
        The contact.
    scale : Scale
        Half widths and pressure by which figures divide.
    coordinate : Quantity
        Coordinate of the history.
    at : float
        Value of the coordinate.
    history : History, optional
        History that the contact is a record of.

    Examples
    --------
    >>> view = plot.ContactView.from_source(history, revolution=2)
    >>> view.caption, view.isotropic
    ('Twin discs, orthotropic friction and wear, N\xa0=\xa02', False)
    """

    contact: State
    scale: Scale
    coordinate: Quantity = REVOLUTION
    at: float = 0
    history: History | None = None

    @classmethod
    def from_source(cls, source: "Source", at: float | None = None, **named: float) -> Self:
        """Return the view of a contact, or of a record of a history, by default the last stored.

        Raises
        ------
        TypeError
            If the source is neither a contact nor a history.
        LookupError
            If the history did not store the fields of the record.
        """
        if isinstance(source, cls):
            return source
        if isinstance(source, History):
            saved = source.saved[source.row_of(at, **named)]
            scale = Scale.from_history(source)
            return cls(source.state(saved), scale, source.coordinate, saved, source)
        if isinstance(source, State):
            return cls(source, Scale.from_contact(source), at=source.revolution)
        kind = type(source).__name__
        raise TypeError(f"source: a contact or a history is needed, not {kind}")

    @property
    def x(self) -> np.ndarray:
        """Centres of the elements in the rolling direction, mm, shape (n_x,)."""
        return self.contact.grid.x

    @property
    def y(self) -> np.ndarray:
        """Centres of the elements in the lateral direction, mm, shape (n_y,)."""
        return self.contact.grid.y

    @property
    def columns(self) -> Mapping[str, Quantity]:
        """Columns of the history to which the contact belongs, by name; empty without one."""
        return {} if self.history is None else self.history.columns

    @property
    def title(self) -> str:
        """Title of the scene, with a note if the contact is not solved."""
        note = "" if self.contact.converged else f"not converged: {self.contact.status}"
        return ", ".join(filter(None, (self.contact.scene.title, note)))

    @property
    def caption(self) -> str:
        """Title of the scene and, unless it is 0, the position in the history."""
        position = self.position.replace("$", "").replace(" ", "\u00a0") if self.at else ""
        return ", ".join(filter(None, (self.title, position)))

    def describe(self, quantity: str, scaled: bool = True) -> str:
        """Return the title of a figure: the scene, the quantity, the position and the scale."""
        in_course = self.history is not None and len(self.history) > 1
        return format_title(
            self.title,
            quantity,
            self.position if self.at or in_course else "",
            describe_friction(self.contact.frame),
            self.scale.note if scaled else "",
        )

    @property
    def edge_note(self) -> str:
        """Note on the side of the leading edge, for the label of x; empty for shifts."""
        return "" if self.shifts else ", leading edge right"

    @property
    def shifts(self) -> bool:
        """Whether the bodies shift without rolling in the step of the contact."""
        return self.contact.scene.schedule.shifts_at(self.at)

    @property
    def position(self) -> str:
        """Position of the contact in its history (revolution, distance) as math text."""
        return math_value(self.coordinate, self.at)

    @property
    def isotropic(self) -> bool:
        """Whether friction is equal in all directions."""
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
        """Mask of slip for maps: slipping elements with a slipping neighbour in x.

        On a mesh the steps of the leading edge slip, because the traction bound nearly vanishes
        there; a layer of one element is no zone.
        """
        sliding = self.contact.sliding
        neighbours = np.pad(sliding, ((1, 1), (0, 0)))
        return sliding & (neighbours[2:] | neighbours[:-2])

    @property
    def bound_ratios(self) -> tuple[float, float]:
        """Largest |p_x|/p_n and |p_y|/p_n that friction allows; zeros without friction."""
        if self.contact.frame is None:
            return 0.0, 0.0
        x, y = np.linalg.norm(self.contact.frame.matrix, axis=0).tolist()
        return x, y


def select_evenly(saved: np.ndarray, count: int = 8) -> np.ndarray:
    """Return at most `count` of some values, evenly spaced, with the first and the last.

    Examples
    --------
    >>> plot.select_evenly(np.arange(100), 4).tolist()
    [0, 33, 66, 99]
    """
    if len(saved) <= count:
        return saved
    return saved[np.linspace(0, len(saved) - 1, count).round().astype(int)]


Source: TypeAlias = "ContactView | State | History"
"""A contact, or a history with a contact in each record with stored fields."""
