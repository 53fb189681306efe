"""What the path tracer is timed on: one shape in a thousand to a million triangles, and models of the corpus."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import viewer
from viewer.scene.camera import Camera
from viewer.scene.environment_presets import make_preset
from viewer.scene.material import Material
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Instance, Scene

from . import truth_cases
from .shot import REPOSITORY

_CORPUS = REPOSITORY.parent / "shared" / "corpus" / "models"
MODELS = {"DamagedHelmet": "DamagedHelmet/DamagedHelmet.gltf", "FlightHelmet": "FlightHelmet/FlightHelmet.gltf",
          "MetalRoughSpheres": "MetalRoughSpheresNoTextures/MetalRoughSpheresNoTextures.glb"}
SOLVED = "cornell-box", "glass-smooth"
"""Those of `truth_cases`."""
HILLS = (1_000, 32_000, 1_000_000)


def scenes() -> dict[str, tuple[Scene, Camera]]:
    """Hills of each triangle count, those of the models that are there, framed under the studio, and solved scenes."""
    found = {f"hills {count:,}": hills(count) for count in HILLS}
    for name, path in MODELS.items():
        if (_CORPUS / path).is_file():
            scene = viewer.load(_CORPUS / path)
            found[name] = scene, Camera.framing(scene.center, scene.radius, 1.0)
    for name in SOLVED:
        if (truth_cases.FOLDER / name).is_dir():
            case = truth_cases.load_case(name)
            found[name] = case.scene, case.camera
    return found


def hills(triangles: int) -> tuple[Scene, Camera]:
    """A grey height field of three octaves of waves, which a thousand triangles show as well as a million."""
    side = int(np.sqrt(triangles / 2)) + 1
    x, z = np.meshgrid(np.linspace(-1, 1, side), np.linspace(-1, 1, side))
    y, rng = np.zeros_like(x), np.random.default_rng(3)
    for octave in range(3):
        turn, phase = rng.uniform(0, 2 * np.pi, 2)
        frequency = 3 * 1.9**octave
        along = frequency * (x * np.cos(turn) + z * np.sin(turn))
        across = frequency * (z * np.cos(turn) - x * np.sin(turn))
        y += 0.3 * 0.55**octave * np.sin(along + phase + np.sin(1.3 * across))
    positions = np.stack([x, y, z], -1).reshape(-1, 3).astype(np.float32)
    corner = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
    quads = np.stack([corner, corner + side, corner + 1, corner + 1, corner + side, corner + side + 1], -1)
    slope_z, slope_x = np.gradient(y, 2 / (side - 1))
    normals = np.stack([-slope_x, np.ones_like(y), -slope_z], -1).reshape(-1, 3)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    mesh = Mesh("hills", positions, 0, indices=quads.astype(np.uint32).ravel(), normals=normals.astype(np.float32))
    grey = Material(base_color=(0.6, 0.6, 0.6, 1.0), metallic=0.0, perceptual_roughness=1.0, specular=0.0)
    scene = Scene("hills", (mesh,), (replace(grey, double_sided=True),), (Instance(0, np.eye(4)),),
                  environment=make_preset("studio"))
    return scene, Camera.look_at((0.0, 1.6, 2.0), (0, -0.1, 0.15), fov_y=np.radians(45))
