"""Layers bonded to a body: their response to waves, and influence coefficients."""

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.special import j1

import tractive_sam as ts
from tractive_sam.mechanics.layers import _fit_images

BASE = ts.Material(1.0, 0.3)
THREE = ts.LayeredBody(
    (
        ts.Layer(0.2, ts.Material(4.0, 0.25)),
        ts.Layer(0.3, ts.Material(0.5, 0.45)),
        ts.Layer(0.5, ts.Material(2.0, 0.3)),
    ),
    ts.Material(1.0, 0.35),
)


def coated(shear, thickness=1.0, poisson=0.3, base=BASE):
    return ts.LayeredBody((ts.Layer(thickness, ts.Material(shear, poisson)),), base)


@pytest.mark.parametrize(
    ("shear", "kh", "expected"),
    [
        (4.0, 0.5, (2.20692234, 0.94817642, 1.56649686, 0.60064962)),
        (4.0, 1.0, (1.57224354, 0.88101019, 1.17675506, 0.56921976)),
        (4.0, 2.0, (0.91048476, 0.78218463, 1.02222298, 0.33049062)),
        (0.25, 1.0, (0.40367786, 0.60462819, 0.84979452, 0.06072063)),
        (10.0, 0.5, (4.83745858, 1.15198917, 1.86119869, 1.22999171)),
        (0.1, 0.5, (0.20314910, 0.45445150, 0.53728815, 0.01791224)),
    ],
)
def test_response_of_a_coating(shear, kh, expected):
    """Normalised by the modulus of the coating; an independent solution of all waves at once."""
    found = shear * coated(shear).response(np.array([kh]))[:, 0]
    np.testing.assert_allclose(found, expected, atol=6e-9)  # digits of the expected values


def test_response_of_three_layers():
    found = np.array((1.0, 10.0)) * THREE.response(np.array((1.0, 10.0))) / (1.0, 10.0)
    expected = [
        (0.54625078, 0.34380101, 0.62010126, 0.09256199),
        (0.26827990, 0.21846772, 0.25722014, 0.11221771),
    ]
    np.testing.assert_allclose(found.T, expected, atol=6e-9)  # digits of the expected values


def test_closed_form_of_normal_response():
    """O'Sullivan & King, J. Tribol. 110 (1988) 235-240."""
    k, shear, nu, below = np.geomspace(0.01, 30.0, 40), 7.0, 0.2, 0.4
    a = 1.0 - 4.0 * (1.0 - nu) / (1.0 + shear * (3.0 - 4.0 * below))
    b = (shear - 1.0) / (shear + 3.0 - 4.0 * nu)
    fall = np.exp(-2.0 * k)
    above = 1.0 + 4.0 * b * k * fall - a * b * fall**2
    ratio = above / (1.0 - (a + b + 4.0 * b * k**2) * fall + a * b * fall**2)
    found = coated(shear, 1.0, nu, ts.Material(1.0, below)).response(k)[0]
    np.testing.assert_allclose(found, ratio * (1.0 - nu) / shear, rtol=1e-10)  # rounding


@pytest.mark.parametrize("kh", [1e-6, 1e-3, 1.0, 50.0, 2000.0])
def test_equal_layers_are_a_homogeneous_body(kh):
    steel = ts.Material(8e4, 0.3)
    layers = tuple(ts.Layer(h, steel) for h in (0.1, 1.0, 0.4))
    found = ts.LayeredBody(layers, steel).response(np.array([kh]))[:, 0]
    # Waves that are long compared with the layers are almost linearly dependent.
    np.testing.assert_allclose(found, steel.compliances, rtol=1e-9)


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.499, 0.5])
@pytest.mark.parametrize("shear", [1e-3, 0.1, 10.0, 1e3])
def test_exponentials_fit_the_response(shear, poisson):
    body = coated(shear, 0.3, poisson)
    heights, amplitudes = body.images
    k = np.geomspace(1e-7, 200.0, 501)
    fitted = body.compliances[:, None] + amplitudes @ np.exp(-np.outer(heights, k))
    response = body.response(k)
    # Twice the error at which no further heights are tried, as other waves are tested.
    assert (abs(fitted - response) / response[[0, 1, 2, 1]]).max() < 2e-6


@dataclass(frozen=True)
class ByQuadrature(ts.SpectralHalfSpaces):
    """Integrals over the waves, which also hold for responses without closed form."""

    body: ts.LayeredBody

    @property
    def surface(self):
        return ts.HalfSpaces(self.body.layers[0].material, self.B)

    def spectrum(self, component, kx, ky):
        k = np.hypot(kx, ky)
        of_A = self.body.response(k.ravel()).reshape(4, *k.shape)
        of_B = np.array((1.0, 1.0, 1.0, -1.0)) * self.B.compliances
        zz, along, across, lift = of_A + of_B[:, None, None]
        return {
            "zz": zz / k,
            "xx": (across + (along - across) * (kx / k) ** 2) / k,
            "yy": (across + (along - across) * (ky / k) ** 2) / k,
            "xy": (along - across) * kx * ky / k**3,
            "xz": 1j * lift * kx / k**2,
            "yz": 1j * lift * ky / k**2,
        }[component]


@pytest.mark.parametrize("sides", [(0.1, 0.1), (0.3, 0.1), (1.5, 1.0)])
@pytest.mark.parametrize("component", ["xx", "xy", "yy", "zz", "xz", "yz"])
def test_coefficients_against_quadrature(component, sides):
    other, body = ts.Material(3.0, 0.25), coated(4.0)
    found = ts.LinearHalfSpaces(body, other).coefficients(component, (30, 20), *sides)
    waves = ByQuadrature(BASE, other, 1.0, body)
    expected = waves.coefficients(component, (30, 20), *sides)
    # The fit of the response by exponentials has an error of 1e-9 here, of S_Lz 3e-9.
    np.testing.assert_allclose(found, expected, atol=5e-9 * abs(expected).max())


@pytest.mark.parametrize("component", ["zz", "xx", "xy", "xz"])
def test_homogeneous_bodies_have_the_coefficients_of_half_spaces(component):
    pair, sides = (ts.Material(2.0, 0.2), ts.Material(5.0, 0.4)), (0.1, 0.15)
    found = ts.LinearHalfSpaces(*pair).coefficients(component, (20, 20), *sides)
    expected = ts.HalfSpaces(*pair).coefficients(component, (20, 20), *sides)
    np.testing.assert_allclose(found, expected, atol=1e-15 * abs(expected).max())  # rounding


@pytest.mark.parametrize(("row", "component"), [(0, "zz"), (1, "xx"), (2, "yy")])
def test_strips_are_long_rectangles(row, component):
    """Differences of displacements by strips are integrals over waves along x."""
    law, dx = ts.LinearHalfSpaces(coated(5.0, 0.4), BASE, datum=3.0), 0.05
    table = law.coefficients(component, (60, 1), dx, 1.0)[:, 0]
    nodes, weights = np.polynomial.legendre.leggauss(24)
    edges = np.linspace(0.0, 400.0, 1601)
    k = (edges[:-1, None] + 0.125 * (1.0 + nodes)).ravel()
    weights = np.tile(0.125 * weights, 1600)
    change = coated(5.0, 0.4).response(k)[row] - coated(5.0).compliances[row]
    places = dx * np.arange(1, 60)
    # Of the change from the surface, which ends at k = 18/h.
    mean = dx * np.sinc(0.5 * k * dx / np.pi)
    raised = ((np.cos(np.outer(places, k)) - 1.0) * mean) @ (weights * change / k) / np.pi
    surface = ts.LinearHalfSpaces(ts.Material(5.0, 0.3), BASE, datum=3.0)
    plain = surface.coefficients(component, (60, 1), dx, 1.0)[:, 0]
    found = (table - plain)[1:] - (table - plain)[0]
    np.testing.assert_allclose(found, raised, atol=1e-8 * abs(raised).max())  # the fit


def test_thin_layer_under_a_loaded_element():
    """The displacement at the centre of an element, as an integral over waves and angles."""
    body, rigid, side = coated(0.337, 0.0034), ts.Material(np.inf, 0.3), 0.15
    nodes, weights = np.polynomial.legendre.leggauss(16)
    angle, share = 0.125 * np.pi * (nodes + 1.0), 0.125 * np.pi * weights
    reach = 0.5 * side / np.cos(angle)  # distance of the edge
    edges = np.linspace(0.0, 120.0 / 0.0034, 3000)
    half = 0.5 * np.diff(edges)[:, None]
    k = (edges[:-1, None] + half * (1.0 + nodes)).ravel()
    change = (body.response(k)[0] - BASE.compliances[0]) / k * (half * weights).ravel()
    raised = 8.0 * share @ (reach * (j1(np.outer(reach, k)) @ change)) / (2.0 * np.pi)
    plain, found = (
        ts.LinearHalfSpaces(A, rigid).coefficients("zz", (1, 1), side, side)[0, 0]
        for A in (BASE, body)
    )
    # Waves that are shorter than a twentieth of the layer are left out.
    assert found == pytest.approx(plain + raised, rel=1e-5)


def test_strip_far_away_acts_as_on_the_base():
    law = ts.LinearHalfSpaces(coated(5.0, 0.4), coated(5.0, 0.4), datum=3.0)
    base = ts.LinearHalfSpaces(BASE, BASE, datum=3.0)
    both = [b.coefficients("zz", (4001, 1), 1.0, 1.0)[:, 0] for b in (law, base)]
    steps = [np.diff(table)[[2000, -1]] for table in both]
    np.testing.assert_allclose(*steps, rtol=1e-4)  # (h/x)² times the stiffness ratio


def test_like_layers_are_not_coupled_and_unlike_ones_are():
    assert not ts.LinearHalfSpaces(coated(4.0), coated(4.0)).coupled
    assert ts.LinearHalfSpaces(coated(4.0), BASE).coupled


@pytest.mark.parametrize("thickness", [0.0, -1.0, np.inf, np.nan])
def test_thickness_must_be_positive(thickness):
    with pytest.raises(ValueError, match="thickness"):
        ts.Layer(thickness, BASE)


def test_response_that_exponentials_do_not_resolve_is_refused():
    with pytest.raises(ValueError, match="not resolved"):
        _fit_images(coated(4.0), good=0.0, largest_error=0.0)


def graded(shear, poisson=0.3):
    return ts.LayeredBody((ts.Layer(1.0, ts.Material(shear, poisson), "exponential"),), BASE)


@pytest.mark.parametrize(
    ("shear", "k", "expected"),
    [
        (4.0, 1.0, (2.09873557, 1.10542312, 1.78873626, 0.59424253)),
        (4.0, 4.0, (1.07793361, 0.83488882, 1.18812814, 0.35196665)),
        (0.25, 1.0, (0.26510477, 0.44387442, 0.55905391, 0.05751465)),
    ],
)
def test_response_of_a_graded_layer(shear, k, expected):
    """Roots of a quartic equation; normalised by the modulus of the surface."""
    found = shear * graded(shear).response(np.array([k]))[:, 0]
    np.testing.assert_allclose(found, expected, atol=6e-9)  # digits of the expected values


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.5])
@pytest.mark.parametrize("shear", [0.02, 30.0])
def test_many_layers_tend_to_the_graded_one(shear, poisson):
    """Of second order in their thickness."""
    k, exact, errors = np.array((0.1, 1.0, 4.0)), graded(shear, poisson), []
    for n in (20, 40):
        moduli = shear ** (1.0 - (np.arange(n) + 0.5) / n)
        layers = tuple(ts.Layer(1.0 / n, ts.Material(G, poisson)) for G in moduli)
        response = ts.LayeredBody(layers, BASE).response(k)
        errors.append(abs(response - exact.response(k)) / exact.response(k)[[0, 1, 2, 1]])
    assert errors[1].max() < 0.02
    assert (errors[1] < 0.3 * errors[0] + 1e-6).all()


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.5])
@pytest.mark.parametrize("shear", [1e-3, 0.1, 50.0])
def test_exponentials_fit_the_response_of_a_graded_layer(shear, poisson):
    body = graded(shear, poisson)
    heights, amplitudes = body.images
    k = np.geomspace(1e-3, 1e3, 301)
    fitted = body.compliances[:, None] + amplitudes @ np.exp(-np.outer(heights, k))
    # The error at which no further heights are tried, and at other waves.
    assert (abs(fitted - body.response(k)) / body.response(k)[[0, 1, 2, 1]]).max() < 2e-6


def test_exponentials_fit_the_longest_waves_of_graded_layers():
    parts = ((0.5, 300.0, 0.3), (0.1, 0.1, 0.45), (0.3, 5.0, 0.2))
    layers = (ts.Layer(h, ts.Material(G, nu), "exponential") for h, G, nu in parts)
    body = ts.LayeredBody(tuple(layers), BASE)
    heights, amplitudes = body.images
    k = np.geomspace(1e-6, 1e-2, 41)
    fitted = body.compliances[:, None] + amplitudes @ np.exp(-np.outer(heights, k))
    # Digits that the response loses in the longest waves.
    assert (abs(fitted - body.response(k)) / body.response(k)[[0, 1, 2, 1]]).max() < 1e-4


def test_the_opening_ahead_of_a_line_does_not_depend_on_the_unit_of_length():
    """A line has no side across it, and 1 stands for its length."""
    normal = np.array([[1.0, -1.0], [0.0, 0.0]])
    laws = [
        ts.LinearHalfSpaces(coated(0.2, thickness=scale), BASE, datum=10.0 * scale)
        for scale in (1.0, 1e3)
    ]
    small, large = (
        law.opening(normal, 0.1 * scale, 1.0) for law, scale in zip(laws, (1.0, 1e3), strict=True)
    )
    np.testing.assert_allclose(small, large, rtol=1e-6)  # of the fits of both responses


def test_gradient_without_change_is_a_plain_layer():
    layers = tuple(ts.Layer(1.0, BASE, gradient) for gradient in ("none", "exponential"))
    plain, same = (ts.LayeredBody((layer,), BASE).response(np.ones(1)) for layer in layers)
    np.testing.assert_array_equal(plain, same)


def test_unknown_gradient():
    with pytest.raises(ValueError, match="gradient"):
        ts.Layer(1.0, BASE, "linear")


@pytest.mark.parametrize("step", [0.1, 0.3, 0.4, 0.5])
def test_worn_layers_are_those_that_remain_to_a_step(step):
    """Also for steps that do not divide the thickness, and in a body that relaxes."""
    terms = ((0.5, 0.01),)
    for depth in np.linspace(0.0, 1.02, 52):
        body = THREE.worn(depth, step)
        thickness = [layer.thickness for layer in getattr(body, "layers", ())]
        late = sum(thickness) - max(1.0 - depth, 0.0)
        assert -1e-8 <= late <= step * 0.5
        # A layer that is worn through is gone.
        assert len(thickness) == np.sum(depth < np.array([0.2, 0.5, 1.0]) - 1e-8)
        assert ts.RelaxingBody(THREE, terms).worn(depth, step) == ts.RelaxingBody(body, terms)
