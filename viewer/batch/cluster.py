"""`--dask`: tasks are done by the workers of a Dask cluster, one on this machine or one that is there already."""

from __future__ import annotations

import json
import logging
import os
import pickle
import platform
import signal
import time
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack, chdir, suppress
from functools import partial
from typing import Any, Self

from ..base.cores import core_count
from ..base.messages import say
from ..base.progress import Progress
from ..errors import InputError, OutputError, UsageError, ViewerError
from ..jobs.render_job import RenderTask
from ..scene.files import read_file
from .engines import ClusterLost, Doer, WorkerLost
from .options import LOCAL
from .work import Done

_CONNECT_S = 10
_COUNTED_S = 1.0


class Cluster:
    """An `Engine` on the workers of the scheduler at `address`, or of `scheduler_file`; of `count` workers on this
    machine for LOCAL. Raises UsageError if Dask is not installed, and OutputError if there is no such scheduler.

    A worker renders in one thread, however many it has, since an OpenGL context belongs to a thread. So it is given a
    task at a time, and one that dies fails no other task.
    """

    def __init__(self, make_worker: Callable[[], Doer], address: str = LOCAL, scheduler_file: str | None = None,
                 count: int | None = None) -> None:
        self._stack = ExitStack()
        self._client: Any = self._stack.enter_context(_connected(address, scheduler_file, count, self._stack))
        self._make_worker, self._folder = pickle.dumps(make_worker), os.getcwd()
        self._room, self._counted = 1, -_COUNTED_S
        if not self._client.nthreads():
            say(f"{self._client.scheduler.address}: the scheduler has no worker yet, and is waited for")

    @property
    def room(self) -> int:
        if time.monotonic() - self._counted > _COUNTED_S:  # workers come and go
            with suppress(OSError, RuntimeError):  # a scheduler that is lost is told of by the tasks
                self._room, self._counted = max(len(self._client.nthreads()), 1), time.monotonic()
        return self._room

    def submit(self, task: RenderTask) -> Future[Done]:
        future: Future[Done] = Future()
        theirs = self._client.submit(_do, self._make_worker, self._folder, task, pure=False)
        theirs.add_done_callback(partial(_answer, future, self._client.scheduler.address))
        return future

    def finish(self) -> bool:
        return False

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        with suppress(OSError, TimeoutError):
            self._stack.close()


def _connected(address: str, scheduler_file: str | None, count: int | None, stack: ExitStack) -> Any:
    try:
        import dask
        from distributed import Client, LocalCluster
    except ImportError as error:
        raise UsageError("--dask needs Dask: pip install 'pbr-viewer[batch]'") from error
    for name in [name for name in logging.root.manager.loggerDict if name.startswith("distributed")]:
        logging.getLogger(name).setLevel(logging.CRITICAL)  # what is lost is told by us, in a line
    if address == LOCAL:
        address = dask.config.get("scheduler-address", None) or LOCAL
    where = f"--scheduler-file {scheduler_file}" if scheduler_file is not None else f"--dask {address}"
    try:
        if scheduler_file is not None:
            address = _address_in(scheduler_file)
        if address != LOCAL:
            return Client(address, timeout=_CONNECT_S)
        count = count or core_count()
        stack.enter_context(dask.config.set({"distributed.scheduler.allowed-failures": 0}))  # --retries counts them
        threads = str(max(core_count() // count, 1))
        cluster = LocalCluster(n_workers=count, threads_per_worker=1, dashboard_address=None, host="127.0.0.1",
                               silence_logs=logging.CRITICAL, env={"LP_NUM_THREADS": threads}, preload=[__name__])
        return Client(stack.enter_context(cluster), timeout=_CONNECT_S)
    except (OSError, TimeoutError, ValueError) as error:
        raise OutputError(f"{where}: no scheduler answers there ({str(error) or 'it takes too long'})") from error


def _address_in(scheduler_file: str) -> str:
    try:
        return str(json.loads(read_file(scheduler_file))["address"])
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(scheduler_file, "", "is not the file of a Dask scheduler: it names no address") from error


def dask_setup(worker: object) -> None:
    """Dask calls this in each worker of a local cluster. Ctrl-C is for the command, which then ends them."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _answer(future: Future[Done], scheduler: str, theirs: Any) -> None:
    """Give `future` what has become of the task of Dask's future `theirs`."""
    try:
        if theirs.status == "finished":
            future.set_result(theirs.result())
        elif theirs.status == "error":
            future.set_exception(_as_ours(theirs.exception()))
        else:
            future.set_exception(ClusterLost(f"{scheduler}: the scheduler is lost"))
    except Exception as error:
        future.set_exception(ClusterLost(f"{scheduler}: the scheduler is lost ({error})"))


def _as_ours(error: BaseException) -> ViewerError:
    from distributed import KilledWorker

    if isinstance(error, ViewerError):
        return error
    if isinstance(error, KilledWorker):
        return WorkerLost("the worker that rendered it has died")
    return WorkerLost(f"the worker that rendered it has failed: {type(error).__name__}: {error}")


_thread = ThreadPoolExecutor(1, "pictures")
_worker: tuple[bytes, Doer] | None = None


def _do(make_worker: bytes, folder: str, task: RenderTask) -> Done:
    """What a worker of Dask calls."""
    return _thread.submit(_do_here, make_worker, folder, task).result()


def _do_here(make_worker: bytes, folder: str, task: RenderTask) -> Done:
    global _worker
    try:
        with chdir(folder):  # names of files are as they were given
            if _worker is None or _worker[0] != make_worker:
                _worker = None  # before another one is made
                _worker = make_worker, pickle.loads(make_worker)()
            return _worker[1].do(task, Progress(1, enabled=False))
    except OSError as error:
        raise OutputError(f"{platform.node()}: a worker has no folder {folder}: it needs the files at the same places "
                          f"({error.strerror})") from error
