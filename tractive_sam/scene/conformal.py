"""The [conformal] table: a contact that curves with its bodies, and what it excludes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

from tractive_sam.mechanics import CurvedPatch, Elasticity
from tractive_sam.schema import Fault, Real, Row, Table, ValidEntries, entry

from .checks import is_line


class Conformal(Table):
    """Contact that curves with its bodies: a ball in a groove, a flange root, a cylinder in a bore.

    Bodies with finite `radius_y` curve across the track: y is the length of the arc. A line contact
    curves along x, and has no friction. The load is the force along the normal at the middle of the
    patch.

    Examples
    --------
    >>> groove = ts.Scene.builtin("ball-in-groove")
    >>> ts.solve(groove).P > groove.load.normal  # the pressure acts at angles to the load
    True
    """

    key_advice: ClassVar[Mapping[str, str]] = {
        "radius": "radius_y of the bodies, negative for the groove (radius_x in a line contact)",
        "clearance": "radius_y of the bodies: their difference is the clearance",
    }
    excludes: ClassVar[dict[str, str]] = {
        "body.profile": "a roller with a profile is straight",
        "gap": "the separation follows from the radii",
        "wheel": "a wheel on a rail has a plane for each patch",
        "elasticity.law": "the bodies are a cylinder and a cylindrical hole",
        "subsurface": "the stress below a surface is known for half-spaces only",
        "fatigue": "the stress below a surface is known for half-spaces only",
        "residual": "the stress below a surface is known for half-spaces only",
        "inclusion": "the stress below a surface is known for half-spaces only",
        "transient": "its steps solve for a load or an approach in a plane",
        "process": "it may solve for a load in a plane",
        "load.force_y": "a lateral creepage has another slip at each angle: give it",
        "load.pressure": "it is that of a flat contact: give load.normal or load.approach",
        "jacobian": "the load of a curved contact depends on the angle; use differences",
        "levels": "levels are compared for a flat contact",
        "tables": "the contact of a table is flat",
    }
    angle: Real = entry(
        "contact angle at the middle of the patch, degrees: between its normal and the plane in "
        "which the bodies roll; it grows with y",
        default=0.0,
        gt=-90.0,
        lt=90.0,
    )

    def patch(self, scene: Any) -> CurvedPatch:
        """Return the geometry and motion of the patch of a scene."""
        A, B = ((body.radius_x, body.radius_y) for body in (scene.body.A, scene.body.B))
        return CurvedPatch(A, B, math.radians(self.angle), scene.line)

    def elasticity(self, scene: Any) -> Elasticity:
        """Return the elastic law of the bodies of a scene."""
        return self.patch(scene).elasticity(**scene.materials)

    def describe(self, scene: Any) -> Iterator[Row]:
        """Yield report rows: the patch, the response of the bodies, their rolling, and limits."""
        patch = self.patch(scene)
        where = "along x, in plane strain" if patch.line else "across the track"
        text = f"{where}, R = {patch.radius:.6g} mm; {patch.concave} is concave"
        yield Row("curved patch", f"{text}, clearance {patch.clearance:.4g} mm", brief=True)
        if scene.hertz is not None:
            half = scene.hertz.a if patch.line else scene.hertz.b
            degrees = math.degrees(half / patch.radius)
            text = f"{degrees:.3g} degrees by Hertz; the curved contact is narrower"
            yield Row("half angle", text)
        yield Row("response", "of a cylinder and of a cylindrical hole, both infinitely long")
        if not patch.line:
            yield Row("waves n = 0, 1", "of half-spaces at the distance of points in space")
            spin = -patch.rise * math.tan(patch.angle) / scene.body.radii[0]
            yield Row("spin by the contact angle", f"{spin:.4g} /mm, not part of creepage.spin")
            yield Row(
                "rolling", "points beside the middle slip, and spin with the angle (Heathcote)"
            )
            yield Row("worn volume", "with the circumference at the middle of the patch")


def check_conformity(entries: ValidEntries) -> Iterator[Fault]:
    """Report bodies that do not conform, and contacts or meshes around half of the circle."""
    if entries["conformal"] is None:
        return
    for k, block in enumerate(entries["duty"]):
        if block.shift_y:
            cure = "nothing: a body in a groove does not shift"
            yield Fault(f"duty[{k}].shift_y", "with [conformal]", cure)
    if is_line(entries) and entries["friction"] is not None:
        cure = "nothing: around a bore the surfaces turn as they pass, which is not modelled"
        yield Fault("friction", "with [conformal] in a line contact", cure)
    if is_line(entries) and entries["conformal.angle"]:
        cure = "0: a line contact curves along x"
        yield Fault("conformal.angle", f"{entries['conformal.angle']:g} in a line contact", cure)
    axis = 0 if is_line(entries) else 1
    key = f"radius_{'xy'[axis]}"
    radii = [entries[f"body.{name}.{key}"] for name in "AB"]
    if min(radii) >= 0.0 or math.isinf(max(radii)):
        cure = "one negative radius, of the groove or bore, and one smaller positive radius"
        values = f"{radii[0]:g} and {radii[1]:g} with [conformal]"
        yield Fault(f"body.A.{key}, body.B.{key}", values, cure)
        return
    half = (entries["grid.half_length"] or ()) if entries["grid"] is not None else ()
    contact = entries["body"].hertz(entries["load"])
    quarter = 0.25 * math.pi * (max(radii) - min(radii))
    if len(half) > axis:
        if half[axis] > 1.8 * quarter:
            cure = f"at most {1.8 * quarter:.4g} mm across the arc, 0.9 of half the circle"
            yield Fault("grid.half_length", f"{half[axis]:g} mm", cure)
    elif contact is not None and (reach := (contact.a, contact.b)[axis]) > quarter:
        cure = "a smaller load: the half angle by Hertz must be less than 90 degrees"
        value = f"{90.0 * reach / quarter:.4g} degrees"
        yield Fault(f"load.{entries['load'].prescribed_key}", value, cure)
