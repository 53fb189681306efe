"""Does the tasks of a render job by an engine: what is done already is left out, and what fails may be tried again."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..base.atomic import remove_leftovers, write_json
from ..base.messages import say
from ..base.progress import Progress
from ..base.signals import Stopped
from ..errors import InputError, OutputError
from ..jobs.assemble import make_environment
from ..jobs.camera_output import write_camera_files
from ..jobs.model_renderer import Record
from ..jobs.render_job import RenderJob, RenderTask
from .engines import ClusterLost, Engine, Here, WorkerLost
from .manifest import Line, Manifest
from .options import LOCAL
from .sums import Sums
from .work import Done, Worker

if TYPE_CHECKING:
    from .keys import Keys


@dataclass(frozen=True)
class Batch:
    """How the tasks of a job are done.

    `stats` names a JSON file for the times, plan and memory, or the error, of each picture. `folder` is that of the
    manifest; None for none. With `resume` the pictures that are done by it are left out. `retries` is how often a model
    is tried again that has failed for reasons which may pass; None for the default. `jobs` is the number of processes
    beside this one that do the tasks; None for this one alone. `dask` is the address of the scheduler of a Dask cluster
    that does them, and `scheduler_file` a file that has it. `cameras` has the file for the cameras of each model's
    pictures.
    """

    stats: str | None = None
    folder: Path | None = None
    resume: bool = False
    retries: int | None = None
    jobs: int | None = None
    dask: str | None = None
    scheduler_file: str | None = None
    cameras: Mapping[str, Path] = field(default_factory=dict)

    @property
    def is_here(self) -> bool:
        """Whether this process does the tasks."""
        return self.jobs is None and self.dask is None and self.scheduler_file is None


@dataclass(frozen=True)
class Attempt:
    """`key` is that of the files before they are read, in case that they change meanwhile."""

    number: int
    task: RenderTask
    tries: int = 0
    key: str | None = None


def render_all(tasks: Sequence[RenderTask], job: RenderJob, batch: Batch) -> int:
    """Make the pictures of all models. Returns the exit status: 0, or 1 if some picture could not be made.

    A model that cannot be rendered is reported on stderr, and the others are still rendered. A signal that ends a
    picture early ends the job, too; the exit status is then the shell's for that signal. Raises ContextError and
    UsageError, which concern all models, and OutputError for a manifest or `stats` that cannot be written.
    """
    with ExitStack() as stack:
        manifest = None if batch.folder is None else stack.enter_context(Manifest(batch.folder))
        run = Run(job, batch, manifest)
        attempts = [Attempt(number, task) for number, task in enumerate(tasks) if not run.is_done(number, task)]
        if batch.resume and not job.options["quiet"]:
            say(f"{len(tasks) - len(attempts)} of {len(tasks)} models are done already")
        progress = stack.enter_context(Progress(len(attempts), not job.options["quiet"], unit="models"))
        try:
            with make_engine(job, batch, len(attempts) > 1, progress) as engine:
                run.do(attempts, engine, progress)
        except (Stopped, ClusterLost):
            run.note_finished()
            run.tell(len(attempts))
            raise
        if not batch.is_here:
            run.tell(len(attempts))
    if not batch.is_here:
        for folder in {task.output.parent for task in tasks}:
            remove_leftovers(folder)  # of workers that died
    records = [record for _, found in sorted(run.records.items()) for record in found]
    all_known = sorted((run.known | run.records).items())
    write_camera_files(batch.cameras, [record for _, found in all_known for record in found], job.options)
    if batch.stats is not None:
        write_json(batch.stats, records[0] if len(tasks) == len(records) == 1 else records)
    if run.stopped is not None:
        return Stopped(run.stopped).exit_status
    return 1 if any("error" in record for record in records) else 0


def make_engine(job: RenderJob, batch: Batch, has_several: bool, progress: Progress) -> Engine:
    """What does the tasks. Raises InputError for an environment that cannot be used, which `has_several` models would
    tell of one after the other."""
    if batch.is_here:
        return Here(job, has_several, progress)
    environment, make_worker = make_environment(job.options), partial(Worker, job)
    if has_several and environment is not None:
        environment.radiance  # noqa: B018  it is decoded when it is first read
    if batch.dask is not None or batch.scheduler_file is not None:
        from .cluster import Cluster

        return Cluster(make_worker, batch.dask or LOCAL, batch.scheduler_file, batch.jobs)
    from .processes import Processes

    assert batch.jobs is not None
    return Processes(make_worker, batch.jobs)


def do_parts(parts: Sequence[RenderTask], job: RenderJob, batch: Batch) -> Run:
    """Do the parts of one picture or film, each of which is tried again once where `batch` does not say how often.
    The first signal to stop ends them, with the samples there are, and the run's `stopped` is that then. The second
    raises Stopped. Raises as `render_all`."""
    run = Run(job, replace(batch, retries=1 if batch.retries is None else batch.retries), None)
    with ExitStack() as stack:
        progress = stack.enter_context(Progress(len(parts), not job.options["quiet"]))
        attempts = [Attempt(number, part) for number, part in enumerate(parts)]
        engine = stack.enter_context(make_engine(job, batch, True, progress))
        try:
            run.do(attempts, engine, progress, are_parts=True)
        except Stopped as stopped:
            run.stopped = stopped.number
            run.gather(engine)
    return run


class Run:
    """`records` are what `--stats` tells of the pictures, by the numbers of their tasks, and `known` the same of those
    that were done before, as far as their manifest tells it. `stopped` is the signal that ended the run early."""

    def __init__(self, job: RenderJob, batch: Batch, manifest: Manifest | None) -> None:
        self._batch, self._manifest, self._is_quiet = batch, manifest, bool(job.options["quiet"])
        self._retries = (manifest is not None) if batch.retries is None else batch.retries
        self._keys: Keys | None = None
        if manifest is not None:
            from .keys import Keys  # imports readers of XML and of packages' metadata, and through them urllib and ssl

            self._keys = Keys(job)
        self.records: dict[int, tuple[Record, ...]] = {}
        self.known: dict[int, tuple[Record, ...]] = {}
        self.stopped: int | None = None
        self._running: dict[Future[Done], Attempt] = {}
        self.sums = Sums()
        self.frames: dict[int, np.ndarray] = {}
        self._started = time.monotonic()

    def is_done(self, number: int, task: RenderTask) -> bool:
        """Whether it need not be done, because the manifest to resume says that it was."""
        manifest = self._manifest
        if not self._batch.resume or manifest is None:
            return False
        key = self._key(task)
        if not manifest.is_done(task, key):
            return False
        lines = manifest.lines_of(task, key)
        if self._batch.cameras and not all(line.cameras for line in lines):
            return False
        self.known[number] = tuple({"model": task.model, "output": str(manifest.file_of(line)), "cameras": line.cameras}
                                   for line in lines if line.cameras)
        return True

    def _with_key(self, attempt: Attempt) -> Attempt:
        return attempt if attempt.key is not None else replace(attempt, key=self._key(attempt.task))

    def _key(self, task: RenderTask) -> str:
        if self._manifest is None or self._keys is None:
            return ""
        return self._keys.of(task.model, self._manifest.out(task.picture()))

    def do(self, attempts: Sequence[Attempt], engine: Engine, progress: Progress, are_parts: bool = False) -> None:
        """Do them all, unless a signal ends one early. If they `are_parts` of one picture, a failure is the end."""
        waiting, running = deque(attempts), self._running
        while self.stopped is None and (waiting or running) and not (are_parts and self._has_failed):
            while waiting and len(running) < engine.room:
                attempt = self._with_key(waiting.popleft())
                if waiting and isinstance(engine, Here):
                    waiting[0] = self._with_key(waiting[0])
                    engine.expect(waiting[0].task)
                running[engine.submit(attempt.task)] = attempt
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                attempt = running.pop(future)
                waiting.extend(self._note(attempt, future))
                if not isinstance(engine, Here):  # which shows what it does now
                    progress.done(len(self.records), Path(attempt.task.model).name)

    def gather(self, engine: Engine) -> None:
        """Take the samples of the parts that a signal has found in the making, as far as they are traced."""
        if any(attempt.task.samples is not None for attempt in self._running.values()) and engine.finish():
            wait(self._running)
        for future, attempt in self._running.items():
            if future.done() and future.exception() is None and (part := future.result().part) is not None:
                self.sums.add(attempt.number, part)

    def note_finished(self) -> None:
        """Note the models that were done while the engine ended, so that each picture there has its line."""
        for future, attempt in list(self._running.items()):
            is_done = future.done() and not future.cancelled() and future.exception() is None
            if is_done and not future.result().may_pass:
                del self._running[future]
                list(self._note(attempt, future))

    @property
    def _has_failed(self) -> bool:
        return any("error" in record for records in self.records.values() for record in records)

    def _note(self, attempt: Attempt, future: Future[Done]) -> Iterator[Attempt]:
        """Note what has become of the attempt; yields another one if it is to be tried again."""
        task = attempt.task
        try:
            done = future.result()
        except (WorkerLost, InputError, OutputError) as error:
            text = f"{task.model}: {error}"
            done = Done(({"model": task.model, "output": str(task.picture()), "error": text},), "",
                        (f"pbr-viewer: {text}",), may_pass=True)
        for line in done.lines:
            say(line)
        if done.may_pass and done.stopped is None and attempt.tries < self._retries:
            say(f"{task.model}: is tried again")
            yield replace(attempt, tries=attempt.tries + 1, key=None)
            return
        if self.stopped is None:
            self.stopped = done.stopped
        self.records[attempt.number] = done.records
        if done.part is not None:
            self.sums.add(attempt.number, done.part)
        if done.frames is not None:
            self.frames[attempt.number] = done.frames
        if self._manifest is not None:
            lines = self._lines(task, attempt.key or "", done, self._manifest)
            self._manifest.add(list(lines), self._manifest.out(task.picture()))

    def tell(self, count: int) -> None:
        """Tell what has become of `count` models, and in which time, unless there was but one."""
        if count < 2 or self._is_quiet:
            return
        seconds = time.monotonic() - self._started
        failed = sum(any("error" in record for record in records) for records in self.records.values())
        rate = 60 * len(self.records) / max(seconds, 1e-3)
        where = ""
        if self._manifest is not None and self._manifest.path.exists():  # not if it was stopped before the first
            where = f"; {self._manifest.path} has a line for each picture"
            if len(self.records) < count:
                where += ", by which --resume goes on"
        failures = f"; {failed} failed" if failed else ""
        say(f"{len(self.records) - failed} of {count} models are rendered in {seconds:.0f} s, {rate:.3g} a minute"
            f"{failures}{where}")

    @staticmethod
    def _lines(task: RenderTask, key: str, done: Done, manifest: Manifest) -> Iterator[Line]:
        for number, record in enumerate(done.records, 1):
            error = record.get("error")
            if error is None and done.stopped is not None and number == len(done.records):
                error = "stopped early"
            out, times = manifest.out(Path(str(record["output"]))), record.get("wall_s")
            seconds = round(times["total"], 3) if isinstance(times, dict) else None
            cameras = record.get("cameras")
            yield Line(task.model, out, key, "done" if error is None else "failed",
                       None if error is None else str(error), seconds, done.worker,
                       cameras if isinstance(cameras, list) else [])
