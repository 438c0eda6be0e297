"""The columns and fields of records: names, units, descriptions, and how each is computed.

These define the columns of the results file, of the JSON and the tables of `tractive-sam show`, and
the labels of figures. What a contact provides is declared beside it: `CONTACT_COLUMNS` and `FIELDS`
in `state`, `FlashTemperature.columns` and `HEAT_FIELDS` in `heat`, `InterfaceStress.columns` and
`FATIGUE_COLUMNS` in `stress`. Here are the columns that only a process provides.
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import partial

from tractive_sam.mechanics import VON_MISES
from tractive_sam.results.heat import HEAT_FIELDS, FlashTemperature
from tractive_sam.results.quantity import (
    COORDINATE,
    Quantity,
    error_bar_column,
    index_by_name,
    read_error_bar,
    vectors,
)
from tractive_sam.results.state import BOUND, CONTACT_COLUMNS, FIELDS
from tractive_sam.results.stress import FATIGUE_COLUMNS, InterfaceStress, stress_columns
from tractive_sam.scene import Scene

PACKAGE_FIELDS = {**FIELDS, **HEAT_FIELDS, BOUND.name: BOUND}
"""All fields that the package defines; other fields are user-defined."""


def storable_fields(scene: Scene) -> dict[str, Quantity]:
    """Return the fields over x and y that a history of a scene may store, by name."""
    # Slip of a shift, in mm: a shift has no rolling distance to divide by.
    shifted: list[Quantity] = []
    if scene.schedule.shifts:
        shifted = vectors("slip", "mm", "slip of A relative to B in the step")
    elif scene.schedule.shifting:
        mixed = "slip of A relative to B, divided by the rolling speed; of a step that shifts, mm"
        shifted = vectors("slip", "1", mixed)
    more = {name: quantity for name, quantity in HEAT_FIELDS.items() if quantity.applies(scene)}
    return FIELDS | index_by_name(shifted) | more | {BOUND.name: BOUND}


def _has_single_load(scene: Scene) -> bool:
    """Return whether a scene has one load, for which error bars of a body are computed."""
    return not scene.duty


REVOLUTION = Quantity(
    "revolution",
    "1",
    "revolutions of body A, or of body B if A is flat",
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
    "rolling distance",
    symbol="s",
    label="distance",
    needs=("transient.only_rolls",),
    role=COORDINATE,
)

_of_step = partial(Quantity, needs=("transient",))

# fmt: off
_COORDINATES = (
    REVOLUTION,
    Quantity("distance", "1", "parameter of the courses; the bodies do not roll", symbol="s",
             label="parameter", needs=("schedule.shifts",), role=COORDINATE),
    replace(DISTANCE, needs=("transient.is_mixed",),
            long_name="rolling distance, and the parameter of stages in which the bodies shift"),
    DISTANCE,  # the last of its name, which is therefore found without a scene
)

_PROCESS_COLUMNS = (
    Quantity("jump", "1", "number of revolutions in the next step", format="d"),
    Quantity("solves", "1", "contacts solved for this record", format="d"),
    Quantity("seconds", "s", "time spent on this record"),
    _of_step("shift_x", "mm", "shift of A relative to B in x since the start, including creepage",
             symbol=r"\delta_x"),
    _of_step("shift_y", "mm", "shift of A relative to B in y since the start, including creepage",
             symbol=r"\delta_y"),
    _of_step("turn", "rad", "rotation of A relative to B since the start, including spin"),
    _of_step("step_work", "N mm", "work supplied in the step before this record by tangential "
                                  "forces and, for dissimilar bodies and those that relax, by "
                                  "the load", per_length=True),
    _of_step("step_friction", "N mm", "frictional work in the step before this record",
             per_length=True),
    Quantity("step_bulk", "N mm", "work that a body loses inside in the step before this record",
             dims=("body",), needs=("transient", "body.relaxes"), per_length=True),
    _of_step("friction_work", "N mm", "frictional work since the start", per_length=True),
    Quantity("step_worn", "mm3", "volume worn off both bodies in the step before this record",
             per_length=True, needs=("transient", "wear")),
    _of_step("elastic_energy", "N mm", "elastic energy due to the tractions and, for dissimilar "
                                       "bodies and those that relax, the pressure", symbol="W",
             per_length=True),
    Quantity("next_step", "1", "increment of the parameter in the next step",
             needs=("schedule.shifts",)),
    Quantity("next_step", "mm", "length of the next step", needs=("transient.rolls",)),
    Quantity("stage", "1", "index of the stage, from 0", format="g", needs=("transient.stage",)),
    _of_step("stretch", "1", "index of the interval between two knots, from 0", format="g"),
    Quantity("entering_profile", "mm", "wear depth before the contact, both bodies together",
             dims=("y",)),
    Quantity("wear_per_revolution", "mm",
             "increase of the entering profile in one revolution, both bodies together",
             dims=("y",)),
    Quantity("wear_profile_A", "mm", "wear depth of body A; for a flat body, due to a single pass",
             dims=("y",)),
    Quantity("wear_profile_B", "mm", "wear depth of body B; for a flat body, due to a single pass",
             dims=("y",)),
    Quantity("measured_profile", "mm", "measured separation across the track, at x = 0",
             dims=("y",), needs=("gap",)),
)
# fmt: on

WITH_ERROR_BAR = (
    *("P", "Qx", "Qy", "Mz", "approach", "p_max", "wear_max", "xi_x", "xi_y"),
    *("temperature_max", "temperature_mean"),
)


_STRESS = stress_columns(VON_MISES)

_FATIGUE_WITH_ERROR_BAR = (
    "utilisation",
    "shakedown_lower",
    "shakedown_upper",
    "fatigue_life",
    "stressed_volume",
    "volume_life",
)

STRESSES = tuple(column.name for column in _STRESS.of_maximum)
"""Columns of the largest stress in each body."""

_BY_NAME = index_by_name((*CONTACT_COLUMNS, *FlashTemperature.columns))

COLUMNS = (
    *_COORDINATES,
    *CONTACT_COLUMNS,
    *_PROCESS_COLUMNS,
    *FlashTemperature.columns,
    *_STRESS.of_maximum,
    *InterfaceStress.columns,
    *FATIGUE_COLUMNS,
    *(
        replace(error_bar_column(column), when=_has_single_load)
        for column in FATIGUE_COLUMNS
        if column.name in _FATIGUE_WITH_ERROR_BAR
    ),
    *(error_bar_column(_BY_NAME[name]) for name in WITH_ERROR_BAR),
    _STRESS.value_error,
    Quantity(
        "relative_error",
        "1",
        "largest relative error bar of the quantities that accuracy.tolerance limits",
        partial(read_error_bar, "relative", ()),
        needs=("accuracy",),
        over_blocks="largest",
    ),
)
"""Columns of each revolution. A column that an earlier results file lacks is nan."""

PARTS = Quantity(
    "worn_by",
    "mm",
    "wear depth of each body before the contact, due to each block",
    dims=("block", "body", "y"),
)
"""Recorded if the bodies wear by separate laws, or in several blocks."""

SHARE = Quantity(
    "block_share",
    "1",
    "fraction of the worn cross-section of both bodies that is due to each block, since the start",
    dims=("block",),
)
ROLLED = Quantity(
    "rolled_block",
    "1",
    "index of the block of this revolution; -1 for the mean of a cycle",
    format="d",
    whole=True,
)
"""Recorded for duty cycles, as is `SHARE`."""


def _in_place_of(package: Quantity, replacing: Mapping[str, Quantity]) -> Quantity:
    """Return the user-defined column that replaces a column of the package, else the latter.

    If none has this role, it is the column of the package.
    """
    if package.role not in replacing:
        return package
    user_names = {
        column.name: replacing[column.role].name for column in COLUMNS if column.role in replacing
    }
    return replace(
        replacing[package.role],
        needs=package.needs,
        when=package.when,
        bodies_of=package.bodies_of,
        over_blocks=package.over_blocks,
        place_of=user_names.get(package.place_of, ""),
        error_of=user_names.get(package.error_of, ""),
    )


def columns(scene: Scene, user_columns: Iterable[Quantity] = ()) -> dict[str, Quantity]:
    """Return all columns of the history of a scene by name, user-defined ones included."""
    user_columns = list(user_columns)
    replacing = {
        column.role: column for column in user_columns if column.role not in ("", COORDINATE)
    }
    coordinates = [column for column in user_columns if column.role == COORDINATE]
    chosen = [column for column in coordinates if column.applies(scene)] + [
        _in_place_of(column, replacing)
        for column in COLUMNS
        if column.applies(scene) and not (coordinates and column.role == COORDINATE)
    ]
    chosen += [column for column in user_columns if not column.role and column.applies(scene)]
    return index_by_name(column.with_units_of(scene) for column in chosen)
