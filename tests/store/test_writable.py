"""Folders and names under which a file may be written; its mode is retained."""

import os
import stat

import numpy as np
import pytest

from tests.store.sample_records import SCENE, make_record, mesh
from tractive_sam.store import (
    HistoryWriter,
    Image,
    ResultsError,
    check_results,
    open_history,
    results_writer,
    write_volume,
)


def mode(path):
    return stat.S_IMODE(path.stat().st_mode)


def test_a_protected_file_is_not_replaced(finished):
    """Also not by the administrator, to whom the system allows all."""
    before = finished.read_bytes()
    finished.chmod(0o444)
    with pytest.raises(ResultsError, match=finished.name), results_writer(finished, True):
        pass
    with pytest.raises(ResultsError, match=finished.name):
        HistoryWriter(finished, SCENE, mesh(), overwrite=True)
    assert finished.read_bytes() == before


@pytest.mark.parametrize("kept", [0o600, 0o664])
def test_the_mode_of_a_file_is_kept(finished, kept):
    finished.chmod(kept)
    HistoryWriter.reopen(finished).append(make_record(7, with_fields=True))
    assert mode(finished) == kept
    HistoryWriter(finished, SCENE, mesh(), overwrite=True)
    assert mode(finished) == kept


def test_the_mode_of_a_new_file_is_as_usual(path, tmp_path):
    HistoryWriter(path, SCENE, mesh())
    usual = tmp_path / "usual"
    usual.touch()
    assert mode(path) == mode(usual)


def test_a_link_in_a_circle_is_reported(path):
    path.symlink_to(path)
    with pytest.raises(ResultsError, match=path.name):
        check_results(path)
    with pytest.raises(ResultsError, match=path.name):
        open_history(path)


@pytest.mark.parametrize("length", [218, 255])
def test_the_longest_names(tmp_path, length):
    path = tmp_path / ("x" * (length - 3) + ".h5")
    with results_writer(path):
        HistoryWriter(path, SCENE, mesh()).append(make_record(0, with_fields=True))
    assert len(open_history(path)) == 1
    volume = tmp_path / ("x" * (length - 7) + ".vtkhdf")
    layers = [{"von_mises": np.ones((2, 2))}] * 2
    write_volume(volume, Image((2, 2, 2), (0.0,) * 3, (1.0,) * 3), layers, SCENE, {})
    assert {file.name for file in tmp_path.iterdir()} == {path.name, volume.name}


def test_names_that_are_too_long_are_reported_as_that(tmp_path):
    path = tmp_path / ("x" * 253 + ".h5")
    with pytest.raises(ResultsError, match="xxx"):
        check_results(path)
    with pytest.raises(ResultsError, match="xxx"):
        open_history(path)


def test_a_folder_that_cannot_be_written_is_found_out_before(tmp_path, monkeypatch):
    # As the system refuses it; to the administrator, who may run this, it would not.
    def refused(*_args, **_kwargs):
        raise PermissionError(13, os.strerror(13))

    monkeypatch.setattr("pathlib.Path.touch", refused)
    with pytest.raises(ResultsError, match=r"(?i)permission denied"):
        check_results(tmp_path / "a.h5")
