"""A progress bar is shown if it is visible, and removed at the end."""

import io
import math
import sys
from types import SimpleNamespace

import pytest
from rich.console import Console

import tractive_sam as ts
from tractive_sam.rolling.wheel_rail import WheelRailPatches
from tractive_sam.run import progress

SCENE = ts.Scene.builtin("twin-discs").with_set(
    [
        "grid.half_length=[0.35, 0.7]",
        "grid.elements=[15, 21]",
        "wear.revolutions=3",
        "wear.save=[0]",
    ]
)
SCENE = SCENE.replace(subsurface=None)
PATCH = WheelRailPatches.columns[0]


def rolled_on(terminal, requested):
    """What a terminal is shown of a roll."""
    with progress.show_roll_progress(SCENE, requested, terminal) as called:
        if called is not None:
            ts.roll(SCENE, progress=called)
    return terminal.file.getvalue()


def terminal(is_one=True):
    return Console(file=io.StringIO(), force_terminal=is_one, width=120)


def test_in_a_terminal_where_it_is_requested():
    assert "revolution 3 of 3" in rolled_on(terminal(), True)
    assert not rolled_on(terminal(), False)
    assert not rolled_on(terminal(is_one=False), True)


def test_patches_of_a_wheel_are_counted_without_an_end():
    scene = ts.Scene.builtin("wheel-rail")
    values = {"patch": 1, "wear_max": 0.0, "approach": 0.1}
    record = SimpleNamespace(values=values, at=1, coordinate=PATCH)
    screen = terminal()
    with progress.show_roll_progress(scene, True, screen) as show:
        show(record)
    assert "patch 1" in screen.file.getvalue()
    assert "patch 1 of" not in screen.file.getvalue()


@pytest.fixture
def over_at_once(monkeypatch):
    """Whatever the load of the machine, nothing takes long."""
    monkeypatch.setattr(progress, "DELAY", math.inf)


def test_by_itself_only_of_what_takes_longer(over_at_once, monkeypatch):
    assert not rolled_on(terminal(), None)
    monkeypatch.setattr(progress, "DELAY", 0.0)
    assert "revolution 3 of 3" in rolled_on(terminal(), None)


def test_of_one_contact_the_mesh_and_its_residual(over_at_once, monkeypatch):
    def solved_on(terminal, requested):
        with progress.show_solving(requested, terminal):
            ts.solve(SCENE, progress=False)
        return terminal.file.getvalue()

    assert "15 x 21 elements, residual" in solved_on(terminal(), True)
    assert not solved_on(terminal(), False)
    assert not solved_on(terminal(), None)
    monkeypatch.setattr(progress, "DELAY", 0.0)
    assert "15 x 21 elements, residual" in solved_on(terminal(), None)
    assert not solved_on(terminal(is_one=False), True)


@pytest.fixture
def notebook(monkeypatch):
    """A notebook that keeps what it is shown."""
    shown = []

    class Handle:
        def update(self, bundle, raw):
            shown.append(bundle["text/html"])

    def display(bundle, raw, display_id):
        shown.append(bundle["text/html"])
        return Handle()

    shell = SimpleNamespace(get_ipython=lambda: SimpleNamespace(kernel="a kernel"))
    monkeypatch.setitem(sys.modules, "IPython", shell)
    monkeypatch.setitem(sys.modules, "IPython.display", SimpleNamespace(display=display))
    return shown


def test_in_a_notebook_it_is_one_line_that_is_empty_at_the_end(notebook):
    ts.roll(SCENE, progress=True)
    assert notebook[0].startswith("<progress>")
    assert notebook[-1] == ""


def test_a_notebook_is_silent_where_that_is_requested(notebook, over_at_once):
    ts.roll(SCENE, progress=False)
    ts.roll(SCENE)  # no bar for a short run by default
    assert notebook == []


@pytest.mark.parametrize(
    ("seconds", "text"), [(5.4, "0:05"), (65.0, "1:05"), (7200.0, "2:00:00"), (0.2, "0:00")]
)
def test_durations(seconds, text):
    assert progress.format_remaining_time(seconds) == text
