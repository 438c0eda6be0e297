"""What a scene takes of the memory, looked at before any of it is taken."""

import math

from tractive_sam.contact import Model
from tractive_sam.kernels.stress import COMPONENTS
from tractive_sam.operators import available
from tractive_sam.results import FIELDS
from tractive_sam.rolling import process_of
from tractive_sam.schema import Fault, SceneError
from tractive_sam.solvers import NEARBY

BESIDE = 3.5
"""Numbers that are held beside all planes while the stress of one is computed and written, over
those of that plane (measured on `spheres` with 40,000 depths)."""

FITS = 0.9
"""Share of the memory left that what is said to fit takes."""


def fields_together(model: Model) -> int:
    """Fields that an elastic operator of a scene takes at once."""
    return 3 if model.elasticity.coupled and model.transmits else 2 if model.transmits else 1


def of_contact(model: Model) -> float:
    """Memory that a solve takes, bytes."""
    fields, lattice = fields_together(model), model.operators.lattice
    # In doubles: spectra and buffers of the transforms, both in double and single precision, tables
    # on the way to them, and the Krylov space: of a large mesh in single precision, of others all
    # vectors of a system, the responses to them and their orthonormal basis.
    padded, elements = math.prod(lattice.padded), math.prod(lattice.shape)
    krylov = 25 if elements >= NEARBY.large else 3 * NEARBY.krylov
    spectra = 1.5 * (9 if fields == 3 else 3)
    one = 8.0 * (padded * (spectra + 3.75 * fields + 7) + krylov * fields * elements)
    observers = process_of(model).following
    return one * len(model.blocks) + sum(seen.bytes_needed(model) for seen in observers)


def of_stress(model: Model) -> float:
    """Memory that the planes of [subsurface] take, bytes."""
    asked, (nx, ny) = model.scene.subsurface, model.grid.elements
    if asked is None:
        return 0.0
    along = {"x": ny, "y": nx}
    planes = [nx * ny if p.axis == "z" else along[p.axis] * asked.elements for p in asked.planes]
    return 8.0 * len(COMPONENTS) * len(asked.bodies) * (sum(planes) + BESIDE * max(planes))


def of_fatigue(model: Model) -> float:
    """Memory that the layers of [fatigue] take, and what it keeps of each body, bytes."""
    asked, (nx, ny) = model.scene.fatigue, model.grid.elements
    if asked is None:
        return 0.0
    # Layers go on beyond the mesh; a few of both bodies are held at a time.
    layers = 3 * len(COMPONENTS) * 4 * nx * ny
    blocks = len(model.blocks)
    return 8.0 * len(asked.bodies) * (blocks * layers + BESIDE * 20 * asked.elements * ny)


def of_records(model: Model) -> float:
    """Memory that records take where no file does, bytes."""
    kept = len(model.scene.schedule.save)
    blocks = max(1, len(model.scene.duty))
    return 8.0 * kept * blocks * len(FIELDS) * math.prod(model.grid.elements)


def of_scene(model: Model) -> float:
    """Memory that a scene takes that is rolled into a file, bytes."""
    return of_contact(model) + of_stress(model) + of_fatigue(model)


def check_solve(model: Model) -> None:
    """See that a solve fits into the memory, with [accuracy] on the largest mesh that it allows.

    Raises
    ------
    SceneError
        With the number of elements that does.
    """
    _check_mesh(model, of_contact(model))
    if model.scene.accuracy is not None:
        _check_accuracy(model)


def check_roll(model: Model, in_memory: bool) -> None:
    """See that a roll fits into the memory, with its stress and with what it keeps there.

    Raises
    ------
    SceneError
        With what does.
    """
    check_solve(model)
    free, contact, stress = available(), of_contact(model), of_stress(model)
    if in_memory:
        contact += of_records(model)
        _check_mesh(model, contact)
    if contact + stress > free:
        asked = model.scene.subsurface
        most = int(FITS * (free - contact) / stress * asked.elements)
        given = f"{asked.elements}, for which {_describe_shortage(contact + stress, free)}"
        raise SceneError([Fault("subsurface.elements", given, f"here at most about {most}")])


def _check_accuracy(model: Model) -> None:
    free, most = available(), model.scene.accuracy.elements
    needed = of_contact(model) * most / math.prod(model.grid.elements)
    if needed > free:
        given = f"{most}, for which {_describe_shortage(needed, free)}"
        allowed = f"here at most about {int(FITS * free / needed * most)}"
        raise SceneError([Fault("accuracy.elements", given, allowed)])


def _check_mesh(model: Model, needed: float) -> None:
    free = available()
    if needed <= free:
        return
    nx, ny = model.grid.elements
    share = FITS * free / needed
    per_side = share ** (1.0 / sum(n > 1 for n in (nx, ny)))
    fits = " x ".join(str(max(1, int(per_side * n))) for n in (nx, ny))
    given = f"{nx} x {ny}, for which {_describe_shortage(needed, free)}"
    raise SceneError([Fault("grid.elements", given, f"here at most about {fits}")])


def _describe_shortage(needed: float, free: float) -> str:
    return f"the memory does not suffice: {needed / 2**20:.0f} MiB, and {free / 2**20:.0f} are free"
