"""The columns of records: names, units, descriptions, and how to read them from a contact.

This table defines the columns of the results file, of the JSON and the tables of `tractive-sam
show`, and the labels of figures. A new column needs one line here.
"""

import math
from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from operator import attrgetter

from tractive_sam.mechanics import VON_MISES
from tractive_sam.results.fatigue_columns import FATIGUE_COLUMNS
from tractive_sam.results.quantity import COORDINATE, Quantity, index_by_name
from tractive_sam.results.state import State
from tractive_sam.results.stored_fields import read_component, read_heat, read_number
from tractive_sam.results.stress_quantities import error_bar_column, read_error_bar, stress_columns
from tractive_sam.scene import Scene


def _over_load(force: str, contact: State) -> float:
    """Return a force of a contact over its load."""
    return getattr(contact, force) / contact.P if contact.P else 0.0


def _deepest(contact: State) -> float:
    """Return the largest wear depth."""
    return float(contact.wear.max())


def _has_single_load(scene: Scene) -> bool:
    """Return whether there is a single load: only then error bars of a body are computed."""
    return not scene.duty


REVOLUTION = Quantity(
    "revolution",
    "1",
    "revolutions rolled by body A, by B where A is flat",
    symbol="N",
    label="revolutions",
    format="d",
    whole=True,
    needs=("schedule.revolves",),
    role=COORDINATE,
)

DISTANCE = Quantity(
    "distance",
    "mm",
    "distance rolled",
    symbol="s",
    label="distance",
    needs=("transient.rolls",),
    role=COORDINATE,
)

PARAMETER = Quantity(
    "distance",
    "1",
    "parameter of the courses: nothing rolls",
    symbol="s",
    label="parameter",
    needs=("schedule.shifts",),
    role=COORDINATE,
)


_of_step = partial(Quantity, needs=("transient",))
_of_heat = partial(Quantity, needs=("heat",))

# fmt: off
_SCALARS = (
    REVOLUTION,
    PARAMETER,
    DISTANCE,  # the last of its name, which is therefore found without a scene
    Quantity("P", "N", "normal load", attrgetter("P"), symbol="P", per_length=True),
    Quantity("Qx", "N", "longitudinal force on body A", attrgetter("Qx"),
             symbol="Q_x", per_length=True),
    Quantity("Qy", "N", "lateral force on body A", attrgetter("Qy"),
             symbol="Q_y", per_length=True),
    Quantity("Mz", "N mm", "spin moment on body A", attrgetter("Mz"),
             symbol="M_z", per_length=True),
    Quantity("Qx_over_P", "1", "longitudinal force over normal load",
             partial(_over_load, "Qx"), symbol="Q_x/P", format=".4f"),
    Quantity("Qy_over_P", "1", "lateral force over normal load",
             partial(_over_load, "Qy"), symbol="Q_y/P", format=".4f"),
    Quantity("approach", "mm", "approach, of a line contact to the surface one radius R_x away",
             attrgetter("approach"), symbol=r"\delta"),
    Quantity("p_max", "MPa", "peak contact pressure", attrgetter("p_max"),
             symbol=r"p_\mathrm{max}"),
    Quantity("p_95", "MPa", "pressure that 5 % of the load exceeds",
             attrgetter("p_95"), symbol="p_{95}"),
    Quantity("half_width_x", "mm", "half width of the contact in the rolling direction, to where "
             "the squared pressure falls to zero", attrgetter("half_width_x"), symbol="a"),
    Quantity("half_width_y", "mm", "half width of the contact in the lateral direction, to where "
             "the squared pressure falls to zero",
             attrgetter("half_width_y"), symbol="b"),
    Quantity("area", "mm2", "contact area within such edges", attrgetter("area"), symbol="A",
             per_length=True),
    Quantity("wear_max", "mm", "largest wear depth, both bodies together",
             _deepest, symbol=r"w_\mathrm{max}"),
    Quantity("stick_fraction", "1", "share of the contact area that sticks",
             attrgetter("stick_fraction"), format=".3f"),
    Quantity("xi_x", "1", "longitudinal creepage", attrgetter("xi_x"), symbol=r"\xi_x"),
    Quantity("xi_y", "1", "lateral creepage", attrgetter("xi_y"), symbol=r"\xi_y"),
    Quantity("spin", "1/mm", "spin creepage", attrgetter("spin"), symbol=r"\varphi"),
    Quantity("residual", "1", "relative residual of the contact conditions",
             attrgetter("residual"), format=".0e"),
    Quantity("dissipation", "N", "frictional work per distance rolled, from traction and slip",
             attrgetter("dissipation"), per_length=True),
    Quantity("work_supplied", "N", "work per distance rolled of the forces that drive the bodies",
             attrgetter("work_supplied"), per_length=True),
    Quantity("t_gamma", "N", "T-gamma, -(Q_x xi_x + Q_y xi_y + M_z phi)", attrgetter("t_gamma"),
             symbol=r"T\gamma", per_length=True),
    Quantity("t_gamma_over_area", "MPa", "T-gamma over the contact area",
             attrgetter("t_gamma_over_area"), symbol=r"T\gamma/A"),
    Quantity("worn_area", "mm2", "cross section worn off both bodies in a pass",
             attrgetter("worn_area"), per_length=True),
    Quantity("operator_applications", "1", "applications of elastic operators",
             attrgetter("cost.applications")),
    Quantity("convolutions", "1", "all convolutions of the solves, in tangential applications",
             attrgetter("cost.convolutions")),
    Quantity("jump", "1", "revolutions that the next step is to take", format="d"),
    Quantity("converged", "1", "1 where the contact conditions hold to the tolerance",
             partial(read_number, "converged"), format="d"),
    Quantity("solves", "1", "contacts solved for this record", format="d"),
    Quantity("seconds", "s", "time spent on this record"),
    _of_step("shift_x", "mm", "shift of A over B in x since the start, by creepage too",
             symbol=r"\delta_x"),
    _of_step("shift_y", "mm", "shift of A over B in y since the start, by creepage too",
             symbol=r"\delta_y"),
    _of_step("turn", "rad", "turn of A over B since the start, by spin too"),
    _of_step("step_work", "N mm", "work supplied in the step to this record, by tangential "
             "forces "
             "and, of dissimilar bodies, by the load", per_length=True),
    _of_step("step_friction", "N mm", "work of friction in the step to this record",
             per_length=True),
    _of_step("friction_work", "N mm", "work of friction since the start", per_length=True),
    Quantity("step_worn", "mm3", "volume worn off both bodies in the step to this record",
             per_length=True, needs=("transient", "wear")),
    _of_step("elastic_energy", "N mm", "elastic energy of the tractions, of dissimilar "
             "bodies with "
             "the pressure", symbol="W", per_length=True),
    Quantity("next_step", "1", "how far the parameter is to go in the next step",
             needs=("schedule.shifts",)),
    Quantity("next_step", "mm", "how far the next step is to go", needs=("transient.rolls",)),
    _of_step("stretch", "1", "stretch between two knots, from 0 on", format="g"),
)

_OTHERS = (
    Quantity("p_max_at", "mm", "position (x, y) of the peak contact pressure",
             attrgetter("p_max_at"), ("axis",)),
    Quantity("wear_profile", "mm", "wear depth behind the contact, both bodies together; of "
             "shifts the deepest along x",
             partial(read_component, "wear", 0), ("y",)),
    Quantity("entering_profile", "mm", "wear depth before the contact, both bodies together",
             dims=("y",)),
    Quantity("wear_per_revolution", "mm",
             "depth by which the entering profile deepens in a revolution, both bodies together",
             dims=("y",)),
    Quantity("wear_profile_A", "mm", "wear depth of body A; of a flat one that of a single pass",
             dims=("y",)),
    Quantity("wear_profile_B", "mm", "wear depth of body B; of a flat one that of a single pass",
             dims=("y",)),
    Quantity("measured_profile", "mm", "measured separation across the track, at x = 0",
             dims=("y",), needs=("gap",)),
    Quantity("creepage_found", "1", "creepages (x, y) that the prescribed forces take",
             attrgetter("creepage_found"), ("axis",), needs=("finds_creepage",)),
    _of_heat("temperature_max", "degC", "largest temperature of the surfaces in contact",
             partial(read_heat, "temperature_max"), symbol=r"T_\mathrm{max}"),
    _of_heat("temperature_max_at", "mm", "position (x, y) of the largest temperature",
             partial(read_heat, "temperature_max_at", none=(math.nan, math.nan)),
             ("axis",)),
    _of_heat("temperature_mean", "degC", "mean temperature of the surfaces in contact",
             partial(read_heat, "temperature_mean"), symbol=r"T_\mathrm{mean}"),
    _of_heat("heat_share", "1", "share of body A in the heat that friction makes",
             partial(read_heat, "share"), format=".4f"),
    Quantity("worn_volume", "mm3", "volume worn off each body since it was new; of a flat body "
             "only where a transient wears it",
             attrgetter("worn_volume"), ("body",), symbol="V", per_length=True, needs=("wear",)),
    Quantity("worn_mass", "mg", "mass worn off each body since it was new, by its density",
             attrgetter("worn_mass"), ("body",), symbol="m", per_length=True, needs=("wear",)),
)
# fmt: on

WITH_ERROR_BAR = (
    *("P", "Qx", "Qy", "Mz", "approach", "p_max", "wear_max", "xi_x", "xi_y"),
    *("temperature_max", "temperature_mean"),
)


_STRESSES = stress_columns(VON_MISES)

_FATIGUE_WITH_ERROR_BAR = (
    "utilisation",
    "shakedown_lower",
    "shakedown_upper",
    "fatigue_life",
    "stressed_volume",
    "volume_life",
)

STRESSES = tuple(column.name for column in _STRESSES[:-1])
"""Columns of the largest stress in each body."""

_BY_NAME = index_by_name((*_SCALARS, *_OTHERS))

COLUMNS = (
    *_SCALARS,
    *_OTHERS,
    *_STRESSES[:-1],
    *FATIGUE_COLUMNS,
    *(
        replace(error_bar_column(column), when=_has_single_load)
        for column in FATIGUE_COLUMNS
        if column.name in _FATIGUE_WITH_ERROR_BAR
    ),
    *(error_bar_column(_BY_NAME[name]) for name in WITH_ERROR_BAR),
    _STRESSES[-1],
    Quantity(
        "relative_error",
        "1",
        "widest relative error bar of what accuracy.tolerance bounds",
        partial(read_error_bar, "relative"),
        needs=("accuracy",),
    ),
)
"""Columns of each revolution. A column that an earlier results file lacks is nan."""

PARTS = Quantity(
    "worn_by",
    "mm",
    "wear depth with which each body enters, by the block that wore it",
    dims=("block", "body", "y"),
)
"""Recorded if the bodies wear by separate laws, or in several blocks."""

SHARE = Quantity(
    "block_share",
    "1",
    "share of each block in the section worn off both bodies since the roll began",
    dims=("block",),
)
ROLLED = Quantity(
    "rolled_block",
    "1",
    "which of the different blocks the revolution is of; -1 where it is the mean of a cycle",
    format="d",
    whole=True,
)
"""Recorded for duty cycles, as is `SHARE`."""


def _in_place_of(package: Quantity, user: Quantity) -> Quantity:
    """Return a user-defined column that replaces one of the package, under its conditions."""
    return replace(user, needs=package.needs, when=package.when, bodies_of=package.bodies_of)


def columns(scene: Scene, own: Iterable[Quantity] = ()) -> dict[str, Quantity]:
    """Return the columns of the history of a scene by name, including user-defined ones."""
    own = list(own)
    replacing = {column.role: column for column in own if column.role not in ("", COORDINATE)}
    coordinates = [column for column in own if column.role == COORDINATE]
    chosen = [column for column in coordinates if column.applies(scene)] + [
        _in_place_of(column, replacing[column.role]) if column.role in replacing else column
        for column in COLUMNS
        if column.applies(scene) and not (coordinates and column.role == COORDINATE)
    ]
    chosen += [column for column in own if not column.role and column.applies(scene)]
    return index_by_name(column.with_units_of(scene) for column in chosen)
