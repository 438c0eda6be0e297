"""What the page of a history draws, as JSON: numbers as float32 in base64."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import ceil, sqrt
from typing import Any

import numpy as np

from tractive_sam import interrupt
from tractive_sam.description import format_unit, html_symbol
from tractive_sam.markup import as_html
from tractive_sam.pages.arrays import packed
from tractive_sam.pages.charts import charts
from tractive_sam.plot import (
    ContactView,
    Scale,
    edge_level,
    extend_outwards,
    select_evenly,
    stick_level,
)
from tractive_sam.results import COMPONENTS, Grid, History, PlaneStress, numbers, widened
from tractive_sam.safe_text import printable_text

MOST_SAVED = 40
"""Records whose fields are on the page; of more some are left out."""

MOST_NUMBERS = 9e5
"""Numbers of all fields, and of all stresses: 4.6 MB of text each."""

FEWEST = 24
"""Elements on a side that are shown however many records there are."""

BESIDE, BESIDE_STRESS = 0.15, 1.0
"""Shown around the contact, in its half widths: of the surface, and below it."""

PROFILES = ("wear_profile_A", "wear_profile_B", "wear_profile")


def of_history(history: History) -> dict[str, Any]:
    """All that the page draws, and what is left out of it."""
    saved = select_evenly(history.saved, MOST_SAVED)
    blocks = _blocks(history)
    states = []
    for at in saved:
        interrupt.raise_if_interrupted()
        states += [ContactView.from_source(block, at) for _, block in blocks]
    surface = _Window.around(states, BESIDE, MOST_NUMBERS / (10 * max(len(states), 1)))
    along = history.coordinate
    rows = [int(np.flatnonzero(history[along.name] == at)[-1]) for at in saved]
    each = [row for row in rows for _ in blocks]
    return {
        "line": history.grid.directions == 1,
        "along": {
            "name": as_html(along.label or along.name),
            "symbol": html_symbol(along.symbol) or as_html(along.name),
            "unit": as_html(format_unit(along.unit)),
        },
        "places": [
            as_html(format(at, along.format) + name) for at in saved.tolist() for name, _ in blocks
        ],
        "at": packed(np.repeat(saved, len(blocks))),
        "scale": _scale(history) if len(history) else None,
        "surface": None if surface is None else surface.fields(states),
        "profiles": _profiles(history, each),
        "stress": _stress([block for _, block in blocks], saved, states),
        "numbers": [
            _numbers(block, row)
            for row in (rows or [-1] * bool(len(history)))
            for _, block in blocks
        ],
        "course": packed(history[along.name]),
        "charts": charts(history),
        "leftOut": list(_left_out(history, saved, surface)),
    }


def _left_out(history: History, saved: np.ndarray, surface: "_Window | None") -> Iterator[str]:
    """Notes on what the page does not show, or shows otherwise."""
    if len(saved) < len(history.saved):
        yield f"{len(saved)} of {len(history.saved)} stored records are shown here"
    if surface is not None and surface.every > 1:
        yield f"of the surface every {surface.every}. element is drawn"
    if len(history.block_names) > 1:
        yield (
            "a duty cycle: each place of the slider is one of its blocks; numbers count y from the "
            "middle of the band that it rolls on"
        )


def _blocks(history: History) -> list[tuple[str, History]]:
    """Names and histories of the blocks of a duty cycle; else of the whole, which has no name."""
    blocks = [(f", {name}", history.block(k)) for k, name in enumerate(history.block_names)]
    return blocks or [("", history)]


def _scale(history: History) -> dict[str, Any]:
    scale = Scale.from_history(history)
    known = {"a": scale.a, "b": scale.b, "p": scale.p}
    return {name: value if np.isfinite(value) else None for name, value in known.items()} | {
        "hertz": scale.hertz
    }


@dataclass(frozen=True)
class _Window:
    """The part of the mesh around the contacts of all records, and which of its elements."""

    x: slice
    y: slice
    every: int

    @classmethod
    def around(cls, states: Sequence[ContactView], beside: float, most: float) -> "_Window | None":
        """Window with at most so many elements; None where nothing touches."""
        if not states:
            return None
        touching = np.any([state.contact.touching for state in states], axis=0)
        if not touching.any():
            return None
        sides = [_side(touching.any(axis=axis), beside) for axis in (1, 0)]
        elements = [side.stop - side.start for side in sides]
        every = ceil(sqrt(max(1.0, elements[0] * elements[1] / most)))
        every = max(1, min(every, max(elements) // FEWEST))
        return cls(sides[0], sides[1], every)

    def of(self, values: np.ndarray) -> np.ndarray:
        """Values in the window, shape (..., y, x) of (..., n_x, n_y)."""
        x, y = (slice(side.start, side.stop, self.every) for side in (self.x, self.y))
        return np.swapaxes(values[..., x, y], -1, -2)

    def axes(self, state: ContactView) -> tuple[np.ndarray, np.ndarray]:
        """Centres of the elements, mm."""
        y = _on_bodies({"y": state.y}, "y")
        return state.x[self.x][:: self.every], y[self.y][:: self.every]

    def fields(self, states: Sequence[ContactView]) -> dict[str, Any]:
        """Fields of all records, shape (records, y, x)."""
        x, y = self.axes(states[0])
        rows: dict[str, list[np.ndarray]] = {}
        for state in states:
            for name, values in _surface(state):
                rows.setdefault(name, []).append(self.of(values))
        fields = {name: packed(values) for name, values in rows.items()}
        return {
            "x": packed(x),
            "y": packed(y),
            "fields": fields,
            "bounds": states[0].bound_ratios,
            "isotropic": states[0].isotropic,
            "frictionless": states[0].contact.frame is None,
            "worn": bool(any(state.contact.wear.any() for state in states)),
            "moved": bool(any(state.contact.slip.any() for state in states)),
            "shifts": states[0].contact.scene.schedule.shifts,
        }


def _side(touched: np.ndarray, beside: float) -> slice:
    """From the first to the last that is touched, and some beside, at least two."""
    inside = np.flatnonzero(touched)
    more = max(2, round(0.5 * beside * (inside[-1] - inside[0] + 1)))
    return slice(max(0, inside[0] - more), min(touched.size, inside[-1] + more + 1))


def _surface(state: ContactView) -> Iterator[tuple[str, np.ndarray]]:
    """Fields of a contact by their names on the page."""
    contact = state.contact
    yield "pressure", contact.pressure
    yield "px", contact.traction[0]
    yield "py", contact.traction[1]
    yield "used", contact.utilisation
    # Slip and wear do not vanish at the edge, where maps are cut off: they are to go on there.
    yield "sx", extend_outwards(contact.slip[0], contact.touching)
    yield "sy", extend_outwards(contact.slip[1], contact.touching)
    yield "wear", extend_outwards(1e3 * contact.wear, contact.touching)
    yield "sliding", contact.sliding.astype(float)
    if contact.friction_varies:
        pressure = np.where(contact.touching, contact.pressure, 1.0)
        yield "friction", extend_outwards(contact.utilisation / pressure, contact.touching)
    for body, temperature in (contact.heat.temperature if contact.heat else {}).items():
        yield f"temperature_{body}", temperature
    if contact.grid.directions > 1:
        yield "edge", _of_one(edge_level(contact.pressure))
        yield "stick", _stick(state)


def _stick(state: ContactView) -> np.ndarray:
    """Zero at the boundary between stick and slip; nan where there is none."""
    stick = state.contact.touching & ~state.slip_zone
    if not stick.any() or not state.slip_zone.any():
        return np.full(stick.shape, np.nan)
    return extend_outwards(stick_level(state, stick), state.contact.touching)


def _of_one(values: np.ndarray) -> np.ndarray:
    return values / max(np.abs(values).max(), 1e-300)


def _profiles(history: History, rows: Sequence[int]) -> dict[str, Any] | None:
    """Depth worn off each body across the track, micrometres, shape (records, n_y)."""
    if history.grid.directions == 1 or not rows:
        return None
    found = {name: 1e3 * history[name][rows] for name in PROFILES if name in history.columns}
    known = {name: depth for name, depth in found.items() if np.isfinite(depth).any()}
    worn = np.any([np.nan_to_num(depth).any(axis=0) for depth in known.values()], axis=0)
    if not worn.any():
        return None
    track = _side(worn, BESIDE)
    names = {"wear_profile_A": "A", "wear_profile_B": "B", "wear_profile": "both"}
    lines = {names[name]: packed(depth[:, track]) for name, depth in known.items()}
    return {"y": packed(history.y[track]), "lines": lines}


def _stress(
    blocks: Sequence[History], saved: np.ndarray, states: Sequence[ContactView]
) -> list[dict[str, Any]]:
    """Stress on every stored plane, by component, shape (records, second axis, first axis).

    Blocks have their own depths, and each place its axes: shape (records, axis).
    """
    history = blocks[0]
    count = len(history.planes) * len(states) * (1 + len(COMPONENTS))
    found = []
    asked = [] if history.scene.subsurface is None else map(str, history.scene.subsurface.planes)
    order = {plane: k for k, plane in enumerate(asked)}
    for body, plane in sorted(history.planes, key=lambda one: order.get(one[1], len(order))):
        interrupt.raise_if_interrupted()
        each = (block.stress(body, plane, at) for at in saved for block in blocks)
        rows = [_on_mesh(one, history.grid) for one in each]
        (first, along), (second, across) = rows[0].axes.items()
        if min(along.size, across.size) < 2:
            continue  # of a line contact, a plane across is only a line
        sides = [
            _side_of(name, states, size)
            for name, size in ((first, along.size), (second, across.size))
        ]
        size = np.prod([side.stop - side.start for side in sides])
        every = max(1, min(ceil(sqrt(size * count / MOST_NUMBERS)), along.size // FEWEST))
        part = tuple(slice(side.start, side.stop, every) for side in sides)
        named = {"von Mises": [row.von_mises[part].T for row in rows]}
        for name in COMPONENTS:
            named[name] = [row.components[name][part].T for row in rows]
        found.append(
            {
                "body": body,
                "plane": plane,
                "axes": [first, second],
                "first": packed([_on_bodies(row.axes, first)[part[0]] for row in rows]),
                "second": packed([_on_bodies(row.axes, second)[part[1]] for row in rows]),
                "components": {name: packed(values) for name, values in named.items()},
            }
        )
    return found


def _on_mesh(stress: PlaneStress, grid: Grid) -> PlaneStress:
    """Stress that was stored on a narrower mesh, on the last one; it is not known beside."""
    sizes = {"x": grid.x.size, "y": grid.y.size}
    shape = tuple(sizes.get(name, places.size) for name, places in stress.axes.items())
    if shape == stress.components[COMPONENTS[0]].shape:
        return stress
    axes = dict(stress.axes)
    for (name, places), size in zip(stress.axes.items(), shape, strict=True):
        if size > places.size:
            steps = np.arange(size) - (size - places.size) // 2
            axes[name] = places[0] + (places[1] - places[0]) * steps
    wide = {name: widened(one, shape, np.nan) for name, one in stress.components.items()}
    return replace(stress, axes=axes, components=wide)


def _on_bodies(axes: Mapping[str, np.ndarray], name: str) -> np.ndarray:
    """Places along an axis; y from the middle of the mesh: a band of a duty cycle lies aside."""
    places = axes[name]
    return places - 0.5 * (places[0] + places[-1]) if name == "y" else places


def _side_of(name: str, states: Sequence[ContactView], size: int) -> slice:
    if name == "depth":
        return slice(0, size)
    touching = np.any([state.contact.touching for state in states], axis=0)
    touched = touching.any(axis=1 if name == "x" else 0)
    return _side(touched, BESIDE_STRESS) if touched.any() else slice(0, size)


def _numbers(history: History, row: int) -> list[Mapping[str, str]]:
    """The numbers of a record, one a line of a table."""
    return [
        {
            "name": printable_text(name),
            "value": printable_text(value),
            "unit": printable_text(format_unit(one.unit)),
            "about": printable_text(one.long_name),
        }
        for name, value, one in numbers(history, row)
    ]
