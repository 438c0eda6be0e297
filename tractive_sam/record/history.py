"""The whole of a computation: every record, in memory or still on disk."""

import math
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol, Self

import numpy as np

from tractive_sam.record.quantities import FIELDS, POINTS, PROFILES, SCALARS
from tractive_sam.record.record import Record

FINISHED = ("done", "converged")
"""Values of `History.status` that mean that nothing is missing."""


class Rows(Protocol):
    """Fields of several records, read one at a time: an array, or something that reads a file."""

    def __len__(self) -> int:
        """Number of records with fields."""

    def __getitem__(self, row: int) -> np.ndarray:
        """The field of one record, shape (n_x, n_y)."""


@dataclass(frozen=True)
class History:
    """All records of a computation, under the names of `record.quantities`.

    Attributes
    ----------
    scene_toml : str
        The scene that was computed.
    status : str
        "done" or "converged"; "running" of a computation that still runs or was killed; else why
        it ended early.
    message : str
        What the status means and, where something is wrong, what to try.
    a0, b0, p0 : float
        Semi-axes in x and y, mm, and largest pressure, MPa, of the unworn contact by Hertz; nan
        where Hertz does not apply.
    x, y : ndarray, shapes (n_x,) and (n_y,)
        Centres of the elements, mm.
    scalars : mapping of str to ndarray, shape (n,)
        One number a record.
    points : mapping of str to ndarray, shape (n, 2)
        One position a record, mm.
    profiles : mapping of str to ndarray, shape (n, n_y)
        One function of y a record.
    fields : mapping of str to Rows, length m <= n
        One function of x and y for each record that kept its fields; see `field`.
    field_revolutions : ndarray of int, shape (m,)
        Revolutions of these records.
    totals : mapping of str to float
        "contact_solves" and "wall_seconds" of the whole computation, as far as known.
    versions : mapping of str to str
        Programs that computed it.
    """

    scene_toml: str
    status: str
    message: str
    a0: float
    b0: float
    p0: float
    x: np.ndarray
    y: np.ndarray
    scalars: Mapping[str, np.ndarray]
    points: Mapping[str, np.ndarray]
    profiles: Mapping[str, np.ndarray]
    fields: Mapping[str, Rows]
    field_revolutions: np.ndarray
    totals: Mapping[str, float]
    versions: Mapping[str, str]

    @classmethod
    def of_records(
        cls,
        records: Iterable[Record],
        scene_toml: str,
        x: np.ndarray,
        y: np.ndarray,
        *,
        a0: float = math.nan,
        b0: float = math.nan,
        p0: float = math.nan,
        status: str = "done",
        message: str = "",
        totals: Mapping[str, float] | None = None,
        versions: Mapping[str, str] | None = None,
    ) -> Self:
        """Collect records in memory; those of smaller meshes are padded to the mesh (x, y)."""
        records = list(records)
        kept = [record for record in records if record.fields]
        scalars = _stacked(records, "scalars", SCALARS, ())
        scalars["revolution"] = scalars["revolution"].astype(int)
        return cls(
            scene_toml,
            status,
            message,
            a0,
            b0,
            p0,
            x,
            y,
            scalars,
            points=_stacked(records, "points", POINTS, (2,)),
            profiles=_stacked(records, "profiles", PROFILES, y.shape),
            fields=_stacked(kept, "fields", FIELDS, x.shape + y.shape),
            field_revolutions=np.array([record.revolution for record in kept], dtype=int),
            totals=dict(totals or {}),
            versions=dict(versions or {}),
        )

    def __len__(self) -> int:
        return len(self.scalars["revolution"])

    def __getitem__(self, name: str) -> np.ndarray:
        """What was recorded under a name of `SCALARS`, `POINTS` or `PROFILES`, one row a record."""
        for kind in (self.scalars, self.points, self.profiles):
            if name in kind:
                return kind[name]
        raise KeyError(name)

    @property
    def finished(self) -> bool:
        """Whether the computation came to its end."""
        return self.status in FINISHED

    @cached_property
    def settings(self) -> dict[str, Any]:
        """The scene as plain tables."""
        return tomllib.loads(self.scene_toml)

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
        if revolution is None and len(self.field_revolutions):
            return self.fields[name][len(self.field_revolutions) - 1]
        rows = np.flatnonzero(self.field_revolutions == revolution)
        if not rows.size:
            kept = ", ".join(map(str, self.field_revolutions)) or "none"
            raise LookupError(f"no fields of revolution {revolution}; there are those of {kept}")
        return self.fields[name][int(rows[-1])]

    def to_dict(self) -> dict[str, Any]:
        """Scalars, points and totals as plain numbers and lists; None where there is no number."""
        rows = {name: self[name].tolist() for name in (*SCALARS, *POINTS)}
        reference = {"a0": self.a0, "b0": self.b0, "p0": self.p0}
        return _without_nan(
            {"status": self.status, "message": self.message} | reference | rows | self.totals
        )


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


def padded(values: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """The values in the middle of an array of zeros: the same function on a wider mesh.

    Raises
    ------
    ValueError
        If the wider mesh does not add the same number of elements on either side.
    """
    extra = np.subtract(shape, values.shape)
    if (extra < 0).any() or (extra % 2).any():
        raise ValueError(f"a mesh of {values.shape} elements is not the middle of one of {shape}")
    return np.pad(values, [(n // 2, n // 2) for n in extra]) if extra.any() else values


def _without_nan(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _without_nan(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_without_nan(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
