"""The decorator of every kernel: compiled when first called, kept on disk until its source changes.

Where nothing can be kept, every process compiles anew; `NUMBA_CACHE_DIR` names another folder.

By itself numba's cache sees a change in the module of a function, but not in the modules from which
that takes other functions and constants: it would go on with an old formula. So what is kept bears
a hash of all these sources in its name.

What takes long to compile, and kernels do without: an array assigned to a slice or a row (the text
of its error alone is 40 functions of numba), a literal number passed to another kernel and views
that are not contiguous (each is a further specialisation).
"""

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

import numba
from numba.core import event
from numba.core.caching import FunctionCache

ANY_ORDER = {"reassoc", "contract", "nsz"}
"""`fastmath` of sums that may be added in any order, which allows for vector instructions."""


def compiled(
    function: Callable[..., Any] | None = None, *, fastmath: Any = False, inner: bool = False
) -> Any:
    """Compile a function of numbers and arrays; division by zero gives inf or nan.

    Parameters
    ----------
    function : callable
        What to compile.
    fastmath : bool or set of str
        Freedom that the compiler has, such as `ANY_ORDER`.
    inner : bool
        Whether only other kernels call it: an entry from Python is then not compiled.
    """
    if function is None:
        return lambda function: compiled(function, fastmath=fastmath, inner=inner)
    name = function.__qualname__
    # numba names the files of its cache when it is given the function.
    function.__qualname__ = f"{sources(function.__module__.rpartition('.')[2])}.{name}"
    try:
        options = {"error_model": "numpy", "nogil": True, "fastmath": fastmath}
        # An entry for callbacks from C, and one from Python: about a tenth of the time each takes.
        options |= {"no_cfunc_wrapper": True, "no_cpython_wrapper": inner}
        kernel: Any = numba.njit(**options)(function)
        with suppress(RuntimeError):  # of no folder that may be written
            kernel._cache = _Kept(function)
        return kernel
    finally:
        function.__qualname__ = name


class _Kept(FunctionCache):
    """What numba keeps on disk; where it cannot be read or written, it is compiled anew."""

    def load_overload(self, *asked: Any) -> Any:
        """What was compiled, or None."""
        try:
            return super().load_overload(*asked)
        except Exception:  # what is damaged may raise any
            with suppress(OSError):
                self.flush()
            return None

    def save_overload(self, *compiled: Any) -> None:
        """Keep it, where there is room."""
        with suppress(OSError):
            super().save_overload(*compiled)


@cache
def sources(module: str) -> str:
    """Hash of a module of this room and of those that it imports from."""
    text = Path(__file__).with_name(f"{module}.py").read_text("utf-8")
    imported = re.findall(rf"^from {re.escape(__package__)}\.(\w+) import", text, re.MULTILINE)
    return sha256("".join([text, *map(sources, imported)]).encode()).hexdigest()[:12]


@contextmanager
def compiling_told(tell: Callable[[], None]) -> Iterator[None]:
    """Call `tell` once, when in the block a kernel is compiled that is not kept on disk."""
    with event.install_listener("numba:compile", _Once(tell)):
        yield


class _Once(event.Listener):
    """Tells of the first event."""

    def __init__(self, tell: Callable[[], None]) -> None:
        self._tell: Callable[[], None] | None = tell

    def on_start(self, event: event.Event) -> None:
        tell, self._tell = self._tell, None
        if tell is not None:
            tell()

    def on_end(self, event: event.Event) -> None:
        """Nothing more to say."""
