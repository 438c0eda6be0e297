"""Processes on this machine that compute calls of functions for a study, a table or a fit.

They are connected to their client by pipes: no port is open, and other users cannot submit calls.
"""

import os
import signal
import sys
from collections import Counter, deque
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from multiprocessing import get_context, parent_process, resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.context import BaseContext
from pickle import dumps, loads
from threading import Thread
from traceback import format_exception
from typing import Any, Protocol

from tractive_sam import interrupt
from tractive_sam.schema import allow_laws
from tractive_sam.store import ResultsError

Call = tuple[Any, ...]
"""A function and its arguments."""


class Workers(Protocol):
    """Processes that compute calls: on this machine, or those of a scheduler.

    Examples
    --------
    >>> from tractive_sam import studies
    >>> class ThisProcess(studies.Workers):
    ...     def run(self, calls):
    ...         for k, (function, *arguments) in enumerate(calls):
    ...             yield k, function(*arguments)
    >>> dict(studies.computed([(abs, -1), (abs, 2)], ThisProcess()))
    {0: 1, 1: 2}
    """

    def run(self, calls: Sequence[Call]) -> Iterator[tuple[int, Any]]:
        """Compute calls; yield (index, result or exception) as they end.

        The first calls begin first. A `WorkerDiedError` is yielded for a call whose workers died.

        Parameters
        ----------
        calls : sequence of tuple
            A function and its arguments each. Functions must be importable.
        """


class WorkerDiedError(RuntimeError):
    """Error of a call if every worker that computed it died."""

    def __init__(
        self, text: str = "every worker that computed it died; the memory may be too small"
    ) -> None:
        super().__init__(text)


def computed(calls: Sequence[Call], workers: Workers) -> Iterator[tuple[int, Any]]:
    """Compute calls on workers; yield (index, result) as they end.

    The calls of a worker that dies are computed by others.

    Parameters
    ----------
    calls : sequence of tuple
        A function and its arguments each. Functions must be importable.
    workers : Workers
        The workers, see `open_workers`.

    Raises
    ------
    RuntimeError
        If every worker of a call died. Errors of the calls are raised as they are.

    Examples
    --------
    >>> import math
    >>> from tractive_sam import studies
    >>> def roots(numbers):
    ...     calls = [(math.sqrt, number) for number in numbers]
    ...     with studies.open_workers(2) as workers:
    ...         return dict(studies.computed(calls, workers))
    """
    for k, answer in workers.run(calls):
        if isinstance(answer, Exception):
            raise answer
        yield k, answer


def call_with_laws(laws: Sequence[str], call: Call) -> Any:
    """Allow the laws that the client allows, and return the result of a call."""
    allow_laws(*laws)
    function, *arguments = call
    return function(*arguments)


def prepare_workers() -> BaseContext:
    """Start the server process of workers on Linux, and return the context that starts workers.

    The server loads what workers share in the background. Without this call, it starts when workers
    are opened.

    Examples
    --------
    >>> from tractive_sam import studies
    >>> _ = studies.prepare_workers()
    """
    # A server of Python 3.11.0 accepts calls from other users (CVE-2022-42919).
    if sys.platform != "linux" or sys.version_info < (3, 11, 1):
        return get_context("spawn")
    from multiprocessing import forkserver  # not available on Windows

    context = get_context("forkserver")
    context.set_forkserver_preload(["tractive_sam.studies.preload"])
    with _settings_of_workers():
        forkserver.ensure_running()
    return context


class LocalWorkers:
    """Processes on this machine, each with one thread; they end with the `with` block.

    A worker that dies is replaced. On Linux, workers are copies of a server process (fork server)
    that has imported the package; it starts at once, while the client prepares the calls.

    Parameters
    ----------
    number : int
        Number of processes.
    attempts : int
        Workers that may die of a call before it is given up.
    poll : float
        Longest time until a signal to stop is noticed, s.
    """

    def __init__(self, number: int, attempts: int = 3, poll: float = 0.05) -> None:
        self._number, self._attempts, self._poll = number, attempts, poll
        self._workers: list[_Worker] = []
        self._context = prepare_workers()

    def __enter__(self) -> "LocalWorkers":
        return self

    def __exit__(self, *_: object) -> None:
        """End all processes at once: results files are complete at every moment."""
        self._end(self._workers)

    def run(self, calls: Sequence[Call]) -> Iterator[tuple[int, Any]]:
        """Compute calls; yield (index, result or exception) as they end, see `Workers`."""
        waiting, deaths = deque(range(len(calls))), Counter[int]()

        def submit_waiting() -> None:
            for worker in self._workers:
                if waiting and worker.started and worker.index is None:
                    worker.submit(waiting[0], calls[waiting[0]])
                    waiting.popleft()

        try:
            while waiting or any(worker.index is not None for worker in self._workers):
                interrupt.raise_if_interrupted()
                missing = min(self._number, len(calls)) - len(self._workers)
                if missing > 0:
                    with _settings_of_workers():
                        self._workers += [_Worker(self._context) for _ in range(missing)]
                submit_waiting()
                ready = wait([worker.connection for worker in self._workers], self._poll)
                for worker in [one for one in self._workers if one.connection in ready]:
                    k, answer = worker.receive()
                    if isinstance(answer, WorkerDiedError):
                        self._end([worker])
                        if k is None:
                            continue
                        deaths[k] += 1
                        if deaths[k] < self._attempts:
                            waiting.appendleft(k)
                            continue
                    submit_waiting()
                    if k is not None:
                        yield k, answer
        finally:
            self._end([worker for worker in self._workers if worker.index is not None])

    def _end(self, workers: Sequence["_Worker"]) -> None:
        """End workers, and forget them."""
        self._workers = [worker for worker in self._workers if worker not in workers]
        for worker in workers:
            worker.process.kill()
        for worker in workers:
            worker.process.join()
            worker.connection.close()


class _Worker:
    """A process, the connection to it, and the index of the call that it computes.

    Attributes
    ----------
    process : Process
        The process.
    connection : Connection
        Its connection.
    index : int or None
        Index of its call.
    started : bool
        Whether it has reported that it started.
    """

    def __init__(self, context: Any) -> None:
        self.index: int | None = None
        self.started = False
        self.connection, its_end = context.Pipe()
        # The server process may have started in another folder, with other variables.
        arguments = (its_end, os.getcwd(), dict(os.environ))
        self.process = context.Process(target=serve, args=arguments, daemon=True)
        self.process.start()
        its_end.close()  # so that the connection ends with the process

    def submit(self, index: int, call: Call) -> None:
        """Send a call."""
        request = dumps((call_with_laws, allow_laws(), call))
        self.index = index
        with suppress(OSError):  # if the process has died, `receive` finds it
            self.connection.send_bytes(request)

    def receive(self) -> tuple[int | None, Any]:
        """Return (index, answer) of its call; (None, None) as it starts.

        Raises
        ------
        ResultsError
            If the process ended before it started.
        """
        try:
            answer = self.connection.recv()
        except (EOFError, OSError):
            if not self.started:
                raise ResultsError(
                    "a worker process ended as it started, see its messages; a script must be a "
                    'file that calls this under `if __name__ == "__main__":`, as workers import it'
                ) from None
            answer = WorkerDiedError()
        index, self.index, self.started = self.index, None, True
        return index, answer


def serve(client: Connection, folder: str, environment: Mapping[str, str]) -> None:
    """Answer the calls of a client; runs in a worker.

    Parameters
    ----------
    client : Connection
        The client.
    folder, environment : str, mapping of str to str
        Working directory and environment variables.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C: the client ends its workers
    os.chdir(folder)
    os.environ.update(environment)
    Thread(target=_end_with_client, daemon=True).start()
    client.send(None)
    with suppress(EOFError, OSError):
        while True:
            client.send_bytes(_answer(client.recv_bytes()))


def _end_with_client() -> None:
    """End this process as soon as its client has ended, also if the client was killed."""
    if (client := parent_process()) is not None:
        client.join()
    os._exit(1)


def _answer(request: bytes) -> bytes:
    """Return the pickled result of a pickled call, or its exception with the traceback."""
    try:
        function, *arguments = loads(request)
        return dumps(function(*arguments))
    except Exception as error:  # the client handles it
        traceback = "".join(format_exception(error))
        try:
            loads(dumps(error))
        except Exception:  # of any kind: its class cannot be copied
            error = RuntimeError(f"{type(error).__name__}: {error}")
        error.add_note(traceback)
        return dumps(error)


@contextmanager
def _settings_of_workers() -> Iterator[None]:
    """Within the block, new processes have one thread each, and do not receive Ctrl-C.

    The cores compute several calls, not several threads of one. (FFTW has one thread by default.)

    A terminal sends Ctrl-C to all processes of a command. The client ends the workers; otherwise
    each worker would print a traceback.
    """
    names = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
    # Modules in the working directory are not imported, except where the client imports them.
    settings = dict.fromkeys(names, "1") | {"OMP_WAIT_POLICY": "passive", "PYTHONSAFEPATH": "1"}
    variables = {name: os.environ.get(name) for name in settings}
    os.environ.update(settings)
    masked = hasattr(signal, "pthread_sigmask")
    if masked:
        resource_tracker.ensure_running()  # started later, it would unblock Ctrl-C
        mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGHUP})
    try:
        yield
    finally:
        if masked:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)  # blocked signals are delivered now
        for name, value in variables.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
