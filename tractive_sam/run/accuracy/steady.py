"""Solve unworn bodies on finer and finer meshes."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from tractive_sam.contact import Gap, Laws, Model, solve_on_fitted_mesh
from tractive_sam.results import Cost, State
from tractive_sam.run.accuracy.assessment import assess
from tractive_sam.run.accuracy.error_bars import Sample
from tractive_sam.run.accuracy.levels import Levels
from tractive_sam.scene import Scene
from tractive_sam.subsurface import fatigue, maxima_by_body


@dataclass(frozen=True)
class RefinedContact:
    """Contact of unworn bodies on the mesh that their accuracy needs, with its model and level.

    Attributes
    ----------
    model : Model
        The scene on that mesh.
    contact : State
        Its contact, with error bars; its cost includes all meshes.
    level : int
        Level of the mesh.
    missed : str
        Why the finest allowed mesh does not suffice; empty if it does.
    """

    model: Model
    contact: State
    level: int
    missed: str


def refine_unworn(
    scene: Scene, measured: Gap | None, model_of: Callable[..., Model] = Model
) -> RefinedContact:
    """Solve unworn bodies on finer meshes until the error bars, or the mesh limit, are reached.

    Parameters
    ----------
    scene : Scene
        Scene with [accuracy] and the tolerances of `set_tolerances`.
    measured : Gap, optional
        Measured separation of the scene.
    model_of : callable
        Makes the model of a scene, a measured separation and a mesh.
    """
    levels = Levels(scene, measured)
    samples: list[Sample | None] = []
    cost, elements, level = Cost(), 1, Levels.first
    while True:
        model, contact = solve_on_fitted_mesh(model_of(scene, measured, levels.grid(level)))
        before, elements = elements, math.prod(model.grid.elements)
        cost = contact.cost + cost.scaled(before / elements)
        # A contact of a few elements may fail although a finer one converges.
        solved = contact.converged
        samples.append(_sample(contact, model.laws) if solved else None)
        assessment = assess(contact, samples, peak=True)
        if not assessment.missed or not levels.allowed(level + 1):
            contact = replace(contact, cost=cost, error_bars=assessment.error_bars)
            return RefinedContact(model, contact, level, assessment.missed)
        level += 1


def _sample(contact: State, laws: Laws) -> Sample:
    """Return the sample of a contact, with its largest stresses and its fatigue."""
    has_fatigue = contact.scene.has("fatigue") and not contact.scene.schedule.end
    cycles = fatigue(contact, laws=laws) if has_fatigue else {}
    return Sample.from_contact(contact, maxima_by_body(contact, laws), cycles)
