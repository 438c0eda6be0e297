"""Influence coefficients of strips that are endless in y: line contact in plane strain."""

import numpy as np

from tractive_sam.kernels.strip import logarithm, step
from tractive_sam.mechanics.material import CombinedMaterial


def strip_coefficients(
    offsets: tuple[int, int], dx: float, datum: float, material: CombinedMaterial
) -> dict[str, np.ndarray]:
    """Displacement per unit traction at the offsets of one quadrant, mm/MPa.

    The only offset in y is 0. Columns beyond it are zero: with them the transform in y passes every
    row by itself, in circulant inverses as well.

    Parameters
    ----------
    offsets : tuple of int
        Shape of the tables.
    dx : float
        Width of the strips and step of the offsets, mm.
    datum : float
        Distance from a load at which its displacement is taken to be zero, mm.
    material : CombinedMaterial
        The pair of materials.
    """
    x = dx * np.arange(offsets[0])
    nu, K = material.poisson, material.coupling
    c = 1.0 / (np.pi * material.shear)
    log, sign = logarithm(x, dx, datum), step(x, dx)
    columns = {
        "xx": c * (1.0 - nu) * log,
        "yy": c * log,
        "zz": c * (1.0 - nu) * log,
        "xz": -c * K * sign,
    }
    tables = {name: np.zeros(offsets) for name in ("xx", "xy", "yy", "zz", "xz", "yz")}
    for name, column in columns.items():
        tables[name][:, 0] = column
    return tables
