"""The whole of a computation: every record, in memory or still on disk."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from typing import Any, Protocol, Self, TypeVar

import numpy as np

from tractive_sam.description import text_table
from tractive_sam.extras import check_extra
from tractive_sam.mechanics import Frame
from tractive_sam.optional import pandas, xarray
from tractive_sam.results.balance import balance_of
from tractive_sam.results.column_table import PARTS, STRESSES, columns
from tractive_sam.results.cycle import PREFIX
from tractive_sam.results.describe import summarize_history
from tractive_sam.results.fatigue import BodyFatigue
from tractive_sam.results.figure_table import html_with_figure
from tractive_sam.results.grid import Grid, widened
from tractive_sam.results.heat import FlashTemperature
from tractive_sam.results.law_record import LawRecord, describe_laws
from tractive_sam.results.plane_stress import PlaneStress
from tractive_sam.results.quantity import BODIES, COORDINATE, Quantity, of_role
from tractive_sam.results.record import Record
from tractive_sam.results.state import State
from tractive_sam.results.status import Cost, Status
from tractive_sam.results.stored_fields import BOUND, FIELDS, OUTSIDE, WARM, kept_fields
from tractive_sam.scene import Scene, block_label

DONE = "done"
"""The `History.status` that means that nothing is missing."""

FORMER = {"wear_rate": "worn_area"}
"""Columns by their former names."""

LABELS = {"axis": ("x", "y"), "body": BODIES, "position": ("x", "y", "depth")}
"""What is along the dimensions of columns that are not of the mesh."""

BESIDE = ("a0", "b0", "p0", "energy_balance", "wear_balance", "contact_solves", "wall_seconds")
"""Numbers of `History.to_dict` that are no columns."""

T_co = TypeVar("T_co", covariant=True)


class Rows(Protocol[T_co]):
    """Fields of several records, read one at a time: a sequence, or something that reads a file."""

    def __len__(self) -> int:
        """Number of records with fields."""

    def __getitem__(self, row: int) -> T_co:
        """The field of one record."""


@dataclass(frozen=True, eq=False)
class History:
    """All records of a computation, under the names of `results.column_table`.

    Attributes
    ----------
    scene : Scene
        What was computed.
    status : str
        "done"; "running" of a computation that still runs or was killed; else why
        it ended early.
    message : str
        What the status means and, where something is wrong, what to try.
    grid : Grid
        The mesh.
    columns : mapping of str to Quantity
        What was recorded; `history[name]` has the numbers.
    values : mapping of str to ndarray
        One row a record, of the shape of the column's dimensions; nan where it is not known.
    fields : mapping of str to Rows, length m <= n
        One function of x and y for each record that kept its fields; see `field` and `state`.
    saved : ndarray, shape (m,)
        Values of the coordinate of these records, such as their revolutions.
    stresses : mapping of (body, plane) to Rows, length m
        Stress on planes for each record that kept its fields; see `stress`. Of a duty cycle each
        block has its own.
    provenance : tuple of (int, mapping of str to str)
        Programs that computed the records from each of these rows on.
    law_records : mapping of str to LawRecord
        Laws that replaced those of the scene, by "friction", "wear" and so on.
    started : str
        Where the worn bodies are from with which it began; empty of new ones.
    cycles : mapping of str to Rows, length m
        What rolling has done to each body that [fatigue] names, of each record that kept its
        fields; see `fatigue`.
    stresses_of_blocks : tuple of mapping
        Of a duty cycle: the `stresses` of each block.
    measured : str
        Hash of the numbers of the measured gap and profiles; empty without them.
    datum : str
        What the approach is counted from: "vertex", where the unworn bodies touch first, or "node",
        the nearest element, in results files of earlier versions.
    own_fields : mapping of str to Quantity
        Those of the fields that are not the package's.

    Examples
    --------
    >>> history["revolution"].tolist()
    [0, 1, 2]
    >>> history.field("pressure", revolution=2).shape
    (41, 121)
    >>> bool(history["wear_max"][-1] > history["wear_max"][0])
    True
    """

    scene: Scene
    status: str
    message: str
    grid: Grid
    columns: Mapping[str, Quantity]
    values: Mapping[str, np.ndarray]
    fields: Mapping[str, Rows[np.ndarray]]
    saved: np.ndarray
    stresses: Mapping[tuple[str, str], Rows[PlaneStress]]
    provenance: tuple[tuple[int, Mapping[str, str]], ...] = ()
    law_records: Mapping[str, LawRecord] = field(default_factory=dict)
    started: str = ""
    cycles: Mapping[str, Rows[BodyFatigue]] = field(default_factory=dict)
    stresses_of_blocks: tuple[Mapping[tuple[str, str], Rows[PlaneStress]], ...] = ()
    measured: str = ""
    datum: str = "vertex"
    own_fields: Mapping[str, Quantity] = field(default_factory=dict)

    @classmethod
    def of_records(
        cls,
        records: Iterable[Record],
        scene: Scene,
        grid: Grid,
        *,
        status: str = DONE,
        message: str = "",
        law_records: Mapping[str, LawRecord] | None = None,
        started: str = "",
    ) -> Self:
        """Collect records in memory; those of smaller meshes are widened to the last mesh."""
        records = list(records)
        kept = [record for record in records if record.fields]
        names = records[0].columns if records else columns(scene)
        coordinate = of_role(names.values(), COORDINATE)
        return cls(
            scene,
            status,
            message,
            grid,
            names,
            {
                name: stacked(one, [r.values[name] for r in records], grid)
                for name, one in names.items()
            },
            {
                name: [_field(record, name, grid) for record in kept]
                for name in ({k: None for one in kept for k in one.fields} if kept else FIELDS)
            },
            np.array([record.at for record in kept], int if coordinate.whole else float),
            _by_plane(kept),
            law_records=law_records or {},
            started=started,
            cycles=_by_body(kept),
            stresses_of_blocks=tuple(_by_plane(kept, k) for k in range(len(scene.duty))),
            own_fields={k: one for record in kept for k, one in record.own_fields.items()},
        )

    def __repr__(self) -> str:
        return text_table("History", summarize_history(self))

    def _repr_html_(self) -> str:
        return html_with_figure(
            summarize_history(self), "forces" if len(self) > 1 else "pressure", self
        )

    def __getattr__(self, name: str) -> Any:
        """Tell of a column, and of what a contact has and a history has not, where it is."""
        cure = ""
        if name in self.__dict__.get("columns", ()):  # there may be none yet of a copy
            cure = f"; history[{name!r}] is that of all records"
        elif name in State.__dataclass_fields__ or hasattr(State, name):
            cure = f"; history.state(n).{name} is that of one contact"
        raise AttributeError(f"a History has no {name!r}{cure}")

    def __len__(self) -> int:
        return len(self.values[self.coordinate.name])

    def __getitem__(self, name: str) -> np.ndarray:
        """What was recorded under a name, one row a record.

        Raises
        ------
        KeyError
            If there is no such quantity; the message lists those there are.
        """
        if name in self.values:
            return self.values[name]
        cure = f"; it is history[{FORMER[name]!r}] now" if name in FORMER else ""
        if name in self.fields:
            cure = f"; the field is history.field({name!r})"
        raise KeyError(f"no quantity {name!r}{cure}; there are {', '.join(self.values)}")

    def of_dims(self, *dims: str) -> dict[str, Quantity]:
        """The columns of some dimensions: none are one number a record."""
        return {name: one for name, one in self.columns.items() if one.dims == dims}

    def of_role(self, role: str) -> Quantity:
        """The column of a role, whatever its name.

        Raises
        ------
        LookupError
            If there is none.
        """
        return of_role(self.columns.values(), role)

    @property
    def coordinate(self) -> Quantity:
        """The column along which it goes: "revolution", or another that grows."""
        return self.of_role(COORDINATE)

    @property
    def field_revolutions(self) -> np.ndarray:
        """As `saved`: revolutions of the records that kept their fields."""
        return self.saved

    @property
    def x(self) -> np.ndarray:
        """Centres of the elements in the rolling direction, shape (n_x,), mm."""
        return self.grid.x

    @property
    def y(self) -> np.ndarray:
        """Centres of the elements in the lateral direction, shape (n_y,), mm."""
        return self.grid.y

    @property
    def a0(self) -> float:
        """Semi-axis in x of the unworn contact by Hertz, mm; nan where Hertz does not apply."""
        return math.nan if self.scene.hertz is None else self.scene.hertz.a

    @property
    def b0(self) -> float:
        """Semi-axis in y, mm, as `a0`."""
        return math.nan if self.scene.hertz is None else self.scene.hertz.b

    @property
    def p0(self) -> float:
        """Peak pressure, MPa, as `a0`."""
        return math.nan if self.scene.hertz is None else self.scene.hertz.p0

    @property
    def bodies(self) -> tuple[str, ...]:
        """Bodies whose stress was computed, of "A" and "B"; none without [subsurface]."""
        return () if self.scene.subsurface is None else tuple(self.scene.subsurface.bodies)

    @property
    def finished(self) -> bool:
        """Whether the computation came to its end."""
        return self.status == DONE

    @property
    def laws(self) -> str:
        """Laws that replaced those of the scene, in one line; empty where none did."""
        return describe_laws(self.law_records)

    @property
    def versions(self) -> Mapping[str, str]:
        """Programs that computed the last records."""
        return self.provenance[-1][1] if self.provenance else {}

    @property
    def totals(self) -> dict[str, float]:
        """Contacts solved and seconds spent on all records, "contact_solves" and "wall_seconds"."""
        return {
            "contact_solves": int(np.nansum(self["solves"])),
            "wall_seconds": float(np.nansum(self["seconds"])),
        }

    @property
    def energy_balance(self) -> np.ndarray:
        """Work that friction dissipates over the work supplied, one number a record.

        Unity, whatever the friction law, the profile and the mesh. The paper's upwind slip misses
        some per cent, at small creepage most of it, and the wear misses as much. nan where nothing
        is driven, or no more than the rounding of what the pressure does on the slopes of the
        bodies; and without friction. Of a transient with what is stored as elastic energy.
        """
        return balance_of(self).energy

    @property
    def wear_balance(self) -> np.ndarray:
        """Worn cross section over what the frictional work wears, one number a record.

        Of a transient the volume worn in the step over what the work in it wears: unity of steps
        that roll, and of shifts as far as they are short.

        A unit of work wears i1/mu1 along the first tribological axis, and i2/mu2 along the second.
        Where these differ, the section is compared with what is nearest to it between the two:
        unity is within. nan where nothing wears, or no more than the rounding of the wear so far,
        with the laws of measured regimes, with one of one's own, with friction or wear that
        varies, and of duty cycles, whose blocks have it.
        """
        return balance_of(self).wear

    @property
    def worn_track(self) -> tuple[np.ndarray, np.ndarray]:
        """What a transient with [wear] has worn along the track, both bodies together.

        Places on the bodies, shape (n,), mm, ascending: the place x is in the middle of the contact
        when the distance x has been rolled. Depths there, shape (n, n_y), mm: as each record tells
        them of the material that leaves the mesh, and the fields of the last one, where they are
        stored, of what is still on it.

        Raises
        ------
        ValueError
            If nothing wears, or nothing rolls.
        """
        x = self.grid.x
        if "step_worn" not in self.columns or not self.scene.schedule.rolls:
            raise ValueError("a track is worn by a [transient] that rolls, with [wear]")
        places, depth = self["distance"] + x[0], self["wear_profile"]
        if len(self.saved) and self.saved[-1] == self["distance"][-1]:
            on_mesh = self.saved[-1] + x
            left = places < on_mesh[0]
            places = np.append(places[left], on_mesh)
            depth = np.concatenate((depth[left], self.field("wear")))
        places, last = np.unique(places[::-1], return_index=True)
        return places, depth[::-1][last]

    @property
    def block_names(self) -> list[str]:
        """Names of the blocks of a duty cycle, in order; none of another history."""
        return [block_label(self.scene, k) for k in range(len(self.scene.duty))]

    @property
    def planes(self) -> tuple[tuple[str, str], ...]:
        """Body and plane of every stress that was kept, as ("A", "y=0")."""
        return tuple(self.stresses)

    @property
    def line(self) -> bool:
        """Whether it is of a line contact, with forces per length."""
        return self.grid.line

    @property
    def title(self) -> str:
        """Title of the scene, empty where it has none."""
        return self.scene.title

    def field(self, name: str, at: float | None = None, **named: float | None) -> np.ndarray:
        """One field of one record, shape (n_x, n_y); of a duty cycle (blocks, n_x, n_y).

        Parameters
        ----------
        name : str
            A name of `FIELDS`, or of a field of an observer.
        at : float, optional
            One of `saved`, also by the name of the coordinate, ``revolution=2``; the last by
            default.

        Raises
        ------
        LookupError
            If the field was not kept; the message lists what was.
        """
        if name not in self.fields:
            raise LookupError(f"no field {name!r}; there are {', '.join(self.fields) or 'none'}")
        return self.fields[name][self.row_of(at, **named)]

    def stress(
        self, body: str, plane: str, at: float | None = None, **named: float | None
    ) -> "PlaneStress":
        """Stress of a body on a plane in one record; of a duty cycle its blocks have it.

        Parameters
        ----------
        body : "A" or "B"
            The body.
        plane : str
            The plane as the scene names it, "y=0".
        at : float, optional
            As of `field`.

        Raises
        ------
        LookupError
            If it was not kept; the message lists what was.
        """
        rows = self.stresses.get((body, str(plane)))
        if rows is None and any(self.stresses_of_blocks):
            raise LookupError("each block has its own stress: history.block(k).stress(...)")
        if rows is None:
            kept = ", ".join(f"{plane} of {body}" for body, plane in self.planes)
            raise LookupError(
                f"no stress on {plane} of body {body}; there is {kept or 'none: add [subsurface]'}"
            )
        return rows[self.row_of(at, **named)]

    def fatigue(self, body: str, at: float | None = None, **named: float | None) -> BodyFatigue:
        """What rolling has done to a body by one record, with its damage where there is a limit.

        Parameters
        ----------
        body : "A" or "B"
            The body.
        at : float, optional
            As of `field`.

        Raises
        ------
        LookupError
            If it was not kept; the message lists what was.
        """
        if body not in self.cycles:
            kept = ", ".join(self.cycles) or "none: add [fatigue]"
            raise LookupError(f"no fatigue of body {body}; there is {kept}")
        return self.cycles[body][self.row_of(at, **named)]

    def row_of(self, at: float | None = None, **named: float | None) -> int:
        """The row of a value of the coordinate in `saved`; arguments and errors as of `field`."""
        coordinate = self.coordinate.name
        if named:
            if at is not None or named.keys() != {coordinate}:
                asked = " and ".join([*([] if at is None else ["a value"]), *named])
                raise TypeError(f"one {coordinate} is needed, not {asked}")
            at = named[coordinate]
        if at is None and len(self.saved):
            return len(self.saved) - 1
        # A distance may come from a sum.
        rows = [] if at is None else np.flatnonzero(np.isclose(self.saved, at, rtol=1e-12, atol=0))
        if not len(rows):
            kept = ", ".join(map(str, self.saved)) or "none"
            asked = "" if at is None else f" {at:g}"
            raise LookupError(f"no fields of {coordinate}{asked}; there are those of {kept}")
        return int(rows[-1])

    def state(self, at: float | None = None, **named: float | None) -> State:
        """The contact of one record, as of `solve`.

        Files of the first format kept neither its gap, which then is nan, nor where it slips, which
        then is told from its traction.

        Parameters
        ----------
        at : float, optional
            As of `field`.

        Raises
        ------
        LookupError
            If its fields were not kept; the message lists those that were.

        Examples
        --------
        >>> history.state(2).Qx == history["Qx"][2]
        True
        """
        if self.block_names:
            raise LookupError("a duty cycle has a contact for each block: history.block(k).state()")
        kept = self.row_of(at, **named)
        row = int(np.flatnonzero(self[self.coordinate.name] == self.saved[kept])[-1])
        return self.contact(row, {name: rows[kept] for name, rows in self.fields.items()})

    def block(self, which: int | str) -> Self:
        """What was recorded of one block of a duty cycle, as a history of its own.

        Profiles and worn volumes are those of the bodies, which all blocks wear.

        Parameters
        ----------
        which : int or str
            Its place in the [[duty]] of the scene, from 0, or its name. A text that is no name may
            be a place.

        Raises
        ------
        LookupError
            If there is no such block.

        Examples
        --------
        >>> blocks = ({"revolutions": 1}, {"revolutions": 1, "load": {"normal": 200.0}})
        >>> spectrum = ts.roll(discs.replace(duty=blocks))
        >>> light = spectrum.block(1)
        >>> round(float(light["P"][-1])), light.state(2).scene.load.normal
        (200, 200.0)
        """
        k = self.place_of(which)
        apart = (PREFIX, PARTS.name)
        columns = {n: one for n, one in self.columns.items() if not n.startswith(apart)}
        values = {}
        for name in columns:
            own = PREFIX + name
            values[name] = self.values[own][:, k] if own in self.values else self.values[name]
        fields = {name: _OfBlock(rows, k) for name, rows in self.fields.items()}
        grid = self.grid.shifted(self.scene.duty[k].shift_y)
        changes = {"columns": columns, "values": values, "fields": fields}
        changes["stresses"] = self.stresses_of_blocks[k] if self.stresses_of_blocks else {}
        changes["stresses_of_blocks"] = ()
        changes["law_records"] = self._law_records_of(self.scene.blocks[k])
        return replace(self, scene=self.scene.blocks[k], grid=grid, **changes)

    def _law_records_of(self, block: Scene) -> dict[str, LawRecord]:
        """Return the laws in a block: a law that the scene names has the coefficients of the block.

        A law that replaced the one of the scene has the same ones in every block.
        """
        records, friction = dict(self.law_records), self.scene.friction
        record = records.get("friction")
        if record and friction and friction.named_law and record.frame == friction.frame:
            records["friction"] = replace(record, frame=block.friction.frame)
        return records

    def place_of(self, which: int | str) -> int:
        """Place of a block in the [[duty]] of the scene, from its place or its name.

        Raises
        ------
        LookupError
            If there is no such block.

        Examples
        --------
        >>> blocks = ({"revolutions": 1}, {"name": "light", "revolutions": 1})
        >>> ts.roll(discs.replace(duty=blocks)).place_of("light")
        1
        """
        names = self.block_names
        places = {of(k): k for of in (int, str) for k in range(len(names))}
        k = (places | {name: names.index(name) for name in names}).get(which)
        if k is None:
            there = f"counted from 0: {', '.join(names)}" if names else "add [[duty]]"
            raise LookupError(f"no block {which}; there are {len(names)}, {there}")
        return k

    def contact(self, row: int, fields: Mapping[str, np.ndarray]) -> State:
        """The contact of a record, from its fields by the names of `FIELDS`."""
        number = {name: float(self[name][row]) for name in self.of_dims()}
        creeping = sum(
            number[force] * number[creepage]
            for force, creepage in (("Qx", "xi_x"), ("Qy", "xi_y"), ("Mz", "spin"))
        )
        solved = number["converged"] > 0.0
        found = State(
            scene=self.scene,
            grid=self.grid,
            pressure=fields["pressure"],
            traction=np.stack((fields["traction_x"], fields["traction_y"])),
            slip=np.stack((fields["slip_x"], fields["slip_y"])),
            gap=fields.get("gap", np.full(self.grid.elements, np.nan)),
            wear=fields["wear"],
            approach=number["approach"],
            xi_x=number["xi_x"],
            xi_y=number["xi_y"],
            spin=number["spin"],
            rolling_resistance=number["work_supplied"] + creeping,
            sliding=fields.get("sliding", np.zeros(self.grid.elements)) > 0.0,
            status=Status.CONVERGED if solved else _status(self.status),
            note="" if solved else self.message,
            residual=number["residual"],
            cost=Cost(number["operator_applications"], convolutions=number["convolutions"]),
            revolution=int(number.get("revolution", 0)),
            volumes=self._volumes(row),
            frame=self.frame,
            traction_bound=_known(fields.get(BOUND.name)),
            laws=self.law_records,
        )
        if all(name in fields for name in WARM):
            into_A = fields["heat_into_A"]
            made = -self.scene.creepage.speed * (found.traction * found.slip).sum(axis=0)
            warm = {"A": fields["temperature_A"], "B": fields["temperature_B"]}
            flux = {"A": into_A, "B": made - into_A}
            found = replace(found, heat=FlashTemperature(self.grid, found.touching, warm, flux))
        return found if "sliding" in fields else found.with_sliding_by_traction()

    @property
    def frame(self) -> Frame | None:
        """Scaled tribological frame of the friction law; None without friction."""
        if (record := self.law_records.get("friction")) is not None:
            return record.frame
        return None if self.scene.friction is None else self.scene.friction.frame

    def _volumes(self, row: int) -> dict[str, float] | None:
        """Worn volume of each body in a record, as far as it was recorded."""
        found = self.values.get("worn_volume")
        return None if found is None else dict(zip(BODIES, found[row].tolist(), strict=True))

    def to_dict(self) -> dict[str, Any]:
        """Columns but for profiles, balances and totals as plain lists; None for no number."""
        roles = {one.role for one in self.columns.values()}
        rows: dict[str, Any] = {} if "stress_max" in roles else {name: {} for name in STRESSES}
        for name, one in self.columns.items():
            if one.dims[:1] == ("body",):
                of_bodies = {
                    body: self[name][:, BODIES.index(body)] for body in one.bodies(self.scene)
                }
                rows[name] = {body: values.tolist() for body, values in of_bodies.items()}
            elif "y" not in one.dims:
                rows[name] = self[name].tolist()
        rows |= {name: getattr(self, name).tolist() for name in ("energy_balance", "wear_balance")}
        reference = {"a0": self.a0, "b0": self.b0, "p0": self.p0}
        about = {"status": self.status, "message": self.message} | reference
        return _without_nan(about | rows | self.totals)

    def numbers(self) -> dict[str, np.ndarray]:
        """Every column but profiles as arrays of one number a record.

        Those of a body, an axis or a position by names like "worn_mass A" and "p_max_at x".
        """
        found = {}
        for name, one in self.columns.items():
            if "y" in one.dims:
                continue
            of_dims = {**LABELS, "block": self.block_names}
            labels = [of_dims[dim] for dim in one.dims]
            if one.dims[:1] == ("body",):
                labels[0] = one.bodies(self.scene)
            for place in product(*labels):
                at = tuple(of_dims[dim].index(k) for dim, k in zip(one.dims, place, strict=True))
                found[" ".join((name, *place))] = self[name][(..., *at)]
        return found

    def to_dataframe(self) -> "pandas.DataFrame":
        """`numbers` as a table along the coordinate; needs pandas, which comes with xarray.

        Raises
        ------
        ImportError
            Without pandas, which comes with the extra ``study``.

        Examples
        --------
        >>> history.to_dataframe()["worn_mass A"].loc[2] == history["worn_mass"][2, 0]
        True
        """
        check_extra("pandas", "history.to_dataframe")
        return pandas.DataFrame(self.numbers()).set_index(self.coordinate.name)

    def to_xarray(self) -> "xarray.Dataset":
        """Columns, and fields of the records that kept them, with units and coordinates.

        Raises
        ------
        ImportError
            Without xarray, which comes with the extra ``study``.

        Examples
        --------
        >>> history.to_xarray()["Qx"].sel(revolution=2).item() == history["Qx"][2]
        True
        """
        check_extra("xarray", "history.to_xarray")

        def about(one: Quantity) -> dict[str, str]:
            return {"units": one.unit, "long_name": one.long_name}

        along = self.coordinate
        data = {
            name: ((along.name, *one.dims), self[name], about(one))
            for name, one in self.columns.items()
            if one is not along
        }
        quantities = {**kept_fields(self.scene), **self.own_fields}
        for name, rows in self.fields.items():
            blocks = () if not self.block_names else (len(self.block_names),)
            values = np.empty((len(rows), *blocks, *self.grid.elements))
            for row in range(len(rows)):
                values[row] = rows[row]
            dims = ("saved", *("block" for _ in blocks), "x", "y")
            data[name] = (dims, values, about(quantities[name]))
        labels = {name: list(values) for name, values in LABELS.items()}
        if self.block_names:
            labels["block"] = self.block_names
        coordinates = labels | {
            along.name: (along.name, self[along.name], about(along)),
            "saved": ("saved", self.saved, about(along)),
            "x": ("x", self.x, {"units": "mm"}),
            "y": ("y", self.y, {"units": "mm"}),
        }
        told = {"title": self.title, "status": self.status, "message": self.message}
        return xarray.Dataset(data, coordinates, told)


@dataclass(frozen=True, eq=False)
class _OfBlock:
    """One block of fields that are stored of all."""

    rows: Rows[np.ndarray]
    block: int

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, row: int) -> np.ndarray:
        return self.rows[row][self.block]


def _field(record: Record, name: str, grid: Grid) -> np.ndarray:
    """Return a field of a record on a mesh that may be wider; nan where the record has none."""
    if name not in record.fields:
        return np.full_like(record.fields["pressure"], np.nan)
    return widened(record.fields[name], grid.elements, OUTSIDE.get(name, 0.0))


def _known(bound: np.ndarray | None) -> np.ndarray | None:
    """Return a stored bound of the traction; None where the file does not have that of a record."""
    return None if bound is None or np.isnan(bound).any() else bound


def _status(ended: str) -> Status:
    """Why a contact was not solved, as far as the status of its history says so."""
    return Status(ended) if ended in set(Status) else Status.OUT_OF_ITERATIONS


def stacked(quantity: Quantity, values: Sequence[Any], grid: Grid) -> np.ndarray:
    """One row a record of what was recorded, on a mesh that may be wider than its own."""
    along = {"x": grid.elements[0], "y": grid.elements[1]}
    if "block" in quantity.dims:
        along["block"] = np.shape(values[0])[quantity.dims.index("block")] if len(values) else 0
    shape = tuple(along[k] if k in along else len(LABELS[k]) for k in quantity.dims)
    rows = np.empty((len(values), *shape), int if quantity.whole else float)
    for row, value in zip(rows, values, strict=True) if shape else ():
        if quantity.dims[0] == "body":
            row[:] = np.nan
            for body, of_body in value.items():
                row[BODIES.index(body)] = of_body
        else:
            mesh = tuple(along[name] for name in quantity.dims if name in ("x", "y"))
            row[:] = widened(np.asarray(value, float), mesh) if mesh else value
    if not shape:
        rows[:] = values
    return rows


def _by_plane(
    kept: Sequence[Record], block: int | None = None
) -> dict[tuple[str, str], list["PlaneStress"]]:
    first = kept[0].stress if kept else ()
    rows = {
        (one.body, str(one.plane)): [record.stress[k] for record in kept]
        for k, one in enumerate(first)
        if one.block == block
    }
    return dict(sorted(rows.items()))  # as a file has them


def _by_body(kept: Sequence[Record]) -> dict[str, list[BodyFatigue]]:
    bodies = (one.body for one in kept[0].cycles) if kept else ()
    return {body: [record.cycles[k] for record in kept] for k, body in enumerate(bodies)}


def _without_nan(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _without_nan(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_without_nan(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
