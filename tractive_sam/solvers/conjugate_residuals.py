"""Generalised conjugate residuals: a linear solver whose solution comes with its response.

The method of Eisenstat, Elman & Schultz (1983), SIAM J. Numer. Anal. 20, 345-357. The solution is
a sum of vectors that the operator has acted on, and so the response to it is a sum as well.
"""

from math import sqrt

import numpy as np

from tractive_sam.solvers.gmres import orthogonalised
from tractive_sam.solvers.newton_system import System


def conjugate_residuals(
    system: System, tolerance: float, most: int
) -> tuple[np.ndarray, np.ndarray]:
    """Solve a linear system of Newton's method, and return the response to its solution.

    Parameters
    ----------
    system : System
        The system.
    tolerance : float
        Norm of the residual, relative to that of the right-hand side, at which to stop.
    most : int
        Largest number of applications.

    Returns
    -------
    vector : ndarray, shape (n,)
        The solution.
    response : ndarray, shape (2 or 3, n_x, n_y)
        Response of the elastic operator to its fields.
    """
    left = system.right_hand_side()
    goal = tolerance * np.linalg.norm(left)
    rounding = 1e-13  # part of a new vector below which rounding has spoilt its digits
    found: list[tuple[np.ndarray, np.ndarray]] = []
    basis = np.empty((min(most, 15), left.size))
    triangle, along = np.zeros((most, most)), np.zeros(most)
    while len(found) < most and sqrt(left @ left) > goal:
        k = len(found)
        vector = system.preconditioner(left)
        response = system.response(vector)
        w, h, beyond = orthogonalised(system.product(vector, response.copy()), basis[:k])
        if beyond <= rounding * np.linalg.norm(h):
            break
        if k == len(basis):
            basis = np.concatenate((basis, np.empty_like(basis)))
        np.divide(w, beyond, out=basis[k])
        triangle[:k, k], triangle[k, k] = h, beyond
        along[k] = basis[k] @ left
        left -= along[k] * basis[k]
        found.append((vector, response))
    count = len(found)
    shares = np.linalg.solve(triangle[:count, :count], along[:count])
    vector, answer = np.zeros(left.size), np.zeros(system.shape)
    for share, (one, response) in zip(shares, found, strict=True):
        vector += share * one
        answer += share * response
    return vector, answer
