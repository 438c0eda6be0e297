"""Results as tables for people."""

import math
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from rich import box
from rich.table import Table

from tractive_sam.results import BODIES
from tractive_sam.scene import told

if TYPE_CHECKING:
    from tractive_sam.results import History

COURSE = (
    ("Qx_over_P", "Qx/P", 1, ".4f"),
    ("Qy_over_P", "Qy/P", 1, ".4f"),
    ("p_max", "p_max\nMPa", 1, ".4g"),
    ("half_width_x", "half x\nmm", 1, ".4g"),
    ("half_width_y", "half y\nmm", 1, ".4g"),
    ("wear_max", "wear\nµm", 1e3, ".4g"),
    ("stick_fraction", "stick\n%", 100, ".1f"),
    ("residual", "residual", 1, ".0e"),
)
"""What is told of every record, after the coordinate: name, heading, factor and format."""

FOUND = (("xi_x", "xi_x", 1, ".3e"), ("xi_y", "xi_y", 1, ".3e"))
"""The same of creepages, where forces are prescribed."""

MOST_ROWS = 20

CLOSED = 5e-3
"""Error of the energy balance that is not reported."""


def about(history: "History") -> Table:
    """What was computed, and how it ended."""
    table = Table.grid(padding=(0, 2))
    rows = {"scene": history.title, "status": history.status, "message": history.message}
    if math.isfinite(history.p0):
        unworn = f"a0 = {history.a0:.5g} mm, b0 = {history.b0:.5g} mm, p0 = {history.p0:.6g} MPa"
        rows["unworn contact"] = unworn
    rows["records"] = f"{len(history)}, {len(history.saved)} with fields"
    rows |= told.told(history.scene)
    if others := rolled_on_by(history):
        rows["rolled on by"] = others
    rows |= balances(history)
    totals = history.totals
    if totals["contact_solves"]:
        spent = f"{totals['contact_solves']} contacts solved in {totals['wall_seconds']:.3g} s"
        rows["cost"] = spent
    for name, value in rows.items():
        table.add_row(name, value)
    return table


def asked(history: "History") -> Table:
    """The load and the wear that were asked for, in the units that people have."""
    table = Table.grid(padding=(0, 2))
    for name, value in told.told(history.scene).items():
        table.add_row(name, value)
    return table


def rolled_on_by(history: "History") -> str:
    """Programs of other versions that a history was rolled on by, and from where; mostly none."""
    found = []
    for (_, before), (record, now) in pairwise(history.provenance):
        others = ", ".join(f"{name} {now[name]}" for name in now if now[name] != before.get(name))
        along = history.coordinate.name
        found += [f"{others} from {along} {at} on" for at in history[along][record : record + 1]]
    return "; ".join(found)


def balances(history: "History", only_if_open: bool = False) -> dict[str, str]:
    """How the balances of "energy" and "wear" are met where they are met worst.

    Without those of nothing that is driven, or wears.
    """
    told = {}
    for name, balance, tell in (
        ("energy", history.energy_balance, _energy),
        ("wear", history.wear_balance, _wear),
    ):
        known = balance[np.isfinite(balance)]
        if known.size:
            worst = known[abs(known - 1.0).argmax()]
            closed = abs(worst - 1.0) <= CLOSED
            if not (closed and only_if_open):
                told[name] = tell(history, worst, closed)
    return told


def _energy(history: "History", balance: float, closed: bool) -> str:
    told = f"friction dissipates {balance:.5f} of the work supplied"
    if not closed:
        told += "; wear is as much in error"
        if history.scene.solver.slip == "upwind":
            told += ': the upwind slip of the paper does that, solver.slip = "auto" does not'
    return told


def _wear(history: "History", balance: float, closed: bool) -> str:
    told = f"the worn section is {balance:.5f} of what the frictional work wears"
    if not closed:
        told += "; more elements across the contact bring them together"
    return told


def last_record(history: "History") -> Table:
    """The last record, one quantity a row."""
    table = Table(box=box.SIMPLE_HEAD, show_header=False)
    table.add_column(style="bold")
    table.add_column(justify="right")
    table.add_column()
    table.add_column(style="dim")
    for name, one in history.of_dims().items():
        if not name.endswith("_error"):
            unit = "" if one.unit == "1" else one.unit
            value, error_bar = history[name][-1], _error_bar(history, name)
            table.add_row(name, _number(value, error_bar), unit, one.long_name)
    for name, one in history.of_dims("body").items():
        for body in one.bodies(history.scene) if not name.endswith("_error") else ():
            k = BODIES.index(body)
            value, error_bar = history[name][-1, k], _error_bar(history, name, k)
            told = _number(value, error_bar) if math.isfinite(value) else "none"
            table.add_row(f"{name} {body}", told, one.unit, one.long_name)
    return table


def _error_bar(history: "History", name: str, *body: int) -> float:
    """The last error bar of a quantity, zero where it has none."""
    try:
        bars = history[f"{name}_error"]
    except KeyError:
        return 0.0
    last = float(bars[(-1, *body)])
    return 0.0 if math.isnan(last) else last


def records(history: "History") -> Table:
    """Some records from the first to the last, one a row."""
    count = len(history)
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    along = history.coordinate
    heading = along.symbol + ("" if along.unit == "1" else f"\n{along.unit}")
    found = FOUND if "creepage_found" in history.columns else ()
    course = ((along.name, heading, 1, along.format), *COURSE[:2], *found, *COURSE[2:])
    for _, heading, _, _ in course:
        table.add_column(heading, justify="right", no_wrap=True)
    shown = sorted({round(k * (count - 1) / (MOST_ROWS - 1)) for k in range(MOST_ROWS)})
    for row in shown:
        table.add_row(*(format(history[name][row] * f, form) for name, _, f, form in course))
    if len(shown) < count:
        table.caption = f"{len(shown)} of {count} records; show --json tells all"
    return table


def _number(value: float, error_bar: float = 0.0) -> str:
    if math.isinf(error_bar):
        return f"{value:.4g}, growing with the mesh"
    if error_bar > 0.0:
        # As many digits as the error bar has, which is told to two.
        decimals = max(0, 1 - math.floor(math.log10(error_bar)))
        if abs(value) >= 1e-3:
            return f"{value:.{decimals}f} ± {error_bar:.{decimals}f}"
        return f"{value:.4g} ± {error_bar:.2g}"
    return f"{value:.0f}" if float(value).is_integer() and abs(value) < 1e9 else f"{value:.4g}"
