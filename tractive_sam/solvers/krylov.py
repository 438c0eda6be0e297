"""Krylov methods: for linear systems, and conjugate gradients for the normal problem.

Generalised minimal residuals store one vector of each iteration. Generalised conjugate residuals
store three; their solution is a sum of vectors that the operator has acted on, and so the response
to it is a sum as well.

Conjugate gradients are the projected method of Polonsky & Keer (1999), Wear 231, 206-219, with the
circulant inverse of the operator as preconditioner: on a contact area that no longer changes it
converges in about ten iterations on any mesh.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import hypot, inf, prod, sqrt
from typing import NamedTuple, Protocol

import numpy as np

from tractive_sam.compute import PlanCache, backend_of
from tractive_sam.kernels.linear_algebra import extend_basis, solve_triangle
from tractive_sam.operators import Lattice
from tractive_sam.results import Cost, Status
from tractive_sam.solvers.problem import NormalProblem, Note, Outcome, Start, closed, needed

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


_memory = PlanCache(np.empty, 4)
"""Array of a shape and a number type; the thread uses its memory again for the next system.

A system must therefore not solve another one of its size.
"""


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
    make = _memory if residual.nbytes <= 2**16 else np.empty
    space: np.ndarray = make((3, rows, residual.size), kind)
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
    shares = solve_triangle(triangle, along, k).astype(kind)
    vector, response = shares @ space[0, :k], shares @ space[1, :k, :size]
    return vector, response.reshape(system.shape)


@dataclass(frozen=True)
class ConjugateGradients:
    """Conjugate gradient solver for the normal problem without tractions, for load or approach.

    The operator of bodies that relax is not symmetric: `ActiveSets` solves their problem.

    Attributes
    ----------
    iterations : int
        Most iterations.
    """

    iterations: int = 500

    def solve(
        self, problem: NormalProblem, tolerance: float, start: Start | Outcome | None = None
    ) -> Outcome:
        """Solve the normal problem to a tolerance, and return the outcome.

        Parameters
        ----------
        problem : NormalProblem
            The problem.
        tolerance : float
            Natural residual, relative, at which to stop.
        start : Start or Outcome, optional
            Initial guess; elements with zero pressure are assumed out of contact at first.
        """
        if not problem.operators.elasticity.symmetric:
            return ActiveSets().solve(problem, tolerance, start)
        pressure = _first_guess(problem)
        if start is not None:
            pressure = needed(start.pressure, "start.pressure")
            pressure = backend_of(pressure).xp.maximum(pressure, 0.0)
        at, status = _Iteration(problem, pressure), Status.OUT_OF_ITERATIONS
        for taken in range(self.iterations + 1):
            residual = natural_residual(at.pressure, at.gap, at.lattice)
            if residual <= tolerance:
                status = Status.CONVERGED
                break
            if taken == self.iterations or not at.advance():
                break
        return at.outcome(Note("conjugate gradients", status), residual, taken)


class _Iteration:
    """State of the conjugate gradients: pressure, displacement, gap, approach, last direction.

    Attributes
    ----------
    applications, preconditionings : int
        Work done.
    """

    def __init__(self, problem: NormalProblem, pressure: np.ndarray):
        self.problem, self.under_load = problem, problem.load is not None
        self.applications = self.preconditionings = 0
        self.backend, self.lattice = backend_of(pressure), problem.operators.lattice
        self._active = pressure < 0.0  # none yet
        self._response = pressure
        self._last: _Search | None = None
        self._set_pressure(pressure)

    def outcome(self, note: Note, residual: float, taken: int) -> Outcome:
        """Return the outcome of a method, with its status, after a number of iterations."""
        return Outcome(
            note.status,
            residual,
            taken,
            Cost(self.applications, self.preconditionings),
            pressure=_scale_to_load(self.problem, closed(self.pressure, self.gap)),
            gap=self.gap,
            approach=self.approach,
            trace=(note,),
        )

    def _set_pressure(self, pressure: np.ndarray) -> None:
        """Set the pressure, scaled to the load, and compute displacement and gap."""
        self.pressure = _scale_to_load(self.problem, pressure)
        self._set_lift(self._apply(self.pressure))

    def _set_lift(self, lift: np.ndarray) -> None:
        """Set the displacement by the pressure, and compute the approach and the gap."""
        self._lift, self.approach = lift, self.problem.approach
        gap = self.problem.gap + lift
        if self.under_load:
            # The approach is the one that the elements in contact have on average.
            xp, total = self.backend.xp, self.lattice.sum
            touching = xp.where(self.pressure > 0.0, xp.ones_like(gap), 0.0)
            self.approach = total(gap * touching) / total(touching)
        self.gap = gap - self.approach

    def advance(self) -> bool:
        """Minimise the energy along a new direction; return False if that has no minimum."""
        xp, dot = self.backend.xp, self.lattice.dot
        active = (self.pressure > 0.0) | (self.gap < 0.0)
        unchanged = bool(xp.all(active == self._active))
        self._active = active
        if self.under_load and not unchanged:
            self._response = self._precondition(xp.ones_like(self.gap))
        # The gap of the elements in contact, and of those that overlap, is the gradient.
        step = self._precondition(self.gap)
        if self.under_load:
            step = self._without_load(step)
        direction, product = step, dot(self.gap, step)
        if (last := self._last) is not None:
            # Polak-Ribiere: forgets directions of a contact area that has changed.
            beta = max(0.0, (product - dot(last.gap, step)) / last.product)
            direction = step + beta * xp.where(active, last.direction, 0.0)
            if self.under_load and not unchanged:
                # Elements of the former area must not change the load on this one.
                direction = self._without_load(direction)
        self._last = _Search(direction, self.gap, product)
        return self._minimise_along(direction)

    def close(self, active: np.ndarray, goal: float, steps: int) -> tuple[np.ndarray, np.ndarray]:
        """Close the gap of active elements; return the pressure, also of tension, and the gap.

        The iteration then has this pressure without tension.

        Parameters
        ----------
        active : ndarray of bool
            Elements that may carry pressure; at least one under a load.
        goal : float
            Relative residual of their gap.
        steps : int
            Most iterations.
        """
        if self.under_load and not active.any():
            active = self.gap == self.gap.min()
        self._active = active
        if np.any(self.pressure[~active]) or (self.under_load and not self.pressure.any()):
            self._set_pressure(np.where(active, self.pressure, 0.0))
        if self.under_load:
            self._response = self._precondition(np.ones(active.shape))
        step, lift = conjugate_residuals(_Closing(self), goal, steps)
        raw = self.pressure + step.reshape(active.shape)
        self.pressure = raw
        self._set_lift(self._lift + lift)
        if self.under_load:
            missed = self.mean(self.gap)
            self.gap, self.approach = self.gap - missed, self.approach + missed
        gap = self.gap
        if raw.min() < 0.0:
            self._set_pressure(np.maximum(raw, 0.0))
        return raw, gap

    def mean(self, gap: np.ndarray) -> float:
        """Return the mean of a gap over the active elements."""
        weights = 1.0 * self._active
        return self.lattice.sum(gap * weights) / self.lattice.sum(weights)

    def _minimise_along(self, direction: np.ndarray) -> bool:
        """Minimise along a direction, without tension; return False if that has no curvature."""
        xp, dot, change = self.backend.xp, self.lattice.dot, self._apply(direction)
        # Positive for any direction, but for gaps so wide that rounding leaves nothing of it.
        if not (curvature := dot(direction, change)) > 0.0:
            return False
        length = dot(self.gap, direction) / curvature
        self.pressure = self.pressure - length * direction
        if xp.min(self.pressure) < 0.0:
            # Elements that would pull leave; then what was summed up no longer is the lift.
            self._set_pressure(xp.maximum(self.pressure, 0.0))
        else:
            self._set_lift(self._lift - length * change)
        return True

    def _apply(self, field: np.ndarray) -> np.ndarray:
        """Return the normal displacement by a pressure, and count the application."""
        self.applications += 1
        return self.problem.operators.normal(field[None, ...])[0, ...]

    def _precondition(self, gap: np.ndarray) -> np.ndarray:
        """Return the approximate pressure of the active elements that causes a gap."""
        self.preconditionings += 1
        where, inverse = self.backend.xp.where, self.problem.operators.normal_inverse
        gap = where(self._active, gap, 0.0)
        return where(self._active, inverse(gap[None, ...])[0, ...], 0.0)

    def _without_load(self, step: np.ndarray) -> np.ndarray:
        """Return a step of the pressure without the part that changes the load."""
        total = self.lattice.sum
        return step - self._response * (total(step) / total(self._response))


class _Closing:
    """Linear system for the change of pressure that closes the gap of the active elements.

    Under a load the gap is that less its mean, and the change has no load.
    """

    def __init__(self, at: _Iteration):
        self._at, self.shape = at, at.gap.shape

    def _rows(self, gap: np.ndarray) -> np.ndarray:
        """Return the gap of the active elements, less its mean under a load."""
        at = self._at
        return np.where(at._active, gap - (at.mean(gap) if at.under_load else 0.0), 0.0).ravel()

    def right_hand_side(self) -> np.ndarray:
        """Return the negative gap."""
        return -self._rows(self._at.gap)

    def preconditioner(self, vector: np.ndarray) -> np.ndarray:
        """Return the approximate change of pressure that causes a gap."""
        step = self._at._precondition(vector.reshape(self.shape))
        return (self._at._without_load(step) if self._at.under_load else step).ravel()

    def response(self, vector: np.ndarray) -> np.ndarray:
        """Return the displacement of all elements by a change of pressure."""
        return self._at._apply(vector.reshape(self.shape))

    def product(self, vector: np.ndarray, response: np.ndarray) -> np.ndarray:
        """Return the change of the gap of the active elements."""
        return self._rows(response)


class _Search(NamedTuple):
    """Last search direction, with the gap there and the product of gap and step."""

    direction: np.ndarray
    gap: np.ndarray
    product: float


@dataclass(frozen=True)
class ActiveSets:
    """Solver of the normal problem of operators that are not symmetric, but positive definite.

    In each step the gap of the active elements is closed by GMRES, preconditioned by the circulant
    inverse. Elements that pull then leave the contact, and those that overlap enter it (Newton's
    method for the natural residual). If the number of both no longer falls, only those change that
    are the worst; a single change at last always ends (Murty 1974, Linear Algebra Appl. 9, 65-108).

    Attributes
    ----------
    steps : int
        Most steps.
    krylov : int
        Most iterations of GMRES in a step.
    patience : int
        Steps without fewer wrong elements after which half as many as before may change.
    """

    steps: int = 200
    krylov: int = 150
    patience: int = 3

    def solve(
        self, problem: NormalProblem, tolerance: float, start: Start | Outcome | None = None
    ) -> Outcome:
        """Solve the normal problem; see `ConjugateGradients.solve`."""
        pressure = _first_guess(problem)
        if start is not None:
            pressure = np.maximum(needed(start.pressure, "start.pressure"), 0.0)
        at, status = _Iteration(problem, pressure), Status.OUT_OF_ITERATIONS
        active, since, part = at.pressure > 0.0, 0, 1.0
        fewest = active.size + 1
        for taken in range(self.steps + 1):
            residual = natural_residual(at.pressure, at.gap, at.lattice)
            if residual <= tolerance:
                status = Status.CONVERGED
                break
            if taken == self.steps:
                break
            raw, gap = at.close(active, max(0.1, 0.3 * tolerance / residual), self.krylov)
            wrong = np.where(active, raw, gap)  # of active elements that pull, others that overlap
            count = int(np.count_nonzero(wrong < 0.0))
            since = 0 if count < fewest else since + 1
            fewest = min(fewest, count)
            if since >= self.patience:
                since, part = 0, 0.5 * part
            if count:
                last = max(int(part * count), 1) - 1
                active = active ^ (wrong <= np.partition(wrong[wrong < 0.0], last)[last])
        return at.outcome(Note("active sets", status), residual, taken)


def natural_residual(pressure: np.ndarray, gap: np.ndarray, lattice: Lattice) -> float:
    """Return |p - max(0, p - gap)| / |p|, zero exactly if Signorini's conditions hold."""
    missed = backend_of(pressure).xp.minimum(pressure, gap)
    size, distance = sqrt(lattice.dot(pressure, pressure)), sqrt(lattice.dot(missed, missed))
    return distance / size if size > 0.0 else float(distance > 0.0)


def _scale_to_load(problem: NormalProblem, pressure: np.ndarray) -> np.ndarray:
    """Return the pressure scaled to the prescribed load, if there is one."""
    if problem.load is None:
        return pressure
    xp, gap = backend_of(pressure).xp, problem.gap
    if not xp.any(pressure > 0.0):  # so small a contact that interpolation or a step has lost it
        pressure = xp.where(gap == xp.min(gap), xp.ones_like(gap), 0.0)
    return pressure * (problem.load / problem.operators.lattice.sum(pressure))


def _first_guess(problem: NormalProblem) -> np.ndarray:
    """Return an initial pressure: the depth to which the undeformed bodies overlap."""
    level, backend = problem.approach, backend_of(problem.gap)
    if problem.load is not None:
        level = float(np.median(backend.to_numpy(problem.gap)))
    return backend.xp.maximum(level - problem.gap, 0.0)
