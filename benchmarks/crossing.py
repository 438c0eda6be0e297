"""Does a wheel on two rails of a crossing agree with another program?

CONTACT's example two_patches: a wheel S1002 on the nose and the wing rail of a crossing, given by
sections along the track. Its profiles are not part of this package; the argument is the folder
testbank/profiles of its source (github.com/eve70a/CONTACT).

Page: docs/theory/wheel-rail.md
"""

import argparse
import math
import tempfile
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline
from timing import show, write

import tractive_sam as ts
from tractive_sam.contact import Model, equilibrium, share_load
from tractive_sam.rail import Patch, Profile, RailSections, read_profile

ORIGIN = (750.0, 0.0)
"""y and z of the origin of the rail in the track, mm."""

NAMES = ("P", "p_max", "approach", "Qx", "Qy")
PRINTED = {
    0.2: ((4790, 1584, 0.02054, 1313, 557.3), (6171, 634.5, 0.01725, 1611, 152.9)),
    0.05: ((4755, 1573, 0.02047, 1303, 552.1), (6201, 621.4, 0.01734, 1602, 151.9)),
}
"""CONTACT on the nose and the wing rail: P, p_max, approach, |Q_x|, |Q_y|, by the size of elements.

Elements of 0.2 mm: as its example prints. Elements of 0.05 mm: the same version (revision 2707,
gfortran 12.2, DX = DS = 0.05, EPS = 1e-6) at the prescribed height Z_WS = -0.9237838 mm (NORM = 0),
where FZ is 10 kN; with a prescribed load, its iteration ends without contact.
"""

PLANES = ((4.1777, 718.2019, -0.7640), (-2.4600, 782.0806, -0.0500))
"""x and y of the origin (mm) and angle (rad) of the planes of nose and wing rail that it prints."""

PARTS = {
    110.0: (1.260e4, 717.5, 0.02809, 2855),
    118.9: (1.262e4, 721.1, 0.02811, 2861),
    122.0: (1.261e4, 716.5, 0.02807, 2860),
    126.0: (1.260e4, 715.0, 0.02813, 2837),
    130.0: (1.293e4, 1291.0, 0.02791, 2893),
}
"""CONTACT on a rail beside which another one begins at 118.94 mm (its example ``mbench_intrup``).

P, p_max, approach, |Q_x| by the position, mm, as printed, with y = 0.78 mm and elements of 0.2 mm.
"""

NUMBER = 13
"""Sections with both rails: the last ones of the file uk_interrupt_v2.slcs."""


def read_entries(profiles: Path) -> tuple[list[str], list[str]]:
    """Return the lines of all sections in the file: with their profiles, and with their marks."""
    lines = (profiles / "uk_interrupt_v2.slcs").read_text().splitlines()
    entries = [line for line in lines if line.strip() and not line.lstrip().startswith("%")]
    return [line for line in entries if "'" in line], [line for line in entries if "999." in line]


def write_sections(profiles: Path, path: Path) -> None:
    """Write the sections that contain both rails, with absolute paths of their profiles."""
    files, marks = read_entries(profiles)
    head = ["0.0 1000.0", f"{NUMBER}", "11 0 0", "1"]
    path.write_text(
        "\n".join([*head, *files[-NUMBER:], *marks[-NUMBER:]]).replace(
            "uk_crossing", f"{profiles}/uk_crossing"
        )
    )


def spline_through(points: np.ndarray) -> Profile:
    """Return the cubic spline through points (n, 2) over the length of their polygon."""
    length = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))))
    curve = CubicSpline(length, points)
    return Profile.from_nodes(curve(length), curve(length, 1))


def sample_sections(profiles: Path, rail: RailSections, largest: float = 0.5) -> RailSections:
    """Return a rail of sections through points at the distances of CONTACT.

    Between two marks, the points of a section are equidistant. All sections have equal numbers of
    points: where the marks are farthest apart, the points are at most `largest` apart (routines
    varprof_make_vj and varprof_make_2dspline). The section is the cubic spline through
    these points (routine varprof_get_loc_z_at_xy).

    Parameters
    ----------
    profiles : Path
        Folder of the profiles.
    rail : RailSections
        The rail in the track.
    largest : float
        Largest distance of the points, mm.
    """
    files, lines = read_entries(profiles)
    curves = [read_profile(profiles / line.split("'")[1], "section", unit="m") for line in files]
    marks = np.array([line.split()[1:] for line in lines], dtype=float)
    marks = np.minimum(marks, [[curve.s[-1]] for curve in curves])
    longest = np.nanmax(np.diff(np.where(marks < 0.0, np.nan, marks), axis=1), axis=0)
    numbers = 1 + ((longest + 1e-6) / largest).astype(int)
    place = np.concatenate([*(k + np.arange(n) / n for k, n in enumerate(numbers)), [numbers.size]])
    sampled = [
        spline_through(curve.at(np.interp(place, np.arange(along.size), along)))
        for curve, along in zip(curves[-NUMBER:], marks[-NUMBER:], strict=True)
    ]
    nodes = np.stack([section.s for section in sampled])
    return RailSections.from_profiles(rail.x, sampled, nodes, 0.1).moved(0.0, ORIGIN)


def polygon(profile: Profile, y: float, element: float) -> Profile:
    """Return straight lines between points of a profile, one element apart, one of them at y.

    CONTACT takes the wheel from such lines (routines trim_wheel_profile and interp_cartz2unif). The
    curve turns at each point, within 0.00001 mm on either side.
    """
    middle = float(profile.locate(np.array([y]), near=y)[0])
    points = profile.at(np.arange(middle % element, profile.s[-1], element))
    steps = np.diff(points, axis=0)
    along = steps / np.hypot(*steps.T)[:, None]
    ends = np.stack((points[:-1] + 1e-5 * along, points[1:] - 1e-5 * along), axis=1)
    return Profile.from_pieces([(ends.reshape(-1, 2), np.repeat(along, 2, axis=0))])


def sample_patch(
    patch: Patch, rail: RailSections, plane: tuple[float, float, float], element: float
) -> Patch:
    """Return a patch in a plane of CONTACT, with its rail and its wheel sampled as in CONTACT."""
    x, y, angle = plane
    z = float(rail.across(x, y, near=y)[0][1])
    origin = np.array([x, y, z])
    at_wheel = float(patch.wheel.turn[:, 1] @ (origin - patch.wheel.centre)) - patch.wheel.datum
    wheel = replace(patch.wheel, profile=polygon(patch.wheel.profile, at_wheel, element))
    return replace(patch, wheel=wheel, rail=rail, origin=origin, angle=angle)


def crossing_scene(
    sections: Path,
    wheel: Path,
    element: float,
    x: float = 160.0,
    y: float = 3.52,
    load: float = 1e4,
) -> ts.Scene:
    """Return the scene of an example, with elements of this size, mm."""
    steel = {"shear": 82e3, "poisson": 0.28}
    tables = {
        "body": {"A": steel, "B": steel},
        "wheel": {"profile": str(wheel)},
        "rail": {"profile": str(sections), "unit": "m", "inclination": math.inf},
        # VPITCH is -4.3481181 at 2 m/s.
        "wheelset": {"x": x, "y": y, "roll": 0.0, "pitch": 4.3481181 * 0.46 / 2.0 - 1.0},
        "friction": {"mu": 0.3},
        "solver": {"slip": "upwind"},
    }
    tables["rail"]["origin"], tables["wheelset"]["load"] = [*ORIGIN], load
    half = np.max([p.half_length for p in ts.Scene(**tables).wheel_rail.patches], axis=0)
    elements = [2 * round(1.2 * length / element) + 1 for length in half]
    grid = {"half_length": [0.5 * element * n for n in elements], "elements": elements}
    return ts.Scene(**tables, grid=grid)


def solve_as_contact(model: Model, start: ts.State | None) -> ts.State:
    """Return the contact; its approach is the largest overlap at centres of elements."""
    contact = equilibrium(model, start=start, check_resolution=False)
    return replace(contact, approach=contact.approach - float(model.undeformed_gap.min()))


def solve_sampled(scene: ts.Scene, profiles: Path, element: float) -> tuple[ts.State, ...]:
    """Return the contacts in the planes of CONTACT, with profiles sampled as in CONTACT."""
    own = scene.wheel_rail
    rail = sample_sections(profiles, own.patches[0].rail)
    patches = tuple(
        sample_patch(patch, rail, plane, element)
        for patch, plane in zip(own.patches, PLANES, strict=True)
    )
    model = Model(scene, wheel_rail=replace(own, patches=patches))
    return share_load(model, solve_as_contact)


def solve_crossing(profiles: Path) -> list[dict[str, object]]:
    """Return both patches with elements of 0.2 and 0.05 mm, and the values of CONTACT.

    With elements of 0.2 mm, also with the profiles sampled as in CONTACT.
    """
    rows = []
    profiles = profiles.resolve()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "crossing.slcs"
        write_sections(profiles, path)
        for element, sampling in (
            (0.2, "tractive_sam"),
            (0.2, "CONTACT"),
            (0.05, "tractive_sam"),
        ):
            scene = crossing_scene(path, profiles / "MBench_S1002_v3.prw", element)
            patches = scene.wheel_rail.patches
            if sampling == "tractive_sam":
                history = ts.roll(scene)
                angles = history["contact_angle"]
                values = [{name: history[name][k] for name in NAMES} for k in range(len(patches))]
            else:
                contacts = solve_sampled(scene, profiles, element)
                angles = [math.degrees(angle) for _, _, angle in PLANES]
                values = [{name: getattr(contact, name) for name in NAMES} for contact in contacts]
            for angle, computed, printed in zip(angles, values, PRINTED[element], strict=True):
                row: dict[str, object] = {"angle": angle, "element": element, "sampling": sampling}
                for name, known in zip(NAMES, printed, strict=True):
                    row |= {name: abs(float(computed[name])), f"{name} printed": known}
                rows.append(row)
    return rows


def solve_parts(profiles: Path) -> list[dict[str, object]]:
    """Return the contacts at positions before and after another rail begins, and printed values."""
    rows = []
    for x, printed in PARTS.items():
        files = profiles / "uk_interrupt_v2.slcs", profiles / "MBench_S1002_v3.prw"
        scene = crossing_scene(*files, 0.2, x, 0.78, printed[0])
        # The printed force is normal; contact angles are about -0.05.
        scene = scene.replace(**{"wheelset.load": None, "wheelset.normal_load": printed[0]})
        contact = ts.solve(scene)
        row: dict[str, object] = {"x": x}
        for name, known in zip(("P", "p_max", "approach", "Qx"), printed, strict=True):
            row |= {name: abs(float(getattr(contact, name))), f"{name} printed": known}
        rows.append(row)
    return rows


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("profiles", type=Path, help="folder testbank/profiles of CONTACT")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ts.SceneWarning)
        profiles = parser.parse_args().profiles
        parts = solve_parts(profiles)
        rows = solve_crossing(profiles)
    write("wheel_rail_parts", parts)
    write("wheel_rail_crossing", rows)
    show("A rail beside which another one begins", parts)
    show("Nose and wing rail of a crossing", rows)
