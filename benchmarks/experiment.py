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

from timing import show, write

import tractive_sam as ts
from tractive_sam.mechanics import USFD
from tractive_sam.validation.experiment import (
    SLIP,
    measured_friction,
    measured_work,
    predicted_work,
)

NAMES = ("predicted", "least", "most")


def main() -> None:
    friction = measured_friction()
    coefficients = friction.mean(), friction.min(), friction.max()
    print("friction in full slip {:.3f}, from {:.3f} to {:.3f}".format(*coefficients))
    law, rows = USFD["r8t-uic60"], []
    for slip, measured in zip(SLIP, measured_work(), strict=True):
        predictions = {
            name: predicted_work(mu, slip) for name, mu in zip(NAMES, coefficients, strict=True)
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
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ts.SceneWarning)  # 20 % of slip is meant
        main()
