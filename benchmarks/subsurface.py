"""Stress below the surface: time and memory of volumes and planes, relative to bare FFTs.

Bare FFTs are only the required transforms, executed on the arrays of the package: per layer, four
packed tables forward and six stresses back; per depth of a plane, eight packed rows for each edge.
The usual method transforms 18 tables forward instead of four; `over 18 + 6` is relative to this
method. Ratios are based on medians over layers or depths, so that other work on the machine affects
both sides equally. The volume of 512 x 512 x 64 runs in a separate process, and its memory is the
peak resident memory of this process.

Page: docs/benchmarks.md
"""

import os
import resource
import subprocess
import sys
import tracemalloc
from collections.abc import Callable
from dataclasses import replace
from statistics import median
from time import perf_counter

import numpy as np
import pyfftw
from timing import seconds, show, write

from tractive_sam.compute.fft import edge_transform, layer_transform, padded_length
from tractive_sam.contact import Model, equilibrium
from tractive_sam.operators import Lattice, StressLayers, StressPlane
from tractive_sam.results.grid import Grid
from tractive_sam.results.state import State
from tractive_sam.scene import Scene
from tractive_sam.subsurface import stress_maximum, stress_on_plane, stress_volume
from tractive_sam.subsurface.stress_fields import LoadedBodies

DEPTHS = 64
LARGE = 512
# The Fortran program CONTACT: 151 depths of the plane y = 0 on 91 x 91 elements, on an equal core.
CONTACT_SECONDS = 2.0


def spheres(n: int) -> State:
    return equilibrium(Model(Scene.builtin("spheres").with_set([f"grid.elements=[{n}, {n}]"])))


def depths(contact: State, count: int) -> np.ndarray:
    return np.linspace(0.0, 1.5 * contact.scene.hertz.a, count)


def stream(contact: State, count: int, threads: int = 1) -> list[float]:
    """Compute every layer of a volume without storing it, and return the seconds of each layer."""
    stamps = [perf_counter()]
    for _ in stress_volume(contact, depths(contact, count), threads=threads):
        stamps.append(perf_counter())  # noqa: PERF401 - the time between two layers
    return np.diff(stamps).tolist()


def peak(run: Callable[[], object]) -> int:
    """Return the largest memory that Python and numpy use at once during a call, bytes."""
    tracemalloc.start()
    run()
    _, peak_bytes = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return peak_bytes


def volume(contact: State) -> dict:
    n = contact.grid.elements[0]
    load = LoadedBodies.from_contact(contact, "A")
    lattice = Lattice(contact.grid.elements, contact.grid.dx, contact.grid.dy)
    poisson = contact.scene.materials["A"].poisson
    layers = StressLayers(lattice, load.tractions, (poisson,), (1.0,))
    transform = layer_transform(lattice.shape, layers._padded)
    arrays = (transform.tables, transform.packs, transform.spectra, layers._loads)
    array_bytes = sum(array.nbytes for array in arrays) + 6 * n * layers._padded[1] * 8
    stream(contact, 1)
    took = seconds(lambda: stream(contact, DEPTHS))
    layer = median(stream(contact, DEPTHS))
    bare = seconds(lambda: (transform.forward(), transform.backward()), 0.5, DEPTHS)
    layer_transform.cache_clear()  # so that its arrays are seen to be taken
    peak_bytes = peak(lambda: stream(contact, DEPTHS))
    return {
        "what": f"volume {n} x {n} x {DEPTHS}",
        "seconds": took,
        "over its FFTs": layer / bare,
        "over 18 + 6": layer / textbook(n),
        "MiB": peak_bytes / 2**20,
        "over its arrays": peak_bytes / array_bytes,
    }


def textbook(n: int) -> float:
    """Return the seconds of 18 tables forward and six stresses back, on the doubled mesh."""
    p = padded_length(n)
    real = pyfftw.zeros_aligned((6, p, p))
    spectrum = pyfftw.zeros_aligned((6, p, p // 2 + 1), dtype=complex)
    forward = pyfftw.FFTW(real, spectrum, axes=(1, 2))
    backward = pyfftw.FFTW(spectrum, real, axes=(1, 2), direction="FFTW_BACKWARD")

    def run():
        for _ in range(3):
            forward.execute()
        backward.execute()

    return seconds(run, 0.5, DEPTHS)


def plane(contact: State, text: str, count: int) -> dict:
    n = contact.grid.elements[0]
    z = depths(contact, count)
    load = LoadedBodies.from_contact(contact, "A")
    position = 0.0 if text == "y=0" else 0.75 * contact.scene.hertz.a
    poisson = contact.scene.materials["A"].poisson
    operator = StressPlane(contact.grid, "y", position, load.tractions, (poisson,), (1.0,))
    blocks, edges = operator._distances.shape
    transform = edge_transform(edges, operator._padded)
    spectra = np.zeros((6, operator._padded // 2 + 1), dtype=complex)

    def run():
        for _ in range(blocks):
            transform.forward()
        np.fft.irfft(spectra, operator._padded)

    bare = seconds(run, 0.5, 200)
    depth = seconds(lambda: operator.at(z[count // 2]), 0.5, count)
    took = seconds(lambda: stress_on_plane(contact, text, depths=z))
    array_bytes = transform.tables.nbytes + transform.packs.nbytes + operator._loads.nbytes
    array_bytes += 6 * n * count * 8  # the result
    edge_transform.cache_clear()
    peak_bytes = peak(lambda: stress_on_plane(contact, text, depths=z))
    return {
        "what": f"plane {text}, {n} x {n}, {count} depths",
        "seconds": took,
        "over its FFTs": depth / bare,
        "over 18 + 6": "",
        "MiB": peak_bytes / 2**20,
        "over its arrays": peak_bytes / array_bytes,
    }


def large(threads: int) -> None:
    """Measure sliding spheres under Hertz pressure on a large mesh, in a separate process."""
    small = spheres(31)
    grid = Grid(small.grid.half_length, (LARGE, LARGE))
    pressure = small.scene.hertz.pressure(grid.x[:, None], grid.y)
    mu = small.scene.friction.mu[0]
    contact = replace(
        small, grid=grid, pressure=pressure, traction=np.stack((mu * pressure, 0.0 * pressure))
    )
    stream(contact, 1, threads)
    print(
        sum(stream(contact, DEPTHS, threads)),
        resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
    )


def large_rows() -> list[dict]:
    rows = []
    for threads in (1, 2):
        command = [sys.executable, __file__, "large", str(threads)]
        # FFTW takes its threads from OpenMP, which `timing` has set to one.
        environment = os.environ | {"OMP_NUM_THREADS": str(threads)}
        done = subprocess.run(command, check=True, capture_output=True, text=True, env=environment)
        took, resident = map(float, done.stdout.split())
        rows.append(
            {
                "what": f"volume {LARGE} x {LARGE} x {DEPTHS}, threads: {threads}, full process",
                "seconds": took,
                "MiB": resident,
            }
        )
    return rows


def main():
    mesh128, mesh91 = spheres(128), spheres(91)
    rows = [
        volume(mesh128),
        plane(mesh128, "y=0", DEPTHS),
        plane(mesh91, "y=0", 151),
        plane(mesh91, "y=0.75a", 151),
    ]
    rows[2]["CONTACT/this"] = CONTACT_SECONDS / rows[2]["seconds"]
    rows += large_rows()
    rows.append(
        {
            "what": "largest von Mises stress, 91 x 91",
            "seconds": seconds(lambda: stress_maximum(mesh91)),
        }
    )
    columns = [*rows[0], "CONTACT/this"]
    rows = [{column: row.get(column, "") for column in columns} for row in rows]
    show("Stress below the surface of `spheres`, one body", rows)
    print(f"written: {write('subsurface', rows)}")


if __name__ == "__main__":
    if sys.argv[1:2] == ["large"]:
        large(int(sys.argv[2]))
    else:
        main()
