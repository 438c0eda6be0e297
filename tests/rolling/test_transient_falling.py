"""Steps of a transient with friction that falls with the speed of sliding."""

import warnings

import numpy as np
import pytest

import tractive_sam as ts
from tests.contact.test_falling import Row, cylinder
from tests.scenes import interrupted
from tractive_sam.contact import Model, StepInput, Stepper
from tractive_sam.mechanics import Exponential

SPHERES = ts.Scene.builtin("spheres").replace(subsurface=None, creepage=None)
P, MU = SPHERES.normal_load, SPHERES.friction.mu[0]
SPEED, KINETIC = 1000.0, 0.6
FALLS = {"law": "exponential", "static": MU, "kinetic": KINETIC * MU, "half_speed": 30.0}
REMEMBERS = FALLS | {"half_speed": 10.0, "memory": 1e-2}
DRIVE = "creepage.longitudinal"


def scene(transient, n=11, slip="auto", friction=FALLS, **changes):
    """Spheres of 4.08 mm half length that roll at 1 m/s."""
    more = {"grid.elements": (n, n), "solver.slip": slip, "creepage.speed": SPEED}
    return SPHERES.replace(transient=transient, friction=friction, **more, **changes)


def steady(here):
    """Return the steady contact of a scene with constant creepage."""
    course = here.transient.creepage.longitudinal
    return ts.solve(here.replace(transient=None, **{DRIVE: course[-1]}))


def dx(n):
    return 8.16 / n


def worst_balance(history):
    missed = history["step_work"] - history["step_friction"]
    missed[1:] -= np.diff(history["elastic_energy"])
    return np.abs(missed[1:]).max() / history["elastic_energy"].max()


@pytest.mark.parametrize("slip", ["auto", "upwind"])
@pytest.mark.parametrize("friction", [FALLS, REMEMBERS])
@pytest.mark.parametrize("length", [1.0, 0.5])
def test_what_is_steady_stays_so(slip, friction, length):
    n = 15
    courses = {"distance": [0, 3 * dx(n)], DRIVE: [-5e-3] * 2, "start": "steady"}
    here = scene(courses | {"step": length * dx(n)}, n, slip, friction)
    history, before = ts.roll(here), steady(here)
    # Steady rolling lets a memory fade by the slip of an element, of first order, and parts of an
    # element by theirs: 2.6e-3, of 31 and 61 elements 1.5e-3 and 0.8e-3.
    allowed = 1e-6 if length == 1.0 else 5e-3
    assert np.abs(history["Qx"] / before.Qx - 1.0).max() < allowed


@pytest.mark.slow
@pytest.mark.parametrize("slip", ["auto", "upwind"])
@pytest.mark.parametrize("friction", [FALLS, REMEMBERS])
def test_in_the_end_it_is_steady(slip, friction):
    here = scene({"distance": [0, 80 * dx(11)], DRIVE: [-3e-3] * 2}, 11, slip, friction)
    history, after = ts.roll(here), steady(here)
    assert history.status == "done"
    size = MU * after.p_max
    for name, found in zip(("traction_x", "traction_y"), after.traction, strict=True):
        # What is left of the start falls with the distance: below the tolerance after 17 a.
        np.testing.assert_allclose(history.field(name), found, atol=2e-6 * size)
    assert worst_balance(history) < 1e-12  # rounding


@pytest.mark.parametrize("slip", ["auto", "upwind"])
@pytest.mark.parametrize("friction", [FALLS, REMEMBERS])
def test_steady_dissimilar_bodies_stay_so_and_their_work_balances(slip, friction):
    other = ts.Scene.builtin("spheres-dissimilar").replace(subsurface=None)
    mu, length = other.friction.mu[0], 2.0 * 1.2 * other.hertz.a
    law = friction | {"static": mu, "kinetic": KINETIC * mu, "half_speed": 400.0}
    courses = {"distance": [0, 2 * length / 15], DRIVE: [-5e-3] * 2, "start": "steady"}
    mesh = {"grid": {"half_length": (length / 2,) * 2, "elements": (15, 15)}, "solver.slip": slip}
    history = ts.roll(
        other.replace(friction=law, transient=courses, creepage={"speed": SPEED}, **mesh)
    )
    assert history.status == "done"
    assert np.abs(history["Qx"] / history["Qx"][0] - 1.0).max() < 1e-6  # a hundred tolerances
    assert worst_balance(history) < 1e-12  # rounding


@pytest.mark.parametrize("friction", [FALLS, REMEMBERS])
def test_a_force_takes_the_creepage_that_has_it(friction):
    forces = [0.0, 0.5 * MU * P]
    rolls = {"distance": [0, 6 * dx(11)]}
    here = scene(rolls | {"load.force_x": forces}, friction=friction)
    forced = ts.roll(here)
    np.testing.assert_allclose(forced["Qx"], np.linspace(*forces, 7), atol=1e-6 * MU * P)
    model, then = Model(here), []
    stepper = Stepper(model)
    now = stepper.at_rest(stepper.press(StepInput(load=P)))
    for creepage in forced["creepage_found"][1:, 0]:
        now = stepper.step(now, StepInput(model.grid.dx, (creepage, 0.0, 0.0), P))
        then.append(now.contact.Qx)
    np.testing.assert_allclose(then, forced["Qx"][1:], atol=1e-6 * MU * P)


@pytest.mark.slow
def test_a_force_beyond_the_top_has_the_creepage_of_the_top_in_its_message():
    tops = []
    for parts in (1, 2):
        rolls = {"distance": [0, 8 * dx(11)], "load.force_x": [0.0, 0.999 * MU * P]}
        history = ts.roll(scene(rolls | {"step": dx(11) / parts}))
        assert "transient.load.force_x" in history.message
        tops.append(float(history.message.split("at a creepage of ")[1].split(":")[0]))
    # Not over an element's length: tops of half as long steps are at larger creepages, not half.
    assert 0.9 < tops[1] / tops[0] < 1.5


def test_bodies_that_part_forget():
    touch = SPHERES.hertz.approach
    courses = {"distance": [0, 3, 5, 8], "load.approach": [touch, touch, -1e-3, touch]}
    drive = {DRIVE: [-5e-3] * 4, "start": "steady"}
    apart = scene(courses | drive, friction=REMEMBERS, **{"load.approach": touch})
    apart = apart.replace(**{"load.normal": None})
    history = ts.roll(apart)
    assert history.status == "done"
    assert history["Qx"][-1] > 0.0
    assert (history["Qx"] == 0.0).any()


def test_adaptive_steps_follow_even_ones():
    courses = {"distance": [0, 8 * dx(11)], DRIVE: [0.0, -4e-3]}
    even, adaptive = (
        ts.roll(scene(courses | {"stepping": stepping}, friction=REMEMBERS))
        for stepping in ("even", "adaptive")
    )
    assert adaptive["Qx"][-1] == pytest.approx(even["Qx"][-1], rel=1e-2)  # ten tolerances


def dense_step(matrix, rigid, pressure, law, times):
    """Solve a step of a line contact element by element, by bisection of each slip.

    The slip is rigid + matrix q, and q = -mu(times |slip|) p slip/|slip| in elements that slide.
    """
    traction = np.zeros(len(rigid))
    for _ in range(4000):
        before = traction.copy()
        for i in np.flatnonzero(pressure > 0.0):
            others = rigid[i] + matrix[i] @ traction - matrix[i, i] * traction[i]
            sign, bound = np.sign(others), law(0.0) * pressure[i]
            if abs(others) <= matrix[i, i] * bound:
                traction[i] = -others / matrix[i, i]
                continue
            low, high = 0.0, abs(others)
            for _ in range(60):
                middle = 0.5 * (low + high)
                missed = abs(others) - matrix[i, i] * law(times * middle) * pressure[i] - middle
                low, high = (middle, high) if missed > 0.0 else (low, middle)
            traction[i] = -sign * law(times * low) * pressure[i]
        if np.abs(traction - before).max() < 1e-13 * pressure.max():
            return traction
    raise AssertionError("no dense solution")


def test_a_step_is_that_of_dense_matrices():
    law = {"law": "rational", "static": 0.3, "kinetic": 0.15, "half_speed": 4e3}
    grid = {"half_length": 4.65, "elements": 31}
    here = cylinder().replace(friction=law, grid=grid, **{DRIVE: -2e-3})
    model = Model(here)
    stepper, requested = Stepper(model), StepInput(model.grid.dx, (-3e-3, 0.0, 0.0), 3111.08)
    before = stepper.at_rest(ts.solve(here))
    now = stepper.step(before, requested)
    matrix = stepper.operators.part((32, 1)).tangential.as_matrix()[:32, :32]
    scale = model.units.pressure * model.frame.mu[0]
    past = np.pad(before.contact.traction[0, :, 0] / scale, (0, 1))
    gone = (matrix @ past)[1:32]
    rigid = model.frame.slip_to_scaled(np.full((2, 1, 1), -3e-3))[0, 0, 0] / model.units.slip - gone
    per_slip = model.frame.slip_to_physical(np.ones((2, 1, 1)))[0, 0, 0] * model.units.slip
    share = lambda speed: 0.5 + 0.5 / (1.0 + speed / 4e3)  # noqa: E731
    pressure = now.contact.pressure[:, 0] / model.units.pressure
    speed = here.creepage.speed * per_slip
    found = dense_step(matrix[:31, :31], rigid, pressure, share, speed)
    got = now.contact.traction[0, :, 0] / scale
    assert now.contact.sliding.any()
    assert now.contact.sticking.any()
    np.testing.assert_allclose(got, found, atol=1e-6 * pressure.max())  # ten tolerances


@pytest.mark.parametrize("slip", ["auto", "upwind"])
def test_tractions_are_bounded_by_the_local_speed_of_the_step(slip):
    here = scene(None, 21, slip, FALLS, **{DRIVE: -4e-3})
    model = Model(here)
    stepper, before = Stepper(model), ts.solve(here)
    now = stepper.step(stepper.at_rest(before), StepInput(dx(21), (-6e-3, 2e-3, 0.0), P)).contact
    speed = SPEED * np.hypot(*now.slip)
    mu = MU * (KINETIC + (1.0 - KINETIC) * np.exp(-np.log(2.0) * speed / 30.0))
    share = np.hypot(*now.traction) / np.where(now.touching, mu * now.pressure, 1.0)
    inside = now.sliding & (np.hypot(*before.slip) > 0.0)
    # The slip that is reported is the mean of two faces, in the law a parabola through three.
    assert np.abs(share[inside] - 1.0).max() < (1e-6 if slip == "upwind" else 2e-2)
    assert share[now.sticking].max() <= 1.0 + 1e-6
    along = (now.traction * now.slip).sum(axis=0)[inside]
    sizes = (np.hypot(*now.traction) * np.hypot(*now.slip))[inside]
    assert (along / sizes).max() < (-1.0 + 1e-9 if slip == "upwind" else -0.99)


@pytest.mark.parametrize(
    ("start", "printed", "slides"),
    [("rest", [0.5977], [4]), ("sliding", [0.5702, 0.5739, 0.5774], [47, 2, 4])],
)
def test_both_solutions_of_a_step_are_those_of_an_independent_program(start, printed, slides):
    """One of 0.1 mm from steady rolling; CONTACT prints its force and the elements that slide."""
    here = cylinder(**{"friction.start": start})
    laws = ts.Laws.of(here).replace(elasticity=Row(*here.materials.values()))
    model = Model(here, laws=laws)
    stepper = Stepper(model)
    now = stepper.at_rest(ts.solve(here, laws=laws))
    for share, count in zip(printed, slides, strict=True):
        with pytest.warns(ts.SceneWarning, match=r"friction\.law.*friction\.start"):
            now = stepper.step(now, StepInput(model.grid.dx, (-1e-3, 0.0, 0.0), 3111.08))
        # It prints four digits, and ends when the slip changes by a thousandth.
        assert now.contact.Qx / (0.3 * 3111.08) == pytest.approx(share, rel=3e-4)
        assert now.contact.sliding.sum() == count


@pytest.mark.filterwarnings("ignore::tractive_sam.SceneWarning")
def test_the_end_of_a_branch_leads_to_the_next_solution():
    """Without fixed friction, the third step is not solved by any method."""
    creepages = [-4.4606e-4, -4.5485e-4]
    course = {"distance": [0.0, 0.3], "start": "steady", DRIVE: creepages}
    sliding = {"friction.start": "sliding", "friction.half_speed": 166.6, "grid.elements": 121}
    history = ts.roll(cylinder(**sliding).replace(transient=course))
    assert history.status == "done"


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::tractive_sam.SceneWarning")
@pytest.mark.parametrize("slip", ["auto", "upwind"])
@pytest.mark.parametrize("start", ["rest", "sliding"])
def test_a_long_course_of_falling_friction_is_solved(start, slip):
    """The first 2 mm of a published course, after steady rolling at a smaller creepage."""
    creepages = [-0.9999e-3, -1e-3, -1e-3]
    course = {"distance": [0.0, 0.0, 2.0], "start": "steady", DRIVE: creepages}
    here = cylinder(**{"friction.start": start, "solver.slip": slip}).replace(transient=course)
    rows = ts.Laws.of(here).replace(elasticity=Row(*here.materials.values()))
    assert ts.roll(here, laws=rows).status == "done"


@pytest.mark.parametrize("slip", ["auto", "upwind"])
@pytest.mark.parametrize("half_speed", [30.0, 2e4])
def test_a_step_of_several_solutions_warns_from_both_sides(slip, half_speed):
    found, warned = [], []
    for start in ("rest", "sliding"):
        here = cylinder(**{"friction.start": start, "friction.half_speed": half_speed})
        model = Model(here.replace(**{"solver.slip": slip}))
        stepper = Stepper(model)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", ts.SceneWarning)
            before = stepper.at_rest(ts.solve(model.scene))
            caught.clear()
            now = stepper.step(before, StepInput(model.grid.dx, (-1.1e-3, 0.0, 0.0), 3111.08))
        found.append(now.contact.Qx)
        warned.append(any("transient.step" in str(one.message) for one in caught))
    several = abs(found[1] / found[0] - 1.0) > 1e-5  # a hundred tolerances
    assert several == (half_speed < 100.0)
    assert warned == [several, several]


def test_steps_shorter_than_the_contact_deforms_have_several_solutions_but_for_a_memory():
    """A fall by the speed is as much steeper in a step as that is shorter, one by a memory not."""
    steep = {"memory": 0.0, "half_speed": 2e4}, {"memory": 2e-3, "half_speed": 2e4}
    warned = []
    for law in steep:
        for length in (1.0, 1.0 / 64.0):
            here = cylinder(**{f"friction.{key}": value for key, value in law.items()})
            model = Model(here)
            stepper = Stepper(model)
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always", ts.SceneWarning)
                now = stepper.at_rest(ts.solve(here))
                stepper.step(now, StepInput(length * model.grid.dx, (-1e-3, 0.0, 0.0), 3111.08))
            warned.append(any("transient.step" in str(one.message) for one in caught))
    assert warned == [False, True, False, False]


@pytest.mark.parametrize("step", [1.0, 0.4])
@pytest.mark.parametrize("friction", [FALLS, REMEMBERS])
def test_work_balances_and_wears(step, friction):
    n, wear = 15, {"coefficient": 1e-7, "law": "energy"}
    transient = {"distance": [0, 4 * dx(n)], DRIVE: [-4e-3, -8e-3], "start": "steady"}
    here = scene(transient | {"step": step * dx(n)}, n, "auto", friction, wear=wear)
    history = ts.roll(here)
    assert worst_balance(history) < 1e-12  # rounding
    volume = history["worn_volume"][-1].sum()
    # 1e-7 mm³/(N m) is 1e-10 mm³/(N mm); rounding
    assert volume == pytest.approx(1e-10 * history["friction_work"][-1], rel=1e-9)


@pytest.mark.parametrize("friction", [FALLS, REMEMBERS])
def test_wears_by_the_sliding_distance_however_little_friction_is_left(friction):
    n, wear = 15, {"coefficient": 1e-7}
    transient = {"distance": [0, 4 * dx(n)], DRIVE: [-0.3] * 2, "start": "steady"}
    volumes = [
        ts.roll(scene(transient, n, "auto", law, wear=wear))["worn_volume"][-1].sum()
        for law in (friction, {"mu": KINETIC * MU})
    ]
    assert volumes[0] == pytest.approx(volumes[1], rel=1e-3)  # elastic slip is a part of 1e-2


@pytest.mark.parametrize("friction", [FALLS, REMEMBERS])
def test_mirror_image(friction):
    forces = []
    for sign in (1.0, -1.0):
        courses = {DRIVE: [-3e-3] * 2, "creepage.lateral": [0.0, sign * 2e-3]}
        courses["creepage.spin"] = [sign * 3e-4] * 2
        history = ts.roll(scene({"distance": [0, 4 * dx(11)], **courses}, friction=friction))
        forces.append((history["Qx"], sign * history["Qy"]))
    np.testing.assert_allclose(forces[0], forces[1], rtol=1e-6, atol=1e-6 * MU * P)  # tolerance


@pytest.mark.parametrize("friction", [FALLS, REMEMBERS])
def test_half_as_long_steps_come_to_the_same(friction):
    n, ends = 15, []
    for parts in (1, 2):
        transient = {"distance": [0, 6 * dx(n)], DRIVE: [-2e-3, -6e-3], "start": "steady"}
        transient["step"] = dx(n) / parts
        ends.append(
            [
                ts.roll(scene(transient, n, "auto", law))["Qx"][-1] / (MU * P)
                for law in ({"mu": MU}, friction)
            ]
        )
    (constant, falling), (half_constant, half_falling) = ends
    # Half as long steps differ by 1.6e-3 with the constant law, by 2.1e-3 and 0.9e-3 with these.
    assert abs(half_falling - falling) < 2.0 * abs(half_constant - constant) + 1e-4
    assert abs(falling - constant) > 1e-3  # and the law matters


def test_a_law_without_a_slope_is_coulombs():
    # Without symmetry: only the problem of Coulomb's law would be solved on half of the mesh.
    course = {DRIVE: [-3e-3] * 2, "creepage.lateral": [1e-3] * 2}
    here = scene({"distance": [0, 4 * dx(11)], **course}, friction={"mu": MU})
    level = ts.FallingCoulomb((MU, MU), sliding=Exponential(1.0, 1.0), speed=SPEED)
    histories = [
        ts.roll(here, laws=ts.Laws.of(here).replace(friction=law))
        for law in (ts.Coulomb((MU, MU)), level)
    ]
    # The pressure at rest is solved to the tolerance, with Coulomb's law on half of the mesh.
    for name in ("Qx", "dissipation", "elastic_energy"):
        np.testing.assert_allclose(histories[0][name], histories[1][name], rtol=1e-5)
    costs = [history["convolutions"][1:].sum() for history in histories]
    assert costs[0] == pytest.approx(costs[1], rel=0.1)  # single iterations


@pytest.mark.parametrize("law", [FALLS, {"mu": MU, "strength": 60.0}])
def test_a_course_of_friction_multiplies_the_coefficients_but_not_the_strength(law):
    n, strength = 15, 0.5 * MU * SPHERES.hertz.p0
    law = law | ({"strength": strength} if "strength" in law else {})
    transient = {"distance": [0, 2 * dx(n)], DRIVE: [-1e-2] * 2, "start": "steady"}
    here = scene(transient | {"friction.mu": [1.5 * MU] * 2}, n, "auto", law)
    stronger = {k: 1.5 * v if k in ("mu", "static", "kinetic") else v for k, v in law.items()}
    history, before = ts.roll(here), steady(scene(transient, n, "auto", stronger))
    np.testing.assert_allclose(history["Qx"], before.Qx, rtol=1e-6)  # ten tolerances
    if "strength" in law:
        size = np.hypot(history.field("traction_x"), history.field("traction_y"))
        assert size.max() <= strength * (1.0 + 1e-12)  # rounding


def test_continues_where_it_was_interrupted(tmp_path):
    courses = {"distance": [0, 6 * dx(11)], DRIVE: [0.0, -8e-3]}
    here = scene(courses | {"friction.mu": [MU, 0.7 * MU]}, friction=REMEMBERS)
    path = tmp_path / "roll.h5"
    interrupted(here, path, 3)
    resumed, whole = ts.roll(here, path, resume=True), ts.roll(here)
    np.testing.assert_allclose(resumed["Qx"], whole["Qx"], rtol=1e-9, atol=1e-9 * MU * P)


JUMP = {"distance": [0, 1, 1, 2], DRIVE: [0.0, -3e-3, -3e-3, -3e-3]}


@pytest.mark.parametrize(
    ("transient", "friction", "key"),
    [
        ({"distance": [0, 1], "start": "shift", DRIVE: [0.0, 1e-3]}, FALLS, "transient.start"),
        (JUMP | {"load.normal": [P, P, 1.2 * P, 1.2 * P]}, FALLS, "transient.distance"),
        ({"distance": [0, 1], "load.force_x": [0.1 * P] * 2}, FALLS, "transient.load.force_x"),
        ({"distance": [0, 1], DRIVE: [0, -3e-3]}, REMEMBERS | {"strength": 9.0}, "strength"),
    ],
)
def test_what_has_no_speed_of_sliding_is_refused(transient, friction, key):
    with pytest.raises(ts.SceneError, match=key.replace(".", r"\.")):
        scene(transient, friction=friction)
    scene(transient, friction={"mu": MU})


def test_a_jump_of_the_creepage_takes_no_shift():
    jump = JUMP | {DRIVE: [0.0, -1e-3, -3e-3, -3e-3]}
    assert ts.roll(scene(jump)).status == "done"


def test_a_shift_without_speed_is_refused():
    here = scene(None, friction=FALLS)
    stepper = Stepper(Model(here))
    now = stepper.at_rest(stepper.press(StepInput(load=P)))
    with pytest.raises(ValueError, match=r"laws\.friction"):
        stepper.step(now, StepInput(0.0, (1e-3, 0.0, 0.0), P))


def growth(damping, mass, steps=50):
    """Growth rate, 1/s, of a mass on a spring that a sliding contact drives in y.

    The mean lateral creepage of a step has the velocity of the mass, and its force belongs to this
    velocity: the midpoint rule, which neither damps nor drives.
    """
    here = scene(None, 11, "auto", SLIDES)
    model, at = Model(here), SLIDING / SPEED
    stepper, time = Stepper(model), model.grid.dx / SPEED
    spring = (0.2 / time) ** 2 * mass
    now, earlier = stepper.at_rest(ts.solve(here.replace(**{"creepage.lateral": at}))), None
    steady_force, place, velocity, size = now.contact.Qy, 0.0, 1.0, []
    for _ in range(steps):
        middle, then = velocity, None
        for _ in range(2):  # what the force changes by within a step is small
            by = (0.0, at + middle / SPEED, 0.0)
            then = stepper.step(
                now, StepInput(model.grid.dx, by, P), earlier, 1.0 if earlier else 0.0
            )
            force = then.contact.Qy - steady_force - damping * middle
            force -= spring * (place + 0.5 * time * middle)
            middle = velocity + 0.5 * time * force / mass
        earlier, now = now, then
        velocity, place = 2.0 * middle - velocity, place + time * middle
        size.append(0.5 * np.log(mass * velocity**2 + spring * place**2))
    return np.polyfit(time * np.arange(steps), size, 1)[0]


SLIDES, SLIDING = FALLS | {"half_speed": 400.0}, 400.0


@pytest.mark.slow
def test_a_falling_curve_drives_a_mass_that_is_damped_less_than_slope_times_load():
    # At the half speed: mu falls by ln 2/2 of its fall over the half speed.
    critical = 0.5 * np.log(2.0) / SLIDING * MU * (1.0 - KINETIC) * P  # N s/mm
    mass = critical * 0.04  # grows by half within the 50 steps
    rates = [growth(factor * critical, mass) for factor in (0.5, 1.5)]
    assert rates[0] > 0.0 > rates[1]
    # (critical - damping)/(2 mass), and zero at the critical damping; the contact is elastic.
    zero = 0.5 + rates[0] / (rates[0] - rates[1])
    assert zero == pytest.approx(1.0, abs=0.02)
    assert rates[0] == pytest.approx(0.25 * critical / mass, rel=0.1)
