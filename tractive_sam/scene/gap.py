"""The [gap] table: a measured or worn separation, or profile, added to the radii."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, PlainValidator

from tractive_sam.schema import (
    LARGEST,
    SMALLEST,
    Check,
    Fault,
    FilePath,
    PositivePair,
    Row,
    Table,
    ValidEntries,
    entry,
)

TEXTS = (".csv", ".txt", ".dat", ".tsv", ".xyz", ".asc")
SUFFIXES = (".h5", ".npy", ".npz", *TEXTS)
"""Formats of a gap file."""

LENGTHS = {"m": 1e3, "mm": 1.0, "um": 1e-3, "nm": 1e-6}
"""Units of lengths, mm."""

ALONG = 1e6
"""Distance to either side, mm, over which a profile across the track is the same."""

_ARRAYS = ("x", "y", "separation")


_ANYWHERE = ContextVar("gap files need not be there", default=False)


@contextmanager
def files_anywhere() -> Iterator[None]:
    """Let scenes name gap files that are not there: those that were computed, and then moved."""
    before = _ANYWHERE.set(True)
    try:
        yield
    finally:
        _ANYWHERE.reset(before)


def named(path: Path, suffixes: tuple[str, ...]) -> Path:
    """The absolute path of a file, which need not be there.

    Raises
    ------
    ValueError
        If it ends in no such suffix.
    """
    if path.suffix not in suffixes:
        raise ValueError(f"a file ending in {', '.join(suffixes)}")
    return path.absolute()  # scenes are written down and read again, in other folders as well


def _existing(path: Path) -> Path:
    found = named(path, SUFFIXES)
    # os.path.isfile, unlike Path.is_file, puts up with any text.
    if not _ANYWHERE.get() and not os.path.isfile(found):
        raise ValueError("an existing file")
    return found


def _array(value: Any) -> NDArray[np.float64]:
    if np.ma.is_masked(value):
        raise ValueError("an array without masked points")
    try:
        array = np.array(value)
    except ValueError:
        array = np.array(None)
    if array.dtype.kind not in "iuf" or not np.all(np.isfinite(array)):
        raise ValueError("an array of finite numbers")
    array = array.astype(float) + 0.0  # no negative zeros: equal arrays have equal bytes
    if array.size and np.abs(array).max() > LARGEST:
        raise ValueError(f"numbers of at most {LARGEST:g} in magnitude")
    array.flags.writeable = False
    return array


def _axis(array: NDArray[np.float64]) -> NDArray[np.float64]:
    if array.ndim != 1 or array.size < 2 or not np.all(np.diff(array) >= SMALLEST):
        raise ValueError("at least 2 increasing numbers")
    return array


def _either_file_or_arrays(entries: ValidEntries) -> Iterator[Fault]:
    given = [key for key in _ARRAYS if key in entries.given]
    if "file" in entries.given and given:
        yield Fault("file", f"together with {', '.join(given)}", "a file or the arrays, not both")
    elif "file" not in entries.given:
        for key in _ARRAYS:
            if key not in given:
                yield Fault(key, "nothing", "a file, or all of x, y and separation")


def _fitting_shape(entries: ValidEntries) -> Iterator[Fault]:
    if not entries.given.issuperset(_ARRAYS):
        return
    x, y, separation = (entries[key] for key in _ARRAYS)
    if separation.shape != (x.size, y.size):
        shape = f"the shape {separation.shape}"
        yield Fault("separation", shape, f"the shape ({x.size}, {y.size}), a row for each x")


def _heights_of_a_body(entries: ValidEntries) -> Iterator[Fault]:
    if "positive" in entries.given and "body" not in entries.given:
        cure = "gap.body as well: only heights of a body point out of it or into it"
        yield Fault("positive", entries["positive"], cure)


def _step_of_a_file(entries: ValidEntries) -> Iterator[Fault]:
    if "step" in entries.given and "file" not in entries.given:
        yield Fault("step", entries["step"], "a file that holds no x and y; arrays have theirs")


_Unit = Literal["m", "mm", "um", "nm"]
_UNITS = f"one of {', '.join(LENGTHS)}"

_File = Annotated[FilePath, AfterValidator(_existing)]
_Array = Annotated[np.ndarray, PlainValidator(_array)]
_Axis = Annotated[_Array, AfterValidator(_axis)]


class Gap(Table):
    """A separation on a rectangular grid, or the heights of a body, from a file or as arrays.

    `separation` has the shape (len(x), len(y)); without x it is a profile (len(y),), the same all
    along the track. The arrays are read-only. Only the existence of
    a file is checked here; a relative one is sought from the folder of the TOML file, or else from
    the working folder, and absolute from then on. What a file may hold tells `store.read_gap`.

    Examples
    --------
    >>> groove = ts.Gap(y=[-5, 0, 5], separation=[0, 1e-3, 0])
    >>> grooved = ts.solve(scene.replace(gap=groove))
    >>> grooved.converged
    True
    """

    file: _File | None = entry("measured separation", "the path of a file", None)
    x: _Axis | None = entry("x of the rows of separation, mm", "an array", None)
    y: _Axis | None = entry("y of the columns of separation, mm", "an array", None)
    separation: _Array | None = entry("separation to add to the radii', mm", "an array", None)
    body: Literal["A", "B"] | None = entry(
        "body whose heights are given in place of a separation", "A or B", None
    )
    positive: Literal["outward", "inward"] = entry(
        "where positive heights point: out of the body (peaks) or into it (depths)",
        "outward or inward",
        "outward",
    )
    unit: _Unit | None = entry(
        "unit of the separation or the heights; else that in the file's header, or mm", _UNITS, None
    )
    length_unit: _Unit | None = entry(
        "unit of x and y; else that in the file's header, or mm", _UNITS, None
    )
    step: PositivePair | None = entry(
        "spacing of a matrix without x and y, in the unit of x and y; it is centred at 0",
        "two numbers above 0",
        None,
    )
    checks: ClassVar[tuple[Check, ...]] = (
        _either_file_or_arrays,
        _fitting_shape,
        _heights_of_a_body,
        _step_of_a_file,
    )

    def describe(self, scene: Any) -> Iterator[Row]:
        """See `Table.describe`."""
        source = self.file.name if self.file else "an array"
        yield Row("separation", f"of the radii, and the measured one of [gap], {source}")

    @classmethod
    def unfold(cls, given: Mapping[Any, Any]) -> Mapping[Any, Any]:
        """A profile across the track, without x, as the same all along it."""
        profile = given.get("separation")
        row = isinstance(profile, list | tuple) and not any(map(np.ndim, profile))
        row = row or (isinstance(profile, np.ndarray) and profile.ndim == 1)
        if given.get("x") is not None or not row:
            return given
        return {**given, "x": [-ALONG, ALONG], "separation": np.ma.array([profile, profile])}

    def in_mm(self, x: Any, y: Any, values: Any, units: tuple[str, str] = ("mm", "mm")) -> Any:
        """x, y and separation in mm, of what was measured.

        Parameters
        ----------
        x, y, values : ndarray
            As measured, in the units of this table.
        units : tuple of str
            Of x and y, and of values, where this table has none.
        """
        length = LENGTHS[self.length_unit or units[0]]
        height = LENGTHS[self.unit or units[1]]
        if self.body is not None and self.positive == "outward":
            height = -height  # what stands out of either body closes the gap
        return length * x, length * y, height * values + 0.0

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Gap):
            return NotImplemented
        return self._compared() == other._compared()

    def __hash__(self) -> int:
        return hash(self._compared())

    def _compared(self) -> tuple[Any, ...]:
        given = (getattr(self, key) for key in type(self).model_fields)
        return tuple(a.tobytes() if isinstance(a, np.ndarray) else a for a in given)
