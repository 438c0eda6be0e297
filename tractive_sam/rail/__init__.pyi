"""What `rail` exports, for `__init__.py` and for type checkers."""

from .builtin import BUILTIN as BUILTIN
from .builtin import builtin_profile as builtin_profile
from .contact import Clearance as Clearance
from .contact import NoContactError as NoContactError
from .contact import find_contact_points as find_contact_points
from .contact import find_patches as find_patches
from .contact import free_roll as free_roll
from .contact import lowest_gap as lowest_gap
from .files import SECTIONS as SECTIONS
from .files import SUFFIXES as SUFFIXES
from .files import ProfileError as ProfileError
from .files import read_profile as read_profile
from .files import write_profile as write_profile
from .locus import ConicityCheck as ConicityCheck
from .locus import ContactLocus as ContactLocus
from .locus import find_locus as find_locus
from .measured import UNITS as UNITS
from .measured import check_datum as check_datum
from .measured import from_measurement as from_measurement
from .patch import Patch as Patch
from .profile import Profile as Profile
from .profile import Rail as Rail
from .sections import RailSections as RailSections
from .sections import read_sections as read_sections
from .wheelset import Wheel as Wheel
from .wheelset import place_rail as place_rail
