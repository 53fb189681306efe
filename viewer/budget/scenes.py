"""The scenes a device is calibrated on, built without a file: what most models are like, small."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np

from ..measure.check.scenes import placed, plate, sphere
from ..scene.environment_files import load_environment
from ..scene.light import Light
from ..scene.material import Material, Texture
from ..scene.scene import Instance, Scene
from ..scene.texture_image import open_texture_image

CROWD, HOST = 128, 288
"""Segments around the balls of scenes of many triangles, and of very many."""


def lit_scenes() -> dict[str, list[Scene]]:
    """By the names of `viewer.budget.calibration.LIGHTINGS`: under two environments, one of them with a sun, and under
    lights alone."""
    lights = (Light.from_angles(0.7, 0.9, 3.0), Light.from_angles(-1.2, 0.5, 1.5))
    group = _group()
    return {"environment": [group.relit(environment=load_environment(name)) for name in ("studio", "sky")],
            "lights": [group.relit(lights=lights)]}


def again(scene: Scene) -> Scene:
    """The same, which nobody can tell to be that: it has to be prepared anew."""
    return replace(scene, meshes=tuple(replace(mesh) for mesh in scene.meshes))


def crowd(scene: Scene, segments: int = CROWD) -> Scene:
    """The same, of many more triangles."""
    meshes = (sphere(mesh.material, segments) if mesh.name == "sphere" else mesh for mesh in scene.meshes)
    return again(replace(scene, meshes=tuple(meshes)))


def herd(scene: Scene) -> Scene:
    """The same with many more instances, of two small triangles each."""
    stone, count = len(scene.meshes), 16
    steps = np.linspace(-3, 3, count)
    stones = tuple(Instance(stone, placed((x, -0.999, z), 0.05)) for x in steps for z in steps)
    return again(replace(scene, meshes=(*scene.meshes, plate(0)), instances=(*scene.instances, *stones)))


def mapped(scene: Scene, side: int) -> Scene:
    """The same with a map of `side` x `side` texels."""
    from PIL import Image

    file = io.BytesIO()
    ramp = np.add.outer(np.arange(side), 3 * np.arange(side))
    texels = np.stack([ramp % 251, ramp // 3 % 241, ramp // 7 % 239], axis=-1).astype(np.uint8)
    Image.fromarray(texels).save(file, "JPEG", quality=90)
    texture = Texture(open_texture_image(file.getvalue(), "calibration"))
    first, *others = scene.materials
    return again(replace(scene, materials=(replace(first, base_color_texture=texture), *others)))


def _group() -> Scene:
    """Balls that almost touch, on a floor: metal and plastic, rough and smooth, in one another's way."""
    looks = [((0.3, 0.27, 0.25), 0.0, 0.8), ((0.95, 0.75, 0.35), 1.0, 0.25), ((0.6, 0.1, 0.1), 0.0, 0.4),
             ((0.5, 0.5, 0.5), 0.0, 0.9)]
    materials = tuple(Material(base_color=(*color, 1.0), metallic=metallic, perceptual_roughness=roughness,
                               double_sided=True) for color, metallic, roughness in looks)
    floor = np.array([[1, 0, 0, 0], [0, 0, 1, -1], [0, -1, 0, 0], [0, 0, 0, 1]], float)
    balls = [placed((-2.05, 0, 0)), placed((0, 0, -0.6)), placed((2.05, 0, 0))]
    meshes = (plate(0, 3.5), *(sphere(k, 64) for k in (1, 2, 3)))
    instances = (Instance(0, floor), *(Instance(k + 1, where) for k, where in enumerate(balls)))
    return Scene("calibration", meshes, materials, instances)
