import math
from contextlib import suppress

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tractive_sam.scene import Scene
from tractive_sam.schema import SceneError
from tractive_sam.schema.toml import emit, parse, parse_value

POSITIVE = st.floats(1e-3, 1e3)
FINITE = st.floats(-1e3, 1e3).filter(lambda value: value == 0 or abs(value) > 1e-30)
TEXT = st.text(st.characters(exclude_categories=["Cs"]), max_size=20)


def optional(strategy):
    return st.none() | strategy


def one_of_two(first, second, strategy):
    return st.sampled_from([first, second]).flatmap(
        lambda key: st.fixed_dictionaries({key: strategy})
    )


@st.composite
def bodies(draw):
    radius = st.floats(1, 100)  # more slender contacts need a grid
    rest = {"poisson": st.floats(0, 0.5), "radius_x": radius, "radius_y": radius}
    elastic = draw(one_of_two("young", "shear", POSITIVE))
    return elastic | draw(st.fixed_dictionaries(rest, optional={"density": POSITIVE}))


@st.composite
def wears(draw):
    last = draw(st.integers(1, 10**6))
    save = draw(optional(st.sets(st.integers(0, last), min_size=1, max_size=5).map(sorted)))
    return {
        "intensity": draw(st.floats(1e-9, 1e-3) | st.tuples(POSITIVE, st.just(0))),
        "revolutions": last,
        "save": save,
        "stepping": draw(st.sampled_from(["adaptive", "every-revolution"])),
    }


SCENES = st.fixed_dictionaries(
    {
        "title": TEXT,
        "body": st.fixed_dictionaries({"A": bodies(), "B": bodies()}),
        "load": one_of_two("normal", "approach", POSITIVE),
        "friction": st.fixed_dictionaries(
            {
                "mu": POSITIVE | st.tuples(st.floats(0.02, 2.0), st.floats(0.02, 2.0)),
                "angle": st.floats(-360, 360).map(round),
            }
        ),
    },
    optional={
        "creepage": st.fixed_dictionaries(
            {}, optional=dict.fromkeys(["longitudinal", "spin"], FINITE)
        ),
        "wear": wears(),
        "subsurface": st.fixed_dictionaries(
            {"planes": st.lists(st.sampled_from(["y=0", "x=.5a", "z=1b"]), min_size=1, unique=True)}
        ),
        "solver": st.just({"method": "newton"}),
    },
)


@pytest.mark.filterwarnings("ignore::tractive_sam.schema.SceneWarning")  # large contacts
@settings(max_examples=60)
@given(SCENES)
def test_round_trip(tables):
    scene = Scene(**tables)
    again = Scene.from_toml_text(scene.to_toml())
    assert again == scene
    assert again.to_toml() == scene.to_toml()


@given(TEXT)
def test_any_title_is_written(text):
    assert parse(emit({"title": text})) == {"title": text}


def test_infinite_radius_is_written(spheres):
    flat = spheres.replace(**{"body.B.radius_x": math.inf})
    assert "radius_x = inf" in flat.to_toml()
    assert Scene.from_toml_text(flat.to_toml()) == flat


def test_defaults_are_not_written(spheres):
    """So that a creepage left to be found stays free, and saves follow the revolutions."""
    text = spheres.replace(**{"load.force_x": 0.01}).to_toml()
    assert "creepage" not in text
    assert "solver" not in text


JUNK = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.sampled_from([10**400, -math.inf, math.inf, 0.3, 1, 2.0, "auto", "y=0", "A"])
    | TEXT,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(TEXT, inner, max_size=3),
    max_leaves=5,
)


def tables_like(model):
    """Dictionaries with many known keys and any values."""
    fields = {}
    for key, info in model.model_fields.items():
        kinds = (info.annotation, *getattr(info.annotation, "__args__", ()))
        inner = next((kind for kind in kinds if hasattr(kind, "model_fields")), None)
        fields[key] = (tables_like(inner) | JUNK) if inner else JUNK
    return st.fixed_dictionaries({}, optional=fields)


@pytest.mark.slow
@settings(max_examples=150)
@given(tables_like(Scene), st.dictionaries(TEXT, JUNK, max_size=1))
def test_junk_gives_faults(tables, more):
    with pytest.raises(SceneError):
        Scene(**tables, **{key: value for key, value in more.items() if key not in tables})


@pytest.mark.slow
@settings(max_examples=150)
@given(
    SCENES, st.lists(st.tuples(st.sampled_from(["load", "body", "wear", "grid", "friction"]), JUNK))
)
@pytest.mark.filterwarnings("ignore::tractive_sam.schema.SceneWarning")
def test_partly_junk_gives_a_scene_or_faults(tables, replaced):
    with suppress(SceneError):
        Scene(**tables | dict(replaced))


@given(TEXT | st.text("[]{}=.\"'\n# 01ae_-", max_size=30))
def test_any_text_gives_faults(text):
    with pytest.raises(SceneError):
        Scene.from_toml_text(text)


@pytest.mark.parametrize(
    ("text", "given_line"),
    [
        ("a = 1\nb = = 2\n", "line 2, 'b = = 2'"),
        ('a = "open', "text that is not TOML"),
        ("[a]\n[a]", "line 2, '[a]'"),
    ],
)
def test_syntax(text, given_line):
    with pytest.raises(SceneError) as caught:
        Scene.from_toml_text(text)
    (fault,) = caught.value.faults
    assert fault.key == "(file)"
    assert fault.given == given_line
    assert "(at" not in fault.allowed


@pytest.mark.parametrize(
    ("text", "hint"),
    [("a = 10,5", "decimal point"), ("a = -0,5  # mm", "decimal point"), ("a = infinity", "inf")],
)
def test_syntax_of_numbers(text, hint):
    with pytest.raises(SceneError, match=hint):
        Scene.from_toml_text(text)


def test_numbers_beyond_all_bounds():
    for text in ("title = " + "9" * 5000, "title = 0x" + "f" * 9000, "title = " + "[" * 5000):
        with pytest.raises(SceneError):
            Scene.from_toml_text(text)


@pytest.mark.parametrize("name", ["missing.toml", ".", "a\0b"])
def test_unreadable_file(tmp_path, name):
    with pytest.raises(SceneError) as caught:
        Scene.from_toml(f"{tmp_path}/{name}")
    assert [fault.key for fault in caught.value.faults] == ["(file)"]


def test_file_in_another_encoding(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_bytes("title = 'Scheibe für Öl'".encode("latin-1"))
    with pytest.raises(SceneError, match="UTF-8"):
        Scene.from_toml(path)


def test_file(tmp_path, spheres):
    path = tmp_path / "scene.toml"
    path.write_text(spheres.to_toml(), encoding="utf-8")
    assert Scene.from_toml(path) == Scene.from_toml(str(path)) == spheres


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("200", 200),
        ("[0.4, 0.2]", [0.4, 0.2]),
        ("inf", math.inf),
        ('"auto"', "auto"),
        ("auto", "auto"),
        ("every-revolution", "every-revolution"),
        ("[0.4", "[0.4"),
        ("[[500,.4], [600, -1.]]", [[500, 0.4], [600, -1.0]]),
        ("./wear.5", "./wear.5"),
        ("1\nb = 2", "1\nb = 2"),
        ("", ""),
    ],
)
def test_value(text, value):
    assert parse_value(text) == value


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-be"])
def test_byte_order_mark_states_the_encoding(tmp_path, encoding):
    text, path = Scene.builtin("spheres").replace(title="µ = 0,3").to_toml(), tmp_path / "s.toml"
    mark = b"\xfe\xff" if encoding == "utf-16-be" else b""
    path.write_bytes(mark + text.encode(encoding))
    assert Scene.from_toml(path) == Scene.from_toml_text(text)


@pytest.mark.parametrize("path", [r"C:\Users\a.npy", r"C:\data\a.npy", r"C:\temp\new.npy"])
def test_backslashes_in_double_quotes_are_explained(path):
    with pytest.raises(SceneError, match="single quotes"):
        Scene.from_toml_text(f'{Scene.builtin("spheres").to_toml()}\n[gap]\nfile = "{path}"')


def test_settings_may_correct_a_file_that_does_not_exist():
    tables = Scene.builtin("wheel-rail").entries()
    tables["wheel"]["profile"] = "missing.prw"
    with pytest.raises(SceneError, match=r"wheel\.profile"):
        Scene.from_tables(tables)
    corrected = Scene.from_tables(tables, ["wheel.profile=S1002"])
    assert corrected == Scene.builtin("wheel-rail")
    assert Scene.from_tables(tables, ["title=a", "wheel.profile=S1002"]).title == "a"


def test_equal_coefficients_are_written_as_one_number():
    """Pairs that one number may give, but not sizes of a mesh; the scene is the same."""
    scene = Scene.builtin("spheres").replace(
        **{"grid.elements": (17, 17), "friction.mu": (0.3, 0.3)},
        wear={"coefficient": (1e-5, 2e-5), "revolutions": 10},
    )
    lines = scene.to_toml().split("\n")
    assert {"mu = 0.3", "elements = [17, 17]", "coefficient = [1e-05, 2e-05]"} <= {*lines}
    assert Scene.from_toml_text(scene.to_toml()) == scene
