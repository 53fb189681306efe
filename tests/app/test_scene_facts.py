"""What the panel tells of a model."""

from __future__ import annotations

import numpy as np

from viewer.interact.scene_facts import scene_facts
from viewer.scene.material import Material
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Instance, Scene


def test_facts_are_words_and_numbers():
    """Whatever a reader says of a file: names, of which some are empty, counts, and images."""
    images = [{"name": "/models/chair/wood", "format": "jpeg", "width": 640, "height": 480, "bits": 8},
              {"name": "", "format": "png", "width": 2, "height": 1, "bits": 16}]
    grids = [{"name": "density", "type": "FloatGrid", "active_voxels": 1234},
             {"name": "", "type": "BoolGrid", "active_voxels": None}]
    facts = {"format": "GLB 2.0", "scenes": ["main", ""], "images": images, "textures": 0, "grids": grids}
    mesh = Mesh("m", np.eye(3, dtype=np.float32), 0)
    shown = dict(scene_facts(Scene("triangle.glb", (mesh,), (Material(),), (Instance(0, np.eye(4)),), facts=facts)))
    assert shown["Triangles"] == "1" and shown["Format"] == "GLB 2.0" and shown["Scenes"] == "main, (unnamed)"
    assert shown["Images"] == "wood, 640 × 480, jpeg\n(unnamed), 2 × 1, png"
    assert shown["Grids"] == "density, FloatGrid, 1,234 voxels\n(unnamed), BoolGrid" and shown["Volumes"] == "0"
    assert "Textures" not in shown and not any(set(text) & set("{}[]'") for text in shown.values())
