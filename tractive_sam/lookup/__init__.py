"""Evaluation of creep-force tables, with NumPy alone.

`hermite` interpolates, `coordinates` converts creepages to the bounded coordinates of a table,
`creep_table` combines both, and `c_sources` and `text` write a table as C code and as columns.
"""

from tractive_sam.lookup.c_sources import (
    arguments_of,
    c_sources,
    check_axis_name,
    check_name,
    plain_title,
)
from tractive_sam.lookup.coordinates import (
    CONTACT,
    MIRROR,
    NAMES,
    RATIO,
    REVERSED,
    Coordinates,
    creepages_at,
    creepages_by_coordinates,
)
from tractive_sam.lookup.creep_table import CreepTable, Forces, share_of_bar
from tractive_sam.lookup.describe import describe_axis, describe_range
from tractive_sam.lookup.hermite import Hermite, cell_of
from tractive_sam.lookup.text import columns_of

__all__ = [
    "CONTACT",
    "MIRROR",
    "NAMES",
    "RATIO",
    "REVERSED",
    "Coordinates",
    "CreepTable",
    "Forces",
    "Hermite",
    "arguments_of",
    "c_sources",
    "cell_of",
    "check_axis_name",
    "check_name",
    "columns_of",
    "creepages_at",
    "creepages_by_coordinates",
    "describe_axis",
    "describe_range",
    "plain_title",
    "share_of_bar",
]
