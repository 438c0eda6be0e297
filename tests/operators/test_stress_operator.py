"""Layers and planes by FFT against the direct sum over elements."""

import numpy as np
import pytest

from tractive_sam.kernels.stress_sum import layer_table, sum_patch_stress
from tractive_sam.operators import Lattice, StressLayers, StressPlane, stress_layers
from tractive_sam.results.grid import Grid
from tractive_sam.subsurface.sources import tractions_on_bodies

GRID = Grid((3.0, 2.0), (13, 10))
MESH = Lattice(GRID.elements, GRID.dx, GRID.dy)
POISSON, SIGNS = (0.28, 0.4), (1.0, -1.0)
DEPTHS = [0.0, 1e-9, 0.1, 1.0, 4.0]
ZZ, XZ, YZ = 2, 4, 5
# Tractions are of order one; sums of 30 of them, and FFTs of 20 x 20.
ROUNDING = 1e-14


def random_tractions(rows, columns):
    tractions = np.zeros((3, *GRID.elements))
    shape = tractions[:, rows, columns].shape
    tractions[:, rows, columns] = np.random.default_rng(0).normal(size=shape)
    return tractions


# In the middle, at one corner, everywhere.
BOXES = [(slice(3, 9), slice(2, 7)), (slice(0, 2), slice(8, 10)), (slice(None), slice(None))]


def direct(tractions, body, points):
    """Stress (6, n) by the direct sum."""
    centres = np.array([(x, y) for x in GRID.x for y in GRID.y])
    loads = np.ascontiguousarray(tractions_on_bodies(tractions, SIGNS)[body].reshape(3, -1).T)
    out = np.empty((len(points), 6))
    sides = GRID.dx, GRID.dy
    sum_patch_stress(out, np.array(points, float), centres, loads, *sides, POISSON[body])
    return out.T


def close(stress, truth):
    np.testing.assert_allclose(stress, truth, rtol=1e-12, atol=ROUNDING)


@pytest.mark.parametrize("box", BOXES)
@pytest.mark.parametrize("depth", DEPTHS)
def test_layer(box, depth):
    tractions = random_tractions(*box)
    points = [(x, y, depth) for x in GRID.x for y in GRID.y]
    stress = StressLayers(MESH, tractions, POISSON, SIGNS).at(depth)
    assert stress.shape == (2, 6, *GRID.elements)
    for body in (0, 1):
        close(stress[body].reshape(6, -1), direct(tractions, body, points))


def test_threads_change_nothing():
    tractions = random_tractions(*BOXES[0])
    one, two = (
        StressLayers(MESH, tractions, POISSON, SIGNS, threads).at(0.3) for threads in (1, 2)
    )
    np.testing.assert_allclose(two, one, atol=1e-15)


# Not at the surface between two rows: the stress is infinite there.
CUTS = [("edge", 0.1), ("edge", 1.0)]
CUTS += [(place, depth) for place in ("row", "between", "outside") for depth in DEPTHS]


@pytest.mark.parametrize("box", BOXES)
@pytest.mark.parametrize("normal", ["x", "y"])
@pytest.mark.parametrize(("place", "depth"), CUTS)
def test_plane(box, normal, place, depth):
    tractions = random_tractions(*box)
    centres, step = (GRID.x, GRID.dx) if normal == "x" else (GRID.y, GRID.dy)
    position = {
        "row": centres[4],
        "edge": centres[4] + 0.5 * step,
        "between": centres[4] + 0.3 * step,
        "outside": -7.0,
    }[place]
    points = [(position, y, depth) for y in GRID.y]
    if normal == "y":
        points = [(x, position, depth) for x in GRID.x]
    stress = StressPlane(GRID, normal, position, tractions, POISSON, SIGNS).at(depth)
    assert stress.shape == (2, 6, len(points))
    for body in (0, 1):
        close(stress[body], direct(tractions, body, points))


def test_surface_carries_the_tractions():
    tractions = random_tractions(*BOXES[0])
    layer = StressLayers(MESH, tractions, POISSON, SIGNS).at(0.0)
    row = StressPlane(GRID, "y", GRID.y[4], tractions, POISSON, SIGNS).at(0.0)
    on_bodies = tractions_on_bodies(tractions, SIGNS)
    np.testing.assert_allclose(layer[:, [XZ, YZ, ZZ]], -on_bodies, atol=ROUNDING)
    np.testing.assert_allclose(row[:, [XZ, YZ, ZZ]], -on_bodies[..., 4], atol=ROUNDING)


@pytest.mark.parametrize("operator", ["layers", "plane"])
def test_bodies_do_not_see_each_other(operator):
    tractions = random_tractions(*BOXES[0])

    def made(*bodies):
        if operator == "layers":
            return StressLayers(MESH, tractions, *bodies)
        return StressPlane(GRID, "x", 0.3, tractions, *bodies)

    together = made(POISSON, SIGNS).at(0.4)
    for body in (0, 1):
        single = made(POISSON[body : body + 1], SIGNS[body : body + 1]).at(0.4)
        np.testing.assert_allclose(together[body], single[0], atol=1e-15)


def test_results_are_not_overwritten():
    layers = StressLayers(MESH, random_tractions(*BOXES[0]), POISSON, SIGNS)
    first = layers.at(0.2)
    kept = first.copy()
    layers.at(0.5)
    np.testing.assert_array_equal(first, kept)


def test_no_load_no_stress():
    nothing = np.zeros((3, *GRID.elements))
    assert not StressLayers(MESH, nothing, (0.3,), (1.0,)).at(0.1).any()
    assert not StressPlane(GRID, "x", 0.0, nothing, (0.3,), (1.0,)).at(0.1).any()


def test_error_far_below_is_absolute():
    """A hundred elements down the stress is 1e-4, with as many digits less than at the surface."""
    tractions = random_tractions(*BOXES[0])
    depth = 100.0 * GRID.dx
    points = [(x, y, depth) for x in GRID.x for y in GRID.y]
    truth = direct(tractions, 0, points)
    stress = StressLayers(MESH, tractions, POISSON, SIGNS).at(depth)[0].reshape(6, -1)
    assert np.abs(truth).max() < 1e-3
    np.testing.assert_allclose(stress, truth, atol=ROUNDING)


def test_what_is_kept_of_a_mesh_is_bounded_and_changes_nothing(monkeypatch):
    layers = StressLayers(MESH, random_tractions(*BOXES[0]), POISSON, SIGNS)
    depths = np.linspace(0.1, 0.9, 9)
    computed, cache = [], stress_layers.LayerCache()

    def compute_table(tables, depth, *more):
        computed.append(depth)
        layer_table(tables, depth, *more)

    monkeypatch.setattr(stress_layers, "layer_table", compute_table)
    monkeypatch.setattr(stress_layers, "layer_cache", cache)
    once = [layers.at(depth) for depth in depths]
    small = stress_layers.LayerCache(cache.size() * 5 // 9)
    monkeypatch.setattr(stress_layers, "layer_cache", small)
    computed.clear()
    for _ in range(2):
        for depth, stress in zip(depths, once, strict=True):
            np.testing.assert_array_equal(layers.at(depth), stress)
            assert small.size() <= small.max_bytes
    assert computed == [*depths, *depths[5:]]
    other = StressLayers(MESH.with_shape((20, 10)), np.ones((3, 20, 10)), (0.3,), (1.0,))
    other.at(0.1)
    computed.clear()
    layers.at(depths[0])
    assert computed == [depths[0]]
