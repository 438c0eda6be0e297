"""Memory that a scene takes, before it is allocated, and memory that the process may still take."""

import math
import operator
import os
from contextlib import suppress
from pathlib import Path
from types import ModuleType

from tractive_sam.contact import Model
from tractive_sam.kernels.stress import COMPONENTS
from tractive_sam.mechanics import HertzContact
from tractive_sam.operators import layer_cache
from tractive_sam.results import storable_fields
from tractive_sam.rolling import process_of, process_type
from tractive_sam.schema import Fault, SceneError, required
from tractive_sam.solvers import COUPLED, FIXED_PRESSURE, NEARBY

resource: ModuleType | None
try:
    import resource
except ImportError:  # this system has no limits
    resource = None


def available_memory() -> float:
    """Return the memory, in bytes, that the process may still allocate; infinite if unknown."""
    return max(0.0, min(_free_memory(), memory_of_groups(), _memory_of_limit()))


def _free_memory() -> float:
    """Return the memory available on the machine, bytes; if unknown, its total memory, or inf."""
    with suppress(OSError, ValueError):
        for line in Path("/proc/meminfo").read_text().splitlines():
            if line.startswith("MemAvailable:"):
                return 1024.0 * float(line.split()[1])
    with suppress(AttributeError, OSError, ValueError):
        return float(os.sysconf("SC_PHYS_PAGES")) * os.sysconf("SC_PAGE_SIZE")
    return math.inf


def memory_of_groups(
    root: Path = Path("/sys/fs/cgroup"), members: Path = Path("/proc/self/cgroup")
) -> float:
    """Return the memory, in bytes, that the control groups (cgroups) still allow the process.

    In `root`, Linux stores the limits of groups (containers, batch jobs); `members` lists
    those of the process.
    """
    free = [math.inf]
    with suppress(OSError, ValueError):
        for line in members.read_text().splitlines():
            _, kinds, name = line.split(":", 2)
            if kinds == "":  # version 2
                names, base = ("memory.max", "memory.current", "inactive_file"), root
            elif "memory" in kinds.split(","):  # version 1
                names = ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file")
                base = root / "memory"
            else:
                continue
            inner = Path(name.lstrip("/"))
            free += [_memory_of_group(base / group, *names) for group in (inner, *inner.parents)]
    return min(free)


def _memory_of_group(group: Path, limit: str, usage: str, cache: str) -> float:
    """Return the bytes that a control group still allows, cache included; inf if unlimited."""
    try:
        limit_bytes, used = (float((group / name).read_text()) for name in (limit, usage))
    except (OSError, ValueError):  # no control group, or "max"
        return math.inf
    with suppress(OSError, ValueError):
        stat = dict(line.split() for line in (group / "memory.stat").read_text().splitlines())
        used -= float(stat.get(cache, 0.0))  # the system frees the cache when it needs memory
    return limit_bytes - used


def _memory_of_limit() -> float:
    """Return the memory, in bytes, that ``ulimit -v`` still allows; infinite without a limit."""
    if resource is None:
        return math.inf
    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    if limit == resource.RLIM_INFINITY:
        return math.inf
    with suppress(OSError, ValueError):
        return (
            limit - float(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        )
    return float(limit)


FIELD_COPIES = 3.5
"""Memory used while the stress of one plane is computed and written, in addition to all planes,
over the numbers of that plane (measured on `spheres` with 40,000 depths)."""

KRYLOV_VECTORS = 30.0
"""Vectors that a Krylov space in single precision takes, with all else of an iterate, in doubles
(measured on `spin` with 200 to 400 elements along a side)."""

FITS = 0.9
"""Fraction of the free memory that a proposed size takes."""


def fields_per_operator(model: Model) -> int:
    """Return the number of fields, 1 to 3, that the elastic operator of a model transforms."""
    return 3 if model.elasticity.coupled and model.transmits else 2 if model.transmits else 1


def contact_bytes(model: Model) -> float:
    """Return the estimated memory of a contact's solution, bytes."""
    fields, lattice = fields_per_operator(model), model.operators.lattice
    # In doubles: spectra and buffers of the transforms, both in double and single precision, tables
    # from which they are made, and the Krylov space: on a large mesh in single precision, on others
    # all vectors of a system, the responses to them and their orthonormal basis.
    padded, elements = math.prod(lattice.padded), math.prod(lattice.shape)
    spectra = padded * (1.5 * (9 if fields == 3 else 3) + 3.75 * fields + 5)
    krylov, gmres_from = _krylov_limits(model)
    part, sizes = _rectangles(model)
    around = part * elements
    vectors = 3.0 * krylov * around
    if around >= gmres_from:
        vectors = KRYLOV_VECTORS * around + _coarse_vectors(model)
    process, schedule = process_of(model), model.scene.schedule
    # Of the patches of a wheel, plans and tables remain; measured on `wheel-rail`.
    patches = 1 if schedule.in_sequence else 1 + _count_records(model)
    # Spectra and buffers of both problems on each further rectangle; measured on `twin-discs`.
    rectangles = 178.0 * sizes * min(around, 0.27 * elements)
    block = 8.0 * (patches * (spectra + vectors * fields) + rectangles)
    observed = sum(observer.bytes_needed(model) for observer in process.following)
    return block * len(model.blocks) + observed


def _rectangles(model: Model) -> tuple[float, float]:
    """Return the part of the mesh on which a contact that wears is solved, and its further sizes.

    The solvers use a rectangle around the contact. As it wears, each size of the rectangle has its
    spectra and buffers; those of eight sizes remain.
    """
    scene, hertz = model.scene, model.scene.hertz
    if scene.wear is None or fields_per_operator(model) == 3:  # coupled: on the mesh
        return 1.0, 0.0
    most = min(7, max(0, _count_records(model) - 2))
    mu = (0.0, 0.0) if scene.friction is None else scene.friction.mu
    rates = scene.wear.per_work(mu) if any(mu) else None
    if not isinstance(hertz, HertzContact) or not rates:
        return 1.0, min(3, most)
    # Full slip at the middle of the contact. Of the approach, a depth of a seventeenth changes the
    # size once; measured on `twin-discs` after 2 to 1000 revolutions, on which a part sticks.
    creepage = math.hypot(
        *(getattr(scene.creepage, key) or 0.0 for key in ("longitudinal", "lateral"))
    )
    work = max(map(operator.mul, rates, mu)) * 0.25 * math.pi * hertz.p0 * creepage * 2.0 * hertz.a
    worn = work * scene.schedule.end / hertz.approach
    part = 1.1 * hertz.a * hertz.b / math.prod(model.grid.half_length)
    return min(1.0, part * (1.0 + 0.1 * worn)), min(most, 17.0 * worn)


def _krylov_limits(model: Model) -> tuple[int, float]:
    """Return the most vectors of a Krylov space, and the elements from which it is reduced.

    The first contact is solved from rest, and each further one from the contact before it.
    """
    from_rest = COUPLED if fields_per_operator(model) == 3 else FIXED_PRESSURE
    is_sequence = model.scene.schedule.in_sequence and _count_records(model) > 1
    method = NEARBY if is_sequence else from_rest
    return method.krylov, method.gmres_from


def _coarse_vectors(model: Model) -> float:
    """Return the numbers, for each field, of the coarser mesh on which a large one starts."""
    return 0.75 * math.prod(_krylov_limits(model))


def _count_records(model: Model) -> int:
    """Return the number of records that the process of a model will probably write."""
    return process_type(model.scene).expected_records(model.scene, model.grid.dx)


def stress_bytes(model: Model) -> float:
    """Return the estimated memory, bytes, of the stress planes of [subsurface]; 0 without it."""
    table, (nx, ny) = model.scene.subsurface, model.grid.elements
    if table is None:
        return 0.0
    along = {"x": ny, "y": nx}
    planes = [nx * ny if p.axis == "z" else along[p.axis] * table.elements for p in table.planes]
    return 8.0 * len(COMPONENTS) * len(table.bodies) * (sum(planes) + FIELD_COPIES * max(planes))


def fatigue_bytes(model: Model) -> float:
    """Return the estimated memory, bytes, of layers and results of [fatigue]; 0 without it."""
    table, (nx, ny) = model.scene.fatigue, model.grid.elements
    if table is None:
        return 0.0
    # Layers of three lengths extend beyond the mesh, with their transforms.
    layers = 7 * len(COMPONENTS) * 4 * nx * ny
    results = FIELD_COPIES * 20 * table.elements * ny
    tables = 8.0 * 20 * nx * ny * table.elements
    cached = min(float(layer_cache.max_bytes), tables)
    return 8.0 * len(table.bodies) * (len(model.blocks) * layers + results) + cached


def records_bytes(model: Model) -> float:
    """Return the estimated memory of the records of a roll without a results file, bytes."""
    saved = len(model.scene.schedule.save)
    blocks = max(1, len(model.scene.duty))
    fields = len(storable_fields(model.scene))
    return 8.0 * saved * blocks * fields * math.prod(model.grid.elements)


def scene_bytes(model: Model) -> float:
    """Return the estimated memory of a roll that writes its records to a file, bytes."""
    # The programs that find the contacts of profiles of wheel and rail.
    profiles = 0.0 if model.scene.wheelset is None else 30.0 * 2**20
    # The search for the largest stress: spectra of the tractions and of surface displacements, and
    # the stress at the surface; measured on `spheres` with 200 to 400 elements along a side.
    subsurface, elements = model.scene.subsurface, math.prod(model.grid.elements)
    search = 0.0 if subsurface is None else 8.0 * 34 * elements
    of_stress = search + stress_bytes(model) + fatigue_bytes(model)
    return contact_bytes(model) + of_stress + profiles


def check_solve(model: Model) -> None:
    """Raise an error unless a solve probably fits into the memory.

    Raises
    ------
    SceneError
        With the number of elements that fits; or if the scene names a process or an observer that
        may not be used.
    """
    process_of(model)  # refuses what a scene names and may not import
    # Smaller meshes take less than the program itself, and the check takes .6 ms.
    if math.prod(model.grid.elements) > 2**14:
        _check_mesh(model, contact_bytes(model), available_memory())
    if model.scene.accuracy is not None:
        _check_accuracy(model)


def check_roll(model: Model, in_memory: bool) -> None:
    """Raise an error unless a roll, with stress and records, probably fits into the memory.

    Raises
    ------
    SceneError
        With the setting that would fit.
    """
    free, stress = available_memory(), stress_bytes(model)
    contact = scene_bytes(model) - stress + (records_bytes(model) if in_memory else 0.0)
    _check_mesh(model, contact, free)
    check_solve(model)
    if contact + stress > free:
        elements = required(model.scene.subsurface, "subsurface").elements
        fits = int(FITS * (free - contact) / stress * elements)
        shortage = f"{elements}, for which {_describe_shortage(contact + stress, free)}"
        raise SceneError([Fault("subsurface.elements", shortage, f"here at most about {fits}")])


def _check_accuracy(model: Model) -> None:
    """Raise an error if the largest mesh of [accuracy] does not fit into the memory."""
    free = available_memory()
    elements = required(model.scene.accuracy, "accuracy").elements
    needed = contact_bytes(model) * elements / math.prod(model.grid.elements)
    if needed > free:
        shortage = f"{elements}, for which {_describe_shortage(needed, free)}"
        allowed = f"here at most about {int(FITS * free / needed * elements)}"
        raise SceneError([Fault("accuracy.elements", shortage, allowed)])


def _check_mesh(model: Model, needed: float, free: float) -> None:
    """Raise an error if a computation needs more bytes than are free."""
    if needed <= free:
        return
    nx, ny = model.grid.elements
    # What does not depend on the mesh, as far as it leaves half of the memory to the rest.
    fixed = min(0.5 * FITS * free, 8.0 * fields_per_operator(model) * _coarse_vectors(model))
    share = (FITS * free - fixed) / (needed - fixed)
    per_side = share ** (1.0 / sum(n > 1 for n in (nx, ny)))
    fits = " x ".join(str(max(1, int(per_side * n))) for n in (nx, ny))
    shortage = f"{nx} x {ny}, for which {_describe_shortage(needed, free)}"
    raise SceneError([Fault("grid.elements", shortage, f"here at most about {fits}")])


def _describe_shortage(needed: float, free: float) -> str:
    """Describe how much memory is needed and how much is free."""
    return f"the memory does not suffice: {needed / 2**20:.0f} MiB, and {free / 2**20:.0f} are free"
