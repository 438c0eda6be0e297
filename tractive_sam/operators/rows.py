"""Compliance between the rows of a contact: the wear of one row changes the pressure of all."""

import numpy as np

from tractive_sam.kernels.spectral import row_products
from tractive_sam.operators.elastic import Operators


def row_compliance(operators: Operators, contact: np.ndarray) -> np.ndarray:
    """Return the matrix of mean normal displacements of rows (elements of one y) by loads on rows.

    A row is what a ring of material meets: all elements of one y. The load of a row is spread
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
