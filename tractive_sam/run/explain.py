"""What a scene will have modelled, what is left out and why, and what it will take."""

from collections.abc import Iterator
from time import perf_counter

import numpy as np

from tractive_sam.contact import Model, rough_maps
from tractive_sam.description import Description, Row, Section, format_duration
from tractive_sam.operators import available
from tractive_sam.rolling import process_of, process_type
from tractive_sam.run import memory
from tractive_sam.run.accuracy.levels import with_tolerances
from tractive_sam.run.accuracy.steady import Refined, refined
from tractive_sam.run.gap_notes import warn_of_gap
from tractive_sam.run.given import measured_gap, travelling
from tractive_sam.run.model_rows import (
    MODEL_ROWS,
    describe_laws_of_packages,
    describe_mesh,
    describe_refinement,
)
from tractive_sam.scene import Scene
from tractive_sam.schema import describe_tables

# Typical work at a tolerance of 1e-8, in applications with all that goes with them: of a new
# contact on nested meshes, of a revolution or a step, which starts from the one before
# (benchmarks/transient.py), and of a jump, which is solved more than once.
COLD_APPLICATIONS = 50
WARM_APPLICATIONS = 40
JUMP_APPLICATIONS = 50
STRESS_APPLICATIONS = 75  # as long as the largest stress of one body takes
FATIGUE_APPLICATIONS = 4  # as long as a depth of [fatigue] takes, of one body
PLANES = 15  # as many times as long with a critical plane
DEPTH_APPLICATIONS = 0.5  # as long as a depth of a plane takes, of both bodies

OF_PROGRAMS = 250
"""Memory that a process takes before any scene, MiB."""


TIMED = 2**18
"""Most elements of a mesh whose transforms are timed."""


def explain(scene: Scene) -> Description:
    """Say what will be modelled, on which mesh, and estimate memory and time.

    The time is estimated from transforms measured on this machine.

    Raises
    ------
    GapError
        If the measured gap, or a profile that travels, cannot be read.
    SceneError
        If the memory does not suffice to find the mesh of an [accuracy].

    Examples
    --------
    >>> sections = ts.explain(scene)  # prints itself
    >>> sections[0].title, sections[0].rows[3]
    ('Bodies', ('combined radii', 'R_x = 168.75 mm, R_y = 168.75 mm'))
    """
    model, refinement = _model_of(scene)
    described = describe_tables(scene)
    for key, describe in MODEL_ROWS.items():
        if (table := getattr(model.scene, key)) is not None:
            described[key] += describe(table, model)
    for seen in process_of(model).following:
        described[seen.key or "observer"] += seen.describe(model)
    if refinement is not None:
        described["accuracy"] += describe_refinement(refinement)
    described |= {
        "laws": [*describe_laws_of_packages(model)],
        "mesh": [*describe_mesh(model, refinement)],
        "work": [*_work(model)],
    }
    sections = {title: [row for key in keys for row in described[key]] for title, keys in SECTIONS}
    if model.measured is not None:
        warn_of_gap(model)
    return Description(
        Section(title, [(row.label, row.text) for row in rows])
        for title, rows in sections.items()
        if rows
    )


SECTIONS = (
    ("Bodies", ("body", "elasticity", "load", "gap")),
    ("State", ("creepage", "friction", "solver")),
    ("Wear", ("wear",)),
    ("Load spectrum", ("load_history", "duty")),
    ("Stress", ("subsurface",)),
    ("Transient", ("transient",)),
    ("Process", ("process",)),
    ("Observers", ("observer",)),
    ("Heat", ("heat",)),
    ("Fatigue", ("fatigue",)),
    ("Laws of other packages", ("laws",)),
    ("Accuracy", ("accuracy",)),
    ("Mesh", ("mesh",)),
    ("Work", ("work",)),
)
"""Headings, and the tables of the scene and parts of the model that are described below each."""


def _model_of(scene: Scene) -> tuple[Model, Refined | None]:
    """Return the model on its mesh, which [accuracy] finds by refinement."""
    measured = measured_gap(scene)
    model = Model(scene, measured, profiles=travelling(scene))
    if scene.accuracy is None:
        return model, None
    memory.check_solve(model)
    chosen = with_tolerances(scene)
    found = refined(chosen.without_blocks, measured)
    return Model(chosen, measured, found.model.grid), found


def _work(model: Model) -> Iterator[Row]:
    """Yield the memory and the time that a scene takes, and what finer meshes would take."""
    yield Row("records", f"{records(model)} expected")
    needed, free = memory.of_scene(model), available()
    room = f"about {needed / 2**20:.0f} MiB, and {OF_PROGRAMS} MiB for programs"
    if needed > free:
        room += f": more than the {free / 2**20:.0f} MiB that are free here"
    yield Row("memory", room)
    if not model.method.predictable:
        unknown = "the iterations of Uzawa's method are not known beforehand"
        yield Row("time", f"not estimated: {unknown}")
        return
    count = applications(model)
    seconds = seconds_per_application(model) * count
    transforms = f"{count} elastic responses by Fourier transforms"
    yield Row("time", f"about {format_duration(seconds)}, for {transforms}")
    yield from _resolving(model, seconds)


def _resolving(model: Model, seconds: float) -> Iterator[Row]:
    """Yield what it takes to resolve maps that the mesh does not."""
    grid = model.grid
    for table, one in rough_maps(model.scene, model.measured, model.profiles, grid.half_length):
        if any(one.unresolved(grid)):
            elements = one.resolving(grid).elements
            more = np.prod(elements, dtype=float) / np.prod(grid.elements)
            time = format_duration(seconds * work(elements) / work(grid.elements))
            room = f"{memory.of_contact(model) * more / 2**20:.0f} MiB"
            finer = " x ".join(map(str, elements))
            yield Row(f"to resolve {table}", f"{finer} elements, about {room} and {time}")


def records(model: Model) -> int:
    """Return the number of records that a scene is expected to have."""
    return process_type(model.scene).expected_records(model.scene, model.grid.dx)


def applications(model: Model) -> int:
    """Transform pairs that a scene is expected to take, or what takes as long."""
    count, stress = records(model), model.scene.subsurface
    bodies = depths = 0
    if stress is not None:
        kept = len(model.scene.schedule.save)
        bodies, depths = len(stress.bodies), kept * len(stress.planes) * stress.elements
    each = JUMP_APPLICATIONS if model.scene.schedule.adaptive else WARM_APPLICATIONS
    blocks = len(model.blocks)
    contacts = blocks * (COLD_APPLICATIONS + (count - 1) * each)
    # Coarser meshes that give the error bars take together about as long as the finest.
    meshes = 1 if model.scene.accuracy is None else 2
    whole = meshes * (contacts + blocks * count * bodies * STRESS_APPLICATIONS)
    return whole + int(depths * DEPTH_APPLICATIONS) + count * _of_fatigue(model)


def _of_fatigue(model: Model) -> int:
    """What takes as long as following the material in one record."""
    asked = model.scene.fatigue
    if asked is None:
        return 0
    planes = PLANES if asked.limit and asked.criterion in ("findley", "fatemi-socie") else 1
    return len(model.blocks) * len(asked.bodies) * asked.elements * FATIGUE_APPLICATIONS * planes


def seconds_per_application(model: Model) -> float:
    """Time of a transform pair and all that goes with it, measured here and now.

    Of a large mesh it is that of a part, in proportion to the work of the transforms.
    """
    fields, operators = memory.fields_together(model), model.operators
    shape = _timed(model.grid.elements)
    operators = operators.on(operators.lattice.of(shape))
    operator = {1: operators.normal, 2: operators.slip}.get(fields) or operators.coupled
    values = np.ones(operator.shape)
    operator(values)
    times = []
    for _ in range(3):
        began = perf_counter()
        operator(values)
        times.append(perf_counter() - began)
    # Vectors, projections and factors around a transform take about as long as itself.
    return 2.0 * float(np.median(times)) * work(model.grid.elements) / work(shape)


def work(shape: tuple[int, int]) -> float:
    """Measure of the work of a transform of a mesh."""
    elements = float(np.prod(shape))
    return elements * np.log2(4.0 * elements)


def _timed(shape: tuple[int, int]) -> tuple[int, int]:
    """The part of a mesh that is timed: of the same sides, and of few elements."""
    share = np.sqrt(min(1.0, TIMED / np.prod(shape, dtype=float)))
    nx, ny = (min(n, max(3, round(share * n))) for n in shape)
    return min(nx, max(3, TIMED // ny)), min(ny, max(3, TIMED // nx))
