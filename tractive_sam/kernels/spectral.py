"""Products of spectra: the only work of a convolution between its two transforms.

One pass over memory each; numpy would take one for every term.
"""

import numpy as np

from tractive_sam.kernels.compiled import ANY_ORDER, compiled


def scalar(s, h):
    """Multiply a spectrum in place by a scalar spectrum: h[0] = s[0] h[0], (1, m) complex."""
    np.multiply(s, h, out=h)


@compiled
def symmetric_2x2(s, h):
    """Multiply two spectra (2, m) in place by a symmetric matrix with entries s: 11, 12, 22."""
    for k in range(h.shape[1]):
        a, b = h[0, k], h[1, k]
        h[0, k] = s[0, k] * a + s[1, k] * b
        h[1, k] = s[1, k] * a + s[2, k] * b


@compiled
def full_3x3(s, h):
    """Multiply three spectra (3, m) in place by a 3 x 3 matrix stored row by row in `s`, (9, m)."""
    for k in range(h.shape[1]):
        a, b, c = h[0, k], h[1, k], h[2, k]
        h[0, k] = s[0, k] * a + s[1, k] * b + s[2, k] * c
        h[1, k] = s[3, k] * a + s[4, k] * b + s[5, k] * c
        h[2, k] = s[6, k] * a + s[7, k] * b + s[8, k] * c


@compiled(fastmath=ANY_ORDER)
def row_products(out, rows, kernel, places):
    """Set `out` (m, m) to the work of each row on each other row, by Parseval's theorem.

    Parameters
    ----------
    out : ndarray, shape (m, m)
        Set, symmetric.
    rows : ndarray of complex, shape (m, n)
        Spectra of the rows.
    kernel : ndarray, shape (k, n)
        Spectra by the distance of two rows, weighed.
    places : ndarray of int, shape (m,)
        Positions of the rows, ascending.
    """
    for i in range(rows.shape[0]):
        for j in range(i, rows.shape[0]):
            a, b, c = rows[i], rows[j], kernel[places[j] - places[i]]
            total = 0.0
            for k in range(a.shape[0]):
                total += c[k] * (a[k].real * b[k].real + a[k].imag * b[k].imag)
            out[i, j] = out[j, i] = total
