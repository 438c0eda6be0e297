"""Checks of prescribed tangential forces: friction must be able to carry them."""

import math
from collections.abc import Iterator

from tractive_sam.mechanics import full_slip_force, load_to_carry
from tractive_sam.schema import Check, Fault, ValidEntries, shorten

from .line_contact import is_line


def _check_force_has_friction(entries: ValidEntries) -> Iterator[Fault]:
    """Report prescribed tangential forces without friction."""
    for key in ("load.force_x", "load.force_y"):
        if key in entries.given and entries["friction"] is None:
            yield Fault(
                key,
                "without friction",
                "a [friction] table: without friction there is no tangential force",
            )


def _check_force_limit(entries: ValidEntries) -> Iterator[Fault]:
    """Report prescribed forces above the friction limit in a scene without [transient]."""
    if entries["transient"] is not None:
        return  # `_check_force_limit_at_knots` covers it
    forces = entries["load.force_x"], entries["load.force_y"]
    angle = math.radians(entries["friction.angle"])
    for names, value, limit in _forces_above_limit(
        forces, _normal_load(entries), _largest_mu(entries), angle
    ):
        yield _limit_fault(entries, [f"load.{name}" for name in names], value, limit)


def _check_force_limit_at_knots(entries: ValidEntries) -> Iterator[Fault]:
    """Report the first knot at which forces exceed the friction limit of a known normal load."""
    transient, mu, largest = entries["transient"], entries["friction.mu"], _largest_mu(entries)
    if transient is None:
        return
    angle, constant = math.radians(entries["friction.angle"]), constant_quantities(entries)
    knots = (
        (table, stage, k) for table, stage in transient.by_key.items() for k in stage.knot_range
    )
    for table, stage, k in knots:
        values = stage.values_at(k, constant)
        forces = values["load.force_x"], values["load.force_y"]
        factor = values["friction.mu"] / mu[0]
        mu_at_knot = factor * largest[0], factor * largest[1]
        excess = [*_forces_above_limit(forces, values["load.normal"], mu_at_knot, angle)]
        for names, value, limit in excess:
            given = (f"load.{name}" for name in names)
            keys = [f"{table}.{key}" if key in stage.courses else key for key in given]
            unit = " mm" if stage.rolls else ""
            yield _limit_fault(entries, keys, f"{value} at {stage.distance[k]:g}{unit}", limit)
        if excess:
            return


def constant_quantities(entries: ValidEntries) -> dict[str, float | None]:
    """Return loads, forces and friction of [load] and [friction] by dotted key; None if not set."""
    keys = ("load.approach", "load.force_x", "load.force_y")
    values: dict[str, float | None] = {key: entries[key] for key in keys}
    return values | {"load.normal": _normal_load(entries), "friction.mu": entries["friction.mu"][0]}


def _check_method_of_forces(entries: ValidEntries) -> Iterator[Fault]:
    """Report a method that cannot compute the creepage of a prescribed force."""
    method = entries["solver.method"]
    forces = [k for k in ("load.force_x", "load.force_y") if entries[k] is not None]
    if method in ("uzawa", "anderson") and forces:
        text = f'"auto" or "newton", which compute the creepages of {" and ".join(forces)}'
        yield Fault("solver.method", shorten(method), text)


def _largest_mu(entries: ValidEntries) -> tuple[float, float]:
    """Return (mu1, mu2) at the lateral position with the largest friction."""
    mu1, mu2 = entries["friction.mu"]
    factor = 1.0 if entries["friction"] is None else entries["friction"].largest_factor
    return factor * mu1, factor * mu2


def _normal_load(entries: ValidEntries) -> float | None:
    """Return the normal load, or None if only the solution of the contact gives it."""
    if entries["load.pressure"] is not None:
        return entries["body"].normal_load(entries["load"])
    return entries["load.normal"]


def _forces_above_limit(
    forces: tuple[float | None, float | None],
    load: float | None,
    mu: tuple[float, float],
    angle: float,
) -> Iterator[tuple[tuple[str, ...], str, float]]:
    """Yield (names, value as text, limit) of forces that friction cannot transmit."""
    if load is None:
        return
    force_x, force_y = forces
    if force_x is not None and force_y is not None:
        share = load_to_carry((force_x, force_y), mu, angle) / load
        if share >= 1:
            limit = math.hypot(force_x, force_y) / share
            yield ("force_x", "force_y"), shorten((force_x, force_y)), limit
        return
    for axis, (name, force) in enumerate((("force_x", force_x), ("force_y", force_y))):
        # If the other force is free, the limit is the force of full slip along this axis.
        limit = abs(full_slip_force(load, mu, angle, (1.0 - axis, float(axis)))[axis])
        if force is not None and abs(force) >= limit:
            yield (name,), shorten(force), limit


def _limit_fault(entries: ValidEntries, keys: list[str], value: str, limit: float) -> Fault:
    """Return the fault of forces above the friction limit."""
    unit = "N/mm" if is_line(entries) else "N"
    cure = f"less than {limit:.6g} {unit}: friction can carry at most this much in this direction"
    return Fault(", ".join(keys), value, cure)


FORCE_CHECKS: tuple[Check, ...] = (
    _check_force_has_friction,
    _check_force_limit,
    _check_force_limit_at_knots,
    _check_method_of_forces,
)
"""Checks of prescribed forces."""
