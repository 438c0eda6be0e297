"""Generalised minimal residuals, preconditioned from the right, without restarts."""

from collections.abc import Callable

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
    norm = np.linalg.norm(rhs)
    if norm == 0.0:
        return np.zeros_like(rhs), 0
    basis = [rhs / norm]
    triangle = np.zeros((most, most))
    rotations = np.zeros((most, 2))
    residual = np.zeros(most + 1)
    residual[0] = norm
    k = 0
    while k < most and abs(residual[k]) > tolerance * norm:
        w = np.array(operator(preconditioner(basis[k])))
        h = np.zeros(k + 2)
        # Modified Gram-Schmidt; at the few dozen vectors met here it stays orthogonal enough.
        for i, v in enumerate(basis):
            h[i] = np.dot(v, w)
            w -= h[i] * v
        h[k + 1] = np.linalg.norm(w)
        for i, (c, s) in enumerate(rotations[:k]):
            h[i], h[i + 1] = c * h[i] + s * h[i + 1], c * h[i + 1] - s * h[i]
        size = np.hypot(h[k], h[k + 1])
        if size == 0.0:
            break
        c, s = rotations[k] = h[k] / size, h[k + 1] / size
        triangle[:k, k], triangle[k, k] = h[:k], size
        residual[k + 1] = -s * residual[k]
        residual[k] *= c
        k += 1
        if s == 0.0:  # the Krylov space holds the solution
            break
        basis.append(w / h[k])
    if k == 0:
        return np.zeros_like(rhs), 0
    weights = np.linalg.solve(triangle[:k, :k], residual[:k])
    combined = sum(y * v for y, v in zip(weights, basis, strict=False))
    return np.array(preconditioner(combined)), k
