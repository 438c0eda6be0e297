"""The cases of a study: one scene each, all checked before the first is run."""

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np

from tractive_sam import interrupt
from tractive_sam.description import format_setting
from tractive_sam.scene import Scene
from tractive_sam.schema import Fault, SceneError
from tractive_sam.store import FORMAT_VERSION, GapError, read_gap, versions
from tractive_sam.studies.design import Study, StudyError

DIGEST = 16
"""Hexadecimal digits of the hash of a scene."""


@dataclass(frozen=True)
class Case:
    """One case of a study: its number, the values that vary, and its scene.

    Attributes
    ----------
    number : int
        Index among all cases; the last dimension varies fastest.
    changes : mapping of str to object
        Values that vary, by dotted key.
    scene : Scene
        The scene.
    digest : str
        Hash of the scene without its title.

    Examples
    --------
    >>> import tractive_sam as ts
    >>> from tractive_sam.studies import cases
    >>> study = ts.Study(scene="spheres", axis=[{"key": "friction.mu", "values": [0.2, 0.4]}])
    >>> case = cases(study)[1]
    >>> print(case)
    case 1 (friction.mu = 0.4)
    >>> case.scene.friction.mu
    (0.4, 0.4)
    """

    number: int
    changes: dict[str, Any]
    scene: Scene
    digest: str

    @property
    def name(self) -> str:
        """File name of the case without suffix: its number and the hash of its scene."""
        return f"{self.number:05d}-{self.digest}"

    def __str__(self) -> str:
        values = ", ".join(f"{k} = {format_setting(value)}" for k, value in self.changes.items())
        return f"case {self.number} ({values})"


def cases(study: Study) -> list[Case]:
    """Return all cases of a study; StudyError with the faults of all their scenes.

    Raises
    ------
    StudyError
        With the faults of all scenes that are not valid, each once.

    Examples
    --------
    >>> import tractive_sam as ts
    >>> from tractive_sam.studies import cases
    >>> angles = {"key": "friction.angle", "values": [0, 45, 90]}
    >>> loads = {"key": "load.normal", "values": [100.0, 300.0]}
    >>> len(cases(ts.Study(scene="twin-discs", axis=[angles, loads])))
    6
    """
    listed: list[Case] = []
    faults: dict[tuple[str, str], list[tuple[Fault, Case]]] = {}
    seen: dict[str, Case] = {}
    base = study.scene.with_current_files(fix=True)
    for number, changes in enumerate(_changes(study)):
        interrupt.raise_if_interrupted()
        try:
            scene = base.replace(**changes).with_current_files(fix=True)
            for key, table in {"gap": scene.gap, **scene.schedule.profiles}.items():
                if table is not None and table.file is not None:
                    read_gap(table, key)
            case = Case(number, changes, scene, _digest(scene))
        except SceneError as error:
            case, new = Case(number, changes, study.scene, ""), list(error.faults)
        except GapError as error:
            case = Case(number, changes, study.scene, "")
            new = [Fault(error.key, error.given, error.allowed)]
        else:
            twin = seen.setdefault(case.digest, case)
            allowed = f"scenes that differ; {twin} is equal"
            new = [] if twin is case else [Fault("axis", "a scene twice", allowed)]
            listed.append(case)
        for fault in new:
            # Many cases share a fault: it is reported once, with their number.
            faults.setdefault((fault.key, fault.given), []).append((fault, case))
    if faults:
        raise StudyError(_merge_faults(same) for same in faults.values())
    return listed


def _changes(study: Study) -> Iterator[dict[str, Any]]:
    """Yield the values by key of every case."""
    dimensions = study.dimensions
    for index in np.ndindex(study.shape):
        places = zip(dimensions, index, strict=True)
        yield {key: value for dimension, k in places for key, value in dimension.at(k).items()}


def _merge_faults(same: list[tuple[Fault, Case]]) -> Fault:
    """Return the first of equal faults, with the number of cases that have it."""
    fault, case = same[0]
    where = f"in {case}" if len(same) == 1 else f"in {case} and {len(same) - 1} more"
    return replace(fault, given=f"{fault.given} {where}")


def _digest(scene: Scene) -> str:
    """Return a hash of a scene, of the files it names, and of the methods' version.

    Results of versions with different methods or files are never mixed.
    """
    return hashlib.sha256(f"{scene.fingerprint()} {_generation()}".encode()).hexdigest()[:DIGEST]


@cache
def _generation() -> str:
    """Return the text "major.minor format" of the package's methods and its results format."""
    first, second, *_ = (*versions()["tractive-sam"].split("."), "")
    return f"{first}.{second} {FORMAT_VERSION}"


def title_of(key: str) -> str:
    """Return the meaning and unit of a key of the scene, for titles."""
    title = Scene.find_field(key).title or key
    within, bracket, _ = key.rpartition("].")
    return f"{within}]: {title}" if bracket else title
