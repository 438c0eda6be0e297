"""Checks of the parts of a table of creep forces: names for C and XML, axes and arrays."""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from tractive_sam.lookup.coordinates import CONTACT, NAMES, RATIO


def table_faults(
    names: Sequence[str],
    axes: Sequence[Any],
    coefficients: Any,
    bars: Any,
    between: Sequence[Any],
    apart: Sequence[str] = (),
    full_range: bool = False,
    contact: Mapping[str, float] | None = None,
    gradient_bars: Any = None,
) -> Iterator[str]:
    """Yield the faults of the parts of a `CreepTable`, each with its variable.

    Arrays are only checked if names and axes have no faults.
    """
    every = (*names, *NAMES)
    faults = [*_name_faults(names, apart, contact), *_axis_faults(every, axes, full_range)]
    yield from faults
    if faults:
        return
    shape = tuple(map(len, axes))
    yield from _array_faults("coefficients", coefficients, (*shape, 2 ** len(shape), 3))
    yield from _array_faults("error_bar", bars, (*shape, 3), lower=0.0)
    if gradient_bars is not None:
        yield from _array_faults("gradient_bar", gradient_bars, (shape[-1], 3, 3), lower=0.0)
    if len(between) != len(every):
        yield f"between: for {len(between)} axes; allowed: for all {len(every)}"
        return
    for name, errors, count in zip(every, between, shape, strict=True):
        if count > 1 or len(errors):
            yield from _array_faults(f"between_{name}", errors, (count - 1, 3), lower=0.0)


def is_identifier(name: str) -> bool:
    """Return whether C, Python and XML allow a text as a name."""
    return re.fullmatch(r"[A-Za-z]\w*", name, re.ASCII) is not None


def _name_faults(
    names: Sequence[str], apart: Sequence[str], contact: Mapping[str, float] | None
) -> Iterator[str]:
    """Yield the faults of the names of axes and of the contact."""
    for name in names:
        if not is_identifier(name) or (*names, *NAMES).count(name) > 1:
            yield f"axes: the name {name!r}; allowed: letters, digits and _, each name once"
    if (names[:1] == (RATIO,)) != (contact is None) or RATIO in names[1:]:
        yield f"axes: {', '.join(names)}; allowed: {RATIO} first, or a, b, load, mu and shear"
    if not set(apart) <= set(names):
        yield f"apart: {' '.join(apart)}; allowed: some of {' '.join(names)}"
    for name in CONTACT:
        value = 1.0 if contact is None else contact.get(name, math.nan)
        if not (value > 0.0 and math.isfinite(value)):
            yield f"{name}: {value}; allowed: a positive and finite number"


def _axis_faults(every: Sequence[str], axes: Sequence[Any], full_range: bool) -> Iterator[str]:
    """Yield the faults of the nodes of the axes."""
    if len(axes) != len(every):
        yield f"axes: {len(axes)} arrays; allowed: {len(every)}, one of each name"
        return
    quarter = 0.5 * math.pi
    ends = {"heading": (-quarter, quarter), "tilt": (0.0, quarter), "u": (0.0, 1.0)}
    if full_range:
        ends |= {"heading": (-math.pi, math.pi), "tilt": (-quarter, quarter)}
    for name, nodes in zip(every, axes, strict=True):
        if not (_is_numeric(nodes) and nodes.ndim == 1 and nodes.size):
            yield f"{name}: {_describe_array(nodes)}; allowed: a row of numbers"
        elif not (np.isfinite(nodes).all() and (np.diff(nodes) > 0.0).all()):
            yield f"{name}: nodes that are not finite, or do not ascend; allowed: ascending numbers"
        elif name in ends and np.abs(nodes[[0, -1]] - ends[name]).max() > 1e-9:  # rounding
            low, high = ends[name]
            yield f"{name}: from {nodes[0]:g} to {nodes[-1]:g}; allowed: from {low:g} to {high:g}"
        elif name == RATIO and np.abs(nodes).max() > math.log(1e6):
            yield f"{name}: up to {np.abs(nodes).max():g}; allowed: ln(a/b) of a/b from 1e-6 to 1e6"


def _array_faults(
    name: str, values: Any, shape: tuple[int, ...], lower: float = -math.inf
) -> Iterator[str]:
    """Yield the fault of an array that has no numbers, or another shape, or invalid numbers."""
    if not _is_numeric(values) or values.shape != shape:
        yield f"{name}: {_describe_array(values)}; allowed: numbers of the shape {shape}"
    elif not (np.isfinite(values).all() and values.min(initial=0.0) >= lower):
        allowed = "finite numbers" + (f" of at least {lower:g}" if lower > -math.inf else "")
        yield f"{name}: invalid numbers; allowed: {allowed}"


def _is_numeric(values: Any) -> bool:
    """Return whether values are an array of numbers."""
    return isinstance(values, np.ndarray) and values.dtype.kind in "fiu"


def _describe_array(values: Any) -> str:
    """Describe the type and the shape of values."""
    array = np.asarray(values)
    return f"{array.dtype} of the shape {array.shape}"
