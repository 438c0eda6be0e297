"""Wear of twin discs against the global incremental wear model (Fig. 15, Table 1)."""

from collections.abc import Iterator

import numpy as np

from tractive_sam import plot
from tractive_sam.paper.page import (
    Finding,
    FindingTable,
    Picture,
    Statement,
    Verdict,
    Work,
    format_deviation,
)
from tractive_sam.paper.scenes import flat_discs, hertz_of
from tractive_sam.reference import GlobalWear, giwm
from tractive_sam.results import History, Record
from tractive_sam.run import roll
from tractive_sam.scene import Scene
from tractive_sam.schema import required


def roll_into_file(work: Work, scene: Scene, name: str) -> History:
    """Roll a scene, store the results in the file `name`.h5 (overwritten), and return the history.

    Raises
    ------
    RuntimeError
        If a contact was not solved.
    """

    def report(record: Record) -> None:
        work.report(f"{name}, revolution {record.revolution} of {work.size.revolutions}")

    path = work.results / f"{name}.h5"
    history = roll(scene, path, overwrite=True, progress=report)
    if not history.finished:
        raise RuntimeError(f"{path}: {history.status}; {history.message}")
    return history


def read_saved(history: History, name: str) -> np.ndarray:
    """Return a column of a history at the revolutions with stored fields."""
    return history[name][np.isin(history["revolution"], history.field_revolutions)]


def wear_depth_findings(work: Work, good: float = 0.1) -> Iterator[Finding]:
    """Yield statement, figure and table on wear depth against GIWM (Fig. 15, Table 1).

    Depths within a relative distance of `good` agree well.
    """
    scene = flat_discs(work.size)
    history = roll_into_file(work, scene, "twin-discs-isotropic")
    course = _giwm(scene, work.size.revolutions)
    saved = [N for N in history.field_revolutions.tolist() if N]
    depth = read_saved(history, "wear_max")[1:]
    both = depth / course.depth[saved] - 1
    single = 0.5 * depth / course.depth[saved] - 1
    first, last = saved[0], saved[-1]
    yield Statement(
        "Fig. 15",
        "The wear depth agrees well with the global incremental wear model (GIWM).",
        f"Of both discs together {1e3 * depth[-1]:.2f} µm at N = {last}, GIWM "
        f"{1e3 * course.depth[last]:.2f} µm ({both[-1]:+.0%}; {both[0]:+.0%} at N = {first}). "
        f"Of a single disc, half of it: {single[0]:+.0%} at N = {first}, {single[-1]:+.0%} at N = "
        f"{last}. GIWM has a mean pressure, full slip, and a half width in x that falls "
        f"to {course.a[1] / course.a[0]:.0%} in the first revolution.",
        Verdict.from_conditions(bool(np.all(abs(both) < good)), bool(np.all(abs(single) < good))),
        f"if within {good:.0%} at every stored N",
    )
    yield _table(history, course, saved)
    N = np.arange(course.depth.size)
    yield Picture(
        "fig-15",
        plot.compare({"computed": history}, "wear_max", {"GIWM": (N, course.depth)}),
        "Fig. 15. Largest wear depth of both discs together.",
    )
    yield Picture(
        "fig-15-half-width",
        plot.compare({"computed": history}, "half_width_y", {"GIWM": (N, course.b)}),
        "Table 1. Half width across the rolling direction, computed and by GIWM.",
    )


def _giwm(scene: Scene, revolutions: int) -> GlobalWear:
    """Return the wear of a scene of the paper by the global incremental wear model (GIWM)."""
    A, B, hertz = scene.body.A, scene.body.B, hertz_of(scene)
    return giwm(
        load=required(scene.normal_load, "load.normal"),
        e_star=scene.material.E_star,
        radii_x=(A.radius_x, B.radius_x),
        radius_y=A.radius_y,  # B is a cylinder
        semi_axes=(hertz.a, hertz.b),
        creepage=scene.creepage.longitudinal,
        intensity=required(scene.wear, "wear").intensities[0],
        revolutions=revolutions,
    )


def _table(history: History, course: GlobalWear, saved: list[int]) -> FindingTable:
    """Return a table of wear depths and half widths, computed and by GIWM."""
    depth, b = (read_saved(history, name)[1:] for name in ("wear_max", "half_width_y"))
    rows = [
        (
            f"{N:,}",
            f"{1e3 * depth[k]:.4g}",
            f"{1e3 * course.depth[N]:.4g}",
            format_deviation(depth[k], course.depth[N]),
            f"{b[k]:.3f}",
            f"{course.b[N]:.3f}",
        )
        for k, N in enumerate(saved)
    ]
    return FindingTable(
        "Wear depth of both discs and half width b of the contact, computed and by GIWM (Table 1).",
        ("N", "depth, µm", "GIWM, µm", "difference", "b, mm", "GIWM, mm"),
        rows,
    )
