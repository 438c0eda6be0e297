"""The public names and the rooms that they come from, for `__init__.py` and for type checkers."""

from . import plot as plot
from . import reference as reference
from . import studies as studies
from . import subsurface as subsurface
from .results.history import History as History
from .results.maximum import VonMisesMaximum as VonMisesMaximum
from .results.plane_stress import PlaneStress as PlaneStress
from .results.state import Contact as Contact
from .results.state import NotConverged as NotConverged
from .run.export import export_volume as export_volume
from .run.pipeline import roll as roll
from .run.pipeline import solve as solve
from .scene import Accuracy as Accuracy
from .scene import Bodies as Bodies
from .scene import Body as Body
from .scene import Creepage as Creepage
from .scene import Friction as Friction
from .scene import Gap as Gap
from .scene import Load as Load
from .scene import Mesh as Mesh
from .scene import Scene as Scene
from .scene import SceneError as SceneError
from .scene import SceneWarning as SceneWarning
from .scene import Solver as Solver
from .scene import Subsurface as Subsurface
from .scene import Wear as Wear
from .scene import builtin_names as builtin_names
from .store import GapError as GapError
from .store import ResultsError as ResultsError
from .store import open_history as open_history
from .studies import Study as Study
from .studies import StudyError as StudyError
from .studies import StudyResults as StudyResults
from .studies import explain_study as explain_study
from .studies import open_study as open_study
from .studies import study as study
from .subsurface import stress_at as stress_at
from .subsurface import stress_on_plane as stress_on_plane
from .subsurface import stress_on_planes as stress_on_planes
from .subsurface import stress_volume as stress_volume
from .subsurface import von_mises_maximum as von_mises_maximum

__version__: str
