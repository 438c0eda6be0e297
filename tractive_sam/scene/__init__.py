"""The scene: what is asked, checked as a whole before anything is computed.

Tables and keys are those of a scene file; units mm, N, MPa, degrees, revolutions.
"""

from . import toml
from .bodies import Bodies, Body
from .catalogue import builtin_names
from .describe import Row, describe_load, describe_tables
from .document import Document
from .duty import Block, BlockCreepage, BlockFriction, BlockLoad, Spectrum, label
from .fatigue import Fatigue, FatigueVolume
from .faults import (
    MOST_TOLD,
    Fault,
    PlausibilityWarning,
    SceneError,
    SceneWarning,
    shown,
    suggestion,
    warn,
)
from .friction import Friction
from .gap import ALONG, LENGTHS, TEXTS, Gap, files_anywhere
from .heat import Bulk, Heat, Thermal
from .keys import groups
from .load_history import Binned, LoadHistory, blocks_of
from .named_law import LawTable, NamedLaw, build_law, load_law_class
from .override import parse_settings
from .plane import Plane
from .plausibility import near_edge, pressure_notes
from .process import ProcessTable
from .quantities import LARGEST, Real, entry, number
from .resolution import FewestElements
from .scene import Scene
from .schedule import Schedule
from .starter import starter
from .table import Check, Known, Table
from .tables import (
    MOST_ELEMENTS,
    Accuracy,
    Creepage,
    ElasticBodies,
    Load,
    Mesh,
    Solver,
    Subsurface,
)
from .transient import CreepageCourse, FrictionCourse, LoadCourse, Profiles, Transient
from .varied import FILES, files_of_varied
from .wear import Wear
from .wear_laws import BY_COEFFICIENT, PER_INTENSITY, Coefficients, Sets, WearLaws

__all__ = [
    "ALONG",
    "BY_COEFFICIENT",
    "FILES",
    "LARGEST",
    "LENGTHS",
    "MOST_ELEMENTS",
    "MOST_TOLD",
    "PER_INTENSITY",
    "TEXTS",
    "Accuracy",
    "Binned",
    "Block",
    "BlockCreepage",
    "BlockFriction",
    "BlockLoad",
    "Bodies",
    "Body",
    "Bulk",
    "Check",
    "Coefficients",
    "Creepage",
    "CreepageCourse",
    "Document",
    "ElasticBodies",
    "Fatigue",
    "FatigueVolume",
    "Fault",
    "FewestElements",
    "Friction",
    "FrictionCourse",
    "Gap",
    "Heat",
    "Known",
    "LawTable",
    "Load",
    "LoadCourse",
    "LoadHistory",
    "Mesh",
    "NamedLaw",
    "Plane",
    "PlausibilityWarning",
    "ProcessTable",
    "Profiles",
    "Real",
    "Row",
    "Scene",
    "SceneError",
    "SceneWarning",
    "Schedule",
    "Sets",
    "Solver",
    "Spectrum",
    "Subsurface",
    "Table",
    "Thermal",
    "Transient",
    "Wear",
    "WearLaws",
    "blocks_of",
    "build_law",
    "builtin_names",
    "describe_load",
    "describe_tables",
    "entry",
    "files_anywhere",
    "files_of_varied",
    "groups",
    "label",
    "load_law_class",
    "near_edge",
    "number",
    "parse_settings",
    "pressure_notes",
    "shown",
    "starter",
    "suggestion",
    "toml",
    "warn",
]
