"""`pbr-viewer render`: pictures of models, one after the other, with one renderer."""

from __future__ import annotations

import json
import resource
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import click

from .atomic import atomic_write
from .errors import OutputError, UsageError
from .image import WRITABLE, Image
from .progress import Progress
from .raster.renderer import Renderer
from .scene.camera import Camera
from .scene.scene import Scene
from .settings import Settings


@dataclass
class RenderJob:
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
        camera: Callable[[Scene], Camera],
        stats: str | None = None,
    ) -> None:
        """Render each (model, path). `stats` names a JSON file for times, plan and memory."""
        records = []
        with Progress(len(work), enabled=not self.quiet) as progress:
            for model, path in work:
                progress.step(f"{Path(model).name}: loading")
                start = time.perf_counter()
                scene = load(model)
                loaded = time.perf_counter()
                progress.say(f"{Path(model).name}: rendering")
                image = self._render(scene, camera(scene), path)
                rendered = time.perf_counter()
                image.save(path)
                saved = time.perf_counter()
                seconds = {"load": loaded - start, "render": rendered - loaded, "save": saved - rendered}
                records.append(self._record(model, path, scene, seconds))
                if self.verbose:
                    click.echo(f"{path}: {', '.join(f'{name} {s:.3f} s' for name, s in seconds.items())}", err=True)
        if stats is not None:
            with atomic_write(stats) as temporary:
                temporary.write_text(json.dumps(records[0] if len(records) == 1 else records, indent=1) + "\n")

    def _render(self, scene: Scene, camera: Camera, path: Path) -> Image:
        if self._renderer is None:
            from .gpu.context import open_context

            context = open_context(self.backend)
            self._renderer = Renderer(context, use_cache=self.use_cache, measure=self.measure)
            if self.verbose:
                click.echo(f"{context.backend}: {context.renderer}, OpenGL {context.version}", err=True)
        if path.suffix.lower() == ".exr":
            return self._renderer.render(scene, camera, self.settings, self.size)
        return self._renderer.display(scene, camera, self.settings, self.size)

    def _record(self, model: str, path: Path, scene: Scene, seconds: dict[str, float]) -> dict[str, object]:
        renderer = self._renderer
        return {
            "model": model, "output": str(path), "size": list(self.size), "triangles": scene.triangle_count,
            "device": renderer.context.renderer, "backend": renderer.context.backend,
            "wall_s": seconds, "prepare_s": dict(renderer.times), "pass_ms": dict(renderer.pass_ms),
            "plan": renderer.plan.to_json(),
            "memory": {"peak_rss_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
                       "textures_mb": renderer.texture_bytes / 1e6},
        }


def output_paths(models: Sequence[str], output: str) -> list[Path]:
    """Where each model's picture goes: OUT itself, OUT with {name} filled in, or OUT/name.png in a folder."""
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
            raise UsageError(f"-o {path}: a picture ends in {', '.join(WRITABLE)}")
        if not path.parent.is_dir():
            raise OutputError(f"{path}: no folder {path.parent}")
    twice = {str(path) for path in paths if paths.count(path) > 1}
    if twice:
        raise UsageError(f"-o {output}: several models would be written to {', '.join(sorted(twice))}")
    return paths
