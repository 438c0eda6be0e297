"""What a study will take, from its scenes."""

from collections import defaultdict
from functools import cache

import numpy as np

from tractive_sam.contact import Model
from tractive_sam.description import Section, format_duration, format_setting
from tractive_sam.operators import available
from tractive_sam.results import FIELDS, STRESS, columns
from tractive_sam.run import explain, memory
from tractive_sam.schema import Fault
from tractive_sam.store import read_gap
from tractive_sam.studies.case import Case, cases
from tractive_sam.studies.design import Study, StudyError

EMPTY_FILE = 2e5
"""Size of a results file without anything in it, bytes."""

OF_A_LINE = 2e3
"""Size of the last record of a case, bytes."""

OF_A_FILE = 0.1
"""Time that a results file takes, whatever is in it, s (benchmarks/study.py)."""

UZAWA = 20.0
"""Applications of Uzawa's method over those of the default one, roughly: it orders the cases."""


def explain_study(study: Study, workers: int) -> list[Section]:
    """Say what a study is made of, and estimate the time and the room that it takes.

    Parameters
    ----------
    study : Study
        What is asked.
    workers : int
        Processes at work.

    Raises
    ------
    StudyError
        With the faults of all scenes that are not valid.

    Examples
    --------
    >>> import tractive_sam as ts
    >>> angles = {"key": "friction.angle", "start": 0, "stop": 90, "number": 7}
    >>> study = ts.Study(scene="twin-discs", axis=[angles])
    >>> axes, work = ts.explain_study(study, workers=2)
    >>> axes.rows
    [('friction.angle', '7 values: 0, 15, 30 ... 90'), ('in all', '7 cases')]
    >>> [what for what, told in work.rows]
    ['a case', 'all cases', 'with 2 workers', 'memory', 'results']
    """
    found = cases(study)
    models = _models(found)
    files = study.keep == "all"
    seconds = np.array(_times(models, files))
    volume = sum(map(_bytes, models)) if files else OF_A_LINE * len(found)
    room = f"about {max(map(memory.of_scene, models)) / 2**20:.0f} MiB"
    whole = max(seconds.sum() / workers, seconds.max())
    duration = format_duration
    return [
        Section("Cases", [*_axes(study), ("in all", f"{len(found)} cases")]),
        Section(
            "Work",
            [
                ("a case", " to ".join(dict.fromkeys(map(duration, (min(seconds), max(seconds)))))),
                ("all cases", f"about {duration(seconds.sum())} of one core"),
                (f"with {workers} workers", f"about {duration(whole)}; --workers N for others"),
                ("memory", f"{room} a worker, and {explain.OF_PROGRAMS} MiB for programs"),
                ("results", _room(volume, len(found) if files else 1)),
            ],
        ),
    ]


def _room(volume: float, files: int) -> str:
    """Room on the disk, bytes."""
    size = f"{volume / 1e6:.0f} MB" if volume > 1e6 else f"{volume / 1e3:.0f} kB"
    return f"at most about {size} in {'one file' if files == 1 else f'{files} files'}"


def estimates(found: list[Case], with_files: bool = True) -> list[float]:
    """Time that each case is expected to take on a core like this one, s."""
    return _times(_models(found), with_files)


def check_memory(found: list[Case], workers: int) -> None:
    """See that so many processes at once fit into the memory of this machine.

    Raises
    ------
    StudyError
        With the number that does.
    """
    each = max(map(memory.of_scene, _models(found)), default=0.0) + explain.OF_PROGRAMS * 2**20
    free, workers = available(), min(workers, len(found))
    if workers * each > free:
        mebi = 2**20
        told = f"{workers} of about {each / mebi:.0f} MiB each, and {free / mebi:.0f} are free"
        fits = int(free / each)
        allowed = f"here at most {fits}" if fits else "coarser scenes, or more memory"
        raise StudyError([Fault("workers", told, allowed)])


def _axes(study: Study) -> list[tuple[str, str]]:
    rows = []
    for one in study.dimensions:
        for key, column in one.columns.items():
            told = ", ".join(map(format_setting, column[:3]))
            if len(column) > 3:
                told += f" ... {format_setting(column[-1])}"
            rows.append((key, f"{len(column)} values: {told}"))
    return rows


def _models(found: list[Case]) -> list[Model]:
    read = cache(read_gap)  # many cases share a measured gap
    models = []
    for case in found:
        gap = case.scene.gap
        models.append(Model(case.scene, None if gap is None else read(gap)))
    return models


def _times(models: list[Model], with_files: bool) -> list[float]:
    """Seconds of each; one mesh of a kind is timed, for others it follows from their size."""
    kinds = defaultdict(list)
    for model in models:
        kinds[memory.fields_together(model), type(model.elasticity)].append(model)
    pace = {kind: _pace(alike) for kind, alike in kinds.items()}
    return [
        OF_A_FILE * with_files
        + pace[memory.fields_together(model), type(model.elasticity)]
        * _size(model)
        * explain.applications(model)
        * (1.0 if model.method.predictable else UZAWA)
        for model in models
    ]


def _pace(alike: list[Model]) -> float:
    typical = sorted(alike, key=_size)[len(alike) // 2]
    return explain.seconds_per_application(typical) / _size(typical)


def _size(model: Model) -> float:
    return explain.work(model.grid.elements)


def _bytes(model: Model) -> float:
    """Size of a results file, if nothing in it could be compressed."""
    scene, (nx, ny) = model.scene, model.grid.elements
    kept = len(scene.schedule.save)
    numbers = (kept + 1) * len(FIELDS) * nx * ny  # and the state from which a run goes on
    numbers += explain.records(model) * sum(
        ny if one.dims else 1 for one in columns(scene).values()
    )
    if scene.subsurface is not None:
        below = scene.subsurface
        planes = len(below.planes) * len(below.bodies)
        numbers += kept * planes * len(STRESS) * below.elements * (nx + ny) // 2
    return EMPTY_FILE + 8.0 * numbers
