"""The data of a history: columns, fields and laws, and the contact of one of its records."""

import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any, Self

import numpy as np

from tractive_sam.mechanics import Frame
from tractive_sam.results.column_table import PACKAGE_FIELDS
from tractive_sam.results.grid import Grid
from tractive_sam.results.heat import FlashTemperature
from tractive_sam.results.quantity import (
    BODIES,
    COORDINATE,
    PREFIX,
    Quantity,
    Rows,
    TableRows,
    View,
    find_by_role,
)
from tractive_sam.results.state import BOUND, Cost, State, Status
from tractive_sam.results.stress import BodyFatigue, InclusionPassage, PlaneStress
from tractive_sam.scene import Scene, block_label
from tractive_sam.schema import required

UNNAMED = "laws"
"""Name of the only record of a file that was written before laws had fingerprints."""


@dataclass(frozen=True)
class LawRecord:
    """Name, hash and frame of a user-defined law that replaced the law of the scene.

    Attributes
    ----------
    text : str
        Name and parameters of the law, for readers.
    fingerprint : str
        Hash of its content (`mechanics.law`); empty if the file lacks it.
    frame : Frame, optional
        For a friction law: coefficients and axes in which its tractions are measured.
    """

    text: str
    fingerprint: str = ""
    frame: Frame | None = None


def describe_laws(records: Mapping[str, LawRecord]) -> str:
    """Return user-defined laws as text, "friction=..., wear=..."; empty if none was replaced."""
    return ", ".join(
        law.text if name == UNNAMED else f"{name}={law.text}" for name, law in records.items()
    )


def dump_laws(records: Mapping[str, LawRecord]) -> str:
    """Return records of user-defined laws as JSON."""
    return json.dumps(
        {
            name: {
                "text": law.text,
                "fingerprint": law.fingerprint,
                "frame": None if law.frame is None else [*law.frame.mu, law.frame.angle],
            }
            for name, law in records.items()
        }
    )


def load_laws(text: str, line: str = "") -> dict[str, LawRecord]:
    """Return records of user-defined laws from JSON; without JSON, from their line of text.

    Raises
    ------
    ValueError
        If the JSON is not what `dump_laws` writes.
    """
    if not text:
        return {UNNAMED: LawRecord(line)} if line else {}
    try:
        return {
            str(name): LawRecord(str(law["text"]), str(law["fingerprint"]), _frame(law["frame"]))
            for name, law in json.loads(text).items()
        }
    except (AttributeError, KeyError, TypeError) as error:
        raise ValueError(f"laws: {error!r}") from None


def _frame(numbers: list[float] | None) -> Frame | None:
    """Return a frame from its two coefficients and its angle; None if there are none."""
    if numbers is None:
        return None
    first, second, angle = map(float, numbers)
    return Frame((first, second), angle)


RENAMED_COLUMNS = {"wear_rate": "worn_area"}
"""Current names of renamed columns."""


@dataclass(frozen=True, eq=False)
class HistoryData:
    """The data of a `History`, which documents them, and the access to its columns and blocks."""

    scene: Scene
    status: str
    message: str
    grid: Grid
    columns: Mapping[str, Quantity]
    values: Mapping[str, np.ndarray]
    tables: Mapping[str, TableRows]
    saved: np.ndarray
    provenance: tuple[tuple[int, Mapping[str, str]], ...] = ()
    law_records: Mapping[str, LawRecord] = field(default_factory=dict)
    started: str = ""
    measured: str = ""
    datum: str = "vertex"
    block_index: int | None = None

    def __len__(self) -> int:
        return len(self.values[self.coordinate.name])

    def __getitem__(self, name: str) -> np.ndarray:
        """Return the values of a column, one row a record.

        Raises
        ------
        KeyError
            If the column does not exist; the message lists all columns.
        """
        if name in self.values:
            return self.values[name]
        new = RENAMED_COLUMNS.get(name)
        cure = f"; it is now called history[{new!r}]" if new else ""
        if name in self.fields:
            cure = f"; the field is history.field({name!r})"
        raise KeyError(f"no quantity {name!r}{cure}; there are {', '.join(self.values)}")

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names of the columns, as those of a DataFrame."""
        return iter(self.values)

    def __contains__(self, name: object) -> bool:
        return name in self.values

    @cached_property
    def fields(self) -> Mapping[str, Rows[np.ndarray]]:
        """Fields over x and y by name: a sequence with one array a stored record, read on access.

        Of a duty cycle over (block, x, y).
        """
        table = self.tables["fields"]
        return {
            name: View(len(table), partial(self._read_field, name)) for name in table.quantities
        }

    def _read_field(self, name: str, row: int) -> np.ndarray:
        """Return a field of a stored record, of one block if this is the history of a block."""
        values = self.tables["fields"].read(name, row)
        return values if self.block_index is None else values[self.block_index]

    @cached_property
    def user_fields(self) -> dict[str, Quantity]:
        """Descriptions of user-defined fields."""
        stored = self.tables["fields"].quantities
        return {name: stored[name] for name in stored if name not in PACKAGE_FIELDS}

    @cached_property
    def stresses(self) -> dict[tuple[str, str], Rows[PlaneStress]]:
        """Stress by body and plane: a sequence with one `PlaneStress` a stored record.

        A duty cycle has them in `stresses_of_blocks`.
        """
        return self._stresses_of(self.block_index)

    @cached_property
    def stresses_of_blocks(self) -> tuple[dict[tuple[str, str], Rows[PlaneStress]], ...]:
        """For a duty cycle: the `stresses` of each block."""
        return tuple(self._stresses_of(k) for k in range(len(self.block_names)))

    @cached_property
    def passages(self) -> dict[tuple[str, str], Rows[InclusionPassage]]:
        """Passages by body and inclusion: a sequence with one a stored record; blocks have them."""
        return self._rows_of("passage", InclusionPassage, self.block_index)

    def _stresses_of(self, block: int | None) -> dict[tuple[str, str], Rows[PlaneStress]]:
        """Return the stress by body and plane, of one block of a duty cycle."""
        return self._rows_of("stress", PlaneStress, block)

    def _rows_of(self, kind: str, of: Any, block: int | None) -> dict[tuple[str, str], Any]:
        """Return the tables below a group as objects by body and name, of one block of a cycle."""
        start, found = f"{kind}/" if block is None else f"{kind}/block-{block}/", {}
        for path, rows in self.tables.items():
            body, _, name = path.removeprefix(start).partition("/")
            if path.startswith(start) and body in BODIES:
                read = partial(of.from_table, rows, body, name, block)
                found[body, name] = View(len(rows), read)
        return found

    @cached_property
    def cycles(self) -> dict[str, Rows[BodyFatigue]]:
        """Fatigue of each body: a sequence with one `BodyFatigue` a stored record."""
        table, start = self.scene.fatigue, "fatigue/"
        k = None if table is None else table.shear_yield_stress
        cycles: dict[str, Rows[BodyFatigue]] = {}
        for path, rows in self.tables.items():
            if path.startswith(start):
                body, shear_yield = path.removeprefix(start), math.nan if k is None else k
                read = partial(BodyFatigue.from_table, rows, body, shear_yield)
                cycles[body] = View(len(rows), read)
        return cycles

    def of_dims(self, *dims: str) -> dict[str, Quantity]:
        """Return the columns with just these dimensions, as "body"; without any, scalars."""
        return {name: column for name, column in self.columns.items() if column.dims == dims}

    def of_role(self, role: str) -> Quantity:
        """Return the column that has a role, as "coordinate"; its name may be user-defined.

        Raises
        ------
        LookupError
            If no column has this role.
        """
        return find_by_role(self.columns.values(), role)

    @property
    def coordinate(self) -> Quantity:
        """Column by which the records are ordered: "revolution", "distance" or user-defined."""
        return self.of_role(COORDINATE)

    @property
    def title(self) -> str:
        """Title of the scene; may be empty."""
        return self.scene.title

    @property
    def a0(self) -> float:
        """Semi-axis in x of the unworn contact by Hertz, mm; nan if Hertz does not apply."""
        return math.nan if self.scene.hertz is None else self.scene.hertz.a

    @property
    def b0(self) -> float:
        """Semi-axis in y of the unworn contact by Hertz, mm; nan if Hertz does not apply."""
        return math.nan if self.scene.hertz is None else self.scene.hertz.b

    @property
    def p0(self) -> float:
        """Peak pressure of the unworn contact by Hertz, MPa; nan if Hertz does not apply."""
        return math.nan if self.scene.hertz is None else self.scene.hertz.p0

    @property
    def bodies(self) -> tuple[str, ...]:
        """Bodies with computed stress, of "A" and "B"; none without [subsurface]."""
        return () if self.scene.subsurface is None else tuple(self.scene.subsurface.bodies)

    @property
    def laws(self) -> str:
        """User-defined laws that replaced laws of the scene, in one line of text; may be empty."""
        return describe_laws(self.law_records)

    @property
    def frame(self) -> Frame | None:
        """Scaled tribological frame of the friction law; None without friction."""
        if (record := self.law_records.get("friction")) is not None:
            return record.frame
        return None if self.scene.friction is None else self.scene.friction.frame

    @property
    def totals(self) -> dict[str, float]:
        """Sums over all records: "contact_solves" and "wall_seconds"."""
        return {
            "contact_solves": int(np.nansum(self["solves"])),
            "wall_seconds": float(np.nansum(self["seconds"])),
        }

    @property
    def block_names(self) -> list[str]:
        """Names of the blocks of a duty cycle, in order; empty without blocks."""
        return [block_label(self.scene, k) for k in range(len(self.scene.duty))]

    def block(self, which: int | str) -> Self:
        """Return the records of one block of a duty cycle as a separate history.

        Profiles and worn volumes belong to the bodies, which all blocks wear.

        Parameters
        ----------
        which : int or str
            Index of the block in the [[duty]] of the scene, from 0, or its name. A text that is no
            name may be an index.

        Raises
        ------
        LookupError
            If the block does not exist.

        Examples
        --------
        >>> blocks = ({"revolutions": 1}, {"revolutions": 1, "load": {"normal": 200.0}})
        >>> spectrum = ts.roll(discs.replace(duty=blocks))
        >>> light = spectrum.block(1)
        >>> round(float(light["P"][-1])), light.state(2).scene.load.normal
        (200, 200.0)
        """
        k, values = self.place_of(which), {}
        columns = {name: c for name, c in self.columns.items() if "block" not in c.dims}
        for name in columns:
            each = self.values.get(PREFIX + name)
            values[name] = self.values[name] if each is None else each[:, k]
        return replace(
            self,
            scene=self.scene.blocks[k],
            grid=self.grid.shifted(self.scene.duty[k].shift_y),
            columns=columns,
            values=values,
            block_index=k,
            law_records=self._law_records_of(self.scene.blocks[k]),
        )

    def _law_records_of(self, block: Scene) -> dict[str, LawRecord]:
        """Return the replaced laws of one block; a named friction law has its coefficients.

        A law that replaced the one of the scene is common to all blocks.
        """
        records, friction = dict(self.law_records), self.scene.friction
        record = records.get("friction")
        if record and friction and friction.named_law and record.frame == friction.frame:
            frame = required(block.friction, "friction").frame
            records["friction"] = replace(record, frame=frame)
        return records

    def place_of(self, which: int | str) -> int:
        """Return the index of a block in the [[duty]] of the scene, from its index or its name.

        Raises
        ------
        LookupError
            If the block does not exist.

        Examples
        --------
        >>> blocks = ({"revolutions": 1}, {"name": "light", "revolutions": 1})
        >>> ts.roll(discs.replace(duty=blocks)).place_of("light")
        1
        """
        names = self.block_names
        places = {convert(k): k for convert in (int, str) for k in range(len(names))}
        k = (places | {name: names.index(name) for name in names}).get(which)
        if k is None:
            listed = f"counted from 0: {', '.join(names)}" if names else "add [[duty]]"
            raise LookupError(f"no block {which}; there are {len(names)}, {listed}")
        return k


def contact_of(history: HistoryData, row: int, fields: Mapping[str, np.ndarray]) -> State:
    """Return the contact (`State`) of a record, given its fields by the names of `FIELDS`."""
    number = {name: float(history[name][row]) for name in history.of_dims()}
    creeping = sum(
        number[force] * number[creepage]
        for force, creepage in (("Qx", "xi_x"), ("Qy", "xi_y"), ("Mz", "spin"))
    )
    solved = number["converged"] > 0.0
    failure = history.status if history.status in set(Status) else Status.OUT_OF_ITERATIONS
    bound = fields.get(BOUND.name)
    cost = (number[name] for name in ("convolutions", "over_application"))
    contact = State(
        scene=history.scene,
        grid=history.grid,
        pressure=fields["pressure"],
        traction=np.stack((fields["traction_x"], fields["traction_y"])),
        slip=np.stack((fields["slip_x"], fields["slip_y"])),
        gap=fields.get("gap", np.full(history.grid.elements, np.nan)),
        wear=fields["wear"],
        approach=number["approach"],
        xi_x=number["xi_x"],
        tilt=number.get("tilt", 0.0),
        xi_y=number["xi_y"],
        spin=number["spin"],
        rolling_resistance=number["work_supplied"] + creeping,
        sliding=fields.get("sliding", np.zeros(history.grid.elements)) > 0.0,
        status=Status.CONVERGED if solved else Status(failure),
        note="" if solved else history.message,
        residual=number["residual"],
        # Applications of preconditioners are not stored.
        cost=Cost(number["operator_applications"], 0.0, *cost),
        revolution=int(number.get("revolution", 0)),
        volumes=_per_body(history, "worn_volume", row),
        bulk_dissipation=_per_body(history, "bulk_dissipation", row) or {},
        frame=history.frame,
        traction_bound=None if bound is None or np.isnan(bound).any() else bound,
        laws=history.law_records,
    )
    if {"heat_into_A", "temperature_A", "temperature_B"} <= fields.keys():
        into_A = fields["heat_into_A"]
        speed = required(history.scene.creepage.speed, "creepage.speed")
        heat = -speed * (contact.traction * contact.slip).sum(axis=0)
        warm = {"A": fields["temperature_A"], "B": fields["temperature_B"]}
        flux = {"A": into_A, "B": heat - into_A}
        temperatures = FlashTemperature(history.grid, contact.touching, warm, flux)
        contact = replace(contact, heat=temperatures)
    return contact if "sliding" in fields else contact.with_sliding_by_traction()


def _per_body(history: HistoryData, name: str, row: int) -> dict[str, float] | None:
    """Return a quantity of each body in a record; None if it was not recorded."""
    values = history.values.get(name)
    return None if values is None else dict(zip(BODIES, values[row].tolist(), strict=True))
