"""Fatigue of the material, from its stress path through one contact or a sequence of contacts.

In steady rolling the stress path of a point (y, depth) is sigma(x; y, depth), from the leading side
to the trailing side: the stress along x on a mesh.

Each point of the material has a fixed position in its body. If the bodies shift, this is a fixed
position in the contact. If they roll, the contact moves over the point: at the rolling distance s
the point is at x = X - s, with its position X at the distance 0. Material below the contact at the
end of the sequence leaves it as if the contact continued to roll with its last tractions.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any, cast

import numpy as np

from tractive_sam.contact import Laws
from tractive_sam.description import ShortArrays
from tractive_sam.mechanics import (
    CycleCriterion,
    HalfSpaces,
    Steel,
    SurfaceResponse,
    enclosing_radius,
    evaluate_cycles,
    residual_shear,
)
from tractive_sam.operators import Lattice
from tractive_sam.results import BodyFatigue, Grid, State
from tractive_sam.scene import Fatigue, Scene, layered_body
from tractive_sam.schema import required
from tractive_sam.subsurface.layered import with_interfaces
from tractive_sam.subsurface.sources import SIGNS, surface_cycles, surface_points
from tractive_sam.subsurface.stress_fields import (
    LoadedBodies,
    check_depths,
    semi_axes,
    stress_layers,
    worn_depth,
)


def cycle_depths(contact: State, grading: float = 1.5) -> np.ndarray:
    """Return the depths at which [fatigue] is computed, shape (elements,), mm.

    They are the surface, one element below it (the longer side), and further depths down to the
    depth in the scene, or at least three elements; and both sides of each interface. With
    [[fatigue.A.layer]] they include interfaces down to twice this depth, and those that wear leaves
    (wear.layer_step).

    Parameters
    ----------
    contact : State
        The solved contact of a scene with [fatigue].
    grading : float
        Exponent of the distribution: above 1 depths are denser towards the surface.

    Examples
    --------
    >>> tired = scene.replace(fatigue={"shear_yield": 300.0, "elements": 8})
    >>> cycle_depths(ts.solve(tired)).size
    8
    """
    table = fatigue_table(contact)
    side = max(contact.grid.sides)
    deepest = max(table.depth * semi_axes(contact)[0], 3.0 * side)
    share = np.linspace(0.0, 1.0, table.elements - 1) ** grading
    depths = np.concatenate(([0.0], side + (deepest - side) * share))
    faces = [face for name in table.bodies for face in _steel(contact.scene, name).faces]
    deeper = [face for face in faces if depths[-1] <= face <= 2.0 * depths[-1]]
    if deeper:
        depths = np.append(depths, 1.1 * max(deeper))
    bodies = (each for name in table.bodies for each in _worn_bodies(contact.scene, name))
    return with_interfaces(depths, bodies)


def _worn_bodies(scene: Scene, body: str) -> Iterator[SurfaceResponse]:
    """Yield a body, and with strengths of its layers as it is after each step of their wear."""
    if not _steel(scene, body).is_layered:
        yield scene.body.responses[body]
        return
    layered = layered_body(scene, body)
    yield layered
    if scene.wear is None or (step := scene.wear.layer_step) is None:
        return
    for layer, face in zip(layered.layers, layered.interfaces, strict=True):
        for share in np.arange(0.0, 1.0 - 1e-9, step):
            yield layered.worn(float(face) - (1.0 - share) * layer.thickness, step)


def _steel(scene: Scene, body: str) -> Steel:
    """Return the material of a body of a scene; without its tables it has no curves."""
    return scene.steel.get(body, Steel())


@dataclass(frozen=True, eq=False)
class LocalSteel:
    """Residual stress and strength of the material of a body at the rows and depths of a pass.

    Attributes
    ----------
    stress : ndarray, shape (2, rows, ...), optional
        Residual stress xx, yy, MPa.
    limit, shear_yield : ndarray, shape (rows, ...)
        Fatigue limit and yield stress in shear, MPa; nan without one.
    common_yield : float
        Yield stress in shear of [fatigue], for which criteria are made, MPa; nan without one.
    varies : bool
        Whether the strength depends on the depth.
    has_factor : bool
        Whether to compute the load factor at first yield.
    layer : ndarray of int, shape (rows, ...)
        Number of the layer.
    steel : Steel
        Material of all depths.

    Examples
    --------
    >>> soft = {"depth": [0.0, 1.0], "shear_yield": [300.0, 200.0]}
    >>> tired = ts.solve(scene.replace(fatigue={"A": soft, "bodies": ["A"]}))
    >>> from tractive_sam.subsurface import LocalSteel
    >>> steel = LocalSteel.from_contact(tired, "A", np.array([0.0, 0.5]), np.zeros(1))
    >>> steel.at_depth(1).shear_yield
    array([250.])
    """

    stress: np.ndarray | None
    limit: np.ndarray
    shear_yield: np.ndarray
    common_yield: float
    varies: bool
    has_factor: bool
    layer: np.ndarray
    steel: Steel

    @classmethod
    def at_points(
        cls, scene: Scene, body: str, zeta: np.ndarray, layer: np.ndarray | None = None
    ) -> "LocalSteel":
        """Return the steel at depths (rows, ...) below the unworn surface, mm.

        On an interface, `layer` is the number of the layer.
        """
        table, steel = required(scene.fatigue, "fatigue"), _steel(scene, body)
        layer = steel.layer_at(zeta) if layer is None else layer.astype(int)
        common = math.nan if table.shear_yield_stress is None else table.shear_yield_stress
        limit, k = (steel.at(name, zeta, layer) for name in ("limit", "shear_yield"))
        varies = steel.is_layered or limit is not None or k is not None
        common_limit = math.nan if table.limit is None else table.limit
        limit = np.full(zeta.shape, common_limit) if limit is None else limit
        k = np.full(zeta.shape, common) if k is None else k
        has_factor = scene.residual is not None and not math.isnan(common)
        return cls(steel.stress(zeta), limit, k, common, varies, has_factor, layer, steel)

    @classmethod
    def from_contact(
        cls,
        contact: State,
        body: str,
        depths: np.ndarray,
        worn: np.ndarray,
        laws: Laws | None = None,
        layer: np.ndarray | None = None,
    ) -> "LocalSteel":
        """Return the steel below rows worn by `worn` (n_y,), at depths (n,), mm.

        With layers, `laws` have those that wear has left; by default they are those of the contact.
        If the numbers of the `layer` (n_y, n) there are stored, the laws need not be known.
        """
        steel, zeta = _steel(contact.scene, body), worn[:, None] + depths
        if layer is None and steel.is_layered:
            known = laws or Laws.of_contact(contact, ("elasticity",))
            elastic = known.elasticity.single_body(body)
            faces = getattr(getattr(elastic, "A", None), "interfaces", np.zeros(0))
            lost = steel.distinct - faces.size
            # Either wear removed the upper layers, or the laws have other layers than the scene.
            is_known = not lost or contact.scene.has("wear.layer_step")
            below = lost + np.searchsorted(faces, depths)
            layer = steel.layer_at(zeta, below if is_known else None)
        return cls.at_points(contact.scene, body, zeta, layer)

    def at_depth(self, k: int, at_corners: bool = False) -> "LocalSteel":
        """Return the steel of the rows, or of corner rows between them, at one depth."""

        def select(values: np.ndarray) -> np.ndarray:
            rows = values[..., k]
            two = at_corners and rows.shape[-1] > 1
            return 0.5 * (rows[..., 1:] + rows[..., :-1]) if two else rows

        stress = None if self.stress is None else select(self.stress)
        limit, shear_yield = select(self.limit), select(self.shear_yield)
        if self.steel.is_layered and shear_yield.shape[-1] < self.shear_yield.shape[0]:
            # Of two rows in different layers the weaker one, as no mean of them is a material.
            shear_yield = np.minimum(self.shear_yield[1:, k], self.shear_yield[:-1, k])
        return replace(self, stress=stress, limit=limit, shear_yield=shear_yield)

    def of_rows(self, part: slice) -> "LocalSteel":
        """Return the steel of some rows at one depth."""
        stress = None if self.stress is None else self.stress[:, part]
        limit, shear_yield = self.limit[part], self.shear_yield[part]
        return replace(self, stress=stress, limit=limit, shear_yield=shear_yield)

    def evaluate(
        self, criterion: CycleCriterion, cycle: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return a criterion of cycles (6, n, rows, ...) with the residual stress, and the radius.

        A criterion depends on the ratio of its stresses to its yield strength: with another yield
        strength it is the value of stresses in the common ratio.
        """
        total = self._add_residual(cycle)
        if not self.varies or not hasattr(criterion, "yield_strength"):
            return evaluate_cycles(criterion, total)
        ratio = (self.shear_yield / self.common_yield).reshape(-1, *(1,) * (cycle.ndim - 3))
        value, radius = evaluate_cycles(criterion, total / ratio)
        return ratio * value, ratio * radius

    def inverse_yield_factor(self, cycle: np.ndarray) -> np.ndarray:
        """Return 1 over the load factor at which cycles (6, n, rows, ...) first yield.

        J2(f sigma + rho) = k² is quadratic in the factor f. The result is at most 1e6, also where
        the residual stress yields without load.
        """
        none = self._add_residual(np.zeros_like(cycle[:, :1]))
        # Coordinates of the deviators, whose squares add up to J2.
        stress, rest = (
            np.stack([0.5 * (s[0] - s[1]), (s[0] + s[1] - 2.0 * s[2]) / 12.0**0.5, *s[3:]])
            for s in (cycle, none)
        )
        k = np.reshape(self.shear_yield, (-1, *(1,) * (cycle.ndim - 3)))
        a, b = (stress**2).sum(axis=0), (stress * rest).sum(axis=0)
        free = np.broadcast_to(k**2 - (rest**2).sum(axis=0), a.shape)
        root = np.sqrt(np.maximum(b * b + a * free, 0.0))
        inverse = np.divide(b + root, free, out=np.full(a.shape, 1e6), where=free > 0.0)
        return np.minimum(inverse.max(axis=0), 1e6)

    def _add_residual(self, cycle: np.ndarray) -> np.ndarray:
        """Return cycles with the residual stress added; the same array without any."""
        if self.stress is None:
            return cycle
        total = cycle.copy()
        total[:2] += self.stress.reshape(2, 1, -1, *(1,) * (cycle.ndim - 3))
        return total

    @property
    def stack_limit(self) -> np.ndarray | float:
        """Limit of the stress that may be interpolated over the depth (`Steel.stack`), MPa."""
        return self.limit if self.steel.common_limit is None else self.steel.common_limit

    def profiles(self, depths: np.ndarray, used: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the largest utilisation (n_y, n) of passes, and the profiles of all passes.

        Parameters
        ----------
        depths : ndarray, shape (n,)
            mm.
        used : ndarray, shape (passes, n_y, n)
            Criterion over `stack_limit` in each pass.

        Returns
        -------
        largest : ndarray, shape (n_y, n)
            Utilisation.
        profiles : ndarray, shape (passes, n_y, ...)
            From `Steel.stack`.
        """
        largest = used.max(axis=0) * (self.stack_limit / self.limit)
        return largest, self.steel.stack(depths, used, self.layer)

    def fields(self, factor: np.ndarray | None = None) -> dict[str, Any]:
        """Return the fields of `BodyFatigue` that depend on the material, by name, (n_y, n)."""
        fields: dict[str, Any] = {"steel": self.steel}
        if self.stress is not None:
            fields |= {"residual_xx": self.stress[0], "residual_yy": self.stress[1]}
        if self.steel.is_layered:
            fields["local_layer"] = 1.0 * self.layer
        if self.varies:
            fields |= {"local_limit": self.limit, "local_yield": self.shear_yield}
        if self.has_factor and factor is not None:
            fields["inverse_yield_factor"] = factor
        return fields


def fatigue(
    contact: State, *, depths: np.ndarray | None = None, laws: Laws | None = None
) -> dict[str, BodyFatigue]:
    """Return the fatigue of each body's material in one pass of a contact, by body.

    The stress is computed layer by layer, and not stored.

    Parameters
    ----------
    contact : State
        The solved contact of a scene with [fatigue].
    depths : array_like, shape (n,), optional
        Depths, ascending from 0, mm; by default from [fatigue].
    laws : Laws, optional
        Criterion and bodies; by default the laws of the solution.

    Returns
    -------
    dict of str to BodyFatigue
        By body.

    Raises
    ------
    ValueError
        If the scene has no [fatigue], or the depths do not begin with the surface.

    Examples
    --------
    >>> table = {"criterion": "orthogonal-shear", "limit": 250.0, "bodies": ["A"]}
    >>> top = ts.fatigue(ts.solve(scene.replace(fatigue=table)))["A"].largest()
    >>> round(top.interior * 250.0 / scene.hertz.p0, 1), round(top.interior_at[2], 1)
    (0.2, 1.5)
    """
    fatigue_table(contact)
    depths = cycle_depths(contact) if depths is None else check_depths(depths)
    if not depths.size or depths[0] != 0.0 or (np.diff(depths) <= 0.0).any():
        raise ValueError("depths must ascend from 0, the surface")
    needed = "elasticity", "fatigue", "life"
    by_body = cycle_fatigue([contact], depths, [laws or Laws.of_contact(contact, needed)])
    return {body: worst for body, (worst, _) in by_body.items()}


def cycle_fatigue(
    contacts: Sequence[State],
    depths: np.ndarray,
    laws: Sequence[Laws],
    worn: Mapping[str, np.ndarray] | None = None,
) -> dict[str, tuple[BodyFatigue, np.ndarray]]:
    """Return by body (fatigue in the passes of contacts, utilisation in each contact).

    The criterion applies to each pass separately. Residual stress is constant over all passes:
    shakedown refers to the path through all contacts.

    Parameters
    ----------
    contacts : sequence of State
        Solved contacts on one mesh: of the blocks of a load spectrum, or a single one.
    depths : ndarray, shape (n,)
        Ascending from 0, mm.
    laws : sequence of Laws
        Laws of each contact.
    worn : mapping of str to ndarray, optional
        Depth (n_y,) worn off each body, mm; by default from the first contact.

    Returns
    -------
    dict of str to (BodyFatigue, ndarray of shape (contacts, n_y, n))
        By body: the largest utilisation, and the profiles of each contact (`Steel.stack`).

    Examples
    --------
    >>> contact = ts.solve(scene.replace(fatigue={"shear_yield": 300.0, "bodies": ["A"]}))
    >>> depths = cycle_depths(contact)
    >>> worst, each = cycle_fatigue([contact], depths, [ts.Laws.of(contact.scene)])["A"]
    >>> each.shape == (1, *worst.path_radius.shape)
    True
    """
    table, grid = fatigue_table(contacts[0]), contacts[0].grid
    shape = grid.elements[1], depths.size
    used = {body: np.full((len(contacts), *shape), np.nan) for body in table.bodies}
    residual, radius, factor = ({body: np.zeros(shape) for body in table.bodies} for _ in range(3))
    worn = worn or {body: worn_depth(contacts[0], body) for body in table.bodies}
    steel = {
        body: LocalSteel.from_contact(contacts[0], body, depths, worn[body], laws[0])
        for body in table.bodies
    }
    layers = (
        layer_cycles(contact, depths, law) for contact, law in zip(contacts, laws, strict=True)
    )
    for k, at_depth in enumerate(zip(*layers, strict=True), 1):
        for i, body in enumerate(table.bodies):
            cycles = [layer[i] for _, _, layer in at_depth]
            found, values = _evaluate(laws, cycles, steel[body].at_depth(k))
            radius[body][:, k], residual[body][:, k], factor[body][:, k] = found
            for utilisation, value in zip(used[body], values, strict=False):
                utilisation[:, k] = value
    surfaces = (_surface_cycles(contact, law) for contact, law in zip(contacts, laws, strict=True))
    for passes in zip(*surfaces, strict=True):
        body, cycles = passes[0][0], [cycle for _, cycle, _ in passes]
        is_valid = np.any([rows for _, _, rows in passes], axis=0)
        found, values = _evaluate(laws, cycles, steel[body].at_depth(0, at_corners=True))
        for values_of, at_corners in zip((radius, residual, factor), found, strict=True):
            of_body = values_of[body]
            of_body[:, 0] = average_rows(at_corners, is_valid, of_body[:, 1])
        for utilisation, value, (_, _, rows) in zip(used[body], values, passes, strict=False):
            utilisation[:, 0] = average_rows(value, rows, utilisation[:, 1])
    shear_yield = table.shear_yield_stress
    about = laws[0].fatigue, math.nan if shear_yield is None else shear_yield
    y = grid.shifted(0.0).y
    results: dict[str, tuple[BodyFatigue, np.ndarray]] = {}
    for body in table.bodies:
        largest, profiles = steel[body].profiles(depths, used[body])
        fields, further = (largest, residual[body], radius[body]), steel[body].fields(factor[body])
        results[body] = BodyFatigue(body, y, depths, *fields, *about, **further), profiles
    return results


def fatigue_table(contact: State) -> Fatigue:
    """Return the [fatigue] table of the scene; raise a ValueError if there is none."""
    table = contact.scene.fatigue
    if table is None:
        raise ValueError("the scene has no [fatigue] table; add one with a criterion and a limit")
    return table


def _evaluate(
    laws: Sequence[Laws], cycles: Sequence[np.ndarray], steel: LocalSteel
) -> tuple[tuple[np.ndarray, np.ndarray, np.ndarray], list[np.ndarray]]:
    """Return ((path radius, residual shear, yield factor), utilisation in each pass) of cycles.

    Returns
    -------
    found : tuple of ndarray
        `enclosing_radius`, `residual_shear` and `LocalSteel.inverse_yield_factor` of the path
        through all cycles. A constant stress changes neither of the first two: residual stress of
        the material is one of those among which shakedown finds the best.
    utilisations : list of ndarray
        Utilisation in each pass; empty without a criterion.
    """
    path = cycles[0] if len(cycles) == 1 else np.concatenate(cycles, axis=1)
    utilisations = []
    radius = None
    for law, cycle in zip(laws, cycles, strict=True):
        if law.fatigue is not None:
            value, radius = steel.evaluate(law.fatigue, cycle)
            utilisations.append(np.maximum(value, 0.0) / steel.stack_limit)
    if radius is None or len(cycles) > 1:
        radius = enclosing_radius(path)
    factor = steel.inverse_yield_factor(path) if steel.has_factor else 0.0 * radius
    return (radius, residual_shear(path), factor), utilisations


def layer_cycles(
    contact: State,
    depths: np.ndarray,
    laws: Laws,
    half_width: float | None = None,
    spaces: int = 12,
) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Yield (x of the layer, x outside it, stress paths) for each depth below the surface.

    Parameters
    ----------
    contact : State
        The solved contact.
    depths : ndarray, shape (k,)
        Ascending from 0, mm.
    laws : Laws
        Laws of the bodies.
    half_width : float, optional
        Half width of the contact in x that determines the length of layers, mm; by default of this
        contact.
    spaces : int
        See `_columns`: with 12 the error of a criterion from maxima outside the layers is 1e-3,
        with 8 it is 3e-3.

    Yields
    ------
    x, columns : ndarray, shapes (n,) and (2 spaces - 2,)
        Positions on the layer, ascending, and ahead of it and behind it, mm.
    cycles : ndarray, shape (bodies, 6, n + 2 spaces - 1, n_y)
        Stress at these positions, and then none, MPa.
    """
    # Few lengths of layers: transforms are cached for each, also while wear changes the contact.
    lengths, multiple = 3, 4
    grid, bodies = contact.grid, fatigue_table(contact).bodies
    # The shear stress is largest ahead and behind the contact at a distance of about the depth.
    part = np.ceil(depths[1:] / depths[-1] * lengths) / lengths
    # At this distance the first columns are an element apart.
    distance = np.maximum(part * depths[-1], 0.5 * spaces * grid.dx)
    half_width = contact.half_width_x if half_width is None else half_width
    needed = half_width + distance - grid.half_length[0]
    beyond = np.maximum(0, multiple * np.ceil(needed / grid.dx / multiple)).astype(int)
    load = LoadedBodies.from_contact(contact, bodies, laws, residual=False)
    for more, together in groupby(zip(beyond, depths[1:], strict=True), lambda pair: pair[0]):
        group = np.array([depth for _, depth in together])
        x = _columns(grid, half_width, int(more), group[0], spaces)
        outside = load.in_contact_axes(load.source.at_columns(x, group))
        layer_x = grid.lengthened(int(more)).x
        elements = grid.elements[0] + 2 * int(more)
        layers = stress_layers(contact, group, bodies, int(more), laws=laws, residual=False)
        for k, (_, stress) in enumerate(layers):
            # In memory path by path, as the kernels need them.
            paths = np.zeros((len(bodies), stress.shape[3], 6, elements + x.size + 1))
            paths[..., :elements] = stress.transpose(0, 3, 1, 2)
            paths[..., elements:-1] = outside[..., k].transpose(0, 3, 1, 2)
            yield layer_x, x, paths.transpose(0, 2, 3, 1)


def _columns(grid: Grid, half_width: float, more: int, depth: float, spaces: int) -> np.ndarray:
    """Return x of the sparse points ahead of and behind a layer of stress paths, mm.

    Friction causes tension behind the contact, and the hydrostatic tension of a deep point has its
    maximum at a distance of some depths over the friction coefficient. At the distance s from a
    line contact the stress is proportional to 1/s. The error of a maximum is proportional to the
    square of the spacing over s³: with columns equally spaced in 1/sqrt(s) it does not depend on s,
    and a few columns cover the stress. Outside an ellipse the stress is proportional to 1/s², and
    the error to 1/s.

    Parameters
    ----------
    grid : Grid
        The mesh.
    half_width : float
        Half width of the contact in x, mm.
    more : int
        Elements by which the layer extends beyond the mesh.
    depth : float
        Smallest depth of the columns, mm.
    spaces : int
        Number of spaces between the end of the layer and infinity.
    """
    end = grid.half_length[0] + (more - 0.5) * grid.dx
    nearest = end - half_width + depth
    x = end + nearest * ((spaces / np.arange(spaces - 1, 0, -1)) ** 2 - 1.0)
    return grid.centre[0] + np.concatenate((x, -x))


def _surface_cycles(contact: State, laws: Laws) -> Iterator[tuple[str, np.ndarray, np.ndarray]]:
    """Yield (body, stress cycles at its surface, mask of valid rows) for each body.

    A point of the surface passes the contact along a row of element corners: the cycles have the
    shape (6, n, m), with stress components, n positions in x, the last one unloaded, and m rows. A
    row that only touches the edge of the contact is not valid.
    """
    grid, bodies = contact.grid, fatigue_table(contact).bodies
    load = LoadedBodies.from_contact(contact, bodies, laws)
    lattice = Lattice(grid.elements, grid.dx, grid.dy)
    for name, body in zip(bodies, load.bodies, strict=True):
        sign = SIGNS[name]
        cycle, is_valid = surface_cycles(
            lattice, cast(HalfSpaces, body), load.tractions, sign, contact.sliding
        )
        unloaded = np.zeros((6, 1, cycle.shape[2]))
        cycle = np.concatenate((cycle, unloaded), axis=1)
        cycle[4:] *= sign  # in the axes of the contact
        yield name, cycle, is_valid


def average_rows(values: np.ndarray, is_valid: np.ndarray, below: np.ndarray) -> np.ndarray:
    """Return the mean of the valid corner rows beside each row; `below` where neither is valid."""
    if values.size == below.size:  # a line
        return np.where(is_valid, values, below)
    count = np.zeros(below.size)
    total = np.zeros(below.size)
    for rows in (slice(None, -1), slice(1, None)):
        count[rows] += is_valid
        total[rows] += np.where(is_valid, values, 0.0)
    return np.divide(total, count, out=below.copy(), where=count > 0.0)


@dataclass(frozen=True, eq=False, repr=False)
class Course(ShortArrays):
    """Sequence of contacts that material passes, with the rolling distance at each of them.

    Attributes
    ----------
    contacts : sequence of State
        Solved contacts on one mesh.
    places : ndarray, shape (k,)
        Rolling distance at each contact, mm; 0 if the bodies shift.
    laws : Laws
        Criterion and bodies.
    rolls : bool
        Whether the material is unloaded before it enters the contact.
    steady : bool
        Whether steady rolling under the first contact precedes the sequence.
    paths : int
        Largest number of stress values in memory.

    Examples
    --------
    >>> course = Course([contact, contact], np.array([0.0, 0.1]), ts.Laws.of(contact.scene))
    >>> course.rolls, course.steady
    (True, False)
    """

    contacts: Sequence[State]
    places: np.ndarray
    laws: Laws
    rolls: bool = True
    steady: bool = False
    paths: int = 2**22

    def steps(self, away: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return (rolling distances, contact indices) of the sequence, with `away` if it rolls.

        If the bodies roll, the last contact continues with its tractions, and with `steady` the
        first contact precedes with its tractions.

        Parameters
        ----------
        away : ndarray, shape (n,)
            Rolling distances before and after the sequence, ascending, mm.

        Returns
        -------
        positions : ndarray, shape (m,)
            Rolling distances, mm.
        numbers : ndarray of int, shape (m,)
            Contact at each of them.
        """
        number = np.arange(self.places.size)
        if not self.rolls:
            return self.places, number
        none = np.zeros(away.size, int)
        places, numbers = [self.places, self.places[-1] + away], [number, none + number[-1]]
        if self.steady:
            places, numbers = [self.places[0] - away[::-1], *places], [none, *numbers]
        return np.concatenate(places), np.concatenate(numbers)


def course_fatigue(course: Course, depths: np.ndarray) -> dict[str, tuple[BodyFatigue, np.ndarray]]:
    """Return by body (fatigue in a sequence of contacts, x of the worst point by row and depth).

    The sequence is one cycle of every point. The results are the largest utilisation and the
    largest ball of all points of a row and a depth.

    Parameters
    ----------
    course : Course
        Contacts of a scene with [fatigue].
    depths : ndarray, shape (n,)
        Ascending from 0, mm.

    Returns
    -------
    dict of str to (BodyFatigue, ndarray of shape (n_y, n))
        By body: the fatigue, and the position x of the point with the largest utilisation, mm; if
        the bodies roll, its position in the contact at the distance 0.

    Examples
    --------
    >>> tired = ts.solve(scene.replace(fatigue={"shear_yield": 300.0, "bodies": ["A"]}))
    >>> course = Course([tired, tired], np.array([0.0, 0.1]), ts.Laws.of(tired.scene))
    >>> depths = cycle_depths(tired)[::20]
    >>> worst, place = course_fatigue(course, depths)["A"]
    >>> worst.residual_shear.shape == place.shape == (tired.grid.elements[1], depths.size)
    True
    """
    first = course.contacts[0]
    table, grid = fatigue_table(first), first.grid
    shape = len(table.bodies), grid.elements[1], depths.size
    used, place = np.full(shape, np.nan), np.full(shape, np.nan)
    residual, radius, factor = np.zeros(shape), np.zeros(shape), np.zeros(shape)
    new = np.zeros(grid.elements[1])  # a course wears less than a turn of its bodies
    at = depths, new, course.laws
    steel = [LocalSteel.from_contact(first, body, *at) for body in table.bodies]
    half_width = max(contact.half_width_x for contact in course.contacts)
    layers = (layer_cycles(contact, depths, course.laws, half_width) for contact in course.contacts)
    for k, at_depth in enumerate(zip(*layers, strict=True), 1):
        x, columns, _ = at_depth[0]
        for i in range(len(table.bodies)):
            cycles = np.stack([layer[i] for _, _, layer in at_depth])
            residual[i, :, k] = residual_shear(np.concatenate(cycles, axis=1))
            for rows, material, paths in _paths(course, x, columns, cycles, grid.dx):
                here = steel[i].at_depth(k).of_rows(rows)
                largest = _worst(course.laws, paths, material, here)
                radius[i, rows, k], used[i, rows, k], place[i, rows, k], factor[i, rows, k] = (
                    largest
                )
    for i, body in enumerate(table.bodies):
        is_valid, *at_surface = _surface(course, body, steel[i].at_depth(0, at_corners=True))
        fields = residual, radius, used, place, factor
        for values, all_rows in zip(at_surface, fields, strict=True):
            all_rows[i, :, 0] = average_rows(values, is_valid, all_rows[i, :, 1])
    shear_yield = table.shear_yield_stress
    about = course.laws.fatigue, math.nan if shear_yield is None else shear_yield
    y = grid.shifted(0.0).y
    results: dict[str, tuple[BodyFatigue, np.ndarray]] = {}
    for i, body in enumerate(table.bodies):
        utilisation = np.maximum(used[i], 0.0) / steel[i].stack_limit
        of_body = steel[i].profiles(depths, utilisation[None])[0], residual[i], radius[i]
        further = steel[i].fields(factor[i])
        results[body] = BodyFatigue(body, y, depths, *of_body, *about, **further), place[i]
    return results


def _worst(
    laws: Laws, path: np.ndarray, material: np.ndarray, steel: LocalSteel
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return (largest radius, criterion, its position, yield factor) by row; nan without criterion.

    Parameters
    ----------
    laws : Laws
        Criterion.
    path : ndarray, shape (6, m, rows, points)
        Stress of each point.
    material : ndarray, shape (points,)
        Positions of the points, mm.
    steel : LocalSteel
        Material of the rows.
    """
    factor = np.zeros(path.shape[2])
    if steel.has_factor:
        factor = steel.inverse_yield_factor(path).max(axis=1)
    if laws.fatigue is None:
        radius, none = enclosing_radius(path), np.full(path.shape[2], np.nan)
        return radius.max(axis=1), none, none, factor
    value, radius = steel.evaluate(laws.fatigue, path)
    worst = value.argmax(axis=1)
    return radius.max(axis=1), value.max(axis=1), material[worst], factor


def _paths(
    course: Course, x: np.ndarray, columns: np.ndarray, cycles: np.ndarray, dx: float
) -> Iterator[tuple[slice, np.ndarray, np.ndarray]]:
    """Yield (rows, positions, stress paths) of material points at one depth, in chunks of rows.

    The stress is interpolated between the positions at which it is computed.

    Parameters
    ----------
    course : Course
        The contacts.
    x, columns : ndarray, shapes (n,) and (c,)
        Positions in the contact: of a layer, ascending, and ahead of it and behind it, mm.
    cycles : ndarray, shape (contacts, 6, n + c + 1, n_y)
        Stress at these positions, and then none.
    dx : float
        Spacing of the points of the material, mm.
    """
    # Over the layer and the columns, which become sparse as the stress changes less.
    far = columns[columns > x[-1]] - x[-1]
    passing = dx * np.arange(1, x.size + 1)
    places, contact = course.steps(np.concatenate((passing, passing[-1] + far)))
    rolled = course.places[-1] - course.places[0]
    material = course.places[0] + x[0] + dx * np.arange(x.size + round(rolled / dx))
    x = np.concatenate((x, columns))
    order = np.argsort(x)
    x = x[order]
    at = np.clip(material - places[:, None], x[0], x[-1])
    after = np.clip(np.searchsorted(x, at), 1, x.size - 1)
    share = (at - x[after - 1]) / (x[after] - x[after - 1])
    before, after = order[after - 1], order[after]
    count = places.size + course.rolls
    rows = max(1, course.paths // (6 * count * material.size))
    for first in range(0, cycles.shape[3], rows):
        part = slice(first, first + rows)
        stress = cycles[..., part]
        paths = np.zeros((6, count, stress.shape[3], material.size))
        for k, (number, low, high) in enumerate(zip(contact, before, after, strict=True)):
            weight, field = share[k][:, None], stress[number]
            values = field[:, low] * (1.0 - weight) + field[:, high] * weight
            paths[:, k] = values.swapaxes(1, 2)
        yield part, material, paths


def _surface(course: Course, body: str, steel: LocalSteel) -> tuple[np.ndarray, ...]:
    """Return (valid rows, residual shear, radius, criterion, its position, factor) at the surface.

    A stress at an edge is assigned to the nearest corner of elements.

    Returns
    -------
    is_valid : ndarray of bool
        Rows with a valid path.
    residual, radius, value, position, factor : ndarray
        Residual shear, largest radius, largest value of the criterion and its position, and
        `LocalSteel.inverse_yield_factor`.
    """
    grid = course.contacts[0].grid
    lattice, sign = Lattice(grid.elements, grid.dx, grid.dy), SIGNS[body]
    surfaces, rows_in_contact = [], []
    for contact in course.contacts:
        load = LoadedBodies.from_contact(contact, (body,), course.laws)
        stress, *at, rows = surface_points(
            lattice, cast(HalfSpaces, load.bodies[0]), load.tractions, sign, contact.sliding
        )
        stress[4:] *= sign  # in the axes of the contact
        surfaces.append((stress, *at))
        rows_in_contact.append(rows)
    in_contact = np.any(rows_in_contact, axis=0)
    corner = grid.x[0] + 0.5 * grid.dx
    places, contact_of = course.steps(grid.dx * np.arange(1, grid.elements[0] + 1))
    moved = np.rint((places - course.places[0]) / grid.dx).astype(int)
    results = np.zeros((5, in_contact.size))
    for j in range(in_contact.size):
        stresses, at = [], []
        for shift, k in zip(moved, contact_of, strict=True):
            stress, column, row = surfaces[k]
            here = row == j
            stresses.append(stress[:, here])
            at.append(column[here] + shift)
        every = np.concatenate(
            [surfaces[k][0][:, surfaces[k][2] == j] for k in range(len(surfaces))], axis=1
        )
        if not every.shape[1]:
            continue
        paths, columns = _grouped(
            np.concatenate(stresses, axis=1), np.concatenate(at), course.rolls
        )
        material = course.places[0] + corner + grid.dx * columns
        row = steel.of_rows(slice(j, j + 1))
        worst = _worst(course.laws, paths[:, :, None], material, row)
        results[:, j] = residual_shear(every[..., None])[0], *(value[0] for value in worst)
    return in_contact, *results


def _grouped(
    stress: np.ndarray, column: np.ndarray, unloaded: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Group stresses by column: (paths (6, m, columns) padded with their last stress, columns).

    Shorter paths end with their last stress again; all begin unloaded, if they are to.
    """
    order = np.argsort(column, kind="stable")
    columns, begin, count = np.unique(column[order], return_index=True, return_counts=True)
    number = np.minimum(np.arange(count.max())[:, None], count - 1)
    paths = stress[:, order[begin + number]]
    if unloaded:
        paths = np.concatenate((np.zeros((6, 1, columns.size)), paths), axis=1)
    return paths, columns
