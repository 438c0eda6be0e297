"""Fails the n-th call to the disk of every output, for every n, as a program of its own.

    python -m tests.disk_faults FOLDER [OUTPUT ...] [--every N]

It runs with the library of `disk_faults.c` loaded, and prints what went wrong. With `--every` it
fails each N-th call only, each kind of fault beginning with another one.
"""

import argparse
import ctypes
import errno
import os
import sys
import zipfile
from collections import Counter
from pathlib import Path

import numpy as np
from typer.testing import CliRunner

import tractive_sam as ts
from tests.store.sample_records import SCENE, make_record, mesh
from tractive_sam.cli import app, main
from tractive_sam.store import HistoryWriter, open_history

FOREVER = 10**9
FAULTS = [
    *((error, 1) for error in (errno.EIO, errno.ENOSPC, errno.EDQUOT)),
    *((error, FOREVER) for error in (errno.EIO, errno.ENOSPC, errno.EDQUOT)),
    (0, 1),  # a write that takes only half of the data
]  # fmt: skip
EARLIER = b"that of yesterday"


def write_results(path):
    with HistoryWriter(path, SCENE, mesh(), overwrite=True) as writer:
        for number in range(3):
            writer.append(make_record(number, with_fields=True, grid=mesh()))
        writer.finish("done")


def prepare(folder):
    """Write what the commands read."""
    write_results(folder / "a.h5")
    mu = {"key": "friction.mu", "values": [0.2, 0.4]}
    small = ["grid.elements=[15, 15]"]
    asked = ts.Study(scene="spheres", keep="scalars", without=["subsurface"], set=small, axis=[mu])
    ts.study(asked, folder / "study", workers=0)
    (folder / "study.toml").write_text(asked.to_toml())


def commands(folder, out):
    """Arguments of each output, and its file."""
    results, cases = folder / "a.h5", folder / "study"
    return {
        "report": (["report", results, "-o", out / "a.html"], out / "a.html"),
        "header": (["table", "steel", "--header", out / "steel.h"], out / "steel.h"),
        "text": (["table", "steel", "--text", out / "steel.txt"], out / "steel.txt"),
        "figure": (["table", "steel", "--figure", out / "steel.png"], out / "steel.png"),
        "fmu": (["table", "steel", "--fmu", out / "steel.fmu"], out / "steel.fmu"),
        "csv": (["study-show", cases, "--csv", out / "a.csv"], out / "a.csv"),
        "netcdf": (["study-show", cases, "--netcdf", out / "a.nc"], out / "a.nc"),
        "figures": (
            ["study-show", cases, "--figures", out, "--quantity", "Qx"], out / "Qx-curve.png",
        ),
        "scene": (["scenes", "--write", "spheres"], out / "spheres.toml"),
        "export": (
            ["export", results, "--surface", "-o", out / "a.vtkhdf"], out / "a.vtkhdf",
        ),
        "run": (
            ["run", "spheres", "--set", "grid.elements=[15, 15]", "-o", out / "b.h5"], out / "b.h5",
        ),
        "study": (["study", folder / "study.toml", "-o", out / "s"], out / "s" / "complete.jsonl"),
    }  # fmt: skip


def in_child(act, log):
    """Run in a process of its own; its status, or minus the signal that ended it."""
    child = os.fork()
    if not child:
        stream = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(stream, 1)
        os.dup2(stream, 2)
        act()
        sys.exit(0)  # all the way out, as what HDF5 holds open ends there
    status = os.waitpid(child, 0)[1]
    return os.waitstatus_to_exitcode(status)


def is_whole(name, file, reference):
    if name == "fmu":  # with the time of its making
        return zipfile.ZipFile(file).testzip() is None
    if name in ("run", "export", "netcdf"):
        return len(file.read_bytes()) == len(reference) or bool(len(open_history(file)))
    if name == "study":
        lines = file.read_bytes().split(b"\n")
        return len(lines) == len(reference.split(b"\n"))
    return file.read_bytes() == reference


def wrong(name, file, status, message, reference, earlier):
    """What contradicts the law of an output that failed or not."""
    if status not in (0, 3):
        yield f"status {status}"
    if "Traceback" in message or "Exception ignored" in message:
        yield "a traceback"
    named = file.name in message or file.parent.name in message
    if status == 3 and not (named and "error: " in message):
        yield "no message that names the file"
    left = [one.name for one in file.parent.glob(".*") if one.name.endswith((".new", ".part"))]
    if left:
        yield f"left behind {left}"
    if status == 3 and name not in ("study", "run"):
        found = file.read_bytes() if file.exists() else None
        if found != earlier and not is_whole(name, file, reference):
            yield "neither the earlier file nor the whole new one"
    if status == 0 and not is_whole(name, file, reference):
        yield "not the whole file"


def clear(out, file, earlier):
    for one in sorted(out.rglob("*"), reverse=True):
        one.rmdir() if one.is_dir() else one.unlink()
    out.mkdir(exist_ok=True)
    if earlier is not None:
        file.write_bytes(earlier)


def fail_every_call(name, arguments, file, out, log, counts, every=1):
    """Fail the n-th call, for every n until there is none left, by every fault."""
    library = ctypes.CDLL(None)

    def act():
        os.chdir(out)
        sys.argv[1:] = [str(one) for one in arguments]
        main()

    clear(out, file, None)
    library.fail_calls(b"", 0, 0, 0)
    os.chdir(out)
    done = CliRunner().invoke(app, [str(one) for one in arguments])  # children import no more
    assert done.exit_code == 0, done.output
    reference = file.read_bytes()
    earlier = EARLIER if name not in ("scene", "run", "study") else None
    earlier = reference if name == "export" else earlier  # it replaces no other files
    for first, (error, length) in enumerate(FAULTS):
        for call in range(first % every, 1000, every):
            clear(out, file, earlier)
            library.fail_calls(os.fsencode(f"{out}/"), call, call + length, error)
            status = in_child(act, log)
            calls = library.calls_so_far()
            library.fail_calls(b"", 0, 0, 0)
            message = log.read_text(errors="replace")
            found = list(wrong(name, file, status, message, reference, earlier))
            counts["tried"] += 1
            counts["failed"] += bool(found)
            if found:
                kind = errno.errorcode.get(error, "short")
                print(
                    f"{name}, {kind} at call {call} for {length}: {found}: {message[-300:]!r}",
                    flush=True,
                )
            if calls <= call:
                break


def run(folder, names, every):
    out, log, counts = folder / "output", folder / "log", Counter()
    out.mkdir()
    prepare(folder)
    for name, (arguments, file) in commands(folder, out).items():
        if not names or name in names:
            before = counts.copy()
            fail_every_call(name, arguments, file, out, log, counts, every)
            print(name, dict(counts - before), flush=True)
    print(f"{counts['tried']} tried, {counts['failed']} failed")
    sys.exit(1 if counts["failed"] else 0)


if __name__ == "__main__":
    np.seterr(all="ignore")
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path)
    parser.add_argument("outputs", nargs="*")
    parser.add_argument("--every", type=int, default=1)
    given = parser.parse_args()
    run(given.folder, given.outputs, given.every)
