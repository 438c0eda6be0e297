"""The posterior of a fit, for samplers."""

from collections.abc import Callable, Mapping
from os import PathLike
from typing import Any

import numpy as np

from tractive_sam.fitting.design import FitDesign
from tractive_sam.fitting.estimate import Loss
from tractive_sam.fitting.run import make_problem, read_design


def log_posterior(
    design: FitDesign | Mapping[str, Any] | str | PathLike[str],
) -> tuple[Callable[[np.ndarray], float], np.ndarray]:
    """Return the log posterior density of a fit as a function, up to a constant, and a start.

    The density is one of the values of the parameters: a positive one that is fitted by its
    logarithm has no prior except bounds and the stated one. Positions of profiles are coordinates
    after the parameters, see `FitResult`.

    Parameters
    ----------
    design : FitDesign, mapping or path-like
        See `fit`.

    Returns
    -------
    density : callable
        Function of values, shape (size,); minus infinity outside bounds and if a computation fails.
    start : ndarray, shape (size,)
        First values.

    Raises
    ------
    FitError
        With every fault of the design and of its data.

    Examples
    --------
    >>> from tractive_sam import fitting
    >>> density, start = fitting.log_posterior(
    ...     {"scene": coarse, "free": ["friction.mu"], "data": [data]}
    ... )
    >>> density(0.3 * start / start) > density(2.0 * start)
    True
    """
    table = read_design(design).fit
    problem = make_problem(table)
    n = len(problem.parameters)
    loss = Loss(table.loss)

    def density(values: np.ndarray) -> float:
        values = np.asarray(values, float)
        inside = (values[:n] >= problem.parameters.lower) & (values[:n] <= problem.parameters.upper)
        if not (inside & ((values[:n] > 0.0) | ~problem.parameters.logarithmic)).all():
            return -np.inf
        u = np.concatenate([problem.parameters.coordinates(values[:n]), values[n:]])
        predicted = problem.predict(u)
        residuals = problem.residuals(u, predicted)
        problem.evaluations.stored.clear()  # samplers hardly return to earlier values
        if not np.isfinite(residuals).all():
            return -np.inf
        # A relative noise follows the prediction, and so does the width of its density.
        follows = problem.noise.relative > 0.0
        cost = loss.cost(residuals, predicted.size)
        return -cost - float(np.log(problem.deviation(predicted)[follows]).sum())

    first = np.ones(problem.size)
    first[n:] = 0.0
    first = problem.align_profiles(first)
    return density, np.concatenate([problem.parameters.values(first), first[n:]])
