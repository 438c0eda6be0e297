"""Krylov methods for linear systems, preconditioned from the right, without restarts.

Generalised minimal residuals store one vector of each iteration. Generalised conjugate residuals
store three; their solution is a sum of vectors that the operator has acted on, and so the response
to it is a sum as well.
"""

from collections.abc import Callable
from math import hypot, inf, prod, sqrt
from typing import Protocol

import numpy as np

from tractive_sam.kernels.krylov import extend_basis

Map = Callable[[np.ndarray], np.ndarray]


class LinearSystem(Protocol):
    """Protocol of a linear system: its right-hand side, matrix product and preconditioner."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the fields (pressure, tractions) in a vector of unknowns."""

    def right_hand_side(self) -> np.ndarray:
        """Return the right-hand side of the system, shape (n,)."""

    def preconditioner(self, vector: np.ndarray) -> np.ndarray:
        """Apply an approximate inverse of the matrix to a vector."""

    def response(self, vector: np.ndarray) -> np.ndarray:
        """Return the elastic gap and slip due to the fields in a vector of unknowns."""

    def product(self, vector: np.ndarray, response: np.ndarray) -> np.ndarray:
        """Return the matrix times a vector with a known response; the next call overwrites it."""


class Basis:
    """Memory for the vectors of a Krylov space, which the solves of several systems share.

    On large meshes the system takes longer to provide fresh memory for a vector than it takes to
    make it orthogonal to the others.
    """

    def __init__(self) -> None:
        self._vectors = np.empty((0, 0))

    def vectors(self, count: int, like: np.ndarray) -> np.ndarray:
        """Return rows like a vector, at least `count`; those returned before keep their values."""
        if self._vectors.dtype != like.dtype or not len(self._vectors):
            self._vectors = np.empty((16, like.size), like.dtype)
        if count > len(self._vectors):
            self._vectors = np.concatenate((self._vectors, np.empty_like(self._vectors)))
        return self._vectors


def gmres(
    operator: Map,
    preconditioner: Map,
    rhs: np.ndarray,
    tolerance: float,
    max_steps: int,
    memory: Basis | None = None,
) -> tuple[np.ndarray, int]:
    """Solve ``operator(x) = rhs`` by GMRES (Saad & Schultz 1986); return x and the steps.

    Parameters
    ----------
    operator, preconditioner : callable
        Linear maps on vectors like `rhs`; each may return an array it will overwrite later.
    rhs : ndarray, shape (n,)
        Right-hand side.
    tolerance : float
        Norm of the residual over the norm of `rhs` at which to stop.
    max_steps : int
        Most iterations.
    memory : Basis, optional
        Memory for the Krylov space, of solves of as many equations before.

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
    memory = memory or Basis()
    basis = memory.vectors(1, rhs)
    np.divide(rhs, rhs.dtype.type(norm), out=basis[0])
    # The basis has the precision of rhs. The triangle and the rotations are small and in double
    # precision: they add no rounding errors.
    triangle = np.zeros((max_steps, max_steps))
    rotations: list[tuple[float, float]] = []
    residual, k = [norm], 0
    while k < max_steps and abs(residual[k]) > tolerance * norm:
        basis = memory.vectors(k + 2, rhs)
        basis[k + 1] = operator(preconditioner(basis[k]))
        h, beyond = orthogonalise(basis[k + 1], basis[: k + 1])
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
        residual[k:] = c * residual[k], -s * residual[k]
        k += 1
        if s == 0.0:  # the Krylov space holds the solution
            break
        basis[k] /= rhs.dtype.type(beyond)
    # Preconditioned from the right: the residual minimised belongs to the system itself, and the
    # step is preconditioned once, at the end.
    weights = np.linalg.solve(triangle[:k, :k], residual[:k]).astype(rhs.dtype)
    return np.array(preconditioner(weights @ basis[:k])), k


def orthogonalise(w: np.ndarray, basis: np.ndarray) -> tuple[np.ndarray, float]:
    """Make w orthogonal to an orthonormal basis, in place; return its components and new norm.

    Classical Gram-Schmidt: products with all vectors together. It is repeated if less than a tenth
    is left, which has rounding errors (Daniel, Gragg, Kaufman & Stewart 1976, Math. Comp. 30,
    772-795): a tenth costs one digit, and a solve does not need the last ones.
    """
    if not len(basis):
        return np.zeros(0), sqrt(w @ w)
    h = basis @ w
    w -= h @ basis
    beyond = w @ w
    components = h.astype(float)
    if beyond < 0.01 * (beyond + h @ h):
        h = basis @ w
        w -= h @ basis
        beyond = w @ w
        components += h
    return components, sqrt(beyond)


def conjugate_residuals(
    system: LinearSystem, tolerance: float, max_steps: int
) -> tuple[np.ndarray, np.ndarray]:
    """Solve a linear system by conjugate residuals; return the solution and its response.

    The method of Eisenstat, Elman & Schultz (1983), SIAM J. Numer. Anal. 20, 345-357.

    Parameters
    ----------
    system : LinearSystem
        The system.
    tolerance : float
        Norm of the residual over the norm of the right-hand side at which to stop.
    max_steps : int
        Largest number of applications.

    Returns
    -------
    vector : ndarray, shape (n,)
        The solution.
    response : ndarray, shape (2 or 3, n_x, n_y)
        Response of the elastic operator to its fields.
    """
    residual = system.right_hand_side()
    kind = residual.dtype.type
    norm = sqrt(residual @ residual)
    goal = tolerance * norm
    # Part of a new vector below which rounding has spoilt its digits.
    rounding = 500.0 * float(np.finfo(kind).eps)
    rows = min(max_steps, 12)
    space = np.empty((3, rows, residual.size), kind)
    triangle, along, size = np.zeros((rows, rows)), np.zeros(rows), prod(system.shape)
    k = 0
    while k < max_steps and norm > goal:
        if k == rows:
            space = np.concatenate((space, np.empty_like(space)), axis=1)
            triangle, along, rows = np.pad(triangle, (0, k)), np.pad(along, (0, k)), 2 * k
        vectors, responses, basis = space
        vectors[k] = system.preconditioner(residual)
        response = system.response(vectors[k])
        responses[k, :size] = response.ravel()
        basis[k] = system.product(vectors[k], response)
        norm = extend_basis(basis, k, residual, triangle, along, rounding)
        if norm == inf:
            break
        k += 1
    shares = np.linalg.solve(triangle[:k, :k], along[:k]).astype(kind)
    vector, response = shares @ space[0, :k], shares @ space[1, :k, :size]
    return vector, response.reshape(system.shape)
