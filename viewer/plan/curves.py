"""What the raster draws curves with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ..scene.curves import Curves
from ..scene.fibre import gives_color
from ..scene.scene import Scene
from ..settings import Settings
from .bsdf_switches import bsdf_switches
from .model import Program

VERTEX = "raster/curve.vert"
POINTS_WIDTH = 4096
"""Points in a row of the texture that holds them."""
PLY_PIXELS, FIBRE_PIXELS = 8.0, 20.0
"""Widths of a yarn in pixels from which its plies are drawn, and its fibres."""
_LIT = ("HALF_TARGET", "IS_ORTHOGRAPHIC", "LIGHT_COUNT", "DIRECTIONAL_COUNT", "POINT_COUNT", "SHADOW_LAYERS",
        "SHADOW_PATTERN", "HAS_ENVIRONMENT", "ENVIRONMENT_ROTATED", "MEDIA", "FOG", "FOG_HEIGHT", "VOLUMES")


@dataclass(frozen=True)
class CurvePlan:
    """The programs of curves, with the vertex shader VERTEX. `shade` has one for each set of curves of the scene;
    `depth` is that of shadow maps, and of the pass before curves are shaded. Where segments are wide that a strip does
    not show well, two of each are drawn, with other values of ROUND (shaders/raster/curve_blunt.glsl)."""

    shade: tuple[Program, ...]
    depth: Program
    scatters_again: bool
    """Whether light that one fibre has scattered reaches others."""
    are_yarns: bool
    strands: int
    megabytes: float
    """What the points take on the GPU, without those that splines are divided by."""

    @property
    def programs(self) -> tuple[Program, ...]:
        return (*dict.fromkeys(self.shade), self.depth)


def draws_curves(scene: Scene, settings: Settings) -> bool:
    """Whether the raster draws curves of the scene."""
    shows_fibres = settings.mode == "phong" or (settings.mode == "pbr" and settings.lobes in ("all", "specular"))
    return bool(scene.curves) and shows_fibres


def has_colors(curves: Curves, settings: Settings) -> bool:
    """Whether the colours of the points count."""
    return curves.colors is not None and (curves.fibre is not None or not gives_color(settings))


def plan_curves(scene: Scene, settings: Settings, common: Mapping[str, int]) -> CurvePlan | None:
    """The plan of the curves, None where none are drawn. `common` are the switches that lit surfaces share."""
    if not draws_curves(scene, settings):
        return None
    drawn = {"POINTS_WIDTH": POINTS_WIDTH, "ROUND": 0, "YARN": int(settings.yarn != "off")}
    lit = {name: common[name] for name in _LIT} | drawn
    scatters_again = settings.mode == "pbr" and settings.hair_scattering == "multiple"
    if settings.mode == "pbr":
        fragment = "raster/yarn.frag" if drawn["YARN"] else "raster/curve.frag"
        lit |= {"REFLECTS": 1, "HAIR_LIGHT": int(scatters_again), "NEAR": drawn["YARN"]}
    else:
        fragment, shown = "raster/curve_phong.frag", bsdf_switches(settings)
        lit |= {name: shown[name] for name in ("SHOW_DIFFUSE", "SHOW_SPECULAR")}
    shade = tuple(Program.of(fragment, lit | {"HAS_COLORS": int(has_colors(curves, settings))})
                  for curves in scene.curves)
    own = 64 if drawn["YARN"] else 16
    size = sum(len(curves.points) * (own + 16 * has_colors(curves, settings)) for curves in scene.curves)
    return CurvePlan(shade, Program.of("raster/curve_depth.frag", drawn | {"HAS_COLORS": 0}),
                     scatters_again, bool(drawn["YARN"]), sum(curves.strand_count for curves in scene.curves),
                     size / 1e6)
