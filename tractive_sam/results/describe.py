"""Describe a history: numbers with error bars, balances, caveats and cost."""

import math
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from tractive_sam.description import format_number
from tractive_sam.results.balance import SteadyBalance, balance_of
from tractive_sam.results.history_data import HistoryData
from tractive_sam.results.quantity import BODIES, Quantity
from tractive_sam.scene import conformity_notes, describe_load, edge_notes, pressure_notes


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
    for name, balance, describe in (
        ("energy", [balance.energy for balance in each], _describe_energy),
        ("wear", [balance.wear_overall for balance in worn], _describe_wear),
    ):
        values = np.concatenate(balance)
        values = values[np.isfinite(values)]
        if values.size:
            worst = values[abs(values - 1.0).argmax()]
            closed = abs(worst - 1.0) <= closed_within
            if not (closed and only_if_open):
                texts[name] = describe((worn if name == "wear" else each)[0], worst, closed)
    return texts


def caveats(history: HistoryData) -> dict[str, str]:
    """Return notes on results of a history that may mislead, as text by the row they belong to.

    "utilisation" so close to the surface that it depends on the mesh and has no error bar,
    "stress" that elements may miss, "width" of bodies that the contact fills, "p_max" that no
    material withstands or that is too small for the materials, "angle_range" of a conformal wheel.
    """
    notes = {
        "angle_range": _describe_conformity(history),
        "stress": _describe_missed_stress(history),
        "p_max": _describe_implausible_pressure(history),
        "utilisation": _describe_shallow_utilisation(history),
    }
    half = history["half_width_y"]
    widest = 2.0 * float(half[np.isfinite(half)].max(initial=0.0))
    notes["width"] = "; ".join(edge_notes(history.scene, widest))
    return {name: text for name, text in notes.items() if text}


def _describe_conformity(history: HistoryData) -> str:
    """Describe a large range of the contact angle over a wheel's patch; empty if it is small."""
    columns = [name for name in ("angle_range", "block_angle_range") if name in history.columns]
    largest = [np.nan_to_num(history[name]).max(initial=0.0) for name in columns]
    return "; ".join(conformity_notes(float(max(largest, default=0.0))))


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


def _describe_energy(balance: SteadyBalance, value: float, closed: bool) -> str:
    """Describe the value of an energy balance, with advice unless the balance is closed."""
    text = f"{balance.dissipated} {value:.5f} of the work supplied"
    return text if closed else f"{text}; wear is as much in error{balance.energy_cure}"


def _describe_wear(balance: SteadyBalance, value: float, closed: bool) -> str:
    """Describe the value of a wear balance, with advice unless the balance is closed."""
    text = f"the worn {balance.worn} is {value:.5f} of what the frictional work wears"
    return text if closed else f"{text}; {balance.wear_cure} them together"


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
