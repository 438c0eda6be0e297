"""Every table describes itself, and summaries and reports are made from its rows."""

import pytest

import tractive_sam as ts
from tractive_sam.scene import describe_load
from tractive_sam.schema import Row, Table, describe_tables

DISCS = ts.Scene.builtin("twin-discs")


class Lubricant(Table):
    """A table that the package does not know."""

    effect = "lubrication"

    def describe(self, scene):
        yield Row("film", "from another package", brief=True)


class Lubricated(ts.Scene):
    """A scene with this table."""

    lubricant: Lubricant | None = None


@pytest.mark.parametrize("name", ts.builtin_names())
def test_labels_of_a_table_are_different_and_no_text_is_empty(name):
    for rows in describe_tables(ts.Scene.builtin(name)).values():
        assert len({row.label for row in rows}) == len(rows)
        assert all(row.text for row in rows)


def test_a_summary_has_a_line_for_each_given_table():
    lines = dict(line.split(maxsplit=1) for line in str(repr(DISCS)).splitlines()[2:])
    for key in DISCS.model_fields_set - {"title"}:
        brief = [row for row in describe_tables(DISCS)[key] if row.brief]
        assert all(row.text in repr(DISCS) for row in brief)
        assert brief or f"[{key}]" in repr(DISCS)
    assert "[grid]" in lines["other"]


def test_a_report_and_a_summary_agree():
    assert all(text in repr(DISCS) for text in describe_load(DISCS).values())
    assert "15000 revolutions" in describe_load(DISCS)["wear"]


def test_a_new_table_is_described_without_a_change_elsewhere():
    scene = Lubricated(**DISCS.entries())
    assert describe_tables(scene)["lubricant"] == [
        Row("lubrication", "left out: the scene has no [lubricant]")
    ]
    film = Lubricated(**DISCS.entries(), lubricant={})
    assert "from another package" in repr(film)


def test_only_given_keys_decide_between_load_pressure_and_approach():
    for key, value in (("normal", 300.0), ("pressure", 1e3), ("approach", 5e-3)):
        scene = DISCS.replace(**{f"load.{key}": value})
        assert scene.load.prescribed_key == key
        text = describe_load(scene)["load"]
        assert f"{scene.hertz.p0:.6g} MPa" in text
        assert f"P = {scene.hertz.load:.6g} N" in text


def test_courses_replace_the_value_at_rest_in_the_summary():
    rolling = {
        name: next(
            row.text
            for row in describe_tables(ts.Scene.builtin(name))["creepage"]
            if row.label == "rolling"
        )
        for name in ("traction-control", "fretting")
    }
    assert "xi_x as in [transient]" in rolling["traction-control"]
    assert "Q_x as in [transient]" in rolling["fretting"]
