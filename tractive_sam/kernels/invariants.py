"""Scalars of stress tensors, in one pass over them."""

import math

from tractive_sam.kernels.compiled import ANY_ORDER, compiled


@compiled(fastmath=ANY_ORDER)
def compute_von_mises(out, stress):
    """Set `out` (n,) to the von Mises stresses of stresses (6, n): xx, yy, zz, xy, xz, yz."""
    for k in range(out.size):
        xx, yy, zz = stress[0, k], stress[1, k], stress[2, k]
        xy, xz, yz = stress[3, k], stress[4, k], stress[5, k]
        normal = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
        out[k] = math.sqrt(0.5 * normal + 3.0 * (xy**2 + xz**2 + yz**2))
