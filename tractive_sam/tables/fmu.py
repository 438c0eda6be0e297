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
from collections.abc import Mapping
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import ClassVar, Literal
from xml.sax.saxutils import quoteattr

import numpy as np

from tractive_sam.extras import require_extra
from tractive_sam.lookup import CreepTable, arguments_of, c_sources, fill_template, plain_title
from tractive_sam.output_file import write_file
from tractive_sam.store import versions


@dataclass(frozen=True)
class FmuVariable:
    """Input or output variable of an FMU: name, meaning, unit, start value and limits.

    Attributes
    ----------
    name, meaning, unit : str
        The unit is one of `unit_texts`.
    start : float, optional
        Value before the start of an input; an output has none.
    low, high : float
        Limits.
    """

    name: str
    meaning: str
    unit: str
    start: float | None = None
    low: float = -1e30
    high: float = 1e30

    @property
    def kind(self) -> str:
        """XML attributes of causality and variability; an input with one value is a parameter."""
        if self.start is None:
            return 'causality="output" variability="continuous" initial="calculated"'
        if self.is_fixed:
            return 'causality="parameter" variability="fixed" initial="exact"'
        return 'causality="input" variability="continuous"'

    @property
    def is_fixed(self) -> bool:
        """Whether both limits are equal, so that the variable has one allowed value."""
        return self.low == self.high

    def describe(self, place: int) -> str:
        """XML attributes of the variable at a place in the list of all: name, meaning, kind."""
        named = f"name={quoteattr(self.name)} valueReference={quoteattr(str(place))}"
        return f"{named} description={quoteattr(self.meaning)} {self.kind}"

    @property
    def numbers(self) -> str:
        """XML attributes of unit, limits and start value."""
        limits = f'unit={quoteattr(self.unit)} min="{self.low!r}" max="{self.high!r}"'
        return limits if self.start is None else f'{limits} start="{self.start!r}"'


_INPUTS = {
    variable.name: variable
    for variable in (
        FmuVariable("xi_x", "longitudinal creepage", "1", 0.0),
        FmuVariable("xi_y", "lateral creepage", "1", 0.0),
        FmuVariable("spin", "spin", "1/mm", 0.0),
        FmuVariable("a", "semi-axis in rolling direction", "mm", 1.0, 0.0),
        FmuVariable("b", "semi-axis in lateral direction", "mm", 1.0, 0.0),
        FmuVariable("load", "normal load; 0 of separated bodies", "N", 1000.0, 0.0),
        FmuVariable("mu", "coefficient of friction", "1", 0.3, 0.0),
        FmuVariable("shear", "combined shear modulus", "MPa", 80e3, 0.0),
    )
}


def list_inputs(table: CreepTable) -> list[FmuVariable]:
    """Return the input variables of the FMU of a table, in the order of its C function."""
    inputs = []
    for name in arguments_of(table):
        if name in table.names:
            nodes = table.axis(name)
            low, high = float(nodes[0]), float(nodes[-1])
            inputs.append(FmuVariable(name, name, "1", low, low, high))
        elif name == "a":  # at an a/b of the table
            inputs.append(replace(_INPUTS[name], start=float(np.sqrt(np.prod(table.ellipticity)))))
        else:
            inputs.append(_INPUTS[name])
    return inputs


def list_outputs() -> list[FmuVariable]:
    """Return the output variables of an FMU: three forces, then their nine derivatives."""
    forces = (
        FmuVariable("Qx", "longitudinal force on body A", "N"),
        FmuVariable("Qy", "lateral force on body A", "N"),
        FmuVariable("Mz", "spin moment on body A", "N.mm"),
    )
    slopes = {("N", "1/mm"): "N.mm", ("N.mm", "1/mm"): "N.mm2"}
    creepages = [_INPUTS[name] for name in ("xi_x", "xi_y", "spin")]
    return [
        *forces,
        *(
            FmuVariable(
                f"{force.name}_by_{by.name}",
                f"derivative of {force.name} by {by.name}",
                slopes.get((force.unit, by.unit), force.unit),
            )
            for force in forces
            for by in creepages
        ),
    ]


class Description2:
    """XML description of the FMU of a table for FMI 2.0.

    Parameters
    ----------
    table : CreepTable
        The table.
    name : str
        Name of the model.
    token : str
        Number by which the library recognises its description.
    """

    unit_texts: ClassVar[Mapping[str, str]] = {
        "1": "",
        "mm": 'm="1" factor="1e-3"',
        "1/mm": 'm="-1" factor="1e3"',
        "N": 'kg="1" m="1" s="-2"',
        "MPa": 'kg="1" m="-1" s="-2" factor="1e6"',
        "N.mm": 'kg="1" m="2" s="-2" factor="1e-3"',
        "N.mm2": 'kg="1" m="3" s="-2" factor="1e-6"',
    }
    """Base units of each unit, and the factor to them."""

    def __init__(self, table: CreepTable, name: str, token: str):
        inputs, outputs = list_inputs(table), list_outputs()
        self.sources, self.variables = ("unit.c", f"{name}.c"), [*inputs, *outputs]
        self.varying = [k for k, variable in enumerate(inputs) if not variable.is_fixed]
        self.outputs = range(len(inputs), len(self.variables))
        units = (
            f"<Unit name={quoteattr(unit)}><BaseUnit {base}/></Unit>"
            for unit, base in self.unit_texts.items()
        )
        self.values = {
            "NAME": name,
            "TOKEN": token,
            "TITLE": quoteattr(plain_title(table)),
            "TOOL": quoteattr(f"tractive_sam {versions()['tractive-sam']}"),
            "UNITS": "".join(units),
        }

    @property
    def files(self) -> dict[str, str]:
        """Content of the XML files by path in the FMU: modelDescription.xml."""
        depends = " ".join(str(k + 1) for k in self.varying)
        return {
            "modelDescription.xml": self._fill(
                "fmu2.xml",
                SOURCES="".join(f'<File name="{file}"/>' for file in self.sources),
                VARIABLES="".join(
                    f"<ScalarVariable {variable.describe(place)}><Real {variable.numbers}/>"
                    "</ScalarVariable>\n"
                    for place, variable in enumerate(self.variables)
                ),
                UNKNOWNS="".join(
                    f'<Unknown index="{k + 1}" dependencies="{depends}"/>' for k in self.outputs
                ),
            )
        }

    def _fill(self, file: str, **values: str) -> str:
        """Return the text of a template with these values and those of all templates."""
        return fill_template("tractive_sam.tables", file, values | self.values)


class Description3(Description2):
    """XML description of the FMU of a table for FMI 3.0 (parameters as `Description2`)."""

    @property
    def files(self) -> dict[str, str]:
        """Content of the XML files by path in the FMU: modelDescription.xml, list of sources."""
        depends = " ".join(map(str, self.varying))
        model = self._fill(
            "fmu3.xml",
            TIME=str(len(self.variables)),
            VARIABLES="".join(
                f"<Float64 {variable.describe(place)} {variable.numbers}/>\n"
                for place, variable in enumerate(self.variables)
            ),
            OUTPUTS="".join(
                f'<{element} valueReference="{k}" dependencies="{depends}"/>'
                for element in ("Output", "InitialUnknown")
                for k in self.outputs
            ),
        )
        sources = "".join(f'<SourceFile name="{file}"/>' for file in self.sources)
        build = self._fill("build3.xml", SOURCES=sources)
        return {"modelDescription.xml": model, "sources/buildDescription.xml": build}


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
