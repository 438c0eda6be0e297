"""What `subsurface` exports, for `__init__.py` and for type checkers."""

from .fatigue_cycles import Course as Course
from .fatigue_cycles import LocalSteel as LocalSteel
from .fatigue_cycles import course_fatigue as course_fatigue
from .fatigue_cycles import cycle_depths as cycle_depths
from .fatigue_cycles import cycle_fatigue as cycle_fatigue
from .fatigue_cycles import fatigue as fatigue
from .inclusions import InclusionGroup as InclusionGroup
from .inclusions import InclusionStress as InclusionStress
from .inclusions import around_inclusions as around_inclusions
from .inclusions import inclusion_lift as inclusion_lift
from .layered import with_interfaces as with_interfaces
from .stress_fields import Maximum as Maximum
from .stress_fields import PlaneStress as PlaneStress
from .stress_fields import check_depths as check_depths
from .stress_fields import depths as depths
from .stress_fields import displacement as displacement
from .stress_fields import elastic_energy as elastic_energy
from .stress_fields import maxima_by_body as maxima_by_body
from .stress_fields import semi_axes as semi_axes
from .stress_fields import stress_at as stress_at
from .stress_fields import stress_layers as stress_layers
from .stress_fields import stress_maximum as stress_maximum
from .stress_fields import stress_on_plane as stress_on_plane
from .stress_fields import stress_on_planes as stress_on_planes
from .stress_fields import stress_path as stress_path
from .stress_fields import stress_volume as stress_volume
