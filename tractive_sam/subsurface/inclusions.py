"""Stress in and around inclusions as they pass below a contact, and their lift of its surface."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np
import scipy  # its parts are loaded when first used

from tractive_sam.contact import Laws, Model, equilibrium
from tractive_sam.description import ShortArrays
from tractive_sam.mechanics import Material, Steel, principal_stresses, von_mises
from tractive_sam.results import COMPONENTS, InclusionPassage, PlaneStress, Point, State
from tractive_sam.scene import Plane
from tractive_sam.solvers import combine_images
from tractive_sam.subsurface.fatigue_cycles import LocalSteel
from tractive_sam.subsurface.inclusion_group import (
    InclusionGroup,
    inclusion_groups,
    points_around,
    sphere_points,
    surface_points,
)
from tractive_sam.subsurface.sources import SIGNS
from tractive_sam.subsurface.stress_fields import stress_at, stress_layers, worn_depth


@dataclass(frozen=True, eq=False, repr=False)
class InclusionStress(ShortArrays):
    """Stress around an inclusion as it passes below a contact.

    Attributes
    ----------
    inclusion : int
        Its place in [[inclusion]], from 0.
    body : str
        "A" or "B".
    von_mises : float
        Largest equivalent stress of von Mises in the body beside it, MPa.
    at : tuple of float
        Position (x, y, depth) of this point at that moment, mm.
    tension : float
        Largest tensile stress inside, MPa; below 0 if there is compression at all times.
    utilisation : float
        Largest utilisation of the body beside it; nan without a fatigue limit.
    utilisation_at : tuple of float
        Its position (nan, y, depth), mm.
    lift : float
        Largest displacement of the surface above it that it causes, in either direction, mm.
    plane : PlaneStress
        Stress around it at the moment of the largest von Mises stress, over the distance from its
        centre along x and the depth below the unworn surface; depths worn off have nan.
    passage : InclusionPassage
        Pressure, lift and stress by its position.
    above : LiftedPass, optional
        Contacts during the passage, if the lift changes the contact.

    Examples
    --------
    >>> hole = ts.Inclusion(at=[0.0, 0.0, 1.5], radii=0.1, young=0.0, cells=7)
    >>> (around,) = ts.around_inclusions(ts.solve(scene.replace(inclusion=[hole])))
    >>> around.body, str(around.plane.plane), list(around.plane.axes)
    ('A', 'inclusion-1', ['along', 'depth'])
    """

    inclusion: int
    body: str
    von_mises: float
    at: Point
    tension: float
    utilisation: float
    utilisation_at: Point
    lift: float
    plane: PlaneStress
    passage: InclusionPassage
    above: LiftedPass | None = None


@dataclass(frozen=True, eq=False)
class LiftedPass:
    """Contacts above inclusions whose lift of the surface is part of the gap, by their position.

    Attributes
    ----------
    x : ndarray, shape (n,)
        Positions of the middle of the inclusions, descending, mm.
    contacts : tuple of State
        The contact at each of them.
    lifts : ndarray, shape (n, n_x, n_y)
        Displacement of the surface out of the body, mm.
    iterations : int
        Most contacts solved at a position until lift and pressure agree.
    residual : float
        Largest change of the lift in the last iteration over the largest lift at its position; inf
        if a contact is not solved.

    Examples
    --------
    >>> hole = ts.Inclusion(at=[0.0, 0.0, 0.5], radii=0.2, young=0.0, cells=5, lifts=True)
    >>> coarse = scene.replace(inclusion=[hole], grid={"elements": [15, 15]})
    >>> (around,) = ts.around_inclusions(ts.solve(coarse))
    >>> bool(around.above.peaks.min() < scene.hertz.p0), around.above.residual < 1e-4
    (True, True)
    """

    x: np.ndarray
    contacts: tuple[State, ...]
    lifts: np.ndarray
    iterations: int
    residual: float

    tolerance: ClassVar[float] = 1e-4
    """Residual at which the iteration ends."""
    fields: ClassVar[int] = 400
    """Fields on the mesh that all contacts take."""

    @property
    def peaks(self) -> np.ndarray:
        """Peak pressure at each position, shape (n,), MPa."""
        return np.array([contact.p_max for contact in self.contacts])


def around_inclusions(
    contact: State, laws: Laws | None = None, model: Model | None = None
) -> tuple[InclusionStress, ...]:
    """Return the stress around each inclusion of a scene as it passes below a contact.

    Inclusions whose centres are farther apart than three times their extent do not disturb each
    other, neither by stress nor by their lift of the surface. If wear has uncovered an inclusion,
    it and those that it disturbs have nan.

    Parameters
    ----------
    contact : State
        The solved contact of a scene with [[inclusion]].
    laws : Laws, optional
        Laws of the bodies; by default the laws of the solution.
    model : Model, optional
        Model of the contact, to solve it again for inclusions whose lift changes it; by default
        that of its scene.

    Raises
    ------
    ValueError
        If the scene has a [gap] or a roller, and a contact must be solved again without a model.

    Examples
    --------
    >>> hole = ts.Inclusion(at=[0.0, 0.0, 1.5], radii=0.1, young=0.0, cells=7)
    >>> (around,) = ts.around_inclusions(ts.solve(scene.replace(inclusion=[hole])))
    >>> round(around.von_mises / scene.hertz.p0, 1)
    1.5
    """
    laws = laws or Laws.of_contact(contact, ("elasticity", "fatigue"))
    results: dict[int, InclusionStress] = {}
    for passing in _passages(contact, laws):
        if passing.lifting.any() and not passing.is_open:
            if model is None and contact.scene.gap is not None:
                raise ValueError(
                    "model: lifts of an inclusion need the separation of the scene, of [gap] or of "
                    "a roller's profile; take the values of ts.roll(scene), or give "
                    "Model(scene, store.read_gap(scene.gap), contact.grid)"
                )
            solver = model or Model(contact.scene, grid=contact.grid, laws=laws)
            results |= replace(passing, above=passing.lifted(solver)).results()
        else:
            results |= passing.results()
    return tuple(results[k] for k in sorted(results))


def inclusion_lift(contact: State, x: float = 0.0, laws: Laws | None = None) -> np.ndarray:
    """Return the displacement of both surfaces by inclusions, out of the bodies, (n_x, n_y), mm.

    It closes the gap. With `lifts` of an inclusion, the contact is solved with its lift.

    Parameters
    ----------
    contact : State
        The solved contact of a scene with [[inclusion]].
    x : float
        Distance by which the inclusions are ahead of their places, mm.
    laws : Laws, optional
        Laws of the bodies; by default the laws of the solution.

    Examples
    --------
    >>> hole = ts.Inclusion(at=[0.0, 0.0, 0.5], radii=0.2, young=0.0, cells=7)
    >>> lift = ts.inclusion_lift(ts.solve(scene.replace(inclusion=[hole])))
    >>> bool(lift.min() < 0.0)  # the surface above a void yields
    True
    """
    laws, grid = laws or Laws.of_contact(contact, ("elasticity", "fatigue")), contact.grid
    grid = grid.shifted(0.0)  # y of the bodies
    lift = np.zeros(grid.elements)
    for passing in _passages(contact, laws):
        _, *middle = (float(at.mean()) for at in passing.group.cells)
        there = replace(passing, only=middle[0] + x)
        if there.is_open:
            continue
        own = there.group.share * np.tensordot(there.solved[1], there.shares[0], (1, 0))
        places = np.meshgrid(grid.x - middle[0] - x, grid.y - middle[1], indexing="ij")
        lift += there.group.box.lift(own, *map(np.ravel, places)).reshape(grid.elements)
    return lift


def _passages(contact: State, laws: Laws) -> Iterator[_Passing]:
    """Yield the passage of each group of inclusions that disturb each other."""
    inclusions = contact.scene.inclusion
    for group in inclusion_groups(inclusions):
        body = inclusions[group[0]].body
        depth = worn_depth(contact, body)
        y = contact.grid.shifted(0.0).y  # of the bodies
        worn = max(np.interp(inclusions[k].at[1], y, depth) for k in group)
        yield _Passing(contact, laws, body, group, float(worn))


@dataclass(frozen=True, eq=False)
class _Passing:
    """Passage of a group of inclusions below a contact.

    Attributes
    ----------
    contact, laws, body : State, Laws, str
        The contact, and the body that contains them.
    numbers : list of int
        Their places in [[inclusion]].
    worn : float
        Depth worn off, mm.
    only : float, optional
        The only position of the inclusions, mm; by default they pass the contact.
    above : LiftedPass, optional
        Contacts at some of the positions, if the lift of the inclusions changes the contact.
    """

    contact: State
    laws: Laws
    body: str
    numbers: list[int]
    worn: float
    only: float | None = None
    above: LiftedPass | None = None

    moments: ClassVar[int] = 101
    """Positions of the inclusions below the contact."""
    tolerance: ClassVar[float] = 1e-4
    """Part of the loads at all positions that is left out."""
    nodes: ClassVar[int] = 8
    """Depths at which the stress of the contact is computed."""
    every: ClassVar[int] = 5
    """Every fifth position is solved with the lift, and those with the extreme pressures.

    Between them, the change is interpolated.
    """

    @cached_property
    def group(self) -> InclusionGroup:
        """The inclusions in the smallest box."""
        inclusions = [self.contact.scene.inclusion[k] for k in self.numbers]
        material = self.contact.scene.body.responses[self.body]
        assert isinstance(material, Material)
        return InclusionGroup(inclusions, material.shear, material.poisson, self.worn)

    @property
    def is_open(self) -> bool:
        """Whether wear has uncovered one of the inclusions."""
        return any(self.group.places[:, 2] <= [one.half[2] for one in self.group.inclusions])

    @cached_property
    def outer(self) -> InclusionGroup:
        """The inclusions with the body around them."""
        return replace(self.group, margin=self.group.widest)

    @cached_property
    def x(self) -> np.ndarray:
        """Positions of the middle of the inclusions, from the leading side on, mm."""
        if self.only is not None:
            return np.array([self.only])
        depth = self.group.cells[0].mean()
        reach = self.contact.half_width_x + 3.0 * depth
        return self.contact.grid.centre[0] + np.linspace(reach, -reach, self.moments)

    @property
    def signs(self) -> np.ndarray:
        """Factors of stress components between the axis z of the contact and the depth, (6,)."""
        return np.array([1.0] * 4 + [SIGNS[self.body]] * 2)

    def loads(self, group: InclusionGroup) -> Iterator[np.ndarray]:
        """Yield the stress (6, n_z, n_x, n_y) without inclusions in a box, by position."""
        course = self.course(self.contact, group)
        if self.above is None:
            yield from map(course, self.x)
            return
        changes = [
            self.load_at(place, contact, group) - self.load_at(place, self.contact, group)
            for place, contact in zip(self.above.x, self.above.contacts, strict=True)
        ]
        change = scipy.interpolate.CubicSpline(-self.above.x, changes)
        for place in self.x:
            yield course(place) + change(-place)

    def load_at(self, place: float, contact: State, group: InclusionGroup) -> np.ndarray:
        """Return the stress (6, n_z, n_x, n_y) below a contact in a box at one position."""
        return self.course(contact, group, place)(place)

    def course(
        self, contact: State, group: InclusionGroup, only: float | None = None
    ) -> Callable[[float], np.ndarray]:
        """Return the stress (6, n_z, n_x, n_y) below a contact in a box, by its position.

        Its axes are x, y and the depth. With `only`, it is known near this position.
        """
        depth, x, y = group.cells
        grid = contact.grid
        y = y - grid.shift
        at_depth, depths = _chebyshev(depth, self.nodes)
        reach = np.abs(self.x - grid.centre[0]).max() + np.ptp(x)
        beyond = max(0, math.ceil((reach - grid.half_length[0]) / grid.dx) + 2)
        along = grid.lengthened(beyond).x
        near = slice(None)
        if only is not None:  # the influence of a node on a spline ends within a few nodes
            margin = 0.5 * np.ptp(x) + 12.0 * grid.dx
            near = slice(*np.searchsorted(along, [only - margin, only + margin]))
        along = along[near]
        if grid.y.size > 3 and (y[0] < grid.y[0] or y[-1] > grid.y[-1]):  # outside the mesh
            at_y, rows = _chebyshev(y, self.nodes)
            points = np.stack(np.meshgrid(depths, along, rows, indexing="ij"), axis=-1)
            stress = stress_at(
                contact, points.reshape(-1, 3)[:, [1, 2, 0]], self.body, self.laws, False
            )
            values = stress.reshape(*points.shape[:3], 6).transpose(0, 3, 1, 2) @ at_y.T
        else:
            layers = stress_layers(contact, depths, self.body, beyond, 1, self.laws, residual=False)
            # Depth, component, x, y.
            values = np.stack([stress[0][:, near] for _, stress in layers])
            if grid.y.size > 3:
                values = scipy.interpolate.CubicSpline(grid.y, values, axis=3)(y)
            else:  # a line contact
                values = np.repeat(values[..., :1], y.size, axis=3)
        values = np.tensordot(at_depth, values, 1) * self.signs[:, None, None]
        spline = scipy.interpolate.CubicSpline(along, values, axis=2)
        return lambda place: spline(place + x - x.mean()).swapaxes(0, 1)

    @property
    def lifting(self) -> np.ndarray:
        """Share in each cell, (n_z, n_x, n_y), of the inclusions whose lift changes the contact."""
        pairs = zip(self.group.inclusions, self.group.shares, strict=True)
        return sum((one.lifts * share for one, share in pairs), np.zeros(self.group.box.shape))

    def lifted(self, model: Model, most: int = 40) -> LiftedPass:
        """Return the contacts above the lifted surface: lift and pressure are solved in turn.

        Each contact is that of steady rolling at a position of the inclusions. It begins with the
        lift below the undisturbed contact; lifts are combined so that they change least (Anderson
        1965, J. ACM 12, 547-560).

        Parameters
        ----------
        model : Model
            Model of the contact.
        most : int
            Most contacts at a position.
        """
        response, contact = _LiftResponse(self), self.contact
        places = self.x[:: self.every].tolist()
        # Coarser contacts would not respond to the last changes of the lift.
        tolerance = min(model.scene.solver.tolerance, 0.01 * LiftedPass.tolerance)
        contacts, lifts, iterations, residual = list[State](), list[np.ndarray](), 0, 0.0
        for place in places:  # which grow
            images, changes = list[np.ndarray](), list[np.ndarray]()
            lift = response.on_mesh(self.load_at(place, self.contact, self.group), place)
            while len(images) < most:
                contact = equilibrium(model, self.contact.wear - lift, contact, tolerance)
                image = response.on_mesh(self.load_at(place, contact, self.group), place)
                images, changes = [*images, image], [*changes, image - lift]
                largest = max(np.abs(image).max(), 1e-9 * model.units.gap)
                missed = float(np.abs(changes[-1]).max() / largest)
                if not contact.converged or missed <= LiftedPass.tolerance:
                    break
                lift = combine_images(images[-6:], changes[-6:])
            iterations = max(iterations, len(images))
            residual = max(residual, missed if contact.converged else math.inf)
            contacts.append(contact)
            lifts.append(lift)
            if len(contacts) == len(self.x[:: self.every]):  # extremes between them
                peaks = [contact.p_max for contact in contacts]
                course = scipy.interpolate.CubicSpline(-np.array(places), peaks)(-self.x)
                extremes = self.x[[course.argmin(), course.argmax()]].tolist()
                places += [place for place in extremes if place not in places]
        order = np.argsort(places)[::-1]
        above = tuple(contacts[k] for k in order)
        return LiftedPass(
            np.array(places)[order], above, np.array(lifts)[order], iterations, residual
        )

    def constant(self, group: InclusionGroup) -> np.ndarray:
        """Return the residual stress (6, n_z, n_x, n_y) in the cells of a box."""
        stress = np.zeros((6, *group.box.shape))
        steel = self.contact.scene.steel.get(self.body, Steel())
        if (residual := steel.stress(group.cells[0] + self.worn)) is not None:
            stress[:2] = residual[..., None, None]
        return stress

    @cached_property
    def shares(self) -> np.ndarray:
        """Factors (positions + 1, n) of a few loads; the last load is constant, and acts alone."""
        inside = self.group.owner >= 0
        loads = np.array([load[:, inside].ravel() for load in self.loads(self.group)])
        sizes, vectors = np.linalg.eigh(loads @ loads.T)
        shares = np.zeros(
            (len(loads) + 1, 1 + np.count_nonzero(sizes > self.tolerance**2 * sizes[-1]))
        )
        shares[:-1, :-1] = vectors[:, len(sizes) + 1 - shares.shape[1] :]
        shares[:, -1] = 1.0
        return shares

    def combine(self, group: InclusionGroup) -> np.ndarray:
        """Return the few loads (n, 6, n_z, n_x, n_y) as strains, without inclusions, in a box."""
        total = np.zeros((self.shares.shape[1], 6, *group.box.shape))
        for share, load in zip(self.shares, self.loads(group), strict=False):
            total[:-1] += np.multiply.outer(share[:-1], load)
        total[-1] = self.constant(group)
        return np.tensordot(total, np.linalg.inv(self.group.stiffness), (1, 1)).transpose(
            0, 4, 1, 2, 3
        )

    @cached_property
    def solved(self) -> tuple[np.ndarray, np.ndarray]:
        """Strain and eigenstrain (6, n, n_z, n_x, n_y) in each of the few loads."""
        strains = self.combine(self.group)
        last = len(strains) - 1
        pairs = [self.group.solve(load, misfit=k == last) for k, load in enumerate(strains)]
        return np.stack([one for one, _ in pairs], 1), np.stack([two for _, two in pairs], 1)

    def widen(self, field: np.ndarray) -> np.ndarray:
        """Return a field of the smallest box in the wider one, 0 around it."""
        inner, outer = self.group.cells, self.outer.cells
        wide = np.zeros((*field.shape[:-3], *self.outer.box.shape))
        first = [int(np.abs(two - one[0]).argmin()) for one, two in zip(inner, outer, strict=True)]
        z, x, y = (slice(k, k + at.size) for k, at in zip(first, inner, strict=True))
        wide[..., z, x, y] = field
        return wide

    @cached_property
    def around(self) -> np.ndarray:
        """Strain (6, n, n_z, n_x, n_y) in the wider box in each of the few loads."""
        own = self.widen(self.group.share * self.solved[1]).swapaxes(0, 1)
        fields = [
            load + self.outer.box(e) for load, e in zip(self.combine(self.outer), own, strict=True)
        ]
        return np.stack(fields, axis=1)

    def near(self, k: int, directions: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Return the stress (6, positions + 1, points) beside an inclusion, and points (3, points).

        The points are those of the surface of an ellipsoid in directions, see `surface_points`, and
        the cells next to a cuboid.
        """
        inclusion, place = self.group.inclusions[k], self.group.places[k]
        if inclusion.is_ellipsoid:
            stress = self.group.at_surface(k, *self.solved, directions)
            points = surface_points(inclusion, directions)[0] + place[:, None]
        else:
            near = scipy.ndimage.binary_dilation(self.outer.owner == k, np.ones((3, 3, 3)))
            near &= self.outer.owner < 0
            stress = np.tensordot(self.group.stiffness, self.around[..., near], 1)
            z, x, y = self.outer.cells
            points = np.stack(
                [np.broadcast_to(at, near.shape)[near] for at in (x[:, None], y, z[:, None, None])]
            )
        points[0] -= self.group.cells[1].mean()
        return np.einsum("pn,cnk->cpk", self.shares, stress), points

    def largest(
        self,
        k: int,
        near: tuple[np.ndarray, np.ndarray],
        measure: Callable[[np.ndarray, np.ndarray], np.ndarray],
        rounds: int = 3,
    ) -> tuple[float, np.ndarray, np.ndarray]:
        """Return the largest measure of a cycle beside an inclusion, its cycle, and its point (3,).

        Parameters
        ----------
        k : int
            The inclusion.
        near : tuple
            Stress and points beside it, of `near`.
        measure : callable
            Returns the measure (points,) of cycles (6, positions + 1, points) at depths (points,).
        rounds : int
            Searches around the largest one of an ellipsoid, each as wide as half of the one before.
        """
        directions, (cycle, points) = sphere_points(), near
        width = math.pi / math.sqrt(directions.shape[1])
        values = measure(cycle, points[2])
        for _ in range(rounds * self.group.inclusions[k].is_ellipsoid):
            if not np.isfinite(values).any():
                break
            directions = points_around(directions[:, values.argmax()], width)
            cycle, points = self.near(k, directions)
            values, width = measure(cycle, points[2]), 0.5 * width
        top = int(values.argmax())
        return float(values[top]), cycle[..., top], points[:, top]

    def section(self, k: int, moment: int | None) -> PlaneStress:
        """Return the stress around an inclusion on the plane through its centre; nan at no moment.

        It always has as many depths, from those of the unworn body on.
        """
        z, x, y = replace(self.outer, worn=0.0).cells
        row = int(np.abs(y - self.group.places[k][1]).argmin())
        values = np.full((6, x.size, z.size), np.nan)
        if moment is not None:
            load = self.constant(self.outer)
            if moment < self.moments:
                load = load + next(v for i, v in enumerate(self.loads(self.outer)) if i == moment)
            strain, own = (np.tensordot(v, self.shares[moment], (1, 0)) for v in self.solved)
            change = self.outer.box(self.widen(self.group.share * own))
            stress = load + np.tensordot(self.group.stiffness, change, 1)
            inside = np.zeros_like(strain)
            for n in range(len(self.numbers)):
                elastic = self.group.inside(n, strain) - self.group.inside(n, own)
                inside[:, self.group.owner == n] = self.group.stiffness @ elastic
            mostly = self.outer.share > 0.5
            stress[:, mostly] = self.widen(inside)[:, mostly]
            values[..., z.size - len(stress[0]) :] = stress[..., row].swapaxes(1, 2)
        axes = {"along": x - self.group.places[k][0], "depth": z}
        plane = Plane("y", float(y[row]), label=f"inclusion-{self.numbers[k] + 1}")
        components = dict(zip(COMPONENTS, values * self.signs[:, None, None], strict=True))
        return PlaneStress(self.body, plane, plane.number, axes, components)

    def results(self) -> dict[int, InclusionStress]:
        """Return the results of each inclusion by its place in [[inclusion]]."""
        found = {}
        if self.is_open:
            nowhere, unknown = (math.nan,) * 3, np.full((4, self.moments), math.nan)
            for k, number in enumerate(self.numbers):
                about = number, self.body, math.nan, nowhere, math.nan, math.nan, nowhere, math.nan
                passage = InclusionPassage(self.body, f"inclusion-{number + 1}", *unknown)
                found[number] = InclusionStress(*about, self.section(k, None), passage)
            return found
        lifts = self.lifts()
        for k, number in enumerate(self.numbers):
            near = self.near(k)
            mises, cycle, point = self.largest(k, near, lambda v, _: von_mises(v).max(axis=0))
            moment = int(von_mises(cycle).argmax())
            x, y, depth = point.tolist()
            at = x + (*self.x, math.nan)[moment], y, depth
            strain, own = (self.group.inside(k, values) for values in self.solved)
            stress = np.tensordot(self.group.stiffness, strain - own, 1)
            parts = np.array_split(stress, math.ceil(stress.shape[-1] / 2000), axis=2)
            tension = max(_largest_tension(self.shares @ part) for part in parts)
            used, _, point = self.largest(k, near, self._utilisation)
            place = (math.nan, *(point[1:].tolist() if math.isfinite(used) else [math.nan] * 2))
            found[number] = InclusionStress(
                number, self.body, mises, at, tension, used, place,
                float(np.abs(lifts[k]).max()), self.section(k, moment),
                self.passage(k, near[0], cycle, lifts[k, :-1]), self.above,
            )  # fmt: skip
        return found

    def lifts(self) -> np.ndarray:
        """Return the lift of the surface above each inclusion, (inclusions, positions + 1), mm."""
        x, y, _ = (self.group.places - [self.group.cells[k].mean() for k in (1, 2, 0)]).T
        return (self.shares @ self.group.box.lift(self.group.share * self.solved[1], x, y)).T

    def passage(
        self, k: int, cycles: np.ndarray, highest: np.ndarray, lift: np.ndarray
    ) -> InclusionPassage:
        """Return the passage of an inclusion.

        Parameters
        ----------
        k : int
            The inclusion.
        cycles : ndarray, shape (6, positions + 1, points)
            Stress beside it, of `near`.
        highest : ndarray, shape (6, positions + 1)
            Cycle of the point with the largest stress.
        lift : ndarray, shape (positions,)
            Lift of the surface above it, mm.
        """
        stress = von_mises(cycles)
        mises = np.maximum(stress.max(axis=1), von_mises(highest))
        if self.group.inclusions[k].is_ellipsoid:  # search around the largest values, too
            tops, width = sphere_points()[:, np.unique(stress.argmax(axis=1))], 0.13
            more = np.concatenate([points_around(top, width) for top in tops.T], axis=1)
            mises = np.maximum(mises, von_mises(self.near(k, more)[0]).max(axis=1))
        pressure = np.full(self.x.size, math.nan)
        if self.above is not None:
            pressure[np.isin(self.x, self.above.x)] = self.above.peaks
        place = self.x + self.group.places[k, 0] - self.group.cells[1].mean()
        name = f"inclusion-{self.numbers[k] + 1}"
        return InclusionPassage(self.body, name, place, pressure, lift, mises[:-1])

    def _utilisation(self, cycle: np.ndarray, depth: np.ndarray) -> np.ndarray:
        """Return the utilisation of points by their cycles; nan without a limit for the body."""
        table, law = self.contact.scene.fatigue, self.laws.fatigue
        if table is None or law is None or table.limit is None or self.body not in table.bodies:
            return np.full(depth.size, np.nan)
        # The cycle contains the residual stress.
        at_points = LocalSteel.at_points(self.contact.scene, self.body, depth + self.worn)
        local = replace(at_points, stress=None)
        return np.maximum(local.evaluate(law, cycle)[0], 0.0) / local.limit


def _largest_tension(stress: np.ndarray) -> float:
    """Return the largest principal stress among stresses (6, ...).

    It is one to two thirds of the von Mises stress above the mean stress, which excludes most.
    """
    mean, third = stress[:3].mean(axis=0), von_mises(stress) / 3.0
    high = mean + 2.0 * third >= (mean + third).max()
    return float(principal_stresses(stress[:, high])[0].max())


class _LiftResponse:
    """Lift of the surface by the inclusions of a passage, as a linear function of their load.

    It begins with the few loads of the undisturbed passage; the part of a load that the known ones
    do not contain is added to them. The lift of each is known on a table around the inclusions,
    which becomes coarser with the distance.

    Parameters
    ----------
    passing : _Passing
        The passage below the undisturbed contact.
    spacing : float
        Spacing of the table over the distance from the inclusions.
    """

    def __init__(self, passing: _Passing, spacing: float = 0.15) -> None:
        self._passing, group = passing, passing.group
        grid = passing.contact.grid.shifted(0.0)  # y of the bodies
        depth, x, y = group.cells
        self._middle = float(x.mean()), float(y.mean())
        # The lift has waves about as long as the inclusions are deep.
        deep = max(float(depth[0] - 0.5 * group.box.sides[0]), 0.25 * float(depth[-1]))
        far = np.abs(passing.x - grid.centre[0]).max() + grid.half_length[0]
        aside = np.abs(grid.y - self._middle[1]).max()
        self._axes = (
            _graded_places(0.5 * float(np.ptp(x)), far, deep, spacing),
            _graded_places(0.5 * float(np.ptp(y)), aside, deep, spacing),
        )
        few = np.tensordot(passing.combine(group), group.stiffness, (1, 1))[:-1]
        loads = np.moveaxis(few, -1, 1)[..., group.owner >= 0].reshape(len(few), -1)
        sizes = np.linalg.norm(loads, axis=1)
        self._loads, self._largest = list(loads / sizes[:, None]), sizes.max()
        *tables, self._constant = self._lift(passing.solved[1])
        self._tables = [table / size for table, size in zip(tables, sizes, strict=True)]

    def _lift(self, eigenstrain: np.ndarray) -> np.ndarray:
        """Return the lift (n, x, y) on the table by eigenstrains (6, n, n_z, n_x, n_y)."""
        x, y = np.meshgrid(*self._axes, indexing="ij")
        own = self._passing.lifting * eigenstrain
        return self._passing.group.box.lift(own, x.ravel(), y.ravel()).reshape(-1, *x.shape)

    def on_mesh(self, load: np.ndarray, place: float) -> np.ndarray:
        """Return the lift on the mesh (n_x, n_y), mm, by a load (6, n_z, n_x, n_y) at a position.

        The part of the load that is left out is that of `_Passing.tolerance`.
        """
        group, grid = self._passing.group, self._passing.contact.grid.shifted(0.0)
        inside = group.owner >= 0
        rest, total = load[:, inside].ravel(), self._constant.copy()
        for known, table in zip(self._loads, self._tables, strict=True):
            share = known @ rest
            rest = rest - share * known
            total += share * table
        if (size := float(np.linalg.norm(rest))) > self._passing.tolerance * self._largest:
            strain = np.zeros_like(load)
            strain[:, inside] = np.linalg.solve(group.stiffness, rest.reshape(6, -1) / size)
            _, own = group.solve(strain)
            self._loads.append(rest / size)
            self._tables.append(self._lift(own[:, None])[0])
            total += size * self._tables[-1]
        spline = scipy.interpolate.RectBivariateSpline(*self._axes, total)
        return spline(grid.x - place, grid.y - self._middle[1])


def _graded_places(half: float, far: float, deep: float, spacing: float) -> np.ndarray:
    """Return places from -far to far, denser up to the distance `half` from 0.

    Their spacing is a part of the distance from inclusions within `half`, `deep` below the surface.
    """
    places = [0.0]
    while places[-1] < far:
        places.append(places[-1] + spacing * math.hypot(deep, max(places[-1] - half, 0.0)))
    return np.array([*(-place for place in places[:0:-1]), *places])


def _chebyshev(at: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the interpolation (n, count) from Chebyshev nodes to positions (n,), and the nodes."""
    centre, half = 0.5 * (at[0] + at[-1]), 0.5 * (at[-1] - at[0])
    known = np.cos(np.pi * (np.arange(count) + 0.5) / count)
    scaled = np.clip((at - centre) / half, -1.0, 1.0)
    here, there = (np.cos(np.arccos(v)[:, None] * np.arange(count)) for v in (scaled, known))
    return here @ np.linalg.inv(there), centre + half * known
