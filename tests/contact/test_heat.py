"""Flash temperature of contacts, and friction that depends on it."""

import numpy as np
import pytest

import tractive_sam as ts
from tests.scenes import interrupted
from tractive_sam.contact.heat import _solve_division
from tractive_sam.operators.heat import SurfaceHeat, temperature_coefficients
from tractive_sam.results import Grid

GLASS = {"conductivity": 1.0, "density": 2500.0, "heat_capacity": 800.0}


@pytest.fixture(scope="module")
def discs():
    half = {"half_length": (0.35, 0.8), "elements": (41, 31)}
    return ts.Scene.builtin("hot-discs").replace(grid=half)


@pytest.fixture(scope="module")
def cold(discs):
    """Return the discs with friction that does not depend on temperature."""
    return discs.replace(**{"friction.temperature": None})


def test_equal_bodies_share_by_half(cold):
    contact = ts.solve(cold)
    heat = contact.heat
    assert heat.share == 0.5
    assert (heat.flux["A"] == heat.flux["B"]).all()
    assert (heat.temperature["A"] == heat.temperature["B"]).all()
    assert heat.temperature_mean < heat.temperature_max


def test_heat_conducted_is_heat_made(cold):
    contact = ts.solve(
        cold.replace(**{"body.B.thermal": GLASS, "heat.bulk": {"A": 80.0, "B": 5.0}})
    )
    heat, V = contact.heat, 20e3
    area = contact.grid.element_area
    conducted = (heat.flux["A"].sum() + heat.flux["B"].sum()) * area
    assert conducted == pytest.approx(V * contact.dissipation, rel=1e-10)
    assert 1e3 * heat.power == pytest.approx(V * contact.dissipation, rel=1e-10)
    apart = (heat.temperature["A"] - heat.temperature["B"])[contact.touching]
    assert np.abs(apart).max() < 1e-8 * heat.temperature_max  # 1e-12 in the sum of squares
    assert heat.share > 0.6  # steel takes more of it than glass


def test_contact_conducts_without_sliding(cold):
    still = {"creepage.longitudinal": 0.0, "heat.bulk": {"A": 150.0, "B": 0.0}}
    heat = ts.solve(cold.replace(**still)).heat
    assert heat.temperature_max == pytest.approx(75.0, abs=1e-7)
    assert heat.temperature_mean == pytest.approx(75.0, abs=1e-8)
    assert np.isnan(heat.share)  # no heat is made
    assert heat.flux["A"].sum() < 0.0  # it flows from A
    np.testing.assert_allclose(heat.flux["A"], -heat.flux["B"])


@pytest.mark.parametrize("line", [True, False])
def test_any_pair_of_bodies_is_solved(line):
    """Random conductivities, Peclet numbers and sizes, against a dense solution.

    The bound of the difference is the tolerance of GMRES times the condition of these matrices.
    """
    rng = np.random.default_rng(3)
    for elements in ((589, 1), (401, 1), (101, 1)) if line else ((21, 17), (16, 9)):
        grid = Grid((1.0, 0.5 if line else 1.0), elements)
        y = np.zeros(1) if line else grid.y
        touching = (grid.x[:, None] / 0.85) ** 2 + (y / 0.85) ** 2 < 1.0
        i, j = np.nonzero(touching)
        for _ in range(6):
            speed, lams = 10.0 ** rng.uniform(0.0, 5.0), 10.0 ** rng.uniform(-1.0, 2.6, 2)
            kappas = speed / 10.0 ** rng.uniform(-4.0, 3.0, 2)
            bodies = [SurfaceHeat(grid, speed, *of) for of in zip(kappas, lams, strict=True)]
            heat = touching * rng.random(touching.shape)
            into_A, residual = _solve_division(*bodies, heat, 3.0, touching)
            assert residual == 0.0  # within the tolerance
            dense = []
            for kappa, lam in zip(kappas, lams, strict=True):
                x = grid.dx * np.arange(1 - elements[0], elements[0])
                across = y if line else grid.dy * np.arange(1 - elements[1], elements[1])
                sides = grid.dx, np.inf if line else grid.dy
                table = temperature_coefficients(x, across, *sides, speed, kappa, lam)
                rows, columns = i[:, None] - i, j[:, None] - j
                dense.append(table[rows + elements[0] - 1, columns + elements[1] - 1])
            exact = np.linalg.solve(sum(dense), dense[1] @ heat[touching] + 3.0)
            assert np.abs(into_A[touching] - exact).max() < 1e-7 * np.abs(exact).max()


@pytest.mark.parametrize("course", [{}, {"transient": {"distance": [0.0, 0.05]}}])
def test_unsolved_shares_are_not_converged(cold, monkeypatch, course):
    monkeypatch.setattr("tractive_sam.contact.heat.gmres", lambda a, b, rhs, *_: (0.0 * rhs, 0))
    scene = cold.replace(**{"body.B.thermal": GLASS, "grid.elements": (21, 15), **course})
    history = ts.roll(scene)
    assert history.status != "done"
    assert "heat" in history.message
    assert np.isfinite(history["temperature_max"]).all()  # the data are there


def test_symmetric_under_exchange_of_the_bodies(cold):
    given = {"body.A.thermal": GLASS, "heat.bulk": {"A": 80.0, "B": 20.0}}
    swapped = {"body.B.thermal": GLASS, "heat.bulk": {"A": 20.0, "B": 80.0}}
    one, other = (ts.solve(cold.replace(**changes)).heat for changes in (given, swapped))
    assert one.share == pytest.approx(1.0 - other.share, abs=1e-9)
    assert one.temperature_max == pytest.approx(other.temperature_max, rel=1e-9)
    np.testing.assert_allclose(one.temperature["A"], other.temperature["B"], rtol=1e-7)


def test_line_contact_against_the_elliptic_strip():
    """Full slip at a Peclet number of 2,800: the closed form is for infinity."""
    cylinders = ts.Scene.builtin("cylinders").replace(
        **{
            "creepage.longitudinal": -0.08, "creepage.speed": 3e5, "heat": {"bulk": 0.0},
            "body.A.thermal": GLASS, "body.B.thermal": GLASS,
        }
    )  # fmt: skip
    contact = ts.solve(cylinders)
    a, V, kappa = cylinders.hertz.a, 3e5, 0.5
    q0 = 0.5 * 0.08 * V * cylinders.friction.mu[0] * cylinders.hertz.p0
    exact = 2.1883 * q0 / 1.0 * np.sqrt(a * kappa / (np.pi * V))
    assert contact.heat.temperature_max == pytest.approx(exact, rel=1e-2)  # elastic slip: 5e-3


def test_friction_falls_with_the_temperature(discs, cold):
    hot, plain = ts.solve(discs), ts.solve(cold)
    table = np.array(discs.friction.temperature).T
    factor = np.interp(hot.heat.temperature["A"], *table)
    sliding = hot.sliding
    assert sliding.sum() > 0.9 * hot.touching.sum()
    used = np.hypot(*hot.traction)[sliding] / (0.3 * hot.pressure[sliding])
    np.testing.assert_allclose(used, factor[sliding], rtol=1e-6)  # ten tolerances of the coupling
    assert hot.Qx < 0.95 * plain.Qx
    assert hot.heat.temperature_max < plain.heat.temperature_max
    flat = discs.replace(**{"friction.temperature": [[20.0, 1.0], [2000.0, 1.0]]})
    # A factor of one changes nothing beyond the residual of both, 1e-8.
    assert ts.solve(flat).Qx == pytest.approx(plain.Qx, rel=1e-8)


@pytest.mark.parametrize("law", [{}, {"law": "exponential", "kinetic": 0.2, "half_speed": 500.0}])
def test_friction_with_a_memory_adapts_to_the_temperature_over_the_sliding_distance(discs, law):
    """The ratio in an element follows from the ratio ahead, by the equation of the theory."""
    distance, bulk = 1e-3, {"A": 20.0, "B": 100.0}
    mu = {"static": 0.3, "mu": None} if law else {"mu": 0.3}
    table = discs.friction.entries() | mu | law | {"memory": distance}
    scene = discs.replace(friction=table, **{"heat.bulk": bulk})
    contact = ts.solve(scene)
    degrees, factors = np.array(scene.friction.temperature).T
    dx, V = contact.grid.dx, scene.creepage.speed
    size = np.hypot(*contact.slip)
    target = np.interp(contact.heat.temperature["A"], degrees, factors)
    if law:
        target = target * (0.2 + 0.1 * np.exp(-np.log(2.0) * V * size / 500.0)) / 0.3
    used = np.hypot(*contact.traction[:, :, 15]) / (0.3 * np.maximum(contact.pressure[:, 15], 1e-9))
    assert contact.sliding[contact.touching].all()
    first, *rest, _ = np.flatnonzero(contact.touching[:, 15])[::-1]
    entering = np.interp(60.0, degrees, factors)  # equal bodies: the mean of both bulks
    assert target[first, 15] < used[first] < entering
    kept = np.exp(-V * size[:, 15] * dx / (V * distance))
    expected = [kept[i] * used[i + 1] + (1.0 - kept[i]) * target[i, 15] for i in rest]
    np.testing.assert_allclose(used[rest], expected, rtol=1e-5)  # the slip at the leading edge
    with_none, at_once = (ts.solve(scene.replace(**{"friction.memory": m})) for m in (0.0, 1e-9))
    assert at_once.Qx == pytest.approx(with_none.Qx, rel=1e-7)  # ten tolerances of the coupling
    assert contact.Qx > with_none.Qx


def test_a_sweep_from_the_leading_edge_gives_the_same_friction_and_temperature():
    """Sliding strip, fast: heat and memory of each element depend on the elements ahead only."""
    mu, falls, memory = 0.3, [[20.0, 1.0], [2000.0, 0.4]], 5e-3
    poor = {"conductivity": 0.05, "density": 7850.0, "heat_capacity": 450.0}
    scene = ts.Scene.builtin("cylinders").replace(
        subsurface=None,
        creepage={"longitudinal": -0.02, "speed": 5e3},
        heat={"bulk": 20.0},
        friction={"mu": mu, "temperature": falls, "memory": memory},
        grid={"half_length": [2.0], "elements": [61]},
        solver={"slip": "upwind"},
        **{"body.A.thermal": poor, "body.B.thermal": poor},
    )
    contact = ts.solve(scene)
    assert contact.stick_fraction == 0.0
    pressure, dx = contact.pressure[::-1, 0], contact.grid.dx
    slid = dx * np.hypot(*contact.slip)[::-1, 0]
    # Temperature of half the heat: (q/sqrt(pi k rho c V)) (sqrt(since start) - sqrt(since end)).
    effusivity = np.sqrt(0.05 * 7850.0 * 450.0 * 1e-6)
    roots = np.sqrt(np.maximum(np.arange(-0.5, pressure.size), 0.0))
    rise = 5e3 * slid / dx * pressure * np.sqrt(dx / (np.pi * 5e3)) / effusivity
    ratio, ratios = mu, np.zeros(pressure.size)
    for i in np.flatnonzero(pressure):
        kept, ahead, before = 1.0 / (1.0 + slid[i] / memory), ratio, ratios * rise
        for _ in range(60):  # a contraction, by the heat of the element itself
            temperature = 20.0 + before[:i] @ np.diff(roots)[i:0:-1] + ratio * rise[i] * roots[1]
            ratio = kept * ahead + (1.0 - kept) * mu * np.interp(temperature, *np.transpose(falls))
        ratios[i] = ratio
    # The front of the heat is a step to 1e-6 at this speed.
    assert contact.Qx == pytest.approx((ratios * pressure).sum() * dx, rel=1e-6)
    np.testing.assert_allclose(contact.traction[0, ::-1, 0], ratios * pressure, rtol=1e-6)


def test_constant_friction_without_temperature_has_nothing_to_adapt_to(cold):
    with pytest.raises(ts.SceneError, match=r"friction\.memory.*friction\.temperature"):
        cold.replace(**{"friction.memory": 0.1})


def test_without_contact_nothing_is_warm(discs):
    approach = discs.hertz.approach
    apart = discs.replace(load={"normal": None, "approach": approach})
    heat = ts.solve(apart, wear=np.full(discs.grid.elements, 2.0 * approach)).heat
    assert np.isnan((heat.temperature_max, heat.temperature_mean, *heat.temperature_max_at)).all()
    assert heat.power == 0.0


def test_columns_and_history(discs, tmp_path):
    history = ts.roll(discs, tmp_path / "hot.h5")
    contact = ts.solve(discs)
    assert history["temperature_max"][0] == pytest.approx(contact.heat.temperature_max, rel=1e-6)
    assert tuple(history["temperature_max_at"][0]) == contact.heat.temperature_max_at
    assert history["heat_share"][0] == 0.5
    again = ts.open_history(tmp_path / "hot.h5")
    assert again["temperature_mean"][0] == history["temperature_mean"][0]


def test_temperatures_have_error_bars(discs):
    scene = discs.replace(**{"creepage.longitudinal": -2e-3, "creepage.spin": 0.01})
    rough = ts.roll(scene.replace(grid=None, accuracy={"tolerance": 0.02}))
    grid = {"half_length": rough.grid.half_length, "elements": (111, 111)}
    fine = ts.solve(scene.replace(grid=grid)).heat
    for name in ("temperature_max", "temperature_mean"):
        bar = rough[f"{name}_error"][-1]
        assert abs(rough[name][-1] - getattr(fine, name)) < bar  # 0.3 of it
        assert 0.0 < bar < 0.1


def test_a_law_that_knows_no_temperature_is_reported(discs):
    laws = ts.Laws.of(discs).replace(friction=ts.Coulomb(mu=(0.3, 0.3)))
    with pytest.raises(ValueError, match=r"friction\.temperature"):
        ts.solve(discs, laws=laws)


@pytest.mark.parametrize(
    ("changes", "key", "words"),
    [
        ({"body.A.thermal.conductivity": -1.0}, "body.A.thermal.conductivity", "above 0"),
        ({"body.A.thermal": None}, "body.A.thermal", "both"),
        ({"creepage.speed": None}, "creepage.speed", "[heat]"),
        ({"heat": None}, "friction.temperature", "[heat]"),
        (
            {
                "heat": None,
                "friction.temperature": None,
                "wear": {"intensity": 1e-9, "revolutions": 1, "temperature": [[20.0, 1.0]]},
            },
            "wear.temperature",
            "[heat]",
        ),
        (
            {
                "wear": {"intensity": 1e-9, "revolutions": 1, "temperature": [[20.0, 1.0]]},
                "solver.method": "uzawa",
            },
            "wear.temperature",
            "solver.method",
        ),
        ({"heat.bulk": -300.0}, "heat.bulk", "-273.15"),
        ({"heat.bulk": {"A": "warm"}}, "heat.bulk.A", "number"),
        ({"friction.temperature": [[90.0, 1.0], [50.0, 0.5]]}, "friction.temperature", "ascend"),
        (
            {"friction.temperature": [[100.0, 1.0], [150.0, -0.5]]},
            "friction.temperature",
            "above 0",
        ),
        (
            {"body.A.thermal": None, "body.B.thermal": None, "body.A.young": 170e3},
            "body.A.thermal",
            "steel",
        ),
    ],
)
def test_bad_input_is_reported(discs, changes, key, words):
    with pytest.raises(ts.SceneError) as caught:
        discs.replace(**changes)
    (fault,) = caught.value.faults
    assert fault.key == key
    assert words in f"{fault.given} {fault.allowed}"


def test_explained(discs):
    heat = next(section for section in ts.explain(discs) if section.title == "Heat")
    rows = dict(heat.rows)
    assert "of an element" in rows["Peclet number A"]
    assert "bulk" in rows["body A"]
    assert rows["share of each body"].startswith("half")


def test_fields_are_kept_and_read(discs, tmp_path):
    glass = discs.replace(**{"body.B.thermal": GLASS, "heat.bulk": {"A": 80.0, "B": 20.0}})
    ts.roll(glass, tmp_path / "hot.h5")
    state = ts.open_history(tmp_path / "hot.h5").state(0)
    heat = ts.solve(glass).heat
    for body in "AB":
        np.testing.assert_allclose(state.heat.temperature[body], heat.temperature[body], rtol=1e-6)
        np.testing.assert_allclose(state.heat.flux[body], heat.flux[body], rtol=1e-4, atol=1e-3)
    # (two solves of the coupling, which agree to its tolerance)
    assert state.heat.share == pytest.approx(heat.share, rel=1e-6)


def test_wears_and_resumes(discs, tmp_path):
    wear = {"intensity": 1e-9, "revolutions": 3, "save": [0, 3], "stepping": "every-revolution"}
    scene = discs.replace(wear=wear)
    whole = ts.roll(scene)
    assert (np.diff(whole["wear_max"]) > 0.0).all()
    assert np.isfinite(whole["temperature_max"]).all()
    shorter = scene.with_set(["wear.revolutions=1"])
    ts.roll(shorter, tmp_path / "hot.h5")
    resumed = ts.roll(scene, tmp_path / "hot.h5", resume=True)
    np.testing.assert_allclose(resumed["temperature_max"], whole["temperature_max"], rtol=1e-12)


@pytest.mark.slow
def test_continues_with_the_wear_of_warm_surfaces(discs, tmp_path):
    """What the last contact wears is reported by its temperatures, which the file does not keep."""
    coarse = {"half_length": (0.35, 0.8), "elements": (15, 15)}
    scene = discs.replace(grid=coarse, wear={"intensity": 2e-6, "revolutions": 20})
    whole = ts.roll(scene)
    interrupted(scene, tmp_path / "hot.h5", 4)
    resumed = ts.roll(scene, tmp_path / "hot.h5", resume=True)
    for name in ("revolution", "Qx", "p_max", "wear_max"):
        np.testing.assert_array_equal(resumed[name], whole[name], err_msg=name)


@pytest.mark.slow
def test_a_block_that_waits_for_its_turn_stays_as_warm(discs, tmp_path):
    coarse = {"half_length": (0.35, 0.8), "elements": (15, 15)}
    wear = {"intensity": 1e-6, "revolutions": 4, "save": [0, 1, 2], "stepping": "every-revolution"}
    blocks = [{"revolutions": 1}, {"revolutions": 1, "load": {"normal": 200.0}}]
    scene = discs.replace(grid=coarse, wear=wear, duty=blocks)
    whole = ts.roll(scene)
    interrupted(scene, tmp_path / "hot.h5", 1)
    resumed = ts.roll(scene, tmp_path / "hot.h5", resume=True)
    np.testing.assert_array_equal(resumed["block_temperature_max"], whole["block_temperature_max"])
    fields = (one.field("temperature_A", 1) for one in (resumed, whole))
    np.testing.assert_array_equal(*fields)


def test_plotted(discs):
    contact = ts.solve(discs)
    for draw in (ts.plot.temperature, ts.plot.friction):
        assert len(draw(contact).axes) == 2  # map and colour bar
    with pytest.raises(ValueError, match="heat"):
        ts.plot.temperature(ts.solve(discs.replace(heat=None, **{"friction.temperature": None})))


def test_wears_by_the_sliding_distance_however_hot(discs, cold):
    """Archard's depth p_n |s| follows from pressure and slip, not from friction."""
    wear = {"intensity": 1e-9, "revolutions": 1}
    hot, plain = (ts.roll(one.replace(wear=wear))["worn_area"] for one in (discs, cold))
    assert hot[0] == pytest.approx(plain[0], rel=5e-3)  # elastic slip; friction is 13 % less


def test_wear_answers_to_the_temperature(cold):
    wear = {"intensity": 1e-9, "revolutions": 1, "save": [0, 1]}
    plain = ts.roll(cold.replace(wear=wear))
    twice = ts.roll(cold.replace(wear=wear | {"temperature": [[20.0, 2.0]]}))
    # The wear of the pass itself, 1e-9 of the approach, changes the contact.
    assert twice["worn_area"] == pytest.approx(2.0 * plain["worn_area"], rel=1e-6)
    softening = [[20.0, 1.0], [400.0, 5.0]]
    contact = ts.roll(cold.replace(wear=wear | {"temperature": softening})).state(1)
    factor = np.interp(contact.heat.temperature["A"], *np.transpose(softening))
    single = plain.state(1)
    rate = np.diff(single.wear[::-1], axis=0, prepend=0.0)[::-1]
    assert factor.max() > 1.1
    assert contact.worn_area == pytest.approx(
        float((factor * rate).sum()) * contact.grid.dy, rel=1e-5
    )


@pytest.mark.parametrize(
    "stepping", [pytest.param("adaptive", marks=pytest.mark.slow), "every-revolution"]
)
def test_wear_that_answers_to_the_temperature_resumes(cold, tmp_path, stepping):
    wear = {"intensity": 1e-8, "revolutions": 12, "save": [0, 4, 12], "stepping": stepping}
    scene = cold.replace(wear=wear | {"temperature": [[20.0, 1.0], [400.0, 5.0]]})
    whole = ts.roll(scene)
    ts.roll(scene.with_set(["wear.revolutions=4", "wear.save=[0, 4]"]), tmp_path / "r.h5")
    resumed = ts.roll(scene, tmp_path / "r.h5", resume=True)
    assert resumed["wear_max"][-1] == pytest.approx(whole["wear_max"][-1], rel=1e-6)
    assert np.isnan(whole.wear_balance).all()


def test_study_over_the_speed(discs, tmp_path):
    fast = {"key": "creepage.speed", "values": [5e3, 20e3]}
    results = ts.study(ts.Study(scene=discs, axis=[fast]), tmp_path / "speeds", workers=0)
    warm = results.dataset()["temperature_max"].values
    force = results.dataset()["Qx_over_P"].values
    assert warm[0] < warm[1]
    assert force[0] > force[1]
