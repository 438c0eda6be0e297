"""Profiles of rollers across the track, and their tilt: the separation that they add to the radii.

A scene with body.A.profile or body.B.profile contains the separation as a [gap] that its keys give:
it is computed when the scene is made, and is no entry of the scene.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from tractive_sam.mechanics import FreeEnds
from tractive_sam.schema import (
    Check,
    Fault,
    FilePath,
    NotNegative,
    Positive,
    Real,
    Row,
    SceneError,
    Table,
    ValidEntries,
    entry,
    optional,
    shorten,
)
from tractive_sam.text_table import TextError, read_table

from .inputs import TEXTS, absolute_path, check_exists


def _check_form(entries: ValidEntries) -> Iterator[Fault]:
    """Report a profile without the keys of its form, or with keys of another one."""
    keys = {
        "logarithmic": {"load", "load_factor", "curved", "drop"},
        "crowned": {"radius", "flat", "drop"},
        "points": {"y", "depth"},
        "series": {"basis", "coefficients"},
    }
    form = entries["form"]
    for key in sorted(set().union(*keys.values()) - keys[form]):
        if key in entries.given:
            forms = " or ".join(f'"{name}"' for name, allowed in keys.items() if key in allowed)
            yield Fault(key, f'with form = "{form}"', f"only with {forms}")
    if form == "crowned" and len(entries.given & {"radius", "drop"}) != 1:
        yield Fault("radius", "neither or both", "one of radius and drop, the depth at the ends")
    if form == "series" and not entries["coefficients"]:
        yield Fault("coefficients", "nothing", "a list of numbers, mm")
    if form != "points":
        return
    y, depth = entries["y"] or (), entries["depth"] or ()
    if len(y) < 3 or len(y) != len(depth) or (np.diff(y) <= 0.0).any():
        cure = "at least 3 ascending numbers, mm, as many as depth; or a file"
        yield Fault("y", f"{len(y)} numbers, and {len(depth)} depths", cure)


class RollerProfile(Table):
    """Profile of a roller across the track: depth below its cylinder over y.

    Forms: "logarithmic" is Lundberg's profile, with three parameters by Fujiwara & Kawase (NTN
    Technical Review 75 (2007) 140); "crowned" is a parabola beside a straight middle, also an end
    relief; "points" are depths that a file or arrays give; "series" is a sum of functions whose
    coefficients a design or a spread can vary, as body.A.profile.coefficients[0].

    Examples
    --------
    >>> profile = ts.RollerProfile(form="crowned", flat=4.0, drop=0.01)
    >>> profile.depth_at(np.array([0.0, 2.0, 5.0]), 10.0, 0.0)
    array([0.  , 0.  , 0.01])
    """

    file: FilePath | None = optional(
        'text file with the columns y and depth, mm; the form is then "points"'
    )
    form: Literal["logarithmic", "crowned", "points", "series"] = entry("form of the profile")
    load: Positive | None = optional(
        'with "logarithmic": load for which the pressure is even along the roller, N; by default '
        "load.normal when the scene is made"
    )
    load_factor: Positive = entry("factor K1 on this load", default=1.0)
    curved: Real = entry(
        "share K2 of the half length that is curved, from the ends inward", default=1.0, gt=0, le=1
    )
    drop: Positive | None = optional(
        "depth at the ends, mm; without it, a logarithmic profile is Lundberg's, which grows "
        "towards the ends without limit, here up to a millionth of the half length from them"
    )
    radius: Positive | None = optional('with "crowned": radius of the crown, mm')
    flat: NotNegative = entry('with "crowned": length of the straight middle, mm', default=0.0)
    y: tuple[Real, ...] | None = optional(
        'with "points": positions across the track, mm', "a list of ascending numbers"
    )
    depth: tuple[Real, ...] | None = optional(
        'with "points": depths below the cylinder at these positions, mm',
        "a list of numbers, as many as y",
    )
    basis: Literal["logarithmic", "polynomial", "spline"] = entry(
        'with "series": even functions of s, the position over the half length: ln 1/(1 - s^2), '
        "s^2, s^4, ...; s^2, s^4, ...; or cubic B-splines on equal intervals with zero slope at "
        "s = 0",
        default="logarithmic",
    )
    coefficients: tuple[Real, ...] | None = optional(
        'with "series": factors of these functions, mm', "a list of numbers", max_length=20
    )
    chamfer: NotNegative = entry(
        "length of the chamfers at 45 degrees at both ends, mm, part of body.A.width", default=0.0
    )
    excluded_by_ends: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(
            ("subsurface", "fatigue", "residual", "inclusion"),
            "the stress in the bodies is that of half-spaces, wrong near ends",
        ),
        "transient": "the steps of a transient are those of half-spaces",
        "wheelset": "wheel and rail have no ends near their patch",
        "conformal": "ends are those of cylinders, with radius_y = inf",
        "elasticity.law": "a law of another package knows no ends",
    }
    """Tables of a scene that ends of a roller exclude, and why (`find_exclusions`)."""
    internal: ClassVar[frozenset[str]] = frozenset(("excluded_by_ends",))
    checks: ClassVar[tuple[Check, ...]] = (_check_form,)

    @classmethod
    def unfold(cls, entries: Mapping[Any, Any]) -> Mapping[Any, Any]:
        """Return the entries with the points of a file, columns y and depth in its first row."""
        file = entries.get("file")
        if file is None:
            return entries
        value = shorten(str(file))
        try:
            path = absolute_path(Path(file), TEXTS)
            check_exists(path)
            table = read_table(path, max_bytes=2**24, named=True)
            if sorted(table.names) != ["depth", "y"]:
                raise TextError(f"columns {', '.join(table.names)}", "columns y and depth")
            y, depth = (table.column(table.names.index(name), "mm") for name in ("y", "depth"))
        except TextError as error:
            raise SceneError(
                [Fault("file", f"{path.name}, {error.value}", error.allowed)]
            ) from None
        except (OSError, TypeError, ValueError) as error:
            raise SceneError([Fault("file", value, str(error))]) from None
        points = {"form": "points", "y": tuple(y.tolist()), "depth": tuple(depth.tolist())}
        return {**{key: item for key, item in entries.items() if key != "file"}, **points}

    def depth_at(
        self, y: NDArray[np.float64], length: float, amplitude: float
    ) -> NDArray[np.float64]:
        """Return the depth of the profile below the cylinder at positions y, mm.

        Parameters
        ----------
        y : ndarray
            Positions from the middle of the roller, mm.
        length : float
            Length of the profile without chamfers, mm.
        amplitude : float
            A = Q / (pi L E*) of a logarithmic profile, mm.
        """
        half, away = 0.5 * length, np.minimum(np.abs(y), 0.5 * length)
        if self.form == "points":
            return np.interp(np.clip(y, -half, half), self.y or (), self.depth or ())
        if self.form == "crowned":
            beyond = np.maximum(away - 0.5 * self.flat, 0.0)
            if self.radius is not None:
                return beyond**2 / (2.0 * self.radius)
            return (self.drop or 0.0) * (beyond / (half - 0.5 * self.flat)) ** 2
        if self.form == "series":
            return self._sum_series(np.minimum(away / half, 1.0 - 1e-6))
        start = (1.0 - self.curved) * half
        last = 1.0 if self.drop is not None else 1.0 - 1e-6
        share = np.clip((away - start) / (half - start), 0.0, last) ** 2
        a = self.load_factor * amplitude
        end = 1.0 if self.drop is None else -math.expm1(-self.drop / a)
        return -a * np.log1p(-end * share)

    def _sum_series(self, s: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the sum of the functions of the basis at shares of the half length."""
        factors = np.array(self.coefficients)
        if self.basis == "spline":  # two zero factors: depth and slope are zero at s = 0
            # Scenes without splines need no interpolation, which takes long to load.
            from scipy.interpolate import BSpline  # noqa: PLC0415

            inner = np.linspace(0.0, 1.0, max(factors.size, 2))
            knots = np.concatenate([[0.0] * 3, inner, [1.0] * 3])
            factors = np.concatenate([np.zeros(knots.size - 4 - factors.size), factors])
            return np.asarray(BSpline(knots, factors, 3)(s))
        powers = [s ** (2 * k) for k in range(1, factors.size + 1)]
        if self.basis == "logarithmic":
            powers = [-np.log1p(-(s**2)), *powers[:-1]]
        return factors @ np.array(powers)


def add_roller_gap(tables: Mapping[Any, Any], bodies: Any, load: Any) -> Mapping[Any, Any]:
    """Return scene tables with the separation of roller profiles and tilt as their [gap].

    The load for which a logarithmic profile is made becomes an entry of the profile, so that a
    later change of the load does not change the roller.

    Parameters
    ----------
    tables : mapping
        Tables of a scene.
    bodies, load : type
        Classes of the tables [body] and [load].

    Raises
    ------
    SceneError
        If there is a [gap] as well.
    """
    body = _to_dict(tables.get("body"))
    each = {name: _to_dict(body.get(name)) for name in "AB"}
    keys = [(name, key) for key in ("profile", "ends") for name in "AB" if each[name].get(key)]
    if not keys:
        return tables
    if tables.get("gap") is not None:
        key = ".".join(("body", *keys[0]))
        cure = f"[gap] or {key}, not both: give the depths of [gap] as body.A.profile"
        raise SceneError([Fault("gap", f"with {key}", cure)])
    profiles = [name for name, key in keys if key == "profile"]
    normal = _to_dict(tables.get("load")).get("normal")
    for name in profiles:
        profile = _to_dict(each[name]["profile"])
        if isinstance(each[name]["profile"], str):
            text = each[name]["profile"]
            profile = {"file": text} if text.lower().endswith(TEXTS) else {"form": text}
        if profile.get("form") == "logarithmic" and profile.get("load") is None:
            profile["load"] = normal
        each[name]["profile"] = profile
    tables = {**tables, "body": {**body, **each}}
    try:
        pair, loaded = bodies(**tables["body"]), load(**_to_dict(tables.get("load")))
    except (SceneError, TypeError):
        return tables  # the faults are reported when the tables are read
    tables["body"] = pair.entries()
    if not all(map(_is_complete, pair.rollers.values())):
        return tables  # see `check_roller`
    y, separation = _find_separation(pair, loaded.tilt or 0.0)
    return {**tables, "gap": {"y": y, "separation": separation, "profile": "y"}}


def _to_dict(table: Any) -> dict[Any, Any]:
    """Return a table in any form as a dictionary; empty for other values."""
    if isinstance(table, Table):
        return table.entries()
    return dict(table) if isinstance(table, Mapping) else {}


def _is_complete(body: Any) -> bool:
    """Return whether a roller has a width that its profile fits, and a load for which it is."""
    profile, width = body.shape, body.width or 0.0
    fits = profile.flat < width - 2.0 * profile.chamfer
    return fits and not (profile.form == "logarithmic" and profile.load is None)


def _find_separation(
    pair: Any, tilt: float, samples: int = 801
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return positions across the track and the separation of profiles and tilt there, mm."""
    rollers = [(body, body.shape) for body in pair.rollers.values()]
    places = []
    for body, profile in rollers:
        half = 0.5 * body.width - profile.chamfer
        # Denser towards the ends; then the chamfer, or what would be beyond the end.
        inside = half * np.sin(0.5 * np.pi * np.linspace(-1.0, 1.0, samples))
        beyond = half + 0.5 * body.width * np.linspace(0.0, 1.0, 26)[1:] ** 2
        places.append(np.concatenate((-beyond[::-1], inside, beyond)))
    y = np.unique(np.concatenate(places))
    y = y[np.append(True, np.diff(y) > 1e-9 * y[-1])]
    separation = 1e-3 * tilt * y
    for body, profile in rollers:
        length = body.width - 2.0 * profile.chamfer
        modulus = pair.contact_modulus(length)  # over the length of the roller
        amplitude = (profile.load or 0.0) / (math.pi * length * modulus)
        chamfer = np.maximum(np.abs(y) - 0.5 * length, 0.0)
        if body.ends:  # nothing touches beyond them
            chamfer += 1e3 * np.maximum(np.abs(y) - 0.5 * body.width, 0.0)
        separation = separation + profile.depth_at(y, length, amplitude) + chamfer
    return y, separation


def describe_rollers(pair: Any, scene: Any) -> Iterator[Row]:
    """Yield report rows: profile and tilt of rollers, how ends are modelled, and what follows."""
    for name, body in pair.rollers.items():
        kept = {} if body.profile is None else body.profile.entries()
        kept = {k: v for k, v in kept.items() if k not in ("y", "heights")}
        text = ", ".join(f"{key} = {value}" for key, value in kept.items()) or "straight"
        tilt = f"; tilt {scene.load.tilt:g} mrad" if scene.load.tilt else ""
        if scene.load.moment is not None:
            tilt = f"; tilt found for the moment {scene.load.moment:g} N mm"
        ends = "" if body.ends else "; material beyond the ends counts as half-space"
        yield Row(f"roller {name}", f"width {body.width:g} mm, {text}{tilt}{ends}")
    widths = [body.width for body in pair.rollers.values() if body.ends]
    for name, body in pair.rollers.items():
        if body.ends:
            how = "no traction on the faces" if body.ends == "free" else "a factor on mirror images"
            text = f"{how} at y = +-{0.5 * body.width:g} mm; they act on pressure, tractions act "
            yield Row(f"ends of {name}", text + "as on half-spaces")
    if widths and (len(widths) == 1 or widths[0] != widths[1]):
        text = "without limit where the other body continues beyond a sharp end: p_max grows with "
        yield Row("edge pressure", text + "finer meshes; use p_95, or end_load")


def find_ends(pair: Any, datum: float) -> FreeEnds:
    """Return the elastic law of two bodies with ends, one or both."""
    bodies = pair.A, pair.B
    width_A, width_B = (body.width if body.ends else math.inf for body in bodies)
    quick = pair.A.ends == "quick", pair.B.ends == "quick"
    return FreeEnds(**pair.materials, widths=(width_A, width_B), quick=quick, datum=datum)


def check_roller(entries: ValidEntries) -> Iterator[Fault]:
    """Report rollers without a width, crowned by their radius, or too short for their profile."""
    rollers = entries["body"].rollers
    for name in "AB" if rollers else ():
        if not math.isinf(radius := entries[f"body.{name}.radius_y"]):
            cure = 'inf: rollers are cylinders; a crown is profile = { form = "crowned", ... }'
            yield Fault(f"body.{name}.radius_y", f"{radius:g}, beside a profile or ends", cure)
    for name, body in rollers.items():
        width, profile = body.width, body.profile
        if width is None:
            cure = "the width of the body, mm, which its profile and its ends need"
            yield Fault(f"body.{name}.width", "nothing", cure)
        if profile is None:
            continue
        key = f"body.{name}.profile"
        if width is not None and width <= 2.0 * profile.chamfer:
            cure = f"less than half of the width, {0.5 * width:g} mm"
            yield Fault(f"{key}.chamfer", shorten(profile.chamfer), cure)
        elif width is not None and profile.flat >= width - 2.0 * profile.chamfer:
            cure = f"less than {width - 2.0 * profile.chamfer:g} mm, the width without chamfers"
            yield Fault(f"{key}.flat", shorten(profile.flat), cure)
        if profile.form == "logarithmic" and profile.load is None:
            cure = "the load for which the profile is made, N; or load.normal"
            yield Fault(f"{key}.load", "nothing", cure)


def check_tilt(entries: ValidEntries) -> Iterator[Fault]:
    """Report a tilt or a moment without a roller, and a moment that no tilt gives."""
    widths = [body.width for body in entries["body"].rollers.values()]
    for key in ("load.tilt", "load.moment"):
        if entries[key] is not None and not widths:
            cure = "only with body.A.profile or body.A.ends; for other bodies, tilt their [gap]"
            yield Fault(key, shorten(entries[key]), cure)
    moment, normal = entries["load.moment"], entries["load.normal"]
    if moment is None:
        return
    if normal is None:
        yield Fault("load.normal", "nothing, with load.moment", "a number above 0, N")
    if normal is not None and widths and None not in widths:
        most = 0.5 * min(widths) * normal
        if abs(moment) >= most:
            cure = f"less than {most:.6g} N mm, the load at the end of the roller"
            yield Fault("load.moment", shorten(moment), cure)
