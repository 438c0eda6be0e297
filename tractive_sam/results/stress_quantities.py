"""The columns of error bars, and of the largest stress in each body."""

import math
from dataclasses import replace
from functools import partial

from tractive_sam.mechanics import StressCriterion
from tractive_sam.results.quantity import BODIES, Quantity
from tractive_sam.results.state import State


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
