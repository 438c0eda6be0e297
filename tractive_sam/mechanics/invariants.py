"""Scalars of a stress tensor that do not depend on the axes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def von_mises(stress: ArrayLike) -> NDArray[np.float64]:
    """Return the equivalent stress of von Mises, in the unit of the stress.

    Parameters
    ----------
    stress : array_like, shape (6, ...)
        Components xx, yy, zz, xy, xz, yz.

    Examples
    --------
    >>> float(von_mises([100.0, 0.0, 0.0, 0.0, 0.0, 0.0]))
    100.0
    """
    xx, yy, zz, xy, xz, yz = np.asarray(stress, float)
    normal = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    return np.sqrt(0.5 * normal + 3.0 * (xy**2 + xz**2 + yz**2))


def principal_stresses(stress: ArrayLike) -> NDArray[np.float64]:
    """Return the principal stresses, the largest (most tensile) first, shape (3, ...).

    Parameters
    ----------
    stress : array_like, shape (6, ...)
        Components xx, yy, zz, xy, xz, yz.

    Examples
    --------
    >>> principal_stresses([100.0, 0.0, -50.0, 0.0, 0.0, 0.0])
    array([100.,   0., -50.])
    """
    tensor = np.moveaxis(
        np.asarray(stress, float)[[[0, 3, 4], [3, 1, 5], [4, 5, 2]]], (0, 1), (-2, -1)
    )
    return np.moveaxis(np.linalg.eigvalsh(tensor), -1, 0)[::-1]


def max_shear(stress: ArrayLike) -> NDArray[np.float64]:
    """Return the largest shear stress (Tresca), half the difference of the extreme principal ones.

    Parameters
    ----------
    stress : array_like, shape (6, ...)
        Components xx, yy, zz, xy, xz, yz.

    Examples
    --------
    >>> float(max_shear([100.0, 0.0, -50.0, 0.0, 0.0, 0.0]))
    75.0
    """
    largest, _, smallest = principal_stresses(stress)
    return 0.5 * (largest - smallest)
