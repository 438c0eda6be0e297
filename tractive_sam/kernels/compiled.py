"""The decorator of every kernel: compile at the first call, store until its source changes.

If nothing can be stored, every process compiles again; `NUMBA_CACHE_DIR` names another folder.

Numba's cache notices a change in the module of a function, but not in the modules from which it
imports functions and constants, and would use an old formula. So the name of the stored code
contains a hash of all these sources.

Kernels avoid what takes long to compile: an array assigned to a slice or a row (the text of its
error alone is 40 functions of numba), a literal number passed to another kernel, and views that are
not contiguous (each is a further specialisation).
"""

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any, ClassVar

import numba
from numba.core.caching import FunctionCache
from numba.core.compiler import Compiler

ANY_ORDER = {"reassoc", "contract", "nsz"}
"""`fastmath` of sums that may be added in any order, which allows for vector instructions."""


def compiled(
    function: Callable[..., Any] | None = None, *, fastmath: Any = False, inner: bool = False
) -> Any:
    """Decorator: compile a function of numbers and arrays by numba; x/0 gives inf or nan.

    Parameters
    ----------
    function : callable
        The function to compile.
    fastmath : bool or set of str
        Freedom that the compiler has, for example `ANY_ORDER`.
    inner : bool
        Whether only other kernels call the function: no entry from Python is compiled then.
    """
    if function is None:
        return lambda function: compiled(function, fastmath=fastmath, inner=inner)
    _Compiler.kernels.add(function)
    name = function.__qualname__
    # numba names the files of its cache when it is given the function.
    function.__qualname__ = f"{hash_sources(function.__module__.rpartition('.')[2])}.{name}"
    try:
        options = {"error_model": "numpy", "nogil": True, "fastmath": fastmath}
        # An entry for callbacks from C, and one from Python: about a tenth of the time each takes.
        options |= {"no_cfunc_wrapper": True, "no_cpython_wrapper": inner}
        kernel: Any = numba.njit(pipeline_class=_Compiler, **options)(function)
        with suppress(RuntimeError):  # of no folder that may be written
            kernel._cache = _StoredOverloads(function)
        return kernel
    finally:
        function.__qualname__ = name


class _Compiler(Compiler):
    """Compiler of kernels: numba's, which counts them."""

    kernels: ClassVar[set[Any]] = set()
    begun: ClassVar[set[Any]] = set()
    notify: ClassVar[Callable[[int, int], None] | None] = None

    def compile_extra(self, function: Any) -> Any:
        """Compile a function."""
        self.begun.add(function)
        if _Compiler.notify:
            _Compiler.notify(len(self.begun), len(self.kernels))
        return super().compile_extra(function)


class _StoredOverloads(FunctionCache):
    """Store of compiled functions on disk (numba's cache), which ignores damaged or full disks."""

    def load_overload(self, *arguments: Any) -> Any:
        """Return the stored compiled function, or None; a damaged store is cleared."""
        try:
            return super().load_overload(*arguments)
        except Exception:  # what is damaged may raise any
            with suppress(OSError):
                self.flush()
            return None

    def save_overload(self, *compiled: Any) -> None:
        """Store a compiled function on disk; ignore write errors."""
        with suppress(OSError):
            super().save_overload(*compiled)


@cache
def hash_sources(module: str) -> str:
    """Return a hash of the source of a kernel module and of those that it imports."""
    text = Path(__file__).with_name(f"{module}.py").read_text("utf-8")
    imported = re.findall(rf"^from {re.escape(__package__)}\.(\w+) import", text, re.MULTILINE)
    return sha256("".join([text, *map(hash_sources, imported)]).encode()).hexdigest()[:12]


@contextmanager
def notify_compilation(notify: Callable[[int, int], None]) -> Iterator[None]:
    """Call a function before each compilation in the `with` block.

    Its arguments are the number of kernels that the process compiles, up to this one, and their
    largest possible number: that of the kernels of all modules that are loaded.
    """
    _Compiler.notify = notify
    try:
        yield
    finally:
        _Compiler.notify = None
