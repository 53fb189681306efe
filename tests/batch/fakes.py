"""Stand-ins for a worker that renders: what they do with a task stands in the name of its model."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable
from pathlib import Path

from viewer.base.atomic import atomic_write
from viewer.base.progress import Progress
from viewer.batch.work import Done
from viewer.errors import ContextError, InputError
from viewer.jobs.render_job import RenderTask


class Deaf:
    """Python ignores what ends the wait of this `__del__`."""

    def __del__(self) -> None:
        while True:
            Path("waits").touch()
            time.sleep(0.01)


class FakeWorker:
    """`fail` is reported; `kill` ends the process while a file is half written; `wait` takes until the file `go` is
    there, or until it is to stop, and `deaf` the same after it has lost one exception; `context` and `input` raise."""

    def do(self, task: RenderTask, progress: Progress, wants_to_stop: Callable[[], bool] = lambda: False) -> Done:
        name = Path(task.model).stem
        record: dict[str, object] = {"model": task.model, "output": str(task.output), "wall_s": {"total": 0.1}}
        if name.startswith("fail"):
            return Done(({**record, "error": f"{task.model}: broken"},), str(os.getpid()), (f"{task.model}: broken",))
        if name == "context":
            raise ContextError("no OpenGL context")
        if name == "input":
            raise InputError("env.hdr", "line 1", "is broken")
        with atomic_write(task.output) as temporary:
            temporary.write_text("half")
            if name == "kill":
                os.kill(os.getpid(), signal.SIGKILL)
            if name == "deaf":
                Deaf()
            while name in ("wait", "deaf") and not (Path("go").exists() or wants_to_stop()):
                Path("waits").touch()
                time.sleep(0.01)
            temporary.write_text("whole")
        return Done((record,), str(os.getpid()))
