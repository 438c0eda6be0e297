"""Stress at arbitrary points."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from tractive_sam.kernels import stress_sum
from tractive_sam.results.state import Contact
from tractive_sam.subsurface.loaded import LoadedBodies
from tractive_sam.subsurface.strips import Strips


@dataclass(frozen=True)
class Patches:
    """The loaded elements of one half-space.

    Attributes
    ----------
    centres : ndarray, shape (m, 2)
        (x, y), mm.
    tractions : ndarray, shape (m, 3)
        (p_x, p_y, p_n), MPa.
    sides : tuple of float
        (dx, dy), mm.
    poisson : float
        Poisson's ratio.
    """

    centres: np.ndarray
    tractions: np.ndarray
    sides: tuple[float, float]
    poisson: float

    @classmethod
    def on_mesh(
        cls, x: np.ndarray, y: np.ndarray, sides: tuple[float, float], tractions, poisson: float
    ) -> "Patches":
        """Take the loaded ones of a mesh with centres x, y and tractions (3, n_x, n_y)."""
        i, j = np.nonzero(tractions.any(axis=0))
        loads = np.ascontiguousarray(tractions[:, i, j].T)
        return cls(np.stack((x[i], y[j]), axis=1), loads, sides, poisson)

    def stress(self, points: np.ndarray) -> np.ndarray:
        """Stresses (n, 6) at points (n, 3) of the half-space, MPa."""
        out = np.empty((len(points), 6))
        stress_sum.stress_at(out, points, self.centres, self.tractions, *self.sides, self.poisson)
        return out


def stress_at(contact: Contact, points: ArrayLike, body: str = "A") -> np.ndarray:
    """Stress at points, summed over the loaded elements; exact for their constant tractions.

    Some 0.1 microseconds a point and loaded element. At the surface, on the edge between two
    elements of different tangential traction, the stress is infinite; what is infinite is left out
    there (see `kernels.stress`).

    Parameters
    ----------
    contact : Contact
        The solved contact.
    points : array_like, shape (n, 3)
        x, y and depth, mm.
    body : "A" or "B"
        The body concerned.

    Returns
    -------
    ndarray, shape (n, 6)
        xx, yy, zz, xy, xz, yz in the axes of the contact, MPa.

    Raises
    ------
    ValueError
        If there is no such body, or points are not of that shape, finite and below the surface.

    Examples
    --------
    >>> sigma = ts.stress_at(contact, [(0.0, 0.0, 0.5 * scene.hertz.a)])
    >>> sigma.shape
    (1, 6)
    """
    points = np.ascontiguousarray(points, dtype=float)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError(f"points must have the shape (n, 3), not {points.shape}")
    if not np.isfinite(points).all() or (points[:, 2] < 0.0).any():
        raise ValueError("points must be finite, with a depth of at least 0")
    grid, load = contact.grid, LoadedBodies.of(contact, (body,))
    tractions, nu = load.tractions[0], load.poisson[0]
    if grid.line:
        patches = Strips.on_grid(grid, tractions, nu)
    else:
        patches = Patches.on_mesh(grid.x, grid.y, (grid.dx, grid.dy), tractions, nu)
    return load.in_contact_axes(patches.stress(points).T[None])[0].T
