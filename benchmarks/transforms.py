"""Compare the time of a contact with transforms of FFTW and of SciPy, which replace FFTW if needed.

Both run alternately, each in a separate process without compilation. Times are CPU times of the
processes.

Page: docs/citing.md
"""

import json
import statistics
import subprocess
import sys

from timing import show, write

PROGRAM = """
import json, sys, time
if {scipy}:
    sys.modules["pyfftw"] = None
import tractive_sam as ts
scene = ts.Scene.builtin("spheres").with_set(["grid.elements=[{n}, {n}]"])
contact = ts.solve(scene)
began = time.process_time()
for _ in range(3):
    ts.solve(scene)
print(json.dumps([(time.process_time() - began) / 3, contact.Qx]))
"""


def measure(n: int, scipy: bool) -> tuple[float, float]:
    """Return the seconds of a solution and its force."""
    program = PROGRAM.format(n=n, scipy=scipy)
    output = subprocess.run([sys.executable, "-c", program], capture_output=True, check=True)
    seconds, force = json.loads(output.stdout)
    return seconds, force


def main() -> None:
    rows = []
    for n in (41, 91, 181, 361):
        pairs = [(measure(n, False), measure(n, True)) for _ in range(3)]
        ratio = statistics.median(scipy[0] / fftw[0] for fftw, scipy in pairs)
        (fftw, force), (scipy, scipy_force) = pairs[0]
        rows.append(
            {
                "elements": n,
                "fftw_seconds": round(fftw, 4),
                "scipy_seconds": round(scipy, 4),
                "ratio": round(ratio, 2),
                "difference_of_force": abs(scipy_force / force - 1.0),
            }
        )
    show("Solution of a contact of spheres, CPU time", rows)
    write("transforms", rows)


if __name__ == "__main__":
    main()
