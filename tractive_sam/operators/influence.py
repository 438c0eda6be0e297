"""Periodic tables of influence coefficients, from which every operator is made.

Names follow the grammar ``displacement_xz``: u_x from p_z. A table holds the coefficient of the
offset (i, j) elements at index (i mod p_x, j mod p_y). The offsets that a linear convolution never
reads are filled with true coefficients as well: the operators do not notice, but the circulant
inverses used as preconditioners do. With zeros there, the preconditioned slip operator has a
condition number of 121 instead of 5 on the scene `spheres` at 45 x 45.
"""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from tractive_sam.kernels.tables import quadrant
from tractive_sam.operators.fft import padded_length
from tractive_sam.operators.strips import strip_coefficients
from tractive_sam.reference import CombinedMaterial

COMPONENTS = ("xx", "xy", "yy", "zz", "xz", "yz")
"""The six independent kernels; A_zx = -A_xz and A_zy = -A_yz (reciprocity)."""

_PARITY = {"xx": (1, 1), "xy": (-1, -1), "yy": (1, 1), "zz": (1, 1), "xz": (-1, 1), "yz": (1, -1)}


@dataclass(frozen=True)
class Mesh:
    """Number of elements and their sides: all that a convolution knows of a grid.

    Where a datum is given the elements are strips endless in y, one beside the other in x (n_y = 1,
    plane strain): the distance from a load at which its displacement is taken to be zero, mm.
    """

    shape: tuple[int, int]
    dx: float
    dy: float
    datum: float | None = None

    def of(self, shape: tuple[int, int]) -> "Mesh":
        """A mesh of another number of the same elements."""
        return replace(self, shape=shape)

    @property
    def padded(self) -> tuple[int, int]:
        """Periods (p_x, p_y) of the tables."""
        return padded_length(self.shape[0]), padded_length(self.shape[1])

    @property
    def block(self) -> tuple[int, int]:
        """Elements in x and y that make one of the next coarser mesh."""
        return (2, 2) if self.datum is None else (2, 1)

    def coarsened(self) -> "Mesh":
        """The mesh of elements twice as long and, but for strips, wide that covers this one."""
        (nx, ny), (bx, by) = self.shape, self.block
        return replace(self, shape=(-(-nx // bx), -(-ny // by)), dx=bx * self.dx, dy=by * self.dy)


@lru_cache(maxsize=8)
def _quadrant(px: int, py: int, dx: float, dy: float) -> np.ndarray:
    # Two more offsets in x than half a period, for the difference at the last one.
    return quadrant(px // 2 + 2, py // 2 + 1, dx, dy)


def _coefficients(mesh: Mesh, material: CombinedMaterial) -> dict[str, np.ndarray]:
    """Displacement per unit traction at the offsets of one quadrant, mm/MPa."""
    if mesh.datum is not None:
        px, py = mesh.padded
        return strip_coefficients((px // 2 + 2, py // 2 + 1), mesh.dx, mesh.datum, material)
    r1, xx, yy, xy, x2, y2 = _quadrant(*mesh.padded, mesh.dx, mesh.dy)
    nu, K = material.poisson, material.coupling
    c = 1.0 / (np.pi * material.shear)
    return {
        "xx": c * ((1.0 - nu) * r1 + nu * xx),
        "xy": c * nu * xy,
        "yy": c * ((1.0 - nu) * r1 + nu * yy),
        "zz": c * (1.0 - nu) * r1,
        "xz": -c * K * x2,
        "yz": -c * K * y2,
    }


def _periodic(table: np.ndarray, parity: tuple[int, int], mesh: Mesh, shift: int) -> np.ndarray:
    """Unfold a quadrant by its parities; ``shift`` elements are added to the offset in x."""
    px, py = mesh.padded
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


def displacement(mesh: Mesh, material: CombinedMaterial, component: str) -> np.ndarray:
    """Relative displacement u_A - u_B at an element's centre per unit traction on another.

    Juliá & Rodríguez-Tembleque (2025), eq. (43), integrated over the element; the signs of the
    coupling terms are those of a z-axis that points into body A.

    Returns
    -------
    ndarray, shape (p_x, p_y)
        For a component of `COMPONENTS`, mm/MPa.
    """
    return _periodic(_coefficients(mesh, material)[component], _PARITY[component], mesh, 0)


def slip(mesh: Mesh, material: CombinedMaterial, component: str) -> np.ndarray:
    """Slip -du/dx per unit traction at the leading face of an element (paper, eq. 28).

    The difference of the displacements at the centres on both sides of the face. It is taken of
    the coefficients, once, so that an evaluation of the slip is a single convolution.

    Returns
    -------
    ndarray, shape (p_x, p_y)
        For a component of `COMPONENTS`, 1/MPa.
    """
    coefficients, parity = _coefficients(mesh, material)[component], _PARITY[component]
    here, ahead = (_periodic(coefficients, parity, mesh, shift) for shift in (0, 1))
    return (here - ahead) / mesh.dx
