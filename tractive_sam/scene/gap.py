"""The [gap] table: a measured or worn separation added to that of the radii."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, BeforeValidator, PlainValidator

from .faults import Fault
from .quantities import LARGEST, SMALLEST, entry
from .table import Check, Known, Table

SUFFIXES = (".h5", ".npy", ".csv")
"""Formats of a gap file."""

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


def _existing(path: Path) -> Path:
    if path.suffix not in SUFFIXES:
        raise ValueError(f"a file ending in {', '.join(SUFFIXES)}")
    if not _ANYWHERE.get() and not os.path.isfile(
        path
    ):  # unlike Path.is_file, puts up with any text
        raise ValueError("an existing file")
    return path.absolute()  # scenes are written down and read again, in other folders as well


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


def _either_file_or_arrays(known: Known) -> Iterator[Fault]:
    given = [key for key in _ARRAYS if key in known.given]
    if "file" in known.given and given:
        yield Fault("file", f"together with {', '.join(given)}", "a file or the arrays, not both")
    elif "file" not in known.given:
        for key in _ARRAYS:
            if key not in given:
                yield Fault(key, "nothing", "a file, or all of x, y and separation")


def _fitting_shape(known: Known) -> Iterator[Fault]:
    if not known.given.issuperset(_ARRAYS):
        return
    x, y, separation = (known[key] for key in _ARRAYS)
    if separation.shape != (x.size, y.size):
        shape = f"the shape {separation.shape}"
        yield Fault("separation", shape, f"the shape ({x.size}, {y.size}), a row for each x")


_File = Annotated[
    Path,
    BeforeValidator(lambda text: Path(text) if isinstance(text, str) else text),
    AfterValidator(_existing),
]
_Array = Annotated[np.ndarray, PlainValidator(_array)]
_Axis = Annotated[_Array, AfterValidator(_axis)]


class Gap(Table):
    """A separation on a rectangular grid, from a file or as arrays; mm.

    `separation` has the shape (len(x), len(y)). The arrays are read-only. Only the existence of
    a file is checked here; a relative one is sought from the folder of the TOML file, or else from
    the working folder, and absolute from then on.

    Examples
    --------
    >>> groove = ts.Gap(x=[-5, 5], y=[-5, 0, 5], separation=[[0, 1e-3, 0], [0, 1e-3, 0]])
    >>> grooved = ts.solve(scene.replace(gap=groove))
    >>> grooved.converged
    True
    """

    file: _File | None = entry("measured separation", "the path of a file", None)
    x: _Axis | None = entry("x of the rows of separation, mm", "an array", None)
    y: _Axis | None = entry("y of the columns of separation, mm", "an array", None)
    separation: _Array | None = entry("separation to add to the radii', mm", "an array", None)
    checks: ClassVar[tuple[Check, ...]] = (_either_file_or_arrays, _fitting_shape)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Gap):
            return NotImplemented
        return self.file == other.file and all(
            np.array_equal(getattr(self, key), getattr(other, key)) for key in _ARRAYS
        )

    def __hash__(self) -> int:
        arrays = (getattr(self, key) for key in _ARRAYS)
        return hash((self.file, *(None if a is None else a.tobytes() for a in arrays)))
