"""Stress in a half-space from tractions on a mesh: layers, vertical planes, strips, surface."""

from collections import OrderedDict
from collections.abc import Callable, Hashable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache, partial
from threading import Lock
from typing import Literal, cast

import numpy as np

from tractive_sam.compute import (
    LayerTransform,
    edge_transform,
    layer_transform,
    padded_length,
    transform,
)
from tractive_sam.kernels.stress import edge_factors
from tractive_sam.kernels.stress_sum import edge_table, layer_product, layer_table, plane_product
from tractive_sam.mechanics import AnisotropicMaterial, HalfSpaces, LinearHalfSpaces, Material
from tractive_sam.operators import elastic
from tractive_sam.operators.elastic import Lattice
from tractive_sam.results import Grid


def extent(occupied: np.ndarray) -> slice:
    """Return the slice from the first to the last True of a mask; slice(0, 1) if there is none."""
    where = np.flatnonzero(occupied)
    return slice(where[0], where[-1] + 1) if where.size else slice(0, 1)


def largest_offset(occupied: np.ndarray) -> int:
    """Return the largest distance, in elements, from a loaded element to any other on an axis.

    `occupied` is a mask of the loaded places along one axis of the mesh, shape (n,).
    """
    loaded = extent(occupied)
    return max(loaded.stop - 1, occupied.size - 1 - loaded.start)


class LayerCache:
    """Cache of the transformed influence tables of stress, by mesh and depth, limited in bytes.

    If they become too many, the mesh used longest ago is dropped. Of one mesh the first depths are
    retained, as every pass goes through all depths.

    Parameters
    ----------
    max_bytes : int
        Largest size of all tables, bytes.
    """

    def __init__(self, max_bytes: int = 64 * 2**20) -> None:
        self.max_bytes = max_bytes
        self._meshes: OrderedDict[Hashable, dict[float, np.ndarray]] = OrderedDict()
        self._lock = Lock()

    def get(self, mesh: Hashable, depth: float) -> np.ndarray | None:
        """Return the transformed tables of a mesh at a depth, or None if they are not cached."""
        with self._lock:
            if mesh not in self._meshes:
                return None
            self._meshes.move_to_end(mesh)
            return self._meshes[mesh].get(depth)

    def keep(self, mesh: Hashable, depth: float, transforms: np.ndarray) -> None:
        """Store a copy of transformed tables if there is room, after old meshes are dropped."""
        with self._lock:
            of_mesh = self._meshes.setdefault(mesh, {})
            while self.size() + transforms.nbytes > self.max_bytes and len(self._meshes) > 1:
                self._meshes.popitem(last=False)
            if self.size() + transforms.nbytes <= self.max_bytes:
                of_mesh[depth] = transforms.copy()

    def size(self) -> int:
        """Return the size of all cached tables, bytes."""
        return sum(layer.nbytes for of_mesh in self._meshes.values() for layer in of_mesh.values())


layer_cache = LayerCache()
"""Tables of all contacts of this process."""


class StressLayers:
    """Subsurface stress of both bodies at the centres of a mesh, one depth at a time, by FFT.

    The bodies are half-spaces z >= 0 with z into the body, loaded as in
    :mod:`tractive_sam.kernels.stress`. For tractions constant on every element the result is exact;
    its error is rounding, about 1e-15 of the tractions at any depth. The stress of a layer is not
    stored, so that memory does not grow with the number of layers. Bodies under one contact share
    the integrals over an element, which do not depend on Poisson's ratio, and their transforms; the
    cache of these serves other tractions on this mesh.

    Parameters
    ----------
    lattice : Lattice
        Elements; lengths in mm.
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) acting on a half-space, MPa.
    poisson : sequence of float
        Poisson's ratio of each half-space.
    signs : sequence of float
        Factors of p_x and p_y, for each half-space.
    threads : int
        Threads to use.
    """

    multiple = 8
    """Offsets are rounded up to multiples of this many elements: loads that change a little, as a
    contact does that wears, share plans and transforms."""

    def __init__(
        self,
        lattice: Lattice,
        tractions: np.ndarray,
        poisson: Sequence[float],
        signs: Sequence[float],
        threads: int = 1,
    ):
        self.lattice = lattice
        self.poisson, self.signs = tuple(poisson), tuple(signs)
        self.threads = threads
        loaded = np.any(tractions, axis=0)
        # No offset from a loaded element is longer than half a period.
        farthest = (largest_offset(np.any(loaded, axis=k)) for k in (1, 0))
        self._padded = tuple(
            padded_length(-(-(far + 1) // self.multiple) * self.multiple) for far in farthest
        )
        px, py = self._padded
        spectra = transform(3, lattice.shape, self._padded).forward(tractions)
        self._loads = spectra * (0.5 / (np.pi * px * py))

    def at(self, depth: float) -> np.ndarray:
        """Return the stress tensors at one depth, MPa, shape (bodies, 6, n_x, n_y).

        Parameters
        ----------
        depth : float
            z >= 0, mm.

        Returns
        -------
        ndarray, shape (bodies, 6, n_x, n_y)
            In the order of `kernels.stress.COMPONENTS`, MPa; a new array.
        """
        transform = layer_transform(self.lattice.shape, self._padded, self.threads)
        packs = self._packs(transform, float(depth))
        out = np.empty((len(self.poisson), 6, *self.lattice.shape))
        for stress, sign, nu in zip(out, self.signs, self.poisson, strict=True):
            self._by_rows(partial(layer_product, transform.spectra, packs, self._loads, sign, nu))
            stress[:] = transform.backward()
        return out

    def _packs(self, transform: LayerTransform, depth: float) -> np.ndarray:
        """Return the transformed influence tables at one depth, from the cache or computed."""
        sides = self.lattice.dx, self.lattice.dy
        mesh = *sides, *self._padded
        packs = layer_cache.get(mesh, depth)
        if packs is None:
            self._by_rows(partial(layer_table, transform.tables, depth, *sides))
            transform.forward()
            packs = transform.packs
            layer_cache.keep(mesh, depth, packs)
        return packs

    def _by_rows(self, work: Callable[[int, int], None]) -> None:
        """Call work(first, last) for ranges that cover the rows 0 to p_x/2, in parallel threads."""
        count = self._padded[0] // 2 + 1
        if self.threads == 1:
            work(0, count)
            return
        ends = np.linspace(0, count, self.threads + 1).astype(int)
        with ThreadPoolExecutor(self.threads) as pool:
            list(pool.map(work, ends[:-1], ends[1:]))


class StressPlane:
    """Subsurface stress on a vertical plane x or y = constant, one depth at a time.

    Bodies, accuracy and sharing as for `StressLayers`, at a fraction of its cost: along the plane
    the elements are convolved by FFT, across it they are summed in the spectrum. The integral over
    an element is a difference between two of its edges, which neighbours share. So the sum runs
    over edges, with the jump of the traction across them, and edges at equal distances on both
    sides of the plane are taken together. Their tables are transformed some edges at a time.

    Parameters
    ----------
    grid : Grid
        Elements; lengths in mm.
    normal : "x" or "y"
        The plane is x = position and its points are at the grid's y, or the reverse.
    position : float
        Position of the plane, mm; anywhere.
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) acting on a half-space, MPa.
    poisson : sequence of float
        Poisson's ratio of each half-space.
    signs : sequence of float
        Factors of p_x and p_y, for each half-space.
    """

    table_bytes = 2**22
    """Largest size of the tables of edges that are transformed together, bytes."""

    exchanged = (1, 0, 2, 3, 5, 4)
    """The components xx, yy, zz, xy, xz, yz after an exchange of x and y."""

    def __init__(
        self,
        grid: Grid,
        normal: Literal["x", "y"],
        position: float,
        tractions: np.ndarray,
        poisson: Sequence[float],
        signs: Sequence[float],
    ):
        self.poisson, self.signs = tuple(poisson), tuple(signs)
        across, step, self._step = grid.x, grid.dx, grid.dy
        self._exchanged = normal == "y"
        if self._exchanged:
            # From here on the plane is x = position.
            across, step, self._step = grid.y, grid.dy, grid.dx
            tractions = tractions.swapaxes(1, 2)[[1, 0, 2]]
        loaded = np.any(tractions, axis=0)
        self._points = loaded.shape[1]
        self._padded = padded_length(largest_offset(np.any(loaded, axis=0)) + 1)
        rows = extent(np.any(loaded, axis=1))
        jumps = np.diff(tractions[:, rows], axis=1, prepend=0.0, append=0.0)
        # Plane minus edge, in elements.
        place = (position - across[rows.start]) / step + 0.5
        nearest = 0.5 * round(2.0 * place)
        # A plane within 1e-9 elements of a row of centres or of edges lies on it.
        offsets = (nearest if abs(place - nearest) < 1e-9 else place) - np.arange(jumps.shape[1])
        distances, group = np.unique(np.abs(offsets), return_inverse=True)
        blocks = -(-64 * self._padded * distances.size // self.table_bytes)
        edges = -(-distances.size // blocks)
        # The last block is filled with edges without load.
        self._distances = np.full((blocks, edges), step)
        self._distances.flat[: distances.size] = distances * step
        self._loads = np.empty((blocks, 2, 3, edges, self._padded // 2 + 1), dtype=complex)
        for block, spectra in enumerate(self._loads):
            loads = np.zeros((2, 3, edges, self._points))
            for edge in np.flatnonzero(group // edges == block):
                k = group[edge] % edges
                loads[0, :, k] += jumps[:, edge]
                loads[1, :, k] += np.sign(offsets[edge]) * jumps[:, edge]
            spectra[:] = np.fft.rfft(loads, self._padded) / (2.0 * np.pi)

    def at(self, depth: float) -> np.ndarray:
        """Return the stress tensors along the plane at one depth, MPa, shape (bodies, 6, n).

        Parameters
        ----------
        depth : float
            z >= 0, mm.

        Returns
        -------
        ndarray, shape (bodies, 6, n)
            In the order of `kernels.stress.COMPONENTS`, MPa; a new array.
        """
        transform = edge_transform(self._distances.shape[1], self._padded)
        spectra = np.zeros((len(self.poisson), 6, self._padded // 2 + 1), dtype=complex)
        for distances, loads in zip(self._distances, self._loads, strict=True):
            edge_table(transform.tables, distances, float(depth), self._step)
            transform.forward()
            for out, sign, nu in zip(spectra, self.signs, self.poisson, strict=True):
                plane_product(out, transform.packs, loads, sign, nu)
        stresses = np.fft.irfft(spectra, self._padded)[..., : self._points]
        return stresses[:, self.exchanged] if self._exchanged else stresses


class StripLayers:
    """Subsurface stress below a line contact, one depth at a time, by convolution of strips.

    Exact to rounding, about 1e-13 of the tractions; see :mod:`tractive_sam.kernels.stress`.

    Parameters
    ----------
    lattice : Lattice
        A row of strips; lengths in mm.
    tractions : ndarray, shape (3, n_x, 1)
        (p_x, p_y, p_n) acting on a half-space, MPa.
    poisson : sequence of float
        Poisson's ratio of each half-space.
    signs : sequence of float
        Factors of p_x and p_y, for each half-space.
    """

    def __init__(
        self,
        lattice: Lattice,
        tractions: np.ndarray,
        poisson: Sequence[float],
        signs: Sequence[float],
    ):
        self.lattice, self.poisson, self.signs = lattice, tuple(poisson), tuple(signs)
        jumps = np.diff(tractions[:, :, 0], axis=1, prepend=0.0, append=0.0)
        self._shape = 1, jumps.shape[1]
        self._padded = 1, padded_length(jumps.shape[1])
        spectra = transform(3, self._shape, self._padded).forward(jumps[:, None])
        self._loads = spectra[:, 0] / (np.pi * self._padded[1])

    def at(self, depth: float) -> np.ndarray:
        """Return stress tensors at centres of strips at one depth, MPa, shape (bodies, 6, n_x, 1).

        Parameters
        ----------
        depth : float
            z >= 0, mm.

        Returns
        -------
        ndarray, shape (bodies, 6, n_x, 1)
            In the order of `kernels.stress.COMPONENTS`, MPa; a new array.
        """
        table = np.empty((4, self._padded[1]))
        edge_factors(table, float(depth), self.lattice.dx)
        ln, t, xz, zz = np.fft.rfft(table)
        p_x, p_y, p_n = self._loads
        back, count = transform(5, self._shape, self._padded), self.lattice.shape[0]
        out = np.empty((len(self.poisson), 6, count, 1))
        for stress, sign, nu in zip(out, self.signs, self.poisson, strict=True):
            back.spectrum[:, 0] = (
                -sign * p_x * (2.0 * ln + zz) - p_n * (t - xz),
                sign * p_x * zz - p_n * (t + xz),
                -sign * p_y * ln,
                p_n * zz - sign * p_x * (t - xz),
                -sign * p_y * t,
            )
            stress[[0, 2, 3, 4, 5], :, 0] = back.backward()[:, 0, :count]
            stress[1] = nu * (stress[0] + stress[2])
        return out


def surface_stress(
    lattice: Lattice,
    body: HalfSpaces | LinearHalfSpaces,
    tractions: np.ndarray,
    signs: Sequence[float] = (1.0,),
) -> np.ndarray:
    """Return surface stress at inner corners (bodies, 6, n_x - 1, n_y - 1), by displacement.

    With tractions constant on elements the stress is infinite at every edge across which the
    tangential one jumps; the displacement is finite. Its differences between centres are means of
    the strain, and Hooke's law with the mean of the tractions makes them stress. The contact
    conditions are met by the displacement at centres: the error of each traction makes it exact
    there.

    Parameters
    ----------
    lattice : Lattice
        Elements (n_x, n_y), or strips; lengths in mm.
    body : HalfSpaces or LinearHalfSpaces
        The body, as `single_body` of its law gives it.
    tractions : ndarray, shape (3, n_x, n_y)
        (p_x, p_y, p_n) acting on the half-space z >= 0, MPa.
    signs : sequence of float
        Factors of p_x and p_y, for each of several bodies of this kind.

    Returns
    -------
    ndarray, shape (bodies, 6, n_x - 1, n_y - 1), for strips (bodies, 6, n_x - 1, 1)
        In the order of `kernels.stress.COMPONENTS`, MPa: of corners that four elements share, or
        of edges that two strips do.
    """
    _, in_x, in_y = _at_corners(_displacements(lattice, body, tractions), lattice)
    p_x, p_y, p_n = _at_corners(tractions, lattice)[0]
    stress = np.empty((len(signs), 6, *p_n.shape))
    for of_body, s in zip(stress, signs, strict=True):
        xx, yy = in_x[2] + s * in_x[0], in_y[3] + s * in_y[1]
        xy = in_y[2] + in_x[3] + s * (in_y[0] + in_x[1])
        of_body[2], of_body[4], of_body[5] = -p_n, -s * p_x, -s * p_y
        stiffness = getattr(body.A, "stiffness", None)
        if stiffness is not None:
            by_strain, by_stress = AnisotropicMaterial(stiffness).in_surface
            strain = np.tensordot(by_strain, (xx, yy, xy), 1)
            of_body[[0, 1, 3]] = strain + np.tensordot(by_stress, of_body[[2, 5, 4]], 1)
            continue
        nu = cast(Material, body.A).poisson  # also of a body with layers
        plane, by_pressure = 2.0 / (1.0 - nu), nu / (1.0 - nu)
        of_body[0] = plane * (xx + nu * yy) - by_pressure * p_n
        of_body[1] = plane * (yy + nu * xx) - by_pressure * p_n
        of_body[3] = xy
    return stress


def _at_corners(fields: np.ndarray, lattice: Lattice) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return means and derivatives in x and in y of fields (m, n_x, n_y) at inner corners."""
    if fields.shape[2] == 1:  # strips do not change in y
        fields = fields.repeat(2, axis=2)
    rise, total = fields[:, 1:] - fields[:, :-1], fields[:, 1:] + fields[:, :-1]
    return (
        0.25 * (total[..., 1:] + total[..., :-1]),
        0.5 / lattice.dx * (rise[..., 1:] + rise[..., :-1]),
        0.5 / lattice.dy * (total[..., 1:] - total[..., :-1]),
    )


def _displacements(
    lattice: Lattice, body: HalfSpaces | LinearHalfSpaces, tractions: np.ndarray
) -> np.ndarray:
    """Return u_x and u_y by tangential traction, and both by pressure, at centres, (4, n_x, n_y).

    The fields are transformed one by one, with the memory of one.
    """
    single = transform(1, lattice.shape, lattice.padded)
    p_x, p_y, p_n = (single.forward(field[None])[0].copy() for field in tractions)
    xx, xy, yx, yy, xz, yz = _spectra(lattice, body)
    out = np.empty((4, *lattice.shape))
    terms = ((xx, p_x), (xy, p_y)), ((yx, p_x), (yy, p_y)), ((xz, p_n),), ((yz, p_n),)
    for displacement, products in zip(out, terms, strict=True):
        single.spectrum[:] = 0.0
        for kernel, load in products:
            single.spectrum[0] += kernel * load
        displacement[:] = single.backward()[0]
    return out


@lru_cache(maxsize=4)
def _spectra(lattice: Lattice, body: LinearHalfSpaces | HalfSpaces) -> tuple[np.ndarray, ...]:
    """Return spectra of the displacement kernels xx, xy, yx, yy, xz, yz; mostly real but the last.

    Those of tangential traction are real unless the body has no symmetry about the axes.
    """

    def of(component: str) -> np.ndarray:
        return elastic.transform_displacement(lattice, body, component)

    tangential = [of(component) for component in ("xx", "xy", "yy")]
    if body.interchangeable:
        tangential = [spectrum.real.copy() for spectrum in tangential]
    xx, xy, yy = tangential
    yx = xy if body.interchangeable else of("yx")
    return xx, xy, yx, yy, of("xz"), of("yz")
