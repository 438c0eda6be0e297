"""Versions of the programs that compute and store."""

import platform
from importlib.metadata import PackageNotFoundError, version

PACKAGES = ("tractive-sam", "numpy", "scipy", "numba", "pyfftw", "h5py")


def versions() -> dict[str, str]:
    """Versions of Python and of the packages that numbers depend on, by name."""
    return {"python": platform.python_version()} | {name: _version(name) for name in PACKAGES}


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:  # run from a source tree
        return "not installed"
