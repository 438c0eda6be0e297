"""Figures of what rolling does to the material."""

import numpy as np
import pytest

import tractive_sam as ts
from tests.plot.rendering import render
from tractive_sam import plot
from tractive_sam.mechanics import residual_shear, von_mises
from tractive_sam.plot.fatigue import LINE_CONTACT
from tractive_sam.reference import line_pressure_stress, line_shear_stress

ASKED = {"shear_yield": 300.0, "sensitivity": 0.333, "limit": 250.0, "elements": 12}


@pytest.fixture(scope="module")
def tired():
    settings = ["grid.elements=[15, 31]", "wear.revolutions=20", "wear.save=[0, 5, 20]"]
    scene = ts.Scene.builtin("twin-discs").with_set(settings)
    return ts.roll(scene.replace(subsurface=None, fatigue=ASKED))


def test_a_last_record_that_was_not_solved_is_left_out():
    settings = ["grid.half_length=[0.35, 0.54]", "grid.elements=[15, 15]", "wear.intensity=2e-5"]
    scene = ts.Scene.builtin("twin-discs").with_set(
        [*settings, "wear.revolutions=400", "wear.save=[0]"]
    )
    history = ts.roll(scene.replace(subsurface=None, fatigue=ASKED))
    assert history.status == "off grid"
    figure = render(plot.wear_against_fatigue(history, "A"))
    wear, balance = figure.axes[0].lines
    assert np.isfinite(wear.get_ydata()).any()
    assert np.isfinite(balance.get_ydata()).any()


@pytest.mark.slow
@pytest.mark.parametrize(
    "draw",
    [
        plot.shakedown_map,
        plot.utilisation,
        plot.damage,
        plot.fatigue_course,
        plot.wear_against_fatigue,
    ],
)
def test_figures(draw, tired):
    figure = render(draw(tired))
    assert figure.get_suptitle().startswith("Twin discs")
    box = figure.get_tightbbox()
    width, height = figure.get_size_inches()
    assert -0.01 < box.x0 < box.x1 < width + 0.01
    assert -0.01 < box.y0 < box.y1 < height + 0.01


def test_the_classic_curves_are_those_of_the_closed_form():
    x = np.linspace(-4.0, 4.0, 801)[:, None]
    for mu, first, inside, surface in LINE_CONTACT[::4]:

        def cycle(depths, mu=mu):
            arguments = (x, np.asarray(depths), 1.0, 1.0)
            stress = line_pressure_stress(*arguments, 0.3)
            stress = stress + mu * line_shear_stress(*arguments, 0.3)
            return np.concatenate((stress, np.zeros_like(stress[:, :1])), axis=1)

        depths = np.linspace(0.3, 0.6, 31)
        below, top = cycle(depths), cycle([0.0])
        left = max(residual_shear(below[..., k : k + 1])[0] for k in range(depths.size))
        deep = cycle(np.linspace(0.4, 0.9, 26))
        yields = max(von_mises(deep).max(), von_mises(top).max()) / 3.0**0.5
        # Points are .01 apart, depths .01 and .02.
        assert 1.0 / left == pytest.approx(inside, rel=2e-3)
        assert 1.0 / residual_shear(top)[0] == pytest.approx(surface, rel=2e-3)
        assert 1.0 / yields == pytest.approx(first, rel=2e-3)


def test_the_map_shows_the_place_of_the_roll(tired):
    (axes,) = plot.shakedown_map(tired).axes
    (course,) = [line for line in axes.lines if line.get_color() == "black"][:1]
    np.testing.assert_allclose(course.get_ydata(), tired["p_max"] / 300.0)


def test_what_lacks_is_reported():
    plain = ts.roll(ts.Scene.builtin("spheres").with_set(["grid.elements=[15, 15]"]))
    for draw in (plot.shakedown_map, plot.damage, plot.utilisation, plot.wear_against_fatigue):
        with pytest.raises((ValueError, LookupError), match="fatigue"):
            draw(plain)
    with pytest.raises(ValueError, match="fatigue"):
        plot.fatigue_course(plain)


@pytest.mark.slow
@pytest.mark.usefixtures("empty_pictures")
def test_a_history_has_them_among_its_figures(tired, tmp_path):
    names = {path.stem for path in plot.save_all(tired, tmp_path, dpi=30)}
    assert names >= {
        "shakedown-map",
        "fatigue-course",
        "utilisation-A",
        "damage-A",
        "damage-B",
        "wear-against-fatigue-B",
    }


@pytest.mark.slow
@pytest.mark.usefixtures("empty_pictures")
def test_a_line_contact_has_them_too(tmp_path):
    scene = ts.Scene.builtin("cylinders").replace(subsurface=None, fatigue=ASKED)
    names = {path.stem for path in plot.save_all(ts.roll(scene), tmp_path, dpi=30)}
    assert names >= {"shakedown-map", "utilisation-A"}


def test_the_limit_is_marked_in_line_contacts():
    """The places at which the equivalent stress is the limit follow from the depths alone."""
    scene = ts.Scene.builtin("cylinders").with_set(["grid.elements=41"])
    limited = scene.replace(subsurface=None, wear=None, fatigue=ASKED)
    (top,) = ts.roll(limited)["utilisation"][:, 0]
    limited = limited.with_set([f"fatigue.limit={0.5 * top * ASKED['limit']:.6g}"])
    history = ts.roll(limited)
    figure = render(plot.utilisation(history, "A"))
    axes, found = figure.axes[0], history.fatigue("A")
    (contour,) = [one for one in axes.collections if hasattr(one, "levels")]
    marked = np.unique(np.concatenate([path.vertices[:, 1] for path in contour.get_paths()]))
    depths = found.depth / plot.Scale.from_history(history).length
    # Drawn by interpolation in the root of the depth, read here in the depth itself: the limit lies
    # between two of 12 depths, over which the utilisation changes by some tenths.
    at_limit = np.interp(marked, depths, found.utilisation[0])
    assert marked.size
    assert at_limit == pytest.approx(1.0, abs=0.05)
    assert axes.get_xlabel() == "line contact"
