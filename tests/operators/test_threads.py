"""Operators may be used by several threads at once."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np

from tractive_sam.operators import HalfSpace, Mesh, StressLayers
from tractive_sam.reference import Material, combine


def test_threads_do_not_disturb_each_other():
    material = combine(Material(1.0, 0.3), Material(1.0, 0.3))
    operator = HalfSpace(Mesh((96, 96), 0.1, 0.1), material, 1.0).slip
    fields = np.random.default_rng(0).normal(size=(8, 2, 96, 96))
    alone = [operator(f) for f in fields]
    with ThreadPoolExecutor(4) as pool:
        for _ in range(5):
            for a, b in zip(pool.map(operator, fields), alone, strict=True):
                np.testing.assert_array_equal(a, b)


def test_nor_below_the_surface():
    tractions = np.random.default_rng(0).normal(size=(4, 1, 3, 24, 20))
    layers = [StressLayers(Mesh((24, 20), 0.1, 0.1), t, (0.3,), 1) for t in tractions]
    alone = [layer.at(0.2) for layer in layers]
    with ThreadPoolExecutor(4) as pool:
        for _ in range(5):
            for a, b in zip(pool.map(lambda one: one.at(0.2), layers), alone, strict=True):
                np.testing.assert_array_equal(a, b)
