"""Figures of wheel and rail: contact points, rolling radii, conicity, patches and worn profiles."""

from collections.abc import Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from tractive_sam.plot.contact_map import ContactView, Need
from tractive_sam.plot.figure import LOOK, Figure, apply_style, format_title, new_axes, new_figure
from tractive_sam.plot.registry import contact_figure, history_figure
from tractive_sam.rail import ConicityCheck, ContactLocus, Profile
from tractive_sam.results import History, WornProfiles
from tractive_sam.scene import Scene


def _draw_profile(axes: Any, profile: Profile, lift: float = 0.0, **style: Any) -> None:
    """Draw a profile with z upwards."""
    axes.plot(profile.points[:, 0], lift - profile.points[:, 1], **style)


@contact_figure(
    "wheel-rail",
    needs=[Need(lambda view: view.contact.scene.wheelset is not None, "a scene with [wheel]")],
    shown=lambda view: view.history is None or view.at == view.history.saved[0],  # all patches
)
def wheel_on_rail(view: ContactView) -> Figure:
    """Wheel and rail in the track, with the normals of all patches.

    Examples
    --------
    >>> settings = ["grid.elements=[15, 15]"]
    >>> plot.wheel_on_rail(ts.solve(ts.Scene.builtin("wheel-rail").with_set(settings)))
    <Figure size ...>
    """
    wheel_rail = view.contact.scene.wheel_rail
    title = format_title(view.title, "profiles, with the angles of the contacts")
    figure, axes = new_axes(1.0, 0.6, title)
    points, _ = wheel_rail.wheel.silhouette(wheel_rail.wheel.profile.s)
    length = 12.0  # of the normals, mm
    points = points[-points[:, 2] < length]  # a yawed flange seems to reach far up at its back
    axes.plot(points[:, 1], -points[:, 2], label="wheel")
    _draw_profile(axes, wheel_rail.rail.section(0.0), label="rail")
    patches = sorted(wheel_rail.patches, key=lambda patch: patch.origin[1])
    sides = ["center"] if len(patches) == 1 else ["right"] + ["left"] * (len(patches) - 1)
    for patch, side in zip(patches, sides, strict=True):
        y, z = patch.origin[1:]
        ends = length * patch.normal[1:]
        label = f"${np.degrees(patch.angle):.1f}$°"
        axes.plot([y, y + ends[0]], [-z, -z - ends[1]], color=LOOK.grey)
        place = (y + ends[0], -z - ends[1])
        axes.annotate(label, place, (0, 3), textcoords="offset points", ha=side)
    axes.margins(y=0.2)  # for the labels above the normals
    axes.set(xlabel="y (mm)", ylabel="height (mm)", aspect="equal")
    axes.legend(loc="lower center")
    return figure


@apply_style
def contact_points(scene: Scene, locus: ContactLocus, apart: float = 12.0) -> Figure:
    """Draw both profiles, the wheel lifted, and connect their contact points at each position.

    Parameters
    ----------
    scene : Scene
        Scene with [wheel], [rail] and [wheelset].
    locus : ContactLocus
        Its contact points, of the right side.
    apart : float
        Height by which the wheel is lifted, mm.

    Examples
    --------
    >>> scene = ts.Scene.builtin("wheel-rail")
    >>> plot.contact_points(scene, ts.contact_locus(scene, [-2.0, 0.0, 2.0]))
    <Figure size ...>
    """
    figure, axes = new_axes(1.0, 0.6)
    assert scene.wheel is not None
    assert scene.rail is not None
    wheel, rail, centre = scene.wheel.curve, scene.rail.curve, scene.wheel_rail.wheel.datum
    moved = wheel.moved(0.0, (centre, 0.0))
    _draw_profile(axes, moved, lift=apart, label=f"wheel, raised by {apart:g} mm")
    _draw_profile(axes, rail, label="rail")
    for k, y in enumerate(locus.y):
        (wheel_y, wheel_z), (rail_y, rail_z) = locus.wheel[0, k], locus.rail[0, k]
        axes.plot([centre + wheel_y, rail_y], [apart - wheel_z, -rail_z], "-", color=LOOK.grey)
        if k in (0, len(locus.y) // 2, len(locus.y) - 1):
            axes.annotate(f"${y:.3g}$", (rail_y, -rail_z), (0, -5), textcoords="offset points",
                          ha="center", va="top", fontsize=7)  # fmt: skip
    axes.set(xlabel="lateral position (mm)", ylabel="height (mm)", aspect="equal")
    # Beside or below the profiles, a narrow figure has no room.
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
    return figure


@apply_style
def radius_difference(locus: ContactLocus) -> Figure:
    """Draw the rolling radius difference over the lateral position of the wheelset.

    Parameters
    ----------
    locus : ContactLocus
        Contact points; their jumps are marked.

    Examples
    --------
    >>> plot.radius_difference(ts.contact_locus(ts.Scene.builtin("wheel-rail"), [-1.0, 0.0, 1.0]))
    <Figure size ...>
    """
    figure, axes = new_axes(1.0, 0.6)
    axes.plot(locus.y, locus.radius_difference, "o-", ms=3)
    axes.plot(locus.y[locus.jumps], locus.radius_difference[locus.jumps], "x", label="jump")
    if locus.jumps.any():
        axes.legend()
    axes.set(xlabel="lateral position y (mm)", ylabel="rolling radius difference (mm)")
    return figure


@apply_style
def conicity(locus: ContactLocus, points: int = 30) -> Figure:
    """Draw the equivalent conicity, harmonic and by Klingel, over the lateral amplitude.

    The curves begin at `ContactLocus.least_amplitude`. A band is the error bar of the harmonic one.
    The curve of Klingel's motion has gaps at amplitudes without such a motion (hollow wheels).

    Parameters
    ----------
    locus : ContactLocus
        Contact points on both sides of the middle.
    points : int
        Number of amplitudes.

    Examples
    --------
    >>> scene = ts.Scene.builtin("wheel-rail")
    >>> plot.conicity(ts.contact_locus(scene, [-2.0, -1.0, 0.0, 1.0, 2.0]))
    <Figure size ...>
    """
    figure, axes = new_axes(1.0, 0.6)
    largest = min(-locus.y[0], locus.y[-1])
    amplitudes = np.linspace(min(locus.least_amplitude, largest), largest, points)
    harmonic, error, klingel = np.full((3, points), np.nan)
    for k, amplitude in enumerate(amplitudes):
        harmonic[k], error[k] = locus.conicity(amplitude), locus.conicity_error(amplitude)
        with suppress(ValueError):
            klingel[k] = locus.klingel_conicity(amplitude)
    axes.plot(amplitudes, harmonic, label="harmonic")
    axes.fill_between(amplitudes, harmonic - error, harmonic + error, alpha=0.25, linewidth=0)
    axes.plot(amplitudes, klingel, "--", label="Klingel's motion")
    axes.set(xlabel="amplitude (mm)", ylabel=r"equivalent conicity $\tan\gamma_e$")
    if harmonic.min() < 0.0:
        axes.axhline(0.0, color=LOOK.grey)
    else:
        axes.set_ylim(bottom=0.0)
    axes.legend()
    return figure


@apply_style
def conicity_checks(checks: Sequence[ConicityCheck]) -> Figure:
    """Draw equivalent conicities over the reference values, with the band of their tolerance.

    Each title has a panel, and each label a line in it. Circles mark values beyond the tolerance.

    Parameters
    ----------
    checks : sequence of ConicityCheck
        Computed and reference values; those of a title have a common reference.

    Examples
    --------
    >>> locus = ts.contact_locus(ts.Scene.builtin("wheel-rail"), [-2.0, -1.0, 0.0, 1.0, 2.0])
    >>> check = locus.check_conicity("S1002", "free roll", [2.0], [0.23], [0.05])
    >>> plot.conicity_checks([check])
    <Figure size ...>
    """
    titles = list(dict.fromkeys(check.title for check in checks))
    columns = min(len(titles), 3)
    rows = -(-len(titles) // columns)
    figure = new_figure(1.0 if columns < 3 else 1.4, 0.2 + 0.4 * rows)
    panels = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False).ravel()
    for axes, title in zip(panels, titles, strict=False):
        shown = [check for check in checks if check.title == title]
        longest = max(shown, key=lambda check: check.amplitude.size)
        limits = [longest.reference + sign * longest.tolerance for sign in (-1.0, 1.0)]
        axes.fill_between(longest.amplitude, *limits, color=LOOK.grey, alpha=0.3, linewidth=0,
                          label="tolerance of the reference")  # fmt: skip
        for check, style, colour in zip(shown, ("-", "--"), LOOK.lines, strict=False):
            axes.plot(check.amplitude, check.conicity, style, color=colour, label=check.label)
            beyond = check.amplitude[~check.agrees], check.conicity[~check.agrees]
            axes.plot(*beyond, "o", mfc="none", color=colour)
        axes.set_title(title, fontsize="small")
    for axes in panels[len(titles) :]:
        axes.set_axis_off()
    figure.supxlabel("amplitude (mm)", fontsize="medium")
    figure.supylabel(r"equivalent conicity $\tan\gamma_e$", fontsize="medium")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return figure


def _is_worn(history: History) -> bool:
    """Return whether material is worn off the wheel or the rail."""
    return bool((history["worn_section"][-1] > 0.0).any())


@history_figure("wheel-rail-profiles", columns=["worn_section"], shown=_is_worn)
def worn_wheel_of_history(history: History) -> Figure:
    """New and worn profiles of wheel and rail, with the depths magnified.

    Examples
    --------
    >>> scene = ts.Scene.builtin("wheel-wear").with_set(["wear.revolutions=1000"])
    >>> plot.worn_wheel_of_history(ts.roll(scene))
    <Figure size ...>
    """
    return worn_wheel_and_rail(WornProfiles.from_history(history))


@history_figure("worn-sections", columns=["worn_section"], shown=_is_worn)
def worn_sections(history: History) -> Figure:
    """Cross sections worn off wheel and rail, over the revolutions of the wheel.

    Examples
    --------
    >>> scene = ts.Scene.builtin("wheel-wear").with_set(["wear.revolutions=1000"])
    >>> plot.worn_sections(ts.roll(scene))
    <Figure size ...>
    """
    figure, axes = new_axes(1.0, 0.6)
    for k, (name, line) in enumerate({"wheel": "o-", "rail": "o--"}.items()):
        axes.plot(history["revolution"], history["worn_section"][:, k], line, ms=3, label=name)
    axes.set(xlabel="revolutions of the wheel", ylabel="worn section (mm²)")
    axes.legend()
    return figure


@apply_style
def worn_wheel_and_rail(worn: WornProfiles, magnified: float = 100.0) -> Figure:
    """Draw new and worn profiles, with the depths magnified.

    Parameters
    ----------
    worn : WornProfiles
        Result of `wear_profiles`, or profiles read from a history.
    magnified : float
        Factor of the depths.

    Examples
    --------
    >>> scene = ts.Scene.builtin("wheel-wear").with_set(["wear.revolutions=1000"])
    >>> plot.worn_wheel_and_rail(ts.wear_profiles(scene))
    <Figure size ...>
    """
    figure = new_figure(1.0, 1.1)
    depths = {"wheel": (worn.wheel_depth[-1], 1.0), "rail": (worn.rail_depth[-1], -1.0)}
    for k, (name, new) in enumerate(worn.new.items()):
        depth, outward = depths[name]
        axes = figure.add_subplot(2, 1, k + 1)
        _draw_profile(axes, new, color=LOOK.grey, label=f"new {name}")
        _draw_profile(axes, new.worn(magnified * depth, outward), label=f"wear x {magnified:g}")
        axes.set(xlabel="y (mm)", ylabel="height (mm)", aspect="equal")
        axes.legend(loc="lower center" if name == "rail" else "lower right")
    return figure
