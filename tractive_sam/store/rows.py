"""The rows of a results file: laid out, filled, and made wider."""

import h5py
import numpy as np

from tractive_sam.record import FIELDS, POINTS, PROFILES, SCALARS, Record
from tractive_sam.record.history import padded

ROWS = (*SCALARS, *POINTS, *PROFILES)
"""Datasets of /history with one row a record."""


def committed(file: h5py.File) -> int:
    """Number of complete records."""
    return int(file["history/committed"][()])


def full(file: h5py.File) -> bool:
    """Whether every row laid out is taken."""
    return committed(file) == len(file["history/record"])


def lay_out(file: h5py.File, count: int) -> None:
    """Change the number of rows in /history; on disk at once, so that filling moves nothing."""
    history = file["history"]
    for name in ROWS:
        before = len(history[name])
        history[name].resize(count, axis=0)
        history[name][before:] = history[name].fillvalue
    history["record"].resize(count, axis=0)
    history["record"][:] = np.arange(count)


def fill(file: h5py.File, record: Record) -> None:
    """Fill the first free row of /history, in place."""
    row, history = committed(file), file["history"]
    for values in (record.scalars, record.points, record.profiles):
        for name, value in values.items():
            history[name][row] = value
    # The number of complete records must not reach the disk before they do.
    file.flush()
    history["committed"][()] = row + 1
    file.flush()


def append_fields(file: h5py.File, record: Record) -> None:
    """Add a row to /fields, for the record that will next be filled in."""
    fields = file["fields"]
    values = {"record": committed(file), "revolution": record.revolution} | dict(record.fields)
    for name, value in values.items():
        fields[name].resize(len(fields[name]) + 1, axis=0)
        fields[name][-1] = value


def widen(file: h5py.File, x: np.ndarray, y: np.ndarray) -> None:
    """Change to a wider mesh, of which the present one is the middle."""
    history, fields = file["history"], file["fields"]
    for name in PROFILES:
        values = padded(history[name][:], (len(history[name]), len(y)))
        history[name].resize(values.shape)
        history[name][:] = values
    for name in FIELDS:
        _, n_x, n_y = fields[name].shape
        fields[name].resize((len(fields[name]), len(x), len(y)))
        for row in range(len(fields[name])):
            fields[name][row] = padded(fields[name][row, :n_x, :n_y], (len(x), len(y)))
    for name, centres in (("x", x), ("y", y)):
        file["grid"][name].resize(centres.shape)
        file["grid"][name][:] = centres
