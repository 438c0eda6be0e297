"""Figures of duty cycles and of wear laws."""

import numpy as np
import pytest
from matplotlib.colors import to_rgb

import tractive_sam as ts
from tractive_sam import plot
from tractive_sam.plot.figure import LOOK, line_colours

DISCS = ts.Scene.builtin("twin-discs").replace(subsurface=None)
DISCS = DISCS.with_set(
    ["grid.half_length=[0.42, 0.9]", "grid.elements=[15, 25]", "wear.revolutions=20"]
)
BLOCKS = (
    {"name": "heavy", "revolutions": 1, "load": {"normal": 450.0}},
    {"revolutions": 1, "shift_y": 0.1},
)


@pytest.fixture(scope="module")
def spectrum():
    few = {"planes": ["x=0"], "elements": 4}
    return ts.roll(DISCS.replace(duty=BLOCKS, subsurface=few))


def labels(figure):
    return [text.get_text() for legend in figure.legends for text in legend.get_texts()]


def test_blocks_are_named_and_add_up(spectrum):
    figure = plot.worn_by_block(spectrum)
    assert labels(figure) == ["heavy", "duty[1]"]
    (line,) = figure.axes[0].lines
    np.testing.assert_allclose(line.get_ydata(), 1e3 * spectrum["entering_profile"][-1], rtol=1e-9)
    assert labels(plot.block_shares(spectrum)) == ["heavy", "duty[1]"]


def test_elements_lie_on_the_law():
    history = ts.roll(DISCS.with_set(["wear.law=usfd"]))
    axes = plot.wear_regimes(history).axes[0]
    dots, law = axes.lines[:2]
    work, rate = dots.get_data()
    assert work.size > 20
    np.testing.assert_allclose(rate, np.where(work < 10.4, 5.3 * work, 55.0), rtol=1e-9)
    assert law.get_label() == "law"


def test_elements_of_a_warm_contact_lie_aside_of_the_law():
    """By the factor that the temperature gives their wear."""
    warm = ["creepage.speed=2000", "heat.bulk=20", "wear.temperature=[[0, 2], [9000, 2]]"]
    laws = ['wear.law={A="usfd", B="archard"}', "wear.coefficient.B=1e-3"]
    history = ts.roll(DISCS.with_set(["wear.revolutions=1", *laws, *warm]))
    figure = plot.wear_regimes(history)
    work, rate = figure.axes[0].lines[0].get_data()
    np.testing.assert_allclose(rate, 2.0 * np.where(work < 10.4, 5.3 * work, 55.0), rtol=1e-9)
    assert labels(figure) == ["A", "B", "law, without heat"]


def test_each_body_has_its_dots():
    settings = ['wear.law={A="usfd", B="archard"}', "wear.coefficient.B=1e-3"]
    figure = plot.wear_regimes(ts.roll(DISCS.with_set(settings)))
    assert labels(figure) == ["A", "B", "law"]


@pytest.mark.slow
@pytest.mark.usefixtures("empty_pictures")
def test_every_figure_of_a_cycle_is_saved(spectrum, tmp_path):
    paths = plot.save_all(spectrum, tmp_path, dpi=30, blocks=[1])
    assert all(path.exists() for path in paths)
    names = {path.relative_to(tmp_path).as_posix() for path in paths}
    assert {"worn-by-block.png", "block-shares.png", "wear-regimes.png"} <= names
    assert {"block-1/forces.png", "block-1/pressure-20.png", "block-1/von-mises-x0-20.png"} <= names
    assert not any(name.startswith("block-0/") for name in names)


def test_a_block_that_is_not_there_is_reported_before_any_figure(spectrum, tmp_path):
    with pytest.raises(LookupError, match="heavy"):
        plot.save_all(spectrum, tmp_path / "none", blocks=["light"])
    assert not (tmp_path / "none").exists()


def test_many_blocks_have_colours_of_their_own():
    lines = list(LOOK.lines)
    assert line_colours(6) == [to_rgb(one) for one in lines]
    assert len(set(line_colours(30))) == 30
    duty = [{"revolutions": 1, "load": {"normal": 300.0 + k}} for k in range(14)]
    history = ts.roll(DISCS.with_set(["wear.revolutions=14"]).replace(duty=duty))
    figure = plot.block_shares(history)
    assert len({tuple(one.get_facecolor()[0]) for one in figure.axes[0].collections}) == 14
    figure.draw_without_rendering()
    legend = figure.legends[0].get_window_extent()
    assert 0.0 <= legend.y0 < legend.y1 <= figure.bbox.height


def test_nothing_to_draw():
    with pytest.raises(ValueError, match="duty"):
        plot.worn_by_block(ts.roll(DISCS))
    with pytest.raises(ValueError, match="element"):
        plot.wear_regimes(ts.solve(DISCS.with_set(["creepage.longitudinal=0"])))
