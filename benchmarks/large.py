"""Large meshes: time and memory of a steady solution of `spheres`, from 128² to 4096² elements.

Each mesh is solved twice in a separate process. The script reports the peak memory of the process;
the second solution requires no planning and compilation. The residual is 1e-6, far below the error
of the mesh. All cores are used (the environment variable OMP_NUM_THREADS limits them).

`--threads` repeats the solution with these numbers of threads instead, and measures one application
of the tangential operator beside it; times are wall times, the least of three.

    python benchmarks/large.py [--meshes 128 256 512 1024 2048 4096] [--threads 1 2 4]

Page: docs/benchmarks.md
"""

import argparse
import json
import os
import subprocess
import sys
from time import perf_counter, process_time

MESHES = (128, 256, 512, 1024, 2048, 4096)
MESH_VARIABLE, THREADS_VARIABLE = "_TRACTIVE_SAM_MESH", "_TRACTIVE_SAM_THREADS"


def measure_mesh(n: int) -> dict:
    """Solve one mesh in this process."""
    import resource  # noqa: PLC0415 - not on every machine

    import tractive_sam as ts  # noqa: PLC0415
    from tractive_sam.contact import Model  # noqa: PLC0415
    from tractive_sam.run import memory  # noqa: PLC0415

    scene = ts.Scene.builtin("spheres").with_set(
        [f"grid.elements=[{n}, {n}]", "solver.tolerance=1e-6"]
    )
    contact, times = None, []
    for _ in range(2):
        contact = None  # with it go the operators of the first solution
        began, spent = perf_counter(), process_time()
        contact = ts.solve(scene)
        times.append((perf_counter() - began, process_time() - spent))
    (first, _), (again, cpu) = times
    return {
        "n": n,
        "applications": round(contact.cost.applications, 1),
        "preconditioner": round(contact.cost.preconditioner, 1),
        "first s": first,
        "again s": again,
        "CPU s": cpu,
        "us an element": 1e6 * again / n**2,
        "GiB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20,
        "GiB estimated": memory.contact_bytes(Model(scene)) / 2**30,
        "Qx/muP": contact.Qx / (scene.friction.mu[0] * contact.P),
    }


def measure_threads(n: int) -> dict:
    """Measure a solution and an application with as many threads as OMP_NUM_THREADS allows."""
    import numpy as np  # noqa: PLC0415 - not before the number of threads is set

    import tractive_sam as ts  # noqa: PLC0415
    from tractive_sam.contact import Model  # noqa: PLC0415

    scene = ts.Scene.builtin("spheres").with_set(
        [f"grid.elements=[{n}, {n}]", "solver.tolerance=1e-6"]
    )
    operator, fields = Model(scene).operators.tangential, np.ones((2, n, n))

    def least(run) -> float:
        times = []
        for _ in range(4):
            began = perf_counter()
            run()
            times.append(perf_counter() - began)
        return min(times[1:])  # the first run plans

    return {
        "n": n,
        "threads": int(os.environ["OMP_NUM_THREADS"]),
        "application s": least(lambda: operator(fields)),
        "solution s": least(lambda: ts.solve(scene)),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--meshes", type=int, nargs="+", default=MESHES)
    parser.add_argument("--threads", type=int, nargs="+", default=[])
    environment, rows, wanted = dict(os.environ), [], parser.parse_args()
    from timing import show, write  # noqa: PLC0415 - holds this process to one thread

    for n in wanted.meshes:
        for threads in wanted.threads or [0]:
            mesh = environment | {MESH_VARIABLE: str(n)}
            mesh |= {THREADS_VARIABLE: "1", "OMP_NUM_THREADS": str(threads)} if threads else {}
            ran = subprocess.run(
                [sys.executable, __file__], env=mesh, stdout=subprocess.PIPE, check=True
            )
            rows.append(json.loads(ran.stdout))
    show(f"`spheres`, to 1e-6, on {len(os.sched_getaffinity(0))} cores", rows)
    print(f"written: {write('large_threads' if wanted.threads else 'large', rows)}")


if __name__ == "__main__":
    if MESH_VARIABLE in os.environ:
        measure = measure_threads if THREADS_VARIABLE in os.environ else measure_mesh
        print(json.dumps(measure(int(os.environ[MESH_VARIABLE]))))
    else:
        main()
