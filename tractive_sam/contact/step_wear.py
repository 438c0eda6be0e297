"""Wear of a step of transient rolling, or a shift: depths that sliding particles lose."""

import math
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from tractive_sam.contact.model import Model
from tractive_sam.contact.step_result import StepInput, StepResult
from tractive_sam.contact.step_work import Particles
from tractive_sam.mechanics import FrictionLaw, WearConditions, WearLaw
from tractive_sam.operators import Advection
from tractive_sam.results import Status


@dataclass(frozen=True, eq=False)
class StepWear:
    """Wear of both bodies in one time step: the depths that sliding particles lose.

    Attributes
    ----------
    model : Model
        The scene in numbers.
    law : WearLaw
        The law of wear on its mesh.
    """

    model: Model
    law: WearLaw

    deepest: ClassVar[float] = 1.0
    """Allowed depth of a step over the elastic depth of a ripple as short as the elements."""

    def add_wear(
        self,
        inputs: StepInput,
        result: StepResult,
        advection: Advection,
        friction: FrictionLaw,
        groups: tuple[Particles, ...],
    ) -> StepResult:
        """Return the result of a step with the depths added that sliding particles lose, mm.

        Parameters
        ----------
        inputs : StepInput
            Prescribed quantities of the step.
        result : StepResult
            The step, with the depths before it.
        advection : Advection
            Distance that its particles moved.
        friction : FrictionLaw
            The friction law of the step.
        groups : tuple of Particles
            The particles with tractions that do work.
        """
        gained, deep = np.zeros_like(result.worn), 0.0
        law = self.law.with_friction(friction).weakened(inputs.mean_friction)
        law = law.under(WearConditions(result.contact.wear, math.nan))
        if not advection.length:
            groups = tuple(self._with_last_traction(result, group) for group in groups)
        for group in groups:
            depth = self._depths(inputs, group, law)
            deep = max(deep, self._relative_depth(group.pressure, depth))
            gained += group.weight * (advection.move_depths(depth) if group.earlier else depth)
        worn = result.worn + gained
        contact = replace(result.contact, wear=self.model.add_initial_wear(worn.sum(axis=0)))
        if deep > 1.0:
            note = (
                "the wear of a step is too deep for the pressure to follow: lower transient.step "
                "or wear.intensity (wear.coefficient)"
            )
            contact = replace(contact, status=Status.OUT_OF_ITERATIONS, note=note)
        return replace(result, contact=contact, worn=worn, gained=gained, deep=deep)

    def _with_last_traction(self, result: StepResult, particles: Particles) -> Particles:
        """Return particles with the last traction of the shift, scaled to the pressure of each.

        They slip with that traction. If it turned in the shift, the mean traction does not oppose
        the slip.
        """
        last, pressure = result.contact.pressure, particles.pressure
        share = np.divide(pressure, last, out=np.zeros_like(last), where=last > 0.0)
        fields = self.model.scaled_fields(result.contact)
        return replace(particles, fields=np.where(last > 0.0, share * fields, particles.fields))

    def _depths(self, inputs: StepInput, particles: Particles, law: WearLaw) -> np.ndarray:
        """Return the depths that particles lose in a step from A and B, shape (2, n_x, n_y), mm.

        They follow from the pressure, the traction and the slip of each particle. A law that
        depends on the work of friction wears exactly by `StepResult.friction` if the bodies roll. A
        shift wears as if it rolled the length of an element, which matters only to a law that is
        not linear in the slip.
        """
        model, units = self.model, self.model.units
        distance = inputs.distance or model.grid.dx
        slipped = particles.wearing * particles.slip
        slip = units.slip * model.grid.dx / distance * model.frame.slip_to_physical(slipped)
        traction = units.pressure * model.frame.to_physical(particles.traction)
        return distance * law.rates(model.scene.wear_share, particles.pressure, traction, slip)

    def _relative_depth(self, pressure: np.ndarray, gained: np.ndarray) -> float:
        """Return the largest ratio of a step's wear to its stable limit; ripples grow above 1.

        The gap of a step contains the wear w' = 2 w_1 - w_2 that is extrapolated from one (w_1) and
        two (w_2) steps before. Pressure responds to a ripple of it by its stiffness. The mean
        pressure of a step then wears w = w_1 - r (w' + w_1')/2, with r the depth of a step over the
        elastic depth of the ripple: beyond r = 1.15 ripples grow.
        """
        units, operators = self.model.units, self.model.operators
        elastic = operators.ripple_compliance * units.gap * pressure / units.pressure
        worn = gained.sum(axis=0)
        return float(np.max(worn[worn > 0.0] / (self.deepest * elastic[worn > 0.0]), initial=0.0))
