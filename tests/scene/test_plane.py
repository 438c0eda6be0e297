import pytest
from hypothesis import given
from hypothesis import strategies as st

from tractive_sam.scene import Plane


@pytest.mark.parametrize(
    ("text", "plane", "name"),
    [
        ("y=0", Plane("y", 0.0), "y=0"),
        ("y=0.75a", Plane("y", 0.75, "a"), "y=0.75a"),
        (" x = -1.50 b ", Plane("x", -1.5, "b"), "x=-1.5b"),
        ("z=.48a", Plane("z", 0.48, "a"), "z=0.48a"),
        ("x=-0.0", Plane("x", 0.0), "x=0"),
        ("x=1e-3", Plane("x", 0.001), "x=0.001"),
    ],
)
def test_grammar(text, plane, name):
    assert Plane.parse(text) == plane
    assert str(plane) == name


@given(st.sampled_from("xyz"), st.floats(0, 1e30), st.sampled_from(["", "a", "b"]))
def test_text_round_trip(axis, number, unit):
    plane = Plane(axis, number, unit)
    assert Plane.parse(str(plane)) == plane
    assert Plane.parse(plane) is plane


def test_units():
    positions = [Plane.parse(f"y=0.5{unit}").value_in(2.0, 6.0) for unit in ("", "a", "b")]
    assert positions == [0.5, 1.0, 3.0]


@pytest.mark.parametrize(
    "text", ["", "y", "y=", "y=c", "y=1c", "w=1", "y=1 a b", "y=inf", "y=٣", 5, None]
)
def test_no_plane(text):
    with pytest.raises(ValueError, match="y=0"):
        Plane.parse(text)


@pytest.mark.parametrize(("text", "words"), [("z=-0.1", "depth"), ("y=1e400", "finite")])
def test_plane_out_of_reach(text, words):
    with pytest.raises(ValueError, match=words):
        Plane.parse(text)
