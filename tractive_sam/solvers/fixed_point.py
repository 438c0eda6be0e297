"""The paper's projected iterations as maps: project(tractions - step * residual).

Uzawa's method repeats such a map, Anderson's accelerates it. The smooth modes of the slip operator
have almost imaginary eigenvalues A(k) (1 - exp(i k_x dx))/dx, for which |1 - r lambda| < 1 holds up
to r = dx/A(k): the usable step of the slip shrinks with the mesh. The bound with the largest A(k)
of the contact is safe, but no mode that long fits into it; what works best is a fixed multiple.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tractive_sam.kernels import friction
from tractive_sam.operators import HalfSpace
from tractive_sam.solvers.outcome import relative
from tractive_sam.solvers.problem import CoupledProblem, TangentialProblem

Array = np.ndarray


UZAWA_STEP = 5.5
"""Step of Uzawa's method over the bound: fastest at 31 x 31 and at 91 x 91 on the scene `spheres`,
where 8 and 10 times the bound diverge."""

ANDERSON_STEP = 16.0
"""Step under Anderson's acceleration, which tolerates and profits from longer ones."""


def slip_step(half_space: HalfSpace, contact: Array) -> float:
    """Bound on the step of the slip on a contact area (see the module)."""
    ones = np.where(contact, 1.0, 0.0)
    zero = np.zeros_like(ones)
    rows = (
        np.abs(half_space.tangential(np.stack(unit))).sum(axis=0).max()
        for unit in ((ones, zero), (zero, ones))
    )
    return 1.0 / max(rows)


def gap_step(half_space: HalfSpace, contact: Array) -> float:
    """Step of the gap: the inverse of a bound on the largest eigenvalue of A_nn on the contact."""
    return 1.0 / half_space.normal(np.where(contact, 1.0, 0.0)[None]).max()


@dataclass(frozen=True)
class Evaluation:
    """A map applied once.

    Attributes
    ----------
    image : ndarray
        The projected state.
    residual : float
        Natural residual of the state, relative.
    fields : dict
        Payload of an `Outcome`: the projected state is not among them, the state is.
    """

    image: Array
    residual: float
    fields: dict


class TangentialMap:
    """pi_t -> disc(pi_t - r sigma), paper eq. (13); states have the shape (2, n_x, n_y)."""

    def __init__(self, problem: TangentialProblem, boldness: float = UZAWA_STEP):
        self.problem = problem
        self.step = boldness * slip_step(problem.half_space, problem.bound > 0.0)

    def shorten(self, factor: float) -> None:
        """Multiply the step by a factor below one."""
        self.step *= factor

    @property
    def applications(self) -> int:
        """Applications of the slip operator so far."""
        return self.problem.half_space.slip.applications

    def admissible(self, state: Array) -> Array:
        """The nearest state within the friction bound."""
        out = np.empty_like(state)
        friction.project(state, self.problem.bound, out)
        return out

    def __call__(self, state: Array) -> Evaluation:
        """Evaluate the map once, at the cost of one application."""
        slip = self.problem.rigid + self.problem.half_space.slip(state)
        opposed = self.problem.friction_slip.opposed(slip, state)
        target = self.admissible(state - opposed)
        size = np.linalg.norm(target)
        residual = np.linalg.norm(target - state) / size if size > 0.0 else 0.0
        image = self.admissible(state - self.step * opposed)
        return Evaluation(image, float(residual), {"traction": state, "slip": slip})


class CoupledMap:
    """(pi_n, pi_t) -> both projections at once, paper section 7.5, steps (II)-(V).

    States have the shape (3, n_x, n_y). Equal materials need no coupled operator: the pressure
    then meets the tractions in the radius of the disc only.

    Parameters
    ----------
    problem : CoupledProblem
        The problem; under a load, `approach` is what `load_control` adjusts.
    contact : ndarray of bool
        Area for which the steps are chosen.
    wear : callable, optional
        (pressure, traction, slip) -> wear within the pass, in units of gap, added to the gap
        (step V).
    boldness : float
        Step of the slip over its bound.
    """

    def __init__(
        self,
        problem: CoupledProblem,
        contact: Array,
        wear: Callable[[Array, Array, Array], Array] | None = None,
        boldness: float = UZAWA_STEP,
    ):
        self.problem = problem
        self.wear = wear
        slip = boldness * slip_step(problem.half_space, contact)
        self.steps = np.array([gap_step(problem.half_space, contact), slip])
        self._dissimilar = problem.half_space.material.coupling != 0.0

    @property
    def applications(self) -> int:
        """Applications of the operator so far."""
        half_space = self.problem.half_space
        return (half_space.coupled if self._dissimilar else half_space.slip).applications

    def shorten(self, factor: float) -> None:
        """Multiply the steps by a factor below one."""
        self.steps = factor * self.steps

    def _response(self, state: Array) -> tuple[Array, Array]:
        half_space = self.problem.half_space
        if self._dissimilar:
            response = half_space.coupled(state)
            return response[0], response[1:]
        return half_space.normal(state[:1])[0], half_space.slip(state[1:])

    def admissible(self, state: Array) -> Array:
        """Pressure not negative, tractions within the bound it gives."""
        out = np.empty_like(state)
        np.maximum(state[0], 0.0, out=out[0])
        friction.project(state[1:], out[0], out[1:])
        return out

    def __call__(self, state: Array) -> Evaluation:
        """Evaluate the map once, at the cost of one application."""
        problem = self.problem
        lift, drag = self._response(state)
        slip = problem.rigid + drag
        gap = problem.gap + lift - problem.approach
        if self.wear is not None:
            gap = gap + self.wear(state[0], state[1:], slip)
        opposed = problem.half_space.friction_slip(state[0], gap).opposed(slip, state[1:])
        target = np.empty_like(state)
        target[0] = np.maximum(state[0] - gap, 0.0)
        friction.project(state[1:] - opposed, state[0], target[1:])
        missed = target - state
        residual = max(
            relative(np.linalg.norm(missed[k]), np.linalg.norm(target[k]))
            for k in (slice(1), slice(1, None))
        )
        fields = {"pressure": state[0], "traction": state[1:], "gap": gap, "slip": slip}
        of_gap, of_slip = self.steps
        image = state - np.concatenate(((of_gap * gap)[None], of_slip * opposed))
        return Evaluation(self.admissible(image), residual, fields)
