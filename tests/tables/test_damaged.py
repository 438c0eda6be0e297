"""Files of tables with wrong parts are refused when they are opened, each by its variable."""

import re

import h5py
import numpy as np
import pytest
from typer.testing import CliRunner

import tractive_sam as ts
from tests.tables import copy_without_seal
from tractive_sam.cli import app
from tractive_sam.lookup import CreepTable, Hermite, c_sources
from tractive_sam.store import ResultsError
from tractive_sam.tables import TableAxis

C = "p*/__attribute__((constructor))static void go(void){puts(0);}/*"
NAMES = ("poisson) { system(0); } int g(double q", C, 'p"><evil/>', "../p", "for", "kappa", "u",
         "poisson\u202e", "")  # fmt: skip


@pytest.fixture
def steel(tmp_path):
    """A copy of the built-in table."""
    return copy_without_seal(tmp_path / "steel.nc")


def replaced(path, name, values, **how):
    with h5py.File(path, "r+") as file:
        del file[name]
        file.create_dataset(name, data=values, **how)


def numbers_of(path, name):
    with h5py.File(path) as file:
        return file[name][()]


WRONG = {
    "nan": lambda values: values * np.nan,
    "inf": lambda values: np.full_like(values, np.inf),
    "reversed": lambda values: values[::-1],
    "constant": np.zeros_like,
    "short": lambda values: values[:-1],
    "deep": lambda values: values[None],
    "scalar": lambda values: 1.0,
    "texts": lambda values: np.full(values.shape, b"x"),
    "objects": lambda values: np.full(values.shape, "x", dtype=h5py.string_dtype()),
    "complex": lambda values: values + 1j,
    "empty": lambda values: values[:0],
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", WRONG)
@pytest.mark.parametrize("name", ["log_ratio", "heading", "tilt", "u"])
def test_axes(steel, name, kind):
    replaced(steel, name, WRONG[kind](numbers_of(steel, name)))
    with pytest.raises(ResultsError, match=name):
        ts.open_table(steel)


@pytest.mark.slow
@pytest.mark.parametrize("kind", sorted(WRONG.keys() - {"reversed", "constant"}))
@pytest.mark.parametrize("name", ["coefficients", "error_bar", "between_u", "check_errors"])
def test_arrays(steel, name, kind):
    replaced(steel, name, WRONG[kind](numbers_of(steel, name)))
    if name == "check_errors" and kind in ("nan", "inf"):
        return  # of no consequence to forces
    with pytest.raises(ResultsError, match=name):
        ts.open_table(steel)


@pytest.mark.parametrize("name", ["error_bar", "between_tilt"])
def test_errors_are_not_negative(steel, name):
    replaced(steel, name, -1.0 - numbers_of(steel, name))
    with pytest.raises(ResultsError, match=name):
        ts.open_table(steel)


def test_an_array_larger_than_its_file(steel):
    shape = (10**6, 1, 100, 100, 100, 32, 3)
    with h5py.File(steel, "r+") as file:
        del file["coefficients"]
        file.create_dataset("coefficients", shape, float, chunks=(1, 1, 10, 10, 10, 32, 3))
    with pytest.raises(ResultsError, match="coefficients"):
        ts.open_table(steel)


@pytest.mark.parametrize("kind", ["external", "virtual", "raw"])
@pytest.mark.parametrize("name", ["poisson", "u", "coefficients", "error_bar", "between_u"])
def test_no_other_file_is_read(steel, tmp_path, name, kind):
    values = numbers_of(steel, name)
    (tmp_path / "raw").write_bytes(values.tobytes())
    with h5py.File(tmp_path / "other.h5", "w") as other:
        other["z"] = values
    with h5py.File(steel, "r+") as file:
        del file[name]
        if kind == "external":
            file[name] = h5py.ExternalLink(str(tmp_path / "other.h5"), "/z")
        elif kind == "raw":
            raw = [(str(tmp_path / "raw"), 0, values.nbytes)]
            file.create_dataset(name, values.shape, values.dtype, external=raw)
        else:
            layout = h5py.VirtualLayout(values.shape, values.dtype)
            layout[...] = h5py.VirtualSource(str(tmp_path / "other.h5"), "z", values.shape)
            file.create_virtual_dataset(name, layout)
    with pytest.raises(ResultsError, match=name):
        ts.open_table(steel)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("tolerance", "x"),
        ("tolerance", np.nan),
        ("tolerance", -1.0),
        ("tolerance", [1.0, 2.0]),
        ("contacts", "many"),
        ("held_out_median", "x"),
        ("cpu_seconds", np.inf),
        ("title", 5.0),
        ("axes", 5.0),
        ("axes", "log_ratio poisson heading tilt"),
        ("axes", "log_ratio poisson u tilt heading"),
        ("axes", "poisson log_ratio heading tilt u"),
        ("axes", "log_ratio log_ratio heading tilt u"),
        ("axes", ""),
        ("apart", "nothing"),
        ("whole", 1),
        ("whole", "x"),
        ("a", 1.0),
    ],
)
def test_attributes(steel, name, value):
    with h5py.File(steel, "r+") as file:
        file.attrs[name] = value
    with pytest.raises(ResultsError, match=re.escape(str(steel))):
        ts.open_table(steel)


def test_a_damaged_table_ends_the_command_as_invalid_input(steel):
    with h5py.File(steel, "r+") as file:
        file.attrs["axes"] = ""
    assert CliRunner().invoke(app, ["show", str(steel)]).exit_code == 2


@pytest.mark.parametrize("name", NAMES)
def test_names_of_axes(steel, name):
    """These names would be code in C and XML: they are refused when read, designed and written."""
    with h5py.File(steel, "r+") as file:
        if name and name not in file:
            file[name] = file["poisson"][()]
        file.attrs["axes"] = f"log_ratio {name} heading tilt u"
    with pytest.raises(ResultsError, match=r"axes|name"):
        ts.open_table(steel)
    with pytest.raises(ts.SceneError, match="name"):
        TableAxis(key="friction.angle", values=[0.0, 45.0], name=name or "u")
    found = ts.open_table("steel")
    law, parts = found.law, (found.bars, found.between, found.about)
    with pytest.raises(ValueError, match="name"):
        c_sources(CreepTable(Hermite(law.axes, law.coefficients), ("log_ratio", name), *parts))
