"""Cases on the workers of dask.distributed.

The scheduler only distributes cases, long ones first. All state is in the files: an interrupted
case is submitted again and resumes from its last record.
"""

import gc
import logging
import signal
import socket
from collections.abc import Callable, Iterator, Sequence, Sized
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from importlib.util import find_spec
from multiprocessing import resource_tracker
from time import monotonic, sleep
from traceback import format_exception
from typing import TYPE_CHECKING, Any, TypeVar
from uuid import uuid4

from tractive_sam import interrupt
from tractive_sam.extras import describe_missing
from tractive_sam.schema import allow_laws
from tractive_sam.store import ResultsError
from tractive_sam.studies.worker import (
    FAILED,
    LOCKED,
    SINGLE_THREAD,
    CaseOutcome,
    Chain,
    Task,
    make_chains,
    run_case,
    run_chain,
)

if TYPE_CHECKING:
    from distributed import Client, Future, Worker
    from distributed.security import Security

Answer = TypeVar("Answer")


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
def local_cluster(workers: int, encrypted: bool = True) -> Iterator[tuple[str, "Security | None"]]:
    """Start a scheduler and workers on this machine for the block; yield (address, security).

    They accept connections from this machine only, and show no web page of their state. Everyone
    who reaches a port of dask without TLS can run any program through it, also other users.

    Parameters
    ----------
    workers : int
        Number of processes.
    encrypted : bool
        Whether they use TLS, with keys that are made for this cluster and stored only in memory.

    Yields
    ------
    str, Security or None
        Address of their scheduler, and the keys that a client needs.

    Raises
    ------
    ResultsError
        If keys are needed and cannot be made.

    Examples
    --------
    >>> from tractive_sam import studies
    >>> def by_cluster(calls):
    ...     with studies.local_cluster(2) as (address, security):
    ...         return dict(studies.computed(calls, address, print, security))
    """
    from dask import config  # of an extra
    from distributed import Client, LocalCluster  # of an extra
    from distributed.security import Security  # of an extra

    try:
        security = Security.temporary() if encrypted else None
    except ImportError:
        raise ResultsError(
            "encryption needs the package cryptography, of the extra study: pip install "
            "cryptography; or use encrypted=False (--unencrypted) if no other user of this machine "
            "could misuse the processes"
        ) from None
    _close_unused_clients()
    # No pages at the ports for browsers, also of workers that replace dead ones.
    kinds = ("scheduler", "worker")
    pages: dict[str, list[str]] = {f"distributed.{kind}.http.routes": [] for kind in kinds}
    with _signals_blocked(), config.set(pages):
        cluster = LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            processes=True,
            host="127.0.0.1",
            memory_limit=0,  # no limit; `explain` estimates the memory of a scene
            dashboard_address=None,
            scheduler_kwargs={"dashboard_address": "127.0.0.1:0"},  # any free port
            security=security,
            silence_logs=logging.ERROR,
            env=SINGLE_THREAD,
        )
    with cluster:
        with Client(cluster.scheduler_address, security=security, set_as_default=False) as client:
            client.run(_silence_worker)
            # the port on which a scheduler serves its status pages
            client.run_on_scheduler(lambda dask_scheduler: dask_scheduler.http_server.stop())
        yield cluster.scheduler_address, security


def _close_unused_clients() -> None:
    """Close clients without a connection, before another event loop starts.

    The garbage collector closes these clients at any time. If the lock of the loops is held at that
    time, it would wait forever.
    """
    gc.collect()


def _silence_worker(dask_worker: "Worker") -> None:
    """Suppress a worker's messages on aborted cases and lost connections; close its status page.

    The client reports both; if a command ends while a worker reports to the scheduler, the worker
    would print a traceback.
    """
    logging.getLogger("distributed.worker.state_machine").setLevel(logging.ERROR)
    logging.getLogger("distributed.worker").addFilter(
        # An OSError comes from a lost connection.
        lambda record: not (record.exc_info and isinstance(record.exc_info[1], OSError))
    )
    dask_worker.http_server.stop()


@contextmanager
def _signals_blocked() -> Iterator[None]:
    """Within the block, block Ctrl-C in new threads and processes.

    A terminal sends it to all processes of a command. The client ends the workers; otherwise each
    worker would print a traceback.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    resource_tracker.ensure_running()  # started later, it would unblock Ctrl-C
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGHUP})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)  # blocked signals are delivered now


def on_cluster(
    tasks: list[Task],
    address: str,
    count_records: Callable[[Task], int],
    log: Callable[[str], None],
    security: "Security | None" = None,
) -> Iterator[tuple[Task, CaseOutcome]]:
    """Run tasks on the workers of a scheduler; yield (task, outcome) as they end.

    Parameters
    ----------
    tasks : list of Task
        The tasks.
    address : str
        Address of the scheduler.
    count_records : callable
        Returns the number of records in the results file of a task.
    log : callable
        Called with a message about what is waited for.
    security : Security, optional
        Keys that a client needs; by default from the configuration of dask.

    Raises
    ------
    ResultsError
        If the address is invalid.
    SchedulerLostError
        If no scheduler answers within the time of `WAITS`.
    """
    remaining = {task.case.digest: task for task in tasks}
    killed: dict[str, int] = {}

    def submit_remaining(client: "Client") -> Iterator[tuple[Task, CaseOutcome]]:
        chains = make_chains(remaining.values(), single=killed)
        for task, together, outcome in _submit_chains(client, chains):
            if outcome is None and together > 1:
                killed[task.case.digest] = 0  # single cases show which one killed the worker
                continue
            ended = outcome or _judge_death(task, count_records(task), killed)
            if ended is not None and ended.status != LOCKED:
                del remaining[task.case.digest]
                yield task, ended

    yield from _repeat_until_done(submit_remaining, remaining, address, log, security)


def _repeat_until_done(
    submit: Callable[["Client"], Iterator[Answer]],
    remaining: Sized,
    address: str,
    log: Callable[[str], None],
    security: "Security | None",
) -> Iterator[Answer]:
    """Yield the results of `submit`, which is repeated with new clients until nothing remains."""
    patience = WAITS.first
    while remaining:
        try:
            with _client(address, patience, log, security) as client:
                patience = WAITS.lost
                _report_workers(client, log)
                yield from submit(client)
        except _DisconnectedError:
            log("the scheduler was lost; the remaining cases are submitted again")
        else:
            if remaining:
                log(f"waiting for {len(remaining)} cases of an earlier client")
        if remaining:
            sleep(WAITS.pause)


def _report_workers(client: "Client", log: Callable[[str], None]) -> None:
    """Log that a scheduler has no workers, or workers with several threads."""
    threads = client.nthreads()
    if not threads:
        log("the scheduler has no workers yet; dask worker ADDRESS --nthreads 1 starts one")
    many = sum(count > 1 for count in threads.values())
    if many:
        log(f"{many} workers have several threads, which slows them; start them with --nthreads 1")


def _judge_death(task: Task, records: int, killed: dict[str, int]) -> CaseOutcome | None:
    """Store a case's records in `killed`; return a failure if they have not grown, else None."""
    before = killed.get(task.case.digest, 0)
    killed[task.case.digest] = records
    if records > before:
        return None
    cure = "the memory may be too small: tractive-sam explain estimates what a scene needs"
    return CaseOutcome(FAILED, f"every worker that computed it died; {cure}")


@contextmanager
def _client(
    address: str, patience: float, log: Callable[[str], None], security: "Security | None"
) -> Iterator["Client"]:
    """Within the block, connect to a scheduler; SchedulerLostError after `patience` seconds."""
    from distributed import Client  # of an extra
    from distributed.comm import get_address_host_port  # of an extra

    client, began, waiting = None, monotonic(), False
    while client is None:
        interrupt.raise_if_interrupted()
        try:
            _close_unused_clients()
            socket.create_connection(get_address_host_port(address), WAITS.answer).close()
            client = Client(address, timeout=WAITS.answer, set_as_default=False, security=security)
        except (OSError, TimeoutError) as error:
            if monotonic() - began > patience:
                cure = "start one and run the study again: complete cases are not run again"
                reason = error.with_traceback(None)  # the traceback refers to the client
                raise SchedulerLostError(f"no scheduler answers at {address}; {cure}") from reason
            if not waiting:
                log(f"waiting for a scheduler at {address}")
            waiting = True
            sleep(WAITS.pause)
        except ValueError:
            cure = "use tcp://HOST:PORT, as the scheduler prints it"
            raise ResultsError(f"{address} is not an address of a scheduler; {cure}") from None
    try:
        yield client
    finally:
        with suppress(OSError, TimeoutError):
            client.close(timeout=5)


def _submit_chains(
    client: "Client", chains: list[Chain]
) -> Iterator[tuple[Task, int, CaseOutcome | None]]:
    """Submit every chain once; yield (task, length of chain, outcome) as they end.

    Yields each task with the length of its chain and its outcome, None if its workers died.
    """
    calls = [
        (f"case-{chain[0].case.number}", chain[0].seconds, _worker_call(chain)) for chain in chains
    ]
    for k, future in _submit_calls(client, calls):
        for task, outcome in zip(chains[k], _outcomes(future, len(chains[k])), strict=True):
            yield task, len(chains[k]), outcome


Call = tuple[str, float, tuple[Any, ...]]
"""A name, a priority, and a function with its arguments."""


def _submit_calls(client: "Client", calls: list[Call]) -> Iterator[tuple[int, "Future"]]:
    """Submit calls to a scheduler; yield (index, future) as they end."""
    from distributed import as_completed  # of an extra

    unique = uuid4().hex  # the scheduler must not take a call for an earlier one
    futures = {
        client.submit(
            _call_with_laws, allow_laws(), *call,
            key=f"{name}-{unique}", priority=priority, pure=False,
        ): k
        for k, (name, priority, call) in enumerate(calls)
    }  # fmt: skip
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


def _call_with_laws(
    laws: Sequence[str], function: Callable[..., Answer], *arguments: Any
) -> Answer:
    """Allow the laws that the client allows, call a function, and return its result."""
    allow_laws(*laws)
    return function(*arguments)


def computed(
    calls: Sequence[tuple[Any, ...]],
    address: str,
    log: Callable[[str], None],
    security: "Security | None" = None,
) -> Iterator[tuple[int, Any]]:
    """Run function calls on the workers of a scheduler; yield (index, result) as they end.

    The calls of a worker that dies are submitted to others. If the scheduler is lost, all remaining
    calls are submitted again.

    Parameters
    ----------
    calls : sequence of tuple
        A function and its arguments each.
    address : str
        Address of the scheduler.
    log : callable
        Called with a message about what is waited for.
    security : Security, optional
        Keys that a client needs; by default from the configuration of dask.

    Raises
    ------
    ResultsError
        If the address is invalid.
    RuntimeError
        If every worker of a call died. Errors of the calls are raised as they are.
    SchedulerLostError
        If no scheduler answers at the address for `PATIENCE`.

    Examples
    --------
    >>> import math
    >>> from tractive_sam import studies
    >>> def roots(numbers, workers=2):
    ...     calls = [(math.sqrt, number) for number in numbers]
    ...     with studies.local_cluster(workers) as (address, security):
    ...         return dict(studies.computed(calls, address, print, security))
    """
    remaining = dict(enumerate(calls))

    def submit_remaining(client: "Client") -> Iterator[tuple[int, Any]]:
        numbers = [*remaining]
        named = [(f"call-{k}", -float(k), remaining[k]) for k in numbers]
        for place, future in _submit_calls(client, named):
            result = _result(future)
            del remaining[numbers[place]]
            yield numbers[place], result

    yield from _repeat_until_done(submit_remaining, remaining, address, log, security)


def _result(future: "Future") -> Any:
    """Return the result of an ended call, or raise its error; _DisconnectedError if it was lost."""
    from distributed.scheduler import KilledWorker  # of an extra

    if future.status == "finished":
        return future.result()
    if future.status != "error":
        raise _DisconnectedError
    error = future.exception()
    if isinstance(error, KilledWorker):
        raise RuntimeError("every worker that computed it died; the memory may be too small")
    raise error


def check_installed() -> None:
    """Raise a ResultsError unless dask.distributed is installed.

    Raises
    ------
    ResultsError
        If it is not.

    Examples
    --------
    >>> from tractive_sam import studies
    >>> studies.check_installed()
    """
    if find_spec("distributed") is None:
        missing = describe_missing("processes that share the work", "distributed")
        raise ResultsError(f"{missing}; or use 0 workers")


def _worker_call(chain: Chain) -> tuple[Any, ...]:
    """Return (function, arguments ...) that a worker calls for a chain of tasks.

    A chain is a tuple of tasks that a worker receives together.
    """
    first = chain[0]
    if first.file is not None:
        return run_case, first.case.scene, str(first.file)
    return run_chain, [task.case.scene for task in chain]


def _outcomes(future: "Future", number: int) -> Sequence[CaseOutcome | None]:
    """Return a chain's outcomes: None for each if its workers died, FAILED after an error."""
    from distributed.scheduler import KilledWorker  # of an extra

    if future.status == "finished":
        result = future.result()
        return result if isinstance(result, list) else [result]
    if future.status != "error":
        raise _DisconnectedError
    error = future.exception()
    if isinstance(error, KilledWorker):
        return [None] * number
    traceback = "".join(format_exception(error))
    return [CaseOutcome(FAILED, f"{type(error).__name__}: {error}", traceback=traceback)] * number
