"""What the log of complete cases holds is what was written, or it does not count."""

import json

import pytest

from tests.studies.conftest import small
from tractive_sam.studies import open_study, study
from tractive_sam.studies.design import CaseLog


def entry(digest, value=0.25):
    row = {"Qx": value, "stick_fraction": 1.0}
    return {"digest": digest, "size": 0, "version": "1.0", "message": "as asked", "row": row}


WRITTEN = {digest: entry(digest) for digest in ("0123456789abcdef", "fedcba9876543210")}


@pytest.fixture
def log(tmp_path):
    log = CaseLog(tmp_path / "complete.jsonl")
    for one in WRITTEN.values():
        log.append(one)
    return log


def test_holds_what_was_written(log):
    assert log.read().entries == WRITTEN
    assert log.read().damage_note == ""


def test_every_flipped_bit_is_detected(log):
    content = log.path.read_bytes()
    for place in range(len(content)):
        for bit in range(8):
            damaged = bytearray(content)
            damaged[place] ^= 1 << bit
            log.path.write_bytes(damaged)
            found = log.read()
            assert found.entries.items() <= WRITTEN.items(), (place, bit)
            # The end of line before the first entry is no part of it.
            assert len(found.entries) < len(WRITTEN), (place, bit)
            assert "damaged" in found.damage_note


def test_every_cut_is_detected(log):
    content = log.path.read_bytes()
    for length in range(len(content)):
        log.path.write_bytes(content[:length])
        assert log.read().entries.items() <= WRITTEN.items()
        log.append(entry("ab"))  # what comes after the cut is not lost with it
        assert log.read().entries["ab"] == entry("ab")


def test_numbers_changed_by_hand_do_not_count(log):
    log.path.write_text(log.path.read_text().replace("0.25", "999.0", 1))
    found = log.read()
    assert found.entries == dict(list(WRITTEN.items())[1:])
    assert found.damaged == 1


def test_entries_without_checksum_count_before_the_first_one_that_has_one(tmp_path):
    log = CaseLog(tmp_path / "complete.jsonl")
    log.path.write_text(f"\n{json.dumps(entry('ab'))}\n{json.dumps(entry('cd'))}\n" + '{"digest')
    assert set(log.read().entries) == {"ab", "cd"}
    log.append(entry("ef"))
    log.path.write_bytes(log.path.read_bytes() + b"\n" + json.dumps(entry("12")).encode())
    assert set(log.read().entries) == {"ab", "cd", "ef"}
    assert log.read().damaged == 2
    log.drop_damaged()
    assert set(log.read().entries) == {"ab", "cd", "ef"}
    assert log.read().damaged == 0


def test_a_damaged_case_is_reported_and_computed_again(tmp_path):
    requested = small(keep="scalars")
    results = study(requested, tmp_path)
    file = tmp_path / "complete.jsonl"
    content = bytearray(file.read_bytes())
    content[content.index(b"\n") // 2] ^= 4  # of the first line; a flipped end of it damages two
    file.write_bytes(content)
    shown = open_study(tmp_path)
    assert "complete.jsonl" in shown.damage_note
    assert shown.counts["waiting"] == 1
    notes = []
    again = study(requested, tmp_path, say=notes.append)
    assert notes == [shown.damage_note]
    assert again.complete
    assert again.damage_note == ""
    # What the tolerance of the scenes, 1e-8, leaves of a solution.
    assert again.column("Qx") == pytest.approx(results.column("Qx"), rel=1e-6)
