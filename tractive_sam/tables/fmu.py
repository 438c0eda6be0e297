"""Write a table as a unit of the Functional Mock-up Interface (FMU), version 2.0 or 3.0.

The unit is for co-simulation and model exchange. It consists of the C sources of the table and of
the interface, compiled for this machine; fmpy compiles them for other machines. It runs without
Python.
"""

import hashlib
import os
import shutil
import subprocess
import zipfile
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Literal

from tractive_sam.extras import require_extra
from tractive_sam.lookup import CreepTable, c_sources, fill_template
from tractive_sam.output_file import write_file
from tractive_sam.tables.fmu_description import Description2, Description3, list_inputs


@dataclass(frozen=True)
class _FmiVersion:
    """Files and names that differ between FMI 2 and FMI 3, to write a unit (FMU).

    Attributes
    ----------
    headers : tuple of str
        Headers, which fmpy contains.
    source : str
        File of this package with the functions.
    description : type
        Writes the description.
    platform : str
        Attribute of fmpy that names the folder of binaries.
    """

    headers: tuple[str, ...]
    source: str
    description: type[Description2]
    platform: str


VERSIONS = {
    2: _FmiVersion(
        ("fmi2TypesPlatform.h", "fmi2FunctionTypes.h", "fmi2Functions.h"),
        "unit2.c",
        Description2,
        "platform",
    ),
    3: _FmiVersion(
        ("fmi3PlatformTypes.h", "fmi3FunctionTypes.h", "fmi3Functions.h"),
        "unit3.c",
        Description3,
        "platform_tuple",
    ),
}
"""Versions of the interface."""


def write_fmu(table: CreepTable, path: str | PathLike[str], fmi: Literal[2, 3] = 2) -> bool:
    """Write a table as an FMU (zip); return whether it holds a binary for this machine.

    Parameters
    ----------
    table : CreepTable
        The table.
    path : path-like
        The file.
    fmi : 2 or 3
        Version of the interface, 2.0 or 3.0.

    Returns
    -------
    bool
        Whether it was compiled: without a C compiler it contains only its sources.

    Raises
    ------
    ImportError
        If fmpy is not installed, which has the headers of the interface and checks the unit.
    ValueError
        If the name is not valid in C, or the version of FMI is not 2 or 3.
    RuntimeError
        If the compiler fails, or fmpy finds errors in the unit.

    Examples
    --------
    >>> def export_unit(table, path):
    ...     if not ts.write_fmu(table, path):
    ...         print("it contains only sources: fmpy compile adds the binary")
    """
    if fmi not in VERSIONS:
        raise ValueError(f"fmi is {fmi!r}; allowed: 2 or 3")
    with require_extra("write_fmu"):
        import fmpy  # noqa: PLC0415 - of an extra
        from fmpy.validation import validate_fmu  # noqa: PLC0415
    path, name, version = Path(path), Path(path).stem, VERSIONS[fmi]
    generated = c_sources(table, name)
    token = hashlib.sha256("".join(generated.values()).encode()).hexdigest()[:32]
    generated |= _interface(table, name, token, version)
    with TemporaryDirectory() as folder:
        root, sources = Path(folder), Path(folder, "sources")
        sources.mkdir()
        for include in version.headers:
            shutil.copy(Path(fmpy.__file__).parent / "c-code" / include, sources)
        for file, text in generated.items():
            (sources / file).write_text(text, encoding="ascii")
        for file, text in version.description(table, name, token).files.items():
            (root / file).write_text(text, encoding="utf-8")
        compiled = _compile(root, name, getattr(fmpy, version.platform), fmpy)
        content = [entry for entry in sorted(root.rglob("*")) if entry.is_file()]
        unit = root / path.name
        with zipfile.ZipFile(unit, "w", zipfile.ZIP_DEFLATED) as archive:
            for entry in content:
                archive.write(entry, entry.relative_to(root).as_posix())
        problems = validate_fmu(str(unit))
        if problems:
            raise RuntimeError(f"{path}: {'; '.join(problems)}")
        write_file(path, unit.read_bytes())
    return compiled


def _compile(root: Path, name: str, platform: str, fmpy: ModuleType) -> bool:
    """Compile the FMU in a folder for this machine; return False without a compiler."""
    compiler = os.environ.get("CC") or "cc"
    if shutil.which(compiler) is None:
        return False
    binaries = root / "binaries" / platform
    binaries.mkdir(parents=True)
    library = binaries / f"{name}{fmpy.sharedLibraryExtension}"
    sources = ["unit.c", f"{name}.c", "-lm"]
    command = [compiler, "-std=c99", "-O2", "-shared", "-fPIC", "-o", str(library), *sources]
    completed = subprocess.run(
        command, cwd=root / "sources", capture_output=True, text=True, check=False
    )
    if completed.returncode:
        raise RuntimeError(f"{compiler} cannot compile the FMU: {completed.stderr[-500:]}")
    return True


def _interface(table: CreepTable, name: str, token: str, version: _FmiVersion) -> dict[str, str]:
    """Return the C source of the FMI functions for a table, by file name."""
    inputs = list_inputs(table)
    values = {
        "NAME": name,
        "TOKEN": token,
        "COUNT": str(len(inputs)),
        "GIVEN": ", ".join(f"input[{k}]" for k in range(len(inputs))),
        "STARTS": ", ".join(repr(variable.start) for variable in inputs),
    }
    templates = {"unit.h": "unit.h", "unit.c": version.source}
    return {
        file: fill_template("tractive_sam.tables", template, values)
        for file, template in templates.items()
    }
