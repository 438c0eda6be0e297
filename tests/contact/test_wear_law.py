"""Wear is what the work of friction wears."""

from dataclasses import dataclass

import numpy as np
import pytest

import tractive_sam as ts
from tests.scenes import steady
from tractive_sam.contact import Model, equilibrium
from tractive_sam.mechanics.falling import Exponential
from tractive_sam.mechanics.wear import Archard, ArchardByWork
from tractive_sam.scene import Scene

INTENSITY, MU, ANGLE = (3e-6, 1e-6), (0.2, 0.5), 0.6


def random_fields(seed=1):
    """Pressure, and slip in any direction."""
    random = np.random.default_rng(seed)
    return random.uniform(0.0, 1.0, (9, 7)), random.normal(size=(2, 9, 7))


def turned(vector, angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.stack((c * vector[0] + s * vector[1], c * vector[1] - s * vector[0]))


def test_where_it_slips_it_is_archards_law():
    """p_t = -p_n M² s/||s||*_mu, the associated rule of friction."""
    pressure, slip = random_fields()
    along = turned(slip, ANGLE)
    mu = np.array(MU)[:, None, None]
    traction = turned(-pressure * mu**2 * along / np.hypot(*(mu * along)), -ANGLE)
    by_work = ArchardByWork(INTENSITY, MU, ANGLE).rate(pressure, traction, slip)
    archard = Archard(INTENSITY, ANGLE).rate(pressure, traction, slip)
    np.testing.assert_allclose(by_work, archard, rtol=1e-13)
    # Linear in the load: so is the response of the wear to it.
    half = ArchardByWork(INTENSITY, MU, ANGLE).rate(0.5 * pressure, 0.5 * traction, slip)
    np.testing.assert_allclose(half, 0.5 * by_work, rtol=1e-14)


def test_any_work_wears_between_the_two_axes_and_never_less_than_nothing():
    pressure, slip = random_fields()
    traction = random_fields(2)[1]
    rate = ArchardByWork(INTENSITY, MU, ANGLE).rate(pressure, traction, slip)
    work = np.maximum(-(traction * slip).sum(axis=0), 0.0)
    assert (work == 0.0).any()
    rounding = 1e-12 * rate.max()
    assert (rate >= 2e-6 * work - rounding).all()
    assert (rate <= 15e-6 * work + rounding).all()


FULL_SLIP = 0.0044
"""Creepage of `spheres` from which on hardly anything sticks."""

CREEPAGES = {
    "longitudinal": {"creepage.longitudinal": -FULL_SLIP},
    "lateral": {"creepage.longitudinal": 0.0, "creepage.lateral": FULL_SLIP},
    "spin": {"creepage.longitudinal": 0.0, "creepage.spin": FULL_SLIP / 3.5},
    "combined": {
        "creepage.longitudinal": -0.7 * FULL_SLIP,
        "creepage.lateral": 0.5 * FULL_SLIP,
        "creepage.spin": 0.5 * FULL_SLIP / 3.5,
    },
}
FRICTION = {
    "isotropic": ("friction.mu=0.4013",),
    "orthotropic": ("friction.mu=[0.5, 0.1]", "friction.angle=30"),
}
DISSIMILAR = ("body.B.shear=8.0", "body.B.poisson=0.45")


def section_over_work(contact, intensity):
    """Worn section over that which the frictional work wears along the first axis."""
    friction = contact.scene.friction
    law = ArchardByWork(intensity, friction.mu, np.deg2rad(friction.angle))
    rate = law.rate(contact.pressure, contact.traction, contact.slip)
    assert (rate >= 0.0).all()
    worn = rate.sum() * contact.grid.element_area
    return worn / (intensity[0] / friction.mu[0] * contact.dissipation)


@pytest.mark.slow
@pytest.mark.parametrize("bodies", [(), DISSIMILAR], ids=["equal", "dissimilar"])
@pytest.mark.parametrize("friction", FRICTION)
@pytest.mark.parametrize("creepage", CREEPAGES)
def test_worn_section_is_what_the_work_wears(creepage, friction, bodies):
    """By the pressure of elements that stick, it would be up to 30 times as much."""
    for share in (1e-3, 1e-2, 0.1, 1.0):
        given = [f"{key}={share * value}" for key, value in CREEPAGES[creepage].items()]
        for elements in (17, 40):
            contact = steady("spheres", *FRICTION[friction], *bodies, *given, elements=elements)
            proportional = tuple(1e-6 * mu for mu in contact.scene.friction.mu)
            balance = section_over_work(contact, proportional)
            # Elements with negative work do not wear: few, and only around the pole of spin.
            assert 1.0 - 1e-12 < balance < 1.0 + 2e-3


@pytest.mark.slow
def test_law_of_another_direction_than_friction_at_small_creepage():
    """i/mu differs between the axes: the section against far finer meshes.

    At 1 % of full slip the slip zone is thinner than an element.
    """
    settings = ("friction.mu=[0.5, 0.2]", "friction.angle=35", "creepage.lateral=1.6e-5")
    settings = (*settings, f"creepage.longitudinal={-0.01 * FULL_SLIP}")
    coarse, fine = (
        section_over_work(steady("spheres", *settings, elements=n), (1e-6, 3e-6)) for n in (31, 201)
    )
    # Of first order: within an element the direction is not resolved.
    assert coarse == pytest.approx(fine, rel=0.05)


@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("spheres", ("creepage.longitudinal=-10.0",)),
        ("spheres-orthotropic", ("creepage.longitudinal=-10.0", "friction.angle=25")),
        ("cylinders", ("creepage.longitudinal=-1.0",)),
    ],
)
def test_full_slip_wears_by_archards_law(name, settings):
    scene = Scene.builtin(name).with_set(settings)
    contact = equilibrium(Model(scene))
    assert contact.stick_fraction == 0.0
    friction = scene.friction
    angle = np.deg2rad(friction.angle)
    fields = contact.pressure, contact.traction, contact.slip
    by_work = ArchardByWork(INTENSITY, friction.mu, angle).rate(*fields)
    archard = Archard(INTENSITY, angle).rate(*fields)
    # The slip at the centre and the mean of the faces differ by a hundredth of the elastic slip,
    # a ten thousandth of the rigid one; in one dimension not at all.
    tolerance = 1e-5 if scene.hertz is not None and name != "cylinders" else 1e-12
    np.testing.assert_allclose(by_work, archard, rtol=tolerance)


def test_the_papers_slip_wears_by_its_law():
    """To the letter: p_n |s|_i, whatever the traction."""
    for name in ("twin-discs", "twin-discs-isotropic"):
        scene = Scene.builtin(name)
        by_work, letter = (
            Model(scene.with_set([f'solver.slip="{slip}"'])).wear_law for slip in ("auto", "upwind")
        )
        assert isinstance(by_work, ArchardByWork)
        assert letter == Archard(scene.wear.intensity, np.deg2rad(scene.friction.angle))


@dataclass(frozen=True)
class Stripe(ts.Coulomb):
    """Half of the friction for y > 0."""

    def bound(self, pressure, x, y):
        return ts.Bound(np.where(y > 0.0, 0.5, 1.0) * pressure, np.where(y > 0.0, 0.5, 1.0))


FALLING = ts.FallingCoulomb((0.3, 0.3), 0.0, Exponential(0.4, 100.0), 1e3, strength=150.0)


@pytest.mark.parametrize(
    "friction",
    [ts.Coulomb((0.1, 0.1)), ts.ScaledFriction(ts.Coulomb((0.3, 0.3)), 0.4), Stripe(), FALLING],
)
@pytest.mark.parametrize("law", ["archard", {"A": "jendel", "B": "archard"}])
def test_laws_in_place_of_the_scenes_friction_wear_as_they_slip(law, friction):
    """In full slip the depth follows from pressure and slip, whatever the friction is."""
    coefficient = 1e-3 if law == "archard" else {"B": 1e-3}
    scene = Scene.builtin("spheres").replace(
        friction={"mu": 0.3},
        creepage={"longitudinal": -10.0, "speed": 1e3},
        wear={"law": law, "revolutions": 1, "coefficient": coefficient},
        subsurface=None,
        **{"grid.elements": (21, 21), "body.A.hardness": 2e3, "body.B.hardness": 2e3},
    )
    model = Model(scene, laws=ts.Laws.of(scene).replace(friction=friction))
    contact = equilibrium(model)
    fields = contact.pressure, contact.traction, contact.slip
    given = ts.Laws.of(scene).wear.with_friction(ts.Coulomb((0.3, 0.3)), None, None)
    # As if the traction were that of the scene's friction.
    opposed = np.stack((-0.3 * contact.pressure * np.sign(contact.slip[0]), 0.0 * contact.pressure))
    expected = given.rate(contact.pressure, opposed, contact.slip)
    # The slip at the centre and the mean of the faces differ by a ten thousandth.
    np.testing.assert_allclose(model.wear_law.rate(*fields), expected, rtol=1e-3)
