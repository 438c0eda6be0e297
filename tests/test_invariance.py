"""Results of small random scenes do not change if only their description does.

The scenes and their changes come from benchmarks/invariance.py, which compares more of them.
"""

from pathlib import Path

import pytest

pytestmark = pytest.mark.filterwarnings(
    "ignore::tractive_sam.schema.SceneWarning"  # few elements
)

KINDS = (
    *("steady", "gentle", "hard", "forced", "gap", "line", "falling", "heat"),
    *("wear", "adaptive", "duty", "fatigue", "transient", "shift"),
    *("layered", "relaxing", "anisotropic", "roller", "conformal", "included"),
)

SLOW = (
    *("adaptive", "duty", "fatigue", "heat", "shift", "wear"),
    *("relaxing", "conformal", "included"),
)


@pytest.fixture
def invariance(monkeypatch):
    monkeypatch.syspath_prepend(Path(__file__).parents[1] / "benchmarks")
    import invariance  # noqa: PLC0415 - not on the path before

    return invariance


def test_every_kind_is_tested(invariance):
    assert set(KINDS) == set(invariance.KINDS)


@pytest.mark.parametrize(
    "kind",
    [pytest.param(kind, marks=pytest.mark.slow if kind in SLOW else ()) for kind in KINDS],
)
def test_results_follow_the_change_of_the_description(invariance, kind):
    """Mirror image, bodies exchanged, other units, axes exchanged, other steps and records."""
    scene = invariance.random_scene(kind, seed=2, number=KINDS.index(kind))
    rows = list(invariance.compared(scene))
    assert any(row["change"] == "mirror" for row in rows), rows
    assert not [row for row in rows if not row["holds"]]


def test_a_change_that_matters_is_found(invariance):
    """A mirror image that forgets the angle of friction is another scene."""
    from scene_changes import MIRROR, Outcome  # noqa: PLC0415 - as above

    scene = invariance.random_scene("steady", seed=2, number=0)
    mirrored = MIRROR.scene(scene)
    wrong = mirrored.replace(**{"friction.angle": scene.friction.angle})
    found = MIRROR.back(Outcome.of(wrong))
    rows = invariance.differences(Outcome.of(scene), found)
    apart = {name: value for _, name, value in rows}
    assert apart["Qx"] > 1e-3
