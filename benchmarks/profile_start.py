"""Where the seconds from start to PNG go: `python -m benchmarks.profile_start [MODEL] [HDR] [--rounds N]`.

Every round starts two processes in an empty home: the first finds no caches, the second those of the first.
"""

from __future__ import annotations

import argparse
import json
import math
import statistics
import sys
import tempfile
import time
from pathlib import Path

from . import process, shot
from .spans import Spans

SIZE = (512, 512)
_CHILD = "--child"
WATCHED = {
    "bake the environment": "viewer.raster.environment:bake_environment",
    "compile GLSL": "viewer.gpu.programs:compile_program",
    "decode textures": "viewer.scene.decoding:decode_levels",
    "upload textures": "viewer.raster.textures:_upload",
    "wait for textures": "viewer.raster.textures:Textures.upload",
    "upload meshes": "viewer.raster.geometry:MeshBuffers._buffer",
    "draw surfaces": "viewer.raster.surfaces:Surfaces.draw_opaque",
    "draw the background": "viewer.raster.environment:EnvironmentLight.draw_background",
    "resolve": "viewer.raster.target:Target.resolve",
    "display pass": "viewer.image.display:DisplayPass.draw",
    "read back": "viewer.raster.renderer:Renderer.read_display",
}
"""What is timed, by the function that does it, in the module that calls it."""


def main() -> None:
    if _CHILD in sys.argv:
        model, environment, picture, started = sys.argv[2:]
        print(json.dumps(profile(model, environment, Path(picture), float(started))))
        return
    options = _parse()
    runs: dict[str, list[process.Run]] = {"cold": [], "warm": []}
    for _ in range(options.rounds):
        with tempfile.TemporaryDirectory(prefix="profile-") as home:
            for several in runs.values():
                several.append(_start(*shot.inputs(options.model, options.env), Path(home)))
    print(table(runs))


def profile(model: str, environment: str, picture: Path, started: float) -> dict[str, object]:
    """Draw one picture and write it, in this process, which began at `started` (seconds of the epoch)."""
    spans = Spans()
    spans.main["start Python"] = time.time() - started
    with spans.span("import"):
        from viewer.api import load
        from viewer.gpu.context import open_context
        from viewer.image.image import Image
        from viewer.raster.renderer import Renderer
        from viewer.raster.sampled_images import decode_ahead
        from viewer.scene.camera import Camera
        from viewer.settings import Settings
    for name, place in WATCHED.items():
        spans.watch(name, place)
    with spans.span("read the model"):
        scene = load(model, environment)
    ahead = decode_ahead(scene, Settings())
    with spans.span("open the context"):
        context = open_context()
    camera = Camera.look_at(shot.eye(scene.bounds), scene.center, fov_y=math.radians(shot.FOV_Y))
    renderer = Renderer(context)
    renderer.expect(ahead)
    with spans.span("first frame, the rest"):
        renderer.draw(scene, camera, Settings(), SIZE)
        pixels = renderer.read_display(Settings())
    with spans.span("encode and write"):
        Image.from_srgb(pixels).save(picture)
    first, aside = dict(spans.main), dict(spans.aside)
    start = time.perf_counter()
    renderer.draw(scene, camera, Settings(), SIZE)
    renderer.read_display(Settings())
    return {"main": first, "aside": aside, "second_frame_s": time.perf_counter() - start,
            "renderer": f"{context.renderer}, {context.backend}"}


def table(runs: dict[str, list[process.Run]]) -> str:
    """Medians in milliseconds as Markdown; what is left of the wall time is the end of the process."""
    failed = [run["error"] for several in runs.values() for run in several if "error" in run]
    if failed:
        raise SystemExit(f"failed: {failed[0]}")
    columns = {state: _column(several) for state, several in runs.items()}
    names = list(dict.fromkeys(name for column in columns.values() for name in column))
    lines = [f"{runs['cold'][0]['renderer']}, {SIZE[0]}x{SIZE[1]}, medians of {len(runs['cold'])}, ms", "",
             "| part | " + " | ".join(columns) + " |", "|---|" + "---|" * len(columns)]
    lines += [f"| {name} | " + " | ".join(f"{column.get(name, 0.0):.0f}" for column in columns.values()) + " |"
              for name in names]
    return "\n".join(lines)


def _column(several: list[process.Run]) -> dict[str, float]:
    column: dict[str, float] = {}
    for name in dict.fromkeys(name for run in several for name in run["main"]):
        column[name] = statistics.median(run["main"].get(name, 0.0) for run in several) * 1e3
    for name in dict.fromkeys(name for run in several for name in run["aside"]):
        column[f"({name}, on other threads)"] = statistics.median(run["aside"].get(name, 0.0) for run in several) * 1e3
    column["end"] = statistics.median(run["wall_s"] - run["second_frame_s"] - sum(run["main"].values())
                                      for run in several) * 1e3
    column["whole process"] = statistics.median(run["wall_s"] - run["second_frame_s"] for run in several) * 1e3
    column["(a second frame)"] = statistics.median(run["second_frame_s"] for run in several) * 1e3
    return column


def _start(model: str, environment: str, home: Path) -> process.Run:
    picture = home / "picture.png"
    command = [sys.executable, "-m", "benchmarks.profile_start", _CHILD, model, environment, str(picture),
               repr(time.time())]
    return process.run(command, picture, SIZE, home, shot.REPOSITORY)


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.profile_start", description=__doc__)
    parser.add_argument("model", nargs="?", default=shot.default_model())
    parser.add_argument("env", nargs="?", default=shot.default_environment())
    parser.add_argument("--rounds", type=int, default=5)
    return parser.parse_args()


if __name__ == "__main__":
    main()
