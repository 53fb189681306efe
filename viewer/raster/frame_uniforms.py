"""What all surfaces of a frame read: the camera, the lights and their shadow maps, the environment, the DFG table."""

from __future__ import annotations

import moderngl
import numpy as np

from ..bake.dfg import dfg_albedos, dfg_table
from ..bake.stretched import stretched_levels
from ..gpu.float_texture import float_texture
from ..gpu.free import free
from ..gpu.programs import matrix_uniform
from ..plan.model import Plan
from ..scene.depth_span import depth_span
from ..scene.frame import Frame
from ..settings import Settings
from .lights import pack_lights
from .prepared import Prepared
from .shadows import KeptShadowMaps
from .units import UNIT_DFG, UNIT_RADIANCE, UNIT_SHADOW


class FrameUniforms:
    """Owns the DFG tables and the uniform blocks of the last frame."""

    def __init__(self, gl: moderngl.Context, prepared: Prepared, shadows: KeptShadowMaps) -> None:
        self._gl, self._prepared, self._shadows = gl, prepared, shadows
        self._blocks: list[moderngl.Buffer] = []
        self._dfg: dict[tuple[str, str, bool, bool], moderngl.Texture] = {}

    def fill(self, plan: Plan, frame: Frame, settings: Settings) -> dict[str, object]:
        """The uniforms that all surfaces share; fills the uniform blocks and binds the shared textures."""
        values = self.of_view(frame)
        if settings.show == "depth":
            near, far = depth_span(frame.scene, frame.camera)
            values["u_depth_axis"] = tuple(frame.camera.forward * (frame.unit / (far - near)))
            values["u_least_depth"] = near / (far - near)
        if self._prepared.environment is not None:
            values |= self._prepared.environment.uniforms(plan)
        if plan.dfg:
            values |= self.of_dfg(settings, plan.reflections, plan.stretches)
        if plan.is_everything:  # the programs of opaque surfaces have code for glass, too
            self._prepared.surfaces.textures.bind_blank("base_color", UNIT_RADIANCE)
            values["u_backdrop"] = UNIT_RADIANCE
        blocks = [pack_lights(plan, frame)] if plan.lights else []
        shadows = self._shadows.of(plan)
        if shadows is not None:
            blocks.append(shadows.pack(frame))
            shadows.texture.use(UNIT_SHADOW)
            values |= {"u_shadow_map": UNIT_SHADOW, "u_shadow_tile_size": float(shadows.tile_size)}
        free(self._gl, *self._blocks)
        self._blocks = [self._gl.buffer(np.ascontiguousarray(block)) for block in blocks]
        for binding, block in enumerate(self._blocks):
            block.bind_to_uniform_block(binding)
        return values

    @staticmethod
    def of_view(frame: Frame) -> dict[str, object]:
        """Those of the camera alone."""
        return {
            "u_view_projection": matrix_uniform(frame.view_projection),
            "u_view_direction": tuple(-frame.camera.forward),
            "u_drawn_size": frame.size,
            "u_point_size": max(1.0, frame.size[1] / 200),
        }

    def of_dfg(self, settings: Settings, looks_up: bool, stretches: bool) -> dict[str, object]:
        """That of the DFG table, which it binds: with the lookups of an environment if there is one that is
        reflected, and with the albedos of stretched lobes if there are any."""
        key = (settings.ndf, settings.masking, looks_up, stretches)
        if key not in self._dfg:
            table = (dfg_table if looks_up else dfg_albedos)(settings.ndf, settings.masking)
            levels = stretched_levels(settings.masking) if stretches else ()
            self._dfg[key] = float_texture(self._gl, table, *levels)
        self._dfg[key].use(UNIT_DFG)
        return {"u_dfg": UNIT_DFG}

    def release(self) -> None:
        free(self._gl, *self._blocks, *self._dfg.values())
