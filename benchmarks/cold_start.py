"""Cost of the first run of a command: CPU seconds with and without compiled kernels.

Each command runs twice, first with an empty cache of kernels and then with the cache that the first
run created. Seconds are user and system time of the process. The bytecode of the modules exists, as
after an installation.

Page: docs/changelog.md
"""

import json
import os
import subprocess
import sys
import tempfile
from importlib.resources import files
from pathlib import Path

from timing import show, write

COMMANDS = {
    "version": ["--version"],
    "explain spheres": ["explain", "spheres"],
    "run spheres": ["run", "spheres"],
    "run spheres, contact only": ["run", "contact.toml"],
    "run twin-discs": ["run", "twin-discs"],
}

MEASURED = """
import json, resource, runpy, sys
from time import process_time

from numba.core import event

class Listener(event.Listener):
    def __init__(self):
        self.open, self.rows = [], []

    def on_start(self, event):
        self.open.append([process_time(), 0.0])

    def on_end(self, event):
        began, inner = self.open.pop()
        took = process_time() - began
        if self.open:
            self.open[-1][1] += took
        function = event.data["dispatcher"].py_func
        self.rows.append((f"{function.__module__}.{function.__qualname__}", took - inner))

path, sys.argv = sys.argv[1], ["tractive_sam", *sys.argv[2:]]
listener = Listener()
try:
    with event.install_listener("numba:compile", listener):
        runpy.run_module("tractive_sam", run_name="__main__")
finally:
    usage = resource.getrusage(resource.RUSAGE_SELF)
    with open(path, "w") as file:
        json.dump((usage.ru_utime + usage.ru_stime, listener.rows), file)
"""


def write_contact(folder: str) -> None:
    """Write the scene `spheres` without subsurface stress."""
    scene = files("tractive_sam.scene") / "builtin" / "spheres.toml"
    text = scene.read_text("utf-8").partition("[subsurface]")[0]
    (Path(folder) / "contact.toml").write_text(text, "utf-8")


def measured(arguments: list[str], cache: str, folder: str, byte_code: str) -> tuple[float, list]:
    """Return the CPU seconds of a command, and name and seconds of each compiled kernel."""
    path = Path(folder) / "measured.json"
    environment = {**os.environ, "NUMBA_CACHE_DIR": cache, "PYTHONPYCACHEPREFIX": byte_code}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    command = [sys.executable, "-c", MEASURED, str(path), *arguments]
    subprocess.run(command, env=environment, cwd=folder, capture_output=True, check=True)
    return tuple(json.loads(path.read_text()))


def main():
    with tempfile.TemporaryDirectory() as byte_code, tempfile.TemporaryDirectory() as first:
        write_contact(first)
        measured(COMMANDS["run spheres"], first, first, byte_code)  # writes the byte code
        measure_all(byte_code)


def measure_all(byte_code: str) -> None:
    """Measure every command, and print and write the results."""
    rows, kernels = [], {}
    for name, arguments in COMMANDS.items():
        with tempfile.TemporaryDirectory() as cache:
            seconds = []
            for _ in ("cold", "warm"):
                with tempfile.TemporaryDirectory() as folder:
                    write_contact(folder)
                    took, compiled = measured(arguments, cache, folder, byte_code)
                seconds.append(took)
                for kernel, times in compiled:
                    kernels.setdefault(name, {}).setdefault(kernel, []).append(times)
        count = sum(map(len, kernels.get(name, {}).values()))
        rows.append({"command": name, "cold": seconds[0], "warm": seconds[1], "compiled": count})
    show("CPU seconds of commands, without and with compiled kernels", rows)
    print(f"written: {write('cold_start', rows)}")
    for name, by_kernel in kernels.items():
        by_cost = sorted(by_kernel.items(), key=lambda item: -sum(item[1]))
        each = [
            {"kernel": kernel, "specialisations": len(times), "seconds": sum(times)}
            for kernel, times in by_cost[:15]
        ]
        show(
            f"{name}: kernels with the longest compilation, without the kernels that they call",
            each,
        )


if __name__ == "__main__":
    main()
