"""`pbr-viewer render`: pictures of models, one after the other, with one OpenGL context."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from ..base.atomic import write_json
from ..base.messages import say, say_error
from ..base.progress import Progress
from ..base.signals import Stopped
from ..errors import ContextError, OutputError, UsageError, ViewerError
from ..image.image import WRITABLE
from ..scene.camera import Camera
from ..scene.scene import Scene
from ..settings import Settings
from .makers import make_picture_maker
from .picture_maker import PictureMaker, RenderRequest

if TYPE_CHECKING:
    from ..gpu.context import Context

Record = dict[str, object]


@dataclass
class RenderJob:
    """`aov` are the layers of `viewer.settings.LAYERS` to add; `measure` waits for each pass to know its time; `quiet`
    shows no progress bar; `verbose` tells the times. `chooses`: the method is chosen for each picture."""

    backend: str
    settings: Settings
    size: tuple[int, int]
    aov: tuple[str, ...] = ()
    use_cache: bool = True
    measure: bool = False
    quiet: bool = False
    verbose: bool = False
    chooses: bool = False
    _context: Context | None = field(default=None, init=False)

    def run(
        self,
        work: Sequence[tuple[str, Path]],
        load: Callable[[str], Scene],
        camera: Callable[[str, Scene], Camera],
        stats: str | None = None,
    ) -> int:
        """Render each (model, path); the exit status: 0, or 1 where some model could not be shown.

        That one is told on stderr, and the others are rendered all the same. `stats` names a JSON file for times,
        plan and memory, or the error, of each. While paths are traced, a signal to stop ends all with the picture as it
        is by then and with the status that shells have for that signal; elsewhere it raises Stopped. Raises
        ContextError and UsageError, which would hold for all.
        """
        records: list[Record] = []
        status = 0
        maker = make_picture_maker(RenderRequest(
            self._open, self.settings, self.size, self.aov, self.use_cache, self.measure, self.quiet, self.chooses))
        with Progress(len(work), enabled=not self.quiet) as progress, self._opened():
            for model, path in work:
                try:
                    record = self._one(model, path, load, camera, progress, maker)
                except (ContextError, UsageError):
                    raise
                except (ViewerError, MemoryError) as error:
                    text = f"{model}: out of memory" if isinstance(error, MemoryError) else str(error)
                    say_error(text)
                    status, record = 1, {"model": model, "output": str(path), "error": text}
                records.append(record)
                if maker.stopped is not None:
                    status = Stopped(maker.stopped).exit_status
                    break
        if stats is not None:
            write_json(stats, records[0] if len(work) == 1 else records)
        return status

    def _one(self, model: str, path: Path, load: Callable[[str], Scene], camera: Callable[[str, Scene], Camera],
             progress: Progress, maker: PictureMaker) -> Record:
        progress.step(f"{Path(model).name}: loading")
        start = time.perf_counter()
        scene = load(model)
        view = camera(model, scene)
        loaded = time.perf_counter()
        progress.say(f"{Path(model).name}: rendering")
        image = maker.make(scene, view, path, progress)
        rendered = time.perf_counter()
        image.save(path)
        saved = time.perf_counter()
        seconds = {"load": loaded - start, "render": rendered - loaded, "save": saved - rendered,
                   "total": saved - start}
        if self.verbose:
            times = ", ".join(f"{name} {value:.3f} s" for name, value in seconds.items())
            say(f"{path}: {times}; {maker.summary}")
        if maker.stopped is not None:
            say_error(f"{path}: stopped after {maker.summary}")
        return self._record(model, path, scene, seconds, maker)

    @contextmanager
    def _opened(self) -> Iterator[None]:
        """Release at the end what `_open` opened, if it did."""
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
            "wall_s": seconds, **maker.stats,
            "memory": {"peak_rss_mb": peak_memory_mb(), "textures_mb": maker.texture_bytes / 1e6},
        }


def output_paths(models: Sequence[str], output: str) -> list[Path]:
    """Where each model's picture goes: OUT itself, OUT with {name} filled in, or OUT/name.png in a folder.

    Raises UsageError for names that are no pictures' or are wanted twice, OutputError for folders that do not exist.
    """
    names = [Path(model).stem for model in models]
    folder = Path(output)
    if "{name}" in output:
        paths = [Path(output.replace("{name}", name)) for name in names]
    elif folder.is_dir() or output.endswith(("/", "\\")):
        if not folder.is_dir():
            raise OutputError(f"{output}: no such folder")
        paths = [folder / f"{name}.png" for name in names]
    elif len(models) > 1:
        raise UsageError(f"-o {output}: several models need a folder or a pattern with {{name}}")
    else:
        paths = [folder]
    for path in paths:
        if path.suffix.lower() not in WRITABLE:
            raise UsageError(f"-o {path}: a picture's name ends in {', '.join(WRITABLE)}")
        check_output(path)
    twice = {str(path) for path in paths if paths.count(path) > 1}
    if twice:
        raise UsageError(f"-o {output}: several models would be written to {', '.join(sorted(twice))}")
    return paths


def check_layers(names: Sequence[str], settings: Settings, paths: Sequence[Path], chooses: bool = False) -> None:
    """Raises UsageError for layers that are not made or that no file could hold; where the method is chosen, it is one
    that makes them."""
    if names and settings.mode != "path" and not chooses:
        raise UsageError(f"aov does nothing in mode {settings.mode}, only in mode path")
    other = [path for path in paths if path.suffix.lower() != ".exr"]
    if names and other:
        raise UsageError(f"--aov with -o {other[0]}: only an .exr holds layers")


def check_output(path: str | Path) -> None:
    """Raises OutputError for a file that could not be written, before the work for it is done."""
    path = Path(path)
    if path.is_dir():
        raise OutputError(f"{path}: is a folder; a file name is needed")
    if not path.parent.is_dir():
        raise OutputError(f"{path}: the folder {path.parent} does not exist")


def peak_memory_mb() -> float | None:
    """The most this process has held so far, or None where the system does not tell."""
    try:
        import resource
    except ImportError:  # Windows
        return None
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1 << 20 if sys.platform == "darwin" else 1 << 10)
