"""Stress cycles, life, temperature: closed forms and printed numbers."""

import math
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np
from scipy.optimize import brentq

import tractive_sam as ts
from tractive_sam.operators import SurfaceHeat
from tractive_sam.results import Grid
from tractive_sam.validation.closed_forms import (
    FLAT,
    LINE,
    MESH,
    hertz_of,
    on_elements,
    radii_of_ellipse,
)
from tractive_sam.validation.comparison import Comparison, PublishedSet, compare

ORTHOGONAL = {"criterion": "orthogonal-shear", "limit": 1.0, "bodies": ["A"]}


def frictionless_ellipse(a: float, b: float, across: int) -> ts.Scene:
    """Return a scene of a frictionless contact with the semi-axes a and b, and p0 = 1000 MPa."""
    modulus, p0 = 1e5, 1000.0
    radii = dict(zip(("radius_x", "radius_y"), radii_of_ellipse(a, b, p0, modulus), strict=True))
    body = {"young": 2.0 * modulus, "poisson": 0.0}
    load = {"normal": 2.0 / 3.0 * math.pi * a * b * p0}
    scene = ts.Scene(body={"A": body | radii, "B": body | FLAT}, load=load)
    return on_elements(scene, across)


def orthogonal_shear(ratio: float) -> Iterator[Comparison]:
    """Amplitude of the orthogonal shear stress, and its depth, below an ellipse a = `ratio` b."""
    # The rolling direction is that of a; Lundberg and Palmgren's t from the ratio of the axes.
    t = brentq(lambda t: (t * t - 1.0) * (2.0 * t - 1.0) - ratio**2, 1.0, 50.0)
    scene = frictionless_ellipse(ratio, 1.0, 61).replace(fatigue=ORTHOGONAL | {"depth": 1.0})
    top = ts.fatigue(ts.solve(scene))["A"].largest()
    shear, depth = (
        math.sqrt(2.0 * t - 1.0) / (2.0 * t * (t + 1.0)),
        (t + 1.0) * math.sqrt(2 * t - 1),
    )
    yield compare("tau_0/p0", shear, top.interior / hertz_of(scene).p0, 3e-3)
    yield compare("z_0/a", 1.0 / depth, top.interior_at[2] / hertz_of(scene).a, 2e-2, 1.0)


def shakedown(mu: float, first: str, certain: str, depth: str) -> Iterator[Comparison]:
    """Cylinders in full slip, nu = 0.3: p0/k at first yield and up to shakedown."""
    drive: dict[str, Any] = {"friction.mu": mu, "creepage.longitudinal": -0.05}
    if mu == 0.0:
        drive = {"friction": None, "creepage": None}
    fatigue = {"shear_yield": 300.0, "criterion": "orthogonal-shear", "limit": 250.0}
    scene = on_elements(LINE, 97, fatigue=fatigue, **drive)
    contact = ts.solve(scene)
    p0 = hertz_of(scene).p0
    yielding = ts.stress_maximum(contact).value
    yield compare("first yield, p0/k", first, math.sqrt(3.0) * p0 / yielding, 1e-3)
    left = ts.fatigue(contact)["A"].largest("residual_shear")
    yield compare("shakedown certain up to p0/k", certain, p0 / left.interior, 5e-4)
    yield compare("its depth over a", depth, left.interior_at[2] / hertz_of(scene).a, 2e-2, 1.0)


def shakedown_of_circle() -> Iterator[Comparison]:
    """Frictionless sphere, nu = 0.3: p0/k above which there is no shakedown."""
    scene = frictionless_ellipse(1.0, 1.0, 61).replace(grid=None)
    scene = scene.replace(**{"body.A.poisson": 0.3, "body.B.poisson": 0.3})
    fatigue = {"shear_yield": 300.0, "bodies": ["A"]}
    scene = on_elements(scene, 61, fatigue=fatigue)
    path = ts.fatigue(ts.solve(scene))["A"].largest("path_radius")
    yield compare("p0/k", "4.7", hertz_of(scene).p0 / path.value)


def life_over_load(kind: str, published: str) -> Iterator[Comparison]:
    """Life of the stressed volume of a "line" or "point" contact over its load."""
    scene, life, lives = LINE, ts.VolumeLife(slope=9.0 / 8.0), []
    if kind == "point":
        scene, life = frictionless_ellipse(1.0, 1.0, 41), ts.VolumeLife()
    for factor in (1.0, 2.0):
        loaded = scene.replace(friction=None, creepage=None, grid=None, fatigue=ORTHOGONAL)
        loaded = loaded.replace(**{"load.normal": factor * (scene.normal_load or math.nan)})
        cycled = ts.fatigue(ts.solve(on_elements(loaded, 41)))["A"]
        around = loaded.body.A.radius_x
        lives.append(life.life(life.volume(cycled.y, cycled.depth, cycled.utilisation, around)))
    yield compare("load-life exponent", published, -np.log2(lives[1] / lives[0]), 1e-3)


def strip() -> Iterator[Comparison]:
    """Temperature of a fast band source on a half-space, q = lambda = 1."""
    n, speed = 512, 2e6
    grid = Grid((1.0, 0.5), (n, 1))
    heat = SurfaceHeat(grid, speed, 1.0, 1.0)
    distance = 1.0 - grid.x
    unit = math.sqrt(math.pi * speed)
    uniform = heat(np.ones((n, 1)))[:, 0]
    exact = 2.0 * math.sqrt(distance[0])
    yield compare("uniform flux, trailing edge", exact, uniform[0] * unit, 1e-4)
    elliptic = heat(np.sqrt(1.0 - grid.x**2)[:, None])[:, 0]
    # Integral of sqrt(1 - s²)/sqrt(s - x) from x to 1, at its maximum over x.
    angle = np.linspace(0.0, 1.0, 20_001)

    def behind(x: float) -> float:
        s = x + (1.0 - x) * angle**2
        values = 2.0 * math.sqrt(1.0 - x) * np.sqrt(np.maximum(1.0 - s * s, 0.0))
        return float(np.trapezoid(values, angle))

    places = np.linspace(-0.7, -0.6, 101)
    values = [behind(x) for x in places]
    yield compare("elliptic flux, largest", max(values), elliptic.max() * unit, 1e-4)
    at = 1.0 - places[int(np.argmax(values))]
    yield compare("its distance from the edge over a", at, distance[elliptic.argmax()], 5e-3)


def disc(peclet: float, largest: str, mean: str, error: float) -> Iterator[Comparison]:
    """Temperature of a disc of uniform flux that slides on a half-space, q = a = lambda = 1."""
    n, parts = 128, 16
    grid = Grid((1.1, 1.1), (n, n))
    fine = (np.arange(parts) + 0.5) / parts - 0.5
    x = grid.x[:, None] + grid.dx * fine
    inside = x.reshape(-1, 1) ** 2 + x.reshape(1, -1) ** 2 < 1.0
    share = inside.reshape(n, parts, n, parts).mean(axis=(1, 3))
    warm = SurfaceHeat(grid, 2.0 * peclet, 1.0, 1.0)(share)
    yield compare("largest temperature", largest, warm.max(), error)
    yield compare("mean temperature", mean, (warm * share).sum() / share.sum(), error)


LUNDBERG = "Lundberg and Palmgren 1947, Acta Polytechnica 7"
MELAN = "Melan 1938; Johnson 1962; residual stresses minimised point by point"
JAEGER = "Jaeger 1942; Carslaw and Jaeger 1959, ch. 10"

SETS = (
    *(
        PublishedSet(
            f"Orthogonal shear stress below an ellipse, a = {ratio:g} b",
            LUNDBERG,
            partial(orthogonal_shear, ratio),
            MESH(61),
        )
        for ratio in (0.2, 0.5, 1.0, 2.0, 5.0)
    ),
    *(
        PublishedSet(
            f"Shakedown of cylinders in full slip, mu = {mu:g}",
            MELAN,
            partial(shakedown, mu, *printed),
            MESH(97),
        )
        for mu, *printed in (
            (0.0, "3.107", "4.000", "0.50"),
            (0.1, "3.063", "3.564", "0.46"),
            (0.2, "2.936", "3.202", "0.42"),
            (0.3, "2.598", "2.900", "0.38"),
        )
    ),
    PublishedSet(
        "Shakedown of a frictionless sphere",
        "Ponter, Hearle and Johnson 1985, J. Mech. Phys. Solids 33, 339",
        shakedown_of_circle,
    ),
    *(
        PublishedSet(
            f"Life of a {kind} contact over its load",
            LUNDBERG,
            partial(life_over_load, kind, exponent),
            "the integration over the depth: 0.1 %",
        )
        for kind, exponent in (("line", "4.000"), ("point", "3.000"))
    ),
    PublishedSet("Temperature of a fast band source", JAEGER, strip, "0.01 %: 512 elements"),
    PublishedSet(
        "Temperature of a disc at rest",
        JAEGER,
        partial(disc, 0.0, "1.0000", "0.8488", 1e-3),
        "0.1 %: 116 elements across the disc",
    ),
    *(
        PublishedSet(
            f"Temperature of a sliding disc, Pe = {peclet:g}",
            "Tian and Kennedy 1994, J. Tribol. 116, 167: fits",
            partial(disc, peclet, largest, mean, 0.04),
            "4 % of the fits",
        )
        for peclet, largest, mean in (
            (1.0, "0.7484", "0.5346"),
            (20.0, "0.2446", "0.1514"),
            (100.0, "0.1121", "0.0686"),
        )
    ),
)
