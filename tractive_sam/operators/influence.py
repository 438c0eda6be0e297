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


def _coefficients(lattice: Lattice, elasticity: Elasticity, component: str) -> np.ndarray:
    """Return displacement per unit traction, mm/MPa, at non-negative offsets in x and y."""
    px, py = lattice.padded
    # Two more offsets in x than half a period, for the difference at the last one.
    offsets = px // 2 + 2, py // 2 + 1
    return elasticity.coefficients(component, offsets, lattice.dx, lattice.dy)


def unfold_quadrant(
    table: np.ndarray, parity: tuple[int, int], period: tuple[int, int], shift: int = 0
) -> np.ndarray:
    """Extend a table of offsets >= 0 to a periodic one, by its parities, moved by `shift`."""
    px, py = period
    i = np.arange(px)
    i = np.where(i > px // 2, i - px, i) + shift
    j = np.arange(py)
    j = np.where(j > py // 2, j - py, j)
    unfolded = table[np.abs(i)[:, None], np.abs(j)[None, :]]
    if parity[0] < 0:
        unfolded = unfolded * np.sign(i)[:, None]
    if parity[1] < 0:
        unfolded = unfolded * np.sign(j)[None, :]
    return unfolded


def displacement_table(
    lattice: Lattice, elasticity: Elasticity, component: str, period: tuple[int, int] | None = None
) -> np.ndarray:
    """Return the periodic table (p_x, p_y) of u_A - u_B per unit traction on an element, mm/MPa.

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

    Returns
    -------
    ndarray, shape (p_x, p_y)
        mm/MPa.
    """
    coefficients = _coefficients(lattice, elasticity, component)
    return unfold_quadrant(coefficients, _PARITY[component], period or lattice.padded, 0)


def slip(lattice: Lattice, elasticity: Elasticity, component: str) -> np.ndarray:
    """Return the periodic table of slip -du/dx at the leading face per unit traction, 1/MPa.

    The difference of the displacements at the centres on both sides of the face. It is taken of
    the coefficients, once, so that an evaluation of the slip is a single convolution.

    Returns
    -------
    ndarray, shape (p_x, p_y)
        For a component of `mechanics.elasticity.COMPONENTS`, 1/MPa.
    """
    coefficients, parity = _coefficients(lattice, elasticity, component), _PARITY[component]
    here, ahead = (unfold_quadrant(coefficients, parity, lattice.padded, shift) for shift in (0, 1))
    return (here - ahead) / lattice.dx


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
