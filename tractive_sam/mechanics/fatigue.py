"""Fatigue criteria, Wöhler curve, life of a volume, and shakedown of stress cycles."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from tractive_sam.kernels import critical_plane, fatigue
from tractive_sam.mechanics.criteria import CycleCriterion
from tractive_sam.mechanics.law import Law


def check_cycles(cycle: np.ndarray) -> np.ndarray:
    """Return cycles as an array; raise a ValueError unless the shape is (6, n, ...) with n > 0."""
    cycle = np.asarray(cycle, float)
    if cycle.ndim < 2 or len(cycle) != 6 or not cycle.shape[1]:
        shape = "(6, n, ...): xx, yy, zz, xy, xz, yz at n points along the cycle"
        raise ValueError(f"cycle has the shape {cycle.shape}; allowed: {shape}")
    return cycle


def to_paths(cycle: np.ndarray) -> np.ndarray:
    """Return cycles (6, n, ...) in the shape of the kernels, (number, 6, n)."""
    cycle = check_cycles(cycle)
    flat = cycle.reshape(*cycle.shape[:2], math.prod(cycle.shape[2:]))
    return np.ascontiguousarray(flat.transpose(2, 0, 1))


def _apply_kernel(
    kernel: Callable[..., None], cycle: np.ndarray, *parameters: float, numbers: int = 1
) -> np.ndarray:
    """Return results of a kernel for each cycle, (numbers, ...); nan if a stress is nan or inf."""
    paths = to_paths(cycle)
    is_finite = np.isfinite(paths).all(axis=(1, 2))
    out = np.full((numbers, len(paths)), np.nan)
    if is_finite.any():  # comparisons in kernels would pass over nan
        values = np.empty((numbers, np.count_nonzero(is_finite)))
        kernel(*values, paths if is_finite.all() else paths[is_finite], *parameters)
        out[:, is_finite] = values
    return out.reshape(numbers, *np.shape(cycle)[2:])


@dataclass(frozen=True)
class DangVan(CycleCriterion):
    """Dang Van's criterion: largest tau + a sigma_h along the cycle, after shakedown of the grains.

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
        """Return the value of the criterion for stress paths, MPa (`CycleCriterion.__call__`)."""
        return self.and_radius(cycle)[0]

    def and_radius(self, cycle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the criterion and the radius of the smallest ball around the deviator's path, MPa.

        Returns
        -------
        criterion, radius : ndarray
            Both of the shape (...), MPa.
        """
        out, radius = _apply_kernel(fatigue.dang_van, cycle, self.sensitivity, numbers=2)
        return out, radius


@dataclass(frozen=True)
class Crossland(CycleCriterion):
    """Crossland's criterion: radius of the smallest ball around sqrt(J2), plus a times sigma_h,max.

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
        """Return the value of the criterion for stress paths, MPa (`CycleCriterion.__call__`)."""
        return self.and_radius(cycle)[0]

    def and_radius(self, cycle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the criterion and the radius of the smallest ball around the deviator's path, MPa.

        Returns
        -------
        criterion, radius : ndarray
            Both of the shape (...), MPa.
        """
        radius = enclosing_radius(cycle)
        hydrostatic = cycle[:3].sum(axis=0).max(axis=0) / 3.0
        return radius + self.sensitivity * hydrostatic, radius


@dataclass(frozen=True)
class Findley(CycleCriterion):
    """Findley's criterion: largest tau_a + k sigma_n,max of all planes (1959).

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
        """Return the value of the criterion for stress paths, MPa (`CycleCriterion.__call__`)."""
        return _apply_kernel(critical_plane.critical_plane, cycle, self.sensitivity, 0.0)[0]


@dataclass(frozen=True)
class FatemiSocie(CycleCriterion):
    """Fatemi and Socie's criterion: largest tau_a (1 + k sigma_n,max/sigma_y) of all planes (1988).

    For an elastic cycle it is G times their parameter gamma_a (1 + k sigma_n,max/sigma_y).

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
        """Return the value of the criterion for stress paths, MPa (`CycleCriterion.__call__`)."""
        each = self.sensitivity / self.yield_strength
        return _apply_kernel(critical_plane.critical_plane, cycle, 0.0, each)[0]


@dataclass(frozen=True)
class OrthogonalShear(CycleCriterion):
    """Criterion: the amplitude of the orthogonal shear stress xz, half of its range.

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
        """Return the value of the criterion for stress paths, MPa (`CycleCriterion.__call__`)."""
        return 0.5 * np.ptp(check_cycles(cycle)[4], axis=0)


def enclosing_radius(cycle: np.ndarray) -> np.ndarray:
    """Return the radius of the smallest ball around the path of the stress deviator, MPa.

    For a smaller yield stress in shear no constant residual stress makes the cycle elastic
    (Koiter).

    Parameters
    ----------
    cycle : ndarray, shape (6, n, ...)
        See `CycleCriterion`.

    Returns
    -------
    ndarray, shape (...)
    """
    return _apply_kernel(fatigue.enclosing_radii, cycle)[0]


def evaluate_cycles(criterion: CycleCriterion, cycle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return a criterion of cycles, and the `enclosing_radius` of each deviator's path, MPa.

    Returns
    -------
    criterion, radius : ndarray
        Both of the shape (...), MPa.
    """
    if isinstance(criterion, DangVan | Crossland):
        return criterion.and_radius(cycle)
    return criterion(cycle), enclosing_radius(cycle)


def residual_shear(cycle: np.ndarray) -> np.ndarray:
    """Return sqrt(J2) that remains in each cycle of one depth under the best residual stress, MPa.

    The residual stresses are rho_xx of each point and one rho_yy for all points. For a yield stress
    in shear above the largest result the cycles become elastic (Melan); see
    `kernels.fatigue.shakedown_layer`.

    Parameters
    ----------
    cycle : ndarray, shape (6, n, m)
        See `CycleCriterion`; all points of one depth.

    Returns
    -------
    ndarray, shape (m,)
        MPa.
    """
    return _apply_kernel(fatigue.shakedown_layer, cycle)[0]


def interpolate_over_depth(depth: np.ndarray, values: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Interpolate values (rows, n) at depths (n,) to other depths, cubic in sqrt(depth), monotone.

    The interpolation is cubic in the square root of the depth, and monotone if the values are: near
    the edges of the contact and of the stick area the stress depends on the root of the distance.

    Parameters
    ----------
    depth : ndarray, shape (n,)
        Ascending from 0, at least three, mm.
    values : ndarray, shape (rows, n)
        Values at the depths.
    at : ndarray, shape (m,) or (rows, m)
        New depths, ascending in each row, mm.

    Returns
    -------
    ndarray, shape (rows, m)
    """
    places = np.sqrt(np.broadcast_to(at, (len(values), at.shape[-1])))
    out = np.empty(places.shape)
    fatigue.monotone(out, np.sqrt(depth), np.ascontiguousarray(values), places)
    return out


@dataclass(frozen=True)
class VolumeLife(Law):
    """Life of a stressed volume for a probability of survival (Weibull).

    ln(1/S) = constant N^slope integral of (tau - limit)^c / z^h dV. Without a limit and with the
    amplitude of the orthogonal shear stress this is the theory of Lundberg & Palmgren (Acta
    Polytechnica 7, 1947), with the limit of a criterion the theory of Ioannides & Harris (J.
    Tribol. 107, 1985, 367). The life is proportional to the load to the power -(c - h + 2)/(3
    slope) = -3 for a point contact, and with slope 9/8 to -(c - h + 1)/(2 slope) = -4 for a line
    contact.

    Parameters
    ----------
    constant : float
        Material constant, in N, mm and cycles; with the default only ratios of lives are valid.
    slope : float
        Weibull slope, 10/9 for point contacts, 9/8 for line contacts.
    limit : float
        Stress below which there is no damage, MPa.
    stress_exponent, depth_exponent : float
        c and h.

    Examples
    --------
    >>> table = {"criterion": "orthogonal-shear", "limit": 1.0, "bodies": ["A"]}
    >>> smooth = scene.replace(friction=None, creepage=None, fatigue=table)
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
    points_per_depth: ClassVar[int] = 8
    """Integration points for every depth of the stress."""

    def volume(
        self, y: np.ndarray, depth: np.ndarray, stress: np.ndarray, around: float = 1.0
    ) -> float:
        """Return the integral of stress amplitude^c / depth^h over a body, below its first depth.

        1/z^h is infinite at the surface: if friction stresses the surface, the integral increases
        as the first depth, one element, decreases; see `surface_density_ratio`.

        Parameters
        ----------
        y, depth : ndarray, shapes (n_y,) and (n,)
            See `BodyFatigue`, mm; a line contact has one y, and the integral is per length.
        stress : ndarray, shape (n_y, n)
            Amplitude, MPa: the utilisation times its limit.
        around : float
            Length of the track, mm.
        """
        z, density = self._density(depth, stress)
        rows = _integrate(density, z)
        return float(around * (_integrate(rows, y) if y.size > 1 else rows[0]))

    def surface_density_ratio(self, depth: np.ndarray, stress: np.ndarray) -> float:
        """Return the largest integrand at the first depth over the largest one at all depths.

        Near 1 the integral depends on the element size.

        Parameters
        ----------
        depth : ndarray, shape (n,)
            Depths, mm.
        stress : ndarray, shape (n_y, n)
            Amplitude, MPa, as for `volume`.
        """
        density = self._density(depth, stress)[1]
        largest = density.max(initial=0.0)
        return float(density[:, 0].max() / largest) if largest > 0.0 else 0.0

    def _density(self, depth: np.ndarray, stress: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return integration points (n,) over the depth, mm, and the integrand there, (n_y, n)."""
        z = np.linspace(depth[1], depth[-1], self.points_per_depth * depth.size)
        above = np.maximum(interpolate_over_depth(depth, stress, z) - self.limit, 0.0)
        return z, above**self.stress_exponent / z**self.depth_exponent

    def survival(self, volume: float, cycles: float) -> float:
        """Return the probability of survival after a number of cycles, given the stressed `volume`.

        Parameters
        ----------
        volume : float
            Integral of the stressed volume, from `volume`.
        cycles : float
            Number of cycles.
        """
        return math.exp(-self.constant * cycles**self.slope * volume)

    def life(self, volume: float, survival: float = 0.9) -> float:
        """Return the number of cycles for a probability of survival; inf for an unstressed volume.

        Parameters
        ----------
        volume : float
            Integral of the stressed volume, from `volume`.
        survival : float
            Probability of survival, between 0 and 1.
        """
        if volume <= 0.0:
            return math.inf
        return (math.log(1.0 / survival) / (self.constant * volume)) ** (1.0 / self.slope)


def _integrate(values: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Return the definite integral over x along the last axis, by the trapezium rule."""
    return (0.5 * (values[..., 1:] + values[..., :-1]) * np.diff(x)).sum(axis=-1)
