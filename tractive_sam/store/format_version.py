"""Versions of Python and of the packages that determine the numbers."""

import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version

FORMAT = "tractive-sam history"
FORMAT_VERSION = 2
"""Increased when readers of the version before would misread the file. Version 1 is still read, see
`legacy_format`. A new column needs no new version: a missing column reads as nan."""


def versions() -> dict[str, str]:
    """Return the versions of Python, this package and the five it computes with, by name."""
    packages = ("tractive-sam", "numpy", "scipy", "numba", "pyfftw", "h5py")
    return {"python": platform.python_version()} | {name: _version(name) for name in packages}


@cache  # reading the description of a package takes milliseconds
def _version(package: str) -> str:
    """Return the version of an installed package, or a note that it is missing."""
    try:
        return version(package)
    except PackageNotFoundError:  # run from a source tree
        return "not installed"
