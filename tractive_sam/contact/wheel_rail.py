"""All patches of a wheel on a rail: they share one approach, and carry its load together.

The wheel is a vertical distance d below its first touch. The approach of a patch is the largest
overlap of the undeformed surfaces there, normal to its plane. At the contact angle delta, its
pressure and its lateral traction carry P cos(delta) - Q_y sin(delta) of the vertical force.

A free wheelset turns so fast that the tractions of its two wheels have no moment about the axle.
The other wheel is computed for it with an equal load, on a rail and with friction in the mirror;
where the wheelset stands in the middle of the track, it is the mirror image.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from tractive_sam.contact.mesh import enlarge
from tractive_sam.contact.model import Model
from tractive_sam.rail import Patch
from tractive_sam.results import Cost, State, Status
from tractive_sam.schema import required

GROWTHS = 8
"""Largest number of enlargements of a mesh that the scene does not fix."""

Solve = Callable[[Model, State | None], State]
"""Solves a patch at a depth of the wheel, from the contact at another depth."""


def share_load(
    model: Model,
    solve: Solve,
    starts: Sequence[State | None] = (),
    tolerance: float = 1e-6,
    max_steps: int = 12,
) -> tuple[State, ...]:
    """Solve all patches of a wheel at the depth at which they together carry its load.

    It uses the secant method for the load to the power 2/3, which for a Hertz contact is linear in
    the depth of the wheel. The first patch has the cost of all.

    Parameters
    ----------
    model : Model
        Model of a scene with a wheel.
    solve : callable
        Solves a patch.
    starts : sequence of State or None
        Similar contacts in the first patches.
    tolerance : float
        Relative error of the load.
    max_steps : int
        Largest number of depths; the contacts at the last one are returned even if the load is not
        within the tolerance.

    Returns
    -------
    tuple of State
        The patches in the order of `WheelRail.patches`; one that is open has no pressure.
    """
    wheelset = required(model.scene.wheelset, "wheelset")
    patches = required(model.wheel_rail, "wheel").patches
    by_normal = wheelset.load is None
    load = required(wheelset.load or wheelset.normal_load, "wheelset.load")
    models, cost = [model.of_patch(patch) for patch in patches], Cost()
    hertz = model.scene.hertz
    unworn = None if hertz is None else hertz.approach
    last = [*starts, *(None for _ in patches)][: len(patches)]
    approach = required(unworn, "body") if last[0] is None else last[0].approach
    depth, previous = approach / np.cos(patches[0].angle), (0.0, 0.0)
    for _ in range(max_steps):
        contacts = [
            solve(local.of_patch(patch, depth), before)
            for local, patch, before in zip(models, patches, last, strict=True)
        ]
        cost = sum((contact.cost for contact in contacts), cost)
        carried = sum(
            supported_load(contact, patch, by_normal)
            for contact, patch in zip(contacts, patches, strict=True)
        )
        unsolved = {contact.status for contact in contacts if not contact.converged}
        # At a smaller depth the contact may be within the mesh, at a larger one resolved by it.
        too_deep = unsolved == {Status.OFF_GRID} and carried > (1.0 + tolerance) * load
        too_flat = unsolved == {Status.NOT_RESOLVED} and carried < (1.0 - tolerance) * load
        settled = not (unsolved or abs(carried - load) > tolerance * load)
        if settled or (unsolved and not (too_deep or too_flat)):
            break
        power = max(carried, 0.0) ** (2.0 / 3.0)
        slope = (power - previous[1]) / (depth - previous[0])
        previous = depth, power
        depth += (load ** (2.0 / 3.0) - power) / slope
        last = [contact if contact.touching.any() else None for contact in contacts]
    return (contacts[0].with_cost(cost), *contacts[1:])


def find_pitch(
    model: Model,
    solve_wheel: Callable[[Model, Sequence[State | None]], tuple[State, ...]],
    starts: Sequence[State | None],
    tolerance: float,
    max_steps: int = 30,
) -> tuple[State, ...]:
    """Solve the patches of a wheel at the pitch at which no moment acts on its axle.

    The moment rises or falls with the pitch throughout. The method is the secant method within the
    interval that contains the root; its first step is that of sticking contacts.

    Parameters
    ----------
    model : Model
        Model of a scene with a wheel whose pitch is free.
    solve_wheel : callable
        Solves the patches of a wheel at the pitch of its model, from similar contacts.
    starts : sequence of State or None
        Similar contacts in the first patches; their pitch is the first one.
    tolerance : float
        Error of the moment over load times radius times the friction of full sliding.
    max_steps : int
        Largest number of pitches; the contacts at the last one are returned in any case.
    """
    geometry = required(model.wheel_rail, "wheel")
    wheelset = required(model.scene.wheelset, "wheelset")
    are_mirrored = wheelset.y == wheelset.yaw == 0.0 and wheelset.roll in ("free", 0.0)
    wheels = [model]
    if not are_mirrored:
        wheels.append(Model(model.scene.opposite_wheel, wheel_rail=geometry.opposite))
    pitch, starts_of = geometry.pitch, [starts, ()]
    if starts and starts[0] is not None:
        pitch = geometry.patches[0].pitch_at(starts[0].xi_x)
    radius, (long, wide) = geometry.wheel.radius, geometry.patches[0].half_length
    # Of sticking contacts, half as large as the overlap: Kalker's 4 G a b.
    slope = 1.5 * model.scene.material.E_star * long * wide * radius * len(wheels)
    largest = required(model.scene.normal_load, "load") * radius * len(wheels)
    largest *= max(required(model.scene.friction, "friction").mu)
    below, above, cost = -np.inf, np.inf, Cost()
    before: tuple[float, float] | None = None
    for _ in range(max_steps):
        moment, solved = 0.0, []
        for k, wheel in enumerate(wheels):
            contacts = solve_wheel(wheel.at_pitch(pitch), starts_of[k])
            for _ in range(GROWTHS if k else 0):  # the caller enlarges the mesh of the first wheel
                if (wheel := enlarge_for(wheels[k], contacts)) is wheels[k]:
                    break
                wheels[k] = wheel
                contacts = solve_wheel(wheel.at_pitch(pitch), ())
            patches = required(wheel.wheel_rail, "wheel").patches
            pairs = [*zip(contacts, patches, strict=True)]
            moment += sum(p.moment_about_axle((c.Qx, c.Qy), c.Mz) for c, p in pairs)
            cost = cost + contacts[0].cost
            starts_of[k] = [contact if contact.touching.any() else None for contact in contacts]
            solved.append(contacts)
        if any(not contact.converged for contact in solved[0]):
            break
        other = next((c for contacts in solved[1:] for c in contacts if not c.converged), None)
        if other is not None:
            note = f"the other wheel, which determines wheelset.pitch: {other.message}"
            status = Status.NOT_RESOLVED if other.status is Status.OFF_GRID else other.status
            solved[0] = tuple(replace(c, status=status, note=note) for c in solved[0])
            break
        if abs(moment) <= tolerance * largest:
            break
        below, above = (pitch, above) if moment < 0.0 else (below, pitch)
        if before is not None and moment != before[1]:
            slope = max((moment - before[1]) / (pitch - before[0]), 1e-3 * slope)
        before, step = (pitch, moment), -moment / slope
        if not below < pitch + step < above:
            step = 0.5 * (below + above) - pitch
        pitch += step
    return (solved[0][0].with_cost(cost), *solved[0][1:])


def enlarge_for(model: Model, contacts: Sequence[State]) -> Model:
    """Return a model on a mesh enlarged along the axes in which contacts reach its edge, if any."""
    edges = [contact.at_edge for contact in contacts if contact.status is Status.OFF_GRID]
    if not edges or model.scene.has_fixed_domain:
        return model
    along, across = map(any, zip(*edges, strict=True))
    return model.on(enlarge(model.grid, (along, across)))


def supported_load(contact: State, patch: Patch, normal: bool = False) -> float:
    """Return the vertical force of a patch, or with `normal` its normal force, N."""
    if normal:
        return contact.P
    return float(contact.P * np.cos(patch.angle) - contact.Qy * np.sin(patch.angle))
