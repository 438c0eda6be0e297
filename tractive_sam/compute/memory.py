"""How much memory the process may still take."""

import math
import os
from contextlib import suppress
from pathlib import Path
from types import ModuleType

resource: ModuleType | None
try:
    import resource
except ImportError:  # this system has no limits
    resource = None


def available_memory() -> float:
    """Return the memory, in bytes, that the process may still allocate; infinite if unknown."""
    return max(0.0, min(_free_memory(), memory_of_groups(), _memory_of_limit()))


def _free_memory() -> float:
    """Return the memory available on the machine, bytes; if unknown, its total memory, or inf."""
    with suppress(OSError, ValueError):
        for line in Path("/proc/meminfo").read_text().splitlines():
            if line.startswith("MemAvailable:"):
                return 1024.0 * float(line.split()[1])
    with suppress(AttributeError, OSError, ValueError):
        return float(os.sysconf("SC_PHYS_PAGES")) * os.sysconf("SC_PAGE_SIZE")
    return math.inf


def memory_of_groups(
    root: Path = Path("/sys/fs/cgroup"), members: Path = Path("/proc/self/cgroup")
) -> float:
    """Return the memory, in bytes, that the control groups (cgroups) still allow the process.

    In `root`, Linux stores the limits of groups (containers, batch jobs); `members` lists
    those of the process.
    """
    free = [math.inf]
    with suppress(OSError, ValueError):
        for line in members.read_text().splitlines():
            _, kinds, name = line.split(":", 2)
            if kinds == "":  # version 2
                names, base = ("memory.max", "memory.current", "inactive_file"), root
            elif "memory" in kinds.split(","):  # version 1
                names = ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file")
                base = root / "memory"
            else:
                continue
            inner = Path(name.lstrip("/"))
            free += [_memory_of_group(base / group, *names) for group in (inner, *inner.parents)]
    return min(free)


def _memory_of_group(group: Path, limit: str, usage: str, cache: str) -> float:
    """Return the bytes that a control group still allows, cache included; inf if unlimited."""
    try:
        limit_bytes, used = (float((group / name).read_text()) for name in (limit, usage))
    except (OSError, ValueError):  # no control group, or "max"
        return math.inf
    with suppress(OSError, ValueError):
        stat = dict(line.split() for line in (group / "memory.stat").read_text().splitlines())
        used -= float(stat.get(cache, 0.0))  # the system frees the cache when it needs memory
    return limit_bytes - used


def _memory_of_limit() -> float:
    """Return the memory, in bytes, that ``ulimit -v`` still allows; infinite without a limit."""
    if resource is None:
        return math.inf
    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    if limit == resource.RLIM_INFINITY:
        return math.inf
    with suppress(OSError, ValueError):
        return (
            limit - float(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        )
    return float(limit)
