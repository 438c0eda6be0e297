"""A law of wear that depends on the depth worn so far, or on the revolution: running-in."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

import tractive_sam as ts

DISCS = ts.Scene.builtin("twin-discs").replace(subsurface=None)
LAST = 200
DISCS = DISCS.with_set(
    [f"wear.revolutions={LAST}", f"wear.save=[0, {LAST}]", "grid.elements=[15, 31]"]
)


@dataclass(frozen=True)
class RunningIn(ts.WearLaw):
    """Wear by work that falls from k0 to k1, 1/MPa, as the surfaces wear down by depths E0, mm."""

    k0: float = 2e-5
    k1: float = 2e-6
    E0: float = 5e-4
    k: float | np.ndarray = 2e-5

    def under(self, conditions):
        share = np.exp(-conditions.depth / self.E0)
        return replace(self, k=self.k1 + (self.k0 - self.k1) * share)

    def rate(self, pressure, traction, slip):
        return self.k * np.maximum(-(traction * slip).sum(axis=0), 0.0)


@dataclass(frozen=True)
class Decaying(RunningIn):
    """Running-in over revolutions N in place of the depth."""

    N0: float = 50.0

    def under(self, conditions):
        share = np.exp(-conditions.revolution / self.N0)
        return replace(self, k=self.k1 + (self.k0 - self.k1) * share)


def rolled(law, scene=DISCS, path=None, **options):
    return ts.roll(scene, path, laws=ts.Laws.of(scene).replace(wear=law), **options)


@pytest.mark.slow
@pytest.mark.parametrize("law", [RunningIn(), Decaying()])
def test_adaptive_jumps_wear_as_every_revolution_does(law):
    adaptive = rolled(law)
    every = rolled(law, DISCS.with_set(["wear.stepping=every-revolution"]))
    found, expected = (one["wear_profile"][-1] for one in (adaptive, every))
    # The tolerance of the stepping, 1e-3 of the depth, bounds an estimate: thrice as much.
    np.testing.assert_allclose(found, expected, atol=3e-3 * expected.max())
    assert adaptive.totals["contact_solves"] < 0.5 * every.totals["contact_solves"]
    least = rolled(replace(law, k0=law.k1))["wear_max"][-1]
    assert expected.max() > 1.5 * least  # it did run in


def test_rate_is_that_of_the_revolution():
    few = DISCS.with_set(["wear.revolutions=3", "wear.save=[3]", "wear.stepping=every-revolution"])
    law = Decaying(N0=2.0)
    history = rolled(law, few)
    k = law.k1 + (law.k0 - law.k1) * np.exp(-history["revolution"][1:] / law.N0)
    np.testing.assert_allclose(history["worn_area"][1:], k * history["dissipation"][1:], rtol=1e-2)


@dataclass(frozen=True)
class Warm(RunningIn):
    """Wear by work in proportion to the temperature, k0 in 1/(MPa K)."""

    def under(self, conditions):
        return replace(self, k=self.k0 * conditions.temperature)


@pytest.mark.parametrize("method", ["auto", "uzawa"])
def test_rate_is_that_of_the_temperature(method):
    hot = ts.Scene.builtin("hot-discs").with_set(
        ["grid.elements=[13, 15]", "wear.coefficient=1e-3", "wear.revolutions=1", "wear.save=[1]"]
    )
    hot = hot.replace(**{"friction.temperature": None, "solver.method": method})
    law = Warm(k0=1e-8)
    history = rolled(law, hot)
    rate = history["worn_area"][-1] / history["dissipation"][-1]
    # Material that slips is at least as warm as the bulk, and somewhere hotter by 100 K.
    assert 1.1 * law.k0 * hot.heat.bulks["A"] < rate < law.k0 * history["temperature_max"][-1]


@pytest.mark.parametrize("law", [RunningIn(), pytest.param(Decaying(), marks=pytest.mark.slow)])
def test_resumed_run_is_the_whole_one(tmp_path, law):
    half = DISCS.with_set([f"wear.revolutions={LAST // 2}", f"wear.save=[{LAST // 2}]"])
    whole = DISCS.with_set([f"wear.save=[{LAST // 2}, {LAST}]"])
    rolled(law, half, tmp_path / "in.h5")
    resumed = rolled(law, whole, tmp_path / "in.h5", resume=True)["wear_profile"][-1]
    expected = rolled(law, whole)["wear_profile"][-1]
    np.testing.assert_allclose(resumed, expected, atol=1e-6 * expected.max())  # solver: 1e-8


@pytest.mark.slow
def test_each_block_of_a_duty_cycle_runs_in():
    blocks = [{"revolutions": 1}, {"revolutions": 1, "load": {"normal": 200.0}}]
    cycle = DISCS.replace(duty=blocks)
    found = [
        rolled(RunningIn(), cycle.with_set([f"wear.stepping={one}"]))["wear_profile"][-1]
        for one in ("adaptive", "every-revolution")
    ]
    np.testing.assert_allclose(*found, atol=6e-3 * found[1].max())  # blocks in turn, or their mean


def test_each_body_runs_in_by_itself():
    law = RunningIn()
    both = rolled(ts.PerBody(A=law, B=replace(law, k0=law.k1)))
    worn = [both[f"wear_profile_{body}"][-1].max() for body in "AB"]
    assert worn[0] > 1.5 * worn[1]


def test_material_runs_in_within_a_transient():
    scene = DISCS.replace(
        wear={"intensity": 1e-6}, transient={"distance": [0.0, 0.5], "start": "steady"}
    )
    law = RunningIn(E0=1e-6)
    new, run_in, between = (
        rolled(one, scene)["step_worn"][-1]
        for one in (replace(law, E0=np.inf), replace(law, k0=law.k1), law)
    )
    assert run_in < between < new
