"""Stress in bodies with layers: that of a homogeneous body, and what the layers add to it.

Waves of traction cause a stress at a depth that is known in closed form (`LayeredBody.stress`). Its
difference from the stress in a homogeneous half-space with the material at this depth is a sum of
exponentials of the wave number, exp(-k d), with heights d of at least half of the first layer. Each
of them has closed forms in space: so waves may be short or long, loads act at any distance, and
without layers the stress is exactly that of a half-space.
"""

from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby
from typing import Any, Literal, cast

import numpy as np

from tractive_sam.kernels.half_space import raised_stress
from tractive_sam.mechanics import (
    HalfSpaces,
    LayeredBody,
    LinearHalfSpaces,
    Material,
    StressCriterion,
    Strips,
)
from tractive_sam.operators import Lattice, extent, transform_quadrant
from tractive_sam.results import COMPONENTS, Grid, InterfaceStress, Point
from tractive_sam.subsurface.sources import (
    PatchStress,
    StripStress,
    largest_at_surface,
    stress_source,
    tractions_on_bodies,
)


def _amplitudes(body: LayeredBody, depths: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return heights and amplitudes of the kernels of `raised_stress` at depths.

    Parameters
    ----------
    body : LayeredBody
        The body.
    depths : ndarray, shape (m,)
        mm.

    Returns
    -------
    heights : ndarray, shape (n,)
        mm.
    amplitudes : ndarray, shape (m, 6, 3, 7, n)
        By depth, component of the stress, load (p_x, p_y, p_n), kernel and height.
    """
    heights, waves = body.stress_images(depths)
    LL, Lz, zL, zz, along, by_pressure, TT, twist = np.moveaxis(waves, 1, 0)
    nu = np.array([material.poisson for material in body.materials(depths)])[:, None]
    # The stress across the waves by their tractions, and by pressure.
    across, across_by_pressure = nu * (along + zL), nu * (by_pressure + zz)
    turned, bent = across + 2.0 * twist - along, by_pressure - across_by_pressure
    one, xx, xy, x, y, xyy, xxy = range(7)
    terms = {
        ("xx", "x"): {x: along, xyy: turned},
        ("xx", "y"): {y: across, xxy: -turned},
        ("xx", "n"): {one: -across_by_pressure, xx: -bent},
        ("yy", "x"): {x: across, xyy: -turned},
        ("yy", "y"): {y: along, xxy: turned},
        ("yy", "n"): {one: -by_pressure, xx: bent},
        ("zz", "x"): {x: zL},
        ("zz", "y"): {y: zL},
        ("zz", "n"): {one: -zz},
        ("xy", "x"): {y: twist, xxy: -turned},
        ("xy", "y"): {x: twist, xyy: -turned},
        ("xy", "n"): {xy: -bent},
        ("xz", "x"): {one: -TT, xx: TT - LL},
        ("xz", "y"): {xy: TT - LL},
        ("xz", "n"): {x: -Lz},
        ("yz", "x"): {xy: TT - LL},
        ("yz", "y"): {one: -LL, xx: LL - TT},
        ("yz", "n"): {y: -Lz},
    }
    amplitudes = np.zeros((depths.size, 6, 3, 7, heights.size))
    for (component, load), kernels in terms.items():
        for kernel, values in kernels.items():
            place = COMPONENTS.index(component), "xyn".index(load), kernel
            amplitudes[:, *place] = values
    return heights, amplitudes / (2.0 * np.pi)


class LayeredStress:
    """Stress solver for bodies with layers, under rectangular elements or strips.

    Parameters
    ----------
    bodies : sequence of LinearHalfSpaces or HalfSpaces
        See `LinearHalfSpaces.single_body`.
    signs : sequence of float
        Sign of each body, see `sources.SIGNS`.
    grid : Grid
        Elements; lengths in mm.
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) on body A, MPa.
    together : int
        Depths at which tables are computed at once.
    """

    together = 8

    def __init__(
        self,
        bodies: Sequence[LinearHalfSpaces | HalfSpaces],
        signs: Sequence[float],
        grid: Grid,
        tractions: np.ndarray,
    ):
        self._bodies, self._signs, self._grid, self._tractions = bodies, signs, grid, tractions
        self._on_bodies = tractions_on_bodies(tractions, signs)
        (datum,) = {getattr(body, "datum", None) for body in bodies}
        self._datum = datum
        self._lattice = Lattice(grid.elements, grid.dx, grid.dy)
        # A homogeneous body is one without layers.
        self._layered = [
            body.A if isinstance(body.A, LayeredBody) else LayeredBody((), cast(Material, body.A))
            for body in bodies
        ]

    def _plain(self, number: int, poisson: float) -> PatchStress | StripStress:
        """Return the stress solver of a body as if it were homogeneous."""
        pair = Material(1.0, poisson), Material(np.inf, poisson)
        of_body = (self._signs[number],), self._grid, self._tractions
        if self._datum is None:
            return PatchStress((HalfSpaces(*pair),), *of_body)
        return StripStress((Strips(*pair, self._datum),), *of_body)

    def _by_material(
        self, number: int, depths: np.ndarray
    ) -> Iterator[tuple[PatchStress | StripStress, np.ndarray]]:
        """Yield (stress solver of the homogeneous body, depths) for runs of one Poisson's ratio."""
        poisson = [material.poisson for material in self._layered[number].materials(depths)]
        for nu, run in groupby(zip(poisson, depths, strict=True), lambda pair: pair[0]):
            yield self._plain(number, nu), np.array([depth for _, depth in run])

    def layers(self, depths: Iterable[float], threads: int = 1) -> Iterator[np.ndarray]:
        """Yield stresses (bodies, 6, n_x, n_y) at the centres of the grid, depth by depth."""
        depths = np.array(list(depths), dtype=float)
        each = [self.of_body(number, depths, threads) for number in range(len(self._bodies))]
        return map(np.stack, zip(*each, strict=True))

    def of_body(self, number: int, depths: np.ndarray, threads: int = 1) -> Iterator[np.ndarray]:
        """Yield the stress (6, n_x, n_y) of a body, depth by depth."""
        plain = (
            stress[0]
            for source, run in self._by_material(number, depths)
            for stress in source.layers(run, threads)
        )
        body, period = self._layered[number], self._lattice.padded
        if not body.layers:
            yield from plain
            return
        loads = np.fft.rfft2(self._on_bodies[number], period)
        nx, ny = self._lattice.shape
        for first in range(0, depths.size, self.together):
            tables = self._tables(body, depths[first : first + self.together])
            for of_depth, stress in zip(tables, plain, strict=False):
                added = np.zeros((6, *loads.shape[1:]), dtype=complex)
                for c, component in enumerate(COMPONENTS):
                    for load, name, table in zip(loads, "xyn", of_depth[c], strict=True):
                        letters = component + name
                        parity = tuple((-1) ** letters.count(axis) for axis in "xy")
                        added[c] += transform_quadrant(table, parity, period) * load
                yield stress + np.fft.irfft2(added, period)[:, :nx, :ny]

    def _tables(self, body: LayeredBody, depths: np.ndarray, columns: int = 12) -> np.ndarray:
        """Return the added stress per unit traction on an element, (m, 6, 3, ...) at offsets >= 0.

        `columns` offsets in x are computed at once.
        """
        heights, amplitudes = _amplitudes(body, depths)
        weights = amplitudes.reshape(-1, 7 * heights.size)
        mx, my = (period // 2 + 1 for period in self._lattice.padded)
        table = np.empty((len(weights), mx, my))
        y = self._grid.dy * (np.arange(my + 1) - 0.5)
        for first in range(0, mx, columns):
            part = slice(first, min(first + columns, mx))
            x = self._grid.dx * (np.arange(part.start, part.stop + 1) - 0.5)
            loads = self._load(x, y, heights).reshape(7 * heights.size, -1)
            table[:, part] = (weights @ loads).reshape(len(weights), -1, my)
        return table.reshape(*amplitudes.shape[:3], mx, my)

    def _load(self, x: np.ndarray, y: np.ndarray, heights: np.ndarray) -> np.ndarray:
        """Return the integrals of kernels over elements between corners x and y, (7, n, k, l)."""
        if self._datum is None:
            values = raised_stress(x[:, None], y, heights[:, None, None])
            return np.diff(np.diff(values, axis=2), axis=3)
        # Of strips that are infinitely long in y; the other kernels are zero.
        loads = np.zeros((7, heights.size, x.size - 1, y.size - 1))
        loads[:2, ..., 0] = np.diff(2.0 * np.arctan(x / heights[:, None]))
        loads[3, ..., 0] = -np.diff(np.log(x**2 + heights[:, None] ** 2))
        return loads

    def on_plane(
        self, axis: Literal["x", "y", "z"], position: float, depths: np.ndarray
    ) -> np.ndarray:
        """Return stresses (bodies, 6, n, k) on a plane at k depths; (bodies, 6, n_x, n_y) if z."""
        if axis == "z":
            return next(self.layers([position]))
        stresses = []
        for number, body in enumerate(self._layered):
            runs = self._by_material(number, depths)
            plain = [source.on_plane(axis, position, run)[0] for source, run in runs]
            stress = np.concatenate(plain, axis=-1)
            if body.layers:
                stress += self._added_to_lines(number, axis, np.array([position]), depths)[:, 0]
            stresses.append(stress)
        return np.stack(stresses)

    def _added(self, number: int, place: np.ndarray, depths: np.ndarray) -> np.ndarray:
        """Return the stress (6, k) that layers add at a place (x, y), and k depths."""
        heights, amplitudes = _amplitudes(self._layered[number], depths)
        loaded = self._on_bodies[number].any(axis=0)
        part = extent(loaded.any(axis=1)), extent(loaded.any(axis=0))
        loads = self._on_bodies[number][:, *part]
        centres, sides = (self._grid.x, self._grid.y), (self._grid.dx, self._grid.dy)
        # From the last corner to the first one, so that the place minus corners ascends.
        x, y = (
            at - c[here][0] - side * (np.arange(here.stop - here.start, -1, -1) - 0.5)
            for at, c, side, here in zip(place, centres, sides, part, strict=True)
        )
        fields = np.einsum("khij,lij->klh", self._load(x, y, heights), loads[:, ::-1, ::-1])
        return np.einsum("mclkh,klh->cm", amplitudes, fields)

    def at(self, points: np.ndarray) -> np.ndarray:
        """Return stresses (bodies, 6, n) at points (n, 3)."""
        stress = np.empty((len(self._bodies), 6, len(points)))
        for number, body in enumerate(self._layered):
            poisson = np.array([material.poisson for material in body.materials(points[:, 2])])
            for nu in set(poisson):
                here = poisson == nu
                stress[number][:, here] = self._plain(number, nu).at(points[here])[0]
            for place in np.unique(points[:, :2], axis=0) if body.layers else ():
                here = (points[:, :2] == place).all(axis=1)
                stress[number][:, here] += self._added(number, place, points[here, 2])
        return stress

    def at_columns(self, x: np.ndarray, depths: np.ndarray) -> np.ndarray:
        """Return stresses (bodies, 6, n_x, n_y, k) at x (n_x,) beyond the grid and k depths."""
        stresses = []
        for number, body in enumerate(self._layered):
            runs = self._by_material(number, depths)
            plain = [source.at_columns(x, run)[0] for source, run in runs]
            stress = np.concatenate(plain, axis=-1)
            if body.layers:
                stress += self._added_to_lines(number, "x", x, depths, 24)
            stresses.append(stress)
        return np.stack(stresses)

    def _added_to_lines(
        self,
        number: int,
        axis: Literal["x", "y"],
        places: np.ndarray,
        depths: np.ndarray,
        blocks: int = 10**6,
    ) -> np.ndarray:
        """Return the stress (6, n, m, k) that layers add on lines of the grid at k depths.

        Lines at x = places (n,) are along y, through the m rows of elements; those at y = places
        are along x. Elements are combined across the lines to at most `blocks`.
        """
        heights, amplitudes = _amplitudes(self._layered[number], depths)
        across, loads = (0, self._on_bodies[number])
        if axis == "y":
            across, loads = (1, loads.swapaxes(1, 2))
        centres, (step, along) = (
            (self._grid.x, self._grid.y)[across],
            (self._grid.dx, self._grid.dy),
        )
        if axis == "y":
            step, along = along, step
        here = extent(loads.any(axis=(0, 2)))
        block = -(-(here.stop - here.start) // blocks)
        loads = loads[:, here]
        loads = np.pad(loads, ((0, 0), (0, -loads.shape[1] % block), (0, 0)))
        loads = loads.reshape(3, -1, block, loads.shape[2]).mean(axis=2)
        rows, period = loads.shape[2], self._lattice.padded[1 - across]
        edges = centres[here.start] + step * (block * np.arange(loads.shape[1] + 1) - 0.5)
        offsets = along * (np.arange(1 - rows, rows + 1) - 0.5)
        spectra = np.fft.rfft(loads[:, ::-1], period).transpose(2, 1, 0)
        stress = np.empty((6, len(places), rows, depths.size))
        for n, place in enumerate(places):
            if axis == "x":
                of_blocks = self._load(place - edges[::-1], offsets, heights)
            else:
                of_blocks = self._load(offsets, place - edges[::-1], heights).swapaxes(2, 3)
            table = np.zeros((7 * heights.size, loads.shape[1], period))
            table[..., np.arange(1 - rows, rows)] = of_blocks.reshape(*table.shape[:2], -1)
            waves = np.fft.rfft(table).transpose(2, 0, 1) @ spectra
            fields = np.fft.irfft(waves, period, axis=0)[:rows].reshape(rows, 7, heights.size, 3)
            stress[:, n] = np.einsum("mclkh,nkhl->cnm", amplitudes, fields, optimize=True)
        return stress

    def levels(self, criterion: StressCriterion) -> "LayeredLevels":
        """Return the `LayeredLevels` of the bodies, in which the largest stress is searched."""
        of_bodies = self._bodies, self._signs, self._grid, self._tractions
        return LayeredLevels(self, of_bodies, self._layered, criterion)


@stress_source.register
def _layered_stress(body: LinearHalfSpaces, *of_bodies) -> LayeredStress:
    """Return the stress solver for bodies with layers."""
    return LayeredStress(*of_bodies)


def with_interfaces(depths: np.ndarray, bodies: Iterable[object]) -> np.ndarray:
    """Return depths with those on both sides of interfaces, and one within each layer at least.

    The lower side is a part in 1e9 deeper: an interface belongs to the layer above it.

    Parameters
    ----------
    depths : ndarray, shape (n,)
        Ascending, mm.
    bodies : iterable
        Bodies; only each `LayeredBody` counts, with its interfaces above the last depth.

    Returns
    -------
    ndarray, shape (m,)
        Ascending, mm.

    Examples
    --------
    >>> from tractive_sam.subsurface import with_interfaces
    >>> hard = ts.Layer(0.01, ts.Material(1e5, 0.3))
    >>> with_interfaces(np.array([0.0, 0.5]), [ts.LayeredBody((hard,), hard.material)])
    array([0.   , 0.005, 0.01 , 0.01 , 0.5  ])
    """
    for body in bodies:
        top = 0.0
        for face in body.interfaces if isinstance(body, LayeredBody) else ():
            if face >= depths[-1]:
                break
            inside = ((depths > top * (1.0 + 2e-9)) & (depths < face)).any()
            middle = [] if inside else [0.5 * (top + face)]
            depths = np.unique([*depths, *middle, face, face * (1.0 + 1e-9)])
            top = face
    return depths


class LayeredLevels:
    """Stress below a contact of bodies with layers, to search its maximum.

    The depths are in geometric sequence, with both sides of each interface. The largest value of
    the mesh is raised to the top of parabolas through its neighbours in the same material.

    Parameters
    ----------
    source : LayeredStress
        Solver of the stress.
    of_bodies : tuple
        Its bodies, signs, grid and tractions.
    layered : sequence of LayeredBody
        Layers of the bodies, if any.
    criterion : StressCriterion
        Criterion of the stress.
    """

    def __init__(
        self,
        source: LayeredStress,
        of_bodies: tuple[Sequence[Any], Sequence[float], Grid, np.ndarray],
        layered: Sequence[LayeredBody],
        criterion: StressCriterion,
    ):
        self._source, self._layered, self._criterion = source, layered, criterion
        self._bodies, self._signs, self._grid, self._tractions = of_bodies

    def surface(self, sliding: np.ndarray) -> list[tuple[float, Point]]:
        """Return (value, position) of the largest stress at the surface of each body."""
        grid = self._grid
        lattice, first = Lattice(grid.elements, grid.dx, grid.dy), float(grid.y[0])
        loads = self._bodies, self._signs, self._tractions
        largest = largest_at_surface(lattice, *loads, sliding, self._criterion, first)
        x, y = float(grid.x[0]), 0.0 if grid.elements[1] == 1 else first
        return [(v, (x + i * grid.dx, y + j * grid.dy, 0.0)) for v, i, j in largest]

    def interior(self, surface: Sequence[float]) -> list[tuple[float, Point]]:
        """Return (value, position) of the largest stress below each body's surface; nan if none.

        Parameters
        ----------
        surface : sequence of float
            Largest stress at each body's surface, MPa: where the stress rises towards it there is
            no maximum below.
        """
        grid, loaded = self._grid, self._tractions[2] != 0.0
        side = max(grid.sides)
        counts = (np.count_nonzero(loaded.any(axis=axis)) for axis in (1, 0))
        half = 0.5 * min(n * of for n, of in zip(counts, grid.sides, strict=False))
        depths = np.geomspace(2.0 * side, max(1.6 * half, 4.0 * side), 18)
        depths = with_interfaces(depths, self._layered)
        number, rows = np.arange(len(self._bodies))[:, None, None], grid.y
        values = np.stack(
            [
                self._criterion.at(stress.swapaxes(0, 1), number, rows, depth)
                for depth, stress in zip(depths, self._source.layers(depths), strict=True)
            ],
            axis=1,
        )
        return [
            self._top(body, depths, of_body, at_surface)
            for body, of_body, at_surface in zip(self._layered, values, surface, strict=True)
        ]

    def interfaces(self) -> list[tuple[InterfaceStress, ...]]:
        """Return the largest stresses on the interfaces of each body, from the surface down."""
        each = []
        for number, body in enumerate(self._layered):
            faces = []
            for k, stress in enumerate(self._source.of_body(number, body.interfaces)):
                place = body.interfaces[k : k + 1]
                shear = self._top(body, place, np.hypot(stress[4], stress[5])[None], -np.inf)
                tension = self._top(body, place, stress[None, 2], -np.inf)
                faces.append(InterfaceStress(*shear, *tension))
            each.append(tuple(faces))
        return each

    def _top(
        self, body: LayeredBody, depths: np.ndarray, values: np.ndarray, at_surface: float
    ) -> tuple[float, Point]:
        """Return (value, position) of the largest of values (depths, n_x, n_y)."""
        top = tuple(int(k) for k in np.unravel_index(values.argmax(), values.shape))
        if top[0] == 0 and values[top] <= at_surface:
            return np.nan, (np.nan, np.nan, np.nan)
        places, value = [], float(values[top])
        for axis, at in enumerate((depths, self._grid.x, self._grid.y)):
            k, near = top[axis], slice(top[axis] - 1, top[axis] + 2)
            materials = np.searchsorted(body.interfaces, at[near]) if axis == 0 else [0]
            if not 0 < k < at.size - 1 or len(set(materials)) > 1:
                places.append(float(at[k]))
                continue
            line = np.moveaxis(values, axis, -1)[top[:axis] + top[axis + 1 :]][near]
            bend, slope, _ = np.polyfit(at[near] - at[k], line - line[1], 2)
            step = -0.5 * slope / bend if bend < 0.0 else 0.0
            places.append(float(at[k] + step))
            value += float(slope * step + bend * step**2)
        depth, x, y = places
        return value, (x, y, depth)
