"""A table of creep forces: scaling, symmetries, interpolation and error."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from tractive_sam.description import Description
from tractive_sam.lookup.coordinates import CONTACT, NAMES, RATIO, SPIN, Coordinates
from tractive_sam.lookup.describe import describe_table
from tractive_sam.lookup.hermite import Hermite, cell_of
from tractive_sam.lookup.table_checks import faults_of_table
from tractive_sam.markup import fill
from tractive_sam.safe_text import printable_text

MARGIN = 1e-9
"""Of a coordinate outside a table that rounding alone may have brought there."""


@dataclass(frozen=True, eq=False)
class Forces:
    """Creep forces from a table; arrays have the shape of what was given.

    Attributes
    ----------
    Qx, Qy : ndarray
        Forces on body A, N.
    Mz : ndarray
        Spin moment on body A, N mm.
    """

    Qx: np.ndarray
    Qy: np.ndarray
    Mz: np.ndarray
    _table: CreepTable = field(repr=False)
    _at: tuple = field(repr=False)

    @cached_property
    def error(self) -> np.ndarray:
        """How far each of Qx, Qy, Mz may be off, shape (3, ...).

        From those on an infinitely fine mesh: error bar of the contacts solved and error of
        interpolation.
        """
        points, _, _, unit, shape = self._at
        return (unit * self._table.error_at(points)).reshape(3, *shape)

    @cached_property
    def gradient(self) -> np.ndarray:
        """Derivatives of Qx, Qy, Mz by xi_x, xi_y, spin, shape (3, 3, ...).

        Of an infinite creepage they are zero.
        """
        points, where, by_creepage, unit, shape = self._at
        found = self._table.gradient_at(points, where)
        return (found * unit[:, None] * by_creepage).reshape(3, 3, *shape)

    @cached_property
    def gradient_error(self) -> np.ndarray:
        """Error bars of `gradient`, in its units, shape (3, 3, ...).

        Contacts that are solved on twice the elements, at points between the nodes, give them. All
        nine derivatives are within them at 95 of 100 points or more. They are nan of a table whose
        file has none, as it was made before they were measured.
        """
        points, where, by_creepage, unit, shape = self._at
        found = self._table.gradient_error_at(points, where)
        return (found * unit[:, None] * by_creepage).reshape(3, 3, *shape)


@dataclass(frozen=True, eq=False)
class CreepTable:
    """The forces of contacts over mu P, by creepages, spin and what else varies.

    Called with creepages and contacts it gives forces, their gradient and how far they may be off;
    see `lookup.coordinates` for the scaling. Every creepage is in the table, infinite ones too; on
    other axes what is outside is refused.

    Attributes
    ----------
    law : Hermite
        (Q_x, Q_y, M_z / c) / (mu P) over the axes `names`, heading, tilt and u.
    names : tuple of str
        Axes beside those of creepages: "log_ratio", ln(a/b), and "poisson" of a table of any
        contacts of Hertz, and those of its own.
    bars : ndarray, shape (n_1, ..., n_N, 3)
        Error bars of the contacts at the nodes.
    between : tuple of ndarray
        Largest errors of interpolation seen within each interval of each axis, shape (n - 1, 3).
    about : mapping
        Title, tolerance, versions and what else the file tells.
    apart : tuple of str
        Axes between whose nodes nothing is known, such as files of gaps.
    whole : bool
        Whether it has all headings and tilts, for want of symmetries.
    contact : mapping of str to float, optional
        Of the table of one scene: a, b, load, mu and shear that scale it.
    gradient_bars : ndarray, shape (n_u, 3, 3), optional
        Error bars of gradients (force, creepage) over sqrt(K_ii K_jj), K_ii the slopes at rest of
        the same contact: at rest, and within each interval of u.

    Raises
    ------
    ValueError
        With the variables at fault: names that are none in C, axes that are no ascending numbers
        or leave creepages out, arrays of another shape, or numbers that are not finite.

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
    names: tuple[str, ...]
    bars: np.ndarray
    between: tuple[np.ndarray, ...]
    about: Mapping[str, Any]
    apart: tuple[str, ...] = ()
    whole: bool = False
    contact: Mapping[str, float] | None = None
    gradient_bars: np.ndarray | None = None

    def __post_init__(self) -> None:
        """Check all parts."""
        names, law, arrays = self.names, self.law, (self.bars, self.between)
        faults = [
            *faults_of_table(names, law.axes, law.coefficients, *arrays, self.apart, self.whole,
                             self.contact, self.gradient_bars)
        ]  # fmt: skip
        if faults:
            raise ValueError("; ".join(faults))

    def __repr__(self) -> str:
        return f"{printable_text(f'CreepTable {self.title}'.rstrip())}\n\n{self.description!r}"

    def _repr_html_(self) -> str:
        sections = self.description._repr_html_()
        return fill("<p><b>$title</b></p>$sections", title=self.title, sections=sections)

    @property
    def title(self) -> str:
        """Title from the file; empty where it has none."""
        return str(self.about.get("title", ""))

    @property
    def sections(self) -> dict[str, list[tuple[str, str]]]:
        """Rows of label and text, by the title of their section."""
        return {section.title: section.rows for section in self.description}

    @property
    def description(self) -> Description:
        """What the table contains, its errors, and how it is called."""
        axes = dict(zip((*self.names, *NAMES), self.law.axes, strict=True))
        return describe_table(axes, self.about, self.apart, self.whole, self.contact)

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
        a: ArrayLike | None = None,
        b: ArrayLike | None = None,
        load: ArrayLike | None = None,
        mu: ArrayLike | None = None,
        shear: ArrayLike | None = None,
        **others: ArrayLike | None,
    ) -> Forces:
        """Forces of contacts; all arguments broadcast.

        Parameters
        ----------
        xi_x, xi_y, spin : array_like
            Creepages, and spin in 1/mm; one of each three may be infinite: full slip.
        a, b : array_like
            Semi-axes in rolling and in lateral direction, mm. Needed, as are the next three, but of
            the table of one scene, which gives all five.
        load : array_like
            Normal load, N.
        mu : array_like
            Coefficient of friction, along the axis e1 where it is orthotropic.
        shear : array_like
            Combined shear modulus G, 2/G = 1/G_A + 1/G_B, MPa.
        **others : array_like
            Poisson's ratio, ``poisson``, and further axes by their names; each is needed where the
            table has several values of it.

        Raises
        ------
        ValueError
            If a creepage is no number, a property of the contact not positive and finite, an axis
            not given or not of the table, or its value outside the table.
        """
        given = self._contact({"a": a, "b": b, "load": load, "mu": mu, "shear": shear})
        along = self._along(others)
        arrays = [np.asarray(one, float) for one in (xi_x, xi_y, spin, *given, *along.values())]
        shape = np.broadcast_shapes(*(one.shape for one in arrays))
        flat = np.empty((len(arrays), int(np.prod(shape))))
        for row, one in zip(flat, arrays, strict=True):
            row.reshape(shape)[...] = one
        creepages, (a_, b_, load_, mu_, shear_) = flat[:3], flat[3:8]
        if not ((flat[3:8] > 0.0) & np.isfinite(flat[3:8])).all():
            proper = ((flat[3:8] > 0.0) & np.isfinite(flat[3:8])).all(axis=1)
            name = CONTACT[int(proper.argmin())]
            raise ValueError(f"{name}: positive and finite numbers are needed")
        ratio = a_ / b_
        points = dict(zip(along, flat[8:], strict=True))
        if self.contact is None:
            points = {RATIO: np.log(ratio)} | points
        for name, nodes in zip(self.names, self.law.axes, strict=False):
            self._inside(name, points[name], nodes)
        c, bound = np.sqrt(a_ * b_), mu_ * load_
        unit = np.array([bound, bound, bound * c])
        scale = shear_ * (c * c) / bound
        by_creepage = np.array([scale, scale, scale * c])
        where = Coordinates.of(creepages * by_creepage, ratio, self.whole)
        at = (*(points[name] for name in self.names), *where.points)
        Qx, Qy, Mz = (unit * where.signs * self.law(at)).reshape(3, *shape)
        return Forces(Qx, Qy, Mz, self, (at, where, by_creepage, unit, shape))

    def _contact(self, given: dict[str, Any]) -> list[Any]:
        for name, one in given.items():
            if self.contact is None and one is None:
                raise ValueError(f"{name}: needed, of tables of any contact")
            if self.contact is not None and one is not None:
                raise ValueError(f"{name}: the scene of the table gives it; leave it out")
        return [*(given if self.contact is None else self.contact).values()]

    def _along(self, others: dict[str, Any]) -> dict[str, Any]:
        """Values along all axes but a/b and creepages."""
        axes = {k: v for k, v in zip(self.names, self.law.axes, strict=False) if k != RATIO}
        for name in others:
            if name not in axes:
                known = ", ".join(axes) or "none"
                raise ValueError(f"{name}: no axis of the table, which has {known}")
        found = {}
        for name, nodes in axes.items():
            found[name] = others.get(name)
            if found[name] is None:
                if len(nodes) > 1:
                    low, high = nodes[0], nodes[-1]
                    raise ValueError(f"{name}: needed, the table has {low:g} to {high:g}")
                found[name] = nodes[0]
        return found

    @property
    def ellipticity(self) -> tuple[float, float]:
        """Least and largest a/b."""
        if self.contact is not None:
            return (self.contact["a"] / self.contact["b"],) * 2
        low, high = np.exp(self.law.axes[0][[0, -1]])
        return float(low), float(high)

    def axis(self, name: str) -> np.ndarray:
        """The nodes along one of the axes `names`."""
        return self.law.axes[self.names.index(name)]

    def _inside(self, name: str, values: np.ndarray, nodes: np.ndarray) -> None:
        if name in self.apart:
            off = np.abs(values[:, None] - nodes).min(axis=1, initial=np.inf)
            if not (off <= MARGIN * (1.0 + np.abs(values))).all():
                known = ", ".join(f"{one:g}" for one in nodes)
                raise ValueError(f"{name}: {known} are in the table, and nothing between them")
            return
        inside = (values >= nodes[0] - MARGIN) & (values <= nodes[-1] + MARGIN)
        if not inside.all():
            told = np.array([nodes[0], nodes[-1], values[~inside][0]])
            if name == RATIO:
                name, told = "a/b", np.exp(told)
            low, high, one = (float(v) for v in told)
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

    def gradient_at(self, points, where: Coordinates) -> np.ndarray:
        """Derivatives of scaled forces by scaled creepages, shape (3, 3, P)."""
        first = len(points) - len(NAMES)
        shifted = (*points[:first], *where.points_of_slopes)
        by = self.law.parts(shifted, range(first, len(points)))
        # by (coordinate, force, P) times (coordinate, creepage, P)
        return np.einsum("kfp,kcp->fcp", by, where.by_creepages) * where.signs[:, None]

    def slopes_at_rest(self, points, r0: np.ndarray) -> np.ndarray:
        """Sizes of the slopes at rest of each force by its creepage, shape (3, P).

        Of scaled forces, at the points' places along the axes `names`; r0 is `unit_radius` there.
        """
        first, none = len(points) - len(NAMES), np.zeros_like(r0)
        right = np.full_like(r0, 0.5 * np.pi)
        directions = ((none, none), (right, none), (none, right))
        by_u = [
            self.law((*points[:first], *direction, none), len(points) - 1)[k]
            for k, direction in enumerate(directions)
        ]
        return np.abs(by_u) / r0 * np.array([[1.0], [1.0], [SPIN]])

    def gradient_error_at(self, points, where: Coordinates) -> np.ndarray:
        """Error bars of `gradient_at`, shape (3, 3, P); zero in full slip, nan where unknown."""
        nodes, u = self.law.axes[-1], points[-1]
        if self.gradient_bars is None:
            return np.full((3, 3, len(u)), np.nan)
        cell = cell_of(nodes, u)
        bars = share_of_bar(nodes, u)[:, None, None] * self.gradient_bars[1 + cell]
        bars[cell == 0] += self.gradient_bars[0]
        size = np.sqrt(self.slopes_at_rest(points, where.r0))
        found = np.moveaxis(bars, 0, -1) * size[:, None] * size
        return np.where(where.full, 0.0, found)

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


def share_of_bar(nodes: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Share of an interval's error bar of gradients that counts at u, shape (P,).

    It rises from rest, where slopes have their own bars, within a third of the first interval, and
    falls to zero in the last one, as gradients do towards full slip.

    Parameters
    ----------
    nodes : ndarray, shape (n_u,)
        Nodes along u.
    u : ndarray, shape (P,)
        Places along u.
    """
    cell = cell_of(nodes, u)
    t = (u - nodes[cell]) / (nodes[cell + 1] - nodes[cell])
    share = np.where(cell == 0, np.minimum(3.0 * t, 1.0), 1.0)
    return np.where(cell == len(nodes) - 2, 1.0 - t, share)
