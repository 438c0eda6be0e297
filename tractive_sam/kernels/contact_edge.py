"""Place of the edge of a contact beyond the centre of an element (`results.state`), with NumPy."""

import numpy as np


def edge_place(here, before):
    """Return the distances of the contact edge beyond the centres of outermost elements, elements.

    A cubic in the ratio of both pressures; peaks at a rim are cut where the next element touches.

    Parameters
    ----------
    here : float or ndarray
        Pressures of outermost elements, positive.
    before : float or ndarray
        Pressures of their neighbours in the contact; 0 if there is none.
    """
    # Place of the edge of an element without neighbours in contact: half its width.
    single = 0.5
    # Largest place of an edge: there, the next element comes into contact.
    last = 0.8246
    r = here / np.maximum(before, here)
    place = -0.1754 + r * (1.0173 + r * (0.3268 + r * 0.3638))
    return np.minimum(place, last + (single - last) * (before <= 0.0))
