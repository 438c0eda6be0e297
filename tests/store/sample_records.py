from dataclasses import dataclass, replace

import numpy as np

from tractive_sam.kernels.stress import COMPONENTS
from tractive_sam.results.plane_stress import PlaneStress
from tractive_sam.results.quantities import BODY_POINTS, BODY_SCALARS, FIELDS, PROFILES, SCALARS
from tractive_sam.results.record import Record
from tractive_sam.scene import Plane

SCENE = 'title = "Twin discs"\n\n[friction]\nmu = [0.6, 0.3]\n'
REFERENCE = {"a0": 0.28, "b0": 0.45, "p0": 1144.4}


@dataclass(frozen=True)
class Mesh:
    """All that a writer wants to know of a grid."""

    x: np.ndarray
    y: np.ndarray
    half_length: tuple[float, float]


def mesh(n_x=5, n_y=9):
    x, y = 0.1 * (np.arange(n_x) - n_x // 2), 0.2 * (np.arange(n_y) - n_y // 2)
    return Mesh(x, y, (0.05 * n_x, 0.1 * n_y))


def make_stress(number, grid):
    """Stress of both bodies on a vertical plane and on one at constant depth."""
    depth = np.array([0.0, 0.1, 0.3])
    planes = {"y=0": {"x": grid.x, "depth": depth}, "z=0.5a": {"x": grid.x, "y": grid.y}}
    return tuple(
        PlaneStress(
            body,
            Plane.parse(plane),
            0.14,
            axes,
            {
                name: np.full([len(axis) for axis in axes.values()], number + 0.1 * k)
                for k, name in enumerate(COMPONENTS)
            },
        )
        for body in "AB"
        for plane, axes in planes.items()
    )


def with_stress(record, grid=None):
    """The same record of a scene with [subsurface]."""
    number = record.revolution / 10
    bodies = {
        body: dict.fromkeys(BODY_SCALARS, number + k) | dict.fromkeys(BODY_POINTS, (number, k, 0.1))
        for k, body in enumerate("AB")
    }
    stress = make_stress(number, grid or mesh()) if record.fields else ()
    return replace(record, bodies=bodies, stress=stress)


def make_record(number, with_fields=False, grid=None):
    """A record whose every value tells its number."""
    grid = grid or mesh()
    shape = (len(grid.x), len(grid.y))
    scalars = {name: number + 0.01 * k for k, name in enumerate(SCALARS)}
    fields = {name: np.full(shape, number + 0.1 * k) for k, name in enumerate(FIELDS)}
    return Record(
        10 * number,
        scalars | {"revolution": 10 * number, "solves": 2, "seconds": 0.5, "converged": 1.0},
        {"p_max_at": (0.1 * number, -0.1 * number)},
        {name: np.full(shape[1], 1e-6 * number) for name in PROFILES},
        fields if with_fields else {},
    )


def records(count, every=3):
    return [make_record(number, number % every == 0) for number in range(count)]
