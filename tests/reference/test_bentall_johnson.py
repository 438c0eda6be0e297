import math

import numpy as np
import pytest

from tractive_sam.mechanics.elasticity import Material, combine
from tractive_sam.mechanics.hertz_contact import combined_radius
from tractive_sam.reference import bentall_johnson_creepage

ALUMINIUM, STEEL = Material(23000.0, 0.31), Material(82000.0, 0.28)
RADIUS = combined_radius(50.0, 50.0)


def test_published_example():
    creepage = bentall_johnson_creepage(combine(ALUMINIUM, STEEL), 0.1, RADIUS)
    # 5.259e-4 with the rounded constant 0.457, 5.260e-4 by a boundary element program
    assert creepage == pytest.approx(-5.26e-4, rel=1e-3)


def test_equal_materials_roll_without_creepage():
    assert bentall_johnson_creepage(combine(STEEL, STEEL), 0.1, RADIUS) == 0


def test_swapped_bodies():
    there = bentall_johnson_creepage(combine(ALUMINIUM, STEEL), 0.1, RADIUS)
    assert bentall_johnson_creepage(combine(STEEL, ALUMINIUM), 0.1, RADIUS) == pytest.approx(-there)


def test_friction_forces_cancel():
    """Weighted with the pressure, as much of the contact slips forward as backward."""
    pair = combine(ALUMINIUM, STEEL)
    a = 0.1
    p0 = pair.E_star * a / (2 * RADIUS)
    angle = (np.arange(20000) + 0.5) * math.pi / 20000  # x = a cos(angle)
    pressure = p0 * np.sin(angle)
    slip = bentall_johnson_creepage(pair, a, RADIUS) + 2 * pair.coupling / pair.shear * pressure
    weights = pressure * np.sin(angle)
    assert np.sum(np.sign(slip) * weights) / np.sum(weights) == pytest.approx(0, abs=2e-4)
