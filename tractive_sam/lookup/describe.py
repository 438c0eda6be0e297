"""The description of a table of creep forces."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from tractive_sam.description import Description, Section
from tractive_sam.lookup.coordinates import CONTACT, NAMES, RATIO


def describe_table(
    axes: Mapping[str, np.ndarray],
    about: Mapping[str, Any],
    apart: Sequence[str],
    full_range: bool,
    contact: Mapping[str, float] | None,
) -> Description:
    """Describe the range of a table, its errors, and its use.

    Parameters
    ----------
    axes : mapping of str to ndarray
        Nodes along every axis, creepages last.
    about, apart, whole, contact
        See the attributes of `CreepTable`.
    """
    nodes = [describe_axis(name, nodes, name in apart) for name, nodes in axes.items()]
    total = math.prod(len(nodes) for nodes in axes.values())
    made = [("version", str(about.get("version", "unknown")))]
    if {"contacts", "cpu_seconds"} <= about.keys():
        spent = f"{about['contacts']} contacts, {about['cpu_seconds']:.3g} s of one core"
        made.append(("solved", spent))
    varying = [name for name in axes if name not in (RATIO, *NAMES) and len(axes[name]) > 1]
    arguments = [f"{name}=..." for name in (*(() if contact else CONTACT), *varying)]
    call = f"table({', '.join(('xi_x', 'xi_y', 'spin', *arguments))})"
    use = [
        ("in Python", f"table = ts.open_table(FILE); {call}"),
        ("elsewhere", "tractive-sam table FILE, with --header, --fmu, --text or --figure"),
    ]
    return Description((
        Section("Table of creep forces", describe_range(contact, full_range)),
        Section("Nodes", [*nodes, ("total", str(total))]),
        Section("Errors", _describe_errors(about)),
        Section("Made by", made),
        Section("Use", use),
    ))  # fmt: skip


def describe_range(contact: Mapping[str, float] | None, full_range: bool) -> list[tuple[str, str]]:
    """Describe the contacts and the creepages of a table."""
    contacts = "any Hertz contact of equal materials, with isotropic friction"
    quarter = "a quarter of all; the others follow by two symmetries"
    if contact is not None:
        a, b, load, mu, shear = (contact[key] for key in CONTACT)
        scales = f"a = {a:.4g} mm, b = {b:.4g} mm, P = {load:.4g} N, mu = {mu:g}"
        contacts = f"one scene; scaled by {scales}, G = {shear:.4g} MPa"
    return [
        ("contacts", contacts),
        ("creepages", "all headings and tilts" if full_range else quarter),
    ]


def describe_axis(name: str, nodes: np.ndarray, apart: bool) -> tuple[str, str]:
    """Describe the nodes along an axis; `apart`: without interpolation between them."""
    if name == RATIO:
        name, nodes = "a/b", np.exp(nodes)
    if len(nodes) == 1:
        return name, f"{nodes[0]:.4g}"
    if apart:
        return name, ", ".join(f"{node:.6g}" for node in nodes) + ", without interpolation"
    return name, f"{len(nodes)} from {nodes[0]:.4g} to {nodes[-1]:.4g}"


def _describe_errors(about: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Describe the tolerance and the measured errors of forces and gradients."""
    errors = [("tolerance", f"{float(about.get('tolerance', math.nan)):g} of mu P")]
    if "held_out" in about:
        errors.append((
            f"{about['held_out']} points held out",
            f"{about['held_out_median']:.1e} of mu P in the median, {about['held_out_worst']:.1e} "
            f"at most; {about['held_out_inside']:.1%} within the error that the table reports",
        ))  # fmt: skip
    gradients = "errors unknown; tractive-sam table FILE.nc -o NEW.nc computes them"
    if "gradient_checks" in about:
        gradients = (
            f"at rest within {about['gradient_at_rest']:.1e} of sqrt(K_ii K_jj), K_ii the slopes "
            f"at rest; at {about['gradient_checks']} points {about['gradient_median']:.1e} in the "
            f"median, {about['gradient_worst']:.1e} at most, {about['gradient_inside']:.1%} within "
            "error bars"
        )
    return [*errors, ("gradients", gradients)]
