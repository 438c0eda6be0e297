"""Compliance between the rows of a contact: the wear of one row changes the pressure of all."""

from functools import lru_cache

import numpy as np

from tractive_sam.kernels.spectral import row_products
from tractive_sam.mechanics import Elasticity
from tractive_sam.operators import influence
from tractive_sam.operators.influence import Lattice


def row_compliance(lattice: Lattice, elasticity: Elasticity, contact: np.ndarray) -> np.ndarray:
    """Mean normal displacement of each row in contact by a load on each other one.

    A row is what a ring of material meets: all elements of one y. The load of a row is spread
    evenly over its elements in contact, and the displacement averaged over them (a Galerkin
    projection of A_nn onto one unknown a row). Spectra along x make it cost no more than one
    application of A_nn a row.

    Parameters
    ----------
    lattice : Lattice
        The elements.
    elasticity : Elasticity
        The bodies.
    contact : ndarray of bool, shape (n_x, n_y)
        Elements in contact.

    Returns
    -------
    ndarray, shape (m, m)
        For the m rows in contact, ascending in y: mm per MPa summed over the elements of a row.
    """
    rows = np.flatnonzero(contact.any(axis=0))
    share = contact[:, rows] / contact[:, rows].sum(axis=0)
    share = np.fft.rfft(share, n=lattice.padded[0], axis=0)
    compliance = np.empty((len(rows), len(rows)))
    row_products(compliance, np.ascontiguousarray(share.T), _along(lattice, elasticity), rows)
    return compliance


@lru_cache(maxsize=2)
def _along(lattice: Lattice, elasticity: Elasticity) -> np.ndarray:
    """Spectra along x of the displacement, (p_y, p_x/2 + 1)."""
    px, _ = lattice.padded
    # Even in x: a real spectrum. Parseval over its half: inner frequencies count twice.
    along = np.fft.rfft(influence.displacement(lattice, elasticity, "zz"), axis=0).real / px
    along[1:-1] *= 2.0
    return np.ascontiguousarray(along.T)
