"""The steel of the bodies: [fatigue], its strength over the depth, and [residual].

A file is read into the table when the scene is made: the scene contains its numbers, not its path.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, get_args

import numpy as np
from pydantic import AfterValidator, Field, create_model

from tractive_sam.mechanics import HertzContact, HertzLine, RollingMarch, Steel, Woehler
from tractive_sam.schema import (
    Check,
    Fault,
    FilePath,
    InnerTable,
    LawTable,
    NamedLaw,
    NotNegative,
    Positive,
    Real,
    Row,
    SceneError,
    Table,
    ValidEntries,
    describe_law_names,
    entry,
    not_both,
    optional,
    shorten,
    suggest_name,
    warn,
)
from tractive_sam.text_table import TextError, read_table

from .inputs import TEXTS, absolute_path, check_exists
from .layers import LayerStrength, check_strength_of_layers, find_strengths, layered_body
from .tables import check_distinct

_Length = Field(min_length=1, max_length=10_000)
_Depths = Annotated[tuple[NotNegative, ...], _Length]
_Stresses = Annotated[tuple[Annotated[Real, Field(ge=-1e4, le=1e4)], ...], _Length]
_Strengths = Annotated[tuple[Annotated[Positive, Field(le=1e5)], ...], _Length]
_Hardnesses = Annotated[tuple[Annotated[Real, Field(ge=80.0, le=1500.0)], ...], _Length]


def _check_lengths(columns: tuple[str, ...]) -> Check:
    """Return a check that columns have one number for each depth, and that there are columns."""

    def check(entries: ValidEntries) -> Iterator[Fault]:
        given = [name for name in columns if name in entries.given]
        if "depth" in entries.given and not given:
            yield Fault(columns[0], "nothing, with depth", f"one or more of {', '.join(columns)}")
        if given and "depth" not in entries.given:
            cure = f"depths, mm, one for each number of {given[0]}; or a file with such columns"
            yield Fault("depth", "nothing", cure)
            return
        if "depth" in entries.given and (np.diff(entries["depth"]) <= 0.0).any():
            yield Fault("depth", shorten(entries["depth"]), "ascending depths, mm")
        for name in given:
            numbers, depths = len(entries[name]), len(entries["depth"])
            if numbers != depths:
                yield Fault(name, f"{numbers} numbers", f"{depths} numbers, as many as depth")

    return check


class _OverDepth(Table):
    """Base class of tables with columns over the depth, as arrays or in a file."""

    columns: ClassVar[tuple[str, ...]] = ()
    file: FilePath | None = optional(
        "text file with a line of column names, depth and others of the arrays below; units in it "
        "are converted. The scene contains its numbers, so the file is read once"
    )
    depth: _Depths | None = optional(
        "depths below the unworn surface, mm; above the first and below the last one the values "
        "are constant",
        "a list of ascending numbers of at least 0",
    )

    @classmethod
    def unfold(cls, entries: Mapping[Any, Any]) -> Mapping[Any, Any]:
        """Return the entries with the numbers of a file in its place.

        Raises
        ------
        SceneError
            If the file cannot be read, has unknown columns, or is given together with arrays.
        """
        file, names = entries.get("file"), ("depth", *cls.columns)
        if file is None:
            return entries
        if both := [name for name in (*names, "from") if entries.get(name) is not None]:
            cure = "a file or the arrays, not both"
            raise SceneError([Fault("file", f"with {', '.join(both)}", cure)])
        others = {key: value for key, value in entries.items() if key != "file"}
        return {**others, **cls._read(file, names)}

    @classmethod
    def _read(cls, file: Any, names: tuple[str, ...]) -> dict[str, tuple[float, ...]]:
        """Return the columns of a file by name; raise a SceneError if it cannot be read."""
        value, columns = shorten(str(file)), {}
        try:
            path = absolute_path(Path(file), TEXTS)
            check_exists(path)
            table = read_table(path, max_bytes=2**24, named=True)
            unknown = [name for name in table.names if name not in names]
            if unknown or len({*table.names}) < len(table.names) or "depth" not in table.names:
                allowed = suggest_name(unknown[0], names) if unknown else "depth, and each one once"
                raise TextError(f"columns {', '.join(table.names)}", allowed)
            for place, name in enumerate(table.names):
                # Hardness scales, such as HV0.5, differ by the force of the test.
                if table.units[place].casefold().startswith("hv"):
                    columns[name] = tuple(table.numbers([place])[:, 0].tolist())
                else:
                    meaning = cls.model_fields[name].title or ""
                    columns[name] = tuple(table.column(place, meaning).tolist())
        except TextError as error:
            fault = Fault("file", f"{path.name}, {error.value}", error.allowed)
            raise SceneError([fault]) from None
        except OSError as error:
            raise SceneError([Fault("file", value, f"a file of text ({error.strerror})")]) from None
        except (TypeError, ValueError) as error:
            raise SceneError([Fault("file", value, str(error))]) from None
        if note := table.find_unused(table.units):
            warn(f"{path.name}: {note}")
        return columns


def _check_source(entries: ValidEntries) -> Iterator[Fault]:
    """Report a residual stress without a source, with two, or rolled stress with its pressure."""
    arrays = [key for key in ("depth", "xx", "yy") if key in entries.given]
    if "from" in entries.given and arrays:
        yield Fault("from", f"with {', '.join(arrays)}", "from or the arrays, not both")
    elif "from" not in entries.given and not arrays:
        yield Fault("depth", "nothing", 'depth with xx and yy, a file, or from = "rolling"')
    if "pressure" in entries.given and "from" not in entries.given:
        yield Fault("pressure", shorten(entries["pressure"]), 'only with from = "rolling"')


# "from" is no name in Python.
_fields: dict[str, Any] = {
    "from": (
        Literal["rolling"] | None,
        optional(
            'source other than depth, xx and yy: "rolling", the stress that frictionless rolling '
            "of the unworn contact leaves in elastic-perfectly-plastic material"
        ),
    )
}
_Origin: Any = create_model("_Origin", __base__=_OverDepth, **_fields)


class ResidualStress(_Origin):
    """Residual stress of a body over the depth below its unworn surface.

    Stresses on planes parallel to the surface are zero in equilibrium. The stress belongs to the
    material: wear uncovers deeper material with its stress.

    Examples
    --------
    >>> ts.ResidualStress(depth=[0.0, 0.2, 1.0], xx=[-300.0, -150.0, 0.0]).xx
    (-300.0, -150.0, 0.0)
    """

    columns: ClassVar[tuple[str, ...]] = ("xx", "yy")
    xx: _Stresses | None = optional(
        "residual stress in the rolling direction at these depths, MPa; 0 without this key",
        "a list of numbers from -1e4 to 1e4, as many as depth",
    )
    yy: _Stresses | None = optional(
        "residual stress in the lateral direction at these depths, MPa; 0 without this key",
        "a list of numbers from -1e4 to 1e4, as many as depth",
    )
    pressure: Positive | None = optional(
        'with from = "rolling": peak pressure p0 of the rolling, MPa; by default the largest one '
        "of [load] and the blocks, by Hertz"
    )
    checks: ClassVar[tuple[Check, ...]] = (_check_source, _check_lengths(columns))

    @property
    def is_rolled(self) -> bool:
        """Whether the stress follows from rolling."""
        return getattr(self, "from") is not None


class Residual(Table):
    """Residual stress of the bodies.

    Examples
    --------
    >>> peened = ts.ResidualStress(depth=[0.0, 0.3], yy=[-500.0, 0.0])
    >>> ts.Residual(A=peened).B is None
    True
    """

    A: InnerTable[ResidualStress | None] = optional("residual stress of body A")
    B: InnerTable[ResidualStress | None] = optional("residual stress of body B")

    def describe(self, scene: Any) -> Iterator[Row]:
        """Yield report rows: the source and the range of the residual stress of each body."""
        for body in "AB":
            table: ResidualStress | None = getattr(self, body)
            if table is None:
                continue
            depth, xx = scene.steel[body].curves["xx"]
            yy = scene.steel[body].curves["yy"][1]
            source = f"{len(depth)} depths down to {depth[-1]:.4g} mm"
            if table.is_rolled:
                source = f"left by rolling at p0 = {rolled_contact(scene, body).p0:.6g} MPa"
            ranges = (
                f"{name} {min(v):.4g} to {max(v):.4g}" for name, v in (("xx", xx), ("yy", yy))
            )
            yield Row(f"body {body}", f"{', '.join(ranges)} MPa, {source}")


class Strength(_OverDepth):
    """Hardness or strength of a body over the depth below its unworn surface, and of its layers.

    They take precedence over the limit and the yield stress of [fatigue]. From the Vickers hardness
    follow the yield strength, 2.876 HV - 90.7 MPa (Pavlina & Van Tyne 2008), and the fatigue limit
    in reversed bending, 1.6 HV MPa and with inclusions at most 1.56 (HV + 120) / area^(1/12)
    (Murakami 2002). The limit of the criterion is its value for this bending.

    Examples
    --------
    >>> case = ts.Strength(depth=[0.0, 0.5, 1.5], hardness=[720.0, 600.0, 380.0], inclusion=30.0)
    >>> case.hardness
    (720.0, 600.0, 380.0)
    """

    columns: ClassVar[tuple[str, ...]] = ("hardness", "limit", "shear_yield")
    hardness: _Hardnesses | None = optional(
        "Vickers hardness at these depths, HV",
        "a list of numbers from 80 to 1500, as many as depth",
    )
    inclusion: Positive | None = optional(
        "square root of the area of the largest inclusion, micrometres; the fatigue limit of steel "
        "harder than 400 HV depends on it"
    )
    limit: _Strengths | None = optional(
        "fatigue limit of the criterion at these depths, MPa; by default it follows from hardness",
        "a list of numbers above 0, as many as depth",
    )
    shear_yield: _Strengths | None = optional(
        "yield stress in shear k at these depths, MPa; by default it follows from hardness",
        "a list of numbers above 0, as many as depth",
    )
    layer: tuple[LayerStrength, ...] = entry(
        "strength and life of each layer of the body, from the surface down; the other keys are "
        "those of the body below the layers",
        "one table for each [[body.A.layer]]",
        (),
        min_length=1,
        max_length=100,
    )
    checks: ClassVar[tuple[Check, ...]] = (_check_lengths(columns),)

    def find_curves(self, criterion: Any, sensitivity: float | None) -> dict[str, np.ndarray]:
        """Return hardness, limit and shear_yield at the depths by name, without unknown ones.

        Parameters
        ----------
        criterion : str or NamedLaw
            Fatigue criterion; the limit of one of another package does not follow from hardness.
        sensitivity : float or None
            Its sensitivity; without one that it needs there is no limit.
        """
        given = {name: getattr(self, name) for name in self.columns}
        curves = {name: np.array(values) for name, values in given.items() if values is not None}
        return find_strengths(curves, self.inclusion, criterion, sensitivity)


def check_strength_of_bodies(entries: ValidEntries) -> Iterator[Fault]:
    """Report [fatigue.A] of a body without fatigue, without its rule, or without the other body."""
    tables = {body: entries[body] for body in "AB" if entries[body] is not None}
    rule = entries["criterion"], entries["sensitivity"]
    curves = {body: table.find_curves(*rule) for body, table in tables.items()}
    for body, table in tables.items():
        if body not in entries["bodies"]:
            yield Fault(body, "a table", f"nothing, or {body} in fatigue.bodies")
        if not table.layer and all(getattr(table, name) is None for name in table.columns):
            yield Fault(f"{body}.hardness", "nothing", "hardness, limit or shear_yield, with depth")
        hardest = max(table.hardness or (0.0,))
        by_rule = "limit" in curves[body] and table.limit is None
        if (
            by_rule
            and table.inclusion is None
            and hardest > LayerStrength.hardest_without_inclusions
        ):
            cure = (
                "a number above 0: the fatigue limit of steel harder than "
                f"{LayerStrength.hardest_without_inclusions:g} HV depends on its largest "
                "inclusion, of some 20 to 60 micrometres; or the key limit over the depth"
            )
            yield Fault(f"{body}.inclusion", f"nothing, with hardness up to {hardest:g} HV", cure)
        if table.inclusion is not None and table.hardness is None:
            yield Fault(f"{body}.inclusion", shorten(table.inclusion), "only with hardness")
        yield from check_strength_of_layers(entries, body, curves[body])
    if not tables:
        return
    given = {
        "limit": "limit" in entries.given,
        "shear_yield": bool(entries.given & {"shear_yield", "yield_strength"}),
    }
    for name, is_common in given.items():
        lacking = [b for b in entries["bodies"] if name not in curves.get(b, {})]
        if lacking and not is_common and len(lacking) < len(entries["bodies"]):
            cure = f"a number above 0, for body {lacking[0]}; or fatigue.bodies without this body"
            yield Fault(name, f"nothing, and body {lacking[0]} has none over the depth", cure)


def find_surface_strength(entries: Mapping[str, Any], name: str) -> float | None:
    """Return the limit or the yield stress in shear at the surface of the first body with one, MPa.

    Parameters
    ----------
    entries : mapping
        Entries of [fatigue]: A, B, criterion and sensitivity.
    name : str
        "limit" or "shear_yield".
    """
    for body in "AB":
        table = entries[body]
        curves = (
            {} if table is None else table.find_curves(entries["criterion"], entries["sensitivity"])
        )
        if name in curves:
            return float(curves[name][0])
    return None


_MAX_EXPONENT = 100.0
"""Exponent of a Wöhler curve for which 1 % of the stress changes the life by a factor of e."""


def _check_table_has_purpose(entries: ValidEntries) -> Iterator[Fault]:
    """Report a table with neither a yield stress nor a limit."""
    if not entries.given & {"shear_yield", "yield_strength", "limit", "A", "B"}:
        cure = "[fatigue] shear_yield or yield_strength (shakedown), limit (utilisation), in MPa"
        yield Fault("limit", "nothing, and no yield stress", cure)


def _check_sensitivity(entries: ValidEntries) -> Iterator[Fault]:
    """Report a sensitivity that is missing, too large or unused by the fatigue criterion."""
    # Upper bound and definition of the sensitivity, for each criterion with a sensitivity. At the
    # bounds of the first two the fatigue limit in torsion equals that in bending.
    sensitivities = {
        "dang-van": (1.5, "3 (tau_e/sigma_e - 1/2), torsion and bending limits"),
        "crossland": (3.0 - math.sqrt(3.0), "3 tau_e/sigma_e - sqrt 3, torsion, bending limits"),
        "findley": (10.0, "k, sigma_e/tau_e = 2 / (1 + k/sqrt(1 + k²)), bending, torsion limits"),
        "fatemi-socie": (10.0, "k"),
    }
    criterion, value = entries["criterion"], entries["sensitivity"]
    if isinstance(criterion, NamedLaw):
        return
    if criterion not in sensitivities:
        if value is not None:
            yield Fault("sensitivity", shorten(value), f'nothing: "{criterion}" has no sensitivity')
        return
    upper, meaning = sensitivities[criterion]
    allowed = f'from 0 to below {upper:.4g} for "{criterion}" ({meaning})'
    if value is None:
        if entries["limit"] is not None:
            yield Fault("sensitivity", "nothing", allowed)
    elif value >= upper:
        yield Fault("sensitivity", shorten(value), allowed)


def _check_yield_of_criterion(entries: ValidEntries) -> Iterator[Fault]:
    """Report a missing yield stress that "fatemi-socie" needs, if a fatigue limit is set."""
    if entries["criterion"] != "fatemi-socie" or entries["limit"] is None:
        return
    has_yield = entries.given & {"shear_yield", "yield_strength"}
    if not has_yield and find_surface_strength(entries, "shear_yield") is None:
        yield Fault("yield_strength", "nothing", 'a number above 0, which "fatemi-socie" needs')


class FatigueVolume(Table):
    """Fatigue life of the stressed volume, with a Weibull slope.

    The law is that of Lundberg and Palmgren or, with a stress limit, the law of Ioannides and
    Harris; see `ts.VolumeLife`.

    Examples
    --------
    >>> ts.FatigueVolume(constant=1e-34).survival
    0.9
    """

    constant: float | None = optional(
        "material constant A, in N, mm and cycles; without this key, no life is computed",
        ge=1e-100,
        le=1e100,
    )
    survival: float = entry(
        "survival probability of the complete volume", default=0.9, gt=0.0, lt=1.0
    )
    slope: Positive | None = optional(
        "Weibull slope; the default is 10/9, or 9/8 for a line contact"
    )
    limit: NotNegative = entry("stress below which there is no damage, MPa", default=0.0)
    stress_exponent: Positive = entry(
        "exponent of the stress", default=31.0 / 3.0, le=_MAX_EXPONENT
    )
    depth_exponent: NotNegative = entry("exponent of the depth", default=7.0 / 3.0, le=10.0)


def _check_limit_is_given(entries: ValidEntries) -> Iterator[Fault]:
    """Report a user-defined criterion, or [fatigue.volume], without the limit of the criterion."""
    if entries["limit"] is not None:
        return
    if isinstance(entries["criterion"], NamedLaw):
        yield Fault("limit", "nothing", f"a number above 0, which {entries['criterion']} needs")
    if entries["volume"] is not None:
        cure = "a number above 0: [fatigue.volume] needs the utilisation of the criterion"
        yield Fault("limit", "nothing", cure)


CriterionName = Literal["dang-van", "crossland", "findley", "fatemi-socie", "orthogonal-shear"]


class Fatigue(LawTable):
    """Shakedown limits, fatigue criterion, life, and damage during wear.

    The shakedown limits follow from a yield stress. The utilisation follows from the fatigue limit
    of the criterion, and the damage from the utilisation and a Wöhler curve. The stress is
    computed for elastic material.

    The parameters of a criterion of another package are further keys. If the criterion has a
    parameter `yield_stress` (in tension), it receives the value from the scene.

    Examples
    --------
    >>> steel = ts.Fatigue(shear_yield=300.0, sensitivity=0.333, limit=250.0)
    >>> steel.criterion, round(steel.yield_stress, 1)
    ('dang-van', 519.6)
    """

    shear_yield: Positive | None = optional("yield stress in shear k, MPa")
    yield_strength: Positive | None = optional("yield stress in tension, sqrt 3 k, MPa")
    criterion: CriterionName | NamedLaw = entry(
        "fatigue criterion", describe_law_names(get_args(CriterionName)), "dang-van"
    )
    sensitivity: NotNegative | None = optional(
        "sensitivity of the criterion to normal stress: a for Dang Van and Crossland, k for "
        "Findley and Fatemi-Socie",
        "a number of at least 0; the upper bound depends on the criterion",
    )
    A: InnerTable[Strength | None] = optional("strength of body A over the depth")
    B: InnerTable[Strength | None] = optional("strength of body B over the depth")
    limit: Positive | None = Field(
        title="fatigue limit of the criterion, MPa; the utilisation is the equivalent stress "
        "divided by this limit, or by the limit over the depth in [fatigue.A] and [fatigue.B]; by "
        "default, the latter at the surface",
        default_factory=lambda entries: find_surface_strength(entries, "limit"),
    )
    cycles: Positive = entry("number of cycles to failure at a utilisation of 1", default=1e7)
    exponent: Positive = entry(
        "exponent of the Wöhler curve, life = cycles * utilisation ** -exponent",
        default=10.0,
        le=_MAX_EXPONENT,
    )
    knee: bool = entry("whether life is infinite below a utilisation of 1", default=False)
    depth: Positive = entry("depth, in units of the semi-axis a", default=1.5)
    elements: int = entry("number of points along the depth", default=24, ge=8, le=10**4)
    bodies: Annotated[tuple[Literal["A", "B"], ...], AfterValidator(check_distinct)] = entry(
        "bodies for which fatigue is computed", default=("A", "B"), min_length=1
    )
    volume: InnerTable[FatigueVolume | None] = optional("life of the stressed volume")
    tolerance: float = entry(
        "error of the damage, divided by the largest damage; a jump is shortened if its error "
        "exceeds 0.3 times this tolerance; the column damage_error contains the total error",
        default=1e-2,
        ge=1e-6,
        le=1.0,
    )
    law_key: ClassVar[str] = "criterion"
    law_names: ClassVar[tuple[str, ...]] = get_args(CriterionName)
    law_fields: ClassVar[tuple[str, ...]] = ("sensitivity",)
    checks: ClassVar[tuple[Check, ...]] = (
        not_both("shear_yield", "yield_strength"),
        _check_table_has_purpose,
        _check_sensitivity,
        _check_yield_of_criterion,
        _check_limit_is_given,
        check_strength_of_bodies,
    )

    def describe(self, scene: Any) -> Iterator[Row]:
        """Yield report rows: bodies, shakedown limits, life and depths of the fatigue analysis."""
        k, hertz = self.shear_yield_stress, scene.hertz
        shakedown = "left out: neither shear_yield nor yield_strength is given"
        if k is not None:
            bounds = "certain by Melan (rho_xx and rho_yy), impossible by Koiter"
            shakedown = f"k = {k:.6g} MPa: {bounds}"
        yield Row("bodies", ", ".join(self.bodies))
        yield Row("shakedown", shakedown)
        if k is not None and hertz is not None:
            ratio = f"{hertz.p0 / k:.3g} unworn; shakedown limit of a frictionless line contact: 4"
            yield Row("p0/k", ratio)
        if self.limit is None:
            yield Row("utilisation and damage", "left out: limit is not given")
        else:
            life = f"{self.cycles:g} cycles at {self.limit:g} MPa, to the power -{self.exponent:g}"
            yield Row("life", f"{life}, infinite below" if self.knee else life)
        yield Row(
            "depths",
            f"{self.elements} down to {self.depth:g} a; between the surface and the depth of one "
            "element the stress changes with the square root of the depth",
        )
        plastic = "yielding above the shakedown limit is not modelled"
        yield Row("stress", f"elastic: {plastic}")
        missing = ["bending"]
        missing += ["residual stress from manufacture"] if scene.residual is None else []
        missing += [] if self.A or self.B else ["hardness over the depth"]
        yield Row("not included", ", ".join(missing))
        for body in self.bodies:
            strength: Strength | None = getattr(self, body)
            if strength is None:
                continue
            reach = math.inf if hertz is None else 2.0 * self.depth * hertz.a
            for k, layer in enumerate(strength.layer):
                text = layer.describe_strength(self)
                if scene.steel[body].faces[k] > reach:
                    text += f"; below {reach:.4g} mm nothing is evaluated: increase fatigue.depth"
                yield Row(f"layer {k} of body {body}", text)
            if strength.depth is not None:
                units = {"hardness": "HV", "limit": "MPa", "shear_yield": "MPa"}
                curves = {name: scene.steel[body].curves.get(name) for name in units}
                parts = [
                    f"{name.replace('_', ' ')} {curve[1][0]:.4g} at the surface, "
                    f"{curve[1][-1]:.4g} {units[name]} at {curve[0][-1]:.4g} mm"
                    for name, curve in curves.items()
                    if curve is not None
                ]
                yield Row(f"strength of body {body}", "; ".join(parts))

    @property
    def yield_stress(self) -> float | None:
        """Yield stress in tension, MPa, as set or sqrt(3) times k; None if neither is set.

        If it is set over the depth only, the value at the surface.
        """
        if self.yield_strength is not None:
            return self.yield_strength
        k = self.shear_yield or find_surface_strength(vars(self), "shear_yield")
        return None if k is None else math.sqrt(3.0) * k

    @property
    def shear_yield_stress(self) -> float | None:
        """Yield stress in shear k, MPa, as set or from tension over sqrt(3); None without both."""
        return None if self.yield_stress is None else self.yield_stress / math.sqrt(3.0)

    @property
    def life(self) -> Woehler:
        """Wöhler curve of bodies, without their layers."""
        return Woehler(self.cycles, self.exponent, self.knee)

    @property
    def has_layer_strengths(self) -> bool:
        """Whether a body has a strength of its layers."""
        return any(table is not None and table.layer for table in (self.A, self.B))


def rolled_pressures(scene: Any, blocks: Iterable[Any]) -> dict[str, float]:
    """Return the peak pressure of rolling, MPa, by its key, for bodies without a given one.

    It is the largest one of the scene and its blocks, so that all blocks have one residual stress.
    """
    tables = {} if scene.residual is None else {b: getattr(scene.residual, b) for b in "AB"}
    rolled = [b for b, table in tables.items() if table and table.is_rolled and not table.pressure]
    if not rolled:
        return {}
    largest = max(each.hertz.p0 for each in (scene, *blocks) if each.hertz is not None)
    return {f"residual.{body}.pressure": largest for body in rolled}


def rolled_contact(scene: Any, body: str) -> HertzContact | HertzLine:
    """Return the Hertz contact of the peak pressure whose rolling leaves the stress of a body."""
    hertz, key = scene.hertz, f"residual.{body}.pressure"
    pressure = rolled_pressures(scene, scene.blocks).get(
        key, getattr(scene.residual, body).pressure
    )
    size = pressure / hertz.p0  # semi-axes are proportional to the peak pressure
    b = {} if math.isinf(hertz.b) else {"b": size * hertz.b}
    return replace(hertz, a=size * hertz.a, p0=pressure, **b)


def find_steel(scene: Any, deepest: float = 3.0, depths: int = 61) -> dict[str, Steel]:
    """Return the steel of each body over the depth, by body; without bodies that have no table.

    Parameters
    ----------
    scene : Scene
        The scene.
    deepest : float
        Depth down to which rolling is followed, over the semi-axis a.
    depths : int
        Number of these depths.
    """
    steel: dict[str, Steel] = {}
    for body in "AB":
        curves: dict[str, Any] = {}
        strength = None if scene.fatigue is None else getattr(scene.fatigue, body)
        residual = None if scene.residual is None else getattr(scene.residual, body)
        if strength is not None:
            rule = scene.fatigue.criterion, scene.fatigue.sensitivity
            found = strength.find_curves(*rule).items()
            curves |= {name: (np.array(strength.depth), values) for name, values in found}
        if residual is not None and residual.is_rolled:
            contact = rolled_contact(scene, body)
            zeta = deepest * contact.a * np.linspace(0.0, 1.0, depths)
            k = Steel(curves).at("shear_yield", zeta)
            k = scene.fatigue.shear_yield_stress if k is None else k
            march = RollingMarch(contact, scene.materials[body].poisson)
            xx, yy = march.residual(zeta, k)
            curves |= {"xx": (zeta, xx), "yy": (zeta, yy)}
        elif residual is not None:
            zeta = np.array(residual.depth)
            for name in ResidualStress.columns:
                values = getattr(residual, name)
                curves[name] = zeta, np.zeros(zeta.size) if values is None else np.array(values)
        parts = () if strength is None else strength.layer
        if parts or (scene.fatigue is not None and _distinct_layers(scene, body)):
            steel[body] = _find_layered_steel(scene, body, parts, curves)
        elif curves:
            steel[body] = Steel(curves)
    return steel


def _distinct_layers(scene: Any, body: str) -> int:
    """Return the number of layers above the last interface at which the elastic constants jump."""
    return len(getattr(scene.body.responses[body], "layers", ()))


def _find_layered_steel(
    scene: Any, body: str, parts: tuple[LayerStrength, ...], curves: Mapping[str, Any]
) -> Steel:
    """Return the strength and life of a body with layers; `curves` of the body below them.

    Without `parts`, all layers have the strength of the body: only their stress jumps.
    """
    table = scene.fatigue
    faces = layered_body(scene, body).interfaces
    rule = table.criterion, table.sensitivity
    own = {} if table.limit is None or "limit" in curves else {"limit": table.limit}
    layers = tuple(part.find_values(*rule) for part in parts) or (own,) * faces.size
    lives = tuple(part.find_life(table) for part in parts) or (table.life,) * faces.size
    common = {"limit": table.limit, "shear_yield": table.shear_yield_stress}
    ends = np.array([0.0, 2.0 * faces[-1]])  # figures show this depth
    constant = {name: (ends, np.full(2, common[name])) for name in layers[0]}
    distinct = _distinct_layers(scene, body)
    # The equivalent stress of these criteria depends on the stress alone, and not on a strength.
    by_stress = table.criterion in ("dang-van", "crossland", "findley", "orthogonal-shear")
    kinds, groups = [None if by_stress else part.get("shear_yield") for part in layers], [0]
    for k, pair in enumerate(zip(kinds, [*kinds[1:], None], strict=True)):
        jumps = k < distinct or not (by_stress or pair[0] == pair[1])
        groups.append(groups[-1] + jumps)
    limit = table.limit or 1.0
    return Steel(
        constant | dict(curves), faces, layers, (*lives, table.life), tuple(groups), distinct, limit
    )


def check_steel(entries: ValidEntries) -> Iterator[Fault]:
    """Report strengths of layers that are not there, and residual stress that cannot be rolled."""
    for body in "AB":
        strength = None if entries["fatigue"] is None else getattr(entries["fatigue"], body)
        layers, tables = entries[f"body.{body}.layer"], () if strength is None else strength.layer
        if tables and len(tables) != len(layers):
            cure = f"{len(layers)}, one for each [[body.{body}.layer]]; [fatigue] is the body below"
            if not layers:
                cure = f"none, or [[body.{body}.layer]]: body {body} has no layers"
            yield Fault(f"fatigue.{body}.layer", f"tables: {len(tables)}", cure)
    for body in "AB":
        table = None if entries["residual"] is None else getattr(entries["residual"], body)
        if table is None or not table.is_rolled:
            continue
        key, fatigue = f"residual.{body}.from", entries["fatigue"]
        has_gap = entries["gap"] is not None or entries["wheel"] is not None
        if has_gap or entries["body"].hertz(entries["load"]) is None:
            cure = "depth with xx and yy: rolling is followed below a Hertz contact of radii"
            yield Fault(key, '"rolling" without a Hertz contact', cure)
        elif not entries["body"].is_isotropic:
            cure = "depth with xx and yy: rolling is followed in homogeneous, isotropic bodies"
            yield Fault(key, '"rolling" with layers or a stiffness', cure)
        strength = None if fatigue is None else getattr(fatigue, body)
        has_yield = strength is not None and (strength.hardness or strength.shear_yield)
        if fatigue is None or not (has_yield or fatigue.shear_yield or fatigue.yield_strength):
            cure = f"fatigue.shear_yield, or hardness in [fatigue.{body}], at which it yields"
            yield Fault(key, '"rolling" without a yield stress', cure)
