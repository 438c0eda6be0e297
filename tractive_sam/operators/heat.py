"""Temperature of a surface that passes below a heated mesh, by FFT: one operator for each body.

`SurfaceHeat` is the temperature of steady heat, `HeatMemory` the heat of earlier steps. A flux q(t)
that moves over a half-space warms its surface, in coordinates of the contact, by

    T = c integral over the lag tau of tau^(-1/2) (G_tau * q(t - tau)),   c = sqrt(kappa/pi)/lambda,

G_tau Gauss's bell that conduction spreads heat by along the surface, shifted by -V tau. On all lags
that matter, tau^(-1/2) is a sum of few exponentials, sum of w_j exp(-r_j tau) (a sum over cosines
in depth of the body). So the past is that many fields, whatever its length,

    h_j = integral of exp(-r_j tau) (G_tau * q(t - tau)),

and a step of the time t with the flux q takes each, in every wave along the surface, from h_j to
exp(-l_j t) h_j + (1 - exp(-l_j t))/l_j q,  l_j = r_j + kappa |k|^2 - i V k_x. The rate of the last
is zero: it is the heat per area that the body has taken up.
"""

from dataclasses import dataclass

import numpy as np

from tractive_sam.compute import Convolution, fast_length, padded_length, transform
from tractive_sam.kernels import heat
from tractive_sam.results import Grid, widen_field

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


@dataclass(frozen=True, eq=False)
class Exponentials:
    """Weights and rates of a sum of exponentials that approximates 1/sqrt(t).

    Attributes
    ----------
    rates : ndarray, shape (m,)
        1/s, descending to 0.
    weights : ndarray, shape (m,)
        1/sqrt(s).
    """

    rates: np.ndarray
    weights: np.ndarray

    @classmethod
    def fit(cls, first: float, last: float, ratio: float = 3.0) -> "Exponentials":
        """Fit the exponentials to 1/sqrt(t) between two times, s.

        Parameters
        ----------
        first, last : float
            The times. Before the first the sum is bounded. A later last one adds slower rates.
        ratio : float
            Ratio of successive rates: by 3 the sum is right to 5e-4, by 4 to 2e-3.
        """
        fastest, slowest = 4.0 / first, 0.3 / last
        count = 1 + int(np.log(fastest / slowest) / np.log(ratio))
        rates = np.append(fastest * ratio ** -np.arange(float(count)), 0.0)
        times = np.geomspace(first, last, 100 * count)
        scaled = np.exp(-np.outer(times, rates)) * np.sqrt(times / first)[:, None]
        root = np.full(times.size, 1.0 / np.sqrt(first))
        return cls(rates, np.linalg.lstsq(scaled, root, rcond=1e-12)[0])

    def __call__(self, times: np.ndarray) -> np.ndarray:
        """Return the sum at times of shape (n,)."""
        return np.exp(-np.outer(times, self.rates)) @ self.weights


class HeatMemory:
    """Temperature of a body's surface due to its heating in all earlier steps of time.

    Material enters the mesh cold. Material that has left it is dropped, except in a margin that
    conducts heat back. Beyond the margin it would warm the mesh by less than 1e-3 of the largest
    rise, if half the mesh has a Peclet number of 0.5 or more.

    Parameters
    ----------
    grid : Grid
        The mesh; one row, infinitely long in y, for a line contact.
    speed : float
        V, mm/s; above 0.
    kappa : float
        Diffusivity, mm²/s.
    lam : float
        Conductivity, W/(m K).
    shortest : float
        Lag, in times to roll one element, from which on its root is accurate.
    margin : float
        Width of the margin, in kappa/V: upstream, heat falls by e over this length. On a mesh in
        two directions the width is half as large, as heat also falls with the distance.
    widest : float
        Largest width of the margin, in half lengths of the mesh; half as large in two directions.
    fading : int
        Elements over which heat fades out at the ends of the margin: a sudden end would ring if a
        step is not a multiple of the element.

    Attributes
    ----------
    shape : tuple of int
        Shape of the fields of the past: their number, and elements in x and y with the margin.
    exponentials : Exponentials
        The inverse root of the lag.
    factor : float
        c, K mm² sqrt(s)/mJ.
    fade : ndarray, shape (elements in x with the margin, 1)
        Factor on the fields at the end of each step.
    """

    def __init__(
        self,
        grid: Grid,
        speed: float,
        kappa: float,
        lam: float,
        *,
        shortest: float = 0.01,
        margin: float = 8.0,
        widest: float = 8.0,
        fading: int = 8,
    ):
        self.grid, self._speed, self._kappa, self._fading = grid, speed, kappa, fading
        self.factor = np.sqrt(kappa / np.pi) / lam
        width = min(margin * kappa / speed, widest * grid.half_length[0]) / grid.directions
        margins = [int(np.ceil(width / side)) for side in grid.sides] + [0]
        self._margins = margins[0] + fading, margins[1]
        extended = [n + 2 * more for n, more in zip(grid.elements, self._margins, strict=True)]
        first = grid.dx / speed
        self.exponentials = Exponentials.fit(shortest * first, 2.0 * extended[0] * first)
        self.shape = (self.exponentials.rates.size, *extended)
        ramp = np.sin(0.5 * np.pi * (np.arange(fading) + 0.5) / fading) ** 2
        self.fade = np.ones((extended[0], 1))
        self.fade[:fading, 0], self.fade[-fading:, 0] = ramp, ramp[::-1]

    def cold_fields(self) -> np.ndarray:
        """Return heat fields of zero, with the margin: a body that was never warmed."""
        return np.zeros(self.shape)

    def steady_fields(self, flux: np.ndarray, changing: float = 1e-6) -> np.ndarray:
        """Return the heat fields of a body under a constant flux, mW/mm²: steps until steady.

        Until what a step of as many elements as heat fades over changes of them, over the largest.
        """
        past, more = self.cold_fields(), np.inf
        time = self._fading * self.grid.dx / self._speed
        while more > changing:
            later = self.step(past, time).after(flux)
            more = np.abs(later - past).max() / max(np.abs(later).max(), 1e-300)
            past = later
        return past

    def widen(self, past: np.ndarray) -> np.ndarray:
        """Return heat fields of a smaller mesh on this one: zero around, slower rates added.

        A wider mesh may have slower rates. As all lags so far are short for these, exp(-r tau) is
        linear between the slowest rate before and none.
        """
        slowest, mesh = len(past) - 2, self.shape[1:]
        share = self.exponentials.rates[slowest + 1 : -1] / self.exponentials.rates[slowest]
        slower = [past[-1] + fraction * (past[slowest] - past[-1]) for fraction in share]
        return widen_field(np.array([*past[:-1], *slower, past[-1]]), mesh)

    def after_shock(self, past: np.ndarray, heat: np.ndarray) -> np.ndarray:
        """Return the heat fields after the sudden release of heat, mJ/mm², shape (n_x, n_y)."""
        return past + widen_field(heat, self.shape[1:])

    def stored_heat(self, past: np.ndarray) -> float:
        """Return the heat in the last of the heat fields, margin included, mJ (line: mJ/mm)."""
        return float(past[-1].sum() * self.grid.element_area)

    def on_mesh(self, field: np.ndarray) -> np.ndarray:
        """Return a field without its margin, shape (n_x, n_y)."""
        (first_x, first_y), (nx, ny) = self._margins, self.grid.elements
        return field[first_x : first_x + nx, first_y : first_y + ny]

    def periods(self, time: float) -> tuple[int, int]:
        """Return padded transform lengths for a step of time: no heat wraps around the ends."""
        spread = 5.0 * np.sqrt(2.0 * self._kappa * time)
        shift, *aside = self.grid.sides
        reaches = [(self._speed * time + spread) / shift, *(spread / side for side in aside)]
        # By powers of two, so that steps of different lengths have few plans.
        more = [int(2 ** np.ceil(np.log2(max(reach, 1.0)))) for reach in reaches] + [0]
        nx, ny = (n + padding for n, padding in zip(self.shape[1:], more, strict=False))
        return fast_length(nx), fast_length(ny)

    def waves(self, periods: tuple[int, int]) -> np.ndarray:
        """Return the rates kappa |k|² - i V k_x at which waves decay and move in a transform, 1/s.

        The shape is (p_x, p_y/2 + 1), and (p_x, 1) for a line contact, which has no waves in y.
        """
        along = 2.0 * np.pi * np.fft.fftfreq(periods[0], self.grid.dx)[:, None]
        squares = along**2
        for side in self.grid.sides[1:]:
            squares = squares + (2.0 * np.pi * np.fft.rfftfreq(periods[1], side)) ** 2
        return self._kappa * squares - 1j * self._speed * along

    def step(self, past: np.ndarray, time: float) -> "HeatStep":
        """Return a step of duration `time`, s, of a body with the heat fields `past`."""
        return HeatStep(self, past, time)


class HeatStep:
    """Conduction in a body over one step of time, from its heat fields before the step.

    Parameters
    ----------
    memory : HeatMemory
        Heat memory of the body.
    past : ndarray
        Fields of the body before the step.
    time : float
        Duration of the step, s.

    Attributes
    ----------
    rise : ndarray, shape (elements in x, elements in y)
        Temperature rise at the end of the step by the heat released before it, K, with the margin.
    temperature : ndarray, shape (n_x, n_y)
        This rise on the mesh, without the margin.
    """

    def __init__(self, memory: HeatMemory, past: np.ndarray, time: float):
        self._memory, self._past, self._time = memory, past, time
        self._padded = memory.periods(time)
        self._waves = memory.waves(self._padded)
        self._spread = _symmetric(np.exp(-self._waves * time))
        self._decay = np.exp(-memory.exponentials.rates * time)
        # Heat fields after conduction in the step, without new heat.
        weights, plan = memory.exponentials.weights, transform(1, memory.shape[1:], self._padded)
        plan.forward(np.tensordot(weights * self._decay, past, 1)[None])[0] *= self._spread
        self.rise = memory.factor * (plan.backward()[0] / np.prod(self._padded))
        self.temperature = memory.on_mesh(self.rise)

    def after(self, flux: np.ndarray) -> np.ndarray:
        """Return the heat fields after the step, with the flux in the step, mW/mm², (n_x, n_y)."""
        memory, time = self._memory, self._time
        plan = transform(1, memory.shape[1:], self._padded)
        heat = time * plan.forward(widen_field(flux, memory.shape[1:])[None])[0]
        past = np.empty_like(self._past)
        for j, rate in enumerate(memory.exponentials.rates):
            power = (rate + self._waves) * time
            power[np.abs(power) < 1e-12] = 1e-12
            spectrum = plan.forward(self._past[j][None])[0]
            spectrum *= self._decay[j] * self._spread
            spectrum += _symmetric(-np.expm1(-power) / power) * heat
            past[j] = plan.backward()[0] / np.prod(self._padded) * memory.fade
        return past


def _symmetric(factors: np.ndarray) -> np.ndarray:
    """Drop the imaginary part of the factors at the shortest wave along x, in place."""
    half = len(factors) // 2
    factors[half] = factors[half].real
    return factors
