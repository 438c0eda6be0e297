"""No figure is cut: nothing that is drawn touches the border of its picture."""

import io

import matplotlib.image
import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam import plot
from tractive_sam.plot.figure import LOOK, Figure, apply_style, set_title

ROUND = ("grid.elements=[15, 15]", "grid.half_length=[4.08, 4.08]")
WEAR = ("wear.coefficient=1e-4", "wear.revolutions=4", "wear.save=[0, 4]")

SCENES = {
    "wear": ts.Scene.builtin("spheres").with_set([*ROUND, *WEAR]),
    "line": ts.Scene.builtin("cylinders"),
    "transient": ts.Scene.builtin("fretting").with_set(["grid.elements=[15, 15]"]),
    "heat": ts.Scene.builtin("hot-discs").with_set(["grid.elements=[15, 15]"]),
}


def touches_border(picture):
    """Whether any of the outermost pixels of a picture is not white."""
    dark = matplotlib.image.imread(picture)[..., :3].min(axis=2) < 0.95  # below: ink, not rounding
    return bool(np.concatenate([dark[0], dark[-1], dark[:, 0], dark[:, -1]]).any())


@pytest.mark.slow
@pytest.mark.parametrize("kind", SCENES)
def test_no_figure_of_a_history_touches_its_border(kind, tmp_path):
    history = ts.roll(SCENES[kind])
    paths = plot.save_all(history, tmp_path, dpi=60)
    assert paths
    assert not [path.stem for path in paths if touches_border(path)]


@apply_style
def axes_up_to(top):
    """Draw empty axes of forces over revolutions, with an upper limit in y."""
    figure = Figure(figsize=(LOOK.width, 0.66 * LOOK.width))
    axes = figure.add_subplot(xlim=(0, 15000), ylim=(0.057, top))
    axes.set(xlabel="revolutions $N$", ylabel="force / normal load")
    axes.xaxis.set_major_formatter("{x:,.0f}")
    set_title(figure, "two lines\nof a title")
    return figure


@pytest.mark.slow
def test_labels_stay_inside_where_ticks_depend_on_the_layout():
    """Near 0.45 the layout alternates between labels of one and of two decimals."""
    for top in np.linspace(0.448, 0.46, 7):
        picture = io.BytesIO()
        axes_up_to(top).savefig(picture, format="png", dpi=80)
        picture.seek(0)
        assert not touches_border(picture), top
