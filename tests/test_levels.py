"""Levels of the model: each error is the one that the refined contact shows."""

import math

import pytest
from typer.testing import CliRunner

import tractive_sam as ts
from tractive_sam.cli import app

STEEL = {"young": 208e3, "poisson": 0.3, "radius_x": 50.0, "radius_y": 50.0}
CIRCLE = ts.Scene(
    body={"A": STEEL, "B": STEEL},
    load={"pressure": 1200.0},
    creepage={"longitudinal": -2e-3},
    friction={"mu": 0.3},
)
CARTER = "closed form (Hertz, Carter)"
LINEAR = "closed form (Hertz, linear theory with a limit)"
TABLE = "table look-up (steel)"


@pytest.fixture(scope="module")
def circle():
    return ts.compare_levels(CIRCLE, tolerance=2e-3)


def by_name(levels):
    return {level.name: level for level in levels.levels}


def test_the_cheapest_level_follows_from_the_error(circle):
    # The limit of Vermeulen and Johnson misses the force by 2.2 %, the table by less than .1 %.
    assert circle.find_cheapest(0.05).name in (LINEAR, TABLE)  # they take about the same time
    assert circle.find_cheapest(0.015).name == TABLE
    assert circle.find_cheapest(1e-5) is None


def test_levels_are_listed_by_their_cost_and_those_that_do_not_apply_last(circle):
    times = [level.seconds for level in circle.levels if not level.missing]
    assert times == sorted(times)
    assert circle.levels[-1].name == CARTER
    assert circle.levels[-1].error == math.inf
    assert "line contact" in circle.levels[-1].missing


def test_the_pressure_of_hertz_is_that_of_the_refined_contact(circle):
    # The reference and Hertz's pressure differ by the discretisation of the reference alone.
    assert by_name(circle)[LINEAR].pressure < circle.uncertainty


def test_errors_of_meshes_fall(circle):
    errors = [level.error for level in circle.levels if level.name.startswith("mesh")]
    assert len(errors) >= 3
    assert errors[-1] < errors[0] < 0.01


def test_carter_is_exact_for_cylinders():
    levels = ts.compare_levels(ts.Scene.builtin("cylinders"), tolerance=2e-3)
    assert by_name(levels)[CARTER].error < levels.uncertainty
    assert by_name(levels)[TABLE].missing


def test_the_error_shows_what_a_theory_leaves_out():
    """Coupling of unlike bodies changes the force by more than itself near free rolling."""
    aluminium = {"body.A.young": 70e3, "body.A.poisson": 0.33}
    levels = ts.compare_levels(CIRCLE.replace(**aluminium), tolerance=5e-3)
    assert by_name(levels)[LINEAR].force > 0.5
    assert levels.find_cheapest(0.02).name.startswith("mesh")


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"friction": {"mu": (0.4, 0.2)}}, "friction"),
        ({"creepage": {}, "load.force_x": 100.0}, "creepages"),
    ],
)
def test_theories_that_do_not_apply_say_why(changes, reason):
    levels = ts.compare_levels(CIRCLE.replace(**changes), tolerance=5e-3)
    assert all(reason in by_name(levels)[name].missing for name in (CARTER, LINEAR, TABLE))
    assert levels.find_cheapest(0.02).name.startswith("mesh")


@pytest.mark.parametrize(
    ("scene", "key"),
    [("fretting", "transient"), ("wheel-rail", "wheelset"), ("wheel-wear", "duty")],
)
def test_scenes_of_several_contacts_are_refused(scene, key):
    with pytest.raises(ts.SceneError) as caught:
        ts.compare_levels(ts.Scene.builtin(scene))
    assert key in [fault.key for fault in caught.value.faults]


def test_the_command_names_the_cheapest_level(tmp_path):
    file = tmp_path / "circle.toml"
    file.write_text(CIRCLE.to_toml())
    result = CliRunner().invoke(app, ["explain", str(file), "--error", "0.015"])
    assert result.exit_code == 0, result.output
    (answer,) = (line for line in result.stdout.splitlines() if "enough for 1.5 %" in line)
    assert answer.split("%")[1].strip() == TABLE
    refused = CliRunner().invoke(app, ["explain", "steel", "--error", "0.03"])
    assert refused.exit_code == 2
    assert "--error" in refused.output


def test_figure_and_table(circle):
    (axes,) = circle.draw().axes
    assert len(axes.lines) == 5  # four levels that apply, and the meshes
    assert LINEAR in repr(circle)
    assert "<table>" in circle._repr_html_()


def test_profiles_are_part_of_every_level():
    """The pressure of a crowned roller, whose profile is no radius, is the same on every mesh."""
    crown = {"form": "crowned", "radius": 500.0}
    entries = {
        "body.A.radius_y": math.inf,
        "body.B.radius_y": math.inf,
        "body.A.width": 10.0,
        "body.A.profile": crown,
        "load": {"normal": 2000.0},
    }
    levels = ts.compare_levels(CIRCLE.replace(**entries), tolerance=5e-3)
    meshes = [level for level in levels.levels if level.name.startswith("mesh")]
    assert max(level.error for level in meshes) < 0.02
    assert all(level.missing for level in levels.levels if level not in meshes)
