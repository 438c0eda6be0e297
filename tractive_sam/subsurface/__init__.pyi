"""What `subsurface` exports, for `__init__.py` and for type checkers."""

from .displacement_field import displacement as displacement
from .displacement_field import elastic_energy as elastic_energy
from .fatigue_cycles import Course as Course
from .fatigue_cycles import course_fatigue as course_fatigue
from .fatigue_cycles import cycle_depths as cycle_depths
from .fatigue_cycles import cycle_fatigue as cycle_fatigue
from .fatigue_cycles import fatigue as fatigue
from .loaded_bodies import PlaneStress as PlaneStress
from .loaded_bodies import check_depths as check_depths
from .loaded_bodies import depths as depths
from .loaded_bodies import semi_axes as semi_axes
from .loaded_bodies import stress_at as stress_at
from .loaded_bodies import stress_layers as stress_layers
from .loaded_bodies import stress_on_plane as stress_on_plane
from .loaded_bodies import stress_on_planes as stress_on_planes
from .loaded_bodies import stress_path as stress_path
from .loaded_bodies import stress_volume as stress_volume
from .maximum import Maximum as Maximum
from .maximum import maxima_by_body as maxima_by_body
from .maximum import stress_maximum as stress_maximum
