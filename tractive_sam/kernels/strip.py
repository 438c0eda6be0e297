"""Point kernels of the half-plane surface integrated over a strip that is infinitely long in y.

The strip is centred at the origin with the width ``dx``; ``x`` is observer minus centre. Integrated
over y, the kernels of :mod:`tractive_sam.kernels.rectangle` become

========  ====================  ==========
from      integrand             in x
========  ====================  ==========
1/r       -2 ln(abs(x)/d)       even
y²/r³     -2 ln(abs(x)/d)       even
x/r²      pi sign(x)            odd
========  ====================  ==========

and x²/r³, x y/r³ and y/r² contribute nothing. An infinitely long load moves the half-plane
infinitely far, so that only displacements relative to some other point have a meaning: here the
mean of the points of the surface at the distance d from each load.

Source: Johnson, Contact Mechanics (1985), sections 2.2, 2.3 and 2.5, which take derivatives in x
instead of a datum.
"""

import numpy as np


def integrate_logarithm(x: np.ndarray, dx: float, datum: float) -> np.ndarray:
    """Return the integral of -2 ln(|x|/datum) over a strip, at distances x of its centre, mm.

    With h = dx/2 it is 4 h - 2 (x + h) ln(|x + h|/d) + 2 (x - h) ln(|x - h|/d); the terms that
    cancel far from the strip are taken together.

    Parameters
    ----------
    x : ndarray
        Observer minus centre of the strip, mm.
    dx : float
        Width of the strip, mm.
    datum : float
        Distance d at which the displacement by a load is taken to be zero, mm.
    """
    h, x = 0.5 * dx, np.abs(x)
    apart = np.abs(x - h)  # and x + h - apart is 2 x or dx, whichever is less
    # On an edge of the strip, apart = 0, the product with the infinite logarithm is zero.
    inner = np.where(apart > 0.0, apart, 1.0)
    outward = 2.0 * (x - h) * np.log1p(np.minimum(2.0 * x, dx) / inner)
    return 2.0 * dx - outward - 2.0 * dx * np.log((x + h) / datum)


def integrate_sign(x: np.ndarray, dx: float) -> np.ndarray:
    """Return the integral of pi sign(x) over a strip, at distances x of its centre, mm."""
    return np.pi * np.clip(2.0 * x, -dx, dx)
