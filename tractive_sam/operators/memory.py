"""How much memory the process may still take."""

import math
import os
from contextlib import suppress
from pathlib import Path
from types import ModuleType

resource: ModuleType | None
try:
    import resource
except ImportError:  # no such limits on this system
    resource = None

GROUPS = Path("/sys/fs/cgroup")
"""Where Linux tells the limits of groups of processes, as of a container or of a batch job."""


def available() -> float:
    """Memory that the process may still take, bytes; infinite where the system does not tell."""
    return max(0.0, min(_of_machine(), _of_groups(), _of_limit()))


def _of_machine() -> float:
    """What is free, or can be freed of caches; where only its size is told, all of it."""
    with suppress(OSError, ValueError):
        for line in Path("/proc/meminfo").read_text().splitlines():
            if line.startswith("MemAvailable:"):
                return 1024.0 * float(line.split()[1])
    with suppress(AttributeError, OSError, ValueError):
        return float(os.sysconf("SC_PHYS_PAGES")) * os.sysconf("SC_PAGE_SIZE")
    return math.inf


def _of_groups(root: Path = GROUPS, told: Path = Path("/proc/self/cgroup")) -> float:
    """What is left to the groups of the process and to those that hold them."""
    left = [math.inf]
    with suppress(OSError, ValueError):
        for line in told.read_text().splitlines():
            _, kinds, name = line.split(":", 2)
            if kinds == "":  # version 2
                names, base = ("memory.max", "memory.current", "inactive_file"), root
            elif "memory" in kinds.split(","):  # version 1
                names = ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file")
                base = root / "memory"
            else:
                continue
            inner = Path(name.lstrip("/"))
            left += [_of_group(base / group, *names) for group in (inner, *inner.parents)]
    return min(left)


def _of_group(group: Path, limit: str, usage: str, cache: str) -> float:
    try:
        most, used = (float((group / name).read_text()) for name in (limit, usage))
    except (OSError, ValueError):  # no such group, or "max"
        return math.inf
    with suppress(OSError, ValueError):
        stat = dict(line.split() for line in (group / "memory.stat").read_text().splitlines())
        used -= float(stat.get(cache, 0.0))  # is given back where memory is wanted
    return most - used


def _of_limit() -> float:
    """What ``ulimit -v`` leaves."""
    if resource is None:
        return math.inf
    most, _ = resource.getrlimit(resource.RLIMIT_AS)
    if most == resource.RLIM_INFINITY:
        return math.inf
    with suppress(OSError, ValueError):
        return (
            most - float(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        )
    return float(most)
