"""Cases on the workers of dask.distributed.

The scheduler is asked for nothing but to hand out cases, long ones first. Whatever it forgets is in
the files: a case that was cut off is handed out again and goes on from its last record.
"""

import gc
import logging
import signal
import socket
from collections.abc import Callable, Iterator, Sequence, Sized
from contextlib import contextmanager, suppress
from importlib.util import find_spec
from multiprocessing import resource_tracker
from time import monotonic, sleep
from traceback import format_exception
from typing import TYPE_CHECKING, Any, TypeVar
from uuid import uuid4

from tractive_sam import interrupt
from tractive_sam.extras import describe_missing
from tractive_sam.store import ResultsError
from tractive_sam.studies.chain import Chain, chained
from tractive_sam.studies.task import FAILED, HELD, Outcome, Task
from tractive_sam.studies.worker import ONE_THREAD, run_case, run_chain

if TYPE_CHECKING:
    from distributed import Client, Future, Scheduler, Worker
    from distributed.security import Security

T = TypeVar("T")

FIRST_CONTACT = 30.0
"""Longest wait for a scheduler that was never there, s."""

PATIENCE = 600.0
"""Longest wait for a scheduler that was lost, s."""

PAUSE = 1.0
"""Before what was cut off or held is handed out again, s."""


GLANCE = 0.05
"""Between looks at what has ended, s."""


class SchedulerLostError(ConnectionError):
    """There is no scheduler (any more); what is complete remains so.

    Examples
    --------
    >>> from tractive_sam import studies
    >>> def patiently(study, folder, address):
    ...     try:
    ...         return studies.study(study, folder, scheduler=address)
    ...     except studies.SchedulerLostError:
    ...         return studies.study(study, folder)  # on this machine, from where it ended
    """


CONNECTING = 5.0
"""Longest time to wait for an answer of a scheduler, s."""


class _CutOffError(Exception):
    """The connection to the scheduler broke, or it forgot what it was asked for."""


NO_CRYPTOGRAPHY = (
    "the package cryptography, of the extra study, makes the keys of workers: pip install "
    "cryptography; or encrypted=False (--unencrypted), where no other user of this machine is one "
    "that could run programs in your name"
)


NO_PAGES: dict[str, list[str]] = {
    "distributed.scheduler.http.routes": [],
    "distributed.worker.http.routes": [],
}
"""What a local cluster shows at its ports for browsers, until they close: a worker that is started
in place of one that died has one again."""


@contextmanager
def local_cluster(workers: int, encrypted: bool = True) -> Iterator[tuple[str, "Security | None"]]:
    """Processes on this machine.

    They listen to this machine alone, and none of them shows a page of its state. Whoever reaches
    a port of dask without TLS has it run any program, other users of this machine included.

    Parameters
    ----------
    workers : int
        Their number.
    encrypted : bool
        Whether they speak TLS, with keys made for this cluster and stored in memory alone.

    Yields
    ------
    str, Security or None
        Address of their scheduler, and what a client of it needs.

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
        raise ResultsError(NO_CRYPTOGRAPHY) from None
    _closed_before()
    with _signals_kept_from_threads(), config.set(NO_PAGES):
        cluster = LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            processes=True,
            host="127.0.0.1",
            memory_limit=0,  # a scene takes what it takes; `explain` tells how much
            dashboard_address=None,
            scheduler_kwargs={"dashboard_address": "127.0.0.1:0"},  # of its server: any free port
            security=security,
            silence_logs=logging.ERROR,
            env=ONE_THREAD,
        )
    with cluster:
        with Client(cluster.scheduler_address, security=security, set_as_default=False) as client:
            client.run(_quiet)
            client.run_on_scheduler(_without_pages)
        yield cluster.scheduler_address, security


def _closed_before() -> None:
    """Have clients closed that found nobody, before another loop is started.

    Such a client is left to the garbage collector, and closes itself in whatever is being done
    then: where that holds the lock of the loops, it would wait for ever.
    """
    gc.collect()


def _quiet(dask_worker: "Worker") -> None:
    """Have a worker say nothing of a case that it leaves when it is ended: the client does."""
    logging.getLogger("distributed.worker.state_machine").setLevel(logging.ERROR)
    dask_worker.http_server.stop()


def _without_pages(dask_scheduler: "Scheduler") -> None:
    """Close the port at which a scheduler shows its state."""
    dask_scheduler.http_server.stop()


@contextmanager
def _signals_kept_from_threads() -> Iterator[None]:
    """Have threads that are started meanwhile, and processes that they start, see no Ctrl-C.

    A terminal sends it to all processes of a command. It is for the client to end the workers;
    those that died of it as well would fill the terminal with their ends.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    resource_tracker.ensure_running()  # to start it later would let the thread see Ctrl-C again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGHUP})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)  # those that came meanwhile come now


def on_cluster(
    tasks: list[Task],
    address: str,
    reached: Callable[[Task], int],
    say: Callable[[str], None],
    security: "Security | None" = None,
) -> Iterator[tuple[Task, Outcome]]:
    """Have tasks done by the workers of a scheduler; yields them as they end.

    Parameters
    ----------
    tasks : list of Task
        What is to be done.
    address : str
        Of the scheduler.
    reached : callable
        Records that the results file of a task holds.
    say : callable
        Told when something has to be waited for.
    security : Security, optional
        What a client of it needs; by default what dask's configuration says.

    Raises
    ------
    ResultsError
        If that is no address.
    SchedulerLostError
        If there is no scheduler there, or none any more for `PATIENCE`.
    """
    left = {task.case.digest: task for task in tasks}
    killed: dict[str, int] = {}

    def turn(client: "Client") -> Iterator[tuple[Task, Outcome]]:
        for task, together, outcome in _handed_out(client, chained(left.values(), alone=killed)):
            if outcome is None and together > 1:
                killed[task.case.digest] = 0  # which of them it was is seen alone
                continue
            ended = outcome or _after_deaths(task, reached(task), killed)
            if ended is not None and ended.status != HELD:
                del left[task.case.digest]
                yield task, ended

    yield from _turns(turn, left, address, say, security)


def _turns(
    turn: Callable[["Client"], Iterator[T]],
    left: Sized,
    address: str,
    say: Callable[[str], None],
    security: "Security | None",
) -> Iterator[T]:
    """What turns with a client yield, one after another until none of `left` is left."""
    patience = FIRST_CONTACT
    while left:
        try:
            with _client(address, patience, say, security) as client:
                patience = PATIENCE
                _look_at_workers(client, say)
                yield from turn(client)
        except _CutOffError:
            say("the scheduler was lost; what is not complete is handed out again")
        else:
            if left:
                say(f"waiting for {len(left)} cases that an earlier client began")
        if left:
            sleep(PAUSE)


def _look_at_workers(client: "Client", say: Callable[[str], None]) -> None:
    """Say what would leave the user waiting."""
    threads = client.nthreads()
    if not threads:
        say("the scheduler has no workers yet; dask worker ADDRESS --nthreads 1 starts one")
    many = sum(count > 1 for count in threads.values())
    if many:
        say(f"{many} workers have several threads, which slows them; start them with --nthreads 1")


def _after_deaths(task: Task, records: int, killed: dict[str, int]) -> Outcome | None:
    """A failure, unless the case came further than when its workers died before."""
    before = killed.get(task.case.digest, 0)
    killed[task.case.digest] = records
    if records > before:
        return None
    cure = "memory may not suffice: tractive-sam explain tells what a scene takes"
    return Outcome(FAILED, f"every worker that computed it died; {cure}")


@contextmanager
def _client(
    address: str, patience: float, say: Callable[[str], None], security: "Security | None"
) -> Iterator["Client"]:
    from distributed import Client  # of an extra
    from distributed.comm import get_address_host_port  # of an extra

    client, began, told = None, monotonic(), False
    while client is None:
        interrupt.raise_if_interrupted()
        try:
            _closed_before()
            socket.create_connection(get_address_host_port(address), CONNECTING).close()
            client = Client(address, timeout=CONNECTING, set_as_default=False, security=security)
        except (OSError, TimeoutError) as error:
            if monotonic() - began > patience:
                cure = "start one and run the study again: complete cases are not run again"
                told_by = error.with_traceback(None)  # which would keep such a client
                raise SchedulerLostError(f"there is no scheduler at {address}; {cure}") from told_by
            if not told:
                say(f"waiting for a scheduler at {address}")
            told = True
            sleep(PAUSE)
        except ValueError:
            cure = "give it as tcp://HOST:PORT, as the scheduler says it"
            raise ResultsError(f"{address} is no address of a scheduler; {cure}") from None
    try:
        yield client
    finally:
        with suppress(OSError, TimeoutError):
            client.close(timeout=5)


def _handed_out(
    client: "Client", chains: list[Chain]
) -> Iterator[tuple[Task, int, Outcome | None]]:
    """Hand out every chain once.

    Yields each task with the length of its chain and its outcome, None if its workers died.
    """
    calls = [(f"case-{chain[0].case.number}", chain[0].seconds, _work(chain)) for chain in chains]
    for k, future in _ended(client, calls):
        for task, outcome in zip(chains[k], _outcomes(future, len(chains[k])), strict=True):
            yield task, len(chains[k]), outcome


Call = tuple[str, float, tuple[Any, ...]]
"""A name, a priority, and what a worker calls with what."""


def _ended(client: "Client", calls: list[Call]) -> Iterator[tuple[int, "Future"]]:
    """Hand out calls; yields the number of each, and its future, as they end."""
    from distributed import as_completed  # of an extra

    round_of = uuid4().hex  # so that the scheduler takes it for nothing that it was asked before
    futures = {
        client.submit(*what, key=f"{name}-{round_of}", priority=priority, pure=False): k
        for k, (name, priority, what) in enumerate(calls)
    }
    try:
        ended = as_completed(futures, loop=client.loop)
        while not ended.is_empty():
            interrupt.raise_if_interrupted()
            if not ended.has_ready():
                sleep(GLANCE)
                continue
            future = next(ended)
            yield futures.pop(future), future
            future.release()
    finally:
        # Where the client goes before its cases are done, those not begun yet are forgotten.
        for future in futures:
            with suppress(OSError, TimeoutError):
                future.release()


def computed(
    calls: Sequence[tuple[Any, ...]],
    address: str,
    say: Callable[[str], None],
    security: "Security | None" = None,
) -> Iterator[tuple[int, Any]]:
    """Have functions called by the workers of a scheduler; yields number and result as they end.

    What a worker that dies was at is handed to others, and all that is left again where the
    scheduler is lost.

    Parameters
    ----------
    calls : sequence of tuple
        A function and its arguments each.
    address : str
        Of the scheduler.
    say : callable
        Told when something has to be waited for.
    security : Security, optional
        What a client of it needs; by default what dask's configuration says.

    Raises
    ------
    ResultsError
        If that is no address.
    RuntimeError
        If every worker died that was handed a call; else whatever a call raises.
    SchedulerLostError
        If there is no scheduler there, or none any more for `PATIENCE`.

    Examples
    --------
    >>> import math
    >>> from tractive_sam import studies
    >>> def roots(numbers, workers=2):
    ...     calls = [(math.sqrt, number) for number in numbers]
    ...     with studies.local_cluster(workers) as (address, security):
    ...         return dict(studies.computed(calls, address, print, security))
    """
    left = dict(enumerate(calls))

    def turn(client: "Client") -> Iterator[tuple[int, Any]]:
        numbers = [*left]
        asked = [(f"call-{k}", -float(k), left[k]) for k in numbers]
        for place, future in _ended(client, asked):
            found = _result(future)
            del left[numbers[place]]
            yield numbers[place], found

    yield from _turns(turn, left, address, say, security)


def _result(future: "Future") -> Any:
    from distributed.scheduler import KilledWorker  # of an extra

    if future.status == "finished":
        return future.result()
    if future.status != "error":
        raise _CutOffError
    error = future.exception()
    if isinstance(error, KilledWorker):
        raise RuntimeError("every worker that computed it died; memory may not suffice")
    raise error


def check_installed() -> None:
    """See that there is dask.distributed.

    Raises
    ------
    ResultsError
        If there is none.

    Examples
    --------
    >>> from tractive_sam import studies
    >>> studies.check_installed()
    """
    if find_spec("distributed") is None:
        missing = describe_missing("processes that share the work", "distributed")
        raise ResultsError(f"{missing}; or ask for 0 workers")


def _work(chain: Chain) -> tuple[Any, ...]:
    """What a worker calls, and with what."""
    first = chain[0]
    if first.file is not None:
        return run_case, first.case.scene, str(first.file)
    return run_chain, [task.case.scene for task in chain]


def _outcomes(future: "Future", number: int) -> Sequence[Outcome | None]:
    """What became of the cases of a chain."""
    from distributed.scheduler import KilledWorker  # of an extra

    if future.status == "finished":
        found = future.result()
        return found if isinstance(found, list) else [found]
    if future.status != "error":
        raise _CutOffError
    error = future.exception()
    if isinstance(error, KilledWorker):
        return [None] * number
    where = "".join(format_exception(error))
    return [Outcome(FAILED, f"{type(error).__name__}: {error}", traceback=where)] * number
