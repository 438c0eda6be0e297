"""The tables of a scene but for the bodies and the gap, each checked by itself.

Units mm, N, MPa, degrees, revolutions.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, TypeVar, get_args

from pydantic import AfterValidator, BeforeValidator, Field, PlainValidator

from tractive_sam.mechanics import BRR, JENDEL, USFD, Frame

from .alternatives import exactly_one
from .faults import Fault
from .named_law import ANOTHER, LawTable, NamedLaw
from .plane import Plane
from .quantities import (
    NotNegative,
    OptionalOrthotropicNotNegative,
    OptionalOrthotropicPositive,
    OptionalPositiveOneOrTwo,
    OrthotropicPositive,
    Positive,
    Real,
    Whole,
    alone,
    entry,
    number,
    positive,
)
from .table import Check, Known, Table

Item = TypeVar("Item")


def distinct(items: tuple[Item, ...]) -> tuple[Item, ...]:
    """See that no item is there twice."""
    if len(set(items)) < len(items):
        raise ValueError("each item once")
    return items


class Load(Table):
    """What presses the bodies together, and tangential forces prescribed in place of creepages.

    All forces of a line contact (both bodies with ``radius_y = inf``) are per length, N/mm.

    Examples
    --------
    >>> ts.Load(normal=300.0, force_x=120.0).force_x
    120.0
    """

    normal: Positive | None = positive("normal load P, N; of a line contact N/mm", None)
    approach: Positive | None = positive(
        "approach of the bodies, mm, from the first touch of the unworn ones", None
    )
    pressure: Positive | None = positive(
        "peak contact pressure p0 of the unworn bodies by Hertz, MPa, from which the load follows",
        None,
    )
    force_x: Real | None = number("prescribed tangential force Q_x on body A, N or N/mm", None)
    force_y: Real | None = number("prescribed tangential force Q_y on body A, N or N/mm", None)
    checks: ClassVar[tuple[Check, ...]] = (exactly_one("normal", "approach", "pressure"),)


class Creepage(Table):
    """The rigid creepages; a negative longitudinal one drives body A.

    Examples
    --------
    >>> ts.Creepage(longitudinal=-0.005, spin=0.01)
    Creepage(longitudinal=-0.005, lateral=0.0, spin=0.01, speed=None)
    """

    longitudinal: Real = number("longitudinal creepage xi_x", 0.0)
    lateral: Real = number("lateral creepage xi_y", 0.0)
    spin: Real = number("spin creepage phi, 1/mm", 0.0)
    speed: Positive | None = positive(
        "rolling speed V, mm/s, for what depends on the sliding speed", None
    )


MOST_ORTHOTROPIC = 100.0
"""Ratio of the friction coefficients up to which contacts are known to be solved."""


def _at_rest(friction: dict[str, Any]) -> tuple[float, float]:
    """The coefficients at rest, where only they are given; without them mu is not known."""
    if friction["static"] is None:
        raise KeyError("static")
    return friction["static"]


def _axes_alike(known: Known) -> Iterator[Fault]:
    mu = known["mu"]
    if max(mu) > MOST_ORTHOTROPIC * min(mu) * (1.0 + 1e-12):
        allowed = f"one coefficient at most {MOST_ORTHOTROPIC:g} times the other"
        yield Fault("mu", f"{mu[0]:g} and {mu[1]:g}", allowed)


FALLING = ("kinetic", "half_speed")
"""What a law that falls with the speed of sliding is given by."""

POLACH = ("A", "B")
"""What Polach's may be given by in its place."""


def _warmer(pairs: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
    if any(late[0] <= early[0] for early, late in pairwise(pairs)):
        raise ValueError("pairs [temperature, factor] whose temperatures ascend")
    return pairs


Factors = Annotated[tuple[tuple[Real, Positive], ...], AfterValidator(_warmer)]


def _law_is_given(known: Known) -> Iterator[Fault]:
    law, given = known["law"], known.given
    if isinstance(law, NamedLaw):
        return
    if law == "constant":
        idle = [key for key in ("static", *FALLING, *POLACH, "memory", "start") if key in given]
        if idle:
            cure = 'only with a law that falls: law = "exponential", "rational" or "polach"'
            yield Fault(", ".join(idle), 'with law = "constant"', cure)
        return
    polach = [key for key in POLACH if key in given]
    if polach and law != "polach":
        yield Fault(", ".join(polach), f'with law = "{law}"', f"{' and '.join(FALLING)}")
        return
    if polach and given.intersection(FALLING):
        told = f"together with {', '.join(key for key in FALLING if key in given)}"
        yield Fault(", ".join(polach), told, f"{' and '.join(FALLING)}, or {' and '.join(POLACH)}")
        return
    for key in POLACH if polach else FALLING:
        if key not in given:
            yield Fault(key, f'nothing, and law = "{law}"', "what the law falls to, and how fast")


def _kinetic_is_less(known: Known) -> Iterator[Fault]:
    mu, kinetic = known["mu"], known["kinetic"]
    if kinetic is None or known["law"] == "constant":
        return
    if any(less > more for less, more in zip(kinetic, mu, strict=True)):
        allowed = f"at most the coefficient at rest, {_pair(mu)}"
        yield Fault("kinetic", _pair(kinetic), allowed)
    elif not math.isclose(kinetic[0] * mu[1], kinetic[1] * mu[0], rel_tol=1e-9):
        allowed = "a pair in the ratio of that at rest: one law scales both coefficients"
        yield Fault("kinetic", _pair(kinetic), allowed)


def _pair(mu: tuple[float, float]) -> str:
    return f"{mu[0]:g}" if mu[0] == mu[1] else f"[{mu[0]:g}, {mu[1]:g}]"


FrictionName = Literal["constant", "exponential", "rational", "polach"]


class Friction(LawTable):
    """Orthotropic Coulomb friction; `angle` also turns the axes of the wear law.

    Both coefficients may fall with the local speed of sliding s, in the same ratio:
    kinetic + (static - kinetic) exp(-ln 2 s/half_speed), or .../(1 + s/half_speed).

    A law of another package has its parameters as further keys. It takes `mu`, `angle` in radians
    and the rolling speed `speed` from the scene if it has parameters of these names.

    Examples
    --------
    >>> ts.Friction(mu=(0.6, 0.3), angle=45.0).mu
    (0.6, 0.3)
    >>> ts.Friction(law="exponential", static=0.33, kinetic=0.14, half_speed=1250.0).mu
    (0.33, 0.33)
    """

    static: OptionalOrthotropicPositive = entry(
        "friction coefficients at rest, of a law that falls with sliding",
        "a number above 0, or a pair of them",
        None,
    )
    mu: OrthotropicPositive = entry(
        "friction coefficients along the axes e1, e2",
        "a number above 0, or a pair of them",
        default_factory=_at_rest,
    )
    angle: Real = entry(
        "angle from x to e1, degrees", "a number from -360 to 360", 0.0, ge=-360, le=360
    )
    law: FrictionName | NamedLaw = entry(
        "how friction falls with the local speed of sliding; all but the constant one need "
        "creepage.speed; or a law of another package",
        f'"constant", "exponential", "rational" or "polach", {ANOTHER}',
        "constant",
    )
    kinetic: OptionalOrthotropicPositive = entry(
        "friction coefficients at great speed",
        "a number above 0, or a pair in the ratio of that at rest",
        None,
    )
    half_speed: Positive | None = positive(
        "speed of sliding at which half of the way to it is gone, mm/s", None
    )
    A: Real | None = entry(
        "of Polach's law, in place of kinetic: what is left at great speed over that at rest",
        "a number from 0 to 1",
        None,
        ge=0,
        le=1,
    )
    B: Positive | None = positive(
        "of Polach's law, in place of half_speed: its rate of decay, s/m", None
    )
    memory: NotNegative = entry(
        "distance slid over which the coefficients follow the speed, mm; 0: at once",
        "a number of at least 0",
        0.0,
    )
    temperature: Factors | None = entry(
        "factor on the coefficients over the surface temperature, degrees C, linear between the "
        "pairs and constant beyond; needs [heat]",
        "pairs [temperature, factor], the temperatures ascending, the factors above 0",
        None,
        min_length=1,
    )
    strength: Positive | None = positive("shear strength that no traction exceeds, MPa", None)
    layer: NotNegative = entry(
        "shear compliance h/G3 of an interfacial layer, mm/MPa", "a number of at least 0", 0.0
    )
    start: Literal["rest", "sliding"] = entry(
        "where a falling law has several solutions: the one reached from friction at rest, or "
        "that from friction at great speed",
        '"rest" or "sliding"',
        "rest",
    )
    law_names: ClassVar[tuple[str, ...]] = get_args(FrictionName)
    law_fields: ClassVar[tuple[str, ...]] = ("static", *FALLING, *POLACH, "memory", "strength")
    checks: ClassVar[tuple[Check, ...]] = (
        exactly_one("mu", "static"),
        _axes_alike,
        _law_is_given,
        _kinetic_is_less,
    )

    @property
    def frame(self) -> Frame:
        """Scaled tribological frame of the coefficients at rest."""
        return Frame(self.mu, math.radians(self.angle))

    @property
    def varies(self) -> bool:
        """Whether the coefficients are other than at rest anywhere."""
        falls = self.share is not None
        return falls or self.strength is not None or self.temperature is not None

    @property
    def share(self) -> tuple[float, float] | None:
        """Share left at great speed, and the half speed, mm/s; None of what does not fall."""
        if self.law == "constant" or self.named_law:
            return None
        if self.A is not None:
            return self.A, 1e3 * math.log(2.0) / self.B
        return self.kinetic[0] / self.mu[0], self.half_speed


def _saved_within(known: Known) -> Iterator[Fault]:
    save, last = known["save"], known["revolutions"]
    if save[-1] > last:
        yield Fault("save", str(save[-1]), f"at most {last}, the number of revolutions")


def _ascending(save: tuple[int, ...]) -> tuple[int, ...]:
    if any(late <= early for early, late in pairwise(save)):
        raise ValueError("ascending whole numbers")
    return save


PER_INTENSITY = 1e3
"""Coefficient in mm3/(N m) of a wear intensity of 1/MPa = 1 mm3/(N mm)."""


class Coefficients(Table):
    """Specific wear rate of each body on its own, in place of one number for both together.

    Examples
    --------
    >>> ts.Wear(coefficient={"A": 1e-3, "B": 3e-3}, revolutions=100).coefficient.B
    0.003
    """

    A: NotNegative | None = entry(
        "specific wear rate k of body A, mm3/(N m)", "a number of at least 0", None
    )
    B: NotNegative | None = entry(
        "specific wear rate k of body B, mm3/(N m)", "a number of at least 0", None
    )


if TYPE_CHECKING:
    from .quantities import Accepting, Pair

    SpecificWearRate = Accepting[
        float | Pair | Coefficients | Mapping[str, float] | None, Pair | Coefficients | None
    ]
else:
    SpecificWearRate = OptionalOrthotropicNotNegative | Coefficients

LawName = Literal["archard", "energy", "usfd", "brr", "jendel"]
LawOrTable = Literal[LawName, "table"]
_LAWS = '"archard", "energy", "usfd", "brr" or "jendel"'

OF_SETS = {"usfd": USFD, "brr": BRR, "jendel": JENDEL}
"""Published sets of coefficients by the law that they are of; the first one is the default."""

BY_COEFFICIENT = ("archard", "energy")
"""Laws whose coefficient the scene gives."""


def _rising(points: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
    works = [work for work, _ in points]
    if not any(works) or any(late <= early for early, late in pairwise(works)):
        raise ValueError("pairs [W, rate] with ascending W")
    if works[0] == 0.0 and points[0][1]:
        raise ValueError("no rate at W = 0: what does not slip does not wear")
    return points


def _laws_of_what(known: Known) -> Iterator[Fault]:
    table, bodies = known["table"], (known["A"], known["B"])
    if table is None and bodies == (None, None):
        yield Fault("table", "nothing", "a table, or laws A and B of the bodies")
    if "table" in bodies and table is None:
        yield Fault("table", "nothing", "points of the law, as a body goes by them")
    if table is not None and any(bodies) and "table" not in bodies:
        yield Fault("table", "no body that goes by it", 'A = "table", B = "table", or no table')


class WearLaws(Table):
    """A wear law of one's own as points, or laws of each body on its own.

    Examples
    --------
    >>> laws = ts.WearLaws(A="usfd", B="archard")
    >>> ts.Wear(law=laws, coefficient={"B": 1e-4}, revolutions=100).laws
    {'A': 'usfd', 'B': 'archard'}
    """

    table: (
        Annotated[tuple[tuple[NotNegative, NotNegative], ...], AfterValidator(_rising)] | None
    ) = entry(
        "mass worn over frictional work: W = T-gamma/A, N/mm2, and rate, ug/(m mm2) of each body; "
        "straight from the origin through the points, and on beyond the last",
        "a list of pairs [W, rate] with ascending W",
        None,
        min_length=1,
    )
    A: LawOrTable | None = entry(
        "law of body A; without one it does not wear", f'{_LAWS}, or "table"', None
    )
    B: LawOrTable | None = entry(
        "law of body B; without one it does not wear", f'{_LAWS}, or "table"', None
    )
    checks: ClassVar[tuple[Check, ...]] = (_laws_of_what,)


class Sets(Table):
    """Named sets of coefficients of each body on its own.

    Examples
    --------
    >>> ts.Sets(A="low", B="high").A
    'low'
    """

    A: str | None = entry("set of coefficients of body A", "a name", None)
    B: str | None = entry("set of coefficients of body B", "a name", None)


def _laws(law: str | WearLaws | NamedLaw) -> dict[str, str | None]:
    """Name of the law of each body."""
    if not isinstance(law, WearLaws):
        return {"A": str(law), "B": str(law)}
    both = "table" if law.A is None and law.B is None else None
    return {"A": law.A or both, "B": law.B or both}


def _given_what_its_law_takes(known: Known) -> Iterator[Fault]:
    if isinstance(known["law"], NamedLaw):
        return
    laws = _laws(known["law"])
    taking = [body for body, name in laws.items() if name in BY_COEFFICIENT]
    either = known.given & {"intensity", "coefficient"}
    together = known["law"] in BY_COEFFICIENT
    if not taking:
        for key in sorted(either):
            yield Fault(
                key, f"with the law {known['law']!r}", "nothing: its coefficients are known"
            )
        return
    if known["law"] == "archard":
        yield from exactly_one("intensity", "coefficient")(known)
    elif "intensity" in either:
        cure = "coefficient: mm3/J of the energy law, or { A = ..., B = ... } of each body"
        yield Fault("intensity", "not with this law", cure)
    elif "coefficient" not in either:
        yield Fault("coefficient", "nothing", "that of the bodies whose law takes one")
    if "coefficient" not in either:
        return
    k = known["coefficient"]
    if not isinstance(k, Coefficients):
        if not together and k is not None:
            listed = ", ".join(f"{body} = ..." for body in taking)
            yield Fault("coefficient", str(k), f"that of each body: {{ {listed} }}")
        return
    for body, name in laws.items():
        value = getattr(k, body)
        if body in taking and value is None:
            yield Fault(f"coefficient.{body}", "nothing", f"that of its law, {name}")
        if body not in taking and value is not None:
            yield Fault(f"coefficient.{body}", str(value), "nothing: its law takes none")


def _sets_are_known(known: Known) -> Iterator[Fault]:
    laws, given = _laws(known["law"]), known["set"]
    for body in "AB" if given is not None else ():
        name = given if isinstance(given, str) else getattr(given, body)
        sets = OF_SETS.get(laws[body] or "", {})
        if name is not None and name not in sets and not (isinstance(given, str) and not sets):
            key = "set" if isinstance(given, str) else f"set.{body}"
            allowed = f"one of {', '.join(sets)}" if sets else "nothing: its law has no sets"
            yield Fault(key, repr(name), allowed)
            if isinstance(given, str):
                return
    if isinstance(given, str) and not any(laws[body] in OF_SETS for body in "AB"):
        yield Fault("set", repr(given), f"only with one of {', '.join(OF_SETS)}")


class Wear(LawTable):
    """Wear over many revolutions or a [transient], by Archard's law or by others.

    A law of another package has its parameters as further keys. It takes `mu`, `angle` in radians
    and the rolling speed `speed` from the scene if it has parameters of these names.

    Examples
    --------
    >>> ts.Wear(intensity=2e-6, revolutions=15000).stepping
    'adaptive'
    >>> ts.Wear(coefficient=2e-3, revolutions=15000).intensities
    (2e-06, 2e-06)
    >>> ts.Wear(law="usfd", revolutions=15000).sets
    {'A': 'r8t-uic60', 'B': 'r8t-uic60'}
    """

    law: LawName | WearLaws | NamedLaw = entry(
        "wear law: by pressure and slip, by frictional work, or by measured regimes; or a law of "
        "another package",
        f"{_LAWS}, {{ table = [[W, rate], ...] }}, {{ A = ..., B = ... }}, {ANOTHER}",
        "archard",
    )
    set: str | Sets | None = entry(
        "named set of coefficients of a measured law",
        "a name, or { A = ..., B = ... }",
        None,
    )
    by: Literal["element", "contact"] = entry(
        "whether a law of T-gamma/A is taken by each element, or by the whole contact",
        '"element" or "contact"',
        "element",
    )
    intensity: OptionalOrthotropicNotNegative = entry(
        "wear intensities along the axes e1, e2, of both bodies together, 1/MPa",
        "a number of at least 0, or a pair of them",
        None,
    )
    coefficient: SpecificWearRate = entry(
        "specific wear rates k along the axes e1, e2, mm3/(N m), or of the energy law, in mm3/J of "
        "the work along each axis; of both bodies together, or of each on its own",
        "a number of at least 0, a pair of them, or { A = ..., B = ... }",
        None,
    )
    revolutions: Whole = entry(
        "number of revolutions of body A, of B where A is flat; none with [transient]",
        "a whole number from 1 to 1e12, which only a scene with [transient] may leave out",
        0,
        ge=1,
        le=10**12,
    )
    save: Annotated[tuple[Annotated[Whole, Field(ge=0)], ...], AfterValidator(_ascending)] = entry(
        "revolutions whose fields are stored",
        "ascending whole numbers from 0",
        default_factory=lambda wear: tuple(sorted({0, wear["revolutions"]})),
        min_length=1,
    )
    temperature: Factors | None = entry(
        "factor on the wear over the surface temperature, degrees C, linear between the pairs and "
        "constant beyond; needs [heat]",
        "pairs [temperature, factor], the temperatures ascending, the factors above 0",
        None,
        min_length=1,
    )
    stepping: Literal["adaptive", "every-revolution"] = entry(
        "stepping through the revolutions", '"adaptive" or "every-revolution"', "adaptive"
    )
    turns: Literal["each", "equal"] = entry(
        "whether each body meets its wear again at its own turns, or both at those of A",
        '"each" or "equal" (the paper\'s, for bodies of equal circumference)',
        "each",
    )
    tolerance: Real = entry(
        "error of the adaptive stepping, relative to the wear depth",
        "a number above 0, at most 0.1",
        1e-3,
        gt=0,
        le=0.1,
    )
    law_names: ClassVar[tuple[str, ...]] = get_args(LawName)
    law_fields: ClassVar[tuple[str, ...]] = ("set", "by", "intensity", "coefficient")
    checks: ClassVar[tuple[Check, ...]] = (
        _given_what_its_law_takes,
        _sets_are_known,
        _saved_within,
    )

    @property
    def laws(self) -> dict[str, str | None]:
        """Name of the law of each body; None of one that does not wear."""
        return _laws(self.law)

    @property
    def together(self) -> bool:
        """Whether one law wears both bodies together, each by its share."""
        return self.law in BY_COEFFICIENT or self.named_law is not None

    @property
    def sets(self) -> dict[str, str | None]:
        """Name of the set of coefficients of each body, where its law has sets."""
        found = {}
        for body, law in self.laws.items():
            given = self.set if isinstance(self.set, str | None) else getattr(self.set, body)
            found[body] = (given or next(iter(OF_SETS[law]))) if law in OF_SETS else None
        return found

    @property
    def intensities(self) -> tuple[float, float]:
        """Wear intensities (i1, i2) of both bodies together, 1/MPa, by whichever key is given."""
        if self.intensity is not None:
            return self.intensity
        k = self.coefficient
        if isinstance(k, Coefficients):
            k = ((k.A or 0.0) + (k.B or 0.0),) * 2
        return (k[0] / PER_INTENSITY, k[1] / PER_INTENSITY)

    def per_work(self, mu: tuple[float, float]) -> tuple[float, float] | None:
        """Depth worn over frictional work per area along the axes, 1/MPa; None of other laws."""
        if self.law not in BY_COEFFICIENT:
            return None
        i = self.intensities
        return i if self.law == "energy" else (i[0] / mu[0], i[1] / mu[1])

    @property
    def share(self) -> dict[str, float] | None:
        """Share of each body in the depth worn; None where only hardness tells it."""
        k = self.coefficient
        if not (isinstance(k, Coefficients) and self.together):
            return None
        share = k.A / (k.A + k.B) if k.A + k.B else 0.5
        return {"A": share, "B": 1.0 - share}


_Elements = Annotated[int, Field(ge=3, le=10**6)]
_OneOrTwo = Annotated[
    tuple[_Elements, ...], BeforeValidator(alone), Field(min_length=1, max_length=2)
]


MOST_ELEMENTS = 5 * 10**7
"""Elements of a grid: more would take some hundred GiB."""


def _fits_a_machine(known: Known) -> Iterator[Fault]:
    elements = known["elements"]
    if elements is not None and math.prod(elements) > MOST_ELEMENTS:
        yield Fault("elements", str(elements), f"at most {MOST_ELEMENTS:.0e} elements in all")


LONGEST = 1e6
"""Side of an element over the other: in a longer one the influence coefficients lose all digits."""


def _no_needles(known: Known) -> Iterator[Fault]:
    half_length, elements = known["half_length"] or (), known["elements"] or ()
    if len(half_length) == len(elements) == 2:
        dx, dy = (length / n for length, n in zip(half_length, elements, strict=True))
        if not 1.0 / LONGEST <= dx / dy <= LONGEST:
            given = f"elements of {2 * dx:.3g} x {2 * dy:.3g} mm"
            yield Fault("half_length", given, f"elements at most {LONGEST:g} times as long as wide")


def _not_nothing(known: Known) -> Iterator[Fault]:
    if known["half_length"] is None and known["elements"] is None:
        yield Fault("half_length", "nothing", "it, elements or both; or no [grid]")


class Mesh(Table):
    """The [grid] table: a rectangle of equal elements around the origin.

    A line contact has one number in place of each pair, that in x. Without `half_length` the domain
    is that of a scene without [grid]; it grows with the contact, by elements of the same size.
    Without `elements` they are as large as those of such a scene, or a little smaller.

    Examples
    --------
    >>> ts.Mesh(half_length=(0.35, 1.4), elements=(41, 121)).elements
    (41, 121)
    """

    half_length: OptionalPositiveOneOrTwo = entry(
        "half lengths of the domain in x and y, mm; by default chosen from the contact",
        "a pair of numbers above 0",
        None,
    )
    elements: _OneOrTwo | None = entry(
        "elements in x and y; by default chosen from the contact",
        "a pair of whole numbers from 3 to 1e6",
        None,
    )
    checks: ClassVar[tuple[Check, ...]] = (_not_nothing, _fits_a_machine, _no_needles)


class Accuracy(Table):
    """An accuracy in place of a mesh: the mesh and all tolerances follow from it.

    The mesh is refined until the error bars of the forces and of the moment, of the largest
    pressure of the unworn bodies and of the depth of wear are within the tolerance. The largest
    stress has a bar of its own, which may be wider.

    Examples
    --------
    >>> ts.Accuracy(tolerance=1e-2).elements
    300000
    """

    tolerance: Real = entry(
        "error of the results, relative", "a number from 1e-5 to 0.1", 1e-3, ge=1e-5, le=0.1
    )
    elements: int = entry(
        "most elements of a mesh", "a whole number from 1000 to 5e7", 300_000, ge=1000, le=5 * 10**7
    )


class Subsurface(Table):
    """Where the stress below the surface is computed.

    Examples
    --------
    >>> ts.Subsurface(planes=("y=0", "x=0.5a"), depth=2.0).bodies
    ('A', 'B')
    """

    planes: Annotated[
        tuple[Annotated[Plane, PlainValidator(Plane.parse)], ...], AfterValidator(distinct)
    ] = entry("planes of the stress", 'a list of planes like "y=0.75a"', min_length=1)
    depth: Positive = positive("depth, in units of the semi-axis a", 1.5)
    elements: int = entry(
        "points over the depth", "a whole number from 2 to 1e6", 64, ge=2, le=10**6
    )
    bodies: Annotated[tuple[Literal["A", "B"], ...], AfterValidator(distinct)] = entry(
        "bodies whose stress is computed", 'a list of "A" and "B"', ("A", "B"), min_length=1
    )


class ElasticBodies(LawTable):
    """The [elasticity] table: homogeneous half-spaces, or a law of another package.

    Such a law has its parameters as further keys. It takes the materials `A` and `B` of the bodies
    from the scene if it has parameters of these names. Hertz's contact, from which the mesh and the
    units follow, is that of homogeneous bodies.

    Examples
    --------
    >>> ts.ElasticBodies(law="my_package:Coated", thickness=0.1).law.parameters
    {'thickness': 0.1}
    """

    law: Literal["half-spaces"] | NamedLaw = entry(
        "how the surfaces of the bodies displace under tractions",
        f'"half-spaces", {ANOTHER}',
        "half-spaces",
    )
    law_names: ClassVar[tuple[str, ...]] = ("half-spaces",)


class Solver(Table):
    """How the contact problem is solved.

    Examples
    --------
    >>> ts.Solver(method="newton", tolerance=1e-6).method
    'newton'
    """

    method: Literal["auto", "uzawa", "anderson", "newton"] = entry(
        "iteration of the tangential problem", '"auto", "uzawa", "anderson" or "newton"', "auto"
    )
    slip: Literal["auto", "upwind"] = entry(
        "discretisation of the slip: to second order, or the paper's, to first",
        '"auto" (second order) or "upwind" (the paper\'s)',
        "auto",
    )
    tolerance: Real = entry(
        "relative tolerance of the contact conditions",
        "a number from 1e-13 to 1e-2",
        1e-8,
        ge=1e-13,
        le=1e-2,
    )
