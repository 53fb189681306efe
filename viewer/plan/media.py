"""The passes of the raster that draw fog and volumes: their programs, and the switches of surfaces among them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ..bake.similarity import without_peak
from ..bake.volume_lights import COUNT, volume_lights
from ..scene.fog import fog_medium
from ..scene.light import Light
from ..scene.medium import Medium
from ..scene.scene import Scene
from ..scene.volume import volume_medium
from ..settings import Settings
from .model import Program
from .shadow_layers import point_lights_left

SLICES = 7
"""Slices of the media that one pass marches through: OpenGL 3.3 grants eight targets, and one carries light on."""
SLICE_COUNT = 28
SKY_LIGHTS = 32
"""Directions from which light of the environment reaches the cells of the grid."""
MAX_VOLUMES = 8
DENSE = 75.0
"""Volumes may have an optical depth above this, by `Volume.greatest_depth`: their faces are found between the points
where they are looked up."""


@dataclass(frozen=True)
class MediaPlan:
    """The programs of viewer/raster/media.py and media_light.py. `depth` is None without volumes or lights, and `glow`,
    for what volumes emit, if they scatter nothing of that. `lit` and `off_meshes`, for what meshes reflect of lights,
    are None without meshes or shadow maps."""

    march: Program
    bake: Program
    glow: Program | None
    depth: Program | None
    lit: Program | None
    off_meshes: Program | None
    scatters_again: bool
    """Whether light that has been scattered is scattered once more."""

    @property
    def has_sky_shadows(self) -> bool:
        """Whether meshes stand before the environment."""
        return self.bake["SKY_SHADOWS"] == 1

    @property
    def parts_past_meshes(self) -> int:
        """Of the texture of light in media, for each grid: what meshes do to it (shaders/raster/past_meshes.glsl)."""
        return 2 if self.has_sky_shadows else int(self.lit is not None)

    @property
    def has_fog(self) -> bool:
        return self.march["FOG"] == 1

    @property
    def volumes(self) -> int:
        """The number of volumes that are drawn."""
        return self.march["VOLUMES"]

    @property
    def programs(self) -> tuple[Program, ...]:
        every = self.march, self.bake, self.glow, self.depth, self.lit, self.off_meshes
        return tuple(program for program in every if program is not None)


def has_media(scene: Scene, settings: Settings) -> bool:
    """Whether there is fog or a volume that is drawn."""
    return not settings.shows_values and (settings.fog > 0 or bool(scene.volumes))


def media_switches(scene: Scene, settings: Settings) -> dict[str, int]:
    """The switches of surfaces: MEDIA, whether there are any between them and the eye, and which."""
    fog = settings.fog > 0
    return {"MEDIA": int(has_media(scene, settings)), "FOG": int(fog),
            "FOG_HEIGHT": int(fog and settings.fog_height > 0), "VOLUMES": min(len(scene.volumes), MAX_VOLUMES)}


def lights_of_volumes(scene: Scene, settings: Settings, count: int) -> tuple[Light, ...]:
    """At most `count` lights that stand for what volumes emit."""
    if not sends_light(scene, settings):
        return ()
    return volume_lights(scene.volumes[:MAX_VOLUMES], volume_medium(settings), count)


def most_of_volumes(settings: Settings, others: Sequence[Light]) -> int:
    """How many lights may stand for what volumes emit beside all `others`: so many as can have shadows, and one at
    least."""
    return min(max(point_lights_left(others), 1), COUNT) if settings.shadows == "on" else COUNT


def sends_light(scene: Scene, settings: Settings) -> bool:
    """Whether volumes emit light, and there is anything for it to fall on."""
    return (bool(scene.volumes) and any(settings.volume_emission) and not settings.shows_values
            and (bool(scene.instances or scene.curves) or settings.fog > 0))


def _scatters_emission(scene: Scene, settings: Settings) -> bool:
    """Whether volumes scatter what they emit."""
    return (bool(scene.volumes) and any(settings.volume_emission) and volume_medium(settings).scatters
            and settings.media_scattering == "multiple")


def plan_media(scene: Scene, settings: Settings, common: Mapping[str, int], from_volumes: int) -> MediaPlan | None:
    """The plan of the media, None without any. `common` are the switches that all lit surfaces have in common, and
    the last `from_volumes` of the point lights stand for what volumes emit."""
    switches = media_switches(scene, settings)
    if not switches["MEDIA"]:
        return None
    names = ("LIGHT_COUNT", "DIRECTIONAL_COUNT", "POINT_COUNT", "SHADOW_LAYERS", "HAS_ENVIRONMENT",
             "ENVIRONMENT_ROTATED")
    lights = {name: common[name] for name in names}
    lit = switches | lights | {"SHADOW_PATTERN": 0, "REFLECTS": 0}
    has_meshes = hides_light(scene, settings)
    lit["SKY_SHADOWS"] = int(common["HAS_ENVIRONMENT"] and has_meshes)
    lit["LIT_MESHES"] = int(common["SHADOW_LAYERS"] > 0 and has_meshes)
    extinction = travelled(volume_medium(settings), settings).sigma_t[0]
    lit["VOLUME_LIGHTS"] = from_volumes
    lit["DENSE"] = int(any(extinction * volume.greatest_depth > DENSE for volume in scene.volumes[:MAX_VOLUMES]))
    has_depth = switches["VOLUMES"] and common["LIGHT_COUNT"]
    droplets = any(medium.droplet_diameter > 0 for medium, is_there in (
        (fog_medium(settings), switches["FOG"]), (volume_medium(settings), switches["VOLUMES"])) if is_there)
    towards_lights = switches | lights | {"VOLUME_LIGHTS": from_volumes}
    emits = _scatters_emission(scene, settings)
    march, bake = {"SLICES": SLICES, "HAS_DROPLETS": int(droplets), "EMITS": int(emits)}, {"SKY_LIGHTS": SKY_LIGHTS}
    return MediaPlan(Program.of("raster/media_march.frag", lit | march),
                     Program.of("raster/media_bake.frag", lit | bake),
                     Program.of("raster/media_bake.frag", lit | bake | {"FOG": 0, "FOG_HEIGHT": 0}) if emits else None,
                     Program.of("raster/volume_depth.frag", towards_lights) if has_depth else None,
                     Program.of("raster/lit_patches.frag", lit) if lit["LIT_MESHES"] else None,
                     Program.of("raster/media_off_meshes.frag", lit) if lit["LIT_MESHES"] else None,
                     settings.media_scattering == "multiple")


def travelled(medium: Medium, settings: Settings) -> Medium:
    """The medium that light is taken to travel in."""
    return without_peak(medium) if settings.media_scattering == "multiple" else medium


def hides_light(scene: Scene, settings: Settings) -> bool:
    """Whether anything stands before the environment that no light passes."""
    meshes = [scene.meshes[k] for k in {instance.mesh for instance in scene.instances}]
    return bool(scene.curves) or any(
        mesh.topology == "triangles" and not (settings.mode == "pbr" and scene.materials[mesh.material].is_seen_through)
        for mesh in meshes)
