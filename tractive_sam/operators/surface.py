"""Stress at the surface of a half-space, from the displacements that tractions on a mesh cause."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from tractive_sam.compute import transform
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
    nu = body.A.poisson
    plane, by_pressure = 2.0 / (1.0 - nu), nu / (1.0 - nu)
    _, in_x, in_y = _at_corners(_displacements(lattice, body, tractions), lattice)
    p_x, p_y, p_n = _at_corners(tractions, lattice)[0]
    stress = np.empty((len(signs), 6, *p_n.shape))
    for of_body, s in zip(stress, signs, strict=True):
        xx, yy = in_x[2] + s * in_x[0], in_y[3] + s * in_y[1]
        of_body[0] = plane * (xx + nu * yy) - by_pressure * p_n
        of_body[1] = plane * (yy + nu * xx) - by_pressure * p_n
        of_body[2] = -p_n
        of_body[3] = in_y[2] + in_x[3] + s * (in_y[0] + in_x[1])
        of_body[4], of_body[5] = -s * p_x, -s * p_y
    return stress


def _at_corners(fields: np.ndarray, lattice: Lattice) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return means and derivatives in x and in y of fields (m, n_x, n_y) at inner corners."""
    if fields.shape[2] == 1:  # strips do not change in y
        fields = fields.repeat(2, axis=2)
    rise, total = fields[:, 1:] - fields[:, :-1], fields[:, 1:] + fields[:, :-1]
    return (
        0.25 * (total[..., 1:] + total[..., :-1]),
        0.5 / lattice.dx * (rise[..., 1:] + rise[..., :-1]),
        0.5 / lattice.dy * (total[..., 1:] - total[..., :-1]),
    )


def _displacements(lattice: Lattice, body: HalfSpaces, tractions: np.ndarray) -> np.ndarray:
    """Return u_x and u_y by tangential traction, and both by pressure, at centres, (4, n_x, n_y).

    The shear modulus is one. The transform owns the arrays.
    """
    p_x, p_y, p_n = transform(3, lattice.shape, lattice.padded).forward(tractions)
    back = transform(4, lattice.shape, lattice.padded)
    (xx, xy, yy), by_pressure = _spectra(lattice, body)
    back.spectrum[0] = xx * p_x + xy * p_y
    back.spectrum[1] = xy * p_x + yy * p_y
    np.multiply(by_pressure, p_n, out=back.spectrum[2:])
    return back.backward()


@lru_cache(maxsize=4)
def _spectra(lattice: Lattice, body: HalfSpaces) -> tuple[np.ndarray, np.ndarray]:
    """Return spectra of the displacement kernels: real ones xx, xy, yy, and xz, yz."""

    def of(component: str) -> np.ndarray:
        return influence.transform_displacement(lattice, body, component)

    even = np.stack([of(component).real for component in ("xx", "xy", "yy")])
    return even, np.stack([of(component) for component in ("xz", "yz")])
