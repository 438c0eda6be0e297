"""Write a table as columns of text."""

import math

import numpy as np

from tractive_sam.lookup.coordinates import RATIO, creepages_at
from tractive_sam.lookup.creep_table import CreepTable

COLUMNS = ("w1", "w2", "w3", "qx", "qy", "mz", "bar_qx", "bar_qy", "bar_mz", "full")
"""Columns after the columns of the axes other than creepages."""


def columns_of(table: CreepTable) -> str:
    """Return the nodes of a table as text, one per line, the last creepage coordinate fastest.

    Lines that begin with # describe the scaling. The columns are a/b, Poisson's ratio and further
    axes, and `COLUMNS`: scaled creepages G c² / (mu P) (xi_x, xi_y, c spin), forces
    (Q_x, Q_y, M_z / c) / (mu P) and their error bars. In full slip the creepages are infinite, the
    columns give their direction, and ``full`` is 1, else 0.
    """
    names = ["a/b" if name == RATIO else name for name in table.names]
    lines = [
        "# creep forces, by tractive_sam",
        "# w = G c^2 / (mu P) (xi_x, xi_y, c spin), c = sqrt(a b); q = (Qx, Qy, Mz/c) / (mu P)",
        "# all headings and tilts"
        if table.whole
        else "# (w1, -w2, -w3) gives (qx, -qy, -mz); (-w1, w2, w3) gives (-qx, qy, mz)",
        "# full = 1: full slip, (w1, w2, w3) is the direction of infinite creepages",
    ]
    if table.contact is not None:
        lines.append(
            "# " + ", ".join(f"{key} = {value:.9g}" for key, value in table.contact.items())
        )
    lines.append("# " + " ".join((*names, *COLUMNS)))
    axes, values = table.law.axes, table.law.coefficients[..., 0, :]
    for place in np.ndindex(values.shape[:-1]):
        point = [float(x[k]) for x, k in zip(axes, place, strict=True)]
        *along, heading, tilt, u = point
        ratio = table.ellipticity[0] if table.contact is not None else math.exp(along[0])
        if table.contact is None:
            along[0] = ratio
        w = creepages_at(ratio, heading, tilt, u) if u else np.zeros(3)
        numbers = (*along, *w, *values[place], *table.bars[place])
        lines.append(" ".join(f"{number:.9g}" for number in numbers) + f" {int(u == 1.0)}")
    return "\n".join(lines) + "\n"
