"""Answers of cases: computed once, here or by workers, and stored as they come."""

import math
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field, replace
from statistics import median
from time import monotonic, process_time
from typing import Any, TypeVar

import numpy as np

from tractive_sam import interrupt
from tractive_sam.fitting.case import Answer, FitCase, compute
from tractive_sam.results import State

Name = TypeVar("Name", bound=Hashable)

Compute = Callable[[Sequence[FitCase]], Iterator[tuple[int, Answer]]]
"""Computes cases; yields their places and answers as they end."""


class InProcess:
    """Computes cases in this process; a contact starts from the contact of its case `near`.

    Attributes
    ----------
    seconds : list of float
        CPU times of the cases so far.
    """

    def __init__(self) -> None:
        # The last contact that had no initial guess, and its scene, of each seat.
        self._contacts: dict[tuple[int, ...], tuple[str, State | None]] = {}
        self.seconds: list[float] = []

    def __call__(self, cases: Sequence[FitCase]) -> Iterator[tuple[int, Answer]]:
        """Yield (index, answer) of each case as it is computed (`Compute`)."""
        for k, case in enumerate(cases):
            interrupt.raise_if_interrupted()
            began = process_time()
            answer, contact = compute(case, self._start_of(case))
            self.seconds.append(process_time() - began)
            if case.near is None:
                self._contacts[case.seat] = case.scene.fingerprint(), contact
            yield k, answer

    def _start_of(self, case: FitCase) -> State | None:
        """Return the initial guess of a case, solved again if a stored answer stands for it."""
        if case.near is None or not case.is_steady:
            return None
        scene, contact = self._contacts.get(case.seat, ("", None))
        if scene != case.near.scene.fingerprint():
            scene = case.near.scene.fingerprint()
            _, contact = compute(replace(case.near, derivatives=()), None)
            self._contacts[case.seat] = scene, contact
        return contact


def compute_in_turn(cases: Sequence[FitCase]) -> list[Answer]:
    """Return the answers of similar cases; runs in workers."""
    return [answer for _, answer in InProcess()(cases)]


@dataclass
class InWorkers:
    """Computes cases in worker processes of this machine, short ones in this process.

    A worker computes all contacts of one seat, which start from the same contact.

    Attributes
    ----------
    number : int
        Processes.
    stack : ExitStack
        Ends the processes.
    say : callable
        Called with a text if something has to be waited for.
    worthwhile : float
        Least CPU time of all cases that are computed together, s, in this process: shorter ones
        take longer in workers, which need seconds to start and know no contact to start from.
    here : InProcess
        Computes what is not worthwhile, and what comes first.
    """

    number: int
    stack: ExitStack
    say: Callable[[str], None] = print
    worthwhile: float = 2.0
    here: InProcess = field(default_factory=InProcess)
    _cluster: tuple[str, Any] | None = None

    def __call__(self, cases: Sequence[FitCase]) -> Iterator[tuple[int, Answer]]:
        """Yield (index, answer) of each case as it is computed (`Compute`)."""
        times = self.here.seconds
        if not times or median(times) * len(cases) < self.worthwhile:
            yield from self.here(cases)
            return
        # dask is an extra, and takes long to load
        from tractive_sam.studies import computed, local_cluster  # noqa: PLC0415

        if self._cluster is None:
            self._cluster = self.stack.enter_context(local_cluster(self.number))
        groups: dict[tuple, list[int]] = {}
        for k, case in enumerate(cases):
            groups.setdefault(case.seat if case.is_steady else (k,), []).append(k)
        places = list(groups.values())
        calls = [(compute_in_turn, [cases[k] for k in group]) for group in places]
        address, security = self._cluster
        for n, answers in computed(calls, address, self.say, security):
            yield from zip(places[n], answers, strict=True)


@contextmanager
def compute_with(number: int) -> Iterator[Compute]:
    """Yield what computes cases: this process for 0 workers, else `number` worker processes.

    Parameters
    ----------
    number : int
        Processes; 0: this one.
    """
    if not number:
        yield InProcess()
        return
    from tractive_sam.studies import check_installed  # noqa: PLC0415 - loads dask

    check_installed()
    with ExitStack() as stack:
        yield InWorkers(number, stack)


@dataclass
class Evaluations:
    """Store of the answers of all cases, which computes missing ones and writes them to the file.

    Attributes
    ----------
    compute : Compute
        Computes answers that are not known.
    known : dict of str to Answer
        Answers by the digest of the case; answers of an earlier run come from its file.
    save : callable, optional
        Writes the file; called at most every `interval` seconds, and when the fit is interrupted.
    interval : float
        Least time between two writings, s. An interruption loses no more, unless one case takes
        longer.
    progress : callable, optional
        Called after each case that was computed, and after each iteration of the search.
    searched : list of (float, float)
        Time, s, and chi-square of each iteration of the search, priors included.
    """

    compute: Compute
    stored: dict[str, Answer] = field(default_factory=dict)
    save: Callable[[], None] | None = None
    interval: float = 2.0
    progress: Callable[["Evaluations"], None] | None = None
    searched: list[tuple[float, float]] = field(default_factory=list)
    _saved: float = field(default_factory=monotonic)

    def answers(self, cases: Mapping[Name, FitCase]) -> dict[Name, Answer]:
        """Return the answers of cases, by name; those not stored yet are computed."""
        missing = {c.digest: c for c in cases.values() if c.digest not in self.stored}
        if missing:
            digests = list(missing)
            try:
                for k, answer in self.compute(list(missing.values())):
                    self.add(digests[k], answer)
            except BaseException:
                self.write()
                raise
        return {name: self.stored[case.digest] for name, case in cases.items()}

    def remember(self, digest: str, compute: Callable[[], Answer]) -> Answer:
        """Return the stored answer of a digest, or compute it with a function and store it."""
        if digest not in self.stored:
            self.add(digest, compute())
        return self.stored[digest]

    @property
    def cost(self) -> tuple[int, int, float]:
        """Contacts, rolls and convolutions of all stored answers, earlier runs included."""
        answers = self.stored.values()
        contacts, rolls = (
            sum(getattr(answer, name) for answer in answers) for name in ("contacts", "rolls")
        )
        return contacts, rolls, sum(answer.convolutions for answer in answers)

    def add_iteration(self, chi2: float) -> None:
        """Store the chi-square of an iteration of the search, and report progress."""
        self.searched.append((monotonic(), chi2))
        if self.progress is not None:
            self.progress(self)

    def seconds_left(self, small: float = 1e-3) -> float:
        """Return the expected time of the search until chi-square falls by less than `small`, s.

        Chi-square is assumed to fall by equal factors from now on; nan while this is unknown.
        """
        if len(self.searched) < 3:
            return math.nan
        times, chi2 = np.transpose(self.searched[-3:])
        before, last = -np.diff(chi2)
        if last <= small:
            return 0.0
        ratio = last / before if before > last else 0.9
        return float(math.log(small / last) / math.log(ratio) * 0.5 * (times[-1] - times[0]))

    def add(self, digest: str, answer: Answer) -> None:
        """Store an answer in memory, report progress, and write the file at intervals."""
        self.stored[digest] = answer
        if self.progress is not None:
            self.progress(self)
        if monotonic() - self._saved > self.interval:
            self.write()

    def write(self) -> None:
        """Write the file of the fit, if it has one, with all stored answers."""
        if self.save is not None:
            self.save()
        self._saved = monotonic()
