"""Slopes of creep forces at rest, extrapolated to an infinitely fine mesh.

At rest all of the contact sticks. Its tractions are singular at the trailing edge, and their
resultants depend on how the elements cover the contact: by 1 % to 2 % with fifteen elements across
it, irregularly from mesh to mesh. Most of this error depends on the second moments of the covered
area, which are known for an ellipse. A fit over many meshes

    slope = limit + c_1 / n + c_2 (moment of x² - exact) + c_3 (moment of y² - exact)

over n elements across the contact yields the limit, and its scatter yields the error bar.
"""

import numpy as np
import scipy  # its parts are loaded when first used


def rest_meshes(
    elements: int, finest: int, wanted: float, *, number: int = 16, spread: float = 3.2
) -> np.ndarray:
    """Return the numbers of elements across the contact on which slopes at rest are solved.

    Parameters
    ----------
    elements, finest : int
        First and largest number of elements of the table.
    wanted : float
        Error bar of forces over mu P; slopes at rest must have a tenth of this error, or less.
    number : int
        Meshes: four times the unknowns of the fit.
    spread : float
        Elements of the finest over elements of the coarsest mesh.
    """
    # From 101 elements slopes are within 0.3 % if forces are wanted within 0.8 % of mu P.
    largest = min(finest, max(2 * elements, 0.8 / wanted))
    across = np.geomspace(largest / spread, largest, number)
    return np.unique(2 * np.rint(0.5 * (across - 1.0)).astype(int) + 1)


def extrapolate_slopes(
    meshes: np.ndarray, slopes: np.ndarray, moments: np.ndarray, *, confidence: float = 0.95
) -> tuple[np.ndarray, np.ndarray]:
    """Extrapolate slopes at rest to an infinitely fine mesh; return (limit, error bar).

    Parameters
    ----------
    meshes : ndarray, shape (M,)
        Elements across the contact.
    slopes : ndarray, shape (M, ...)
        Slopes on each mesh.
    moments : ndarray, shape (M, K)
        Excess moments of the area, on which the slopes depend; zero in the limit.
    confidence : float
        Probability that a slope is within its error bar if scatter is normal.

    Returns
    -------
    limit, bar : ndarray, shape (...)
        Slopes of the limit and half widths of their intervals.
    """
    # The scatter decreases faster than 1/n, as the number of elements at the edge increases.
    weights = meshes[:, None] ** 1.5
    basis = weights * np.column_stack([np.ones(len(meshes)), 1.0 / meshes, moments])
    values = weights * slopes.reshape(len(meshes), -1)
    # Both moments of a circle are equal: the rest of a singular value is rounding.
    inverse = np.linalg.pinv(basis, rcond=1e-6)
    fitted = inverse @ values
    free = max(len(meshes) - np.linalg.matrix_rank(basis, tol=1e-6 * np.abs(basis).max()), 1)
    scatter = np.sqrt(np.sum((values - basis @ fitted) ** 2, axis=0) / free)
    bar = scipy.special.stdtrit(free, 0.5 + 0.5 * confidence) * np.linalg.norm(inverse[0]) * scatter
    return fitted[0].reshape(slopes.shape[1:]), bar.reshape(slopes.shape[1:])
