"""Products of spectra: the only work of a convolution between its two transforms.

One pass over memory each; numpy would take one for every term.
"""

from tractive_sam.kernels.compiled import compiled


@compiled
def scale(s, h):
    """``h[0] <- s[0] h[0]``: one component, in place. ``s``: (1, m), ``h``: (1, m) complex."""
    for k in range(h.shape[1]):
        h[0, k] = s[0, k] * h[0, k]


@compiled
def symmetric_2x2(s, h):
    """``h <- S h`` in place, S symmetric 2 x 2 with entries (11, 12, 22) in ``s``: (3, m)."""
    for k in range(h.shape[1]):
        a, b = h[0, k], h[1, k]
        h[0, k] = s[0, k] * a + s[1, k] * b
        h[1, k] = s[1, k] * a + s[2, k] * b


@compiled
def full_3x3(s, h):
    """``h <- S h`` in place, S a full 3 x 3 matrix stored row by row in ``s``: (9, m)."""
    for k in range(h.shape[1]):
        a, b, c = h[0, k], h[1, k], h[2, k]
        h[0, k] = s[0, k] * a + s[1, k] * b + s[2, k] * c
        h[1, k] = s[3, k] * a + s[4, k] * b + s[5, k] * c
        h[2, k] = s[6, k] * a + s[7, k] * b + s[8, k] * c
