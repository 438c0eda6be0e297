"""Zero-padded real transforms through FFTW (pyfftw is imported in this room only).

The arrays of transforms belong to their plan and are overwritten by its next use.
"""

import atexit
import math
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache, lru_cache
from math import ceil
from threading import Lock, get_ident, local
from time import process_time
from typing import Generic, TypeVar

import numpy as np
from threadpoolctl import ThreadpoolController

from tractive_sam import interrupt
from tractive_sam.compute.fftw import load_wisdom, pyfftw, save_wisdom


class _Transformed(local):
    """FFT points (fields times padded elements) that this thread has transformed.

    Attributes
    ----------
    points : float
        Number of points.
    timed, seconds : float
        Points of the convolutions that were timed, and the CPU time of these.
    untimed : int
        Convolutions that are not timed until the next one is.
    """

    points = timed = seconds = 0.0
    untimed = 0


_TRANSFORMED = _Transformed()


def count_transform(fields: int, padded: tuple[int, ...]) -> None:
    """Add one padded FFT of several fields, forward or backward, to the count of this thread."""
    _TRANSFORMED.points += fields * math.prod(padded)


def is_timed(of: int = 8) -> bool:
    """Return whether to time the next convolution of this thread: one of eight.

    Reading the clock twice takes a tenth of the time of a small convolution.
    """
    untimed = _TRANSFORMED.untimed
    _TRANSFORMED.untimed = untimed - 1 if untimed else of - 1
    return untimed == 0


def count_time(fields: int, padded: tuple[int, int], began: float) -> None:
    """Add the CPU time since `began` to the time of the convolutions that are timed."""
    _TRANSFORMED.timed += 2 * fields * padded[0] * padded[1]
    _TRANSFORMED.seconds += process_time() - began


class ConvolutionMeter:
    """Counter of convolution work of this thread, in applications of the tangential operator.

    The unit is one application of the tangential operator on a mesh: two fields forward and two
    backward. A transform of fewer fields, or on a part of the mesh, counts by its share of points,
    whatever its precision. Operators, preconditioners, coarser meshes, heat and the boxes around
    inclusions are included.

    Parameters
    ----------
    padded : tuple of int
        Padded shape (p_x, p_y) of the mesh.
    """

    def __init__(self, padded: tuple[int, int]) -> None:
        self._unit = 4.0 * padded[0] * padded[1]
        self._before, self._began = _TRANSFORMED.points, process_time()
        self._timed, self._seconds = _TRANSFORMED.timed, _TRANSFORMED.seconds
        _TRANSFORMED.untimed = 0

    @property
    def convolutions(self) -> float:
        """Work since the creation, in applications of the tangential operator (four transforms)."""
        return (_TRANSFORMED.points - self._before) / self._unit

    @property
    def over_application(self) -> float:
        """CPU time since the creation over the CPU time of one tangential application, or nan.

        The time of an application follows from one of eight convolutions in double precision since
        then; nan means that there were none, or that the clock is too coarse to time them.
        """
        timed, seconds = _TRANSFORMED.timed - self._timed, _TRANSFORMED.seconds - self._seconds
        application = seconds * self._unit / timed if seconds > 0.0 else float("nan")
        return (process_time() - self._began) / application

    @property
    def work(self) -> dict[str, float]:
        """Both measures by the names of their attributes in `results.Cost`."""
        return {"convolutions": self.convolutions, "over_application": self.over_application}


def threads_for_transform(padded: tuple[int, int], large: int = 2**19, max_threads: int = 4) -> int:
    """Return the threads for an FFT: 1 if small, else OMP_NUM_THREADS or cores, at most 4.

    The environment variable OMP_NUM_THREADS limits it, as in most libraries.

    Parameters
    ----------
    padded : pair of int
        Size of the padded array.
    large : int
        Numbers of a padded array from which threads pay; below, they cost more than they bring.
    max_threads : int
        Threads of a large transform; memory feeds no more of them.
    """
    if math.prod(padded) < large:
        return 1
    bound = os.environ.get("OMP_NUM_THREADS", "").split(",")[0].strip()
    allowed = int(bound) if bound.isdigit() else cores()
    return max(1, min(max_threads, allowed))


def cores() -> int:
    """Return the number of cores that the process may use; if unknown, all of the machine."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


@contextmanager
def numeric_settings() -> Iterator[None]:
    """Limit BLAS to one thread and ignore underflow within the block or function.

    Vectors are too short here for more threads, and threads that wait take cores from others.
    Numbers near zero, such as residuals, may underflow to zero, whatever `np.seterr` prescribes.
    """
    # SciPy has another library, which may be loaded later.
    pools = _controller("scipy.linalg" in sys.modules)
    with pools.limit(limits=1, user_api="blas"), np.errstate(under="ignore"):
        yield


@cache
def _controller(with_scipy: bool) -> ThreadpoolController:
    """Return the controller of the BLAS thread pools that are loaded, with or without SciPy's."""
    return ThreadpoolController()


Plan = TypeVar("Plan")


@cache
def fast_length(n: int, columns: bool = False) -> int:
    """Return an even length of at least n that FFTW transforms fast.

    Short transforms are planned by FFTW's estimate, which makes 144 numbers in double precision
    take twice as long as 160. The lengths below are those for which no length up to a quarter
    longer takes less time for a convolution, as the mean of both precisions.

    Longer ones are a multiple of eight if one is near: along x FFTW transforms neighbouring columns
    together, and a length of 126 takes three times as long as 128.

    Parameters
    ----------
    n : int
        Smallest length.
    columns : bool
        Whether contiguous complex columns are transformed, or real rows.
    """
    best = {2, 4, 8, 16, 20, 32, 48, 56, 64, 80, 96, 120, 128, 160, 200, 240, 256, 320, 400}
    if not columns:
        best = best - {96} | {24, 36, 42, 72, 84, 100, 144, 180, 288}
    two, eight = (k * pyfftw.next_fast_len(-(-n // k)) for k in (2, 8))
    usual = eight if eight <= 1.03 * two else two
    return min((length for length in best if length >= n), default=usual)


def padded_length(n: int, reach: float = 1.0, columns: bool = False) -> int:
    """Return a length that FFTW transforms fast and that holds a linear convolution of n.

    With a `reach` below 1 the convolution is linear for offsets up to this part of n. For `columns`
    see `fast_length`.
    """
    return fast_length(ceil((1.0 + reach) * n) - 1, columns)


def plan(
    source: np.ndarray,
    target: np.ndarray,
    axis: int,
    direction: str,
    threads: int = 1,
    measured: bool = False,
) -> pyfftw.FFTW:
    """Return FFTW's fastest transform from `source` to `target`; planning overwrites both arrays.

    Back to real numbers, executing it overwrites the source.

    FFTW estimates what is fastest, or measures it. Measuring saves 2 to 30 % of each execution and
    takes as long as 1,000 to 30,000. It pays for tiles: a convolution has many.
    """
    if measured:
        _recall_wisdom()
    flags = ["FFTW_MEASURE" if measured else "FFTW_ESTIMATE"]
    if direction == "FFTW_BACKWARD" and not np.iscomplexobj(target):
        flags.append("FFTW_DESTROY_INPUT")
    return pyfftw.FFTW(source, target, (axis,), direction, flags, threads)


class PaddedTransform:
    """Forward and backward transform of ``fields`` zero-padded arrays, planned once.

    A padded two-dimensional transform is done axis by axis, so that the rows known to be zero are
    neither transformed forward nor computed backward: three quarters of the work of
    the full transform.

    The arrays returned belong to the plan and are overwritten by its next call.

    Parameters
    ----------
    fields : int
        Number of arrays transformed together.
    shape : tuple of int
        Shape (n_x, n_y) of an array without its padding.
    padded : tuple of int
        Shape (p_x, p_y) with it.
    single : bool
        Whether in single precision.

    Attributes
    ----------
    spectrum : ndarray of complex, shape (fields, p_x, p_y/2 + 1)
        Spectra that `forward` returns and `backward` transforms.
    """

    def __init__(
        self, fields: int, shape: tuple[int, int], padded: tuple[int, int], single: bool = False
    ):
        self.shape = shape
        self._fields, self._padded = fields, padded
        nx, (px, py) = shape[0], padded
        half = (fields, px, py // 2 + 1)
        real, spectral = (np.float32, np.complex64) if single else (np.float64, np.complex128)
        self._real = pyfftw.zeros_aligned((fields, nx, py), dtype=real)
        self._rows = pyfftw.zeros_aligned(half, dtype=spectral)
        self.spectrum = pyfftw.zeros_aligned(half, dtype=spectral)

        threads = threads_for_transform(padded)
        # Forward along x keeps its input, so that the padding of `_rows` stays zero for good.
        self._forward_y = plan(self._real, self._rows[:, :nx], 2, "FFTW_FORWARD", threads)
        self._forward_x = plan(self._rows, self.spectrum, 1, "FFTW_FORWARD", threads)
        self._backward_x = plan(self.spectrum, self.spectrum, 1, "FFTW_BACKWARD", threads)
        self._backward_y = plan(self.spectrum[:, :nx], self._real, 2, "FFTW_BACKWARD", threads)
        self._rows[:] = 0.0  # planning wrote into it

    def forward(self, fields: np.ndarray) -> np.ndarray:
        """Return the spectra (fields, p_x, p_y/2 + 1) of arrays (fields, n_x, n_y)."""
        ny = self.shape[1]
        self._real[..., :ny] = fields
        self._real[..., ny:] = 0.0
        count_transform(self._fields, self._padded)
        self._forward_y.execute()
        self._forward_x.execute()
        return self.spectrum

    def backward(self) -> np.ndarray:
        """Return the inverse transform of `spectrum`, cropped to (fields, n_x, n_y), times p_x p_y.

        The normalisation is left to the spectra of the kernel, which carry it at no cost.
        """
        count_transform(self._fields, self._padded)
        self._backward_x.execute()
        self._backward_y.execute()
        return self._real[..., : self.shape[1]]


@cache
def _recall_wisdom() -> None:
    """Load FFTW's plans of earlier processes, once, and store them when this process ends."""
    load_wisdom()
    atexit.register(save_wisdom)


_PLANNING, _QUEUE = Lock(), Lock()
"""FFTW's planner is not safe for threads. Who waits for it does so in the queue."""


def _keep_planner_for_fork() -> None:
    # A lock that another thread holds while the process forks stays held in the child for good.
    # With the queue, the fork waits for one plan, and not for all plans that threads still request.
    """Acquire both locks of the planner before the process forks."""
    _QUEUE.acquire()
    _PLANNING.acquire()


def _release_planner() -> None:
    """Release both locks of the planner after a fork, in parent and child."""
    _PLANNING.release()
    _QUEUE.release()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(
        before=_keep_planner_for_fork,
        after_in_parent=_release_planner,
        after_in_child=_release_planner,
    )


class PlanCache(Generic[Plan]):
    """Cache of plans (objects with their arrays) by thread and by the arguments of `make`.

    A plan owns the arrays that it works on, so that threads cannot share it. Every computation
    requests plans often, so a program that received a signal stops here.

    Parameters
    ----------
    make : callable
        Function that makes a plan; its arguments are hashable.
    size : int
        Number of plans stored, over all threads.
    """

    def __init__(self, make: Callable[..., Plan], size: int) -> None:
        @lru_cache(maxsize=size)
        def of_thread(_thread: int, *arguments) -> Plan:
            with _QUEUE:  # a fork of the process that waits for the planner comes first
                _PLANNING.acquire()
            try:
                return make(*arguments)
            finally:
                _PLANNING.release()

        self._of_thread = of_thread
        self.cache_clear = of_thread.cache_clear
        """Forget all plans and free their arrays."""

    def __call__(self, *arguments) -> Plan:
        """Return the plan of these arguments, made on its first use."""
        interrupt.raise_if_interrupted()
        return self._of_thread(get_ident(), *arguments)


transform = PlanCache(PaddedTransform, 32)
"""The `PaddedTransform` of its arguments, made on its first use."""


class LayerTransform:
    """FFTs for `StressLayers`: four packed tables forward, six stress components backward.

    Parameters
    ----------
    shape : tuple of int
        Mesh (n_x, n_y) on which the stresses are wanted.
    padded : tuple of int
        Periods (p_x, p_y) of the tables, even.
    threads : int
        Threads that FFTW may use.

    Attributes
    ----------
    tables : ndarray, shape (4, p_x, p_y)
        Packed tables, the input of `forward`.
    packs : ndarray of complex, shape (4, p_x, p_y/2 + 1)
        Spectra of the tables.
    spectra : ndarray of complex, shape (6, p_x, p_y/2 + 1)
        Spectra of the stresses, for `backward`; destroyed by it.
    """

    def __init__(self, shape: tuple[int, int], padded: tuple[int, int], threads: int = 1):
        (nx, ny), (px, py) = shape, padded
        self.tables = pyfftw.zeros_aligned((4, px, py))
        self.packs = pyfftw.zeros_aligned((4, px, py // 2 + 1), dtype=complex)
        self.spectra = pyfftw.zeros_aligned((6, px, py // 2 + 1), dtype=complex)
        stresses = pyfftw.zeros_aligned((6, nx, py))
        self._stresses = stresses[..., :ny]
        self._tables_y = plan(self.tables, self.packs, 2, "FFTW_FORWARD", threads)
        self._tables_x = plan(self.packs, self.packs, 1, "FFTW_FORWARD", threads)
        self._stress_x = plan(self.spectra, self.spectra, 1, "FFTW_BACKWARD", threads)
        # Rows beyond the mesh are not transformed back.
        self._stress_y = plan(self.spectra[:, :nx], stresses, 2, "FFTW_BACKWARD", threads)

    def forward(self) -> None:
        """Transform the array `tables` into the array `packs`."""
        self._tables_y.execute()
        self._tables_x.execute()

    def backward(self) -> np.ndarray:
        """Transform `spectra` back and return six stresses (6, n_x, n_y), times p_x p_y."""
        self._stress_x.execute()
        self._stress_y.execute()
        return self._stresses


class EdgeTransform:
    """FFTs along a plane for `StressPlane`: eight packed tables of edges, forward.

    Parameters
    ----------
    edges : int
        Number of rows.
    padded : int
        Period p of the tables, even.

    Attributes
    ----------
    tables : ndarray, shape (8, edges, p)
        Packed tables, the input of `forward`.
    packs : ndarray of complex, shape (8, edges, p/2 + 1)
        Spectra of the tables.
    """

    def __init__(self, edges: int, padded: int):
        self.tables = pyfftw.zeros_aligned((8, edges, padded))
        self.packs = pyfftw.zeros_aligned((8, edges, padded // 2 + 1), dtype=complex)
        self._plan = plan(self.tables, self.packs, 2, "FFTW_FORWARD")

    def forward(self) -> None:
        """Transform the array `tables` into the array `packs`."""
        self._plan.execute()


class BoxTransform:
    """FFTs of fields over the three axes of a box, planned once.

    Parameters
    ----------
    fields : int
        Number of fields transformed together.
    padded : tuple of int
        Shape (p_1, p_2, p_3) of each, the last one even.

    Attributes
    ----------
    values : ndarray, shape (fields, p_1, p_2, p_3)
        Fields, the input of `forward` and the output of `backward`.
    spectrum : ndarray of complex, shape (fields, p_1, p_2, p_3/2 + 1)
        Spectra of the fields.
    """

    def __init__(self, fields: int, padded: tuple[int, int, int]):
        self.values = pyfftw.zeros_aligned((fields, *padded))
        half = (fields, *padded[:2], padded[2] // 2 + 1)
        self.spectrum = pyfftw.zeros_aligned(half, dtype=complex)
        real, complex_ = self.values, self.spectrum
        self._forward = [plan(real, complex_, 3, "FFTW_FORWARD")]
        self._forward += [plan(complex_, complex_, axis, "FFTW_FORWARD") for axis in (2, 1)]
        self._backward = [plan(complex_, complex_, axis, "FFTW_BACKWARD") for axis in (1, 2)]
        self._backward.append(plan(complex_, real, 3, "FFTW_BACKWARD"))

    def forward(self, fields: np.ndarray) -> np.ndarray:
        """Return the spectra of fields (fields, n_1, n_2, n_3), padded with zeros."""
        self.values[...] = 0.0
        self.values[tuple(map(slice, fields.shape))] = fields
        count_transform(len(self.values), self.values.shape[1:])
        for step in self._forward:
            step.execute()
        return self.spectrum

    def backward(self, spectrum: np.ndarray) -> np.ndarray:
        """Return the inverse transform of spectra, padded, times p_1 p_2 p_3."""
        self.spectrum[...] = spectrum
        count_transform(len(self.values), self.values.shape[1:])
        for step in self._backward:
            step.execute()
        return self.values


layer_transform = PlanCache(LayerTransform, 8)
"""The `LayerTransform` of its arguments, made on its first use."""

edge_transform = PlanCache(EdgeTransform, 8)
"""The `EdgeTransform` of its arguments, made on its first use."""

box_transform = PlanCache(BoxTransform, 4)
"""The `BoxTransform` of its arguments, made on its first use."""
