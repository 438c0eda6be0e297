"""What `rolling` lets out, for `__init__.py` and for type checkers."""

from .body_damage import stressed_volume as stressed_volume
from .observers import Damage as Damage
from .observers import ElasticFields as ElasticFields
from .observers import LargestStress as LargestStress
from .passage import Passage as Passage
from .passage import ProfilePoint as ProfilePoint
from .passage import start_passage as start_passage
from .process import Observer as Observer
from .process import Process as Process
from .process import Recorder as Recorder
from .process import Step as Step
from .process import StepRecord as StepRecord
from .process import StoredStep as StoredStep
from .process import continuing_rows as continuing_rows
from .registry import process_of as process_of
from .registry import process_type as process_type
from .registry import steps as steps
from .revolutions import Forecast as Forecast
from .transient import Moment as Moment
from .transient import TransientProcess as TransientProcess
from .wheel_rail import ProfileWear as ProfileWear
