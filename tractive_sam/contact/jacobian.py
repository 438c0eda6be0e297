"""Derivatives of forces and approach at a solved contact, from the matrix of a Newton step.

Pressure and scaled tractions, approach, and the unknown creepages for prescribed forces, together
w, satisfy R(w; q) = 0: no gap in contact, tractions that friction allows, prescribed resultants.
While no element changes its state,

    dw/dq = -(dR/dw)^-1 dR/dq,

with dR/dw the matrix of `solvers.newton_system`. Each parameter q needs one linear system for all
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
    elsewhere, the tractions p_t = F^T p~ change as if p~ changed by E p~, and with them elastic
    slip, gap and forces; and the slip s~ = F s changes by E s~. A bound that falls with the slip s
    does not depend on that change; a strength, divided by mu, falls.

The tractions then change by F^T (dp~ + E p~). For bodies of equal material the pressure depends on
the load only, so that every other column is solved under a fixed pressure.

Friction that depends on temperature has a bound that depends on the heat of all elements: on the
heat due to every change above, and within the matrix on that of every step (`_WarmSystem`).
"""

from collections.abc import Callable, Container, Mapping
from functools import partial
from typing import Any, Self

import numpy as np

from tractive_sam.contact.heat import friction_at_temperature, temperature_change
from tractive_sam.contact.model import Model
from tractive_sam.contact.steady import dimensionless_start
from tractive_sam.extras import check_extra
from tractive_sam.mechanics import Coulomb, FallingCoulomb
from tractive_sam.optional import xarray
from tractive_sam.results import COLUMNS, State, index_by_name
from tractive_sam.schema import required, warn
from tractive_sam.solvers import Iterate, Problem, System, gmres, needed

TOLERANCE = 1e-7
"""Relative residual of a linear system."""

USELESS = 1e-5
"""Relative residual above which a solution is not used as a derivative."""

KRYLOV, ROUNDS = 150, 4
"""Largest number of iterations of GMRES, and of its restarts."""


def check_jacobian(model: Model) -> None:
    """Refuse, before anything is solved, what has no Jacobian.

    Raises
    ------
    ImportError
        If xarray is missing.
    ValueError
        If there is no friction.
    """
    check_extra("xarray", "jacobian")
    if model.laws.friction is None:
        raise ValueError("jacobian: friction is needed; give the scene a [friction] table")


def jacobian_of(
    model: Model, contact: State, only: Container[str] | None = None
) -> "xarray.DataArray":
    """Derivatives at a solved contact, on its mesh; see `State.jacobian`.

    Parameters
    ----------
    model : Model
        What was solved.
    contact : State
        Its solution.
    only : container of str, optional
        Columns that are wanted; by default all.
    """
    if model.scene.friction is not None and model.scene.friction.temperature:
        heat = required(contact.heat, "heat")
        model = model.with_friction(friction_at_temperature(model, heat.temperature["A"]))
    gap = (model.undeformed_gap + contact.wear) / model.units.gap
    all_fields = tangential = _Linearised(model, model.problem(gap), contact)
    if not model.elasticity.coupled:
        tangential = all_fields.with_fixed_pressure()
    rows = ["Qx", "Qy", "Mz"]
    derivatives: dict[str, Callable[[], np.ndarray]] = {}
    for k, creepage in enumerate(model.scene.contact_type.creepages):
        if (*model.free, False)[k]:
            force, rows[k] = rows[k], creepage
            derivatives[force] = partial(tangential.by_force, k)
        else:
            derivatives[creepage] = partial(tangential.by_creepages, *np.eye(3)[k])
    if model.load is None:
        rows.append("P")
        derivatives["approach"] = all_fields.by_approach
    else:
        rows.append("approach")
        derivatives["P"] = all_fields.by_load
    if type(model.laws.friction) in (Coulomb, FallingCoulomb):  # other laws may have no mu
        derivatives |= {f"mu{k + 1}": partial(tangential.by_mu, k) for k in (0, 1)}
    columns = {k: compute() for k, compute in derivatives.items() if only is None or k in only}

    unsolved = [name for name, column in columns.items() if np.isnan(column).any()]
    if unsolved:
        warn(f"jacobian: the linear systems of {', '.join(unsolved)} were not solved: nan")
    quantities = index_by_name(column.with_units_of(model.scene) for column in COLUMNS)
    names = (*rows, *columns)
    units = {name: quantities[name].unit if name in quantities else "1" for name in names}
    cost = sum(problem.applications for problem in {all_fields, tangential})
    return xarray.DataArray(
        np.stack(list(columns.values()), axis=1),
        [("result", rows), ("parameter", list(columns))],
        attrs={"units": UnitsByName.from_mapping(units), "operator_applications": cost},
    )


class UnitsByName(str):
    """Units of rows and columns as a text, which netCDF can store; ``units["Qx"]`` is a unit."""

    @classmethod
    def from_mapping(cls, units: Mapping[str, str]) -> Self:
        """Return the text of units by name."""
        return cls("; ".join(f"{name}: {unit}" for name, unit in units.items()))

    def __getitem__(self, key: Any) -> str:
        """Return the unit of a row or column, or a part of the text."""
        if not isinstance(key, str):
            return super().__getitem__(key)
        return dict(part.split(": ", 1) for part in self.split("; "))[key]


class _WarmSystem(System):
    """The linear system with a bound that depends on the heat of all steps."""

    def __init__(self, problem: Problem, at: Iterate, warmed: Callable[..., np.ndarray | float]):
        self._bound_change = warmed
        super().__init__(problem, at, np.float64)

    def _rows(self, step: np.ndarray, response: np.ndarray) -> np.ndarray:
        """Return the linearised conditions with the change of the bound by heat."""
        rows = super()._rows(step, response)
        change = self._bound_change(step[-2:], response[-2:])
        rows[-2:] -= self.at.ratio * change * self.at.law.direction
        return rows


class _Linearised:
    """A problem linearised at its solution, and the derivatives of results by parameters.

    Every derivative has the shape (4,): Q_x or xi_x, Q_y or xi_y, M_z, approach or P.
    """

    def __init__(self, model: Model, problem: Problem, contact: State):
        self.model, self.problem, self.contact = model, problem, contact
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
        self._applications = 1  # in addition to those of the system
        self._force = model.units.pressure * model.grid.element_area
        self._none = np.zeros((3, *model.grid.elements))

    def with_fixed_pressure(self) -> "_Linearised":
        """Return the tangential problem under the pressure of this one."""
        problem = self.problem.with_pressure(self.at.pressure, self.at.gap)
        return _Linearised(self.model, problem, self.contact)

    @property
    def applications(self) -> int:
        """Number of applications of the elastic operators so far."""
        return self.system.applications + self._applications

    def by_creepages(self, *creepages: float) -> np.ndarray:
        """Return the derivatives by creepages (longitudinal, lateral, spin)."""
        model = self.model
        slip = model.frame.slip_to_scaled(model.rigid_slip_by(*creepages)) / model.units.slip
        return self._derivatives(
            slip=self._slip_change(slip, self._none), bound=self._bound_change(self._none[1:], slip)
        )

    def by_force(self, axis: int) -> np.ndarray:
        """Return the derivatives by the force prescribed along an axis."""
        prescribed = np.flatnonzero(self.model.free)
        return self._derivatives(forces=(prescribed == axis) / self._force)

    def by_load(self) -> np.ndarray:
        """Return the derivatives by the prescribed load."""
        return self._derivatives(load=1.0 / self._force)

    def by_approach(self) -> np.ndarray:
        """Return the derivatives by the prescribed approach."""
        gap = np.full(self.at.pressure.shape, -1.0 / self.model.units.gap)
        return self._derivatives(gap, self._slip_change(self._none[1:], self._none, gap))

    def by_mu(self, axis: int) -> np.ndarray:
        """Return the derivatives by a coefficient of friction; for a falling law the static one."""
        at, law = self.at, self.model.laws.friction
        E = np.eye(2)[axis] / self.model.frame.mu[axis]
        stretched = np.concatenate((self._none[:1], E[:, None, None] * at.traction))
        response = self.problem.response(stretched[-self.problem.shape[0] :])
        self._applications += 1
        gap = self._none[0] if self.problem.is_pressure_fixed else response[0]
        # The unit of slip is proportional to the square of the larger coefficient.
        unit = 2.0 * self.model.frame.largest_by(axis)
        turned = at.seen.stretched(at.slip, at.traction, E, unit)
        bound = self._bound_change(stretched[1:], response[-2:])
        if isinstance(law, FallingCoulomb):
            # A bound depends on the slip itself, not on the scaled slip.
            framed = E[:, None, None] * at.seen.sticking(at.slip, at.traction)
            bound = bound + law.by_mu(at.bound, axis)
            if at.law.falling is not None:
                bound = bound - at.law.falling.change(framed, at.seen.bound)
        return self._derivatives(
            gap,
            self._slip_change(response[-2:], stretched, gap) + turned,
            forces=-self.problem.forces.force(stretched[1:]),
            bound=bound,
            stretched=stretched[1:],
        )

    def _bound_change(self, traction: np.ndarray, slip: np.ndarray) -> np.ndarray | float:
        """Return the change of the bound by the heat of changed scaled tractions and slip."""
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
        follows = np.where(self.at.bound.by_pressure > 0.0, self.at.bound.radius, 0.0)
        return follows / law.warmth.factor * slope * warmer

    def _slip_change(self, slip: np.ndarray, fields: np.ndarray, gap=None) -> np.ndarray:
        """Return the change of the slip in the friction law, by that of slip, fields and gap."""
        at, gap = self.at, self._none[0] if gap is None else gap
        return at.seen.sticking_change(slip, at.traction, fields, gap, at.slip)

    def _derivatives(
        self, gap=0.0, slip=None, load=0.0, forces=0.0, bound=0.0, stretched=0.0
    ) -> np.ndarray:
        """Return the derivatives of the results from the direct effects of a parameter.

        Parameters
        ----------
        gap, slip : ndarray
            Gap, and slip in the friction law.
        bound : ndarray
            Bound of the tractions, except for its dependence on the slip.
        load, forces : float and ndarray
            Prescribed load and forces.
        stretched : ndarray
            Tractions, by their frame.
        """
        model, system, at = self.model, self.system, self.at
        rhs = np.zeros(system.length)
        rows, under_load = system.fields(rhs), int(system.under_load)
        rows[:-2] = -np.where(at.active, gap, 0.0)
        if slip is not None:
            at.law.rows(self._none[1:], slip, rows[-2:])
            rows[-2:] = at.ratio * (bound * at.law.direction - rows[-2:])
        border = rhs[system.size :]
        border[:under_load] = system.weight * load
        border[under_load:] = system.weight * at.ratio * forces

        vector = self._solve(rhs)
        step, extra = system.fields(vector), vector[system.size :]
        traction = self._force * model.frame.to_physical(step[-2:] + stretched)
        x, y = model.grid.x[:, None], model.grid.y[None, :]
        moment = (x * traction[1] - y * traction[0]).sum()
        results = np.array([*traction.sum(axis=(1, 2)), moment, 0.0])
        results[np.flatnonzero(model.free)] = model.units.slip * extra[under_load:]
        if under_load:
            results[3] = model.units.gap * extra[0]
        elif system.free:
            results[3] = self._force * step[0].sum()
        return results

    def _solve(self, rhs: np.ndarray) -> np.ndarray:
        """Solve the linear system; return nan without a solution."""
        system, size = self.system, np.linalg.norm(rhs)
        vector, residual, missed = np.zeros_like(rhs), rhs, size
        for _ in range(ROUNDS):
            if missed <= TOLERANCE * size:
                break
            goal = float(0.9 * TOLERANCE * size / missed)
            step, _ = gmres(system.operator, system.preconditioner, residual, goal, KRYLOV)
            vector += step
            residual = rhs - system.operator(vector)
            missed = np.linalg.norm(residual)
        return vector if missed <= USELESS * size else np.full_like(rhs, np.nan)
