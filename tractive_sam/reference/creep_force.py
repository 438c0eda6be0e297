"""Force against longitudinal creepage for a circular contact: two approximate curves.

Both are written over the creep parameter of eq. (40) and give Q / (mu P). They are continued as
odd functions to negative parameters. Source of the numbering: Juliá & Rodríguez-Tembleque,
Int. J. Mech. Sci. 294 (2025) 110195.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def creep_parameter(
    xi_x: ArrayLike, *, shear: float, a: float, mu: float, load: float, poisson: float
) -> NDArray[np.float64]:
    """Normalise a longitudinal creepage, -xi_x 16 G a² / (3 mu P (4 - 3 nu)), eq. (40).

    Parameters
    ----------
    xi_x : array_like
        Longitudinal creepage; negative drives body A, which makes the parameter positive.
    shear, poisson : float
        Combined shear modulus, MPa, and Poisson's ratio.
    a : float
        Radius of the contact, mm.
    mu : float
        Friction coefficient.
    load : float
        Normal load P, N.

    Examples
    --------
    >>> parameter = creep_parameter(-0.0031, shear=1.0, a=3.5, mu=0.4013, load=0.4705, poisson=0.28)
    >>> round(float(parameter), 3)
    0.339
    """
    return -np.multiply(xi_x, 16 * shear * a**2 / (3 * mu * load * (4 - 3 * poisson)))


def vermeulen_johnson(xi: ArrayLike) -> NDArray[np.float64]:
    """Return Q/(mu P) = 1 - (1 - xi)³, ±1 beyond |xi| = 1, odd; Vermeulen & Johnson (1964).

    Eq. (41) of the paper.

    Examples
    --------
    >>> vermeulen_johnson([0.0, 0.5, 1.0])
    array([0.   , 0.875, 1.   ])
    """
    size = np.minimum(np.abs(xi), 1.0)
    return np.copysign(size * (3.0 - size * (3.0 - size)), xi)


def vermeulen_johnson_inverse(ratio: ArrayLike) -> NDArray[np.float64]:
    """Return the creep parameter that transmits `ratio` = Q/(mu P), by the inverse of eq. (41).

    Raises
    ------
    ValueError
        If a ratio lies outside [-1, 1]: friction cannot carry it.

    Examples
    --------
    >>> float(vermeulen_johnson_inverse(0.875))
    0.5
    """
    size = np.abs(ratio)
    if not np.all(size <= 1):
        raise ValueError("Q/(mu P) must lie between -1 and 1")
    root = np.cbrt(1.0 - size)
    # 1 - root, without the cancellation at small forces
    return np.copysign(size / (1.0 + root + root**2), ratio)


def kalker_simplified(xi: ArrayLike) -> NDArray[np.float64]:
    """Return Q/(mu P) of Kalker's simplified theory (1967), eq. (42); odd, ±1 from |xi| = 1.

    Q/(mu P) = 3/2 xi arccos(xi) + 1 - (1 + xi²/2) sqrt(1 - xi²) for 0 <= xi <= 1.

    A simplified theory, 5-6 % below the half-space solution at small creepage; the two meet at
    full slip, xi = 1.

    Examples
    --------
    >>> kalker_simplified([0.0, 0.5, 1.0]).round(4)
    array([0.    , 0.8111, 1.    ])
    """
    size = np.minimum(np.abs(xi), 1.0)
    root = (1.0 + size**2 / 2) * np.sqrt(1.0 - size**2)
    # 1 - root = (1 - root²) / (1 + root), without the cancellation at small creepage
    rest = size**4 * (3.0 + size**2) / 4 / (1.0 + root)
    return np.copysign(1.5 * size * np.arccos(size) + rest, xi)
