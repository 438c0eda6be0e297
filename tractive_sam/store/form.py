"""The form of a results file: groups and datasets as they were laid out."""

import tomllib
from collections.abc import Iterator

import h5py

from tractive_sam.results.quantities import (
    ADDED,
    BODY_POINTS,
    BODY_SCALARS,
    FIELDS,
    POINTS,
    PROFILES,
    SCALARS,
    STATE,
    STRESS,
)
from tractive_sam.store.rows import SLOTS, committed, planes

GROUPS = ("grid", "history", "fields", "stress", "state")


def check_form(file: h5py.File) -> None:
    """Find what another program, or a damaged disk, has put in place of what was written.

    Raises
    ------
    KeyError
        If a dataset is missing.
    ValueError
        If a dataset has another shape or another kind of numbers, or if a text is none.
    """
    _check_texts(file)
    rows = len(file["history/record"])
    if not 0 <= committed(file) <= rows:
        raise ValueError(f"{committed(file)} of {rows} records")
    for dataset, shape in _forms(file):
        numbers = dataset.dtype.kind in "fiu"
        if not numbers or dataset.shape != shape or dataset.maxshape[0] is not None:
            found = f"{dataset.dtype} of the shape {dataset.shape}"
            raise ValueError(f"{dataset.name} holds {found}, not numbers of the shape {shape}")


def _check_texts(file: h5py.File) -> None:
    scene = file["scene"]
    tomllib.loads(scene[()].decode())
    for name in ("status", "message"):
        if not isinstance(scene.attrs[name], str):
            raise ValueError(f"the {name} is no text")


def _forms(file: h5py.File) -> Iterator[tuple[h5py.Dataset, tuple[int, ...]]]:
    """Every dataset of numbers, with the shape it is to have."""
    grid, history, fields = file["grid"], file["history"], file["fields"]
    mesh = (len(grid["x"]), len(grid["y"]))
    yield from ((grid[axis], (count,)) for axis, count in zip("xy", mesh, strict=True))
    rows = len(history["record"])
    for name in SCALARS:
        if name in history or name not in ADDED:
            yield history[name], (rows,)
    for name in POINTS:
        yield history[name], (rows, 2)
    for name in PROFILES:
        yield history[name], (rows, mesh[1])
    if "body" in history:
        bodies = len(history["body"])
        yield from ((history[name], (rows, bodies)) for name in BODY_SCALARS)
        yield from ((history[name], (rows, bodies, 3)) for name in BODY_POINTS)
    kept = len(fields["record"])
    yield fields["revolution"], (kept,)
    yield from ((fields[name], (kept, *mesh)) for name in FIELDS)
    yield from ((file["state"][name], (SLOTS, *mesh)) for name in STATE)
    for plane in planes(file):
        axes = tuple(len(plane[axis]) for axis in ("x", "y", "depth") if axis in plane)
        kept = len(plane["record"])
        yield plane["revolution"], (kept,)
        yield from ((plane[name], (kept, *axes)) for name in STRESS)
