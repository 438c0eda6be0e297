"""A contact carries the laws that it was solved with, and a file knows them by their content."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

import tractive_sam as ts

SPHERES = ts.Scene.builtin("spheres").with_set(["grid.elements=[25, 25]"])
SLIDING = SPHERES.replace(**{"creepage.longitudinal": -0.02})
DISCS = ts.Scene.builtin("twin-discs").with_set(
    ["wear.revolutions=2", "wear.save=[0, 2]", "grid.elements=[15, 31]"]
)
PLAIN = DISCS.replace(subsurface=None)
LONGER = PLAIN.with_set(["wear.revolutions=4", "wear.save=[0, 2, 4]"])
BODIES = ts.Laws.of(SPHERES).elasticity


@dataclass(frozen=True, eq=False)
class Mapped(ts.Coulomb):
    """Friction that a map weakens; `repr` abbreviates large arrays."""

    factor: np.ndarray | None = None

    def bound(self, pressure, x, y):
        return ts.Bound(self.factor.mean() * pressure, self.factor.mean())


@dataclass(frozen=True)
class Film(ts.Coulomb):
    """A film that carries less of a high pressure: the bound is p_n (1 - p_n/scale)."""

    scale: float = 1.0

    def bound(self, pressure, x, y):
        return ts.Bound(pressure * (1.0 - pressure / self.scale), 1.0 - 2.0 * pressure / self.scale)


@dataclass(frozen=True)
class Stiff(type(BODIES)):
    """Half-spaces that deform half as much: the stress below them is not known."""

    def coefficients(self, component, offsets, dx, dy):
        return 0.5 * super().coefficients(component, offsets, dx, dy)


def law(scene, **laws):
    return ts.Laws.of(scene).replace(**laws)


def solved(friction):
    return ts.solve(SLIDING, laws=law(SLIDING, friction=friction))


@pytest.mark.parametrize("friction", [ts.Coulomb((0.1, 0.1)), Film((0.2, 0.1), 0.3, scale=0.1)])
def test_what_slides_is_on_the_bound_of_its_own_law(friction):
    contact = solved(friction)
    used = contact.utilisation[contact.touching] / contact.bound[contact.touching]
    np.testing.assert_allclose(used, 1.0, rtol=1e-6)  # of the solver: 1e-8 of the largest
    assert contact.stick_fraction == 0.0
    by_traction = contact.with_sliding_by_traction().sliding
    np.testing.assert_array_equal(by_traction, contact.sliding)


def test_figures_take_the_law_of_the_contact():
    contact = solved(ts.Coulomb((0.1, 0.1)))
    title = ts.plot.traction(contact).get_suptitle()
    assert "0.1" in title
    assert "0.4013" not in title


@pytest.mark.parametrize("stored", [False, True])
def test_a_record_keeps_the_bound_and_the_frame(tmp_path, stored):
    film = law(PLAIN, friction=Film((0.4, 0.3), 0.2, scale=5000.0))
    path = tmp_path / "film.h5" if stored else None
    history = ts.roll(PLAIN, path, laws=film)
    read, contact = history.state(0), ts.solve(PLAIN, laws=film)
    assert read.frame == contact.frame == film.friction.frame
    np.testing.assert_allclose(read.bound, contact.bound, rtol=1e-6, atol=1e-6 * contact.p_max)


def test_no_bound_is_stored_where_it_is_the_pressure():
    assert "traction_bound" not in ts.roll(PLAIN).fields


def test_the_bound_follows_when_a_block_waits_or_a_roll_resumes(tmp_path):
    film = law(PLAIN, friction=Film((0.4, 0.3), 0.2, scale=5000.0))
    ts.roll(PLAIN, tmp_path / "film.h5", laws=film)
    whole = ts.roll(LONGER, laws=film)
    resumed = ts.roll(LONGER, tmp_path / "film.h5", laws=film, resume=True)
    np.testing.assert_allclose(resumed["Qx"], whole["Qx"], rtol=1e-7)  # solver tolerance 1e-8
    ends = resumed.state(4).bound, whole.state(4).bound
    np.testing.assert_allclose(*ends, atol=1e-6 * whole["p_max"][-1])


def test_stress_is_that_of_the_bodies_that_were_solved(tmp_path):
    plain = ts.solve(PLAIN)
    layered = law(PLAIN, elasticity=ts.InterfacialLayer(ts.Laws.of(PLAIN).elasticity, 1e-5))
    contact = ts.solve(PLAIN, laws=layered)
    depths = [(0.0, 0.0, 0.1)]
    given = ts.stress_at(contact, depths, laws=ts.Laws.of(PLAIN))
    np.testing.assert_array_equal(ts.stress_at(contact, depths), given)
    ts.roll(PLAIN, tmp_path / "layer.h5", laws=layered)
    read = ts.open_history(tmp_path / "layer.h5").state(0)
    with pytest.raises(ValueError, match="laws"):
        ts.stress_at(read, depths)
    np.testing.assert_allclose(ts.stress_at(read, depths, laws=layered), given, rtol=1e-6)
    assert np.isfinite(ts.stress_at(plain, depths)).all()


def test_bodies_with_other_coefficients_have_no_stress_of_homogeneous_ones():
    contact = ts.solve(SPHERES, laws=law(SPHERES, elasticity=Stiff(BODIES.A, BODIES.B)))
    assert contact.approach == pytest.approx(
        0.63 * ts.solve(SPHERES).approach, rel=1e-2
    )  # 2^(-2/3)
    with pytest.raises(ValueError, match=r"Stiff.*single_body"):
        ts.stress_maximum(contact, "A")
    with pytest.raises(ValueError, match=r"Stiff.*single_body"):
        ts.roll(DISCS, laws=law(DISCS, elasticity=Stiff(BODIES.A, BODIES.B)))


class TestFingerprint:
    def test_every_number_of_an_array_counts(self):
        weak = np.ones((41, 41))
        weak[20, 20] = 0.5
        one, other = Mapped(factor=np.ones((41, 41))), Mapped(factor=weak)
        assert repr(one) == repr(other)
        assert one.fingerprint() != other.fingerprint()
        assert one.fingerprint() == replace(one, factor=np.ones((41, 41))).fingerprint()

    def test_equal_numbers_of_other_types_are_equal(self):
        laws = ts.Coulomb((0.5, 1.0)), ts.Coulomb((np.float64(0.5), 1))
        assert len({one.fingerprint() for one in laws}) == 1

    def test_code_of_functions_counts(self):
        @dataclass(frozen=True)
        class Given(ts.Coulomb):
            share: object = None

        assert Given(share=lambda p: p).fingerprint() != Given(share=lambda p: 2 * p).fingerprint()

    def test_cached_values_do_not(self):
        bodies = ts.Laws.of(SPHERES).elasticity
        before = bodies.fingerprint()
        assert bodies.material.E_star > 0.0
        assert bodies.fingerprint() == before == ts.Laws.of(SPHERES).elasticity.fingerprint()

    def test_a_law_of_other_content_does_not_resume(self, tmp_path):
        one, other = (Mapped((0.6, 0.3), 0.0, np.full((41, 41), k)) for k in (1.0, 0.2))
        ts.roll(PLAIN, tmp_path / "map.h5", laws=law(PLAIN, friction=one))
        with pytest.raises(ts.ResultsError, match="laws"):
            ts.roll(LONGER, tmp_path / "map.h5", laws=law(PLAIN, friction=other), resume=True)
        resumed = ts.roll(LONGER, tmp_path / "map.h5", laws=law(PLAIN, friction=one), resume=True)
        assert resumed.finished


def test_a_law_of_wear_of_another_package_has_no_wear_balance(tmp_path):
    """A name in a text decided it once; the record of a law does now."""

    class Named(ts.WearLaw):
        def rate(self, pressure, traction, slip):
            return 1e-6 * pressure * np.hypot(*slip)

    class Wearing(ts.HalfSpaces):
        def describe(self):
            return "Wearing(wear=0)"

    own = ts.roll(PLAIN, laws=law(PLAIN, wear=Named()))
    assert np.isnan(own.wear_balance).all()
    # Wear by work depends on the coefficients, which another law of friction does not state.
    scaled = ts.ScaledFriction(ts.Laws.of(PLAIN).friction, 0.5)
    assert np.isnan(ts.roll(PLAIN, laws=law(PLAIN, friction=scaled)).wear_balance).all()
    bodies = ts.Laws.of(PLAIN).elasticity
    same = ts.roll(PLAIN, laws=law(PLAIN, elasticity=Wearing(bodies.A, bodies.B)))
    np.testing.assert_allclose(same.wear_balance[1:], 1.0, rtol=1e-7)  # of work: ten residuals
