"""Describe a history: numbers with error bars, balances, caveats.

Contacts in steady rolling balance per distance rolled; steps of a course balance together with the
elastic energy stored in the bodies. The columns of a history determine its kind of balance.
"""

import math
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import ClassVar

import numpy as np

from tractive_sam.description import TextTable, format_number
from tractive_sam.results.history_data import UNNAMED, HistoryData
from tractive_sam.results.quantity import BODIES, Quantity
from tractive_sam.scene import Scene, conformity_notes, describe_load, edge_notes, pressure_notes
from tractive_sam.schema import required


class SteadyBalance:
    """Balances of work and of wear in the records of steady rolling.

    Parameters
    ----------
    history : HistoryData
        All records.
    """

    rounding = 1e-12
    """Share of the terms of a sum that its rounding may reach."""

    worn: ClassVar[str] = "section"
    """Quantity that the wear balance compares with the wear that the work of friction causes."""

    def __init__(self, history: HistoryData):
        self.history = history

    @property
    def dissipated(self) -> str:
        """Quantity that the energy balance compares with the supplied work."""
        return "friction and the bodies dissipate" if self._relaxes else "friction dissipates"

    @property
    def _relaxes(self) -> bool:
        """Whether a body dissipates work inside."""
        return self.history.scene.has("body.relaxes")

    @property
    def energy(self) -> np.ndarray:
        """Ratio of dissipated to supplied work in each record, shape (n,); nan without work.

        It is 1 without numerical error, and nan without dissipation, or if no work is supplied.
        """
        history = self.history
        supplied = history["work_supplied"]
        rounding = self.rounding * history["P"] * np.abs(history["approach"])
        driven = np.abs(supplied) > rounding / history.grid.half_length[0]
        inside = history["bulk_dissipation"].sum(axis=1) if self._relaxes else 0.0
        driven &= history.scene.has("friction") or self._relaxes
        return _ratio(history["dissipation"] + inside, supplied, driven)

    @property
    def wear(self) -> np.ndarray:
        """Ratio of wear to the wear expected from frictional work, (n,); nan if unknown."""
        history = self.history
        largest = history["wear_max"] * 2.0 * history.grid.half_length[1]
        return self._worn_by_work(history["worn_area"], history["dissipation"], largest)

    @property
    def wear_overall(self) -> np.ndarray:
        """Wear balances by which the wear of a history is judged: `wear` of each record."""
        return self.wear

    def _worn_by_work(self, worn: np.ndarray, work: np.ndarray, total: np.ndarray) -> np.ndarray:
        """Return wear over the nearest wear that `work` allows; nan if unknown or rounding."""
        per_work = self._wear_per_work
        if per_work is None:
            return np.full(len(worn), np.nan)
        low, high = sorted(per_work)
        wears = (worn > self.rounding * total) & (work > 0.0)
        return _ratio(worn, np.clip(worn, low * work, high * work), wears)

    @property
    def _wear_per_work(self) -> tuple[float, float] | None:
        """Wear depth per frictional work along both axes, 1/MPa; None if not constant."""
        scene = self.history.scene
        changing = "friction.mu" in scene.schedule.courses
        changing = changing or scene.has("wear.temperature") or scene.has("duty")
        return None if changing else self._wear_per_work_of(scene)

    def _wear_per_work_of(self, scene: Scene) -> tuple[float, float] | None:
        """Return the wear depth per frictional work of one block; None if not constant."""
        replaced = not {"friction", "wear", UNNAMED}.isdisjoint(self.history.law_records)
        friction, wear = scene.friction, scene.wear
        if friction is None or wear is None or replaced or friction.varies:
            return None
        return wear.per_work(friction.mu)

    @property
    def energy_cure(self) -> str:
        """End of a message: possible reason of an error of the energy balance; may be empty."""
        if self.history.scene.solver.slip == "upwind":
            return ': the upwind slip of the paper does that, solver.slip = "auto" does not'
        return ""

    @property
    def wear_cure(self) -> str:
        """Beginning of a message: remedy for an error of the wear balance."""
        return "more elements across the contact bring"


class StepBalance(SteadyBalance):
    """Balances of work and wear in the steps of a transient, which store elastic energy."""

    worn = "volume"

    @property
    def dissipated(self) -> str:
        """Quantity that the energy balance compares with the supplied work."""
        return f"{super().dissipated} and the bodies store"

    @property
    def energy(self) -> np.ndarray:
        """Ratio of dissipated plus stored to supplied work in each step, (n,); first nan.

        See `SteadyBalance.energy`.
        """
        history = self.history
        stored, supplied = history["elastic_energy"], history["step_work"]
        gained = np.diff(stored, prepend=np.nan)
        driven = np.abs(supplied) > 1e-6 * np.abs(stored)
        lost = history["step_friction"]
        if "step_bulk" in history.columns:
            lost = lost + history["step_bulk"].sum(axis=1)
        return _ratio(lost + gained, supplied, driven)

    @property
    def wear(self) -> np.ndarray:
        """Ratio of wear in each step to the wear expected from its work, (n,); nan if unknown."""
        history = self.history
        if "step_worn" not in history.columns:
            return np.full(len(history), np.nan)
        total = history["worn_volume"].sum(axis=1)
        return self._worn_by_work(history["step_worn"], history["step_friction"], total)

    @property
    def wear_overall(self) -> np.ndarray:
        """Wear balance of all steps together, shape (1,); shape (0,) without wear.

        The wear of shifts is proportional to their work only in the limit of small steps.
        """
        balance = self.wear
        finite = np.isfinite(balance) & (balance > 0.0)
        if not finite.any():
            return np.zeros(0)
        worn = self.history["step_worn"][finite]
        return np.array([worn.sum() / (worn / balance[finite]).sum()])

    @property
    def energy_cure(self) -> str:
        """End of a message: possible reason of an error of the energy balance."""
        return "; material leaves the mesh under load: use a longer grid.half_length"

    @property
    def wear_cure(self) -> str:
        """Beginning of a message: remedy for an error of the wear balance."""
        scene = self.history.scene
        if scene.schedule.shifts:
            return "a shorter transient.step brings"
        if scene.solver.slip == "upwind":
            return 'solver.slip = "auto" or more elements across the contact bring'
        return super().wear_cure


class ProfileBalance(SteadyBalance):
    """Balances of worn profiles: the wear since they were new, at all positions together."""

    @property
    def wear(self) -> np.ndarray:
        """Ratio of worn sections to those expected from frictional work, (n,); nan if unknown."""
        scene = self.history.scene
        share, passes = scene.wear_share, required(scene.rail, "rail").passes_per_revolution
        sections = self.history["worn_section"].sum(axis=1) / (share["A"] + passes * share["B"])
        return self._worn_by_work(sections, self.history["profile_work"], sections)

    @property
    def _wear_per_work(self) -> tuple[float, float] | None:
        """Wear depth per frictional work along both axes, 1/MPa; None if positions differ."""
        scene = self.history.scene
        each = {self._wear_per_work_of(local) for local in scene.blocks}
        return each.pop() if len(each) == 1 and not scene.has("wear.temperature") else None

    @property
    def wear_cure(self) -> str:
        """Beginning of a message: remedy for an error of the wear balance."""
        return "a smaller wear.tolerance, or more elements across the contact, bring"


def balance_of(history: HistoryData) -> SteadyBalance:
    """Return the balances of a history: of a transient, of worn profiles, or of steady rolling."""
    if "step_work" in history.columns:
        return StepBalance(history)
    return (ProfileBalance if "profile_work" in history.columns else SteadyBalance)(history)


def _ratio(over: np.ndarray, under: np.ndarray, where: np.ndarray) -> np.ndarray:
    """Return over / under where a mask is true, and nan elsewhere."""
    return np.divide(over, under, out=np.full(len(over), np.nan), where=where)


def format_values(history: HistoryData, row: int) -> Iterator[tuple[str, str, Quantity]]:
    """Yield (name, text of number ± error bar, column) of a record, by scalar column and body."""
    for name, quantity in history.of_dims().items():
        if not (quantity.error_of or np.isnan(history[name]).all()):
            value = history[name][row]
            small = abs(value) < _solver_error(history, name, row)
            text = format_number(0.0 if small else value, error_bar(history, name, row))
            yield name, text, quantity
    for name, quantity in history.of_dims("body").items():
        for body in quantity.bodies(history.scene) if not quantity.error_of else ():
            k = BODIES.index(body)
            value, bar = history[name][row, k], error_bar(history, name, row, k)
            yield (
                f"{name} {body}",
                format_number(value, bar) if math.isfinite(value) else "none",
                quantity,
            )


def _solver_error(history: HistoryData, name: str, row: int, share: float = 1e-6) -> float:
    """Return the size up to which a force or moment may be a solver error beside larger forces."""
    force = share * math.hypot(history["Qx"][row], history["Qy"][row])
    ratio = force / history["P"][row] if history["P"][row] > 0.0 else 0.0
    scales = {"Qx": force, "Qy": force, "Qx_over_P": ratio, "Qy_over_P": ratio}
    return (scales | {"Mz": force * history["half_width_x"][row]}).get(name, 0.0)


def error_bar(history: HistoryData, name: str, row: int, *body: int) -> float:
    """Return the error bar of a quantity in a record; zero if it has none."""
    try:
        bars = history[f"{name}_error"]
    except KeyError:
        return 0.0
    bar = float(bars[(row, *body)])
    return 0.0 if math.isnan(bar) else bar


def describe_programs(history: HistoryData) -> str:
    """List program versions that changed when a history was resumed, with the first record."""
    changes = []
    for (_, before), (record, after) in pairwise(history.provenance):
        changed = [name for name in after if after[name] != before.get(name)]
        programs = ", ".join(f"{name} {after[name]}" for name in changed)
        along = history.coordinate.name
        places = history[along][record : record + 1]
        changes += [f"{programs} from {along} {place} on" for place in places]
    return "; ".join(changes)


def describe_balances(history: HistoryData, only_if_open: bool = False) -> dict[str, str]:
    """Describe the "energy" and "wear" balances where their error is largest, as text by name.

    For a duty cycle the distance is sought in the records of all blocks. The wear of a transient is
    balanced over all of its course, since the wear of shifts is proportional to their work only for
    small steps. Without work, or without wear, there is no balance.

    Parameters
    ----------
    history : History
        All records.
    only_if_open : bool
        Whether to omit balances with an error of at most half a percent.
    """
    # Error of the energy balance that is not reported.
    closed_within = 5e-3
    parts = [history.block(k) for k in range(len(history.scene.duty))] or [history]
    each = [balance_of(part) for part in parts]
    worn = [balance_of(history)] if "profile_work" in history.columns else each
    texts: dict[str, str] = {}
    for name, balances, ratios in (
        ("energy", each, [balance.energy for balance in each]),
        ("wear", worn, [balance.wear_overall for balance in worn]),
    ):
        values = np.concatenate(ratios)
        values = values[np.isfinite(values)]
        if values.size:
            worst = values[abs(values - 1.0).argmax()]
            closed = abs(worst - 1.0) <= closed_within
            if closed and only_if_open:
                continue
            first = balances[0]
            if name == "energy":
                text = f"{first.dissipated} {worst:.5f} of the work supplied"
                advice = f"wear is as much in error{first.energy_cure}"
            else:
                text = f"the worn {first.worn} is {worst:.5f} of what the frictional work wears"
                advice = f"{first.wear_cure} them together"
            texts[name] = text if closed else f"{text}; {advice}"
    return texts


def caveats(history: HistoryData) -> dict[str, str]:
    """Return notes on results of a history that may mislead, as text by the row they belong to.

    "utilisation" so close to the surface that it depends on the mesh and has no error bar,
    "stress" that elements may miss, "width" of bodies that the contact fills, "p_max" that no
    material withstands or that is too small for the materials, "angle_range" of a conformal wheel,
    "layers" that wear thins or removes.
    """
    ranges = [name for name in ("angle_range", "block_angle_range") if name in history.columns]
    widest_range = max((np.nan_to_num(history[k]).max(initial=0.0) for k in ranges), default=0.0)
    notes = {
        "angle_range": "; ".join(conformity_notes(float(widest_range))),
        "layers": _describe_worn_layers(history),
        "stress": _describe_missed_stress(history),
        "p_max": _describe_implausible_pressure(history),
        "utilisation": _describe_shallow_utilisation(history),
    }
    half = history["half_width_y"]
    widest = 2.0 * float(half[np.isfinite(half)].max(initial=0.0))
    notes["width"] = "; ".join(edge_notes(history.scene, widest))
    return {name: text for name, text in notes.items() if text}


def _describe_worn_layers(history: HistoryData, share: float = 0.1) -> str:
    """Describe layers that wear has thinned by more than a share or removed; else an empty text."""
    texts = []
    wear = history.scene.wear
    follows = wear is not None and wear.layer_step is not None
    for body in BODIES if len(history) else ():
        layers = getattr(history.scene.body, body).layer
        column = f"wear_profile_{body}"
        column = column if column in history.columns else "wear_max"
        if not layers or column not in history.columns:
            continue
        worn = float(np.nan_to_num(history[column]).max(initial=0.0))
        thickness = layers[0].thickness
        if worn > share * thickness:
            text = (
                f"wear has removed {worn:.3g} of the {thickness:g} mm of the layer of body {body}"
            )
            if worn >= thickness:
                text = f"worn through: wear of {worn:.3g} mm, and the layer of body {body} is "
                text += f"{thickness:g} mm thick"
            if worn >= thickness or not follows:
                texts.append(text)
    if not texts:
        return ""
    if follows:
        return f"{'; '.join(texts)}; the contact continues with what lies below"
    cure = "the contact is computed with unworn layers: set wear.layer_step, or continue with a "
    return f"{'; '.join(texts)}; {cure}thinner layer"


def _describe_implausible_pressure(history: HistoryData) -> str:
    """Describe the largest pressure of a history if it is implausible; else an empty text."""
    pressure = np.where(history["converged"] > 0.0, history["p_max"], 0.0)
    if not pressure.any():
        return ""
    row = int(pressure.argmax())
    along = history.coordinate
    place = f" at {along.name} {format(history[along.name][row], along.format)}"
    return "; ".join(pressure_notes(history.scene, float(pressure[row]), place))


def _describe_shallow_utilisation(history: HistoryData, shallow: float = 3.0) -> str:
    """Warn of a largest utilisation so close to the surface that it depends on the mesh, or "".

    Within three elements, paths that are sampled at the elements lose up to 13 % of it.
    """
    columns = history.values
    if "utilisation_at" not in columns or "utilisation_error" in columns or not len(history):
        return ""
    depths = zip(BODIES, columns["utilisation_at"][-1, :, 2] / history.grid.dx, strict=True)
    near = [f"{body} {depth:.1f}" for body, depth in depths if depth <= shallow]
    if not near:
        return ""
    return (
        f"the largest one lies within {shallow:g} elements of the surface (body "
        f"{', '.join(near)} elements below it) and depends on their size, as do life and damage; "
        "use more elements, or set [accuracy] (of one load, without [[duty]]) for its error bar"
    )


def _describe_missed_stress(history: HistoryData) -> str:
    """Warn of elements too long to resolve the largest subsurface stress; else an empty text."""
    # Depth of the largest stress over the smaller semi-axis: 0.48 for a circle, 0.79 for a line.
    depth_of_stress = 0.6
    grid, hertz = history.grid, history.scene.hertz
    if not history.bodies or hertz is None or history.scene.gap is not None:
        return ""
    depth, side = depth_of_stress * min(hertz.a, hertz.b), max(grid.sides)
    if 2.0 * side <= depth:
        return ""
    return (
        f"the largest one inside lies about {depth:.3g} mm deep and is sought from two elements "
        f"deep on, {2.0 * side:.3g} mm: its value may be too small; use shorter elements"
    )


def describe_history(history: HistoryData) -> dict[str, str]:
    """Describe a history for reports: computation, balances, cost; text by label."""
    a0, b0, p0 = history.a0, history.b0, history.p0
    totals, saved = history.totals, len(history.saved)
    solves = totals["contact_solves"]
    rows = {
        "unworn contact": f"a0 = {a0:.5g} mm, b0 = {b0:.5g} mm, p0 = {p0:.6g} MPa by Hertz"
        if math.isfinite(p0) and history.scene.wheelset is None
        else "",
        "records": f"{len(history)}, {saved} with fields",
        **describe_load(history.scene),
        "laws": history.laws,
        "began with": history.started,
        "rolled on by": describe_programs(history),
        **{f"{name} balance": text for name, text in describe_balances(history).items()},
        **caveats(history),
        "cost": f"{solves} contacts solved in {totals['wall_seconds']:.3g} s" if solves else "",
    }
    return {label: text for label, text in rows.items() if text}


def summarize_history(history: HistoryData) -> dict[str, str]:
    """Return a short summary of a history (status, values of its last record): text by label."""
    # Numbers of the last record: those always shown, and those shown unless they are zero.
    last_values = (
        ("Qx_over_P", "Qy_over_P", "p_max", "half_width_x", "half_width_y", "stick_fraction"),
        ("wear_max", "worn_mass A", "worn_mass B", "xi_x", "xi_y"),
    )
    along = history.coordinate
    rows = {
        "scene": history.title or "no title",
        "status": history.status + (f": {history.message}" if history.message else ""),
        "records": f"{len(history)}, {len(history.saved)} with fields",
    }
    if not len(history):
        return rows
    first, last = (format(history[along.name][k], along.format) for k in (0, -1))
    rows[along.name] = first if len(history) == 1 else f"{first} to {last}"
    texts = {name: (value, quantity.unit) for name, value, quantity in format_values(history, -1)}
    always, nonzero = last_values
    for name in (*always, *nonzero):
        value, unit = texts.get(name, ("nan", ""))
        if value not in ("nan", "none", "inf") and (name in always or value != "0"):
            rows[name] = value if unit == "1" else f"{value} {unit}"
    return rows


@dataclass(frozen=True)
class Column:
    """A column of the printed table of records: quantity, heading, number format and factor.

    Attributes
    ----------
    name : str
        Column of the history.
    heading : str
        Heading, with the unit in the second line.
    format : str
        Format of its numbers.
    factor : float
        Factor of the numbers.
    """

    name: str
    heading: str
    format: str = ".4g"
    factor: float = 1

    def format_value(self, value: float) -> str:
        """Return a value of the quantity as text, times the factor of the column."""
        value *= self.factor
        return format(int(value) if self.format == "d" else value, self.format)


def select_columns(columns: Collection[str], creepages: bool = False) -> list[Column]:
    """Return the columns of the printed table of records, by the columns that a history has.

    Parameters
    ----------
    columns : collection of str
        Columns of the history; shifts of a transient replace the half widths, and patches of a
        wheel have their place and forces.
    creepages : bool
        Whether to print the creepages, which follow from prescribed forces.
    """
    # Columns of the table of records, in groups.
    ends = (
        Column("wear_max", "wear\nµm", factor=1e3),
        Column("stick_fraction", "stick\n%", ".1f", 100),
        Column("residual", "residual", ".0e"),
    )
    shifts = (
        Column("shift_x", "shift x\nµm", factor=1e3),
        Column("shift_y", "shift y\nµm", factor=1e3),
        Column("friction_work", "friction\nN mm"),
    )
    widths = (Column("half_width_x", "half x\nmm"), Column("half_width_y", "half y\nmm"))
    pressures = (Column("p_max", "p_max\nMPa"), Column("p_95", "p_95\nMPa"))
    creepage_columns = (Column("xi_x", "xi_x", ".3e"), Column("xi_y", "xi_y", ".3e"))
    forces = (Column("Qx_over_P", "Qx/P", "z.4f"), Column("Qy_over_P", "Qy/P", "z.4f"))
    shown_creepages = creepage_columns if creepages else ()
    if "shift_x" in columns:
        return [*forces, *shown_creepages, pressures[0], *shifts, pressures[1], *ends]
    if "contact_angle" in columns:
        patch = (Column("contact_y", "y\nmm", ".5g"), Column("contact_angle", "angle\ndeg", ".2f"))
        newtons = (Column(name, f"{name}\nN", "z.0f") for name in ("P", "Qx", "Qy"))
        return [*patch, *newtons, pressures[0], *widths, *ends]
    return [*forces, *shown_creepages, *pressures, *widths, *ends]


def last_record(history: HistoryData, solver: bool = False) -> TextTable:
    """Return the table of the last record, one quantity a row.

    Parameters
    ----------
    history : History
        At least one record.
    solver : bool
        Whether to include the quantities of the solver, which the totals summarize.
    """
    hidden: set[str] = set() if solver else {
        "operator_applications", "convolutions", "over_application", "jump", "converged", "solves",
        "seconds", "next_step", "stretch",
    }  # fmt: skip
    return _quantity_table(row for row in format_values(history, -1) if row[0] not in hidden)


def main_results(history: HistoryData, max_rows: int = 15) -> TextTable:
    """Return the table of the main results of the last record that are not zero.

    Parameters
    ----------
    history : History
        At least one record.
    max_rows : int
        Most rows: they fit a terminal of 24 lines together with the load.
    """
    order = (
        "contact_y", "P", "Qx", "Qy", "Mz", "Qx_over_P", "worn_mass", "fatigue_life", "shift_x",
        "friction_work", "p_max", "p_95", "half_width_x", "half_width_y", "stick_fraction",
        "wear_max", "temperature_max", "stress_max", "von_mises_max", "utilisation", "xi_x", "xi_y",
    )  # fmt: skip
    rows = [row for row in format_values(history, -1) if row[1] not in ("0", "nan", "none")]
    main = [row for name in order for row in rows if row[2].name == name]
    caption = "run --verbose prints all quantities, show FILE all of every record"
    return _quantity_table(main[:max_rows], caption)


def _quantity_table(rows: Iterable[tuple[str, str, Quantity]], caption: str = "") -> TextTable:
    """Return the table of quantities: name, value, unit and meaning."""
    cells = [[name, text, _unit_of(column), column.long_name] for name, text, column in rows]
    return TextTable(cells, numbers=frozenset({1}), caption=caption)


def record_table(history: HistoryData, max_rows: int = 20) -> TextTable:
    """Return the table of at most `max_rows` records, at about equal distances."""
    count, coordinate = len(history), history.coordinate
    heading = "\n".join(filter(None, (coordinate.symbol or coordinate.name, _unit_of(coordinate))))
    has_creepages = "creepage_found" in history.columns and any(map(math.isfinite, history["xi_x"]))
    columns = select_columns(history.columns, creepages=has_creepages)
    columns = [Column(coordinate.name, heading, coordinate.format), *columns]
    shown = _select_spaced(history[coordinate.name].tolist(), max_rows)
    return TextTable(
        [[column.format_value(history[column.name][row]) for column in columns] for row in shown],
        tuple(column.heading for column in columns),
        frozenset(range(len(columns))),
        f"{len(shown)} of {count} records; show --json prints all" if len(shown) < count else "",
    )


def _unit_of(quantity: Quantity) -> str:
    """Return the unit of a quantity, or "" if it is dimensionless."""
    return "" if quantity.unit == "1" else quantity.unit


def _select_spaced(places: list[float], count: int) -> list[int]:
    """Return the indices of at most `count` of ascending values, at about equal distances."""
    if len(places) <= count:
        return list(range(len(places)))
    first, last = places[0], places[-1]
    aims = (first + k * (last - first) / (count - 1) for k in range(count))
    return sorted({min(range(len(places)), key=lambda n: abs(places[n] - aim)) for aim in aims})
