"""What is free, by what the system reports of it."""

import math
from pathlib import Path

import pytest

from tractive_sam.run import memory


@pytest.fixture
def groups(tmp_path):
    """Write files of control groups; returns what is left to a process of them."""

    def left(reported, files):
        for name, text in files.items():
            path = tmp_path / "root" / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        (tmp_path / "reported").write_text(reported)
        return memory.memory_of_groups(tmp_path / "root", tmp_path / "reported")

    return left


def test_something_is_free():
    assert memory.available_memory() > 2**20
    assert memory.available_memory() < math.inf or not Path("/proc/meminfo").exists()


def test_the_narrowest_group_counts(groups):
    files = {
        "job/step/memory.max": "max\n",
        "job/step/memory.current": "10\n",
        "job/memory.max": "1000\n",
        "job/memory.current": "600\n",
        "job/memory.stat": "anon 1\ninactive_file 100\n",
    }
    # Of the 600 in use, 100 are pages of files that are given back.
    assert groups("0::/job/step\n", files) == 500.0


def test_groups_of_the_first_version(groups):
    files = {
        "memory/job/memory.limit_in_bytes": "1000",
        "memory/job/memory.usage_in_bytes": "600",
        "memory/job/memory.stat": "total_inactive_file 50",
    }
    assert groups("9:name=systemd:/\n4:cpu,memory:/job\n", files) == 450.0


def test_without_groups(groups):
    assert groups("0::/gone\n", {}) == math.inf


def test_what_cannot_be_read_bounds_nothing(groups):
    assert groups("no group\n", {}) == math.inf
