"""What is recorded of a computation agrees with itself and with its contacts."""

import json
import pickle
from typing import get_args

import numpy as np
import pytest

import tractive_sam as ts
from tests.store.sample_records import SCENE, STRESSED, make_record, mesh, with_stress
from tractive_sam.results import caveats
from tractive_sam.results.column_table import COLUMNS, PACKAGE_FIELDS, columns
from tractive_sam.results.record import restart_fields
from tractive_sam.results.state import FIELDS
from tractive_sam.results.stress import STRESS
from tractive_sam.schema import PlausibilityWarning, Table

REVOLUTIONS = 2


@pytest.fixture(scope="module")
def discs():
    """Twin discs on a coarse mesh, orthotropic, with stress in both bodies."""
    return ts.Scene.builtin("twin-discs").with_set(
        [
            f"wear.revolutions={REVOLUTIONS}",
            f"wear.save=[0, {REVOLUTIONS}]",
            "wear.stepping=every-revolution",
            "grid.elements=[15, 31]",
            "subsurface.elements=8",
        ]
    )


@pytest.fixture(scope="module")
def contact(discs):
    return ts.solve(discs)


@pytest.fixture(scope="module")
def history(discs):
    return ts.roll(discs)


def collected(records, grid, scene=SCENE, **about):
    return ts.History.of_records(records, scene, grid, **about)


class TestHistory:
    def test_every_quantity_has_one_row_a_record(self, history):
        n, n_y = REVOLUTIONS + 1, len(history.y)
        assert len(history) == n
        along = {"axis": 2, "y": n_y, "body": 2, "position": 3}
        shapes = {
            one.name: (n, *(along[name] for name in one.dims))
            for one in columns(history.scene).values()
        }
        assert {name: history[name].shape for name in history.columns} == shapes

    @pytest.mark.parametrize("revolution", [0, REVOLUTIONS])
    def test_numbers_are_those_of_the_fields(self, history, revolution):
        row = history["revolution"] == revolution
        pressure, wear = (history.field(name, revolution) for name in ("pressure", "wear"))
        element = np.diff(history.x)[0] * np.diff(history.y)[0]
        assert history["p_max"][row] == pressure.max()
        assert history["wear_max"][row] == wear.max()
        # Sums over equal elements, to rounding.
        assert history["P"][row] == pytest.approx(pressure.sum() * element, rel=1e-12)
        for axis in "xy":
            force = history.field(f"traction_{axis}", revolution).sum() * element
            scale = history["P"][row].item()  # Q_y may be nothing but rounding
            assert history[f"Q{axis}"][row] == pytest.approx(force, abs=1e-12 * scale)
            assert history[f"Q{axis}_over_P"][row] == history[f"Q{axis}"][row] / scale

    def test_wear_is_shared_and_only_grows(self, history):
        both = history["wear_profile_A"] + history["wear_profile_B"]
        np.testing.assert_allclose(both, history["wear_profile"], rtol=1e-12)  # rounding
        assert (np.diff(history["wear_profile"], axis=0) >= 0.0).all()

    def test_friction_balances_what_is_supplied_and_worn(self, history):
        # Laws of the continuum, met to the error of a coarse mesh.
        np.testing.assert_allclose(history.energy_balance, 1.0, atol=1e-2)
        np.testing.assert_allclose(history.wear_balance[1:], 1.0, atol=1e-2)

    def test_what_a_contact_has_is_reported_where_it_is(self, history):
        with pytest.raises(AttributeError, match=r"history\.state\(n\)\.pressure"):
            _ = history.pressure
        with pytest.raises(AttributeError, match=r"history\['Qx'\]"):
            _ = history.Qx
        assert not hasattr(history, "nothing")

    def test_it_has_names_of_columns_as_a_dataframe_has(self, history):
        assert list(history) == list(history.columns)
        assert "Qx" in history
        assert 0 not in history

    def test_it_can_be_sent_to_another_process(self, history):
        again = pickle.loads(pickle.dumps(history))
        assert again.to_dict() == history.to_dict()
        assert again.columns == history.columns
        np.testing.assert_array_equal(again.field("pressure"), history.field("pressure"))

    def test_last_fields_are_the_default(self, history):
        for name in FIELDS:
            last = history.field(name, REVOLUTIONS)
            np.testing.assert_array_equal(history.field(name), last)
        assert history.field_revolutions.tolist() == [0, REVOLUTIONS]

    def test_stress_is_kept_with_the_fields(self, history):
        assert set(history.planes) == {(body, plane) for body in "AB" for plane in ("y=0", "x=0")}
        for body, plane in history.planes:
            stress = history.stress(body, plane)
            largest = history["von_mises_max"][-1, history.bodies.index(body)]
            # Both take the surface at other points of an element, and there are few across here.
            assert stress.von_mises.max() <= largest * 1.02

    @pytest.mark.parametrize(
        ("ask", "reported"),
        [
            (lambda h: h["no_such"], "p_max"),  # what there is
            (lambda h: h["pressure"], "history.field"),  # the cure
            (lambda h: h.field("no_such"), "pressure"),
            (lambda h: h.field("pressure", 1), f"0, {REVOLUTIONS}"),
            (lambda h: h.stress("A", "z=9"), "y=0 of A"),
        ],
    )
    def test_what_is_not_there_is_reported_with_what_is(self, history, ask, reported):
        with pytest.raises(LookupError, match=reported):
            ask(history)

    def test_plain_numbers_are_json(self, history):
        plain = json.loads(json.dumps(history.to_dict(), allow_nan=False))
        assert plain["revolution"] == [0, 1, 2]
        assert plain["wear_balance"][0] is None  # nothing has worn yet
        assert plain["wear_balance"][1] == history.wear_balance[1]
        assert plain["von_mises_max"].keys() == {"A", "B"}
        assert plain["contact_solves"] >= REVOLUTIONS + 1

    def test_without_wear_and_stress(self):
        scene = ts.Scene.builtin("spheres").with_set(["grid.elements=[15, 15]"])
        history = ts.roll(scene.replace(subsurface=None))
        assert (len(history), history.bodies, history.planes) == (1, (), ())
        assert np.isnan(history.wear_balance).all()
        assert history.to_dict()["wear_balance"] == [None]


class TestOfRecords:
    def test_a_smaller_mesh_lies_in_the_middle_of_the_last(self):
        small, wide = mesh(5, 9), mesh(9, 13)
        history = collected([make_record(1, True, small), make_record(2, True, wide)], wide)
        inner = history.field("pressure", 10)
        assert inner.shape == (9, 13)
        assert (inner[2:-2, 2:-2] == 1.0).all()
        assert inner.sum() == 5 * 9
        assert (history["wear_profile"][0, 2:-2] == 1e-6).all()

    def test_a_mesh_that_is_not_in_the_middle_is_refused(self):
        with pytest.raises(ValueError, match=r"\(5, 9\)"):
            collected([make_record(1, True, mesh(5, 9))], mesh(6, 9))

    def test_none(self):
        history = collected([], mesh(), status="running")
        assert (len(history), history.finished) == (0, False)
        with pytest.raises(LookupError):
            history.field("pressure")

    def test_only_kept_fields_are_counted(self):
        history = collected([make_record(k, with_fields=k == 1) for k in range(3)], mesh())
        assert history.field_revolutions.tolist() == [10]
        assert history["revolution"].tolist() == [0, 10, 20]
        assert history["revolution"].dtype == int

    def test_bodies(self):
        history = collected([with_stress(make_record(2, True))], mesh(), STRESSED)
        assert history.bodies == ("A", "B")
        assert history["von_mises_max"].tolist() == [[2.0, 3.0]]
        assert history.stress("B", "y=0").body == "B"


class TestState:
    def test_a_stored_contact_is_the_solved_one(self, discs, history):
        solved, stored = ts.solve(discs), history.state(0)
        for name in ("pressure", "traction", "slip", "gap", "wear", "sliding"):
            np.testing.assert_array_equal(getattr(solved, name), getattr(stored, name))
        for name in ("Qx", "Qy", "Mz", "approach", "xi_x", "message", "status", "work_supplied"):
            assert getattr(solved, name) == getattr(stored, name)

    def test_it_continues_as_the_solved_one(self, discs, history):
        again = ts.solve(discs, start=history.state(0))
        assert again.cost.applications < 0.5 * history["operator_applications"][0]

    def test_gap_is_closed_in_contact(self, contact):
        kept = restart_fields(contact)
        assert kept.keys() == FIELDS.keys()
        assert (kept["gap"][kept["pressure"] > 0] <= contact.approach * 1e-6).all()  # touching

    def test_results_are_equal_only_to_themselves(self, history):
        state = history.state()
        assert state == state  # noqa: PLR0124
        assert state != history.state()
        assert len({state, history}) == 2


class TestXarray:
    def test_columns_and_fields_have_their_dimensions(self, history):
        data = history.to_xarray()
        np.testing.assert_array_equal(data["Qx"].sel(revolution=REVOLUTIONS), history["Qx"][-1])
        assert data["von_mises_max"].sel(body="B").dims == ("revolution",)
        assert data["pressure"].dims == ("saved", "x", "y")
        assert data["p_max"].attrs["units"] == "MPa"
        np.testing.assert_array_equal(
            data["wear"].sel(saved=REVOLUTIONS), history.field("wear", REVOLUTIONS)
        )


def test_dataframe_has_a_column_a_number(history):
    pytest.importorskip("pandas", reason="pandas comes with xarray, of the extra study")
    frame = history.to_dataframe()
    assert frame.index.name == "revolution"
    assert frame.index.tolist() == history["revolution"].tolist()
    np.testing.assert_array_equal(frame["worn_mass B"], history["worn_mass"][:, 1])
    np.testing.assert_array_equal(frame["p_max_at y"], history["p_max_at"][:, 1])
    np.testing.assert_array_equal(
        frame["von_mises_max_at A depth"], history["von_mises_max_at"][:, 0, 2]
    )


def test_error_bars_are_of_scenes_that_ask_for_them(discs):
    requested = discs.replace(grid=None, accuracy={"tolerance": 1e-2})
    assert not [name for name in columns(discs) if name.endswith("_error")]
    assert {"Qx_error", "von_mises_max_error", "relative_error"} <= columns(requested).keys()


def test_every_quantity_has_a_unit_and_a_name():
    for one in (*COLUMNS, *PACKAGE_FIELDS.values(), *STRESS.values()):
        assert one.unit, one.name
        assert one.long_name, one.name


def test_forces_of_a_line_contact_are_per_length():
    area, line = columns(SCENE), columns(ts.Scene.builtin("cylinders"))
    assert (area["P"].unit, line["P"].unit) == ("N", "N/mm")
    assert area["p_max"] == line["p_max"]


@pytest.mark.parametrize("one", [*COLUMNS, *PACKAGE_FIELDS.values()], ids=lambda q: q.name)
def test_quantities_can_be_sent_to_another_process(one):
    assert pickle.loads(pickle.dumps(one)) == one


def test_a_stress_that_long_elements_miss_is_reported():
    """Maxima less than two elements deep, as in a slender contact, are not sought."""
    flank = {"body.A.radius_x": 9.0, "body.A.radius_y": 2500.0, "body.B.radius_y": np.inf}
    single = dict.fromkeys(("wear", "friction", "creepage", "grid"))
    planes = {"planes": ["y=0"], "elements": 8}
    scene = ts.Scene.builtin("twin-discs").replace(**flank, **single, subsurface=planes)
    # Nearly a line contact's; on coarse elements along x to a per cent.
    largest = 0.55 * scene.hertz.p0
    for elements, missed in (((15, 401), False), ((15, 61), True)):
        history = ts.roll(scene.replace(grid={"elements": elements}))
        assert ("stress" in caveats(history)) == missed
        assert (history["von_mises_interior"][0, 0] > largest) != missed


def test_a_utilisation_near_the_surface_is_noted_unless_it_has_an_error_bar():
    """Friction has the largest one at the surface; without it, it is half a semi-axis deep."""
    material = {"limit": 250.0, "sensitivity": 0.3, "elements": 8, "bodies": ["B"]}
    single = dict.fromkeys(("wear", "subsurface"))
    grid = {"half_length": (0.32, 0.9), "elements": (25, 25)}
    rough = ts.Scene.builtin("twin-discs").replace(**single, grid=grid, fatigue=material)
    note = caveats(ts.roll(rough))["utilisation"]
    assert "B 0.0" in note
    assert "accuracy" in note
    smooth = rough.replace(friction=None, creepage=None)
    assert "utilisation" not in caveats(ts.roll(smooth))
    assured = rough.replace(grid=None, accuracy={"tolerance": 0.1})
    assert "utilisation" not in caveats(ts.roll(assured))


def test_a_contact_that_grows_to_the_edges_of_a_disc_is_reported():
    """A is wide enough for the worn contact, B for the unworn one, which has no note."""
    scene = ts.Scene.builtin("twin-discs").replace(
        **{"wear.revolutions": 500, "wear.save": [0, 500], "subsurface": None}
    )
    new = 2.0 * scene.hertz.b
    scene = scene.replace(**{"body.A.width": 3.0 * new, "body.B.width": 1.3 * new})
    reported = caveats(ts.roll(scene))
    assert "body B" in reported["width"]
    assert "body A" not in reported["width"]
    assert caveats(ts.roll(scene.replace(wear=None))) == {}
    with pytest.warns(PlausibilityWarning, match="body B"):
        scene.replace(**{"body.B.width": 1.2 * new})


def tables_in(annotation):
    """Return the tables that the annotation of a key allows."""
    if isinstance(annotation, type) and issubclass(annotation, Table):
        return [annotation]
    return [table for part in get_args(annotation) for table in tables_in(part)]


def has_key(table, key):
    """Return whether a dotted key is one of a table, or a property of it or of an inner table."""
    first, _, rest = key.partition(".")
    if first not in table.model_fields:
        return hasattr(table, first)
    inner = tables_in(table.model_fields[first].annotation)
    return not rest or any(has_key(one, rest) for one in inner)


def test_columns_need_keys_and_properties_that_scenes_have():
    """A scene without a column's key has no such column: a wrong name would pass unnoticed."""
    needs = {key for column in COLUMNS for key in column.needs}
    assert {key for key in needs if not has_key(ts.Scene, key)} == set()
    assert not has_key(ts.Scene, "transient.rolls_only")
