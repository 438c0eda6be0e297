"""Numeric entries of a scene by dotted key: their values, and scenes with other ones.

``friction.mu`` of an isotropic law is one number; ``friction.mu[0]`` and ``friction.mu[1]`` are the
numbers of a pair.
"""

import re
from collections.abc import Mapping
from typing import Any

from tractive_sam.scene import Scene
from tractive_sam.schema import Fault, SceneError, shorten, split_key


def base_of(key: str) -> str:
    """Return a dotted key without the index of a pair: "friction.mu" of "friction.mu[0]"."""
    return re.sub(r"\[\d+\]$", "", key)


def value_of(scene: Scene, key: str) -> Any:
    """Return the value of a dotted key in a scene, defaults included; None if it has no value."""
    value: Any = scene.settings()
    for name in split_key(key):
        try:
            value = value[name]
        except (KeyError, IndexError, TypeError):
            return None
    return value


def start_of(scene: Scene, key: str, start: float | None) -> float:
    """Return the first value of a free key: `start`, or that in the scene; SceneError if neither.

    Raises
    ------
    SceneError
        If the scene has no entry of this key, or it is not one number and no start is given.
    """
    Scene.find_field(base_of(key))
    value = value_of(scene, key)
    if isinstance(value, tuple) and len(value) == 2 and value[0] == value[1]:
        value = value[0]
    if isinstance(value, tuple) and len(value) == 2:
        raise SceneError([Fault(key, shorten(value), f"its two numbers: {key}[0], {key}[1]")])
    if key != base_of(key) and value is None:
        raise SceneError([Fault(key, "nothing", f"a scene that gives the pair {base_of(key)}")])
    if value is not None and (isinstance(value, bool) or not isinstance(value, int | float)):
        raise SceneError([Fault(key, shorten(value), "the key of a number")])
    first = value if start is None else start
    if first is None:
        raise SceneError([Fault(key, "nothing", "a value in the scene, or a start")])
    return float(first)


def is_integer(scene: Scene, key: str) -> bool:
    """Return whether the value of a dotted key in a scene is an integer."""
    return type(value_of(scene, key)) is int


def changes_of(scene: Scene, values: Mapping[str, float]) -> dict[str, Any]:
    """Return scene entries that set keys to values: integers rounded, a pair in one entry."""
    changes: dict[str, Any] = {}
    for key, value in values.items():
        base = base_of(key)
        new: Any = round(value) if is_integer(scene, key) else value
        if base != key:
            pair = list(changes.get(base, value_of(scene, base)))
            pair[int(key[len(base) + 1 : -1])] = new
            new = tuple(pair)
        changes[base] = new
    return changes
