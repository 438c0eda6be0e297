"""The public names of studies, for `__init__.py` and for type checkers."""

from .cluster import SchedulerLostError as SchedulerLostError
from .cluster import open_workers as open_workers
from .design import SAMPLE as SAMPLE
from .design import Axis as Axis
from .design import Bounds as Bounds
from .design import Case as Case
from .design import Dimension as Dimension
from .design import Latin as Latin
from .design import Study as Study
from .design import StudyError as StudyError
from .design import Values as Values
from .design import cases as cases
from .design import is_study as is_study
from .figures import save_figures as save_figures
from .figures import study_figures as study_figures
from .pool import Workers as Workers
from .pool import computed as computed
from .pool import prepare_workers as prepare_workers
from .results import STATUSES as STATUSES
from .results import CaseRow as CaseRow
from .results import StudyResults as StudyResults
from .results import open_study as open_study
from .run import StudyProgress as StudyProgress
from .run import estimate_times as estimate_times
from .run import explain_study as explain_study
from .run import study as study
