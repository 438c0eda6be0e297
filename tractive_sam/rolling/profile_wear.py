"""Wear of the profiles of wheel and rail over the positions of a duty.

The depths worn off both profiles, along their normals and over their arc lengths, follow

    dE/dN = sum over positions of w_j D_j R_j(I_j E)

with the share w_j of a position in the revolutions, the depth R_j that its patches wear in a pass,
the depths I_j E of both bodies together at the rows of a patch, and D_j, which brings a depth at
rows to nodes of the profiles. Short waves of a profile decay fast (`rolling.response`); the steps
are linearly implicit in the response J_j of R_j, so that they are not limited by stability:

    (1 - dN sum w_j D_j J_j I_j) dE = dN sum w_j D_j R_j.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from tractive_sam.contact import Model, solve_patches_on_fitted_mesh, wear_law_at
from tractive_sam.rail import Profile, write_profile
from tractive_sam.results import NotConverged, State
from tractive_sam.rolling.response import wear_response
from tractive_sam.scene import Scene, WheelRail
from tractive_sam.schema import Fault, SceneError


@dataclass(frozen=True, eq=False)
class WornProfiles:
    """Profiles of a wheel and a rail that wear.

    Attributes
    ----------
    scene : Scene
        What was rolled.
    revolutions : ndarray, shape (n,)
        Revolutions of the wheel after each step, the first one 0.
    wheel_depth, rail_depth : ndarray, shape (n, m)
        Depth worn off along the normals at the nodes of the profiles, mm.
    contact_y : tuple of tuple of float
        For each step the lateral positions of all patches on the rail, mm.
    solves : int
        Contacts that were solved.

    Examples
    --------
    >>> scene = ts.Scene.builtin("wheel-wear").with_set(["wear.revolutions=1000"])
    >>> worn = ts.wear_profiles(scene, deepest=0.1)
    >>> bool(worn.wheel_depth[-1].max() > 0.0)
    True
    """

    scene: Scene
    revolutions: np.ndarray
    wheel_depth: np.ndarray
    rail_depth: np.ndarray
    contact_y: tuple[tuple[float, ...], ...]
    solves: int

    def wheel(self, step: int = -1) -> Profile:
        """Return the wheel profile after a step."""
        return self.scene.wheel.curve.worn(self.wheel_depth[step], 1.0)

    def rail(self, step: int = -1) -> Profile:
        """Return the rail profile after a step, in its own frame."""
        return self.scene.rail.own_curve.worn(self.rail_depth[step], -1.0)

    @property
    def worn_areas(self) -> dict[str, np.ndarray]:
        """Cross section worn off "wheel" and "rail" after each step, shape (n,), mm2."""
        nodes = {"wheel": self.scene.wheel.curve.s, "rail": self.scene.rail.own_curve.s}
        depths = {"wheel": self.wheel_depth, "rail": self.rail_depth}
        return {name: np.trapezoid(depths[name], nodes[name], axis=1) for name in nodes}

    def write(self, folder: str | PathLike[str]) -> list[Path]:
        """Write worn profiles (.prw, .prr) and the depths of all steps (.csv) into a folder.

        Returns
        -------
        list of Path
            The files.
        """
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        last = f"{self.revolutions[-1]:g}"
        files = [folder / f"wheel-{last}.prw", folder / f"rail-{last}.prr", folder / "wear.csv"]
        title = f"{self.scene.title}, worn for {last} revolutions"
        write_profile(self.wheel(), files[0], "wheel", title)
        write_profile(self.rail(), files[1], "rail", title)
        areas = self.worn_areas
        table = np.column_stack(
            (
                *(self.revolutions, areas["wheel"], areas["rail"]),
                *(self.wheel_depth.max(axis=1), self.rail_depth.max(axis=1)),
            )
        )
        names = "revolution,wheel_area,rail_area,wheel_depth,rail_depth"
        np.savetxt(files[2], table, delimiter=",", header=names, comments="")
        return files


@dataclass(frozen=True, eq=False)
class _PatchWear:
    """What a patch wears in a pass.

    Attributes
    ----------
    rates : ndarray, shape (2, n_y)
        Depth of wheel and rail at each row, mm.
    response : ndarray, shape (n_y, n_y)
        Derivative of the depth of both with respect to the profile.
    places : tuple of ndarray, shape (n_y,)
        Arc lengths of the new wheel and of the new rail at the rows, mm.
    """

    rates: np.ndarray
    response: np.ndarray
    places: tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True, eq=False)
class ProfileWear:
    """Wear of both profiles of a scene over its positions.

    Attributes
    ----------
    scene : Scene
        Scene with [wheel], [rail], [wheelset] and [wear]; each block of [[duty]] is a position.
    rail_passes : float
        Wheels that pass over a cross section of the rail per revolution of the wheel.
    load_tolerance : float
        Relative error of the load that the patches of a wheel carry together.
    """

    scene: Scene
    rail_passes: float = 1.0
    load_tolerance: float = 1e-4

    @property
    def positions(self) -> list[tuple[float, Scene]]:
        """Share in the revolutions, and scene, of each different position."""
        spectrum = self.scene.spectrum
        if spectrum is None:
            return [(1.0, self.scene)]
        shares = [number / spectrum.cycle for number in spectrum.revolutions]
        return [*zip(shares, spectrum.scenes, strict=True)]

    def steps(self, deepest: float) -> Iterator[WornProfiles]:
        """Yield the profiles after each step.

        Parameters
        ----------
        deepest : float
            Largest depth of wear of a step, mm.
        """
        nodes = self.scene.wheel.curve.s, self.scene.rail.own_curve.s
        depths, revolution, solves = [np.zeros(s.size) for s in nodes], 0.0, 0
        courses: list[tuple[float, np.ndarray, np.ndarray, tuple[float, ...]]] = []
        starts: dict[int, State] = {}
        while True:
            worn, places = self._wear_of_positions(depths, starts)
            solves += len(worn)
            courses.append((revolution, depths[0], depths[1], places))
            turns, wheel, rail, contact_y = zip(*courses, strict=True)
            fields = np.array(turns), np.array(wheel), np.array(rail), contact_y, solves
            yield WornProfiles(self.scene, *fields)
            left = [stop for stop in self.scene.schedule.stops if stop > revolution]
            if not left:
                return
            change, length = _implicit_step(worn, nodes, left[0] - revolution, deepest)
            revolution += length
            depths = [depth + more for depth, more in zip(depths, change, strict=True)]

    def _wear_of_positions(
        self, depths: list[np.ndarray], starts: dict[int, State]
    ) -> tuple[list[tuple[float, _PatchWear]], tuple[float, ...]]:
        """Return the wear of all patches of all positions, with its share in the revolutions."""
        wheel = self.scene.wheel.curve.worn(depths[0], 1.0)
        rail = self.scene.rail.curve.worn(depths[1], -1.0)
        worn, places = list[tuple[float, _PatchWear]](), list[float]()
        for k, (share, scene) in enumerate(self.positions):
            model = Model(scene, wheel_rail=WheelRail.of_profiles(scene, wheel, rail))
            model, contacts = solve_patches_on_fitted_mesh(
                model, starts.get(k), self.load_tolerance
            )
            starts[k] = contacts[0]
            for contact, patch in zip(contacts, model.wheel_rail.patches, strict=True):
                if not contact.converged:
                    raise NotConverged(contact)
                if contact.touching.any():
                    places.append(float(patch.origin[1]))
                    worn.append((share, self._wear_of_patch(model.of_patch(patch), contact, wheel)))
        return worn, tuple(places)

    def _wear_of_patch(self, model: Model, contact: State, wheel: Profile) -> _PatchWear:
        """Return the wear of a patch."""
        law, patch, y = wear_law_at(model, contact), model.patch, contact.grid.y
        rates = law.rates(
            model.scene.wear_share, contact.pressure, contact.traction, contact.slip
        ).sum(axis=1)
        new = self.scene.wheel.curve.s, self.scene.rail.curve.s
        rail = patch.rail
        places = (
            np.interp(patch.wheel_profile(y)[1], wheel.s, new[0]),
            np.interp(patch.rail_profile(y)[1], rail.s, new[1]),
        )
        lasting = np.array([[1.0], [self.rail_passes]]) * contact.grid.dx
        return _PatchWear(rates * lasting, wear_response(model, contact), places)


def _implicit_step(
    worn: list[tuple[float, _PatchWear]],
    nodes: tuple[np.ndarray, np.ndarray],
    most: float,
    deepest: float,
) -> tuple[list[np.ndarray], float]:
    """Return the change of the depths in a linearly implicit step, and its revolutions."""
    size = nodes[0].size
    totals = [patch.rates.sum(axis=0) for _, patch in worn]
    onto = [
        _onto_nodes(patch, nodes, total) for (_, patch), total in zip(worn, totals, strict=True)
    ]
    rate = sum(
        share * matrix @ total for (share, _), matrix, total in zip(worn, onto, totals, strict=True)
    )
    length = min(most, deepest / max(float(rate.max()), 1e-300))
    active = np.flatnonzero(rate > 0.0)
    system = np.eye(active.size)
    for (share, patch), matrix in zip(worn, onto, strict=True):
        pairs = zip(patch.places, nodes, strict=True)
        at_rows = np.concatenate([_interpolation(s, at) for at, s in pairs], axis=1)[:, active]
        system -= length * share * matrix[active] @ patch.response @ at_rows
    change = np.zeros(rate.size)
    change[active] = length * np.linalg.solve(system, rate[active])
    return np.split(np.maximum(change, 0.0), [size]), length


def _onto_nodes(
    patch: _PatchWear, nodes: tuple[np.ndarray, np.ndarray], total: np.ndarray
) -> np.ndarray:
    """Return the matrix from depths of both bodies at rows to depths at the nodes of both."""
    parts = patch.rates / np.where(total > 0.0, total, 1.0)
    triples = zip(patch.places, nodes, parts, strict=True)
    return np.concatenate([_interpolation(at, s) * part for at, s, part in triples])


def _interpolation(known: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return the matrix of linear interpolation, shape (len(at), len(known)); zero beyond it."""
    k = np.clip(np.searchsorted(known, at) - 1, 0, known.size - 2)
    share = (at - known[k]) / (known[k + 1] - known[k])
    matrix, rows = np.zeros((at.size, known.size)), np.arange(at.size)
    inside = (share >= 0.0) & (share <= 1.0)
    matrix[rows, k], matrix[rows, k + 1] = inside * (1.0 - share), inside * share
    return matrix


def wear_profiles(
    scene: Scene,
    *,
    deepest: float = 0.01,
    rail_passes: float = 1.0,
    progress: Callable[[WornProfiles], Any] | None = None,
) -> WornProfiles:
    """Wear the profiles of a wheel and a rail over the positions of a duty.

    Material is removed along the normals of both profiles, without any smoothing. Each block of
    [[duty]] is a position of the wheelset with its share in the revolutions.

    Parameters
    ----------
    scene : Scene
        Scene with [wheel], [rail], [wheelset] and [wear].
    deepest : float
        Largest depth of wear of a step, mm.
    rail_passes : float
        Wheels that pass over a cross section of the rail per revolution of the wheel.
    progress : callable, optional
        Called with the profiles after each step.

    Raises
    ------
    SceneError
        If the scene has no wheel or no wear, or worn profiles have no contact.
    NotConverged
        If a contact is not solved.

    Examples
    --------
    >>> scene = ts.Scene.builtin("wheel-wear").with_set(["wear.revolutions=1000"])
    >>> worn = ts.wear_profiles(scene, deepest=0.1)
    >>> round(float(worn.revolutions[-1]))
    1000
    """
    for name in ("wheelset", "wear"):
        if getattr(scene, name) is None:
            raise SceneError([Fault(name, "nothing", f"a [{name}] table, to wear profiles")])
    last = None
    try:
        for last in ProfileWear(scene, rail_passes).steps(deepest):
            if progress is not None:
                progress(last)
    except ValueError as error:
        where = 0.0 if last is None else last.revolutions[-1]
        raise SceneError([Fault("wear", f"revolution {where:g}", str(error))]) from error
    assert last is not None
    return replace(last, scene=scene)
