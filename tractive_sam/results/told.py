"""Numbers of a history as people write them, and what there is to say of it."""

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from tractive_sam.results.quantities import BODIES, Quantity
from tractive_sam.scene import near_edge, pressure_notes

if TYPE_CHECKING:
    from tractive_sam.results.history import History

DEPTH_OF_STRESS = 0.6
"""Depth of the largest stress over the smaller semi-axis: 0.48 of a circle, 0.79 of a line."""

CLOSED = 5e-3
"""Error of the energy balance that is not reported."""


def number(value: float, error_bar: float = 0.0) -> str:
    """A number with its error bar, in as many digits as that leaves."""
    if math.isinf(error_bar):
        return f"{value:.4g}, without a limit on finer meshes"
    if error_bar > 1e-12 * abs(value):  # less is rounding
        # As many digits as the error bar has, which is told to two.
        decimals = max(0, 1 - math.floor(math.log10(error_bar)))
        if abs(value) >= 1e-3:
            return f"{value:.{decimals}f} ± {error_bar:.{decimals}f}"
        return f"{value:.4g} ± {error_bar:.2g}"
    return f"{value:.0f}" if float(value).is_integer() and abs(value) < 1e9 else f"{value:.4g}"


def numbers(history: "History", row: int) -> Iterator[tuple[str, str, Quantity]]:
    """What a record tells in numbers: name, number with error bar, and quantity."""
    for name, one in history.of_dims().items():
        if not (name.endswith("_error") or np.isnan(history[name]).all()):
            yield name, number(history[name][row], error_bar(history, name, row)), one
    for name, one in history.of_dims("body").items():
        for body in one.bodies(history.scene) if not name.endswith("_error") else ():
            k = BODIES.index(body)
            value, bar = history[name][row, k], error_bar(history, name, row, k)
            yield f"{name} {body}", number(value, bar) if math.isfinite(value) else "none", one


def error_bar(history: "History", name: str, row: int, *body: int) -> float:
    """The error bar of a quantity in a record, zero where it has none."""
    try:
        bars = history[f"{name}_error"]
    except KeyError:
        return 0.0
    last = float(bars[(row, *body)])
    return 0.0 if math.isnan(last) else last


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

    Without those of nothing that is driven, or wears; and of transients, whose steps of parts of an
    element balance to second order only.
    """
    told: dict[str, str] = {}
    if history.scene.transient is not None:
        return told
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


def caveats(history: "History") -> dict[str, str]:
    """Return what to mind, by name.

    "stress" that elements may miss, "width" of bodies that the contact fills, "p_max" that no
    material withstands or that is too little for the materials.
    """
    told = {"stress": _missed_stress(history), "p_max": _implausible_pressure(history)}
    if len(history) and not history.grid.line:
        widest = 2.0 * float(np.nanmax(history["half_width_y"], initial=0.0))
        told["width"] = "; ".join(near_edge(history.scene, widest))
    return {name: text for name, text in told.items() if text}


def _implausible_pressure(history: "History") -> str:
    """Describe the largest pressure of all solved records, where it is implausible."""
    pressure = np.where(history["converged"] > 0.0, history["p_max"], 0.0)
    if not pressure.any():
        return ""
    row = int(pressure.argmax())
    along = history.coordinate
    place = f" at {along.name} {format(history[along.name][row], along.format)}"
    return "; ".join(pressure_notes(history.scene, float(pressure[row]), place))


def _missed_stress(history: "History") -> str:
    """Where elements are so long that the largest stress is not found."""
    grid, hertz = history.grid, history.scene.hertz
    if not history.bodies or hertz is None or history.scene.gap is not None:
        return ""
    depth, side = DEPTH_OF_STRESS * min(hertz.a, hertz.b), max(grid.dx, 0 if grid.line else grid.dy)
    if 2.0 * side <= depth:
        return ""
    return (
        f"the largest one inside lies about {depth:.3g} mm deep and is sought from two elements "
        f"deep on, {2.0 * side:.3g} mm: what is told of it may be too small; shorten the elements"
    )


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
