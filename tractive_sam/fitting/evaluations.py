"""Answers of cases: computed once, here or by workers, and stored as they come."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from time import monotonic
from typing import TypeVar

from tractive_sam import interrupt
from tractive_sam.fitting.case import Answer, FitCase, compute
from tractive_sam.results import State

Name = TypeVar("Name", bound=Hashable)

Compute = Callable[[Sequence[FitCase]], Iterator[tuple[int, Answer]]]
"""Computes cases; yields their places and answers as they end."""


class Here:
    """Computes in this process, each contact from the last one of its seat."""

    def __init__(self) -> None:
        self._contacts: dict[tuple[int, ...], State] = {}

    def __call__(self, cases: Sequence[FitCase]) -> Iterator[tuple[int, Answer]]:
        """See `Compute`."""
        for k, case in enumerate(cases):
            interrupt.raise_if_interrupted()
            answer, contact = compute(case, self._contacts.get(case.seat))
            if contact is not None:
                self._contacts[case.seat] = contact
            yield k, answer


def compute_answer(case: FitCase) -> Answer:
    """Return the answer of a case alone, for workers."""
    return compute(case)[0]


@contextmanager
def compute_with(number: int, say: Callable[[str], None] = print) -> Iterator[Compute]:
    """Compute in this process, or in processes of this machine.

    Parameters
    ----------
    number : int
        Processes; 0: this one.
    say : callable
        Called with a text where something has to be waited for.
    """
    if not number:
        yield Here()
        return
    # dask is an extra, and takes long to load
    from tractive_sam.studies import (  # noqa: PLC0415
        check_installed,
        computed,
        local_cluster,
    )

    check_installed()
    with local_cluster(number) as (address, security):

        def elsewhere(cases: Sequence[FitCase]) -> Iterator[tuple[int, Answer]]:
            calls = [(compute_answer, case) for case in cases]
            yield from computed(calls, address, say, security)

        yield elsewhere


@dataclass
class Evaluations:
    """The answers of all cases so far.

    Attributes
    ----------
    compute : Compute
        Computes those that are not known.
    known : dict of str to Answer
        By the digest of the case; those of an earlier run come from its file.
    save : callable, optional
        Writes the file; called at most every `interval` seconds, and where the fit is interrupted.
    interval : float
        Least time between two writings, s: a computation lost takes no longer, unless one case
        does.
    progress : callable, optional
        Called after each case that was computed.
    """

    compute: Compute
    known: dict[str, Answer] = field(default_factory=dict)
    save: Callable[[], None] | None = None
    interval: float = 2.0
    progress: Callable[[Evaluations], None] | None = None
    _saved: float = field(default_factory=monotonic)

    def answers(self, cases: Mapping[Name, FitCase]) -> dict[Name, Answer]:
        """Return the answers of cases, by name; those not known are computed."""
        missing = {c.digest: c for c in cases.values() if c.digest not in self.known}
        if missing:
            digests = list(missing)
            try:
                for k, answer in self.compute(list(missing.values())):
                    self.add(digests[k], answer)
            except BaseException:
                self.write()
                raise
        return {name: self.known[case.digest] for name, case in cases.items()}

    def remember(self, digest: str, compute: Callable[[], Answer]) -> Answer:
        """Return an answer, computed by a function if it is not known."""
        if digest not in self.known:
            self.add(digest, compute())
        return self.known[digest]

    @property
    def cost(self) -> tuple[int, int, float]:
        """Contacts, rolls and transforms of all computations, those of earlier runs included."""
        known = self.known.values()
        contacts, rolls = (
            sum(getattr(one, name) for one in known) for name in ("contacts", "rolls")
        )
        return contacts, rolls, sum(one.convolutions for one in known)

    def add(self, digest: str, answer: Answer) -> None:
        """Add an answer, and store it."""
        self.known[digest] = answer
        if self.progress is not None:
            self.progress(self)
        if monotonic() - self._saved > self.interval:
            self.write()

    def write(self) -> None:
        """Write what is known."""
        if self.save is not None:
            self.save()
        self._saved = monotonic()
