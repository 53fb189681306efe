"""`--jobs N`: tasks are done in processes of their own, so that one that crashes or is killed takes no other with it.

`concurrent.futures.ProcessPoolExecutor` gives up all tasks when one of its processes dies, and does not say which task
that one had. So a thread stands for each process here, gives it one task at a time, and starts another when it dies.
"""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from multiprocessing import get_context, parent_process
from multiprocessing.connection import Connection, wait
from typing import NoReturn, Self

from ..base.cores import core_count
from ..base.progress import Progress
from ..base.signals import Stopped, sent_again
from ..errors import ViewerError
from ..jobs.render_job import RenderTask
from .engines import Doer, WorkerLost
from .work import Done

_SPAWN = get_context("spawn")
"""A process that is forked from one with an OpenGL context cannot render."""
_PATIENCE = 10.0
"""Seconds that a process may take to end when it is asked to."""


class Processes:
    """An `Engine` of `count` processes, which are started when they are first needed. Each calls `make_worker`, which
    must be a name or a `functools.partial` of one."""

    def __init__(self, make_worker: Callable[[], Doer], count: int) -> None:
        self.room = count
        self._make_worker = make_worker
        self._threads = ThreadPoolExecutor(count, "worker")
        self._local = threading.local()
        self._lock = threading.Lock()
        self._started: list[_Process] = []
        self._is_closed = False

    def submit(self, task: RenderTask) -> Future[Done]:
        return self._threads.submit(self._do, task)

    def _do(self, task: RenderTask) -> Done:
        process = getattr(self._local, "process", None)
        if process is None or not process.is_alive:
            process = self._local.process = self._start()
        return process.do(task)

    def finish(self) -> bool:
        with self._lock:
            self._is_closed = True
        for process in self._started:
            process.finish()
        return True

    def _start(self) -> _Process:
        with self._lock:
            if self._is_closed:
                raise WorkerLost("given up")
            self._started = [process for process in self._started if process.is_alive]
            self._started.append(process := _Process(self._make_worker, self.room))
        return process

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        with self._lock:
            self._is_closed = True
        self._threads.shutdown(wait=False, cancel_futures=True)
        for process in self._started:
            process.ask_to_end()
        for process in self._started:
            process.end()
        self._threads.shutdown()


class _Process:
    def __init__(self, make_worker: Callable[[], Doer], count: int) -> None:
        self._connection, theirs = _SPAWN.Pipe()
        self._joining, self._sending, self._is_finishing = threading.Lock(), threading.Lock(), False
        self._process = _SPAWN.Process(target=_serve, args=(theirs, make_worker, count))
        self._process.start()
        theirs.close()  # so that the end of the process ends the connection

    @property
    def is_alive(self) -> bool:
        return self._process.is_alive()

    def do(self, task: RenderTask) -> Done:
        """Raises what the task raises there, and WorkerLost if the process ends."""
        try:
            with self._sending:
                if self._is_finishing:
                    raise WorkerLost("given up")
                self._connection.send(task)
            answer = self._connection.recv()
        except (EOFError, OSError) as error:
            self._join()
            raise WorkerLost(how_it_ended(self._process.exitcode)) from error
        if isinstance(answer, Exception):
            raise answer
        return answer

    def finish(self) -> None:
        """What it is doing ends early, if it can, and it is given nothing more."""
        with self._sending, suppress(OSError):
            self._is_finishing = True
            self._connection.send(None)

    def ask_to_end(self) -> None:
        """What it is doing is given up, and no half-written file is left."""
        self._process.terminate()

    def end(self) -> None:
        self._join(_PATIENCE)
        self._process.kill()
        self._join()

    def _join(self, seconds: float | None = None) -> None:
        with self._joining:  # two threads that wait for one process may both miss its exit status
            self._process.join(seconds)


def how_it_ended(code: int | None) -> str:
    """Words for the exit status of a process that has ended in the midst of a task."""
    if code is None or code >= 0:
        return f"the process that rendered it has ended (exit status {code})"
    name = signal.Signals(-code).name
    if name == "SIGKILL":
        return "the process that rendered it was killed (SIGKILL), perhaps for want of memory"
    return f"the process that rendered it has crashed ({name})"


def _serve(connection: Connection, make_worker: Callable[[], Doer], count: int) -> None:
    """One of `count` other processes: does tasks until the connection ends, as it does when the first process ends.
    None ends the task in the making early, which looks whether something has come, and nothing else."""
    with suppress(Stopped), sent_again():
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the first process, which then terminates this one
        signal.signal(signal.SIGTERM, _stop)  # whatever it is doing: nobody waits for part of a picture
        threading.Thread(target=_end_with_parent, daemon=True).start()
        # Mesa's software renderer would start as many threads as there are cores in each process.
        os.environ.setdefault("LP_NUM_THREADS", str(max(core_count() // count, 1)))
        worker, nowhere = None, Progress(1, enabled=False)
        with suppress(EOFError, OSError):
            while True:
                task = connection.recv()
                if task is None:
                    continue
                try:
                    worker = worker or make_worker()
                    answer: Done | ViewerError = worker.do(task, nowhere, connection.poll)
                except ViewerError as error:
                    answer = error
                connection.send(answer)


def _stop(number: int, frame: object) -> NoReturn:
    raise Stopped(number)


def _end_with_parent() -> None:
    """Without it, a process whose parent is killed would first finish its picture."""
    parent = parent_process()
    assert parent is not None
    wait([parent.sentinel])
    os.kill(os.getpid(), signal.SIGTERM)
