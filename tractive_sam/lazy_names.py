"""Names of a package that are looked up when first used, also in a zip archive."""

import os
from typing import Any

import lazy_loader  # type: ignore[import-untyped]


def attach_names(package: str, file: str) -> tuple[Any, Any, list[str]]:
    """Return `__getattr__`, `__dir__` and `__all__` of a package from its `__init__.pyi`.

    Parameters
    ----------
    package : str
        Name of the package.
    file : str
        Path of its `__init__.py`, perhaps within an archive.
    """
    stub = f"{os.path.splitext(file)[0]}.pyi"
    if os.path.exists(stub):
        return lazy_loader.attach_stub(package, stub)
    from importlib.resources import as_file, files  # noqa: PLC0415 - takes time to load

    with as_file(files(package) / "__init__.pyi") as extracted:
        return lazy_loader.attach_stub(package, str(extracted))
