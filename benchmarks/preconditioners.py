"""Preconditioners of a Newton step, on the dense matrix of the scene `spheres`.

The matrix belongs to the last Newton step of a steady solution on one mesh. Its unknowns are both
tractions of elements that stick, and the traction across the slip of elements that slip. The script
compares the preconditioner of the program with exact inverses of blocks of the matrix: of the rows
of elements along x or along y, and of the zones of stick and slip. Such inverses cannot be computed
on large meshes; they show what a better preconditioner could save at most.

Iterations are those of GMRES for a random right-hand side.

    python benchmarks/preconditioners.py [--meshes 31 61]

Page: docs/benchmarks.md
"""

import argparse
from collections.abc import Callable

import numpy as np
from scipy.linalg import lu_factor, lu_solve
from timing import show, write

from tractive_sam.contact import Model, equilibrium
from tractive_sam.kernels.friction import SLIP, STICK
from tractive_sam.scene import Scene
from tractive_sam.solvers import newton
from tractive_sam.solvers.krylov import gmres
from tractive_sam.solvers.newton import Iterate, System
from tractive_sam.solvers.problem import Problem

Map = Callable[[np.ndarray], np.ndarray]


class DenseSystem:
    """Matrix and preconditioner of the last Newton step on n x n elements, restricted to unknowns.

    Attributes
    ----------
    matrix, inverse : ndarray, shape (m, m)
        The Newton matrix, and the preconditioner of the program.
    stuck : int
        Number of unknowns of elements that stick; they come first.
    row, column : ndarray of int, shape (m,)
        Indices (i, j) of the element of each unknown.
    """

    def __init__(self, n: int):
        problem, at = last_step(n)
        system, state = System(problem, at, np.float64), at.law.state
        across = np.stack((-at.law.direction[1], at.law.direction[0]))
        sticks = np.broadcast_to(state == STICK, across.shape)
        slips = state == SLIP
        self.stuck, self.count = int(sticks.sum()), int(sticks.sum() + slips.sum())
        places = [np.nonzero(sticks)[1:], np.nonzero(slips)]
        self.row, self.column = (np.concatenate(indices) for indices in zip(*places, strict=True))

        def reduced(operator: Map) -> np.ndarray:
            columns = []
            for unit in np.eye(self.count):
                fields = np.zeros(across.shape)
                fields[sticks] = unit[: self.stuck]
                fields[:, slips] += across[:, slips] * unit[self.stuck :]
                out = operator(fields.ravel()).reshape(across.shape)
                columns.append(np.append(out[sticks], (across * out).sum(axis=0)[slips]))
            return np.stack(columns, axis=1)

        self.matrix, self.inverse = reduced(system.operator), reduced(system.preconditioner)

    def blocks(self, label: np.ndarray) -> Map:
        """Return the exact inverse of the blocks of unknowns with equal labels."""
        groups = [np.flatnonzero(label == value) for value in np.unique(label)]
        factors = [(group, lu_factor(self.matrix[np.ix_(group, group)])) for group in groups]

        def solve(vector: np.ndarray) -> np.ndarray:
            out = np.empty_like(vector)
            for group, factor in factors:
                out[group] = lu_solve(factor, vector[group])
            return out

        return solve

    def one_zone_after_the_other(self) -> Map:
        """Return the exact inverse of the stick zone, and of the slip zone with its tractions."""
        k = self.stuck
        stick, slip = lu_factor(self.matrix[:k, :k]), lu_factor(self.matrix[k:, k:])

        def solve(vector: np.ndarray) -> np.ndarray:
            first = lu_solve(stick, vector[:k])
            return np.append(first, lu_solve(slip, vector[k:] - self.matrix[k:, :k] @ first))

        return solve


def last_step(n: int) -> tuple[Problem, Iterate]:
    """Return the problem and the iterate before the last Newton step of a solution to 1e-8."""
    scene = Scene.builtin("spheres").with_set(
        [f"grid.elements=[{n}, {n}]", "solver.tolerance=1e-8"]
    )
    steps, create = [], newton.System

    def record(problem: Problem, at: Iterate, *arguments: object) -> System:
        steps.append((problem, at))
        return create(problem, at, *arguments)

    newton.System = record
    try:
        equilibrium(Model(scene))
    finally:
        newton.System = create
    return steps[-1]


def measure(n: int) -> list[dict]:
    """Return a row for each preconditioner on n x n elements."""
    dense = DenseSystem(n)
    zone = np.arange(dense.count) < dense.stuck
    preconditioners = {
        "none": lambda vector: vector,
        "program": lambda vector: dense.inverse @ vector,
        "exact, rows along x": dense.blocks(dense.column),
        "exact, rows along y": dense.blocks(dense.row),
        "exact, each zone": dense.blocks(zone),
        "exact, stick and then slip": dense.one_zone_after_the_other(),
    }
    rhs = np.random.default_rng(0).standard_normal(dense.count)
    rows = []
    for name, solve in preconditioners.items():
        combined = np.stack([dense.matrix @ solve(unit) for unit in np.eye(dense.count)], axis=1)
        iterations = {
            f"to {goal:.0e}": gmres(lambda v: dense.matrix @ v, solve, rhs, goal, 300)[1]
            for goal in (1e-2, 1e-4, 1e-8)
        }
        row = {"elements": f"{n} x {n}", "preconditioner": name, "unknowns": dense.count}
        rows.append(row | {"condition number": np.linalg.cond(combined)} | iterations)
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--meshes", type=int, nargs="+", default=(31, 61))
    rows = [row for n in parser.parse_args().meshes for row in measure(n)]
    show("Iterations for the last Newton step, by preconditioner", rows)
    print(f"written: {write('preconditioners', rows)}")


if __name__ == "__main__":
    main()
