"""Stress at the surface of a half-space, from the displacements that tractions on a mesh cause."""

from functools import lru_cache

import numpy as np

from tractive_sam.kernels import surface_stress as surface_kernels
from tractive_sam.mechanics import HalfSpaces
from tractive_sam.operators import influence
from tractive_sam.operators.fft import spectrum, transform
from tractive_sam.operators.influence import Lattice


def surface_stress(lattice: Lattice, body: HalfSpaces, tractions: np.ndarray) -> np.ndarray:
    """Stress at the corners of the elements: its means over rectangles from centre to centre.

    With tractions constant on elements the stress is infinite at every edge across which the
    tangential one jumps; the displacement is not. Its differences between centres are means of the
    strain, and Hooke's law with the mean of the tractions makes them stress. Displacement at
    centres is what the contact conditions are met with: the error of each traction is the one that
    makes it right there.

    Parameters
    ----------
    lattice : Lattice
        Elements (n_x, n_y), or strips; lengths in mm.
    body : HalfSpaces
        The body, as `HalfSpaces.alone` gives it.
    tractions : ndarray, shape (..., 3, n_x, n_y)
        (p_x, p_y, p_n) acting on the half-space z >= 0, MPa; of several such bodies at once.

    Returns
    -------
    ndarray, shape (..., 6, n_x - 1, n_y - 1), of strips (..., 6, n_x - 1, 1)
        In the order of `kernels.stress.COMPONENTS`, MPa: of corners that four elements share, or
        of edges that two strips do.
    """
    each = tractions.reshape(-1, 3, *lattice.shape)
    nx, ny = lattice.shape
    stress = np.empty((len(each), 6, nx - 1, max(ny - 1, 1)))
    u, sides = _displacements(lattice, body, each), (lattice.dx, lattice.dy)
    surface_kernels.at_corners(stress, u, each, *sides, body.A.poisson)
    return stress.reshape(*tractions.shape[:-3], *stress.shape[1:])


def between(fields: np.ndarray) -> np.ndarray:
    """Means (..., n_x - 1, n_y - 1) at the corners of elements, or (..., n_x - 1, 1) of strips."""
    return _mean(_mean(fields, -1), -2)


def slopes(fields: np.ndarray, dx: float, dy: float) -> np.ndarray:
    """Derivatives in x and y, (2, ...), at the corners of elements; as `between`."""
    in_x = _mean(np.diff(fields, axis=-2), -1) / dx
    if fields.shape[-1] == 1:
        return np.stack((in_x, np.zeros_like(in_x)))
    return np.stack((in_x, _mean(np.diff(fields, axis=-1), -2) / dy))


def _mean(fields: np.ndarray, axis: int) -> np.ndarray:
    if fields.shape[axis] == 1:
        return fields
    if axis == -1:
        return 0.5 * (fields[..., 1:] + fields[..., :-1])
    return 0.5 * (fields[..., 1:, :] + fields[..., :-1, :])


def _displacements(lattice: Lattice, body: HalfSpaces, tractions: np.ndarray) -> np.ndarray:
    """(u_x, u_y) at the centres, (bodies, 2, n_x, n_y); they belong to the transform.

    Of unit shear modulus.
    """
    planned = transform(3 * len(tractions), lattice.shape, lattice.padded)
    spectra = planned.forward(tractions.reshape(-1, *lattice.shape))
    product = spectra.reshape(-1, 3, *spectra.shape[1:])
    surface_kernels.displacement_product(product, *_spectra(lattice, body))
    return planned.backward().reshape(tractions.shape)[:, :2]


@lru_cache(maxsize=4)
def _spectra(lattice: Lattice, body: HalfSpaces) -> tuple[np.ndarray, np.ndarray]:
    """Of the kernels: the even ones (3, ...) have real spectra, the odd ones (2, ...) imaginary."""

    def of(component: str) -> np.ndarray:
        return spectrum(influence.displacement(lattice, body, component))

    even = np.stack([of(component).real for component in ("xx", "xy", "yy")])
    return even, np.stack([of(component).imag for component in ("xz", "yz")])
