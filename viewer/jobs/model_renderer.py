"""Renders the pictures of one model after the other, with one OpenGL context."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Self

from ..base.atomic import made_folders
from ..base.begun import begun
from ..base.memory import memory_mb
from ..base.messages import say
from ..base.progress import Progress
from ..base.signals import Stopped, postponed
from ..errors import ContextError, OutputError, UsageError, ViewerError
from ..image.film import write_film
from ..image.image import Image
from ..plan.warnings import camera_warnings, sample_warnings
from ..scene.camera import Camera
from ..scene.camera_file import camera_facts
from ..scene.scene import Scene
from .assemble import known_warnings, make_environment, make_quality, make_scene, make_settings
from .film import Film, make_film
from .following import make_following
from .makers import RasterMaker, make_picture_maker
from .picture_maker import RenderRequest
from .render_job import RenderJob, RenderTask
from .views import View, views_of

if TYPE_CHECKING:
    from ..gpu.context import Context
    from ..scene.decoding import Decoder

Record = dict[str, object]


class ModelRenderer:
    """Does the tasks of a job in this process. What they share, such as the context, programs and the environment, is
    made for the first of them and kept until `release`, which the end of a `with` block calls.

    `tell` gets each line for the user.
    """

    def __init__(self, job: RenderJob, tell: Callable[[str], None] = say) -> None:
        options = job.options
        self._job, self._tell = job, tell
        self._settings = make_settings(options)
        self._environment = make_environment(options)
        self._context: Context | None = None
        self._begun: dict[RenderTask, Future[tuple[Scene, Decoder]]] = {}
        self._warned: list[str] = []
        """What the user has been warned of in this model."""
        self.may_pass = False
        """Whether the last task has failed for want of memory, or at writing, so that another try may do it."""
        self._request = RenderRequest(
            self._open, self._settings, options["size"], options["aov"], use_cache=not options["no_cache"],
            measure=job.measure, quiet=options["quiet"], chooses=job.chooses, tell_error=options["tell_error"],
            following=make_following(options), tell=tell)
        self._maker = make_picture_maker(self._request)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.release()

    def release(self) -> None:
        if self._context is not None:
            self._context.release()
            self._context = None

    @property
    def stopped(self) -> int | None:
        """The number of the signal that ended the last task early; None if it is complete."""
        return self._maker.stopped

    def decode_environment(self) -> None:
        """Decode it now, so that an error is reported once, and not for each model. Raises InputError."""
        if self._environment is not None:
            self._environment.radiance  # noqa: B018  it is decoded when it is first read

    def expect(self, task: RenderTask) -> None:
        """Begin to load the model of the task after the next one, and to decode its images, on other threads, while
        the next one is drawn. The first task is not delayed by that, and paths keep all cores busy by themselves."""
        if isinstance(self._maker, RasterMaker) and self._maker.has_renderer:
            self._begun[task] = begun(partial(self._load_ahead, task))

    def _load_ahead(self, task: RenderTask) -> tuple[Scene, Decoder]:
        from ..raster.sampled_images import decode_ahead

        options = self._job.options
        scene = make_scene(task.model, self._environment, options)
        quality = make_quality(options, self._settings, scene, options["size"])
        return scene, decode_ahead(scene, quality.applied(self._settings))

    def _load(self, task: RenderTask) -> Scene:
        if task not in self._begun:
            return make_scene(task.model, self._environment, self._job.options)
        scene, ahead = self._begun.pop(task).result()
        assert isinstance(self._maker, RasterMaker)
        self._maker.expect(ahead)
        return scene

    def render(self, task: RenderTask, progress: Progress) -> list[Record]:
        """Make all pictures of a model, and write them. Returns what `--stats` tells of each; an "error" says why there
        is none.

        A model that cannot be rendered is told of, but raises nothing. A signal to stop during path tracing ends the
        picture with its samples so far, and one during a film with the frames so far (`stopped`). At other times it
        raises Stopped. Raises ContextError and UsageError, which concern all models.
        """
        self.may_pass = False
        self._maker.forget()
        progress.step(f"{Path(task.model).name}: loading")
        start = time.perf_counter()
        records: list[Record] = []
        with self._told(task.model, task.picture(), records):
            scene = self._load(task)
            film = make_film(task.model, task.picture(), scene, self._job.options)
            self._warn(task.model, scene)
            if film is not None:
                records.append(self._film(task, scene, film, start, progress))
                return records
            if self._job.options["sheet"] is not None:
                records.append(self._sheet(task, scene, start, progress))
                return records
            views = views_of(task.model, scene, self._job.options)
            if len(views) == 1 and "{view}" not in str(task.output):
                views = (replace(views[0], label=""),)
            for view in views:
                with self._told(task.model, task.picture(view.label), records):
                    records.append(self._picture(task, scene, view, start, progress))
                if self.stopped is not None:
                    break
                start = time.perf_counter()
        return records

    @contextmanager
    def _told(self, model: str, path: Path, records: list[Record]) -> Iterator[None]:
        """Tell of an error that concerns this picture alone, and add its record."""
        try:
            yield
        except (ContextError, UsageError):
            raise
        except (ViewerError, MemoryError) as error:
            text = f"{model}: {_words(error)}" if isinstance(error, MemoryError) else _words(error)
            self._tell(f"pbr-viewer: {text}")
            records.append({"model": model, "output": str(path), "error": text})
            self.may_pass = self.may_pass or isinstance(error, (MemoryError, OutputError))

    def _picture(self, task: RenderTask, scene: Scene, view: View, start: float, progress: Progress) -> Record:
        """Make the picture of a view. `start` is when loading began, or the view before it had ended."""
        path, maker, loaded = task.picture(view.label), self._maker, time.perf_counter()
        progress.say(f"{path.name}: rendering")
        self._request.size = view.size
        self._choose_quality(scene, view.size)
        image = maker.make(scene, view.camera, path, progress)
        of_camera = [] if self._job.chooses else camera_warnings(scene, self._settings, view.camera)
        self._warn_after(task.model, scene, of_camera)
        rendered = time.perf_counter()
        with made_folders(path.parent):
            image.save(path)
        saved = time.perf_counter()
        failure = self._tell_error(scene, view.camera, path, task.map_of_error(view.label), progress)
        told = saved if self._job.options["tell_error"] is None else time.perf_counter()
        seconds = {"load": loaded - start, "render": rendered - loaded, "save": saved - rendered,
                   **({} if told == saved else {"tell_error": told - saved}), "total": told - start}
        record = self._done(task.model, path, scene, seconds, maker.summary)
        if self._job.options["write_cameras"] is not None:
            record["cameras"] = [camera_facts(view.camera, view.size)]
        return record | ({"error": failure} if failure else {})

    def _sheet(self, task: RenderTask, scene: Scene, start: float, progress: Progress) -> Record:
        """As `_picture`, of all views in one; the plan and the times of preparing are those of the last view."""
        from ..image.sheet import labelled_sheet
        from .sheets import sheet_views

        path, loaded = task.picture(), time.perf_counter()
        views, cells = sheet_views(task.model, scene, self._job.options), []
        self._choose_quality(scene, self._job.options["size"])  # that of each view
        for number, view in enumerate(views):
            progress.part(number / len(views), f"{path.name}: view {number + 1} of {len(views)}")
            self._request.size = view.size
            cells.append((view.title, self._maker.make(scene, view.camera, path, progress).srgb))
            if self.stopped is not None:
                break
        self._warn_after(task.model, scene)
        rendered = time.perf_counter()
        sheet = labelled_sheet(cells, self._job.options["sheet"][0], self._job.options["size"])
        sheet.save(path)
        saved = time.perf_counter()
        seconds = {"load": loaded - start, "render": rendered - loaded, "save": saved - rendered,
                   "total": saved - start}
        record = self._done(task.model, path, scene, seconds, f"{len(cells)} of {len(views)} views")
        if self._job.options["write_cameras"] is not None:
            record["cameras"] = [camera_facts(view.camera, view.size) for view in views[:len(cells)]]
        return record | {"size": list(sheet.size), "views": len(cells)}

    def _film(self, task: RenderTask, scene: Scene, film: Film, start: float, progress: Progress) -> Record:
        """As `_picture`."""
        path, loaded = task.picture(), time.perf_counter()
        progress.say(f"{path.name}: rendering")
        self._choose_quality(scene, self._request.size)  # one for all frames
        with postponed() as request:
            count = write_film(path, self._frames(scene, film, path, progress), film.fps)
        self._maker.stopped = self._maker.stopped or request.number
        self._warn_after(task.model, scene)
        rendered = time.perf_counter()
        seconds = {"load": loaded - start, "render": rendered - loaded, "save": 0.0, "total": rendered - start}
        how_far = f"{count} of {len(film.frames)} frames"
        return self._done(task.model, path, scene, seconds, how_far) | {"frames": count}

    def _choose_quality(self, scene: Scene, size: tuple[int, int]) -> None:
        self._request.quality = make_quality(self._job.options, self._settings, scene, size)

    def _done(self, model: str, path: Path, scene: Scene, seconds: dict[str, float], how_far: str) -> Record:
        """Tell that a picture or film is in its file, if that is to be told, and return its record."""
        if self._job.options["verbose"]:
            times = ", ".join(f"{name} {value:.3f} s" for name, value in seconds.items())
            self._tell(f"{path}: {times}; {self._maker.summary}")
        if self.stopped is not None:
            self._tell(f"pbr-viewer: {path}: stopped after {how_far}")
        return self._record(model, path, scene, seconds)

    def _warn_after(self, model: str, scene: Scene, of_camera: Sequence[str] = ()) -> None:
        """Warn of what is known only when the picture is there. What is wrong with textures is known when they are
        decoded, which other threads may do at any time."""
        if not self._job.options["quiet"]:
            lost = [line for line in scene.all_warnings if line not in self._warned]
            self._warned += lost
            for warning in [*lost, *of_camera, *sample_warnings(self._maker.stats)]:
                self._tell(f"{model}: warning: {warning}")

    def _warn(self, model: str, scene: Scene) -> None:
        if not self._job.options["quiet"]:
            self._warned = known_warnings(scene, self._settings)
            for warning in self._warned:
                self._tell(f"{model}: warning: {warning}")

    def _tell_error(self, scene: Scene, camera: Camera, path: Path, map_path: Path | None, progress: Progress) -> str:
        """Tell the error of the picture at `path`, if that is asked for, and write its map. Returns why that failed,
        as it was told to the user, or ""."""
        maker = self._maker
        if self._job.options["tell_error"] is None:
            return ""
        assert isinstance(maker, RasterMaker)  # options refuse it for others
        try:
            maker.tell_error(scene, camera, path, progress)
        except (ViewerError, MemoryError) as problem:
            text = f"{path} is written, but how far it is from the truth is not known: {_words(problem)}"
            self._tell(f"pbr-viewer: {text}")
            return text
        error = maker.error
        if error is not None and not self._job.options["quiet"]:
            for line in (str(error), *(f"warning: {note}" for note in error.notes)):
                self._tell(f"{path}: {line}")
        if error is not None and map_path is not None:
            with made_folders(map_path.parent):
                error.map_image().save(map_path)
        return ""

    def _frames(self, scene: Scene, film: Film, path: Path, progress: Progress) -> Iterator[Image]:
        """The pictures of a film. The first signal to stop ends them, after one at least; the next, at once after the
        first picture."""
        maker = self._maker
        with postponed() as request:
            for k, frame in enumerate(film.frames):
                scene = frame.of(scene)
                progress.part(k / len(film.frames), f"{path.name}: frame {k + 1} of {len(film.frames)}")
                try:
                    image = maker.make(scene, film.camera(scene, frame), path, progress)
                except Stopped as stopped:
                    if k == 0:
                        raise
                    maker.stopped = stopped.number
                    break
                maker.stopped = maker.stopped or request.number
                if k == 0 or maker.stopped is None:
                    yield image
                if maker.stopped is not None:
                    break

    def _open(self) -> Context:
        if self._context is None:
            from ..gpu.context import open_context

            start = time.perf_counter()
            self._context = context = open_context(self._job.options["backend"])
            if self._job.options["verbose"]:
                seconds = time.perf_counter() - start
                self._tell(f"{context.backend}: {context.renderer}, OpenGL {context.version}: {seconds:.3f} s")
        return self._context

    def _record(self, model: str, path: Path, scene: Scene, seconds: dict[str, float]) -> Record:
        context, maker = self._open(), self._maker
        return {
            "model": model, "output": str(path), "size": list(self._request.size),
            "triangles": scene.triangle_count,
            "device": context.renderer, "opengl": context.version, "backend": context.backend,
            "wall_s": seconds, **maker.stats, "warnings": list(scene.all_warnings),
            "memory": memory_mb() | {"textures_mb": maker.texture_bytes / 1e6},
        }


def _words(error: ViewerError | MemoryError) -> str:
    return "out of memory" if isinstance(error, MemoryError) else str(error)
