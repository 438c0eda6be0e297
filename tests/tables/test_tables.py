"""Tables of creep forces: their laws, the errors that they report, and equal numbers in C."""

import json
import math
import shutil
import subprocess

import h5py
import numpy as np
import pytest
from typer.testing import CliRunner

import tractive_sam as ts
from tests.tables import copy_without_seal
from tractive_sam.cli import app
from tractive_sam.lookup import Hermite, c_sources, columns_of
from tractive_sam.lookup.creep_table import COLUMNS
from tractive_sam.reference import creep_coefficients, full_slip_with_spin
from tractive_sam.tables import builtin_tables, is_design
from tractive_sam.tables.design import Contacts, unit_scene

pytest.importorskip("xarray", reason="xarray is of the extra study")

CONTACT = {"a": 6.0, "b": 4.0, "load": 8e4, "mu": 0.3, "shear": 8e4}
C = math.sqrt(24.0)
BOUND = 0.3 * 8e4
UNIT = BOUND * np.array([1.0, 1.0, C])
SCALE = 8e4 * C**2 / BOUND * np.array([1.0, 1.0, C])
"""Scaled creepages over creepages."""


@pytest.fixture(scope="module")
def table():
    return ts.open_table("steel")


def scaled(table, w, **contact):
    """Scaled forces and their gradient at scaled creepages, shape (3, P)."""
    w = np.asarray(w, float).reshape(3, -1)
    forces = table(*(w / SCALE[:, None]), **CONTACT | contact)
    f = np.stack([forces.Qx, forces.Qy, forces.Mz]) / UNIT[:, None]
    gradient = forces.gradient / UNIT[:, None, None] / SCALE[:, None]
    return f, gradient, forces.error / UNIT[:, None]


def some(number=40, seed=1):
    return np.random.default_rng(seed).normal(size=(3, number)) * np.array([[0.4], [0.4], [1.0]])


def test_symmetries(table):
    w, mirror = some(), np.array([[1.0], [-1.0], [-1.0]])
    f, g, _ = scaled(table, w)
    mirrored, g_mirrored, _ = scaled(table, mirror * w)
    reversed_, g_reversed, _ = scaled(table, -w)
    # Only signs differ: equal numbers are looked up.
    np.testing.assert_array_equal(mirrored, mirror * f)
    np.testing.assert_array_equal(reversed_, -f)
    np.testing.assert_allclose(g_mirrored, mirror[:, None] * g * mirror[:, 0, None], atol=1e-15)
    np.testing.assert_allclose(g_reversed, g, atol=1e-15)


def test_small_creepages_are_linear_theory(table):
    k = creep_coefficients(1.5, 0.3)
    linear = -np.array([[k.C11, 0, 0], [0, k.C22, k.C23], [0, -k.C23, k.C33]])
    f, g, _ = scaled(table, 1e-4 * np.eye(3))
    # Kalker's numbers have three digits; the rest is what the table reports of itself.
    np.testing.assert_allclose(f, 1e-4 * linear, atol=0.04 * 1e-4 * np.abs(linear).max())
    np.testing.assert_allclose(g[:, :, 0], linear, atol=0.04 * np.abs(linear).max())


def test_infinite_creepages_are_full_slip(table):
    inf = math.inf
    f = table([inf, -inf, 0.0, 0.0], [0.0, 1.0, -inf, 0.0], [5.0, 0.0, 0.0, inf], **CONTACT)
    expected = -BOUND * np.array([[1.0, -1.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0]])
    # Closed forms at the nodes; along a/b a cubic is between them, of spin alone.
    np.testing.assert_allclose([f.Qx, f.Qy], expected, atol=1e-9 * BOUND)
    moment = full_slip_with_spin(1.5, (0.0, 0.0), 1.0)[2] * BOUND * C
    assert abs(f.Mz[3] - moment) <= f.error[2, 3] + 1e-3 * BOUND * C
    assert (f.gradient == 0.0).all()
    huge = table(1e6, 0.0, 0.0, **CONTACT)
    assert huge.Qx == pytest.approx(-BOUND, rel=1e-6)


def test_gradient_is_that_of_the_values(table):
    w, h = some(), 1e-6
    _, g, _ = scaled(table, w)
    for k in range(3):
        step = h * np.eye(3)[k][:, None]
        slope = (scaled(table, w + step)[0] - scaled(table, w - step)[0]) / (2 * h)
        # Rounding over the step; across the edges of cells second derivatives jump.
        np.testing.assert_allclose(g[:, k], slope, atol=1e-4)


@pytest.mark.parametrize("spin", [0.0, 0.7, -0.7])
def test_gradient_at_rest_and_of_spin_only(table, spin):
    """There headings do not count, but slopes by them do; -0 is no other place than 0."""
    h = 1e-5
    for zero in (0.0, -0.0):
        _, g, _ = scaled(table, [zero, zero, spin])
        for k in range(3):
            step = h * np.eye(3)[k] / SCALE[k] * SCALE[0]
            high, low = (scaled(table, [0.0, 0.0, spin] + sign * step)[0] for sign in (1.0, -1.0))
            slope = (high - low)[:, 0] / (2.0 * step[k])
            # At a pole slopes differ between headings by what cubics leave of their cosines.
            np.testing.assert_allclose(g[:, k, 0], slope, atol=5e-3 * np.abs(g).max())


def test_values_and_slopes_have_no_jumps(table):
    """Along a line through rest, mirror planes and cells."""
    t = np.linspace(-1.5, 1.5, 15_001)
    f, g, _ = scaled(table, np.stack([t, 0.3 - 0.2 * t, 0.5 * t]))
    step = t[1] - t[0]
    assert np.abs(np.diff(f, axis=1)).max() < 10.0 * step  # slopes are at most about 5
    # A slope that jumped would do so whatever the step; curvature is at most some hundreds.
    assert np.abs(np.diff(g, axis=2)).max() < 1e3 * step


@pytest.mark.slow
def test_points_anywhere_are_within_the_reported_error(table):
    """Against contacts solved on a finer mesh than any node."""
    random = np.random.default_rng(7)
    inside, (low, high) = 0, table.ellipticity
    for _ in range(12):
        ratio = math.exp(random.uniform(math.log(low), math.log(high)))
        w = random.normal(size=3) * np.array([0.4, 0.4, 1.0])
        expected = Contacts(unit_scene(ratio, 0.3)).forces(w, 33)
        given = {"a": math.sqrt(ratio), "b": 1.0 / math.sqrt(ratio), "load": 1.0, "mu": 1.0}
        found = table(*w, **given, shear=1.0)
        off = np.abs(np.array([found.Qx, found.Qy, found.Mz]) - expected)
        inside += bool((off <= found.error).all())
    assert inside >= 11  # 95 of 100 are to be


def test_scaling_is_that_of_solved_contacts():
    """A scene in newtons and millimetres, on the mesh of a table's contacts."""
    steel = {"young": 208e3, "poisson": 0.3}
    scene = ts.Scene(
        body={
            "A": steel | {"radius_x": 460.0, "radius_y": 300.0},
            "B": steel | {"radius_x": math.inf, "radius_y": math.inf},
        },
        load={"normal": 5e3},
        creepage={"longitudinal": -1e-3, "lateral": 7e-4, "spin": 5e-4},
        friction={"mu": 0.25},
    )
    hertz, bound = scene.hertz, 0.25 * 5e3
    c, shear = hertz.mean_semi_axis, scene.material.shear
    half = (hertz.a * 17 / 15, hertz.b * 17 / 15)
    contact = ts.solve(scene.replace(grid={"half_length": half, "elements": (17, 17)}))
    w = shear * c**2 / bound * np.array([-1e-3, 7e-4, 5e-4 * c])
    found = Contacts(unit_scene(hertz.a / hertz.b, 0.3)).forces(w, 15)
    expected = np.array([contact.Qx, contact.Qy, contact.Mz / c]) / bound
    np.testing.assert_allclose(found, expected, atol=1e-7)  # tolerance of the scenes


def test_shapes_and_scalars(table):
    f = table(np.zeros((2, 1)), 1e-3, np.zeros(3), **CONTACT)
    assert f.Qx.shape == (2, 3)
    assert f.error.shape == (3, 2, 3)
    assert f.gradient.shape == (3, 3, 2, 3)
    assert table(0.0, 0.0, 0.0, **CONTACT).Qx == 0.0


@pytest.mark.parametrize(
    ("changes", "named"),
    [
        ({"a": 100.0}, "a/b"),
        ({"b": 0.0}, "b"),
        ({"mu": -0.3}, "mu"),
        ({"load": math.nan}, "load"),
        ({"poisson": 0.2}, "poisson"),
        ({"xi_x": math.nan}, "creepages"),
        ({"xi_x": math.inf, "spin": math.inf}, "creepages"),
    ],
)
def test_points_outside_are_refused(table, changes, named):
    given = {"xi_x": 1e-3, "xi_y": 0.0, "spin": 0.0} | CONTACT | changes
    with pytest.raises(ValueError, match=named):
        table(**given)


def test_hermite_is_exact_for_cubics_in_two_dimensions():
    x, y = np.array([0.0, 0.3, 1.0]), np.array([-1.0, 0.5])

    def parts(x, y):
        f, g = x**3 - 2 * x, y**3 + y**2
        return np.stack([f * g, f * (3 * y**2 + 2 * y), (3 * x**2 - 2) * g,
                         (3 * x**2 - 2) * (3 * y**2 + 2 * y)], axis=-1)  # fmt: skip

    law = Hermite((x, y), parts(*np.meshgrid(x, y, indexing="ij"))[..., None])
    at = np.random.default_rng(0).uniform([[0.0], [-1.0]], [[1.0], [0.5]], (2, 50))
    value, by_y, by_x, _ = np.moveaxis(parts(*at), -1, 0)
    # Rounding of a few products.
    np.testing.assert_allclose(law(at)[0], value, atol=1e-13)
    np.testing.assert_allclose(law(at, by=0)[0], by_x, atol=1e-13)
    np.testing.assert_allclose(law(at, by=1)[0], by_y, atol=1e-13)


@pytest.mark.parametrize(
    "given",
    [
        {"ellipticity": []},
        {"ellipticity": [2.0, 1.0]},
        {"ellipticity": 50.0},
        {"poisson": 0.7},
        {"tolerance": 1e-6},
        {"elements": 31, "finest": 21},
        {"ellipticty": 1.0},
    ],
    ids=str,
)
def test_designs_that_are_none(given):
    with pytest.raises(ts.TableError, match=[*given][-1]):
        ts.TableDesign(**given)


def test_a_tolerance_that_takes_too_much_is_refused():
    with pytest.raises(ts.TableError, match="tolerance"):
        ts.build_table(ts.TableDesign(tolerance=1e-3, elements=15, finest=15))


def test_files_that_are_no_tables(tmp_path):
    for name, content in (("missing.nc", None), ("text.nc", b"no table"), ("empty.nc", b"")):
        path = tmp_path / name
        if content is not None:
            path.write_bytes(content)
        with pytest.raises(ts.ResultsError, match=name):
            ts.open_table(path)


def test_a_table_of_another_version(tmp_path):
    path = copy_without_seal(tmp_path / "other.nc")
    with h5py.File(path, "r+") as file:
        file.attrs["format"] = "creep-force table 1"
    with pytest.raises(ts.ResultsError, match="creep-force table 1"):
        ts.open_table(path)


def test_columns_of_text(table):
    lines = columns_of(table).splitlines()
    numbers = np.array([line.split() for line in lines if not line.startswith("#")], float)
    assert numbers.shape == (table.nodes, 12)
    assert lines[4].split()[1:] == ["a/b", "poisson", *COLUMNS]
    full = numbers[numbers[:, -1] == 1.0]
    assert (np.hypot(full[:, 5], full[:, 6]) <= 1.0 + 1e-9).all()


PROGRAM = """
#include <stdio.h>
#include "steel.h"
int main(void) {
    double p[9], force[3], gradient[9];
    while (scanf("%lf %lf %lf %lf %lf %lf %lf %lf %lf", p, p + 1, p + 2, p + 3, p + 4, p + 5, p + 6,
                 p + 7, p + 8) == 9) {
        int k, bad = steel(p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7], p[8], force, gradient);
        printf("%d", bad);
        for (k = 0; k < 3; k++) printf(" %.17g", bad ? 0.0 : force[k]);
        for (k = 0; k < 9; k++) printf(" %.17g", bad ? 0.0 : gradient[k]);
        printf("\\n");
    }
    return 0;
}
"""


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")
def test_c_sources_give_the_same_numbers(table, tmp_path):
    for file, text in c_sources(table, "steel").items():
        (tmp_path / file).write_text(text)
    (tmp_path / "main.c").write_text(PROGRAM)
    strict = ["-std=c99", "-O0", "-Wall", "-Wextra", "-Werror", "-pedantic"]
    command = ["cc", *strict, "main.c", "steel.c", "-o", "main", "-lm"]
    subprocess.run(command, cwd=tmp_path, check=True)
    random = np.random.default_rng(3)
    number, (low, high) = 200, table.ellipticity
    w = random.normal(size=(3, number)) * 10.0 ** random.uniform(-4, 2, number)
    w[:, 0], w[:, 1], w[:, 2] = 0.0, (math.inf, 1.0, 0.0), (0.0, 0.0, -math.inf)
    w[1:, 3], w[:2, 4] = 0.0, 0.0
    ratio = np.exp(random.uniform(np.log(low), np.log(high), number))
    contact = {"a": 3.0 * ratio, "b": 3.0 + 0.0 * ratio, "load": 1e4, "mu": 0.4, "shear": 8e4}
    xi = w * 1e-3
    f = table(*xi, **contact)
    given = np.stack(np.broadcast_arrays(*xi, *contact.values(), 0.3), axis=1)
    lines = [" ".join(map(repr, row)) for row in given.tolist()]
    lines += ["nan 0 0 1 1 1 1 1 .3", "0 0 0 1 1 -1 1 1 .3", "0 0 0 99 1 1 1 1 .3",
              "0 0 0 1 1 1 1 1 .2"]  # fmt: skip
    reported = subprocess.run(
        ["./main"], cwd=tmp_path, input="\n".join(lines), capture_output=True, text=True, check=True
    )
    found = np.array([line.split() for line in reported.stdout.splitlines()], float)
    assert found[:, 0].tolist() == [0] * number + [1, 2, 3, 4]
    found = found[:number, 1:]
    forces = np.stack([f.Qx, f.Qy, f.Mz], axis=1)
    # Equal products, rounded in another order.
    size = np.abs(forces).max(axis=0)
    np.testing.assert_allclose(found[:, :3] / size, forces / size, atol=1e-12)
    gradient = np.moveaxis(f.gradient, -1, 0).reshape(number, 9)
    size = np.abs(gradient).max(axis=0)
    np.testing.assert_allclose(found[:, 3:] / size, gradient / size, atol=1e-12)


@pytest.mark.slow
def test_command(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run = CliRunner().invoke
    assert run(app, ["table", "steel", "--header", "s.h", "--text", "s.txt"]).exit_code == 0
    assert (tmp_path / "s.h").exists()
    assert (tmp_path / "s.c").exists()
    assert (tmp_path / "s.txt").exists()
    (tmp_path / "bad.toml").write_text("tolerance = -1\n")
    for command in (
        ["table", "steel"],
        ["table", "bad.toml", "-o", "bad.nc"],
        ["table", "missing.toml", "-o", "bad.nc"],
        ["table", "bad.toml"],
        ["table", "missing.nc", "--text", "s.txt"],
        ["table", "steel", "--header", "1.h"],
    ):
        assert run(app, command).exit_code == 2, command
    assert not (tmp_path / "bad.nc").exists()


def test_a_table_and_its_design_are_reported(tmp_path):
    run, file = CliRunner().invoke, str(builtin_tables()["steel"])
    for command in (["show", "steel"], ["show", file], ["explain", file]):
        reported = run(app, command)
        assert reported.exit_code == 0
        assert "Steel on steel" in reported.stdout
        assert "a=..., b=..., load=..., mu=..., shear=...)" in reported.stdout
    reported = json.loads(run(app, ["show", "steel", "--json"]).stdout)
    assert math.prod(map(len, reported["axes"].values())) == reported["nodes"]
    (tmp_path / "trams.toml").write_text("ellipticity = [0.5, 2.0]\n")
    assert "from 0.5 to 2" in run(app, ["explain", str(tmp_path / "trams.toml")]).stdout
    (tmp_path / "either.toml").write_text(
        'scene = "spheres-orthotropic"\n[[axis]]\nkey = "friction.angle"\nvalues = [0, 45]'
    )
    either = run(app, ["explain", str(tmp_path / "either.toml")])
    assert "tolerance" in either.stderr
    for command in (
        ["show", "steel", "--csv"],
        ["explain", "steel", "--set", "a=1"],
    ):
        assert run(app, command).exit_code == 2, command


@pytest.mark.parametrize(
    ("text", "answer"),
    [
        ("tolerance = 0.1", True),
        ('[[axis]]\nkey = "friction.mu"\nname = "mu2"', True),
        ('[[axis]]\nkey = "friction.mu"', False),  # a study, or a table: not to be reported
        ("axis = 5", False),
        ("[load]\nnormal = 1.0", False),
    ],
)
def test_designs_are_known_by_what_they_only_have(tmp_path, text, answer):
    (tmp_path / "file.toml").write_text(text)
    assert is_design(tmp_path / "file.toml") is answer


def test_is_no_design(tmp_path):
    assert not is_design(tmp_path / "missing.toml")
    assert not is_design("twin-discs")
