"""Stress at the surface of a half-space, from the displacements that tractions on a mesh cause."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from tractive_sam.compute import spectrum, transform
from tractive_sam.kernels import surface_stress as surface_kernels
from tractive_sam.mechanics import HalfSpaces
from tractive_sam.operators import influence
from tractive_sam.operators.influence import Lattice


def surface_stress(
    lattice: Lattice, body: HalfSpaces, tractions: np.ndarray, signs: Sequence[float] = (1.0,)
) -> np.ndarray:
    """Return surface stress at inner corners (bodies, 6, n_x - 1, n_y - 1), by displacement.

    With tractions constant on elements the stress is infinite at every edge across which the
    tangential one jumps; the displacement is finite. Its differences between centres are means of
    the strain, and Hooke's law with the mean of the tractions makes them stress. The contact
    conditions are met by the displacement at centres: the error of each traction makes it exact
    there.

    Parameters
    ----------
    lattice : Lattice
        Elements (n_x, n_y), or strips; lengths in mm.
    body : HalfSpaces
        The body, as `HalfSpaces.single_body` gives it.
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) acting on the half-space z >= 0, MPa.
    signs : sequence of float
        Factors of p_x and p_y, for each of several bodies of this kind.

    Returns
    -------
    ndarray, shape (bodies, 6, n_x - 1, n_y - 1), for strips (bodies, 6, n_x - 1, 1)
        In the order of `kernels.stress.COMPONENTS`, MPa: of corners that four elements share, or
        of edges that two strips do.
    """
    nx, ny = lattice.shape
    stress = np.empty((len(signs), 6, nx - 1, max(ny - 1, 1)))
    u, sides = _displacements(lattice, body, tractions), (lattice.dx, lattice.dy)
    surface_kernels.at_corners(stress, u, tractions, tuple(signs), *sides, body.A.poisson)
    return stress


def _displacements(lattice: Lattice, body: HalfSpaces, tractions: np.ndarray) -> np.ndarray:
    """Return u_x and u_y by tangential traction, and both by pressure, at centres, (4, n_x, n_y).

    The shear modulus is one. The transform owns the arrays.
    """
    spectra = transform(3, lattice.shape, lattice.padded).forward(tractions)
    back = transform(4, lattice.shape, lattice.padded)
    surface_kernels.displacement_product(back.spectrum, spectra, *_spectra(lattice, body))
    return back.backward()


@lru_cache(maxsize=4)
def _spectra(lattice: Lattice, body: HalfSpaces) -> tuple[np.ndarray, np.ndarray]:
    """Return spectra of the displacement kernels: real ones xx, xy, yy, imaginary ones xz, yz."""

    def of(component: str) -> np.ndarray:
        return spectrum(influence.displacement_table(lattice, body, component))

    even = np.stack([of(component).real for component in ("xx", "xy", "yy")])
    return even, np.stack([of(component).imag for component in ("xz", "yz")])
