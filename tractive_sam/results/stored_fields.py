"""Fields that are stored: functions of x and y, stress on planes, and fatigue over depth."""

import math
from functools import partial
from operator import attrgetter
from typing import Any

import numpy as np

from tractive_sam.mechanics import VON_MISES
from tractive_sam.results.quantity import Quantity, index_by_name
from tractive_sam.results.state import State
from tractive_sam.scene import Scene


def read_component(field: str, k: int, contact: State) -> np.ndarray:
    """Return a component of a vector field of a contact, shape (n_x, n_y)."""
    return getattr(contact, field)[k]


def vectors(field: str, unit: str, text: str) -> list[Quantity]:
    """Return the quantities of both components of a vector field of a contact, as ``slip_x``."""
    return [
        Quantity(f"{field}_{axis}", unit, f"{direction} {text}", partial(read_component, field, k))
        for k, (axis, direction) in enumerate((("x", "longitudinal"), ("y", "lateral")))
    ]


def read_number(name: str, contact: State) -> Any:
    """Return an attribute of a contact as numbers; 1 and 0 for true and false."""
    return 1.0 * getattr(contact, name)


def read_heat(name: str, contact: State, none: Any = math.nan) -> Any:
    """Return an attribute of `contact.heat`, or the value `none` without heat."""
    return none if contact.heat is None else getattr(contact.heat, name)


FIELDS = index_by_name(
    (
        Quantity("pressure", "MPa", "contact pressure", attrgetter("pressure")),
        *vectors("traction", "MPa", "traction on body A"),
        *vectors("slip", "1", "slip of A relative to B, divided by the rolling speed"),
        Quantity("wear", "mm", "wear depth, both bodies together", attrgetter("wear")),
        Quantity("gap", "mm", "separation of the deformed surfaces", attrgetter("gap")),
        Quantity(
            "sliding",
            "1",
            "1 if the traction has reached the friction bound",
            partial(read_number, "sliding"),
        ),
    )
)
"""Functions of x and y, stored at chosen revolutions; resuming needs all of them."""

BOUND = Quantity(
    "traction_bound",
    "MPa",
    "largest traction that friction allows, in the norm of its law",
    attrgetter("traction_bound"),
)
"""Stored with `FIELDS` if it differs from the pressure, which it does not for Coulomb's law."""

BEFORE = index_by_name(
    (
        Quantity("before_pressure", "MPa", "pressure in the previous step"),
        Quantity("before_x", "MPa", "longitudinal traction on body A in the previous step"),
        Quantity("before_y", "MPa", "lateral traction on body A in the previous step"),
    )
)
"""Fields that resuming a transient needs in addition: stored for the last contact only."""

HEAT_FIELDS = index_by_name(
    (
        Quantity("temperature_A", "degC", "temperature of the surface of body A",
                 partial(read_heat, "temperature_A"), needs=("heat",)),
        Quantity("temperature_B", "degC", "temperature of the surface of body B",
                 partial(read_heat, "temperature_B"), needs=("heat",)),
        Quantity("heat_into_A", "mW/mm2", "heat flux into body A",
                 partial(read_heat, "into_A"), needs=("heat",)),
    )
)  # fmt: skip
"""Fields stored for scenes with [heat]; resuming does not need them."""


def storable_fields(scene: Scene) -> dict[str, Quantity]:
    """Return the fields over x and y that a history of a scene may store, by name."""
    # Slip of a shift, in mm: a shift has no rolling distance to divide by.
    shifted: list[Quantity] = []
    if scene.schedule.shifts:
        shifted = vectors("slip", "mm", "slip of A relative to B in the step")
    elif scene.schedule.shifting:
        mixed = "slip of A relative to B, divided by the rolling speed; of a step that shifts, mm"
        shifted = vectors("slip", "1", mixed)
    warm = {name: quantity for name, quantity in HEAT_FIELDS.items() if quantity.applies(scene)}
    return FIELDS | index_by_name(shifted) | warm | {BOUND.name: BOUND}


OUTSIDE = {"gap": math.inf} | dict.fromkeys(HEAT_FIELDS, math.nan)
"""Value of a field outside the mesh, if it is not zero: there is no contact, and gap and
temperature are not computed."""

STRESS = index_by_name(
    (
        Quantity(VON_MISES.name, VON_MISES.unit, VON_MISES.long_name),
        Quantity("xx", "MPa", "normal stress in x"),
        Quantity("yy", "MPa", "normal stress in y"),
        Quantity("zz", "MPa", "normal stress in z"),
        Quantity("xy", "MPa", "shear stress xy"),
        Quantity("xz", "MPa", "shear stress xz"),
        Quantity("yz", "MPa", "shear stress yz"),
    )
)
"""Functions on a plane below the surface, stored with the fields."""


FATIGUE_FIELDS = index_by_name(
    (
        Quantity("utilisation", "1", "ratio of the equivalent stress of the cycle to its limit",
                 dims=("y", "depth")),
        Quantity("residual_shear", "MPa",
                 "sqrt(J2) of the cycle with the residual stress due to rolling that minimises it",
                 dims=("y", "depth")),
        Quantity("path_radius", "MPa",
                 "sqrt(J2) of the cycle minus the constant deviator that minimises it",
                 dims=("y", "depth")),
        Quantity("damage", "1", "damage of the material", dims=("y", "zeta")),
        Quantity("worn", "mm", "depth worn off the body", dims=("y",)),
    )
)  # fmt: skip
"""Functions over the section of a body, from fatigue, stored with the fields."""
