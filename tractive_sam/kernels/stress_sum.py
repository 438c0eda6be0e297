"""Stress at arbitrary points: the sum over all loaded patches, or over point forces for them."""

import math

import numpy as np

from tractive_sam.kernels.compiled import ANY_ORDER, compiled
from tractive_sam.kernels.stress import (
    assemble_normal,
    assemble_shear_x,
    assemble_shear_y,
    patch_integrals,
)


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
