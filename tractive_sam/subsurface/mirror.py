"""Two bodies under one contact, both seen as half-spaces z >= 0.

Body A is one as it stands. Body B is its mirror image in z: it carries the opposite tangential
traction, and in the axes of the contact its xz and yz have the opposite sign.
"""

from collections.abc import Sequence

import numpy as np

SIGNS = {"A": 1.0, "B": -1.0}
"""Sign of z in each body, and of the tangential traction that acts on it."""


def acting(tractions: np.ndarray, signs: Sequence[float]) -> np.ndarray:
    """Tractions (bodies, 3, ...) on half-spaces of these signs, of (p_x, p_y, p_n) on body A."""
    each = np.array([(sign, sign, 1.0) for sign in signs])
    return tractions * each.reshape(*each.shape, *(1,) * (tractions.ndim - 1))
