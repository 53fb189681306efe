"""A scene made ready to be traced: its triangles, materials and lights on the device, and the intersector."""

from __future__ import annotations

import moderngl

from ..gpu.context import Context
from ..scene.scene import Scene
from ..settings import Settings
from .geometry import trace_geometry
from .intersect import make_intersector
from .lights import SceneLights
from .plan import TracePlan, plan_trace
from .scene_data import SceneData
from .scene_words import geometry_switches
from .words import WordsBuilder


class TracedScene:
    def __init__(self, context: Context, scene: Scene, settings: Settings, intersector: str) -> None:
        self.geometry = trace_geometry(scene)
        self._scene, self._light_radius = scene, settings.light_radius
        self._data = SceneData(context, scene, self.geometry)
        self._lights = SceneLights(context, scene, self.geometry, self._data.words, settings)
        self._data.upload()
        self.switches = self._data.switches | self._lights.switches
        self.intersector = make_intersector(context, self.geometry, self._data, intersector)

    @property
    def texture_bytes(self) -> int:
        """About what the scene's textures take on the GPU."""
        return self._data.texture_bytes

    def holds(self, scene: Scene, settings: Settings) -> bool:
        return scene is self._scene and settings.light_radius == self._light_radius

    def bind(self, program: moderngl.Program) -> None:
        """Bind the textures and set the uniforms that do not depend on the picture."""
        self._data.bind(program)
        self._lights.bind(program)

    def release(self) -> None:
        self._data.release()
        self._lights.release()


def plan_without_device(scene: Scene, settings: Settings) -> TracePlan:
    """The plan of a picture without layers, before there is a context. Raises InputError as `SceneLights` does."""
    geometry = trace_geometry(scene)
    switches = geometry_switches(scene, geometry)
    switches |= SceneLights(None, scene, geometry, WordsBuilder(), settings).switches
    return plan_trace(scene, settings, geometry, switches, has_layers=settings.denoise != "off",
                      intersector="Embree where OpenGL is software, a BVH in a shader elsewhere")
