"""A contact of one or two elements across is not resolved, whoever computes it."""

import numpy as np
import pytest

import tractive_sam as ts
from tractive_sam.run import solve_many

pytestmark = pytest.mark.filterwarnings("ignore::tractive_sam.schema.SceneWarning")

NAME = "not resolved"
SPHERES = ts.Scene.builtin("spheres").replace(subsurface=None)


def on(elements, scene=SPHERES, **changes):
    """A scene on elements of about its half width over the number."""
    return scene.replace(**{"grid": {"half_length": (7.0, 7.0), "elements": elements}} | changes)


@pytest.mark.parametrize("elements", [(3, 61), (61, 3), (3, 3)])
def test_two_elements_are_no_contact(elements):
    contact = ts.solve(on(elements), throw=False)
    assert min(contact.elements_across) < 3
    assert (contact.status, contact.converged) == (NAME, False)
    assert "grid" in contact.message
    with pytest.raises(ts.NotConverged):
        ts.solve(on(elements))


def test_three_elements_are_one():
    """The fewest that have a middle; on finer meshes of this contact, too."""
    for count in (5, 7, 31):
        contact = ts.solve(on((count, count)))
        assert min(contact.elements_across) >= 3


def test_of_a_line_contact_x_counts():
    line = ts.Scene.builtin("cylinders").replace(subsurface=None)
    a = line.hertz.a
    for elements, status in ((3, NAME), (31, "converged")):
        scene = line.replace(grid={"half_length": (2.4 * a,), "elements": (elements,)})
        assert ts.solve(scene, throw=False).status == status


def test_bodies_that_do_not_touch_are_solved():
    """Nothing is to be resolved."""
    gap = {"y": [-9.0, 9.0], "separation": [0.5, 0.5]}
    apart = on((21, 21), gap=gap, **{"load.approach": 1e-3})
    contact = ts.solve(apart.replace(gap=gap), wear=np.full((21, 21), 0.1))
    assert contact.converged
    assert contact.elements_across == (0, 0)


def test_a_roll_and_many_solves_say_so():
    history = ts.roll(on((3, 3)))
    assert history.status == NAME
    assert not history.finished
    found = solve_many(on((5, 5)), {"load.normal": [1e-3, 0.4705]})
    assert (found["status"] == NAME).values.tolist() == [True, False]


def test_a_course_may_begin_and_end_with_few_elements(tmp_path):
    """At touch and separation; not if the contact is so small throughout."""
    friction = {"mu": 0.3}
    lift = {"distance": (0.0, 2.0, 4.0), "load": {"normal": (1e-6, 0.47, 1e-6)}, "step": 0.5}
    scene = on((21, 21), friction=friction, creepage={"longitudinal": -1e-3}, transient=lift)
    touching = ts.roll(scene)
    assert touching.finished, touching.message
    assert touching["half_width_x"][0] == 0.5 * 14.0 / 21  # of one element
    small = scene.replace(**{"transient.load.normal": (1e-6, 1e-5, 1e-6)})
    history = ts.roll(small, tmp_path / "small.h5")
    assert history.status == NAME
    assert len(history) == len(touching)
    resumed = ts.roll(small, tmp_path / "small.h5", resume=True)
    assert (resumed.status, resumed.message) == (history.status, history.message)
    steady = scene.replace(**{"transient.start": "steady"})
    assert ts.roll(steady).finished
