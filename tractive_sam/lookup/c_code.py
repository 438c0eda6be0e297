"""Write a table as C99: a header with one function, and its source, which needs only libm."""

import re
from collections.abc import Mapping
from importlib.resources import files
from keyword import kwlist

import numpy as np

from tractive_sam.lookup.creep_table import MARGIN, CreepTable, is_identifier
from tractive_sam.lookup.hermite import CONTACT, MIN_RADIUS, NAMES, POLE, RATIO, SPIN

CREEPAGES = ("xi_x", "xi_y", "spin")

C_WORDS = """
auto break case char const continue default do double else enum extern float for goto if inline int
long register restrict return short signed sizeof static struct switch typedef union unsigned void
volatile while"""
"""Reserved words of C (C99, 6.4.1)."""

MEANS = """, semi-axes in rolling and in
   lateral direction (mm), normal load (N), coefficient of friction, combined shear modulus (MPa),
   Poisson's ratio and what else varies"""


def c_sources(table: CreepTable, name: str = "creep_forces") -> dict[str, str]:
    """Return a header and a source with a function that returns the forces and gradients.

    Parameters
    ----------
    table : CreepTable
        The table.
    name : str
        Name of the function and of the files.

    Returns
    -------
    dict of str to str
        Text of each file, by its name: NAME.h and NAME.c.

    Raises
    ------
    ValueError
        If C does not allow the name, or if an axis has the name of a variable of the function.
    """
    check_name(name)
    for axis in table.names:
        check_axis_name(axis)
    values = {"DATA": _define_arrays(table)} | _describe(table)
    values |= {"GUARD": f"{name.upper()}_H", "NAME": name}
    return {
        f"{name}{suffix}": fill_template("tractive_sam.lookup", f"law{suffix}", values)
        for suffix in (".h", ".c")
    }


def fill_template(package: str, file: str, values: Mapping[str, str]) -> str:
    """Return the text of a file of a package, with each "@KEY@" replaced by its value, in order."""
    text = (files(package) / file).read_text(encoding="ascii")
    for key, value in values.items():
        text = text.replace(f"@{key}@", value)
    return text


def _describe(table: CreepTable) -> dict[str, str]:
    """Return the texts and numbers of a table by their names in the template."""
    low, high = table.ellipticity
    arguments = arguments_of(table)
    return {
        "TITLE": plain_title(table),
        "GIVEN": ", ".join(arguments),
        "ARGUMENTS": ",\n           ".join(f"double {argument}" for argument in arguments),
        "MEANS": "" if table.contact else MEANS,
        "RANGES": "".join(
            _describe_values(table, name) for name in arguments if name in table.names
        ),
        "CONSTANTS": "".join(
            f"    const double {key} = {_number(value)};\n"
            for key, value in (table.contact or {}).items()
        ),
        "ALONG": ", ".join("log(a / b)" if axis == RATIO else axis for axis in table.names)
        or "0.0",
        "CHECKS": "".join(_check_of_axis(table, axis) for axis in table.names),
        "WHOLE": str(int(table.whole)),
        "TOLERANCE": f"{float(table.about.get('tolerance', np.nan)):g}",
        "GRADIENTS": _describe_gradients(table),
        "LOW": f"{low:.6g}",
        "HIGH": f"{high:.6g}",
        "SPIN": _number(SPIN),
        "MIN_RADIUS": _number(MIN_RADIUS),
        "POLE": _number(POLE),
        "PI": _number(np.pi),
        "N": str(len(table.law.varying)),
    }


def _define_arrays(table: CreepTable) -> str:
    """Return the definitions of the nodes and coefficients of a table."""
    axes, varies = table.law.axes, table.law.varying
    data = _numbers(table.law.coefficients[..., table.law.derivative_indices, :])
    parts = [f"static const double @NAME@_nodes_{k}[] = {{{_numbers(axes[k])}}};\n" for k in varies]
    listed = ", ".join(f"@NAME@_nodes_{k}" for k in varies)
    parts += [
        f"static const double *const @NAME@_nodes[] = {{{listed}}};\n",
        f"static const int @NAME@_count[] = {{{', '.join(str(len(axes[k])) for k in varies)}}};\n",
        f"static const int @NAME@_axis[] = {{{', '.join(map(str, varies))}}};\n",
        f"static const double @NAME@_data[] = {{{data}}};\n\n",
    ]
    return "".join(parts)


def check_name(name: str) -> None:
    """Check that a name is allowed for a function of C.

    Raises
    ------
    ValueError
        If it is not allowed.
    """
    if not is_identifier(name) or name in C_WORDS.split():
        raise ValueError(
            f"{name!r} is not allowed as a name in C, and the function has the name of the file; "
            "allowed: letters, digits and _"
        )


def check_axis_name(name: str, further: bool = False) -> None:
    """Check that a name is allowed for an axis of a table, in C, Python and XML.

    Parameters
    ----------
    name : str
        The name.
    further : bool
        Whether the axis is neither a/b nor Poisson's ratio, and needs another name.

    Raises
    ------
    ValueError
        If it is not allowed; the message states what is allowed.
    """
    if name in (RATIO, "poisson") and not further:
        return
    if not is_identifier(name) or name in _reserved_names():
        raise ValueError("a name of letters, digits and _ that tables, C and Python do not reserve")


def _reserved_names() -> set[str]:
    """Return the names that an axis cannot have: arguments, and reserved words of C and Python."""
    words = re.findall(r"[A-Za-z]\w*", fill_template("tractive_sam.lookup", "law.c", {}))
    return {RATIO, "poisson", "self", "Qx", "Qy", "Mz", *NAMES, *words, *C_WORDS.split(), *kwlist}


def arguments_of(table: CreepTable) -> list[str]:
    """Return the names of the arguments of the function."""
    contact = [] if table.contact else CONTACT
    return [*CREEPAGES, *contact, *(name for name in table.names if name != RATIO)]


def plain_title(table: CreepTable) -> str:
    """Return the title without characters that comments of C or attributes of XML forbid."""
    title = str(table.about.get("title", ""))
    return re.sub(r"[^\w ,.;:()-]", " ", title, flags=re.ASCII) or "A table"


def _describe_gradients(table: CreepTable) -> str:
    """Return the error bars of gradients at rest, as lines of a comment."""
    if table.gradient_bars is None:
        return "   Error bars of gradients are not known."
    rest = table.gradient_bars[0].max(axis=1)
    forces = ", ".join(f"{bar:.1e}" for bar in rest)
    return (
        f"   Error bars of gradients at rest, over sqrt(K_ii K_jj), K_ii the slopes at rest:\n"
        f"   {forces} of Qx, Qy, Mz; elsewhere see gradient_error of the table in Python."
    )


def _describe_values(table: CreepTable, name: str) -> str:
    """Return the allowed values of an axis, as a line of a comment."""
    nodes = table.axis(name)
    if name in table.apart:
        return f"   {name} is one of {', '.join(f'{node:g}' for node in nodes)};\n"
    return f"   {name} is from {nodes[0]:.6g} to {nodes[-1]:.6g};\n"


def _check_of_axis(table: CreepTable, name: str) -> str:
    """Return the line of C that refuses values outside an axis."""
    nodes, value = table.axis(name), "every[0]" if name == RATIO else name
    if name in table.apart:
        near = f"{_number(MARGIN)} * (1.0 + fabs({value}))"
        inside = " || ".join(f"fabs({value} - {_number(node)}) <= {near}" for node in nodes)
    else:
        low, high, near = _number(nodes[0]), _number(nodes[-1]), _number(MARGIN)
        inside = f"{value} >= {low} - {near} && {value} <= {high} + {near}"
    return f"    if (!({inside})) return {3 if name == RATIO else 4};\n"


def _number(value: float) -> str:
    """Format a number for C."""
    return repr(float(value))


def _numbers(values: np.ndarray) -> str:
    """Format an array of numbers for C, six a line."""
    flat = [repr(value) for value in values.ravel().tolist()]
    lines = (", ".join(flat[k : k + 6]) for k in range(0, len(flat), 6))
    return "\n" + ",\n".join(lines) + "\n"
