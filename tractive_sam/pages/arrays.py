"""Numbers as JSON."""

from base64 import b64encode
from typing import Any

import numpy as np


def pack_array(values: Any) -> dict[str, Any]:
    """Return an array as JSON data: its shape, and its values as float32 in base64, in C order."""
    array = np.ascontiguousarray(values, "<f4")
    return {"shape": array.shape, "base64": b64encode(array.tobytes()).decode()}
