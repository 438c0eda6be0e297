"""Contacts made of strips of Carter's solution: Hertzian pressure, stick at the leading edge."""

from types import SimpleNamespace

import numpy as np

from tractive_sam.mechanics.hertz import HertzContact
from tractive_sam.results.history import History
from tractive_sam.results.quantities import FIELDS, POINTS, PROFILES, SCALARS
from tractive_sam.results.record import Record

HERTZ = HertzContact(a=0.5, b=0.8, p0=900.0, approach=0.01, load=754.0)
TOML = (
    'title = "Strips"\n[friction]\nmu = 0.3\n[body.A]\nradius_y = 50.0\n[body.B]\nradius_y = inf\n'
)
SLIPPING = 0.2
"""Half the length of the slip zone, mm."""

X = 0.6 * np.linspace(-1, 1, 31)
Y = 1.0 * np.linspace(-1, 1, 33)


def pressure(hertz=HERTZ):
    return hertz.pressure(X[:, None], Y)


def traction(mu=0.3, hertz=HERTZ, direction=(1.0, 0.0)):
    """Traction that drives body A, in units of what friction carries along `direction`."""
    lead = hertz.a * np.sqrt(np.maximum(1 - (Y / hertz.b) ** 2, 0))
    stick = np.maximum(lead - SLIPPING, 0)
    less = np.sqrt(np.maximum(stick**2 - (X[:, None] - (lead - stick)) ** 2, 0))
    size = mu * np.maximum(pressure(hertz) - hertz.p0 / hertz.a * less, 0)
    return size * np.reshape(direction, (2, 1, 1))


def slip():
    """Slip against the traction, growing from the end of the stick zone."""
    lead = HERTZ.a * np.sqrt(np.maximum(1 - (Y / HERTZ.b) ** 2, 0))
    behind = np.maximum(np.minimum(2 * SLIPPING - lead, lead) - X[:, None], 0)
    return np.stack((-1e-3 * np.sqrt(behind), np.zeros_like(behind)))


def contact(toml=TOML, hertz=HERTZ, **changes):
    """What figures need to know of a solved contact."""
    fields = {"pressure": pressure(), "traction": traction(), "slip": slip()}
    return SimpleNamespace(
        converged=True,
        status="converged",
        scene=SimpleNamespace(to_toml=lambda: toml, hertz=hertz),
        grid=SimpleNamespace(x=X, y=Y),
        half_width_x=0.48,
        half_width_y=0.79,
        p_max=895.0,
        wear=np.zeros((len(X), len(Y))),
        **(fields | changes),
    )


def history(stored=(0, 10, 100), toml=TOML, reference=True):
    """A contact that wears: lower and wider at every stored revolution."""
    records = []
    for revolution in sorted({*range(0, 101, 5), *stored}):
        wider = 1 + 0.002 * revolution
        worn = HertzContact(HERTZ.a, HERTZ.b * wider, HERTZ.p0 / wider, 0.01, HERTZ.load)
        profile = 1e-5 * revolution * np.maximum(1 - (Y / worn.b) ** 2, 0)
        fields = dict.fromkeys(FIELDS, np.zeros((len(X), len(Y))))
        fields |= {"pressure": pressure(worn), "wear": np.tile(profile, (len(X), 1))}
        fields |= dict(zip(("traction_x", "traction_y"), traction(hertz=worn), strict=True))
        fields |= dict(zip(("slip_x", "slip_y"), slip(), strict=True))
        scalars = dict.fromkeys(SCALARS, 0.0) | {
            "revolution": revolution,
            "Qx_over_P": 0.2 + 1e-4 * revolution,
            "half_width_x": worn.a,
            "half_width_y": worn.b,
            "p_max": worn.p0,
            "p_95": 0.983 * worn.p0,
            "wear_max": profile.max(),
        }
        kept = fields if revolution in stored else {}
        points = dict.fromkeys(POINTS, (0.0, 0.0))
        records.append(Record(revolution, scalars, points, dict.fromkeys(PROFILES, profile), kept))
    hertz = {"a0": HERTZ.a, "b0": HERTZ.b, "p0": HERTZ.p0} if reference else {}
    grid = SimpleNamespace(x=X, y=Y, half_length=(0.62, 1.03125))
    return History.of_records(records, toml, grid, **hertz)
