"""A process of another package: an indexing drive that rolls forth, stops, rolls back, and wears.

It uses public names only, and is installed as a module beside tractive_sam by its test.
"""

from dataclasses import dataclass, replace

import numpy as np

import tractive_sam as ts


@dataclass(frozen=True, eq=False)
class Stroke(ts.Step):
    """The contact of a stroke, and the depth with which the next one begins."""

    number: int
    depth: np.ndarray  # (n_y,), mm
    worn_area: float  # mm2

    @property
    def place(self):
        return self.number

    @property
    def own_state(self):
        return {"depth": self.depth}

    def on(self, grid):
        more = (grid.elements[1] - self.depth.size) // 2
        contacts = tuple(contact.on(grid) for contact in self.contacts)
        return replace(self, contacts=contacts, depth=np.pad(self.depth, more))

    def record(self, block=None):
        values = {"stroke": self.number, "track_depth": float(self.depth.max())}
        values["worn_area"] = self.worn_area  # the contact alone does not know it
        return ts.StepRecord(self.contact, values)


class IndexingDrive(ts.Process):
    """Rolls forth in odd strokes and back in even ones; every stroke wears one track."""

    columns = (
        ts.Quantity("stroke", "1", "strokes", format="d", whole=True, role="coordinate"),
        ts.Quantity("track_depth", "mm", "largest depth of the track, both bodies together"),
    )

    def __init__(self, model, passes: int = 1):
        super().__init__(model)
        self.passes = passes

    @property
    def parameters(self):
        return {"passes": self.passes}

    @classmethod
    def expected_records(cls, scene, dx):
        return 1 + int(scene.schedule.end)

    def begin(self):
        return self._stroke(0, np.zeros(self.model.grid.elements[1]))

    def advance(self, last):
        while last.converged and last.number < self.model.scene.schedule.end:
            last = self._stroke(last.number + 1, last.depth)
            yield last

    @classmethod
    def restore(cls, scene, stored):
        number, worn_area = (stored.history[name][stored.row] for name in ("stroke", "worn_area"))
        return Stroke((stored.contact(scene),), int(number), stored.state["depth"], worn_area)

    def _stroke(self, number, depth):
        scene, grid = self.model.scene, self.model.grid
        creepage = scene.creepage.longitudinal * (-1.0 if number % 2 == 0 else 1.0)
        now = scene.replace(**{"creepage.longitudinal": creepage if number else 0.0})
        contact = ts.solve(now, wear=np.tile(depth, (grid.elements[0], 1)), throw=False)
        law, worn_area = ts.Laws.of(scene).wear, 0.0
        if law is not None and number and contact.converged:
            fields = contact.pressure, contact.traction, contact.slip
            worn = law.on(grid.element_area).depth(depth, *fields, grid.dx)[0] - depth
            worn_area, depth = worn.sum() * grid.dy, depth + self.passes * worn
        return Stroke((contact,), number, depth, worn_area)
