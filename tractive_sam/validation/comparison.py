"""Published values beside computed ones: a value, a published set of values, and what it gave."""

import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from decimal import Decimal
from enum import StrEnum
from time import process_time

from tractive_sam.results import NotConverged
from tractive_sam.schema import SceneWarning


class Verdict(StrEnum):
    """Agreement of computed with published values."""

    AGREES = "agrees"
    EXPLAINED = "differs, explained"
    DIFFERS = "differs"
    FAILED = "not computed"


@dataclass(frozen=True)
class Comparison:
    """A published value and the computed one.

    Attributes
    ----------
    quantity : str
        Name of the quantity, with its unit if it has one.
    published : str
        The published value with its digits, or seven digits of a closed form.
    computed : float
        The computed value.
    allowed : float
        Largest difference of agreement: half a unit of the last published digit, and the error that
        the computation claims.
    value : float
        The published value as a number.
    reason : str
        Why the values differ, if the computation shows it.
    """

    quantity: str
    published: str
    computed: float
    allowed: float
    value: float
    reason: str = ""

    @property
    def difference(self) -> float:
        """Computed value minus published value."""
        return self.computed - self.value

    @property
    def agrees(self) -> bool:
        """Whether the difference is allowed."""
        return abs(self.difference) <= self.allowed


def compare(
    quantity: str, published: str | float, computed: float, error: float = 0.0, scale: float = 0.0
) -> Comparison:
    """Return a comparison that allows for the published digits and for the error of computation.

    Parameters
    ----------
    quantity : str
        Name of the quantity.
    published : str or float
        A printed value with its digits, or the number of a closed form.
    computed : float
        The computed value.
    error : float
        Relative error that the computation claims: of its mesh, or of its iteration.
    scale : float
        Size to which the error is relative, if it is larger than the value.
    """
    allowed = error * max(abs(float(published)), scale)
    if isinstance(published, float):
        return Comparison(quantity, f"{published:.7g}", float(computed), allowed, published)
    exponent = int(Decimal(published).as_tuple().exponent)
    half_unit = 0.5 * 10.0**exponent * (1.0 + 1e-6)
    return Comparison(quantity, published, float(computed), allowed + half_unit, float(published))


@dataclass(frozen=True)
class PublishedSet:
    """Values that belong together: of a table, an example or a closed form.

    Attributes
    ----------
    title : str
        What is compared.
    source : str
        Author, year, and place in the publication.
    compute : callable
        Returns the comparisons.
    error : str
        What the allowed differences contain beside the published digits.
    explanation : str
        Why computed values differ from published ones, where they do and it is known.
    quick : bool
        Whether the set belongs to the quick half, which takes about a minute.
    """

    title: str
    source: str
    compute: Callable[[], Iterable[Comparison]]
    error: str = ""
    explanation: str = ""
    quick: bool = True

    def run(self) -> "Outcome":
        """Compute the values, and return them with their verdict.

        A contact that cannot be solved is a verdict too.
        """
        began, failure, comparisons = process_time(), "", list[Comparison]()
        with warnings.catch_warnings():
            # Published examples go to extremes: creepages of 25 %, bodies of one N/mm².
            warnings.simplefilter("ignore", SceneWarning)
            try:
                comparisons.extend(self.compute())
            except (NotConverged, RuntimeError) as error:
                failure = str(error)
        return Outcome(self, tuple(comparisons), process_time() - began, failure)


@dataclass(frozen=True)
class Topic:
    """A title and the published sets below it."""

    title: str
    sets: tuple[PublishedSet, ...]


@dataclass(frozen=True)
class Outcome:
    """A published set with its comparisons, the CPU seconds that they took, and their failure."""

    of: PublishedSet
    comparisons: tuple[Comparison, ...]
    seconds: float
    failure: str = ""

    def verdict(self, comparison: Comparison) -> Verdict:
        """Return the verdict on a comparison of this set."""
        if comparison.agrees:
            return Verdict.AGREES
        is_explained = comparison.reason or self.of.explanation
        return Verdict.EXPLAINED if is_explained else Verdict.DIFFERS

    @property
    def worst(self) -> Verdict:
        """The verdict on the complete set: that on its worst comparison."""
        order = list(Verdict)
        found = [self.verdict(comparison) for comparison in self.comparisons]
        return max([*found, *([Verdict.FAILED] if self.failure else [])], key=order.index)
