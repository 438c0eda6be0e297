"""A trait of a measured file gives the numbers of the plain file, or a fault that names the cause.

Kinds of files and traits come from benchmarks/file_traits.py, which also combines traits at random.
"""

import re
from pathlib import Path

import numpy as np
import pytest

NAMED = ("trace", "points")
COLUMNS = (*NAMED, "load history", "fit")
ALL = (*COLUMNS, "matrix")
FAULTS = {
    "decimal commas between commas": (ALL, "commas between columns|a finite number"),
    "slash": (("load history", "fit"), "column"),
    "no header": (("load history", "fit"), "header"),
    "row numbers ''": ((*NAMED, "load history", "matrix"), "columns|unknown column|evenly spaced"),
    "row numbers 'index'": (("matrix",), "evenly spaced"),
    "row numbers 'No'": (("matrix",), "evenly spaced"),
    "row numbers 'k'": ((*NAMED, "load history", "matrix"), "k |k:|evenly spaced"),
    "time column": ((*NAMED, "matrix"), "time|evenly spaced"),
    "second height": ((*NAMED, "load history"), "z2"),
    "unknown unit": (COLUMNS, "furlong"),
    "no unit of heights": (NAMED, "without the unit of z|without the unit of height"),
    "unit in a heading": (COLUMNS, "line 1, 'Value units: m'"),
    "unit in free words": (ALL, "line 1, 'all heights in nm'"),
    "scale in a heading": (ALL, "line 1, 'Z scale: 0.1'"),
    "offset in a heading": (ALL, "line 1, 'Offset = 5'"),
    "scale in words": (ALL, "line 1, 'Data multiplied"),
    "magnification": (ALL, "line 1, 'vertical"),
    "formula in a comment": (ALL, "line 1, 'z = 2"),
    "calibration": (ALL, "line 1, 'Calib"),
    "upside down in words": (ALL, "line 1, 'z is"),
    "columns in a heading": (ALL, "line 1, 'Columns: 14', but"),
    "factor in a name": (COLUMNS, "column"),
    "sign in a name": (COLUMNS, "column"),
    "size in a heading": (("matrix",), "gap.step"),
    "points in a heading": (ALL, "line 1, 'Points: 4', but"),
    "cell 'nan'": (ALL, "line [0-9]+, 'nan'"),
    "cell ''": (ALL, "line [0-9]+, ''"),
    "cell '-'": (ALL, "line [0-9]+, '-'"),
    "cell '--'": (ALL, "line [0-9]+, '--'"),
    "cell 'n/a'": (ALL, "line [0-9]+, 'n/a'"),
    "cell '-9999'": (ALL, "line [0-9]+, '-9999'"),
    "cell '1.#QNAN'": (ALL, "line [0-9]+, '1.#QNAN'"),
    "cell 'O.1'": (ALL, "line [0-9]+, 'O.1'"),
    "cell '1_0'": (ALL, "line [0-9]+, '1_0'"),
    "cell '50 %'": (ALL, "line [0-9]+, '50 %'"),
    "cell 'inf'": (ALL, "line [0-9]+, 'inf'"),
    "cell '0.1 0.2'": (ALL, "line [0-9]+, '0.1 0.2'"),
    "cell '1e'": (ALL, "line [0-9]+, '1e'"),
    "long row": (ALL, "line [0-9]+ of [0-9]+ cells"),
    "second block": (ALL, "line [0-9]+"),
    "thousands": (COLUMNS, "thousands"),
    "depths": (NAMED, "gap.positive"),
    "cut file": (ALL, "line 1, 'Points: [0-9]+', but"),
    **{f"gain after '{mark}'": (ALL, "gain = 2'") for mark in ("//", "*", "REM")},
    "gain after ';'": (ALL, "gain = 2|unknown column|no column"),
    "unit with a factor": (ALL, "line 1, 'Value units: 1e-4 m'"),
    "per cent in a comment": (ALL, "line 1, 'values in per cent'"),
    "summary below the table": (ALL, "'mean'|cells"),
    "flags": (ALL, "a header of|'OK'"),
    "thousands with apostrophes": (COLUMNS, "with the unit|[0-9]'[0-9]"),
    "exponents after blanks": (ALL, "no rows below the header; line [0-9]+, '.* e"),
    "units in cells": (ALL, "no rows below the header; line [0-9]+, '.* mm"),
}
"""Kinds of files that are refused, and the message, by trait; all other traits change nothing."""

NOTES = {
    "remark with a number": "line 1 'tare: 50 N'",
    "instrument's heading": "line 1 'Instrument: own stylus'",
}
"""Notes on what is not used, by trait."""

UNREAD = {"factor below the table": "'all values x 0.5'"}
"""Notes on what would change the numbers, by trait."""


@pytest.fixture
def file_traits(monkeypatch):
    monkeypatch.syspath_prepend(Path(__file__).parents[1] / "benchmarks")
    import file_traits  # noqa: PLC0415 - not on the path before

    return file_traits


@pytest.mark.parametrize("kind", ALL)
def test_each_trait_gives_the_same_numbers_or_its_fault(file_traits, tmp_path, kind):
    rng = np.random.default_rng(3)
    assert {*FAULTS} <= {*file_traits.TRAITS}
    for trait in file_traits.TRAITS:
        outcome = file_traits.try_file(kind, (trait,), tmp_path, rng)
        kinds, message = FAULTS.get(trait, ((), ""))
        words = re.match("words '(.*)'", trait)  # a remark that nothing reads: other numbers
        unread = words[1] if words else UNREAD.get(trait, "")
        result = "fault" if kind in kinds else "note" if unread else "same"
        assert outcome.result == result, outcome
        message = message if kind in kinds else unread or NOTES.get(trait, "")
        assert re.search(message, outcome.message), outcome


@pytest.mark.slow
@pytest.mark.parametrize("kinds", [ALL, ("wheel", "rail")], ids=["columns", "profiles"])
def test_random_traits_give_no_other_numbers_without_a_word(file_traits, kinds):
    outcomes = [*file_traits.try_traits(40, seed=7, kinds=kinds)]
    assert {outcome.result for outcome in outcomes} <= {"same", "note", "fault"}, outcomes
