"""The records of one block of a duty cycle."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tractive_sam.results.cycle import PREFIX
from tractive_sam.results.law_record import LawRecord
from tractive_sam.results.recorded import Recorded, Rows
from tractive_sam.scene import Scene
from tractive_sam.schema import required


def attributes_of_block(history: Recorded, k: int) -> dict[str, Any]:
    """Return the attributes in which the history of block k (from 0) differs from the full one."""
    scene = history.scene
    columns = {name: c for name, c in history.columns.items() if "block" not in c.dims}
    values = {}
    for name in columns:
        each = history.values.get(PREFIX + name)
        values[name] = history.values[name] if each is None else each[:, k]
    return {
        "scene": scene.blocks[k],
        "grid": history.grid.shifted(scene.duty[k].shift_y),
        "columns": columns,
        "values": values,
        "fields": {name: _BlockRows(rows, k) for name, rows in history.fields.items()},
        "stresses": history.stresses_of_blocks[k] if history.stresses_of_blocks else {},
        "stresses_of_blocks": (),
        "law_records": _law_records_of(history, scene.blocks[k]),
    }


def _law_records_of(history: Recorded, block: Scene) -> dict[str, LawRecord]:
    """Return the replaced laws of one block; a named friction law has the block's coefficients.

    A law that replaced the one of the scene is common to all blocks.
    """
    records, friction = dict(history.law_records), history.scene.friction
    record = records.get("friction")
    if record and friction and friction.named_law and record.frame == friction.frame:
        records["friction"] = replace(record, frame=required(block.friction, "friction").frame)
    return records


@dataclass(frozen=True, eq=False)
class _BlockRows:
    """Sequence of the fields of one block, a view of the fields of all blocks."""

    rows: Rows[np.ndarray]
    block: int

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, row: int) -> np.ndarray:
        return self.rows[row][self.block]
