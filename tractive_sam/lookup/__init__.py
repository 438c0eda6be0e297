"""Tables of creep forces as vehicle and bearing models use them: NumPy alone.

`hermite` interpolates, `coordinates` says how creepages become the bounded coordinates of a table,
`creep_table` puts both together, `header` and `text` write a table as C and as columns.
"""

from tractive_sam.lookup.coordinates import (
    MIRROR,
    REVERSED,
    Coordinates,
    by_coordinates,
    creepages_at,
)
from tractive_sam.lookup.creep_table import CreepTable, Forces
from tractive_sam.lookup.header import c_header
from tractive_sam.lookup.hermite import Hermite
from tractive_sam.lookup.text import columns_of

__all__ = [
    "MIRROR",
    "REVERSED",
    "Coordinates",
    "CreepTable",
    "Forces",
    "Hermite",
    "by_coordinates",
    "c_header",
    "columns_of",
    "creepages_at",
]
