"""Scenes of one triangle, and plans of them, for the tests of plans."""

from __future__ import annotations

import numpy as np

from benchmarks.shader_code import lines_left
from viewer.plan.planner import plan_scene
from viewer.scene.environment import Environment
from viewer.scene.light import Light
from viewer.scene.material import Material, Texture
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Instance, Scene
from viewer.scene.texture_image import TextureImage
from viewer.scene.volume import Volume
from viewer.settings import Settings

ENVIRONMENT = Environment("grey", np.ones((16, 32, 3), np.float32))
SUN = Light.from_angles(0.0, 0.5, 1.0)
MAP = Texture(TextureImage("none", b"", 16, 16, "PNG"))  # never decoded: nothing is drawn here
BOX = Volume.in_box(np.ones((2, 2, 2), np.float32), [[0, 0, 0], [1, 1, 1]])
PLAIN = Material()


def scene(material: Material = PLAIN, *, topology: str = "triangles", tangents: bool = True, uvs: int = 1,
          colors: bool = False, lit: bool = True, **fields) -> Scene:
    corner = np.float32([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    mesh = Mesh("mesh", corner, 0, topology, normals=np.float32([[0, 0, 1]] * 3) if lit else None,
                tangents=np.float32([[1, 0, 0, 1]] * 3) if tangents else None, uvs=(corner[:, :2],) * uvs,
                colors=np.ones((3, 4), np.float32) if colors else None)
    return Scene("test", (mesh,), (material,), (Instance(0, np.eye(4)),), **fields)


def plan(model: Scene, *, samples: int = 4, half: bool = True, orthographic: bool = False, **settings):
    return plan_scene(model, Settings.of(**settings), model.lights, samples=samples, half_target=half,
                      orthographic=orthographic)


def code(found) -> str:
    """The fragment shader as the compiler sees it: what the switches leave of it."""
    program = found.programs[0]
    return "\n".join(lines_left(program.fragment, dict(program.switches)))
