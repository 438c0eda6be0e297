"""Tables with further axes and without symmetries: read, and written as C and as FMUs."""

import math
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest

from tractive_sam.lookup import CreepTable, Hermite, c_sources, columns_of
from tractive_sam.plot import table_errors
from tractive_sam.store import ResultsError
from tractive_sam.tables import open_table, write_fmu

needs_cc = pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")
CONTACT = {"a": 2.0, "b": 1.0, "load": 1e4, "mu": 0.4, "shear": 8e4}


def made_up(names, axes, seed=0, **given):
    """A table of random numbers: what is read of it, is read of any."""
    random = np.random.default_rng(seed)
    axes = (*map(np.array, axes), np.linspace(-math.pi, math.pi, 5),
            np.linspace(-math.pi / 2, math.pi / 2, 3), np.array([0.0, 0.3, 1.0]))  # fmt: skip
    shape = tuple(map(len, axes))
    numbers = random.normal(size=(*shape, 2 ** len(axes), 3))
    for k, nodes in enumerate(axes):  # an axis of one node has no derivatives
        if len(nodes) == 1:
            by = [d for d in range(2 ** len(axes)) if d >> (len(axes) - 1 - k) & 1]
            numbers[..., by, :] = 0.0
    bars = np.abs(random.normal(size=(*shape, 3)))
    between = tuple(np.abs(random.normal(size=(n - 1, 3))) for n in shape)
    return CreepTable(Hermite(axes, numbers), names, bars, between, {"tolerance": 0.01}, **given)


def of_any():
    axes = [[-0.5, 0.2, 0.9], [0.3], [0.0, 1.0, 3.0]]
    return made_up(("log_ratio", "poisson", "angle"), axes, whole=True)


def make_quarter():
    """The built-in table: with symmetries, and a single value of Poisson's ratio."""
    return open_table("steel")


def of_a_scene():
    axes = [[0.0, 1e3, 2e3], [1.0, 2.0]]
    return made_up(("worn", "K"), axes, whole=True, apart=("worn",), contact=CONTACT)


CASES = {"any": (of_any, CONTACT | {"poisson": 0.3, "angle": 2.2}),
         "scene": (of_a_scene, {"worn": 1e3, "K": 1.3})}  # fmt: skip


@pytest.mark.parametrize("kind", CASES)
def test_values_follow_slopes_anywhere(kind):
    """Signs and headings of a full table: the gradient follows from the values."""
    make, given = CASES[kind]
    table, h = make(), 1e-7
    xi = np.random.default_rng(1).normal(size=(3, 30)) * 2e-3
    f = table(*xi, **given)
    for k in range(3):
        step = h * np.eye(3)[k][:, None]
        high, low = (table(*(xi + sign * step), **given) for sign in (1.0, -1.0))
        for one, name in enumerate(("Qx", "Qy", "Mz")):
            slope = (getattr(high, name) - getattr(low, name)) / (2.0 * h)
            # Random numbers bend sharply: what is left is of second order in the step.
            size = np.abs(f.gradient[one, k]).max()
            np.testing.assert_allclose(f.gradient[one, k], slope, atol=1e-3 * size)


@pytest.mark.parametrize(
    ("kind", "changes", "named"),
    [
        ("any", {"angle": None}, "angle: missing"),
        ("any", {"angle": 4.0}, "angle: 4; allowed: 0 to 3"),
        ("any", {"angel": 1.0}, "angel: no axis"),
        ("any", {"load": None}, "load: missing"),
        ("scene", {"load": 1e4}, "load: fixed by the scene"),
        ("scene", {"worn": 500.0}, "worn: .* 0, 1000, 2000"),
        ("scene", {"worn": math.nan}, "worn: .* 0"),
    ],
)
def test_what_is_not_in_a_table_is_refused(kind, changes, named):
    make, given = CASES[kind]
    with pytest.raises(ValueError, match=named):
        make()(1e-3, 0.0, 0.0, **given | changes)


@pytest.mark.parametrize("kind", CASES)
def test_tables_are_read_as_they_are_written(kind, tmp_path):
    writing = pytest.importorskip("tractive_sam.tables.table_file", reason="xarray is of an extra")
    make, given = CASES[kind]
    table = make()
    writing.write_table(table, tmp_path / "table.nc")
    again = open_table(tmp_path / "table.nc")
    assert (again.names, again.apart, again.whole) == (table.names, table.apart, table.whole)
    assert again.contact == table.contact
    one, other = (t(1e-3, -2e-3, 1e-3, **given) for t in (table, again))
    # Derivatives in a file are rounded by 1e-6, and a force is the sum of some of them.
    assert (one.Qx, one.Mz) == pytest.approx((other.Qx, other.Mz), rel=1e-5)
    np.testing.assert_allclose(one.error, other.error, rtol=1e-6)


def test_a_whole_table_as_text():
    lines = [line for line in columns_of(of_a_scene()).splitlines() if line[0] != "#"]
    assert len(lines) == of_a_scene().nodes
    assert lines[0].split()[:2] == ["0", "1"]


def test_errors_are_plotted():
    random = np.random.default_rng(2)
    checks = {name: np.abs(random.normal(size=(40, 3))) for name in ("check_errors", "check_told")}
    table = of_any()
    table.about.update(checks | {"held_out_inside": 0.97})
    assert table_errors(table).axes
    with pytest.raises(ValueError, match="points"):
        table_errors(of_a_scene())


PROGRAM = """
#include <stdio.h>
#include "law.h"
int main(void) {
    double p[@COUNT@], force[3], gradient[9];
    for (;;) {
        int k, bad;
        for (k = 0; k < @COUNT@; k++) if (scanf("%lf", p + k) != 1) return 0;
        bad = law(@GIVEN@, force, gradient);
        printf("%d", bad);
        for (k = 0; k < 3; k++) printf(" %.17g", bad ? 0.0 : force[k]);
        for (k = 0; k < 9; k++) printf(" %.17g", bad ? 0.0 : gradient[k]);
        printf("\\n");
    }
}
"""


def points(given, number=50):
    """Creepages of all signs and sizes, full slip too, and what else is given."""
    random = np.random.default_rng(4)
    xi = random.normal(size=(3, number)) * 10.0 ** random.uniform(-5, 0, number)
    xi[:, 0], xi[:, 1], xi[:, 2] = 0.0, (math.inf, 1.0, 0.0), (0.0, 0.0, -math.inf)
    return xi, np.stack(np.broadcast_arrays(*xi, *given.values()), axis=1)


def assert_equal(found, expected):
    # Equal products, rounded in another order.
    size = np.abs(expected).max(axis=0)
    np.testing.assert_allclose(found / size, expected / size, atol=1e-12)


@pytest.mark.parametrize("kind", CASES)
def test_a_single_point_is_that_of_an_array(kind):
    """Without arrays, forces, gradient and error bars agree with results for arrays."""
    make, given = CASES[kind]
    table, (xi, _) = make(), points(given)
    many = table(*xi, **given)
    size = np.abs(all_of(many)).max(axis=0)
    for k, one in enumerate(xi.T.tolist()):
        single = table(*one, **given)
        found = np.array([single.Qx, single.Qy, single.Mz, *single.gradient.ravel()])
        np.testing.assert_allclose(found / size, all_of(many)[k] / size, atol=1e-12)
        np.testing.assert_array_equal(single.error, many.error[:, k])
    plain = make_quarter()
    given = CONTACT | {"a": 1.0}
    many = plain(*xi, **given)
    for k, one in enumerate(xi.T.tolist()):
        single = plain(*one, **given)
        scale = np.abs(many.gradient).max()
        np.testing.assert_allclose(single.gradient, many.gradient[..., k], atol=1e-12 * scale)


@pytest.mark.parametrize("kind", CASES)
def test_separated_bodies_have_no_forces_and_no_gradient(kind):
    """Also within arrays, with the semi-axes 0 of a contact without load."""
    make, given = CASES[kind]
    table = make()
    if kind == "scene":
        pytest.skip("its load is that of the scene")
    loads = np.array([0.0, 1e4, 0.0])
    axes = {name: np.where(loads > 0.0, given[name], 0.0) for name in "ab"}
    f = table(1e-3, [0.0, 1e-3, np.inf], 0.0, **given | axes | {"load": loads})
    single = table(1e-3, 1e-3, 0.0, **given)
    for values in (f.Qx, f.Qy, f.Mz, *f.gradient.reshape(9, 3), *f.error):
        assert values[[0, 2]].tolist() == [0.0, 0.0]
    assert f.Qx[1] == pytest.approx(single.Qx, rel=1e-12)
    np.testing.assert_allclose(f.gradient[..., 1], single.gradient, rtol=1e-12)
    none = table(1e-3, 0.0, 0.0, **given | {"load": 0.0})
    assert (none.Qx, none.gradient.any()) == (0.0, False)
    with pytest.raises(ValueError, match="load"):
        table(1e-3, 0.0, 0.0, **given | {"load": -1.0})


def all_of(forces):
    gradient = np.moveaxis(forces.gradient, -1, 0).reshape(-1, 9)
    return np.concatenate([np.stack([forces.Qx, forces.Qy, forces.Mz], axis=1), gradient], axis=1)


@needs_cc
@pytest.mark.parametrize("kind", CASES)
def test_c_sources(kind, tmp_path):
    make, given = CASES[kind]
    table, (xi, rows) = make(), points(given)
    count = rows.shape[1]
    text = PROGRAM.replace("@COUNT@", str(count))
    text = text.replace("@GIVEN@", ", ".join(f"p[{k}]" for k in range(count)))
    for file, source in c_sources(table, "law").items():
        (tmp_path / file).write_text(source)
    (tmp_path / "main.c").write_text(text)
    strict = ["-std=c99", "-O1", "-Wall", "-Wextra", "-Werror", "-pedantic"]
    subprocess.run(
        ["cc", *strict, "main.c", "law.c", "-o", "main", "-lm"], cwd=tmp_path, check=True
    )
    outside = rows[-1].copy()
    outside[-1] = 99.0
    lines = "\n".join(" ".join(map(repr, row)) for row in [*rows.tolist(), outside.tolist()])
    reported = subprocess.run(
        ["./main"], cwd=tmp_path, input=lines, capture_output=True, text=True, check=True
    )
    found = np.array([line.split() for line in reported.stdout.splitlines()], float)
    assert found[:, 0].tolist() == [0] * len(rows) + [4]
    assert_equal(found[:-1, 1:], all_of(table(*xi, **given)))


@pytest.mark.slow
@needs_cc
@pytest.mark.parametrize("interface", ["CoSimulation", "ModelExchange"])
@pytest.mark.parametrize("kind", CASES)
@pytest.mark.parametrize("fmi", [2, 3])
def test_fmu(fmi, kind, interface, tmp_path):
    """Simulated over a course of all inputs: the outputs are what Python finds of the inputs."""
    fmpy = pytest.importorskip("fmpy", reason="it is of the extra fmu")
    make, given = CASES[kind]
    table, (xi, _) = make(), points(given)
    assert write_fmu(table, tmp_path / "law.fmu", fmi)
    unit = fmpy.read_model_description(tmp_path / "law.fmu")
    assert unit.fmiVersion == f"{fmi}.0"
    names = [one.name for one in unit.modelVariables if one.causality == "input"]
    fixed = {
        one.name: float(one.start) for one in unit.modelVariables if one.variability == "fixed"
    }
    assert fixed == ({"poisson": 0.3} if kind == "any" else {})
    if "load" in given:  # the bodies separate in the middle
        given = given | {"load": np.where(np.arange(len(xi[0])) == 25, 0.0, given["load"])}
    outputs = [one.name for one in unit.modelVariables if one.causality == "output"]
    signals = np.zeros(len(xi[0]), [("time", float), *((name, float) for name in names)])
    values = dict(zip(("xi_x", "xi_y", "spin"), np.nan_to_num(xi, posinf=1.0, neginf=-1.0),
                      strict=True)) | given  # fmt: skip
    signals["time"] = np.arange(len(signals))
    for name in names:
        signals[name] = values[name]
    found = fmpy.simulate_fmu(
        str(tmp_path / "law.fmu"), fmi_type=interface, input=signals, output=[*names, *outputs],
        stop_time=len(signals) - 1.0, output_interval=1.0, step_size=1.0,
    )  # fmt: skip
    assert len(found) >= len(signals)
    forces = table(**{name: found[name] for name in names} | fixed)
    assert_equal(np.stack([found[name] for name in outputs], axis=1), all_of(forces))


@pytest.mark.slow
@needs_cc
@pytest.mark.parametrize("fmi", [2, 3])
def test_variables_of_fmus_have_units_and_limits(fmi, tmp_path):
    fmpy = pytest.importorskip("fmpy", reason="it is of the extra fmu")
    write_fmu(of_any(), tmp_path / "law.fmu", fmi)
    unit = fmpy.read_model_description(tmp_path / "law.fmu")
    known = {one.name for one in unit.unitDefinitions}
    for variable in unit.modelVariables:
        if variable.name == "time":
            continue
        assert (variable.unit or variable.declaredType) in known
        assert float(variable.min) <= float(variable.start or variable.min) <= float(variable.max)
    units = {one.name: one.unit for one in unit.modelVariables}
    assert (units["Qx_by_spin"], units["Mz_by_xi_x"], units["Mz_by_spin"]) == (
        "N.mm", "N.mm", "N.mm2",
    )  # fmt: skip


@pytest.mark.slow
@needs_cc
@pytest.mark.parametrize("fmi", [2, 3])
def test_directional_derivatives_of_fmus(fmi, tmp_path):
    """By every input: differences of the table in Python."""
    fmpy = pytest.importorskip("fmpy", reason="it is of the extra fmu")
    table, given = of_any(), CASES["any"][1] | {"xi_x": 2e-4, "xi_y": -1e-4, "spin": 5e-5}
    write_fmu(table, tmp_path / "law.fmu", fmi)
    description = fmpy.read_model_description(tmp_path / "law.fmu")
    unit = fmpy.instantiate_fmu(
        fmpy.extract(str(tmp_path / "law.fmu")), description, fmi_type="CoSimulation"
    )
    place = {one.name: one.valueReference for one in description.modelVariables}
    get = unit.getReal if fmi == 2 else unit.getFloat64
    write = unit.setReal if fmi == 2 else unit.setFloat64
    unit.enterInitializationMode()
    write([place[name] for name in given], [float(value) for value in given.values()])
    unit.exitInitializationMode()
    forces = ("Qx", "Qy", "Mz")
    of = [place[name] for name in forces]
    size = np.abs(get(of)).max()
    for name, value in given.items():
        if name == "poisson":
            continue
        slopes = unit.getDirectionalDerivative(of, [place[name]], [1.0])
        step = 1e-6 * abs(value)
        high, low = (table(**given | {name: value + sign * step}) for sign in (1.0, -1.0))
        for slope, force in zip(slopes, forces, strict=True):
            expected = (getattr(high, force) - getattr(low, force)) / (2.0 * step)
            # Differences of second order in a step of 1e-6, and of rounding.
            assert slope == pytest.approx(expected, abs=1e-6 * size / abs(value), rel=1e-6)
    unit.freeInstance()


@pytest.mark.slow
@needs_cc
def test_fmus_refuse(tmp_path, monkeypatch):
    fmpy = pytest.importorskip("fmpy", reason="it is of the extra fmu")
    with pytest.raises(ValueError, match="'1'"):
        write_fmu(of_any(), tmp_path / "1.fmu")
    with pytest.raises(ValueError, match="2 or 3"):
        write_fmu(of_any(), tmp_path / "law.fmu", 4)
    write_fmu(of_any(), tmp_path / "law.fmu")
    reported = []
    with pytest.raises(fmpy.fmi1.FMICallException):
        fmpy.simulate_fmu(
            str(tmp_path / "law.fmu"), fmi_type="CoSimulation",
            start_values={"angle": 50.0}, logger=lambda *said: reported.append(said),
        )  # fmt: skip
    assert any(b"outside the table" in part for said in reported for part in said
               if isinstance(part, bytes))  # fmt: skip
    monkeypatch.setenv("CC", "no-such-compiler")
    assert not write_fmu(of_any(), tmp_path / "sources.fmu")
    assert fmpy.supported_platforms(str(tmp_path / "sources.fmu")) == ["c-code"]


def test_a_name_of_no_file(tmp_path):
    with pytest.raises(ResultsError):
        open_table(tmp_path / "none.nc")


def test_headers_report_error_bars_of_gradients():
    """At rest, or that there are none."""
    table = of_any()
    assert "gradients are not known" in c_sources(table)["creep_forces.h"]
    bars = np.full((3, 3, 3), 0.5)
    bars[0] = np.array([1e-3, 2e-3, 4e-3])[:, None]
    known = c_sources(replace(table, gradient_bars=bars))
    assert "1.0e-03, 2.0e-03, 4.0e-03 of Qx, Qy, Mz" in known["creep_forces.h"]


@pytest.mark.parametrize(
    "bars", [np.zeros((2, 3, 3)), -np.ones((3, 3, 3)), np.full((3, 3, 3), np.nan)]
)
def test_error_bars_of_gradients_that_are_none(bars):
    with pytest.raises(ValueError, match="gradient_bar"):
        replace(of_any(), gradient_bars=bars)
