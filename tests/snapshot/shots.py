"""The path-traced pictures of a snapshot: what materials, lights and settings a path can meet, in few pixels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache

import features
from cases import sides
from internals import resource_folder
from shapes import facing_floor, moved, orthographic, plate, scene, sphere

import viewer
from viewer.scene.camera import Camera
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.scene import Scene
from viewer.settings import Settings

SIZE = (64, 64)


@dataclass(frozen=True)
class Shot:
    name: str
    make: Callable[[], tuple[Scene, Camera]]
    settings: dict[str, object] = field(default_factory=dict)
    layers: tuple[str, ...] = ()

    def with_mode(self) -> Settings:
        return Settings.of(**{"mode": "path", "spp": 4, "seed": 0} | self.settings)


SUN = Light.from_angles(0.5, 0.7, 2.0)
LAYERS = ("albedo", "normal", "distance", "variance", "samples")


def asset(name: str, *lights: Light, is_lit: bool = True) -> Callable[[], tuple[Scene, Camera]]:
    """A model of `assets`, `scenes/glass` for instance, under the goldens' environment or none."""
    def make() -> tuple[Scene, Camera]:
        model = _load(name)
        model = model.relit(environment=sides() if is_lit else None, lights=(*model.lights, *lights))
        return model, model.cameras[0] if model.cameras else Camera.framing(model.center, model.radius, 1.0)

    return make


@cache
def _load(name: str) -> Scene:
    return viewer.load(resource_folder("assets") / f"{name}.glb", environment=None)


def glasses() -> tuple[Scene, Camera]:
    """Three solid balls of glass, clear, rough, and one that absorbs, and a thin rough pane, over a floor in the sun
    and under a lamp that shines."""
    solid = {"metallic": 0.0, "transmission": 1.0, "thickness": 1.0}
    materials = [
        Material(base_color=(0.6, 0.6, 0.6, 1), metallic=0.0, perceptual_roughness=0.8),
        Material(perceptual_roughness=0.0, **solid),
        Material(perceptual_roughness=0.4, ior=1.33, base_color=(0.9, 0.95, 0.8, 1), **solid),
        Material(perceptual_roughness=0.1, attenuation_distance=0.5, attenuation_color=(0.9, 0.3, 0.2), **solid),
        Material(perceptual_roughness=0.3, double_sided=True, **(solid | {"thickness": 0.0})),
        Material(base_color=(0, 0, 0, 1), metallic=0.0, emissive=(8.0, 7.0, 5.0)),
    ]
    balls = [(sphere(1 + k, 32), moved((-1.1 + 1.1 * k, 0.0, 0.0), 0.5)) for k in range(3)]
    lamp = facing_floor(0.4, y=1.6)
    lamp[:3, 1:3] *= -1  # it faces down
    model = scene((plate(0, 4.0), facing_floor(y=-0.5)), *balls, (plate(4, 0.5), moved((0.5, 0.2, 0.9))),
                  (plate(5), lamp), materials=materials, lights=(SUN,), environment=sides())
    return model, replace(orthographic(0.3, 0.25, height=3.4), name="glasses")


SHOTS = [
    Shot("spheres", asset("scenes/spheres", SUN)),
    Shot("spheres beckmann exact", asset("scenes/spheres", SUN), {
        "ndf": "beckmann", "masking": "smith-separable", "fresnel": "exact", "background": "none"}),
    Shot("glass", asset("scenes/glass", SUN)),
    Shot("glasses", glasses, layers=LAYERS),
    Shot("glasses denoised", glasses, {"denoise": "fast"}),
    Shot("alpha", asset("scenes/alpha", SUN), layers=LAYERS),
    Shot("emissive", asset("scenes/emissive", is_lit=False)),
    Shot("lights", asset("scenes/lights", is_lit=False)),
    Shot("lights of a radius", asset("scenes/lights", is_lit=False), {"light_radius": 0.2, "clamp": 2.0}),
    Shot("normal map", asset("scenes/normal-map")),
    Shot("textures", asset("scenes/textures")),
    Shot("vertex colours", asset("scenes/vertex-colors")),
    Shot("unlit", asset("scenes/unlit")),
    Shot("two-sided", asset("scenes/two-sided")),
    Shot("specular and ior", asset("scenes/specular-ior"), {"background": (0.1, 0.2, 0.3)}),
    Shot("specular, everything compiled in", asset("scenes/specular-ior"), {"plan": "everything"}),
    Shot("small lights", asset("noise/small-lights", is_lit=False)),
    Shot("small lights by bsdf", asset("noise/small-lights", is_lit=False), {"sampling": "bsdf"}),
    Shot("many lights", asset("noise/many-lights", is_lit=False), {"sampling": "lights"}),
    Shot("caustics", asset("noise/caustics", is_lit=False)),
    Shot("demo", asset("demo")),
    Shot("window", features.window(0.4)),
    Shot("hollow ball", features.hollow_ball),
    Shot("pane", features.pane),
]
