"""Transmitted force against creepage, as eq. (40) makes it dimensionless."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import cycle

import numpy as np
from numpy.typing import ArrayLike

from tractive_sam.plot.figure import Figure
from tractive_sam.plot.style import GREY, WIDTH, styled
from tractive_sam.reference import kalker_simplified, vermeulen_johnson

MARKERS = "so^Dv"

Points = tuple[ArrayLike, ArrayLike]


@styled
def creep_force_curve(
    computed: Mapping[str, Points],
    reference: Mapping[str, Points] | None = None,
    *,
    theory: bool = True,
) -> Figure:
    """Creep-force curve of a circular contact.

    Parameters
    ----------
    computed : mapping of str to pair of array_like
        Name of a series, its creep parameters (`reference.creep_parameter`) and its forces
        Q/(mu P).
    reference : mapping of str to pair of array_like, optional
        Points of other programs or of measurements, alike.
    theory : bool
        Whether to draw Vermeulen & Johnson's and Kalker's simplified curve.

    Examples
    --------
    >>> plot.creep_force_curve({"computed": ([0.2, 0.5], [0.43, 0.82])})
    <Figure size ...>
    """
    reference = reference or {}
    figure = Figure(figsize=(WIDTH, 0.72 * WIDTH))
    axes = figure.add_subplot()
    for marker, (name, (xi, force)) in zip(cycle(MARKERS), computed.items(), strict=False):
        axes.plot(xi, force, marker, label=name, markerfacecolor="none", markeredgewidth=1.2)
    for marker, (name, (xi, force)) in zip(cycle("x+*"), reference.items(), strict=False):
        axes.plot(xi, force, marker, label=name, color=GREY)
    if theory:
        ends = [np.max(xi) for xi, _ in (*computed.values(), *reference.values())]
        xi = np.linspace(0.0, max(1.0, *ends), 201)
        axes.plot(xi, vermeulen_johnson(xi), "--", color=GREY, label="Vermeulen & Johnson (1964)")
        axes.plot(xi, kalker_simplified(xi), "-", color=GREY, label="Kalker (1967), simplified")
    axes.set(xlabel=r"$-\xi_x\,16\,G a_0^2\,/\,3\mu P(4-3\nu)$", ylabel=r"$Q/(\mu P)$")
    axes.set_xlim(left=0.0)
    axes.legend(loc="lower right")
    return figure
