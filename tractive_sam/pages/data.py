"""The data of the page of a history, as JSON: numbers as float32 in base64, and charts."""

from base64 import b64encode
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from math import ceil, sqrt
from typing import Any

import numpy as np

from tractive_sam import interrupt
from tractive_sam.description import format_unit, html_symbol
from tractive_sam.plot import (
    ContactView,
    Measurements,
    Scale,
    edge_level,
    extend_outwards,
    select_evenly,
    stick_level,
)
from tractive_sam.results import (
    BODIES,
    COMPONENTS,
    COORDINATE,
    LABELS,
    PREFIX,
    Grid,
    History,
    PlaneStress,
    Quantity,
    format_values,
    widen_field,
)
from tractive_sam.safe_text import Html, as_html, fill, printable_text


def pack_array(values: Any) -> dict[str, Any]:
    """Return an array as JSON data: its shape, and its values as float32 in base64, in C order."""
    array = np.ascontiguousarray(values, "<f4")
    return {"shape": array.shape, "base64": b64encode(array.tobytes()).decode()}


HIDDEN = {"stress_max", "stress_max_at", "stress_max_error", COORDINATE}
"""Roles that have no chart."""


def charts(history: History, measured: Measurements | None = None) -> list[dict[str, Any]]:
    """Return charts of a history's columns that change or were measured, as JSON data.

    Columns that neither change nor were measured are omitted: the table of numbers contains them.
    For a duty cycle a chart has the columns of the cycle and of its blocks.
    """
    # Titles, and names or roles of columns in one chart. Every other column has a separate chart.
    together = (
        ("Forces over the normal load", ("Qx_over_P", "Qy_over_P")),
        ("Contact pressure", ("p_max", "p_95")),
        ("Half widths of the contact", ("half_width_x", "half_width_y")),
        ("Largest wear depth", ("wear_max",)),
        ("Worn mass", ("worn_mass",)),
        ("Worn volume", ("worn_volume",)),
        ("Largest stress", ("stress_interior", "stress_surface")),
        ("Creepages found", ("creepage_found",)),
        ("Tangential forces", ("Qx", "Qy")),
        ("Work per distance rolled", ("work_supplied", "dissipation", "t_gamma")),
    )
    if len(history) < 2 and measured is None:
        return []
    free = {
        name: column
        for name, column in history.columns.items()
        if _of_cycle(history, column).role not in HIDDEN and not column.error_of
        if not (column.is_profile or "position" in column.dims)
    }
    groups: list[tuple[str, dict[str, Quantity]]] = []
    for name in [name for name in free if PREFIX + name in free]:
        pair = {key: free.pop(key) for key in (name, PREFIX + name)}
        groups.append((chart_title(pair[name]), pair))
    for title, keys in together:
        names = [name for name, column in free.items() if name in keys or column.role in keys]
        groups.append((title, {name: free.pop(name) for name in names}))
    groups += [(chart_title(column), {name: column}) for name, column in free.items()]
    listed = [_chart(history, title, list(group.values()), measured) for title, group in groups]
    return sorted((chart for chart in listed if chart["lines"]), key=lambda chart: chart["aside"])


def _noise(history: History, name: str, share: float = 1e-6) -> float:
    """Return the change of a force or moment that solver errors may cause; 0 of other columns."""
    load = share * float(np.nanmax(history["P"]))
    arm = float(np.nanmax(history["half_width_x"]))
    ratios = {"Qx_over_P": share, "Qy_over_P": share}
    return ({"Qx": load, "Qy": load, "Mz": load * arm} | ratios).get(name.removeprefix(PREFIX), 0.0)


def _of_cycle(history: History, column: Quantity) -> Quantity:
    """Return the cycle's column for a block column (name with a prefix), or the column itself."""
    return history.columns.get(column.name.removeprefix(PREFIX), column)


def jumps(position: np.ndarray, travel: float = 3.0) -> bool:
    """Return whether a position alternates: its path exceeds `travel` times its range.

    Parameters
    ----------
    position : ndarray, shape (n,)
        Positions along the course, finite.
    travel : float
        Path over range from which it alternates; the ratio is 1 for a monotonic motion, and 2 if
        it returns.
    """
    return bool(np.abs(np.diff(position)).sum() > travel * np.ptp(position))


def chart_title(quantity: Quantity) -> str:
    """Return the long name of a quantity up to a semicolon, with a capital: its chart's title."""
    name = quantity.long_name.partition(";")[0]
    return name[:1].upper() + name[1:]


def _chart(
    history: History, title: str, group: list[Quantity], measured: Measurements | None
) -> dict[str, Any]:
    """Return one chart as JSON data: title, label of the axis, lines, and whether it comes last."""
    # Columns of the solver; their charts are the last ones.
    solver = {
        "residual", "operator_applications", "convolutions", "over_application", "jump",
        "converged", "solves", "seconds",
    }  # fmt: skip
    units = [format_unit(column.unit) for column in group]
    label = as_html(", ".join(dict.fromkeys(filter(None, units))))
    names = {_of_cycle(history, column).name for column in group}
    if len(names) == 1 and (symbol := html_symbol(group[0].symbol)):
        label = fill("$symbol ($label)", symbol=symbol, label=label) if label else symbol
    return {
        "title": as_html(title),
        "label": label,
        "lines": [
            line for column in group for line in _lines(history, column, len(group), measured)
        ],
        "aside": names <= solver and bool(group),
    }


def _lines(
    history: History, quantity: Quantity, several: int, measured: Measurements | None
) -> Iterator[dict[str, Any]]:
    """Yield the lines of a column in a chart, one a body and axis; constant columns have none."""
    values, noise = history[quantity.name], _noise(history, quantity.name)
    labels = {**LABELS, "block": history.block_names}
    for place in product(*(labels[dim] for dim in quantity.dims)):
        place_of = zip(quantity.dims, place, strict=True)
        at: Any = (..., *(labels[dim].index(k) for dim, k in place_of))
        line = values[at].astype(float)
        finite = line[np.isfinite(line)]
        column = " ".join((quantity.name, *place))
        compared = measured is not None and column in measured.columns
        constant = finite.size < 2 or np.ptp(finite) <= max(noise, 1e-9 * np.abs(finite).max())
        if constant and not compared:
            continue
        if quantity.place_of and jumps(finite):
            continue
        name = html_symbol(quantity.symbol) or as_html(quantity.name)
        kind = quantity.role.removeprefix("stress_") if quantity.role.startswith("stress_") else ""
        named = [as_html(f"body {k}" if k in BODIES else k) for k in place]
        if PREFIX + quantity.name in history.columns:
            named = [Html("cycle"), *named]
        elif kind:
            named.append(as_html(kind))
        elif "block" not in quantity.dims and (several > 1 or not place):
            named = [name, *named]
        chart_line = {"name": Html(", ".join(named)), "values": pack_array(line)}
        bars = history.values.get(f"{quantity.name}_error")
        if bars is not None and np.isfinite(bars[at]).any():
            chart_line["bars"] = pack_array(bars[at])
        if measured is not None and compared:
            places, points, text = measured.compare(history, column)
            packed = {"x": pack_array(places), "y": pack_array(points)}
            chart_line["measured"] = packed | {"name": as_html(text)}
        yield chart_line


@dataclass(frozen=True)
class PageLimits:
    """Limits on how much of a history its HTML page contains.

    Attributes
    ----------
    records : int
        Largest number of records with fields on the page; of more some are omitted.
    numbers : float
        Largest count of numbers of all fields, and of all stresses: 4.6 MB of text each.
    elements : int
        Smallest number of elements on a side that are shown, for any number of records.
    margin, stress_margin : float
        Margins around the contact, in its half widths: of the surface, and below it.
    """

    records: int = 40
    numbers: float = 9e5
    elements: int = 24
    margin: float = 0.15
    stress_margin: float = 1.0


def page_data(
    history: History, limits: PageLimits | None = None, measured: Measurements | None = None
) -> dict[str, Any]:
    """Return all data of the HTML page of a history as JSON data, with notes on omitted data."""
    limits, blocks = limits or PageLimits(), _blocks(history)
    saved = select_evenly(history.saved, limits.records)
    states = []
    for at in saved:
        interrupt.raise_if_interrupted()
        states += [ContactView.from_source(block, at) for _, block in blocks]
    surface = _Window.from_states(states, limits)
    along = history.coordinate
    rows = [int(np.flatnonzero(history[along.name] == at)[-1]) for at in saved]
    each = [row for row in rows for _ in blocks]
    return {
        "line": history.grid.directions == 1,
        "along": {
            "name": as_html(along.label or along.name),
            "symbol": html_symbol(along.symbol) or as_html(along.name),
            "unit": as_html(format_unit(along.unit)),
            "sequence": history.scene.schedule.in_sequence,
        },
        "places": [
            as_html(format(at, along.format) + name) for at in saved.tolist() for name, _ in blocks
        ],
        "at": pack_array(np.repeat(saved, len(blocks))),
        "scale": _scale(history) if len(history) else None,
        "surface": None if surface is None else surface.fields(states),
        "profiles": _profiles(history, each, limits),
        "stress": _stress([block for _, block in blocks], saved, states, limits),
        "numbers": [
            _numbers(block, row)
            for row in (rows or [-1] * bool(len(history)))
            for _, block in blocks
        ],
        "course": pack_array(history[along.name]),
        "charts": charts(history, measured),
        "leftOut": list(_omissions(history, saved, surface)),
    }


def _omissions(history: History, saved: np.ndarray, surface: "_Window | None") -> Iterator[str]:
    """Yield notes on data that the page omits or shows in another form."""
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
    """Return (name, history) of each block of a duty cycle; ("", history) for other histories."""
    blocks = [(f", {name}", history.block(k)) for k, name in enumerate(history.block_names)]
    return blocks or [("", history)]


def _scale(history: History) -> dict[str, Any]:
    """Return the scales of figures {a, b, p}, None if not finite, and whether Hertz's, `hertz`."""
    scale = Scale.from_history(history)
    values = {"a": scale.a, "b": scale.b, "p": scale.p}
    return {name: value if np.isfinite(value) else None for name, value in values.items()} | {
        "hertz": scale.hertz
    }


@dataclass(frozen=True)
class _Window:
    """Rectangle of the mesh around the contacts of all records, shown at every n-th element."""

    x: slice
    y: slice
    every: int

    @classmethod
    def from_states(cls, states: Sequence[ContactView], limits: PageLimits) -> "_Window | None":
        """Return the window around the contacts of all records, thinned to the limits, or None."""
        if not states:
            return None
        touching = np.any([state.contact.touching for state in states], axis=0)
        if not touching.any():
            return None
        sides = [_side(touching.any(axis=axis), limits.margin) for axis in (1, 0)]
        elements = [side.stop - side.start for side in sides]
        numbers = 10 * len(states) * elements[0] * elements[1]
        every = ceil(sqrt(max(1.0, numbers / limits.numbers)))
        every = max(1, min(every, max(elements) // limits.elements))
        return cls(sides[0], sides[1], every)

    def select(self, values: np.ndarray) -> np.ndarray:
        """Return values in the window, shape (..., y, x) from (..., n_x, n_y)."""
        x, y = (slice(side.start, side.stop, self.every) for side in (self.x, self.y))
        return np.swapaxes(values[..., x, y], -1, -2)

    def axes(self, state: ContactView) -> tuple[np.ndarray, np.ndarray]:
        """Return (x, y) of the drawn (every n-th) elements, mm; y from the middle of the mesh."""
        y = _on_bodies({"y": state.y}, "y")
        return state.x[self.x][:: self.every], y[self.y][:: self.every]

    def fields(self, states: Sequence[ContactView]) -> dict[str, Any]:
        """Return drawn surface fields of all records (records, y, x), axes, flags as JSON data."""
        x, y = self.axes(states[0])
        rows: dict[str, list[np.ndarray]] = {}
        for state in states:
            for name, values in _surface(state):
                rows.setdefault(name, []).append(self.select(values))
        fields = {name: pack_array(values) for name, values in rows.items()}
        schedule = states[0].contact.scene.schedule
        mixed = len({schedule.shifts_at(state.at) for state in states}) > 1
        return {
            "x": pack_array(x),
            "y": pack_array(y),
            "fields": fields,
            "bounds": states[0].bound_ratios,
            "isotropic": states[0].isotropic,
            "frictionless": states[0].contact.frame is None,
            "worn": bool(any(state.contact.wear.any() for state in states)),
            # The slip of rolling and of shifts differ in unit, and share no map.
            "moved": bool(any(state.contact.slip.any() for state in states)) and not mixed,
            "shifts": schedule.shifts,
        }


def _side(touched: np.ndarray, margin: float) -> slice:
    """Return the slice around touched elements: half of `margin` times its length on each side."""
    inside = np.flatnonzero(touched)
    more = max(2, round(0.5 * margin * (inside[-1] - inside[0] + 1)))
    return slice(max(0, inside[0] - more), min(touched.size, inside[-1] + more + 1))


def _surface(state: ContactView) -> Iterator[tuple[str, np.ndarray]]:
    """Yield (name on the page, values) of surface fields; slip and wear extended outwards."""
    contact = state.contact
    yield "pressure", contact.pressure
    yield "px", contact.traction[0]
    yield "py", contact.traction[1]
    yield "used", contact.utilisation
    # Slip and wear do not vanish at the edge, and maps are clipped there: they are extended.
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
        level = edge_level(contact.pressure)
        yield "edge", level / max(np.abs(level).max(), 1e-300)
        yield "stick", _stick(state)


def _stick(state: ContactView) -> np.ndarray:
    """Return a level field, zero at the boundary of stick and slip; nan if there is no boundary."""
    stick = state.contact.touching & ~state.slip_zone
    if not stick.any() or not state.slip_zone.any():
        return np.full(stick.shape, np.nan)
    return extend_outwards(stick_level(state, stick), state.contact.touching)


def _profiles(history: History, rows: Sequence[int], limits: PageLimits) -> dict[str, Any] | None:
    """Return wear depths over y of each body or both, micrometres; None if unworn or a line."""
    if history.grid.directions == 1 or not rows:
        return None
    names = {"wear_profile_A": "A", "wear_profile_B": "B", "wear_profile": "both"}
    depths = {name: 1e3 * history[name][rows] for name in names if name in history.columns}
    worn_profiles = {name: depth for name, depth in depths.items() if np.isfinite(depth).any()}
    worn = np.any([np.nan_to_num(depth).any(axis=0) for depth in worn_profiles.values()], axis=0)
    if not worn.any():
        return None
    track = _side(worn, limits.margin)
    lines = {names[name]: pack_array(depth[:, track]) for name, depth in worn_profiles.items()}
    return {"y": pack_array(history.y[track]), "lines": lines}


def _stress(
    blocks: Sequence[History], saved: np.ndarray, states: Sequence[ContactView], limits: PageLimits
) -> list[dict[str, Any]]:
    """Return stress maps of all records for each stored plane, except mere lines, as JSON data.

    The depths of blocks differ, so the axes have the shape (records, axis).
    """
    history = blocks[0]
    count = len(history.planes) * len(states) * (1 + len(COMPONENTS))
    maps = []
    planes = [] if history.scene.subsurface is None else map(str, history.scene.subsurface.planes)
    order = {plane: k for k, plane in enumerate(planes)}
    for body, plane in sorted(history.planes, key=lambda pair: order.get(pair[1], len(order))):
        interrupt.raise_if_interrupted()
        each = (block.stress(body, plane, at) for at in saved for block in blocks)
        rows = [_widen_to_grid(stress, history.grid) for stress in each]
        (first, along), (second, across) = rows[0].axes.items()
        if min(along.size, across.size) < 2:
            continue  # a plane across a line contact is only a line
        sides = [
            _visible_range(name, states, size, limits.stress_margin)
            for name, size in ((first, along.size), (second, across.size))
        ]
        size = np.prod([side.stop - side.start for side in sides])
        every = ceil(sqrt(size * count / limits.numbers))
        every = max(1, min(every, along.size // limits.elements))
        part = tuple(slice(side.start, side.stop, every) for side in sides)
        named = {"von Mises": [row.von_mises[part].T for row in rows]}
        for name in COMPONENTS:
            named[name] = [row.components[name][part].T for row in rows]
        maps.append(
            {
                "body": body,
                "plane": plane,
                "axes": [first, second],
                "first": pack_array([_on_bodies(row.axes, first)[part[0]] for row in rows]),
                "second": pack_array([_on_bodies(row.axes, second)[part[1]] for row in rows]),
                "components": {name: pack_array(values) for name, values in named.items()},
            }
        )
    return maps


def _widen_to_grid(stress: PlaneStress, grid: Grid) -> PlaneStress:
    """Extend stress that was stored on an earlier, narrower mesh to the last mesh, with nan."""
    sizes = {"x": grid.x.size, "y": grid.y.size}
    shape = tuple(sizes.get(name, places.size) for name, places in stress.axes.items())
    if shape == stress.components[COMPONENTS[0]].shape:
        return stress
    axes = dict(stress.axes)
    for (name, places), size in zip(stress.axes.items(), shape, strict=True):
        if size > places.size:
            steps = np.arange(size) - (size - places.size) // 2
            axes[name] = places[0] + (places[1] - places[0]) * steps
    wide = {name: widen_field(field, shape, np.nan) for name, field in stress.components.items()}
    return replace(stress, axes=axes, components=wide)


def _on_bodies(axes: Mapping[str, np.ndarray], name: str) -> np.ndarray:
    """Return coordinates along an axis of a plane; y is taken from the middle of the mesh."""
    places = axes[name]
    return places - 0.5 * (places[0] + places[-1]) if name == "y" else places


def _visible_range(name: str, states: Sequence[ContactView], size: int, margin: float) -> slice:
    """Return the slice shown of a stress plane's axis: x, y around the contact, all of others."""
    if name not in ("x", "y"):
        return slice(0, size)
    touching = np.any([state.contact.touching for state in states], axis=0)
    touched = touching.any(axis=1 if name == "x" else 0)
    return _side(touched, margin) if touched.any() else slice(0, size)


def _numbers(history: History, row: int) -> list[Mapping[str, str]]:
    """Return the values of a record as rows of a table: name, value, unit and meaning."""
    return [
        {
            "name": printable_text(name),
            "value": printable_text(value),
            "unit": printable_text(format_unit(quantity.unit)),
            "about": printable_text(quantity.long_name),
        }
        for name, value, quantity in format_values(history, row)
    ]
