"""Maps finer than the mesh: resolved if it matters and is affordable, else reported."""

import warnings

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.contact import Model
from tractive_sam.contact.measured import Roughness
from tractive_sam.results import Grid
from tractive_sam.run.inputs import gap_notes, read_measured_gap, read_profiles

DISCS = ts.Scene.builtin("twin-discs").replace(subsurface=None, grid=None, wear=None)
USUAL = Model(DISCS).grid
Y = np.linspace(-0.9, 0.9, 1801)  # steps of 1 um on elements of 12 um
PRESSED = DISCS.replace(creepage=None)


def model_of(scene):
    return Model(scene, read_measured_gap(scene), profiles=read_profiles(scene))


def rough(scene=DISCS, **gap):
    return model_of(scene.replace(gap=gap))


def wave(length, height=1e-4):
    return height * np.cos(2.0 * np.pi * Y / length)


def test_what_flattens_a_wave_left_out():
    """E* q h/2 of its amplitude h (Johnson 1985, 13.2); its rms is that over root 2."""
    y = np.linspace(-1.0, 1.0, 4001)
    heights = 1e-4 * np.cos(2.0 * np.pi * y / 0.01) * np.ones((2, 1))
    map_ = Roughness((np.array([-1e6, 1e6]), y, heights), 1e5, 1e3)
    _, along_y = map_.unresolved_parts(Grid.from_half_lengths((0.9, 0.9), (9, 31)))
    expected = 0.5 * 1e5 * (2.0 * np.pi / 0.01) * 1e-4 / 2.0**0.5
    # What the mesh samples of the wave appears as a long one with a thousandth of its slope.
    assert map_.flattening(along_y) == pytest.approx(expected, rel=0.02)
    assert along_y.samples == pytest.approx(1.8 / 31 / (2.0 / 4000), rel=1e-6)


@pytest.mark.slow
def test_waves_are_tracked_and_the_pressure_converges():
    """The usual mesh has 2.4 elements a wave; on the one that follows it no note is left."""
    model = rough(PRESSED, y=Y, separation=wave(0.03))
    assert model.grid.elements[0] == USUAL.elements[0]  # nothing varies along x
    assert model.grid.elements[1] > 2 * USUAL.elements[1]
    assert not [*gap_notes(model)]
    found = []
    nx, ny = model.grid.elements
    for n in (USUAL.elements[1], ny, 2 * ny + 1):
        grid = {"half_length": model.grid.half_length, "elements": (nx, n)}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ts.SceneWarning)
            found.append(ts.solve(model.scene.replace(grid=grid)).p_max)
    coarse, followed, fine = found
    assert abs(followed - fine) < 0.05 * fine  # of half the elements
    assert abs(coarse - fine) > 3.0 * abs(followed - fine)


@pytest.mark.parametrize(
    "profile",
    [
        1e-3 * np.exp(-((Y / 0.2) ** 4)),
        np.maximum(0.0, 3e-3 * (1.0 - (Y / 0.3) ** 2)),  # worn, with its rim
        wave(0.2),
        Y**2 / 100.0,
    ],
)
@pytest.mark.parametrize("step", [1, 30])
def test_a_smooth_profile_leaves_the_mesh_as_it_is(profile, step):
    """However finely it was sampled."""
    y = np.linspace(-0.9, 0.9, 18001)
    for at, heights in ((y, np.interp(y, Y, profile)), (Y[::step], profile[::step])):
        model = rough(y=at, separation=heights)
        assert model.grid == USUAL
        assert not [*gap_notes(model)]


@pytest.mark.slow
def test_noise_that_cannot_be_resolved_is_reported_with_its_numbers():
    """White noise: its rms slope is root 2 of the heights over the step, along either axis."""
    step = 1.5e-3
    heights = 1e-4 * np.random.default_rng(0).standard_normal((800, 800))
    at = (np.arange(800) - 399.5) * step
    model = rough(PRESSED, x=at, y=at, separation=heights)
    assert model.grid == USUAL  # it would take a million elements
    (note,) = gap_notes(model)
    samples, waves = USUAL.dx / step, 2.0 * USUAL.dx
    assert note.startswith("gap: ")
    assert f"{samples:.2g} x" in note
    assert f"{waves:.2g} x" in note
    nx, ny = (2 * int(np.ceil(half / step - 0.5)) + 1 for half in USUAL.half_length)
    assert f"[{nx}, {ny}]" in note
    assert f"{nx * ny} elements" in note
    map_ = Roughness(model.measured, model.scene.material.plane_strain_modulus, 1.0)
    for part in map_.unresolved_parts(USUAL):
        assert part.slope == pytest.approx(2.0**0.5 * 1e-4 / step, rel=0.02)  # a tenth is seen
        # The samples appear as long waves; their variance adds to the variance of the map.
        assert 1e-4 < part.height < 2.0**0.5 * 1e-4


def test_a_map_within_the_bound_is_tracked_to_its_step():
    heights = 1e-4 * np.random.default_rng(0).standard_normal((161, 161))
    x, y = np.linspace(-0.4, 0.4, 161), np.linspace(-0.8, 0.8, 161)
    model = rough(PRESSED, x=x, y=y, separation=heights)
    assert model.grid.dx <= 0.8 / 160 < USUAL.dx
    assert model.grid.dy <= 1.6 / 160 < USUAL.dy
    assert not [*gap_notes(model)]


def test_of_a_grid_that_is_given_in_part():
    gap = {"y": Y, "separation": wave(0.03)}
    domain = rough(DISCS.replace(**{"grid.half_length": (0.4, 0.6)}), **gap)
    assert domain.grid.half_length == (0.4, 0.6)
    assert not [*gap_notes(domain)]
    elements = rough(DISCS.replace(**{"grid.elements": (41, 61)}), **gap)
    assert elements.grid.elements == (41, 61)
    assert len([*gap_notes(elements)]) == 1


def test_with_accuracy_the_results_choose_the_mesh_and_one_note_is_left():
    scene = PRESSED.replace(
        gap={"y": Y, "separation": wave(0.03, 3e-5)},
        accuracy={"tolerance": 0.1, "elements": 8000},
        friction=None,
    )
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        ts.solve(scene, throw=False)
    assert len([one for one in caught if str(one.message).startswith("gap: ")]) <= 1


def test_profiles_that_travel_are_tracked_wherever_they_are():
    """The waves lie beside the mesh and come into it; of a line contact, too."""
    x = np.linspace(0.5, 1.5, 1001)
    waves = np.outer(1e-4 * np.cos(2.0 * np.pi * x / 0.02), np.ones(2))
    profile = {"A": {"x": x, "y": [-9.0, 9.0], "separation": waves}}
    course = {"distance": (0.0, 2.0), "profile": profile}
    model = model_of(DISCS.replace(transient=course))
    assert model.grid.elements[0] > 2 * USUAL.elements[0]
    given = {"half_length": USUAL.half_length, "elements": USUAL.elements}
    (note,) = gap_notes(model_of(DISCS.replace(transient=course, grid=given)))
    assert note.startswith("transient.profile.A: ")
    line = ts.Scene.builtin("cylinders").replace(subsurface=None, transient=course)
    coarse = line.replace(grid={"half_length": (2.0 * line.hertz.a,), "elements": (61,)})
    (note,) = gap_notes(model_of(coarse))
    assert note.startswith("transient.profile.A: ")
