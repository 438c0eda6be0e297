"""Tests of tables of creep forces, and what they share."""

import h5py

from tractive_sam.store.opening import SEAL
from tractive_sam.tables import builtin_tables


def copy_without_seal(path):
    """Copy the built-in table as a file of another program, which has no seal; return its path."""
    content = builtin_tables()["steel"].read_bytes()
    path.write_bytes(content[: content.rindex(SEAL)])
    with h5py.File(path, "r+") as file:
        del file.attrs["checksum"]
    return path
