"""Two runs that were given one file do not mix their records."""

import pytest

import tractive_sam as ts


def test_a_run_whose_file_was_taken_stops(tmp_path):
    path = tmp_path / "discs.h5"
    coarse = ["grid.half_length=[0.35, 0.7]", "grid.elements=[15, 15]", "wear.revolutions=3"]
    scene = ts.Scene.builtin("twin-discs").with_set(coarse)
    taken = []

    def take_over(record):
        if not taken:
            taken.append(record)
            ts.roll(scene, path, overwrite=True)

    with pytest.raises(ts.ResultsError, match="another run"):
        ts.roll(scene, path, progress=take_over)
    history = ts.open_history(path)
    assert history.status == "done"
    assert history["revolution"].tolist() == [0, 1, 2, 3]
