"""Both bodies of a contact as half-spaces z >= 0.

Body A needs no transformation. Body B is mirrored in z: it has the opposite tangential traction,
and in the axes of the contact its xz and yz have the opposite sign.
"""

from collections.abc import Sequence

import numpy as np

SIGNS = {"A": 1.0, "B": -1.0}
"""Sign of z in each body, and of the tangential traction that acts on it."""


def tractions_on_bodies(tractions: np.ndarray, signs: Sequence[float]) -> np.ndarray:
    """Return the tractions (bodies, 3, ...) on each body's half-space, from those on body A."""
    each = np.array([(sign, sign, 1.0) for sign in signs])
    return tractions * each.reshape(*each.shape, *(1,) * (tractions.ndim - 1))
