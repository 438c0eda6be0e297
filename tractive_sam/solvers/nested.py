"""First guesses from coarser meshes.

A coarse mesh finds the contact, its stick and slip zones and its smooth fields at a fraction of
the cost; the finest mesh then needs a few steps only, however fine it is.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.ndimage import distance_transform_edt

from tractive_sam.solvers.outcome import Outcome
from tractive_sam.solvers.problem import CoupledProblem, NormalProblem, TangentialProblem

COARSEST = 24
"""A mesh is coarsened as long as its shorter side has more elements than this."""

COARSE_TOLERANCE = 1e-3
"""Residual asked for on coarser meshes: below their own discretisation error."""


def refine(values: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Bilinear interpolation of the last two axes to elements of half the size, cut to `shape`."""
    for axis in (-2, -1):
        v = np.moveaxis(values, axis, 0)
        before, after = np.concatenate((v[:1], v[:-1])), np.concatenate((v[1:], v[-1:]))
        fine = np.empty((2 * len(v), *v.shape[1:]))
        fine[::2] = 0.75 * v + 0.25 * before
        fine[1::2] = 0.75 * v + 0.25 * after
        values = np.moveaxis(fine, 0, axis)
    return values[..., : shape[0], : shape[1]]


def refine_traction(coarse: np.ndarray, bound: np.ndarray, fine_bound: np.ndarray) -> np.ndarray:
    """Tractions on the finer mesh, by their share of the bound, which is smooth up to the edge."""
    inside = bound > 0.0
    share = coarse / np.where(inside, bound, 1.0)
    nearest = distance_transform_edt(~inside, return_distances=False, return_indices=True)
    return refine(share[:, *nearest], fine_bound.shape) * fine_bound


def refine_pressure(pressure: np.ndarray, gap: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Pressure on the finer mesh, by a quantity that is smooth across the edge of contact.

    At a distance d from the edge the pressure inside rises like d^1/2 and the gap outside like
    d^3/2, so p² continues as -gap^2/3; the factor is the one of a Hertzian contact of line form,
    where gap = 2/3 p^3 continued, in the dimensionless units of the problem.
    """
    peak = pressure.max()
    if peak == 0.0:
        return np.zeros(shape)
    outside = np.cbrt(np.maximum(1.5 * gap / peak, 0.0)) ** 2
    continued = np.where(pressure > 0.0, (pressure / peak) ** 2, -outside)
    return peak * np.sqrt(np.maximum(refine(continued, shape), 0.0))


def _shorter_side(problem: NormalProblem | TangentialProblem | CoupledProblem) -> int:
    """Elements of a mesh along its shorter side, of those along which it can be coarsened."""
    mesh = problem.half_space.mesh
    return min(n for n, block in zip(mesh.shape, mesh.block, strict=True) if block > 1)


Solve = Callable[..., Outcome]


def nested_tangential(problem: TangentialProblem, tolerance: float, solve: Solve) -> Outcome:
    """Solve on successively finer meshes, each started from the one before."""
    if _shorter_side(problem) <= COARSEST:
        return solve(problem, tolerance)
    coarse_problem = problem.coarsened()
    coarse = nested_tangential(coarse_problem, max(tolerance, COARSE_TOLERANCE), solve)
    if np.isfinite(coarse.residual):
        traction = refine_traction(coarse.traction, coarse_problem.bound, problem.bound)
        fine = solve(problem, tolerance, traction=traction, creepage=coarse.creepage)
    else:
        fine = solve(problem, tolerance)
    return fine.after(coarse, coarse_problem.bound.size / problem.bound.size)


def nested_normal(problem: NormalProblem, tolerance: float, solve: Solve) -> Outcome:
    """Solve on successively finer meshes, each started from the one before."""
    if _shorter_side(problem) <= COARSEST:
        return solve(problem, tolerance)
    coarse_problem = problem.coarsened()
    coarse = nested_normal(coarse_problem, max(tolerance, COARSE_TOLERANCE), solve)
    pressure = refine_pressure(coarse.pressure, coarse.gap, problem.gap.shape)
    fine = solve(problem, tolerance, pressure=pressure)
    return fine.after(coarse, coarse_problem.gap.size / problem.gap.size)


def nested_coupled(
    problem: CoupledProblem,
    tolerance: float,
    solve: Callable[[CoupledProblem, float, Outcome], Outcome],
    begin: Callable[[CoupledProblem], Outcome],
) -> Outcome:
    """Solve on successively finer meshes, each started from the one before.

    The coarsest one, or the one above a coarser one that was not solved, starts from what `begin`
    finds.
    """
    coarse, share = None, 1.0
    if _shorter_side(problem) > COARSEST:
        coarse_problem = problem.coarsened()
        coarse = nested_coupled(coarse_problem, max(tolerance, COARSE_TOLERANCE), solve, begin)
        share = coarse_problem.gap.size / problem.gap.size
    if coarse is not None and coarse.converged and coarse.pressure.any():
        pressure = refine_pressure(coarse.pressure, coarse.gap, problem.gap.shape)
        traction = refine_traction(coarse.traction, coarse.pressure, pressure)
        return solve(
            problem, tolerance, replace(coarse, pressure=pressure, traction=traction)
        ).after(coarse, share)
    first = begin(problem)
    fine = solve(problem, tolerance, first).after(first)
    return fine if coarse is None else fine.after(coarse, share)
