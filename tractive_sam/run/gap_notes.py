"""Notes on measured maps: what the mesh does not resolve, and what steady rolling leaves out."""

import math
from collections.abc import Iterator

from tractive_sam.contact import (
    Model,
    Roughness,
    describe_grid_entries,
    rough_maps,
    standing_roughness,
    uncovered_axes,
)
from tractive_sam.run import memory
from tractive_sam.schema import warn


def warn_of_gap(model: Model) -> None:
    """Issue warnings on gap maps that the mesh does not resolve, or that do not roll."""
    for note in gap_notes(model):
        warn(note)


def gap_notes(model: Model) -> Iterator[str]:
    """Yield notes on the gap maps of a model: [gap], and moving profiles of a [transient]."""
    measured, grid = model.measured, model.grid
    short = [] if measured is None else uncovered_axes(measured, grid)
    if short:
        yield (
            f"gap: the measured separation covers less than the grid in {' and '.join(short)}; "
            "beyond its edge it is continued as a constant. Measure a larger area, or reduce "
            "grid.half_length"
        )
    for table, roughness in rough_maps(model.scene, measured, model.profiles, grid.half_length):
        if any(roughness.unresolved(grid)):
            yield f"{table}: {unresolved_note(model, roughness)}"
    rolls = model.transmits or bool(model.scene.schedule.end)
    if measured is not None and rolls and (rest := standing_roughness(measured, grid)):
        yield (
            f"gap: it varies along x by {rest:.2g} mm rms in addition to a round form. In steady "
            "rolling a gap is fixed in space: asperities and waves do not travel through the "
            "contact. Only ridges along x belong to bodies that turn"
        )


def unresolved_note(model: Model, map_: Roughness) -> str:
    """Describe the roughness that the mesh does not resolve, and the cost to resolve it."""
    grid, parts, finer = model.grid, map_.unresolved_parts(model.grid), map_.resolving(model.grid)
    axes = [k for k, n in enumerate(grid.elements) if n > 1]
    sides, shortest = (grid.dx, grid.dy), (finer.dx, finer.dy)
    samples = " x ".join(f"{max(parts[k].samples, 0.0):.2g}" for k in axes)
    waves = " x ".join(f"{2.0 * sides[k]:.2g}" for k in axes)
    height = math.hypot(*(part.height for part in parts))
    pressure = math.hypot(*map(map_.flattening, parts))
    more = math.prod(finer.elements) / math.prod(grid.elements)
    mib = memory.contact_bytes(model) * more / 2**20
    resolved = " x ".join(f"{2.0 * shortest[k]:.2g}" for k in axes)
    return (
        f"an element has {samples} samples of it, and the mesh resolves no waves shorter than two "
        f"elements, {waves} mm: it misses {height:.2g} mm rms of the map, which take "
        f"{pressure:.2g} MPa to flatten, {pressure / map_.pressure:.2g} times the pressure of the "
        "contact. The gap is sampled at the centres of elements, so that p_max and the contact "
        f"area depend on the mesh. {describe_grid_entries(finer)} resolves waves of {resolved} mm: "
        f"{math.prod(finer.elements)} elements, {mib:.0f} MiB and about {more:.2g} times the time "
        "of this mesh. Or smooth the measurement"
    )
