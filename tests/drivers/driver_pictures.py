"""Small pictures that between them run every pass of both renderers, for any driver to draw."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
for _folder in (TESTS.parent, TESTS, TESTS / "golden"):
    sys.path.insert(0, str(_folder))

from cases import CASES, Case  # noqa: E402
from path_cases import CASES as PATH_CASES  # noqa: E402

from viewer.gpu.context import Context  # noqa: E402
from viewer.image.image import Image  # noqa: E402
from viewer.raster.renderer import Renderer  # noqa: E402
from viewer.trace.tracer import Tracer  # noqa: E402

SIZE, PATH_SIZE = (64, 64), (32, 32)
MULTISAMPLED = "multisampled"

Draw = Callable[[Context], Image]


@dataclass(frozen=True)
class Picture:
    """`draw` makes it with a context. One that is `is_multisampled` needs a driver that multisamples."""

    name: str
    draw: Draw
    is_multisampled: bool = False


_MORE = {
    "every pass": Case("every pass", "lights", settings={
        "reflections": "traced", "ambient_occlusion": "gtao", "antialias": "ssaa-4", "tonemap": "agx",
        "specular_aa": "on"}),
    MULTISAMPLED: Case(MULTISAMPLED, "alpha", settings={"tonemap": "aces"}),
}
_RASTER = (("spheres", "pbr"), ("lights", "pbr"), ("lights", "phong"), ("glass", "pbr"), ("glass-traced", "pbr"),
           ("textures", "pbr"), ("environment-shadows", "pbr"), ("anisotropy", "pbr"), ("lines-points", "pbr"),
           ("normal-map", "phong"), ("tiny", "pbr"), ("every pass", "pbr"), (MULTISAMPLED, "pbr"))
_PATH = (("maps", "embree"), ("brushed", "embree"), ("glass-absorbing", "embree"), ("alpha", "embree"),
         ("emitters", "embree"), ("maps", "bvh"), ("alpha", "bvh"))


def _raster(case: Case, mode: str) -> Draw:
    def draw(context: Context) -> Image:
        settings = case.with_mode(mode)
        if settings.antialias == "msaa-4" and case.name != MULTISAMPLED:
            settings = replace(settings, antialias="none")
        renderer = Renderer(context)
        try:
            return renderer.render(*case.load(), settings, SIZE)
        finally:
            renderer.release()

    return draw


def _path(name: str, intersector: str) -> Draw:
    def draw(context: Context) -> Image:
        case = next(case for case in PATH_CASES if case.name == name)
        denoise = "fast" if name == "emitters" else "off"
        tracer = Tracer(context, intersector=intersector)
        try:
            return tracer.render(*case.make(), replace(case.with_seed(0), spp=4, denoise=denoise), PATH_SIZE)
        finally:
            tracer.release()

    return draw


PICTURES = [
    *(Picture(f"{name}, {mode}", _raster(_MORE.get(name) or next(case for case in CASES if case.name == name), mode),
              name == MULTISAMPLED) for name, mode in _RASTER),
    *(Picture(f"{name}, path, {intersector}", _path(name, intersector)) for name, intersector in _PATH),
]
