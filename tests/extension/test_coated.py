"""A coated half-space by its response in wave numbers (O'Sullivan & King 1988)."""

from dataclasses import dataclass

import numpy as np
import pytest

import tractive_sam as ts

SCENE = ts.Scene.builtin("spheres").replace(
    friction=None, creepage=None, subsurface=None, grid=None
)
HERTZ, BODIES = SCENE.hertz, ts.Laws.of(SCENE).elasticity
RIGID = ts.Material(np.inf, 0.3)


@dataclass(frozen=True)
class Coated(ts.SpectralHalfSpaces):
    """Body A has a coating bonded to it: its pressure; tractions as without the coating."""

    coating: ts.Material

    @property
    def surface(self):
        return ts.HalfSpaces(self.coating, self.B)

    def spectrum(self, component, kx, ky):
        if component != "zz":
            return None
        shear, below = self.coating.shear / self.A.shear, self.A.poisson
        nu = self.coating.poisson
        a = 1.0 - 4.0 * (1.0 - nu) / (1.0 + shear * (3.0 - 4.0 * below))
        b = (shear - 1.0) / (shear + 3.0 - 4.0 * nu)
        twice = 2.0 * np.hypot(kx, ky) * self.length
        fall = np.exp(-np.minimum(twice, 700.0))
        above = 1.0 + 2.0 * b * twice * fall - a * b * fall**2
        ratio = above / (1.0 - (a + b + b * twice**2) * fall + a * b * fall**2)
        of_coating = ts.HalfSpaces(self.coating, RIGID).response("zz", kx, ky)
        return ratio * of_coating + ts.HalfSpaces(RIGID, self.B).response("zz", kx, ky)


def solved(thickness, stiffer):
    coating = ts.Material(stiffer * BODIES.A.shear, BODIES.A.poisson)
    laws = ts.Laws.of(SCENE).replace(elasticity=Coated(BODIES.A, BODIES.B, thickness, coating))
    return ts.solve(SCENE, laws=laws)


@pytest.mark.slow
@pytest.mark.parametrize("stiffer", [3.0, 0.3])
def test_thick_coating_is_the_body_and_thin_one_is_nothing(stiffer):
    """With G1 = 3 G the pressure under a thick coating is 1.310 p0, by Hertz."""
    whole = ts.HalfSpaces(ts.Material(stiffer * BODIES.A.shear, BODIES.A.poisson), BODIES.B)
    thick = (whole.material.E_star / BODIES.material.E_star) ** (2.0 / 3.0)
    # The substrate below a coating of 50 a is felt by a/h = 0.02 times its difference at most.
    assert solved(50.0 * HERTZ.a, stiffer).p_max / HERTZ.p0 == pytest.approx(thick, rel=2e-3)
    # One of 0.003 a changes the compliance of waves as long as a by about 4 k h = 1.2 %.
    assert solved(0.003 * HERTZ.a, stiffer).p_max / HERTZ.p0 == pytest.approx(1.0, rel=1.2e-2)


@pytest.mark.parametrize(
    ("stiffer", "thickness", "half_length", "approach"),
    [(50.0, 0.1, 1.05, 0.923226), (10.0, 0.164908, 1.05, 0.925010), (0.1, 0.902162, 1.9, 2.107547)],
)
def test_approach_of_a_coating(stiffer, thickness, half_length, approach):
    """The approach is that of a Fredholm equation, whatever the extent of the mesh.

    Rigid sphere, Poisson's ratio 0.3 in the coating and the body below; lengths over the contact
    radius, approach over that of the body without a coating.
    """
    flat = {"young": 1.0, "poisson": 0.3, "radius_x": np.inf, "radius_y": np.inf}
    ball = {"young": 1e6, "poisson": 0.3, "radius_x": 10.0, "radius_y": 10.0}
    bare = ts.Scene(body={"A": flat, "B": ball}, load={"normal": 1e-3})
    bodies = ts.Laws.of(bare).elasticity
    a = bare.hertz.a
    coating = ts.Material(stiffer * bodies.A.shear, 0.3)
    law = Coated(bodies.A, bodies.B, thickness * a, coating)
    laws = ts.Laws.of(bare).replace(elasticity=law)

    def press(extent, **load):
        grid = {"elements": (48 * extent,) * 2, "half_length": (half_length * extent * a,) * 2}
        return ts.solve(bare.replace(grid=grid, load=load), laws=laws)

    small, large = press(1, normal=1e-3), press(2, normal=1e-3)
    # The error of 46 elements across the contact: 1.2e-4.
    assert small.approach / bare.hertz.approach == pytest.approx(approach, rel=3e-4)
    assert large.approach == pytest.approx(small.approach, rel=1e-6)
    # The solutions hold to 1e-8; the load grows with the power 1.5 of the approach.
    assert pytest.approx(1e-3, rel=1e-6) == press(1, approach=small.approach).P


def test_elements_much_longer_than_a_coating_are_refused():
    with pytest.raises(ValueError, match=r"grid\.elements.*body\.A\.layer"):
        solved(0.001 * HERTZ.a, 3.0)


def test_stress_below_a_coating_is_not_that_of_homogeneous_bodies():
    with pytest.raises(ValueError, match=r"Coated.*single_body"):
        ts.stress_maximum(solved(HERTZ.a, 3.0), "A")


@dataclass(frozen=True)
class Graded(ts.SpectralHalfSpaces):
    """Goes over to the surface as 1 - exp(-k h): the displacement has a closed form."""

    above: ts.HalfSpaces

    @property
    def surface(self):
        return self.above

    def spectrum(self, component, kx, ky):
        fall = np.exp(-self.length * np.hypot(kx, ky))
        far = ts.HalfSpaces(self.A, self.B).response(component, kx, ky)
        return fall * far + (1.0 - fall) * self.above.response(component, kx, ky)


@pytest.mark.parametrize("sides", [(0.1, 0.1), (0.2, 0.1)])
def test_coefficients_of_all_components(sides):
    """At a length of three elements both parts of the transform count.

    A unit of load on an element displaces a distant point by (c_f - c_s) at the height of the
    length, and by c_s as the homogeneous half-spaces do (Boussinesq and Cerruti).
    """
    steel, soft = ts.Material(1.0, 0.28), ts.Material(0.3, 0.35)
    above = ts.HalfSpaces(soft, ts.Material(2.0, 0.2))
    graded = Graded(steel, ts.Material(3.0, 0.35), 0.3, above)
    below, offsets = ts.HalfSpaces(graded.A, graded.B), (31, 21)
    x, y = (side * np.arange(n) for side, n in zip(sides, offsets, strict=True))
    x, y, h = x[:, None], y[None, :], graded.length
    r = np.sqrt(x**2 + y**2 + h**2)
    force, far = sides[0] * sides[1] / np.pi, np.hypot(x, y) > 8.0 * max(sides)
    for component in ("xx", "xy", "yy", "zz", "xz", "yz"):
        expected = above.coefficients(component, offsets, *sides)
        for bodies, sign in ((below, 1.0), (above, -1.0)):
            nu, K = bodies.material.poisson, bodies.material.coupling
            kernel = {
                "xx": 1.0 / r - nu * (1.0 / (r + h) - x**2 / (r * (r + h) ** 2)),
                "yy": 1.0 / r - nu * (1.0 / (r + h) - y**2 / (r * (r + h) ** 2)),
                "xy": nu * x * y / (r * (r + h) ** 2),
                "zz": (1.0 - nu) / r,
                "xz": -K * x / (r * (r + h)),
                "yz": -K * y / (r * (r + h)),
            }[component]
            expected = expected + sign * force * kernel / bodies.material.shear
        found = graded.coefficients(component, offsets, *sides)
        # At 8 sides an element is a point to 6 / 24 / 8^2 = 4e-3 of a displacement that falls as
        # the square of the distance, as "xz" does.
        np.testing.assert_allclose(found[far], expected[far], atol=4e-3 * abs(expected[far]).max())
