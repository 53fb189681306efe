"""What the golden images show: a scene of assets/scenes or a file of assets/curves or assets/volumes, its light and its
settings."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cache

import numpy as np

import viewer
from viewer.base.resources import resource_folder
from viewer.scene.camera import Camera
from viewer.scene.environment import Environment
from viewer.scene.equirect import texel_directions
from viewer.scene.light import Light
from viewer.scene.scene import Scene
from viewer.settings import Settings, ignored

SIZE = (112, 112)


@dataclass(frozen=True)
class Case:
    """`scene` is a name of assets/scenes, or that of a file of assets/curves or assets/volumes, with its ending.
    `environment` is "sides" (below), a built-in one or None; `lights` come to the scene's own. Without `view` the
    scene's own camera, or the default one; `view` is "inside" (among the objects), "close" (what is refracted
    lies beside the picture) or "orthographic"."""

    name: str
    scene: str
    environment: str | None = "sides"
    rotation: float = 0.0
    view: str = ""
    lights: tuple[Light, ...] = ()
    settings: dict[str, object] = field(default_factory=dict)

    def load(self) -> tuple[Scene, Camera]:
        scene = _scene(self.scene)
        environment = sides() if self.environment == "sides" else viewer_environment(self.environment)
        if environment is not None:
            environment = replace(environment, rotation=np.radians(self.rotation))
        scene = replace(scene, environment=environment, lights=scene.lights + self.lights)
        return scene, self._camera(scene)

    def _camera(self, scene: Scene) -> Camera:
        if self.view == "inside":
            return Camera.look_at((0.45, 0.5, 1.5), (-1.2, 0.45, 0.0), fov_y=np.radians(75))
        if self.view == "close":
            return Camera.look_at((-0.8, 0.8, 2.0), (-1.3, 0.5, 0.0), fov_y=np.radians(40))
        framed = Camera.framing(scene.center, scene.radius, SIZE[0] / SIZE[1])
        if self.view == "orthographic":
            return replace(framed, height=2.0 * scene.radius)
        return scene.cameras[0] if scene.cameras else framed

    def used(self, mode: str) -> dict[str, object]:
        """The case's settings that `mode` uses."""
        return {name: value for name, value in self.settings.items() if name not in ignored(mode)}

    def with_mode(self, mode: str) -> Settings:
        """These, with four samples: what "auto" chooses depends on the device."""
        settings = Settings.of(**{"mode": mode, "antialias": "msaa-4"} | self.used(mode))
        settings.check_used()
        return settings


# From behind and from the side: where masking and Fresnel's reflectance matter most.
GRAZING = (Light.from_angles(np.radians(150), np.radians(25), 4.0), Light.from_angles(np.radians(-100), 0.1, 4.0))
NEAR = Light("point", (1.0, 0.9, 0.6), 2.0, (-0.2, 0.6, 0.9), range=1.5)
# Its shadows fall on several faces of the cube.
FACES = Light("point", (1.0, 1.0, 1.0), 20.0, (0.3, 1.0, 0.4))
# A low sun on the right, nearly behind what is seen: the left of a cloud lies in its own shadow.
LOW_SUN = Light.from_angles(np.radians(140), np.radians(20), 8.0)
# From behind the ball of the scene "lights", whose shadow the beam has in fog, too.
BEAM = Light("spot", (1.0, 0.9, 0.7), 60.0, (-3.2, 1.2, -2.2), (0.63, -0.22, 0.75), inner_cone=0.2, outer_cone=0.3)

CASES = [
    # Every scene of assets/scenes, ordered by environment: a renderer keeps the last one.
    Case("spheres", "spheres"),
    Case("emissive", "emissive", settings={"exposure": -2.5, "tonemap": "aces"}),
    Case("occlusion", "occlusion", settings={"background": "none"}),
    Case("specular-ior", "specular-ior"),
    Case("anisotropy", "anisotropy"),
    Case("specular-glossiness", "specular-glossiness"),
    Case("rough-diffuse", "rough-diffuse"),
    Case("clearcoat", "clearcoat"),
    Case("translucent", "translucent"),
    Case("subsurface", "subsurface"),
    Case("sheen", "sheen"),
    Case("cloth", "cloth", settings={"weave": "denim"}),
    Case("iridescence", "iridescence"),
    Case("dispersion", "dispersion"),
    Case("dispersion-traced", "dispersion", settings={"refraction": "traced"}),
    Case("glass", "glass"),
    Case("glass-alone", "glass", view="close", settings={"background": "none"}),
    Case("glass-traced", "glass", settings={"refraction": "traced"}),
    Case("arm", "arm", rotation=40.0),
    Case("two-sided", "two-sided", rotation=130.0),
    Case("textures", "textures", settings={"tonemap": "none", "background": (0.1, 0.2, 0.05)}),
    Case("spheres-turned", "spheres", rotation=90.0, settings={"tonemap": "agx", "background": "none"}),
    Case("tiny", "tiny", view="orthographic"),
    Case("hair", "lock.hair", lights=GRAZING, settings={"hair_melanin": (0.3, 0.2)}),
    Case("knitted", "knit.bcc", lights=GRAZING, settings={"yarn": "wool"}),
    Case("interlaced", "woven.hair", settings={"yarn": "cotton"}),
    Case("spheres-beckmann", "spheres", settings={"ndf": "beckmann", "phong": "blinn-phong", "exposure": 1.0}),
    Case("environment-shadows", "lights", settings={"environment_shadows": "64", "shadows": "off"}),
    Case("alpha", "alpha", "sky"),
    Case("huge", "huge", "sky"),
    Case("lights-sun", "lights", "sky", rotation=60.0, settings={"tonemap": "agx", "exposure": -1.0}),
    Case("vertex-colors", "vertex-colors", "studio", settings={"background": "none", "tonemap": "aces"}),
    Case("unlit", "unlit", "studio", settings={"tonemap": "agx"}),
    Case("directional-diffuse", "spheres", "furnace", settings={"lobes": "directional-diffuse", "tonemap": "none"}),
    Case("spheres-lit", "spheres", None, lights=GRAZING, settings={"shadows": "off", "tonemap": "none"}),
    Case("spheres-exact", "specular-ior", None, lights=GRAZING, settings={
        "fresnel": "exact", "multiscatter": "off", "shadows": "off", "phong": "blinn-phong"}),
    Case("spheres-separable", "spheres", None, lights=GRAZING, settings={
        "masking": "smith-separable", "multiscatter": "off", "shadows": "off"}),
    Case("spheres-cavity", "spheres", None, lights=GRAZING, settings={
        "ndf": "blinn-phong", "masking": "v-cavity", "multiscatter": "off", "shadows": "off"}),
    Case("spheres-beckmann-lit", "spheres", None, lights=GRAZING, settings={
        "ndf": "beckmann", "multiscatter": "off", "shadows": "off"}),
    Case("normal-map", "normal-map", None, settings={"background": (0.0, 0.0, 0.0), "tonemap": "none"}),
    Case("rough-diffuse-lit", "rough-diffuse", None, settings={"shadows": "off"}),
    Case("translucent-lit", "translucent", None),
    Case("subsurface-slab", "subsurface", None, settings={"subsurface": "slab"}),
    Case("iridescence-lit", "iridescence", None),
    Case("lights", "lights", None, settings={"exposure": 0.5}),
    Case("lights-inside", "lights", None, view="inside", lights=(NEAR,), settings={"shadows": "off", "exposure": 1.0}),
    Case("lights-point", "lights", None, lights=(FACES,), settings={"exposure": -1.0}),
    Case("fog", "lights", None, lights=(BEAM,), settings={
        "fog": 0.08, "fog_albedo": (0.95, 0.9, 0.8), "fog_g": 0.4, "exposure": 1.0}),
    Case("cloud", "cloud.vdb", None, lights=(LOW_SUN,), settings={
        "volume_density": 0.6, "volume_albedo": (0.99, 0.97, 0.9), "volume_g": 0.6, "exposure": 0.5}),
    Case("lines-points", "lines-points", None, settings={"background": (0.2, 0.2, 0.2)}),
]


@cache
def sides() -> Environment:
    """An environment in which no direction looks like another: warm from the right, blue from the left, bright above,
    green behind the camera, and dark below. No mirrored or turned picture passes for the right one."""
    d = texel_directions(64, 128)
    pixels = np.full((64, 128, 3), 0.12) * (1.2 + d[..., 1:2])
    for towards, sharpness, color in (
        ((0.8, 0.35, 0.5), 60, (9.0, 4.0, 1.0)),
        ((-0.9, 0.1, 0.3), 25, (0.4, 1.2, 5.0)),
        ((0.1, 1.0, -0.1), 12, (2.5, 2.5, 2.5)),
        ((0.3, -0.2, 1.0), 90, (0.3, 4.0, 0.6)),
    ):
        axis = np.array(towards) / np.linalg.norm(towards)
        pixels += np.exp(sharpness * (d @ axis - 1))[..., None] * color
    return Environment("sides", pixels.astype(np.float32))


@cache
def viewer_environment(name: str | None) -> Environment | None:
    from viewer.scene.environment_files import load_environment

    return load_environment(name)


@cache
def _scene(name: str) -> Scene:
    folder = "volumes" if name.endswith(".vdb") else "curves"
    file = f"{folder}/{name}" if "." in name else f"scenes/{name}.glb"
    return viewer.load(resource_folder("assets") / file, environment=None)
