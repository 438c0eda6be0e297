"""Periodic tables of influence coefficients, from which every operator is made.

Names follow the grammar ``displacement_xz``: u_x from p_z. A table holds the coefficient of the
offset (i, j) elements at index (i mod p_x, j mod p_y). The offsets that a linear convolution never
reads are filled with true coefficients as well: the operators do not notice, but the circulant
inverses used as preconditioners do. With zeros there, the preconditioned slip operator has a
condition number of 121 instead of 5 on the scene `spheres` at 45 x 45.
"""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from tractive_sam.compute import fast_length, padded_length
from tractive_sam.mechanics import Elasticity

Box = tuple[slice, slice]
"""Rectangle of elements."""

_PARITY = {"xx": (1, 1), "xy": (-1, -1), "yy": (1, 1), "zz": (1, 1), "xz": (-1, 1), "yz": (1, -1)}


@dataclass(frozen=True)
class Lattice:
    """Shape (n_x, n_y) and side lengths of elements; the mesh data that a convolution needs.

    Attributes
    ----------
    shape : tuple of int
        Number of elements (n_x, n_y).
    dx, dy : float
        Side lengths of an element, mm.
    reach : float
        Part of the mesh up to which convolutions are linear; elements at larger distances also act
        on their periodic images.
    """

    shape: tuple[int, int]
    dx: float
    dy: float
    reach: float = 1.0

    def with_shape(self, shape: tuple[int, int]) -> "Lattice":
        """Return a lattice with these element sizes and another number of elements."""
        return replace(self, shape=shape)

    @property
    def padded(self) -> tuple[int, int]:
        """Periods (p_x, p_y) of the operators' tables, for linear convolutions."""
        nx, ny = self.shape
        return padded_length(nx, self.reach, columns=True), padded_length(ny, self.reach)

    @property
    def cyclic(self) -> tuple[int, int]:
        """Periods (p_x, p_y) of the tables of circulant inverses, without zero padding.

        That loads also act across its edges costs a method none or one iteration more; without
        padding an inverse takes a third of the time.
        """
        return fast_length(self.shape[0], columns=True), fast_length(self.shape[1])

    @property
    def coarsening(self) -> tuple[int, int]:
        """Elements (x, y) that one element of the next coarser lattice covers: 2, or 1 of a row."""
        return min(2, self.shape[0]), min(2, self.shape[1])

    def coarsened(self) -> "Lattice":
        """Return a lattice that covers this one with elements of twice the side (`coarsening`)."""
        (nx, ny), (bx, by) = self.shape, self.coarsening
        return Lattice((-(-nx // bx), -(-ny // by)), bx * self.dx, by * self.dy)


def unfold(values: np.ndarray, parity: int, period: int) -> np.ndarray:
    """Extend values at offsets >= 0 (last axis) to a period, evenly or oddly (parity 1 or -1)."""
    half = period // 2
    mirrored = parity * values[..., half - 1 : 0 : -1]
    return np.concatenate((values[..., : half + 1], mirrored), axis=-1)


def transform_quadrant(
    table: np.ndarray, parity: tuple[int, int], period: tuple[int, int], difference: bool = False
) -> np.ndarray:
    """Return the spectrum of a periodic table from its entries at offsets >= 0.

    Only these are transformed along y, and only half of the result along x.

    Parameters
    ----------
    table : ndarray, shape (p_x/2 + 1 or more, p_y/2 + 1 or more)
        Entries at offsets >= 0; for a difference one more in x.
    parity : tuple of int
        1 if the table is even in x (in y), -1 if it is odd.
    period : tuple of int
        (p_x, p_y), even.
    difference : bool
        Whether to transform the table less the same table one element ahead in x.

    Returns
    -------
    ndarray of complex, shape (p_x, p_y/2 + 1)
    """
    # Of real values, the transform is real if they are even, i times real if they are odd; its
    # other half is the complex conjugate.
    (even_x, even_y), half = parity, period[0] // 2
    along_y = np.fft.rfft(unfold(table[: half + 2], even_y, period[1]))
    rows = (along_y.real if even_y > 0 else along_y.imag).T
    values = unfold(rows, even_x, period[0])
    if difference:
        # Not periodic: beyond half a period, the next entry is that of the table.
        ahead = np.roll(values, -1, axis=1)
        ahead[:, half] = rows[:, half + 1]
        values = values - ahead
    columns = np.fft.rfft(values)
    spectrum = np.concatenate((columns, columns[:, half - 1 : 0 : -1].conj()), axis=1).T
    return spectrum if even_y > 0 else 1j * spectrum


def transform_displacement(
    lattice: Lattice,
    elasticity: Elasticity,
    component: str,
    period: tuple[int, int] | None = None,
    difference: bool = False,
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
        One of `mechanics.elasticity.COMPONENTS`.
    period : tuple of int, optional
        (p_x, p_y), no longer than `Lattice.padded`, which it is by default.
    difference : bool
        Whether to return the spectrum of the displacement less that of the element ahead.

    Returns
    -------
    ndarray of complex, shape (p_x, p_y/2 + 1)
        mm/MPa, divided by p_x p_y.
    """
    (px, py), sides = lattice.padded, (lattice.dx, lattice.dy)
    table = elasticity.coefficients(component, (px // 2 + 1 + difference, py // 2 + 1), *sides)
    period = period or (px, py)
    scaled = table / (period[0] * period[1])
    return transform_quadrant(scaled, _PARITY[component], period, difference)


def block_mean(
    values: np.ndarray, block: tuple[int, int], mode: Literal["constant", "edge"]
) -> np.ndarray:
    """Return means over blocks of elements (last two axes); `mode` pads incomplete blocks."""
    (nx, ny), (bx, by) = values.shape[-2:], block
    pad = [(0, 0)] * (values.ndim - 2) + [(0, -nx % bx), (0, -ny % by)]
    v = np.pad(values, pad, mode=mode)
    parts = [v[..., i::bx, j::by] for i in range(bx) for j in range(by)]
    total: np.ndarray = sum(parts[1:], start=parts[0])
    return total / len(parts)
