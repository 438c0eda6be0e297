"""Rows of data sets: exact places of records, improbable settings, signs, and unworn bodies."""

import numpy as np
import pytest

import tractive_sam as ts
from tests.fitting.conftest import CREEPAGES, creep_data
from tractive_sam.fitting import FitError
from tractive_sam.fitting.run import _has_heights, make_problem, read_design
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


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_opposite_signs_of_model_and_data_are_named(spheres, sign):
    data = creep_data(spheres, {"friction.mu": 0.35}, factors=sign, noise={"absolute": 0.02})
    design = {"scene": spheres, "free": ["friction.mu"], "data": [data], "mesh_check": False}
    found = ts.fit(design | {"curve": 0})
    named = [note for note in found.notes if "opposite signs" in note]
    assert len(named) == (sign < 0.0)
    assert all("Qx_over_P" in note and "creepage.longitudinal" in note for note in named)


@pytest.mark.parametrize("slope", [0.0, 0.02, -0.02])
@pytest.mark.parametrize("width", [1.0, 3.0])
def test_traces_of_heights_are_recognised(slope, width):
    """A groove that ends within the trace or beyond it, on a tilted specimen."""
    y = np.linspace(-2.0, 2.0, 101)
    depth = 0.01 * np.sqrt(np.maximum(1.0 - (y / width) ** 2, 0.0)) + slope * y + 0.3
    assert not _has_heights(y, depth)
    assert _has_heights(y[::-1], -depth[::-1])


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
