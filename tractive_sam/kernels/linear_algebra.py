"""Products of spectra and orthonormal vectors, each in one pass over memory.

NumPy would take one pass for every term. The products are the only work of a convolution between
its two transforms.
"""

from math import inf, isnan, sqrt

import numpy as np

from tractive_sam.kernels.compiled import ANY_ORDER, compiled


@compiled(fastmath=ANY_ORDER, inner=True)
def _dot(first, second):
    """Return the scalar product of two vectors, in their precision."""
    total = first.dtype.type(0.0)
    for k in range(first.size):
        total += first[k] * second[k]
    return total


@compiled(fastmath=ANY_ORDER, inner=True)
def _subtract(vector, factor, other):
    """Subtract from a vector another one times a factor, in place."""
    factor = vector.dtype.type(factor)
    for k in range(vector.size):
        vector[k] -= factor * other[k]


@compiled
def extend_basis(basis, k, residual, triangle, along, rounding):
    """Make row k of a basis orthonormal to the rows before it; remove its part of a residual.

    Modified Gram-Schmidt, twice: the second pass removes the rounding errors of the first one.

    Parameters
    ----------
    basis : ndarray, shape (m, n)
        Orthonormal rows, and the new row k, which is changed.
    k : int
        Index of the new row.
    residual : ndarray, shape (n,)
        Residual, orthogonal to the rows before row k; changed.
    triangle : ndarray, shape (m, m)
        Matrix with zeros in column k, which is set to the components and the norm of the new row.
    along : ndarray, shape (m,)
        Components of the residual; the one along the new row is set.
    rounding : float
        Ratio of the new row to its removed part below which rounding has spoilt its digits.

    Returns
    -------
    float
        Norm of the residual; infinite if rounding has spoilt the new row.
    """
    new, removed = basis[k], 0.0
    for _ in range(2):
        for i in range(k):
            part = _dot(basis[i], new)
            _subtract(new, part, basis[i])
            triangle[i, k] += part
            removed += part * part
        norm = sqrt(_dot(new, new))
        if norm * norm >= 0.01 * removed:  # the rounding errors are small
            break
    if norm <= rounding * sqrt(removed):
        return inf
    scale = new.dtype.type(1.0 / norm)
    for j in range(new.size):
        new[j] *= scale
    triangle[k, k], along[k] = norm, _dot(new, residual)
    _subtract(residual, along[k], new)
    return sqrt(_dot(residual, residual))


@compiled
def solve_triangle(triangle, right, count):
    """Return x, shape (count,), with the upper triangle times x equal to the right-hand side."""
    x = np.empty(count)
    for i in range(count - 1, -1, -1):
        total = right[i]
        for j in range(i + 1, count):
            total -= triangle[i, j] * x[j]
        x[i] = total / triangle[i, i]
    return x


@compiled
def scalar(s, h):
    """Multiply a spectrum (1, m) in place by a scalar spectrum, real or complex, (1, m)."""
    for k in range(h.shape[1]):
        h[0, k] *= s[0, k]


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
def mirrored(s, h):
    """Set the spectrum h of two packed fields to s[0] h + s[1] conj(h at the opposite k_x).

    Parameters
    ----------
    s : ndarray, shape (2, columns, p_x)
        Factors.
    h : ndarray of complex, shape (1, m)
        Spectrum along x, column by column at equal distances of at least p_x.
    """
    _, columns, px = s.shape
    stride, opposite = h.shape[1] // columns, np.empty(px, h.dtype)
    for q in range(columns):
        column, direct, crossed = h[0, q * stride : q * stride + px], s[0, q], s[1, q]
        opposite[0] = np.conj(column[0])
        for k in range(1, px):
            opposite[k] = np.conj(column[px - k])
        for k in range(px):
            column[k] = direct[k] * column[k] + crossed[k] * opposite[k]


@compiled
def asymmetry(field, sign):
    """Return the largest |f(y) - sign f(-y)| and the largest |f| of a field; nan if one is nan."""
    nx, ny = field.shape
    apart = size = 0.0
    for i in range(nx):
        for j in range((ny + 1) // 2):
            here, there = field[i, j], field[i, ny - 1 - j]
            difference = abs(here - sign * there)
            if isnan(difference):
                return difference, difference
            apart = max(apart, difference)
            size = max(size, abs(here), abs(there))
    return apart, size


@compiled
def pack_half(fields, even, between, first, out):
    """Set `out` to the sum of fields on all of a period along y, from their half at y >= 0.

    Parameters
    ----------
    fields : ndarray, shape (1 or 2, n_x, n)
        Fields at y >= 0; field `even` is even in y, the other one is odd.
    even, between : int
        Index of the even field; 1 if the axis y = 0 lies between elements, 0 on the first row.
    first : int
        Index along x of the first rows.
    out : ndarray, shape (rows, p_y)
        Set; values at -y are at the end, and those of the odd field on the axis are left out.
    """
    n, odd = fields.shape[2], fields.shape[0] - 1 - even
    rows, py = out.shape
    for i in range(rows):
        for j in range(n, py - n + 1 - between):
            out[i, j] = 0.0
        if fields.shape[0] == 1:
            for j in range(n):
                out[i, j] = fields[0, first + i, j]
            for j in range(1 - between, n):
                out[i, py - between - j] = fields[0, first + i, j]
        else:
            for j in range(n):
                out[i, j] = fields[even, first + i, j] + fields[odd, first + i, j]
            for j in range(1 - between, n):
                out[i, py - between - j] = fields[even, first + i, j] - fields[odd, first + i, j]
            if not between:
                out[i, 0] = fields[even, first + i, 0]


@compiled
def unpack_half(packed, fields, even, between, first, out):
    """Set `out`, shape (1 or 2, n_x, n), to the fields at y >= 0 of a sum (`pack_half`).

    The odd field on the axis is set to its value in `fields`: an equation with the solution zero.
    """
    n, odd = out.shape[2], out.shape[0] - 1 - even
    rows, py = packed.shape
    for i in range(rows):
        if out.shape[0] == 1:
            for j in range(n):
                out[0, first + i, j] = packed[i, j]
        else:
            for j in range(1 - between, n):
                above, below = packed[i, j], packed[i, py - between - j]
                out[even, first + i, j], out[odd, first + i, j] = above + below, above - below
            if not between:
                out[even, first + i, 0] = 2.0 * packed[i, 0]
                out[odd, first + i, 0] = fields[odd, first + i, 0]


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


@compiled
def sum_from_end(values, weights, falls, out):
    """Set rows of `out` from the last one, which is given, to sums over rows ahead that fade.

    A row is its factor `falls` times the next row, and six values from its place on by `weights`.

    Parameters
    ----------
    values : ndarray, shape (m or 1, n + 6, k)
        Values, of each sum or of all.
    weights : ndarray, shape (m, 6)
        Weights of successive values.
    falls : ndarray, shape (m,)
        Factors of the next row.
    out : ndarray, shape (m, n + 1, k)
        The sums.
    """
    for m in range(len(out)):
        source, total, fall = values[m % len(values)], out[m], falls[m]
        a, b, c, d, e, f = weights[m]
        for i in range(total.shape[0] - 2, -1, -1):
            for k in range(total.shape[1]):
                near = a * source[i, k] + b * source[i + 1, k] + c * source[i + 2, k]
                far = d * source[i + 3, k] + e * source[i + 4, k] + f * source[i + 5, k]
                total[i, k] = fall * total[i + 1, k] + (near + far)
