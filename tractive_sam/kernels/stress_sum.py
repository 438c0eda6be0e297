"""Stress at arbitrary points: the sum over all loaded patches."""

import math

from tractive_sam.kernels.compiled import compiled
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
