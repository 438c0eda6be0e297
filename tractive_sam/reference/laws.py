"""Closed forms that are laws of the package as well."""

from tractive_sam.mechanics import (  # noqa: F401 - for __init__.pyi
    CombinedMaterial,
    HertzContact,
    HertzLine,
    Material,
    combine,
    combined_radius,
    full_slip_force,
    hertz,
    hertz_line,
    load_to_carry,
    max_shear,
    principal_stresses,
    von_mises,
)
