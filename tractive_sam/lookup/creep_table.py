"""A table of creep forces: scaling, symmetries, interpolation and error."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from tractive_sam.lookup.coordinates import NAMES, Coordinates
from tractive_sam.lookup.hermite import Hermite, cell_of


@dataclass(frozen=True, eq=False)
class Forces:
    """Creep forces from a table; arrays have the shape of what was given.

    Attributes
    ----------
    Qx, Qy : ndarray
        Forces on body A, N.
    Mz : ndarray
        Spin moment on body A, N mm.
    error : ndarray, shape (3, ...)
        How far each of the three may be from that on an infinitely fine mesh: error bar of the
        contacts solved and error of interpolation.
    """

    Qx: np.ndarray
    Qy: np.ndarray
    Mz: np.ndarray
    error: np.ndarray
    _table: "CreepTable" = field(repr=False)
    _at: tuple = field(repr=False)

    @cached_property
    def gradient(self) -> np.ndarray:
        """Derivatives of Qx, Qy, Mz by xi_x, xi_y, spin, shape (3, 3, ...).

        Of an infinite creepage they are zero.
        """
        points, where, by_creepage, unit, shape = self._at
        first = len(points) - len(NAMES)
        law = self._table.law
        by = np.stack([law(points, by=first + k) for k in range(len(NAMES))], axis=1)
        # by (force, coordinate, P) times (coordinate, creepage, P)
        found = np.einsum("fkp,kcp->fcp", by, where.by_creepages) * where.signs[:, None]
        return (found * unit[:, None] * by_creepage).reshape(3, 3, *shape)


@dataclass(frozen=True, eq=False)
class CreepTable:
    """The forces of Hertzian contacts of alike bodies over mu P, by a/b, creepages and spin.

    Called with creepages and contacts it gives forces, their gradient and how far they may be off;
    see `lookup.coordinates` for the scaling. Every creepage is in the table, infinite ones too; a/b
    or Poisson's ratio outside are refused.

    Attributes
    ----------
    law : Hermite
        (Q_x, Q_y, M_z / c) / (mu P) over ln(a/b), Poisson's ratio, heading, tilt and u.
    bars : ndarray, shape (n_1, ..., n_5, 3)
        Error bars of the contacts at the nodes.
    between : tuple of ndarray
        Largest errors of interpolation seen within each interval of each axis, shape (n - 1, 3).
    about : mapping
        Title, tolerance, versions and what else the file tells.

    Examples
    --------
    >>> table = ts.open_table("steel")
    >>> contact = dict(a=6.0, b=4.0, load=80e3, mu=0.3, shear=80e3)
    >>> f = table(-1e-3, 0.0, 0.0, **contact)
    >>> bool(0.3 < f.Qx / (0.3 * 80e3) < 0.5)
    True
    >>> f.gradient.shape
    (3, 3)
    >>> table([-1e-4, -1e-3, -float("inf")], 0.0, 0.0, **contact).Qx.round()[-1].item()
    24000.0
    """

    law: Hermite
    bars: np.ndarray
    between: tuple[np.ndarray, ...]
    about: Mapping[str, Any]

    @property
    def nodes(self) -> int:
        """Number of nodes."""
        return int(np.prod([len(one) for one in self.law.axes]))

    def __call__(
        self,
        xi_x: ArrayLike,
        xi_y: ArrayLike,
        spin: ArrayLike,
        *,
        a: ArrayLike,
        b: ArrayLike,
        load: ArrayLike,
        mu: ArrayLike,
        shear: ArrayLike,
        poisson: ArrayLike | None = None,
    ) -> Forces:
        """Forces of contacts; all arguments broadcast.

        Parameters
        ----------
        xi_x, xi_y, spin : array_like
            Creepages, and spin in 1/mm; one of each three may be infinite: full slip.
        a, b : array_like
            Semi-axes in rolling and in lateral direction, mm.
        load : array_like
            Normal load, N.
        mu : array_like
            Coefficient of friction.
        shear : array_like
            Combined shear modulus G, 2/G = 1/G_A + 1/G_B, MPa.
        poisson : array_like, optional
            Poisson's ratio; needed of a table with several.

        Raises
        ------
        ValueError
            If a creepage is no number, a property of the contact not positive and finite, or a/b or
            Poisson's ratio outside the table.
        """
        given = {"a": a, "b": b, "load": load, "mu": mu, "shear": shear}
        nu = self.poisson[0] if poisson is None else poisson
        if poisson is None and len(self.poisson) > 1:
            raise ValueError(
                f"poisson: needed, the table has {self.poisson.min():g} to {self.poisson.max():g}"
            )
        arrays = np.broadcast_arrays(
            *(np.asarray(one, float) for one in (xi_x, xi_y, spin, *given.values(), nu))
        )
        shape = arrays[0].shape
        *creepages, a_, b_, load_, mu_, shear_, nu_ = (one.reshape(-1) for one in arrays)
        for name, one in zip(given, (a_, b_, load_, mu_, shear_), strict=True):
            if not ((one > 0.0) & np.isfinite(one)).all():
                raise ValueError(f"{name}: positive and finite numbers are needed")
        ratio = a_ / b_
        self._inside("a/b", np.log(ratio), self.law.axes[0], np.exp)
        self._inside("poisson", nu_, self.law.axes[1], float)
        c, bound = np.sqrt(a_ * b_), mu_ * load_
        unit = bound * np.stack([np.ones_like(c), np.ones_like(c), c])
        scale = shear_ * c**2 / bound
        by_creepage = np.stack([scale, scale, scale * c])
        where = Coordinates.of(np.stack(creepages) * by_creepage, ratio)
        points = (np.log(ratio), nu_, where.heading, where.tilt, where.u)
        values = unit * where.signs * self.law(points)
        error = unit * self.error_at(points)
        Qx, Qy, Mz = (one.reshape(shape) for one in values)
        at = points, where, by_creepage, unit, shape
        return Forces(Qx, Qy, Mz, error.reshape(3, *shape), self, at)

    @property
    def ellipticity(self) -> tuple[float, float]:
        """Least and largest a/b."""
        low, high = np.exp(self.law.axes[0][[0, -1]])
        return float(low), float(high)

    @property
    def poisson(self) -> np.ndarray:
        """Poisson's ratios at the nodes."""
        return self.law.axes[1]

    def _inside(self, name, values, nodes, told) -> None:
        margin = 1e-9
        outside = (values < nodes[0] - margin) | (values > nodes[-1] + margin)
        if outside.any():
            low, high, one = (float(told(v)) for v in (nodes[0], nodes[-1], values[outside][0]))
            raise ValueError(f"{name}: {low:.6g} to {high:.6g} are in the table, not {one:.6g}")

    def error_at(self, points) -> np.ndarray:
        """Errors over mu P, and of the moment over mu P c, at points of `law`, shape (3, P).

        Bar, the largest one of the corners of the cell, and errors of interpolation.
        """
        cells = [cell_of(nodes, x) for nodes, x in zip(self.law.axes, points, strict=True)]
        found = self._bar_of_cell[tuple(cells)].T.copy()
        for cell, errors in zip(cells, self.between, strict=True):
            if len(errors):
                found += errors[cell].T
        return found

    @cached_property
    def _bar_of_cell(self) -> np.ndarray:
        bars = self.bars
        for k in range(bars.ndim - 1):
            if bars.shape[k] > 1:
                ends = [
                    np.take(bars, range(*one), axis=k)
                    for one in ((0, bars.shape[k] - 1), (1, bars.shape[k]))
                ]
                bars = np.maximum(*ends)
        return bars
