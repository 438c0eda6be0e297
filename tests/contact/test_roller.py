"""Rollers: the logarithmic profile carries an even load, tilt and moment are inverse."""

import math
import warnings

import numpy as np
import pytest

import tractive_sam as ts
from tests.plot.rendering import render
from tractive_sam import plot
from tractive_sam.mechanics import hertz_line
from tractive_sam.schema import SceneWarning
from tractive_sam.studies import cases

INF = float("inf")
STEEL = {"young": 208e3, "poisson": 0.3}
WIDTH, LOAD = 12.0, 10e3
LINE = hertz_line(208e3 / 2 / 0.91, 1.0 / (1.0 / 6.0 + 1.0 / 40.0), LOAD / WIDTH)


def roller(profile="logarithmic", body=None, load=None, **tables):
    """A steel roller on a ring."""
    A = STEEL | {"radius_x": 6.0, "radius_y": INF, "width": WIDTH, "profile": profile}
    B = STEEL | {"radius_x": 40.0, "radius_y": INF}
    loads = {"normal": LOAD} | (load or {})
    return ts.Scene(body={"A": A | (body or {}), "B": B}, load=loads, **tables)


def along(contact):
    """Positions, and the load per length of a contact over the even load."""
    return contact.grid.y, contact.pressure.sum(axis=0) * contact.grid.dx * WIDTH / contact.P


def test_the_logarithmic_profile_has_an_even_pressure():
    contact = ts.solve(roller())
    y, share = along(contact)
    inside = np.abs(y) < 0.4 * WIDTH
    # Lundberg's formula is for a vanishing width: the rest is within 1 % away from the ends.
    assert share[inside] == pytest.approx(1.0, abs=0.01)
    assert contact.pressure.max(axis=0)[inside] == pytest.approx(LINE.p0, rel=0.01)
    # Towards its ends Lundberg's profile is too straight.
    assert contact.p_max < 1.3 * LINE.p0
    relieved = ts.solve(roller({"form": "logarithmic", "drop": 0.012}))
    assert relieved.p_max < contact.p_max
    assert contact.Mx == pytest.approx(0.0, abs=1e-6 * LOAD)  # symmetry, rounding


def test_a_straight_roller_has_peaks_at_its_ends():
    even, straight = (
        ts.solve(roller(p)) for p in ("logarithmic", {"form": "crowned", "drop": 1e-6})
    )
    assert straight.p_max > 1.3 * even.p_max


def test_the_design_load_does_not_follow_the_load():
    scene = roller()
    heavier = scene.replace(**{"load.normal": 2.0 * LOAD})
    assert heavier.body.A.profile.load == LOAD
    y, share = along(ts.solve(heavier))
    end = share[np.abs(np.abs(y) - 0.45 * WIDTH).argmin()]
    assert end > 1.05  # the profile is too flat for this load


def test_tilt_moves_the_load_to_the_side_that_comes_nearer():
    tilts = np.linspace(-1.0, 1.0, 9)
    moments = np.array([ts.solve(roller(load={"tilt": tilt})).Mx for tilt in tilts])
    assert (np.diff(moments) < 0.0).all()
    assert moments == pytest.approx(-moments[::-1], abs=1e-6 * LOAD * WIDTH)  # symmetry
    # No jumps: the second differences of a smooth curve are of second order.
    assert np.abs(np.diff(moments, 2)).max() < 0.02 * np.abs(moments).max()


def test_the_load_changes_with_the_width_without_jumps():
    def approach(width):
        A = {"width": width}
        return ts.solve(roller({"form": "crowned", "radius": 2e3}, body=A)).approach

    values = np.array([approach(width) for width in np.linspace(10.0, 12.0, 9)])
    # The ends lie between elements of other sizes: their noise is below 1e-3 of the approach.
    assert np.abs(np.diff(values, 2)).max() < 2e-3 * values.mean()


@pytest.mark.parametrize("tilt", [0.3, -1.0, 2.0])
def test_tilt_and_moment_are_inverse(tilt):
    given = ts.solve(roller(load={"tilt": tilt}, solver={"tolerance": 1e-10}))
    found = ts.solve(roller(load={"moment": given.Mx}, solver={"tolerance": 1e-10}))
    assert found.tilt == pytest.approx(tilt, rel=1e-7)
    assert found.Mx == pytest.approx(given.Mx, abs=1e-8 * LOAD * WIDTH)
    assert np.abs(found.pressure - given.pressure).max() < 1e-5 * given.p_max


def test_crown_and_end_relief():
    profile = ts.RollerProfile(form="crowned", flat=4.0, drop=0.01)
    y = np.array([0.0, 1.9, 3.5, 5.0, -5.0])
    assert profile.depth_at(y, 10.0, 0.0) == pytest.approx([0.0, 0.0, 0.0025, 0.01, 0.01])
    crown = ts.RollerProfile(form="crowned", radius=500.0)
    assert crown.depth_at(y, 10.0, 0.0)[3] == pytest.approx(25.0 / 1000.0)


def test_the_three_parameters():
    profile = ts.RollerProfile(form="logarithmic", load=1.0, curved=0.4, drop=0.02, load_factor=2.0)
    depth = profile.depth_at(np.array([0.0, 2.9, 5.0]), 10.0, 1e-3)
    assert depth[:2] == pytest.approx([0.0, 0.0])
    assert depth[2] == pytest.approx(0.02, rel=1e-12)
    a, share = 2e-3, ((4.0 - 3.0) / 2.0) ** 2
    middle = profile.depth_at(np.array([4.0]), 10.0, 1e-3)[0]
    assert middle == pytest.approx(a * math.log(1.0 / (1.0 - (1.0 - math.exp(-0.02 / a)) * share)))


def test_the_contact_ends_at_the_chamfer():
    contact = ts.solve(roller({"form": "crowned", "drop": 1e-3, "chamfer": 1.0}))
    touching = np.abs(contact.grid.y[contact.touching.any(axis=0)]).max()
    assert touching == pytest.approx(0.5 * WIDTH - 1.0, abs=contact.grid.dy)


def test_points_of_a_file(tmp_path):
    y = np.linspace(-6.0, 6.0, 241)
    rows = "\n".join(f"{a:.6f},{1e3 * a**2 / 4000.0:.9f}" for a in y)
    path = tmp_path / "roller.csv"
    path.write_text(f"y [mm],depth [um]\n{rows}\n")
    text = roller().to_toml().replace('form = "logarithmic"\nload = 10000.0', 'file = "roller.csv"')
    (tmp_path / "scene.toml").write_text(text)
    read, crown = (
        ts.Scene.from_toml(tmp_path / "scene.toml"),
        roller({"form": "crowned", "radius": 2000.0}),
    )
    one, two = ts.solve(read), ts.solve(crown)
    # Linear between points that are .05 mm apart.
    assert one.approach == pytest.approx(two.approach, rel=1e-3)
    assert roller(str(path)).fingerprint() == read.fingerprint()
    study = ts.Study(scene=roller(str(path)), axis=[{"key": "load.tilt", "values": [0.0, 0.5]}])
    assert len(cases(study)) == 2


def test_a_scene_keeps_its_profile_and_not_its_separation():
    scene = roller(load={"tilt": 0.5})
    assert "gap" not in scene.entries()
    again = ts.Scene.from_toml_text(scene.to_toml())
    assert again.fingerprint() == scene.fingerprint()
    level = scene.replace(**{"load.tilt": None})
    assert not np.array_equal(level.gap.separation, scene.gap.separation)
    assert scene.with_set(["load.moment=100"]).load.tilt is None


def test_a_worn_roller_keeps_its_moment(tmp_path):
    tables = {
        "friction": {"mu": 0.1},
        "creepage": {"longitudinal": 0.01},
        "wear": {"intensity": 1e-9, "revolutions": 40, "save": [0, 40], "turns": "each"},
        "grid": {"elements": [17, 61]},
        "fatigue": {"shear_yield": 900.0, "bodies": ["A"], "elements": 8},
    }
    scene = roller(load={"moment": -3000.0}, **tables)
    history = ts.roll(scene, tmp_path / "roller.h5")
    assert history["Mx"] == pytest.approx(-3000.0, abs=1e-6 * LOAD * WIDTH)
    assert history["tilt"][-1] != history["tilt"][0]
    stored = ts.open_history(tmp_path / "roller.h5").state(40)
    assert stored.tilt == pytest.approx(history["tilt"][-1])
    assert np.isfinite(history["shakedown_lower"][-1, 0])


def test_its_figure_and_its_description():
    contact = ts.solve(roller(load={"tilt": 0.5}))
    figure = render(plot.pressure_along_roller(contact))
    peak = figure.axes[0].lines[0].get_ydata()
    assert peak.max() == pytest.approx(contact.p_max)
    text = str(ts.explain(contact.scene))
    assert "tilt 0.5 mrad" in text
    assert "the profiles and the tilt of the rollers" in text


def test_derivatives_at_the_tilt_of_a_moment():
    pytest.importorskip("xarray")
    tables = {
        "friction": {"mu": 0.1},
        "creepage": {"longitudinal": 1e-4},
        "grid": {"elements": [17, 61]},
    }
    tilted = ts.solve(roller(load={"moment": -3000.0}, **tables), jacobian=True)
    level = ts.solve(roller(load={"tilt": tilted.tilt}, **tables), jacobian=True)
    one, two = (contact.jacobian.loc["Qx", "xi_x"].item() for contact in (tilted, level))
    assert one == pytest.approx(two, rel=1e-4)  # elements at the border of stick may differ


@pytest.mark.parametrize(
    ("profile", "body", "load", "key"),
    [
        ("logarithm", {}, {}, "body.A.profile.form"),
        ({}, {}, {}, "body.A.profile.form"),
        ("no-such-file.csv", {}, {}, "body.A.profile.file"),
        ({"form": "crowned"}, {}, {}, "body.A.profile.radius"),
        ({"form": "series"}, {}, {}, "body.A.profile.coefficients"),
        (
            {"form": "series", "coefficients": [0.1], "basis": "sine"},
            {},
            {},
            "body.A.profile.basis",
        ),
        (
            {"form": "crowned", "drop": 0.1, "coefficients": [0.1]},
            {},
            {},
            "body.A.profile.coefficients",
        ),
        ({"form": "crowned", "radius": 1e3, "drop": 0.1}, {}, {}, "body.A.profile.radius"),
        ({"form": "crowned", "radius": -1e3}, {}, {}, "body.A.profile.radius"),
        ({"form": "crowned", "radius": 1e3, "load": 1.0}, {}, {}, "body.A.profile.load"),
        ({"form": "logarithmic", "radius": 1e3}, {}, {}, "body.A.profile.radius"),
        ({"form": "logarithmic", "curved": 1.5}, {}, {}, "body.A.profile.curved"),
        ({"form": "logarithmic", "load_factor": 0.0}, {}, {}, "body.A.profile.load_factor"),
        ({"form": "points", "y": [0.0, 1.0]}, {}, {}, "body.A.profile.y"),
        ({"form": "points", "y": [0, 2, 1], "depth": [0, 0, 0]}, {}, {}, "body.A.profile.y"),
        ({"form": "logarithmic", "chamfer": 7.0}, {}, {}, "body.A.profile.chamfer"),
        ({"form": "crowned", "drop": 0.1, "flat": 12.0}, {}, {}, "body.A.profile.flat"),
        ("logarithmic", {"width": None}, {}, "body.A.width"),
        ("logarithmic", {"radius_y": 100.0}, {}, "body.A.radius_y"),
        ("logarithmic", {}, {"normal": None, "approach": 0.01}, "body.A.profile.load"),
        ("logarithmic", {}, {"tilt": 200.0}, "load.tilt"),
        ("logarithmic", {}, {"tilt": 0.1, "moment": 1.0}, "load.tilt"),
        ("logarithmic", {}, {"moment": 6.0 * LOAD}, "load.moment"),
        (None, {}, {"tilt": 0.1}, "load.tilt"),
        (None, {}, {"moment": 0.1}, "load.moment"),
    ],
)
def test_a_fault(profile, body, load, key):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SceneWarning)
        with pytest.raises(ts.SceneError) as error:
            roller(profile, body, load)
    assert key in [fault.key for fault in error.value.faults]


def test_a_gap_and_a_profile_are_alternatives():
    gap = {"y": [-1.0, 0.0, 1.0], "separation": [0.0, 0.0, 0.0]}
    with pytest.raises(ts.SceneError) as error:
        roller(gap=gap)
    assert "gap" in [fault.key for fault in error.value.faults]


def test_a_series_has_the_profiles_of_the_closed_forms():
    y = np.linspace(-5.999, 5.999, 101)
    s = y / 6.0
    lundberg = ts.RollerProfile(form="logarithmic").depth_at(y, WIDTH, 0.002)
    series = ts.RollerProfile(form="series", coefficients=[0.002])
    assert series.depth_at(y, WIDTH, 0.0) == pytest.approx(lundberg, rel=1e-9)  # rounding
    crown = ts.RollerProfile(form="crowned", drop=0.01).depth_at(y, WIDTH, 0.0)
    polynomial = ts.RollerProfile(form="series", basis="polynomial", coefficients=[0.01, 0.0])
    assert polynomial.depth_at(y, WIDTH, 0.0) == pytest.approx(crown, rel=1e-12)
    mixed = ts.RollerProfile(form="series", coefficients=[0.002, 0.003, 0.004])
    expected = -0.002 * np.log1p(-(s**2)) + 0.003 * s**2 + 0.004 * s**4
    assert mixed.depth_at(y, WIDTH, 0.0) == pytest.approx(expected, rel=1e-12)
    # A parabola is a spline: its factors are the means of products of two of three knots.
    n = 5
    knots = np.concatenate([[0.0] * 3, np.linspace(0.0, 1.0, n), [1.0] * 3])
    a, b, c = (knots[k : k + n + 2] for k in (1, 2, 3))
    factors = ((a * b + b * c + a * c) / 3.0)[2:]
    spline = ts.RollerProfile(form="series", basis="spline", coefficients=factors.tolist())
    assert spline.depth_at(y, WIDTH, 0.0) == pytest.approx(s**2, abs=1e-12)
