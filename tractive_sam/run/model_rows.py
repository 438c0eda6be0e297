"""Rows of an explanation that need the model of a scene: its mesh, method and laws.

`Table.describe` describes a table alone; `MODEL_ROWS` adds to its rows.
"""

from collections.abc import Callable, Iterable, Iterator
from typing import Any

from tractive_sam.contact import Model, choose_grid
from tractive_sam.description import Row
from tractive_sam.operators import STEPS_FROM
from tractive_sam.results import columns
from tractive_sam.rolling import process_of
from tractive_sam.run.accuracy.steady import RefinedContact
from tractive_sam.scene import Heat, Solver
from tractive_sam.schema import required


def _describe_creepage(_table: Any, model: Model) -> Iterator[Row]:
    """Yield rows on the coupling of pressure and tractions, and on the tangential problem."""
    K = model.scene.material.coupling
    coupling = "none: tractions do not change the pressure, which is solved first"
    if model.elasticity.coupled and model.transmits:
        coupling = (
            "of unlike bodies: pressure makes the surfaces slip and tractions lift them, so both "
            f"is solved at once (K = {K:.4g}, 0 for like bodies)"
        )
    elif model.elasticity.coupled:
        coupling = (
            f"of unlike bodies (K = {K:.4g}), but without friction there are no tractions to lift "
            "the surfaces: only the pressure is solved"
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
    yield Row("left out", "inertia, lubricant, plasticity; thin or conforming bodies")


def _describe_transient(_table: Any, model: Model) -> Iterator[Row]:
    """Yield a row on the order of accuracy of a transient."""
    yield Row("order", f"{'second' if model.stencil.staggered else 'first'} in the mesh")


def _describe_process(_table: Any, model: Model) -> Iterator[Row]:
    """Yield the rows of the model's process."""
    yield from process_of(model).describe()


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
    "transient": _describe_transient,
    "process": _describe_process,
    "heat": _describe_heat,
}
"""Rows that the model adds to the rows of a given table."""


def describe_laws_of_packages(model: Model) -> Iterator[Row]:
    """Yield the rows with which user-defined laws describe themselves."""
    for name, law in model.laws.differences_from(model.scene).items():
        yield Row(name, law.text)


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
