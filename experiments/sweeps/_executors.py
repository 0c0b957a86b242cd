"""Where tasks are computed: here, in processes of this machine, or on a cluster; all are executors."""

import multiprocessing
import os
import queue
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing.connection import Connection
from typing import Any

from ..harness._errors import UserError

PATIENCE = "10s"
"""How long a scheduler may take to answer."""


class Inline(Executor):
    """Computes in this process, at once."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future


class SpawnPool(Executor):
    """Processes that each compute one task at a time and never outlive this one.

    Each process has a pool of its own: when one is killed, only its own task fails (with `BrokenExecutor`), it is
    known which task that was, and the next task finds a new process. Processes are spawned, since a fork of a
    process that runs JAX hangs. All of them hold the reading end of one pipe: they end at once when this process
    closes the writing end, or dies and the system closes it.
    """

    def __init__(self, workers: int) -> None:
        self._context = multiprocessing.get_context("spawn")
        self._threads = max(1, available_cores() // workers)
        self._alive, self._hold = self._context.Pipe(duplex=False)
        self._idle: queue.SimpleQueue[ProcessPoolExecutor] = queue.SimpleQueue()
        self._pools: set[ProcessPoolExecutor] = set()
        self._lock = threading.Lock()
        for _ in range(workers):
            self._idle.put(self._new())

    def _new(self) -> ProcessPoolExecutor:
        pool = ProcessPoolExecutor(
            1, mp_context=self._context, initializer=_prepare, initargs=(self._alive, self._threads)
        )
        with self._lock:
            self._pools.add(pool)
        return pool

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        pool = self._idle.get()
        try:
            future = _deaf_to_interrupts(pool.submit, fn, *args, **kwargs)
        except BrokenExecutor:
            # It was killed while it had nothing to do.
            pool = self._replace(pool)
            future = _deaf_to_interrupts(pool.submit, fn, *args, **kwargs)
        future.add_done_callback(lambda done: self._release(pool, done))
        return future

    def _release(self, pool: ProcessPoolExecutor, done: Future[Any]) -> None:
        broken = not done.cancelled() and isinstance(done.exception(), BrokenExecutor)
        self._idle.put(self._replace(pool) if broken else pool)

    def _replace(self, pool: ProcessPoolExecutor) -> ProcessPoolExecutor:
        with self._lock:
            self._pools.discard(pool)
        pool.shutdown(wait=False)
        return self._new()

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End all processes; with `cancel_futures` at once, whatever they are doing."""
        if cancel_futures:
            self._hold.close()
        with self._lock:
            pools = tuple(self._pools)
        for pool in pools:
            pool.shutdown(wait=wait, cancel_futures=cancel_futures)
        for end in (self._hold, self._alive):
            end.close()


def _deaf_to_interrupts(start: Callable[..., Future[Any]], /, *args: Any, **kwargs: Any) -> Future[Any]:
    """Start processes that never see Ctrl-C, not even while they import: a process inherits what is blocked."""
    if not hasattr(signal, "pthread_sigmask"):
        return start(*args, **kwargs)
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        return start(*args, **kwargs)
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def available_cores() -> int:
    """How many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _prepare(alive: Connection, threads: int) -> None:
    """Make this process a worker: it leaves Ctrl-C to its parent, keeps to its cores, and ends with its parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # Before JAX is imported: its number of threads, and not all of an accelerator's memory.
    for name in ("PJRT_NPROC", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ[name] = str(threads)
    os.environ.setdefault("XLA_PYTHON_CLIENT_PREALLOCATE", "false")
    threading.Thread(target=_end_with_parent, args=(alive,), daemon=True).start()


def _end_with_parent(alive: Connection) -> None:
    try:
        alive.recv_bytes()  # nobody sends: it returns when the other end is gone
    except (EOFError, OSError):
        os._exit(1)


@contextmanager
def local(workers: int) -> Iterator[tuple[Executor, int]]:
    """An executor on this machine, and how many tasks it computes at a time; nothing is left running."""
    executor = Inline() if workers == 1 else SpawnPool(workers)
    finished = False
    try:
        yield executor, workers
        finished = True
    finally:
        executor.shutdown(wait=True, cancel_futures=not finished)


@contextmanager
def cluster(address: str) -> Iterator[tuple[Executor, int]]:
    """The executor of a dask.distributed scheduler, and how many tasks to have on the way.

    **Raises:** `UserError` if dask.distributed is not installed, nobody answers at the address, or there are no
    workers.
    """
    try:
        from distributed import Client
    except ImportError as error:
        raise UserError(
            "A scheduler needs the package distributed: pip install jaxocean[cluster]."
        ) from error
    try:
        client = Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, TimeoutError, ValueError, ImportError) as error:
        raise UserError(
            f"No scheduler answers at {address} ({type(error).__name__}): start one (`dask scheduler`), or give the "
            "address that it shows, for example --scheduler tcp://host:8786."
        ) from error
    try:
        known: Any = client.nthreads()
        threads = sum(known.values())
        if threads == 0:
            raise UserError(
                f"The scheduler at {address} has no workers: start some with `dask worker {address} --nthreads 1`."
            )
        executor = client.get_executor(pure=False)
        finished = False
        try:
            yield executor, 2 * threads
            finished = True
        finally:
            executor.shutdown(wait=finished)
    finally:
        client.close(timeout=PATIENCE)
