"""Closed forms for comparison with computed results.

Units mm, N, MPa; x is the rolling direction; forces and tractions act on the upper body A, and
a negative longitudinal creepage drives it (Q_x > 0). Imports nothing of the package.
"""

from tractive_sam.mechanics import (
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

from .bentall_johnson import bentall_johnson_creepage
from .carter import Carter
from .creep_force import (
    creep_parameter,
    kalker_simplified,
    vermeulen_johnson,
    vermeulen_johnson_inverse,
)
from .fastsim import fastsim
from .giwm import GlobalWear, giwm
from .hertz_stress import circle_pressure_stress, circle_shear_stress, hertz_axis_stress
from .kalker import CreepCoefficients, CreepForces, creep_coefficients, linear_creep_forces
from .line_stress import line_pressure_stress, line_shear_stress
from .spinning import full_slip_with_spin

__all__ = [
    "Carter",
    "CombinedMaterial",
    "CreepCoefficients",
    "CreepForces",
    "GlobalWear",
    "HertzContact",
    "HertzLine",
    "Material",
    "bentall_johnson_creepage",
    "circle_pressure_stress",
    "circle_shear_stress",
    "combine",
    "combined_radius",
    "creep_coefficients",
    "creep_parameter",
    "fastsim",
    "full_slip_force",
    "full_slip_with_spin",
    "giwm",
    "hertz",
    "hertz_axis_stress",
    "hertz_line",
    "kalker_simplified",
    "line_pressure_stress",
    "line_shear_stress",
    "linear_creep_forces",
    "load_to_carry",
    "max_shear",
    "principal_stresses",
    "vermeulen_johnson",
    "vermeulen_johnson_inverse",
    "von_mises",
]
