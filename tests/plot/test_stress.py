import numpy as np
import pytest

from tests.plot.rendering import render
from tests.scenes import steady
from tractive_sam import plot
from tractive_sam.plot import stress
from tractive_sam.plot.stress import stress_maxima
from tractive_sam.results.history import History
from tractive_sam.results.record import Record
from tractive_sam.subsurface import stress_maximum, stress_on_plane, stress_on_planes


@pytest.fixture(scope="module")
def contact():
    return steady("spheres", elements=31)


@pytest.fixture(scope="module")
def turned():
    """With traction in y as well."""
    return steady("spheres-orthotropic", elements=31)


def reported(figure):
    """Lines of the legend."""
    return [text.get_text() for text in figure.legends[0].get_texts()]


def marked(axes):
    """Positions of the marks."""
    return [
        tuple(np.ravel(line.get_xydata())) for line in axes.lines if line.get_marker() != "None"
    ]


def test_both_maxima_are_marked_where_they_are(contact):
    figure = render(plot.von_mises_section(contact))
    axes, bar = figure.axes
    maximum, hertz = stress_maximum(contact, "A"), contact.scene.hertz
    interior, surface = marked(axes)
    # Marks are at the points of the plane: an element in x, depths 0.03 a apart near the maximum.
    assert interior[0] == pytest.approx(maximum.interior_at[0] / hertz.a, abs=contact.grid.dx)
    assert interior[1] == pytest.approx(-maximum.interior_at[2] / hertz.a, abs=0.03)
    plane = stress_on_plane(contact, "y=0")
    at_surface = plane.von_mises[:, 0] / hertz.p0
    place = plane.axes["x"][at_surface.argmax()] / hertz.a
    assert surface == pytest.approx((place, 0.0))
    first, second, note = reported(figure)
    # Beside the maximum by half an element at most, 0.04 a, over which it changes by 0.1 %.
    assert float(first.split("$")[1]) == pytest.approx(maximum.interior / hertz.p0, rel=2e-3)
    assert first.startswith("interior")
    assert second.startswith(f"surface: ${at_surface.max():.3f}")
    assert "mesh" in note
    assert bar.get_ylabel() == r"$\sigma_\mathrm{vM}/p_0$"
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("$x/a_0$", "depth $z/a_0$")
    assert axes.get_title(loc="left") == "body A, $y = 0$"


def test_marked_maxima_are_no_maxima_of_the_edges_of_elements():
    along, depth = np.arange(9.0), np.array([0.0, 0.1, 0.5, 2.0, 3.0, 4.0])
    values = np.ones((9, 6))
    values[4, 1] = values[0, 3] = values[2, 5] = 9.0  # too shallow; at the ends of the plane
    values[6, 3], values[2, 0] = 3.0, 2.0
    found = {top.kind: (top.value, top.at) for top in stress_maxima(values, (along, depth))}
    assert found == {"interior": (3.0, (6.0, 2.0)), "surface": (2.0, (2.0, 0.0))}
    (only,) = stress_maxima(np.outer(along, 1.0 + depth), (along, 1.0 + depth))
    assert (only.kind, only.at) == ("largest", (8.0, 5.0))


def test_bodies_share_a_scale_of_colours_above_and_below_the_interface(contact):
    figure = render(plot.von_mises_sections(contact))
    axes, _ = figure.axes
    limits = {filled.get_clim() for filled in axes.collections if filled.filled}
    assert len(limits) == 1
    bottom, top = axes.get_ylim()
    assert -bottom == top == pytest.approx(1.5)
    kinds = [line.split(":")[0] for line in reported(figure)[:-1]]
    assert kinds == ["A, interior", "A, surface", "B, interior", "B, surface"]
    (_, a_inside), _, (_, b_inside), _ = marked(axes)
    assert a_inside > 0.0 > b_inside


def test_planes_parallel_to_the_surface_show_the_contact(contact):
    figure = render(plot.von_mises_sections(contact, "z=0.5a"))
    left, right, _ = figure.axes
    assert [ax.get_title(loc="left") for ax in (left, right)] == [
        "body A, $z = 0.5\\,a_0$",
        "body B, $z = 0.5\\,a_0$",
    ]
    assert (left.get_xlabel(), left.get_ylabel()) == ("$x/a_0$", "$y/a_0$")
    assert len(reported(figure)) == 2  # nothing of the surface


@pytest.mark.parametrize("quantity", ["max_shear", "xx", "xz"])
def test_other_quantities(contact, quantity):
    figure = render(plot.von_mises_sections(contact, quantity=quantity))
    low, high = figure.axes[0].collections[0].get_clim()
    assert low == (0.0 if quantity == "max_shear" else -high)
    # The shear traction is given; stresses along the surface depend on the mesh.
    assert (plot.stress.SURFACE_NOTE in reported(figure)) == (quantity != "xz")


def test_stress_on_a_plane_is_plotted_as_it_is(contact):
    stress = stress_on_plane(contact, "x=0.5a", "B")
    figure = render(plot.von_mises_section(stress))
    assert figure.axes[0].get_xlabel() == "$y$ (mm)"
    assert figure.axes[1].get_ylabel() == r"$\sigma_\mathrm{vM}$ (MPa)"
    scaled = render(plot.von_mises_section(stress, scale=plot.Scale.from_contact(contact)))
    assert scaled.axes[0].get_title(loc="left") == "body B, $x = 0.5\\,a_0$"
    render(plot.von_mises_sections(stress_on_planes(contact, ["y=0.3"], ["A", "B"])))


def test_contact_is_plotted_where_the_plane_crosses_it(contact):
    """Beside the contact, stress at the surface is of the size of rounding."""

    def thick(figure):
        (line,) = [line for line in figure.axes[0].lines if line.get_linewidth() > 2.0]
        return np.count_nonzero(np.isfinite(line.get_ydata()))

    touching = np.count_nonzero(contact.touching[:, contact.grid.elements[1] // 2])
    assert thick(plot.von_mises_section(contact)) == touching
    assert thick(plot.von_mises_section(contact, plane="y=1.1a")) == 0


@pytest.mark.slow
def test_depths_may_come_in_any_order(contact):
    downwards = stress_on_plane(contact, "y=0", depths=np.linspace(0.0, 4.0, 21))
    upwards = stress_on_plane(contact, "y=0", depths=np.linspace(4.0, 0.0, 21))
    assert reported(plot.von_mises_section(downwards)) == reported(plot.von_mises_section(upwards))


@pytest.mark.slow
def test_nothing_overlaps_the_edge_of_the_paper(turned):
    for plane in ("y=0", "x=0.75a", "z=0"):
        for figure in (
            render(plot.von_mises_section(turned, "B", plane)),
            render(plot.von_mises_sections(turned, plane, quantity="xy")),
        ):
            box = figure.get_tightbbox()
            width, height = figure.get_size_inches()
            assert box.x0 >= 0, plane
            assert box.y0 >= 0, plane
            assert box.x1 <= width, plane
            assert box.y1 <= height, plane


def test_sections_are_true_to_scale(turned):
    axes = render(plot.von_mises_section(turned)).axes[0]
    box = axes.get_window_extent()
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    assert box.width / box.height == pytest.approx((right - left) / (top - bottom), rel=1e-6)


def test_what_cannot_be_plotted_is_reported(contact):
    with pytest.raises(ValueError, match=r"quantity.*von_mises"):
        plot.von_mises_section(contact, quantity="zy")
    with pytest.raises(ValueError, match='"A" or "B"'):
        plot.von_mises_section(contact, body="C")
    with pytest.raises(ValueError, match="y=0"):
        plot.von_mises_section(contact, plane="w=0")
    with pytest.raises(ValueError, match="y=0 of A, x=0 of A"):
        plot.von_mises_sections(stress_on_planes(contact, ["y=0", "x=0"], ["A"]))
    with pytest.raises(ValueError, match=r"stress|plane"):
        plot.von_mises_sections([])
    with pytest.raises(ValueError, match="depths"):
        plot.von_mises_section(stress_on_plane(contact, "y=0", depths=[0.0]))
    far = stress_on_plane(contact, "y=0")
    far.components.update({name: 0.0 * values for name, values in far.components.items()})
    with pytest.raises(ValueError, match="stress"):
        plot.von_mises_section(far)


@pytest.fixture(scope="module")
def history(contact):
    """Two records with stress on two planes, one of them of one body."""
    planes = list(stress_on_planes(contact, ["y=0"], ["A", "B"]))
    planes.append(stress_on_plane(contact, "z=0.5a"))
    records = [Record.from_contact(contact, {"revolution": N}, stress=planes) for N in (0, 10)]
    return History.of_records(records, contact.scene, contact.grid)


def test_stored_stress_is_plotted_as_that_of_the_contact(contact, history):
    stored = plot.von_mises_sections(history, "y=0", revolution=10)
    assert reported(stored) == reported(plot.von_mises_sections(contact, "y=0"))
    assert "N\u00a0=\u00a010" in stored.get_suptitle()
    assert reported(plot.von_mises_section(history, "A", "z=0.5a"))


@pytest.mark.parametrize("quantity", ["von_mises", "xx"])
def test_ticks_are_limits_of_bands(contact, quantity):
    figure = plot.von_mises_section(contact, "A", "y=0", quantity=quantity)
    (bands,) = (one for one in figure.axes[0].collections if getattr(one, "filled", False))
    ticks = figure.axes[-1].get_yticks()
    assert set(ticks) <= set(bands.levels)
    assert 0.0 in ticks
    assert len(ticks) > 4


@pytest.mark.slow
@pytest.mark.usefixtures("empty_pictures")
def test_save_all_draws_each_plane_with_the_bodies_it_was_kept_for(history, tmp_path, monkeypatch):
    render = []
    sections = stress.von_mises_sections

    def spied(history, plane, bodies, revolution):
        render.append((plane, bodies, revolution))
        return sections(history, plane, bodies, revolution)

    monkeypatch.setattr(stress, "von_mises_sections", spied)
    names = {path.name for path in plot.save_all(history, tmp_path)}
    assert {"von-mises-y0-0.png", "von-mises-y0-10.png", "von-mises-z0.5a-10.png"} <= names
    assert render[:2] == [("y=0", ("A", "B"), 0), ("z=0.5a", ("A",), 0)]
