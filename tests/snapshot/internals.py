"""What the snapshot needs of the package's inside, all in one place: a refactoring that moves modules changes this."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import viewer.gpu.program
from viewer.bake.environment import bake_environment
from viewer.base.resources import resource_folder
from viewer.gpu.context import Context, create_context
from viewer.gpu.source import ProgramSource, assemble, display_name
from viewer.jobs.info import describe_scene
from viewer.plan.planner import environment_use, plan_scene
from viewer.raster.renderer import Renderer
from viewer.scene.scene import Scene
from viewer.settings import Settings
from viewer.trace.scene.traced_scene import plan_without_device
from viewer.trace.tracer import Tracer

__all__ = ["Context", "ProgramSource", "Renderer", "Tracer", "compiled", "create_context", "describe_scene",
           "display_name", "planned", "resource_folder"]


@contextmanager
def compiled() -> Iterator[list[list[ProgramSource]]]:
    """The sources of every program that is compiled meanwhile, its stages in order."""
    seen: list[list[ProgramSource]] = []
    real = viewer.gpu.program.compile_sources

    def compile_sources(context, sources, varyings=()):
        seen.append([source for source in sources.values() if source is not None])
        return real(context, sources, varyings)

    viewer.gpu.program.compile_sources = compile_sources
    try:
        yield seen
    finally:
        viewer.gpu.program.compile_sources = real


def planned(scene: Scene, settings: Settings) -> list[list[ProgramSource]]:
    """Likewise the programs that the plan names, without a device; of mode path the fragment shaders, for the passes
    choose the others."""
    if settings.mode == "path":
        return [[assemble(program.fragment, dict(program.switches))]
                for program in plan_without_device(scene, settings).programs.values()]
    is_lit, is_reflected = environment_use(scene, settings)
    suns = bake_environment(scene.environment, settings.ndf, levels=is_reflected).suns \
        if is_lit and scene.environment is not None else ()
    plan = plan_scene(scene, settings, [*scene.lights, *suns], half_target=True, orthographic=False,
                      samples=settings.samples(is_software=False, is_still=True))
    return [[assemble(file, dict(program.switches)) for file in ("raster/surface.vert", program.fragment)]
            for program in plan.programs]
