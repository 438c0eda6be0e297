"""A table of creep forces: checks, scaling, symmetries, interpolation and error, as text, too."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from tractive_sam.description import Description, Section
from tractive_sam.lookup.hermite import (
    CONTACT,
    NAMES,
    RATIO,
    SPIN,
    Coordinates,
    Hermite,
    Point,
    SinglePointLaw,
    cell_of,
    creepages_at,
)
from tractive_sam.safe_text import fill, printable_text


def describe_table(
    axes: Mapping[str, np.ndarray],
    about: Mapping[str, Any],
    apart: Sequence[str],
    full_range: bool,
    contact: Mapping[str, float] | None,
) -> Description:
    """Describe the range of a table, its errors, and its use.

    Parameters
    ----------
    axes : mapping of str to ndarray
        Nodes along every axis, creepages last.
    about, apart, whole, contact
        See the attributes of `CreepTable`.
    """
    nodes = [describe_axis(name, nodes, name in apart) for name, nodes in axes.items()]
    total = math.prod(len(nodes) for nodes in axes.values())
    made = [("version", str(about.get("version", "unknown")))]
    if {"contacts", "cpu_seconds"} <= about.keys():
        spent = f"{about['contacts']} contacts, {about['cpu_seconds']:.3g} s of one core"
        made.append(("solved", spent))
    varying = [name for name in axes if name not in (RATIO, *NAMES) and len(axes[name]) > 1]
    arguments = [f"{name}=..." for name in (*(() if contact else CONTACT), *varying)]
    call = f"table({', '.join(('xi_x', 'xi_y', 'spin', *arguments))})"
    use = [
        ("in Python", f"table = ts.open_table(FILE); {call}"),
        ("elsewhere", "tractive-sam table FILE, with --header, --fmu, --text or --figure"),
    ]
    return Description((
        Section("Table of creep forces", describe_range(contact, full_range)),
        Section("Nodes", [*nodes, ("total", str(total))]),
        Section("Errors", _describe_errors(about)),
        Section("Made by", made),
        Section("Use", use),
    ))  # fmt: skip


def describe_range(contact: Mapping[str, float] | None, full_range: bool) -> list[tuple[str, str]]:
    """Describe the contacts and the creepages of a table."""
    contacts = "any Hertz contact of equal materials, with isotropic friction"
    quarter = "a quarter of all; the others follow by two symmetries"
    if contact is not None:
        a, b, load, mu, shear = (contact[key] for key in CONTACT)
        scales = f"a = {a:.4g} mm, b = {b:.4g} mm, P = {load:.4g} N, mu = {mu:g}"
        contacts = f"one scene; scaled by {scales}, G = {shear:.4g} MPa"
    return [
        ("contacts", contacts),
        ("creepages", "all headings and tilts" if full_range else quarter),
    ]


def describe_axis(name: str, nodes: np.ndarray, apart: bool) -> tuple[str, str]:
    """Describe the nodes along an axis; `apart`: without interpolation between them."""
    if name == RATIO:
        name, nodes = "a/b", np.exp(nodes)
    if len(nodes) == 1:
        return name, f"{nodes[0]:.4g}"
    if apart:
        return name, ", ".join(f"{node:.6g}" for node in nodes) + ", without interpolation"
    return name, f"{len(nodes)} from {nodes[0]:.4g} to {nodes[-1]:.4g}"


def _describe_errors(about: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Describe the tolerance and the measured errors of forces and gradients."""
    errors = [("tolerance", f"{float(about.get('tolerance', math.nan)):g} of mu P")]
    if "held_out" in about:
        errors.append((
            f"{about['held_out']} points held out",
            f"{about['held_out_median']:.1e} of mu P in the median, {about['held_out_worst']:.1e} "
            f"at most; {about['held_out_inside']:.1%} within the error that the table reports",
        ))  # fmt: skip
    gradients = "errors unknown; tractive-sam table FILE.nc -o NEW.nc computes them"
    if "gradient_checks" in about:
        gradients = (
            f"at rest within {about['gradient_at_rest']:.1e} of sqrt(K_ii K_jj), K_ii the slopes "
            f"at rest; at {about['gradient_checks']} points {about['gradient_median']:.1e} in the "
            f"median, {about['gradient_worst']:.1e} at most, {about['gradient_inside']:.1%} within "
            "error bars"
        )
    return [*errors, ("gradients", gradients)]


def table_faults(
    names: Sequence[str],
    axes: Sequence[Any],
    coefficients: Any,
    bars: Any,
    between: Sequence[Any],
    apart: Sequence[str] = (),
    full_range: bool = False,
    contact: Mapping[str, float] | None = None,
    gradient_bars: Any = None,
) -> Iterator[str]:
    """Yield the faults of the parts of a `CreepTable`, each with its variable.

    Arrays are only checked if names and axes have no faults.
    """
    every = (*names, *NAMES)
    faults = [*_name_faults(names, apart, contact), *_axis_faults(every, axes, full_range)]
    yield from faults
    if faults:
        return
    shape = tuple(map(len, axes))
    yield from _array_faults("coefficients", coefficients, (*shape, 2 ** len(shape), 3))
    yield from _array_faults("error_bar", bars, (*shape, 3), lower=0.0)
    if gradient_bars is not None:
        yield from _array_faults("gradient_bar", gradient_bars, (shape[-1], 3, 3), lower=0.0)
    if len(between) != len(every):
        yield f"between: for {len(between)} axes; allowed: for all {len(every)}"
        return
    for name, errors, count in zip(every, between, shape, strict=True):
        if count > 1 or len(errors):
            yield from _array_faults(f"between_{name}", errors, (count - 1, 3), lower=0.0)


def is_identifier(name: str) -> bool:
    """Return whether C, Python and XML allow a text as a name."""
    return re.fullmatch(r"[A-Za-z]\w*", name, re.ASCII) is not None


def _name_faults(
    names: Sequence[str], apart: Sequence[str], contact: Mapping[str, float] | None
) -> Iterator[str]:
    """Yield the faults of the names of axes and of the contact."""
    for name in names:
        if not is_identifier(name) or (*names, *NAMES).count(name) > 1:
            yield f"axes: the name {name!r}; allowed: letters, digits and _, each name once"
    if (names[:1] == (RATIO,)) != (contact is None) or RATIO in names[1:]:
        yield f"axes: {', '.join(names)}; allowed: {RATIO} first, or a, b, load, mu and shear"
    if not set(apart) <= set(names):
        yield f"apart: {' '.join(apart)}; allowed: some of {' '.join(names)}"
    for name in CONTACT:
        value = 1.0 if contact is None else contact.get(name, math.nan)
        if not (value > 0.0 and math.isfinite(value)):
            yield f"{name}: {value}; allowed: a positive and finite number"


def _axis_faults(every: Sequence[str], axes: Sequence[Any], full_range: bool) -> Iterator[str]:
    """Yield the faults of the nodes of the axes."""
    if len(axes) != len(every):
        yield f"axes: {len(axes)} arrays; allowed: {len(every)}, one of each name"
        return
    quarter = 0.5 * math.pi
    ends = {"heading": (-quarter, quarter), "tilt": (0.0, quarter), "u": (0.0, 1.0)}
    if full_range:
        ends |= {"heading": (-math.pi, math.pi), "tilt": (-quarter, quarter)}
    for name, nodes in zip(every, axes, strict=True):
        if not (_is_numeric(nodes) and nodes.ndim == 1 and nodes.size):
            yield f"{name}: {_describe_array(nodes)}; allowed: a row of numbers"
        elif not (np.isfinite(nodes).all() and (np.diff(nodes) > 0.0).all()):
            yield f"{name}: nodes that are not finite, or do not ascend; allowed: ascending numbers"
        elif name in ends and np.abs(nodes[[0, -1]] - ends[name]).max() > 1e-9:  # rounding
            low, high = ends[name]
            yield f"{name}: from {nodes[0]:g} to {nodes[-1]:g}; allowed: from {low:g} to {high:g}"
        elif name == RATIO and np.abs(nodes).max() > math.log(1e6):
            yield f"{name}: up to {np.abs(nodes).max():g}; allowed: ln(a/b) of a/b from 1e-6 to 1e6"


def _array_faults(
    name: str, values: Any, shape: tuple[int, ...], lower: float = -math.inf
) -> Iterator[str]:
    """Yield the fault of an array that has no numbers, or another shape, or invalid numbers."""
    if not _is_numeric(values) or values.shape != shape:
        yield f"{name}: {_describe_array(values)}; allowed: numbers of the shape {shape}"
    elif not (np.isfinite(values).all() and values.min(initial=0.0) >= lower):
        allowed = "finite numbers" + (f" of at least {lower:g}" if lower > -math.inf else "")
        yield f"{name}: invalid numbers; allowed: {allowed}"


def _is_numeric(values: Any) -> bool:
    """Return whether values are an array of numbers."""
    return isinstance(values, np.ndarray) and values.dtype.kind in "fiu"


def _describe_array(values: Any) -> str:
    """Describe the type and the shape of values."""
    array = np.asarray(values)
    return f"{array.dtype} of the shape {array.shape}"


MARGIN = 1e-9
"""Relative distance outside a table that may be due to rounding."""


class Scaled(NamedTuple):
    """Contacts in the coordinates of a table.

    Attributes
    ----------
    points : tuple of ndarray, shape (P,)
        Position on each axis.
    coordinates : Coordinates
        Coordinates of the creepages.
    by_creepage, unit : ndarray, shape (3, P)
        Scaled creepages over creepages, and units of the forces.
    shape : tuple of int
        Shape of the arguments.
    """

    points: tuple[np.ndarray, ...]
    coordinates: Coordinates
    by_creepage: np.ndarray
    unit: np.ndarray
    shape: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class Forces:
    """Creep forces from a table; arrays have the shape of the arguments, numbers give numbers.

    Attributes
    ----------
    Qx, Qy : ndarray or float
        Forces on body A, N.
    Mz : ndarray or float
        Spin moment on body A, N mm.
    """

    Qx: np.ndarray | np.float64
    Qy: np.ndarray | np.float64
    Mz: np.ndarray | np.float64
    _table: CreepTable = field(repr=False)
    _arguments: tuple[tuple[ArrayLike, ...], tuple[str, ...]] = field(repr=False)
    _point: Point | None = field(default=None, repr=False)

    @cached_property
    def _at(self) -> Scaled:
        """Scaled creepages at the point or points of these forces."""
        return self._table.scale(*self._arguments)

    @cached_property
    def error(self) -> np.ndarray:
        """Error bars of Qx, Qy, Mz, shape (3, ...).

        The reference is an infinitely fine mesh: they are the sum of the error bar of the solved
        contacts and of the interpolation error.
        """
        points, _, _, unit, shape = self._at
        return (unit * self._table.error_at(points)).reshape(3, *shape)

    @cached_property
    def gradient(self) -> np.ndarray:
        """Derivatives of Qx, Qy, Mz by xi_x, xi_y, spin, shape (3, 3, ...).

        For an infinite creepage they are zero.
        """
        if self._point is not None:
            return self._table.single_point.gradient(self._point)
        points, coordinates, by_creepage, unit, shape = self._at
        gradient = self._table.gradient_at(points, coordinates)
        return (gradient * unit[:, None] * by_creepage).reshape(3, 3, *shape)

    @cached_property
    def gradient_error(self) -> np.ndarray:
        """Error bars of `gradient`, in its units, shape (3, 3, ...).

        They come from contacts with twice the elements, at points between the nodes. All nine
        derivatives are within the bars at 95 of 100 points or more. They are nan for a table from
        a file without them.
        """
        points, coordinates, by_creepage, unit, shape = self._at
        error = self._table.gradient_error_at(points, coordinates)
        return (error * unit[:, None] * by_creepage).reshape(3, 3, *shape)


def _flatten(arguments: Sequence[ArrayLike]) -> tuple[np.ndarray, tuple[int, ...]]:
    """Return broadcast arguments as rows of an array, and the shape of each."""
    arrays = [np.asarray(values, float) for values in arguments]
    shape = np.broadcast_shapes(*(values.shape for values in arrays))
    flat = np.empty((len(arrays), int(np.prod(shape))))
    for row, values in zip(flat, arrays, strict=True):
        row.reshape(shape)[...] = values
    return flat, shape


@dataclass(frozen=True, eq=False)
class CreepTable:
    """Table of creep forces over mu P, as a function of creepages, spin and further axes.

    A call with creepages and contacts returns forces, gradients and error bars; see
    `lookup.hermite` for the scaling. The table covers all creepages, also infinite ones; values
    outside the other axes raise an error.

    Attributes
    ----------
    law : Hermite
        (Q_x, Q_y, M_z / c) / (mu P) over the axes `names`, heading, tilt and u.
    names : tuple of str
        Axes besides creepages: "log_ratio", ln(a/b), and "poisson" in a table of any Hertz
        contact, and user-defined axes.
    bars : ndarray, shape (n_1, ..., n_N, 3)
        Error bars of the contacts at the nodes.
    between : tuple of ndarray
        Largest interpolation errors within each interval of each axis, shape (n - 1, 3).
    about : mapping
        Title, tolerance, versions and further attributes of the file.
    apart : tuple of str
        Axes without interpolation, for example files of gaps.
    whole : bool
        Whether the table has all headings and tilts, without symmetries.
    contact : mapping of str to float, optional
        For the table of one scene: a, b, load, mu and shear that scale it.
    gradient_bars : ndarray, shape (n_u, 3, 3), optional
        Error bars of gradients (force, creepage) over sqrt(K_ii K_jj), K_ii the slopes at rest: at
        rest, and within each interval of u.

    Raises
    ------
    ValueError
        With the faulty variables: names that C does not allow, axes that do not ascend or do not
        cover all creepages, arrays of another shape, or numbers that are not finite.

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
        """Check the arrays, names and axes."""
        names, law, arrays = self.names, self.law, (self.bars, self.between)
        faults = [
            *table_faults(names, law.axes, law.coefficients, *arrays, self.apart, self.whole,
                             self.contact, self.gradient_bars)
        ]  # fmt: skip
        if faults:
            raise ValueError("; ".join(faults))

    def __repr__(self) -> str:
        return f"{printable_text(f'CreepTable {self.title}'.rstrip())}\n\n{self.description!r}"

    def _repr_html_(self) -> str:
        """Return the description of the table as HTML, for notebooks."""
        sections = self.description._repr_html_()
        return fill("<p><b>$title</b></p>$sections", title=self.title, sections=sections)

    @property
    def title(self) -> str:
        """Title from the file; may be empty."""
        return str(self.about.get("title", ""))

    @property
    def sections(self) -> dict[str, list[tuple[str, str]]]:
        """Rows of label and text, by the title of their section."""
        return {section.title: section.rows for section in self.description}

    @property
    def description(self) -> Description:
        """Description of the table: content, errors, and an example of a call."""
        axes = dict(zip((*self.names, *NAMES), self.law.axes, strict=True))
        return describe_table(axes, self.about, self.apart, self.whole, self.contact)

    @property
    def nodes(self) -> int:
        """Number of nodes."""
        return int(np.prod([len(nodes) for nodes in self.law.axes]))

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
        **further: ArrayLike | None,
    ) -> Forces:
        """Return the forces of contacts; all arguments broadcast.

        Parameters
        ----------
        xi_x, xi_y, spin : array_like
            Creepages, and spin in 1/mm; one of the three may be infinite: full slip.
        a, b : array_like
            Semi-axes in rolling and in lateral direction, mm. Required, as the next three, except
            for the table of one scene, which contains all five.
        load : array_like
            Normal load, N; 0 of separated bodies, which have no forces and gradients.
        mu : array_like
            Coefficient of friction, along the axis e1 if friction is orthotropic.
        shear : array_like
            Combined shear modulus G, 2/G = 1/G_A + 1/G_B, MPa.
        **further : array_like
            Poisson's ratio, ``poisson``, and further axes by their names; required for axes with
            several values.

        Raises
        ------
        ValueError
            If a creepage is nan, a property of the contact is not positive and finite, an axis is
            missing or unknown, or a value is outside the table.
        """
        contact = self._contact({"a": a, "b": b, "load": load, "mu": mu, "shear": shear})
        along = self._along(further)
        numbers = (xi_x, xi_y, spin, *contact, *along.values())
        arguments = numbers, tuple(along)
        if all(isinstance(value, float | int) for value in numbers):
            point = self.single_point.locate(numbers[:3], numbers[3:8], along)
            if point is not None:
                Qx, Qy, Mz = map(np.float64, self.single_point.forces(point))
                return Forces(Qx, Qy, Mz, self, arguments, point)
        scaled = self.scale(*arguments)
        points, coordinates, _, unit, shape = scaled
        Qx, Qy, Mz = (unit * coordinates.signs * self.law(points)).reshape(3, *shape)
        forces = Forces(Qx, Qy, Mz, self, arguments)
        forces.__dict__["_at"] = scaled
        return forces

    @cached_property
    def single_point(self) -> SinglePointLaw:
        """Evaluation at single points."""
        return SinglePointLaw(self.law, self.names, self.apart, self.whole)

    def scale(self, numbers: tuple[ArrayLike, ...], along: tuple[str, ...]) -> Scaled:
        """Return the points of `law` for contacts, and the units of their forces.

        Parameters
        ----------
        numbers : tuple of array_like
            xi_x, xi_y, spin, a, b, load, mu, shear, and the values on the axes `along`.
        along : tuple of str
            Axes except a/b and creepages.

        Raises
        ------
        ValueError
            See `__call__`.
        """
        arrays = [np.asarray(values, float) for values in numbers]
        shape = np.broadcast_shapes(*(values.shape for values in arrays))
        flat = np.empty((len(arrays), int(np.prod(shape))))
        for row, values in zip(flat, arrays, strict=True):
            row.reshape(shape)[...] = values
        is_open = flat[5] == 0.0
        if is_open.any():  # the contact does not matter: its forces are multiplied by 0
            middle = np.sqrt(np.prod(self.ellipticity))
            flat[:3, is_open] = 0.0
            flat[3:8, is_open] = np.array([[middle], [1.0], [1.0], [1.0], [1.0]])
        creepages, (a_, b_, load_, mu_, shear_) = flat[:3], flat[3:8]
        if not ((flat[3:8] > 0.0) & np.isfinite(flat[3:8])).all():
            is_valid = ((flat[3:8] > 0.0) & np.isfinite(flat[3:8])).all(axis=1)
            name = CONTACT[int(is_valid.argmin())]
            allowed = "0 or positive" if name == "load" else "positive"
            raise ValueError(f"{name}: a value is not allowed; allowed: finite numbers, {allowed}")
        ratio = a_ / b_
        points = dict(zip(along, flat[8:], strict=True))
        if self.contact is None:
            points = {RATIO: np.log(ratio)} | points
        for name, nodes in zip(self.names, self.law.axes, strict=False):
            self._check_inside(name, points[name], nodes)
        c, bound = np.sqrt(a_ * b_), mu_ * load_
        unit = np.array([bound, bound, bound * c]) * ~is_open
        by_load = shear_ * (c * c) / bound
        by_creepage = np.array([by_load, by_load, by_load * c])
        coordinates = Coordinates.of(creepages * by_creepage, ratio, self.whole)
        at = (*(points[name] for name in self.names), *coordinates.points)
        return Scaled(at, coordinates, by_creepage, unit, shape)

    def _contact(self, properties: dict[str, Any]) -> list[Any]:
        """Return a, b, load, mu and shear, given or of the scene of the table."""
        for name, value in properties.items():
            if self.contact is None and value is None:
                raise ValueError(f"{name}: missing; a table of any contact needs it")
            if self.contact is not None and value is not None:
                raise ValueError(f"{name}: fixed by the scene of the table; remove the argument")
        return [*(properties if self.contact is None else self.contact).values()]

    def _along(self, further: dict[str, Any]) -> dict[str, Any]:
        """Return the values on all axes except a/b and creepages."""
        axes = {k: v for k, v in zip(self.names, self.law.axes, strict=False) if k != RATIO}
        for name in further:
            if name not in axes:
                allowed = ", ".join(axes) or "none"
                raise ValueError(f"{name}: no axis of the table; its axes: {allowed}")
        values = {}
        for name, nodes in axes.items():
            values[name] = further.get(name)
            if values[name] is None:
                if len(nodes) > 1:
                    low, high = nodes[0], nodes[-1]
                    raise ValueError(f"{name}: missing; allowed: {low:g} to {high:g}")
                values[name] = nodes[0]
        return values

    @property
    def ellipticity(self) -> tuple[float, float]:
        """Smallest and largest a/b."""
        if self.contact is not None:
            return (self.contact["a"] / self.contact["b"],) * 2
        low, high = np.exp(self.law.axes[0][[0, -1]])
        return float(low), float(high)

    def axis(self, name: str) -> np.ndarray:
        """Return the nodes along one of the axes `names`."""
        return self.law.axes[self.names.index(name)]

    def _check_inside(self, name: str, values: np.ndarray, nodes: np.ndarray) -> None:
        """Raise a ValueError for values outside an axis, or between nodes without interpolation."""
        if name in self.apart:
            distance = np.abs(values[:, None] - nodes).min(axis=1, initial=np.inf)
            if not (distance <= MARGIN * (1.0 + np.abs(values))).all():
                allowed = ", ".join(f"{node:g}" for node in nodes)
                raise ValueError(f"{name}: between the nodes of the table; allowed: {allowed}")
            return
        inside = (values >= nodes[0] - MARGIN) & (values <= nodes[-1] + MARGIN)
        if not inside.all():
            numbers = np.array([nodes[0], nodes[-1], values[~inside][0]])
            if name == RATIO:
                name, numbers = "a/b", np.exp(numbers)
            low, high, value = (float(number) for number in numbers)
            raise ValueError(f"{name}: {value:.6g}; allowed: {low:.6g} to {high:.6g}")

    def error_at(self, points) -> np.ndarray:
        """Return error bars over mu P, of the moment over mu P c, at points of `law`, shape (3, P).

        They are the largest bar of the corners of the cell plus the interpolation errors.
        """
        cells = [cell_of(nodes, x) for nodes, x in zip(self.law.axes, points, strict=True)]
        bars = self._bar_of_cell[tuple(cells)].T.copy()
        for cell, errors in zip(cells, self.between, strict=True):
            if len(errors):
                bars += errors[cell].T
        return bars

    def gradient_at(self, points, coordinates: Coordinates) -> np.ndarray:
        """Return the derivatives of scaled forces by scaled creepages, shape (3, 3, P).

        Parameters
        ----------
        points : sequence of ndarray, shape (P,)
            Points of `law`: positions on the axes `names`, heading, tilt and u.
        coordinates : Coordinates
            Coordinates of the scaled creepages.
        """
        first = len(points) - len(NAMES)
        shifted = (*points[:first], *coordinates.points_of_slopes)
        by = self.law.parts(shifted, range(first, len(points)))
        # by (coordinate, force, P) times (coordinate, creepage, P)
        return np.einsum("kfp,kcp->fcp", by, coordinates.by_creepages) * coordinates.signs[:, None]

    def slopes_at_rest(self, points, r0: np.ndarray) -> np.ndarray:
        """Return the slopes at rest of each scaled force by its creepage, shape (3, P).

        The points give the position on the axes `names`; r0 is `unit_radius` there.

        Parameters
        ----------
        points : sequence of ndarray, shape (P,)
            Points of `law`; only the positions on the axes `names` count.
        r0 : ndarray, shape (P,)
            `unit_radius` there.
        """
        first, none = len(points) - len(NAMES), np.zeros_like(r0)
        right = np.full_like(r0, 0.5 * np.pi)
        directions = ((none, none), (right, none), (none, right))
        by_u = [
            self.law((*points[:first], *direction, none), len(points) - 1)[k]
            for k, direction in enumerate(directions)
        ]
        return np.abs(by_u) / r0 * np.array([[1.0], [1.0], [SPIN]])

    def gradient_error_at(self, points, coordinates: Coordinates) -> np.ndarray:
        """Return error bars of `gradient_at`, (3, 3, P); zero in full slip, nan if unknown.

        Parameters
        ----------
        points, coordinates
            As for `gradient_at`.
        """
        nodes, u = self.law.axes[-1], points[-1]
        if self.gradient_bars is None:
            return np.full((3, 3, len(u)), np.nan)
        cell = cell_of(nodes, u)
        bars = share_of_bar(nodes, u)[:, None, None] * self.gradient_bars[1 + cell]
        bars[cell == 0] += self.gradient_bars[0]
        size = np.sqrt(self.slopes_at_rest(points, coordinates.r0))
        error = np.moveaxis(bars, 0, -1) * size[:, None] * size
        return np.where(coordinates.full, 0.0, error)

    @cached_property
    def _bar_of_cell(self) -> np.ndarray:
        """Largest error bar of the corners of each cell."""
        bars = self.bars
        for k in range(bars.ndim - 1):
            if bars.shape[k] > 1:
                ends = [
                    np.take(bars, range(*span), axis=k)
                    for span in ((0, bars.shape[k] - 1), (1, bars.shape[k]))
                ]
                bars = np.maximum(*ends)
        return bars


def share_of_bar(nodes: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Return the share of the gradient error bar of an interval at u, shape (P,).

    It increases from 0 at rest, which has a separate bar, to 1 at a third of the first interval,
    and decreases to 0 in the last interval, as gradients towards full slip.

    Parameters
    ----------
    nodes : ndarray, shape (n_u,)
        Nodes along u.
    u : ndarray, shape (P,)
        Values of u.
    """
    cell = cell_of(nodes, u)
    t = (u - nodes[cell]) / (nodes[cell + 1] - nodes[cell])
    share = np.where(cell == 0, np.minimum(3.0 * t, 1.0), 1.0)
    return np.where(cell == len(nodes) - 2, 1.0 - t, share)


COLUMNS = ("w1", "w2", "w3", "qx", "qy", "mz", "bar_qx", "bar_qy", "bar_mz", "full")
"""Columns after the columns of the axes other than creepages."""


def columns_of(table: CreepTable) -> str:
    """Return the nodes of a table as text, one per line, the last creepage coordinate fastest.

    Lines that begin with # describe the scaling. The columns are a/b, Poisson's ratio and further
    axes, and `COLUMNS`: scaled creepages G c² / (mu P) (xi_x, xi_y, c spin), forces
    (Q_x, Q_y, M_z / c) / (mu P) and their error bars. In full slip the creepages are infinite, the
    columns give their direction, and ``full`` is 1, else 0.
    """
    names = ["a/b" if name == RATIO else name for name in table.names]
    lines = [
        "# creep forces, by tractive_sam",
        "# w = G c^2 / (mu P) (xi_x, xi_y, c spin), c = sqrt(a b); q = (Qx, Qy, Mz/c) / (mu P)",
        "# all headings and tilts"
        if table.whole
        else "# (w1, -w2, -w3) gives (qx, -qy, -mz); (-w1, w2, w3) gives (-qx, qy, mz)",
        "# full = 1: full slip, (w1, w2, w3) is the direction of infinite creepages",
    ]
    if table.contact is not None:
        lines.append(
            "# " + ", ".join(f"{key} = {value:.9g}" for key, value in table.contact.items())
        )
    lines.append("# " + " ".join((*names, *COLUMNS)))
    axes, values = table.law.axes, table.law.coefficients[..., 0, :]
    for place in np.ndindex(values.shape[:-1]):
        point = [float(x[k]) for x, k in zip(axes, place, strict=True)]
        *along, heading, tilt, u = point
        ratio = table.ellipticity[0] if table.contact is not None else math.exp(along[0])
        if table.contact is None:
            along[0] = ratio
        w = creepages_at(ratio, heading, tilt, u) if u else np.zeros(3)
        numbers = (*along, *w, *values[place], *table.bars[place])
        lines.append(" ".join(f"{number:.9g}" for number in numbers) + f" {int(u == 1.0)}")
    return "\n".join(lines) + "\n"
