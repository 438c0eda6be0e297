"""An observer of another package: the energy of friction, added up over all steps.

It uses public names only, and is installed as a module beside tractive_sam by its test.
"""

from dataclasses import dataclass, replace

import numpy as np

import tractive_sam as ts


@dataclass(frozen=True, eq=False)
class FrictionEnergy(ts.Observer):
    """Energy of friction per area of the contact, added up over the distance rolled."""

    length: float = 1.0  # mm rolled in a unit of the coordinate: of revolutions the circumference
    place: float = 0.0  # of the last step
    rate: np.ndarray | None = None  # energy per distance and area in it, shape (n_x, n_y), N/mm2
    energy: np.ndarray | None = None  # so far, shape (n_x, n_y), mJ/mm2

    name = "friction_energy"
    kept = ("place", "rate", "energy")  # to resume
    columns = (
        ts.Quantity("energy_max", "mJ/mm2", "largest energy of friction per area"),
        ts.Quantity("energy_profile", "mJ/mm", "energy of friction per width", dims=("y",)),
    )
    fields = (ts.Quantity("energy", "mJ/mm2", "energy of friction per area of the contact"),)

    def begin(self, step, model):
        none = np.zeros(step.grid.elements)
        return replace(self, place=step.place, rate=_rate(step), energy=none)

    def after(self, step, model):
        rate, distance = _rate(step), (step.place - self.place) * self.length
        if model.scene.schedule.shifts:
            distance = 1.0  # the slip of a shift is in mm, and not per distance
        mean = 0.5 * (_widened(self.rate, rate.shape) + rate)
        energy = _widened(self.energy, rate.shape) + distance * mean
        return replace(self, place=step.place, rate=rate, energy=energy)

    def record(self, model, recorded):
        profile = self.energy.sum(axis=0) * model.grid.dx
        return {"energy_max": float(self.energy.max()), "energy_profile": profile}

    def record_fields(self, block):
        return {"energy": self.energy}


def _rate(step):
    """Return the energy of friction per distance and area, of blocks by their shares, N/mm2."""
    each = zip(step.weights, step.contacts, strict=True)
    return sum(share * -(one.traction * one.slip).sum(axis=0) for share, one in each)


def _widened(values, shape):
    """Return values on a mesh with equally many more elements on each side; zero there."""
    return np.pad(values, [((n - m) // 2,) * 2 for n, m in zip(shape, values.shape, strict=True)])


@ts.plot.history_figure("friction-energy", columns=["energy_max"])
def friction_energy(history):
    """Energy of friction per width across the track, at the end."""
    figure = ts.plot.Figure()
    axes = figure.add_subplot(xlabel="$y$ (mm)", ylabel="energy of friction (mJ/mm)")
    axes.plot(history.y, history["energy_profile"][-1])
    return figure
