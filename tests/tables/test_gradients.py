"""Gradients of tables: slopes at rest, and error bars."""

import math

import h5py
import numpy as np
import pytest
from typer.testing import CliRunner

import tractive_sam as ts
from tests.tables import copy_without_seal
from tractive_sam.cli import app
from tractive_sam.lookup import cell_of, share_of_bar
from tractive_sam.reference import creep_coefficients
from tractive_sam.tables import explain_table
from tractive_sam.tables.builder import GradientBars, coefficients
from tractive_sam.tables.design import Contacts, extrapolate_slopes, rest_meshes, unit_scene

pytest.importorskip("xarray", reason="xarray is of the extra study")


@pytest.fixture(scope="module")
def table():
    return ts.open_table("steel")


def scaled_contact(ratio):
    """A contact in which scaled creepages are creepages: G = mu P = c = 1."""
    root = np.sqrt(ratio)
    return {"a": root, "b": 1.0 / root, "load": 1.0, "mu": 1.0, "shear": 1.0}


def slopes(table, ratio):
    return table(0.0, 0.0, 0.0, **scaled_contact(ratio)).gradient


@pytest.mark.slow
@pytest.mark.parametrize("ratio", [0.7, 3.9])
def test_slopes_at_rest_are_those_of_fine_meshes(table, ratio):
    """Between the nodes along a/b, against meshes that the table has not seen."""
    meshes = 2 * np.unique(np.rint(np.geomspace(33, 81, 10) / 2).astype(int))
    limit, bar = Contacts(unit_scene(ratio, 0.3)).slopes_at_rest(meshes + 1)
    found = slopes(table, ratio)
    known = np.abs(limit) > 0.1  # others are zero by symmetry
    assert known.sum() == 5
    # 0.3 % of each coefficient, and what the reference may be off itself.
    assert (np.abs(found - limit) <= 0.003 * np.abs(limit) + bar)[known].all()
    error = table(0.0, 0.0, 0.0, **scaled_contact(ratio)).gradient_error
    assert (np.abs(found - limit) <= error + bar)[known].all()
    assert error.max() < 0.004 * np.abs(limit).max()


def test_slopes_at_rest_are_reciprocal_and_near_kalkers(table):
    """C23 of the lateral force equals C23 of the moment; Kalker's numbers have three digits."""
    for ratio in np.geomspace(*table.ellipticity, 25):
        K = -slopes(table, ratio * (1.0 - 1e-12) if ratio > 1.0 else ratio)
        # A tenth of a percent: two sums over equal tractions, extrapolated separately.
        assert K[2, 1] == pytest.approx(-K[1, 2], rel=1e-3)
        k = creep_coefficients(ratio, 0.3)
        found = [K[0, 0], K[1, 1], K[1, 2], K[2, 2]]
        # Half of the last of three digits is 0.4 % at most, and 0.3 is between two columns.
        np.testing.assert_allclose(found, [k.C11, k.C22, k.C23, k.C33], rtol=0.01)


def test_fits_find_the_limit_and_how_far_they_are_off():
    """Slopes of a known law in 1/n and the moments, with scatter beside it."""
    random, meshes = np.random.default_rng(4), rest_meshes(15, 101, 0.008)
    off = []
    for _ in range(200):
        moments = random.normal(size=(len(meshes), 2)) / meshes[:, None]
        scatter = 0.3 * random.normal(size=len(meshes)) / meshes**1.5
        values = 4.0 + 0.5 / meshes + moments @ [1.0, -0.7] + scatter
        limit, bar = extrapolate_slopes(meshes, values, moments)
        off.append(abs(limit - 4.0) / bar)
        # Without the moments the fit is several times less sure.
        assert extrapolate_slopes(meshes, values, moments[:, :0])[1] > 1.5 * bar
    # 95 of 100 are to be within; of 200 trials 181 to 199 are, in 998 of 1000 cases.
    assert 181 <= np.sum(np.array(off) <= 1.0) <= 199


def test_equal_moments_are_one_unknown():
    """A circle in square elements has equal excesses along x and y."""
    meshes = np.arange(15, 41, 2)
    moment = np.sin(meshes) / meshes
    limit, bar = extrapolate_slopes(meshes, 2.0 + moment, np.stack([moment, moment], axis=1))
    # Exact but for rounding.
    assert limit == pytest.approx(2.0, abs=1e-12)
    assert bar < 1e-12


def test_finer_tables_take_finer_meshes_at_rest():
    rough, fine = rest_meshes(15, 101, 0.08), rest_meshes(15, 101, 0.008)
    assert abs(rough.max() - 30) == 1  # twice the elements, made odd
    assert fine.max() == 101
    assert rest_meshes(15, 15, 0.008).max() == 15  # no more than the design allows
    assert (np.concatenate([rough, fine]) % 2 == 1).all()


def test_slopes_at_rest_vary_along_other_axes_as_they_do_at_the_nodes():
    """Between a/b the slope by u at rest follows from the slopes by u alone, not from values
    beside."""
    x, heading, tilt = np.linspace(-1.0, 1.0, 6), np.linspace(-1.5, 1.5, 5), np.linspace(0, 1.5, 4)
    u, random = np.array([0.0, 0.2, 0.5, 1.0]), np.random.default_rng(0)
    shape = (6, 5, 4, 4, 3)
    values, by = random.normal(size=shape), random.normal(size=(*shape, 3))
    cubic = x**3 - x
    by[..., 0, :, 2] = cubic[:, None, None, None]
    found = coefficients((x, heading, tilt, u), values, by)[..., 0, 9, :]  # by x and u
    # A cubic is its own spline.
    np.testing.assert_allclose(found, np.broadcast_to((3 * x**2 - 1)[:, None, None, None],
                                                      found.shape), atol=1e-12)  # fmt: skip


def test_error_bars_of_gradients_contain_new_errors():
    """Errors with sizes that differ by the interval and have a heavy tail."""
    random, nodes = np.random.default_rng(2), np.array([0.0, 0.1, 0.3, 0.6, 1.0])
    size = np.array([0.02, 0.1, 0.05, 0.01])

    def errors(number):
        u = random.uniform(0.0, 1.0, number)
        cell = np.searchsorted(nodes, u) - 1
        fall = np.where(cell == 3, (1.0 - u) / 0.4, np.where(cell == 0, np.minimum(30 * u, 1), 1))
        spread = (size[cell] * fall)[:, None, None] * random.standard_t(4, size=(number, 3, 3))
        return u, np.abs(spread)

    bars = GradientBars.from_errors(nodes, *errors(300), np.full((4, 3, 3), 1e-3))
    np.testing.assert_array_equal(bars.values[0], 1e-3)
    assert bars.about["gradient_at_rest"] == 1e-3
    u, found = errors(4000)
    reported = bars_at(nodes, bars.values, u)
    # Of new points, all nine derivatives: 95 of 100 are to be within.
    assert np.mean((found <= reported).all(axis=(1, 2))) >= 0.95


def bars_at(nodes, values, u):
    """Return bars at places along u, over sqrt(K_ii K_jj)."""
    cell = cell_of(nodes, u)
    bars = share_of_bar(nodes, u)[:, None, None] * values[1 + cell]
    return bars + (cell == 0)[:, None, None] * values[0]


@pytest.mark.slow
def test_gradients_anywhere_are_within_their_error_bars(table):
    """Against contacts on a finer mesh than any node."""
    random, inside = np.random.default_rng(11), 0
    for _ in range(4):
        ratio = math.exp(random.uniform(*np.log(table.ellipticity)))
        contacts = Contacts(unit_scene(ratio, 0.3))
        for w in random.normal(size=(4, 3)) * [0.4, 0.4, 0.8]:
            solved = contacts.solve(w, 33, 33, 1.0)
            found = table(*w, **scaled_contact(ratio))
            off = np.abs(found.gradient - solved.gradient)
            inside += bool((off <= found.gradient_error).all())
    assert inside >= 15  # 95 of 100 are to be


def test_error_bars_of_gradients_scale_and_vanish_with_them(table):
    """They have the units of gradients, the shape, and are zero in full slip."""
    w = np.random.default_rng(3).normal(size=(3, 2, 5))
    contact = {"a": 6.0, "b": 4.0, "load": 8e4, "mu": 0.3, "shear": 8e4}
    c, bound = math.sqrt(24.0), 0.3 * 8e4
    scale = 8e4 * c**2 / bound * np.array([1.0, 1.0, c])
    found = table(*(w / scale[:, None, None]), **contact).gradient_error
    unit = table(*w, **scaled_contact(1.5)).gradient_error
    assert found.shape == (3, 3, 2, 5)
    factor = bound * np.array([1.0, 1.0, c])[:, None] * scale
    # Products of equal numbers, rounded in another order.
    np.testing.assert_allclose(found, unit * factor[:, :, None, None], rtol=1e-9)
    assert (table(math.inf, 0.0, 0.0, **contact).gradient_error == 0.0).all()
    mirrored = table(w[0], -w[1], -w[2], **scaled_contact(1.5)).gradient_error
    np.testing.assert_array_equal(mirrored, unit)


def test_files_from_before_gradients_were_measured(tmp_path, table):
    """They open, give equal forces, and report that the error of gradients is unknown."""
    path = copy_without_seal(tmp_path / "old.nc")
    with h5py.File(path, "r+") as file:
        del file["gradient_bar"]
        for name in [name for name in file.attrs if name.startswith("gradient_")]:
            del file.attrs[name]
    old = ts.open_table(path)
    f, g = (one(1e-3, 0.0, 2e-4, a=6.0, b=4.0, load=8e4, mu=0.3, shear=8e4) for one in (old, table))
    assert f.Qx == g.Qx
    assert np.isnan(f.gradient_error).all()
    assert np.isfinite(g.gradient_error).all()
    (old_row,), (row,) = (
        [text for name, text in explain_table(one)[2].rows if name == "gradients"]
        for one in (old, table)
    )
    assert "tractive-sam table" in old_row  # how to measure them
    assert f"{table.about['gradient_checks']} points" in row


def test_show_reports_gradients_of_the_table_of_steel():
    shown = CliRunner().invoke(app, ["show", "steel", "--json"])
    assert '"gradient_at_rest"' in shown.stdout
