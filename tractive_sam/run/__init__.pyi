"""What `run` lets out, for `__init__.py` and for type checkers."""

from . import explain as explain
from . import memory as memory
from .export import export_surface as export_surface
from .export import export_volume as export_volume
from .inputs import read_measured_gap as read_measured_gap
from .inputs import warn_of_gap as warn_of_gap
from .many import SequentialRuns as SequentialRuns
from .many import neighbouring_places as neighbouring_places
from .many import solve_from_nearby as solve_from_nearby
from .many import solve_many as solve_many
from .many import with_creepages as with_creepages
from .pipeline import require_wear as require_wear
from .pipeline import roll as roll
from .pipeline import solve as solve
from .pipeline import wear_profiles as wear_profiles
from .progress import format_remaining_time as format_remaining_time
from .progress import open_bar as open_bar
from .progress import show_roll_progress as show_roll_progress
from .resume import describe_differences as describe_differences
from .resume import use_stored_files as use_stored_files
