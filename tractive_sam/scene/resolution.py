"""Smallest number of elements that resolves a contact."""

import math
from dataclasses import dataclass

from tractive_sam.mechanics import HertzContact, HertzLine
from tractive_sam.schema import warn

from .tables import Mesh


@dataclass(frozen=True)
class FewestElements:
    """Smallest numbers of elements across a contact that resolve contact and slip.

    Attributes
    ----------
    contact : int
        For the contact itself: with one or two elements its extent and its pressure depend on the
        mesh only, and no element has neighbours in contact on both sides.
    slip : int
        Number that resolves a stick and a slip area.
    """

    contact: int = 3
    slip: int = 8


def warn_if_coarse(grid: Mesh, contact: HertzContact | HertzLine, margin: float = 1.15) -> None:
    """Issue a warning if a grid is too coarse to resolve the Hertz contact.

    Parameters
    ----------
    grid : Mesh
        The grid of the scene.
    contact : HertzContact or HertzLine
        The unworn contact on it.
    margin : float
        Advised half length over the semi-axis, as for a chosen mesh.
    """
    if grid.elements is None:
        return
    elements = grid.elements if len(grid.elements) > 1 else grid.elements[0]
    semi_axes = (contact.a, contact.b)[: len(grid.elements)]
    half_length = grid.half_length or semi_axes
    sides = [*zip("xy", grid.elements, half_length, semi_axes, strict=False)]
    across = [n * semi_axis / half for _, n, half, semi_axis in sides]
    if min(across) >= FewestElements.slip:
        return
    if min(across) < FewestElements.contact:
        covered = " x ".join(f"{count:.2g}" for count in across)
        advised = ", ".join(f"{margin * semi_axis:.3g}" for semi_axis in semi_axes)
        fewest = math.ceil(FewestElements.slip * margin)
        needed = (
            f" and at least {fewest} elements per direction" if min(grid.elements) < fewest else ""
        )
        warn(
            f"grid.elements: {elements} do not resolve the Hertz contact, which covers {covered} "
            "of them in x and y; check the units of [load] and of the radii, or use "
            f"grid.half_length = [{advised}]{needed}"
        )
        return
    needs = [
        f"at least {math.ceil(FewestElements.slip * half / semi_axis)} in {axis}"
        for (axis, _, half, semi_axis), count in zip(sides, across, strict=True)
        if count < FewestElements.slip
    ]
    warn(f"grid.elements: {elements} resolves the contact poorly; use {', '.join(needs)}")
