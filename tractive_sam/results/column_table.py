"""The columns of records: names, units, descriptions, and how to read them from a contact.

This table defines the columns of the results file, of the JSON and the tables of `tractive-sam
show`, and the labels of figures. A new column needs one line here.
"""

import math
from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from operator import attrgetter
from typing import Any

import numpy as np

from tractive_sam.mechanics import VON_MISES, StressCriterion
from tractive_sam.results.quantity import BODIES, COORDINATE, Quantity, index_by_name
from tractive_sam.results.state import State
from tractive_sam.results.stored_fields import read_component, read_heat, read_number
from tractive_sam.scene import Scene


def _over_load(force: str, contact: State) -> float:
    """Return a force of a contact over its load."""
    return getattr(contact, force) / contact.P if contact.P else 0.0


def _bars_of_damage(contact: State) -> Any:
    """Return the error bars of the damage."""
    return contact.error_bars.get("damage", {})


def _deepest(contact: State) -> float:
    """Return the largest wear depth."""
    return float(contact.wear.max())


def _has_single_load(scene: Scene) -> bool:
    """Return whether there is a single load: only then error bars of a body are computed."""
    return not scene.duty


def _has_fatigue(body: str, scene: Scene) -> bool:
    """Return whether the fatigue of a body is computed."""
    return body in scene.fatigue.bodies


def _surface_fatigue_index(contact: State) -> float:
    """Return the largest |p_t|/p_n - k/p_n in contact."""
    k, touching = contact.scene.fatigue.shear_yield_stress, contact.touching
    if not touching.any():
        return math.nan
    shear = np.hypot(*contact.traction[:, touching]) - k
    return float((shear / contact.pressure[touching]).max())


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


_IN_STEPS = {"needs": ("transient",)}
_ROLLING = {"needs": ("transient.rolls",)}
_SHIFTING = {"needs": ("schedule.shifts",)}
_HEATED = {"needs": ("heat",)}

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
    Quantity("shift_x", "mm", "shift of A over B in x since the start, by creepage too",
             symbol=r"\delta_x", **_IN_STEPS),
    Quantity("shift_y", "mm", "shift of A over B in y since the start, by creepage too",
             symbol=r"\delta_y", **_IN_STEPS),
    Quantity("turn", "rad", "turn of A over B since the start, by spin too", **_IN_STEPS),
    Quantity("step_work", "N mm", "work supplied in the step to this record, by tangential forces "
             "and, of dissimilar bodies, by the load", per_length=True, **_IN_STEPS),
    Quantity("step_friction", "N mm", "work of friction in the step to this record",
             per_length=True, **_IN_STEPS),
    Quantity("friction_work", "N mm", "work of friction since the start", per_length=True,
             **_IN_STEPS),
    Quantity("step_worn", "mm3", "volume worn off both bodies in the step to this record",
             per_length=True, needs=("transient", "wear")),
    Quantity("elastic_energy", "N mm", "elastic energy of the tractions, of dissimilar bodies with "
             "the pressure", symbol="W", per_length=True, **_IN_STEPS),
    Quantity("next_step", "1", "how far the parameter is to go in the next step", **_SHIFTING),
    Quantity("next_step", "mm", "how far the next step is to go", **_ROLLING),
    Quantity("stretch", "1", "stretch between two knots, from 0 on", format="g", **_IN_STEPS),
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
    Quantity("temperature_max", "degC", "largest temperature of the surfaces in contact",
             partial(read_heat, "temperature_max"), symbol=r"T_\mathrm{max}", **_HEATED),
    Quantity("temperature_max_at", "mm", "position (x, y) of the largest temperature",
             partial(read_heat, "temperature_max_at", none=(math.nan, math.nan)),
             ("axis",), **_HEATED),
    Quantity("temperature_mean", "degC", "mean temperature of the surfaces in contact",
             partial(read_heat, "temperature_mean"), symbol=r"T_\mathrm{mean}", **_HEATED),
    Quantity("heat_share", "1", "share of body A in the heat that friction makes",
             partial(read_heat, "share"), format=".4f", **_HEATED),
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


def _bar(name: str, contact: State) -> float:
    """Return an error bar of a contact; nan if there is none."""
    return contact.error_bars.get(name, math.nan)


def _bars(name: str, contact: State) -> dict[str, float]:
    """Return the error bars of both bodies; nan if there are none."""
    bars = contact.error_bars.get(name, {})
    return {body: bars.get(body, math.nan) for body in BODIES}


def _error_bar(of: Quantity) -> Quantity:
    """Return the column of the error bar of a quantity; nan if there is none."""
    return replace(
        of,
        name=f"{of.name}_error",
        long_name=f"error bar of {of.name}",
        of=partial(_bars if of.dims else _bar, of.name),
        symbol="",
        needs=(*of.needs, "accuracy"),
    )


def stress_columns(criterion: StressCriterion) -> tuple[Quantity, ...]:
    """Return the columns of the largest stress in each body by a criterion, and its error bar."""
    name, unit, text = criterion.name, criterion.unit, f"largest {criterion.long_name}"
    stressed = {"needs": ("subsurface",), "bodies_of": "subsurface"}
    of_bodies = stressed | {"dims": ("body",), "symbol": criterion.symbol}
    largest = Quantity(
        f"{name}_max", unit, f"{text}, inside or at the surface", role="stress_max", **of_bodies
    )
    return (
        largest,
        Quantity(
            f"{name}_interior", unit, f"{text} inside the body", role="stress_interior", **of_bodies
        ),
        Quantity(
            f"{name}_surface", unit, f"{text} at the surface", role="stress_surface", **of_bodies
        ),
        Quantity(
            f"{name}_max_at",
            "mm",
            f"position (x, y, depth) of the {text}",
            dims=("body", "position"),
            role="stress_max_at",
            **stressed,
        ),
        replace(_error_bar(largest), role="stress_max_error"),
    )


_STRESSES = stress_columns(VON_MISES)

_OF_BODIES = {"dims": ("body",), "needs": ("fatigue.limit",), "bodies_of": "fatigue"}
_IN_VOLUME = {"dims": ("body",), "needs": ("fatigue.volume",), "bodies_of": "fatigue"}
_OF_PLACES = _OF_BODIES | {"dims": ("body", "position")}
_YIELD = "fatigue.shear_yield_stress"
_SHAKEDOWN = {"dims": ("body",), "needs": (_YIELD,), "bodies_of": "fatigue"}

# fmt: off
_FATIGUE = (
    Quantity("shakedown_lower", "1", "load factor up to which elastic shakedown is certain",
             symbol=r"\lambda_-", format=".3f", **_SHAKEDOWN),
    Quantity("shakedown_upper", "1", "load factor from which elastic shakedown is impossible",
             symbol=r"\lambda_+", format=".3f", **_SHAKEDOWN),
    Quantity("shakedown_interior", "1", "load factor up to which it is certain inside the body",
             format=".3f", **_SHAKEDOWN),
    Quantity("shakedown_surface", "1", "load factor up to which it is certain at the surface",
             format=".3f", **_SHAKEDOWN),
    Quantity("shakedown_lower_at", "mm", "position (no x, y, depth) that bounds shakedown_lower",
             **_SHAKEDOWN | {"dims": ("body", "position")}),
    Quantity("fi_surf", "1", "surface fatigue index, the largest |p_t|/p_n - k/p_n",
             _surface_fatigue_index, symbol=r"FI_\mathrm{surf}", format=".4f",
             needs=(_YIELD, "friction")),
    Quantity("utilisation", "1", "largest equivalent stress of the cycle over its limit",
             symbol="u", format=".3f", **_OF_BODIES),
    Quantity("utilisation_interior", "1", "largest utilisation inside the body",
             format=".3f", **_OF_BODIES),
    Quantity("utilisation_surface", "1", "largest utilisation at the surface",
             format=".3f", **_OF_BODIES),
    Quantity("utilisation_at", "mm", "position of it (x only in a transient, y, depth)",
             **_OF_PLACES),
    Quantity("damage", "1", "largest damage of the remaining material; at 1 a crack starts",
             symbol="D", format=".3g", **_OF_BODIES),
    Quantity("damage_at", "mm", "position of it (x only in a transient, y, depth below the "
             "unworn surface)",
             **_OF_PLACES),
    Quantity("damage_error", "1", "error of it by the length of jumps, the order of blocks and the "
             "points of stress paths, with [accuracy] by the mesh as well", _bars_of_damage,
             format=".1g", **_OF_BODIES),
    Quantity("initiation", "1", "revolution at which it reached 1", format=".4g", **_OF_BODIES),
    Quantity("fatigue_life", "1", "revolutions, or repetitions of a transient, to a crack by the "
             "stress so far, without wear",
             format=".4g", **_OF_BODIES),
    Quantity("wear_margin", "1", "smallest wear over the wear that balances fatigue, across the "
             "track; below 1 cracks start; none without wear", format=".3g", **_OF_BODIES),
    Quantity("stressed_volume", "1", "integral of stress over the volume, N and mm by the "
             "exponents of fatigue.volume; of a flat body over 1 mm of track", format=".4g",
             **_IN_VOLUME),
    Quantity("volume_life", "1", "revolutions that all of the volume survives, by this record's "
             "stress, with the probability fatigue.volume.survival", format=".4g",
             **_IN_VOLUME | {"needs": ("fatigue.volume.constant",)}),
    Quantity("volume_at_top", "1", "share of the stress that counts an element deep in the largest "
             "of all: near 1 the volume grows with the mesh", format=".2g", **_IN_VOLUME),
    Quantity("balancing_wear_A", "mm", "wear of body A in a revolution that balances fatigue",
             dims=("y",), needs=("fatigue.limit",), when=partial(_has_fatigue, "A")),
    Quantity("balancing_wear_B", "mm", "wear of body B in a revolution that balances fatigue",
             dims=("y",), needs=("fatigue.limit",), when=partial(_has_fatigue, "B")),
)
# fmt: on


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
    *_FATIGUE,
    *(
        replace(_error_bar(column), when=_has_single_load)
        for column in _FATIGUE
        if column.name in _FATIGUE_WITH_ERROR_BAR
    ),
    *(_error_bar(_BY_NAME[name]) for name in WITH_ERROR_BAR),
    _STRESSES[-1],
    Quantity(
        "relative_error",
        "1",
        "widest relative error bar of what accuracy.tolerance bounds",
        partial(_bar, "relative"),
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
