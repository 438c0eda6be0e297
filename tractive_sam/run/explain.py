"""Describe what a scene models, what is left out and why, and estimate memory and time.

`Table.describe` describes a table alone; `MODEL_ROWS` adds rows that need the model: its
mesh, method and laws.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from time import process_time
from typing import Any

import numpy as np

from tractive_sam.contact import Model, choose_grid, rough_maps
from tractive_sam.description import Description, Row, Section, format_duration
from tractive_sam.operators import STEPS_FROM
from tractive_sam.results import columns
from tractive_sam.rolling import process_of, process_type
from tractive_sam.run import memory
from tractive_sam.run.error_bars import set_tolerances
from tractive_sam.run.inputs import read_measured_gap, read_profiles, warn_of_gap
from tractive_sam.run.refined_runs import RefinedContact, refine_unworn
from tractive_sam.scene import Heat, Scene, Solver
from tractive_sam.schema import describe_tables, required
from tractive_sam.subsurface import InclusionGroup


def _describe_creepage(_table: Any, model: Model) -> Iterator[Row]:
    """Yield rows on the coupling of pressure and tractions, and on the tangential problem."""
    bodies = model.elasticity.coupling
    coupling = "none: tractions do not change the pressure, which is solved first"
    if model.elasticity.coupled and model.transmits:
        coupling = (
            f"of {bodies}: pressure makes the surfaces slip and tractions lift them, so both is "
            "solved at once"
        )
    elif model.elasticity.coupled:
        coupling = (
            f"of {bodies}, but without friction there are no tractions to lift the surfaces: "
            "only the pressure is solved"
        )
    tangential = "stick and slip"
    if model.laws.friction is None:
        tangential = "left out: without friction there is no traction"
    elif not model.transmits:
        tangential = "left out: equal materials without creepage roll freely, without traction"
    yield Row("coupling", coupling)
    yield Row("tangential problem", tangential)


def _describe_solver(table: Solver, model: Model) -> Iterator[Row]:
    """Yield rows on the solution method and the discretisation of slip."""
    yield Row("method", f"{model.method.description}, to a residual of {table.tolerance:g}")
    if model.transmits:
        scheme = "towards the leading edge (upwind, the paper's): its error falls with their size"
        if model.stencil.staggered:
            scheme = "between elements (staggered): its error falls with the square of their size"
        yield Row("slip", f"from differences {scheme}")
    conforming = " or conforming" if model.shape.is_flat else ""
    yield Row("left out", f"inertia, lubricant, plasticity; thin{conforming} bodies")


def _describe_heat(_table: Heat, model: Model) -> Iterator[Row]:
    """Yield a row with the Peclet number of each body."""
    scene, dx = model.scene, model.grid.dx
    half = model.grid.half_length[0] if scene.hertz is None else scene.hertz.a
    for name, thermal in scene.thermal.items():
        per_length = required(scene.creepage.speed, "creepage.speed") / (2.0 * thermal.diffusivity)
        fronts = "steps" if per_length * dx > STEPS_FROM else "resolved"
        numbers = f"{per_length * half:.3g} of the contact, {per_length * dx:.3g} of an element"
        yield Row(f"Peclet number {name}", f"{numbers}: heat fronts {fronts}")


MODEL_ROWS: dict[str, Callable[[Any, Model], Iterable[Row]]] = {
    "creepage": _describe_creepage,
    "solver": _describe_solver,
    "transient": lambda _table, model: [
        Row("order", f"{'second' if model.stencil.staggered else 'first'} in the mesh")
    ],
    "process": lambda _table, model: process_of(model).describe(),
    "heat": _describe_heat,
}
"""Rows that the model adds to the rows of a given table."""


def describe_refinement(refinement: RefinedContact) -> Iterator[Row]:
    """Yield rows on the error bars of the unworn bodies, for [accuracy]."""
    contact = refinement.contact
    if refinement.missed:
        yield Row("not reached", refinement.missed)
    for name in ("Qx", "Qy", "Mz", "p_max"):
        if name in contact.error_bars:
            bar, unit = contact.error_bars[name], columns(contact.scene)[name].unit
            value = f"{getattr(contact, name):.6g} +- {bar:.1g} {unit}"
            yield Row(f"{name} of the unworn bodies", value)


def describe_mesh(model: Model, refinement: RefinedContact | None) -> Iterator[Row]:
    """Yield rows on the elements, domain and element size of the mesh, and their origin."""
    grid, hertz = model.grid, model.scene.hertz
    sides, half = grid.sides, grid.half_length[: grid.directions]
    origin = "found by refinement" if refinement else _describe_origin(model)
    yield Row("mesh", f"{grid.describe_size()}, {origin}")
    domain = f"{' x '.join(f'+-{length:.4g}' for length in half)} mm"
    if any(grid.centre):
        domain += f" around ({', '.join(f'{x:.4g}' for x in grid.centre[: grid.directions])}) mm"
    yield Row("domain", domain)
    yield Row("element", f"{' x '.join(f'{side:.4g}' for side in sides)} mm")
    if hertz is not None and model.patch is None:
        axes = zip(sides, (hertz.a, hertz.b), strict=False)
        across = " x ".join(f"{2 * axis / side:.0f}" for side, axis in axes)
        yield Row("across the unworn contact", f"{across} elements")


def _describe_origin(model: Model) -> str:
    """Describe why the mesh was chosen, and whether it is refined for a gap map."""
    scene, grid = model.scene, model.grid
    origin = "chosen from the contact" if scene.grid is None else scene.grid.origin
    if model.measured is None and not model.profiles:
        return origin
    usual = choose_grid(scene, model.measured, model.profiles, finer=1.0)
    if (usual.dx, usual.dy) == (grid.dx, grid.dy):
        return origin
    waves = "the waves of the measured gap or profile"
    return f"{origin}, refined from {usual.describe_size()} to {waves}"


@dataclass(frozen=True)
class TypicalWork:
    """Typical work of stress, fatigue and other parts of a run, in units of elastic responses.

    Measured on the built-in scenes, and on `spheres` from 31 x 31 to 361 x 361 elements.

    Attributes
    ----------
    stress : float
        The largest stress of one body in one record.
    plane : float
        A depth of a plane of both bodies.
    fatigue : float
        A depth of [fatigue] of one body.
    planes : float
        Factor on it for a critical plane.
    transforms : float
        Time of an elastic response with the vectors, projections and factors around it, over that
        of its transforms.
    overhead : float
        Time of a response that does not depend on the mesh, s.
    cell : float
        Time for a cell in the transforms of a box around inclusions, s.
    """

    stress: float = 1.5
    plane: float = 0.15
    fatigue: float = 1.6
    planes: float = 15.0
    transforms: float = 3.0
    overhead: float = 4e-4
    cell: float = 1.5e-5


PROGRAM_MEMORY = 220
"""Memory that a process takes before any scene, MiB."""


def explain(scene: Scene) -> Description:
    """Return a description of what a scene models, on which mesh, with memory and time.

    The time is estimated from transforms measured on this machine.

    Parameters
    ----------
    scene : Scene
        The scene.

    Raises
    ------
    GapError
        If the measured gap, or a moving profile, cannot be read.
    SceneError
        If the memory does not suffice to find the mesh for an [accuracy].

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
    for observer in process_of(model).following:
        described[observer.key or "observer"] += observer.describe(model)
    if refinement is not None:
        described["accuracy"] += describe_refinement(refinement)
    described |= {
        "laws": [
            Row(name, law.text) for name, law in model.laws.differences_from(model.scene).items()
        ],
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
    (
        "Bodies",
        ("body", "elasticity", "load", "gap", "conformal", "wheel", "rail", "wheelset"),
    ),
    ("State", ("creepage", "friction", "solver")),
    ("Wear", ("wear",)),
    ("Load spectrum", ("load_history", "duty")),
    ("Stress", ("subsurface", "inclusion")),
    ("Transient", ("transient",)),
    ("Process", ("process",)),
    ("Observers", ("observer",)),
    ("Heat", ("heat",)),
    ("Fatigue", ("residual", "fatigue")),
    ("Laws of other packages", ("laws",)),
    ("Accuracy", ("accuracy",)),
    ("Mesh", ("mesh",)),
    ("Work", ("work",)),
)
"""Titles of sections; the tables of the scene and parts of the model that each describes."""


def _model_of(scene: Scene) -> tuple[Model, RefinedContact | None]:
    """Return the model of a scene, and with [accuracy] the refinement that chose its mesh."""
    measured = read_measured_gap(scene)
    model = Model(scene, measured, profiles=read_profiles(scene))
    if scene.accuracy is None:
        return model, None
    memory.check_solve(model)
    scene = set_tolerances(scene)
    refinement = refine_unworn(scene.without_blocks, measured)
    return Model(scene, measured, refinement.model.grid), refinement


def _work(model: Model) -> Iterator[Row]:
    """Yield rows on the memory and time that a scene takes, also on finer meshes."""
    yield Row("records", f"{expected_records(model)} expected")
    needed, free = memory.scene_bytes(model), memory.available_memory()
    room = f"about {needed / 2**20:.0f} MiB, and {PROGRAM_MEMORY} MiB for programs"
    if needed > free:
        room += f": more than the {free / 2**20:.0f} MiB that are free on this machine"
    yield Row("memory", room)
    if not model.method.predictable:
        unknown = "the number of iterations of Uzawa's method is unknown"
        yield Row("time", f"not estimated: {unknown}")
        return
    count = expected_applications(model)
    seconds = seconds_per_application(model) * count + seconds_of_inclusions(model)
    transforms = f"{count} elastic responses by Fourier transforms"
    yield Row("time", f"about {format_duration(seconds)} of one core, for {transforms}")
    yield from _describe_resolving_meshes(model, seconds)


def _describe_resolving_meshes(model: Model, seconds: float) -> Iterator[Row]:
    """Yield a row on the finer mesh that each unresolved gap map would need."""
    grid = model.grid
    maps = rough_maps(model.scene, model.measured, model.profiles, grid.half_length)
    for table, roughness in maps:
        if any(roughness.unresolved(grid)):
            elements = roughness.resolving(grid).elements
            more = np.prod(elements, dtype=float) / np.prod(grid.elements)
            time = format_duration(
                seconds * transform_work(elements) / transform_work(grid.elements)
            )
            room = f"{memory.contact_bytes(model) * more / 2**20:.0f} MiB"
            finer = " x ".join(map(str, elements))
            yield Row(f"to resolve {table}", f"{finer} elements, about {room} and {time}")


def expected_records(model: Model) -> int:
    """Return the number of records that the process of a model will probably write."""
    return process_type(model.scene).expected_records(model.scene, model.grid.dx)


def expected_applications(model: Model) -> int:
    """Return the work of a run, as a number of elastic responses.

    Work on stress and fatigue counts as the number of responses that take as long.
    """
    work, count, stress = TypicalWork(), expected_records(model), model.scene.subsurface
    bodies = depths = 0
    if stress is not None:
        saved = len(model.scene.schedule.save)
        bodies, depths = len(stress.bodies), saved * len(stress.planes) * stress.elements
    process, blocks = process_of(model), len(model.blocks)
    contacts = process.first_applications + (count - 1) * process.next_applications
    # The coarser meshes for the error bars together take about as long as the finest.
    meshes = 1 if model.scene.accuracy is None else 2
    total = meshes * blocks * (contacts + count * bodies * work.stress)
    total += count * sum(seen.applications(model) for seen in process.following)
    return round(total + depths * work.plane + count * _fatigue_applications(model))


def seconds_of_inclusions(model: Model) -> float:
    """Return the estimated time of the boxes of cells around inclusions in all records, s."""
    cells = sum(InclusionGroup.transformed_cells(model.scene.inclusion))
    return TypicalWork().cell * len(model.blocks) * expected_records(model) * cells


def _fatigue_applications(model: Model) -> float:
    """Return the work of fatigue in a record, in elastic responses; 0 without [fatigue]."""
    work, fatigue = TypicalWork(), model.scene.fatigue
    if fatigue is None:
        return 0.0
    is_critical_plane = fatigue.criterion in ("findley", "fatemi-socie")
    planes = work.planes if fatigue.limit and is_critical_plane else 1.0
    depths = len(model.blocks) * len(fatigue.bodies) * fatigue.elements
    return depths * work.fatigue * planes


def seconds_per_application(model: Model, max_elements: int = 2**18, enough: float = 0.02) -> float:
    """Measure and return the CPU time of one elastic response with the work around it, s.

    A mesh of at most `max_elements` elements stands for a larger one; its time is scaled by the
    work of the transforms. Measuring takes about `enough` seconds. Other programs do not change CPU
    time, but interrupt some responses: the shortest one counts.
    """
    fields, operators = memory.fields_per_operator(model), model.operators
    shape = timed_shape(model.grid.elements, max_elements)
    operators = operators.on(operators.lattice.with_shape(shape))
    operator = {1: operators.normal, 2: operators.slip}.get(fields) or operators.coupled
    values, times = np.ones(operator.shape), list[float]()
    operator(values)
    while len(times) < 3 or (sum(times) < enough and len(times) < 100):
        began = process_time()
        operator(values)
        times.append(process_time() - began)
    scale, work = transform_work(model.grid.elements) / transform_work(shape), TypicalWork()
    return work.transforms * min(times) * scale + work.overhead


def transform_work(shape: tuple[int, int]) -> float:
    """Return the relative work of an FFT on a mesh, n log2(4 n)."""
    elements = float(np.prod(shape))
    return elements * np.log2(4.0 * elements)


def timed_shape(shape: tuple[int, int], max_elements: int) -> tuple[int, int]:
    """Return the shape of a mesh of at most `max_elements`, with similar sides, to time work on."""
    share = np.sqrt(min(1.0, max_elements / np.prod(shape, dtype=float)))
    nx, ny = (min(n, max(3, round(share * n))) for n in shape)
    return min(nx, max(3, max_elements // ny)), min(ny, max(3, max_elements // nx))
