"""Axes of tables: what they name, what symmetries leave, and what is refused."""

import math

import numpy as np
import pytest
from typer.testing import CliRunner

import tractive_sam as ts
from tractive_sam.cli import app
from tractive_sam.lookup import Hermite, creepages_at
from tractive_sam.mechanics.frame import full_slip_force
from tractive_sam.tables import TableAxis
from tractive_sam.tables.builder import coefficients
from tractive_sam.tables.solving import CreepageGrid, Refinement

STEEL = {"young": 208e3, "poisson": 0.3}
FLAT = {"radius_x": math.inf, "radius_y": math.inf}


def scene(**given):
    return ts.Scene(
        **{
            "body": {"A": STEEL | {"radius_x": 100.0, "radius_y": 100.0}, "B": STEEL | FLAT},
            "load": {"normal": 1e3},
            "friction": {"mu": 0.3},
        }
        | given
    )


def soft():
    """A body of rubber on steel."""
    return scene(
        body={
            "A": {"young": 10.0, "poisson": 0.3, "radius_x": 20.0, "radius_y": 20.0},
            "B": STEEL | FLAT,
        },
        load={"normal": 5.0},
    )


RATIO = {"key": "friction.mu", "name": "mu2_over_mu1",
         "values": [[0.3, 0.15], [0.3, 0.3]], "at": [0.5, 1.0]}  # fmt: skip


def test_an_axis_names_entries_of_the_scene():
    together = {"key": "body.B.poisson", "values": [0.3, 0.25]}
    axis = TableAxis(key="body.A.poisson", name="nu", values=[0.2, 0.3], zip=[together])
    assert axis.entries_at(0.25) == pytest.approx({"body.A.poisson": 0.25, "body.B.poisson": 0.275})
    assert TableAxis(**RATIO).entries_at(0.75)["friction.mu"] == pytest.approx([0.3, 0.225])
    files = TableAxis(key="gap.file", name="worn", values=["new", "worn"], at=[0.0, 1e3])
    assert files.apart
    assert not TableAxis(**RATIO).apart


@pytest.mark.parametrize(
    ("given", "symmetries"),
    [
        ({}, (True, True)),
        ({"axis": [RATIO]}, (True, True)),
        ({"axis": [{"key": "friction.angle", "values": [0, 90]}, RATIO]}, (False, True)),
        ({"axis": [{"key": "friction.angle", "values": [0, 90]}]}, (True, True)),
        ({"scene": soft()}, (True, False)),
        ({"scene": soft().replace(friction={"mu": [0.3, 0.2], "angle": 20.0})}, (False, False)),
    ],
)
def test_symmetries_are_those_of_all_scenes(given, symmetries):
    assert ts.TableDesign(**given).symmetries == symmetries


@pytest.mark.parametrize(
    ("given", "named"),
    [
        ({"axis": [{"key": "friction.angel", "values": [0, 1]}]}, "friction.angel"),
        ({"axis": [{"key": "load.normal", "values": [1, 2]}]}, r"axis\[0\].key.*scene"),
        ({"axis": [RATIO | {"at": None}]}, r"axis\[0\].at"),
        ({"axis": [RATIO | {"at": [1.0, 0.5]}]}, r"axis\[0\].at"),
        ({"axis": [RATIO | {"at": [1.0]}]}, r"axis\[0\].at"),
        ({"axis": [RATIO | {"name": "mu"}]}, r"axis\[0\].name"),
        ({"axis": [RATIO | {"name": "1st"}]}, r"axis\[0\].name"),
        ({"axis": [RATIO, RATIO]}, "axis.*friction.mu"),
        ({"axis": [{"key": "friction.angle", "values": [90, 0]}]}, r"axis\[0\].values"),
        ({"axis": [{"key": "friction.angle", "values": [0, 400]}]}, "friction.angle"),
        ({"scene": scene(), "ellipticity": 2.0}, "ellipticity"),
        ({"scene": scene(friction=None)}, "scene.friction"),
        ({"scene": "traction-control"}, "scene.transient"),
        ({"scene": scene(process={"name": "a:B", "end": 1})}, "scene.process"),
        ({"scene": scene(load={"normal": 1e3, "force_x": 10.0})}, "scene.load.force_x"),
        ({"scene": "no-such-scene"}, "scene"),
        ({"scene": "twin-discs", "axis": [{"key": "load.normal", "values": [-1, 2]}]}, "load.nor"),
    ],
)
def test_designs_that_are_none(given, named):
    with pytest.raises(ts.TableError, match=f"(?s){named}"):
        ts.TableDesign(**given)


def test_designs_are_files(tmp_path):
    text = 'scene = "twin-discs"\ntolerance = 0.1\n[[axis]]\nkey = "load.normal"\n'
    (tmp_path / "table.toml").write_text(text + "values = [100, 300]\n")
    design = ts.TableDesign.from_toml(tmp_path / "table.toml")
    assert design.scene_at((200.0,)).normal_load == 200.0
    again = ts.TableDesign.from_toml_text(design.to_toml())
    assert (again.names, again.contact) == (design.names, design.contact)


@pytest.mark.parametrize("name", ["locomotive", "hot-discs"])
def test_friction_that_varies_is_of_a_scene(name):
    speed = {"key": "creepage.speed", "values": [5e3, 2e4]}
    design = ts.TableDesign(scene=name, axis=[speed])
    assert design.symmetries == (True, True)
    slow, fast = (design.contacts((v,)) for v in (5e3, 2e4))
    w = np.array([-1.5, 0.3, 0.2])
    h = 1e-4
    gradient = slow.solve(w, 15, 15, 1.0).gradient
    for k, step in enumerate(h * np.eye(3)):
        apart = (slow.forces(w + step, 15) - slow.forces(w - step, 15)) / (2.0 * h)
        # Elements that change their state within the step.
        np.testing.assert_allclose(gradient[:, k], apart, atol=2e-3 * np.abs(gradient).max())
    # Ten times full slip: the faster, the less friction.
    far = 10.0 * w
    assert 0.98 * abs(slow.forces(far, 15)[0]) > abs(fast.forces(far, 15)[0])


@pytest.mark.parametrize(
    "requested",
    [soft(), scene(friction={"mu": [0.3, 0.15], "angle": 30.0})],
    ids=["soft", "oblique"],
)
def test_nodes_are_known_by_the_contacts_of_others(requested):
    """Half of all creepages are solved; the rest follows by the symmetry that is left."""
    design = ts.TableDesign(scene=requested, elements=15, tolerance=0.2)
    nodes, contacts = CreepageGrid(*design.symmetries), design.contacts(())
    assert nodes.full_range
    ratio = design.ratio(())
    for heading, tilt in ((0.7, -0.4), (-2.0, -1.0), (-2.5, 0.0), (1.0, -0.5 * math.pi)):
        at, signs = nodes.canonical((heading, tilt, 0.5))
        here, there = (contacts.forces(creepages_at(ratio, *one), 9)
                       for one in ((heading, tilt, 0.5), at))  # fmt: skip
        assert at[1] >= 0.0
        np.testing.assert_allclose(here, signs * there, atol=1e-6)  # tolerance of the scenes


def test_full_slip_is_that_of_friction():
    """Solved under huge creepages without a closed form: orthotropic, of one direction."""
    requested = scene(friction={"mu": [0.3, 0.15], "angle": 30.0})
    design = ts.TableDesign(scene=requested, elements=15, tolerance=0.2)
    w = np.array([math.cos(0.4), math.sin(0.4), 0.0])
    found = design.contacts(()).forces(Refinement().full * w, 15)
    expected = full_slip_force(1.0, (1.0, 0.5), math.radians(30.0), (w[0], w[1]))
    # Nothing sticks: what is left is the tolerance of the solver.
    np.testing.assert_allclose(found, [*expected, 0.0], atol=1e-5)


def law(heading, tilt, u):
    """Any smooth function of a vector, without symmetries, and its derivatives by coordinates."""
    h, t, r = (np.asarray(one, float) for one in (heading, tilt, u))
    x, y, z = r * np.cos(t) * np.cos(h), r * np.cos(t) * np.sin(h), r * np.sin(t)
    f = np.stack([np.sin(x + 0.3 * y), np.cos(y - 0.5 * z) + x * z, np.exp(0.3 * z - 0.2 * x)], -1)
    by = np.stack(
        [
            np.stack([np.cos(x + 0.3 * y), 0.3 * np.cos(x + 0.3 * y), 0 * x], -1),
            np.stack([z, -np.sin(y - 0.5 * z), 0.5 * np.sin(y - 0.5 * z) + x], -1),
            np.exp(0.3 * z - 0.2 * x)[..., None] * np.array([-0.2, 0.0, 0.3]),
        ],
        -2,
    )
    moved = np.stack(
        [
            np.stack([-y, x, 0 * x], -1),
            np.stack([-r * np.sin(t) * np.cos(h), -r * np.sin(t) * np.sin(h), r * np.cos(t)], -1),
            np.stack([np.cos(t) * np.cos(h), np.cos(t) * np.sin(h), np.sin(t)], -1),
        ],
        -1,
    )
    return f, by @ moved


def test_whole_tables_converge_across_the_seam_and_the_poles():
    random = np.random.default_rng(5)
    low, high = np.array([-math.pi, -math.pi / 2, 0.0]), np.array([math.pi, math.pi / 2, 1.0])
    points = random.uniform(low, high, (300, 3)).T
    exact, worst = law(*points)[0].T, []
    for n in (1, 2, 4):
        counts = (8 * n + 1, 4 * n + 1, 4 * n + 1)
        axes = [np.linspace(*ends) for ends in zip(low, high, counts, strict=True)]
        values, slopes = law(*np.meshgrid(*axes, indexing="ij"))
        found = Hermite(tuple(axes), coefficients(axes, values, slopes, full_range=True))
        worst.append(np.abs(found(points) - exact).max())
    # Mixed derivatives by central differences leave the third order at least.
    assert worst[0] / worst[1] > 6.0
    assert worst[1] / worst[2] > 6.0


ANGLE = """
scene = "spheres-orthotropic"
tolerance = 0.2
elements = 15
[[axis]]
key = "friction.angle"
values = [0, 60]
"""

WORN = """
tolerance = 0.2
elements = 15
[scene]
body.A = {young = 208e3, poisson = 0.3, radius_x = 460.0, radius_y = inf}
body.B = {young = 208e3, poisson = 0.3, radius_x = inf, radius_y = 300.0}
load.normal = 80e3
friction.mu = 0.3
[[axis]]
key = "gap.file"
name = "worn"
values = ["new.csv", "worn.csv"]
at = [0, 1000]
"""


@pytest.mark.slow  # some hundred contacts of each table are solved
@pytest.mark.usefixtures("few_table_nodes")
@pytest.mark.parametrize(("text", "name"), [(ANGLE, "angle"), (WORN, "worn")])
def test_the_command_makes_tables_with_axes(text, name, tmp_path):
    """The errors reported refer to points anywhere, at all values of the axis."""
    y = np.linspace(-20.0, 20.0, 81)
    for file, depth in (("new", 0.0), ("worn", 0.02)):
        columns = np.column_stack([y, depth * np.exp(-((y / 4.0) ** 2))])
        np.savetxt(tmp_path / f"{file}.csv", columns, delimiter=",", header="y, separation",
                   comments="")  # fmt: skip
    (tmp_path / "design.toml").write_text(text)
    made = CliRunner().invoke(
        app, ["table", str(tmp_path / "design.toml"), "-o", str(tmp_path / "made.nc")]
    )
    assert made.exit_code == 0, made.output
    table = ts.open_table(tmp_path / "made.nc")
    assert table.names == (name,)
    assert table.whole
    assert table.about["held_out_worst"] <= 0.2
    design, inside = ts.TableDesign.from_toml(tmp_path / "design.toml"), []
    random, (a, b, load, mu, shear) = np.random.default_rng(3), table.contact.values()
    c = math.sqrt(a * b)
    unit = mu * load * np.array([1.0, 1.0, c])
    creepages = mu * load / (shear * c**2) * np.array([1.0, 1.0, 1.0 / c])
    for place in table.axis(name):
        contacts = design.contacts((float(place),))
        for w in random.normal(size=(6, 3)) * [0.5, 0.5, 1.0]:
            found = table(*(w * creepages), **{name: place})
            off = np.abs([found.Qx, found.Qy, found.Mz] / unit - contacts.forces(w, 21))
            inside.append(bool((off <= found.error / unit + 1e-9).all()))
    assert np.mean(inside) >= 0.8  # 95 of 100 are to be, of twelve maybe ten


def test_files_next_to_an_axis_are_sought_from_the_folder_of_the_design(tmp_path):
    zipped = {"key": "gap.file", "values": ["one.csv", "two.csv"]}
    tables = {"axis": [{"key": "load.normal", "values": [1.0, 2.0], "zip": [zipped]}]}
    ts.TableDesign.resolve_files(tmp_path, tables)
    assert zipped["values"] == [str(tmp_path / "one.csv"), str(tmp_path / "two.csv")]
    assert ts.TableDesign.resolve_files(tmp_path, {"axis": 5}) == {"axis": 5}  # reported later


@pytest.mark.slow
def test_positions_of_a_wheelset_are_axes():
    tables = ts.Scene.builtin("wheel-rail").entries() | {"wheelset": {"y": 1.0, "normal_load": 8e4}}
    axes = [{"key": "wheelset.y", "values": [1.0, 1.5]}, {"key": "wheelset.yaw", "values": [0, 5]}]
    design = ts.TableDesign(scene=tables, axis=axes)
    assert design.names == ("wheelset_y", "yaw")
    assert design.symmetries == (False, True)
    w = np.array([1.0, -0.5, 0.2])
    contacts = design.contacts((1.5, 2.0))
    state = contacts.solve_on_mesh(w, 15)
    motion = {"longitudinal": state.xi_x, "lateral": state.xi_y, "spin": state.spin}
    grid = {"half_length": state.grid.half_length, "elements": state.grid.elements}
    tables |= {"wheelset": {"y": 1.5, "yaw": 2.0, "normal_load": 8e4}, "grid": grid}
    expected = ts.solve(ts.Scene(**tables, creepage=motion))
    assert (state.Qx, state.Qy, state.Mz) == pytest.approx((expected.Qx, expected.Qy, expected.Mz))


@pytest.mark.parametrize(
    ("wheelset", "values", "match"),
    [({"load": 8e4}, [0.0, 1.0], "normal_load"), ({"normal_load": 8e4}, [1.0, 4.9], "2 patches")],
)
def test_positions_that_a_table_cannot_have(wheelset, values, match):
    tables = ts.Scene.builtin("wheel-rail").entries() | {"wheelset": wheelset}
    with pytest.raises(ts.TableError, match=match):
        ts.TableDesign(scene=tables, axis=[{"key": "wheelset.y", "values": values}])
