"""Cheap scenes and synthetic measurements."""

import numpy as np
import pytest

import tractive_sam as ts

CREEPAGES = [-5e-4, -1e-3, -2e-3, -4e-3]


@pytest.fixture(scope="session")
def spheres():
    """Two spheres on a coarse mesh, without a layer: E and p of order one."""
    scene = ts.Scene.builtin("spheres").replace(subsurface=None)
    return scene.replace(**{"grid.elements": (17, 17)})


@pytest.fixture(scope="session")
def discs():
    """Twin discs that wear, on a coarse mesh, with fixed steps."""
    steps = (0, 1, 5, 20, 80, 300, 1000, 2000, 3000)
    wear = {"coefficient": {"A": 1.3e-4, "B": 2.2e-4}, "revolutions": 3000, "save": steps}
    wear |= {"stepping": "saved", "turns": "equal"}
    scene = ts.Scene.builtin("twin-discs").replace(subsurface=None, wear=wear)
    return scene.replace(**{"grid.elements": (13, 27)})


def creep_data(scene, truth, noise=0.05, factors=1.0, **more):
    """Return a data set of Q_x/P over the longitudinal creepage, as a scene with `truth` has it."""
    scene = scene.replace(**truth)
    ratios = [
        ts.solve(scene.replace(**{"creepage.longitudinal": one})).Qx / scene.normal_load
        for one in CREEPAGES
    ]
    columns = {"creepage.longitudinal": CREEPAGES, "Qx_over_P": np.array(ratios) * factors}
    data = {"values": columns, "vary": "creepage.longitudinal", "observe": "Qx_over_P"}
    return data | {"noise": noise} | more


def worn_data(history, body, revolutions, noise=0.03):
    """Return a data set of the worn mass of a body after some revolutions of a history."""
    rows = [history["revolution"].tolist().index(n) for n in revolutions]
    masses = history["worn_mass"][rows, "AB".index(body)]
    columns = {"revolution": list(revolutions), "worn_mass": masses}
    return {"values": columns, "vary": "revolution", "observe": "worn_mass", "body": body} | {
        "noise": noise
    }


def starts(**values):
    """Return the tables of parameters with first values; dots of keys are double underscores."""
    return [{"key": key.replace("__", "."), "start": value} for key, value in values.items()]
