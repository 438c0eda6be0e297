"""A hash of the settings of a scene."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np


def hash_settings(settings: Mapping[str, Any], without: Sequence[str] = ()) -> str:
    """Return a hash of settings and of the content of their files; `without` do not count."""
    counting = {key: value for key, value in settings.items() if key not in without}
    text = json.dumps(_canonical(counting), sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def _canonical(value: Any) -> Any:
    """Return a value as JSON types, in one form for all equal settings."""
    match value:
        case dict():
            return {
                key: _canonical(item)
                for key, item in value.items()
                if item is not None and not (isinstance(item, list | tuple) and not item)
            }
        case list() | tuple():
            return [_canonical(item) for item in value]
        case np.ndarray():
            return [value.shape, hashlib.sha256(value.tobytes()).hexdigest()]
        case float():
            return value + 0.0  # no negative zero
        case bool() | int():
            return value
    content = getattr(value, "content", None)
    return str(value) if content is None else content.digest
