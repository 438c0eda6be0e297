"""Operators may be used by several threads at once; large ones use several themselves."""

import os
import signal
from concurrent.futures import ThreadPoolExecutor
from threading import Event, Thread
from time import sleep

import numpy as np
import pytest
from threadpoolctl import threadpool_info

from tractive_sam.compute import fft, tiles
from tractive_sam.mechanics.elasticity import HalfSpaces, Material
from tractive_sam.operators import Lattice, Operators, StressLayers


def test_threads_do_not_disturb_each_other():
    bodies = HalfSpaces(Material(1.0, 0.3), Material(1.0, 0.3))
    operator = Operators(Lattice((96, 96), 0.1, 0.1), bodies, 1.0, 1.0).slip
    fields = np.random.default_rng(0).normal(size=(8, 2, 96, 96))
    single = [operator(f) for f in fields]
    with ThreadPoolExecutor(4) as pool:
        for _ in range(5):
            for a, b in zip(pool.map(operator, fields), single, strict=True):
                np.testing.assert_array_equal(a, b)


def test_nor_below_the_surface():
    tractions = np.random.default_rng(0).normal(size=(4, 3, 24, 20))
    layers = [StressLayers(Lattice((24, 20), 0.1, 0.1), t, (0.3,), (1.0,)) for t in tractions]
    single = [layer.at(0.2) for layer in layers]
    with ThreadPoolExecutor(4) as pool:
        for _ in range(5):
            for a, b in zip(pool.map(lambda one: one.at(0.2), layers), single, strict=True):
                np.testing.assert_array_equal(a, b)


def test_large_transforms_take_the_cores_there_are(monkeypatch):
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    monkeypatch.setattr(fft, "cores", lambda: 16)
    assert fft.threads_for_transform((256, 256)) == 1
    assert fft.threads_for_transform((2048, 2048)) == 4


@pytest.mark.parametrize(("bound", "taken"), [("1", 1), ("3", 3), ("2,1", 2), ("0", 1), ("x", 2)])
def test_threads_are_bounded_as_those_of_other_libraries(bound, taken, monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", bound)
    monkeypatch.setattr(fft, "cores", lambda: 2)
    assert fft.threads_for_transform((2048, 2048)) == taken


@pytest.mark.parametrize("known", [6, None])
def test_cores_where_the_system_does_not_report_those_of_a_process(known, monkeypatch):
    monkeypatch.delattr(os, "sched_getaffinity", raising=False)
    monkeypatch.setattr(os, "cpu_count", lambda: known)
    assert fft.cores() == (known or 1)


def test_threads_of_a_transform_change_nothing_but_rounding(monkeypatch):
    bodies = HalfSpaces(Material(1.0, 0.3), Material(1.0, 0.3))
    fields = np.random.default_rng(0).normal(size=(2, 90, 80))
    one = Operators(Lattice((90, 80), 0.1, 0.1), bodies, 1.0, 1.0).slip(fields)
    for module in (fft, tiles):
        monkeypatch.setattr(module, "threads_for_transform", lambda padded: 2)
    two = Operators(Lattice((90, 81), 0.1, 0.1), bodies, 1.0, 1.0).slip(
        np.pad(fields, ((0, 0), (0, 0), (0, 1)))
    )
    np.testing.assert_allclose(two[..., :80], one, atol=1e-12 * np.abs(one).max())


def test_blas_threads_are_limited_and_restored():
    def counts():
        return [one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"]

    before = counts()
    with fft.numeric_settings():
        assert set(counts()) <= {1}
    assert counts() == before


def test_underflow_is_no_error_whatever_the_caller_prescribes():
    tiny = np.full(9, 1e-200)
    with np.errstate(all="raise"), fft.numeric_settings():
        assert tiny @ tiny == 0.0


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no such processes on this system")
@pytest.mark.filterwarnings("ignore:.*multi-threaded, use of fork:DeprecationWarning")
def test_process_forked_while_another_thread_plans_can_plan():
    """The fork waits for the plan; in the child, no one is left who would give the planner back."""
    planning = Event()

    def make(number):
        planning.set()
        while number == 0 and not fft._QUEUE.locked():  # until the fork waits
            sleep(1e-3)
        return number

    recalled = fft.PlanCache(make, 4)
    other = Thread(target=recalled, args=(0,))
    other.start()
    planning.wait()
    child = os.fork()
    if child == 0:
        # A process that cannot plan ends by this alarm: nothing else would end it.
        signal.alarm(60)
        recalled(1)
        os._exit(0)
    _, status = os.waitpid(child, 0)
    other.join()
    assert os.waitstatus_to_exitcode(status) == 0
