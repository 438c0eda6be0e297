"""Balances of a history: work that friction dissipates and supplied work, worn volume and work.

Steady contacts balance per distance rolled; steps of a course balance with what the bodies store.
Which of them a history has is seen from its columns.
"""

from typing import ClassVar

import numpy as np

from tractive_sam.results.law_record import UNNAMED
from tractive_sam.results.recorded import Recorded

ROUNDING = 1e-12
"""Share of the terms of a sum that its rounding may reach."""


class SteadyBalance:
    """Balances of records of steady rolling.

    Parameters
    ----------
    history : Recorded
        All records.
    """

    dissipated: ClassVar[str] = "friction dissipates"
    """What the energy balance compares with the work supplied."""
    worn: ClassVar[str] = "section"
    """What the wear balance compares with what the work wears."""

    def __init__(self, history: Recorded):
        self.history = history

    @property
    def energy(self) -> np.ndarray:
        """Dissipated over supplied work of every record, shape (n,)."""
        history = self.history
        supplied = history["work_supplied"]
        rounding = ROUNDING * history["P"] * np.abs(history["approach"])
        driven = np.abs(supplied) > rounding / history.grid.half_length[0]
        return _ratio(history["dissipation"], supplied, driven & history.scene.has("friction"))

    @property
    def wear(self) -> np.ndarray:
        """What is worn over what the work of friction wears, of every record, shape (n,)."""
        history = self.history
        most = history["wear_max"] * 2.0 * history.grid.half_length[1]
        return self._worn_by_work(history["worn_area"], history["dissipation"], most)

    @property
    def wear_overall(self) -> np.ndarray:
        """The wear balances by which the history is judged, shape (m,)."""
        return self.wear

    def _worn_by_work(self, worn: np.ndarray, work: np.ndarray, most: np.ndarray) -> np.ndarray:
        """Worn over what the work wears; `most` is all the wear, which leaves its rounding."""
        per_work = self._wear_per_work
        if per_work is None:
            return np.full(len(worn), np.nan)
        least, largest = sorted(per_work)
        wears = (worn > ROUNDING * most) & (work > 0.0)
        return _ratio(worn, np.clip(worn, least * work, largest * work), wears)

    @property
    def _wear_per_work(self) -> tuple[float, float] | None:
        """Wear per work along both axes, 1/MPa; None where one number does not tell it."""
        scene = self.history.scene
        changing = ("wear.temperature", "duty", "transient.friction.mu")
        replaced = not {"wear", UNNAMED}.isdisjoint(self.history.law_records)
        if not scene.has("wear") or replaced or any(map(scene.has, changing)):
            return None
        return None if scene.friction.varies else scene.wear.per_work(scene.friction.mu)

    @property
    def energy_cure(self) -> str:
        """What may have opened the energy balance."""
        if self.history.scene.solver.slip == "upwind":
            return ': the upwind slip of the paper does that, solver.slip = "auto" does not'
        return ""

    @property
    def wear_cure(self) -> str:
        """What closes the wear balance."""
        return "more elements across the contact bring"


class StepBalance(SteadyBalance):
    """Balances of the steps of a course, in which the bodies store elastic energy."""

    dissipated = "friction dissipates and the bodies store"
    worn = "volume"

    @property
    def energy(self) -> np.ndarray:
        """See `SteadyBalance.energy`."""
        history = self.history
        stored, supplied = history["elastic_energy"], history["step_work"]
        gained = np.diff(stored, prepend=np.nan)
        driven = np.abs(supplied) > 1e-6 * np.abs(stored)
        return _ratio(history["step_friction"] + gained, supplied, driven)

    @property
    def wear(self) -> np.ndarray:
        """See `SteadyBalance.wear`."""
        history = self.history
        if "step_worn" not in history.columns:
            return np.full(len(history), np.nan)
        most = history["worn_volume"].sum(axis=1)
        return self._worn_by_work(history["step_worn"], history["step_friction"], most)

    @property
    def wear_overall(self) -> np.ndarray:
        """The balance of all steps together, one number or none.

        Shifts wear by their work only as their steps become small.
        """
        balance = self.wear
        known = np.isfinite(balance) & (balance > 0.0)
        if not known.any():
            return np.zeros(0)
        worn = self.history["step_worn"][known]
        return np.array([worn.sum() / (worn / balance[known]).sum()])

    @property
    def energy_cure(self) -> str:
        """See `SteadyBalance.energy_cure`."""
        return "; material leaves the mesh under load: use a longer grid.half_length"

    @property
    def wear_cure(self) -> str:
        """See `SteadyBalance.wear_cure`."""
        scene = self.history.scene
        if scene.schedule.shifts:
            return "a shorter transient.step brings"
        if scene.solver.slip == "upwind":
            return 'solver.slip = "auto" or more elements across the contact bring'
        return super().wear_cure


def balance_of(history: Recorded) -> SteadyBalance:
    """Return the balances that a history has."""
    return (StepBalance if "step_work" in history.columns else SteadyBalance)(history)


def _ratio(over: np.ndarray, under: np.ndarray, where: np.ndarray) -> np.ndarray:
    """Quotients, nan elsewhere."""
    return np.divide(over, under, out=np.full(len(over), np.nan), where=where)
