"""Stress in planes parallel to the surface, from tractions on a mesh."""

from collections import OrderedDict
from collections.abc import Callable, Hashable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from threading import Lock

import numpy as np

from tractive_sam.compute import LayerTransform, layer_transform, padded_length, transform
from tractive_sam.kernels.stress_lattice import layer_product, layer_table
from tractive_sam.operators.influence import Lattice
from tractive_sam.operators.load_extent import largest_offset


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
