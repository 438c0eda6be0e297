import numpy as np
import pytest

from tests.plot import strip_theory as strips
from tractive_sam.plot import Scale, State

ORTHOTROPIC = "[friction]\nmu = [0.6, 0.3]\nangle = {}\n"


def test_contact_and_history_give_the_same_state():
    solved = State.of(strips.contact())
    stored = State.of(strips.history(), 0)
    for name in ("x", "y", "pressure", "traction", "slip", "wear"):
        np.testing.assert_array_equal(getattr(solved, name), getattr(stored, name))
    for name in ("mu", "angle", "scale", "title"):
        assert getattr(solved, name) == getattr(stored, name)
    assert State.of(solved) is solved


def test_history_shows_its_last_revolution_by_default():
    assert State.of(strips.history()).revolution == 100
    with pytest.raises(LookupError, match="0, 10, 100"):
        State.of(strips.history(), 5)
    with pytest.raises(LookupError, match="none"):
        State.of(strips.history(stored=()))


def test_slip_zone_is_where_the_traction_reaches_its_bound():
    state = State.of(strips.contact())
    lead = strips.HERTZ.a * np.sqrt(np.maximum(1 - (strips.Y / strips.HERTZ.b) ** 2, 0))
    expected = state.touching & (strips.X[:, None] < np.minimum(2 * strips.SLIPPING - lead, lead))
    np.testing.assert_array_equal(state.sliding, expected)


@pytest.mark.parametrize(("angle", "mu"), [(0, 0.6), (90, 0.3), (180, 0.6), (45, 0.3794733)])
def test_utilisation_of_orthotropic_friction(angle, mu):
    """Traction along x at the bound: 1/mu² = cos²/mu_1² + sin²/mu_2²."""
    state = State.of(strips.contact(ORTHOTROPIC.format(angle), traction=strips.traction(mu)))
    np.testing.assert_allclose(state.utilisation[state.sliding], state.pressure[state.sliding])


@pytest.mark.parametrize("angle", [0.0, 30.0, 90.0, -45.0])
def test_bounds_enclose_the_friction_ellipse(angle):
    state = State.of(strips.contact(ORTHOTROPIC.format(angle)))
    turn, beta = np.linspace(0, 2 * np.pi, 3601), np.radians(angle)
    e1, e2 = 0.6 * np.cos(turn), 0.3 * np.sin(turn)
    p_x, p_y = np.cos(beta) * e1 - np.sin(beta) * e2, np.sin(beta) * e1 + np.cos(beta) * e2
    np.testing.assert_allclose(state.bounds, (p_x.max(), p_y.max()), rtol=1e-6)


def test_without_friction():
    state = State.of(strips.contact("", traction=np.zeros((2, 31, 33))))
    assert state.mu is None
    assert state.isotropic
    assert not state.utilisation.any()


def test_without_hertz_the_contact_is_its_own_scale():
    assert State.of(strips.contact(hertz=None)).scale == Scale(0.48, 0.79, 895.0, hertz=False)
    scale = State.of(strips.history(reference=False)).scale
    assert (scale.a, scale.b, scale.p) == (strips.HERTZ.a, strips.HERTZ.b, strips.HERTZ.p0)
    assert scale.p_symbol == r"p_\mathrm{max}"


def test_caption():
    assert State.of(strips.history(), 10).caption == "Strips, N\u00a0=\u00a010"
    assert State.of(strips.contact("")).caption == ""
