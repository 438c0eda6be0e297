"""Contacts made of strips of Carter's solution: Hertzian pressure, stick at the leading edge."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np

from tractive_sam.mechanics.hertz_contact import HertzContact
from tractive_sam.results.column_table import PACKAGE_FIELDS, columns
from tractive_sam.results.grid import Grid
from tractive_sam.results.history import History
from tractive_sam.results.quantity import fields_table
from tractive_sam.results.record import Record, restart_fields
from tractive_sam.results.state import Cost, State, Status
from tractive_sam.scene import Friction, Scene

HERTZ = HertzContact(a=0.5, b=0.8, p0=900.0, approach=0.01, load=754.0)
SLIPPING = 0.2
"""Half the length of the slip zone, mm."""

GRID = Grid((0.62, 1.03125), (31, 33))
X, Y = GRID.x, GRID.y


class _Strips:
    """A scene but for what the theory takes in its place."""

    def __init__(self, **own):
        vars(self).update(own)

    def __getattr__(self, name):
        return getattr(PLAIN, name)


PLAIN = Scene.builtin("spheres").replace(grid=None, subsurface=None)


def scene(title="Strips", mu=(0.3, 0.3), angle=0.0, hertz=HERTZ):
    """What figures need to know of a scene; mu is None without friction."""
    return _Strips(
        title=title,
        friction=None if mu is None else Friction(mu=mu, angle=angle),
        hertz=hertz,
        body=SimpleNamespace(A=SimpleNamespace(radius_y=50.0), B=SimpleNamespace(radius_y=np.inf)),
    )


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


def contact(requested=None, **changes):
    """A solved contact."""
    fields = {"pressure": pressure(), "traction": traction(), "slip": slip()}
    of_scene = requested or scene()
    found = State(
        scene=of_scene,
        frame=None if of_scene.friction is None else of_scene.friction.frame,
        grid=GRID,
        gap=np.zeros(GRID.elements),
        wear=np.zeros(GRID.elements),
        approach=HERTZ.approach,
        xi_x=-1e-3,
        xi_y=0.0,
        spin=0.0,
        rolling_resistance=0.0,
        sliding=np.zeros(GRID.elements, bool),
        status=Status.CONVERGED,
        note="",
        residual=0.0,
        cost=Cost(),
        **(fields | changes),
    )
    return found.with_sliding_by_traction()


def history(stored=(0, 10, 100), requested=None):
    """A contact that wears: lower and wider at every stored revolution."""
    requested = requested or scene()
    names, records = columns(requested), []
    for revolution in sorted({*range(0, 101, 5), *stored}):
        wider = 1 + 0.002 * revolution
        worn = HertzContact(HERTZ.a, HERTZ.b * wider, HERTZ.p0 / wider, 0.01, HERTZ.load)
        profile = 1e-5 * revolution * np.maximum(1 - (Y / worn.b) ** 2, 0)
        now = contact(
            requested,
            pressure=pressure(worn),
            traction=traction(hertz=worn),
            slip=slip(),
        )
        kept = restart_fields(replace(now, wear=np.tile(profile, (len(X), 1))))
        values = {name: profile if one.dims == ("y",) else 0.0 for name, one in names.items()}
        values |= {
            "revolution": revolution,
            "Qx_over_P": 0.2 + 1e-4 * revolution,
            "half_width_x": worn.a,
            "half_width_y": worn.b,
            "p_max": worn.p0,
            "p_95": 0.983 * worn.p0,
            "wear_max": profile.max(),
            "converged": 1.0,
        }
        tables = {"fields": fields_table(kept, PACKAGE_FIELDS)}
        records.append(Record(values, names, tables if revolution in stored else {}))
    return History.of_records(records, requested, GRID)
