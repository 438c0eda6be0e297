"""A user-defined stress criterion: Tresca, in the maxima, in a history, on planes, in figures."""

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam import plot, reference


class Tresca(ts.StressCriterion):
    name, symbol = "tresca", r"\sigma_\mathrm{T}"
    long_name = "equivalent stress of Tresca"

    def __call__(self, stress):
        return 2.0 * reference.max_shear(stress)


DISCS = ts.Scene.builtin("twin-discs").with_set(
    ["grid.elements=[21, 31]", "wear.revolutions=2", "wear.save=[0, 2]"]
)


def laws(scene):
    return ts.Laws.of(scene).replace(criterion=Tresca())


def test_largest_shear_stress_below_a_line():
    """0.300 p0 at 0.786 a (Johnson 1985, section 4.2)."""
    scene = ts.Scene.builtin("cylinders").replace(friction=None, creepage=ts.Creepage())
    top = ts.stress_maximum(ts.solve(scene), "A", laws(scene))
    assert top.criterion.name == "tresca"
    # As printed, to half a digit.
    assert top.interior / 2 / scene.hertz.p0 == pytest.approx(0.300, abs=5e-4)
    assert top.interior_at[2] / scene.hertz.a == pytest.approx(0.786, abs=5e-3)


@pytest.mark.parametrize("body", ["A", "B"])
def test_it_is_nowhere_larger_than_its_maximum(body):
    scene = ts.Scene.builtin("spheres")
    contact = ts.solve(scene)
    top = ts.stress_maximum(contact, body, laws(scene))
    stress = ts.stress_on_plane(contact, "y=0", body)
    below = stress.depth > contact.grid.dx
    # At an edge of the criterion the search ends a little beside it: 1e-4 here.
    assert stress.by(Tresca())[:, below].max() < 1.001 * top.value
    there = Tresca()(ts.stress_at(contact, [top.interior_at], body).T)
    # Elements that are far are taken together.
    assert there[0] == pytest.approx(top.interior, rel=1e-4)


def test_columns_are_named_by_it(tmp_path):
    kept = ts.roll(DISCS, laws=laws(DISCS))
    stored = ts.roll(DISCS, tmp_path / "discs.h5", laws=laws(DISCS))
    for history in (kept, stored, ts.open_history(tmp_path / "discs.h5")):
        assert not [name for name in history.columns if name.startswith("von_mises")]
        np.testing.assert_array_equal(history["tresca_max"], kept["tresca_max"])
        assert history["tresca_max_at"].shape == (len(history), 2, 3)
        assert history.columns["tresca_max"].symbol == Tresca.symbol
    by_von_mises = ts.roll(DISCS)["von_mises_max"]
    share = kept["tresca_max"] / by_von_mises
    # Tresca's hexagon around the ellipse of von Mises; rounding at its corners.
    assert ((share > 1.0 - 1e-3) & (share < 2.0 / np.sqrt(3.0) + 1e-3)).all()


def test_a_file_continues_with_the_same_criterion_only(tmp_path):
    path, short = tmp_path / "discs.h5", DISCS.with_set(["wear.revolutions=1", "wear.save=[0]"])
    assert "Tresca" in ts.roll(short, path, laws=laws(short)).laws
    with pytest.raises(ts.ResultsError, match="Tresca"):
        ts.roll(DISCS, path, resume=True)
    whole = ts.roll(DISCS, path, resume=True, laws=laws(DISCS))
    np.testing.assert_array_equal(
        whole["tresca_max"], ts.roll(DISCS, laws=laws(DISCS))["tresca_max"]
    )


def test_error_bars_are_named_by_it():
    scene = ts.Scene.builtin("spheres").replace(grid=None, accuracy={"tolerance": 0.1})
    contact = ts.solve(scene, laws=laws(scene))
    assert set(contact.error_bars["tresca_max"]) == set(scene.subsurface.bodies)
    assert "von_mises_max" not in contact.error_bars


@pytest.mark.slow
@pytest.mark.usefixtures("empty_pictures")
def test_figures_are_plotted_by_it(tmp_path):
    contact = ts.solve(DISCS.replace(wear=None))
    for figure in (
        plot.von_mises_section(contact, "A", "y=0", quantity=Tresca()),
        plot.von_mises_sections(contact, "y=0", quantity=Tresca()),
    ):
        assert any(Tresca.symbol in axes.get_ylabel() for axes in figure.axes)
    history = ts.roll(DISCS, laws=laws(DISCS))
    assert Tresca.symbol in plot.stress_course(history).axes[0].get_ylabel()
    assert "tresca-max.png" in {path.name for path in plot.save_all(history, tmp_path)}
