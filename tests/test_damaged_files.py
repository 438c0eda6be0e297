"""Damaged and hostile files of fits, studies and tables: no other number, and no traceback."""

import random
import shutil
from collections import Counter
from contextlib import suppress

import h5py
import numpy as np
import pytest
import xarray
from typer.testing import CliRunner

import tractive_sam as ts
from tests.fitting.conftest import creep_data
from tractive_sam.cli import app
from tractive_sam.fitting.fit_file import write_fit
from tractive_sam.fitting.results import FitResult
from tractive_sam.store import DamagedError, ResultsError, write_netcdf
from tractive_sam.store.netcdf import open_netcdf
from tractive_sam.tables.table_file import write_table

SPHERES = ts.Scene.builtin("spheres").with_set(["grid.elements=[15, 15]"]).replace(subsurface=None)


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Return the files of a fit, of a table and of the log of a study, by kind."""
    folder = tmp_path_factory.mktemp("files")
    data = creep_data(SPHERES, {"friction.mu": 0.35})
    test = {"vary": "creepage.longitudinal", "values": [-0.01], "observe": "Qx_over_P"}
    fit = {"scene": SPHERES, "free": ["friction.mu"], "data": [data], "intervals": "profile"}
    fit["test"] = [test | {"noise": 0.05}]
    ts.fit(fit, folder / "fit.nc", next_test=True)
    write_table(ts.open_table("steel"), folder / "table.nc")
    axis = {"key": "friction.mu", "values": [0.2, 0.3, 0.4]}
    study = ts.Study(scene=SPHERES, axis=[axis], keep="scalars")
    ts.study(study, folder / "study", workers=0)
    return {
        "fit": folder / "fit.nc",
        "table": folder / "table.nc",
        "study": folder / "study" / "complete.jsonl",
    }


def read_fit(path):
    """Everything that a fit's file contains, with the texts that are made of it."""
    found = ts.open_fit(path)
    variables = {name: repr(v.values.tolist()) for name, v in found.dataset.variables.items()}
    return variables | {"attributes": repr(found.dataset.attrs), "shown": repr(found.to_dict())}


def read_table(path):
    table = ts.open_table(path)
    arrays = [*table.law.axes, table.law.coefficients, table.bars, *table.between]
    return {"about": repr(table.about)} | dict(enumerate(array.tobytes() for array in arrays))


def read_study(path):
    """Return the numbers of cases that are said to be complete."""
    study = ts.open_study(path.parent)
    names = ("Qx", "p_max", "approach") if study.counts["complete"] else ()
    columns = {(name, k): x for name in names for k, x in enumerate(study.column(name).tolist())}
    return {name: number for name, number in columns.items() if np.isfinite(number)}


READERS = {"fit": read_fit, "table": read_table, "study": read_study}


def damage(content, seed):
    """Return (kind of damage, damaged content)."""
    chance, content = random.Random(seed), bytearray(content)
    kind = ("bit", "byte", "zeros", "page of zeros", "swapped pages", "truncated")[seed % 6]
    place, size = chance.randrange(len(content)), {"zeros": 64, "page of zeros": 4096}.get(kind)
    if kind == "bit":
        content[place] ^= 1 << chance.randrange(8)
    elif kind == "byte":
        content[place] ^= chance.randrange(1, 256)
    elif size is not None:
        start = place // size * size
        content[start : start + size] = bytes(len(content[start : start + size]))
    elif kind == "truncated":
        del content[place:]
    else:
        first, second = place // 512 * 512, chance.randrange(len(content)) // 512 * 512
        one, other = (bytes(content[at : at + 512]) for at in (first, second))
        content[first : first + len(other)], content[second : second + len(one)] = other, one
    return kind, bytes(content)


@pytest.mark.slow
@pytest.mark.parametrize("kind", READERS)
def test_no_random_damage_gives_other_numbers(files, tmp_path, kind):
    source, read, count = files[kind], READERS[kind], 60
    content, expected = source.read_bytes(), read(source)
    shutil.copytree(source.parent, tmp_path / "copy")
    path, outcomes = tmp_path / "copy" / source.name, Counter()
    for seed in range(count):
        name, damaged = damage(content, seed)
        path.write_bytes(damaged)
        try:
            found = read(path)
        except (ResultsError, ts.StudyError):
            outcomes[name, "reported"] += 1
            continue
        # A study computes lost cases again.
        same = found.items() <= expected.items() if kind == "study" else found == expected
        assert same, f"{name}, seed {seed}"
        outcomes[name, "same"] += 1
    assert outcomes.total() == count
    print(kind, dict(outcomes))


@pytest.mark.parametrize(
    "kind", ["external", "virtual", "raw", "soft", "group", "claim", "objects"]
)
def test_a_fit_leads_to_no_other_file_and_claims_no_more_than_it_holds(files, tmp_path, kind):
    path, secret = shutil.copy(files["fit"], tmp_path / "fit.nc"), tmp_path / "secret"
    secret.write_bytes(np.full(1, 12345.0).tobytes())
    with h5py.File(tmp_path / "other.h5", "w") as other:
        other["z"] = np.full(1, 12345.0)
    with h5py.File(path, "r+") as file:
        del file.attrs["checksum"]  # as an attacker would do
        del file["value"]
        if kind == "external":
            file["value"] = h5py.ExternalLink(str(tmp_path / "other.h5"), "/z")
        elif kind == "soft":
            file["value"] = h5py.SoftLink("/sd")
        elif kind == "raw":
            file.create_dataset("value", (1,), float, external=[(str(secret), 0, 8)])
        elif kind == "virtual":
            layout = h5py.VirtualLayout((1,), float)
            layout[...] = h5py.VirtualSource(str(tmp_path / "other.h5"), "z", (1,))
            file.create_virtual_dataset("value", layout)
        elif kind == "group":
            file.create_group("value")
        elif kind == "claim":
            file.create_dataset("value", (10**12,), float, chunks=(10**6,))
        else:
            file.create_dataset("value", (1,), np.dtype([("a", float)]))
    with pytest.raises(DamagedError, match="value"):
        ts.open_fit(path)


def test_every_byte_is_checked_and_old_files_open(files, tmp_path):
    path = shutil.copy(files["fit"], tmp_path / "fit.nc")
    with open_netcdf(path) as file:
        plain = [name for name, item in file.items() if item.shape and not item.fletcher32]
    written = ts.open_fit(path).dataset.variables
    assert {written[name].dtype.kind for name in plain if name in written} <= {"O", "U"}  # texts
    with h5py.File(path, "r+") as file:  # another program changes it, and its last line is lost
        file["value"][...] *= 2.0
    with pytest.raises(DamagedError, match="changed"):
        ts.open_fit(path)
    with h5py.File(path, "r+") as file:  # as files of earlier versions
        del file.attrs["checksum"]
    assert ts.open_fit(path).values["friction.mu"] > 0.5
    xarray.load_dataset(files["fit"], engine="h5netcdf").close()  # other programs read the files


TEXTS = ("abscissa_name", "observation", "coordinate", "parameter", "design", "test", "notes",
         "curve_column", "answer_layout", "answer_message")  # fmt: skip


@pytest.mark.slow
def test_commands_read_changed_texts_of_a_fit(files, tmp_path):
    """Each text is refused, or shown; those that are shown are changed at once, and drawn."""
    path, right = tmp_path / "fit.nc", ts.open_fit(files["fit"]).dataset

    def change(names, text):
        texts = {
            name: (right[name].dims, np.full(right[name].shape, text, object), right[name].attrs)
            for name in names
        }
        write_fit(path, FitResult(right.assign(texts)))

    hostile, shown = "</script><img src=x onerror=alert(1)>$\\frac{\x1b[31m", []
    for name in TEXTS:
        if name in right:
            change([name], hostile)
            if check_command("show", path) == 0:
                shown.append(name)
    assert shown
    for text in (hostile, ""):
        change(shown, text)
        for command in ("show", "plot", "report"):
            check_command(command, path)


@pytest.mark.slow
@pytest.mark.parametrize("number", [0.0, -1.0])
def test_changed_numbers_of_a_fit_are_shown_or_refused(files, tmp_path, number):
    before, path = ts.open_fit(files["fit"]).dataset, tmp_path / "fit.nc"
    for name in ("value", "sd", "mesh_shift", "correlation", "model_error", "noise"):
        write_netcdf(path, before.assign({name: before[name] * 0.0 + number}))
        with suppress(DamagedError), np.errstate(all="ignore"):
            found = ts.open_fit(path)
            assert found.to_dict()
            assert found.tables()
            assert found.summary()
    for name in ("noise", "band", "sd") if number < 0.0 else ():
        write_netcdf(path, before.assign({name: -before[name]}))
        check_command("plot", path)


COMMANDS = (
    *("run FILE -o made.h5", "run spheres -o FILE --resume", "run spheres -o made.h5 --start FILE"),
    *("explain FILE", "show FILE", "show FILE --json", "plot FILE -o made", "report FILE -o made"),
    *(
        "export FILE -o made.vtkhdf",
        "locus FILE -o made.csv",
        "wear FILE -o made",
        "study-show FILE",
    ),
    *(
        "fit FILE -o made.nc",
        "fit FIT.toml -o FILE",
        "study FILE -o made",
        "table FILE --text made",
    ),
    *("study STUDY.toml -o FILE", "run spheres --set gap.file='FILE'"),
)
"""Commands that read a file of any kind."""

CONTENTS = {
    "zeros": lambda _: bytes(4096),
    "half": lambda content: content[: len(content) // 2],
    "hole": lambda content: content[:2000] + bytes(2000) + content[4000:],
    "bits": lambda content: bytes(byte ^ (k % 97 == 5) for k, byte in enumerate(content)),
    "claims HDF5": lambda _: b"\x89HDF\r\n\x1a\n" + bytes(2000),
    "one key": lambda _: b"scene = 1\n[fit]\nscene = [1]\n",
}
"""Damaged or hostile content of a file, made of its right content."""


@pytest.mark.slow
@pytest.mark.parametrize("suffix", [".toml", ".h5", ".nc", ".csv"])
def test_every_command_ends_with_a_message(files, tmp_path, monkeypatch, suffix):
    """A matrix of kinds of files, contents and commands; a hole may be in unused space."""
    monkeypatch.chdir(tmp_path)
    right = SPHERES.to_toml().encode()
    if suffix == ".h5":
        ts.roll(SPHERES, "right.h5")
        right = (tmp_path / "right.h5").read_bytes()
    elif suffix == ".nc":
        right = files["fit"].read_bytes()
    path = tmp_path / f"x{suffix}"
    data = '[[fit.data]]\nvary = "creepage.longitudinal"\nobserve = "Qx_over_P"\nnoise = 0.05\n'
    fit = f'[fit]\nscene = "spheres"\nfree = "friction.mu"\n{data}file = "{path.name}"\n'
    (tmp_path / "FIT.toml").write_text(fit)
    (tmp_path / "STUDY.toml").write_text(f'scene = "{path.name}"\naxis = 3\n')
    for content, change in CONTENTS.items():
        for command in COMMANDS:
            for made in tmp_path.glob("made*"):
                shutil.rmtree(made) if made.is_dir() else made.unlink()
            path.write_bytes(change(right))
            with np.errstate(all="ignore"):
                found = CliRunner().invoke(app, command.replace("FILE", path.name).split())
            allowed = (0, 2, 3) if content == "hole" else (2, 3)
            assert found.exit_code in allowed, (content, command, found.exception)


def check_command(command, path):
    """Run a command on a file, which ends without a traceback; return its exit status."""
    output = () if command == "show" else ("-o", path.with_name(f"made-{command}"))
    found = CliRunner().invoke(app, [command, *map(str, (path, *output))])
    assert found.exit_code in (0, 2, 3), (command, found.exception)
    assert found.exception is None or isinstance(found.exception, SystemExit)
    return found.exit_code
