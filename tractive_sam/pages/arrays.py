"""Numbers as JSON."""

from base64 import b64encode
from typing import Any

import numpy as np


def pack_array(values: Any) -> dict[str, Any]:
    """Return an array as JSON: shape, and float32 in base64; the last axis varies fastest."""
    array = np.ascontiguousarray(values, "<f4")
    return {"shape": array.shape, "base64": b64encode(array.tobytes()).decode()}
