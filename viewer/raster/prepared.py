"""A scene on the GPU: its environment, its surfaces, and the plans by which it is drawn."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ..gpu.context import Context
from ..gpu.free import free
from ..gpu.programs import Programs
from ..plan.media import has_media, lights_of_volumes, most_of_volumes, sends_light
from ..plan.model import Plan
from ..plan.planner import environment_use, plan_scene
from ..scene.decoding import Decoder
from ..scene.environment import Environment
from ..scene.light import Light
from ..scene.scene import Scene
from ..scene.texture_image import TextureImage
from ..scene.volume import volume_medium
from ..settings import Settings
from .environment import EnvironmentLight
from .stopwatch import Stopwatch
from .surfaces import Surfaces
from .target import Target

_KEPT = 2
"""How many plans are kept: a window that is split between two modes draws with two in turn."""
_BLACK = Environment("black", np.zeros((512, 1024, 3), np.float32))


class Prepared:
    """The scene drawn last, and what drawing it takes whatever passes there are. It keeps what the next one shares."""

    def __init__(self, context: Context, programs: Programs, watch: Stopwatch, use_cache: bool) -> None:
        self._context, self._gl, self._programs, self._watch = context, context.gl, programs, watch
        self.use_cache = use_cache
        self.surfaces = Surfaces(context, programs)
        self.environment: EnvironmentLight | None = None
        self._from_volumes: tuple[object, tuple[Light, ...]] = (None, ())
        self.generation = 0
        """How often programs, or a scene of another layout, have made useless what was drawn with those before."""
        self._programs_generation = programs.generation
        self._ahead: Decoder | None = None
        self._plans: list[tuple[tuple[object, ...], Plan]] = []

    def expect(self, ahead: Decoder) -> None:
        """Take a decoder that has begun with the images of the next scene."""
        if self._ahead is not None:
            self._ahead.cancel()
        self._ahead = ahead

    def holds(self, scene: Scene) -> bool:
        """Whether this is the scene of the last frame, perhaps under other lights."""
        return self.surfaces.scene.has_surfaces_of(scene)

    def prepare(self, scene: Scene, settings: Settings, target: Target, orthographic: bool, deferred: bool) -> Plan:
        """Upload the scene and compile its programs, unless an earlier frame has left them. Returns the plan."""
        with self._watch.preparing("environment"):
            self._prepare_environment(scene, settings)
        self.take(scene)
        background = settings.background if settings.background == "env" else "none"
        shading = replace(settings, exposure=0.0, tonemap="none", background=background)
        shape = scene if settings.indirect == "baked" else None  # which is left out of what is convex
        volumes = scene.volumes if sends_light(scene, settings) else None
        key = (scene.layout, scene.lights, scene.environment, volumes, shape, shading, target.samples, target.half,
               orthographic, deferred)
        return next((plan for k, plan in self._plans if k == key), None) or self._make_plan(scene, key)

    def _prepare_environment(self, scene: Scene, settings: Settings) -> None:
        environment = scene.environment or (_BLACK if settings.plan == "everything" else None)
        if environment is None:
            free(self._gl, self.environment)
            self.environment = None
        elif self.environment is None or not self.environment.holds(environment, settings):
            free(self._gl, self.environment)
            self.environment = None  # should the next one fail
            self._plans = []  # what they need of the environment is baked when they are made
            self.environment = EnvironmentLight(self._context, environment, settings, self.use_cache)
        if self.environment is not None:
            self.environment.environment = environment

    def take(self, scene: Scene) -> None:
        """Take what is drawn. A pose of the scene before keeps its plan, and maps that are drawn anew."""
        is_alike = self._programs_generation == self._programs.generation
        if not self.holds(scene):
            is_alike &= scene.layout == self.surfaces.scene.layout
            self.surfaces.take(scene, self._ahead)
            self._ahead = None
        if not is_alike:
            self.generation += 1
            self._programs_generation, self._plans = self._programs.generation, []
        self.surfaces.scene = scene

    def _make_plan(self, scene: Scene, key: tuple[Any, ...]) -> Plan:
        settings, samples, half, orthographic, deferred = key[-5:]
        is_lit, is_reflected = environment_use(scene, settings)
        if is_lit:
            with self._watch.preparing("environment"):
                self.environment.bake(is_reflected or (settings.mode == "pbr" and has_media(scene, settings)))
        lights, textures = self._lights(scene, settings), self.surfaces.textures
        known: frozenset[TextureImage] | None = None
        while known != textures.grooved:  # which maps have grooves is known when they are decoded
            known = textures.grooved
            plan = plan_scene(scene, settings, lights, samples=samples, half_target=half, orthographic=orthographic,
                              deferred=deferred, grooved=known)
            textures.prefetch(plan)
            with self._watch.preparing("compile and upload"):
                self.surfaces.prepare(plan)
        self._plans = [(key, plan), *self._plans][:_KEPT]
        return plan

    def _lights(self, scene: Scene, settings: Settings) -> list[Light]:
        from_environment = self.environment.lights(settings) if self.environment is not None else []
        others = [*scene.lights, *from_environment]
        count = most_of_volumes(settings, others)
        key = (scene.volumes, volume_medium(settings), sends_light(scene, settings), count)
        if self._from_volumes[0] != key:
            self._from_volumes = key, lights_of_volumes(scene, settings, count)
        return [*others, *self._from_volumes[1]]

    def release(self) -> None:
        free(self._gl, self.surfaces, self.environment)
