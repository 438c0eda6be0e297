import importlib
import pkgutil
from dataclasses import replace

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.collections import QuadMesh
from PIL import Image

import tractive_sam as ts
from tests.plot import strip_theory as strips
from tests.plot.rendering import render
from tractive_sam import plot
from tractive_sam.plot.figure import LOOK, change_options, new_figure

OF_A_STATE = (
    plot.pressure,
    plot.traction,
    plot.traction_sections,
    plot.stick_slip_map,
    plot.wear_map,
)
OF_A_HISTORY = (
    plot.forces,
    plot.widths,
    plot.wear_depth,
    plot.wear_depth_profiles,
    plot.worn_profiles,
    plot.pressure_profiles,
    plot.pressure_over_revolutions,
    plot.slip_over_revolutions,
    plot.wear_over_revolutions,
)


def labels(figure):
    of_axes = (text for ax in figure.axes for text in (ax.get_xlabel(), ax.get_ylabel()))
    return {*of_axes, figure.get_supxlabel()}


@pytest.mark.parametrize("draw", OF_A_STATE)
def test_figures_of_a_state(draw):
    of_contact = render(draw(strips.contact()))
    of_history = render(draw(strips.history(), 10))
    assert labels(of_contact) == labels(of_history) >= {"$x/a_0$, leading edge right"}
    assert of_contact.get_suptitle().startswith("Strips\n")
    assert "; N\u00a0=\u00a010; " in of_history.get_suptitle()


@pytest.mark.slow
@pytest.mark.parametrize("draw", OF_A_HISTORY)
def test_figures_of_a_history(draw):
    render(draw(strips.history()))


@pytest.mark.parametrize("draw", [plot.pressure, plot.stick_slip_map, plot.traction])
def test_maps_are_true_to_scale(draw):
    figure = render(draw(strips.contact()))
    box = figure.axes[0].get_window_extent()
    (left, right), (bottom, top) = figure.axes[0].get_xlim(), figure.axes[0].get_ylim()
    assert box.width / box.height == pytest.approx((right - left) / (top - bottom), rel=1e-6)


def test_the_power_of_ten_is_over_its_colour_bar():
    figure = plot.slip_over_revolutions(strips.history())
    figure.draw_without_rendering()
    beside = figure.axes[-1]
    power = beside.yaxis.get_offset_text()
    assert power.get_text()
    ends, bar = power.get_window_extent(), beside.bbox
    assert ends.x0 + ends.x1 == pytest.approx(bar.x0 + bar.x1, abs=2.0)  # of 100 dots an inch


def test_maps_side_by_side_share_their_colours():
    figure = plot.pressure_over_revolutions(strips.history())
    *maps, bar = figure.axes
    assert [ax.get_title() for ax in maps] == ["$N$ = 0", "$N$ = 10", "$N$ = 100"]
    meshes = [mesh for ax in maps for mesh in ax.collections if isinstance(mesh, QuadMesh)]
    assert len(meshes) == 3
    for mesh in meshes:
        assert mesh.get_clim() == pytest.approx((0.0, 1.0))
    assert bar.get_ylabel() == "contact pressure $p_n/p_0$"


def test_worn_bodies_part_by_what_was_worn_off_them():
    axes = render(plot.worn_profiles(strips.history())).axes[0]
    upper, lower = (line.get_ydata() for line in axes.lines[-2:])
    history = strips.history()
    worn = history["wear_profile_A"][-1] + history["wear_profile_B"][-1]
    np.testing.assert_allclose(upper - lower, 1e3 * (worn + history.y**2 / 100.0), rtol=1e-12)


def test_a_measured_profile_is_plotted_on_its_body():
    y = np.linspace(-3.0, 3.0, 61)
    gap = ts.Gap(x=[-9.0, 9.0], y=y, separation=[0.01 * y**2] * 2, body="B", positive="inward")
    given = {"gap": gap, "wear.revolutions": 1, "wear.save": [1], "grid.elements": [9, 15]}
    history = ts.roll(ts.Scene.builtin("twin-discs-isotropic").replace(**given))
    axes = render(plot.worn_profiles(history)).axes[0]
    upper, lower = (line.get_ydata() for line in axes.lines[-2:])
    known = history["wear_profile_A"][-1] + history["wear_profile_B"][-1]
    radii = history.scene.body
    crowns = 0.5 * history.y**2 * (1.0 / radii.A.radius_y + 1.0 / radii.B.radius_y)
    measured = 0.01 * history.y**2  # interpolated, exactly for a parabola
    np.testing.assert_allclose(upper - lower, 1e3 * (known + crowns + measured), rtol=1e-9)


def inside(axis):
    """Which ticks of an axis are within its limits."""
    low, high = axis.get_view_interval()
    return (axis.get_majorticklocs() >= low) & (axis.get_majorticklocs() <= high)


def test_a_slender_contact_is_stretched_and_says_so():
    flank = {"body.A.radius_x": 9.0, "body.A.radius_y": 2500.0, "subsurface": None, "wear": None}
    given = {"grid": {"elements": [15, 31]}, "body.B.radius_y": np.inf}
    contact = ts.solve(ts.Scene.builtin("twin-discs-isotropic").replace(**flank, **given))
    figure = render(plot.traction(contact))
    axes = figure.axes[0]
    place = axes.get_position()
    width, height = figure.get_size_inches() * place.size
    assert width == pytest.approx(0.85, rel=1e-9)  # inches, as MapFrame.from_sides has it
    assert height < 6.0
    assert all(np.count_nonzero(inside(axis)) >= 3 for axis in (axes.xaxis, axes.yaxis))
    assert "stretched" in figure.get_suptitle()
    reported = figure.get_suptitle().replace("\n", " ")
    assert "leading edge" in reported  # there is no room for it at the axis
    contact = ts.solve(ts.Scene.builtin("spheres").replace(**{"grid.elements": (15, 15)}))
    assert "stretched" not in plot.traction(contact).get_suptitle()


@pytest.mark.slow
def test_bodies_with_a_measured_ridge_touch_though_nothing_wears(tmp_path):
    y = np.linspace(-3.0, 3.0, 61)
    gap = ts.Gap(x=[-9.0, 9.0], y=y, separation=[-1e-3 * np.exp(-(y**2))] * 2)
    given = {"gap": gap, "wear": None, "grid.elements": [9, 15], "subsurface": None}
    history = ts.roll(ts.Scene.builtin("twin-discs-isotropic").replace(**given))
    axes = render(plot.worn_profiles(history)).axes[0]
    upper, lower = (line.get_ydata() for line in axes.lines)
    assert min(upper - lower) == 0.0
    assert axes.figure.legends == []  # there is one record only
    assert "profiles.png" in [path.name for path in plot.save_all(history, tmp_path)]


@pytest.mark.slow
def test_animation_has_a_picture_for_every_stored_revolution(tmp_path):
    path = plot.animate(strips.history(), tmp_path / "a.gif")
    with Image.open(path) as pictures:
        assert pictures.n_frames == 3
        assert pictures.info["duration"] == 500  # ms, of two a second


def test_animation_of_what_does_not_move(tmp_path):
    with pytest.raises(ValueError, match=r"\.gif"):
        plot.animate(strips.history(), tmp_path / "a.mp4")
    with pytest.raises(ValueError, match=r"wear\.save"):
        plot.animate(strips.history((0,)), tmp_path / "a.gif")


@pytest.mark.slow
def test_nothing_overlaps_the_edge_of_the_paper():
    for draw in OF_A_STATE:
        figure = render(draw(strips.history(), 100))
        box = figure.get_tightbbox()
        width, height = figure.get_size_inches()
        assert box.x0 >= 0, draw
        assert box.y0 >= 0, draw
        assert box.x1 <= width, draw
        assert box.y1 <= height, draw


def test_sections_of_orthotropic_friction_show_both_bounds():
    requested = strips.scene(mu=(0.4, 0.2))
    lateral = strips.traction(0.2, direction=(0.6, 0.8))
    figure = render(plot.traction_sections(strips.contact(requested, traction=lateral)))
    names = {text.get_text() for text in figure.legends[0].get_texts()}
    assert names == {"$p_x$", "$p_y$", "bound of $p_x$", "bound of $p_y$"}


def test_component_that_is_not_there_is_not_plotted():
    figure = render(plot.traction_sections(strips.contact()))
    names = {text.get_text() for text in figure.legends[0].get_texts()}
    assert names == {"$p_x$", r"$\pm\mu\,p_n$"}


def test_creep_force_curve():
    xi = np.linspace(0, 1.5, 4)
    figure = render(plot.creep_force_curve({"here": (xi, xi)}, {"there": (xi, xi)}))
    names = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert names[:2] == ["here", "there"]
    assert len(names) == 4
    assert len(plot.creep_force_curve({"here": (xi, xi)}, theory=False).axes[0].lines) == 1


def test_without_contact_the_reason_is_reported():
    with pytest.raises(ValueError, match="touch"):
        plot.pressure(strips.contact(pressure=np.zeros((31, 33))))


def test_title_is_no_math():
    render(plot.pressure(strips.contact(strips.scene(title="costs $5_{ or $6"))))


def test_settings_of_the_session_stay_as_they_are():
    names = ("font.family", "font.size", "figure.constrained_layout.use", "savefig.dpi")
    before = [mpl.rcParams[name] for name in names]
    plot.pressure(strips.contact())
    assert [mpl.rcParams[name] for name in names] == before


@pytest.mark.usefixtures("empty_pictures")
class TestSaveAll:
    def test_history(self, tmp_path):
        paths = plot.save_all(strips.history(), tmp_path / "new" / "folder")
        assert all(path.exists() for path in paths)
        names = {path.name for path in paths}
        assert {"pressure-0.png", "pressure-100.png", "wear-100.png", "forces.png"} <= names
        assert not {"pressure-10.png", "wear-0.png", "pressure.png"} & names
        assert len(names) == len(paths) == 18

    def test_one_state(self, tmp_path):
        one = strips.history(stored=(0,))
        one = replace(one, values={name: rows[:1] for name, rows in one.values.items()})
        paths = plot.save_all(one, tmp_path, "svg")
        assert {path.name for path in paths} == {
            "pressure.svg",
            "traction.svg",
            "traction-sections.svg",
            "stick-slip.svg",
        }

    def test_no_fields(self, tmp_path):
        paths = plot.save_all(strips.history(stored=()), tmp_path, "pdf")
        assert {path.name for path in paths} == {"forces.pdf", "widths.pdf", "wear-depth.pdf"}


def test_a_line_contact_has_functions_of_x_and_no_other_contact_has():
    line, wide = ts.solve(ts.Scene.builtin("cylinders")), ts.solve(ts.Scene.builtin("twin-discs"))
    for draw, of_line in ((plot.pressure, plot.line_pressure), (plot.traction, plot.line_traction)):
        for given, expected in zip(
            draw(line).axes[0].lines, of_line(line).axes[0].lines, strict=True
        ):
            np.testing.assert_array_equal(given.get_xydata(), expected.get_xydata())
    for draw in (plot.stick_slip_map, plot.wear_map, plot.traction_sections):
        with pytest.raises(ValueError, match="line_pressure"):
            draw(line)
    for draw in (plot.line_pressure, plot.line_traction, plot.line_slip):
        with pytest.raises(ValueError, match="line"):
            draw(wide)


def test_units_are_millimetres_and_megapascals():
    state = plot.ContactView.from_source(strips.history(), 10)
    with plot.units("si-mm"):
        figure = render(plot.pressure(strips.history(), 10))
    axes, bar = figure.axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("$x$ (mm), leading edge right", "$y$ (mm)")
    assert bar.get_ylabel() == "contact pressure $p_n$ (MPa)"
    (mesh,) = (mesh for mesh in axes.collections if isinstance(mesh, QuadMesh))
    assert np.max(mesh.get_array()) == pytest.approx(state.contact.pressure.max())
    with pytest.raises(ValueError, match="hertz, si-mm"), plot.units("inch"):
        pass


def test_titles_report_what_where_and_over_which_scale():
    title = plot.pressure(strips.history(), 10).get_suptitle().replace("\u00a0", " ")
    for reported in ("Strips", "contact pressure", "N = 10", "µ = 0.3", "p₀ = 900 MPa"):
        assert reported in title


@pytest.mark.slow
@pytest.mark.usefixtures("empty_pictures")
def test_what_does_not_touch_is_left_out(tmp_path):
    free = ts.Scene.builtin("spheres").replace(load={"approach": 0.03}, subsurface=None)
    course = {"distance": [0, 2, 4], "load.approach": [0.03, 0.03, -0.01], "save": [0, 2, 4]}
    history = ts.roll(free.replace(transient=course, **{"grid.elements": (15, 15)}))
    names = {path.name for path in plot.save_all(history, tmp_path)}
    assert {"pressure-0.png", "pressure-2.png"} <= names
    assert "pressure-4.png" not in names
    maps = plot.pressure_over_revolutions(history).axes
    assert len([axes for axes in maps if axes.get_title()]) == 2
    assert not (plot.edge_level(history.field("pressure", 4.0)) > 0.0).any()
    apart = ts.roll(history.scene.replace(**{"transient.save": [4]}))
    names = {path.name for path in plot.save_all(apart, tmp_path / "apart")}
    assert "forces.png" in names
    assert "pressure-4.png" not in names


@pytest.mark.parametrize("room", [one.name for one in pkgutil.iter_modules(plot.__path__)])
def test_every_drawing_is_a_figure_that_notebooks_show(room):
    module = importlib.import_module(f"tractive_sam.plot.{room}")
    assert getattr(module, "Figure", plot.Figure) is plot.Figure


def test_pdf_has_fonts_that_journals_accept(tmp_path):
    plot.forces(strips.history()).savefig(tmp_path / "forces.pdf")
    assert b"/Type3" not in (tmp_path / "forces.pdf").read_bytes().replace(b" ", b"")


def test_no_figure_is_lower_than_45_mm():
    with change_options(scale=84.0 / 25.4 / LOOK.panel_width):
        assert new_figure(1.8, 0.6).get_figheight() >= 45.0 / 25.4
