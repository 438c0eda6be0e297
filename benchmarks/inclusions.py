"""Inclusions: errors of spheres over the cells, of the lift of the surface, and the cost of a box.

The first table compares the stress inside spheres, and the largest von Mises stress next to them,
with Eshelby's solution for an infinite body under uniaxial stress. The second table compares the
rise of the surface above a sphere that dilates with the exact one. The last line is the CPU time of
a sphere in a box of 64 x 64 x 64 cells below the surface, with its transforms.

    python benchmarks/inclusions.py

Page: docs/howto/inclusions.md
"""

from time import process_time

import numpy as np
from timing import show, write

from tractive_sam.mechanics import von_mises
from tractive_sam.scene import Inclusion
from tractive_sam.subsurface import InclusionGroup
from tractive_sam.subsurface.inclusion_group import sphere_points

SHEAR, NU = 80e3, 0.3
KINDS = {
    "alumina": (389e3, 0.25, 1.27578573, 1.246481),
    "TiN": (380e3, 0.25, 1.26558405, 1.237240),
    "MnS": (138e3, 0.3, 0.80606978, 1.193164),
    "cavity": (0.0, 0.3, 0.0, 1.980796),
    "rigid": (1e9, 0.3, 1.938462, 1.896505),
}


def spheres() -> list[dict[str, object]]:
    """Return errors of the stress inside, and of the largest next to spheres, by cells."""
    rows = []
    for cells in (7, 11, 21):
        for name, (young, nu, inside, largest) in KINDS.items():
            began = process_time()
            sphere = Inclusion(at=(0.0, 0.0, 1e3), radii=1.0, young=young, poisson=nu, cells=cells)
            group = InclusionGroup([sphere], SHEAR, NU)
            strain = np.zeros((6, *group.box.shape))
            strain[:] = np.linalg.inv(group.stiffness)[2][:, None, None, None]
            total, own = group.solve(strain)
            middle = (slice(None), *(cells // 2,) * 3)
            stress = np.tensordot(group.stiffness, total - own, 1)[middle]
            # As dense as the points at which results end their search for the largest value.
            mises = von_mises(group.at_surface(0, total, own, sphere_points(48))).max()
            row = {"cells": cells, "inclusion": name, "inside": abs(stress[2] - inside)}
            rows.append(
                row | {"next to it": abs(mises / largest - 1.0), "CPU": process_time() - began}
            )
    return rows


def lifts() -> list[dict[str, object]]:
    """Return errors of the rise of the surface above a dilating sphere, by its depth and cells."""
    rows = []
    for depth in (3.0, 1.5, 1.1):
        for cells in (7, 11, 21):
            sphere = Inclusion(
                at=(0.0, 0.0, depth), radii=1.0, young=208e3, poisson=NU, cells=cells
            )
            group = InclusionGroup([sphere], SHEAR, NU)
            own = np.zeros((6, *group.box.shape))
            own[:3] = group.share
            x = np.linspace(0.0, 3.0, 31)
            rise = group.box.lift(own, x, 0.0 * x)
            exact = 4.0 / 3.0 * (1.0 + NU) * depth / (x * x + depth**2) ** 1.5
            rows.append({"depth": depth, "cells": cells, "rise": np.abs(rise / exact - 1.0).max()})
    return rows


def large_box() -> float:
    """Return the CPU time, s, of a sphere of 32 cells across and the stress in 64^3 cells."""
    began = process_time()
    sphere = Inclusion(at=(0.0, 0.0, 4.0), radii=1.0, young=389e3, poisson=0.25, cells=32)
    group = InclusionGroup([sphere], SHEAR, NU)
    strain = np.zeros((6, *group.box.shape))
    strain[2], strain[:2] = 1e-3, -3e-4
    _, own = group.solve(strain)
    wide = InclusionGroup([sphere], SHEAR, NU, margin=0.5)
    assert wide.box.shape == (64, 64, 64)
    padded = np.zeros((6, 64, 64, 64))
    padded[:, 16:48, 16:48, 16:48] = group.share * own
    wide.box(padded)
    return process_time() - began


if __name__ == "__main__":
    for name, table in (("inclusions_spheres", spheres()), ("inclusions_lift", lifts())):
        write(name, table)
        show(name, table)
    print(f"64 x 64 x 64 cells: {large_box():.1f} s of CPU time")
