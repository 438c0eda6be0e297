"""The patch integrals at all offsets of a regular mesh, in tables made for transforms.

On a mesh the corners of the patches form a lattice, and each is shared by four patches: the corner
forms of :mod:`tractive_sam.kernels.stress` are evaluated once a corner, their logarithms and
arctangents by numpy, many at a time; differences between corners make the integrals. Far from the
patch those differences lose digits, but not more than a sum over the mesh does: their error is
absolute, about 1e-15 at any distance, like the error of the transforms.

**Packing.** An integral is even (e) or odd (o) in x and in y. Four of them, one of each parity, add
up to one real function on the plane. Its spectrum S separates them again:

    S(+-k_x, k_y) = ee -+ oo - i (eo +- oe),

ee, oe, eo and oo being the real sums with cosines and sines. So four real transforms serve all 14
integrals (`PACKS`). FFTW's cosine and sine transforms of one quadrant take 1.5 to 4.5 times longer.
In one dimension two integrals share a transform.
"""

import numpy as np

from tractive_sam.kernels.compiled import ANY_ORDER, compiled

PACKS = np.array(
    (
        (4, 0, 1, 5),  # xxz, xxx, xxy, xyz
        (6, 2, 3, 11),  # yyz, xyy, yyy, psi_xy
        (9, 7, 8, 14),  # zzz, xzz, yzz
        (10, 13, 12, 14),  # psi_xx, chi_xyy, chi_xxy
    )
)
"""Integrals that share a transform, even-even, odd-even, even-odd and odd-odd in (x, y).

Numbered as `stress.patch_integrals` returns them; the last, 14, stands for none."""

_ROWS = 32
"""Rows of corners evaluated at a time: few enough to stay in the cache."""


def layer_table(out: np.ndarray, z: float, dx: float, dy: float, first: int, last: int) -> None:
    """Set `out` to the 14 stress integrals, in four packs, at all offsets of a mesh at one depth.

    Parameters
    ----------
    out : ndarray, shape (4, p_x, p_y)
        Set at [:, +-i, :] for first <= i < last: the sums of `PACKS` at the offset (i dx, j dy),
        observer minus centre of the patch, at index (i mod p_x, j mod p_y); p_x and p_y even.
    z : float
        Depth, at least 0.
    dx, dy : float
        Sides of the patch and steps of the offsets.
    first, last : int
        Part of range(p_x/2 + 1).
    """
    px = out.shape[1]
    for i in range(first, last, _ROWS - 1):
        rows = np.arange(i, min(i + _ROWS - 1, last))
        strips = np.empty((8, rows.size + 1, out.shape[2]))
        edge_table(strips, (np.append(rows, rows[-1] + 1) - 0.5) * dx, z, dy)
        patches = strips[:, 1:] - strips[:, :-1]
        even, odd = patches[0::2], patches[1::2]
        # Half a period away odd functions have to vanish, for the packs to fall apart again; no
        # load is as far away as that.
        odd[:, 2 * rows == px] = 0.0
        np.add(even, odd, out=out[:, rows[0] : rows[-1] + 1])
        out[:, -rows % px] = np.subtract(even, odd, out=odd)


def edge_table(out: np.ndarray, xs: np.ndarray, z: float, dy: float) -> None:
    """Set `out` to the 14 stress integrals, in packs, of strips that end in an edge x = const.

    A strip is as wide as a patch, -dy/2 < y < dy/2, and runs in x from the edge; what depends on
    its other end is left out, so that the difference between the edges of a patch is its integral.

    Parameters
    ----------
    out : ndarray, shape (8, edges, p_y)
        For each of `PACKS` the sums ee + eo and oe + oo, at the offset j dy at index j mod p_y;
        p_y even.
    xs : ndarray, shape (edges,)
        Observer minus edge. For -x ee and eo have the other sign.
    z : float
        Depth, at least 0.
    dy : float
        Side of the patch and step of the offsets.
    """
    ys = (np.arange(out.shape[2] // 2 + 2) - 0.5) * dy
    for first in range(0, xs.size, _ROWS):
        part = xs[first : first + _ROWS]
        logs, angles = np.empty((3, part.size, ys.size)), np.empty((2, part.size, ys.size))
        _arguments(logs, angles, part, ys, z)
        corners = np.empty((15, part.size, ys.size))
        _corners(corners, np.log(logs, out=logs), np.arctan(angles, out=angles), part, ys, z)
        _pack_edges(out, first, corners, PACKS)


@compiled(fastmath=ANY_ORDER, inner=True)
def _distance2(x, z, width):
    """Return x² + z², or width² if that is 0 (see `stress.log_argument`)."""
    p = x * x + z * z
    return p if p > 0.0 else width * width


@compiled(fastmath=ANY_ORDER)
def _arguments(logs, angles, xs, ys, z):
    """Set `logs` and `angles` to the arguments of the logarithms and arctangents at corners."""
    for i in range(xs.size):
        x = xs[i]
        p = _distance2(x, z, ys[1] - ys[0])
        for j in range(ys.size):
            y = ys[j]
            q = y * y + z * z
            r = np.sqrt(x * x + q)
            # For y < 0 the sum y + r cancels; it equals p / (r - y).
            logs[0, i, j] = y + r if y >= 0.0 else p / (r - y)
            # Over sqrt(q), which falls out of every difference in x: odd in x, as edges want it.
            root = np.sqrt(q)
            logs[1, i, j] = (x + r) / root if x >= 0.0 else root / (r - x)
            logs[2, i, j] = r + z
            angles[0, i, j] = x * y / (p + z * r)
            angles[1, i, j] = x * y / (q + z * r)


@compiled(fastmath=ANY_ORDER)
def _corners(out, logs, angles, xs, ys, z):
    """Set `out` (15, ...) to the corner terms of the 14 integrals and of none at (xs[n], ys[j])."""
    for n in range(xs.size):
        x = xs[n]
        p = _distance2(x, z, ys[1] - ys[0])
        for j in range(ys.size):
            y = ys[j]
            q = y * y + z * z
            r = np.sqrt(x * x + q)
            over_r, over_t = 1.0 / r, 1.0 / (r + z)
            ln_y, ln_x, psi_xx = logs[0, n, j], logs[1, n, j], angles[0, n, j]
            # A = psi_xx + psi_yy, as ln(R + z) is harmonic: two arctangents serve three integrals.
            solid = psi_xx + angles[1, n, j]
            y_r, x_r = y * over_r, x * over_r
            z_p, z_q = z / p, z / q
            zzy_p, zzx_q = z * z_p * y_r, z * z_q * x_r
            zxy_p, zxy_q = z_p * x * y_r, z_q * x * y_r
            out[0, n, j] = zzy_p - y_r - 2.0 * ln_y
            out[1, n, j] = x_r - ln_x
            out[2, n, j] = y_r - ln_y
            out[3, n, j] = zzx_q - x_r - 2.0 * ln_x
            out[4, n, j] = solid - zxy_p
            out[5, n, j] = z * over_r
            out[6, n, j] = solid - zxy_q
            out[7, n, j] = -zzy_p
            out[8, n, j] = -zzx_q
            out[9, n, j] = solid + zxy_p + zxy_q
            out[10, n, j] = psi_xx
            out[11, n, j] = logs[2, n, j]
            out[12, n, j] = -x * over_t
            out[13, n, j] = -y * over_t
            out[14, n, j] = 0.0


@compiled(fastmath=ANY_ORDER)
def _pack_edges(out, first, corners, packs):
    """Set packs of `out` to integrals along edges from corner terms, at both images in y."""
    half = out.shape[2] // 2
    for n in range(corners.shape[1]):
        for a in range(8):
            # Half a period away odd functions have to vanish, as in `layer_table`.
            even, odd = packs[a // 2, a % 2], packs[a // 2, 2 + a % 2]
            out[a, first + n, half] = corners[even, n, half + 1] - corners[even, n, half]
            for j in range(half):
                e = corners[even, n, j + 1] - corners[even, n, j]
                o = corners[odd, n, j + 1] - corners[odd, n, j]
                out[a, first + n, j] = e + o
                if j > 0:
                    out[a, first + n, 2 * half - j] = e - o
