"""Names, units and descriptions of everything that is recorded.

The one table behind the results file, the JSON of `tractive-sam show` and the labels of figures.
"""

from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Quantity:
    """A recorded quantity.

    Attributes
    ----------
    unit : str
        Unit; "1" where it has none.
    long_name : str
        Description for people.
    """

    unit: str
    long_name: str


SCALARS: dict[str, Quantity] = {
    "revolution": Quantity("1", "revolutions rolled by body A, by B where A is flat"),
    "P": Quantity("N", "normal load"),
    "Qx": Quantity("N", "longitudinal force on body A"),
    "Qy": Quantity("N", "lateral force on body A"),
    "Mz": Quantity("N mm", "spin moment on body A"),
    "Qx_over_P": Quantity("1", "longitudinal force over normal load"),
    "Qy_over_P": Quantity("1", "lateral force over normal load"),
    "approach": Quantity("mm", "rigid-body approach"),
    "p_max": Quantity("MPa", "largest pressure"),
    "p_95": Quantity("MPa", "pressure that 5 % of the load exceeds"),
    "half_width_x": Quantity("mm", "half width of the contact in the rolling direction"),
    "half_width_y": Quantity("mm", "half width of the contact in the lateral direction"),
    "wear_max": Quantity("mm", "largest wear depth, both bodies together"),
    "stick_fraction": Quantity("1", "share of the contact area that sticks"),
    "xi_x": Quantity("1", "longitudinal creepage"),
    "xi_y": Quantity("1", "lateral creepage"),
    "spin": Quantity("1/mm", "spin creepage"),
    "residual": Quantity("1", "relative residual of the contact conditions"),
    "dissipation": Quantity("N", "frictional work per distance rolled, from traction and slip"),
    "work_supplied": Quantity("N", "work per distance rolled of the forces that drive the bodies"),
    "wear_rate": Quantity("mm2", "cross section worn off both bodies in a pass"),
    "operator_applications": Quantity("1", "applications of elastic operators"),
    "jump": Quantity("1", "revolutions that the next step is to take"),
    "converged": Quantity("1", "1 where the contact conditions hold to the tolerance"),
    "solves": Quantity("1", "contacts solved for this record"),
    "seconds": Quantity("s", "time spent on this record"),
}
"""One number a record. Those that a former results file lacks are nan in it, here and below."""

PER_LENGTH: dict[str, Quantity] = {
    "P": Quantity("N/mm", "normal load per length"),
    "Qx": Quantity("N/mm", "longitudinal force on body A per length"),
    "Qy": Quantity("N/mm", "lateral force on body A per length"),
    "Mz": Quantity("N mm/mm", "spin moment on body A per length"),
    "approach": Quantity("mm", "approach relative to the surface one radius R_x away"),
    "dissipation": Quantity("N/mm", "frictional work per distance rolled and length"),
    "work_supplied": Quantity("N/mm", "work of the driving forces per distance rolled and length"),
    "wear_rate": Quantity("mm", "depth worn off both bodies in a pass"),
}
"""What is another quantity in a line contact."""


def scalars(line: bool) -> dict[str, Quantity]:
    """`SCALARS` as they are to be read in a line contact, or else."""
    return SCALARS | PER_LENGTH if line else SCALARS


def error_bars(line: bool) -> dict[str, Quantity]:
    """`ERROR_BARS` as they are to be read in a line contact, or else."""
    units = scalars(line)
    quantities = dict(ERROR_BARS)
    for name in BARRED:
        quantities[f"{name}_error"] = replace(ERROR_BARS[f"{name}_error"], unit=units[name].unit)
    return quantities


BARRED = ("P", "Qx", "Qy", "Mz", "approach", "p_max", "wear_max", "xi_x", "xi_y")

ERROR_BARS: dict[str, Quantity] = {
    f"{name}_error": Quantity(SCALARS[name].unit, f"error bar of {name}") for name in BARRED
} | {"relative_error": Quantity("1", "widest relative error bar of what accuracy.tolerance bounds")}
"""One number a record, of scenes with [accuracy]."""

POINTS: dict[str, Quantity] = {
    "p_max_at": Quantity("mm", "position (x, y) of the largest pressure"),
}
"""A position a record."""

PROFILES: dict[str, Quantity] = {
    "wear_profile": Quantity("mm", "wear depth behind the contact, both bodies together"),
    "entering_profile": Quantity("mm", "wear depth before the contact, both bodies together"),
    "wear_per_revolution": Quantity(
        "mm", "depth by which the entering profile deepens in a revolution, both bodies together"
    ),
    "wear_profile_A": Quantity("mm", "wear depth of body A; of a flat one that of a single pass"),
    "wear_profile_B": Quantity("mm", "wear depth of body B; of a flat one that of a single pass"),
}
"""A function of y a record."""

FIELDS: dict[str, Quantity] = {
    "pressure": Quantity("MPa", "contact pressure"),
    "traction_x": Quantity("MPa", "longitudinal traction on body A"),
    "traction_y": Quantity("MPa", "lateral traction on body A"),
    "slip_x": Quantity("1", "longitudinal slip of A over B per unit rolling speed"),
    "slip_y": Quantity("1", "lateral slip of A over B per unit rolling speed"),
    "wear": Quantity("mm", "wear depth, both bodies together"),
}
"""A function of x and y a record, kept at chosen revolutions."""

BODY_SCALARS: dict[str, Quantity] = {
    "von_mises_max": Quantity("MPa", "largest equivalent stress, inside or at the surface"),
    "von_mises_interior": Quantity("MPa", "largest equivalent stress inside the body"),
    "von_mises_surface": Quantity("MPa", "largest equivalent stress at the surface"),
}
"""One number a body and record, of scenes with [subsurface]."""

BODY_ERROR_BARS: dict[str, Quantity] = {
    "von_mises_max_error": Quantity("MPa", "error bar of von_mises_max"),
}
"""One number a body and record, of scenes with [accuracy] and [subsurface]."""

BODY_POINTS: dict[str, Quantity] = {
    "von_mises_max_at": Quantity("mm", "position (x, y, depth) of the largest equivalent stress"),
}
"""A position a body and record, of scenes with [subsurface]."""

STRESS: dict[str, Quantity] = {
    "von_mises": Quantity("MPa", "equivalent stress of von Mises"),
    "xx": Quantity("MPa", "normal stress in x"),
    "yy": Quantity("MPa", "normal stress in y"),
    "zz": Quantity("MPa", "normal stress in z"),
    "xy": Quantity("MPa", "shear stress xy"),
    "xz": Quantity("MPa", "shear stress xz"),
    "yz": Quantity("MPa", "shear stress yz"),
}
"""A function on a plane below the surface, kept with the fields."""

STATE: dict[str, Quantity] = FIELDS | {
    "gap": Quantity("mm", "separation of the deformed surfaces"),
    "sliding": Quantity("1", "1 where the traction has reached the friction bound"),
}
"""A function of x and y of the last record, from which rolling goes on."""
