"""Warnings about a picture: those that can be given before it is rendered, and those that follow from its samples."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..scene.camera import Camera
from ..scene.scene import Scene
from ..scene.triangles import triangles_of
from ..scene.volume import mean_collisions, volume_medium
from ..scene.winding import winding_number
from ..settings import Settings
from .media import MAX_VOLUMES
from .planner import MAX_LIGHTS, is_lit, ordered_lights
from .shadow_layers import shadow_layers

MANY_COLLISIONS = 100.0
"""Of a path in a volume. More are worth a warning, since each takes about the time of a reflection."""


def is_dark(scene: Scene, settings: Settings) -> bool:
    """Whether the picture will be black: there is no light, no surface is emissive or unlit, and no volume emits."""
    if settings.shows_values or (scene.environment is not None and scene.environment.intensity > 0):
        return False
    if not (scene.instances or scene.volumes or scene.curves):
        return False
    if any(light.intensity * max(light.color) > 0 for light in scene.lights):
        return False
    if any(settings.volume_emission) and not _misses_emission(settings) and any(v.maximum > 0 for v in scene.volumes):
        return False
    meshes = (scene.meshes[instance.mesh] for instance in scene.instances)
    shown = ((mesh, scene.materials[mesh.material]) for mesh in meshes)
    return not any(any(material.emissive) or not is_lit(mesh, material) for mesh, material in shown)


def _misses_emission(settings: Settings) -> bool:
    """Whether mode path shows nothing of what volumes emit, for it has no collisions there."""
    return settings.mode == "path" and settings.volume_density == 0


def picture_warnings(scene: Scene, settings: Settings) -> list[str]:
    """Warnings for the user about a picture of `scene` with `settings`, one line each."""
    lines, is_traced = [], settings.mode == "path"
    if is_dark(scene, settings):
        lines.append("there is no light and nothing is emissive: the picture will be black. An environment "
                     "(--env) or a light (--light) is needed")
    lights = sum(light.intensity * max(light.color) > 0 for light in scene.lights)
    if lights > MAX_LIGHTS and not is_traced:
        lines.append(f"only the {MAX_LIGHTS} brightest of {lights} lights are shown; mode path shows them all")
    casts = bool(scene.instances or scene.curves)
    if settings.shadows == "on" and casts and not (is_traced or settings.shows_values):
        shown = ordered_lights(scene.lights)
        casting = sum(light.casts_shadow for light in shown)
        with_map = sum(layer >= 0 for layer in shadow_layers(shown, scene)[0])
        if with_map < casting:
            lines.append(f"only the {with_map} brightest of {casting} lights cast shadows; in mode path all do")
    lines += [f"volume {volume.name!r} is 0 everywhere: there is nothing to draw" for volume in scene.volumes
              if not volume.maximum]
    if is_traced:
        for volume in scene.volumes:
            count = mean_collisions(volume, volume_medium(settings))
            if count > MANY_COLLISIONS:
                lines.append(f"volume {volume.name!r} is so dense, and absorbs so little, that a path may collide "
                             f"up to {count:.0f} times in it: the picture takes long")
    for name, is_there in (("volume", bool(scene.volumes)), ("fog", settings.fog > 0)):
        if is_there and getattr(settings, f"{name}_droplets") > 0 and getattr(settings, f"{name}_g") != 0:
            lines.append(f"{name}_g has no effect together with {name}_droplets, which replaces its phase function")
    if scene.volumes and any(settings.volume_emission) and _misses_emission(settings):
        lines.append("volume_density is 0, so mode path does not show the emission of volumes: paths find it only "
                     "where they collide")
    if len(scene.volumes) > MAX_VOLUMES and not is_traced:
        lines.append(f"only the first {MAX_VOLUMES} of {len(scene.volumes)} volumes are shown; mode path shows them "
                     "all")
    if scene.curves and scene.instances and settings.mode == "pbr":
        if settings.ambient_occlusion != "off" and settings.environment_shadows == "off":
            lines.append("ambient_occlusion ignores curves; environment_shadows includes them")
        traced = [name for name, value in (("reflections", "traced"), ("refraction", "traced"), ("indirect", "baked"))
                  if getattr(settings, name) == value]
        if traced:
            lines.append(f"curves are missing from the light of {' and '.join(traced)}")
    return lines


def camera_warnings(scene: Scene, settings: Settings, camera: Camera) -> list[str]:
    """As `picture_warnings`, of where the camera is. An orthographic one is nowhere."""
    if settings.mode == "path" or camera.height is not None:
        return []
    eye, around = camera.eye, []
    for instance, corners in zip(scene.instances, scene.corners, strict=True):
        mesh = scene.meshes[instance.mesh]
        material = scene.materials[mesh.material]
        if not material.medium.scatters or (eye < corners.min(axis=0)).any() or (eye > corners.max(axis=0)).any():
            continue
        points = mesh.positions @ instance.transform[:3, :3].T + (instance.transform[:3, 3] - eye)
        if winding_number(points[triangles_of(mesh)]) > 0.5:
            around.append(f" of material {material.name!r}" if material.name else "")
    return [f"the camera is inside a solid{around[-1]} that scatters light: mode {settings.mode} does not show the "
            "medium in it; mode path does"] if around else []


NO_PHOTONS = "photons: "
"""Before the reason, in the plan of mode path, why there are none although the settings ask for them."""
DEEP_GLASS = "solids of glass lie in one another "
"""Before how many do and how many paths know of, in the plan of mode path."""
NO_TRIANGLES = " of lines or points: mode path does not show them"
"""After how many meshes, in the plan of mode path."""
TOLD_SHARE = 0.01
"""Of the photons' light: less than this that is missing is told in the statistics alone."""


def sample_warnings(stats: Mapping[str, Any]) -> list[str]:
    """Warnings that follow from `Image.stats`: of samples that mode path leaves out of the picture, and of light."""
    lines = []
    if bad := stats.get("bad_samples", 0):
        every = bad + stats["samples"]
        lines.append(f"{bad} of {every} samples are left out of the picture, because their light could not be computed")
    left_out = stats.get("plan", {}).get("left_out", ())
    lines += [f"caustics has no effect: {line.removeprefix(NO_PHOTONS)}" for line in left_out
              if line.startswith(NO_PHOTONS)]
    lines += [line for line in left_out if line.startswith(DEEP_GLASS) or line.endswith(NO_TRIANGLES)]
    if stats.get("photons") == 0:
        lines.append("the picture ended before the first photons arrived: the light of point, spot and directional "
                     "lights through smooth glass and off smooth mirrors is missing")
    return lines + lost_light(stats.get("photons_lost", 0.0))


def lost_light(share: float) -> list[str]:
    """A warning of the light of photons that the picture lacks, if the share of it is large enough."""
    if share < TOLD_SHARE:
        return []
    return [f"about {share:.0%} of the light of photons is missing from the picture: it can only be seen through "
            "smooth glass or in mirrors"]
