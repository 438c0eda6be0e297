"""Stress of all loaded patches: summed at points, or by transforms in layers and planes of a mesh.

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

Spectra of functions that are odd in x carry a factor -i, as do those odd in y: with the real sums
ee, oe, eo, oo the spectra are ee, -i oe, -i eo and
-oo. The parity of a stress component is the product of the parities of its indices and its load.
"""

import math

import numpy as np

from tractive_sam.kernels.compiled import ANY_ORDER, compiled
from tractive_sam.kernels.stress import (
    assemble_normal,
    assemble_shear_x,
    assemble_shear_y,
    patch_integrals,
)

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


@compiled(fastmath=ANY_ORDER)
def layer_product(out, packs, loads, sign, nu, first, last):
    """Set `out` to the spectra of six stresses in a plane z = const, in the rows +-i of a range.

    Parameters
    ----------
    out : ndarray of complex, shape (6, p_x, p_y/2 + 1)
        Spectra of the stresses, times 2 pi.
    packs : ndarray of complex, shape (4, p_x, p_y/2 + 1)
        Spectra of `layer_table`.
    loads : ndarray of complex, shape (3, p_x, p_y/2 + 1)
        Spectra of (p_x, p_y, p_n).
    sign : float
        Factors of p_x and p_y.
    nu : float
        Poisson's ratio.
    first, last : int
        Part of range(p_x/2 + 1).
    """
    _, px, half = packs.shape
    for i in range(first, last):
        k = (px - i) % px
        for j in range(half):
            sums = _unpack_layer(packs, i, k, j)
            along_x, along_y = assemble_shear_x(sums, nu), assemble_shear_y(sums, nu)
            normal = assemble_normal(sums, nu)
            x, y, n = sign * loads[0, i, j], sign * loads[1, i, j], loads[2, i, j]
            # In the mirror x -> -x the sums of -k_x become the sums of k_x.
            mx, my, mn = -sign * loads[0, k, j], sign * loads[1, k, j], loads[2, k, j]
            s = _combine(along_x, along_y, normal, x, y, n)
            m = _combine(along_x, along_y, normal, mx, my, mn)
            out[0, i, j], out[0, k, j] = s[0], m[0]
            out[1, i, j], out[1, k, j] = s[1], m[1]
            out[2, i, j], out[2, k, j] = s[2], m[2]
            out[3, i, j], out[3, k, j] = s[3], -m[3]
            out[4, i, j], out[4, k, j] = s[4], -m[4]
            out[5, i, j], out[5, k, j] = s[5], m[5]


@compiled(fastmath=ANY_ORDER, inner=True)
def _unpack_layer(packs, i, k, j):
    """Return the real sums of the 14 integrals from packs at (k_x, k_y) and (-k_x, k_y)."""
    xxz, xxx, xxy, xyz = _split_parities(packs[0, i, j], packs[0, k, j])
    yyz, xyy, yyy, psi_xy = _split_parities(packs[1, i, j], packs[1, k, j])
    zzz, xzz, yzz, _ = _split_parities(packs[2, i, j], packs[2, k, j])
    psi_xx, chi_xyy, chi_xxy, _ = _split_parities(packs[3, i, j], packs[3, k, j])
    return xxx, xxy, xyy, yyy, xxz, xyz, yyz, xzz, yzz, zzz, psi_xx, psi_xy, chi_xxy, chi_xyy


@compiled(fastmath=ANY_ORDER, inner=True)
def _split_parities(a, b):
    """Return four real sums (ee, oe, eo, oo) from their two complex combinations a and b."""
    return (
        0.5 * (a.real + b.real),
        0.5 * (b.imag - a.imag),
        -0.5 * (a.imag + b.imag),
        0.5 * (b.real - a.real),
    )


@compiled(fastmath=ANY_ORDER, inner=True)
def _combine(along_x, along_y, normal, x, y, n):
    """Return the spectra of six stresses from factors and the spectra of tractions x, y and n."""
    ix, iy, i_n = _minus_i(x), _minus_i(y), _minus_i(n)
    return (
        along_x[0] * ix + along_y[0] * iy + normal[0] * n,
        along_x[1] * ix + along_y[1] * iy + normal[1] * n,
        along_x[2] * ix + along_y[2] * iy + normal[2] * n,
        along_x[3] * ix + along_y[3] * iy - normal[3] * n,
        along_x[4] * x - along_y[4] * y + normal[4] * i_n,
        along_y[5] * y - along_x[5] * x + normal[5] * i_n,
    )


@compiled(fastmath=ANY_ORDER, inner=True)
def _minus_i(z):
    """Return -i z of a complex number z."""
    return complex(z.imag, -z.real)


@compiled(fastmath=ANY_ORDER)
def plane_product(out, packs, loads, sign, nu):
    """Add the spectra of six stresses in a plane x = const, summed over patch edges, to `out`.

    Parameters
    ----------
    out : ndarray of complex, shape (6, p_y/2 + 1)
        Spectra of the stresses, times 2 pi.
    packs : ndarray of complex, shape (8, edges, p_y/2 + 1)
        Spectra of `edge_table`.
    loads : ndarray of complex, shape (2, 3, edges, p_y/2 + 1)
        Spectra of the jumps of (p_x, p_y, p_n) at the edges at the distance +-x of the plane: their
        sum, and their difference.
    sign : float
        Factors of p_x and p_y.
    nu : float
        Poisson's ratio.
    """
    _, edges, half = packs.shape
    for e in range(edges):
        for j in range(half):
            sums = _unpack_edge(packs, e, j)
            along_x, along_y = assemble_shear_x(sums, nu), assemble_shear_y(sums, nu)
            normal = assemble_normal(sums, nu)
            # Across an edge the integrals odd in x are even, and the reverse.
            odd_x, odd_y, odd_n = (
                sign * loads[0, 0, e, j],
                sign * loads[0, 1, e, j],
                loads[0, 2, e, j],
            )
            x, y, n = sign * loads[1, 0, e, j], sign * loads[1, 1, e, j], loads[1, 2, e, j]
            for c in range(3):
                out[c, j] += along_x[c] * odd_x + along_y[c] * _minus_i(y) + normal[c] * n
            out[3, j] += along_x[3] * _minus_i(x) + along_y[3] * odd_y + normal[3] * _minus_i(odd_n)
            out[4, j] += along_x[4] * x + along_y[4] * _minus_i(odd_y) + normal[4] * odd_n
            out[5, j] += along_x[5] * _minus_i(odd_x) + along_y[5] * y + normal[5] * _minus_i(n)


@compiled(fastmath=ANY_ORDER, inner=True)
def _unpack_edge(packs, e, j):
    """Return the real sums of the 14 integrals across an edge from its packs at k_y."""
    xxz, xxy = packs[0, e, j].real, -packs[0, e, j].imag
    xxx, xyz = packs[1, e, j].real, -packs[1, e, j].imag
    yyz, yyy = packs[2, e, j].real, -packs[2, e, j].imag
    xyy, psi_xy = packs[3, e, j].real, -packs[3, e, j].imag
    zzz, yzz = packs[4, e, j].real, -packs[4, e, j].imag
    xzz = packs[5, e, j].real
    psi_xx, chi_xxy = packs[6, e, j].real, -packs[6, e, j].imag
    chi_xyy = packs[7, e, j].real
    return xxx, xxy, xyy, yyy, xxz, xyz, yyz, xzz, yzz, zzz, psi_xx, psi_xy, chi_xxy, chi_xyy


@compiled
def sum_patch_stress(out, points, centres, tractions, dx, dy, nu):
    """Set `out` to the stresses at points of a half-space under tractions constant on patches.

    Parameters
    ----------
    out : ndarray, shape (n, 6)
        Stresses in the order of `stress.COMPONENTS`, in the unit of the tractions.
    points : ndarray, shape (n, 3)
        (x, y, z) with the depth z >= 0.
    centres : ndarray, shape (m, 2)
        Centres of the patches, in the unit of the points.
    tractions : ndarray, shape (m, 3)
        (p_x, p_y, p_n) on the patches, as in `kernels.stress`.
    dx, dy : float
        Sides of the patches.
    nu : float
        Poisson's ratio.
    """
    for n in range(points.shape[0]):
        xx = yy = zz = xy = xz = yz = 0.0
        for m in range(centres.shape[0]):
            integrals = patch_integrals(
                points[n, 0] - centres[m, 0], points[n, 1] - centres[m, 1], points[n, 2], dx, dy
            )
            for load in range(3):
                p = tractions[m, load]
                if p == 0.0:
                    continue
                if load == 0:
                    s = assemble_shear_x(integrals, nu)
                elif load == 1:
                    s = assemble_shear_y(integrals, nu)
                else:
                    s = assemble_normal(integrals, nu)
                xx += p * s[0]
                yy += p * s[1]
                zz += p * s[2]
                xy += p * s[3]
                xz += p * s[4]
                yz += p * s[5]
        f = 0.5 / math.pi
        out[n, 0], out[n, 1], out[n, 2] = f * xx, f * yy, f * zz
        out[n, 3], out[n, 4], out[n, 5] = f * xy, f * xz, f * yz


NODE = 0.5 / math.sqrt(3.0)
"""Place of the Gauss-Legendre nodes of a side, from its middle, over its length."""


def cumulative_sums(tractions):
    """Return cumulative sums of tractions (3, n_x, n_y) over patches, (n_x + 1, n_y + 1, 3, 4).

    The sums contain the tractions, and the tractions times i, j and i j, the indices of the
    patches.
    """
    fields, nx, ny = tractions.shape
    sums = np.zeros((nx + 1, ny + 1, fields, 4))
    i, j = np.arange(nx)[:, None], np.arange(ny)
    for k, weight in enumerate((1.0, i, j, i * j)):
        sums[1:, 1:, :, k] = np.moveaxis((weight * tractions).cumsum(2).cumsum(1), 0, 2)
    return sums


@compiled
def stress_around(out, points, around, signs, poisson, corner, sums, sides, blocks, widest):
    """Add the stresses at groups of points to `out`; distant patches are combined in blocks.

    A quadtree: a block of patches with sides of at most `widest` times its distance is replaced by
    point forces at 2 x 2 nodes that have its load and its moments. Wider blocks are halved, and
    single patches have more nodes. The choice of blocks depends on `around`, not on the points, so
    that differences between points are smooth.

    Parameters
    ----------
    out : ndarray, shape (m, 6, n)
        Stresses in the order of `stress.COMPONENTS`, in the unit of the tractions, are added to it.
    points : ndarray, shape (m, n, 3)
        (x, y, z) with the depth z > 0.
    around : ndarray, shape (m, 3)
        A place near the points of each group.
    signs : ndarray, shape (m,)
        Factors of p_x and p_y.
    poisson : ndarray, shape (m,)
        Poisson's ratios.
    corner : tuple of float
        (x, y) of the corner of the mesh from which it extends to larger ones.
    sums : ndarray, shape (n_x + 1, n_y + 1, 3, 4)
        Sums from `cumulative_sums` of (p_x, p_y, p_n) on the patches, as in `kernels.stress`.
    sides : tuple of float
        (dx, dy) of the patches.
    blocks : tuple of int
        Patches along the sides of the largest blocks: powers of two that divide n_x and n_y.
    widest : float
        Longest side of a block over its distance, below 1. With 0.3 the relative error of the
        stress under smooth tractions is 2e-3, and almost equal at points near one another.
    """
    for m in range(len(points)):
        group = points[m], around[m]
        _sum_around(out, m, m + 1, *group, signs, poisson, corner, sums, sides, blocks, widest)


@compiled
def stress_at_columns(
    out, x, y, depths, signs, poisson, corner, sums, sides, blocks, widest, spread
):
    """Set `out` to the stresses at columns of points outside a mesh, by blocks of patches.

    Neighbouring rows share their blocks, up to a width of `spread` times the distance of their
    column from the mesh.

    Parameters
    ----------
    out : ndarray, shape (bodies, 6, n_x, n_y, k)
        Stresses in the order of `stress.COMPONENTS`, in the unit of the tractions.
    x : ndarray, shape (n_x,)
        Columns, beyond the ends of the mesh.
    y : ndarray, shape (n_y,)
        Rows, evenly spaced.
    depths : ndarray, shape (k,)
        Depths z > 0, ascending.
    signs, poisson : ndarray, shape (bodies,)
        Factors of p_x and p_y, and Poisson's ratio, of each body.
    corner, sums, sides, blocks, widest
        See `stress_around`.
    spread : float
        Width of rows over their distance, below 2.
    """
    half, k = 0.5 * blocks[0] * sides[0], depths.size
    points, stress = np.empty((y.size * k, 3)), np.empty((signs.size, 6, y.size * k))
    for i in range(x.size):
        distance = math.hypot(max(abs(x[i] - corner[0] - half) - half, 0.0), depths[0])
        together = min(max(int(spread * distance / sides[1]), 1), y.size)
        for first in range(0, y.size, together):
            last = min(first + together, y.size)
            count = (last - first) * k
            for n in range(count):
                points[n, 0], points[n, 1], points[n, 2] = x[i], y[first + n // k], depths[n % k]
            around = np.array((x[i], 0.5 * (y[first] + y[last - 1]), depths[0]))
            stress[:] = 0.0
            group = points[:count], around, signs, poisson
            _sum_around(
                stress, np.int64(0), signs.size, *group, corner, sums, sides, blocks, widest
            )
            for n in range(count):
                for body in range(signs.size):
                    for component in range(6):
                        value = stress[body, component, n]
                        out[body, component, i, first + n // k, n % k] = value


@compiled(inner=True)
def _sum_around(
    out, first, last, points, around, signs, poisson, corner, sums, sides, blocks, widest
):
    """Add to `out[first:last]` the stresses (6, ...) of bodies at a group of points, by blocks."""
    # Forces that are summed at a time.
    at_once = 512
    nx, ny = sums.shape[0] - 1, sums.shape[1] - 1
    forces, at_nodes = np.empty((5, at_once), dtype=np.float32), np.empty((3, 2, 2))
    # Lengths are from what the points are near, over its depth.
    per_depth = 1.0 / around[2]
    dx, dy = sides[0] * per_depth, sides[1] * per_depth
    places = np.empty(points.shape, dtype=np.float32)
    for n in range(len(points)):
        places[n, 0] = (points[n, 0] - around[0]) * per_depth
        places[n, 1] = (points[n, 1] - around[1]) * per_depth
        places[n, 2] = points[n, 2] * per_depth
    count = np.int64(0)  # a literal 0 would compile the callees another time
    # Blocks that wait, (first in x, first in y, number in x, number in y): no more than halvings.
    waiting = np.empty((128, 4), dtype=np.int64)
    for i in range(nx // blocks[0]):
        for j in range(ny // blocks[1]):
            waiting[0, 0], waiting[0, 1] = i * blocks[0], j * blocks[1]
            waiting[0, 2], waiting[0, 3] = blocks
            count_waiting = 1
            while count_waiting > 0:
                top = count_waiting - 1
                a, b, m, n = waiting[top, 0], waiting[top, 1], waiting[top, 2], waiting[top, 3]
                x = (corner[0] - around[0]) * per_depth + (a + 0.5 * m) * dx
                y = (corner[1] - around[1]) * per_depth + (b + 0.5 * n) * dy
                longest = widest * math.sqrt(x * x + y * y + 1.0)
                split_x, split_y = m > 1 and m * dx > longest, n > 1 and n * dy > longest
                if split_x or split_y:
                    if split_x and not (split_y and n * dy > m * dx):
                        m //= 2
                        a += m
                        waiting[top, 2] = m
                    else:
                        n //= 2
                        b += n
                        waiting[top, 3] = n
                    waiting[count_waiting, 0], waiting[count_waiting, 1] = a, b
                    waiting[count_waiting, 2], waiting[count_waiting, 3] = m, n
                    count_waiting += 1
                    continue
                count_waiting -= 1
                if not _set_at_nodes(at_nodes, sums, a, b, m, n):
                    continue
                pieces_x, pieces_y = math.ceil(m * dx / longest), math.ceil(n * dy / longest)
                share = dx * dy / (pieces_x * pieces_y)
                for k in range(2 * pieces_x):
                    at_x = x + m * dx * _node(k, pieces_x)
                    for h in range(2 * pieces_y):
                        if count == at_once:
                            _add_to_bodies(out, first, last, places, forces, count, signs, poisson)
                            count = np.int64(0)
                        forces[0, count] = at_x
                        forces[1, count] = y + n * dy * _node(h, pieces_y)
                        for load in range(3):
                            forces[2 + load, count] = (
                                share * at_nodes[load, k // pieces_x, h // pieces_y]
                            )
                        count += 1
    _add_to_bodies(out, first, last, places, forces, count, signs, poisson)


@compiled(inner=True)
def _node(k, pieces):
    """Return the k-th quadrature node of a side, from its middle, over its length."""
    offset = NODE if k % 2 == 1 else -NODE
    return (k // 2 + 0.5 + offset) / pieces - 0.5


@compiled(inner=True)
def _set_at_nodes(out, sums, a, b, m, n):
    """Set the loads (3, 2, 2) at the nodes of a block of m x n patches; return if any is not 0.

    They have the sum of the tractions and the moments of x, y and x y about the middle.
    """
    # A sum over patches that is less than this part of those before it is rounding.
    nothing = 1e-12
    # The middle and the nodes, in patches.
    x, y = a + 0.5 * (m - 1), b + 0.5 * (n - 1)
    node_x, node_y = NODE * m, NODE * n
    loaded = False
    for load in range(3):
        for by in range(4):
            right = sums[a + m, b + n, load, by] - sums[a, b + n, load, by]
            right -= sums[a + m, b, load, by] - sums[a, b, load, by]
            out[load, by // 2, by % 2] = right
        total, by_i, by_j = out[load, 0, 0], out[load, 0, 1], out[load, 1, 0]
        by_both = out[load, 1, 1]
        loaded = loaded or abs(total) > nothing * abs(sums[a + m, b + n, load, 0])
        lean_x, lean_y = (by_i - x * total) / node_x, (by_j - y * total) / node_y
        twist = (by_both - x * by_j - y * by_i + x * y * total) / (node_x * node_y)
        out[load, 0, 0] = 0.25 * (total - lean_x - lean_y + twist)
        out[load, 0, 1] = 0.25 * (total - lean_x + lean_y - twist)
        out[load, 1, 0] = 0.25 * (total + lean_x - lean_y - twist)
        out[load, 1, 1] = 0.25 * (total + lean_x + lean_y + twist)
    return loaded


@compiled(inner=True)
def _add_to_bodies(out, first, last, places, forces, count, signs, poisson):
    """Add to `out` the stresses (bodies, 6, n) of point forces; p_x, p_y times a sign per body."""
    for body in range(first, last):
        _add_forces(out[body], places, forces, count, signs[body], poisson[body])


@compiled(fastmath=ANY_ORDER, inner=True)
def _add_forces(out, places, forces, count, sign, nu):
    """Add to `out` the stresses of point forces (x, y, P_x, P_y, P_n), Boussinesq and Cerruti.

    The integrands of `stress.far_integrals`, each with its force. In single precision, from what
    the points are near: a millionth of the stress is less than what blocks take from it.
    """
    unit, three = np.float32(1.0), np.float32(3.0)
    f, k, sign = 0.5 / math.pi, np.float32(1.0 - 2.0 * nu), np.float32(sign)
    for n in range(places.shape[0]):
        x, y, z = places[n, 0], places[n, 1], places[n, 2]
        xx = yy = zz = xy = xz = yz = np.float32(0.0)
        for m in range(count):
            u, v = x - forces[0, m], y - forces[1, m]
            p_x, p_y, p_n = sign * forces[2, m], sign * forces[3, m], forces[4, m]
            uu, vv = u * u, v * v
            rr = uu + vv + z * z
            r = math.sqrt(rr)
            t = r + z
            rt = unit / (r * t)
            over_r, over_t = t * rt, r * rt
            over_r3 = over_r * over_r * over_r
            s = three * over_r3 * over_r * over_r * (u * p_x + v * p_y + z * p_n)
            g = (r + t) * over_r * over_r * over_t
            h = rt * over_t * (r + r + t) * over_r * over_r * over_t
            chi_xxy = v * (rt * over_t - uu * h)
            chi_xyy = u * (rt * over_t - vv * h)
            psi_xx = rt * (unit - uu * g)
            xx += k * (p_x * chi_xyy + p_y * (v * over_r3 - chi_xxy) + p_n * (z * over_r3 - psi_xx))
            xx -= uu * s
            yy += k * (p_x * (u * over_r3 - chi_xyy) + p_y * chi_xxy + p_n * psi_xx) - vv * s
            zz -= z * z * s
            xy -= k * (p_x * chi_xxy + p_y * chi_xyy - p_n * rt * u * v * g) + u * v * s
            xz -= u * z * s
            yz -= v * z * s
        out[0, n] += f * xx
        out[1, n] += f * yy
        out[2, n] += f * zz
        out[3, n] += f * xy
        out[4, n] += f * xz
        out[5, n] += f * yz
