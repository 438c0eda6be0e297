"""Tractive rolling contact of elastic bodies: forces, stick and slip, and wear.

Steady rolling of two half-spaces with longitudinal, lateral and spin creepage, orthotropic friction
and wear, by FFT-accelerated semi-analytical methods; after Juliá & Rodríguez-Tembleque, Int. J.
Mech. Sci. 294 (2025) 110195.

    >>> import tractive_sam as ts
    >>> scene = ts.Scene.builtin("spheres")
    >>> contact = ts.solve(scene)
    >>> round(contact.Qx / contact.P, 3)
    0.259
    >>> discs = ts.Scene.builtin("twin-discs").with_set(["wear.revolutions=2", "wear.save=[0, 2]"])
    >>> history = ts.roll(discs)
    >>> history.status
    'done'

Every public name has an example, which goes on from here; those of `plot`, `subsurface` and
`reference` also know the names of their package.

Conventions, stated here once
-----------------------------
**Units** mm, N, MPa, revolutions; angles in degrees in a scene, radians inside; spin in 1/mm. Where
both bodies have ``radius_y = inf`` they touch along a line, in plane strain: forces are then per
length, N/mm, moments N, and arrays have the shape (n_x, 1).

**Axes** x is the rolling direction, y lateral, z normal to the contact plane and into body A, the
upper one. Material crosses the contact from +x, the leading edge, to -x. Arrays have the shape
(n_x, n_y) of the grid, vectors (2, n_x, n_y).

**Signs** Pressure is positive. The traction (p_x, p_y) acts on body A; body B carries its
opposite. Displacement u = u_A - u_B; slip is that of A over B per unit rolling speed,
s_x/V = xi_x - phi y - du_x/dx and s_y/V = xi_y + phi x - du_y/dx. A negative longitudinal creepage
drives body A: Q_x > 0 (for dissimilar bodies: one below the creepage of free rolling).

**Friction** The tribological axes (e1, e2) are turned by the angle beta counter-clockwise from x.

**Threads** Transforms of meshes from about 400 x 400 elements on take up to four cores, others
one; the environment variable OMP_NUM_THREADS bounds them.

**Names** ``displacement_xz`` is u_x from p_z, and so for every influence coefficient. A trailing
``~`` in formulas marks the scaled tribological frame of `tractive_sam.operators.Frame`.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tractive_sam.contact import Contact, NotConverged
    from tractive_sam.export import export_volume
    from tractive_sam.pipeline import roll, solve
    from tractive_sam.record import History
    from tractive_sam.scene import (
        Accuracy,
        Bodies,
        Body,
        Creepage,
        Friction,
        Gap,
        Load,
        Mesh,
        Scene,
        SceneError,
        SceneWarning,
        Solver,
        Subsurface,
        Wear,
        builtin_names,
    )
    from tractive_sam.store import GapError, ResultsError, open_history
    from tractive_sam.studies import (
        Study,
        StudyError,
        StudyResults,
        explain_study,
        open_study,
        study,
    )
    from tractive_sam.subsurface import (
        PlaneStress,
        VonMisesMaximum,
        stress_at,
        stress_on_plane,
        stress_on_planes,
        stress_volume,
        von_mises_maximum,
    )

__all__ = [
    "Accuracy",
    "Bodies",
    "Body",
    "Contact",
    "Creepage",
    "Friction",
    "Gap",
    "GapError",
    "History",
    "Load",
    "Mesh",
    "NotConverged",
    "PlaneStress",
    "ResultsError",
    "Scene",
    "SceneError",
    "SceneWarning",
    "Solver",
    "Study",
    "StudyError",
    "StudyResults",
    "Subsurface",
    "VonMisesMaximum",
    "Wear",
    "builtin_names",
    "explain_study",
    "export_volume",
    "open_history",
    "open_study",
    "roll",
    "solve",
    "stress_at",
    "stress_on_plane",
    "stress_on_planes",
    "stress_volume",
    "study",
    "von_mises_maximum",
]

_ROOMS = ("scene", "store", "record", "contact", "subsurface", "pipeline", "export", "studies")


def __getattr__(name: str):
    # Names are looked up when first used: reading results or printing help need not wait for the
    # compilers and transforms that computing needs.
    if name == "__version__":
        return import_module("importlib.metadata").version("tractive-sam")
    if name in __all__:
        for room in _ROOMS:
            module = import_module(f"{__name__}.{room}")
            if hasattr(module, name):
                return getattr(module, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__"])
