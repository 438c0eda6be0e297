"""What a scene will have modelled, what is left out and why, and what it will take."""

from dataclasses import dataclass
from time import perf_counter

import numpy as np

from tractive_sam.contact import Model, choose_grid, rough_maps
from tractive_sam.operators import STEPS_FROM, available
from tractive_sam.results import columns
from tractive_sam.rolling import MISSED, expected_steps
from tractive_sam.run import memory
from tractive_sam.run.accuracy.levels import with_tolerances
from tractive_sam.run.accuracy.steady import Refined, refined
from tractive_sam.run.gap_notes import warn_of_gap
from tractive_sam.run.given import measured_gap, travelling
from tractive_sam.scene import Scene, told

# Typical work at a tolerance of 1e-8, in applications with all that goes with them: of a new
# contact on nested meshes, of a revolution, which starts from the one before, and of a jump, which
# is solved more than once.
COLD_APPLICATIONS = 50
WARM_APPLICATIONS = 40
JUMP_APPLICATIONS = 50
STEP_APPLICATIONS = 40  # as long as a step of a transient takes (benchmarks/transient.py)
JUMPS = 14  # while the revolutions rolled grow e-fold
STRESS_APPLICATIONS = 75  # as long as the largest stress of one body takes
FATIGUE_APPLICATIONS = 4  # as long as a depth of [fatigue] takes, of one body
PLANES = 15  # as many times as long with a critical plane
DEPTH_APPLICATIONS = 0.5  # as long as a depth of a plane takes, of both bodies

OF_PROGRAMS = 250
"""Memory that a process takes before any scene, MiB."""


TIMED = 2**18
"""Most elements of a mesh whose transforms are timed."""


@dataclass(frozen=True)
class Section:
    """A heading and its rows of (what, answer)."""

    title: str
    rows: list[tuple[str, str]]


class Explanation(tuple[Section, ...]):
    """Sections, which print themselves as `tractive-sam explain` does."""

    __slots__ = ()

    def __repr__(self) -> str:
        parts = []
        for section in self:
            width = max(len(what) for what, _ in section.rows)
            rows = (f"  {what:{width}}  {answer}" for what, answer in section.rows)
            parts.append("\n".join((section.title, *rows)))
        return "\n\n".join(parts)


def explain(scene: Scene) -> Explanation:
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
    >>> told = ts.explain(scene)  # prints itself
    >>> told[0].title, told[0].rows[1]
    ('Bodies', ('combined radii', 'R_x = 168.75 mm, R_y = 168.75 mm'))
    """
    measured = measured_gap(scene)
    profiles = travelling(scene)
    accuracy = []
    model = Model(scene, measured, profiles=profiles)
    if scene.accuracy is not None:
        memory.check_solve(model)
        chosen = with_tolerances(scene)
        found = refined(chosen.alone, measured)
        model = Model(chosen, measured, found.model.grid)
        accuracy = [_accuracy(found)]
    parts = (_bodies, _contact, _wear, _subsurface, _mesh, _work)
    told = [part(model) for part in parts]
    warm = [] if scene.heat is None else [_heat(model)]
    damaged = [] if scene.fatigue is None else [_fatigue(model)]
    changing = _transient(model)
    return Explanation((*told[:4], *changing, *warm, *damaged, *accuracy, *told[4:]))


def _accuracy(found: Refined) -> Section:
    scene, contact = found.contact.scene, found.contact
    meshes = "refined until the error bars are within it"
    if scene.wear is not None:
        meshes += "; further, where two coarser meshes rolled before show that wear asks for it"
    rows = [("asked for", f"{scene.accuracy.tolerance:g}, relative: the mesh is {meshes}")]
    if found.missed:
        rows.append(("not reached", found.missed))
    for name in ("Qx", "Qy", "Mz", "p_max"):
        if name in contact.error_bars:
            bar = contact.error_bars[name]
            value = f"{getattr(contact, name):.6g} +- {bar:.1g} {columns(scene)[name].unit}"
            rows.append((f"{name} of the unworn bodies", value))
    return Section("Accuracy", rows)


def _bodies(model: Model) -> Section:
    material, hertz = model.scene.material, model.scene.hertz
    radius_x, radius_y = model.scene.body.radii
    rows = [
        ("combined modulus", f"E* = {material.E_star:.6g} MPa, nu = {material.poisson:.4g}"),
        ("combined radii", f"R_x = {radius_x:.6g} mm, R_y = {radius_y:.6g} mm"),
    ]
    if model.grid.line:
        rows.append(("line contact", _plane_strain(model)))
    if model.scene.elasticity and model.scene.elasticity.named_law:
        rows.append(("elasticity", f"{model.scene.elasticity.law}, in place of half-spaces"))
    if hertz is not None:
        rows += [
            ("unworn contact (Hertz)", f"a = {hertz.a:.5g} mm, b = {hertz.b:.5g} mm"),
            ("its pressure", f"p0 = {hertz.p0:.6g} MPa, approach = {hertz.approach:.4g} mm"),
        ]
    rows.append(("load", told.load_told(model.scene)))
    if model.measured is not None:
        rows.append(("separation", "that of the radii and the measured one of [gap]"))
        warn_of_gap(model)
    return Section("Bodies", rows)


def _plane_strain(model: Model) -> str:
    return (
        f"plane strain, solved on {model.grid.elements[0]} elements: both bodies are straight and "
        "infinitely long in y (radius_y = inf), so nothing changes along it; forces are per "
        "length, N/mm, and the approach is relative to the surface one R_x away"
    )


def _contact(model: Model) -> Section:
    scene, K = model.scene, model.scene.material.coupling
    if model.elasticity.coupled and model.transmits:
        coupling = (
            "of unlike bodies: pressure makes the surfaces slip and tractions lift them, so both "
            f"are solved at once (K = {K:.4g}, 0 of like ones)"
        )
    elif model.elasticity.coupled:
        coupling = (
            f"of unlike bodies (K = {K:.4g}), but without friction there are no tractions to lift "
            "the surfaces: the pressure is solved alone"
        )
    else:
        coupling = "none: tractions do not change the pressure, which is solved first"
    if scene.friction is None:
        tangential = "left out: without friction there is no traction"
    elif not model.transmits:
        tangential = "left out: equal materials without creepage roll freely, without traction"
    else:
        tangential = "stick and slip under " + _drive(model)
    rows = [("coupling", coupling), ("tangential problem", tangential)]
    if scene.friction is not None:
        rows.append(("friction", told.friction_told(scene)))
    rows.append(("method", f"{model.method.told}, to a residual of {scene.solver.tolerance:g}"))
    if model.transmits:
        staggered = model.stencil.staggered
        scheme = "from differences " + (
            "between elements (staggered): its error falls with the square of their size"
            if staggered
            else "towards the leading edge (upwind, the paper's): its error falls with their size"
        )
        rows.append(("slip", scheme))
    heat = "heat, " if scene.heat is None else ""
    rows.append(("left out", f"inertia, lubricant, {heat}plasticity; thin or conforming bodies"))
    return Section("State", rows)


def _drive(model: Model) -> str:
    creepage, load = model.scene.creepage, model.scene.load
    unit = model.scene.force_unit
    if model.scene.transient is not None:
        return "what changes over the distance (Transient, below)"
    parts = [
        f"Q_x = {load.force_x:g} {unit} (creepage found)"
        if model.free[0]
        else f"xi_x = {creepage.longitudinal:g}",
        f"Q_y = {load.force_y:g} {unit} (creepage found)"
        if model.free[1]
        else f"xi_y = {creepage.lateral:g}",
        f"spin = {creepage.spin:g} /mm",
    ]
    return ", ".join(parts)


def _wear(model: Model) -> Section:
    wear = model.scene.wear
    if wear is None:
        return Section("Wear", [("wear", "left out: the scene has no [wear]")])
    upwind = model.scene.solver.slip == "upwind"
    rows = [("law", f"{told.law_told(model.scene)}, {told.wear_told(model.scene)}")]
    if model.scene.transient is None:
        rows += [
            ("revolutions", f"{wear.revolutions}, {_stepping(wear)}"),
            ("fields kept at", ", ".join(map(str, wear.save))),
            *told.duty_told(model.scene).items(),
            ("turns", told.turns_told(model.scene)),
        ]
    else:
        stays = "stays with the material, which rolls on"
        if not model.scene.transient.rolls:
            stays = "stays where it is, as nothing rolls"
        rows.append(("depth", f"{stays}, and is part of the gap of the next step"))
    rows += [
        ("of the depth", told.share_told(model.scene)),
        ("worn mass", told.density_told(model.scene)),
    ]
    if upwind:
        rows.append(("slip", "the paper's upwind difference: frictional work comes out too small"))
    return Section("Wear", rows)


def _stepping(wear) -> str:
    if wear.stepping == "adaptive":
        told = f"in adaptive jumps, to {wear.tolerance:g} of the wear depth"
        return f"{told}, and their contacts to a residual of no more"
    return "one by one"


def _subsurface(model: Model) -> Section:
    asked, criterion = model.scene.subsurface, model.laws.criterion
    if asked is None:
        return Section("Stress", [("stress", "left out: the scene has no [subsurface]")])
    hertz = model.scene.hertz
    deepest = f"{asked.depth:g} a" if hertz is None else f"{asked.depth * hertz.a:.4g} mm"
    rolls = model.scene.wear is not None or model.scene.transient is not None
    kept = f"each of {model.scene.schedule.save_key}" if rolls else "the unworn bodies"
    rows = [
        ("bodies", ", ".join(asked.bodies)),
        ("planes", f"{', '.join(map(str, asked.planes))}, at {kept}"),
        ("depths", f"{asked.elements} to {deepest}, closer towards the surface"),
        (f"largest {criterion.long_name}", "inside and at the surface, with every record"),
    ]
    return Section("Stress", rows)


def _heat(model: Model) -> Section:
    scene, rows = model.scene, []
    speed, bulk = scene.creepage.speed, scene.heat.bulks
    half = model.grid.half_length[0] if scene.hertz is None else scene.hertz.a
    for name, thermal in scene.thermal.items():
        given = "" if getattr(scene.body, name).thermal else " (steel, not given)"
        moving = speed / (2.0 * thermal.diffusivity)
        fronts = "steps" if moving * model.grid.dx > STEPS_FROM else "resolved"
        rows.append(
            (
                f"body {name}",
                f"{thermal.conductivity:g} W/(m K), {thermal.diffusivity:.4g} mm2/s{given}, bulk "
                f"{bulk[name]:g} degC; Peclet number {moving * half:.3g} of the contact, "
                f"{moving * model.grid.dx:.3g} of an element: heat fronts {fronts}",
            )
        )
    alike = scene.thermal["A"] == scene.thermal["B"] and bulk["A"] == bulk["B"]
    shared = "half to each body" if alike else "by equal temperatures in contact"
    rows.append(("shared", shared))
    table = scene.friction and scene.friction.temperature
    answers = "contact and temperature in turn" if table else "no: the contact is solved once"
    rows.append(("friction answers to it", answers))
    return Section("Heat", rows)


def _fatigue(model: Model) -> Section:
    asked, laws = model.scene.fatigue, model.laws
    k = asked.shear_yield_stress
    shakedown = "left out: there is no shear_yield or yield_strength"
    if k is not None:
        shakedown = f"k = {k:.6g} MPa: certain by Melan (rho_xx and rho_yy), impossible by Koiter"
    rows = [("bodies", ", ".join(asked.bodies)), ("shakedown", shakedown)]
    if k is not None and model.scene.hertz is not None:
        ratio = model.scene.hertz.p0 / k
        rows.append(("p0/k", f"{ratio:.3g} unworn; without friction a line shakes down up to 4"))
    if laws.fatigue is None or laws.life is None:
        rows.append(("utilisation and damage", "left out: there is no limit"))
    else:
        line = laws.life
        life = f"{line.cycles:g} cycles at {asked.limit:g} MPa, to the power -{line.exponent:g}"
        life += ", infinite below" if line.knee else ""
        rows += [("criterion", laws.fatigue.long_name), ("life", life)]
        if laws.volume is not None:
            rows.append(("volume", _volume(model)))
        if len(model.blocks) > 1:
            rows.append(
                (
                    "duty cycle",
                    "the damage of its blocks by Miner's rule, in any order (damage_error "
                    "estimates its effect)",
                )
            )
        if model.scene.wear is not None and model.scene.wear.stepping == "adaptive":
            rows.append(
                (
                    "jumps",
                    f"each misses up to {MISSED * asked.tolerance:g} of the largest damage, by its "
                    "estimate; all together damage_error",
                )
            )
    rows += [
        (
            "depths",
            f"{asked.elements} to {asked.depth:g} a; between the surface and one element "
            "below it stress goes with the root of the depth",
        ),
        ("stress", "elastic: where it is above the shakedown limit the material does not see it"),
        ("records", "every one; fields over (y, depth) with the fields that are kept"),
        (
            "missing",
            "bending, residual stress from making the bodies, hardness over the depth",
        ),
    ]
    return Section("Fatigue", rows)


def _volume(model: Model) -> str:
    law, asked = model.laws.volume, model.scene.fatigue.volume
    told = f"stress^{law.stress_exponent:.4g} / depth^{law.depth_exponent:.4g}"
    told += f" above {law.limit:g} MPa" if law.limit else ""
    told += f", Weibull's slope {law.slope:.4g}; from one element deep on"
    if asked.constant is None:
        return f"{told}; no life: there is no constant"
    return f"{told}; life with a survival of {asked.survival:g}"


def _mesh(model: Model) -> Section:
    grid, hertz = model.grid, model.scene.hertz
    nx, ny = grid.elements
    given = "chosen from the contact"
    if model.scene.grid is not None:
        if not model.scene.bounded:
            given = "given, the domain chosen from the contact"
        else:
            given = "given" if model.scene.grid.elements else f"{given}, the domain given"
    elif model.scene.accuracy is not None:
        given = "found by refinement"
    given += _refinement(model)
    if grid.line:
        rows = [
            ("mesh", f"{nx} elements in x, {given}"),
            ("domain", f"+-{grid.half_length[0]:.4g} mm"),
            ("element", f"{grid.dx:.4g} mm"),
            ("across the unworn contact", f"{2 * hertz.a / grid.dx:.0f} elements"),
        ]
        return Section("Mesh", rows)
    rows = [
        ("mesh", f"{nx} x {ny} elements, {given}"),
        ("domain", f"+-{grid.half_length[0]:.4g} x +-{grid.half_length[1]:.4g} mm"),
        ("element", f"{grid.dx:.4g} x {grid.dy:.4g} mm"),
    ]
    if hertz is not None:
        across = (2 * hertz.a / grid.dx, 2 * hertz.b / grid.dy)
        rows.append(("across the unworn contact", f"{across[0]:.0f} x {across[1]:.0f} elements"))
    return Section("Mesh", rows)


def _refinement(model: Model) -> str:
    """Say that a mesh follows a measured map, and what it was without; else nothing."""
    scene, grid = model.scene, model.grid
    if scene.accuracy is not None or (model.measured is None and not model.profiles):
        return ""
    usual = choose_grid(scene, model.measured, model.profiles, finer=1.0)
    if (usual.dx, usual.dy) == (grid.dx, grid.dy):
        return ""
    elements = " x ".join(str(n) for n in usual.elements if n > 1)
    return f", refined from {elements} to the waves of the measured gap or profile"


def _resolving(model: Model, seconds: float) -> list[tuple[str, str]]:
    """What it takes to resolve maps that the mesh does not."""
    rows, grid = [], model.grid
    for table, one in rough_maps(model.scene, model.measured, model.profiles, grid.half_length):
        if any(one.unresolved(grid)):
            elements = one.resolving(grid).elements
            more = np.prod(elements, dtype=float) / np.prod(grid.elements)
            time = duration(seconds * work(elements) / work(grid.elements))
            room = f"{memory.of_contact(model) * more / 2**20:.0f} MiB"
            answer = f"{' x '.join(map(str, elements))} elements, about {room} and {time}"
            rows.append((f"to resolve {table}", answer))
    return rows


def _work(model: Model) -> Section:
    resolving = []
    if not model.method.predictable:
        time = "not estimated: the iterations of Uzawa's method are not known beforehand"
    else:
        count = applications(model)
        seconds = seconds_per_application(model) * count
        time = f"about {duration(seconds)}, for {count} elastic responses by Fourier transforms"
        resolving = _resolving(model, seconds)
    needed, free = memory.of_scene(model), available()
    room = f"about {needed / 2**20:.0f} MiB, and {OF_PROGRAMS} MiB for programs"
    if needed > free:
        room += f": more than the {free / 2**20:.0f} MiB that are free here"
    return Section("Work", [("memory", room), ("time", time), *resolving])


def _transient(model: Model) -> list[Section]:
    """What changes over the distance, and in which steps; nothing of steady scenes."""
    table = model.scene.transient
    if table is None:
        return []
    start = {
        "rest": "the bodies pressed together, without traction",
        "steady": "steady rolling as the first knot says",
        "shift": "the bodies pressed together; they do not roll but shift, by the courses of "
        "[creepage] in mm and radians",
    }
    unit = "mm" if table.rolls else "of the parameter"
    usual = "of one element" if table.rolls else "of a tenth of a stretch"
    steps = f"{usual if table.step is None else f'of {table.step:g} {unit}'}, shorter to a knot"
    if table.stepping == "adaptive":
        steps = f"as long as tractions are foreseen to {table.tolerance:g}"
    taken = records(model.scene, model.grid.dx) - 1
    order = "second" if model.stencil.staggered else "first"
    rows = [
        ("starts from", start[table.start]),
        ("goes", f"from {table.distance[0]:g} to {table.distance[-1]:g} {unit}"),
        ("courses", ", ".join(table.courses) or "none: everything stays as the tables say"),
        ("steps", f"{steps}: about {taken}, each from the two before"),
        ("order", f"{order} in the mesh"),
        ("fields kept at", ", ".join(f"{at:g}" for at in table.save)),
    ]
    return [Section("Transient", rows)]


def records(scene: Scene, dx: float | None = None) -> int:
    """Records that a scene is expected to have, on elements so long."""
    if scene.transient is not None:
        if dx is None:
            known = scene.bounded or scene.hertz is not None
            dx = choose_grid(scene).dx if known else 0.1
        return 1 + expected_steps(scene, dx)
    wear = scene.wear
    if wear is None:
        return 1
    if wear.stepping == "adaptive":
        # Jumps grow in proportion to the revolutions rolled, and little with a loose tolerance
        # (benchmarks/wear.py).
        jumps = JUMPS * max(1.0, (1e-3 / wear.tolerance) ** 0.3) * np.log1p(wear.revolutions)
        return 1 + min(wear.revolutions, int(jumps))
    return 1 + wear.revolutions


def applications(model: Model) -> int:
    """Transform pairs that a scene is expected to take, or what takes as long."""
    count, stress = records(model.scene, model.grid.dx), model.scene.subsurface
    bodies = depths = 0
    if stress is not None:
        kept = len(model.scene.schedule.save)
        bodies, depths = len(stress.bodies), kept * len(stress.planes) * stress.elements
    jumps = model.scene.wear is not None and model.scene.wear.stepping == "adaptive"
    each = JUMP_APPLICATIONS if jumps else WARM_APPLICATIONS
    if model.scene.transient is not None:
        each = STEP_APPLICATIONS
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


def duration(seconds: float) -> str:
    """A time in words."""
    if seconds < 1.0:
        return "a second or less"
    if seconds < 120.0:
        return f"{seconds:.0f} s"
    if seconds < 7200.0:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"
