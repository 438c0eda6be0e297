"""Stress in bodies with layers: that of a homogeneous body, and what the layers add to it.

Waves of traction cause a stress at a depth that is known in closed form (`LayeredBody.stress`). Its
difference from the stress in a homogeneous half-space with the material at this depth is a sum of
exponentials of the wave number, exp(-k d), with heights d of at least half of the first layer. Each
of them has closed forms in space: so waves may be short or long, loads act at any distance, and
without layers the stress is exactly that of a half-space.
"""

from collections.abc import Iterable, Iterator, Sequence
from itertools import chain, groupby
from typing import Any, Literal, cast

import numpy as np

from tractive_sam.kernels.half_space import raised_stress
from tractive_sam.mechanics import (
    Elasticity,
    HalfSpaces,
    LayeredBody,
    LinearHalfSpaces,
    Material,
    StressCriterion,
    Strips,
)
from tractive_sam.operators import Lattice, extent, transform_quadrants
from tractive_sam.results import COMPONENTS, Grid, InterfaceStress, Point
from tractive_sam.subsurface.sources import (
    PatchStress,
    StressSource,
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


class ElementSums:
    """Stress solver for one body by functions of the distance from loaded elements.

    A subclass has the functions (`functions`) and their spectra (`spectra`).

    Parameters
    ----------
    bodies : (LinearHalfSpaces,)
        The body, see `LinearHalfSpaces.single_body`.
    signs : (float,)
        Its sign, see `sources.SIGNS`.
    grid : Grid
        Elements; lengths in mm.
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) on body A, MPa.

    Attributes
    ----------
    interfaces : ndarray
        Depths of interfaces in the body, mm.
    """

    interfaces = np.empty(0)

    def __init__(
        self,
        bodies: tuple[LinearHalfSpaces],
        signs: tuple[float],
        grid: Grid,
        tractions: np.ndarray,
    ):
        self._of_bodies = bodies, signs, grid, tractions
        (self._body,), self._signs = bodies, signs
        self._grid, self._tractions = grid, tractions
        (self._on_body,) = tractions_on_bodies(tractions, signs)
        self._lattice = Lattice(grid.elements, grid.dx, grid.dy)

    def functions(
        self, x: np.ndarray, y: np.ndarray, depths: np.ndarray
    ) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Yield functions of elements, and their weights, for successive depths.

        Parameters
        ----------
        x, y : ndarray, shapes (k + 1,) and (l + 1,)
            Ascending distances from the corners of elements, mm; of strips only x counts.
        depths : ndarray, shape (m,)
            mm.

        Yields
        ------
        functions : ndarray, shape (f, k, l)
            The same at the next n depths.
        weights : ndarray, shape (n, 6, 3, f)
            By depth, component and traction (p_x, p_y, p_n): their sum is the stress by a unit
            traction on the element.
        """
        raise NotImplementedError

    def spectra(self, depths: np.ndarray) -> Iterator[np.ndarray]:
        """Yield the spectrum of the stress by a unit traction (6, 3, ...), depth by depth."""
        raise NotImplementedError

    def layers(self, depths: Iterable[float], threads: int = 1) -> Iterator[np.ndarray]:
        """Yield stresses (1, 6, n_x, n_y) at the centres of the grid, depth by depth."""
        loads = np.fft.rfft2(self._on_body, self._lattice.padded)
        nx, ny = self._lattice.shape
        for waves in self.spectra(np.array(list(depths), dtype=float)):
            added = waves[:, 0] * loads[0] + waves[:, 1] * loads[1] + waves[:, 2] * loads[2]
            yield np.fft.irfft2(added, self._lattice.padded)[None, :, :nx, :ny]

    def levels(self, criterion: StressCriterion) -> "LayeredLevels":
        """Return the `LayeredLevels` of the body, in which the largest stress is searched."""
        return LayeredLevels([self], self._of_bodies, criterion)

    def on_plane(
        self, axis: Literal["x", "y", "z"], position: float, depths: np.ndarray
    ) -> np.ndarray:
        """Return stresses (1, 6, n, k) on a plane at k depths; (1, 6, n_x, n_y) if z."""
        if axis == "z":
            return next(self.layers([position]))
        return self._on_lines(axis, np.array([position]), depths)[None, :, 0]

    def at(self, points: np.ndarray) -> np.ndarray:
        """Return stresses (1, 6, n) at points (n, 3)."""
        stress = np.empty((1, 6, len(points)))
        for place in np.unique(points[:, :2], axis=0):
            here = (points[:, :2] == place).all(axis=1)
            stress[0][:, here] = self._at_place(place, points[here, 2])
        return stress

    def _at_place(self, place: np.ndarray, depths: np.ndarray) -> np.ndarray:
        """Return the stress (6, k) at a place (x, y), and k depths."""
        loads, (x, y) = self._loads_around(place)
        parts = []
        for functions, weights in self.functions(x, y, depths):
            fields = np.einsum("fij,lij->lf", functions, loads)
            parts.append(np.einsum("mclf,lf->cm", weights, fields))
        return np.concatenate(parts, axis=1)

    def _loads_around(self, place: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
        """Return tractions (3, k, l) in reverse order, and distances of a place from corners."""
        loaded = self._on_body.any(axis=0)
        part = extent(loaded.any(axis=1)), extent(loaded.any(axis=0))
        centres, sides = (self._grid.x, self._grid.y), (self._grid.dx, self._grid.dy)
        # From the last corner to the first one, so that the place minus corners ascends.
        distances = [
            at - c[here][0] - side * (np.arange(here.stop - here.start, -1, -1) - 0.5)
            for at, c, side, here in zip(place, centres, sides, part, strict=True)
        ]
        return self._on_body[:, *part][:, ::-1, ::-1], distances

    def at_columns(self, x: np.ndarray, depths: np.ndarray) -> np.ndarray:
        """Return stresses (1, 6, n_x, n_y, k) at x (n_x,) beyond the grid and k depths."""
        return self._on_lines("x", x, depths, 24)[None]

    def _on_lines(
        self,
        axis: Literal["x", "y"],
        places: np.ndarray,
        depths: np.ndarray,
        blocks: int = 10**6,
    ) -> np.ndarray:
        """Return the stress (6, n, m, k) on lines of the grid at k depths.

        Lines at x = places (n,) are along y, through the m rows of elements; those at y = places
        are along x. Elements are combined across the lines to at most `blocks`.
        """
        across, loads = (0, self._on_body)
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
            x, y = place - edges[::-1], offsets
            if axis == "y":
                x, y = y, x
            first = 0
            for functions, weights in self.functions(x, y, depths):
                of_blocks = functions.swapaxes(1, 2) if axis == "y" else functions
                table = np.zeros((len(of_blocks), loads.shape[1], period))
                table[..., np.arange(1 - rows, rows)] = of_blocks
                waves = np.fft.rfft(table).transpose(2, 0, 1) @ spectra
                fields = np.fft.irfft(waves, period, axis=0)[:rows]
                found = np.einsum("mclf,nfl->cnm", weights, fields, optimize=True)
                stress[:, n, :, first : first + len(weights)] = found
                first += len(weights)
        return stress


class LayeredStress(ElementSums):
    """Stress solver for a body with layers, under rectangular elements or strips.

    Parameters as in `ElementSums`.

    Attributes
    ----------
    together : int
        Depths at which tables are computed at once.
    """

    together = 8

    def __init__(
        self,
        bodies: tuple[LinearHalfSpaces],
        signs: tuple[float],
        grid: Grid,
        tractions: np.ndarray,
    ):
        super().__init__(bodies, signs, grid, tractions)
        self._layered = cast(LayeredBody, self._body.A)
        self.interfaces = self._layered.interfaces

    def _plain(self, poisson: float) -> PatchStress | StripStress:
        """Return the stress solver of the body as if it were homogeneous."""
        pair = Material(1.0, poisson), Material(np.inf, poisson)
        of_body = self._signs, self._grid, self._tractions
        if self._body.datum is None:
            return PatchStress((HalfSpaces(*pair),), *of_body)
        return StripStress((Strips(*pair, self._body.datum),), *of_body)

    def _by_material(
        self, depths: np.ndarray
    ) -> Iterator[tuple[PatchStress | StripStress, np.ndarray]]:
        """Yield (stress solver of the homogeneous body, depths) for runs of one Poisson's ratio."""
        poisson = [material.poisson for material in self._layered.materials(depths)]
        for nu, run in groupby(zip(poisson, depths, strict=True), lambda pair: pair[0]):
            yield self._plain(nu), np.array([depth for _, depth in run])

    def layers(self, depths: Iterable[float], threads: int = 1) -> Iterator[np.ndarray]:
        """Yield stresses (1, 6, n_x, n_y) at the centres of the grid, depth by depth."""
        depths = np.array(list(depths), dtype=float)
        runs = (source.layers(run, threads) for source, run in self._by_material(depths))
        return map(np.add, chain.from_iterable(runs), super().layers(depths))

    def spectra(self, depths: np.ndarray) -> Iterator[np.ndarray]:
        """Yield the spectrum of the stress that layers add (6, 3, ...), depth by depth."""
        period = self._lattice.padded
        for first in range(0, depths.size, self.together):
            for of_depth in self._tables(depths[first : first + self.together]):
                waves = np.empty((6, 3, period[0], period[1] // 2 + 1), dtype=complex)
                for c, component in enumerate(COMPONENTS):
                    for load, name in enumerate("xyn"):
                        letters = component + name
                        parity = tuple((-1) ** letters.count(axis) for axis in "xy")
                        waves[c, load] = transform_quadrants([(of_depth[c, load], parity)], period)
                yield waves

    def _tables(self, depths: np.ndarray, columns: int = 12) -> np.ndarray:
        """Return the added stress per unit traction on an element, (m, 6, 3, ...) at offsets >= 0.

        `columns` offsets in x are computed at once.
        """
        mx, my = (period // 2 + 1 for period in self._lattice.padded)
        table = np.empty((depths.size, 6, 3, mx, my))
        y = self._grid.dy * (np.arange(my + 1) - 0.5)
        for first in range(0, mx, columns):
            part = slice(first, min(first + columns, mx))
            x = self._grid.dx * (np.arange(part.start, part.stop + 1) - 0.5)
            ((functions, weights),) = self.functions(x, y, depths)
            values = weights.reshape(-1, len(functions)) @ functions.reshape(len(functions), -1)
            table[..., part, :] = values.reshape(*table.shape[:3], -1, my)
        return table

    def functions(
        self, x: np.ndarray, y: np.ndarray, depths: np.ndarray
    ) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Yield kernels by height, and their weights at all depths (`ElementSums.functions`)."""
        heights, amplitudes = _amplitudes(self._layered, depths)
        if self._body.datum is None:
            values = raised_stress(x[:, None], y, heights[:, None, None])
            loads = np.diff(np.diff(values, axis=2), axis=3)
        else:
            # Of strips that are infinitely long in y; the other kernels are zero.
            loads = np.zeros((7, heights.size, x.size - 1, y.size - 1))
            loads[:2, ..., 0] = np.diff(2.0 * np.arctan(x / heights[:, None]))
            loads[3, ..., 0] = -np.diff(np.log(x**2 + heights[:, None] ** 2))
        weights = amplitudes.reshape(*amplitudes.shape[:3], -1)
        yield loads.reshape(-1, *loads.shape[2:]), weights

    def on_plane(
        self, axis: Literal["x", "y", "z"], position: float, depths: np.ndarray
    ) -> np.ndarray:
        """Return stresses (1, 6, n, k) on a plane at k depths; (1, 6, n_x, n_y) if z."""
        if axis == "z":
            return next(self.layers([position]))
        plain = [s.on_plane(axis, position, run) for s, run in self._by_material(depths)]
        return np.concatenate(plain, axis=-1) + super().on_plane(axis, position, depths)

    def at(self, points: np.ndarray) -> np.ndarray:
        """Return stresses (1, 6, n) at points (n, 3)."""
        stress = super().at(points)
        poisson = np.array([material.poisson for material in self._layered.materials(points[:, 2])])
        for nu in set(poisson):
            here = poisson == nu
            stress[..., here] += self._plain(nu).at(points[here])
        return stress

    def at_columns(self, x: np.ndarray, depths: np.ndarray) -> np.ndarray:
        """Return stresses (1, 6, n_x, n_y, k) at x (n_x,) beyond the grid and k depths."""
        plain = [source.at_columns(x, run) for source, run in self._by_material(depths)]
        return np.concatenate(plain, axis=-1) + super().at_columns(x, depths)


class StressOfEach:
    """Stress solver for bodies of any kind, by a solver for each of them.

    Parameters
    ----------
    bodies, signs, grid, tractions
        See `sources.stress_source`.
    """

    def __init__(
        self,
        bodies: Sequence[Elasticity],
        signs: Sequence[float],
        grid: Grid,
        tractions: np.ndarray,
    ):
        self._of_bodies = bodies, signs, grid, tractions
        self._sources = [
            stress_source(body, (body,), (sign,), grid, tractions)
            for body, sign in zip(bodies, signs, strict=True)
        ]

    def layers(self, depths: Iterable[float], threads: int = 1) -> Iterator[np.ndarray]:
        """Yield stresses (bodies, 6, n_x, n_y) at the centres of the grid, depth by depth."""
        depths = list(depths)
        each = [source.layers(depths, threads) for source in self._sources]
        return map(np.concatenate, zip(*each, strict=True))

    def on_plane(
        self, axis: Literal["x", "y", "z"], position: float, depths: np.ndarray
    ) -> np.ndarray:
        """Return stresses (bodies, 6, n, k) on a plane at k depths; (bodies, 6, n_x, n_y) if z."""
        return np.concatenate([s.on_plane(axis, position, depths) for s in self._sources])

    def at(self, points: np.ndarray) -> np.ndarray:
        """Return stresses (bodies, 6, n) at points (n, 3)."""
        return np.concatenate([source.at(points) for source in self._sources])

    def at_columns(self, x: np.ndarray, depths: np.ndarray) -> np.ndarray:
        """Return stresses (bodies, 6, n_x, n_y, k) at x (n_x,) beyond the grid and k depths."""
        return np.concatenate([source.at_columns(x, depths) for source in self._sources])

    def levels(self, criterion: StressCriterion) -> "LayeredLevels":
        """Return the `LayeredLevels` of the bodies, in which the largest stress is searched."""
        return LayeredLevels(self._sources, self._of_bodies, criterion)


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
    sources : sequence of StressSource
        Solver of the stress in each body.
    of_bodies : tuple
        The bodies, signs, grid and tractions.
    criterion : StressCriterion
        Criterion of the stress.
    """

    def __init__(
        self,
        sources: Sequence[StressSource],
        of_bodies: tuple[Sequence[Any], Sequence[float], Grid, np.ndarray],
        criterion: StressCriterion,
    ):
        self._sources, self._criterion = sources, criterion
        self._faces = [getattr(source, "interfaces", np.empty(0)) for source in sources]
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
        depths = with_interfaces(depths, [getattr(body, "A", None) for body in self._bodies])
        tops = []
        for number, (source, faces) in enumerate(zip(self._sources, self._faces, strict=True)):
            values = np.stack(
                [
                    self._criterion.at(stress[0], np.full((1, 1), number), grid.y, depth)
                    for depth, stress in zip(depths, source.layers(depths), strict=True)
                ]
            )
            tops.append(self._top(faces, depths, values, surface[number]))
        return tops

    def interfaces(self) -> list[tuple[InterfaceStress, ...]]:
        """Return the largest stresses on the interfaces of each body, from the surface down."""
        each = []
        for source, faces in zip(self._sources, self._faces, strict=True):
            found = []
            for k, (stress,) in enumerate(source.layers(faces)):
                place = faces[k : k + 1]
                shear = self._top(faces, place, np.hypot(stress[4], stress[5])[None], -np.inf)
                tension = self._top(faces, place, stress[None, 2], -np.inf)
                found.append(InterfaceStress(*shear, *tension))
            each.append(tuple(found))
        return each

    def _top(
        self, faces: np.ndarray, depths: np.ndarray, values: np.ndarray, at_surface: float
    ) -> tuple[float, Point]:
        """Return (value, position) of the largest of values (depths, n_x, n_y)."""
        top = tuple(int(k) for k in np.unravel_index(values.argmax(), values.shape))
        if top[0] == 0 and values[top] <= at_surface:
            return np.nan, (np.nan, np.nan, np.nan)
        places, value = [], float(values[top])
        for axis, at in enumerate((depths, self._grid.x, self._grid.y)):
            k, near = top[axis], slice(top[axis] - 1, top[axis] + 2)
            materials = np.searchsorted(faces, at[near]) if axis == 0 else [0]
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
