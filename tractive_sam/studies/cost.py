"""Estimate the time, memory and disk space of a study from its scenes."""

from collections import defaultdict
from collections.abc import Iterable
from functools import cache

import numpy as np

from tractive_sam.compute import available_memory
from tractive_sam.contact import Model
from tractive_sam.description import Description, Section, format_duration, format_setting
from tractive_sam.results import FIELDS, STRESS, columns
from tractive_sam.run import explain, memory
from tractive_sam.scene import Scene
from tractive_sam.schema import Fault
from tractive_sam.store import read_gap
from tractive_sam.studies.case import Case, cases
from tractive_sam.studies.design import Study, StudyError


def explain_study(study: Study, workers: int) -> Description:
    """Return sections that describe the cases of a study, with expected time and disk space.

    Parameters
    ----------
    study : Study
        The study.
    workers : int
        Number of processes.

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
    >>> [label for label, text in work.rows]
    ['a case', 'all cases', 'with 2 workers', 'memory', 'results']
    """
    all_cases = cases(study)
    models = _models(case.scene for case in all_cases)
    files = study.keep == "all"
    seconds = np.array(_estimate_times(models, files))
    # The last record of a case takes 2 kB.
    volume = sum(map(_file_size, models)) if files else 2e3 * len(all_cases)
    memory_each = f"about {max(map(memory.scene_bytes, models)) / 2**20:.0f} MiB a worker"
    total = max(seconds.sum() / workers, seconds.max())
    shortest, longest = format_duration(min(seconds)), format_duration(max(seconds))
    work = [
        ("a case", " to ".join(dict.fromkeys((shortest, longest)))),
        ("all cases", f"about {format_duration(seconds.sum())} of one core"),
        (f"with {workers} workers", f"about {format_duration(total)}; set others by --workers N"),
        ("memory", f"{memory_each}, and {explain.PROGRAM_MEMORY} MiB for programs"),
        ("results", _describe_space(volume, len(all_cases) if files else 1)),
    ]
    axes = [*_describe_axes(study), ("in all", f"{len(all_cases)} cases")]
    return Description((Section("Cases", axes), Section("Work", work)))


def _describe_space(volume: float, files: int) -> str:
    """Describe an amount of disk space, bytes, and a number of files as text."""
    size = f"{volume / 1e6:.0f} MB" if volume > 1e6 else f"{volume / 1e3:.0f} kB"
    return f"at most about {size} in {'one file' if files == 1 else f'{files} files'}"


def estimate_times(scenes: Iterable[Scene], with_files: bool = True) -> list[float]:
    """Return the estimated CPU time of each scene on this machine, s.

    Parameters
    ----------
    scenes : iterable of Scene
        Scenes.
    with_files : bool
        Whether each scene writes its results file.

    Examples
    --------
    >>> import tractive_sam as ts
    >>> from tractive_sam.studies import estimate_times
    >>> len(estimate_times([ts.Scene.builtin("spheres")]))
    1
    """
    return _estimate_times(_models(scenes), with_files)


def check_memory(cases: list[Case], workers: int) -> None:
    """Raise a StudyError if so many simultaneous cases need more than the free memory.

    Raises
    ------
    StudyError
        With the number of processes for which it suffices.
    """
    each = (
        max(map(memory.scene_bytes, _models(case.scene for case in cases)), default=0.0)
        + explain.PROGRAM_MEMORY * 2**20
    )
    free, workers = available_memory(), min(workers, len(cases))
    if workers * each > free:
        mebi = 2**20
        value = f"{workers} of about {each / mebi:.0f} MiB each, and {free / mebi:.0f} are free"
        fits = int(free / each)
        allowed = f"at most {fits} on this machine" if fits else "coarser scenes, or more memory"
        raise StudyError([Fault("workers", value, allowed)])


def _describe_axes(study: Study) -> list[tuple[str, str]]:
    """Return rows with the keys that vary, their number of values, and their range."""
    rows = []
    for dimension in study.dimensions:
        for key, column in dimension.columns.items():
            values = ", ".join(map(format_setting, column[:3]))
            if len(column) > 3:
                values += f" ... {format_setting(column[-1])}"
            rows.append((key, f"{len(column)} values: {values}"))
    return rows


def _models(scenes: Iterable[Scene]) -> list[Model]:
    """Return the model of each scene; gap files are read once."""
    read = cache(read_gap)
    return [Model(scene, None if scene.gap is None else read(scene.gap)) for scene in scenes]


def _estimate_times(
    models: list[Model], with_files: bool, *, file: float = 0.1, uzawa: float = 20.0
) -> list[float]:
    """Return the estimated seconds of each case, from timing one mesh of each kind.

    Parameters
    ----------
    models : list of Model
        Models of the cases.
    with_files : bool
        Whether a results file is written for each.
    file : float
        Seconds for a results file, independent of its content (benchmarks/study.py).
    uzawa : float
        Applications of Uzawa's method over the default one's, roughly: it orders the cases.
    """
    kinds = defaultdict(list)
    for model in models:
        kinds[memory.fields_per_operator(model), type(model.elasticity)].append(model)
    pace = {kind: _pace(alike) for kind, alike in kinds.items()}
    return [
        file * with_files
        + pace[memory.fields_per_operator(model), type(model.elasticity)]
        * _work(model)
        * explain.expected_applications(model)
        * (1.0 if model.method.predictable else uzawa)
        for model in models
    ]


def _pace(alike: list[Model]) -> float:
    """Return the measured seconds of an elastic response of the median model, per unit of work."""
    typical = sorted(alike, key=_work)[len(alike) // 2]
    return explain.seconds_per_application(typical) / _work(typical)


def _work(model: Model) -> float:
    """Return the relative work of an elastic response of a model."""
    return explain.transform_work(model.grid.elements)


def _file_size(model: Model, empty: float = 2e5) -> float:
    """Return the estimated size of a model's results file, bytes."""
    scene, (nx, ny) = model.scene, model.grid.elements
    saved = len(scene.schedule.save)
    numbers = (saved + 1) * len(FIELDS) * nx * ny  # also the state from which a run resumes
    sizes = (ny if column.dims else 1 for column in columns(scene).values())
    numbers += explain.expected_records(model) * sum(sizes)
    if scene.subsurface is not None:
        below = scene.subsurface
        planes = len(below.planes) * len(below.bodies)
        numbers += saved * planes * len(STRESS) * below.elements * (nx + ny) // 2
    return empty + 8.0 * numbers
