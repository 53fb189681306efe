"""What a device takes, measured in processes of their own: there nothing is compiled or loaded yet.

    python -m viewer.budget.start BACKEND methods
    python -m viewer.budget.start BACKEND start

print a line of JSON: a calibration that lacks what the other tells; and that, seconds by `raster` and `path`, and how
long the first program takes.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from typing import Any

from ..gpu.context import Context, open_context
from .calibration import Calibration
from .contention import quiet_seconds

TIMEOUT_S = 600.0
_SHADER_CACHES = ("MESA_SHADER_CACHE_DIR", "__GL_SHADER_DISK_CACHE_PATH")
"""Where drivers keep what they have compiled: Mesa, NVIDIA."""


def measure(context: Context) -> Calibration:
    """Of the device of `context`. Begins with a shader cache that is empty, where the driver lets others name it."""
    with tempfile.TemporaryDirectory(prefix="pbr-viewer-", ignore_cleanup_errors=True) as folder:
        environment = os.environ | dict.fromkeys(_SHADER_CACHES, folder)
        try:
            calibration = Calibration.from_json(_run(context.backend, "methods", environment))
            start = _run(context.backend, "start", environment)
        except (OSError, subprocess.SubprocessError, ValueError, KeyError, TypeError):
            from .calibrate import calibrate

            return calibrate(context)  # a program without an interpreter to start
    return replace(calibration, start=start["start"],
                   first_program=(calibration.first_program[0], start["first_program"]))


def first_program(context: Context) -> float:
    """Seconds of the display pass on one pixel, which every picture needs: of its kind a process's first."""
    from ..gpu.programs import Programs
    from ..image.display import DisplayPass
    from ..settings import Settings

    context.make_current()
    programs = Programs(context)
    display, texture = DisplayPass(context.gl, programs), context.gl.texture((1, 1), 4, dtype="f4")

    def draw() -> None:
        target = display.target((1, 1))
        display.draw(texture, Settings(), target, 0)
        target.read(components=4)

    seconds = quiet_seconds(draw)
    for thing in (display, texture, programs):
        thing.release()
    return seconds


def _run(backend: str, part: str, environment: dict[str, str]) -> dict[str, Any]:
    command = [sys.executable, "-m", "viewer.budget.start", backend, part]
    done = subprocess.run(command, capture_output=True, timeout=TIMEOUT_S, check=True, text=True, env=environment)
    return json.loads(done.stdout)


def _methods(context: Context) -> dict[str, Any]:
    new = first_program(context)
    from .calibrate import calibrate

    return replace(calibrate(context), first_program=(new, new)).to_json()


def _start(context: Context) -> dict[str, Any]:
    from ..scene.camera import Camera
    from .scenes import lit_scenes

    scene = lit_scenes()["environment"][0]
    camera = Camera.framing(scene.center, scene.radius, 1.0)
    first = first_program(context)

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

    return {"start": {"raster": _on_top(raster), "path": _on_top(path)}, "first_program": first}


def _on_top(run: Callable[[], None]) -> float:
    first, second = (quiet_seconds(run) for _ in range(2))
    return max(first - second, 0.0)


def _end_with(parent: int) -> None:
    """Measure no further for a process that was killed."""
    while os.getppid() == parent:
        time.sleep(1.0)
    os._exit(1)


if __name__ == "__main__":
    threading.Thread(target=_end_with, args=(os.getppid(),), daemon=True).start()
    with suppress(KeyboardInterrupt):  # whoever waits for this hears of it, too
        print(json.dumps({"methods": _methods, "start": _start}[sys.argv[2]](open_context(sys.argv[1]))))
