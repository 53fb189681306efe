"""The programs that plans ask for, without a device that compiles them."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import replace
from functools import cache

import numpy as np
from compiled import Sources

from viewer.gpu.source import ProgramSource, assemble
from viewer.plan.curves import VERTEX as CURVE_VERTEX
from viewer.plan.layers import VERTEX as LAYER_VERTEX
from viewer.plan.layers import plan_layers
from viewer.plan.planner import plan_scene
from viewer.raster.curves import ALL, BESIDE
from viewer.raster.surface_programs import (
    SHADOW_VERTEX,
    VERTEX,
    gbuffer_program,
    path_program,
    shadow_program,
    tint_program,
    vertex_of,
)
from viewer.scene.environment import Environment
from viewer.scene.light import Light
from viewer.scene.scene import Scene
from viewer.settings import Settings
from viewer.trace.defines import shader_defines
from viewer.trace.paths.passes import vertex_shader
from viewer.trace.scene.traced_scene import plan_without_device

GREY = Environment("grey", np.full((16, 32, 3), 0.5, np.float32))
SUN = Light("directional", intensity=1.0, direction=(0, -1, 0), angular_radius=0.005)

Key = tuple[str, str, tuple[tuple[str, float], ...]]
"""Vertex file, fragment file and switches of a program."""


def raster_keys(scene: Scene, settings: Settings, *, half: bool = True, orthographic: bool = False) -> Iterator[Key]:
    """Of the surfaces, with those of their shadows, their G-buffer and the paths that begin at them."""
    lights = (*scene.lights, SUN) if scene.environment is not None else scene.lights
    plan = plan_scene(scene, settings, lights, samples=settings.samples(is_software=False, is_still=True),
                      deferred=settings.defers(is_software=False, is_still=True),
                      half_target=half, orthographic=orthographic)
    if plan.ground is not None:
        yield "display/fullscreen.vert", plan.ground.fragment, plan.ground.switches
        yield "raster/ground_light.vert", "raster/ground_light.frag", ()
    if plan.media is not None:
        for program in plan.media.programs:
            yield "display/fullscreen.vert", program.fragment, program.switches
    if plan.curves is not None:
        for program in plan.curves.programs:
            for part in (*ALL, *BESIDE):
                switches = dict(program.switches) | {"ROUND": part}
                yield CURVE_VERTEX, program.fragment, tuple(sorted(switches.items()))
    for draw in plan.draws:
        yield (vertex_of(draw.program.fragment, dict(draw.program.switches)), draw.program.fragment,
               draw.program.switches)
        if plan.shadow_layer_count or plan.environment_shadows:
            shadow = shadow_program(draw)
            yield SHADOW_VERTEX, shadow.fragment, shadow.switches
        if plan.tints_sky and not draw.hides_sky:
            tint = tint_program(draw)
            yield SHADOW_VERTEX, tint.fragment, tint.switches
        if draw.is_in_gbuffer:
            gbuffer = gbuffer_program(draw.program)
            yield VERTEX, gbuffer.fragment, gbuffer.switches
        if draw.traces_refraction:
            path = path_program(draw.program, plan.has_dispersion)
            yield VERTEX, path.fragment, path.switches


def layer_keys(scene: Scene, settings: Settings, names: Collection[str], *,
               orthographic: bool = False) -> Iterator[Key]:
    """Of the pass for layers."""
    plan = plan_layers(scene, settings, names, orthographic)
    for draw in plan.draws:
        yield LAYER_VERTEX, draw.program.fragment, draw.program.switches
    for program in plan.curves.shade if plan.curves is not None else ():
        for part in (*ALL, *BESIDE):
            yield CURVE_VERTEX, program.fragment, tuple(sorted((dict(program.switches) | {"ROUND": part}).items()))


def path_keys(scene: Scene, settings: Settings, rays: int = 0) -> Iterator[Key]:
    """Of the passes over wavefronts of paths, which begin with these rays, and photons, all but intersection."""
    plan = plan_without_device(scene, settings, rays)
    for name, program in (*plan.programs.items(), *plan.photons.items()):
        defines = shader_defines(dict(program.switches))
        yield vertex_shader(name, plan.is_sorted), program.fragment, tuple(defines.items())


def keys(scene: Scene, settings: Settings) -> Iterator[Key]:
    yield from path_keys(scene, settings) if settings.mode == "path" else raster_keys(scene, settings)


def under(scene: Scene, environment: Environment | None, rotation: float = 0.0) -> Scene:
    """The scene under this environment, which is not baked for a plan."""
    return replace(scene, environment=environment and replace(environment, rotation=rotation))


def assembled(wanted: Iterable[Key]) -> list[Sources]:
    """These programs, each once."""
    return [{"vertex": _stage(vertex, switches), "fragment": _stage(fragment, switches)}
            for vertex, fragment, switches in dict.fromkeys(wanted)]


@cache
def _stage(file: str, switches: tuple[tuple[str, float], ...]) -> ProgramSource:
    return assemble(file, dict(switches))
