"""The whole of a computation: every record, in memory or still on disk."""

import math
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol, Self, TypeVar

import numpy as np

from tractive_sam.results.grid import Grid
from tractive_sam.results.plane_stress import PlaneStress
from tractive_sam.results.quantities import (
    BODY_ERROR_BARS,
    BODY_POINTS,
    BODY_SCALARS,
    ERROR_BARS,
    FIELDS,
    POINTS,
    PROFILES,
    SCALARS,
)
from tractive_sam.results.record import Record

DONE = "done"
"""The `History.status` that means that nothing is missing."""

ROUNDING = 1e-12
"""Share of the terms of a sum that its rounding may reach."""

T_co = TypeVar("T_co", covariant=True)


class Rows(Protocol[T_co]):
    """Fields of several records, read one at a time: a sequence, or something that reads a file."""

    def __len__(self) -> int:
        """Number of records with fields."""

    def __getitem__(self, row: int) -> T_co:
        """The field of one record."""


@dataclass(frozen=True)
class History:
    """All records of a computation, under the names of `results.quantities`.

    Attributes
    ----------
    scene_toml : str
        The scene that was computed.
    status : str
        "done"; "running" of a computation that still runs or was killed; else why
        it ended early.
    message : str
        What the status means and, where something is wrong, what to try.
    a0, b0, p0 : float
        Semi-axes in x and y, mm, and largest pressure, MPa, of the unworn contact by Hertz; nan
        where Hertz does not apply.
    half_length : tuple of float
        Half lengths of the domain in x and y, mm.
    x, y : ndarray, shapes (n_x,) and (n_y,)
        Centres of the elements, mm.
    scalars : mapping of str to ndarray, shape (n,)
        One number a record; `ERROR_BARS` of scenes with [accuracy] only.
    points : mapping of str to ndarray, shape (n, 2)
        One position a record, mm.
    profiles : mapping of str to ndarray, shape (n, n_y)
        One function of y a record.
    fields : mapping of str to Rows, length m <= n
        One function of x and y for each record that kept its fields; see `field`.
    field_revolutions : ndarray of int, shape (m,)
        Revolutions of these records.
    bodies : tuple of str
        Bodies whose stress was computed, of "A" and "B"; none without [subsurface].
    body_scalars : mapping of str to ndarray, shape (n, len(bodies))
        One number a record and body; `BODY_ERROR_BARS` of scenes with [accuracy] only.
    body_points : mapping of str to ndarray, shape (n, len(bodies), 3)
        One position (x, y, depth) a record and body, mm.
    stresses : mapping of (body, plane) to Rows, length m
        Stress on planes for each record that kept its fields; see `stress`.
    provenance : tuple of (int, mapping of str to str)
        Programs that computed it, each with the record from which on they did.

    Examples
    --------
    >>> history["revolution"].tolist()
    [0, 1, 2]
    >>> history.field("pressure", revolution=2).shape
    (41, 121)
    >>> bool(history["wear_max"][-1] > history["wear_max"][0])
    True
    """

    scene_toml: str
    status: str
    message: str
    a0: float
    b0: float
    p0: float
    half_length: tuple[float, float]
    x: np.ndarray
    y: np.ndarray
    scalars: Mapping[str, np.ndarray]
    points: Mapping[str, np.ndarray]
    profiles: Mapping[str, np.ndarray]
    fields: Mapping[str, Rows[np.ndarray]]
    field_revolutions: np.ndarray
    bodies: tuple[str, ...]
    body_scalars: Mapping[str, np.ndarray]
    body_points: Mapping[str, np.ndarray]
    stresses: Mapping[tuple[str, str], "Rows[PlaneStress]"]
    provenance: tuple[tuple[int, Mapping[str, str]], ...] = ()

    @classmethod
    def of_records(
        cls,
        records: Iterable[Record],
        scene_toml: str,
        grid: "Grid",
        *,
        a0: float = math.nan,
        b0: float = math.nan,
        p0: float = math.nan,
        status: str = DONE,
        message: str = "",
    ) -> Self:
        """Collect records in memory; those of smaller meshes are padded to the last mesh."""
        records = list(records)
        kept = [record for record in records if record.fields]
        bodies = tuple(records[0].bodies) if records else ()
        barred = bool(records) and ERROR_BARS.keys() <= records[0].scalars.keys()
        bars, body_bars = (ERROR_BARS, BODY_ERROR_BARS) if barred else ({}, {})
        scalars = _stacked(records, "scalars", (*SCALARS, *bars), ())
        scalars["revolution"] = scalars["revolution"].astype(int)
        return cls(
            scene_toml,
            status,
            message,
            a0,
            b0,
            p0,
            grid.half_length,
            grid.x,
            grid.y,
            scalars,
            points=_stacked(records, "points", POINTS, (2,)),
            profiles=_stacked(records, "profiles", PROFILES, grid.y.shape),
            fields=_stacked(kept, "fields", FIELDS, grid.x.shape + grid.y.shape),
            field_revolutions=np.array([record.revolution for record in kept], dtype=int),
            bodies=bodies,
            body_scalars=_of_bodies(records, bodies, (*BODY_SCALARS, *body_bars), ()),
            body_points=_of_bodies(records, bodies, BODY_POINTS, (3,)),
            stresses=_by_plane(kept),
        )

    def __len__(self) -> int:
        return len(self.scalars["revolution"])

    def __getitem__(self, name: str) -> np.ndarray:
        """What was recorded under a name of `results.quantities`, one row a record.

        Raises
        ------
        KeyError
            If there is no such quantity; the message lists those there are.
        """
        kinds = (self.scalars, self.points, self.profiles, self.body_scalars, self.body_points)
        for kind in kinds:
            if name in kind:
                return kind[name]
        known = ", ".join(name for kind in kinds for name in kind)
        cure = f"; the field is history.field({name!r})" if name in self.fields else ""
        raise KeyError(f"no quantity {name!r}; there are {known}{cure}")

    @property
    def finished(self) -> bool:
        """Whether the computation came to its end."""
        return self.status == DONE

    @property
    def versions(self) -> Mapping[str, str]:
        """Programs that computed the last records."""
        return self.provenance[-1][1] if self.provenance else {}

    @property
    def totals(self) -> dict[str, float]:
        """Contacts solved and seconds spent on all records, "contact_solves" and "wall_seconds"."""
        return {
            "contact_solves": int(self["solves"].sum()),
            "wall_seconds": float(np.nansum(self["seconds"])),
        }

    @property
    def energy_balance(self) -> np.ndarray:
        """Work that friction dissipates over the work supplied, one number a record.

        Unity, whatever the friction law, the profile and the mesh. The paper's upwind slip misses
        some per cent, at small creepage most of it, and the wear misses as much. nan where nothing
        is driven, or no more than the rounding of what the pressure does on the slopes of the
        bodies; and without friction.
        """
        supplied = self["work_supplied"]
        rounding = ROUNDING * self["P"] * np.abs(self["approach"]) / self.half_length[0]
        driven = (np.abs(supplied) > rounding) & ("friction" in self.settings)
        return _ratio(self["dissipation"], supplied, driven)

    @property
    def wear_balance(self) -> np.ndarray:
        """Worn cross section over what the frictional work wears, one number a record.

        A unit of work wears i1/mu1 along the first tribological axis, and i2/mu2 along the second.
        Where these differ, the section is compared with what is nearest to it between the two:
        unity is within. nan where nothing wears, or no more than the rounding of the wear so far.
        """
        worn, most = self["wear_rate"], self["wear_max"] * 2.0 * self.half_length[1]
        if "wear" not in self.settings:
            return np.full(len(self), np.nan)
        intensity, mu = (
            np.broadcast_to(self.settings[table][key], 2)
            for table, key in (("wear", "intensity"), ("friction", "mu"))
        )
        least, largest = sorted(intensity / mu)
        work = self["dissipation"]
        wears = (worn > ROUNDING * most) & (work > 0.0)
        return _ratio(worn, np.clip(worn, least * work, largest * work), wears)

    @property
    def planes(self) -> tuple[tuple[str, str], ...]:
        """Body and plane of every stress that was kept, as ("A", "y=0")."""
        return tuple(self.stresses)

    @cached_property
    def settings(self) -> dict[str, Any]:
        """The scene as plain tables."""
        return tomllib.loads(self.scene_toml)

    @property
    def line(self) -> bool:
        """Whether it is of a line contact, with forces per length."""
        return len(self.y) == 1

    @property
    def title(self) -> str:
        """Title of the scene, empty where it has none."""
        return self.settings.get("title", "")

    def field(self, name: str, revolution: int | None = None) -> np.ndarray:
        """One field of one revolution, shape (n_x, n_y).

        Parameters
        ----------
        name : str
            A name of `FIELDS`.
        revolution : int, optional
            One of `field_revolutions`; the last by default.

        Raises
        ------
        LookupError
            If the field was not kept; the message lists what was.
        """
        if name not in self.fields:
            raise LookupError(f"no field {name!r}; there are {', '.join(self.fields) or 'none'}")
        return self.fields[name][self._row(revolution)]

    def stress(self, body: str, plane: str, revolution: int | None = None) -> "PlaneStress":
        """Stress of a body on a plane in one revolution.

        Parameters
        ----------
        body : "A" or "B"
            The body.
        plane : str
            The plane as the scene names it, "y=0".
        revolution : int, optional
            One of `field_revolutions`; the last by default.

        Raises
        ------
        LookupError
            If it was not kept; the message lists what was.
        """
        rows = self.stresses.get((body, str(plane)))
        if rows is None:
            kept = ", ".join(f"{plane} of {body}" for body, plane in self.planes)
            raise LookupError(
                f"no stress on {plane} of body {body}; there is {kept or 'none: add [subsurface]'}"
            )
        return rows[self._row(revolution)]

    def _row(self, revolution: int | None) -> int:
        """The row of a revolution among the records that kept their fields."""
        if revolution is None and len(self.field_revolutions):
            return len(self.field_revolutions) - 1
        rows = np.flatnonzero(self.field_revolutions == revolution)
        if not rows.size:
            kept = ", ".join(map(str, self.field_revolutions)) or "none"
            raise LookupError(f"no fields of revolution {revolution}; there are those of {kept}")
        return int(rows[-1])

    def to_dict(self) -> dict[str, Any]:
        """Scalars, points, balances and totals as plain numbers and lists; None for no number."""
        rows = {name: self[name].tolist() for name in (*self.scalars, *self.points)}
        rows |= {name: getattr(self, name).tolist() for name in ("energy_balance", "wear_balance")}
        in_bodies = {
            name: {body: self[name][:, k].tolist() for k, body in enumerate(self.bodies)}
            for name in (*self.body_scalars, *self.body_points)
        }
        reference = {"a0": self.a0, "b0": self.b0, "p0": self.p0}
        about = {"status": self.status, "message": self.message} | reference
        return _without_nan(about | rows | in_bodies | self.totals)


def _ratio(over: np.ndarray, under: np.ndarray, where: np.ndarray) -> np.ndarray:
    """Quotients, nan elsewhere."""
    return np.divide(over, under, out=np.full(len(over), np.nan), where=where)


def _stacked(
    records: Sequence[Record], kind: str, names: Iterable[str], shape: tuple[int, ...]
) -> dict[str, np.ndarray]:
    """Arrays with one row of that shape a record."""
    return {
        name: np.array(
            [padded(np.asarray(getattr(record, kind)[name], float), shape) for record in records]
        ).reshape(len(records), *shape)
        for name in names
    }


def _of_bodies(
    records: Sequence[Record],
    bodies: tuple[str, ...],
    names: Iterable[str],
    shape: tuple[int, ...],
) -> dict[str, np.ndarray]:
    """Arrays with one row a record and one column of that shape a body."""
    return {
        name: np.array(
            [[record.bodies[body][name] for body in bodies] for record in records], float
        ).reshape(len(records), len(bodies), *shape)
        for name in names
    }


def _by_plane(kept: Sequence[Record]) -> dict[tuple[str, str], list["PlaneStress"]]:
    first = kept[0].stress if kept else ()
    rows = {
        (one.body, str(one.plane)): [record.stress[k] for record in kept]
        for k, one in enumerate(first)
    }
    return dict(sorted(rows.items()))  # as a file has them


def padded(values: np.ndarray, shape: tuple[int, ...], outside: float = 0.0) -> np.ndarray:
    """The values in the middle of an array of zeros: the same function on a wider mesh.

    Raises
    ------
    ValueError
        If the wider mesh does not add the same number of elements on either side.
    """
    extra = np.subtract(shape, values.shape)
    if (extra < 0).any() or (extra % 2).any():
        raise ValueError(f"a mesh of {values.shape} elements is not the middle of one of {shape}")
    sides = [(n // 2, n // 2) for n in extra]
    return np.pad(values, sides, constant_values=outside) if extra.any() else values


def _without_nan(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _without_nan(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_without_nan(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
