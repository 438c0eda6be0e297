"""Derivatives of forces and approach at a solved contact, from the matrix of a Newton step.

Pressure and scaled tractions, approach, and the unknown creepages for prescribed forces, together
w, satisfy R(w; q) = 0: no gap in contact, tractions that friction allows, prescribed resultants.
While no element changes its state,

    dw/dq = -(dR/dw)^-1 dR/dq,

with dR/dw the matrix of `solvers.newton`. Each parameter q needs one linear system for all
rows; the transpose would need one for each row, six instead of four. The direct effect of a
parameter, at constant w, is

xi_x, xi_y, spin
    the slip of the undeformed bodies, s~ = F (xi_x - spin y, xi_y + spin x), at the points of the
    stencil;
load, approach, forces
    the prescribed value. The bound of friction, the slip by the pressure and the opening ahead of
    the leading edge follow from the load through w;
mu_k
    the frame F = M R (`mechanics.frame`). With E = dF F^-1, which has 1/mu_k at (k, k) and is zero
    elsewhere, the tractions p_t = F^T p~ change by F^T (dp~ + E p~). The sum in brackets is the
    unknown, so that elastic slip, gap and forces follow from it alone: for constant p_t, the scaled
    tractions p~ change by -E p~, and the slip s~ = F s by E s~. A bound that falls with the slip s
    does not depend on that change; a strength, divided by mu, falls.

For bodies of equal material the pressure depends on the load only, so that every other column is
solved under a fixed pressure.

Friction that depends on temperature has a bound that depends on the heat of all elements: on the
heat due to every change above, and within the matrix on the heat due to every step (`_WarmSystem`).
"""

from collections.abc import Callable, Container
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from tractive_sam.contact.heat import friction_at_temperature, temperature_change
from tractive_sam.contact.model import Model
from tractive_sam.contact.steady import dimensionless_start
from tractive_sam.extra_packages import xarray
from tractive_sam.extras import check_extra
from tractive_sam.mechanics import Coulomb, FallingCoulomb
from tractive_sam.results import COLUMNS, State, index_by_name
from tractive_sam.schema import required, warn
from tractive_sam.solvers import Iterate, Problem, System, gmres, needed


@dataclass(frozen=True)
class LinearSolver:
    """GMRES with its settings, which solves the linear system of one column of a Jacobian.

    Attributes
    ----------
    tolerance : float
        Relative residual at which to stop.
    useless : float
        Relative residual, in tolerances, above which a solution is not used as a derivative.
    krylov, rounds : int
        Largest number of iterations, and of restarts.
    """

    tolerance: float = 1e-7
    useless: float = 100.0
    krylov: int = 150
    rounds: int = 4

    def solve(self, system: System, rhs: np.ndarray) -> np.ndarray:
        """Return the solution of a linear system; nan if GMRES is far from convergence."""
        size = np.linalg.norm(rhs)
        vector, residual, missed = np.zeros_like(rhs), rhs, size
        for _ in range(self.rounds):
            if missed <= self.tolerance * size:
                break
            goal = float(0.9 * self.tolerance * size / missed)
            step, _ = gmres(system.operator, system.preconditioner, residual, goal, self.krylov)
            vector += step
            residual = rhs - system.operator(vector)
            missed = np.linalg.norm(residual)
        useful = missed <= self.useless * self.tolerance * size
        return vector if useful else np.full_like(rhs, np.nan)


def check_jacobian(model: Model) -> None:
    """Raise an error for a model without a Jacobian (without friction, or xarray not installed).

    Raises
    ------
    ImportError
        If xarray is missing.
    ValueError
        If there is no friction, or if the patch is curved.
    """
    check_extra("xarray", "jacobian")
    if model.laws.friction is None:
        raise ValueError("jacobian: friction is needed; give the scene a [friction] table")
    for key, reason in model.scene.find_exclusions("jacobian").items():
        raise ValueError(f"jacobian: with {key}, {reason}")


def jacobian_of(
    model: Model,
    contact: State,
    only: Container[str] | None = None,
    solver: LinearSolver = LinearSolver(),
) -> "xarray.DataArray":
    """Return derivatives of forces and approach by prescribed quantities, at a solved contact.

    Parameters
    ----------
    model : Model
        Model that was solved.
    contact : State
        Solution of the model.
    only : container of str, optional
        Columns that are wanted; by default all but "mu". That one, for both coefficients of
        friction together, needs one linear system instead of two.
    solver : LinearSolver
        Accuracy of the linear systems.
    """
    if model.scene.friction is not None and model.scene.friction.temperature:
        heat = required(contact.heat, "heat")
        model = model.with_friction(friction_at_temperature(model, heat.temperature["A"]))
    systems = _Systems(model, contact, solver)
    rows, derivatives = systems.rows_and_derivatives()
    wanted = derivatives.keys() - {"mu"} if only is None else only
    columns = {k: compute() for k, compute in derivatives.items() if k in wanted}

    unsolved = [name for name, column in columns.items() if np.isnan(column).any()]
    if unsolved:
        warn(
            f"jacobian: the derivatives by {', '.join(unsolved)} are nan, as their linear systems "
            "did not converge; refine the mesh with grid.elements"
        )
    quantities = index_by_name(column.with_units_of(model.scene) for column in COLUMNS)
    names = (*rows, *columns)
    units = {name: quantities[name].unit if name in quantities else "1" for name in names}
    return xarray.DataArray(
        np.stack(list(columns.values()), axis=1),
        [("result", rows), ("parameter", list(columns))],
        attrs={
            "units": UnitsByName("; ".join(f"{name}: {unit}" for name, unit in units.items())),
            "operator_applications": systems.applications,
        },
    )


@dataclass(frozen=True, eq=False)
class _Systems:
    """Linear systems for the derivatives at a solved contact: for all fields, or tractions only."""

    model: Model
    contact: State
    solver: LinearSolver

    @cached_property
    def all_fields(self) -> "_Linearised":
        """Linearised problem whose unknowns are pressure and tractions."""
        return _Linearised(self.model, self._problem, self.contact, self.solver)

    @cached_property
    def tangential(self) -> "_Linearised":
        """Linearised problem at fixed pressure; for dissimilar bodies pressure is unknown too."""
        if self.model.elasticity.coupled:
            return self.all_fields
        pressure = needed(dimensionless_start(self.model, self.contact).pressure, "start.pressure")
        problem = self._problem.with_pressure(pressure, self.contact.gap / self.model.units.gap)
        return _Linearised(self.model, problem, self.contact, self.solver)

    @property
    def _problem(self) -> Problem:
        """Dimensionless problem of the model with the wear depth of the contact."""
        model, tilt = self.model, self.contact.tilt
        if model.scene.load.moment is not None:  # at the tilt that was found
            model = model.tilted(tilt)
        return model.problem((model.undeformed_gap + self.contact.wear) / model.units.gap)

    @property
    def applications(self) -> int:
        """Number of applications of the elastic operators in the systems so far."""
        used = {system for system in vars(self).values() if isinstance(system, _Linearised)}
        return sum(system.applications for system in used)

    def rows_and_derivatives(self) -> tuple[list[str], dict[str, Callable[[], np.ndarray]]]:
        """Return the names of the rows, and for each column a function that computes it."""
        rows = ["Qx", "Qy", "Mz"]
        derivatives: dict[str, Callable[[], np.ndarray]] = {}
        for k, creepage in enumerate(self.model.scene.contact_type.creepages):
            if (*self.model.free, False)[k]:
                force, rows[k] = rows[k], creepage
                derivatives[force] = partial(self.tangential.by_force, k)
            else:
                derivatives[creepage] = partial(self.tangential.by_creepages, *np.eye(3)[k])
        if self.model.load is None:
            rows.append("P")
            derivatives["approach"] = lambda: self.all_fields.by_approach()  # noqa: PLW0108 - built if called
        else:
            rows.append("approach")
            derivatives["P"] = lambda: self.all_fields.by_load()  # noqa: PLW0108 - built if called
        if type(self.model.laws.friction) in (Coulomb, FallingCoulomb):  # other laws may have no mu
            derivatives |= {
                f"mu{k + 1}": partial(self.tangential.by_mu, np.eye(2)[k]) for k in (0, 1)
            }
            derivatives["mu"] = partial(self.tangential.by_mu, np.ones(2))
        return rows, derivatives


class UnitsByName(str):
    """Units of rows and columns as a text, which netCDF can store; `units["Qx"]` is one unit.

    The text is "name: unit; ...".
    """

    def __getitem__(self, key: Any) -> str:
        """Return the unit of a row or column, or a part of the text."""
        if not isinstance(key, str):
            return super().__getitem__(key)
        return dict(part.split(": ", 1) for part in self.split("; "))[key]


class _WarmSystem(System):
    """Linear system in which the friction bound also changes with the heat of the step."""

    def __init__(self, problem: Problem, at: Iterate, warmed: Callable[..., np.ndarray | float]):
        self._bound_change = warmed
        super().__init__(problem, at, np.float64)

    def _rows(self, step: np.ndarray, response: np.ndarray) -> np.ndarray:
        """Return the linearised conditions, with the change of the friction bound by heat."""
        rows = super()._rows(step, response)
        change = self._bound_change(step[-2:], response[-2:])
        rows[-2:] -= self.at.ratio * change * self.at.law.direction
        return rows


class _Linearised:
    """A contact problem linearised at its solution, with derivatives of forces and approach.

    Every derivative has the shape (4,): Q_x or xi_x, Q_y or xi_y, M_z, approach or P.
    """

    def __init__(self, model: Model, problem: Problem, contact: State, solver: LinearSolver):
        self.model, self.problem, self.contact, self.solver = model, problem, contact, solver
        start = dimensionless_start(model, contact)
        self.at = Iterate(
            problem,
            needed(start.pressure, "start.pressure"),
            needed(start.traction, "start.traction"),
            start.approach,
            needed(start.creepage, "start.creepage"),
        )
        law = model.laws.friction
        self.warm = isinstance(law, FallingCoulomb) and law.warmth is not None
        self.system = (
            _WarmSystem(problem, self.at, self._bound_change)
            if self.warm
            else System(problem, self.at, np.float64)
        )
        self._force = model.units.pressure * model.grid.element_area
        self._none = np.zeros((3, *model.grid.elements))

    @property
    def applications(self) -> int:
        """Number of applications of the elastic operators so far."""
        return self.system.applications + 1  # the iterate's

    def by_creepages(self, *creepages: float) -> np.ndarray:
        """Return the derivatives of all results along a change of (longitudinal, lateral, spin)."""
        model = self.model
        slip = model.frame.slip_to_scaled(model.rigid_slip_by(*creepages)) / model.units.slip
        return self._derivatives(
            slip=self._slip_change(slip, self._none), bound=self._bound_change(self._none[1:], slip)
        )

    def by_force(self, axis: int) -> np.ndarray:
        """Return the derivatives of all results by the prescribed force on axis 0 (x) or 1 (y)."""
        prescribed = np.flatnonzero(self.model.free)
        return self._derivatives(forces=(prescribed == axis) / self._force)

    def by_load(self) -> np.ndarray:
        """Return the derivatives of all results by the prescribed load."""
        return self._derivatives(load=1.0 / self._force)

    def by_approach(self) -> np.ndarray:
        """Return the derivatives of all results by the prescribed approach."""
        gap = np.full(self.at.pressure.shape, -1.0 / self.model.units.gap)
        return self._derivatives(gap, self._slip_change(self._none[1:], self._none, gap))

    def by_mu(self, change: np.ndarray) -> np.ndarray:
        """Return the derivatives of all results along a change of the coefficients of friction.

        Parameters
        ----------
        change : ndarray, shape (2,)
            Change of mu1 and mu2; for a falling law, of the static coefficients.
        """
        at, law = self.at, self.model.laws.friction
        E = change / self.model.frame.mu
        # The unit of slip is proportional to the square of the larger coefficient.
        unit = 2.0 * self.model.frame.largest_by(change)
        slip = at.seen.stretched(at.slip, at.traction, E, unit)
        bound: np.ndarray | float = 0.0
        if isinstance(law, FallingCoulomb):
            # A bound depends on the slip itself, not on the scaled slip.
            framed = E[:, None, None] * at.seen.sticking(at.slip, at.traction)
            bound = law.by_mu(at.bound, change)
            if at.law.falling is not None:
                bound = bound - at.law.falling.change(framed, at.seen.bound)
        return self._derivatives(slip=slip, bound=bound, traction=-E[:, None, None] * at.traction)

    def _bound_change(self, traction: np.ndarray, slip: np.ndarray) -> np.ndarray | float:
        """Return the change of the friction bound due to the heat of changed tractions and slip."""
        model, law = self.model, self.model.laws.friction
        if not isinstance(law, FallingCoulomb) or law.warmth is None:
            return 0.0
        units, frame = model.units, model.frame
        warmer = temperature_change(
            model,
            self.contact,
            units.pressure * frame.to_physical(traction),
            model.stencil.at_centres(units.slip * frame.slip_to_physical(slip)),
        )
        degrees, factors = np.array(required(model.scene.friction, "friction").temperature).T
        steps = np.concatenate(([0.0], np.diff(factors) / np.diff(degrees), [0.0]))
        slope = steps[
            np.searchsorted(degrees, required(self.contact.heat, "heat").temperature["A"])
        ]
        change, bound = slope * warmer / law.warmth.factor, self.at.bound
        if bound.slope is not None and bound.slope.by_temperature_factor is not None:
            by_factor = np.stack((bound.slope.by_temperature_factor, self._none[0]))
            remembered = replace(bound.slope, by_slip=by_factor)
            return remembered.change(np.stack((change, self._none[0])))
        return np.where(bound.by_pressure > 0.0, bound.radius, 0.0) * change

    def _slip_change(self, slip: np.ndarray, fields: np.ndarray, gap=None) -> np.ndarray:
        """Return the change of slip in the friction law due to changes of slip, fields and gap."""
        at, gap = self.at, self._none[0] if gap is None else gap
        return at.seen.sticking_change(slip, at.traction, fields, gap, at.slip)

    def _derivatives(
        self, gap=0.0, slip=None, load=0.0, forces=0.0, bound=0.0, traction=None
    ) -> np.ndarray:
        """Return derivatives of (Qx, Qy, Mz, approach or load) from direct effects of a parameter.

        Parameters
        ----------
        gap, slip : ndarray
            Gap, and slip in the friction law.
        bound : ndarray
            Bound of the tractions, except for its dependence on the slip.
        load, forces : float and ndarray
            Prescribed load and forces.
        traction : ndarray
            Scaled tractions of constant physical ones.
        """
        model, system, at = self.model, self.system, self.at
        rhs = np.zeros(system.length)
        rows, under_load = system.fields(rhs), int(system.under_load)
        rows[:-2] = -np.where(at.active, gap, 0.0)
        if slip is not None:
            at.law.rows(self._none[1:] if traction is None else traction, slip, rows[-2:])
            rows[-2:] = at.ratio * (bound * at.law.direction - rows[-2:])
        border = rhs[system.size :]
        border[:under_load] = system.weight * load
        border[under_load:] = system.weight * at.ratio * forces

        vector = self.solver.solve(system, rhs)
        step, extra = system.fields(vector), vector[system.size :]
        force = self._force * model.frame.to_physical(step[-2:])
        x, y = model.grid.x[:, None], model.grid.y[None, :]
        moment = (x * force[1] - y * force[0]).sum()
        results = np.array([*force.sum(axis=(1, 2)), moment, 0.0])
        results[np.flatnonzero(model.free)] = model.units.slip * extra[under_load:]
        if under_load:
            results[3] = model.units.gap * extra[0]
        elif system.free:
            results[3] = self._force * step[0].sum()
        return results
