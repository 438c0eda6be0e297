"""One reader for measured text: each case of writing a table gives its numbers, or is refused."""

import numpy as np
import pytest

from tractive_sam.text_table import LENGTHS, TextError, find_length_unit, find_scale, parse_table
from tractive_sam.text_table import read_table as read

Y = np.array([-3.0, -1.5, 0.25, 2.0, 10.125])
Z = np.array([0.5, -0.125, 1e-3, 0.0, 4.0])
LINES = [f"{y!r};{z!r}" for y, z in zip(Y.tolist(), Z.tolist(), strict=True)]
HEADER = "y [mm];z [µm]"
TABLE = "\n".join([HEADER, *LINES]) + "\n"
COMMA = TABLE.replace(".", ",")


def replace_first(text, number):
    return text.replace("0.25;", f"{number};")


SAME = {
    "as it is": TABLE,
    "with a mark": TABLE.encode("utf-8-sig"),
    "UTF-16": TABLE.encode("utf-16"),
    "UTF-16 without a mark": TABLE.encode("utf-16-be"),
    "Windows-1252": TABLE.encode("cp1252"),
    "DOS lines and end mark": TABLE.replace("\n", "\r\n").encode() + b"\x1a",
    "lines of old Macs": TABLE.replace("\n", "\r").encode(),
    "tabs": TABLE.replace(";", "\t"),
    "commas": TABLE.replace(";", ","),
    "blanks": TABLE.replace(";", "   "),
    "aligned": TABLE.replace(";", " ; ").replace("\n", "\n  "),
    "decimal commas": COMMA,
    "decimal commas and tabs": COMMA.replace(";", "\t"),
    "decimal commas and blanks": COMMA.replace(";", " "),
    "quoted cells": TABLE.replace(HEADER, '"y [mm]";"z [µm]"'),
    "quoted decimal commas": '"y, mm","z, um"\n'
    + "".join('"{}","{}"\n'.format(*line.replace(".", ",").split(";")) for line in LINES),
    "a row of units": TABLE.replace(HEADER, "y;z\nmm;µm"),
    "a row of units in brackets": TABLE.replace(HEADER, "y;z\n[mm];[micron]"),
    "names with underscores": TABLE.replace(HEADER, "y_(mm);z_(microns)"),
    "short names with underscores": TABLE.replace(HEADER, "y_mm;z_um"),
    "units after a slash": TABLE.replace(HEADER, "y / mm;z / µm"),
    "a header in a comment": "# " + TABLE,
    "comments": TABLE.replace("\n2.0", "\n# second scan\n% 1 2\n2.0"),
    "inline comments": TABLE.replace("0.5\n", "0.5  # first\n").replace("0.0\n", "0.0 ! last\n"),
    "trailing separators": TABLE.replace("\n", ";\n"),
    "separators after numbers alone": TABLE.replace("\n", ";\n").replace(";\n", "\n", 1),
    "an instrument's heading": "Instrument: own\nDate: 2024-05-17\n\n" + TABLE,
    "row numbers": "".join(
        f"{k - 1 if k else ''};{line}\n" for k, line in enumerate(TABLE.splitlines())),
    "Fortran exponents": replace_first(TABLE, "2.5D-01"),
    "minus signs of typesetters": TABLE.replace("-", "−"),
    "a number of rows": TABLE.replace("\n", "\n5\n", 1),
}  # fmt: skip


@pytest.mark.parametrize("case", SAME)
def test_one_table_with_each_notation(tmp_path, case):
    path = tmp_path / "table.txt"
    content = SAME[case]
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    table = read(path)
    np.testing.assert_array_equal(table.numbers(), np.stack([Y, Z], axis=1))
    assert (table.names, table.units) == (("y", "z"), ("mm", "um"))


REFUSED = {
    "thousands": (replace_first(TABLE, "1,000.25"), "line 4.*1,000.25"),
    "thousands without decimals": ("1,000;1\n950;2\n900;3\n", "line 1.*1,000"),
    "both decimal signs": (COMMA.replace("-3,0", "-3.0"), "line 2, '-3.0'"),
    "commas for both": ("1,25,1,75\n2,25,0,50\n", "line 1"),
    "a short row": (replace_first(TABLE, "0.25;1"), "line 4 of 3"),
    "a word": (replace_first(TABLE, "O.25"), "line 4, 'O.25' in column y"),
    "an underscore": (replace_first(TABLE, "1_0"), "line 4, '1_0'"),
    "a percentage": (TABLE.replace("4.0", "4.0 %"), "line 6, '4.0 %'"),
    "a missing cell": (TABLE.replace(";4.0", ";"), "line 6, ''"),
    "a line of numbers above": ("2024 05 17\n" + TABLE.replace(";", " "), "line 1, '2024 05 17'"),
    "a header of other length": ("x;" + TABLE, "line 1"),
    "two units of a column": (TABLE.replace("\n", "\nmm;nm\n", 1), "column 'z .*in nm"),
    "a second block": (TABLE + TABLE, "line 7, 'y .mm.'"),
    "no rows": (HEADER, "no rows"),
    "nothing": ("", "no rows"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_not_clear_is_refused_with_its_line(case):
    text, named = REFUSED[case]
    with pytest.raises(TextError, match=named) as error:
        parse_table(text).numbers()
    assert error.value.allowed


def test_bytes_that_are_no_text(tmp_path):
    (tmp_path / "a.txt").write_bytes(b"1;2\n\x81;3\n")  # not defined in Windows-1252
    with pytest.raises(TextError, match="Windows-1252"):
        read(tmp_path / "a.txt")


def test_missing_values_are_nan_on_request():
    cells = ["", "nan", "NaN", "-", "n/a", "--"]
    text = "y;z\n" + "\n".join(f"{k};{cell}" for k, cell in enumerate(cells)) + "\n6;1\n"
    values = parse_table(text).numbers(missing=True)
    np.testing.assert_array_equal(values, [[k, np.nan] for k in range(6)] + [[6.0, 1.0]])
    with pytest.raises(TextError, match="line 2, '' in column z and 5 more"):
        parse_table(text).numbers()
    with pytest.raises(TextError, match="inf"):
        parse_table("1 2\n2 inf\n").numbers(missing=True)


def test_remarks_keep_what_a_heading_states():
    table = parse_table("# Channel: Height\n# Width = 1.00 mm\nnote\n1 2 3\n4 5 6 # end\n")
    assert [(r.key, r.value) for r in table.remarks[:2]] == [
        ("channel", "Height"),
        ("width", "1.00 mm"),
    ]
    assert table.remarks[2:] == [(3, "note"), (5, "end")]
    assert table.lines == [4, 5]


@pytest.mark.parametrize(
    ("text", "result"),
    [("Gain: 1", "Gain"), ("Gain: 1.000", "Gain"), ("Magnification: 1x", "Magn"), ("Note: -", "N"),
     ("Operator: S", "Operator"), ("upside down: no", "upside"), ("left side", "left"),
     ("second scan", ""), ("Gain: 2", None), ("normal: N", None), ("heights: m", None)],
)  # fmt: skip
def test_remarks_are_named_and_scales_and_units_refused(text, result):
    table = parse_table(f"# {text}\n{TABLE}")
    if result is None:
        with pytest.raises(TextError, match="line 1"):
            table.find_unused(table.units)
    else:
        note = table.find_unused(table.units)
        assert f"line 1 '{result}" in note if result else not note


@pytest.mark.parametrize(
    ("text", "unit"),
    [("µm", "um"), ("μm", "um"), ("Micron", "um"), ("micrometers", "um"), ("inches", "in"),
     ("Å", "angstrom"), ("MM", "mm"), ("m", "m"), ("M", None), ("µin", "uin"), ("V", None)],
)  # fmt: skip
def test_units_of_length(text, unit):
    assert find_length_unit(text) == unit


def test_units_are_converted_to_those_of_a_meaning():
    assert find_scale("kN", "normal load P, N; in a line contact, N/mm") == 1e3
    assert find_scale("%", "longitudinal creepage xi_x") == 1e-2
    assert find_scale("", "anything, mm") == 1.0
    assert find_scale("um", "depth, mm") == LENGTHS["um"]
    assert find_scale("um", "normal load P, N") is None
    assert find_scale("furlong", "depth, mm") is None


def test_a_rule_below_the_header_and_the_separator_of_a_spreadsheet_are_no_content():
    table = parse_table("sep=;\ny [mm];z [um]\n----------\n1;2\n3;4\n")
    assert table.names == ("y", "z")
    assert table.units == ("mm", "um")
    assert not table.find_unused(table.units)
    with pytest.raises(TextError, match="no rows below the header; line 2, '1 mm;2 mm'"):
        parse_table("y;z\n1 mm;2 mm\n")
