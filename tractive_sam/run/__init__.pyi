"""What `run` lets out, for `__init__.py` and for type checkers."""

from . import explain as explain
from . import memory as memory
from .export import export_surface as export_surface
from .export import export_volume as export_volume
from .gap_notes import warn_of_gap as warn_of_gap
from .given import measured_gap as measured_gap
from .many import InTurn as InTurn
from .many import nearby as nearby
from .many import snake as snake
from .many import solve_many as solve_many
from .many import under as under
from .pipeline import roll as roll
from .pipeline import solve as solve
from .progress import progress_shown as progress_shown
from .resume import what_differs as what_differs
