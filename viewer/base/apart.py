"""Calls functions in another process, which may crash, hang or run out of memory instead of this one."""

from __future__ import annotations

import atexit
import json
import math
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from typing import IO, Any

import numpy as np

Arrays = dict[str, np.ndarray]
_MAIN = "import json, sys; sys.path[:] = json.loads(sys.argv[1]); from viewer.base.apart import serve; serve()"
_OWN_MEMORY = 1 << 29
"""Address space that the other process takes before it is called."""
_PATIENCE = 10.0
"""Seconds by the clock that a busy machine may take for one of processor time."""


class ApartError(Exception):
    """A call that gave nothing; the text says why."""


class Apart:
    """Another process, which is started by the first call, and again by the call after one that has ended it.

    Any thread may call; calls wait for each other.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self.process: subprocess.Popen[bytes] | None = None
        self._parent = 0

    def call(self, function: str, data: bytes | memoryview, seconds: float, memory: int, **arguments: Any) -> Arrays:
        """The arrays that `function`, such as "viewer.scene.decoders:draco", makes of `data` and JSON `arguments`.

        Raises ApartError with the text of a ValueError that it raises, or if it crashes, takes longer than `seconds`
        of processor time or more than `memory` bytes. It is ended after ten times as long by the clock, too. Windows
        has that limit of time alone, and instead of the memory it limits the result.
        """
        with self._lock:
            process = self._started()
            late = threading.Event()

            def stop() -> None:
                late.set()
                process.kill()

            timer = threading.Timer(_PATIENCE * seconds, stop)
            try:
                head = {"function": function, "size": len(data), "memory": memory, "seconds": seconds,
                        "arguments": arguments}
                assert process.stdin is not None and process.stdout is not None
                _write(process.stdin, head, data)
                _read(process.stdout)  # it has imported what it needs
                timer.start()
                return _read_arrays(process.stdout, memory)
            except (OSError, EOFError, ValueError) as error:
                self.close()
                was_slow = late.is_set() or process.returncode == -getattr(signal, "SIGXCPU", 0)
                raise ApartError(f"takes longer than {seconds:.0f} s" if was_slow else "is too broken") from error
            except ApartError:
                raise
            except BaseException:  # what was not read would be taken for the next call's answer
                self.close()
                raise
            finally:
                timer.cancel()
                if timer.ident is not None:
                    timer.join()  # or it might end the process later, in the midst of the next call
                if late.is_set():
                    self.close()

    def _started(self) -> subprocess.Popen[bytes]:
        if self._parent != os.getpid():
            self.process = None  # of the process that this one was forked from
        if self.process is None or self.process.poll() is not None:
            self.close()
            command = [sys.executable, "-I", "-S", "-c", _MAIN, json.dumps(sys.path)]
            try:
                self.process = subprocess.Popen(
                    command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                    env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},  # each thread would reserve memory
                    creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0))
            except OSError as error:
                raise ApartError(f"needs another process, which cannot be started: {error.strerror}") from error
            self._parent = os.getpid()
            atexit.register(self.close)
        return self.process

    def close(self) -> None:
        """End the other process, if there is one."""
        process, self.process = self.process, None
        if process is None or self._parent != os.getpid():
            return
        atexit.unregister(self.close)
        process.kill()
        for pipe in (process.stdin, process.stdout):
            with suppress(OSError):
                pipe.close()  # type: ignore[union-attr]
        process.wait()


def serve() -> None:
    """The other process: answers calls until its standard input ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the process that calls
    calls, answers = sys.stdin.buffer, os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a library prints is no answer
    with suppress(EOFError, BrokenPipeError):
        while True:
            head = _read(calls)
            data = calls.read(head["size"])
            module, name = head["function"].split(":")
            function = getattr(import_module(module), name)
            _limit(head["memory"], head["seconds"])
            _write(answers, {})
            _write_arrays(answers, function, data, head["arguments"])


def _write_arrays(answers: IO[bytes], function: Callable[..., Arrays], data: bytes, arguments: dict[str, Any]) -> None:
    try:
        arrays = {name: np.ascontiguousarray(array) for name, array in function(data, **arguments).items()}
    except ValueError as error:
        return _write(answers, {"problem": str(error)})
    except MemoryError:
        return _write(answers, {"problem": "needs too much memory"})
    kinds = [[name, array.dtype.str, array.shape] for name, array in arrays.items()]
    return _write(answers, {"arrays": kinds}, *(array.reshape(-1).view(np.uint8) for array in arrays.values()))


def _read_arrays(answers: Any, most: int) -> Arrays:
    head = _read(answers)
    if "problem" in head:
        raise ApartError(head["problem"])
    arrays = {}
    for name, dtype, shape in head["arrays"]:
        most -= np.dtype(dtype).itemsize * int(np.prod(shape, dtype=object))
        if most < 0:
            raise ValueError("more than was allowed")
        array = arrays[name] = np.empty(shape, dtype)
        if answers.readinto(array.reshape(-1).view(np.uint8)) != array.nbytes:
            raise EOFError
    return arrays


def _write(pipe: IO[bytes], head: dict[str, Any], *data: Any) -> None:
    pipe.write(json.dumps(head).encode() + b"\n")
    for part in data:
        pipe.write(part)
    pipe.flush()


def _read(pipe: IO[bytes]) -> dict[str, Any]:
    line = pipe.readline()
    if not line:
        raise EOFError
    return json.loads(line)


def _limit(memory: int, seconds: float) -> None:
    try:
        import resource
    except ImportError:  # Windows
        return
    for kind, most in ((resource.RLIMIT_AS, _OWN_MEMORY + memory),
                       (resource.RLIMIT_CPU, math.ceil(time.process_time() + seconds))):
        hard = resource.getrlimit(kind)[1]
        with suppress(ValueError, OSError):
            resource.setrlimit(kind, (most if hard < 0 else min(most, hard), hard))


apart = Apart()
"""The one other process; it is not started before it is needed."""
