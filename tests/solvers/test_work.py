"""Convolutions that each method needs: an error in a direction or a weight only costs iterations.

Bounds are 12 % above what the methods need, in applications of the tangential operator. The number
depends on the scene and the methods, not on the machine, except for single iterations that rounding
adds or saves.
"""

import pytest

import tractive_sam as ts
from tractive_sam.compute import ConvolutionMeter
from tractive_sam.contact import Model, equilibrium

SPHERES = ts.Scene.builtin("spheres").replace(
    subsurface=None, **{"solver.tolerance": 1e-8, "grid.elements": (33, 33)}
)

CONVOLUTIONS = {
    "normal problem": (8.2, {"creepage": None, "grid.elements": (45, 45)}),
    "half of a mesh": (22.3, {}),
    "all of a mesh": (37.7, {"creepage.spin": 5e-4}),
    "orthotropic friction": (37.0, {"friction.mu": (0.4, 0.2), "friction.angle": 30.0}),
    "prescribed force": (37.1, {"creepage": None, "load.force_x": 0.05}),
    "dissimilar bodies": (71.0, {"body.B.shear": 3.0}),
}


@pytest.mark.parametrize("kind", CONVOLUTIONS)
def test_steady_contacts_take_no_more_convolutions(kind):
    needed, keys = CONVOLUTIONS[kind]
    contact = equilibrium(Model(SPHERES.replace(**keys)))
    assert contact.converged
    assert contact.cost.convolutions < 1.12 * needed


def test_steps_take_no_more_convolutions():
    course = {
        "start": "rest",
        "distance": [0.0, 12 * 8.16 / 25],  # steps of one element
        "creepage.longitudinal": [-2e-3, -4e-3],
    }
    steps = SPHERES.replace(creepage=None, transient=course, **{"grid.elements": (25, 25)})
    assert ts.roll(steps)["convolutions"][1:].mean() < 1.12 * 7.0


def test_adaptive_wear_takes_no_more_convolutions():
    discs = ts.Scene.builtin("twin-discs-isotropic").replace(
        **{"grid.elements": (21, 61), "wear.revolutions": 500, "wear.save": [0, 500]}
    )
    assert _work_of(discs) < 1.12 * 66.6


def test_adaptive_steps_take_no_more_convolutions():
    course = {
        "start": "steady",
        "distance": [0.0, 3.0, 6.0],
        "creepage.longitudinal": [-1e-3, -3e-3, -3e-3],
        "stepping": "adaptive",
    }
    steps = SPHERES.replace(creepage=None, transient=course, **{"grid.elements": (21, 21)})
    assert _work_of(steps) < 1.12 * 168.8


def _work_of(scene):
    """Return the convolutions of a roll, also of contacts that it does not record."""
    meter = ConvolutionMeter(Model(scene).operators.lattice.padded)
    ts.roll(scene)
    return meter.convolutions
