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
from tractive_sam.lookup.creep_table import CONTACT, RATIO, CreepTable, Forces
from tractive_sam.lookup.header import (
    arguments_of,
    c_header,
    check_name,
    plain_title,
    reserved_names,
)
from tractive_sam.lookup.hermite import Hermite, cell_of
from tractive_sam.lookup.text import columns_of

__all__ = [
    "CONTACT",
    "MIRROR",
    "RATIO",
    "REVERSED",
    "Coordinates",
    "CreepTable",
    "Forces",
    "Hermite",
    "arguments_of",
    "by_coordinates",
    "c_header",
    "cell_of",
    "check_name",
    "columns_of",
    "creepages_at",
    "plain_title",
    "reserved_names",
]
