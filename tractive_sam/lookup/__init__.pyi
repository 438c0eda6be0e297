"""Names that `lookup` exports, for `__init__.py` and for type checkers."""

from .c_code import arguments_of as arguments_of
from .c_code import c_sources as c_sources
from .c_code import check_axis_name as check_axis_name
from .c_code import check_name as check_name
from .c_code import fill_template as fill_template
from .c_code import plain_title as plain_title
from .creep_table import CreepTable as CreepTable
from .creep_table import Forces as Forces
from .creep_table import columns_of as columns_of
from .creep_table import describe_axis as describe_axis
from .creep_table import describe_range as describe_range
from .creep_table import share_of_bar as share_of_bar
from .hermite import CONTACT as CONTACT
from .hermite import MIRROR as MIRROR
from .hermite import NAMES as NAMES
from .hermite import RATIO as RATIO
from .hermite import REVERSED as REVERSED
from .hermite import Coordinates as Coordinates
from .hermite import Hermite as Hermite
from .hermite import cell_of as cell_of
from .hermite import creepages_at as creepages_at
from .hermite import creepages_by_coordinates as creepages_by_coordinates
