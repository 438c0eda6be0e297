"""Balances of a history: work that friction dissipates and supplied work, worn volume and work.

Contacts in steady rolling balance per distance rolled; steps of a course balance together with the
elastic energy stored in the bodies. The columns of a history determine its kind of balance.
"""

from typing import ClassVar

import numpy as np

from tractive_sam.results.history_data import HistoryData
from tractive_sam.results.law_record import UNNAMED
from tractive_sam.scene import Scene
from tractive_sam.schema import required


class SteadyBalance:
    """Balances of work and of wear in the records of steady rolling.

    Parameters
    ----------
    history : HistoryData
        All records.
    """

    rounding = 1e-12
    """Share of the terms of a sum that its rounding may reach."""

    dissipated: ClassVar[str] = "friction dissipates"
    """Quantity that the energy balance compares with the supplied work."""
    worn: ClassVar[str] = "section"
    """Quantity that the wear balance compares with the wear that the work of friction causes."""

    def __init__(self, history: HistoryData):
        self.history = history

    @property
    def energy(self) -> np.ndarray:
        """Ratio of dissipated to supplied work in each record, shape (n,); nan without work.

        It is 1 without numerical error, and nan without friction, or if no work is supplied.
        """
        history = self.history
        supplied = history["work_supplied"]
        rounding = self.rounding * history["P"] * np.abs(history["approach"])
        driven = np.abs(supplied) > rounding / history.grid.half_length[0]
        return _ratio(history["dissipation"], supplied, driven & history.scene.has("friction"))

    @property
    def wear(self) -> np.ndarray:
        """Ratio of wear to the wear expected from frictional work, (n,); nan if unknown."""
        history = self.history
        largest = history["wear_max"] * 2.0 * history.grid.half_length[1]
        return self._worn_by_work(history["worn_area"], history["dissipation"], largest)

    @property
    def wear_overall(self) -> np.ndarray:
        """Wear balances by which the wear of a history is judged: `wear` of each record."""
        return self.wear

    def _worn_by_work(self, worn: np.ndarray, work: np.ndarray, total: np.ndarray) -> np.ndarray:
        """Return wear over the nearest wear that `work` allows; nan if unknown or rounding."""
        per_work = self._wear_per_work
        if per_work is None:
            return np.full(len(worn), np.nan)
        low, high = sorted(per_work)
        wears = (worn > self.rounding * total) & (work > 0.0)
        return _ratio(worn, np.clip(worn, low * work, high * work), wears)

    @property
    def _wear_per_work(self) -> tuple[float, float] | None:
        """Wear depth per frictional work along both axes, 1/MPa; None if not constant."""
        scene = self.history.scene
        changing = "friction.mu" in scene.schedule.courses
        changing = changing or scene.has("wear.temperature") or scene.has("duty")
        return None if changing else self._wear_per_work_of(scene)

    def _wear_per_work_of(self, scene: Scene) -> tuple[float, float] | None:
        """Return the wear depth per frictional work of one block; None if not constant."""
        replaced = not {"wear", UNNAMED}.isdisjoint(self.history.law_records)
        friction, wear = scene.friction, scene.wear
        if friction is None or wear is None or replaced or friction.varies:
            return None
        return wear.per_work(friction.mu)

    @property
    def energy_cure(self) -> str:
        """End of a message: possible reason of an error of the energy balance; may be empty."""
        if self.history.scene.solver.slip == "upwind":
            return ': the upwind slip of the paper does that, solver.slip = "auto" does not'
        return ""

    @property
    def wear_cure(self) -> str:
        """Beginning of a message: remedy for an error of the wear balance."""
        return "more elements across the contact bring"


class StepBalance(SteadyBalance):
    """Balances of work and wear in the steps of a transient, which store elastic energy."""

    dissipated = "friction dissipates and the bodies store"
    worn = "volume"

    @property
    def energy(self) -> np.ndarray:
        """Ratio of dissipated plus stored to supplied work in each step, (n,); first nan.

        See `SteadyBalance.energy`.
        """
        history = self.history
        stored, supplied = history["elastic_energy"], history["step_work"]
        gained = np.diff(stored, prepend=np.nan)
        driven = np.abs(supplied) > 1e-6 * np.abs(stored)
        return _ratio(history["step_friction"] + gained, supplied, driven)

    @property
    def wear(self) -> np.ndarray:
        """Ratio of wear in each step to the wear expected from its work, (n,); nan if unknown."""
        history = self.history
        if "step_worn" not in history.columns:
            return np.full(len(history), np.nan)
        total = history["worn_volume"].sum(axis=1)
        return self._worn_by_work(history["step_worn"], history["step_friction"], total)

    @property
    def wear_overall(self) -> np.ndarray:
        """Wear balance of all steps together, shape (1,); shape (0,) without wear.

        The wear of shifts is proportional to their work only in the limit of small steps.
        """
        balance = self.wear
        finite = np.isfinite(balance) & (balance > 0.0)
        if not finite.any():
            return np.zeros(0)
        worn = self.history["step_worn"][finite]
        return np.array([worn.sum() / (worn / balance[finite]).sum()])

    @property
    def energy_cure(self) -> str:
        """End of a message: possible reason of an error of the energy balance."""
        return "; material leaves the mesh under load: use a longer grid.half_length"

    @property
    def wear_cure(self) -> str:
        """Beginning of a message: remedy for an error of the wear balance."""
        scene = self.history.scene
        if scene.schedule.shifts:
            return "a shorter transient.step brings"
        if scene.solver.slip == "upwind":
            return 'solver.slip = "auto" or more elements across the contact bring'
        return super().wear_cure


class ProfileBalance(SteadyBalance):
    """Balances of worn profiles: the wear since they were new, at all positions together."""

    @property
    def wear(self) -> np.ndarray:
        """Ratio of worn sections to those expected from frictional work, (n,); nan if unknown."""
        scene = self.history.scene
        share, passes = scene.wear_share, required(scene.rail, "rail").passes_per_revolution
        sections = self.history["worn_section"].sum(axis=1) / (share["A"] + passes * share["B"])
        return self._worn_by_work(sections, self.history["profile_work"], sections)

    @property
    def _wear_per_work(self) -> tuple[float, float] | None:
        """Wear depth per frictional work along both axes, 1/MPa; None if positions differ."""
        scene = self.history.scene
        each = {self._wear_per_work_of(local) for local in scene.blocks}
        return each.pop() if len(each) == 1 and not scene.has("wear.temperature") else None

    @property
    def wear_cure(self) -> str:
        """Beginning of a message: remedy for an error of the wear balance."""
        return "a smaller wear.tolerance, or more elements across the contact, bring"


def balance_of(history: HistoryData) -> SteadyBalance:
    """Return the balances of a history: of a transient, of worn profiles, or of steady rolling."""
    if "step_work" in history.columns:
        return StepBalance(history)
    return (ProfileBalance if "profile_work" in history.columns else SteadyBalance)(history)


def _ratio(over: np.ndarray, under: np.ndarray, where: np.ndarray) -> np.ndarray:
    """Return over / under where a mask is true, and nan elsewhere."""
    return np.divide(over, under, out=np.full(len(over), np.nan), where=where)
