"""What is kept of one revolution."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np

from tractive_sam.results.maximum import VonMisesMaximum
from tractive_sam.results.plane_stress import PlaneStress
from tractive_sam.results.quantities import BODY_ERROR_BARS, ERROR_BARS
from tractive_sam.results.state import Contact

Point = tuple[float, ...]


@dataclass(frozen=True)
class Record:
    """State of one revolution, as numbers and arrays under the names of `results.quantities`.

    Attributes
    ----------
    revolution : int
        Revolutions rolled before and in this one.
    scalars : mapping of str to float
        By the names of `SCALARS` and, of scenes with [accuracy], `ERROR_BARS`; nan where the
        error is not known.
    points : mapping of str to tuple of float
        By the names of `POINTS`, mm.
    profiles : mapping of str to ndarray, shape (n_y,)
        By the names of `PROFILES`.
    fields : mapping of str to ndarray, shape (n_x, n_y)
        By the names of `FIELDS`; empty where they are not kept.
    bodies : mapping of str to mapping
        For "A" and "B", numbers and positions by the names of `BODY_SCALARS`, `BODY_ERROR_BARS` and
        `BODY_POINTS`; empty where no stress is computed.
    stress : tuple of PlaneStress
        Stress on the planes that the scene asks for, kept with the fields.
    """

    revolution: int
    scalars: Mapping[str, float]
    points: Mapping[str, tuple[float, ...]]
    profiles: Mapping[str, np.ndarray]
    fields: Mapping[str, np.ndarray]
    bodies: Mapping[str, Mapping[str, float | Point]] = field(default_factory=dict)
    stress: tuple["PlaneStress", ...] = ()


def record(
    contact: "Contact",
    revolution: int = 0,
    with_fields: bool = True,
    maxima: Mapping[str, "VonMisesMaximum"] | None = None,
    stress: Iterable["PlaneStress"] = (),
    profile: np.ndarray | None = None,
    rate: np.ndarray | None = None,
    jump: int = 1,
    solves: int = 1,
    seconds: float = math.nan,
) -> Record:
    """Take the record of a contact.

    Parameters
    ----------
    contact : Contact
        The solved contact.
    revolution : int
        Its number.
    with_fields : bool
        Whether to keep the fields.
    maxima : mapping of str to VonMisesMaximum, optional
        Largest equivalent stress of the bodies "A" and "B".
    stress : iterable of PlaneStress, optional
        Stress on planes.
    profile, rate : ndarray, shape (n_y,), optional
        Depth with which material enters and by which that deepens in this revolution, mm, as the
        adaptive stepping has corrected them; by default those of the contact.
    jump : int
        Revolutions that the next step is to take.
    solves : int
        Contacts solved on the way.
    seconds : float
        Time that took.
    """
    entering = contact.wear[-1] if profile is None else profile
    shift = entering - contact.wear[-1]
    leaving, turns = contact.wear[0] + shift, contact.scene.turns
    lasting = turns.gain * (contact.wear[0] - contact.wear[-1])
    bars = {} if contact.scene.accuracy is None else _bars(contact, ERROR_BARS)
    return Record(
        revolution,
        scalars={
            "revolution": revolution,
            "P": contact.P,
            "Qx": contact.Qx,
            "Qy": contact.Qy,
            "Mz": contact.Mz,
            "Qx_over_P": contact.Qx / contact.P if contact.P else 0.0,
            "Qy_over_P": contact.Qy / contact.P if contact.P else 0.0,
            "approach": contact.approach,
            "p_max": contact.p_max,
            "p_95": contact.p_95,
            "half_width_x": contact.half_width_x,
            "half_width_y": contact.half_width_y,
            "wear_max": float((contact.wear + shift).max()),
            "stick_fraction": contact.stick_fraction,
            "xi_x": contact.xi_x,
            "xi_y": contact.xi_y,
            "spin": contact.spin,
            "residual": contact.residual,
            "dissipation": contact.dissipation,
            "work_supplied": contact.work_supplied,
            "wear_rate": contact.wear_rate,
            "operator_applications": contact.cost.applications,
            "jump": jump,
            "converged": float(contact.converged),
            "solves": solves,
            "seconds": seconds,
            **bars,
        },
        points={"p_max_at": contact.p_max_at},
        profiles={
            "wear_profile": leaving,
            "entering_profile": entering,
            "wear_per_revolution": lasting if rate is None else rate,
            "wear_profile_A": turns.of_body("A", entering, leaving),
            "wear_profile_B": turns.of_body("B", entering, leaving),
        },
        fields=_fields(contact) if with_fields else {},
        bodies={name: _of_body(contact, name, largest) for name, largest in (maxima or {}).items()},
        stress=tuple(stress),
    )


def state(contact: "Contact") -> dict[str, np.ndarray]:
    """All fields from which rolling goes on, by the names of `STATE`, shape (n_x, n_y)."""
    return _fields(contact) | {"gap": contact.gap, "sliding": contact.sliding.astype(float)}


def _bars(contact: "Contact", names: Iterable[str], body: str = "") -> dict[str, float]:
    """Error bars by their recorded names; nan where there is none."""
    known = contact.error_bars
    return {name: known.get(name.removesuffix("_error") + body, math.nan) for name in names}


def _of_body(contact: "Contact", body: str, largest: "VonMisesMaximum") -> dict[str, float | Point]:
    bars = {}
    if contact.scene.accuracy is not None:
        bars = _bars(contact, BODY_ERROR_BARS, f" {body}")
    return {
        "von_mises_max": largest.value,
        "von_mises_interior": largest.interior,
        "von_mises_surface": largest.surface,
        "von_mises_max_at": largest.at,
        **bars,
    }


def _fields(contact: "Contact") -> dict[str, np.ndarray]:
    return {
        "pressure": contact.pressure,
        "traction_x": contact.traction[0],
        "traction_y": contact.traction[1],
        "slip_x": contact.slip[0],
        "slip_y": contact.slip[1],
        "wear": contact.wear,
    }
