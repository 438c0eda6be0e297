"""The columns and fields of records: names, units, descriptions, and how each is computed.

This table defines the columns of the results file, of the JSON and the tables of `tractive-sam
show`, and the labels of figures. A new column needs a line in `COLUMNS`, a new stored field a line
in `MORE_FIELDS`.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import partial
from operator import attrgetter
from typing import Any

import numpy as np

from tractive_sam.mechanics import VON_MISES, StressCriterion
from tractive_sam.results.quantity import BODIES, COORDINATE, Quantity, index_by_name
from tractive_sam.results.state import State
from tractive_sam.scene import Scene
from tractive_sam.schema import required


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
        Quantity(
            "gap",
            "mm",
            "separation of the deformed surfaces",
            attrgetter("gap"),
            outside=math.inf,
        ),
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

_warm = partial(Quantity, needs=("heat",), outside=math.nan)

MORE_FIELDS = index_by_name(
    (
        _warm("temperature_A", "degC", "temperature of the surface of body A",
              partial(read_heat, "temperature_A")),
        _warm("temperature_B", "degC", "temperature of the surface of body B",
              partial(read_heat, "temperature_B")),
        _warm("heat_into_A", "mW/mm2", "heat flux into body A", partial(read_heat, "into_A")),
    )
)  # fmt: skip
"""Fields stored for scenes that have what they need; resuming does not need them."""

PACKAGE_FIELDS = {**FIELDS, **MORE_FIELDS, BOUND.name: BOUND}
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
    more = {name: quantity for name, quantity in MORE_FIELDS.items() if quantity.applies(scene)}
    return FIELDS | index_by_name(shifted) | more | {BOUND.name: BOUND}


def _bars_of_damage(contact: State) -> Any:
    """Return the error bars of the damage of a contact, by body; empty if there are none."""
    return contact.error_bars.get("damage", {})


def _has_fatigue(body: str, scene: Scene) -> bool:
    """Return whether [fatigue] of a scene covers a body."""
    return body in required(scene.fatigue, "fatigue").bodies


def _surface_fatigue_index(contact: State) -> float:
    """Return the surface fatigue index: the largest |p_t|/p_n - k/p_n in contact; nan without."""
    common = required(contact.scene.fatigue, "fatigue").shear_yield_stress
    of_bodies = [steel.at("shear_yield", 0.0) for steel in contact.scene.steel.values()]
    k = min(float(value) for value in (common, *of_bodies) if value is not None)
    touching = contact.touching
    if not touching.any():
        return math.nan
    shear = np.hypot(*contact.traction[:, touching]) - k
    return float((shear / contact.pressure[touching]).max())


_of_bodies = partial(Quantity, dims=("body",), bodies_of="fatigue")
_fatigue = partial(_of_bodies, needs=("fatigue.limit",))
_volume = partial(_of_bodies, needs=("fatigue.volume",))
_shakedown = partial(_of_bodies, needs=("fatigue.shear_yield_stress",))
_layer = partial(_of_bodies, unit="1", format="g", needs=("fatigue.limit", "fatigue.is_layered"))
_position = partial(_fatigue, dims=("body", "position"))


def _has_lifts(scene: Scene) -> bool:
    """Return whether the lift of an inclusion of a scene changes the contact."""
    return any(inclusion.lifts for inclusion in scene.inclusion)


_inclusion = partial(Quantity, dims=("body",), needs=("inclusion",), over_blocks="largest")
_by_inclusion = partial(_inclusion, needs=("inclusion", "fatigue.limit"))
_by_lift = partial(_inclusion, when=_has_lifts)
_places: dict[str, Any] = {"dims": ("body", "position"), "over_blocks": "mean"}

# fmt: off
FATIGUE_COLUMNS = (
    _shakedown("shakedown_lower", "1", "load factor up to which elastic shakedown is certain",
               symbol=r"\lambda_-", format=".3f", over_blocks="smallest"),
    _shakedown("shakedown_upper", "1", "load factor from which elastic shakedown is impossible",
               symbol=r"\lambda_+", format=".3f", over_blocks="smallest"),
    _shakedown("shakedown_interior", "1", "load factor up to which elastic shakedown is certain "
                                          "inside the body",
               format=".3f", over_blocks="smallest"),
    _shakedown("shakedown_surface", "1", "load factor up to which elastic shakedown is certain "
                                         "at the surface",
               format=".3f", over_blocks="smallest"),
    _shakedown("shakedown_lower_at", "mm",
               "position (x is nan, y, depth) that determines shakedown_lower",
               dims=("body", "position"), place_of="shakedown_lower"),
    _of_bodies("yield_factor", "1", "load factor at which the material first yields, with its "
                                    "residual stress", symbol=r"\lambda_y", format=".3f",
               needs=("residual", "fatigue.shear_yield_stress"), over_blocks="smallest"),
    Quantity("fi_surf", "1", "surface fatigue index, the largest |p_t|/p_n - k/p_n",
             _surface_fatigue_index, symbol=r"FI_\mathrm{surf}", format=".4f",
             needs=("fatigue.shear_yield_stress", "friction"), over_blocks="largest"),
    _fatigue("utilisation", "1", "largest ratio of the equivalent stress of the cycle to its limit",
             symbol="u", format=".3f", over_blocks="largest"),
    _fatigue("utilisation_interior", "1", "largest utilisation inside the body",
             format=".3f", over_blocks="largest"),
    _fatigue("utilisation_surface", "1", "largest utilisation at the surface",
             format=".3f", over_blocks="largest"),
    _position("utilisation_at", "mm", "position of the largest utilisation (x only in a "
                                      "transient, y, depth)", place_of="utilisation"),
    _layer("utilisation_layer", long_name="layer with the largest utilisation, 0 at the surface"),
    _layer("failing_layer", long_name="layer with the shortest fatigue_life, 0 at the surface"),
    _fatigue("damage", "1", "largest damage of the remaining material; at 1 a crack starts",
             symbol="D", format=".3g"),
    _position("damage_at", "mm", "position of the largest damage (x only in a transient, y, "
                                 "depth below the unworn surface)", place_of="damage"),
    _fatigue("damage_error", "1", "error of the damage due to the length of jumps, the order of "
                                  "blocks and the points of stress paths; with [accuracy], also "
                                  "due to the mesh", _bars_of_damage,
             format=".1g", error_of="damage"),
    _fatigue("initiation", "1", "revolution at which the damage reached 1", format=".4g"),
    _fatigue("fatigue_life", "1", "revolutions, or repetitions of a transient, until a crack "
                                  "starts under the stress of this record, without wear",
             format=".4g"),
    _fatigue("wear_margin", "1", "smallest ratio across the track of the wear to the wear that "
                                 "balances fatigue; below 1, cracks start; nan without wear",
             format=".3g"),
    _volume("stressed_volume", "1", "integral of the stress over the volume, in N and mm with "
                                    "the exponents of fatigue.volume; for a flat body, over 1 "
                                    "mm of track", format=".4g"),
    _of_bodies("volume_life", "1", "revolutions that the complete volume survives under the "
                                   "stress of this record, with the probability "
                                   "fatigue.volume.survival", format=".4g",
               needs=("fatigue.volume.constant",)),
    _volume("volume_at_top", "1", "integrand at a depth of one element divided by its largest "
                                  "value; near 1, the volume grows as the mesh is refined",
            format=".2g"),
    Quantity("balancing_wear_A", "mm", "wear of body A per revolution that balances fatigue",
             dims=("y",), needs=("fatigue.limit",), when=partial(_has_fatigue, "A")),
    Quantity("balancing_wear_B", "mm", "wear of body B per revolution that balances fatigue",
             dims=("y",), needs=("fatigue.limit",), when=partial(_has_fatigue, "B")),
    _inclusion("inclusion_von_mises", "MPa", "largest von Mises stress next to an inclusion"),
    _inclusion("inclusion_von_mises_at", "mm",
               "position (x, y, depth) of the largest von Mises stress next to an inclusion",
               place_of="inclusion_von_mises", **_places),
    _inclusion("inclusion_tension", "MPa", "largest tension in an inclusion"),
    _inclusion("inclusion_lift", "mm", "largest displacement of the surface above an inclusion, in "
                                       "either direction", format=".3g"),
    _by_lift("inclusion_p_max", "MPa", "largest peak pressure while inclusions pass"),
    _by_lift("inclusion_p_min", "MPa", "smallest peak pressure while inclusions pass",
             over_blocks="smallest"),
    _by_lift("inclusion_iterations", "1", "most contacts solved at a position of inclusions until "
                                          "their lift and the pressure agree", format="g"),
    _by_lift("inclusion_residual", "1", "largest change of the lift in the last iteration over the "
                                        "largest lift", format=".0e"),
    _by_inclusion("inclusion_utilisation", "1", "largest utilisation next to an inclusion",
                  symbol="u", format=".3f"),
    _by_inclusion("inclusion_utilisation_at", "mm",
                  "position (y, depth) of the largest utilisation next to an inclusion",
                  place_of="inclusion_utilisation", **_places),
    Quantity("inclusion_convolutions", "1", "convolutions for the stress around inclusions and the "
                                            "contacts above them, in units of one tangential "
                                            "application", needs=("inclusion",),
             over_blocks="sum"),
)
# fmt: on


_on_interface = partial(Quantity, needs=("subsurface", "body.is_layered"), bodies_of="subsurface")


def read_error_bar(name: str, contact: State) -> float:
    """Return the error bar of a named quantity of a contact; nan if there is none."""
    return contact.error_bars.get(name, math.nan)


def _read_error_bars(name: str, contact: State) -> dict[str, float]:
    """Return the error bars of a named quantity of both bodies; nan if there are none."""
    bars = contact.error_bars.get(name, {})
    return {body: bars.get(body, math.nan) for body in BODIES}


def error_bar_column(of: Quantity) -> Quantity:
    """Return the column "..._error" that holds the error bar of a quantity."""
    return replace(
        of,
        name=f"{of.name}_error",
        long_name=f"error bar of {of.name}",
        over_blocks="mean",
        error_of=of.name,
        of=partial(_read_error_bars if of.dims else read_error_bar, of.name),
        symbol="",
        needs=(*of.needs, "accuracy"),
    )


def stress_columns(criterion: StressCriterion) -> tuple[Quantity, ...]:
    """Return columns of a stress criterion: largest, interior, surface, position, error bar."""
    name, unit, text = criterion.name, criterion.unit, f"largest {criterion.long_name}"
    stressed = partial(Quantity, needs=("subsurface",), bodies_of="subsurface")
    of_body = partial(
        stressed, unit=unit, dims=("body",), symbol=criterion.symbol, over_blocks="largest"
    )
    of_position = partial(stressed, unit="mm", dims=("body", "position"), place_of=f"{name}_max")
    largest, interior, surface, position = (
        column(f"{name}_{part}", long_name=meaning, role=f"stress_{part}")
        for column, part, meaning in (
            (of_body, "max", f"{text}, inside or at the surface"),
            (of_body, "interior", f"{text} inside the body"),
            (of_body, "surface", f"{text} at the surface"),
            (of_position, "max_at", f"position (x, y, depth) of the {text}"),
        )
    )
    return (
        *(largest, interior, surface, position),
        replace(error_bar_column(largest), role="stress_max_error"),
    )


def _over_load(force: str, contact: State) -> float:
    """Return a force of a contact over its load; 0 without load."""
    return getattr(contact, force) / contact.P if contact.P else 0.0


def _deepest(contact: State) -> float:
    """Return the largest wear depth of both bodies together, mm."""
    return float(contact.wear.max())


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

PARAMETER = Quantity(
    "distance",
    "1",
    "parameter of the courses; the bodies do not roll",
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
    replace(DISTANCE, needs=("transient.is_mixed",),
            long_name="rolling distance, and the parameter of stages in which the bodies shift"),
    DISTANCE,  # the last of its name, which is therefore found without a scene
    Quantity("P", "N", "normal load", attrgetter("P"), symbol="P", per_length=True),
    Quantity("Qx", "N", "longitudinal force on body A", attrgetter("Qx"),
             symbol="Q_x", per_length=True),
    Quantity("Qy", "N", "lateral force on body A", attrgetter("Qy"),
             symbol="Q_y", per_length=True),
    Quantity("Fy", "N", "lateral force on A of pressure and traction, at the middle of the patch",
             partial(read_component, "resultant", 0), symbol="F_y", needs=("conformal",),
             per_length=True),
    Quantity("Fz", "N", "normal force on A of pressure and traction, at the middle of the patch",
             partial(read_component, "resultant", 1), symbol="F_z", needs=("conformal",),
             per_length=True),
    Quantity("Mz", "N mm", "spin moment on body A", attrgetter("Mz"),
             symbol="M_z", per_length=True),
    Quantity("Mx", "N mm", "moment of the pressure about x, the integral of p y",
             attrgetter("Mx"), symbol="M_x", needs=("body.has_roller",)),
    Quantity("My", "N mm", "rolling resistance moment, the integral of p x",
             attrgetter("My"), symbol="M_y", needs=("body.relaxes",), per_length=True),
    Quantity("tilt", "mrad", "angle between the axes of the rollers; their distance grows with y",
             attrgetter("tilt"), symbol=r"\theta", needs=("body.has_roller",)),
    Quantity("end_load", "N", "load within a twentieth of the width of the free ends",
             attrgetter("end_load"), symbol="P_e", needs=("body.has_ends",)),
    Quantity("Qx_over_P", "1", "longitudinal force over normal load",
             partial(_over_load, "Qx"), symbol="Q_x/P", format=".4f"),
    Quantity("Qy_over_P", "1", "lateral force over normal load",
             partial(_over_load, "Qy"), symbol="Q_y/P", format=".4f"),
    Quantity("approach", "mm", "approach; in a line contact, relative to surface points at the "
                               "distance R_x",
             attrgetter("approach"), symbol=r"\delta"),
    Quantity("p_max", "MPa", "peak contact pressure", attrgetter("p_max"),
             symbol=r"p_\mathrm{max}", over_blocks="largest"),
    Quantity("p_95", "MPa", "pressure above which 5 % of the load is carried",
             attrgetter("p_95"), symbol="p_{95}", over_blocks="largest"),
    Quantity("half_width_x", "mm", "half-width of the contact in the rolling direction; its "
                                   "edge may lie between elements",
             attrgetter("half_width_x"), symbol="a", over_blocks="largest"),
    Quantity("half_width_y", "mm", "half-width of the contact in the lateral direction; its "
                                   "edge may lie between elements",
             attrgetter("half_width_y"), symbol="b", over_blocks="largest"),
    Quantity("area", "mm2", "contact area", attrgetter("area"), symbol="A",
             per_length=True),
    Quantity("wear_max", "mm", "largest wear depth, both bodies together",
             _deepest, symbol=r"w_\mathrm{max}", over_blocks="largest"),
    Quantity("stick_fraction", "1", "fraction of the contact area that sticks",
             attrgetter("stick_fraction"), format=".3f"),
    Quantity("xi_x", "1", "longitudinal creepage", attrgetter("xi_x"), symbol=r"\xi_x"),
    Quantity("xi_y", "1", "lateral creepage", attrgetter("xi_y"), symbol=r"\xi_y"),
    Quantity("spin", "1/mm", "spin creepage", attrgetter("spin"), symbol=r"\varphi"),
    Quantity("residual", "1", "relative residual of the contact conditions",
             attrgetter("residual"), format=".0e", over_blocks="largest"),
    Quantity("dissipation", "N", "frictional work per unit rolling distance, by traction and slip",
             attrgetter("dissipation"), per_length=True),
    Quantity("work_supplied", "N", "work of the driving forces per unit rolling distance",
             attrgetter("work_supplied"), per_length=True),
    Quantity("t_gamma", "N", "T-gamma, -(Q_x xi_x + Q_y xi_y + M_z phi)", attrgetter("t_gamma"),
             symbol=r"T\gamma", per_length=True),
    Quantity("t_gamma_over_area", "MPa", "T-gamma over the contact area",
             attrgetter("t_gamma_over_area"), symbol=r"T\gamma/A"),
    Quantity("bulk_dissipation", "N", "work per unit rolling distance that a body loses inside",
             attrgetter("bulk_dissipation"), dims=("body",), needs=("body.relaxes",),
             per_length=True),
    Quantity("worn_area", "mm2", "cross-section worn off both bodies in a pass",
             attrgetter("worn_area"), per_length=True),
    Quantity("operator_applications", "1", "applications of elastic operators",
             attrgetter("cost.applications"), over_blocks="sum"),
    Quantity("convolutions", "1", "convolutions, in units of one tangential application",
             attrgetter("cost.convolutions"), over_blocks="sum"),
    Quantity("over_application", "1", "CPU time of a solution over one tangential application",
             attrgetter("cost.over_application"), over_blocks="sum"),
    Quantity("jump", "1", "number of revolutions in the next step", format="d"),
    Quantity("converged", "1", "1 if the contact conditions hold to the tolerance",
             partial(read_number, "converged"), format="d", over_blocks="smallest"),
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
)

_ARRAYS = (
    Quantity("p_max_at", "mm", "position (x, y) of the peak contact pressure",
             attrgetter("p_max_at"), ("axis",), place_of="p_max"),
    Quantity("wear_profile", "mm", "wear depth behind the contact, both bodies together; for "
                                   "shifts, the largest along x",
             partial(read_component, "wear", 0), ("y",)),
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
    Quantity("creepage_found", "1", "creepages (x, y) that the prescribed forces require",
             attrgetter("creepage_found"), ("axis",), needs=("finds_creepage",)),
    _of_heat("temperature_max", "degC", "largest temperature of the surfaces in contact",
             partial(read_heat, "temperature_max"), symbol=r"T_\mathrm{max}",
             over_blocks="largest"),
    _of_heat("temperature_max_at", "mm", "position (x, y) of the largest temperature",
             partial(read_heat, "temperature_max_at", none=(math.nan, math.nan)),
             ("axis",), place_of="temperature_max"),
    _of_heat("temperature_mean", "degC", "mean temperature of the surfaces in contact",
             partial(read_heat, "temperature_mean"), symbol=r"T_\mathrm{mean}"),
    _of_heat("heat_share", "1", "fraction of the frictional heat that flows into body A",
             partial(read_heat, "share"), format=".4f"),
    Quantity("worn_volume", "mm3", "volume worn off each body since it was new; for a flat "
                                   "body, only in a transient",
             attrgetter("worn_volume"), ("body",), symbol="V", per_length=True, needs=("wear",)),
    Quantity("worn_mass", "mg", "mass worn off each body since it was new, from its density",
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

_BY_NAME = index_by_name((*_SCALARS, *_ARRAYS))

COLUMNS = (
    *_SCALARS,
    *_ARRAYS,
    *_STRESSES[:-1],
    # Stress that may detach layers.
    *(
        column
        for name, text in (("shear", "shear stress"), ("tension", "normal stress, tension above 0"))
        for column in (
            _on_interface(
                f"interface_{name}",
                "MPa",
                f"largest {text}, on the interfaces of layers",
                dims=("body",),
                over_blocks="largest",
            ),
            _on_interface(
                f"interface_{name}_at",
                "mm",
                f"position (x, y, depth) of interface_{name}",
                dims=("body", "position"),
                place_of=f"interface_{name}",
            ),
        )
    ),
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
        "largest relative error bar of the quantities that accuracy.tolerance limits",
        partial(read_error_bar, "relative"),
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
