"""Fails the n-th call to the disk of every output, for every n, as a separate program.

    python -m tests.disk_faults FOLDER [OUTPUT ...] [--tries N]

It runs with the library of `disk_faults.c` loaded, and prints what went wrong. With `--tries` it
tries only N pairs of a call and a fault of each output, evenly spread over all.

Every try is a copy (fork) of one process that has imported and compiled all that it needs. Results
files are written after each record, so that faults meet every state of a file.
"""

import argparse
import atexit
import ctypes
import errno
import gc
import math
import os
import sys
import zipfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from unittest.mock import patch

import numpy as np
from typer.testing import CliRunner

import tractive_sam as ts
from tests.store.sample_records import SCENE, make_record, mesh
from tractive_sam.cli import app, main
from tractive_sam.store import HistoryWriter, ResultsError, open_history, writer
from tractive_sam.store.opening import open_results
from tractive_sam.store.writer import Checkpoints

FOREVER = 10**9
FAULTS = [
    *((error, 1) for error in (errno.EIO, errno.ENOSPC, errno.EDQUOT)),
    *((error, FOREVER) for error in (errno.EIO, errno.ENOSPC, errno.EDQUOT)),
    (0, 1),  # a write that takes only half of the data
]  # fmt: skip
EARLIER = b"that of yesterday"
ROLLED = """
[body.A]
young = 208e3
poisson = 0.3
radius_x = 32.5
radius_y = 32.5
[body.B]
young = 208e3
poisson = 0.3
radius_x = 32.3
radius_y = inf
[load]
normal = 300.0
[creepage]
longitudinal = -0.005
[friction]
mu = 0.3
[wear]
intensity = 1e-6
revolutions = 1
save = [1]
turns = "equal"
[grid]
half_length = [0.323, 0.513]
elements = [15, 15]
"""
"""A scene with few records and fields: most of its time belongs to its file."""


@dataclass
class Try:
    """A command with one failed call.

    Attributes
    ----------
    status : int
        Exit status, or minus the signal that ended it.
    message : str
        Its output.
    calls, renames : int
        Number of calls, and of files that were renamed into place.
    """

    status: int
    message: str
    calls: int = 0
    renames: int = 0


@dataclass
class Output:
    """A command that writes a file, which is equal to the byte each time."""

    arguments: list
    file: Path
    earlier: bytes | None = EARLIER  # content of the file before
    finalized_every: int = 1  # tries after which one removes all objects of Python as it ends

    def set_reference(self) -> None:
        """Take the file of an undisturbed command to compare with."""
        self.reference = self.file.read_bytes()

    def is_complete(self) -> bool:
        return self.file.read_bytes() == self.reference

    def violations(self, tried: Try) -> Iterator[str]:
        """Describe what contradicts the law of an output."""
        if tried.status == 0 and not self.is_complete():
            yield "not the whole file"
        if tried.status == 3:
            found = self.file.read_bytes() if self.file.exists() else None
            if found != self.earlier and not self.is_complete():
                yield "neither the earlier file nor the whole new one"


class Archive(Output):
    """A zip file, with the time at which it was made."""

    def is_complete(self) -> bool:
        return zipfile.ZipFile(self.file).testzip() is None


class SameSize(Output):
    """A file that holds times of its making."""

    def is_complete(self) -> bool:
        return self.file.stat().st_size == len(self.reference)


class Export(SameSize):
    """A file that replaces only files of its kind."""

    def set_reference(self) -> None:
        super().set_reference()
        self.earlier = self.reference


class Cases(Output):
    """The list of cases of a study, which grows: an incomplete one is continued."""

    def violations(self, tried: Try) -> Iterator[str]:
        lines = self.file.read_bytes().split(b"\n") if self.file.exists() else []
        if tried.status == 0 and len(lines) != len(self.reference.split(b"\n")):
            yield "not the whole file"


@dataclass
class Results(Output):
    """A results file: it opens, holds all records written before the fault, and can be resumed."""

    # Removing all objects takes as long as the command; its files are closed by then.
    finalized_every: int = 10
    resumed_every: int = 50  # tries after which a state of the file is resumed once more
    resumed: Counter = field(default_factory=Counter)

    def set_reference(self) -> None:
        super().set_reference()
        self.history = open_history(self.file)
        self.begun = 0
        if self.earlier is not None and "--resume" in self.arguments:
            self.begun = len(self.history) - 1

    def violations(self, tried: Try) -> Iterator[str]:
        found = self.file.read_bytes() if self.file.exists() else None
        if not tried.renames and found != self.earlier:
            yield "the file changed before a copy took its place"
        elif tried.renames and found is None:
            yield "the file is lost"
        state = None
        if found is not None:
            try:
                state = yield from self._damage(tried)
            except ResultsError as error:
                yield f"the file does not open: {error}"
                return
        key = state, tried.status
        self.resumed[key] += 1
        if self.resumed[key] % self.resumed_every == 1:
            yield from self._resume()

    def _damage(self, tried: Try) -> Iterator[str]:
        """Describe what is wrong with the file; returns its number of records and its status."""
        with open_results(self.file) as stored:
            stored.verify()
        history, wanted = open_history(self.file), len(self.history)
        written = min(self.begun + max(tried.renames - 1, 0), wanted)
        if tried.renames and len(history) < written:
            yield f"{len(history)} of {written} records"
        yield from self._differences(history)
        if tried.status == 0 and not (history.finished and len(history) == wanted):
            yield "not the whole file"
        return len(history), history.status

    def _differences(self, history: ts.History) -> Iterator[str]:
        costs = {"seconds", "residual", "operator_applications", "convolutions", "over_application"}
        for name in set(history.of_dims()) - costs:
            wanted = self.history[name][: len(history)]
            if not np.array_equal(history[name], wanted, equal_nan=True):
                yield f"other values of {name}"

    def _resume(self) -> Iterator[str]:
        """Describe how a run that resumes from the file differs from the undisturbed one."""
        arguments = [one for one in self.arguments if one not in ("--overwrite", "--resume")]
        resumed = run_child([*arguments, "--resume"], self.file.parent)
        self.resumed["tried"] += 1
        if resumed.status:
            yield f"not resumed: status {resumed.status}, {resumed.message}"
            return
        history = open_history(self.file)
        if not (history.finished and len(history) == len(self.history)):
            yield "resumed to another end"
        yield from (f"resumed to {one}" for one in self._differences(history))


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
    requested = ts.Study(
        scene="spheres", keep="scalars", without=["subsurface"], set=small, axis=[mu]
    )
    ts.study(requested, folder / "study", workers=0)
    (folder / "study.toml").write_text(requested.to_toml())
    (folder / "rolled.toml").write_text(ROLLED)
    further = ROLLED.replace("revolutions = 1", "revolutions = 2")
    (folder / "further.toml").write_text(further)
    ts.roll(ts.Scene.from_toml_text(ROLLED), folder / "rolled.h5")


def outputs(folder, out):
    """Return each output by its name."""
    results, cases = folder / "a.h5", folder / "study"
    rolled = (folder / "rolled.h5").read_bytes()
    run = ["run", folder / "rolled.toml", "-o", out / "b.h5"]
    further = ["run", folder / "further.toml", "-o", out / "b.h5", "--resume"]
    return {
        "report": Output(["report", results, "-o", out / "a.html"], out / "a.html"),
        "header": Output(["table", "steel", "--header", out / "steel.h"], out / "steel.h"),
        "text": Output(["table", "steel", "--text", out / "steel.txt"], out / "steel.txt"),
        "figure": Output(["table", "steel", "--figure", out / "steel.png"], out / "steel.png"),
        "fmu": Archive(["table", "steel", "--fmu", out / "steel.fmu"], out / "steel.fmu"),
        "csv": Output(["study-show", cases, "--csv", out / "a.csv"], out / "a.csv"),
        "netcdf": SameSize(["study-show", cases, "--netcdf", out / "a.nc"], out / "a.nc"),
        "figures": Output(
            ["study-show", cases, "--figures", out, "--quantity", "Qx"], out / "Qx-curve.png"
        ),
        "scene": Output(["scenes", "--write", "spheres"], out / "spheres.toml", None),
        "export": Export(
            ["export", results, "--surface", "-o", out / "a.vtkhdf"], out / "a.vtkhdf"
        ),
        "run": Results(run, out / "b.h5", None),
        "resume": Results(further, out / "b.h5", rolled),
        "overwrite": Results([*run, "--overwrite"], out / "b.h5", rolled),
        "study": Cases(
            ["study", folder / "study.toml", "-o", out / "s"], out / "s" / "complete.jsonl", None
        ),
    }  # fmt: skip


def run_child(arguments, out, fault=None, finalize=True) -> Try:
    """Run a command as a copy of this process; `fault` holds arguments of `fail_calls`."""
    library, log = ctypes.CDLL(None), out.with_name("log")
    library.fail_calls(*((os.fsencode(f"{out}/"), *fault) if fault else (b"", 0, 0, 0)))
    child = os.fork()
    if not child:
        stream = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(stream, 1)
        os.dup2(stream, 2)
        os.chdir(out)
        sys.argv[1:] = [str(one) for one in arguments]
        try:
            main()
        except SystemExit as ended:
            status = int(ended.code or 0)
        if finalize:
            sys.exit(status)  # what HDF5 holds open ends there
        gc.collect()
        atexit._run_exitfuncs()
        sys.stdout.flush()
        sys.stderr.flush()
        library.exit(status)  # HDF5 ends here
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    calls, renames = library.calls_so_far(), library.renames_so_far()
    library.fail_calls(b"", 0, 0, 0)
    return Try(status, log.read_text(errors="replace"), calls, renames)


def violations(output: Output, tried: Try) -> Iterator[str]:
    """Describe what contradicts the law of any output that failed or not."""
    if tried.status not in (0, 3):
        yield f"status {tried.status}"
    if "Traceback" in tried.message or "Exception ignored" in tried.message:
        yield "a traceback"
    file = output.file
    named = file.name in tried.message or file.parent.name in tried.message
    if tried.status == 3 and not (named and "error: " in tried.message):
        yield "no message that names the file"
    left = [one.name for one in file.parent.glob(".*") if one.name.endswith((".new", ".part"))]
    if left:
        yield f"left behind {left}"
    yield from output.violations(tried)


def clear(out, output):
    for one in sorted(out.rglob("*"), reverse=True):
        one.rmdir() if one.is_dir() else one.unlink()
    out.mkdir(exist_ok=True)
    if output.earlier is not None:
        output.file.write_bytes(output.earlier)


def fail_calls(name, output, out, tries=None) -> Counter:
    """Fail the n-th call, for every n, by every fault; or that many evenly spread pairs of them."""
    counts, began = Counter(), os.times()
    earlier, output.earlier = output.earlier, None
    clear(out, output)
    os.chdir(out)
    arguments = [one for one in output.arguments if one not in ("--overwrite", "--resume")]
    done = CliRunner().invoke(app, [str(one) for one in arguments])  # children import no more
    assert done.exit_code == 0, done.output
    output.earlier = earlier
    output.set_reference()
    gc.collect()
    gc.freeze()  # else the garbage collection of each child copies all of its memory
    clear(out, output)
    undisturbed = run_child(output.arguments, out, (FOREVER, FOREVER, 0))
    found = [*violations(output, undisturbed)]
    assert not undisturbed.status, undisturbed.message
    assert not found, found
    counts["calls"] = undisturbed.calls
    pairs = [(call, fault) for call in range(undisturbed.calls) for fault in FAULTS]
    number = len(pairs) if tries is None else min(tries, len(pairs))
    for place in np.linspace(0, len(pairs) - 1, number).astype(int):
        call, (error, length) = pairs[place]
        clear(out, output)
        finalize = counts["tried"] % output.finalized_every == 0
        tried = run_child(output.arguments, out, (call, call + length, error), finalize)
        found = list(violations(output, tried))
        counts["tried"] += 1
        counts["failed"] += bool(found)
        if found:
            kind, end = errno.errorcode.get(error, "short"), tried.message[-300:]
            print(f"{name}, {kind} at call {call} for {length}: {found}: {end!r}", flush=True)
    if isinstance(output, Results):
        counts["resumed"] = output.resumed["tried"]
    counts["CPU seconds"] = round(sum(os.times()[:4]) - sum(began[:4]))
    return counts


def run(folder, names, tries):
    out, counts = folder / "output", Counter()
    out.mkdir()
    prepare(folder)
    for name, output in outputs(folder, out).items():
        if not names or name in names:
            found = fail_calls(name, output, out, tries)
            print(name, dict(found), flush=True)
            counts += found
    print(f"{counts['tried']} tried, {counts['failed']} failed")
    sys.exit(1 if counts["failed"] else 0)


if __name__ == "__main__":
    np.seterr(all="ignore")
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path)
    parser.add_argument("outputs", nargs="*")
    parser.add_argument("--tries", type=int)
    given = parser.parse_args()
    with patch.object(writer, "Checkpoints", partial(Checkpoints, math.inf)):
        run(given.folder.resolve(), given.outputs, given.tries)
