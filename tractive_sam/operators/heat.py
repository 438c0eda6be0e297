"""Temperature of a surface that passes below a heated mesh, by FFT: one operator for each body."""

import numpy as np

from tractive_sam.compute import Convolution, padded_length
from tractive_sam.kernels import heat
from tractive_sam.results import Grid

STEPS_FROM = 3e3
"""Peclet number V dx/(2 kappa) of an element from which fronts are taken for steps: that is right
to 1e-8 then, and less of larger ones."""


def _panels(
    x: float, y: float, dx: float, dy: float, speed: float, kappa: float, until: float = np.inf
) -> np.ndarray:
    """Return the ends of quadrature panels in s, the square root of the time since the release.

    If the source began a time `until` ago, s, to be squared, ends at that.
    """
    # erf of it is one, to rounding.
    beyond = 6.5
    # That in widths of a front, sqrt(kappa)/V in the root of time, of a fast one.
    front = 2.0
    # Length of a panel over its distance from zero, at most: of a slowly moving source.
    growth = 1.6
    root = np.sqrt(kappa)
    # The half side is 2 BEYOND diffusion lengths and the way: dx/2 = V s² + 2 BEYOND sqrt(kappa) s.
    b = beyond * root
    first = min(0.5 * dx / (b + np.sqrt(b * b + 0.5 * speed * dx)), 0.5 * dy / (2.0 * b))
    far = 1e7 * np.hypot(x, y) / root
    if speed > 0.0:  # the front of the farthest point behind, and what it trails
        far = min(far, (b + np.sqrt(b * b + speed * x)) / speed)
    last = np.sqrt(until)
    ends = [min(first, last)]
    widest = front * root / speed if speed > 0.0 else np.inf
    while ends[-1] < min(far, last):
        ends.append(min(last, ends[-1] + min((growth - 1.0) * ends[-1], widest)))
    return np.array(ends)


def temperature_coefficients(
    x: np.ndarray,
    y: np.ndarray,
    dx: float,
    dy: float,
    speed: float,
    kappa: float,
    lam: float,
    until: float = np.inf,
) -> np.ndarray:
    """Return surface temperatures (m, n) at points due to unit flux in an element at the origin.

    Parameters
    ----------
    x, y : ndarray, shapes (m,) and (n,)
        Points on the surface, mm: none on a side of the element.
    dx, dy : float
        Sides of the element, mm; dy = inf for a strip.
    speed : float
        V, mm/s; at least 0.
    kappa : float
        Diffusivity, mm²/s.
    lam : float
        Conductivity, W/(m K).
    until : float
        Time since the source began, s; by default the temperature is steady.

    Returns
    -------
    ndarray, shape (m, n)
        K mm²/mW.
    """
    # Gauss points of a panel.
    points = 10
    sides_x = np.concatenate((x + 0.5 * dx, x - 0.5 * dx))
    table = np.empty((x.size, y.size))
    line = not np.isfinite(dy)
    length = float(np.abs(sides_x).max())
    if speed * dx > STEPS_FROM * 2.0 * kappa and until == np.inf:
        heat.front_integral(x, y, dx, 1e3 * length if line else dy, speed, kappa, table)
    else:
        sides_y = np.zeros(0) if line else np.concatenate((y + 0.5 * dy, y - 0.5 * dy))
        across = dx if line else dy
        widest = 0.0 if line else float(np.abs(sides_y).max())
        ends = _panels(length, widest, dx, across, speed, kappa, until)
        # Before the first panel only the element itself is warm, and wholly so.
        here = np.abs(x)[:, None] < 0.5 * dx
        table[:] = np.where(here & (line | (np.abs(y)[None, :] < 0.5 * across)), ends[0], 0.0)
        nodes, weights = np.polynomial.legendre.leggauss(points)
        for part in np.array_split(np.arange(ends.size - 1), max(1, ends.size // 100)):
            half = 0.5 * (ends[part + 1] - ends[part])[:, None]
            at = (ends[part][:, None] + half * (1.0 + nodes)).ravel()
            along = np.empty((at.size, sides_x.size))
            heat.front_integrand(at, sides_x, speed, kappa, along)
            along = (along[:, : x.size] - along[:, x.size :]) * (half * weights).ravel()[:, None]
            if line:
                table += along.sum(axis=0)[:, None]
                continue
            aside = np.empty((at.size, sides_y.size))
            heat.front_integrand(at, sides_y, 0.0, kappa, aside)
            table += along.T @ (aside[:, : y.size] - aside[:, y.size :])
        if speed == 0.0 and until == np.inf:  # far away in time, A B is dx dy / (4 pi kappa s²)
            table += dx * across / (4.0 * np.pi * kappa * ends[-1])
    # 2 / (rho c sqrt(pi kappa)), with rho c = lambda / kappa
    return 2.0 * table * np.sqrt(kappa / np.pi) / lam


class SurfaceHeat:
    """Operator on a mesh from a steady flux into a body to its surface temperature rise, K.

    Parameters
    ----------
    grid : Grid
        The mesh; of a line contact one row, infinitely long in y.
    speed, kappa, lam, until : float
        See `temperature_coefficients`.
    """

    def __init__(self, grid: Grid, speed: float, kappa: float, lam: float, until: float = np.inf):
        dx, dy = (*grid.sides, np.inf)[:2]
        self._period = period = padded_length(grid.elements[0]), padded_length(grid.elements[1])
        # A product uses the differences of indices below n_x and n_y. The others are filled all
        # the same: with zeros there, the periodic operator has no useful inverse.
        i, j = np.arange(period[0]) - period[0] // 2, np.arange(period[1] // 2 + 1)
        y = np.zeros(1) if grid.elements[1] == 1 else dy * j
        table, j = np.zeros(period), j[: y.size]
        table[i[:, None], -j] = table[i[:, None], j] = temperature_coefficients(
            dx * i, y, dx, dy, speed, kappa, lam, until
        )
        self._spectrum = np.fft.rfft2(table) / table.size
        self._apply = Convolution(self._spectrum[None], grid.elements, period)

    def __call__(self, flux: np.ndarray) -> np.ndarray:
        """Temperature, K, of a flux in mW/mm², both of shape (n_x, n_y)."""
        return self._apply(flux[None])[0]

    def inverse_with(self, body: "SurfaceHeat") -> Convolution:
        """Return the circulant inverse of this plus another body's operator, a preconditioner."""
        both = self._spectrum + body._spectrum
        inverse = 1.0 / (both * np.prod(self._period) ** 2)
        return Convolution(inverse[None], self._apply.shape[1:], self._period)
