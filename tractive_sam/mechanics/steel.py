"""Steel over the depth: residual stress, hardness, strength that follows from it, and life.

Depths are below the unworn surface, so that material keeps its values while wear uncovers it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tractive_sam.mechanics.hertz_contact import HertzContact, HertzLine
from tractive_sam.mechanics.law import Law

Curve = tuple[NDArray[np.float64], NDArray[np.float64]]
"""Depths, ascending, mm, and values at these depths."""


@dataclass(frozen=True)
class Woehler(Law):
    """Wöhler curve with Miner's sum: the life at the utilisation u is N = cycles u^-exponent.

    Each cycle adds 1/N to the damage; a crack starts at 1 (Palmgren 1924, Miner 1945).

    Parameters
    ----------
    cycles : float
        Life at a utilisation of 1.
    exponent : float
        Exponent of the curve.
    knee : bool
        Whether cycles below a utilisation of 1 cause no damage.

    Examples
    --------
    >>> ts.Woehler(cycles=1e7, exponent=10.0).damage(np.array([0.5, 1.0, 2.0]))
    array([9.765625e-11, 1.000000e-07, 1.024000e-04])
    """

    cycles: float
    exponent: float
    knee: bool = False
    max_per_cycle: ClassVar[float] = 1e9
    """Upper limit of the damage of a cycle, to avoid overflow: failure is in the first cycle."""

    def damage(self, utilisation: np.ndarray) -> np.ndarray:
        """Return damage per cycle at utilisations, limited to `max_per_cycle`; 0 below a knee."""
        loaded = utilisation > (1.0 if self.knee else 0.0)
        log = np.log(np.where(loaded, utilisation, 1.0))
        damage = self.exponent * log - np.log(self.cycles)
        return np.where(loaded, np.exp(np.minimum(damage, np.log(self.max_per_cycle))), 0.0)

    def relative_error(self, utilisation_error: float) -> float:
        """Return the relative error of the damage due to a relative error of the utilisation.

        It is (1 + e)^exponent - 1, to first order the exponent times e. The error of cycles near
        the knee is not included.

        Examples
        --------
        >>> round(ts.Woehler(cycles=1e7, exponent=10.0).relative_error(4e-3), 4)
        0.0407
        """
        return float(np.expm1(self.exponent * np.log1p(utilisation_error)))


@dataclass(frozen=True)
class Steel(Law):
    """Residual stress, strength and life of the material of a body over the depth.

    Values between depths are interpolated linearly; above the first depth and below the last one
    they are constant. In a body with layers, the curves are those of the body below the layers. A
    lower face belongs to the layer above it, and nothing is interpolated across a face. Layers are
    numbered from the surface, from 0; the last number is that of the body below.

    Parameters
    ----------
    curves : mapping of str to tuple of ndarray
        Depths, mm, and values of "xx" and "yy", the residual stress along the rolling direction and
        across it, "limit", the fatigue limit, and "shear_yield", MPa; "hardness", HV. Each may be
        absent.
    faces : ndarray, shape (layers,)
        Depths of the lower faces of the layers below the unworn surface, mm.
    layers : tuple of mapping of str to float
        "limit" and "shear_yield" of each layer, MPa; all layers have the same names.
    lives : tuple of Woehler
        Curves of each layer and of the body below; empty without layers.
    groups : tuple of int
        Group of each layer and of the body below: in a group the equivalent stress of the criterion
        is continuous.
    distinct : int
        Number of the upper layers with interfaces of the elastic body; the layers below are
        elastically one with the body.
    common_limit : float, optional
        Limit of the stress that `stack` returns, MPa; without layers it is the limit there.

    Examples
    --------
    >>> case = ts.Steel({"limit": (np.array([0.0, 1.0]), np.array([400.0, 300.0]))})
    >>> case.at("limit", [0.25, 3.0])
    array([375., 300.])
    >>> lives = ts.Woehler(1e5, 4.0), ts.Woehler(1e7, 10.0)
    >>> coated = ts.Steel(case.curves, np.array([0.1]), ({"limit": 50.0},), lives, (0, 1), 1, 400.0)
    >>> coated.at("limit", [0.0, 0.1, 0.25])
    array([ 50.,  50., 375.])
    """

    curves: Mapping[str, Curve] = field(default_factory=dict)
    faces: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))
    layers: tuple[Mapping[str, float], ...] = ()
    lives: tuple[Woehler, ...] = ()
    groups: tuple[int, ...] = (0,)
    distinct: int = 0
    common_limit: float | None = None

    @property
    def is_layered(self) -> bool:
        """Whether the material of layers differs, by their strength or by their stress."""
        return bool(self.lives)

    @property
    def profiles(self) -> int:
        """Number of the profiles of `stack`: one for each group."""
        return max(self.groups) + 1

    def layer_at(
        self, zeta: ArrayLike, elastic: NDArray[np.int_] | None = None
    ) -> NDArray[np.int_]:
        """Return the numbers of the layers at depths below the unworn surface, mm, shape (...).

        Parameters
        ----------
        zeta : array_like, shape (...)
            Depths, mm.
        elastic : ndarray of int, optional
            Number of the elastic layer whose stress is known there: only its material is returned.
        """
        zeta = np.asarray(zeta, float)
        if not self.is_layered:
            return np.broadcast_to(0, zeta.shape)
        number = np.searchsorted(self.faces, zeta)
        if elastic is None:
            return number
        last = np.where(elastic < self.distinct, elastic, self.faces.size)
        return np.clip(number, elastic, last)

    def at(
        self, name: str, zeta: ArrayLike, layer: NDArray[np.int_] | None = None
    ) -> NDArray[np.float64] | None:
        """Return values at depths below the unworn surface, mm, shape (...); None without any.

        They are those of a `layer`, by its number, by default of `layer_at`.
        """
        if name not in self.curves:
            return None
        below = np.interp(np.asarray(zeta, float), *self.curves[name])
        if not self.layers or name not in self.layers[0]:
            return below
        number = self.layer_at(zeta) if layer is None else layer
        values = np.array([*(part[name] for part in self.layers), math.nan])
        return np.where(number < len(self.layers), values[number], below)

    def stress(self, zeta: ArrayLike) -> NDArray[np.float64] | None:
        """Return the residual stress xx, yy at depths, shape (2, ...), MPa; None without any."""
        values = [self.at(name, zeta) for name in ("xx", "yy")]
        if all(value is None for value in values):
            return None
        return np.stack([0.0 * np.asarray(zeta, float) if v is None else v for v in values])

    def life(self, layer: float, common: Woehler) -> Woehler:
        """Return the curve of a layer, by its number; `common` without layers, or if it is nan."""
        return common if math.isnan(layer) or not self.is_layered else self.lives[int(layer)]

    def damage(
        self, used: NDArray[np.float64], layer: NDArray[Any], common: Woehler
    ) -> NDArray[np.float64]:
        """Return the damage of a cycle, from the utilisation and the layers, both (..., n)."""
        if not self.is_layered:
            return common.damage(used)
        damage = np.zeros(used.shape)
        for k, life in enumerate(self.lives):
            here = layer == k
            if here.any():
                damage = np.where(here, life.damage(np.where(here, used, 0.0)), damage)
        return damage

    def stack(
        self, depth: NDArray[np.float64], used: NDArray[np.float64], layer: NDArray[np.int_]
    ) -> NDArray[np.float64]:
        """Return the profiles of all groups, one after the other, (..., n_y, groups n).

        Beyond its depths a profile is constant; on the other side of an interface of two adjacent
        depths it continues. A group that is worn off has zeros.

        Parameters
        ----------
        depth : ndarray, shape (n,)
            Depths below the present surface, ascending, mm.
        used : ndarray, shape (..., n_y, n)
            Equivalent stress over the common limit.
        layer : ndarray of int, shape (n_y, n)
            Number of the layer.
        """
        if not any(self.groups):
            return used
        root, number, parts = np.sqrt(depth), np.arange(depth.size), []
        for group in range(self.profiles):
            inside = np.array(self.groups)[layer] == group
            first = inside.argmax(axis=1)[:, None]
            last = depth.size - 1 - inside[:, ::-1].argmax(axis=1)[:, None]
            place = np.clip(number, first, last)
            part = np.take_along_axis(used, np.broadcast_to(place, used.shape), axis=-1)
            for end, step, beyond in ((last, 1, number > last), (first, -1, number < first)):
                inner, outer = np.clip(end - step, first, last), np.clip(end + step, 0, number[-1])
                run, gap = abs(root[end] - root[inner]), abs(root[outer] - root[end])
                ends, inners = (
                    np.take_along_axis(used, np.broadcast_to(at, (*used.shape[:-1], 1)), axis=-1)
                    for at in (end, inner)
                )
                share = np.divide(gap, run, out=np.zeros_like(run), where=gap < 1e-3 * run)
                further = np.maximum(ends + share * (ends - inners), 0.0)
                part = np.where(beyond, further, part)
            parts.append(np.where(inside.any(axis=1)[:, None], part, 0.0))
        return np.concatenate(parts, axis=-1)

    def utilisation(
        self, used: Sequence[NDArray[np.float64]], zeta: NDArray[np.float64], layer: NDArray[Any]
    ) -> NDArray[np.float64]:
        """Return the utilisation (..., n_y, m) from the profiles at depths.

        Parameters
        ----------
        used : sequence of ndarray, shape (..., n_y, m)
            Profile of each group (`stack`).
        zeta : ndarray, shape (m,) or (n_y, m)
            Depths below the unworn surface, mm.
        layer : ndarray, shape (m,) or (n_y, m)
            Numbers of the layers.
        """
        if self.common_limit is None:
            return used[0]
        group, limit = np.array(self.groups)[layer], self.at("limit", zeta, layer)
        here = np.select([group == k for k in range(self.profiles)], used)
        return here if limit is None else here * (self.common_limit / limit)


def strength_from_hardness(
    hardness: ArrayLike, inclusion: float | None = None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return yield strength and fatigue limit in reversed bending of steels from hardness, MPa.

    The yield strength in tension is 2.876 HV - 90.7, a regression over more than 150 steels with
    yield strengths of 300 to 1700 MPa (Pavlina & Van Tyne, J. Mater. Eng. Perform. 17 (2008) 888).
    The fatigue limit is 1.6 HV, and with inclusions at most 1.56 (HV + 120) / area^(1/12), with the
    area of the largest inclusion in the interior, projected in the direction of the stress, in
    square micrometres (Murakami, Metal Fatigue, 2002, chapters 1 and 6).

    Parameters
    ----------
    hardness : array_like, shape (...)
        Vickers hardness, HV.
    inclusion : float, optional
        Square root of the area of the largest inclusion, micrometres; needed above 400 HV.

    Returns
    -------
    yield_strength, bending : ndarray, shape (...)

    Examples
    --------
    >>> strength_from_hardness([300.0, 700.0], inclusion=30.0)[1].round(1)
    array([371.7, 725.7])
    """
    hardness = np.asarray(hardness, float)
    bending = 1.6 * hardness
    if inclusion is not None:
        bending = np.minimum(bending, 1.56 * (hardness + 120.0) / inclusion ** (1.0 / 6.0))
    return 2.876 * hardness - 90.7, bending


def limit_from_bending(
    criterion: str, sensitivity: float | None, bending: ArrayLike, yield_strength: ArrayLike
) -> NDArray[np.float64]:
    """Return the limit of a fatigue criterion that agrees with the limit in reversed bending, MPa.

    It is the value of the criterion for an alternating stress in one direction. Orthogonal shear
    needs the limit in torsion, which is taken as the limit in bending over sqrt 3 (von Mises).

    Parameters
    ----------
    criterion : str
        Name of a criterion of this package.
    sensitivity : float or None
        Sensitivity of the criterion.
    bending : array_like, shape (...)
        Fatigue limit in reversed bending, MPa.
    yield_strength : array_like, shape (...)
        Yield strength in tension, MPa; for the criterion of Fatemi and Socie.

    Examples
    --------
    >>> limit_from_bending("dang-van", 0.3, [300.0], [900.0])
    array([180.])
    """
    bending, k = np.asarray(bending, float), sensitivity or 0.0
    match criterion:
        case "dang-van":
            return bending * (0.5 + k / 3.0)
        case "crossland":
            return bending * (math.sqrt(3.0) + k) / 3.0
        case "findley":
            return bending * 0.5 * (math.hypot(1.0, k) + k)
        case "fatemi-socie":
            angle = np.linspace(0.0, 0.5 * math.pi, 4001).reshape(-1, *(1,) * bending.ndim)
            normal = bending * np.cos(angle) ** 2 / np.asarray(yield_strength, float)
            return (bending * np.sin(angle) * np.cos(angle) * (1.0 + k * normal)).max(axis=0)
    return bending / math.sqrt(3.0)


@dataclass(frozen=True)
class RollingMarch:
    """Elastic-plastic march along the stress path below a Hertz contact, depth by depth.

    See `kernels.fatigue.rolling_residual`. Below an ellipse the path is in the middle, y = 0.

    Parameters
    ----------
    contact : HertzContact or HertzLine
        The frictionless contact that rolls.
    poisson : float
        Poisson's ratio of the body.
    points : int
        Points of a path; the error of the stress is proportional to their spacing, and below 2e-4
        of the peak pressure.
    reach : float
        Length of the path before and behind the contact, over the larger of semi-axis and depth.
    shallowest : float
        Depth over the smaller semi-axis above which nothing is left: J2 is below (0.22 p0)² there,
        and point forces give no accurate stress.
    sparse, nodes : int
        Below an ellipse: points at which the stress is computed, and nodes along the radius of a
        circle.

    Examples
    --------
    >>> line = reference.hertz_line(e_star=114e3, radius_x=10.0, load=None, pressure=1200.0)
    >>> march = RollingMarch(line, poisson=0.3)
    >>> (march.residual([0.5 * line.a], shear_yield=300.0) / line.p0).round(3)
    array([[-0.134],
           [-0.213]])
    """

    contact: HertzContact | HertzLine
    poisson: float
    points: int = 2001
    reach: float = 8.0
    shallowest: float = 0.1
    sparse: int = 201
    nodes: int = 32

    def paths(self, depths: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the elastic stress paths at depths (k,) above 0, shape (k, 6, points), MPa."""
        a = self.contact.a
        along = np.sinh(4.0 * np.linspace(1.0, -1.0, self.points)) / math.sinh(4.0)
        x = self.reach * np.maximum(a, depths)[:, None] * along
        z = np.broadcast_to(depths[:, None], x.shape)
        if math.isinf(self.contact.b):
            return self._line(x / a, z / a)
        return self._ellipse(x, z)

    def _line(self, x: NDArray[np.float64], z: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the stress below a line contact (McEwen 1949; Johnson 1985, (4.49))."""
        square = 1.0 - x * x + z * z
        root = np.hypot(square, 2.0 * x * z)
        m, n = np.sqrt(0.5 * (root + square)), np.sqrt(0.5 * np.maximum(root - square, 0.0))
        n *= np.sign(x)
        share = (z * z + n * n) / (m * m + n * n)
        xx, zz = 2.0 * z - m * (1.0 + share), -m * (1.0 - share)
        xz = -n * (m * m - z * z) / (m * m + n * n)
        none = np.zeros_like(x)
        stress = [xx, self.poisson * (xx + zz), zz, none, xz, none]
        return self.contact.p0 * np.stack(stress, axis=1)

    def _ellipse(self, x: NDArray[np.float64], z: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the stress below the middle of an ellipse, from point forces (Boussinesq).

        With the pressure p0 t at x = a r cos(angle), y = b r sin(angle), r² = 1 - t², the force of
        a node is p0 a b t² dt d(angle). Gauss' rule in t holds where the depth exceeds the spacing.
        """
        coarse = np.linspace(0, x.shape[1] - 1, self.sparse).astype(int)  # the path is smooth
        a, b = self.contact.a, self.contact.b
        count = int(self.nodes * min(max(1.0, a / b), 2.0))
        t, weight = np.polynomial.legendre.leggauss(count)
        t = 0.5 * (t[:, None] + 1.0)
        angle = math.pi * (np.arange(2 * count) + 0.5) / (2 * count)
        radius = np.sqrt(1.0 - t * t)
        # Half of the ellipse, twice: the forces at y and -y.
        force = self.contact.p0 * a * b * (0.5 * weight[:, None] * t * t) * math.pi / count
        nodes = a * radius * np.cos(angle), b * radius * np.sin(angle), force + 0.0 * angle
        stress = np.zeros((4, *x[:, coarse].shape))  # xx, yy, zz, xz
        depth, free = z[:, coarse], 1.0 - 2.0 * self.poisson
        for at, y, load in zip(*(np.ravel(values) for values in nodes), strict=True):
            away = x[:, coarse] - at
            r = np.sqrt(away * away + y * y + depth * depth)
            share = load / (2.0 * math.pi * r**3)
            below = (r / (r + depth)) ** 2
            first = depth - r * r / (r + depth)
            radial = (2.0 * r + depth) * below / (r * r)
            down = 3.0 * depth * share / (r * r)
            stress[0] += free * share * (first + radial * away**2) - down * away**2
            stress[1] += free * share * (first + radial * y * y) - down * y * y
            stress[2] -= down * depth**2
            stress[3] -= down * away * depth
        number, out = np.arange(x.shape[1]), np.zeros((len(x), 6, x.shape[1]))
        for k, component in enumerate((0, 1, 2, 4)):
            for row, values in enumerate(stress[k]):
                out[row, component] = np.interp(number, coarse, values)
        return out

    def residual(self, depths: ArrayLike, shear_yield: ArrayLike) -> NDArray[np.float64]:
        """Return the residual stress xx, yy that rolling leaves at depths, shape (2, k), MPa.

        Parameters
        ----------
        depths : array_like, shape (k,)
            Depths, mm.
        shear_yield : array_like, shape (k,)
            Yield stress in shear at these depths, MPa; a number applies to all.
        """
        from tractive_sam.kernels.fatigue import rolling_residual  # noqa: PLC0415

        depths = np.asarray(depths, float)
        bounds = np.array(np.broadcast_to(shear_yield, depths.shape), float)
        out, yields = (
            np.zeros((depths.size, 2)),
            depths >= self.shallowest * min(self.contact.a, self.contact.b),
        )
        below = np.empty((np.count_nonzero(yields), 2))
        rolling_residual(below, self.paths(depths[yields]), bounds[yields], self.poisson)
        out[yields] = below
        return out.T
