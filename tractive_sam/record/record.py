"""What is kept of one revolution."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:  # results are to be read without loading what computes them
    from tractive_sam.contact import Contact


@dataclass(frozen=True)
class Record:
    """State of one revolution, as numbers and arrays under the names of `record.quantities`.

    Attributes
    ----------
    revolution : int
        Revolutions rolled before and in this one.
    scalars : mapping of str to float
        By the names of `SCALARS`.
    points : mapping of str to tuple of float
        By the names of `POINTS`, mm.
    profiles : mapping of str to ndarray, shape (n_y,)
        By the names of `PROFILES`.
    fields : mapping of str to ndarray, shape (n_x, n_y)
        By the names of `FIELDS`; empty where they are not kept.
    """

    revolution: int
    scalars: Mapping[str, float]
    points: Mapping[str, tuple[float, ...]]
    profiles: Mapping[str, np.ndarray]
    fields: Mapping[str, np.ndarray]


def record(contact: "Contact", revolution: int = 0, with_fields: bool = True) -> Record:
    """Take the record of a contact.

    Parameters
    ----------
    contact : Contact
        The solved contact.
    revolution : int
        Its number.
    with_fields : bool
        Whether to keep the fields.
    """
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
            "half_width_x": contact.half_width_x,
            "half_width_y": contact.half_width_y,
            "wear_max": float(contact.wear.max()),
            "stick_fraction": contact.stick_fraction,
            "xi_x": contact.xi_x,
            "xi_y": contact.xi_y,
            "spin": contact.spin,
            "residual": contact.residual,
            "operator_applications": contact.cost.applications,
        },
        points={"p_max_at": contact.p_max_at},
        profiles={"wear_profile": contact.wear[0]},
        fields=_fields(contact) if with_fields else {},
    )


def _fields(contact: "Contact") -> dict[str, np.ndarray]:
    return {
        "pressure": contact.pressure,
        "traction_x": contact.traction[0],
        "traction_y": contact.traction[1],
        "slip_x": contact.slip[0],
        "slip_y": contact.slip[1],
        "wear": contact.wear,
    }
