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
from tractive_sam.mechanics.material import CombinedMaterial
from tractive_sam.operators.fft import fast_length, padded_length
from tractive_sam.operators.strips import strip_coefficients

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
        """Periods (p_x, p_y) of the operators' tables: they hold linear convolutions."""
        return padded_length(self.shape[0]), padded_length(self.shape[1])

    @property
    def cyclic(self) -> tuple[int, int]:
        """Periods of the circulant inverses' tables: the mesh and no more.

        That loads also act across the edges of the mesh costs a method none or one iteration more;
        without padding an inverse takes a third of the time.
        """
        return fast_length(self.shape[0]), fast_length(self.shape[1])

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


def _coefficients(mesh: Mesh, material: CombinedMaterial, component: str) -> np.ndarray:
    """Displacement per unit traction at the offsets of one quadrant, mm/MPa."""
    if mesh.datum is not None:
        px, py = mesh.padded
        of_strips = strip_coefficients((px // 2 + 2, py // 2 + 1), mesh.dx, mesh.datum, material)
        return of_strips[component]
    r1, xx, yy, xy, x2, y2 = _quadrant(*mesh.padded, mesh.dx, mesh.dy)
    nu, K = material.poisson, material.coupling
    c = 1.0 / (np.pi * material.shear)
    match component:
        case "xx":
            entry = (1.0 - nu) * r1 + nu * xx
        case "xy":
            entry = nu * xy
        case "yy":
            entry = (1.0 - nu) * r1 + nu * yy
        case "zz":
            entry = (1.0 - nu) * r1
        case "xz":
            entry = -K * x2
        case "yz":
            entry = -K * y2
    return c * entry


def _periodic(
    table: np.ndarray, parity: tuple[int, int], period: tuple[int, int], shift: int
) -> np.ndarray:
    """Unfold a quadrant by its parities; ``shift`` elements are added to the offset in x."""
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


def displacement(
    mesh: Mesh,
    material: CombinedMaterial,
    component: str,
    period: tuple[int, int] | None = None,
) -> np.ndarray:
    """Relative displacement u_A - u_B at an element's centre per unit traction on another.

    Juliá & Rodríguez-Tembleque (2025), eq. (43), integrated over the element; the signs of the
    coupling terms are those of a z-axis that points into body A.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    material : CombinedMaterial
        The pair of materials.
    component : str
        One of `COMPONENTS`.
    period : tuple of int, optional
        (p_x, p_y), no longer than `Mesh.padded`, which it is by default.

    Returns
    -------
    ndarray, shape (p_x, p_y)
        mm/MPa.
    """
    coefficients = _coefficients(mesh, material, component)
    return _periodic(coefficients, _PARITY[component], period or mesh.padded, 0)


def slip(mesh: Mesh, material: CombinedMaterial, component: str) -> np.ndarray:
    """Slip -du/dx per unit traction at the leading face of an element (paper, eq. 28).

    The difference of the displacements at the centres on both sides of the face. It is taken of
    the coefficients, once, so that an evaluation of the slip is a single convolution.

    Returns
    -------
    ndarray, shape (p_x, p_y)
        For a component of `COMPONENTS`, 1/MPa.
    """
    coefficients, parity = _coefficients(mesh, material, component), _PARITY[component]
    here, ahead = (_periodic(coefficients, parity, mesh.padded, shift) for shift in (0, 1))
    return (here - ahead) / mesh.dx
