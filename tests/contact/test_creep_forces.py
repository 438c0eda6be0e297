"""Creep forces against linear theory, closed forms and an independent program."""

import json
from pathlib import Path

import numpy as np
import pytest

from tests.scenes import steady
from tractive_sam.reference import creep_coefficients

REFERENCE = json.loads((Path(__file__).parents[1] / "data" / "reference.json").read_text("utf-8"))


def test_curve_lies_on_that_of_an_independent_program():
    """CONTACT, of first order: on an equal mesh with its slip, and in the limit of fine meshes."""
    for row in REFERENCE["creep_force_curve_spheres"]["rows"][::3]:
        creepage = -row["xi"] * 3 * 0.4013 * 0.4705 * (4 - 3 * 0.28) / (16 * 3.499981**2)
        for slip, value, tolerance in (("upwind", "n61", 0.005), ("auto", "mesh_limit", 0.001)):
            settings = (f"creepage.longitudinal={creepage!r}", f'solver.slip="{slip}"')
            contact = steady("spheres", *settings, elements=61)
            ratio = contact.Qx / (0.4013 * contact.P)
            assert ratio == pytest.approx(row[value], abs=tolerance)


@pytest.mark.parametrize(("a_over_b", "poisson"), [(1.0, 0.25), (0.5, 0.0), (2.0, 0.25)])
def test_linear_theory_is_the_limit_without_slip(a_over_b, poisson):
    """Kalker's coefficients, extrapolated over two meshes of first order."""
    truth = creep_coefficients(a_over_b, poisson)
    coarse, fine = (no_slip_coefficients(a_over_b, poisson, n) for n in (50, 100))
    extrapolated = 2 * fine - coarse
    # Staircase noise of the two contact areas, after scaling by area: 1-2 %.
    np.testing.assert_allclose(extrapolated, truth, rtol=0.025)


def no_slip_coefficients(a_over_b, poisson, across):
    a = 1.0
    b = a / a_over_b
    out = {}
    for key, creepage in {"11": "longitudinal", "22": "lateral", "33": "spin"}.items():
        contact = elliptic(a, b, poisson, across, creepage)
        hertz = contact.scene.hertz
        c = np.sqrt(hertz.a * hertz.b)
        # The mesh's own contact area instead of the ellipse: forces scale like c², c³, c⁴.
        area = np.count_nonzero(contact.touching) * contact.grid.element_area
        c *= np.sqrt(area / hertz.area)
        if key == "11":
            out["11"] = -contact.Qx / (c**2 * contact.xi_x)
        elif key == "22":
            out["22"] = -contact.Qy / (c**2 * contact.xi_y)
        else:
            out["23"] = -contact.Qy / (c**3 * contact.spin)
            out["33"] = -contact.Mz / (c**4 * contact.spin)
    return np.array([out["11"], out["22"], out["23"], out["33"]])


def elliptic(a, b, poisson, across, creepage):
    """A contact of semi-axes near (a, b), G = 1, with friction too high to slip."""
    from tractive_sam.contact import Model, equilibrium  # noqa: PLC0415
    from tractive_sam.scene import Scene  # noqa: PLC0415

    radius_x, radius_y, load = hertz_for(a, b, poisson)
    body = {"shear": 1.0, "poisson": poisson, "radius_x": 2 * radius_x, "radius_y": 2 * radius_y}
    scene = Scene(
        body={"A": body, "B": body},
        load={"normal": load},
        creepage={creepage: 1e-9},
        friction={"mu": 1000.0},
        grid={
            "half_length": (1.12 * a, 1.12 * b),
            "elements": (int(1.12 * across), int(1.12 * across)),
        },
    )
    contact = equilibrium(Model(scene))
    assert contact.converged, contact.message
    return contact


def hertz_for(a, b, poisson):
    """Combined radii and load of a flat contact with given semi-axes."""
    from scipy.special import elliprd  # noqa: PLC0415

    e_star, p0 = 1.0 / (1.0 - poisson), 1e-3
    scale = p0 * a * b / (3.0 * e_star)
    radius_x = 0.5 / (scale * elliprd(0.0, b**2, a**2))
    radius_y = 0.5 / (scale * elliprd(0.0, a**2, b**2))
    return radius_x, radius_y, 2.0 / 3.0 * np.pi * a * b * p0
