"""What the first picture of a process costs on top of what it costs later: measured in a process of its own.

    python -m viewer.budget.start BACKEND

prints a line of JSON, seconds by `raster` and `path`.
"""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace

TIMEOUT_S = 120.0


def measure_start(backend: str) -> dict[str, float]:
    """By the second of two processes: what the driver keeps on disk the first has put there."""
    found = {"raster": 0.0, "path": 0.0}
    for _ in range(2):
        command = [sys.executable, "-m", "viewer.budget.start", backend]
        try:
            done = subprocess.run(command, capture_output=True, timeout=TIMEOUT_S, check=True, text=True)
            found = json.loads(done.stdout)
        except (OSError, subprocess.SubprocessError, ValueError):
            return found
    return found


def _measured(backend: str) -> dict[str, float]:
    from ..gpu.context import open_context
    from ..scene.camera import Camera
    from .scenes import lit_scenes

    scene = lit_scenes()["environment"][0]
    camera = Camera.framing(scene.center, scene.radius, 1.0)
    context = open_context(backend)

    def raster() -> None:
        from ..raster.renderer import Renderer
        from ..settings import Settings

        renderer = Renderer(context)
        renderer.render(scene, camera, Settings(), (16, 16))
        renderer.release()

    def path() -> None:
        from ..settings import Settings
        from ..trace.tracer import Tracer

        tracer = Tracer(context)
        tracer.render(scene, camera, replace(Settings(), mode="path", spp=1, denoise="fast"), (16, 16))
        tracer.release()

    return {"raster": _on_top(raster), "path": _on_top(path)}


def _on_top(run: Callable[[], None]) -> float:
    seconds = []
    for _ in range(2):
        started = time.perf_counter()
        run()
        seconds.append(time.perf_counter() - started)
    return max(seconds[0] - seconds[1], 0.0)


if __name__ == "__main__":
    print(json.dumps(_measured(sys.argv[1])))
