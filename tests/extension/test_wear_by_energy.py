"""A user-defined wear law: wear by the energy that friction dissipates."""

from dataclasses import dataclass

import numpy as np
import pytest

import tractive_sam as ts

MU, PER_ENERGY = 0.3, 5e-6
"""Coefficient of friction, and depth over dissipated energy per area, 1/MPa."""

DISCS = ts.Scene.builtin("twin-discs").with_set(
    [
        f"friction.mu={MU}",
        f"wear.intensity={PER_ENERGY * MU}",
        "wear.revolutions=300",
        "wear.save=[0, 300]",
        "grid.elements=[21, 41]",
    ]
)
DISCS = DISCS.replace(subsurface=None)
SLIDING = DISCS.with_set(["creepage.longitudinal=-0.02"])


@dataclass(frozen=True)
class ByEnergy(ts.WearLaw):
    """Depth per distance rolled, k |p_t . s|."""

    per_energy: float

    def rate(self, pressure, traction, slip):
        return self.per_energy * np.abs((traction * slip).sum(axis=0))


def laws(scene, per_energy=PER_ENERGY):
    return ts.Laws.of(scene).replace(wear=ByEnergy(per_energy))


@pytest.fixture(scope="module")
def partly():
    """Twin discs that stick in part, by energy."""
    return ts.roll(DISCS, laws=laws(DISCS))


def test_it_rolls_in_jumps(partly):
    assert partly.finished, partly.message
    assert partly["revolution"][-1] == 300
    assert len(partly) < 100
    assert (np.diff(partly["wear_max"]) > 0.0).all()


def test_the_worn_section_is_the_work(partly):
    # Elements of negative work wear by its magnitude: none or few.
    wanted = PER_ENERGY * partly["dissipation"][1:]
    np.testing.assert_allclose(partly["worn_area"][1:], wanted, rtol=1e-4)
    # No energy is lost, so that the work supplied wears as much.
    np.testing.assert_allclose(partly.energy_balance, 1.0, rtol=1e-8)


def test_the_balance_of_archard_is_not_reported(partly):
    assert np.isnan(partly.wear_balance).all()


def test_in_full_slip_it_is_that_of_archard():
    by_energy, archard = ts.roll(SLIDING, laws=laws(SLIDING)), ts.roll(SLIDING)
    state = by_energy.state(300)
    # Except at the rim, as wide as the tolerance of the solver permits.
    assert state.sliding.sum() >= 0.99 * state.touching.sum()
    # p_t . s = mu p_n |s|, as slip and traction are parallel: to the residual of the contact.
    sliding = PER_ENERGY * MU * state.pressure * np.hypot(*state.slip)
    section = sliding.sum() * state.grid.element_area
    assert by_energy["worn_area"][-1] == pytest.approx(section, rel=1e-4)
    # One law by two formulas; jumps that differ in the last digits do not differ in more.
    np.testing.assert_array_equal(by_energy["revolution"], archard["revolution"])
    np.testing.assert_allclose(by_energy["wear_max"], archard["wear_max"], rtol=1e-6)


def test_depth_grows_with_the_law():
    single = DISCS.with_set(["wear.revolutions=1", "wear.save=[0, 1]"])
    once, twice = (ts.roll(single, laws=laws(single, k))["worn_area"][-1] for k in (1e-9, 2e-9))
    # So little wear changes nothing of the contact.
    assert twice == pytest.approx(2.0 * once, rel=1e-5)


def test_a_file_is_rolled_on_by_the_same_law_only(tmp_path):
    path, half = tmp_path / "a.h5", DISCS.with_set(["wear.revolutions=20", "wear.save=[0, 20]"])
    ts.roll(half, path, laws=laws(half))
    longer = half.with_set(["wear.revolutions=40", "wear.save=[0, 20, 40]"])
    for other in (None, laws(longer, 2.0 * PER_ENERGY)):
        with pytest.raises(ts.ResultsError, match="laws"):
            ts.roll(longer, path, resume=True, laws=other)
    assert ts.roll(longer, path, resume=True, laws=laws(longer)).finished
