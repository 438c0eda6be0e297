"""Vectors of a Krylov space, made orthonormal one by one."""

from math import inf, sqrt

from tractive_sam.kernels.compiled import ANY_ORDER, compiled


@compiled(fastmath=ANY_ORDER, inner=True)
def _dot(first, second):
    """Return the scalar product of two vectors, in their precision."""
    total = first.dtype.type(0.0)
    for k in range(first.size):
        total += first[k] * second[k]
    return total


@compiled(fastmath=ANY_ORDER, inner=True)
def _subtract(vector, factor, other):
    """Subtract from a vector another one times a factor, in place."""
    factor = vector.dtype.type(factor)
    for k in range(vector.size):
        vector[k] -= factor * other[k]


@compiled
def extend_basis(basis, k, residual, triangle, along, rounding):
    """Make row k of a basis orthonormal to the rows before it; remove its part of a residual.

    Modified Gram-Schmidt, twice: the second pass removes the rounding errors of the first one.

    Parameters
    ----------
    basis : ndarray, shape (m, n)
        Orthonormal rows, and the new row k, which is changed.
    k : int
        Index of the new row.
    residual : ndarray, shape (n,)
        Residual, orthogonal to the rows before row k; changed.
    triangle : ndarray, shape (m, m)
        Matrix with zeros in column k, which is set to the components and the norm of the new row.
    along : ndarray, shape (m,)
        Components of the residual; the one along the new row is set.
    rounding : float
        Ratio of the new row to its removed part below which rounding has spoilt its digits.

    Returns
    -------
    float
        Norm of the residual; infinite if rounding has spoilt the new row.
    """
    new, removed = basis[k], 0.0
    for _ in range(2):
        for i in range(k):
            part = _dot(basis[i], new)
            _subtract(new, part, basis[i])
            triangle[i, k] += part
            removed += part * part
        norm = sqrt(_dot(new, new))
        if norm * norm >= 0.01 * removed:  # the rounding errors are small
            break
    if norm <= rounding * sqrt(removed):
        return inf
    scale = new.dtype.type(1.0 / norm)
    for j in range(new.size):
        new[j] *= scale
    triangle[k, k], along[k] = norm, _dot(new, residual)
    _subtract(residual, along[k], new)
    return sqrt(_dot(residual, residual))
