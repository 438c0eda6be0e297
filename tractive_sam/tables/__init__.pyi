"""The public names of tables, for `__init__.py` and for type checkers."""

from .building import build_table as build_table
from .building import explain_design as explain_design
from .building import explain_table as explain_table
from .building import table_as_dict as table_as_dict
from .design import TableAxis as TableAxis
from .design import TableDesign as TableDesign
from .design import TableError as TableError
from .design import is_design as is_design
from .fmu import write_fmu as write_fmu
from .solving import TableProgress as TableProgress
from .table_file import builtin_tables as builtin_tables
from .table_file import is_table as is_table
from .table_file import open_table as open_table
