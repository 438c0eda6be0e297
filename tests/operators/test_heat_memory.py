"""Heat of earlier steps: against Jaeger's integral, Gauss's bell, and the heat that was given."""

from math import erf, pi, sqrt

import numpy as np
import pytest
from scipy.integrate import quad

from tractive_sam.operators.heat import (
    Exponentials,
    HeatMemory,
    SurfaceHeat,
    temperature_coefficients,
)
from tractive_sam.results import Grid

KAPPA, LAM = 1.0, 1.0


def line(n, half=1.24):
    return Grid((half, 0.5), (n, 1))


def warmed(grid, flux, speed, steps, length=1.0, **settings):
    """Rise and memory after steps, each of so many elements, under a constant flux."""
    memory = HeatMemory(grid, speed, KAPPA, LAM, **settings)
    time = length * grid.dx / speed
    now, past = SurfaceHeat(grid, speed, KAPPA, LAM, time), memory.cold_fields()
    for _ in range(steps):
        step = memory.step(past, time)
        rise, past = step.temperature + now(flux), step.after(flux)
    return rise, memory, past


@pytest.mark.parametrize("longest", [1e3, 1e6])
def test_exponentials_are_the_inverse_root(longest):
    times = np.geomspace(1.0, longest, 3000)
    error = Exponentials.fit(1.0, longest)(times) * np.sqrt(times) - 1.0
    assert np.abs(error).max() < 5e-4  # 4.3e-4, at the ends
    rough = Exponentials.fit(1.0, longest, ratio=6.0)(times) * np.sqrt(times) - 1.0
    assert np.abs(rough).max() > np.abs(error).max()


def test_uniform_flux_warms_by_the_root_of_time():
    """2 q sqrt(t/pi)/sqrt(k rho c), to rounding: below a wide element nothing goes aside."""
    place, time = np.zeros(1), 0.7
    rise = temperature_coefficients(place, place, 1e3, 1e3, 0.0, 2.0, 3.0, time)[0, 0]
    assert rise == pytest.approx(2.0 * sqrt(time / pi) * sqrt(2.0) / 3.0, rel=1e-12)


def test_a_later_time_adds_what_comes_between():
    """The flux since time 0 is the sum of the last part and the time before it."""
    x, y = np.arange(-4.0, 5.0), np.arange(3.0)
    short, long, steady = (
        temperature_coefficients(x, y, 1.0, 1.0, 3.0, KAPPA, LAM, t) for t in (0.3, 5.0, np.inf)
    )
    assert (short <= long + 1e-15).all()
    assert (long <= steady + 1e-15).all()
    late = temperature_coefficients(x, y, 1.0, 1.0, 3.0, KAPPA, LAM, 1e6)
    np.testing.assert_allclose(late, steady, rtol=1e-9)  # quadrature


@pytest.mark.parametrize("peclet", [0.5, 5.0, 50.0])
def test_suddenly_started_strip(peclet):
    """Jaeger's integral over the time since the start, by adaptive quadrature."""
    grid, speed = line(31), 2.0 * peclet
    flux = (np.abs(grid.x) < 1.0).astype(float)[:, None]  # 25 elements of 0.08
    steady = SurfaceHeat(grid, speed, KAPPA, LAM)(flux).max()

    def exact(x, time):
        def front_integrand(s):
            ends = ((x + side + speed * s * s) / (2.0 * s) for side in (1.0, -1.0))
            first, last = map(erf, ends)
            return first - last

        return quad(front_integrand, 0.0, sqrt(time), limit=200, epsabs=1e-9)[0] / sqrt(pi)

    for steps in (1, 3, 12, 40):
        rise = warmed(grid, flux, speed, steps)[0][:, 0]
        jaeger = np.array([exact(x, steps * grid.dx / speed) for x in grid.x])
        # 2e-3 at Pe 50: the flux is a step, which waves of the mesh have at half an element.
        assert np.abs(rise - jaeger).max() < 4e-3 * steady


@pytest.mark.slow
@pytest.mark.parametrize("peclet", [0.5, 5.0, 50.0])
def test_it_becomes_steady_on_finer_meshes(peclet):
    errors = []
    for n in (15, 47):
        grid = line(n)
        flux = np.sqrt(np.maximum(1.0 - grid.x**2, 0.0))[:, None]
        steady = SurfaceHeat(grid, 2.0 * peclet, KAPPA, LAM)(flux)
        rise = warmed(grid, flux, 2.0 * peclet, 10 * n)[0]
        errors.append(np.abs(rise - steady).max() / steady.max())
    # 63 elements: 2e-4, 1e-4 and 4e-4 of the largest rise: order 1.3 in the element, as the flux
    # begins as a root, down to the error of exponentials and the margin.
    assert errors[-1] < max(0.3 * errors[0], 8e-4)


def test_rectangle_since_its_start():
    """Many steps against a single one of all the time, with its heat integrated at once."""
    grid, speed, steps = Grid((1.2, 1.2), (21, 21)), 20.0, 17
    flux = np.sqrt(np.maximum(1.0 - grid.x[:, None] ** 2 - grid.y**2, 0.0))
    rise = warmed(grid, flux, speed, steps)[0]
    direct = SurfaceHeat(grid, speed, KAPPA, LAM, steps * grid.dx / speed)(flux)
    assert np.abs(rise - direct).max() < 3e-3 * direct.max()  # 1.6e-3 by 17 elements of the flux


def test_steps_of_any_length():
    grid, speed = line(31), 10.0
    flux = np.maximum(1.0 - grid.x**2, 0.0)[:, None]
    whole, halves, threes = (
        warmed(grid, flux, speed, count, length)[0]
        for count, length in ((12, 1.0), (24, 0.5), (4, 3.0))
    )
    assert np.abs(halves - whole).max() < 5e-4 * whole.max()  # 2e-4, of the mesh
    assert np.abs(threes - whole).max() < 5e-4 * whole.max()


def test_past_spreads_as_gauss_bell():
    """The dense matrix of a step, of heat that is spread over more than an element."""
    grid, speed, time = Grid((0.5, 0.5), (7, 5)), 1.0, 0.05
    memory = HeatMemory(grid, speed, KAPPA, LAM, margin=0.5)
    _, nx, ny = memory.shape
    rng = np.random.default_rng(1)
    past = memory.cold_fields()
    past[:, 8:-8, 2:-2] = rng.normal(size=past[:, 8:-8, 2:-2].shape)

    def bell(n, side, shift):
        offset = side * np.subtract.outer(np.arange(n), np.arange(n)) + shift
        return side * np.exp(-(offset**2) / (4.0 * KAPPA * time)) / sqrt(4.0 * pi * KAPPA * time)

    along, aside = bell(nx, grid.dx, speed * time), bell(ny, grid.dy, 0.0)
    sums = memory.exponentials
    left = np.tensordot(sums.weights * np.exp(-sums.rates * time), past, 1)
    dense = memory.factor * memory.on_mesh(along @ left @ aside.T)
    rise = memory.step(past, time).temperature
    # exp(-kappa (pi/dy)^2 t) = 4e-6 of what waves shorter than two elements would add
    np.testing.assert_allclose(rise, dense, atol=2e-5 * np.abs(dense).max())


def test_heat_in_the_body_is_the_heat_given():
    grid, speed = Grid((1.0, 1.0), (11, 9)), 10.0
    flux = np.maximum(1.0 - grid.x[:, None] ** 2 - grid.y**2, 0.0)
    _, memory, past = warmed(grid, flux, speed, 5, margin=40.0)
    given = flux.sum() * grid.element_area * 5 * grid.dx / speed
    # 3e-6: the margin is 4 diffusion lengths wide.
    assert memory.stored_heat(past) == pytest.approx(given, rel=1e-5)

    # A while after it the surface is warm by heat/(rho c sqrt(pi kappa t)), integrated over it.
    shock = memory.after_shock(memory.cold_fields(), flux)
    time = 2.0 * grid.dx / speed
    rise = memory.step(shock, time).rise
    exact = flux.sum() * KAPPA / LAM / sqrt(pi * KAPPA * time)
    assert rise.sum() == pytest.approx(exact, rel=5e-4)  # of the exponentials


def test_a_shock_is_a_short_flux():
    grid, speed = line(31), 10.0
    heat = np.maximum(1.0 - grid.x**2, 0.0)[:, None]
    memory, short, time = (
        HeatMemory(grid, speed, KAPPA, LAM),
        1e-4 * grid.dx / speed,
        grid.dx / speed,
    )
    brief = memory.step(memory.cold_fields(), short).after(heat / short)
    later = [
        memory.step(past, time).temperature
        for past in (brief, memory.after_shock(memory.cold_fields(), heat))
    ]
    assert np.abs(later[1] - later[0]).max() < 3e-3 * later[0].max()  # 1e-4 of an element moved


def test_settled_is_steady():
    grid, speed = line(31), 10.0
    flux = np.maximum(1.0 - grid.x**2, 0.0)[:, None]
    memory = HeatMemory(grid, speed, KAPPA, LAM)
    later = warmed(grid, flux, speed, 200)[2]
    difference = memory.on_mesh(memory.steady_fields(flux)[-1] - later[-1])
    assert np.abs(difference).max() < 2e-4 * later[-1].max()  # 6e-5, by how heat fades out


def test_a_wider_mesh_continues():
    speed, time = 10.0, 0.01
    narrow, wide = Grid((1.0, 0.5), (21, 1)), Grid((1.0 * 121 / 21, 0.5), (121, 1))
    flux = np.maximum(1.0 - narrow.x**2, 0.0)[:, None]
    small, past = (one for one in warmed(narrow, flux, speed, 4)[1:])
    large = HeatMemory(wide, speed, KAPPA, LAM)
    assert large.shape[0] > small.shape[0]
    rise = large.step(large.widen(past), time).temperature[50:-50]
    np.testing.assert_allclose(rise, small.step(past, time).temperature, rtol=5e-4)  # of both sums
