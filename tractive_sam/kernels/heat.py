"""Heat that moves over the surface of a half-space: surface temperature by rectangles of flux.

A body passes below a steady source to -x at the speed V. The temperature is the sum over all that
the source has given off (Carslaw & Jaeger 1959, section 10.7): with s the root of the time since,

    T = 2 q / (rho c sqrt(pi kappa)) integral over s of A(s) B(s),
    A = [erf((x_+ + V s²)/(2 sqrt(kappa) s)) - erf((x_- + V s²)/(2 sqrt(kappa) s))] / 2,
    B = [erf(y_+/(2 sqrt(kappa) s)) - erf(y_-/(2 sqrt(kappa) s))] / 2,

x_+-, y_+- the sides of the rectangle as seen from the point. At rest it is the integral of
q/(2 pi lambda r), for V without bound the strip limit, which is causal. The integrand is smooth: it
is summed over panels of Gauss points, short enough for the fronts, which are sqrt(kappa)/V wide in
s. If that is small compared with an element, the fronts are steps: A is one or zero, and the
integral of erf(c/s) is s erf(c/s) + (c/sqrt(pi)) E1(c²/s²).
"""

from math import erf, exp, log, pi, sqrt

from tractive_sam.kernels.compiled import compiled


@compiled
def front_integrand(at, x, speed, kappa, out):
    """Set `out` (k, i) to erf((x_i + V s²)/(2 sqrt(kappa) s)) / 2 at points s_k and sides x_i."""
    for k in range(at.size):
        s = at[k]
        scale = 0.5 / (sqrt(kappa) * s)
        for i in range(x.size):
            out[k, i] = 0.5 * erf(scale * (x[i] + speed * s * s))


@compiled
def exponential_integral(x):
    """Return the exponential integral E1(x), x > 0."""
    euler = 0.5772156649015329
    if x > 700.0:
        return 0.0
    if x <= 1.0:
        total, term = -euler - log(x), 1.0
        for n in range(1, 30):
            term *= -x / n
            total -= term / n
        return total
    b = x + 1.0
    c, d = 1e300, 1.0 / b
    h = d
    for n in range(1, 200):
        a = -1.0 * n * n
        b += 2.0
        d = 1.0 / (a * d + b)
        c = b + a / c
        step = c * d
        h *= step
        if abs(step - 1.0) < 1e-15:
            break
    return h * exp(-x)


@compiled(inner=True)
def _spread(c, s):
    """Return the integral of erf(c/t) over t from 0 to s."""
    if s <= 0.0 or c == 0.0:
        return 0.0
    z = abs(c) / s
    value = s * erf(z) + abs(c) / sqrt(pi) * exponential_integral(z * z)
    return value if c > 0.0 else -value


@compiled(inner=True)
def _front_time(x, speed, kappa):
    """Return the variable s at which a heat front passes x, corrected for diffusion.

    The front in g = (V s² - x)/(2 sqrt(kappa) s) is odd except for the curvature of s(g), which
    makes the integral of [1 + erf(g)]/2 less than the integral of a step by kappa/(4 V² s).
    """
    if x <= 0.0:
        return 0.0
    return sqrt(x / speed) * (1.0 + 0.25 * kappa / (speed * x))


@compiled
def front_integral(x, y, dx, dy, speed, kappa, out):
    """Set `out` to the temperature integral over s at points (x_i, y_j), for sharp heat fronts."""
    width = 2.0 * sqrt(kappa)
    for i in range(x.size):
        first = _front_time(-(x[i] + 0.5 * dx), speed, kappa)
        last = _front_time(-(x[i] - 0.5 * dx), speed, kappa)
        for j in range(y.size):
            high, low = (y[j] + 0.5 * dy) / width, (y[j] - 0.5 * dy) / width
            out[i, j] = 0.5 * (
                _spread(high, last) - _spread(low, last)
                - _spread(high, first) + _spread(low, first)
            )  # fmt: skip
