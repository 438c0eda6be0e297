"""What the stress of a whole cycle does to a material: criteria of fatigue, life, shakedown."""

import math
from dataclasses import dataclass

import numpy as np

from tractive_sam.kernels import fatigue
from tractive_sam.mechanics.criteria import CycleCriterion
from tractive_sam.mechanics.law import Law


def checked(cycle: np.ndarray) -> np.ndarray:
    """Cycles, if they have the shape (6, n, ...) and points at all; else a ValueError."""
    cycle = np.asarray(cycle, float)
    if cycle.ndim < 2 or len(cycle) != 6 or not cycle.shape[1]:
        asked = "(6, n, ...): xx, yy, zz, xy, xz, yz at n points along the cycle"
        raise ValueError(f"a cycle has the shape {asked}; not {cycle.shape}")
    return cycle


def paths(cycle: np.ndarray) -> np.ndarray:
    """Cycles (6, n, ...) as kernels take them, (number, 6, n)."""
    cycle = checked(cycle)
    flat = cycle.reshape(*cycle.shape[:2], math.prod(cycle.shape[2:]))
    return np.ascontiguousarray(flat.transpose(2, 0, 1))


def _each(kernel, cycle: np.ndarray, *parameters, numbers: int = 1) -> np.ndarray:
    """Numbers of each cycle by a kernel, (numbers, ...); nan where a stress is not finite."""
    given = paths(cycle)
    known = np.isfinite(given).all(axis=(1, 2))
    out = np.full((numbers, len(given)), np.nan)
    if known.any():  # kernels compare, which would step over nan
        found = np.empty((numbers, np.count_nonzero(known)))
        kernel(*found, given if known.all() else given[known], *parameters)
        out[:, known] = found
    return out.reshape(numbers, *np.shape(cycle)[2:])


@dataclass(frozen=True)
class DangVan(CycleCriterion):
    """Largest of tau + a sigma_h along the cycle, in what is left once grains have adapted.

    tau is the largest shear stress of the deviator minus the centre of the smallest ball around
    its path, sigma_h the hydrostatic stress (Dang Van, Griveau & Message 1989).

    Parameters
    ----------
    sensitivity : float
        a = 3 (tau_e/sigma_e - 1/2), by the fatigue limits in torsion and in bending; the limit of
        the criterion is tau_e.

    Examples
    --------
    >>> bending = np.zeros((6, 3))
    >>> bending[0] = 300.0, -300.0, 0.0
    >>> round(float(ts.DangVan(sensitivity=0.3)(bending)), 9)  # sigma_e = 300: tau_e = 180
    180.0
    """

    sensitivity: float
    name = "dang-van"
    long_name = "equivalent shear stress of Dang Van"
    path_error = 4e-3  # the centre of the ball changes with the first power of the spacing

    def __call__(self, cycle: np.ndarray) -> np.ndarray:
        """See `CycleCriterion`."""
        return self.and_radius(cycle)[0]

    def and_radius(self, cycle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The same, and the radius of the ball that it takes anyway."""
        out, radius = _each(fatigue.dang_van, cycle, self.sensitivity, numbers=2)
        return out, radius


@dataclass(frozen=True)
class Crossland(CycleCriterion):
    """Amplitude of sqrt(J2), the radius of the smallest ball, plus a times the largest sigma_h.

    Parameters
    ----------
    sensitivity : float
        a = 3 tau_e/sigma_e - sqrt 3; the limit of the criterion is tau_e (Crossland 1956).

    Examples
    --------
    >>> torsion = np.zeros((6, 3))
    >>> torsion[3] = 200.0, -200.0, 0.0
    >>> round(float(ts.Crossland(sensitivity=0.3)(torsion)), 9)
    200.0
    """

    sensitivity: float
    name = "crossland"
    long_name = "equivalent shear stress of Crossland"

    def __call__(self, cycle: np.ndarray) -> np.ndarray:
        """See `CycleCriterion`."""
        return self.and_radius(cycle)[0]

    def and_radius(self, cycle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The same, and the radius of the ball that it takes anyway."""
        radius = enclosing_radius(cycle)
        hydrostatic = cycle[:3].sum(axis=0).max(axis=0) / 3.0
        return radius + self.sensitivity * hydrostatic, radius


@dataclass(frozen=True)
class Findley(CycleCriterion):
    """Largest of tau_a + k sigma_n,max over all planes (Findley 1959).

    tau_a is the radius of the smallest circle around the path of the shear stress on the plane,
    sigma_n,max its largest normal stress.

    Parameters
    ----------
    sensitivity : float
        k; the limit of the criterion is tau_e sqrt(1 + k²), and sigma_e/tau_e is
        2 / (1 + k/sqrt(1 + k²)).

    Examples
    --------
    >>> torsion = np.zeros((6, 3))
    >>> torsion[3] = 200.0, -200.0, 0.0
    >>> float(ts.Findley(sensitivity=0.75)(torsion)).__round__(6)
    250.0
    """

    sensitivity: float
    name = "findley"
    long_name = "equivalent shear stress of Findley"

    def __call__(self, cycle: np.ndarray) -> np.ndarray:
        """See `CycleCriterion`."""
        return _each(fatigue.critical_plane, cycle, self.sensitivity, 0.0)[0]


@dataclass(frozen=True)
class FatemiSocie(CycleCriterion):
    """Largest of tau_a (1 + k sigma_n,max/sigma_y) over all planes (Fatemi & Socie 1988).

    That is G times their parameter gamma_a (1 + k sigma_n,max/sigma_y) of an elastic cycle.

    Parameters
    ----------
    sensitivity : float
        k.
    yield_strength : float
        sigma_y, MPa.

    Examples
    --------
    >>> torsion = np.zeros((6, 3))
    >>> torsion[3] = 200.0, -200.0, 0.0
    >>> float(ts.FatemiSocie(sensitivity=0.0, yield_strength=500.0)(torsion)).__round__(6)
    200.0
    """

    sensitivity: float
    yield_strength: float
    name = "fatemi-socie"
    long_name = "equivalent shear stress of Fatemi and Socie"

    def __call__(self, cycle: np.ndarray) -> np.ndarray:
        """See `CycleCriterion`."""
        each = self.sensitivity / self.yield_strength
        return _each(fatigue.critical_plane, cycle, 0.0, each)[0]


@dataclass(frozen=True)
class OrthogonalShear(CycleCriterion):
    """Half the range of the shear stress xz, across the surface in the rolling direction.

    Source: Lundberg & Palmgren, Acta Polytechnica 7 (1947). In a frictionless line contact it is
    p0/4, half the semi-axis deep.

    Examples
    --------
    >>> cycle = np.zeros((6, 3))
    >>> cycle[4] = 250.0, -250.0, 0.0
    >>> float(ts.OrthogonalShear()(cycle))
    250.0
    """

    name = "orthogonal-shear"
    symbol = r"\tau_0"
    long_name = "amplitude of the orthogonal shear stress"

    def __call__(self, cycle: np.ndarray) -> np.ndarray:
        """See `CycleCriterion`."""
        return 0.5 * np.ptp(checked(cycle)[4], axis=0)


def enclosing_radius(cycle: np.ndarray) -> np.ndarray:
    """Radius of the smallest ball around the path of the deviator, in the norm sqrt(s:s/2), MPa.

    Yield stress in shear below which no constant residual stress makes the cycle elastic (Koiter).

    Parameters
    ----------
    cycle : ndarray, shape (6, n, ...)
        As of `CycleCriterion`.

    Returns
    -------
    ndarray, shape (...)
    """
    return _each(fatigue.balls, cycle)[0]


def judged(criterion: CycleCriterion, cycle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cycles by a criterion, and their `enclosing_radius`; some criteria have it anyway."""
    if isinstance(criterion, DangVan | Crossland):
        return criterion.and_radius(cycle)
    return criterion(cycle), enclosing_radius(cycle)


def residual_shear(cycle: np.ndarray) -> np.ndarray:
    """The sqrt(J2) left of the cycles at one depth by residual stresses that rolling can leave.

    rho_xx of each point and one rho_yy of all: a yield stress in shear above the largest of these
    makes sure that the cycles become elastic (Melan); see `kernels.fatigue.shakedown_layer`.

    Parameters
    ----------
    cycle : ndarray, shape (6, n, m)
        As of `CycleCriterion`, of all points of one depth.

    Returns
    -------
    ndarray, shape (m,)
        MPa.
    """
    return _each(fatigue.shakedown_layer, cycle)[0]


def over_depth(depth: np.ndarray, values: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Values at depths in between.

    By cubics in the root of the depth that are monotone wherever the values are: towards the edges
    of contact and stick the stress at the surface has a root of the distance, so what a depth goes
    through falls with its root.

    Parameters
    ----------
    depth : ndarray, shape (n,)
        Ascending from 0, at least three, mm.
    values : ndarray, shape (rows, n)
        There.
    at : ndarray, shape (m,) or (rows, m)
        Depths, ascending in each row, mm.

    Returns
    -------
    ndarray, shape (rows, m)
    """
    places = np.sqrt(np.broadcast_to(at, (len(values), at.shape[-1])))
    out = np.empty(places.shape)
    fatigue.monotone(out, np.sqrt(depth), np.ascontiguousarray(values), places)
    return out


MOST_PER_CYCLE = 1e9
"""Damage of a cycle that counts: what does more breaks in the first one, whatever the number."""


@dataclass(frozen=True)
class Woehler(Law):
    """A life of N = cycles u^-exponent cycles at the utilisation u, and damage that adds up.

    Each cycle does 1/N of the damage that starts a crack (Palmgren 1924, Miner 1945).

    Parameters
    ----------
    cycles : float
        Life at a utilisation of 1.
    exponent : float
        Of the line.
    knee : bool
        Whether cycles below 1 do no damage.

    Examples
    --------
    >>> ts.Woehler(cycles=1e7, exponent=10.0).damage(np.array([0.5, 1.0, 2.0]))
    array([9.765625e-11, 1.000000e-07, 1.024000e-04])
    """

    cycles: float
    exponent: float
    knee: bool = False

    def damage(self, utilisation: np.ndarray) -> np.ndarray:
        """Damage of a cycle at utilisations; up to 0 there is none."""
        loaded = utilisation > (1.0 if self.knee else 0.0)
        log = np.log(np.where(loaded, utilisation, 1.0))
        most = np.log(MOST_PER_CYCLE)
        return np.where(
            loaded, np.exp(np.minimum(self.exponent * log - np.log(self.cycles), most)), 0.0
        )

    def relative_error(self, utilisation_error: float) -> float:
        """Return the largest relative error of damage by that of the utilisation.

        It is (1 + e)^exponent - 1, to the first order the exponent times e. A cycle within e of
        the knee may do no damage: that is not included.

        Examples
        --------
        >>> round(ts.Woehler(cycles=1e7, exponent=10.0).relative_error(4e-3), 4)
        0.0407
        """
        return float(np.expm1(self.exponent * np.log1p(utilisation_error)))


PARTS = 8
"""Of the integral over a volume, for every depth."""


@dataclass(frozen=True)
class VolumeLife(Law):
    """Life of a volume under stress, with the probability that all of it survives (Weibull).

    ln(1/S) = constant N^slope integral of (tau - limit)^c / z^h dV: with no limit and the amplitude
    of the orthogonal shear stress that of Lundberg & Palmgren (Acta Polytechnica 7, 1947), with the
    limit of a criterion that of Ioannides & Harris (J. Tribol. 107, 1985, 367). Lives go with the
    load to the power -(c - h + 2)/(3 slope) = -3 of a point contact, and with slope 9/8 to
    -(c - h + 1)/(2 slope) = -4 of a line contact.

    Parameters
    ----------
    constant : float
        Of the material, in N, mm and cycles; without it only ratios of lives mean something.
    slope : float
        Weibull's, 10/9 of point contacts, 9/8 of lines.
    limit : float
        Stress that does no harm, MPa.
    stress_exponent, depth_exponent : float
        c and h.

    Examples
    --------
    >>> asked = {"criterion": "orthogonal-shear", "limit": 1.0, "bodies": ["A"]}
    >>> smooth = scene.replace(friction=None, creepage=None, fatigue=asked)
    >>> cycled = ts.fatigue(ts.solve(smooth))["A"]
    >>> life = ts.VolumeLife()
    >>> volume = life.volume(cycled.y, cycled.depth, cycled.utilisation, around=200.0)
    >>> round(life.life(volume, survival=0.5) / life.life(volume, survival=0.9), 2)
    5.45
    """

    constant: float = 1.0
    slope: float = 10.0 / 9.0
    limit: float = 0.0
    stress_exponent: float = 31.0 / 3.0
    depth_exponent: float = 7.0 / 3.0

    def volume(
        self, y: np.ndarray, depth: np.ndarray, stress: np.ndarray, around: float = 1.0
    ) -> float:
        """The integral over a body, from the first depth below the surface down.

        Above it 1/z^h is infinite, and so is the integral where friction stresses the surface: it
        then grows as that depth, one element, becomes smaller; see `at_the_top`.

        Parameters
        ----------
        y, depth : ndarray, shapes (n_y,) and (n,)
            As of `BodyFatigue`, mm; of a line contact one y, and the integral is per length.
        stress : ndarray, shape (n_y, n)
            Amplitude, MPa: the utilisation times the limit that it is by.
        around : float
            Length of the track, mm.
        """
        z, density = self._density(depth, stress)
        rows = _trapezia(density, z)
        return float(around * (_trapezia(rows, y) if y.size > 1 else rows[0]))

    def at_the_top(self, depth: np.ndarray, stress: np.ndarray) -> float:
        """Largest density of the integral at its first depth, over the largest of all.

        Near 1 the integral has no limit, and depends on the size of the elements.
        """
        density = self._density(depth, stress)[1]
        most = density.max(initial=0.0)
        return float(density[:, 0].max() / most) if most > 0.0 else 0.0

    def _density(self, depth: np.ndarray, stress: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        z = np.linspace(depth[1], depth[-1], PARTS * depth.size)
        above = np.maximum(over_depth(depth, stress, z) - self.limit, 0.0)
        return z, above**self.stress_exponent / z**self.depth_exponent

    def survival(self, volume: float, cycles: float) -> float:
        """Probability that nothing breaks in a number of cycles."""
        return math.exp(-self.constant * cycles**self.slope * volume)

    def life(self, volume: float, survival: float = 0.9) -> float:
        """Cycles that are survived with a probability; inf where nothing is stressed."""
        if volume <= 0.0:
            return math.inf
        return (math.log(1.0 / survival) / (self.constant * volume)) ** (1.0 / self.slope)


def _trapezia(values: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Integral along the last axis."""
    return (0.5 * (values[..., 1:] + values[..., :-1]) * np.diff(x)).sum(axis=-1)
