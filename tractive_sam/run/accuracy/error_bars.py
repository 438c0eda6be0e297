"""How far results on a mesh may be from those on an infinitely fine one.

Of an error C h^p two meshes, of elements sqrt(2) times apart, differ by (2^(p/2) - 1) C h^p. So the
error of the finer one is their difference times 1.0 where it falls with h² (equal bodies),
times 2.4 where it falls with h (different bodies; see `operators.stencil`). On top of that, where
the edges of contact and of stick fall within their elements scatters the results by about as much,
so that a small difference may be mere chance: the difference before is looked at as well, and what
is seen of one force is taken for all, since one traction causes them.

The largest stress at a surface is taken at centres of elements. At a sliding edge it falls by up to
h/a from the edge to the next centre, whatever two meshes say: sigma_xx = -2 mu p_0 x/a (K. L.
Johnson, Contact Mechanics, 1985, section 7.1).
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Self

import numpy as np

from tractive_sam.results.maximum import VonMisesMaximum
from tractive_sam.results.state import Contact

SAFETY = 3.0
"""Error bar over the difference between the last two meshes (benchmarks/error_bars.py)."""

FORMER = 0.7
"""Weight of the difference before: 2^(-1/2), by which errors of first order fall."""

SHARED = 0.4
"""Least relative bar of a force over the largest of all forces, and over that for pressure."""

FORCES = ("Qx", "Qy", "Mz")
SHARING = (*FORCES, "p_max")


@dataclass(frozen=True)
class Sample:
    """The quantities of one state on one mesh.

    Attributes
    ----------
    values : mapping of str to float
        By their recorded names; stress as "interior A", "surface A".
    scales : mapping of str to float
        What an error of each is relative to; zero of what the scene gives. Forces: the integral of
        the magnitude of the traction, for the moment times the mean radius of the contact.
    residual : float
        Relative residual of the contact conditions.
    """

    values: Mapping[str, float]
    scales: Mapping[str, float]
    residual: float

    @classmethod
    def of(cls, contact: Contact, maxima: Mapping[str, VonMisesMaximum]) -> Self:
        """The sample of a contact and the largest stresses in its bodies."""
        names = ("P", *FORCES, "xi_x", "xi_y", "approach", "p_max")
        values = {name: float(getattr(contact, name)) for name in names}
        values["wear_max"] = float(contact.wear.max())
        force = float(np.hypot(*contact.traction).sum() * contact.grid.element_area)
        arm = contact.half_width_x
        if not contact.grid.line:
            arm = math.sqrt(arm * contact.half_width_y)
        creepage = math.hypot(contact.xi_x, contact.xi_y, contact.spin * arm)
        scales = {name: abs(value) for name, value in values.items()}
        scales |= {"Qx": force, "Qy": force, "Mz": force * arm, "xi_x": creepage, "xi_y": creepage}
        scales |= dict.fromkeys(off_given(contact), 0.0)
        for body, largest in maxima.items():
            values[f"interior {body}"] = float(np.nan_to_num(largest.interior))
            values[f"surface {body}"] = largest.surface
            scales |= {f"interior {body}": largest.value, f"surface {body}": largest.value}
        return cls(values, scales, contact.residual)


def off_given(contact: Contact) -> dict[str, float]:
    """How far the quantities that the scene gives are from what it gives, by their names."""
    load, creepage = contact.scene.load, contact.scene.creepage
    given = {
        "P": load.normal,
        "approach": load.approach,
        "Qx": load.traction_x,
        "xi_x": creepage.longitudinal if load.traction_x is None else None,
        "Qy": load.traction_y,
        "xi_y": creepage.lateral if load.traction_y is None else None,
    }
    return {
        name: abs(float(getattr(contact, name)) - value)
        for name, value in given.items()
        if value is not None
    }


def relative_error_bars(coarse: Sample, middle: Sample, fine: Sample) -> dict[str, float]:
    """Error bars of the finest of three samples, over its scales.

    Parameters
    ----------
    coarse, middle, fine : Sample
        The same state on meshes of elements sqrt(2) times apart.
    """
    seen = {}
    for name, value in fine.values.items():
        late = abs(value - middle.values[name])
        early = abs(middle.values[name] - coarse.values[name])
        scale = fine.scales[name]
        seen[name] = SAFETY * max(late, FORMER * early) / scale if scale > 0.0 else 0.0
    shared = SHARED * max(seen[name] for name in FORCES)
    for name, scale in fine.scales.items():
        if scale > 0.0:
            floor = max(shared, fine.residual) if name in SHARING else fine.residual
            seen[name] = max(seen[name], floor)
    return seen


def error_bars(relative: Mapping[str, float], fine: Sample, fineness: float) -> dict[str, float]:
    """Error bars in units of the quantities, by their names; stress as "von_mises_max A".

    Parameters
    ----------
    relative : mapping of str to float
        From `relative_error_bars`.
    fine : Sample
        The sample on the finest mesh.
    fineness : float
        Length of an element over half the width of the contact.
    """
    bars = {name: share * fine.scales[name] for name, share in relative.items()}
    for body in [name.split()[1] for name in bars if name.startswith("surface")]:
        inside, outside = fine.values[f"interior {body}"], fine.values[f"surface {body}"]
        deep = bars.pop(f"interior {body}")
        shallow = max(bars.pop(f"surface {body}"), fineness * outside)
        top = max(inside, outside)
        # Either may turn out to be the larger one.
        above = max(inside + deep, outside + shallow) - top
        below = top - max(inside - deep, outside - shallow)
        bars[f"von_mises_max {body}"] = float(max(above, below))
    return bars
