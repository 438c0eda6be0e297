"""Packages of extras, and the message for a missing one."""

from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec

EXTRAS = {
    "dask": "study",
    "distributed": "study",
    "fmpy": "fmu",
    "h5netcdf": "study",
    "pandas": "study",
    "plotly": "report",
    "xarray": "study",
}
"""The extra that installs a package, by package."""


class MissingExtraError(ImportError):
    """Error: a package of an optional extra is not installed; the message states the command."""


def describe_missing(purpose: str, package: str) -> str:
    """Return the message for a missing package: the purpose, the extra and the command."""
    extra = EXTRAS[package]
    return (
        f"{purpose}: {package} is not installed; it comes with the extra {extra}: "
        f"pip install '.[{extra}]' in the source folder of tractive_sam"
    )


def check_extra(package: str, purpose: str) -> None:
    """Raise a MissingExtraError if a package of an optional extra is not installed.

    Parameters
    ----------
    package : str
        A package of `EXTRAS`.
    purpose : str
        The feature that needs the package, for example "--fmu".

    Raises
    ------
    MissingExtraError
        If the package is not installed.
    """
    if find_spec(package) is None:
        raise MissingExtraError(describe_missing(purpose, package), name=package)


@contextmanager
def require_extra(purpose: str) -> Iterator[None]:
    """Raise a MissingExtraError if an import in the block fails for a package of an extra.

    Parameters
    ----------
    purpose : str
        The feature that needs the packages, for example "history.to_xarray".

    Raises
    ------
    MissingExtraError
        If an optional package is not installed.
    """
    try:
        yield
    except ImportError as error:
        package = (error.name or "").partition(".")[0]
        if package not in EXTRAS or isinstance(error, MissingExtraError):
            raise
        message = describe_missing(purpose, package)
        raise MissingExtraError(message, name=package) from None
