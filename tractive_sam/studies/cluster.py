"""Workers of dask.distributed, on one or more machines.

The scheduler only distributes calls. All state is in the files of a study: an interrupted case is
submitted again and resumes from its last record.
"""

import gc
import socket
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from importlib.util import find_spec
from time import monotonic, sleep
from typing import TYPE_CHECKING, Any
from uuid import uuid4

from tractive_sam import interrupt
from tractive_sam.extras import describe_missing
from tractive_sam.schema import allow_laws
from tractive_sam.store import ResultsError
from tractive_sam.studies.pool import (
    Call,
    LocalWorkers,
    WorkerDiedError,
    Workers,
    call_with_laws,
)

if TYPE_CHECKING:
    from distributed import Client, Future


@dataclass(frozen=True)
class Waits:
    """Waiting times and patience with a scheduler and its workers, s.

    Attributes
    ----------
    first : float
        Longest wait for a scheduler that has not been reached yet.
    lost : float
        Longest wait for a scheduler that was lost.
    answer : float
        Longest wait for an answer of a scheduler.
    pause : float
        Pause before tasks that were interrupted or locked are submitted again.
    poll : float
        Time between checks for tasks that have ended.
    """

    first: float = 30.0
    lost: float = 600.0
    answer: float = 5.0
    pause: float = 1.0
    poll: float = 0.05


WAITS = Waits()


class SchedulerLostError(ConnectionError):
    """Error of a scheduler that does not exist or was lost; complete cases stay complete.

    Examples
    --------
    >>> from tractive_sam import studies
    >>> def run_somewhere(study, folder, address):
    ...     try:
    ...         return studies.study(study, folder, scheduler=address)
    ...     except studies.SchedulerLostError:
    ...         return studies.study(study, folder)  # on this machine, the remaining cases
    """


class _DisconnectedError(Exception):
    """Raised if the connection to the scheduler breaks, or it loses its tasks."""


@contextmanager
def open_workers(
    number: int, scheduler: str | None = None, log: Callable[[str], None] = print
) -> Iterator[Workers]:
    """Within the block, yield worker processes of this machine, or the workers of a scheduler.

    Parameters
    ----------
    number : int
        Number of processes, without a scheduler.
    scheduler : str, optional
        Address of a scheduler of dask.distributed, which has its own workers.
    log : callable
        Called with a message about what a scheduler is waited for.

    Raises
    ------
    ResultsError
        If dask is not installed, with a scheduler.

    Examples
    --------
    >>> import math
    >>> from tractive_sam import studies
    >>> def root(number):
    ...     with studies.open_workers(1) as workers:
    ...         return dict(studies.computed([(math.sqrt, number)], workers))[0]
    """
    if scheduler is not None:
        if find_spec("distributed") is None:
            missing = describe_missing("a scheduler", "distributed")
            raise ResultsError(f"{missing}; or use processes of this machine (--workers)")
        yield Cluster(scheduler, log)
        return
    with LocalWorkers(number) as workers:
        yield workers


class Cluster:
    """Workers of a scheduler of dask.distributed.

    The calls of a worker that dies are submitted to others. If the scheduler is lost, all remaining
    calls are submitted again.

    Parameters
    ----------
    address : str
        Address of the scheduler.
    log : callable
        Called with a message about what is waited for.
    """

    def __init__(self, address: str, log: Callable[[str], None]) -> None:
        self._address, self._log, self._patience = address, log, WAITS.first

    def run(self, calls: Sequence[Call]) -> Iterator[tuple[int, Any]]:
        """Compute calls; yield (index, result or exception) as they end, see `Workers`.

        Raises
        ------
        ResultsError
            If the address is invalid.
        SchedulerLostError
            If no scheduler answers within the time of `WAITS`.
        """
        remaining = dict(enumerate(calls))
        while remaining:
            try:
                with self._client() as client:
                    self._patience = WAITS.lost
                    self._report_workers(client)
                    for k, future in _submit_calls(client, remaining):
                        answer = _answer(future)
                        del remaining[k]
                        yield k, answer
            except _DisconnectedError:
                self._log("the scheduler was lost; the remaining cases are submitted again")
                sleep(WAITS.pause)

    def _report_workers(self, client: "Client") -> None:
        """Log that a scheduler has no workers, or workers with several threads."""
        threads = client.nthreads()
        if not threads:
            self._log(
                "the scheduler has no workers yet; dask worker ADDRESS --nthreads 1 starts one"
            )
        many = sum(count > 1 for count in threads.values())
        if many:
            self._log(
                f"{many} workers have several threads, which slows them; "
                "start them with --nthreads 1"
            )

    @contextmanager
    def _client(self) -> Iterator["Client"]:
        """Within the block, connect to the scheduler; SchedulerLostError after the patience."""
        from distributed import Client  # of an extra
        from distributed.comm import get_address_host_port  # of an extra

        client, began, waiting = None, monotonic(), False
        while client is None:
            interrupt.raise_if_interrupted()
            try:
                # Clients without a connection close when they are collected. If another event loop
                # starts meanwhile and holds the lock of the loops, they would wait forever.
                gc.collect()
                socket.create_connection(get_address_host_port(self._address), WAITS.answer).close()
                client = Client(self._address, timeout=WAITS.answer, set_as_default=False)
            except (OSError, TimeoutError) as error:
                if monotonic() - began > self._patience:
                    cure = "start one and run the study again: complete cases are not run again"
                    reason = error.with_traceback(None)  # the traceback refers to the client
                    raise SchedulerLostError(
                        f"no scheduler answers at {self._address}; {cure}"
                    ) from reason
                if not waiting:
                    self._log(f"waiting for a scheduler at {self._address}")
                waiting = True
                sleep(WAITS.pause)
            except ValueError:
                cure = "use tcp://HOST:PORT, as the scheduler prints it"
                raise ResultsError(
                    f"{self._address} is not an address of a scheduler; {cure}"
                ) from None
        try:
            yield client
        finally:
            with suppress(OSError, TimeoutError):
                client.close(timeout=5)


def _submit_calls(client: "Client", calls: Mapping[int, Call]) -> Iterator[tuple[int, "Future"]]:
    """Submit calls to a scheduler, the first ones first; yield (index, future) as they end."""
    from distributed import as_completed  # of an extra

    unique = uuid4().hex  # the scheduler must not take a call for an earlier one
    futures = {
        client.submit(
            call_with_laws, allow_laws(), call, key=f"call-{k}-{unique}", priority=-k, pure=False
        ): k
        for k, call in calls.items()
    }
    try:
        ended = as_completed(futures, loop=client.loop)
        while not ended.is_empty():
            interrupt.raise_if_interrupted()
            if not ended.has_ready():
                sleep(WAITS.poll)
                continue
            future = next(ended)
            yield futures.pop(future), future
            future.release()
    finally:
        # If the client stops early, the scheduler drops the cases that have not begun.
        for future in futures:
            with suppress(OSError, TimeoutError):
                future.release()


def _answer(future: "Future") -> Any:
    """Return the result of an ended call, or its exception; _DisconnectedError if it was lost."""
    from distributed.scheduler import KilledWorker  # of an extra

    if future.status == "finished":
        return future.result()
    if future.status != "error":
        raise _DisconnectedError
    error = future.exception()
    return WorkerDiedError() if isinstance(error, KilledWorker) else error
