"""Rows of data sets: exact places of records, improbable settings, signs, and unworn bodies."""

import re

import numpy as np
import pytest

import tractive_sam as ts
from tests.fitting.conftest import CREEPAGES, creep_data
from tractive_sam.fitting import FitError, explain_fit
from tractive_sam.fitting.data import describe_improbable, read_measured
from tractive_sam.fitting.design import Data
from tractive_sam.fitting.run import make_problem, read_design
from tractive_sam.schema import PlausibilityWarning

PLACES = [0.7, 1.5, 3.3]
"""Distances, mm, between the records of the default steps."""


@pytest.fixture(scope="module")
def transient(spheres):
    """A transient from rest on a coarse mesh: steps of half a millimetre."""
    course = {"distance": [0.0, 4.0], "creepage": {"longitudinal": -0.003}}
    return spheres.replace(transient=course, **{"grid.elements": (13, 13)})


def problem_of(design):
    return make_problem(read_design(design | {"mesh_check": False, "curve": 0}).fit)


def test_predictions_at_distances_are_those_of_a_run_that_records_them(transient):
    history = ts.roll(transient.replace(**{"transient.save": (0.0, *PLACES, 4.0)}), progress=False)
    rows = [int(np.abs(history["distance"] - place).argmin()) for place in PLACES]
    expected = (history["Qx"] / history["P"])[rows]
    data = {"values": {"distance": PLACES, "Qx_over_P": expected}, "vary": "distance",
            "observe": "Qx_over_P", "noise": 0.05}  # fmt: skip
    problem = problem_of({"scene": transient, "free": ["friction.mu"], "data": [data]})
    # the same steps and the same contacts
    assert problem.predict(np.ones(1)) == pytest.approx(expected, rel=1e-12)


PLACES_WITHOUT_RECORD = {
    "beyond the end": ({"vary": "distance", "values": {"distance": [1.0, 5.0]}}, "vary"),
    "of the other kind": ({"vary": "revolution", "values": {"revolution": [1.0, 2.0]}}, "vary"),
    "at beyond the end": ({"at": 9.0, "values": {}}, "at"),
}


@pytest.mark.parametrize("case", PLACES_WITHOUT_RECORD)
def test_places_without_a_record_are_refused(case, transient):
    entries, key = PLACES_WITHOUT_RECORD[case]
    rows = max((len(column) for column in entries["values"].values()), default=1)
    values = entries["values"] | {"Qx_over_P": [0.1] * rows}
    data = {"observe": "Qx_over_P", "noise": 0.05} | entries | {"values": values}
    with pytest.raises(FitError) as caught:
        problem_of({"scene": transient, "free": ["friction.mu"], "data": [data]})
    assert caught.value.faults[0].key == f"fit.data[0].{key}"


def test_parts_of_revolutions_and_revolutions_of_one_contact_are_refused(spheres, discs):
    for scene, revolutions in ((discs, [1.5, 3.0]), (spheres, [1.0, 2.0])):
        data = {"values": {"revolution": revolutions, "Qx": [1.0, 2.0]}, "vary": "revolution",
                "observe": "Qx", "noise": 0.05}  # fmt: skip
        with pytest.raises(FitError, match=r"fit.data\[0\].vary"):
            problem_of({"scene": scene, "free": ["load.normal"], "data": [data]})


def test_every_row_is_checked_as_a_scene_is(spheres):
    """Creepages in per cent: rows beyond 10 % are named, plausible ones are not."""
    columns = {"creepage.longitudinal": [-0.02, -0.2, -2.0], "Qx_over_P": [0.2, 0.3, 0.3]}
    data = {"values": columns, "vary": "creepage.longitudinal", "observe": "Qx_over_P"}
    design = {"scene": spheres, "free": ["friction.mu"], "data": [data | {"noise": 0.05}]}
    with pytest.warns(PlausibilityWarning, match=r"fit.data\[0\]: 2 of 3 rows.* row 2: creepage"):
        problem = problem_of(design)
    assert len(problem.series[0].notes) == 1


def test_signs_that_friction_forbids_are_refused_before_the_search(spheres):
    """Forces along the creepage of A: `explain` and `fit` name the cure, which is what works."""
    data = creep_data(spheres, {"friction.mu": 0.35}, factors=-1.0, noise={"absolute": 0.02})
    table = {"scene": spheres, "free": ["friction.mu"], "data": [data], "mesh_check": False}
    for ask in (ts.fit, lambda fit: explain_fit(ts.FitDesign(fit=fit))):
        with pytest.raises(
            FitError, match=r"wrong sign.* \"creepage.longitudinal\" = \"-"
        ) as caught:
            ask(table)
        assert caught.value.faults[0].key == "fit.data[0].columns"
    data["columns"] = {"creepage.longitudinal": "-creepage.longitudinal"}
    creepages = problem_of(table).series[0].measured.abscissa[1]
    np.testing.assert_array_equal(creepages, np.negative(CREEPAGES))
    problem_of(table | {"scene": spheres.replace(**{"creepage.spin": 0.1})})  # spin may decide


@pytest.mark.parametrize("masses", [[1.0, 2.0, 3.0], [-1.0, -2.0, -3.0], [3.0, 2.0, 1.0]])
def test_losses_of_mass_are_positive_and_grow(discs, masses):
    columns = {"revolution": [1000, 2000, 3000], "worn_mass": masses}
    data = {"values": columns, "vary": "revolution", "observe": "worn_mass", "body": "A"}
    table = {"scene": discs, "free": ["wear.coefficient.A"], "data": [data | {"noise": 0.05}]}
    if masses[0] == 1.0:
        explain_fit(ts.FitDesign(fit=table))
    else:
        with pytest.raises(FitError, match=r"worn_mass (of the wrong sign|that falls)"):
            explain_fit(ts.FitDesign(fit=table))


@pytest.mark.parametrize("slope", [0.0, 0.02, -0.02])
@pytest.mark.parametrize("width", [1.0, 3.0])
def test_traces_of_heights_are_recognised(slope, width):
    """A groove that ends within the trace or beyond it, on a tilted specimen."""
    y = np.linspace(-2.0, 2.0, 101)
    depth = 0.01 * np.sqrt(np.maximum(1.0 - (y / width) ** 2, 0.0)) + slope * y + 0.3
    data = {"values": {"y": y, "depth": depth}, "observe": "wear_profile", "body": "A"}
    data["noise"] = {"absolute": 1e-3}
    assert not [*describe_improbable("", read_measured(Data(**data), ""))]
    data["columns"] = {"depth": "-depth"}
    assert [*describe_improbable("", read_measured(Data(**data), ""))]


IMPROBABLE = {
    "a force as a ratio": ({"observe": "Qx_over_P"}, [300.0, 310.0], "exceeds friction"),
    "a noise in per cent": ({"observe": "Qx_over_P", "noise": 2}, [0.2, 0.3], "noise is larger"),
    "micrometres": ({"observe": "wear_profile", "body": "A"}, [0.0, 3.0, 0.0], "depth .um."),
    "a noise in micrometres": (
        {"observe": "wear_profile", "body": "A", "noise": {"absolute": 0.1}}, [0.0, 0.003, 0.0],
        "noise is larger",
    ),
    "nothing": ({"observe": "Qx_over_P"}, [0.3, 0.31], ""),
    "no groove": ({"observe": "wear_profile", "body": "A"}, [0.0, 0.003, 0.0], ""),
}  # fmt: skip


@pytest.mark.parametrize("case", IMPROBABLE)
def test_values_of_improbable_size_are_doubted(case):
    table, values, note = IMPROBABLE[case]
    columns = {"depth": values, "y": [-1.5, 0.0, 1.5]}
    columns = columns if len(values) == 3 else {table["observe"]: values}
    data = Data(**({"noise": {"absolute": 1e-4}} | table), values=columns)
    notes = [*describe_improbable("a.csv", read_measured(data, ""))]
    assert len(notes) == bool(note)
    assert all(re.search(note, one) for one in notes)


HEADERS = {
    "by name": ("revolution;worn_mass", {}),
    "with the body": ("revolution;worn_mass A", {}),
    "with a unit": ("Revolution;worn mass A [mg]", {}),
    "beside the other body": ("revolution;worn_mass_A;worn_mass_B", {}),
    "by columns": ("N;loss", {"revolution": "N", "worn_mass": "loss"}),
    "with the sign reversed": ("revolution;change", {"worn_mass": "-change"}),
}


@pytest.mark.parametrize("header", HEADERS)
def test_columns_are_found_by_their_words(tmp_path, header):
    names, columns = HEADERS[header]
    sign, more = (-1 if "-change" in columns.values() else 1), names.count(";") - 1
    rows = [f"{n};{sign * n / 1000:g}" + ";7" * more for n in (1000, 2000)]
    file = tmp_path / "weighings.csv"
    file.write_text("\n".join([names, *rows]))
    table = {"file": str(file), "vary": "revolution", "observe": "worn_mass", "noise": 0.05}
    data = Data(**table, body="A", columns=columns)
    measured = read_measured(data, "fit.data[0]", [Data(**table, body="B")] * more)
    np.testing.assert_array_equal(measured.observed[:, 0], [1.0, 2.0])
    np.testing.assert_array_equal(measured.places, [1000.0, 2000.0])


def test_columns_that_are_not_found_are_named_with_their_file(tmp_path):
    file = tmp_path / "weighings.csv"
    data = Data(file=str(file), vary="revolution", observe="worn_mass", body="A", noise=0.05)
    for names in ("revolution;loss", "revolution;worn_mass_A;Worn mass", "revolution;worn_mass B"):
        file.write_text(f"{names}\n" + ";".join("123"[: names.count(";") + 1]))
        with pytest.raises(
            FitError, match=r"weighings.csv: .*columns = \{ \"worn_mass\""
        ) as caught:
            read_measured(data, "fit.data[0]")
        assert caught.value.faults[0].key == "fit.data[0].file"


def test_creep_curves_of_a_scene_that_wears_are_those_of_unworn_bodies(discs):
    unworn = creep_data(discs.replace(wear=None), {})
    worn = creep_data(discs.replace(wear=None), {}) | {"at": 1000}
    for data, is_contact in ((unworn, True), (unworn | {"at": 0}, True), (worn, False)):
        design = {"scene": discs, "free": ["load.normal"], "data": [data]}
        series = problem_of(design).series[0]
        assert [case.is_steady for case in series.cases({"load.normal": 300.0}, 0, False)] == [
            is_contact
        ] * len(CREEPAGES)
        named = [note for note in series.notes if "unworn" in note]
        assert len(named) == ("at" not in data)
