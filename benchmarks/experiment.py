"""Twin discs of wheel and rail steel: measured and predicted frictional work.

Lewis & Dwyer-Joyce 2004 (Proc. IMechE J 218, 467-478) tested dry discs of wheel steel R8T on rail
steel UIC60 900A at 1500 MPa and 400 rpm. Their table 3 gives the frictional heat for each slip
(here from the transcription github.com/thiernodms/KPFASTSIMUSFD, commit 452fbd1). The mass losses
are published only in figures. The constants of a regression through these tests are published as
the USFD law (Braghin et al. 2006, Wear 261, 1253-1264), without the scatter.

The comparison is therefore for the frictional work, which follows from the contact, and the law is
evaluated for the measured and for the predicted work. The only coefficient of the prediction is the
friction coefficient: the mean of the tests in full slip (3 % and more), with its minimum and
maximum. The diameter of 47 mm and the track width of 10 mm are properties of the machine. They are
not in the transcription; the published half-width and flash temperatures confirm them.

    python benchmarks/experiment.py

Page: docs/validation.md
"""

import warnings

import numpy as np
from timing import show, write

import tractive_sam as ts
from tractive_sam.mechanics import USFD

SLIP = np.array([0.002, 0.005, 0.01, 0.03, 0.075, 0.10, 0.15, 0.20])
HEAT = np.array([1.3, 9.2, 25.7, 102.6, 246.0, 327.8, 492.1, 728.4])  # W
FLASH = np.array([0.13, 0.9, 2.5, 10.1, 24.4, 32.8, 49.9, 75.0])  # mean flash temperature, K
HALF_WIDTH, PECLET, HEAT_CAPACITY = 0.315, 10.3, 8000 * 500 * 1e-9  # mm, 1, J/(mm3 K)
PRESSURE, RADIUS, TRACK, RPM = 1500.0, 23.5, 10.0, 400.0
SPEED = 2.0 * np.pi * RADIUS * RPM / 60.0  # mm/s
FULL = SLIP >= 0.03
NAMES = ("predicted", "least", "most")

DISC = {"young": 204e3, "poisson": 0.3, "radius_x": RADIUS, "radius_y": np.inf}
SCENE = ts.Scene(
    title="Twin discs",
    body={"A": DISC, "B": DISC},
    load={"pressure": PRESSURE},
    friction={"mu": 0.4},
)


def flash() -> np.ndarray:
    """Return the mean flash temperature of a band source on both discs, K, as published."""
    diffusivity = SPEED * HALF_WIDTH / (2.0 * PECLET)
    conductivity = diffusivity * HEAT_CAPACITY
    flux = HEAT / (2.0 * HALF_WIDTH * TRACK)
    return 0.5 * 1.064 * flux / conductivity * np.sqrt(HALF_WIDTH * diffusivity / SPEED)


def predicted(mu: float, slip: float) -> float:
    """Return T-gamma/A of the discs, N/mm²."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ts.SceneWarning)  # 20 % of slip is meant
        scene = SCENE.replace(**{"friction.mu": mu, "creepage.longitudinal": -slip})
    contact = ts.solve(scene)
    return contact.t_gamma / (2.0 * contact.scene.hertz.a)


def main() -> None:
    hertz = SCENE.hertz
    area = 2.0 * HALF_WIDTH * TRACK
    work = HEAT * 1e3 / (SPEED * area)
    friction = (work / SLIP / (0.25 * np.pi * PRESSURE))[FULL]
    middle, low, high = friction.mean(), friction.min(), friction.max()
    print(f"half-width {hertz.a:.4f} mm, published {HALF_WIDTH}")
    print(f"ratio of computed to published flash temperatures: {np.round(flash() / FLASH, 3)}")
    print(f"friction in full slip {middle:.3f}, from {low:.3f} to {high:.3f}")
    law = USFD["r8t-uic60"]
    rows = []
    for slip, measured in zip(SLIP, work, strict=True):
        predictions = {
            name: predicted(mu, slip) for name, mu in zip(NAMES, (middle, low, high), strict=True)
        }
        rows.append(
            {
                "slip": slip,
                "measured": measured,
                **predictions,
                "over": predictions["predicted"] / measured,
                "wear measured": law.at(measured),
                **{f"wear {name}": law.at(value) for name, value in predictions.items()},
            }
        )
    write("experiment", rows)
    show("T-gamma/A of twin discs, N/mm²; wear according to the law, ug/(m mm²)", rows)


if __name__ == "__main__":
    main()
