from dataclasses import dataclass

import numpy as np

from tractive_sam.record import FIELDS, SCALARS, Record

SCENE = 'title = "Twin discs"\n\n[friction]\nmu = [0.6, 0.3]\n'
REFERENCE = {"a0": 0.28, "b0": 0.45, "p0": 1144.4}


@dataclass(frozen=True)
class Mesh:
    """All that a writer wants to know of a grid."""

    x: np.ndarray
    y: np.ndarray


def mesh(n_x=5, n_y=9):
    return Mesh(0.1 * (np.arange(n_x) - n_x // 2), 0.2 * (np.arange(n_y) - n_y // 2))


def make_record(number, with_fields=False, grid=None):
    """A record whose every value tells its number."""
    grid = grid or mesh()
    shape = (len(grid.x), len(grid.y))
    scalars = {name: number + 0.01 * k for k, name in enumerate(SCALARS)}
    fields = {name: np.full(shape, number + 0.1 * k) for k, name in enumerate(FIELDS)}
    return Record(
        10 * number,
        scalars | {"revolution": 10 * number},
        {"p_max_at": (0.1 * number, -0.1 * number)},
        {"wear_profile": np.full(shape[1], 1e-6 * number)},
        fields if with_fields else {},
    )


def records(count, every=3):
    return [make_record(number, number % every == 0) for number in range(count)]
