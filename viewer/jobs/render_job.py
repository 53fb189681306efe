"""`pbr-viewer render`: renders pictures of models one after the other, with one OpenGL context."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from ..base.atomic import write_json
from ..base.messages import say, say_error
from ..base.progress import Progress
from ..base.signals import Stopped, postponed
from ..errors import ContextError, OutputError, UsageError, ViewerError
from ..image.film import FILM_FORMATS, write_film
from ..image.image import WRITABLE, Image
from ..plan.warnings import camera_warnings, sample_warnings
from ..quality import Quality
from ..scene.camera import Camera
from ..scene.scene import Scene
from ..settings import Settings
from .film import Film
from .makers import RasterMaker, make_picture_maker
from .picture_maker import PictureMaker, RenderRequest

if TYPE_CHECKING:
    from ..gpu.context import Context

Record = dict[str, object]


@dataclass
class RenderJob:
    """Renders pictures with the same settings.

    `aov` are the layers to add, of `viewer.settings.LAYERS`. With `measure` each pass is timed, which waits for its
    end. With `quiet` there is no progress bar, and with `verbose` times are printed. With `chooses` the method is
    chosen for each picture. `tell_error` are the seconds of path tracing that tell the error of each picture, and
    `error_maps` the files for the maps of the error, by the pictures' files. `quality` is that of pictures of mode pbr.
    """

    backend: str
    settings: Settings
    size: tuple[int, int]
    aov: tuple[str, ...] = ()
    use_cache: bool = True
    measure: bool = False
    quiet: bool = False
    verbose: bool = False
    chooses: bool = False
    tell_error: float | None = None
    error_maps: Mapping[Path, Path] = field(default_factory=dict)
    quality: Quality = Quality()
    _context: Context | None = field(default=None, init=False)

    def run(
        self,
        work: Sequence[tuple[str, Path]],
        load: Callable[[str], Scene],
        camera: Callable[[str, Scene], Camera],
        stats: str | None = None,
        film: Callable[[str, Path, Scene], Film | None] = lambda model, path, scene: None,
    ) -> int:
        """Render each (model, path). Returns the exit status: 0, or 1 if some model could not be rendered.

        `film` says what of a model is filmed; for None it is one picture, from `camera`.

        A model that cannot be rendered is reported on stderr, and the others are still rendered. `stats` names a JSON
        file for the times, plan and memory, or the error, of each picture. A signal to stop during path tracing saves
        the picture with its samples so far, and one during a film the frames so far, and ends the job; the exit status
        is then the shell's for that signal. At other times the signal raises Stopped. Raises ContextError and
        UsageError, which concern all models.
        """
        records: list[Record] = []
        status = 0
        maker = make_picture_maker(RenderRequest(
            self._open, self.settings, self.size, self.aov, self.use_cache, self.measure, self.quiet, self.chooses,
            self.tell_error, self.quality))
        with Progress(len(work), enabled=not self.quiet) as progress, self._opened():
            for model, path in work:
                try:
                    record = self._one(model, path, load, camera, film, progress, maker)
                except (ContextError, UsageError):
                    raise
                except (ViewerError, MemoryError) as error:
                    text = f"{model}: {_words(error)}" if isinstance(error, MemoryError) else _words(error)
                    say_error(text)
                    record = {"model": model, "output": str(path), "error": text}
                records.append(record)
                status = 1 if "error" in record else status
                if maker.stopped is not None:
                    status = Stopped(maker.stopped).exit_status
                    break
        if stats is not None:
            write_json(stats, records[0] if len(work) == 1 else records)
        return status

    def _one(self, model: str, path: Path, load: Callable[[str], Scene], camera: Callable[[str, Scene], Camera],
             film: Callable[[str, Path, Scene], Film | None], progress: Progress, maker: PictureMaker) -> Record:
        progress.step(f"{Path(model).name}: loading")
        start = time.perf_counter()
        scene = load(model)
        shots = film(model, path, scene)
        view = camera(model, scene) if shots is None else None
        loaded = time.perf_counter()
        progress.say(f"{Path(model).name}: rendering")
        known = scene.all_warnings
        image = maker.make(scene, view, path, progress) if view is not None else None
        count = write_film(path, self._frames(scene, shots, path, progress, maker), shots.fps) if shots else 0
        if not self.quiet:  # of textures, what is wrong is known only when they are decoded
            lost = [line for line in scene.all_warnings if line not in known]
            of_camera = [] if view is None or self.chooses else camera_warnings(scene, self.settings, view)
            for warning in [*lost, *of_camera, *sample_warnings(maker.stats)]:
                say(f"{model}: warning: {warning}")
        rendered = time.perf_counter()
        if image is not None:
            image.save(path)
        saved = time.perf_counter()
        failure = "" if view is None else self._tell_error(scene, view, path, progress, maker)
        told = saved if self.tell_error is None else time.perf_counter()
        seconds = {"load": loaded - start, "render": rendered - loaded, "save": saved - rendered,
                   **({} if self.tell_error is None else {"tell_error": told - saved}), "total": told - start}
        if self.verbose:
            times = ", ".join(f"{name} {value:.3f} s" for name, value in seconds.items())
            say(f"{path}: {times}; {maker.summary}")
        if maker.stopped is not None:
            done = f"{count} of {len(shots.frames)} frames" if shots else maker.summary
            say_error(f"{path}: stopped after {done}")
        record = self._record(model, path, scene, seconds, maker) | ({"frames": count} if shots else {})
        return record | ({"error": failure} if failure else {})

    def _tell_error(self, scene: Scene, camera: Camera, path: Path, progress: Progress, maker: PictureMaker) -> str:
        """Tell the error of the picture at `path`, if that is asked for, and write its map. Returns why that failed,
        as it was told to the user, or ""."""
        if self.tell_error is None:
            return ""
        assert isinstance(maker, RasterMaker)  # options refuse it for others
        try:
            maker.tell_error(scene, camera, path, progress)
        except (ViewerError, MemoryError) as problem:
            text = f"{path} is written, but how far it is from the truth is not known: {_words(problem)}"
            say_error(text)
            return text
        error = maker.error
        if error is not None and not self.quiet:
            for line in (str(error), *(f"warning: {note}" for note in error.notes)):
                say(f"{path}: {line}")
        if error is not None and path in self.error_maps:
            error.map_image().save(self.error_maps[path])
        return ""

    @staticmethod
    def _frames(scene: Scene, film: Film, path: Path, progress: Progress, maker: PictureMaker) -> Iterator[Image]:
        """The pictures of a film. The first signal to stop ends them, after one at least."""
        with postponed() as request:
            for k, frame in enumerate(film.frames):
                scene = frame.of(scene)
                progress.part(k / len(film.frames), f"{path.name}: frame {k + 1} of {len(film.frames)}")
                image = maker.make(scene, film.camera(scene, frame), path, progress)
                maker.stopped = maker.stopped or request.number
                if k == 0 or maker.stopped is None:
                    yield image
                if maker.stopped is not None:
                    break

    @contextmanager
    def _opened(self) -> Iterator[None]:
        """Release the context at the end of the block, if `_open` has opened one."""
        try:
            yield
        finally:
            if self._context is not None:
                self._context.release()
                self._context = None

    def _open(self) -> Context:
        if self._context is None:
            from ..gpu.context import open_context

            start = time.perf_counter()
            self._context = context = open_context(self.backend)
            if self.verbose:
                seconds = time.perf_counter() - start
                say(f"{context.backend}: {context.renderer}, OpenGL {context.version}: {seconds:.3f} s")
        return self._context

    def _record(self, model: str, path: Path, scene: Scene, seconds: dict[str, float], maker: PictureMaker) -> Record:
        context = self._open()
        return {
            "model": model, "output": str(path), "size": list(self.size), "triangles": scene.triangle_count,
            "device": context.renderer, "opengl": context.version, "backend": context.backend,
            "wall_s": seconds, **maker.stats, "warnings": list(scene.all_warnings),
            "memory": {"peak_rss_mb": peak_memory_mb(), "textures_mb": maker.texture_bytes / 1e6},
        }


def _words(error: ViewerError | MemoryError) -> str:
    return "out of memory" if isinstance(error, MemoryError) else str(error)


def output_paths(models: Sequence[str], output: str, option: str = "-o") -> tuple[list[Path], list[Path]]:
    """The path of each model's picture, and the folders that are made for them where they are missing.

    A picture is OUT itself, OUT with {name} replaced, or OUT/name.png if OUT is a folder or ends in "/". No folder is
    made for OUT itself. Raises UsageError for a path that is not a picture's or that two models have; it names the
    `option` of `output`.
    """
    names = [Path(model).stem for model in models]
    is_pattern = "{name}" in output
    is_folder = output.endswith(("/", "\\")) or Path(output).is_dir()
    if is_pattern:
        paths = [Path(output.replace("{name}", name)) for name in names]
    elif is_folder:
        paths = [Path(output) / f"{name}.png" for name in names]
    elif len(models) > 1:
        raise UsageError(f"{option} {output}: several models need a folder, {output}/, or a pattern with {{name}}")
    else:
        paths = [Path(output)]
    for path in paths:
        if path.suffix.lower() not in (*WRITABLE, *FILM_FORMATS):
            raise UsageError(f"{option} {path}: the name of a picture must end in one of {', '.join(WRITABLE)}; that "
                             f"of a film in one of {', '.join(FILM_FORMATS)}; that of a folder in /")
    twice = {str(path) for path in paths if paths.count(path) > 1}
    if twice:
        raise UsageError(f"{option} {output}: several models would be written to {', '.join(sorted(twice))}")
    return paths, list(dict.fromkeys(path.parent for path in paths)) if is_pattern or is_folder else []


def check_layers(names: Sequence[str], settings: Settings, paths: Sequence[Path], chooses: bool = False) -> None:
    """Raises UsageError for layers that the mode does not make or that a file cannot store.

    With `chooses`, a method that makes the layers is chosen.
    """
    if names and settings.mode != "path" and not chooses:
        raise UsageError(f"aov has no effect in mode {settings.mode}, only in mode path")
    other = [path for path in paths if path.suffix.lower() != ".exr"]
    if names and other:
        raise UsageError(f"--aov with -o {other[0]}: only an .exr can store layers")


def check_apart(paths: Sequence[str | Path]) -> None:
    """Raises UsageError if two of these files are one."""
    places = [Path(path).absolute() for path in paths]
    for path, place in zip(paths, places, strict=True):
        if places.count(place) > 1:
            raise UsageError(f"{path}: two outputs would be written to one file")


def check_output(path: str | Path) -> None:
    """Raises OutputError if `path` cannot be written, before any work is done for it."""
    path = Path(path)
    if path.is_dir():
        raise OutputError(f"{path}: is a folder; a file name is needed")
    if not path.parent.is_dir():
        raise OutputError(f"{path}: the folder {path.parent} does not exist")


def peak_memory_mb() -> float | None:
    """The peak memory of this process in MB, or None if the system does not report it."""
    try:
        import resource
    except ImportError:  # Windows
        return None
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1 << 20 if sys.platform == "darwin" else 1 << 10)
