"""The dimensionless operators of one contact problem.

With a unit of pressure p*, of gap g* and of slip s* (of half-spaces p* l / E* and
max(mu1, mu2)² p* / G), and with the tractions in the scaled tribological frame, p~ = M^-1 R p_t and
s~ = M R s, every quantity that a solver meets is of order one and both penalty-like factors of the
contact conditions are unity:

    gap   eta   = h/g* - delta/g* + A_nn pi_n + A_nt pi_t,    pi_n = max(0, pi_n - eta)
    slip  sigma = s~_rigid/s*     + D_tn pi_n + D_tt pi_t,    pi_t = disc(pi_t - sigma; pi_n)

Isotropic friction drops out of D_tt altogether. The scaled frame turns orthotropic friction into
isotropic friction of unit coefficient.

Every operator is made from periodic tables of influence coefficients. Names follow the grammar
``displacement_xz``: u_x from p_z. A table holds the coefficient of the offset (i, j) elements at
index (i mod p_x, j mod p_y). The offsets that a linear convolution never reads are filled with true
coefficients as well: the operators do not notice, but the circulant inverses used as
preconditioners do. With zeros there, the preconditioned slip operator has a condition number of 121
instead of 5 on the scene `spheres` at 45 x 45.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache, partial, reduce
from math import prod
from typing import Any, Literal

import numpy as np

from tractive_sam.compute import (
    Array,
    Convolution,
    Mirror,
    MirroredConvolution,
    backend_of,
    fast_length,
    padded_length,
)
from tractive_sam.kernels.linear_algebra import row_products
from tractive_sam.mechanics import PARITIES, Elasticity, Frame
from tractive_sam.operators.zone_inverse import ZoneInverse

Box = tuple[slice, slice]
"""Rectangle of elements."""


@dataclass(frozen=True)
class Lattice:
    """Shape (n_x, n_y) and side lengths of elements; the mesh data that operators need.

    Attributes
    ----------
    shape : tuple of int
        Number of elements (n_x, n_y).
    dx, dy : float
        Side lengths of an element, mm.
    reach : float
        Part of the mesh up to which convolutions are linear; elements at larger distances also act
        on their periodic images.
    mirror : Mirror, optional
        Symmetry of all fields; the lattice then has their upper half.
    first : float
        Position y of the middle of the first row, mm; used for bodies with ends only.
    """

    shape: tuple[int, int]
    dx: float
    dy: float
    reach: float = 1.0
    mirror: Mirror | None = None
    first: float = 0.0

    def with_shape(self, shape: tuple[int, int]) -> "Lattice":
        """Return a lattice with these element sizes and another number of elements."""
        return replace(self, shape=shape)

    @property
    def padded(self) -> tuple[int, int]:
        """Periods (p_x, p_y) of the operators' tables, for linear convolutions."""
        nx, ny = self.whole
        return padded_length(nx, self.reach, columns=True), padded_length(ny, self.reach)

    @property
    def cyclic(self) -> tuple[int, int]:
        """Periods (p_x, p_y) of the tables of circulant inverses, without zero padding.

        That loads also act across its edges costs a method none or one iteration more; without
        padding an inverse takes a third of the time.
        """
        nx, ny = self.whole
        return fast_length(nx, columns=True), fast_length(ny)

    @property
    def whole(self) -> tuple[int, int]:
        """Shape of the lattice with its lower half, if it has the upper half only."""
        nx, ny = self.shape
        return nx, self.mirror.whole(ny) if self.mirror else ny

    @property
    def first_share(self) -> float:
        """Share of the first row in sums: 1/2 if the axis of symmetry halves its elements."""
        return 0.5 if self.mirror is not None and not self.mirror.between else 1.0

    def sum(self, field: Array) -> float:
        """Return the sum of a field; elements that the axis of symmetry halves count half."""
        total = backend_of(field).sum
        halved = total(field[..., 0]) if self.first_share < 1.0 else 0.0
        return float(total(field) - 0.5 * halved)

    def dot(self, first: Array, second: Array) -> float:
        """Return the scalar product of two fields, in which operators are symmetric; see `sum`."""
        dot = backend_of(first).dot
        halved = dot(first[..., 0], second[..., 0]) if self.first_share < 1.0 else 0.0
        return dot(first, second) - 0.5 * halved

    @property
    def coarsening(self) -> tuple[int, int]:
        """Elements (x, y) that one element of the next coarser lattice covers: 2, or 1 of a row."""
        return min(2, self.shape[0]), min(2, self.shape[1])

    def coarsened(self) -> "Lattice":
        """Return a lattice that covers this one with elements of twice the side (`coarsening`).

        An axis of symmetry lies between its elements.
        """
        (nx, ny), (bx, by) = self.shape, self.coarsening
        mirror = self.mirror and Mirror(self.mirror.even, between=True)
        return Lattice((-(-nx // bx), -(-ny // by)), bx * self.dx, by * self.dy, mirror=mirror)

    def clear_axis(self, field: np.ndarray) -> np.ndarray:
        """Set the odd component of a field (2, n_x, n_y) to zero, in place, on an axis on a row."""
        if self.mirror is not None and not self.mirror.between:
            field[1 - self.mirror.even, :, 0] = 0.0
        return field

    def merge(self, values: np.ndarray, mode: Literal["constant", "edge"] = "edge") -> np.ndarray:
        """Return means over the elements of the coarsened lattice, last two axes.

        Parameters
        ----------
        values : ndarray, shape (..., n_x or 1, n_y or 1)
            Values of elements, or of their rows or columns.
        mode : str
            Values beyond the lattice: zero, or those at its end.
        """
        if self.first_share < 1.0 and values.shape[-1] > 1:  # elements begin at the axis
            end = values[..., -1:] if mode == "edge" else np.zeros_like(values[..., -1:])
            values = 0.5 * (values + np.concatenate((values[..., 1:], end), axis=-1))
        nx, ny = values.shape[-2:]
        return block_mean(values, (min(2, nx), min(2, ny)), mode)


def unfold(values: np.ndarray, parity: int, period: int) -> np.ndarray:
    """Extend values at offsets >= 0 (last axis) to a period, evenly or oddly (parity 1 or -1)."""
    half = period // 2
    mirrored = parity * values[..., half - 1 : 0 : -1]
    return np.concatenate((values[..., : half + 1], mirrored), axis=-1)


def transform_quadrants(
    tables: Sequence[tuple[np.ndarray, tuple[int, int]]],
    period: tuple[int, int],
    difference: bool = False,
) -> np.ndarray:
    """Return the spectrum of a sum of periodic tables from their entries at offsets >= 0.

    Only these are transformed along y. If the tables have one parity in y, only half of the result
    is transformed along x.

    Parameters
    ----------
    tables : sequence of (ndarray, (int, int))
        Entries at offsets >= 0, shape (p_x/2 + 1 or more, p_y/2 + 1 or more), for a difference one
        more in x; and 1 if the table is even in x (in y), -1 if it is odd.
    period : tuple of int
        (p_x, p_y), even.
    difference : bool
        Whether to transform the sum less the same sum one element ahead in x.

    Returns
    -------
    ndarray of complex, shape (p_x, p_y/2 + 1)
    """
    # Of real values, the transform is real if they are even, i times real if they are odd; its
    # other half is the complex conjugate.
    half, across = period[0] // 2, {even_y for _, (_, even_y) in tables}
    along: dict[int, list[np.ndarray]] = {}
    for table, (even_x, even_y) in tables:
        unfolded = unfold(table[: half + 2], even_y, period[1])
        if len(across) > 1 and even_y < 0:  # at half a period an odd function is zero
            unfolded[:, period[1] // 2] = 0.0
        along.setdefault(even_x, []).append(unfolded)
    rows = {}
    for even_x, alike in along.items():
        waves: Any = np.fft.rfft(reduce(np.add, alike))
        if len(across) == 1:
            waves = waves.real if 1 in across else waves.imag
        rows[even_x] = waves.T
    values = reduce(np.add, (unfold(row, even_x, period[0]) for even_x, row in rows.items()))
    if difference:
        # Not periodic: beyond half a period, the next entry is that of the table.
        ahead = np.roll(values, -1, axis=1)
        ahead[:, half] = reduce(np.add, (row[:, half + 1] for row in rows.values()))
        values = values - ahead
    if len(across) > 1:
        return np.fft.fft(values).T
    columns = np.fft.rfft(values)
    spectrum = np.concatenate((columns, columns[:, half - 1 : 0 : -1].conj()), axis=1).T
    return spectrum if 1 in across else 1j * spectrum


def transform_displacement(
    lattice: Lattice,
    elasticity: Elasticity,
    component: str,
    period: tuple[int, int] | None = None,
    difference: bool = False,
    symmetry: int = 0,
) -> np.ndarray:
    """Return the spectrum of the displacement u_A - u_B per unit traction on an element.

    The difference of the displacements at the centres on both sides of the leading face of an
    element, over dx, is its slip -du/dx. It is taken of the coefficients, so that an evaluation of
    the slip is a single convolution.

    Parameters
    ----------
    lattice : Lattice
        The elements.
    elasticity : Elasticity
        The bodies.
    component : str
        One of `mechanics.elasticity.PARITIES`, or its reverse.
    period : tuple of int, optional
        (p_x, p_y), no longer than `Lattice.padded`, which it is by default.
    difference : bool
        Whether to return the spectrum of the displacement less that of the element ahead.
    symmetry : int
        1 (-1): only the part that is equal (opposite) at opposite offsets.

    Returns
    -------
    ndarray of complex, shape (p_x, p_y/2 + 1)
        mm/MPa, divided by p_x p_y; it must not be changed.
    """
    padded, sides = lattice.padded, (lattice.dx, lattice.dy)
    # At most 64 MiB are stored.
    store = _may_be_stored(lattice, elasticity, 2**17)
    transform = _stored_transform if store else _transform_tables
    known = component if component in PARITIES else component[::-1]
    # By reciprocity, a reverse component is the same at the opposite offset.
    main = prod(PARITIES[known])
    sign = -1.0 if known != component and main < 0 else 1.0
    parts = tuple(
        (part, parity, 1.0 if known == component or prod(parity) == main else -1.0)
        for part, parity in elasticity.parts(known).items()
        if symmetry in (0, prod(parity))
    )
    return sign * transform(elasticity, padded, sides, parts, period or padded, difference)


def _may_be_stored(lattice: Lattice, elasticity: Elasticity, largest: int) -> bool:
    """Return whether other scenes may have the same bodies on this mesh of few padded elements."""
    return prod(lattice.padded) <= largest and vars(type(elasticity)).get("shared", False)


def _transform_tables(
    elasticity: Elasticity,
    padded: tuple[int, int],
    sides: tuple[float, float],
    parts: tuple[tuple[str, tuple[int, int], float], ...],
    period: tuple[int, int],
    difference: bool,
) -> np.ndarray:
    """Return the spectrum of parts of displacements, by name, parity and sign, on elements."""
    offsets = padded[0] // 2 + 1 + difference, padded[1] // 2 + 1
    spectra, tables, scale = list[np.ndarray](), [], period[0] * period[1]
    for part, parity, sign in parts:
        if period != padded and not difference:
            spectrum = elasticity.periodic(part, period, *sides)
            if spectrum is not None:
                spectra.append(spectrum / (sign * scale))
                continue
        table = elasticity.coefficients(part, offsets, *sides)
        tables.append((table / (sign * scale), parity))
        if not elasticity.symmetric:
            lag = elasticity.lag(part, offsets, *sides)
            tables.append((lag / (sign * scale), (-parity[0], parity[1])))
    if tables:
        spectra.append(transform_quadrants(tables, period, difference))
    return reduce(np.add, spectra)


_stored_transform = lru_cache(64)(_transform_tables)


def block_mean(
    values: np.ndarray, block: tuple[int, int], mode: Literal["constant", "edge"]
) -> np.ndarray:
    """Return means over blocks of elements (last two axes); `mode` pads incomplete blocks."""
    (bx, by), v = block, values
    for axis, size in ((-2, bx), (-1, by)):
        if missing := -v.shape[axis] % size:
            last = v.take([-1] * missing, axis)
            v = np.concatenate((v, last if mode == "edge" else np.zeros_like(last)), axis)
    parts = [v[..., i::bx, j::by] for i in range(bx) for j in range(by)]
    total: np.ndarray = sum(parts[1:], start=parts[0])
    return total / len(parts)


Entries = tuple[float, float, float]
"""Entries (11, 12, 22) of a symmetric matrix."""


class Operators:
    """Dimensionless elastic operators of two bodies on a mesh; each is computed when first used.

    Parameters
    ----------
    lattice : Lattice
        Elements; lengths in mm.
    elasticity : Elasticity
        The bodies.
    gap, slip : float
        Units of gap and of slip over the unit of pressure, g*/p*, mm/MPa, and s*/p*, 1/MPa.
    frame : Frame
        Scaled tribological frame.
    ends : EndResponse, optional
        What ends of the bodies add (`Elasticity.ends_on`).
    """

    def __init__(
        self,
        lattice: Lattice,
        elasticity: Elasticity,
        gap: float,
        slip: float,
        frame: Frame | None = None,
        ends: Any = None,
    ):
        self.lattice = lattice
        self.elasticity = elasticity
        # Displacement over an element's length is in units of slip.
        self._per_gap, self._per_dx = 1.0 / gap, 1.0 / (slip * lattice.dx)
        self._units = gap, slip
        self._displacement = partial(transform_displacement, lattice, elasticity)
        self.frame, self.ends = frame or Frame(), ends

    def on(self, lattice: Lattice, ends: Any = None) -> "Operators":
        """Return the operators of these bodies and units on another lattice."""
        return Operators(lattice, self.elasticity, *self._units, self.frame, ends)

    @cached_property
    def coarsened(self) -> "Operators":
        """Operators of these bodies and units on elements of twice the size."""
        coarse = self.lattice.coarsened()
        ends = self.ends and self.ends.coarsened(coarse.shape, self.lattice.coarsening)
        return self.on(coarse, ends)

    @cached_property
    def approximate(self) -> "Operators":
        """Operators in which elements far from each other also act on their periodic images.

        A convolution takes about half the time. It differs for offsets above 0.7 of the sides
        of the mesh, where kernels are small and smooth. A reach of 0.35 takes more iterations. The
        memory of bodies that relax may be longer than the mesh: theirs are the operators.
        """
        if not self.elasticity.symmetric:
            return self
        return self.on(replace(self.lattice, reach=0.4), self.ends)

    @cached_property
    def keep_symmetry(self) -> bool:
        """Whether the slip and gap by a traction that is symmetric in y are so, too (`Mirror`)."""
        (_, first), (second, _) = self.frame.matrix
        parts = map(self.elasticity.parts, ("xx", "xy", "yy", "zz"))
        # Crystals may lack symmetry about the axes.
        return not (first or second or self.elasticity.coupled or max(map(len, parts)) > 1)

    @cached_property
    def part(self) -> Callable[..., "Operators"]:
        """Function that returns the operators on a lattice of another shape (n_x, n_y).

        With a `Mirror` as second argument they apply to the upper half of symmetric fields. Ends of
        bodies need the first row as well.
        """
        # Without a reference to these operators: a cache of theirs would hold itself.
        lattice, bodies = self.lattice, (self.elasticity, *self._units, self.frame)
        whole = self.ends

        @lru_cache(8)
        def stored(shape: tuple[int, int], mirror: Mirror | None, first: int) -> Operators:
            ends = None
            if whole is not None:
                folds = mirror is not None and lattice.mirror is None
                folded = lattice.shape[1] - 1 if folds else None
                ends = whole.part(shape[0], slice(first, first + shape[1]), folded)
            return Operators(replace(lattice, shape=shape, mirror=mirror), *bodies, ends)

        def on_part(
            shape: tuple[int, int], mirror: Mirror | None = lattice.mirror, first: int | None = 0
        ) -> Operators:
            return stored(shape, mirror, 0 if whole is None else first or 0)

        return on_part

    def _normal_spectrum(self, period: tuple[int, int] | None = None) -> np.ndarray:
        """Return the spectrum of A_nn, gap per pressure, dimensionless; real if symmetric."""
        spectrum = self._per_gap * self._displacement("zz", period)
        return spectrum.real if self.elasticity.symmetric else spectrum

    @cached_property
    def along_x(self) -> np.ndarray:
        """Spectrum along x of normal displacement, mm/MPa, (p_y, p_x/2 + 1), weighted for sums."""
        px, py = self.lattice.padded
        # Even in x: a real spectrum. Parseval over its half: inner frequencies count twice.
        sides = self.lattice.dx, self.lattice.dy
        table = self.elasticity.coefficients("zz", (px // 2 + 1, py // 2 + 1), *sides)
        along = np.fft.rfft(unfold(table.T, 1, px)).real / px
        along[:, 1:-1] *= 2.0
        return np.ascontiguousarray(unfold(along.T, 1, py).T)

    def _tangential_spectra(
        self, period: tuple[int, int] | None = None, difference: bool = False
    ) -> np.ndarray:
        """Return the spectra (11, 12, 22) of A_tt / dx, or of its difference in x, D_tt.

        They are those of the symmetric part of the matrix.
        """
        entries = [self._displacement(k, period, difference, 1) for k in ("xx", "xy", "yy")]
        if not difference and self.elasticity.symmetric:  # even, and so real
            entries = [entry.real for entry in entries]
        return self._per_dx * np.stack(self._tangential(*entries))

    def _tangential_matrix(self, difference: bool) -> list[np.ndarray]:
        """Return the spectra (11, 12, 21, 22) of A_tt / dx, or of its difference in x, D_tt."""
        first, mixed, second = self._tangential_spectra(None, difference)
        if self.elasticity.interchangeable:
            return [first, mixed, mixed, second]
        # A rotation does not change the part with opposite signs.
        unlike = self._displacement("xy", None, difference, -1)
        unlike = self._per_dx * np.linalg.det(self.frame.matrix) * unlike
        return [first, mixed + unlike, mixed - unlike, second]

    def _between_tractions(self, difference: bool) -> Convolution:
        """Return the operator A_tt / dx, or its difference in x, D_tt."""
        if self.elasticity.interchangeable:
            return self._convolution(self._tangential_spectra(difference=difference))
        lattice, matrix = self.lattice, self._tangential_matrix(difference)
        return _FourKernels(np.stack(matrix), lattice.shape, lattice.padded)

    def _convolution(self, spectra: Sequence[np.ndarray] | np.ndarray) -> Convolution:
        """Return the zero-padded convolution on the lattice with spectra of kernels."""
        return self._periodic(np.ascontiguousarray(spectra), self.lattice.padded)

    def _periodic(self, spectra: np.ndarray, period: tuple[int, int]) -> Convolution:
        """Return the convolution on the lattice with spectra of a period."""
        shape, mirror = self.lattice.shape, self.lattice.mirror
        if mirror is None:
            return Convolution(spectra, shape, period)
        return MirroredConvolution(spectra, shape, period, mirror)

    def _inverse(self, *spectra: np.ndarray) -> Convolution:
        """Return the cyclic convolution with inverted spectra, a preconditioner."""
        period = self.lattice.cyclic
        return self._periodic(np.stack(spectra) / np.prod(period) ** 2, period)

    def _tangential(self, xx, xy, yy):
        """Rotate and scale entries to the frame: (11, 12, 22) of F [[xx, xy], [xy, yy]] F^T."""
        (a, b), (c, d) = self.frame.matrix
        if (a, b, c, d) == (1.0, 0.0, 0.0, 1.0):  # isotropic friction
            return xx, xy, yy
        return (
            a * a * xx + 2.0 * a * b * xy + b * b * yy,
            a * c * xx + (a * d + b * c) * xy + b * d * yy,
            c * c * xx + 2.0 * c * d * xy + d * d * yy,
        )

    @cached_property
    def normal(self) -> Convolution:
        """Operator A_nn from pressure to normal displacement, dimensionless."""
        return self._near_ends(self._convolution([self._normal_spectrum()]))

    @cached_property
    def normal_inverse(self) -> Convolution:
        """Approximate (circulant) inverse of `normal`, used as a preconditioner."""
        return self._inverse(1.0 / self._normal_spectrum(self.lattice.cyclic))

    @cached_property
    def slip(self) -> Convolution:
        """Operator D_tt from tangential tractions to slip at the leading faces of the elements."""
        return self._between_tractions(difference=True)

    @cached_property
    def self_influence(self) -> Entries:
        """Slip at an element due to its own traction: entries (11, 12, 22) of D_tt."""
        return self._entries_at(np.array([1.0, -1.0]))

    @cached_property
    def self_displacement(self) -> Entries:
        """Displacement of an element due to its own traction: entries (11, 12, 22) of A_tt / dx."""
        return self._entries_at(np.array([1.0, 0.0]))

    def _entries_at(self, weights: np.ndarray) -> Entries:
        """Return entries (11, 12, 22) of A_tt / dx, a weighted sum of an element and the next."""
        sides = self.lattice.dx, self.lattice.dy
        at, parts = self.elasticity.coefficients, self.elasticity.parts

        offsets = 2, 1
        if not self.elasticity.symmetric:  # those of `slip`, which are stored
            offsets = self.lattice.padded[0] // 2 + 2, self.lattice.padded[1] // 2 + 1

        def of_offsets(component: str) -> np.ndarray:
            tables = [at(k, offsets, *sides) for k, (x, y) in parts(component).items() if x * y > 0]
            if not self.elasticity.symmetric:
                tables.append(self.elasticity.lag(component, offsets, *sides))
            return weights @ sum(table[:2, 0] for table in tables)

        entries = self._tangential(*map(of_offsets, ("xx", "xy", "yy")))
        first, mixed, second = (float(self._per_dx * entry) for entry in entries)
        return first, mixed, second

    @cached_property
    def ripple_compliance(self) -> float:
        """Dimensionless normal displacement by a unit pressure alternating between elements."""
        first, second = (_alternating(n) for n in self.lattice.shape)
        signs = np.outer(first, second)
        response = self.on(self.lattice.with_shape(signs.shape)).normal(signs[None])[0]
        i, j = first.size // 2, second.size // 2
        return float(signs[i, j] * response[i, j])

    @property
    def layer_slip(self) -> np.ndarray | None:
        """Slip of an interfacial layer per traction gained over an element, (2, 2), or None."""
        layer, F = self.elasticity.layer, self.frame.matrix
        return self._per_dx * layer * F @ F.T if layer else None

    def opening(self, angle: np.ndarray) -> np.ndarray:
        """Return the slip per unit of closing gap at edges with these angles, (m, 2, 2 or 3).

        Parameters
        ----------
        angle : ndarray, shape (m,)
            Angles of the edges (`operators.stencil.edge_angles`).
        """
        per_gap, F = self._per_dx / self._per_gap, self.frame.matrix
        normal = np.stack((np.cos(angle), np.sin(angle)))
        opening = self.elasticity.opening(normal, self.lattice.dx, self.lattice.dy)
        by_traction = per_gap * F @ opening[:, :, :2] @ F.T
        if opening.shape[2] == 2:
            return by_traction
        return np.concatenate((by_traction, per_gap * F @ opening[:, :, 2:]), axis=2)

    @cached_property
    def tangential(self) -> Convolution:
        """Operator A_tt / dx from tractions to tangential displacement over dx (units of slip)."""
        return self._between_tractions(difference=False)

    @cached_property
    def tangential_inverse(self) -> Convolution:
        """Approximate (circulant) inverse of `tangential`, used as a preconditioner."""
        a11, a12, a22 = self._tangential_spectra(self.lattice.cyclic)
        determinant = a11 * a22 - a12 * a12
        return self._inverse(a22 / determinant, -a12 / determinant, a11 / determinant)

    @cached_property
    def zone_inverse(self) -> ZoneInverse:
        """Preconditioner of the friction conditions in steady rolling on a large mesh."""
        period, (first, _, second) = self.lattice.cyclic, self.self_influence
        spectra = prod(period) * self._tangential_spectra(period)
        inverse, convolution = self.tangential_inverse, partial(self._periodic, period=period)
        return ZoneInverse(spectra, first + second, inverse, convolution)

    @cached_property
    def coupled(self) -> Convolution:
        """Operator from pressure and tractions to (gap, slip), including A_nt and D_tn."""
        return self._with_pressure(difference=True)

    @cached_property
    def coupled_displacement(self) -> Convolution:
        """Operator from pressure and tractions to (gap, tangential displacement over dx)."""
        return self._with_pressure(difference=False)

    @cached_property
    def slip_by_pressure(self) -> Callable[[Array], Array]:
        """Operator D_tn from pressure (n_x, n_y) to slip, (2, n_x, n_y)."""
        return self._by_pressure(difference=True)

    @cached_property
    def displacement_by_pressure(self) -> Callable[[Array], Array]:
        """Operator from pressure to tangential displacement over dx."""
        return self._by_pressure(difference=False)

    def _by_pressure(self, difference: bool) -> Callable[[Array], Array]:
        """Return the operator from pressure to slip, or to displacement over dx."""
        rows = [self._convolution([row + 0j]) for row in self._drag(difference)]

        def apply(pressure: Array) -> Array:
            backend = backend_of(pressure)
            return backend.concat(tuple(row(pressure[None, ...]) for row in rows))

        return apply

    def _drag(self, difference: bool) -> list[np.ndarray]:
        """Return the spectra of slip, or of displacement over dx, by pressure."""
        drag = [self._per_dx * self._displacement(k, None, difference) for k in ("xz", "yz")]
        return [row[0] * drag[0] + row[1] * drag[1] for row in self.frame.matrix]

    def _with_pressure(self, difference: bool) -> Convolution:
        """Return the operator from pressure and tractions to gap and slip, or displacement over dx.

        Parameters
        ----------
        difference : bool
            True for slip, the difference of the displacement over dx from element to element.
        """
        F, (t11, t12, t21, t22) = self.frame.matrix, self._tangential_matrix(difference)
        lift = [self._per_gap * self._displacement(k) for k in ("zx", "zy")]
        lift_1, lift_2 = (row[0] * lift[0] + row[1] * lift[1] for row in F)
        drag_1, drag_2 = self._drag(difference)
        rows = (self._normal_spectrum(), lift_1, lift_2, drag_1, t11, t12, drag_2, t21, t22)
        return self._near_ends(self._convolution([row + 0j for row in rows]))

    def _near_ends(self, bodies: Convolution) -> Convolution:
        """Return the operator of half-spaces, with what ends add to its first field."""
        return bodies if self.ends is None else _NearEnds(bodies, self.ends, self._per_gap)


class _NearEnds(Convolution):
    """Convolution of fields that begin with a pressure, and what ends of the bodies add."""

    def __init__(self, bodies: Convolution, ends: Any, scale: float):
        vars(self).update(vars(bodies))
        self._bodies, self._ends, self._scale = bodies, ends, scale

    def _convolve(self, backend: Any, fields: Array, spectra: Any) -> Array:
        """Return the convolution of fields with spectra, and the displacement by ends."""
        moved = self._bodies._convolve(backend, fields, spectra)
        added = self._scale * self._ends(backend.to_numpy(fields[0, ...]))
        moved[0, ...] += backend.xp.asarray(added, dtype=moved.dtype)
        return moved


_stored_operators = lru_cache(4)(Operators)


def operators_of(
    lattice: Lattice, elasticity: Elasticity, gap: float, slip: float, frame: Frame
) -> Operators:
    """Return `Operators`; many contacts of the same bodies on a small mesh share them."""
    # Four with all that they compute take up to 80 MiB.
    stored = _may_be_stored(lattice, elasticity, 2**16)
    ends = elasticity.ends_on(lattice.shape, lattice.dx, lattice.dy, lattice.first)
    parts = lattice, elasticity, gap, slip, frame
    return _stored_operators(*parts) if stored else Operators(*parts, ends)


class _FourKernels(Convolution):
    """Convolution of two fields with a matrix of kernels that is not symmetric (11, 12, 21, 22).

    It is that of three fields; the first is zero.
    """

    def __init__(self, spectra: np.ndarray, shape: tuple[int, int], padded: tuple[int, int]):
        rows = np.zeros((9, *spectra.shape[1:]), complex)
        rows[[4, 5, 7, 8]] = spectra
        super().__init__(rows, shape, padded)
        self.shape = (2, *shape)

    def _convolve(self, backend: Any, fields: Array, spectra: Any) -> Array:
        """Return the convolution of two fields with spectra in the form of a backend."""
        fields = backend.concat((backend.xp.zeros_like(fields[:1, ...]), fields))
        return super()._convolve(backend, fields, spectra)[1:, ...]


def _alternating(elements: int, ripples: int = 15) -> np.ndarray:
    """Return 15 weights of alternating sign, half at both ends; [1] for a mesh of one element."""
    if elements == 1:
        return np.ones(1)
    signs = (-1.0) ** np.arange(ripples)
    signs[[0, -1]] *= 0.5
    return signs


def row_compliance(operators: Operators, contact: np.ndarray) -> np.ndarray:
    """Return the matrix of mean normal displacements of rows (elements of one y) by loads on rows.

    A row is what a ring of material meets: all elements of one y. The wear of one row changes the
    pressure of all. The load of a row is spread
    evenly over its elements in contact, and the displacement averaged over them (a Galerkin
    projection of A_nn onto one unknown a row). Spectra along x make it cost no more than one
    application of A_nn a row.

    Parameters
    ----------
    operators : Operators
        Elements and bodies.
    contact : ndarray of bool, shape (n_x, n_y)
        Elements in contact.

    Returns
    -------
    ndarray, shape (m, m)
        For the m rows in contact, ascending in y: mm per MPa summed over the elements of a row.
    """
    rows = np.flatnonzero(contact.any(axis=0))
    share = contact[:, rows] / contact[:, rows].sum(axis=0)
    share = np.ascontiguousarray(np.fft.rfft(share, n=operators.lattice.padded[0], axis=0).T)
    compliance = np.empty((len(rows), len(rows)))
    row_products(compliance, share, operators.along_x, rows)
    return compliance
