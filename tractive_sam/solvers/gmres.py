"""Generalised minimal residuals, preconditioned from the right, without restarts."""

from collections.abc import Callable
from math import hypot, sqrt

import numpy as np

Map = Callable[[np.ndarray], np.ndarray]


def gmres(
    operator: Map, preconditioner: Map, rhs: np.ndarray, tolerance: float, most: int
) -> tuple[np.ndarray, int]:
    """Solve ``operator(x) = rhs`` to a relative residual (Saad & Schultz 1986).

    Parameters
    ----------
    operator, preconditioner : callable
        Linear maps on vectors like `rhs`; each may return an array it will overwrite later.
    rhs : ndarray, shape (n,)
        Right-hand side.
    tolerance : float
        Norm of the residual, relative to that of `rhs`, at which to stop.
    most : int
        Most iterations.

    Returns
    -------
    x : ndarray, shape (n,)
        Best approximation found.
    iterations : int
        Applications of the operator; the preconditioner was applied once more.
    """
    norm = sqrt(rhs @ rhs)
    if norm == 0.0:
        return np.zeros_like(rhs), 0
    basis = np.empty((min(most, 15) + 1, rhs.size), rhs.dtype)
    basis[0] = rhs / norm
    # The basis has the precision of rhs. The triangle and the rotations are in double: they are
    # small, and add no rounding of their own to that of the products.
    triangle = np.zeros((most, most))
    rotations: list[tuple[float, float]] = []
    residual = np.zeros(most + 1)
    residual[0] = norm
    k = 0
    while k < most and abs(residual[k]) > tolerance * norm:
        w, h, beyond = orthogonalised(operator(preconditioner(basis[k])), basis[: k + 1])
        # Givens: the rotations so far, then one that takes away what the new vector adds below.
        column = h.tolist()
        for i, (c, s) in enumerate(rotations):
            here, below = column[i], column[i + 1]
            column[i], column[i + 1] = c * here + s * below, c * below - s * here
        size = hypot(column[k], beyond)
        if size == 0.0:
            break
        c, s = column[k] / size, beyond / size
        column[k] = size
        rotations.append((c, s))
        triangle[: k + 1, k] = column
        residual[k + 1] = -s * residual[k]
        residual[k] *= c
        k += 1
        if s == 0.0:  # the Krylov space holds the solution
            break
        if k == len(basis):
            basis = np.concatenate((basis, np.empty_like(basis)))
        np.divide(w, rhs.dtype.type(beyond), out=basis[k])
    if k == 0:
        return np.zeros_like(rhs), 0
    # From the right: the residual minimised is that of the system itself, and the step is
    # preconditioned once, at the end.
    weights = np.linalg.solve(triangle[:k, :k], residual[:k]).astype(rhs.dtype)
    return np.array(preconditioner(weights @ basis[:k])), k


def orthogonalised(w: np.ndarray, basis: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """The part of w that is orthogonal to the basis, its components along it, and its norm.

    Classical Gram-Schmidt: products with the whole basis at once. It is done again where little is
    left, of which rounding has spoilt a part ("twice is enough").
    """
    before = sqrt(w @ w)
    h = basis @ w
    w = w - h @ basis
    beyond = sqrt(w @ w)
    components = h.astype(float)
    if beyond < 0.5 * before:
        h = basis @ w
        w -= h @ basis
        beyond = sqrt(w @ w)
        components += h
    return w, components, beyond
