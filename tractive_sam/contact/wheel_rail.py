"""All patches of a wheel on a rail: they share one approach, and carry its load together.

The wheel is a vertical distance d below its first touch. The approach of a patch is the largest
overlap of the undeformed surfaces there, normal to its plane. At the contact angle delta, its
pressure and its lateral traction carry P cos(delta) - Q_y sin(delta) of the vertical force.
"""

from collections.abc import Callable

import numpy as np

from tractive_sam.contact.model import Model
from tractive_sam.rail import Patch
from tractive_sam.results import Cost, State, Status
from tractive_sam.schema import required

Solve = Callable[[Model, State | None], State]
"""Solves a patch at a depth of the wheel, from the contact at another depth."""


def share_load(
    model: Model, solve: Solve, start: State | None, tolerance: float = 1e-6, max_steps: int = 12
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
    start : State, optional
        A similar contact in the first patch.
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
    approach = required(unworn, "body") if start is None else start.approach
    depth, previous = approach / np.cos(patches[0].angle), (0.0, 0.0)
    last: list[State | None] = [start, *(None for _ in patches[1:])]
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
        # At a smaller depth the contact may be within the mesh.
        too_deep = unsolved == {Status.OFF_GRID} and carried > (1.0 + tolerance) * load
        if (unsolved and not too_deep) or abs(carried - load) <= tolerance * load:
            break
        power = max(carried, 0.0) ** (2.0 / 3.0)
        slope = (power - previous[1]) / (depth - previous[0])
        previous = depth, power
        depth += (load ** (2.0 / 3.0) - power) / slope
        last = [contact if contact.touching.any() else None for contact in contacts]
    return (contacts[0].with_cost(cost), *contacts[1:])


def supported_load(contact: State, patch: Patch, normal: bool = False) -> float:
    """Return the vertical force of a patch, or with `normal` its normal force, N."""
    if normal:
        return contact.P
    return float(contact.P * np.cos(patch.angle) - contact.Qy * np.sin(patch.angle))
