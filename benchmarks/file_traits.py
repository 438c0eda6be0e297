"""Are traits of measured text files read correctly, or refused?

Small files of each kind are written with random traits: column order, units, signs, encodings,
separators, missing points, digits, headings. The program must read the numbers of the plain file,
or report a fault or a note; other numbers without a word count as silent.

Page: none
"""

import argparse
import sys
import tempfile
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

import tractive_sam as ts
from tractive_sam.fitting.data import read_measured
from tractive_sam.fitting.design import Data, FitError
from tractive_sam.rail import ProfileError, builtin_profile, place_rail, read_profile
from tractive_sam.rail.measured import check_datum
from tractive_sam.store import read_gap


@dataclass(frozen=True)
class Sheet:
    """Numbers of a file and how they are written."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    values: np.ndarray
    settings: dict = field(default_factory=dict)
    separator: str = ";"
    decimal: str = "."
    encoding: str = "utf-8"
    line_end: str = "\n"
    header: str = "{name} [{unit}]"
    heading: tuple[str, ...] = ()
    digits: str = "{:.12g}"
    exponent: str = "e"
    cells: dict = field(default_factory=dict)  # texts by row and column, instead of numbers
    row_end: Callable[[int], str] = lambda row: ""
    between: dict = field(default_factory=dict)  # lines before rows
    tail: bytes = b""

    def write(self, path: Path) -> None:
        rows = []
        for k, row in enumerate(self.values):
            texts = [self.digits.format(v).replace(".", self.decimal) for v in row]
            texts = [text.replace("e", self.exponent) for text in texts]
            texts = [self.cells.get((k, n), text) for n, text in enumerate(texts)]
            rows += [*self.between.get(k, ()), self.separator.join(texts) + self.row_end(k)]
        lines = [*self.heading, *self._header_lines(), *rows]
        text = self.line_end.join([*lines, ""])
        path.write_bytes(text.encode(self.encoding, errors="replace") + self.tail)

    def _header_lines(self) -> list[str]:
        if not self.names or not self.header:
            return []
        if self.header == "row of units":
            return [self.separator.join(self.names), self.separator.join(self.units)]
        pairs = zip(self.names, self.units, strict=True)
        labels = [self.header.format(name=name, unit=unit) for name, unit in pairs]
        return [("# " * self.header.startswith("#")) + self.separator.join(labels).replace("#", "")]

    def column(self, values: np.ndarray, name: str, unit: str, place: int) -> "Sheet":
        """Return a sheet with one more column."""
        names = (*self.names[:place], name, *self.names[place:]) if self.names else ()
        units = (*self.units[:place], unit, *self.units[place:]) if self.names else ()
        return replace(
            self, names=names, units=units, values=np.insert(self.values, place, values, axis=1)
        )


Y = np.linspace(-3.0, 3.0, 13)
X = np.linspace(-1.0, 1.0, 5)
MAP = 2e-3 * np.cos(3.0 * X)[:, None] * np.cos(1.3 * Y + 0.2) + 1e-4 * Y  # mm
LOADS = np.array([[300.0 + 40.0 * np.sin(k), -0.004 + 1e-3 * np.cos(2.0 * k)] for k in range(12)])
CREEP = np.array([[-0.0005 * k, 0.45 * np.tanh(0.4 * k)] for k in range(1, 9)])


def read_trace(path: Path, sheet: Sheet) -> np.ndarray:
    _, y, separation = read_gap(ts.Gap(file=path, body="A", **sheet.settings))
    return np.concatenate([y, separation[0]])


def read_map(path: Path, sheet: Sheet) -> np.ndarray:
    return np.concatenate(
        [np.ravel(a) for a in read_gap(ts.Gap(file=path, body="A", **sheet.settings))]
    )


def read_loads(path: Path, sheet: Sheet) -> np.ndarray:
    blocks = ts.blocks_of(path, levels=4).blocks
    rows = [[b.load.normal, b.creepage.longitudinal, b.revolutions] for b in blocks]
    return np.array(sorted(rows)).ravel()


def read_fit(path: Path, sheet: Sheet) -> np.ndarray:
    columns = {"vary": "creepage.longitudinal", "observe": "Qx_over_P"}
    measured = read_measured(Data(file=str(path), noise=0.05, **columns), "fit.data[0]")
    slips = [row["creepage.longitudinal"] for row in measured.settings]
    return np.array(sorted(zip(slips, measured.observed[:, 0], strict=True))).ravel()


def read_rail_or_wheel(path: Path, sheet: Sheet) -> np.ndarray:
    profile = read_profile(path, **sheet.settings)
    notes = profile.notes
    try:
        if sheet.settings["kind"] == "wheel":
            notes = (*notes, check_datum(profile, 70.0))
        else:
            profile = place_rail(profile, 40.0, 1435.0)
    except ValueError as error:  # a fault of a scene
        raise ProfileError(str(error)) from None
    for note in filter(None, notes):
        warnings.warn(note, stacklevel=2)
    # The middle of the rail lies 757 mm from the middle of the track.
    middle = 0.0 if sheet.settings["kind"] == "wheel" else 757.0
    heights = profile.height(np.linspace(-25.0, 25.0, 101) + middle)
    return 1.0 + 0.2 * heights  # equal within 0.001 mm: a last digit of six


WHEEL, RAIL = (
    profile.at(np.arange(*profile.s[[0, -1]], 0.6))
    for profile in map(builtin_profile, ("S1002", "60E1"))
)
RAIL[:, 1] += 0.3 * np.exp(-(((RAIL[:, 0] - 12.0) / 4.0) ** 2))  # worn on one side

POINTS = np.array(
    [[x, y, z] for x, row in zip(X, MAP, strict=True) for y, z in zip(Y, row, strict=True)]
)
KINDS = {
    "trace": (Sheet(("y", "z"), ("mm", "um"), np.stack([Y, 1e3 * MAP[1]], axis=1)), read_trace),
    "points": (Sheet(("x", "y", "height"), ("mm", "mm", "um"), POINTS * [1, 1, 1e3]), read_map),
    "matrix": (Sheet((), (), MAP, {"step": [0.5, 0.5]}), read_map),
    "load history": (Sheet(("normal", "longitudinal"), ("N", "-"), LOADS), read_loads),
    "wheel": (Sheet(("y", "z"), ("mm", "mm"), WHEEL, {"kind": "wheel"}), read_rail_or_wheel),
    "rail": (Sheet(("y", "z"), ("mm", "mm"), RAIL, {"kind": "rail"}), read_rail_or_wheel),
    "fit": (Sheet(("creepage.longitudinal", "Qx_over_P"), ("-", "-"), CREEP), read_fit),
}
"""Kinds of files: the plain sheet, and a function that reads its numbers."""

FACTORS = {"m": 1e3, "um": 1e-3, "µm": 1e-3, "nm": 1e-6, "inch": 25.4, "Å": 1e-7, "mm": 1.0,
           "N": 1.0, "kN": 1e3, "-": 1.0, "%": 1e-2}  # fmt: skip


def convert(sheet: Sheet, column: int, unit: str) -> Sheet:
    """Return a sheet with a column in another unit."""
    values, old = sheet.values.copy(), sheet.units[column]
    if (unit in ("%", "kN")) != (old in ("-", "N")) or old not in FACTORS:
        return sheet
    values[:, column] *= FACTORS[old] / FACTORS[unit]
    units = tuple(unit if k == column else u for k, u in enumerate(sheet.units))
    return replace(sheet, values=values, units=units)


def lengths_in(unit: str) -> Callable:
    def change(sheet: Sheet, rng: np.random.Generator) -> Sheet:
        if not {"mm", "m", "um", "nm", "inch"} & {*sheet.units}:
            return sheet
        for column in range(len(sheet.units)):
            sheet = convert(sheet, column, unit)
        return sheet

    return change


def heights_in(unit: str) -> Callable:
    return lambda sheet, rng: (
        convert(sheet, len(sheet.units) - 1, unit) if "um" in sheet.units else sheet
    )


def first_in(unit: str, old: str) -> Callable:
    def change(sheet: Sheet, rng: np.random.Generator) -> Sheet:
        return convert(sheet, sheet.units.index(old), unit) if old in sheet.units else sheet

    return change


def cell(text: str) -> Callable:
    def change(sheet: Sheet, rng: np.random.Generator) -> Sheet:
        place = int(rng.integers(len(sheet.values))), sheet.values.shape[1] - 1
        return replace(sheet, cells=sheet.cells | {place: text})

    return change


def permute(sheet: Sheet, rng: np.random.Generator) -> Sheet:
    order = rng.permutation(len(sheet.names)) if sheet.names else np.arange(sheet.values.shape[1])
    names, units = (tuple(t[k] for k in order) if t else () for t in (sheet.names, sheet.units))
    cells = {
        (row, int(np.flatnonzero(order == k)[0])): text for (row, k), text in sheet.cells.items()
    }
    return replace(sheet, names=names, units=units, values=sheet.values[:, order], cells=cells)


def number_rows(name: str) -> Callable:
    return lambda sheet, rng: sheet.column(np.arange(len(sheet.values)), name, "-", 0)


def scale_heading(text: str, factor: float, offset: float = 0.0) -> Callable:
    def change(sheet: Sheet, rng: np.random.Generator) -> Sheet:
        values = sheet.values.copy()
        if not sheet.names:
            values = (values - offset) / factor
        elif "unit" not in text and " in " not in text:  # a header states the units
            values[:, -1] = (values[:, -1] - offset) / factor
        return replace(sheet, values=values, heading=(*sheet.heading, text))

    return change


def write_thousands(sheet: Sheet, rng: np.random.Generator, mark: str = ",") -> Sheet:
    values = 1e5 * sheet.values
    texts = {(i, k): f"{v:,.1f}" for i, row in enumerate(values) for k, v in enumerate(row)}
    if not any("," in text for text in texts.values()):
        return sheet
    cells = {place: text.replace(",", mark) for place, text in texts.items()}
    return replace(sheet, cells=cells, separator=";")


def quote(sheet: Sheet, rng: np.random.Generator) -> Sheet:
    return replace(sheet, header='"{name} [{unit}]"')


def add_height(sheet: Sheet, rng: np.random.Generator) -> Sheet:
    if not sheet.names:
        return sheet  # a wider matrix
    unit = sheet.units[-1]
    return sheet.column(rng.normal(size=len(sheet.values)), "z2", unit, sheet.values.shape[1])


def omit_header(sheet: Sheet, rng: np.random.Generator) -> Sheet:
    sheet = lengths_in("mm")(sheet, rng)
    return replace(sheet, header="") if {*sheet.units} <= {"mm", "N", "-"} else sheet


def omit_unit(sheet: Sheet, rng: np.random.Generator) -> Sheet:
    if "um" not in sheet.units:
        return sheet
    return replace(sheet, units=(*sheet.units[:-1], ""), header="{name}_({unit})")


def name_depth(sheet: Sheet, rng: np.random.Generator) -> Sheet:
    if "um" not in sheet.units:
        return sheet
    signs = np.ones(sheet.values.shape[1])
    signs[-1] = -1.0
    return replace(sheet, names=(*sheet.names[:-1], "depth"), values=sheet.values * signs)


def lengthen_row(sheet: Sheet, rng: np.random.Generator) -> Sheet:
    return replace(sheet, row_end=lambda row: f"{sheet.separator}1" if row == 2 else "")


def cut(sheet: Sheet, rng: np.random.Generator) -> Sheet:
    heading = (*sheet.heading, f"# Points: {len(sheet.values)}")
    return replace(sheet, values=sheet.values[:-3], heading=heading)


def reverse(sheet: Sheet, rng: np.random.Generator) -> Sheet:
    return replace(sheet, values=sheet.values[::-1], cells={}) if sheet.names else sheet


def profile(
    heading: tuple[str, ...] = (),
    tail: str = "",
    *,
    y: float = 0.0,
    z: float = 0.0,
    factor: float = 1.0,
    signs: tuple[float, float] = (1, 1),
    settings: dict | None = None,
    **changes: object,
) -> Callable:
    """Move the points of a profile, and write the heading of a vehicle program or instrument."""

    def change(sheet: Sheet, rng: np.random.Generator) -> Sheet:
        if "kind" not in sheet.settings or sheet.names + sheet.units != ("y", "z", "mm", "mm"):
            return sheet
        lines = [line.format(type=int(sheet.settings["kind"] == "wheel")) for line in heading]
        if lines and any("begin" in line or "ProgramName" in line for line in sheet.heading):
            return sheet
        return replace(
            sheet,
            values=(sheet.values * signs + (y, z)) * factor,
            header="" if lines else sheet.header,
            heading=(*lines, *sheet.heading) if tail == "" else (*sheet.heading, *lines),
            tail=tail.encode() + sheet.tail,
            settings=sheet.settings | (settings or {}),
            **changes,
        )

    return change


def simpack(*entries: str, unit: float = 1000.0, end: str = "point.end\n", **moves) -> Callable:
    head = ("header.begin", " type = {type}", "header.end", "spline.begin", *entries)
    return profile((*head, f"units.len.f = {unit:g}", "point.begin"), end or "\n", **moves)


def miniprof(*entries: str, **moves) -> Callable:
    return profile(("ProgramName=Own", *entries, ""), separator="\t", **moves)


def add_side(sheet: Sheet, rng: np.random.Generator) -> Sheet:
    if "kind" not in sheet.settings or sheet.values.shape[1] != 2 or {*sheet.units} != {"mm"}:
        return sheet
    values = np.column_stack((sheet.values * (-1, 1) - (0, 1), sheet.values))
    return replace(sheet, values=values, names=(), units=())


def read_right_side(sheet: Sheet, rng: np.random.Generator) -> Sheet:
    wide = add_side(sheet, rng)
    settings = sheet.settings if wide is sheet else sheet.settings | {"side": "right"}
    return replace(wide, settings=settings)


def head(*lines: str) -> Callable:
    return lambda sheet, rng: replace(sheet, heading=(*sheet.heading, *lines))


def name_inward(sheet: Sheet, rng: np.random.Generator) -> Sheet:
    if sheet.settings.get("kind") != "rail" or sheet.names != ("y", "z") or not sheet.header:
        return sheet
    units = ("millimetre", *sheet.units[1:])  # the header that states the sign is not omitted
    return replace(sheet, names=("-y", "z"), units=units, values=sheet.values * (-1, 1))


def go_back(sheet: Sheet, rng: np.random.Generator) -> Sheet:
    if "kind" not in sheet.settings or sheet.values.shape[1] != 2:
        return sheet
    back = sheet.values[::-1] + np.array((0.0, 1e-3))
    return replace(sheet, values=np.concatenate((sheet.values, back)))


def put(**changes: object) -> Callable:
    return lambda sheet, rng: replace(sheet, **changes)


TRAITS = {
    **{f"separator {mark!r}": put(separator=mark) for mark in (";", "\t", "   ", " ; ", ", ")},
    "commas": put(separator=","),
    "decimal commas": put(decimal=",", separator=";"),
    "decimal commas and tabs": put(decimal=",", separator="\t"),
    "decimal commas and blanks": put(decimal=",", separator="  "),
    "decimal commas between commas": put(decimal=",", separator=",", digits="{:.8f}"),
    **{f"encoding {name}": put(encoding=name) for name in
       ("utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "cp1252")},
    "DOS lines": put(line_end="\r\n"),
    "Mac lines": put(line_end="\r"),
    "end mark": put(tail=b"\x1a"),
    "parentheses": put(header="{name} ({unit})"),
    "underscores": put(header="{name}_({unit})"),
    "slash": put(header="{name} / {unit}"),
    "row of units": put(header="row of units"),
    "comment header": put(header="#{name} [{unit}]"),
    "no header": omit_header,
    "quoted header": quote,
    "instrument's heading": head("Instrument: own stylus", "Date: 2024-05-17", ""),
    "comments before": head("# measured by hand", "% second run"),
    "comment between": put(between={3: ("# second scan", "! third")}),
    "inline comments": put(row_end=lambda row: "  # point" if row % 3 == 0 else ""),
    "trailing separators": lambda s, rng: replace(s, row_end=lambda row, mark=s.separator: mark),
    "permuted columns": permute,
    "reversed rows": reverse,
    **{f"row numbers {name!r}": number_rows(name) for name in ("", "index", "No", "k")},
    "time column": lambda s, rng: s.column(0.1 * np.arange(len(s.values)), "time", "s", 0),
    "second height": add_height,
    **{f"lengths in {unit}": lengths_in(unit) for unit in ("m", "um", "nm", "inch")},
    **{f"heights in {unit}": heights_in(unit) for unit in ("nm", "µm", "Å", "mm")},
    "force in kN": first_in("kN", "N"),
    "ratios in per cent": first_in("%", "-"),
    "unknown unit": lambda s, rng: replace(s, units=(*s.units[:-1], "furlong")) if s.units else s,
    "no unit of heights": omit_unit,
    "unit in a heading": scale_heading("# Value units: m", 1e3),
    "unit in free words": scale_heading("# all heights in nm", 1e-6),
    "scale in a heading": scale_heading("# Z scale: 0.1", 0.1),
    "offset in a heading": scale_heading("# Offset = 5", 1.0, -5.0),
    "scale in words": scale_heading("# Data multiplied by 10", 10.0),
    "magnification": scale_heading("# vertical magnification 1000", 1000.0),
    "formula in a comment": scale_heading("# z = 2 * value", 0.5),
    "calibration": scale_heading("# Calibration: 0.5", 0.5),
    "upside down in words": scale_heading("# z is upside down", -1.0),
    **{f"words {text!r}": scale_heading(f"# {text}", factor) for text, factor in
       (("divided by two", 0.5), ("sign reversed", -1.0), ("per wheelset", 2.0), ("volts", 3.0),
        ("logarithmic", 1.5), ("raw, uncalibrated", 0.7), ("hundredths", 0.01),
        ("log10 of the values", 1.5))},
    "remark with a number": head("# tare: 50 N"),
    "columns in a heading": head("# Columns: 14"),
    "factor in a name": put(header="1000*{name} [{unit}]"),
    "sign in a name": put(header="-{name} [{unit}]"),
    "size in a heading": head("# Width: 6.5 mm", "# Height: 9 mm"),
    "points in a heading": head("Points: 4"),
    "sep= line": lambda s, rng: replace(s, heading=(f"sep={s.separator}", *s.heading)),
    **{f"gain after {mark!r}": scale_heading(f"{mark} gain = 2", 2.0) for mark in
       ("//", "*", "REM", ";")},
    "unit with a factor": scale_heading("# Value units: 1e-4 m", 0.1),
    "per cent in a comment": scale_heading("# values in per cent", 0.01),
    "factor below the table": lambda s, rng: replace(
        scale_heading("", 0.5)(s, rng), heading=s.heading, tail=b"# all values x 0.5\n" + s.tail
    ),
    "summary below the table": lambda s, rng: replace(s, tail=b"mean;0.1\nmax;0.2\n" + s.tail),
    "dashes below the header": put(between={0: ("--------",)}),
    "flags": lambda s, rng: replace(s, row_end=lambda row, mark=s.separator: f"{mark}OK"),
    "quoted decimal commas": put(separator=",", decimal=",", digits='"{:.12g}"'),
    "thousands with apostrophes": lambda s, rng: write_thousands(s, rng, "'"),
    "exponents after blanks": put(digits="{:.11e}", exponent=" e"),
    "units in cells": put(digits="{:.12g} mm"),
    "row count": lambda s, rng: replace(s, heading=(*s.heading, str(len(s.values)))),
    **{f"cell {text!r}": cell(text) for text in
       ("nan", "", "-", "-9999", "n/a", "O.1", "1_0", "50 %", "inf", "0.1 0.2", "1e", "--",
        "1.#QNAN")},
    "long row": lengthen_row,
    "second block": lambda s, rng: replace(s, between={4: ("y;z",)}),
    "thousands": write_thousands,
    "Fortran exponents": put(digits="{:.11e}", exponent="D"),
    "fewer digits": put(digits="{:.6g}"),
    "depths": name_depth,
    "cut file": cut,
    "upside down": profile(signs=(1, -1)),
    "mirrored, with a key": profile(signs=(-1, 1), settings={"mirror": True}),
    "0.01 mm": profile(digits="{:.2f}"),
    "0.001 mm": profile(digits="{:.3f}"),
    "5 mm aside": profile(y=-5.0),
    "from the back": profile(y=70.0),
    "from the axle": profile(y=750.0),
    "two sides": add_side,
    "right side": read_right_side,
    "SIMPACK": simpack(),
    "SIMPACK in metres": simpack(unit=1.0, factor=1e-3),
    "SIMPACK shift": simpack("shift.y = -2", "shift.z = 1", y=2.0, z=-1.0),
    "SIMPACK rotate": simpack("rotate = 0.02"),
    "SIMPACK bounds": simpack("bound.y.min = -31", "bound.y.max = 31"),
    "SIMPACK bound.z": simpack("bound.z.min = -1", "bound.z.max = 4"),
    "SIMPACK mirrors": simpack("mirror.y = 1", "mirror.z = 1", signs=(-1, -1)),
    "SIMPACK smooth": simpack("approx.smooth = 0.3"),
    "SIMPACK other type": simpack("header.begin", "type = 3", "header.end"),
    "SIMPACK unit of 0": simpack(unit=0.0),
    "SIMPACK cut": simpack(end=""),
    "Miniprof": miniprof("XOffset=0", "YOffset=0", "ColumnDef=X,Y"),
    "Miniprof offsets": miniprof("XOffset=3", "YOffset=-1", y=-3.0, z=1.0),
    "Miniprof count": miniprof("XYPoints=9"),
    "Miniprof left": miniprof("Rail=Left"),
    "Miniprof tilt": miniprof("Tilt=2.5"),
    "datum in a heading": profile(("# FlangeBack = -70.9",), y=0.9),
    "magnified heights": profile(("# heights magnified 1.1 times",), signs=(1, 1.1)),
    "mirror in a heading": profile(("Mirror: yes",), signs=(-1, 1)),
    "unit in a comment": profile(("# z in 0.1 mm",), signs=(1, 10)),
    "inward columns": name_inward,
    "there and back": go_back,
}  # fmt: skip
"""Traits by name: functions that change how a sheet is written, with the same meaning."""


@dataclass(frozen=True)
class Outcome:
    """What the program did with a file: "same", "note", "fault" or "silent"."""

    kind: str
    traits: tuple[str, ...]
    result: str
    message: str


def try_file(kind: str, traits: tuple[str, ...], folder: Path, rng: np.random.Generator) -> Outcome:
    """Write a file of a kind with traits, read it, and compare its numbers with the plain file."""
    plain, read = KINDS[kind]
    path = folder / ("file.csv" if rng.random() < 0.5 else "FILE.TXT")
    plain.write(path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        expected = read(path, plain)
    sheet = plain
    for trait in sorted(traits, key=lambda trait: trait == "no header"):  # without units, in mm
        sheet = TRAITS[trait](sheet, rng)
    sheet.write(path)
    with warnings.catch_warnings(record=True) as notes:
        warnings.simplefilter("always")
        try:
            found = read(path, sheet)
        except (ts.GapError, ts.SceneError, FitError, ProfileError) as error:
            return Outcome(kind, traits, "fault", str(error))
    equal = found.shape == expected.shape and np.allclose(found, expected, rtol=1e-4, atol=1e-9)
    message = "; ".join(str(note.message) for note in notes)
    return Outcome(kind, traits, "same" if equal else "note" if notes else "silent", message)


def try_traits(count: int, seed: int, kinds: tuple[str, ...] = tuple(KINDS)) -> Iterator[Outcome]:
    """Yield the outcomes of each single trait, and of random sets of two or three traits."""
    rng = np.random.default_rng(seed)
    with tempfile.TemporaryDirectory() as folder:
        for kind in kinds:
            for trait in TRAITS:
                yield try_file(kind, (trait,), Path(folder), rng)
        for _ in range(count):
            traits = rng.choice([*TRAITS], size=rng.integers(2, 4), replace=False)
            kind = kinds[rng.integers(len(kinds))]
            yield try_file(kind, tuple(map(str, traits)), Path(folder), rng)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    outcomes = [*try_traits(arguments.count, arguments.seed)]
    print(Counter(outcome.result for outcome in outcomes))
    silent = [outcome for outcome in outcomes if outcome.result == "silent"]
    for outcome in silent:
        print(outcome.kind, outcome.traits)
    refused = Counter((o.kind, o.traits[0], o.result) for o in outcomes if len(o.traits) == 1)
    for kind in KINDS:
        names = [trait for trait in TRAITS if refused[kind, trait, "fault"]]
        print(f"{kind}: {len(TRAITS)} traits, with a fault: {', '.join(names)}")
    sys.exit(bool(silent))


if __name__ == "__main__":
    main()
