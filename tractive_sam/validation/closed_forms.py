"""Contacts and stresses with closed forms: Hertz, Carter, Cattaneo, Johnson, Spence, Eshelby."""

import math
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np
from scipy.special import ellipe, ellipk, elliprd

import tractive_sam as ts
from tractive_sam.reference import HertzContact, HertzLine
from tractive_sam.subsurface import InclusionGroup
from tractive_sam.validation.comparison import Comparison, PublishedSet, compare

SPHERES = ts.Scene.builtin("spheres").replace(subsurface=None)
MU, LOAD = 0.4013, 0.4705
"""Friction coefficient and load of the spheres, N."""

LINE = ts.Scene.builtin("cylinders").replace(subsurface=None)
MU_LINE, LOAD_LINE, RADIUS_LINE, YOUNG_LINE = 0.3, 500.0, 25.0, 208e3
"""Friction coefficient, load (N/mm), combined radius (mm) and modulus (MPa) of the cylinders."""

STEEL = {"shear": 82e3, "poisson": 0.28}
FLAT = {"radius_x": math.inf, "radius_y": math.inf}
ALUMINIUM = {"shear": 23e3, "poisson": 0.31}


def hertz_of(scene: ts.Scene) -> HertzContact | HertzLine:
    """Return the Hertz contact of a scene whose radii give a closed contact."""
    hertz = scene.hertz
    assert hertz is not None
    return hertz


def radii_of_ellipse(a: float, b: float, p0: float, modulus: float) -> tuple[float, float]:
    """Return the combined radii of a Hertz contact with semi-axes a and b, pressure p0 and E*."""
    scale = 2.0 * p0 * a * b / (3.0 * modulus)
    return 1.0 / (scale * elliprd(0.0, b * b, a * a)), 1.0 / (scale * elliprd(0.0, a * a, b * b))


def on_elements(scene: ts.Scene, across: int, **changes: Any) -> ts.Scene:
    """Return a scene with a mesh that has `across` elements over each axis of its contact.

    Four elements lie beside them, so that the edges of a line contact are edges of elements.
    """
    scene = scene.replace(**changes)
    share = (across + 4) / across
    if scene.line:
        return scene.replace(
            **{"grid.half_length": share * hertz_of(scene).a, "grid.elements": across + 4}
        )
    half = (share * hertz_of(scene).a, share * hertz_of(scene).b)
    return scene.replace(grid={"half_length": half, "elements": (across + 4, across + 4)})


def spheres() -> Iterator[Comparison]:
    """Hertz: two equal spheres."""
    contact = ts.solve(on_elements(SPHERES, 128, friction=None, creepage=None))
    radius, load, modulus = 0.5 * 337.5, LOAD, 1.0 / (1.0 - 0.28)
    a = (0.75 * load * radius / modulus) ** (1.0 / 3.0)
    yield compare("p_max, MPa", 1.5 * load / (math.pi * a * a), contact.p_max, 1e-4)
    yield compare("approach, mm", a * a / radius, contact.approach, 1e-4)
    yield compare("a, mm", a, contact.half_width_x, 1.0 / 128)


def ellipse(ratio: float) -> Iterator[Comparison]:
    """Hertz: curvatures and load of an ellipse b = `ratio` a, by complete elliptic integrals."""
    a, p0, modulus = 1.0, 1000.0, 1e5
    b = ratio * a
    square = 1.0 - min(ratio, 1.0 / ratio) ** 2
    long, short = max(a, b), min(a, b)
    k, e = ellipk(square), ellipe(square)
    # Johnson (1985), (4.26): long axis first.
    flat = p0 / modulus * short / (square * long**2) * (k - e)
    sharp = p0 / modulus * short / (square * long**2) * ((long / short) ** 2 * e - k)
    curvature_x, curvature_y = (flat, sharp) if a > b else (sharp, flat)
    body = {"young": 2.0 * modulus, "poisson": 0.0}
    scene = ts.Scene(
        body={
            "A": body | {"radius_x": 0.5 / curvature_x, "radius_y": 0.5 / curvature_y},
            "B": body | FLAT,
        },
        load={"normal": 2.0 / 3.0 * math.pi * a * b * p0},
    )
    contact = ts.solve(on_elements(scene, 96))
    yield compare("p_max, MPa", p0, contact.p_max, 2e-4)
    yield compare("approach, mm", p0 / modulus * short * k, contact.approach, 2e-4)
    yield compare("b/a", ratio, contact.half_width_y / contact.half_width_x, 2.0 / 96)


def line() -> Iterator[Comparison]:
    """Hertz: equal cylinders."""
    contact = ts.solve(on_elements(LINE, 128, friction=None, creepage=None))
    load, radius = LOAD_LINE, RADIUS_LINE
    modulus = YOUNG_LINE / (2.0 * (1.0 - 0.3**2))
    a = math.sqrt(4.0 * load * radius / (math.pi * modulus))
    yield compare("p_max, MPa", 2.0 * load / (math.pi * a), contact.p_max, 1.0 / 128**2)
    yield compare("a, mm", a, contact.half_width_x, 2.0 / 128**2)


def carter(share: float) -> Iterator[Comparison]:
    """Carter: force and stick zone of cylinders at a share of the creepage of full slip."""
    a, mu, radius = hertz_of(LINE).a, MU_LINE, RADIUS_LINE
    stick = 1.0 - share
    creepage = {"creepage.longitudinal": -share * mu * a / radius}
    contact = ts.solve(on_elements(LINE, 256, **creepage))
    yield compare("Q_x/(mu P)", 1.0 - stick**2, contact.Qx / (mu * contact.P), 1e-4)
    yield compare("length of the stick zone over 2a", stick, contact.stick_fraction, 2e-4, 1.0)


def antiplane() -> Iterator[Comparison]:
    """Carter in antiplane shear: the compliance is that of plane strain over 1 - nu."""
    a, mu, radius, poisson = hertz_of(LINE).a, MU_LINE, RADIUS_LINE, 0.3
    creepage = 0.4 * mu * a / radius
    drive = {"creepage.longitudinal": 0.0, "creepage.lateral": -creepage}
    contact = ts.solve(on_elements(LINE, 256, **drive))
    stick = 1.0 - 0.4 * (1.0 - poisson)
    yield compare("Q_y/(mu P)", 1.0 - stick**2, contact.Qy / (mu * contact.P), 1e-4)


def free_rolling(mu: float, published: str, error: float) -> Iterator[Comparison]:
    """Creepage of free rolling cylinders of aluminium and steel, at a = 0.1 mm."""
    radius = {"radius_x": 50.0, "radius_y": math.inf}
    scene = ts.Scene(
        body={"A": ALUMINIUM | radius, "B": STEEL | radius},
        load={"normal": 10.0, "force_x": 0.0},
        friction={"mu": mu},
    )
    scene = scene.replace(**{"load.normal": 10.0 * (0.1 / hertz_of(scene).a) ** 2})
    contact = ts.solve(on_elements(scene, 256))
    yield compare("|xi_x|", published, abs(contact.xi_x), error)


def shift() -> Iterator[Comparison]:
    """Cattaneo: shift of spheres under a tangential force, without rolling."""
    mu, load, nu, share = MU, LOAD, 0.28, 0.657
    a = (0.75 * load * 0.5 * 337.5 * (1.0 - nu)) ** (1.0 / 3.0)
    exact = 3.0 * mu * load * (2.0 - nu) / (8.0 * a) * (1.0 - (1.0 - share) ** (2.0 / 3.0))
    course = {"distance": [0.0, 0.1], "load.force_x": [share * mu * load] * 2}
    scene = on_elements(SPHERES, 87, transient=course, creepage=None)
    history = ts.roll(scene)
    yield compare("shift, mm", exact, -history["shift_x"][0], 1e-3)


def full_slip(angle: float) -> Iterator[Comparison]:
    """Orthotropic friction in full slip along x."""
    mu1, mu2 = 0.4, 0.2
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    effective = math.hypot(mu1 * c, mu2 * s)
    scene = ts.Scene.builtin("spheres-orthotropic").replace(
        **{"friction.angle": angle, "creepage.longitudinal": -10.0, "subsurface": None}
    )
    contact = ts.solve(on_elements(scene, 40))
    yield compare("Q_x/P", effective, contact.Qx / contact.P, 1e-6)
    yield compare("Q_y/P", (mu1**2 - mu2**2) * s * c / effective, contact.Qy / contact.P, 1e-6, mu1)


def spin_moment() -> Iterator[Comparison]:
    """Full slip by spin alone in a circle: the moment of friction."""
    drive = {"creepage.longitudinal": 0.0, "creepage.spin": 100.0}
    contact = ts.solve(on_elements(SPHERES, 128, **drive))
    exact = -3.0 * math.pi / 16.0
    yield compare(
        "M_z/(mu P a)", exact, contact.Mz / (MU * contact.P * hertz_of(contact.scene).a), 1e-3
    )


def von_mises_of_line() -> Iterator[Comparison]:
    """Largest von Mises stress below a frictionless cylinder, plane strain, nu = 0.3."""
    scene = on_elements(LINE, 128, friction=None, creepage=None)
    top = ts.stress_maximum(ts.solve(scene))
    z = np.linspace(0.5, 0.9, 40_001)
    root = np.sqrt(1.0 + z * z)
    xx, zz = -((1.0 + 2.0 * z * z) / root - 2.0 * z), -1.0 / root
    yy = 0.3 * (xx + zz)
    equivalent = np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2))
    hertz, place = hertz_of(scene), equivalent.argmax()
    yield compare("von Mises stress over p0", equivalent[place], top.value / hertz.p0, 1e-3)
    yield compare("depth over a", z[place], top.at[2] / hertz.a, 1e-2)


def stress_below_circle(poisson: float) -> Iterator[Comparison]:
    """Largest von Mises stress on the axis of a circle, from Huber's stresses (Johnson, 3.45)."""
    body = {"shear": 1.0, "poisson": poisson}
    scene = SPHERES.replace(friction=None, creepage=None)
    scene = scene.replace(**{f"body.{n}.{k}": v for n in "AB" for k, v in body.items()})
    scene = on_elements(scene, 64)
    top = ts.stress_maximum(ts.solve(scene))
    z = np.linspace(0.2, 0.8, 60_001)
    rr = -(1.0 + poisson) * (1.0 - z * np.arctan(1.0 / z)) + 0.5 / (1.0 + z * z)
    equivalent = np.abs(rr + 1.0 / (1.0 + z * z))
    hertz, place = hertz_of(scene), equivalent.argmax()
    yield compare("von Mises stress over p0", equivalent[place], top.value / hertz.p0, 1e-3)
    yield compare("depth over a", z[place], top.at[2] / hertz.a, 2e-2)


def sphere_in_tension(young: float, poisson: float) -> Iterator[Comparison]:
    """Eshelby: stress in a sphere far below the surface of steel under uniaxial tension.

    The part of a tension that changes the volume and the part that changes the shape of the sphere
    follow from the tensor of a sphere; both sums are over the moduli of sphere and steel.
    """
    shear, nu = 80e3, 0.3
    radii, at = (1.0, 1.0, 1.0), (0.0, 0.0, 1e3)
    ball = ts.Inclusion(at=at, radii=radii, cells=15, young=young, poisson=poisson)
    group = InclusionGroup([ball], shear, nu)
    tension = np.zeros((6, *group.box.shape))
    tension[2] = 1.0
    strain, own = group.solve(np.tensordot(np.linalg.inv(group.stiffness), tension, 1))
    stress = np.tensordot(group.stiffness, strain - own, 1)[:, 7, 7, 7]
    alpha, beta = (1 + nu) / (3 * (1 - nu)), 2 * (4 - 5 * nu) / (15 * (1 - nu))
    bulk = young / (3 * (1 - 2 * poisson)) / (2 * shear * (1 + nu) / (3 * (1 - 2 * nu)))
    rigid = young / (2 * (1 + poisson)) / shear
    mean = bulk / (1 + alpha * (bulk - 1)) / 3
    deviatoric = rigid / (1 + beta * (rigid - 1)) * 2 / 3
    yield compare("stress along the tension", mean + deviatoric, stress[2], 2e-3)
    yield compare("stress across it", mean - 0.5 * deviatoric, stress[0], 2e-3, 1.0)


MESH = "the mesh: {} elements across the contact, of second order".format
HERTZ = "Hertz 1881; Johnson 1985, Contact Mechanics, ch. 4"
STRESS = "Huber 1904; Johnson 1985, (3.45)"

SETS = (
    PublishedSet("Two spheres without friction", HERTZ, spheres, MESH(128)),
    *(
        PublishedSet(f"Ellipse b/a = {ratio:g}", HERTZ, partial(ellipse, ratio), MESH(96))
        for ratio in (0.2, 0.5, 2.0, 5.0)
    ),
    PublishedSet("Two cylinders without friction", HERTZ, line, MESH(128)),
    *(
        PublishedSet(
            f"Rolling cylinders, creepage {share:g} of full slip",
            "Carter 1926, Proc. R. Soc. A 112, 151",
            partial(carter, share),
            MESH(256),
        )
        for share in (0.1, 0.3, 0.5, 0.7, 0.9)
    ),
    PublishedSet(
        "Rolling cylinders with lateral creepage",
        "Carter 1926 in antiplane shear",
        antiplane,
        MESH(256),
    ),
    PublishedSet(
        "Free rolling of unlike cylinders, little friction",
        "Bentall and Johnson 1967, Int. J. Mech. Sci. 9, 389: 0.457 kappa a/R",
        partial(free_rolling, 0.001, "5.26e-4", 2e-3),
        "the mesh: 0.2 %",
    ),
    PublishedSet(
        "Shift of spheres without rolling",
        "Cattaneo 1938; Mindlin 1949; Johnson 1985, (7.42)",
        shift,
        MESH(87),
    ),
    *(
        PublishedSet(
            f"Orthotropic friction in full slip, {angle:g} degrees",
            "Associated slip rule; Juliá and Rodríguez-Tembleque 2025",
            partial(full_slip, angle),
        )
        for angle in (0.0, 30.0, 45.0, 60.0, 90.0)
    ),
    *(
        PublishedSet(
            f"{name} in steel under tension",
            "Eshelby 1957, Proc. R. Soc. A 241, 376",
            partial(sphere_in_tension, young, poisson),
            "the cells: 15 across the sphere",
            quick=young == 389e3,
        )
        for name, young, poisson in (
            ("Sphere of alumina", 389e3, 0.25),
            ("Sphere of titanium nitride", 380e3, 0.25),
            ("Sphere of manganese sulphide", 138e3, 0.3),
        )
    ),
    PublishedSet(
        "Full slip by spin alone", "Integral of mu p r over the circle", spin_moment, "the mesh"
    ),
    PublishedSet(
        "Stress below a cylinder", "McEwen 1949; Johnson 1985, (4.49)", von_mises_of_line, MESH(128)
    ),
    *(
        PublishedSet(
            f"Stress below a sphere, nu = {poisson:g}",
            STRESS,
            partial(stress_below_circle, poisson),
            MESH(64),
        )
        for poisson in (0.0, 0.25, 0.3, 0.5)
    ),
)
