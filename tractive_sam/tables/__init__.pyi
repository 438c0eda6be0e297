"""The public names of tables, for `__init__.py` and for type checkers."""

from .axis import TableAxis as TableAxis
from .building import build_table as build_table
from .describe import explain_design as explain_design
from .describe import explain_table as explain_table
from .describe import is_design as is_design
from .describe import table_as_dict as table_as_dict
from .design import TableDesign as TableDesign
from .design import TableError as TableError
from .fmu import write_fmu as write_fmu
from .opening import builtin_tables as builtin_tables
from .opening import is_table as is_table
from .opening import open_table as open_table
from .refinement import TableProgress as TableProgress
