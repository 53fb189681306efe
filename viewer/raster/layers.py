"""The pass that finds what surface each pixel shows at its centre, and reads it as layers for other programs.

It draws what modes pbr, phong and path show alike: the first surface, whatever light does behind it. docs/layers.md
says what each layer holds.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import moderngl
import numpy as np

from ..base.reusable import Reusable
from ..gpu.programs import matrix_uniform
from ..plan.layers import places, plan_layers
from ..plan.model import Draw, Plan
from ..scene.camera import Camera
from ..scene.frame import Frame
from ..scene.scene import Scene
from ..settings import Settings
from .curves import CurvePass, halves
from .depth import Depth
from .frame_uniforms import FrameUniforms
from .gbuffer import GBuffer
from .geometry import MeshBuffers
from .prepared import Prepared
from .stopwatch import Stopwatch

Following = tuple[Scene, Camera]
"""The scene at the next time, and its camera then."""


@dataclass(frozen=True)
class _Motion:
    """From `frame` to `next`, the same picture at the next time."""

    frame: Frame
    next: Frame

    def uniforms(self) -> dict[str, object]:
        return {"u_next_view_projection": matrix_uniform(self.next.view_projection),
                "u_to_next": matrix_uniform(self.next.model(np.linalg.inv(self.frame.model(np.eye(4))))),
                "u_half_picture": (self.frame.size[0] / 2, self.frame.size[1] / 2)}

    def of_draw(self, draw: Draw, mesh: MeshBuffers) -> dict[str, object]:
        here, there = (frame.scene.instances[draw.instance] for frame in (self.frame, self.next))
        next_mesh = self.next.scene.meshes[draw.mesh]
        stands = self.next.shows_as(self.frame) and np.array_equal(here.transform, there.transform) and (
            next_mesh is self.frame.scene.meshes[draw.mesh])
        to_mesh = mesh.follow(next_mesh)
        return {"u_next_model": matrix_uniform(self.next.model(there.transform @ to_mesh)),
                "u_moves": 0.0 if stands else 1.0}


class LayerPass:
    """Owns the targets of one picture size, and keeps the last plan."""

    def __init__(self, gl: moderngl.Context, depth: Depth, prepared: Prepared, curves: CurvePass,
                 uniforms: FrameUniforms, watch: Stopwatch) -> None:
        self._gl, self._depth, self._watch = gl, depth, watch
        self._prepared, self._curves, self._uniforms = prepared, curves, uniforms
        self._targets: Reusable[GBuffer] = Reusable()
        self._plan: tuple[tuple[object, ...], Plan] | None = None

    def find(self, frame: Frame, settings: Settings, names: Collection[str],
             following: Following | None) -> dict[str, np.ndarray]:
        """The layers `names` of what `frame` shows, each (H, W) or (H, W, channels), row 0 at the top."""
        scene, surfaces = frame.scene, self._prepared.surfaces
        with self._watch.preparing("layers"):
            self._prepared.take(scene)
            plan = self._planned(scene, settings, names, frame.camera.height is not None)
            surfaces.textures.prefetch(plan)
            surfaces.prepare(plan)
            self._curves.take(scene, settings, plan)
        place = places(names)
        count = 1 + max(place.values())
        targets = self._targets.get(lambda held: held.size == frame.size and held.count == count,
                                    lambda: GBuffer(self._gl, self._depth, frame.size, count))
        following = following or (scene, frame.camera)
        motion = _Motion(frame, Frame(*following, frame.size, frame.is_depth_reversed))
        uniforms = self._uniforms.of_view(frame) | {"u_pixel_ray": matrix_uniform(frame.ray @ frame.to_ndc),
                                                    "u_pixel_origin": matrix_uniform(frame.ray_origin @ frame.to_ndc)}
        if "motion" in names:
            uniforms |= motion.uniforms()
        if "albedo" in names:
            uniforms |= self._uniforms.of_dfg(settings, looks_up=False, stretches=plan.stretches)

        def of_draw(draw: Draw, mesh: MeshBuffers) -> dict[str, object]:
            ids = {"u_ids": halves(draw.instance + 1, draw.material + 1)}
            return ids | (motion.of_draw(draw, mesh) if "motion" in names else {})

        def draw_all() -> None:
            surfaces.draw_layers(frame, plan, uniforms, of_draw)
            if plan.curves is not None:
                self._curves.draw_layers(frame, plan.curves, settings, uniforms, motion.next)

        with self._watch.drawing("layers"), self._depth.test():
            targets.draw(draw_all)
            found = _Found(frame, targets.read(0), {name: targets.read(at) for name, at in place.items() if at})
        return {name: found.layer(name) for name in names}

    def _planned(self, scene: Scene, settings: Settings, names: Collection[str], orthographic: bool) -> Plan:
        key = (scene.layout, settings, tuple(names), orthographic)
        if self._plan is None or self._plan[0] != key:
            self._plan = key, plan_layers(scene, settings, names, orthographic)
        return self._plan[1]

    def release(self) -> None:
        self._targets.release()


@dataclass(frozen=True)
class _Found:
    frame: Frame
    positions: np.ndarray
    outputs: dict[str, np.ndarray]

    def layer(self, name: str) -> np.ndarray:
        """The layer `name`. A pixel without surface has 0, and as its depth infinity."""
        is_found = self.positions[..., 3] > 0
        if name in ("depth", "position"):
            relative = self.positions[..., :3].astype(np.float64) * self.frame.unit
            if name == "depth":
                return np.where(is_found, relative @ self.frame.camera.forward, np.inf).astype(np.float32)
            return np.where(is_found[..., None], relative + self.frame.camera.eye, 0.0)
        output, first, count = {"normal": ("OUT_NORMAL", 0, 3), "albedo": ("OUT_ALBEDO", 0, 3),
                                "uv": ("OUT_UV", 0, 2), "motion": ("OUT_UV", 2, 2),
                                "instance": ("OUT_IDS", 0, 2), "material": ("OUT_IDS", 2, 2)}[name]
        values = self.outputs[output][..., first:first + count]
        if output == "OUT_IDS":
            low, high = (values[..., k].astype(np.uint32) for k in range(2))
            return low | high << 16
        return np.ascontiguousarray(values)
