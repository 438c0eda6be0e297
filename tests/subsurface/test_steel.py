"""Residual stress and strength over the depth change what they should, and nothing else."""

from dataclasses import replace

import numpy as np
import pytest

import tractive_sam as ts
from tests.plot.rendering import render
from tests.scenes import interrupted
from tractive_sam import plot
from tractive_sam.mechanics import (
    Crossland,
    DangVan,
    FatemiSocie,
    Findley,
    RollingMarch,
    hertz,
    hertz_line,
    limit_from_bending,
    strength_from_hardness,
)
from tractive_sam.reference import circle_pressure_stress
from tractive_sam.subsurface import stress_layers

K, INF = 300.0, float("inf")
STEEL = {"young": 208e3, "poisson": 0.3}
EXACT = -0.133975, -0.213397
"""rho_xx, rho_yy over p0 at p0/k = 4, with which a line contact yields nowhere (Johnson 1962)."""


def line(ratio, **tables):
    """A frictionless line contact under a peak pressure of `ratio` times k."""
    a = hertz_line(208e3 / 2 / 0.91, 10.0, pressure=ratio * K).a
    cylinder = STEEL | {"radius_x": 20.0, "radius_y": INF}
    grid = {"half_length": [1.3 * a], "elements": [121]}
    tables = {"fatigue": {"shear_yield": K, "bodies": ["A"], "elements": 40}} | tables
    load = {"pressure": ratio * K}
    return ts.Scene(body={"A": cylinder, "B": cylinder}, load=load, grid=grid, **tables)


def balls(**changes):
    """A small point contact with friction."""
    tables = {"friction": {"mu": 0.2}, "creepage": {"longitudinal": 1e-3}} | changes
    ball = STEEL | {"radius_x": 20.0, "radius_y": 20.0}
    a = hertz(208e3 / 2 / 0.91, 10.0, 10.0, load=300.0).a
    grid = {"half_length": [1.2 * a, 1.2 * a], "elements": [21, 21]}
    return ts.Scene(
        body={"A": ball, "B": ball},
        load={"normal": 300.0},
        grid=grid,
        **tables,
    )


def uniform(xx, yy):
    return {"A": {"depth": [0.0], "xx": [xx], "yy": [yy]}}


def test_the_exact_pair_raises_first_yield_to_the_shakedown_limit():
    planes = {"planes": ["y=0"], "bodies": ["A"]}
    bare = ts.roll(line(3.107, subsurface=planes))
    # 241 points across the contact at the accuracy of the published ratio, 3.107.
    assert bare["von_mises_max"][-1, 0] == pytest.approx(3**0.5 * K, rel=3e-4)
    scene = line(4.0, subsurface=planes)
    with_pair = ts.roll(scene.replace(residual=uniform(*(4.0 * K * rho for rho in EXACT))))
    assert with_pair["von_mises_max"][-1, 0] == pytest.approx(3**0.5 * K, rel=3e-4)
    assert with_pair["yield_factor"][-1, 0] == pytest.approx(1.0, rel=3e-4)
    # Melan and Koiter: any residual stress is one of those that shakedown may find.
    without = ts.roll(scene)
    for bound in ("shakedown_lower", "shakedown_upper"):
        assert with_pair[bound][-1, 0] == pytest.approx(without[bound][-1, 0], rel=1e-12)
        assert with_pair[bound][-1, 0] == pytest.approx(1.0, rel=3e-4)


def test_first_yield_is_a_root_of_the_yield_condition():
    """At the load factor of first yield the largest von Mises stress is the yield strength."""
    rho = -80.0, 50.0
    factor = ts.roll(line(3.0, residual=uniform(*rho)))["yield_factor"][-1, 0]
    contact = ts.solve(line(3.0 * factor))
    depths = np.linspace(0.4, 1.0, 61) * contact.scene.hertz.a
    largest = 0.0
    for _, (stress,) in stress_layers(contact, depths):
        stress[0] += rho[0]
        stress[1] += rho[1]
        largest = max(largest, float(ts.reference.von_mises(stress).max()))
    # Depths every hundredth of a, near the parabola's top.
    assert largest == pytest.approx(3**0.5 * K, rel=5e-4)


TABLE = {
    3.5: [(-0.0416, -0.0469), (-0.0581, -0.0592), (-0.0654, -0.0599), (-0.0642, -0.0535),
          (-0.0435, -0.0314)],
    4.0: [(-0.1339, -0.2132), (-0.1275, -0.1873), (-0.1238, -0.1601), (-0.1208, -0.1345),
          (-0.1075, -0.0933)],
}  # fmt: skip
"""rho_xx/p0, rho_yy/p0 at depths .5, .6, .7, .8, 1.0 a of an independent march."""


@pytest.mark.parametrize("ratio", TABLE)
def test_the_march_agrees_with_an_independent_one(ratio):
    contact = hertz_line(114e3, 10.0, pressure=ratio * K)
    depths = np.array([0.5, 0.6, 0.7, 0.8, 1.0]) * contact.a
    found = RollingMarch(contact, 0.3).residual(depths, K) / contact.p0
    # Both have an error of 2e-4 by their steps, and the table is rounded.
    assert pytest.approx(np.array(TABLE[ratio]), abs=5e-4) == found.T


def test_the_march_leaves_no_stress_in_elastic_material_and_is_proportional():
    contact = hertz_line(114e3, 10.0, pressure=3.0 * K)  # below 3.107
    depths = np.linspace(0.1, 2.0, 8) * contact.a
    assert not RollingMarch(contact, 0.3).residual(depths, K).any()
    first = RollingMarch(replace(contact, p0=4.0 * K), 0.3).residual(depths, K)
    second = RollingMarch(replace(contact, p0=8.0 * K), 0.3).residual(depths, 2.0 * K)
    assert second == pytest.approx(2.0 * first, rel=1e-9)  # rounding


def test_the_path_below_an_ellipse_is_that_of_a_circle():
    circle = hertz(114e3, 10.0, 10.0, pressure=1000.0)
    march = RollingMarch(circle, 0.3, points=401)
    depths = np.array([0.3, 0.5, 1.0, 2.0]) * circle.a
    along = np.sinh(4.0 * np.linspace(1.0, -1.0, 401)) / np.sinh(4.0)
    x = march.reach * np.maximum(circle.a, depths)[:, None] * along
    exact = circle_pressure_stress(x, 0.0, depths[:, None], circle.a, 1000.0, 0.3)
    found = march.paths(depths).swapaxes(0, 1)
    # Linear between every second point, and Gauss' rule at .3 a.
    assert np.abs(found - exact).max() < 2e-3 * 1000.0


def test_rolled_stress_holds_the_contact_elastic():
    """At p0/k = 4 rolling leaves just what shakedown needs."""
    scene = line(4.0, residual={"A": {"from": "rolling"}}, subsurface={"planes": ["y=0"]})
    history = ts.roll(scene)
    # The march is coarser by its steps and by 61 depths, linear between them.
    assert history["von_mises_max"][-1, 0] == pytest.approx(3**0.5 * K, rel=2e-3)
    assert history["von_mises_max"][-1, 1] == pytest.approx(4.0 / 3.107 * 3**0.5 * K, rel=1e-3)


LIMIT = {"sensitivity": 0.3, "limit": 250.0, "bodies": ["A"], "elements": 16}


@pytest.mark.parametrize(
    ("criterion", "change"),
    [("dang-van", 0.3 * 2.0 / 3.0), ("crossland", 0.3 * 2.0 / 3.0), ("orthogonal-shear", 0.0)],
)
def test_equal_biaxial_stress_moves_criteria_by_their_hydrostatic_part(criterion, change):
    """Of xx = yy = rho: sigma_h = 2 rho/3, and a constant deviator moves no ball's radius."""
    rho = 60.0
    table = LIMIT | {"criterion": criterion, "limit": 1.0}
    table |= {"sensitivity": None if criterion == "orthogonal-shear" else 0.3}
    contact = ts.solve(balls(fatigue=table))
    bare = ts.fatigue(contact)["A"].utilisation
    loaded = replace(contact, scene=contact.scene.replace(residual=uniform(rho, rho)))
    shifted = ts.fatigue(loaded)["A"].utilisation
    where = bare > 0.0  # utilisation is at least zero
    assert where.any()
    # The search of the ball ends at 1e-14 of its square.
    assert (shifted - bare)[where] == pytest.approx(change * rho, abs=1e-5 * bare.max())


def test_findley_and_fatemi_socie_are_those_of_the_sum():
    cycle = np.random.default_rng(1).normal(size=(6, 7, 3)) * 100.0
    steel = {"A": {"depth": [0.0, 1.0], "xx": [50.0, 50.0], "yy": [-20.0, -20.0]}}
    for criterion in ("findley", "fatemi-socie"):
        table = LIMIT | {"criterion": criterion, "yield_strength": 500.0}
        scene = balls(fatigue=table, residual=steel)
        local = ts.subsurface.LocalSteel.from_contact(
            ts.solve(scene), "A", np.array([0.0, 0.1]), np.zeros(3)
        )
        law = ts.Laws.of(scene).fatigue
        total = cycle.copy()
        total[0] += 50.0
        total[1] -= 20.0
        found, _ = local.at_depth(1).evaluate(law, cycle)
        assert found == pytest.approx(law(total), rel=1e-12)  # the same sums


def test_a_yield_strength_over_the_depth_is_that_of_the_criterion():
    cycle = np.random.default_rng(2).normal(size=(6, 7, 2)) * 100.0
    table = LIMIT | {"criterion": "fatemi-socie", "yield_strength": 600.0}
    table["A"] = {"depth": [0.0, 1.0], "shear_yield": [200.0, 400.0]}
    scene = balls(fatigue=table)
    local = ts.subsurface.LocalSteel.from_contact(
        ts.solve(scene), "A", np.array([0.0, 0.5]), np.zeros(2)
    )
    found, _ = local.at_depth(1).evaluate(ts.Laws.of(scene).fatigue, cycle)
    # The search of planes ends at 1e-4 of the value.
    assert found == pytest.approx(FatemiSocie(0.3, 3**0.5 * 300.0)(cycle), rel=2e-4)


@pytest.mark.parametrize(
    "law", [DangVan(0.3), Crossland(0.5), Findley(0.4), FatemiSocie(0.7, 900.0)]
)
def test_the_limit_of_a_criterion_is_its_value_in_bending(law):
    bending = np.zeros((6, 3))
    bending[0] = 420.0, -420.0, 0.0
    expected = float(law(bending))
    yield_strength = getattr(law, "yield_strength", np.nan)
    found = limit_from_bending(law.name, law.sensitivity, [420.0], [yield_strength])
    # The kernel of the planes ends at 1e-4.
    assert found[0] == pytest.approx(expected, rel=1e-4 if hasattr(law, "yield_strength") else 1e-5)


def test_only_large_inclusions_lower_the_limit():
    assert strength_from_hardness([200.0], 10.0)[1][0] == pytest.approx(320.0)
    assert strength_from_hardness([700.0], 30.0)[1][0] == pytest.approx(
        1.56 * 820.0 / 30.0 ** (1 / 6)
    )
    large, small = (strength_from_hardness([700.0], size)[1][0] for size in (60.0, 30.0))
    assert large < small < 1.6 * 700.0


def test_hardness_in_proportion_scales_shakedown_and_utilisation():
    """Twice the limit and twice k everywhere halve one and double the other."""
    depth = [0.0, 0.1, 0.4]
    one = LIMIT | {"A": {"depth": depth, "limit": [250.0] * 3, "shear_yield": [300.0] * 3}}
    two = LIMIT | {"A": {"depth": depth, "limit": [500.0] * 3, "shear_yield": [600.0] * 3}}
    flat = LIMIT | {"shear_yield": 300.0}
    histories = [ts.roll(balls(fatigue=table)) for table in (flat, one, two)]
    for name in ("utilisation", "shakedown_lower", "shakedown_upper", "damage"):
        values = [history[name][-1, 0] for history in histories]
        assert values[1] == pytest.approx(values[0], rel=1e-12), name  # the same numbers
    used, lower = (
        [history[name][-1, 0] for history in histories]
        for name in ("utilisation", "shakedown_lower")
    )
    assert used[2] == pytest.approx(0.5 * used[0], rel=1e-12)
    assert lower[2] == pytest.approx(2.0 * lower[0], rel=1e-12)


def test_a_soft_core_is_where_shakedown_and_utilisation_are_least():
    a = 300.0
    scene = balls(fatigue=LIMIT)
    core = scene.hertz.a * 0.9
    case = {"depth": [0.0, core, 1.01 * core], "limit": [400.0, 400.0, 100.0]}
    case["shear_yield"] = [800.0, 800.0, 100.0]
    history = ts.roll(scene.replace(fatigue=LIMIT | {"shear_yield": a, "A": case}))
    for name in ("utilisation_at", "shakedown_lower_at"):
        assert history[name][-1, 0, 2] >= 0.9 * core


def worn(**tables):
    """Twin discs that wear some per cent of their stressed depth."""
    settings = ["grid.elements=[15, 31]", "wear.revolutions=20", "wear.save=[0, 5, 20]"]
    scene = ts.Scene.builtin("twin-discs").with_set([*settings, "wear.intensity=1e-4"])
    return scene.replace(subsurface={"planes": ["y=0", "x=0", "z=0.1a"]}, **tables)


GRADIENT = {"A": {"depth": [0.0, 1.0], "xx": [-1000.0, 0.0], "yy": [0.0, 500.0]}}
CASE = {"A": {"depth": [0.0, 1.0], "limit": [400.0, 200.0], "shear_yield": [900.0, 300.0]}}


@pytest.fixture(scope="module")
def rolled(tmp_path_factory):
    path = tmp_path_factory.mktemp("steel") / "worn.h5"
    ts.roll(worn(fatigue=LIMIT | CASE, residual=GRADIENT), path)
    return ts.open_history(path)


def test_material_keeps_its_stress_and_strength_while_it_wears(rolled):
    cycle = rolled.fatigue("A")
    assert cycle.worn.max() > 1e-3  # mm
    zeta = cycle.worn[:, None] + cycle.depth
    assert cycle.residual_xx == pytest.approx(np.interp(zeta, [0, 1], [-1000.0, 0.0]), abs=1e-9)
    assert cycle.residual_yy == pytest.approx(np.interp(zeta, [0, 1], [0.0, 500.0]), abs=1e-9)
    assert cycle.local_limit == pytest.approx(np.interp(zeta, [0, 1], [400.0, 200.0]), abs=1e-9)
    assert cycle.local_yield == pytest.approx(np.interp(zeta, [0, 1], [900.0, 300.0]), abs=1e-9)


def test_strength_over_depth_without_a_limit_has_no_limit():
    shear = {"depth": [0.0, 1.0], "shear_yield": [900.0, 300.0]}
    cycle = ts.fatigue(ts.solve(worn(fatigue={"shear_yield": 900.0, "A": shear})))["A"]
    assert np.isnan(cycle.local_limit).all()
    assert np.isnan(cycle.utilisation).all()


def test_stress_on_every_plane_has_the_residual_stress_of_its_place(rolled):
    contact = rolled.state(20)
    bare = replace(contact, scene=contact.scene.replace(residual=None))
    worn_off = contact.scene.turns.share_of_entering("A") * contact.wear[-1]
    for plane in ("y=0", "x=0", "z=0.1a", "y=0.1"):
        total, elastic = (ts.stress_on_plane(each, plane) for each in (contact, bare))
        rows = total.axes.get("y", np.array([total.position]))
        here = np.interp(rows, contact.grid.y, worn_off)
        if plane[0] == "z":
            zeta = np.broadcast_to(total.position + here, total.components["xx"].shape)
        else:
            zeta = here[:, None] + total.depth
            zeta = np.broadcast_to(zeta, total.components["xx"].shape)
        change = total.components["xx"] - elastic.components["xx"]
        assert change == pytest.approx(-1000.0 * (1.0 - zeta), abs=1e-6), plane  # MPa, rounding
        assert np.array_equal(total.components["xz"], elastic.components["xz"])
    stored = rolled.stress("A", "x=0", 20).components["xx"]
    assert stored == pytest.approx(ts.stress_on_plane(contact, "x=0").components["xx"], abs=1e-6)
    at = np.array([[0.0, 0.05, 0.02]])
    change = ts.stress_at(contact, at)[0] - ts.stress_at(bare, at)[0]
    depth = 0.02 + np.interp(0.05, contact.grid.y, worn_off)
    assert change[:3] == pytest.approx([-1000.0 * (1.0 - depth), 500.0 * depth, 0.0], abs=1e-6)
    # Body B has none.
    for stress in (ts.stress_at(contact, at, "B"), ts.stress_at(bare, at, "B")):
        assert stress == pytest.approx(ts.stress_at(bare, at, "B"))


def test_the_largest_stress_is_that_of_the_points():
    layer = {"A": {"depth": [0.0, 0.3], "xx": [200.0, -200.0], "yy": [0.0, 300.0]}}
    contact = ts.solve(balls(residual=layer, friction=None, creepage=None))
    top = ts.stress_maximum(contact, "A")
    x, y, depth = top.interior_at
    value = ts.reference.von_mises(ts.stress_at(contact, [(x, y, depth)])[0])
    # The search combines distant elements: 6e-4.
    assert top.interior == pytest.approx(float(value), rel=2e-3)


def test_a_resumed_roll_is_the_same(rolled, tmp_path):
    path = tmp_path / "resumed.h5"
    scene = worn(fatigue=LIMIT | CASE, residual=GRADIENT)
    interrupted(scene, path, after=2)
    history = ts.roll(scene, path, resume=True)
    for name in ("damage", "utilisation", "shakedown_lower", "yield_factor"):
        assert history[name][-1] == pytest.approx(rolled[name][-1], rel=1e-9, nan_ok=True)


def test_without_tables_nothing_changes_and_nothing_is_stored():
    scene = balls(fatigue=LIMIT | {"shear_yield": K})
    assert scene.steel == {}
    bare = ts.fatigue(ts.solve(scene))["A"]
    assert not bare.residual_xx.size
    assert not bare.inverse_yield_factor.size
    none = scene.replace(residual={"A": {"depth": [0.0], "xx": [0.0], "yy": [0.0]}})
    zero = ts.fatigue(ts.solve(none))["A"]
    for name in ("utilisation", "residual_shear", "path_radius"):
        assert np.array_equal(getattr(bare, name), getattr(zero, name)), name
    assert "yield_factor" not in ts.roll(scene).columns


def test_blocks_of_a_duty_cycle_share_one_residual_stress():
    cylinder = line(4.0).replace(friction={"mu": 0.1}, creepage={"longitudinal": 1e-4})
    blocks = [
        {"revolutions": 3, "load": {"pressure": 3.2 * K}},
        {"revolutions": 1, "load": {"pressure": 4.0 * K}},
    ]
    wear = {"intensity": 1e-12, "revolutions": 8}
    scene = cylinder.replace(duty=blocks, wear=wear, residual={"A": {"from": "rolling"}})
    pressures = [block.residual.A.pressure for block in scene.blocks]
    assert pressures == pytest.approx([4.0 * K] * 2)
    one, two = (block.steel["A"].curves["xx"][1] for block in scene.blocks)
    assert np.array_equal(one, two)
    assert np.array_equal(one, scene.steel["A"].curves["xx"][1])


def test_a_transient_has_the_residual_stress_too():
    course = {"distance": [0.0, 0.05], "start": "steady"}
    table = LIMIT | {"criterion": "crossland", "limit": 1.0}
    scene = balls(fatigue=table, transient=course)
    bare, loaded = (
        ts.roll(scene.replace(residual=residual)) for residual in (None, uniform(60.0, 60.0))
    )
    shift = loaded.fatigue("A").utilisation - bare.fatigue("A").utilisation
    where = bare.fatigue("A").utilisation > 0.0
    assert shift[where] == pytest.approx(0.3 * 40.0, abs=1e-2)  # of some hundred MPa


def test_the_figure_shows_every_curve(rolled):
    figure = render(plot.over_depth(rolled, "A"))
    labels = [axes.get_xlabel() for axes in figure.axes]
    assert labels == ["utilisation", "residual stress (MPa)", "strength (MPa)"]
    residual = figure.axes[1].lines[0]
    assert residual.get_xdata()[0] == pytest.approx(-1000.0)
    with pytest.raises(ValueError, match="body B"):
        plot.over_depth(rolled, "B")
