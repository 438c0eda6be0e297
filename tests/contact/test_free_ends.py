"""Free ends: closed forms, stress left on the faces, reciprocity, and what is refused."""

import math

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import tractive_sam as ts
from tests.plot.rendering import render
from tractive_sam import plot
from tractive_sam.mechanics import FreeEnds, HalfSpaces, Material, hertz_line
from tractive_sam.mechanics.free_ends import _Plate, find_quick_factor
from tractive_sam.operators import Lattice, Operators

INF, STEEL = float("inf"), {"young": 208e3, "poisson": 0.3, "radius_y": float("inf")}
PER_LENGTH = 800.0


def rollers(width=6.0, other=None, ends="free", poisson=0.3, A=None, load=None, **tables):
    """Two cylinders of steel; `other` is the width of B, 0 for a half-space."""
    steel = STEEL | {"poisson": poisson}
    B = steel | {"radius_x": 40.0}
    if other != 0:
        B |= {"width": other or width, "ends": ends}
    A = steel | {"radius_x": 6.0, "width": width, "ends": ends} | (A or {})
    loads = {"normal": PER_LENGTH * width} | (load or {})
    tables = {"grid": {"elements": [33, 65]}} | tables
    return ts.Scene(body={"A": A, "B": B}, load=loads, **tables)


def line(scene):
    """The line contact of the cylinders in plane strain."""
    return hertz_line(scene.material.plane_strain_modulus, scene.body.radii[0], PER_LENGTH)


def corner(poisson, distance, n=12, width=1e4):
    """Displacement by a pressure on a square of side 2 at a distance from an end, over half-space.

    At the centre of the square.
    """
    A, rigid, side = Material(0.5 * (1.0 - poisson), poisson), Material(INF, poisson), 2.0 / n
    rows = n + round(distance / side)
    law = FreeEnds(A, rigid, (width, INF), datum=width)
    ends = law.ends_on((n, rows), side, side, -0.5 * width + 0.5 * side)
    pressure = np.zeros((n, rows))
    pressure[:, -n:] = 1.0
    half_space = Operators(Lattice((n, rows), side, side), HalfSpaces(A, rigid), 1.0, 1.0)
    moved = half_space.normal(pressure[None])[0]
    middle = slice(n // 2 - 1, n // 2 + 1), slice(rows - n // 2 - 1, rows - n // 2 + 1)
    return 1.0 + ends(pressure)[middle].mean() / moved[middle].mean()


def test_bodies_that_are_symmetric_have_a_symmetric_pressure():
    pressure = ts.solve(rollers(other=0, grid={"elements": [13, 31]})).pressure
    # Rows are interpolated to 1e-4, from the same places on both sides.
    np.testing.assert_allclose(pressure, pressure[:, ::-1], atol=1e-6 * pressure.max())


def test_without_lateral_contraction_the_line_contact_reaches_the_ends():
    scene = rollers(poisson=0.0)
    contact = ts.solve(scene)
    peak = contact.pressure.max(axis=0)[1:-1]
    # All rows are alike: the differences are those of the quadrature over the waves.
    assert peak == pytest.approx(peak.mean(), rel=5e-4)
    # 21 elements across the contact give the peak to 0.3 %, as in a line contact.
    assert peak.mean() == pytest.approx(line(scene).p0, rel=3e-3)


def test_a_thin_disc_is_in_plane_stress():
    scene = rollers(width=1e-3, grid={"elements": [33, 11]})
    contact = ts.solve(scene)
    assert contact.pressure.max(axis=0)[1:-1].mean() == pytest.approx(
        math.sqrt(1.0 - 0.3**2) * line(scene).p0, rel=2e-3
    )
    assert contact.half_width_x / line(scene).a == pytest.approx(1.04828, rel=5e-3)  # mesh


def test_the_middle_of_a_wide_body_is_in_plane_strain():
    scene = rollers(width=40.0, grid={"elements": [33, 129]})
    contact = ts.solve(scene)
    middle = contact.pressure[:, 64]
    local = hertz_line(
        scene.material.plane_strain_modulus,
        scene.body.radii[0],
        middle.sum() * contact.grid.dx,
    )
    assert middle.max() == pytest.approx(local.p0, rel=3e-3)  # mesh


@pytest.mark.parametrize(
    ("poisson", "distance", "ratio"),
    # By a dense solution in space, extrapolated to fine meshes; its error is 2e-3.
    [(0.0, 0.0, 1.387), (0.3, 0.0, 1.528), (0.3, 3.0, 1.1315)],
)
def test_a_pressure_near_an_end(poisson, distance, ratio):
    assert corner(poisson, distance) == pytest.approx(ratio, abs=3e-3)


def test_the_faces_are_free_of_stress():
    """The stress of pressure and images on a face, and what is put there against it, in space."""
    half, k, poisson, n = 1.0, 2.0, 0.3, 10
    dy = half / n
    y = dy * (np.arange(n) + 0.5)
    plate = _Plate(half, poisson, 0.0, y, dy)
    q, weight = plate._waves_on_face(k, half)
    mode = np.arange(1500.0)
    across, stress = plate._stress(k, half, mode, q)
    total, size = np.hypot(k, across), np.where(mode == 0.0, half, 0.5 * half)
    pressure = 1.0 - 0.5 * np.abs(y - 0.7)
    mean = np.sinc(0.5 * across * dy / np.pi)
    sign = (-1.0) ** mode
    loads = (np.cos(across[:, None] * y) * mean[:, None]) @ pressure * dy / size
    long = np.hypot(k, q)
    thick = np.minimum(2.0 * long * half, 300.0)
    face = 2.0 / long * (np.cosh(thick) - 1.0) / (np.sinh(thick) + thick)
    own = np.diag(np.pi / (2.0 * weight * face)) - (stress * (0.5 * total / size)) @ stress.T
    moved = np.linalg.solve(own, -(stress * sign) @ loads)  # weighted displacement of the face
    on_face = moved / face * (np.pi / (2.0 * weight))
    reaction = 0.5 * total / size * sign * (moved @ stress)
    z = np.geomspace(dy, 3.0, 40)[:, None]  # nearer, it is that of waves left out
    decay = np.exp(-total * z)
    by_mode = ((across / total) ** 2 * (1.0 - total * z) + 2.0 * poisson * (k / total) ** 2) * decay
    left = by_mode @ (sign * (loads - reaction))
    # The transform is smooth in log(q): between its nodes a spline is exact to 1e-3.
    start, fine = q[5], np.linspace(0.0, q[-1], 20001)
    spline = CubicSpline(np.arcsinh(q / start), on_face)(np.arcsinh(fine / start))
    left = left + (2.0 / np.pi) * np.trapezoid(np.cos(fine * z) * spline, fine, axis=1)
    assert np.abs(left).max() < 0.01 * pressure.max()
    assert np.abs(by_mode @ (sign * loads)).max() > 0.1 * pressure.max()


def test_the_response_is_reciprocal_and_the_same_on_parts_and_halves():
    A, B = Material(80e3, 0.3), Material(30e3, 0.2)
    law, shape, dy = FreeEnds(A, B, (2.0, 2.2), datum=5.0), (8, 42), 0.05
    whole = law.ends_on(shape, 0.04, dy, -20.5 * dy)
    random = np.random.default_rng(0)
    p, q = random.random(shape), random.random(shape)
    assert (whole(p) * q).sum() == pytest.approx((whole(q) * p).sum(), rel=1e-12)
    assert (whole(p) * p).sum() > 0.0
    box = np.zeros(shape)
    box[:5, 7:30] = p[:5, 7:30]
    part = whole.part(5, slice(7, 30))
    assert part(p[:5, 7:30]) == pytest.approx(whole(box)[:5, 7:30], rel=1e-12)
    p += p[:, ::-1]
    half = whole.part(8, slice(21, 42), 41)
    assert half(p[:, 21:]) == pytest.approx(whole(p)[:, 21:], rel=1e-12)
    coarse = whole.coarsened((4, 21), (2, 2))
    blocks = random.random((4, 21))
    mean = whole(np.kron(blocks, np.ones((2, 2)))).reshape(4, 2, 21, 2).mean(axis=(1, 3))
    assert coarse(blocks) == pytest.approx(mean, rel=1e-12)


def test_equal_ends_are_softer_and_unequal_ones_have_a_peak():
    equal, wide = ts.solve(rollers()), ts.solve(rollers(other=0))
    ends = [contact.pressure.max(axis=0)[1] / contact.p_95 for contact in (equal, wide)]
    assert ends[0] < 0.8
    assert ends[1] > 1.1
    assert equal.end_load < wide.end_load
    assert equal.end_load < 0.09 * equal.P  # a tenth of the width
    finer = ts.solve(rollers(other=0, grid={"elements": [33, 129]}))
    assert finer.p_max > 1.05 * wide.p_max  # without limit
    assert finer.p_95 == pytest.approx(wide.p_95, rel=0.01)
    assert finer.end_load == pytest.approx(wide.end_load, rel=0.02)


def test_a_factor_on_images_is_near_free_ends():
    free, quick = (ts.solve(rollers(ends=ends)) for ends in ("free", "quick"))
    assert find_quick_factor(0.0) == pytest.approx(1.21)
    assert find_quick_factor(0.3) == pytest.approx(1.39, abs=1e-3)
    assert quick.end_load == pytest.approx(free.end_load, rel=0.03)
    assert quick.end_load != free.end_load


def test_widths_change_the_contact_without_jumps():
    widths = np.linspace(2.0, 2.4, 7)
    found = [ts.solve(rollers(width=w, load={"normal": 1500.0})) for w in widths]
    for values in ([c.approach for c in found], [c.end_load for c in found]):
        # Second differences of a smooth curve are of second order.
        assert np.abs(np.diff(values, 2)).max() < 0.2 * np.abs(np.diff(values)).max()


def test_tilt_and_moment_are_inverse():
    tilted = ts.solve(rollers(load={"tilt": 0.4}))
    assert tilted.Mx < 0.0
    found = ts.solve(rollers(load={"moment": tilted.Mx}))
    assert found.tilt == pytest.approx(0.4, abs=1e-4)  # the tolerance of the contact


def test_tractions_and_wear_at_ends(tmp_path):
    scene = rollers(
        creepage={"longitudinal": -0.002},
        friction={"mu": 0.3},
        wear={"intensity": 1e-9, "revolutions": 20, "save": [0, 20], "turns": "each"},
        grid={"elements": [17, 33]},
    )
    history = ts.roll(scene, tmp_path / "ends.h5")
    stored = ts.open_history(tmp_path / "ends.h5")
    assert stored.scene == scene
    first, last = stored.state(0), stored.state(20)
    assert first.Qx > 0.0
    assert last.wear.max() > 0.0
    assert last.end_load == pytest.approx(history.state(20).end_load, rel=1e-12)
    render(plot.pressure_along_roller(last))


def test_a_report_names_the_ends():
    text = str(ts.explain(rollers(other=8.0)))
    assert "no traction on the faces at y = +-3 mm" in text
    assert "without limit" in text
    assert "mirror images" in str(ts.explain(rollers(ends="quick")))
    assert "counts as half-space" not in text


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"A": {"width": None}}, "body.A.width"),
        ({"A": {"ends": "closed"}}, "body.A.ends"),
        ({"A": {"radius_y": 50.0}}, "body.A.radius_y"),
        (
            {"A": {"layer": [{"thickness": 0.1, "young": 4e5, "poisson": 0.3}]}},
            "body.A.layer",
        ),
        ({"A": {"relaxation": [{"ratio": 0.5, "time": 1.0}]}}, "body.A.relaxation"),
        ({"subsurface": {}}, "subsurface"),
        ({"fatigue": {"yield_strength": 600.0}}, "fatigue"),
        ({"transient": {"length": 1.0}}, "transient"),
        ({"gap": {"y": [-3, 0, 3], "separation": [0, 0, 0]}}, "gap"),
        ({"elasticity": {"law": "other"}}, "elasticity"),
        ({"conformal": {}}, "conformal"),
        ({"load": {"moment": 1e6}}, "load.moment"),
        ({"A": {"width": -1.0}}, "body.A.width"),
        ({"A": {"profile": {"form": "crowned", "radius": 1e3, "chamfer": 4.0}}}, "chamfer"),
    ],
)
def test_what_is_refused(change, key):
    with pytest.raises(ts.SceneError) as error:
        rollers(**change)
    assert key in str(error.value)


@pytest.mark.parametrize("grid", [{"elements": [33, 11]}, {"half_length": (0.1, 1e-5)}])
def test_ends_too_near_to_each_other_are_refused(grid):
    """What they add is not resolved: at a thousandth of the half length the pressure is off."""
    with pytest.raises(ts.SceneError, match=r"body\.A\.width"):
        ts.solve(rollers(width=1e-5, grid={"elements": [33, 11]} | grid))
