"""Figures as the field draws them; the only room that draws.

Every function returns a matplotlib `Figure` that belongs to no window and no global state, but for
`save_all` and `animate`, which write files.
"""

from tractive_sam.plot.animation import animate
from tractive_sam.plot.comparison import compared
from tractive_sam.plot.courses import (
    creepages,
    forces,
    stress_course,
    wear_depth,
    widths,
    worn_mass,
)
from tractive_sam.plot.creep_force import creep_force_curve
from tractive_sam.plot.drawn import Drawn
from tractive_sam.plot.duty import block_shares, wear_regimes, worn_by_block
from tractive_sam.plot.evolution import (
    pressure_over_revolutions,
    slip_over_revolutions,
    wear_over_revolutions,
)
from tractive_sam.plot.fatigue import (
    damage,
    fatigue_course,
    shakedown_map,
    utilisation,
    wear_against_fatigue,
)
from tractive_sam.plot.fields import pressure, stick_slip_map, traction, wear_map
from tractive_sam.plot.figure import Figure as Figure
from tractive_sam.plot.gallery import DPI, FORMATS, save_all
from tractive_sam.plot.heat import friction, temperature, traction_curve
from tractive_sam.plot.line_contact import line_pressure, line_pressures, line_slip, line_traction
from tractive_sam.plot.profiles import chosen as chosen
from tractive_sam.plot.profiles import pressure_profiles, wear_profiles, worn_profiles
from tractive_sam.plot.scale import UNITS, Scale, units
from tractive_sam.plot.sections import traction_sections
from tractive_sam.plot.stress import von_mises, von_mises_sections
from tractive_sam.plot.stress_maxima import stress_maxima as stress_maxima
from tractive_sam.plot.study import Variable, study_curves, study_map, study_samples
from tractive_sam.plot.style import STYLE
from tractive_sam.plot.table import table_errors
from tractive_sam.plot.transient import energies, hysteresis, stick_course, worn_track
from tractive_sam.plot.zones import continued as continued
from tractive_sam.plot.zones import edge_level as edge_level
from tractive_sam.plot.zones import stick_level as stick_level

__all__ = [
    "DPI",
    "FORMATS",
    "STYLE",
    "UNITS",
    "Drawn",
    "Scale",
    "Variable",
    "animate",
    "block_shares",
    "compared",
    "creep_force_curve",
    "creepages",
    "damage",
    "energies",
    "fatigue_course",
    "forces",
    "friction",
    "hysteresis",
    "line_pressure",
    "line_pressures",
    "line_slip",
    "line_traction",
    "pressure",
    "pressure_over_revolutions",
    "pressure_profiles",
    "save_all",
    "shakedown_map",
    "slip_over_revolutions",
    "stick_course",
    "stick_slip_map",
    "stress_course",
    "study_curves",
    "study_map",
    "study_samples",
    "table_errors",
    "temperature",
    "traction",
    "traction_curve",
    "traction_sections",
    "units",
    "utilisation",
    "von_mises",
    "von_mises_sections",
    "wear_against_fatigue",
    "wear_depth",
    "wear_map",
    "wear_over_revolutions",
    "wear_profiles",
    "wear_regimes",
    "widths",
    "worn_by_block",
    "worn_mass",
    "worn_profiles",
    "worn_track",
]
