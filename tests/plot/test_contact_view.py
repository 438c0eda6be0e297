import numpy as np
import pytest

from tests.plot import strip_theory as strips
from tractive_sam.plot import ContactView, Scale

MU = (0.6, 0.3)


def test_contact_and_history_give_the_same_state():
    solved = ContactView.from_source(strips.contact())
    stored = ContactView.from_source(strips.history(), 0)
    for name in ("pressure", "traction", "slip", "wear", "sliding"):
        np.testing.assert_array_equal(getattr(solved.contact, name), getattr(stored.contact, name))
    assert (solved.scale, solved.title) == (stored.scale, stored.title)
    assert ContactView.from_source(solved) is solved


def test_history_shows_its_last_revolution_by_default():
    assert ContactView.from_source(strips.history()).contact.revolution == 100
    with pytest.raises(LookupError, match="0, 10, 100"):
        ContactView.from_source(strips.history(), 5)
    with pytest.raises(LookupError, match="none"):
        ContactView.from_source(strips.history(stored=()))


def test_slip_zone_is_where_the_traction_reaches_its_bound():
    contact = strips.contact()
    lead = strips.HERTZ.a * np.sqrt(np.maximum(1 - (strips.Y / strips.HERTZ.b) ** 2, 0))
    behind = strips.X[:, None] < np.minimum(2 * strips.SLIPPING - lead, lead)
    np.testing.assert_array_equal(contact.sliding, contact.touching & behind)


@pytest.mark.parametrize(("angle", "mu"), [(0, 0.6), (90, 0.3), (180, 0.6), (45, 0.3794733)])
def test_utilisation_of_orthotropic_friction(angle, mu):
    """Traction along x at the bound: 1/mu² = cos²/mu_1² + sin²/mu_2²."""
    requested = strips.scene(mu=MU, angle=angle)
    contact = strips.contact(requested, traction=strips.traction(mu))
    slides = contact.sliding
    assert slides.any()
    np.testing.assert_allclose(contact.utilisation[slides], contact.pressure[slides])


@pytest.mark.parametrize("angle", [0.0, 30.0, 90.0, -45.0])
def test_bounds_enclose_the_friction_ellipse(angle):
    state = ContactView.from_source(strips.contact(strips.scene(mu=MU, angle=angle)))
    turn, beta = np.linspace(0, 2 * np.pi, 3601), np.radians(angle)
    e1, e2 = 0.6 * np.cos(turn), 0.3 * np.sin(turn)
    p_x, p_y = np.cos(beta) * e1 - np.sin(beta) * e2, np.sin(beta) * e1 + np.cos(beta) * e2
    np.testing.assert_allclose(state.bound_ratios, (p_x.max(), p_y.max()), rtol=1e-6)


def test_without_friction():
    state = ContactView.from_source(
        strips.contact(strips.scene(mu=None), traction=np.zeros((2, 31, 33)))
    )
    assert state.bound_ratios == (0.0, 0.0)
    assert state.isotropic
    assert not state.contact.utilisation.any()


def test_without_hertz_the_contact_is_its_own_scale():
    single = strips.scene(hertz=None)
    contact = strips.contact(single)
    own = Scale(contact.half_width_x, contact.half_width_y, contact.p_max, hertz=False)
    assert ContactView.from_source(contact).scale == own
    scale = ContactView.from_source(strips.history(requested=single)).scale
    assert (scale.a, scale.b, scale.p) == (strips.HERTZ.a, strips.HERTZ.b, strips.HERTZ.p0)
    assert scale.p_symbol == r"p_\mathrm{max}"


def test_caption():
    assert ContactView.from_source(strips.history(), 10).caption == "Strips, N\u00a0=\u00a010"
    assert ContactView.from_source(strips.contact(strips.scene(title=""))).caption == ""
