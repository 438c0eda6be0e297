"""Write a table as a C header: one function, C99, with the library math only."""

from __future__ import annotations

import re
from keyword import kwlist

import numpy as np

from tractive_sam.lookup.coordinates import CONTACT, LEAST, NAMES, POLE, RATIO, SPIN
from tractive_sam.lookup.creep_table import MARGIN, CreepTable
from tractive_sam.lookup.table_checks import is_identifier

CREEPAGES = ("xi_x", "xi_y", "spin")

C_WORDS = """
auto break case char const continue default do double else enum extern float for goto if inline int
long register restrict return short signed sizeof static struct switch typedef union unsigned void
volatile while"""
"""Reserved words of C (C99, 6.4.1)."""

MEANS = """, semi-axes in rolling and in
   lateral direction (mm), normal load (N), coefficient of friction, combined shear modulus (MPa),
   Poisson's ratio and what else varies"""

HEAD = """\
/* @TITLE@: creep forces, written by tractive_sam.

   int @NAME@(@GIVEN@, force, gradient)

   Creepages and spin (1/mm; one of the three may be infinite)@MEANS@.
   It fills force[3] with Qx, Qy (N) and Mz (N mm) on body A and, unless it is null,
   gradient[9] with their derivatives by xi_x, xi_y, spin, those of Qx first. Returns 0; 1 if a
   creepage is no number or several are infinite, 2 if a property is not positive and finite, 3 if
   a/b is not from @LOW@ to @HIGH@, 4 if another value is outside the table:
@RANGES@   arrays are left as they are then. Tolerance over mu P: @TOLERANCE@.
@GRADIENTS@ */
#ifndef @GUARD@
#define @GUARD@
#include <math.h>
#include <stddef.h>

"""

BODY = """\
/* Weights of value and slope at both ends, or their derivatives: [end][value, slope]. */
static void @NAME@_cubics(double t, double h, int slope, double w[2][2]) {
    double s = 1.0 - t, r = 6.0 * t * s / h;
    w[0][0] = slope ? -r : s * s * (1.0 + 2.0 * t);
    w[0][1] = slope ? s * (1.0 - 3.0 * t) : h * t * s * s;
    w[1][0] = slope ? r : t * t * (3.0 - 2.0 * t);
    w[1][1] = slope ? t * (3.0 * t - 2.0) : -h * t * t * s;
}

/* Interpolated values, or their derivatives by one of the axes (by >= 0). */
static void @NAME@_law(const double *at, int by, double f[3]) {
    double w[@N@][2][2];
    int cell[@N@], k, m, corner, d;
    for (k = 0; k < @N@; k++) {
        const double *x = @NAME@_nodes[k];
        double h, t;
        int i = 0;
        while (i < @NAME@_count[k] - 2 && at[k] >= x[i + 1]) i++;
        h = x[i + 1] - x[i];
        t = (at[k] - x[i]) / h;
        t = t < 0.0 ? 0.0 : t > 1.0 ? 1.0 : t;
        cell[k] = i;
        @NAME@_cubics(t, h, k == by, w[k]);
    }
    f[0] = f[1] = f[2] = 0.0;
    for (corner = 0; corner < (1 << @N@); corner++) {
        long place = 0;
        for (k = 0; k < @N@; k++)
            place = place * @NAME@_count[k] + cell[k] + (corner >> (@N@ - 1 - k) & 1);
        for (d = 0; d < (1 << @N@); d++) {
            double weight = 1.0;
            for (k = 0; k < @N@; k++)
                weight *= w[k][corner >> (@N@ - 1 - k) & 1][d >> (@N@ - 1 - k) & 1];
            for (m = 0; m < 3; m++)
                f[m] += weight * @NAME@_data[(place * (1 << @N@) + d) * 3 + m];
        }
    }
}

static int @NAME@(@ARGUMENTS@, double force[3],
                  double *gradient) {
@CONSTANTS@    const double given[5] = {a, b, load, mu, shear};
    const double every[] = {@ALONG@, 0.0, 0.0, 0.0};
    double w[3] = {xi_x, xi_y, spin}, sign[3] = {1.0, 1.0, 1.0}, scale[3], unit[3], at[@N@], f[3];
    double c, x, y, kappa, t, r, r0, u, heading, tilt;
    int k, m, n, endless = 0;
    for (k = 0; k < 3; k++) {
        if (isnan(w[k])) return 1;
        endless += isinf(w[k]) != 0;
    }
    if (endless > 1) return 1;
    for (k = 0; k < 5; k++)
        if (!(given[k] > 0.0) || isinf(given[k])) return 2;
@CHECKS@    c = sqrt(a * b);
    unit[0] = unit[1] = mu * load;
    unit[2] = mu * load * c;
    scale[0] = scale[1] = shear * (c * c) / (mu * load);
    scale[2] = scale[0] * c;
    for (k = 0; k < 3; k++) {
        w[k] *= scale[k];
        if (endless) w[k] = isinf(w[k]) ? (w[k] > 0.0 ? 1.0 : -1.0) : 0.0;
    }
    if (w[2] < 0.0 && !@WHOLE@) sign[1] = sign[2] = -1.0;
    if (w[0] < 0.0 && !@WHOLE@) sign[0] = -1.0;
    x = sign[0] * w[0] + 0.0; /* of -0, atan2 would make a heading of pi */
    y = sign[1] * w[1] + 0.0;
    kappa = sign[2] * w[2] * @SPIN@;
    r0 = 2.0 / (3.2 + 0.9 * (a / b));
    t = hypot(x, y);
    r = hypot(t, kappa);
    u = endless ? 1.0 : r / (r + r0);
    heading = atan2(y, x);
    tilt = atan2(kappa, t);
    for (k = 0; k < @N@ - 3; k++) at[k] = every[@NAME@_axis[k]];
    at[@N@ - 3] = heading;
    at[@N@ - 2] = tilt;
    at[@N@ - 1] = u;
    @NAME@_law(at, -1, f);
    for (k = 0; k < 3; k++) force[k] = unit[k] * sign[k] * f[k];
    if (gradient) {
        double ch = cos(heading), sh = sin(heading), ct = cos(tilt), st = sin(tilt), stretch;
        double by[3][3], slope[3][3] = {{0.0}};
        const double most = 0.5 * @PI@ - @POLE@;
        at[@N@ - 2] = tilt > most ? most : tilt < -most ? -most : tilt;
        at[@N@ - 1] = u < @LEAST@ ? @LEAST@ : u;
        if (t < @POLE@ * r) t = @POLE@ * r;
        if (r <= @LEAST@ * r0) r = t = @LEAST@ * r0;
        stretch = r0 / (r + r0) / (r + r0);
        by[0][0] = -sh / t;
        by[0][1] = ch / t;
        by[0][2] = 0.0;
        by[1][0] = -st * ch / r;
        by[1][1] = -st * sh / r;
        by[1][2] = @SPIN@ * ct / r;
        by[2][0] = stretch * ct * ch;
        by[2][1] = stretch * ct * sh;
        by[2][2] = @SPIN@ * stretch * st;
        for (k = 0; k < 3; k++) {
            @NAME@_law(at, @N@ - 3 + k, f);
            for (m = 0; m < 3; m++) slope[m][k] = f[m];
        }
        for (m = 0; m < 3; m++)
            for (n = 0; n < 3; n++) {
                double sum = 0.0;
                for (k = 0; k < 3; k++) sum += slope[m][k] * by[k][n];
                gradient[3 * m + n] = endless ? 0.0 : unit[m] * sign[m] * sum * sign[n] * scale[n];
            }
    }
    return 0;
}
#endif
"""


def c_header(table: CreepTable, name: str = "creep_forces") -> str:
    """Return the text of a header with a function that returns the forces and gradients.

    Parameters
    ----------
    table : CreepTable
        The table.
    name : str
        Name of the function.

    Raises
    ------
    ValueError
        If C does not allow the name, or if an axis has the name of a variable of the function.
    """
    check_name(name)
    for axis in table.names:
        check_axis_name(axis)
    text = HEAD + _define_arrays(table) + BODY
    for key, value in (_describe(table) | {"GUARD": f"{name.upper()}_H", "NAME": name}).items():
        text = text.replace(f"@{key}@", value)
    return text


def _describe(table: CreepTable) -> dict[str, str]:
    """Return the texts and numbers of a table by their names in the template."""
    low, high = table.ellipticity
    arguments = arguments_of(table)
    return {
        "TITLE": plain_title(table),
        "GIVEN": ", ".join(arguments),
        "ARGUMENTS": ",\n                  ".join(f"double {argument}" for argument in arguments),
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
        "LEAST": _number(LEAST),
        "POLE": _number(POLE),
        "PI": _number(np.pi),
        "N": str(len(table.law.varying)),
    }


def _define_arrays(table: CreepTable) -> str:
    """Return the definitions of the nodes and coefficients of a table."""
    axes, varies = table.law.axes, table.law.varying
    data = _numbers(table.law.coefficients[..., table.law.kept, :])
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
    words = re.findall(r"[A-Za-z]\w*", BODY)
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
    return repr(float(value))


def _numbers(values: np.ndarray) -> str:
    flat = [repr(value) for value in values.ravel().tolist()]
    lines = (", ".join(flat[k : k + 6]) for k in range(0, len(flat), 6))
    return "\n" + ",\n".join(lines) + "\n"
