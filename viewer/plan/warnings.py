"""Warnings about a picture that can be given before it is rendered."""

from __future__ import annotations

from collections.abc import Sequence

from ..scene.scene import Scene
from .planner import MAX_LIGHTS, is_lit


def is_dark(scene: Scene) -> bool:
    """Whether the picture will be black: there is no light, and no surface is emissive or unlit."""
    if scene.environment is not None and scene.environment.intensity > 0:
        return False
    if not (scene.instances or scene.volumes) or any(light.intensity * max(light.color) > 0 for light in scene.lights):
        return False
    meshes = (scene.meshes[instance.mesh] for instance in scene.instances)
    shown = ((mesh, scene.materials[mesh.material]) for mesh in meshes)
    return not any(any(material.emissive) or not is_lit(mesh, material) for mesh, material in shown)


def picture_warnings(scene: Scene, mode: str, volume_emission: Sequence[float] = (0.0,)) -> list[str]:
    """Warnings for the user about a picture of `scene` in `mode`, one line each; volumes emit as the setting says."""
    lines = []
    if is_dark(scene) and not (scene.volumes and max(volume_emission) > 0):
        lines.append("there is no light and nothing is emissive: the picture will be black. An environment "
                     "(--env) or a light (--light) is needed")
    lights = sum(light.intensity * max(light.color) > 0 for light in scene.lights)
    if lights > MAX_LIGHTS and mode != "path":
        lines.append(f"only the {MAX_LIGHTS} brightest of {lights} lights are shown; mode path shows them all")
    return lines
