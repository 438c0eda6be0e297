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
def stress_at(out, points, centres, tractions, dx, dy, nu):
    """Set the stresses at points of a half-space, exact for tractions constant on every patch.

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


WIDEST = 0.3
"""Longest side of a block over its distance. What the stress loses by that is a few thousandths,
and much the same at points near one another."""

NODE = 0.5 / math.sqrt(3.0)
"""Place of the Gauss-Legendre nodes of a side, from its middle, over its length."""

AT_ONCE = 512
"""Forces that are summed at a time."""


@compiled
def stress_around(out, points, around, corner, tractions, dx, dy, blocks_x, blocks_y, nu):
    """Set the stresses at points near one another, with patches that are far taken together.

    A quadtree: a block of patches whose sides are at most `WIDEST` times its distance is replaced
    by point forces at 2 x 2 nodes, one for each of its quarters; wider ones are halved, and of
    single patches there are more nodes. What makes a block depends on `around`, not on the points,
    so that differences between these are smooth.

    Parameters
    ----------
    out : ndarray, shape (n, 6)
        Stresses in the order of `stress.COMPONENTS`, in the unit of the tractions.
    points : ndarray, shape (n, 3)
        (x, y, z) with the depth z > 0.
    around : ndarray, shape (3,)
        What the points are near.
    corner : tuple of float
        (x, y) of the corner of the mesh from which it extends to larger ones.
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) on the patches, as in `kernels.stress`.
    dx, dy : float
        Sides of the patches.
    blocks_x, blocks_y : int
        Patches along the sides of the largest blocks: powers of two that divide n_x and n_y.
    nu : float
        Poisson's ratio.
    """
    out[:] = 0.0
    _, nx, ny = tractions.shape
    forces, quarters = np.empty((5, AT_ONCE)), np.empty((3, 2, 2))
    count = 0
    # Blocks that wait, (first in x, first in y, number in x, number in y): no more than halvings.
    waiting = np.empty((128, 4), dtype=np.int64)
    for i in range(0, nx, blocks_x):
        for j in range(0, ny, blocks_y):
            waiting[0, 0], waiting[0, 1], waiting[0, 2], waiting[0, 3] = i, j, blocks_x, blocks_y
            left = 1
            while left > 0:
                a, b, m, n = waiting[left - 1]
                x, y = corner[0] + (a + 0.5 * m) * dx, corner[1] + (b + 0.5 * n) * dy
                most = WIDEST * math.sqrt(
                    (x - around[0]) ** 2 + (y - around[1]) ** 2 + around[2] ** 2
                )
                split_x, split_y = m > 1 and m * dx > most, n > 1 and n * dy > most
                if split_x or split_y:
                    if split_x and not (split_y and n * dy > m * dx):
                        m //= 2
                        a += m
                        waiting[left - 1, 2] = m
                    else:
                        n //= 2
                        b += n
                        waiting[left - 1, 3] = n
                    waiting[left, 0], waiting[left, 1] = a, b
                    waiting[left, 2], waiting[left, 3] = m, n
                    left += 1
                    continue
                left -= 1
                if not _sum_quarters(quarters, tractions, a, b, m, n):
                    continue
                nodes_x, nodes_y = 2 * math.ceil(m * dx / most), 2 * math.ceil(n * dy / most)
                share = 4.0 * dx * dy / (nodes_x * nodes_y)
                for k in range(nodes_x * nodes_y):
                    if count == AT_ONCE:
                        _add_forces(out, points, forces, count, nu)
                        count = 0
                    forces[0, count] = x + m * dx * _node(k % nodes_x, nodes_x)
                    forces[1, count] = y + n * dy * _node(k // nodes_x, nodes_y)
                    half_x, half_y = 2 * (k % nodes_x) // nodes_x, 2 * (k // nodes_x) // nodes_y
                    for load in range(3):
                        forces[2 + load, count] = share * quarters[load, half_x, half_y]
                    count += 1
    _add_forces(out, points, forces, count, nu)


@compiled
def _node(k, nodes):
    """Place of a node of a side, from its middle, over its length: two in each of equal pieces."""
    offset = NODE if k % 2 == 1 else -NODE
    return (k // 2 + 0.5 + offset) / (nodes // 2) - 0.5


@compiled(fastmath=ANY_ORDER)
def _sum_quarters(out, tractions, a, b, m, n):
    """Set the sums (3, 2, 2) of the tractions over the quarters of a block of m x n patches.

    So weighed that forces at the nodes have the moments of the quarters. Whether there are any.
    """
    half_x, half_y = (m + 1) // 2, (n + 1) // 2
    for load in range(3):
        for i in range(2):
            for j in range(2):
                total = 0.0
                for k in range(a + i * half_x, a + (m if i == 1 else half_x)):
                    for h in range(b + j * half_y, b + (n if j == 1 else half_y)):
                        total += tractions[load, k, h]
                out[load, i, j] = total
    loaded = False
    for load in range(3):
        if m == 1:  # one patch has equal halves
            for j in range(2):
                out[load, 0, j] *= 0.5
                out[load, 1, j] = out[load, 0, j]
        if n == 1:
            for i in range(2):
                out[load, i, 0] *= 0.5
                out[load, i, 1] = out[load, i, 0]
        mean = 0.25 * (out[load, 0, 0] + out[load, 0, 1] + out[load, 1, 0] + out[load, 1, 1])
        for i in range(2):
            for j in range(2):
                loaded = loaded or out[load, i, j] != 0.0
                out[load, i, j] = mean + 0.25 / NODE * (out[load, i, j] - mean)
    return loaded


@compiled(fastmath=ANY_ORDER)
def _add_forces(out, points, forces, count, nu):
    """Add the stresses of point forces (x, y, P_x, P_y, P_n), by Boussinesq and Cerruti.

    The integrands of `stress.far_integrals`, each with its force.
    """
    f, k = 0.5 / math.pi, 1.0 - 2.0 * nu
    for n in range(points.shape[0]):
        x, y, z = points[n, 0], points[n, 1], points[n, 2]
        xx = yy = zz = xy = xz = yz = 0.0
        for m in range(count):
            u, v = x - forces[0, m], y - forces[1, m]
            p_x, p_y, p_n = forces[2, m], forces[3, m], forces[4, m]
            uu, vv = u * u, v * v
            rr = uu + vv + z * z
            r = math.sqrt(rr)
            t = r + z
            rt = 1.0 / (r * t)
            over_r, over_t = t * rt, r * rt
            over_r3 = over_r * over_r * over_r
            s = 3.0 * over_r3 * over_r * over_r * (u * p_x + v * p_y + z * p_n)
            g = (r + t) * over_r * over_r * over_t
            h = rt * over_t * (r + r + t) * over_r * over_r * over_t
            chi_xxy = v * (rt * over_t - uu * h)
            chi_xyy = u * (rt * over_t - vv * h)
            psi_xx = rt * (1.0 - uu * g)
            xx += k * (p_x * chi_xyy + p_y * (v * over_r3 - chi_xxy) + p_n * (z * over_r3 - psi_xx))
            xx -= uu * s
            yy += k * (p_x * (u * over_r3 - chi_xyy) + p_y * chi_xxy + p_n * psi_xx) - vv * s
            zz -= z * z * s
            xy -= k * (p_x * chi_xxy + p_y * chi_xyy - p_n * rt * u * v * g) + u * v * s
            xz -= u * z * s
            yz -= v * z * s
        out[n, 0] += f * xx
        out[n, 1] += f * yy
        out[n, 2] += f * zz
        out[n, 3] += f * xy
        out[n, 4] += f * xz
        out[n, 5] += f * yz
