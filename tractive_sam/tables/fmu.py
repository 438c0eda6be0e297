"""Write a table as a unit of the Functional Mock-up Interface 2.0 (FMU).

The unit is for co-simulation and model exchange. It consists of the C header of the table and
`unit.c`, compiled for this machine, with the sources, which fmpy compiles for other machines. It
runs without Python.
"""

import hashlib
import os
import shutil
import subprocess
import zipfile
from importlib.resources import files
from os import PathLike
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType
from xml.sax.saxutils import quoteattr

import numpy as np

from tractive_sam.extras import require_extra
from tractive_sam.lookup import CreepTable, arguments_of, c_header, plain_title
from tractive_sam.output_file import write_file
from tractive_sam.store import versions

HEADERS = ("fmi2TypesPlatform.h", "fmi2FunctionTypes.h", "fmi2Functions.h")

UNITS = {
    "mm": 'm="1" factor="1e-3"',
    "1/mm": 'm="-1" factor="1e3"',
    "N": 'kg="1" m="1" s="-2"',
    "MPa": 'kg="1" m="-1" s="-2" factor="1e6"',
    "N.mm": 'kg="1" m="2" s="-2" factor="1e-3"',
}

INPUTS = {
    "xi_x": ("longitudinal creepage", "", 0.0),
    "xi_y": ("lateral creepage", "", 0.0),
    "spin": ("spin", "1/mm", 0.0),
    "a": ("semi-axis in rolling direction", "mm", 1.0),
    "b": ("semi-axis in lateral direction", "mm", 1.0),
    "load": ("normal load", "N", 1000.0),
    "mu": ("coefficient of friction", "", 0.3),
    "shear": ("combined shear modulus", "MPa", 80e3),
}

FORCES = {
    "Qx": ("longitudinal force on body A", "N"),
    "Qy": ("lateral force on body A", "N"),
    "Mz": ("spin moment on body A", "N.mm"),
}


def write_fmu(table: CreepTable, path: str | PathLike[str]) -> bool:
    """Write a table as an FMU; the name of the file is that of its model.

    Returns
    -------
    bool
        Whether it was compiled: without a C compiler it contains only its sources.

    Raises
    ------
    ImportError
        If fmpy is not installed, which has the headers of the interface and checks the unit.
    ValueError
        If the name is not valid in C.
    RuntimeError
        If the compiler fails, or fmpy finds errors in the unit.

    Examples
    --------
    >>> def export_unit(table, path):
    ...     if not ts.write_fmu(table, path):
    ...         print("it contains only sources: fmpy compile adds the binary")
    """
    with require_extra("write_fmu"):
        import fmpy  # noqa: PLC0415 - of an extra
        from fmpy.validation import validate_fmu  # noqa: PLC0415
    path, name = Path(path), Path(path).stem
    header = c_header(table, name)
    with TemporaryDirectory() as folder:
        root, sources = Path(folder), Path(folder, "sources")
        sources.mkdir()
        for include in HEADERS:
            shutil.copy(Path(fmpy.__file__).parent / "c-code" / include, sources)
        (sources / f"{name}.h").write_text(header, encoding="ascii")
        guid = hashlib.sha256(header.encode()).hexdigest()[:32]
        (sources / "unit.c").write_text(_code(table, name, guid), encoding="ascii")
        (root / "modelDescription.xml").write_text(_description(table, name, guid), "utf-8")
        compiled = _compiled(root, name, fmpy)
        content = [file for file in sorted(root.rglob("*")) if file.is_file()]
        unit = root / path.name
        with zipfile.ZipFile(unit, "w", zipfile.ZIP_DEFLATED) as archive:
            for file in content:
                archive.write(file, file.relative_to(root).as_posix())
        problems = validate_fmu(str(unit))
        if problems:
            raise RuntimeError(f"{path}: {'; '.join(problems)}")
        write_file(path, unit.read_bytes())
    return compiled


def _compiled(root: Path, name: str, fmpy: ModuleType) -> bool:
    """Compile the unit for this machine; return whether there is a compiler."""
    compiler = os.environ.get("CC") or "cc"
    if shutil.which(compiler) is None:
        return False
    binaries = root / "binaries" / fmpy.platform
    binaries.mkdir(parents=True)
    library = binaries / f"{name}{fmpy.sharedLibraryExtension}"
    command = [compiler, "-std=c99", "-O2", "-shared", "-fPIC", "-o", str(library), "unit.c", "-lm"]
    completed = subprocess.run(
        command, cwd=root / "sources", capture_output=True, text=True, check=False
    )
    if completed.returncode:
        raise RuntimeError(f"{compiler} cannot compile the unit: {completed.stderr[-500:]}")
    return True


def _code(table: CreepTable, name: str, guid: str) -> str:
    """Return the C code of the functions of the interface."""
    count = len(arguments_of(table))
    given = ", ".join(f"unit->value[{k}]" for k in range(count))
    starts = ", ".join(repr(start) for _, _, start in _inputs(table).values())
    text = (files("tractive_sam.tables") / "unit.c").read_text(encoding="ascii")
    for key, value in {
        "NAME": name, "GUID": guid, "COUNT": str(count), "GIVEN": given, "STARTS": starts,
    }.items():  # fmt: skip
        text = text.replace(f"@{key}@", value)
    return text


def _inputs(table: CreepTable) -> dict[str, tuple[str, str, float]]:
    """Return meaning, unit and start value of each input."""
    inputs = {}
    for name in arguments_of(table):
        if name in table.names:
            inputs[name] = (name, "", float(table.axis(name)[0]))
        else:
            inputs[name] = INPUTS[name]
    if "a" in inputs:  # at an a/b of the table
        meaning, unit, _ = INPUTS["a"]
        inputs["a"] = (meaning, unit, float(np.sqrt(np.prod(table.ellipticity))))
    return inputs


def _outputs() -> dict[str, tuple[str, str]]:
    """Return meaning and unit of each output."""
    return FORCES | {
        f"{force}_by_{by}": (f"derivative of {force} by {by}", "")
        for force in FORCES
        for by in ("xi_x", "xi_y", "spin")
    }


def _description(table: CreepTable, name: str, guid: str) -> str:
    """Return the description of the model (XML)."""
    inputs = _inputs(table)
    variables = [
        _variable(place, one, meaning, unit, 'causality="input"', start)
        for place, (one, (meaning, unit, start)) in enumerate(inputs.items())
    ]
    outputs, first = _outputs(), len(inputs)
    variables += [
        _variable(first + place, one, meaning, unit, 'causality="output" initial="calculated"')
        for place, (one, (meaning, unit)) in enumerate(outputs.items())
    ]
    depends = " ".join(str(k + 1) for k in range(first))
    unknowns = "".join(
        f'<Unknown index="{first + k + 1}" dependencies="{depends}"/>' for k in range(len(outputs))
    )
    units = "".join(
        f"<Unit name={quoteattr(unit)}><BaseUnit {base}/></Unit>" for unit, base in UNITS.items()
    )
    kind = (
        f'modelIdentifier="{name}" canNotUseMemoryManagementFunctions="true" '
        'canGetAndSetFMUstate="true"'
    )
    source = '<SourceFiles><File name="unit.c"/></SourceFiles>'
    version = versions()["tractive-sam"]  # type: ignore[operator]
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="{name}" guid="{guid}"
  description={quoteattr(plain_title(table))} generationTool="tractive_sam {version}"
  variableNamingConvention="flat" numberOfEventIndicators="0">
<ModelExchange {kind}>{source}</ModelExchange>
<CoSimulation {kind} canHandleVariableCommunicationStepSize="true">{source}</CoSimulation>
<UnitDefinitions>{units}</UnitDefinitions>
<LogCategories><Category name="error"/></LogCategories>
<DefaultExperiment startTime="0" stopTime="1"/>
<ModelVariables>
{"".join(variables)}</ModelVariables>
<ModelStructure><Outputs>{unknowns}</Outputs><InitialUnknowns>{unknowns}</InitialUnknowns>
</ModelStructure>
</fmiModelDescription>
"""


def _variable(
    place: int, name: str, meaning: str, unit: str, kind: str, start: float | None = None
) -> str:
    """Return the description of a variable (XML)."""
    real = f" unit={quoteattr(unit)}" if unit else ""
    real += "" if start is None else f' start="{start!r}"'
    about = f'valueReference="{place}" description={quoteattr(meaning)} {kind}'
    variable = f'<ScalarVariable name="{name}" {about} variability="continuous">'
    return f"{variable}<Real{real}/></ScalarVariable>\n"
