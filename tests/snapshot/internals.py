"""What the snapshot needs of the package's inside, all in one place: a refactoring that moves modules changes this."""

from __future__ import annotations

from compiled import compiled

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
