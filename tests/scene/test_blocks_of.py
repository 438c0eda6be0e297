"""Blocks of a measured load history."""

import numpy as np
import pytest

import tractive_sam as ts

RANDOM = np.random.default_rng(5)
MEASURED = {
    "normal": RANDOM.uniform(100.0, 500.0, 400),
    "longitudinal": -RANDOM.uniform(1e-3, 5e-3, 400),
    "revolutions": RANDOM.integers(1, 20, 400),
}


def test_revolutions_and_means_are_kept():
    binned = ts.blocks_of(MEASURED, levels=5)
    assert len(binned.blocks) <= 25
    n = np.array([one.revolutions for one in binned.blocks])
    load = np.array([one.load.normal for one in binned.blocks])
    assert n.sum() == MEASURED["revolutions"].sum()
    mean = np.average(MEASURED["normal"], weights=MEASURED["revolutions"])
    assert n @ load / n.sum() == pytest.approx(mean, rel=1e-12)


def test_the_error_falls_with_the_levels():
    """Half a level at most; in a level of even spread 1/sqrt(12) of it."""
    errors = [ts.blocks_of(MEASURED, levels=n).error["normal"] for n in (2, 4, 8, 16)]
    ratios = np.divide(errors[:-1], errors[1:])
    np.testing.assert_allclose(ratios, 2.0, rtol=0.3)  # of 400 rows, fewer in a level
    work = [ts.blocks_of(MEASURED, levels=n).work_error for n in (1, 16)]
    assert work[1] < work[0] < 0.05
    assert ts.blocks_of(MEASURED, levels=1000).work_error < 1e-5


def test_a_file_is_its_table(tmp_path):
    path = tmp_path / "measured.csv"
    rows = zip(*(values.tolist() for values in MEASURED.values()), strict=True)
    path.write_text("\n".join([",".join(MEASURED), *(",".join(map(repr, r)) for r in rows)]))
    assert ts.blocks_of(path).blocks == ts.blocks_of(MEASURED).blocks


@pytest.mark.parametrize(
    ("measured", "levels", "key"),
    [
        ({"weight": [1.0]}, 2, "weight"),
        ({"normal": [1.0, 2.0], "spin": [1.0]}, 2, "columns"),
        ({"normal": []}, 2, "columns"),
        ({"normal": [np.nan]}, 2, "columns"),
        ({"normal": ["a"]}, 2, "columns"),
        ({"revolutions": [1]}, 2, "columns"),
        ({"normal": [1.0], "revolutions": [0]}, 2, "revolutions"),
        ({"normal": [1.0]}, 0, "levels"),
        ("none.csv", 2, "measured"),
    ],
)
def test_what_is_wrong_is_told(measured, levels, key):
    with pytest.raises(ts.SceneError) as caught:
        ts.blocks_of(measured, levels)
    assert [fault.key for fault in caught.value.faults] == [key]
