"""Flash temperature of a solved contact: how the heat of friction is shared between the bodies.

Where they touch both surfaces are equally warm: with K_A, K_B the operators of flux to temperature
(`operators.heat`), q the heat made and w what of it goes into A,

    bulk_A + K_A w = bulk_B + K_B (q - w)

in contact, one linear system. Of equal bodies of equal bulk w is q/2, whatever the contact.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache

import numpy as np

from tractive_sam.contact.model import Model
from tractive_sam.mechanics import (
    ArchardByWork,
    FallingCoulomb,
    PerBody,
    TemperatureFactor,
    TemperatureScaledWear,
    WearConditions,
    WearLaw,
)
from tractive_sam.operators import SurfaceHeat
from tractive_sam.results import FlashTemperature, Grid, State, Status
from tractive_sam.solvers import combined, gmres

TOLERANCE = 1e-12
"""Relative residual of the equality of both temperatures."""

KRYLOV = 200

MOST = 40
"""Most contacts that are solved for friction and temperature to agree."""

MEMORY = 5
"""Temperatures that are combined with the last one on the way to those that friction answers to."""


@lru_cache(maxsize=8)
def surface_heat(
    grid: Grid, speed: float, diffusivity: float, conductivity: float, time: float = np.inf
) -> SurfaceHeat:
    """Return the operator of a body on a mesh, a time after the flux began, s."""
    return SurfaceHeat(grid, speed, diffusivity, conductivity, time)


def heat_of(model: Model, contact: State) -> FlashTemperature:
    """Temperatures of a solved contact of a scene with [heat].

    Raises
    ------
    RuntimeError
        If the linear system was not solved, which no material should bring about.
    """
    made = -model.scene.creepage.speed * (contact.traction * contact.slip).sum(axis=0)
    return divide_heat(model, contact, made, model.scene.heat.bulks)


def divide_heat(
    model: Model,
    contact: State,
    made: np.ndarray,
    before: Mapping[str, np.ndarray | float],
    time: float = np.inf,
) -> FlashTemperature:
    """Divide the heat of friction so that both surfaces are equally warm in contact.

    Parameters
    ----------
    model : Model
        The scene in numbers, with [heat].
    contact : State
        The contact: its mesh, and where it touches.
    made : ndarray, shape (n_x, n_y)
        Heat that friction makes, mW/mm².
    before : mapping of str to float or ndarray, shape (n_x, n_y)
        Temperatures of A and B without that heat, degrees C.
    time : float
        Time since it began to be made, s; by default the temperature is steady.

    Raises
    ------
    RuntimeError
        If the linear system was not solved.
    """
    warm = _warm(model, contact.grid, time)
    into_A = _into_A(model, warm, made, before["B"] - before["A"], contact.touching)
    flux = {"A": into_A, "B": made - into_A}
    temperature = {body: before[body] + warm[body](flux[body]) for body in warm}
    return FlashTemperature(contact.grid, contact.touching, temperature, flux)


def warming(model: Model, contact: State, traction: np.ndarray, slip: np.ndarray) -> np.ndarray:
    """Change of the temperature in contact by a change of tractions and slip, K, (n_x, n_y).

    Parameters
    ----------
    model : Model
        The scene in numbers.
    contact : State
        Where it changes.
    traction, slip : ndarray, shape (2, n_x, n_y)
        Changes, MPa, and of s/V.
    """
    warm = _warm(model, contact.grid)
    made = (contact.traction * slip + traction * contact.slip).sum(axis=0)
    made *= -model.scene.creepage.speed
    return warm["A"](_into_A(model, warm, made, 0.0, contact.touching))


def _warm(model: Model, grid: Grid, time: float = np.inf) -> dict[str, SurfaceHeat]:
    """The operators of both bodies."""
    speed = model.scene.creepage.speed
    return {
        body: surface_heat(grid, speed, one.diffusivity, one.conductivity, time)
        for body, one in model.scene.thermal.items()
    }


def _into_A(
    model: Model,
    warm: dict[str, SurfaceHeat],
    made: np.ndarray,
    colder: np.ndarray | float,
    touching: np.ndarray,
) -> np.ndarray:
    """Return the heat that flows into A; bodies of equal material and temperature share by half."""
    thermal = model.scene.thermal
    if thermal["A"] == thermal["B"] and not np.any(colder):
        return 0.5 * made
    return _shared(warm["A"], warm["B"], made, colder, touching)


def _shared(
    A: SurfaceHeat,
    B: SurfaceHeat,
    made: np.ndarray,
    colder: np.ndarray | float,
    touching: np.ndarray,
) -> np.ndarray:
    """What of the heat made goes into A, by equal temperatures in contact."""
    inverse = A.inverse_with(B)

    def spread(values: np.ndarray) -> np.ndarray:
        field = np.zeros(touching.shape)
        field[touching] = values
        return field

    def operator(values: np.ndarray) -> np.ndarray:
        field = spread(values)
        return (A(field) + B(field))[touching]

    rhs = (B(made) + colder)[touching]
    found, left, size = np.zeros_like(rhs), rhs, np.linalg.norm(rhs)
    for _ in range(4):  # again from what rounding leaves
        missed = np.linalg.norm(left)
        if missed <= TOLERANCE * size:
            return spread(found)
        step, _ = gmres(
            operator,
            lambda values: inverse(spread(values)[None])[0][touching],
            left,
            0.5 * TOLERANCE * size / missed,
            KRYLOV,
        )
        found = found + step
        left = rhs - operator(found)
    if np.linalg.norm(left) > 1e-9 * size:
        raise RuntimeError(f"heat: shared to {np.linalg.norm(left) / size:.1e} only")
    return spread(found)


def with_heat(model: Model, contact: State) -> State:
    """A contact with its temperatures: neither a results file nor a wider mesh tells them."""
    if model.scene.heat is None or contact.heat is not None:
        return contact
    return replace(contact, heat=heat_of(model, contact))


def wear_law_in(model: Model, contact: State) -> WearLaw | None:
    """Return the law of wear in a contact: at its revolution, depth and heat, by its friction."""
    law, scene = model.wear_law, model.scene
    if law is None:
        return law
    temperature = None
    if scene.heat is not None:
        heat = with_heat(model, contact).heat
        temperature = heat.temperature["A"]  # where they touch, that of B too
    law = law.under(WearConditions(contact.wear[-1], float(contact.revolution), temperature))

    def of(one: WearLaw) -> WearLaw:
        if isinstance(one, ArchardByWork) and one.friction:
            warm = scene.friction.temperature is not None
            rows = model.grid.y
            friction = in_warmth(model, temperature) if warm else one.friction.on_rows(rows)
            one = replace(one, friction=friction, length=model.grid.dx)
        if scene.wear is not None and scene.wear.temperature:
            one = TemperatureScaledWear(
                one, np.interp(temperature, *np.array(scene.wear.temperature).T)
            )
        return one

    return law.map_laws(of) if isinstance(law, PerBody) else of(law)


def in_warmth(model: Model, temperature: np.ndarray) -> FallingCoulomb:
    """The law of friction at temperatures of the surface, shape (n_x, n_y).

    Raises
    ------
    ValueError
        If the law is not of those that may answer to them.
    """
    law = model.friction_law
    if not isinstance(law, FallingCoulomb):
        raise ValueError(
            f"friction.temperature: the law of friction in place of the scene's, "
            f"{type(law).__name__}, knows no temperature; leave the key out, or give a "
            "FallingCoulomb"
        )
    degrees, factors = np.array(model.scene.friction.temperature).T
    warmth = TemperatureFactor(model.grid.x, model.grid.y, np.interp(temperature, degrees, factors))
    return replace(law, warmth=warmth)


def warmed(
    model: Model, solve: Callable[[Model, State | None], State], start: State | None
) -> State:
    """The contact of a scene with [heat] and its temperatures, to which friction may answer.

    Where it does, contact and temperature are solved in turn, each contact from the one before;
    the temperatures are combined so that they change least (Anderson 1965, J. ACM 12, 547-560).

    Parameters
    ----------
    model : Model
        The scene in numbers.
    solve : callable
        (model, start) -> contact.
    start : State, optional
        A contact nearby.
    """
    table = model.scene.friction and model.scene.friction.temperature
    if not table:
        return with_heat(model, solve(model, start))
    bulk = model.scene.heat.bulks
    temperature = np.full(model.grid.elements, 0.5 * (bulk["A"] + bulk["B"]))
    if start is not None:
        temperature = heat_of(model, start).temperature["A"]
    found: list[np.ndarray] = []
    changes: list[np.ndarray] = []
    tolerance = model.scene.solver.tolerance
    cost = None
    for _ in range(MOST):
        warm = model.with_friction(in_warmth(model, temperature))
        contact = solve(warm, start)
        cost = contact.cost if cost is None else cost + contact.cost
        heat = heat_of(model, contact)
        contact = replace(contact, heat=heat, cost=cost)
        now = heat.temperature["A"]  # where they touch, that of B too
        missed = np.abs(now - temperature)[contact.touching].max(initial=0.0)
        rise = np.abs(now - bulk["A"])[contact.touching].max(initial=0.0)
        if not contact.converged or missed <= tolerance * max(rise, 1.0):
            return contact
        # Warmer surfaces have less friction and make less heat: in turn alone the two may swing for
        # ever, where friction falls steeply.
        found, changes = [*found[-MEMORY:], now], [*changes[-MEMORY:], now - temperature]
        temperature, start = combined(found, changes), contact
    cure = "let friction.temperature fall less steeply, or raise solver.tolerance"
    note = f"not converged: friction and temperature differ by {missed:.1e} K still; {cure}"
    return replace(contact, status=Status.OUT_OF_ITERATIONS, note=note)
