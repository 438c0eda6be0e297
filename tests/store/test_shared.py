"""A results file opens whatever else this process, or another one, has it open with."""

import shutil
import subprocess
import sys

import h5py
import numpy as np
import pytest

from tests.store.sample_records import make_record
from tractive_sam.store import DamagedError, HistoryWriter, ResultsError, open_history
from tractive_sam.store.opening import open_results

OPENINGS = {
    "h5py": lambda path: h5py.File(path, "r"),
    "h5py locked": lambda path: h5py.File(path, "r", locking=True),
    "h5py unlocked": lambda path: h5py.File(path, "r", locking=False),
    "h5py best effort": lambda path: h5py.File(path, "r", locking="best-effort"),
    "h5py for writing": lambda path: h5py.File(path, "r+"),
    "h5py of earlier files": lambda path: h5py.File(path, "r", libver="earliest"),
    "xarray": lambda path: _xarray(path, "h5netcdf", phony_dims="sort"),
    "xarray by netCDF": lambda path: _xarray(path, "netcdf4"),
    "netCDF": lambda path: pytest.importorskip("netCDF4").Dataset(path),
}


def _xarray(path, engine, **options):
    pytest.importorskip({"netcdf4": "netCDF4"}.get(engine, engine))
    xarray = pytest.importorskip("xarray")
    return xarray.open_dataset(path, engine=engine, group="history", **options)


def read(path):
    history = open_history(path)
    return history["Qx"].tolist(), history.field("pressure", history.saved[-1]).sum()


@pytest.mark.slow
@pytest.mark.parametrize("opened", OPENINGS)
def test_opens_while_other_code_has_it_open(finished, opened):
    expected = read(finished)
    before = open_history(finished)
    other = OPENINGS[opened](finished)
    try:
        assert read(finished) == expected
        assert before.field("pressure", before.saved[-1]).sum() == expected[1]
    finally:
        other.close()
    assert read(finished) == expected


@pytest.mark.slow
@pytest.mark.parametrize("opened", [name for name in OPENINGS if name != "h5py for writing"])
def test_other_code_opens_it_while_it_is_read_and_written(finished, opened):
    with open_results(finished):
        OPENINGS[opened](finished).close()
    other = OPENINGS[opened](finished)
    try:
        with HistoryWriter.reopen(finished) as writer:
            count = len(open_history(finished))
            writer.append(make_record(count))
            OPENINGS[opened](finished).close()
            writer.finish("done")
    finally:
        other.close()
    assert len(open_history(finished)) == count + 1


def test_what_another_process_has_open_for_writing_is_not_damaged(finished):
    code = "import h5py, sys; file = h5py.File(sys.argv[1], 'r+'); file.flush(); print(1); input()"
    with subprocess.Popen(
        [sys.executable, "-uc", code, finished], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as other:
        assert other.stdout.readline()
        with pytest.raises(ResultsError, match=r"history\.h5.*writing") as error:
            open_history(finished)
        assert not isinstance(error.value, DamagedError)
        other.communicate(b"\n")
    assert len(open_history(finished)) == 7


@pytest.mark.slow
@pytest.mark.parametrize(
    ("opened", "at"),  # version, sizes, flags, checksum of the head
    [*((None, at) for at in (8, 9, 11, 13, 44)), ("h5py", 8), ("xarray", 44)],
)
def test_damage_is_reported_as_such(finished, tmp_path, opened, at):
    content = bytearray(finished.read_bytes())
    content[at] ^= 1
    # In a copy, as a file that is open elsewhere was complete when it was opened.
    damaged = shutil.copy(finished, tmp_path / "damaged.h5")
    other = None if opened is None else OPENINGS[opened](damaged)
    with damaged.open("rb+") as file:
        file.write(content)
    try:
        with pytest.raises(DamagedError, match=r"damaged\.h5"):
            np.array(open_history(damaged)["Qx"])
    finally:
        if other is not None:
            other.close()
