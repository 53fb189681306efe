"""What will be amiss with a picture, said before it is drawn."""

from __future__ import annotations

from ..scene.scene import Scene
from .planner import MAX_LIGHTS, is_lit


def is_dark(scene: Scene) -> bool:
    """Whether no light falls on anything and nothing shines by itself: the picture will be black."""
    if scene.environment is not None and scene.environment.intensity > 0:
        return False
    if not scene.instances or any(light.intensity * max(light.color) > 0 for light in scene.lights):
        return False
    meshes = (scene.meshes[instance.mesh] for instance in scene.instances)
    shown = ((mesh, scene.materials[mesh.material]) for mesh in meshes)
    return not any(any(material.emissive) or not is_lit(mesh, material) for mesh, material in shown)


def foreseen(scene: Scene, mode: str) -> list[str]:
    """What will be amiss with the picture, in words for the user."""
    lines = []
    if is_dark(scene):
        lines.append("nothing lights it and it does not shine: the picture will be black; try --env or --light")
    lights = sum(light.intensity * max(light.color) > 0 for light in scene.lights)
    if lights > MAX_LIGHTS and mode != "path":
        lines.append(f"of its {lights} lights the {MAX_LIGHTS} brightest are shown; mode path takes them all")
    return lines
