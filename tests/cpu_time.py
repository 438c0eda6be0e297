"""CPU time of the quick tests and of all, printed and compared with its budget."""

import os
import time

import numpy as np
import pytest
from numba.core import event

TOLERATED_RATIO = 1.5
"""Processes on other cores take time from caches, and the first run compiles kernels."""

FIXED_SECONDS = 0.083
"""CPU seconds of `time_fixed_computation` on the machine of the budgets."""


def pytest_addoption(parser):
    parser.addini("cpu_budget_quick", "CPU seconds of all tests that are not marked slow")
    parser.addini("cpu_budget_all", "CPU seconds of all tests")
    parser.addoption("--cpu-budget", action="store_true", help="fail a run that exceeds it")


def read_cpu_time():
    """Return the CPU seconds of this process and of the children that it has waited for."""
    return sum(os.times()[:4])


def time_fixed_computation():
    """Return the least CPU seconds of a fixed computation, by which machines are compared."""
    times = []
    for _ in range(4):
        start, total = time.process_time(), 0
        for k in range(400_000):
            total += k * k % 7
        field = np.linspace(0.0, 1.0, 1 << 18)
        for _ in range(10):
            field = np.sort(np.cos(field))
        times.append(time.process_time() - start)
    return min(times)


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
        self.slowness = 1.0
        self.compilation = CompilationTime()
        event.register("numba:compile", self.compilation)

    def read(self):
        """Return the CPU seconds up to now, without those for compiling kernels."""
        return read_cpu_time() - self.compilation.seconds

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self):
        self.start = self.read()
        return (yield)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self, item, call):
        report = yield
        if call.when == "teardown":
            is_slow = item.get_closest_marker("slow") is not None
            report.user_properties.append(("cpu", [is_slow, self.read() - self.start]))
        return report

    def pytest_runtest_logreport(self, report):
        for name, value in report.user_properties:
            if name == "cpu":
                is_slow, seconds = value
                self.seconds["all"] += seconds
                self.seconds["quick"] += 0.0 if is_slow else seconds

    def exceeded(self):
        """Return the names of the sums that exceed their budget by more than is tolerated.

        On slower machines, the budgets are larger in proportion.
        """
        ratio = TOLERATED_RATIO * self.slowness
        limits = {name: ratio * (budget + self.traced) for name, budget in self.budget.items()}
        return [name for name, seconds in self.seconds.items() if seconds > limits[name]]

    @pytest.hookimpl(trylast=True)
    def pytest_sessionfinish(self, session):
        if self.is_enforced:
            self.slowness = max(1.0, time_fixed_computation() / FIXED_SECONDS)
        if self.is_enforced and self.exceeded() and session.exitstatus == pytest.ExitCode.OK:
            session.exitstatus = pytest.ExitCode.TESTS_FAILED

    def pytest_terminal_summary(self, terminalreporter):
        sums = (
            f"{name} tests {seconds:.0f} of {self.budget[name]:.0f}"
            for name, seconds in self.seconds.items()
        )
        terminalreporter.write_line(f"CPU seconds: {', '.join(sums)}")
        if self.is_enforced and self.exceeded():
            terminalreporter.write_line(
                f"The CPU time of {' and '.join(self.exceeded())} tests exceeds its budget in "
                f"pyproject.toml by more than {TOLERATED_RATIO - 1.0:.0%}: see --durations.",
                red=True,
            )
