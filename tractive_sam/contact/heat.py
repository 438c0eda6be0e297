"""Flash temperature of a solved contact: the division of frictional heat between the bodies.

In contact both surfaces have equal temperatures. With K_A, K_B the operators of flux to temperature
(`operators.heat`), q the frictional heat and w the part of it that flows into A,

    bulk_A + K_A w = bulk_B + K_B (q - w)

in contact, a linear system. For equal bodies with equal bulk temperatures w is q/2.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache

import numpy as np

from tractive_sam.contact.model import Model
from tractive_sam.mechanics import (
    FallingCoulomb,
    PerBody,
    TemperatureFactor,
    TemperatureScaledWear,
    WearConditions,
    WearLaw,
)
from tractive_sam.operators import SurfaceHeat
from tractive_sam.results import FlashTemperature, Grid, State, Status
from tractive_sam.schema import required
from tractive_sam.solvers import combine_images, gmres

surface_heat = lru_cache(maxsize=8)(SurfaceHeat)
"""The `SurfaceHeat` of its arguments, prepared on its first use."""


def temperatures_of(model: Model, contact: State) -> FlashTemperature:
    """Return the surface temperatures of a solved contact of a scene with [heat]."""
    heat = -_speed(model) * (contact.traction * contact.slip).sum(axis=0)
    return divide_heat(model, contact, heat, required(model.scene.heat, "heat").bulks)


def divide_heat(
    model: Model,
    contact: State,
    heat: np.ndarray,
    before: Mapping[str, np.ndarray | float],
    time: float = np.inf,
) -> FlashTemperature:
    """Return surface temperatures, with heat divided so that bodies are equally warm in contact.

    Parameters
    ----------
    model : Model
        The scene in numbers, with [heat].
    contact : State
        The contact, with its mesh and the elements that touch.
    heat : ndarray, shape (n_x, n_y)
        Frictional heat, mW/mm².
    before : mapping of str to float or ndarray, shape (n_x, n_y)
        Temperatures of A and B without that heat, degrees C.
    time : float
        Time since the heat began, s; by default the temperature is steady.
    """
    warm = _operators(model, contact.grid, time)
    into_A, residual = _heat_into_A(model, warm, heat, before["B"] - before["A"], contact.touching)
    flux = {"A": into_A, "B": heat - into_A}
    temperature = {body: before[body] + warm[body](flux[body]) for body in warm}
    return FlashTemperature(contact.grid, contact.touching, temperature, flux, residual)


def temperature_change(
    model: Model, contact: State, traction: np.ndarray, slip: np.ndarray
) -> np.ndarray:
    """Return the temperature change (n_x, n_y), K, due to small changes of tractions and slip.

    Parameters
    ----------
    model : Model
        The scene in numbers.
    contact : State
        The contact that changes.
    traction, slip : ndarray, shape (2, n_x, n_y)
        Changes of the tractions, MPa, and of s/V.
    """
    warm = _operators(model, contact.grid)
    heat = (contact.traction * slip + traction * contact.slip).sum(axis=0)
    heat *= -_speed(model)
    return warm["A"](_heat_into_A(model, warm, heat, 0.0, contact.touching)[0])


def _speed(model: Model) -> float:
    """Return the rolling speed of the scene, mm/s."""
    return required(model.scene.creepage.speed, "creepage.speed")


def _operators(model: Model, grid: Grid, time: float = np.inf) -> dict[str, SurfaceHeat]:
    """Return the operator from heat flux to temperature for each body."""
    speed = _speed(model)
    return {
        body: surface_heat(grid, speed, thermal.diffusivity, thermal.conductivity, time)
        for body, thermal in model.scene.thermal.items()
    }


def _heat_into_A(
    model: Model,
    warm: dict[str, SurfaceHeat],
    heat: np.ndarray,
    colder: np.ndarray | float,
    touching: np.ndarray,
) -> tuple[np.ndarray, float]:
    """Return the frictional heat that flows into A, and the residual of equal temperatures.

    Equal, equally warm bodies receive half of the heat each.
    """
    thermal = model.scene.thermal
    if thermal["A"] == thermal["B"] and not np.any(colder):
        return 0.5 * heat, 0.0
    return _solve_division(warm["A"], warm["B"], heat, colder, touching)


def _solve_division(
    A: SurfaceHeat,
    B: SurfaceHeat,
    heat: np.ndarray,
    colder: np.ndarray | float,
    touching: np.ndarray,
) -> tuple[np.ndarray, float]:
    """Return the heat that flows into A so that both are equally warm in contact; the residual."""
    krylov = 200
    # Relative residual of the equality of both temperatures.
    tolerance = 1e-12
    inverse = A.inverse_with(B)

    def spread(values: np.ndarray) -> np.ndarray:
        field = np.zeros(touching.shape)
        field[touching] = values
        return field

    def operator(values: np.ndarray) -> np.ndarray:
        field = spread(values)
        return (A(field) + B(field))[touching]

    rhs = (B(heat) + colder)[touching]
    solution, residual, size = np.zeros_like(rhs), rhs, np.linalg.norm(rhs)
    for _ in range(4):  # restarts reduce rounding errors
        missed = np.linalg.norm(residual)
        if missed <= tolerance * size:
            return spread(solution), 0.0
        step, _ = gmres(
            operator,
            lambda values: inverse(spread(values)[None])[0][touching],
            residual,
            float(0.5 * tolerance * size / missed),
            krylov,
        )
        solution = solution + step
        residual = rhs - operator(solution)
    return spread(solution), float(np.linalg.norm(residual) / size)


def with_heat(model: Model, contact: State) -> State:
    """Return a contact with temperatures, computed if the scene has [heat] and they are missing."""
    if model.scene.heat is None or contact.heat is not None:
        return contact
    return _attach_heat(contact, temperatures_of(model, contact))


def _attach_heat(contact: State, heat: FlashTemperature) -> State:
    """Return a contact with temperatures; it is not converged if these are not."""
    if not heat.shortfall or not contact.converged:
        return replace(contact, heat=heat)
    return replace(contact, heat=heat, status=Status.OUT_OF_ITERATIONS, note=heat.shortfall)


def wear_conditions(
    model: Model, contact: State, depth: np.ndarray | None = None
) -> WearConditions:
    """Return depth (default: the entering one), revolution and temperature, for a wear law."""
    heat = with_heat(model, contact).heat
    temperature = None if heat is None else heat.temperature["A"]  # equal to B's in contact
    entering = contact.wear[-1] if depth is None else depth
    return WearConditions(entering, float(contact.revolution), temperature)


def wear_law_at(model: Model, contact: State) -> WearLaw | None:
    """Return the wear law at the depth, revolution and temperature of a contact, or None."""
    if model.laws.wear is None:
        return None
    scene, conditions = model.scene, wear_conditions(model, contact)
    temperature = conditions.temperature
    if scene.friction is not None and scene.friction.temperature is not None:
        friction = friction_at_temperature(model, required(temperature, "heat"))
        model = model.with_friction(friction)
    law = required(model.wear_law, "wear").under(conditions)
    if scene.wear is None or not scene.wear.temperature:
        return law
    degrees, factors = np.array(scene.wear.temperature).T
    local = np.interp(required(temperature, "heat"), degrees, factors)
    if isinstance(law, PerBody):
        return law.map_laws(lambda part: TemperatureScaledWear(part, local))
    return TemperatureScaledWear(law, local)


def friction_at_temperature(model: Model, temperature: np.ndarray) -> FallingCoulomb:
    """Return the friction law at surface temperatures (n_x, n_y); raise if it depends on none.

    As `Laws.friction`, it is not yet a law on the rows of the mesh (`FrictionLaw.on_rows`).

    Raises
    ------
    ValueError
        If the law cannot depend on temperature.
    """
    law = model.laws.friction
    if not isinstance(law, FallingCoulomb):
        raise ValueError(
            f"friction.temperature: the friction law {type(law).__name__} replaces that of the "
            "scene, and does not depend on temperature; remove the key, or use a FallingCoulomb"
        )
    degrees, factors = np.array(required(model.scene.friction, "friction").temperature).T
    bulks, shares = required(model.scene.heat, "heat").bulks, shares_of_instant_heat(model)
    entering = sum(share * bulks[body] for body, share in shares.items())
    warmth = TemperatureFactor(
        model.grid.x,
        model.grid.y,
        np.interp(temperature, degrees, factors),
        float(np.interp(entering, degrees, factors)),
    )
    return replace(law, warmth=warmth)


def shares_of_instant_heat(model: Model) -> dict[str, float]:
    """Return the shares of both bodies in heat that appears at once, by their effusivities.

    They are also the weights of the bulk temperatures in the temperature of first contact.
    """
    effusivity = {
        body: thermal.conductivity / thermal.diffusivity**0.5
        for body, thermal in model.scene.thermal.items()
    }
    total = sum(effusivity.values())
    return {body: value / total for body, value in effusivity.items()}


def solve_with_heat(
    model: Model, solve: Callable[[Model, State | None], State], start: State | None
) -> State:
    """Solve a contact with its temperatures, iterated if friction depends on temperature.

    If friction depends on temperature, contact and temperature are solved in turn, each contact
    from the one before; the temperatures are combined so that they change least (Anderson 1965,
    J. ACM 12, 547-560).

    Parameters
    ----------
    model : Model
        The scene in numbers.
    solve : callable
        (model, start) -> contact.
    start : State, optional
        A contact nearby, as initial guess.
    """
    # Number of earlier temperatures that the iteration of temperature and friction combines.
    memory = 5
    # Largest number of contacts that are solved until friction and temperature agree.
    max_contacts = 40
    table = model.scene.friction and model.scene.friction.temperature
    if not table:
        return with_heat(model, solve(model, start))
    bulk = required(model.scene.heat, "heat").bulks
    temperature = np.full(model.grid.elements, 0.5 * (bulk["A"] + bulk["B"]))
    if start is not None:
        temperature = temperatures_of(model, start).temperature["A"]
    temperatures: list[np.ndarray] = []
    changes: list[np.ndarray] = []
    tolerance = model.scene.solver.tolerance
    cost = None
    for _ in range(max_contacts):
        warm = model.with_friction(friction_at_temperature(model, temperature))
        contact = solve(warm, start)
        cost = contact.cost if cost is None else cost + contact.cost
        heat = temperatures_of(model, contact)
        contact = replace(_attach_heat(contact, heat), cost=cost)
        new = heat.temperature["A"]  # equal to B's in contact
        missed = np.abs(new - temperature)[contact.touching].max(initial=0.0)
        rise = np.abs(new - bulk["A"])[contact.touching].max(initial=0.0)
        if not contact.converged or missed <= tolerance * max(rise, 1.0):
            return contact
        # Warmer surfaces have less friction and less heat: without the combination both may
        # oscillate without end if friction falls steeply.
        temperatures = [*temperatures[-memory:], new]
        changes = [*changes[-memory:], new - temperature]
        temperature, start = combine_images(temperatures, changes), contact
    cure = "let friction.temperature fall less steeply, or raise solver.tolerance"
    note = f"not converged: friction and temperature still differ by {missed:.1e} K; {cure}"
    return replace(contact, status=Status.OUT_OF_ITERATIONS, note=note)
