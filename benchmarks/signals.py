"""How does the program end if it is interrupted at a random moment of its start?

The signals are SIGINT and SIGTERM in turn. After the program has replaced the signal handlers, it
must end with exit status 3 and one line. Before that, Python ends the program: while Python starts,
while it reads the script `tractive-sam` that pip has written (which imports `re`), and while it
reads two modules of the package, which replace the handlers before they import other modules.

`begins` is the median time, in ms after the start of the process, at which a stage begins. `lasts`
is the median length of the stage. Both are for programs that reached the next stage. `signals` is
the number of signals in the stage, `one_line` the number after which the program ended with exit
status 3 and one line, and `slowest` the longest time from a signal to the end, in s. The bytecode
must exist, so one run is not counted.

    python benchmarks/signals.py [--signals 200] [--within 60] [ARGUMENT ...]

Page: none
"""

import argparse
import os
import random
import signal
import statistics
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from time import monotonic, sleep

from timing import show, write

STAGES = ("Python", "script of pip", "package", "handlers replaced")
PROGRAM = """
import os, time
def mark():
    os.write(MARKS, b"%r " % time.monotonic())
mark()
import re, sys
mark()
import tractive_sam.cli as cli
note_at_once = cli._note_at_once
def marked():
    noted = note_at_once()
    mark()
    return noted
cli._note_at_once = marked
sys.argv[1:] = ARGUMENTS
cli.main()
"""


@dataclass
class Ending:
    """The end of a program.

    Attributes ---------- marks : list of float
        Start times of the stages after the first one, s after the start of the program.
    sent, took : float
        Time of the signal, s after the start, and time from the signal to the end.
    status : int
        Exit status.
    message : str
        Output on the standard error.
    """

    marks: list[float]
    sent: float
    took: float
    status: int
    message: str

    @property
    def stage(self) -> int:
        """Return the stage in which the signal arrived; lost signals arrived early."""
        return sum(mark <= self.sent for mark in self.marks)

    @property
    def is_single_line(self) -> bool:
        """Whether the program ended like an interrupted program."""
        return self.status == 3 and len(self.message.strip().splitlines()) == 1


def interrupted(arguments: list[str], after: float, number: signal.Signals, folder: str) -> Ending:
    """Start the program, interrupt it after a time in s, and return its end."""
    read, marks = os.pipe()
    text = PROGRAM.replace("MARKS", str(marks)).replace("ARGUMENTS", repr(arguments))
    began = monotonic()
    program = subprocess.Popen(
        [sys.executable, "-c", text], pass_fds=[marks], cwd=folder,
        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    )  # fmt: skip
    os.close(marks)
    sleep(max(0.0, began + after - monotonic()))
    sent = monotonic()
    program.send_signal(number)
    message = program.communicate()[1]
    took = monotonic() - sent
    with os.fdopen(read, "rb") as file:
        times = [float(mark) - began for mark in file.read().split()]
    return Ending(times, sent - began, took, program.returncode, message)


def rows(endings: list[Ending]):
    """Return a row for each stage."""
    uninterrupted = [
        (0.0, *ending.marks) for ending in endings if len(ending.marks) == len(STAGES) - 1
    ]
    for stage, name in enumerate(STAGES):
        inside = [ending for ending in endings if ending.stage == stage]
        begins = [marks[stage] for marks in uninterrupted]
        lasts = [
            marks[stage + 1] - marks[stage] for marks in uninterrupted if stage + 1 < len(STAGES)
        ]
        yield {
            "stage": name,
            "begins": 1e3 * statistics.median(begins),
            "lasts": 1e3 * statistics.median(lasts) if lasts else "",
            "signals": len(inside),
            "one_line": sum(ending.is_single_line for ending in inside),
            "slowest": max((ending.took for ending in inside), default=0.0),
        }


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--signals", type=int, default=200)
    parser.add_argument("--within", type=float, default=60.0, help="ms")
    parser.add_argument("arguments", nargs="*", default=["--version"])
    settings = parser.parse_args()
    rng, endings = random.Random(1), []
    with tempfile.TemporaryDirectory() as folder:
        interrupted(settings.arguments, 10.0, signal.SIGTERM, folder)
        for k in range(settings.signals):
            number = (signal.SIGINT, signal.SIGTERM)[k % 2]
            after = 1e-3 * settings.within * rng.random()
            endings.append(interrupted(settings.arguments, after, number, folder))
    table = list(rows(endings))
    for ending in endings:
        if ending.stage == len(STAGES) - 1 and not ending.is_single_line:
            print(f"{1e3 * ending.sent:.1f} ms: status {ending.status}, {ending.message!r}")
    show(" ".join(settings.arguments), table)
    write("signals", table)


if __name__ == "__main__":
    main()
