"""Twin discs of wheel and rail steel: measured and predicted frictional heat.

Lewis & Dwyer-Joyce 2004 (Proc. IMechE J 218, 467-478) tested dry discs of wheel steel R8T on rail
steel UIC60 900A at 1500 MPa and 400 rpm. Their tables 1 and 3 give the half-width, the frictional
heat for each slip and the flash temperatures (here from the transcription
github.com/thiernodms/KPFASTSIMUSFD, commit 452fbd1).

The prediction has one coefficient, the friction coefficient: the mean of the tests in full slip, at
3 % and more. The diameter of 47 mm and the track width of 10 mm are
properties of the machine. They are not in the transcription; the published half-width and flash
temperatures confirm them.
"""

import math
from collections.abc import Iterator

import numpy as np

import tractive_sam as ts
from tractive_sam.validation.closed_forms import hertz_of
from tractive_sam.validation.comparison import Comparison, PublishedSet, compare

SLIP = np.array([0.002, 0.005, 0.01, 0.03, 0.075, 0.10, 0.15, 0.20])
HEAT = ("1.3", "9.2", "25.7", "102.6", "246.0", "327.8", "492.1", "728.4")
"""Frictional heat, W."""

FLASH = ("0.13", "0.9", "2.5", "10.1", "24.4", "32.8", "49.9", "75.0")
"""Mean flash temperature, K."""

HALF_WIDTH, PECLET, HEAT_CAPACITY = 0.315, 10.3, 8000 * 500 * 1e-9  # mm, 1, J/(mm3 K)
PRESSURE, RADIUS, TRACK, RPM = 1500.0, 23.5, 10.0, 400.0
SPEED = 2.0 * math.pi * RADIUS * RPM / 60.0  # mm/s
AREA = 2.0 * HALF_WIDTH * TRACK  # mm²

DISC = {"young": 204e3, "poisson": 0.3, "radius_x": RADIUS, "radius_y": math.inf}
SCENE = ts.Scene(
    title="Twin discs",
    body={"A": DISC, "B": DISC},
    load={"pressure": PRESSURE},
    friction={"mu": 0.4},
)


def measured_work() -> np.ndarray:
    """Return the measured work T-gamma/A for each slip, N/mm²."""
    return np.array(HEAT, float) * 1e3 / (SPEED * AREA)


def measured_friction() -> np.ndarray:
    """Return the friction coefficients of the tests in full slip."""
    return (measured_work() / SLIP / (0.25 * np.pi * PRESSURE))[SLIP >= 0.03]


def predicted_work(mu: float, slip: float) -> float:
    """Return the computed work T-gamma/A of the discs, N/mm²."""
    contact = ts.solve(SCENE.replace(**{"friction.mu": mu, "creepage.longitudinal": -slip}))
    return contact.t_gamma / (2.0 * hertz_of(contact.scene).a)


def heat() -> Iterator[Comparison]:
    """Yield the frictional heat of each test."""
    friction = measured_friction()
    scatter = max(friction.max() / friction.mean() - 1.0, 1.0 - friction.min() / friction.mean())
    for slip, printed in zip(SLIP, HEAT, strict=True):
        work = predicted_work(friction.mean(), slip)
        yield compare(f"heat, W, slip {slip:.1%}", printed, work * SPEED * AREA / 1e3, scatter)


def flash_temperature() -> Iterator[Comparison]:
    """Yield the half-width, and mean flash temperatures of a band source of the published heat."""
    yield compare("a, mm", str(HALF_WIDTH), hertz_of(SCENE).a, 2e-3)
    diffusivity = SPEED * HALF_WIDTH / (2.0 * PECLET)
    conductivity = diffusivity * HEAT_CAPACITY
    unit = 0.5 * 1.064 / conductivity * math.sqrt(HALF_WIDTH * diffusivity / SPEED)
    for slip, watts, printed in zip(SLIP, HEAT, FLASH, strict=True):
        computed = unit * float(watts) / AREA
        yield compare(f"flash temperature, K, slip {slip:.1%}", printed, computed, 6e-2)


LEWIS = "Lewis and Dwyer-Joyce 2004, Proc. IMechE J 218, 467"

SETS = (
    PublishedSet(
        "Twin discs R8T on UIC60 900A: frictional heat",
        LEWIS,
        heat,
        "the scatter of the friction coefficient in full slip: 8 %",
        "Below 3 % slip, smooth elastic discs transmit more force than the tested discs: rough or "
        "oxidised surfaces deform in shear, and this compliance was not measured.",
    ),
    PublishedSet(
        "Twin discs R8T on UIC60 900A: half-width and flash temperature",
        LEWIS,
        flash_temperature,
        "6 %: constants of the material are rounded; 0.2 % of the half-width",
    ),
)
