"""What `subsurface` exports, for `__init__.py` and for type checkers."""

from .course import Course as Course
from .course import course_fatigue as course_fatigue
from .cycle import cycle_depths as cycle_depths
from .cycle import cycle_fatigue as cycle_fatigue
from .cycle import fatigue as fatigue
from .depth import check_depths as check_depths
from .depth import depths as depths
from .depth import semi_axes as semi_axes
from .displacement_field import displacement as displacement
from .displacement_field import elastic_energy as elastic_energy
from .layers import stress_layers as stress_layers
from .maximum import Maximum as Maximum
from .maximum import maxima_by_body as maxima_by_body
from .maximum import stress_maximum as stress_maximum
from .plane import PlaneStress as PlaneStress
from .plane import stress_on_plane as stress_on_plane
from .plane import stress_on_planes as stress_on_planes
from .points import stress_at as stress_at
from .points import stress_path as stress_path
from .volume import stress_volume as stress_volume
