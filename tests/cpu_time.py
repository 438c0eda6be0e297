"""CPU time of the quick tests and of all, printed and compared with its budget."""

import os
import time

import numpy as np
import pytest
from numba.core import event

TOLERATED_RATIO = 1.5
"""Processes on other cores take time from caches, and the first run compiles kernels."""

FIXED_SECONDS = 0.056
"""CPU seconds of `time_fixed_computation` on the machine of the budgets."""

SAMPLE_EVERY = 10.0
"""CPU seconds between two measurements of the speed of the machine."""


def pytest_addoption(parser):
    parser.addini("cpu_budget_quick", "CPU seconds of all tests that are not marked slow")
    parser.addini("cpu_budget_all", "CPU seconds of all tests")
    parser.addoption("--cpu-budget", action="store_true", help="fail a run that exceeds it")


def read_cpu_time():
    """Return the CPU seconds of this process and of the children that it has waited for."""
    return sum(os.times()[:4])


def time_fixed_computation():
    """Return the CPU seconds of a fixed computation, by which machines are compared.

    It has a part each for the interpreter, for arrays within the caches and for arrays beyond them.
    """
    start, total = time.process_time(), 0
    for k in range(400_000):
        total += k * k % 7
    field = np.linspace(0.0, 1.0, 1 << 12)
    for _ in range(500):
        field = np.cos(field)
    field = np.outer(field, field[:64])
    for _ in range(4):
        field = np.fft.irfft2(np.fft.rfft2(field), field.shape)
    return time.process_time() - start


class CompilationTime(event.Listener):
    """Add up the CPU seconds in which this process compiles kernels, which it does once."""

    def __init__(self):
        self.seconds = 0.0
        self.depth = 0
        self.start = 0.0

    def on_start(self, event):
        if self.depth == 0:
            self.start = time.process_time()
        self.depth += 1

    def on_end(self, event):
        self.depth -= 1
        if self.depth == 0:
            self.seconds += time.process_time() - self.start


class CpuTime:
    """Add up the CPU seconds of tests with their fixtures, also from workers of pytest-xdist.

    The time for compiling kernels in the process of the tests is left out.
    """

    def __init__(self, config):
        self.seconds = {"quick": 0.0, "all": 0.0}
        self.budget = {name: float(config.getini(f"cpu_budget_{name}")) for name in self.seconds}
        self.is_enforced = config.getoption("--cpu-budget")
        # Coverage traces the quick tests, which then take twice as long.
        self.traced = self.budget["quick"] if config.pluginmanager.hasplugin("_cov") else 0.0
        self.start = 0.0
        self.next_sample = 0.0
        self.new_samples, self.samples = [], []
        self.compilation = CompilationTime()
        event.register("numba:compile", self.compilation)

    def read(self):
        """Return the CPU seconds up to now, without those for compiling kernels."""
        return read_cpu_time() - self.compilation.seconds

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self):
        # During the tests: where two processes share a core, each is slower than it is alone.
        self.new_samples = []
        if self.is_enforced and self.read() > self.next_sample:
            self.new_samples.append(time_fixed_computation())
            self.next_sample = self.read() + SAMPLE_EVERY
        self.start = self.read()
        return (yield)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self, item, call):
        report = yield
        if call.when == "teardown":
            is_slow = item.get_closest_marker("slow") is not None
            cpu = [is_slow, self.read() - self.start, self.new_samples]
            report.user_properties.append(("cpu", cpu))
        return report

    def pytest_runtest_logreport(self, report):
        for name, value in report.user_properties:
            if name == "cpu":
                is_slow, seconds, samples = value
                self.samples += samples
                self.seconds["all"] += seconds
                self.seconds["quick"] += 0.0 if is_slow else seconds

    @property
    def slowness(self):
        """The time of the fixed computation over that on the machine of the budgets."""
        return np.mean(self.samples) / FIXED_SECONDS if self.samples else 1.0

    def exceeded(self):
        """Return the names of the sums that exceed their budget by more than is tolerated.

        On slower machines, the budgets are larger in proportion.
        """
        ratio = TOLERATED_RATIO * max(1.0, self.slowness)
        limits = {name: ratio * (budget + self.traced) for name, budget in self.budget.items()}
        return [name for name, seconds in self.seconds.items() if seconds > limits[name]]

    @pytest.hookimpl(trylast=True)
    def pytest_sessionfinish(self, session):
        if self.is_enforced and self.exceeded() and session.exitstatus == pytest.ExitCode.OK:
            session.exitstatus = pytest.ExitCode.TESTS_FAILED

    def pytest_terminal_summary(self, terminalreporter):
        sums = (
            f"{name} tests {seconds:.0f} of {self.budget[name]:.0f}"
            for name, seconds in self.seconds.items()
        )
        slowness = f" on a machine {self.slowness:.2f} times as slow" if self.samples else ""
        terminalreporter.write_line(f"CPU seconds: {', '.join(sums)}{slowness}")
        if self.is_enforced and self.exceeded():
            terminalreporter.write_line(
                f"The CPU time of {' and '.join(self.exceeded())} tests exceeds its budget in "
                f"pyproject.toml by more than {TOLERATED_RATIO - 1.0:.0%}: see --durations.",
                red=True,
            )
