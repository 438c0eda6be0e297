"""One state of a contact, as figures want it: from a solved contact or from a history."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self, TypeAlias

import numpy as np
from scipy.ndimage import binary_opening

from tractive_sam.plot.scale import Scale
from tractive_sam.results.history import History
from tractive_sam.results.state import Contact

ON_THE_BOUND = 1e-5
"""Distance from the friction bound, over the largest pressure, below which an element slips: well
above the residual of any solution that is worth a picture."""


@dataclass(frozen=True)
class State:
    """Fields of one contact and what to draw them against.

    Attributes
    ----------
    x, y : ndarray, shapes (n_x,) and (n_y,)
        Centres of the elements, mm.
    pressure, wear : ndarray, shape (n_x, n_y)
        MPa and mm.
    traction, slip : ndarray, shape (2, n_x, n_y)
        On body A, MPa; of A over B per unit rolling speed.
    mu : tuple of float or None
        Friction coefficients along the axes e1 and e2; None without friction.
    angle : float
        From x to e1, degrees.
    scale : Scale
        Half widths and pressure that stand for one.
    title : str
        Of the scene.
    revolution : int
        Revolutions rolled.

    Examples
    --------
    >>> state = plot.State.of(history, revolution=2)
    >>> state.caption, state.isotropic
    ('Twin discs, orthotropic friction and wear, N\xa0=\xa02', False)
    """

    x: np.ndarray
    y: np.ndarray
    pressure: np.ndarray
    traction: np.ndarray
    slip: np.ndarray
    wear: np.ndarray
    mu: tuple[float, float] | None
    angle: float
    scale: Scale
    title: str = ""
    revolution: int = 0

    @classmethod
    def of(cls, source: "Source", revolution: int | None = None) -> Self:
        """State of whatever holds one; of a history the last stored one, or that of a revolution.

        Raises
        ------
        LookupError
            If the history did not store the fields of the revolution.
        """
        if isinstance(source, State):
            return source
        if isinstance(source, History):
            return cls.of_history(source, revolution)
        return cls.of_contact(source)

    @classmethod
    def of_contact(cls, contact: "Contact") -> Self:
        """State of a solved contact."""
        settings = tomllib.loads(contact.scene.to_toml())
        return cls(
            contact.grid.x,
            contact.grid.y,
            contact.pressure,
            contact.traction,
            contact.slip,
            contact.wear,
            *_friction(settings),
            Scale.of_contact(contact),
            _marked(settings.get("title", ""), contact.converged, contact.status),
        )

    @classmethod
    def of_history(cls, history: History, revolution: int | None = None) -> Self:
        """State of a stored revolution, by default the last."""
        if revolution is None and len(history.field_revolutions):
            revolution = int(history.field_revolutions[-1])

        def field(name: str) -> np.ndarray:
            return history.field(name, revolution)

        # A history that ended early ends with what was not solved; one that runs does not.
        last = len(history) > 0 and revolution == int(history["revolution"][-1])
        failed = last and not history.finished and history.status != "running"
        return cls(
            history.x,
            history.y,
            field("pressure"),
            np.stack((field("traction_x"), field("traction_y"))),
            np.stack((field("slip_x"), field("slip_y"))),
            field("wear"),
            *_friction(history.settings),
            Scale.of_history(history),
            _marked(history.title, not failed, history.status),
            revolution,
        )

    @property
    def caption(self) -> str:
        """Title of the scene and, where something was rolled, the revolution."""
        rolled = f"N\u00a0=\u00a0{self.revolution}" if self.revolution else ""
        return ", ".join(filter(None, (self.title, rolled)))

    @property
    def line(self) -> bool:
        """Whether it is of a line contact, the fields of which do not change along y."""
        return len(self.y) == 1

    @property
    def isotropic(self) -> bool:
        """Whether friction is the same in all directions."""
        return self.mu is None or self.mu[0] == self.mu[1]

    @property
    def x_over_a(self) -> np.ndarray:
        """Centres in the rolling direction in half widths a, shape (n_x,)."""
        return self.x / self.scale.a

    @property
    def y_over_a(self) -> np.ndarray:
        """Centres in the lateral direction in half widths a, shape (n_y,)."""
        return self.y / self.scale.a

    @cached_property
    def touching(self) -> np.ndarray:
        """Elements in contact, bool."""
        return self.pressure > 0.0

    @cached_property
    def utilisation(self) -> np.ndarray:
        """Traction in the norm of the friction law, ||p_t||_mu <= p_n, MPa."""
        if self.mu is None:
            return np.zeros_like(self.pressure)
        c, s = np.cos(np.radians(self.angle)), np.sin(np.radians(self.angle))
        p_x, p_y = self.traction
        return np.hypot((c * p_x + s * p_y) / self.mu[0], (c * p_y - s * p_x) / self.mu[1])

    @cached_property
    def sliding(self) -> np.ndarray:
        """Elements in contact that have reached the friction bound, bool."""
        margin = ON_THE_BOUND * self.pressure.max()
        return self.touching & (self.utilisation >= self.pressure - margin)

    @cached_property
    def slip_zone(self) -> np.ndarray:
        """Elements that slip together with the next one in x, bool.

        On a mesh the steps of the leading edge slip, where the bound nearly vanishes; a layer of
        one element is no zone.
        """
        return binary_opening(self.sliding, [[True], [True]])

    @property
    def bounds(self) -> tuple[float, float]:
        """Largest |p_x|/p_n and |p_y|/p_n that friction allows."""
        mu_1, mu_2 = self.mu or (0.0, 0.0)
        c, s = np.cos(np.radians(self.angle)), np.sin(np.radians(self.angle))
        return float(np.hypot(mu_1 * c, mu_2 * s)), float(np.hypot(mu_1 * s, mu_2 * c))


def _friction(settings: Mapping[str, Any]) -> tuple[tuple[float, float] | None, float]:
    """Coefficients and angle out of the tables of a scene."""
    table = settings.get("friction")
    if table is None:
        return None, 0.0
    mu = table["mu"]
    pair = tuple(mu) if isinstance(mu, list) else (mu, mu)
    return pair, table.get("angle", 0.0)


Source: TypeAlias = "State | Contact | History"
"""What holds a state; a history holds one of each revolution whose fields it stored."""


def _marked(title: str, solved: bool, status: str) -> str:
    """The title, and a mark on what is not a solution."""
    return title if solved else ", ".join(filter(None, (title, f"not converged: {status}")))
