"""A history: all records of a computation, in memory or on disk, and its worn profiles."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import product
from os import PathLike
from pathlib import Path
from typing import Any, ClassVar, Self

import numpy as np

from tractive_sam.description import text_table, without_nan
from tractive_sam.extra_packages import pandas, xarray
from tractive_sam.extras import check_extra
from tractive_sam.lazy_names import renamed_attributes
from tractive_sam.output_file import make_folder, write_table
from tractive_sam.rail import Profile, write_profile
from tractive_sam.results.column_table import STRESSES
from tractive_sam.results.describe import balance_of, summarize_history
from tractive_sam.results.grid import Grid
from tractive_sam.results.history_data import HistoryData, LawRecord, contact_of
from tractive_sam.results.quantity import BODIES, LABELS, Quantity
from tractive_sam.results.record import Record, collect
from tractive_sam.results.state import State, html_with_figure
from tractive_sam.results.stress import BodyFatigue, InclusionPassage, PlaneStress
from tractive_sam.scene import Scene, unworn_profiles

DONE = "done"
"""The `History.status` of a complete computation."""

DERIVED = ("a0", "b0", "p0", "energy_balance", "wear_balance", "contact_solves", "wall_seconds")
"""Numbers of `History.to_dict` that are not columns."""


@renamed_attributes(own_fields="user_fields")
class History(HistoryData):
    """All records of a computation: columns by name, and fields of stored records.

    Attributes
    ----------
    scene : Scene
        The computed scene.
    status : str
        "done"; "running" if the computation runs or was killed; else why it ended early.
    message : str
        Meaning of the status and, if something is wrong, what to try.
    grid : Grid
        The mesh.
    columns : mapping of str to Quantity
        Descriptions of the columns; `history[name]` has the numbers.
    values : mapping of str to ndarray
        One row a record, in the shape of the column's dimensions; nan if there is no value.
    tables : mapping of str to sequence of Table, length m <= n
        Fields, stress and fatigue of the records with stored fields, by paths as "fields",
        "stress/A/y=0" and "fatigue/A", each with `to_xarray`; see also `field`, `stress`,
        `passage`, `fatigue` and `state`.
    saved : ndarray, shape (m,)
        Values of the coordinate of these records, for example their revolutions.
    provenance : tuple of (int, mapping of str to str)
        Rows, and the programs that computed the records from each of these rows on.
    law_records : mapping of str to LawRecord
        Laws that replaced laws of the scene, by "friction", "wear" and so on.
    started : str
        Source of the worn bodies with which the history began; empty for new bodies.
    measured : str
        Hash of the numbers of the measured gap and profiles; empty without them.
    datum : str
        Origin of the approach: "vertex", the first touch of the unworn bodies, or "node", the
        nearest element, in results files of earlier versions.
    block_index : int or None
        Block of a duty cycle whose records these are.

    Examples
    --------
    >>> history["revolution"].tolist()
    [0, 1, 2]
    >>> history.field("pressure", revolution=2).shape
    (41, 121)
    >>> bool(history["wear_max"][-1] > history["wear_max"][0])
    True
    """

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
        """Build a history from records in memory; fields are widened to the last mesh."""
        about: dict[str, Any] = {"law_records": law_records or {}, "started": started}
        return cls(scene, status, message, grid, **collect(list(records), scene, grid), **about)

    def __repr__(self) -> str:
        return text_table("History", summarize_history(self))

    def _repr_html_(self) -> str:
        """Return the summary of the history next to a figure, as HTML for notebooks."""
        return html_with_figure(
            summarize_history(self), "forces" if len(self) > 1 else "pressure", self
        )

    def __getattr__(self, name: str) -> Any:
        """Raise an error that names the place of a column, or of an attribute of a contact."""
        cure = ""
        if name in self.__dict__.get("columns", ()):  # an incomplete copy has no columns
            cure = f"; history[{name!r}] has its values for all records"
        elif name in State.__dataclass_fields__ or hasattr(State, name):
            cure = f"; history.state(n).{name} has its value for one contact"
        raise AttributeError(f"a History has no {name!r}{cure}")

    @property
    def field_revolutions(self) -> np.ndarray:
        """Revolutions of the records with stored fields, an alias of `saved`."""
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
    def finished(self) -> bool:
        """Whether the computation ran to its end."""
        return self.status == DONE

    @property
    def versions(self) -> Mapping[str, str]:
        """Versions of the programs that computed the last records, by program."""
        return self.provenance[-1][1] if self.provenance else {}

    @property
    def energy_balance(self) -> np.ndarray:
        """Dissipated over supplied work in each record, shape (n,): 1 if exact, nan without work.

        The exact value is 1 for any friction law, profile and mesh. With the paper's upwind slip it
        is in error by some per cent, at small creepage by much more, and the wear is in error by as
        much. It is nan without friction, and if no work is supplied beyond the rounding error of
        the pressure on the slopes of the bodies. For a transient it includes the stored elastic
        energy.
        """
        return balance_of(self).energy

    @property
    def wear_balance(self) -> np.ndarray:
        """Worn cross section over the section expected from the frictional work, shape (n,).

        For a transient, the volume worn in the step over the volume that its work wears; for worn
        profiles of wheel and rail, both sections since the profiles were new. The exact
        value is 1 for steps that roll, and for shifts in the limit of short steps.

        A unit of work wears i1/mu1 along the first tribological axis, and i2/mu2 along the second.
        If these differ, the section is compared with the nearest value between the two, so that the
        balance is 1 between them. It is nan if nothing wears beyond the rounding error of the wear
        so far, with the laws of measured regimes, with a user-defined law, with friction or wear
        that varies, and for duty cycles; their blocks have it.
        """
        return balance_of(self).wear

    @property
    def worn_track(self) -> tuple[np.ndarray, np.ndarray]:
        """Positions and wear depths, mm, along the track of a transient with [wear].

        Places on the bodies, shape (n,), mm, ascending: the place x is in the middle of the contact
        after rolling the distance x. Depths there, shape (n, n_y), mm: each record has the depth of
        the material that leaves the mesh; the stored fields of the last record add the depth of the
        material on the mesh.

        Raises
        ------
        ValueError
            If nothing wears, or nothing rolls.
        """
        x = self.grid.x
        if "step_worn" not in self.columns or not self.scene.schedule.rolls:
            raise ValueError("worn_track: only a [transient] that rolls, with [wear], has one")
        rolled = self.scene.schedule.rolled(self["distance"])
        places, depth = rolled + x[0], self["wear_profile"]
        if len(self.saved) and self.saved[-1] == self["distance"][-1]:
            on_mesh = rolled[-1] + x
            behind = places < on_mesh[0]
            places = np.append(places[behind], on_mesh)
            depth = np.concatenate((depth[behind], self.field("wear")))
        places, last = np.unique(places[::-1], return_index=True)
        return places, depth[::-1][last]

    @property
    def planes(self) -> tuple[tuple[str, str], ...]:
        """Body and plane of each stored stress, as ("A", "y=0")."""
        return tuple(self.stresses)

    @property
    def line(self) -> bool:
        """Whether it is the history of a line contact, with forces per length."""
        return self.grid.line

    def field(self, name: str, at: float | None = None, **named: float | None) -> np.ndarray:
        """Return one field of one record, shape (n_x, n_y); for a duty cycle (blocks, n_x, n_y).

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
            If the field was not stored; the message lists the stored ones.
        """
        if name not in self.fields:
            raise LookupError(f"no field {name!r}; there are {', '.join(self.fields) or 'none'}")
        return self.fields[name][self.row_of(at, **named)]

    def stress(
        self, body: str, plane: str, at: float | None = None, **named: float | None
    ) -> PlaneStress:
        """Return the stress of a body on a plane in one record; for a duty cycle see `block`.

        Parameters
        ----------
        body : "A" or "B"
            The body.
        plane : str
            The plane as the scene names it, "y=0".
        at : float, optional
            See `field`.

        Raises
        ------
        LookupError
            If the stress was not stored; the message lists the stored planes.
        """
        rows = self.stresses.get((body, str(plane)))
        if rows is None and any(self.stresses_of_blocks):
            raise LookupError("each block has its own stress: history.block(k).stress(...)")
        if rows is None:
            stored = ", ".join(f"{plane} of {body}" for body, plane in self.planes)
            raise LookupError(
                f"no stress on {plane} of body {body}; there is "
                f"{stored or 'none: add [subsurface]'}"
            )
        return rows[self.row_of(at, **named)]

    def passage(
        self, body: str, inclusion: str, at: float | None = None, **named: float | None
    ) -> InclusionPassage:
        """Return the passage of an inclusion in one record; for a duty cycle see `block`.

        Parameters
        ----------
        body : "A" or "B"
            The body.
        inclusion : str
            Name of the inclusion: "inclusion-1" is the first one of the scene.
        at : float, optional
            See `field`.

        Raises
        ------
        LookupError
            If the passage was not stored; the message lists the stored ones.
        """
        if (body, inclusion) not in self.passages:
            stored = ", ".join(f"{name} of {body}" for body, name in self.passages)
            raise LookupError(
                f"no passage of {inclusion} of body {body}; there is "
                f"{stored or 'none: add [[inclusion]]; a duty cycle has them in its blocks'}"
            )
        return self.passages[body, inclusion][self.row_of(at, **named)]

    def fatigue(self, body: str, at: float | None = None, **named: float | None) -> BodyFatigue:
        """Return the fatigue of a body in one record, with its damage if there is a limit.

        Parameters
        ----------
        body : "A" or "B"
            The body.
        at : float, optional
            See `field`.

        Raises
        ------
        LookupError
            If the fatigue was not stored; the message lists the stored bodies.
        """
        if body not in self.cycles:
            stored = ", ".join(self.cycles) or "none: add [fatigue]"
            raise LookupError(f"no fatigue of body {body}; there is {stored}")
        return self.cycles[body][self.row_of(at, **named)]

    def row_of(self, at: float | None = None, **named: float | None) -> int:
        """Return the index into `saved` of the stored record at a coordinate (default: last)."""
        coordinate = self.coordinate.name
        if named:
            if at is not None or named.keys() != {coordinate}:
                names = " and ".join([*([] if at is None else ["a value"]), *named])
                raise TypeError(f"give one {coordinate}, not {names}")
            at = named[coordinate]
        if at is None and len(self.saved):
            return len(self.saved) - 1
        # A distance may come from a sum.
        wanted = math.nan if at is None else at
        rows = np.flatnonzero(np.isclose(self.saved, wanted, rtol=1e-12, atol=0))
        if not len(rows):
            saved = ", ".join(map(str, self.saved)) or "none"
            value = "" if at is None else f" {at:g}"
            raise LookupError(f"no fields of {coordinate}{value}; the stored ones are {saved}")
        return int(rows[-1])

    def state(self, at: float | None = None, **named: float | None) -> State:
        """Return the contact of one stored record, as `solve` returns it; not of a duty cycle.

        Files of the first format have neither the gap, which then is nan, nor the sliding elements,
        which then follow from the traction.

        Parameters
        ----------
        at : float, optional
            See `field`.

        Raises
        ------
        LookupError
            If its fields were not stored; the message lists the stored records.

        Examples
        --------
        >>> history.state(2).Qx == history["Qx"][2]
        True
        """
        if self.block_names:
            raise LookupError("a duty cycle has a contact for each block: history.block(k).state()")
        saved = self.row_of(at, **named)
        row = int(np.flatnonzero(self[self.coordinate.name] == self.saved[saved])[-1])
        return self.contact(row, {name: rows[saved] for name, rows in self.fields.items()})

    def contact(self, row: int, fields: Mapping[str, np.ndarray]) -> State:
        """Return the contact of record `row`, given its fields by the names of `FIELDS`."""
        return contact_of(self, row, fields)

    def to_dict(self) -> dict[str, Any]:
        """Return columns (no profiles), balances, totals and status as lists; None for nan."""
        balance = balance_of(self)
        roles = {column.role for column in self.columns.values()}
        rows: dict[str, Any] = {} if "stress_max" in roles else {name: {} for name in STRESSES}
        for name, column in self.columns.items():
            if column.dims[:1] == ("body",):
                of_bodies = {
                    body: self[name][:, BODIES.index(body)] for body in column.bodies(self.scene)
                }
                rows[name] = {body: values.tolist() for body, values in of_bodies.items()}
            elif not column.is_profile:
                rows[name] = self[name].tolist()
        rows |= {"energy_balance": balance.energy.tolist(), "wear_balance": balance.wear.tolist()}
        reference = {"a0": self.a0, "b0": self.b0, "p0": self.p0}
        about = {"status": self.status, "message": self.message} | reference
        return without_nan({**about, **rows, **self.totals})

    def numbers(self) -> dict[str, np.ndarray]:
        """Return all columns except profiles as arrays (n,), with names like "worn_mass A".

        Columns of a body, an axis or a position have names like "worn_mass A" and "p_max_at x".
        """
        arrays = {}
        for name, column in self.columns.items():
            if column.is_profile:
                continue
            of_dims = {**LABELS, "block": self.block_names}
            labels = [of_dims[dim] for dim in column.dims]
            if column.dims[:1] == ("body",):
                labels[0] = column.bodies(self.scene)
            for place in product(*labels):
                dims = zip(column.dims, place, strict=True)
                at: tuple[Any, ...] = (..., *(of_dims[dim].index(label) for dim, label in dims))
                arrays[" ".join((name, *place))] = self[name][at]
        return arrays

    def to_dataframe(self) -> pandas.DataFrame:
        """Return the arrays of `numbers` as a pandas DataFrame along the coordinate.

        Raises
        ------
        ImportError
            If pandas is not installed; the extra ``study`` installs it.

        Examples
        --------
        >>> history.to_dataframe()["worn_mass A"].loc[2] == history["worn_mass"][2, 0]
        True
        """
        check_extra("pandas", "history.to_dataframe")
        return pandas.DataFrame(self.numbers()).set_index(self.coordinate.name)

    def to_xarray(self) -> xarray.Dataset:
        """Return the columns and stored fields as an xarray Dataset, with units and coordinates.

        Raises
        ------
        ImportError
            If xarray is not installed; the extra ``study`` installs it.

        Examples
        --------
        >>> history.to_xarray()["Qx"].sel(revolution=2).item() == history["Qx"][2]
        True
        """
        check_extra("xarray", "history.to_xarray")

        along = self.coordinate
        data = {
            name: ((along.name, *column.dims), self[name], column.attributes)
            for name, column in self.columns.items()
            if column is not along
        }
        for name, quantity in self.tables["fields"].quantities.items():
            fields = self.fields[name]
            rows = [fields[row] for row in range(len(fields))]
            blocks = ("block",) if self.block_names else ()
            shape = (len(rows), *(len(self.block_names) for _ in blocks), *self.grid.elements)
            dims = ("saved", *blocks, "x", "y")
            data[name] = (dims, np.reshape(rows, shape), quantity.attributes)
        labels = {name: list(values) for name, values in LABELS.items()}
        if self.block_names:
            labels["block"] = list(self.block_names)
        coordinates = labels | {
            along.name: (along.name, self[along.name], along.attributes),
            "saved": ("saved", self.saved, along.attributes),
            "x": ("x", self.grid.x, {"units": "mm"}),
            "y": ("y", self.grid.y, {"units": "mm"}),
        }
        attributes = {"title": self.title, "status": self.status, "message": self.message}
        return xarray.Dataset(data, coordinates, attributes)


@dataclass(frozen=True, eq=False)
class WornProfiles:
    """Wheel and rail profiles after each wear step, from a history with [wheel] and [wear].

    Attributes
    ----------
    scene : Scene
        The computed scene.
    revolutions : ndarray, shape (n,)
        Revolutions of the wheel after each step, the first one 0.
    wheel_depth, rail_depth : ndarray, shape (n, m)
        Depth worn off along the normals at the nodes of the profiles, mm.
    contact_y : ndarray, shape (n, blocks)
        Lateral position on the rail of the patch with most load in each block, mm.

    Examples
    --------
    >>> scene = ts.Scene.builtin("wheel-wear").with_set(["wear.revolutions=1000"])
    >>> worn = ts.WornProfiles.from_history(ts.roll(scene))
    >>> bool(worn.wheel_depth[-1].max() > 0.0)
    True
    """

    columns: ClassVar[tuple[Quantity, ...]] = (
        Quantity("wheel_wear", "mm", "depth worn off the wheel, normal to it", dims=("wheel",)),
        Quantity("rail_wear", "mm", "depth worn off the rail, normal to it", dims=("rail",)),
        Quantity(
            "worn_section",
            "mm2",
            "cross section worn off each body since it was new",
            dims=("body",),
        ),
        Quantity(
            "wear_max_error", "mm", "error bar of wear_max due to its steps", error_of="wear_max"
        ),
        Quantity(
            "profile_work", "N", "frictional work per length of track since the bodies were new"
        ),
    )
    """Columns of a history with worn profiles."""

    scene: Scene
    revolutions: np.ndarray
    wheel_depth: np.ndarray
    rail_depth: np.ndarray
    contact_y: np.ndarray

    @classmethod
    def from_history(cls, history: History) -> WornProfiles:
        """Read worn wheel and rail profiles from the history of a scene with [wheel] and [wear].

        Raises
        ------
        ValueError
            If the history belongs to another scene.
        """
        if "wheel_wear" not in history.columns:
            raise ValueError(
                "the history has no worn profiles; roll a scene with [wheel] and [wear]"
            )
        name = "block_contact_y" if history.block_names else "contact_y"
        contact_y = history[name].reshape(len(history), -1)
        wheel, rail = history["wheel_wear"], history["rail_wear"]
        return cls(history.scene, history["revolution"], wheel, rail, contact_y)

    def wheel(self, step: int = -1) -> Profile:
        """Return the wheel profile after a wear step (default: the last), in its own frame."""
        return self.new["wheel"].worn(self.wheel_depth[step], 1.0)

    def rail(self, step: int = -1) -> Profile:
        """Return the rail profile after a wear step (default: the last), in its own frame."""
        return self.new["rail"].worn(self.rail_depth[step], -1.0)

    @property
    def worn_areas(self) -> dict[str, np.ndarray]:
        """Cross section worn off "wheel" and "rail" after each step, shape (n,), mm2."""
        depths = {"wheel": self.wheel_depth, "rail": self.rail_depth}
        return {name: np.trapezoid(depths[name], new.s, axis=1) for name, new in self.new.items()}

    @property
    def new(self) -> dict[str, Profile]:
        """Unworn profiles of "wheel" and "rail", in their own frames."""
        sizes = self.wheel_depth.shape[1], self.rail_depth.shape[1]
        return dict(zip(("wheel", "rail"), unworn_profiles(self.scene, *sizes), strict=True))

    def write(self, folder: str | PathLike[str]) -> list[Path]:
        """Write the last profiles (.prw, .prr), and area and largest depth by step (.csv).

        Returns
        -------
        list of Path
            The files.
        """
        folder = make_folder(folder)
        last = f"{self.revolutions[-1]:g}"
        files = [folder / f"wheel-{last}.prw", folder / f"rail-{last}.prr", folder / "wear.csv"]
        title = f"{self.scene.title}, worn for {last} revolutions"
        write_profile(self.wheel(), files[0], "wheel", title)
        write_profile(self.rail(), files[1], "rail", title)
        areas = self.worn_areas
        depths = {"wheel": self.wheel_depth, "rail": self.rail_depth}
        columns = {"revolution": self.revolutions}
        columns |= {f"{name}_area": area for name, area in areas.items()}
        columns |= {f"{name}_depth": depth.max(axis=1) for name, depth in depths.items()}
        write_table(files[2], columns)
        return files
