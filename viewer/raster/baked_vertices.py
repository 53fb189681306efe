"""What is traced once for the vertices of a scene: indirect light, and how thick the solids are that scatter light."""

from __future__ import annotations

from dataclasses import replace

from ..gpu.context import Context
from ..gpu.programs import Programs
from ..plan.model import Plan
from ..scene.scene import Scene
from ..settings import Settings
from .baked_attributes import BakedAttributes
from .interiors import Interiors
from .stopwatch import Stopwatch


class BakedVertices:
    """Gives surfaces, as `attributes`, what is baked at their vertices."""

    def __init__(self, context: Context, programs: Programs, attributes: BakedAttributes, watch: Stopwatch) -> None:
        self._context, self._programs, self._attributes, self._watch = context, programs, attributes, watch
        self._interiors = Interiors(context)
        self._measured: Scene | None = None
        self._lit_by: tuple[object, ...] | None = None

    def prepare(self, scene: Scene, settings: Settings, plan: Plan) -> None:
        """Bake what `plan` needs, unless an earlier frame has left it."""
        if self._measured is not scene and (plan.has_subsurface or self._measured is not None):
            with self._watch.preparing("thickness of solids"):
                self._measure_interiors(scene, plan)
        if plan.has_indirect:
            with self._watch.preparing("indirect light"):
                self._bake_light(scene, settings, plan)

    def _measure_interiors(self, scene: Scene, plan: Plan) -> None:
        """Take the thickness of the solids that scatter light, which is measured if it has changed."""
        solids = _scattering_solids(plan)
        thickness = self._interiors.take(scene, solids)
        if thickness is not None:
            self._attributes.set_interiors(thickness)
        self._measured = scene if solids else None

    def _bake_light(self, scene: Scene, settings: Settings, plan: Plan) -> None:
        """Bake indirect light, anew under other lights."""
        from_volumes = tuple(light for light in plan.lights if light.radius > 0)
        key = (scene.lights, from_volumes, scene.environment, settings.ndf, settings.masking, settings.fresnel,
               settings.multiscatter, plan.has_subsurface)
        if self._lit_by != key or not self._attributes.has_indirect:
            from ..trace.chords import light_behind
            from ..trace.vertex_light import bake_incoming

            # Lights that stand for what volumes emit are what has come out of them.
            lit = replace(scene, lights=(*scene.lights, *from_volumes), volumes=()) if from_volumes else scene
            light = bake_incoming(self._context, lit, settings, programs=self._programs)
            solids = _scattering_solids(plan)
            self._attributes.light_vertices(light, light_behind(self._context, scene, solids, light) if solids else {})
            self._lit_by = key


def _scattering_solids(plan: Plan) -> list[int]:
    """The instances."""
    return [draw.instance for draw in plan.draws if draw.has_subsurface]
