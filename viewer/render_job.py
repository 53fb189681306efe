"""`pbr-viewer render`: pictures of models, one after the other, with one renderer."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from .atomic import write_json
from .errors import ContextError, OutputError, UsageError, ViewerError
from .image import WRITABLE, Image
from .messages import say, say_error
from .progress import Progress
from .raster.decoding import decode_ahead
from .scene.camera import Camera
from .scene.scene import Scene
from .settings import Settings

if TYPE_CHECKING:
    from .raster.renderer import Renderer

Record = dict[str, object]


@dataclass
class RenderJob:
    """`measure` waits for each pass to know its time; `quiet` shows no progress bar; `verbose` tells the times."""

    backend: str
    settings: Settings
    size: tuple[int, int]
    use_cache: bool = True
    measure: bool = False
    quiet: bool = False
    verbose: bool = False
    _renderer: Renderer | None = field(default=None, init=False)

    def run(
        self,
        work: Sequence[tuple[str, Path]],
        load: Callable[[str], Scene],
        camera: Callable[[str, Scene], Camera],
        stats: str | None = None,
    ) -> int:
        """Render each (model, path); the exit status: 0, or 1 where some model could not be shown.

        That one is told on stderr, and the others are rendered all the same. `stats` names a JSON file for times,
        plan and memory, or the error, of each. Raises ContextError and UsageError, which would hold for all.
        """
        records: list[Record] = []
        failed = False
        with Progress(len(work), enabled=not self.quiet) as progress, self._opened():
            for model, path in work:
                try:
                    record = self._one(model, path, load, camera, progress)
                except (ContextError, UsageError):
                    raise
                except (ViewerError, MemoryError) as error:
                    text = f"{model}: out of memory" if isinstance(error, MemoryError) else str(error)
                    say_error(text)
                    failed, record = True, {"model": model, "output": str(path), "error": text}
                records.append(record)
        if stats is not None:
            write_json(stats, records[0] if len(work) == 1 else records)
        return int(failed)

    def _one(self, model: str, path: Path, load: Callable[[str], Scene], camera: Callable[[str, Scene], Camera],
             progress: Progress) -> Record:
        progress.step(f"{Path(model).name}: loading")
        start = time.perf_counter()
        scene = load(model)
        view = camera(model, scene)
        ahead = decode_ahead(scene, self.settings)  # the processor has other things to do in the meantime
        loaded = time.perf_counter()
        progress.say(f"{Path(model).name}: rendering")
        renderer = self._open()
        renderer.expect(ahead)
        renderer.times.clear()
        renderer.pass_ms.clear()
        image = self._render(renderer, scene, view, path)
        rendered = time.perf_counter()
        image.save(path)
        saved = time.perf_counter()
        seconds = {"load": loaded - start, "render": rendered - loaded, "save": saved - rendered,
                   "total": saved - start}
        if self.verbose:
            say(f"{path}: {_listed(seconds)}; preparing: {_listed(renderer.times)}")
        return self._record(renderer, model, path, scene, seconds)

    @contextmanager
    def _opened(self) -> Iterator[None]:
        """Release at the end what `_open` opened, if it did."""
        try:
            yield
        finally:
            if self._renderer is not None:
                self._renderer.context.release()
                self._renderer = None

    def _open(self) -> Renderer:
        if self._renderer is None:
            from .gpu.context import open_context
            from .raster.renderer import Renderer

            start = time.perf_counter()
            context = open_context(self.backend)
            self._renderer = Renderer(context, use_cache=self.use_cache, measure=self.measure)
            if self.verbose:
                seconds = time.perf_counter() - start
                say(f"{context.backend}: {context.renderer}, OpenGL {context.version}: {seconds:.3f} s")
        return self._renderer

    def _render(self, renderer: Renderer, scene: Scene, camera: Camera, path: Path) -> Image:
        if path.suffix.lower() == ".exr":
            return renderer.render(scene, camera, self.settings, self.size)
        return renderer.display(scene, camera, self.settings, self.size)

    def _record(self, renderer: Renderer, model: str, path: Path, scene: Scene, seconds: dict[str, float]) -> Record:
        assert renderer.plan is not None
        context = renderer.context
        return {
            "model": model, "output": str(path), "size": list(self.size), "triangles": scene.triangle_count,
            "device": context.renderer, "opengl": context.version, "backend": context.backend,
            "wall_s": seconds, "prepare_s": dict(renderer.times), "pass_ms": dict(renderer.pass_ms),
            "plan": renderer.plan.to_json(),
            "memory": {"peak_rss_mb": peak_memory_mb(), "textures_mb": renderer.texture_bytes / 1e6},
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


def check_output(path: str | Path) -> None:
    """Raises OutputError for a file that could not be written, before the work for it is done."""
    path = Path(path)
    if path.is_dir():
        raise OutputError(f"{path}: is a folder; a file name is needed")
    if not path.parent.is_dir():
        raise OutputError(f"{path}: there is no folder {path.parent}")


def peak_memory_mb() -> float | None:
    """The most this process has held so far, or None where the system does not tell."""
    try:
        import resource
    except ImportError:  # Windows
        return None
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1 << 20 if sys.platform == "darwin" else 1 << 10)


def _listed(seconds: dict[str, float]) -> str:
    return ", ".join(f"{name} {value:.3f} s" for name, value in seconds.items())
