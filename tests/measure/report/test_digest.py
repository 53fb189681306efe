from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapes

from viewer.measure.report.digest import code_digest, digest
from viewer.scene.camera import Camera
from viewer.settings import Settings


def test_equal_content_has_an_equal_name_and_any_change_another():
    scene = shapes.scene(shapes.sphere(segments=8), environment=shapes.constant())
    same = shapes.scene(shapes.sphere(segments=8), environment=shapes.constant())
    assert digest(scene) == digest(same) == digest(replace(scene, name="other", warnings=("x",)))
    mesh = scene.meshes[0]
    moved = mesh.positions.copy()
    moved[3, 1] += 1e-6
    others = [replace(scene, meshes=(replace(mesh, positions=moved),)), replace(scene, environment=None),
              replace(scene, environment=replace(shapes.constant(), rotation=0.1)),
              replace(scene, environment=shapes.constant(2.0)),
              replace(scene, materials=(replace(scene.materials[0], metallic=0.5),)),
              replace(scene, materials=scene.materials * 2)]
    assert len({digest(scene), *map(digest, others)}) == 1 + len(others)


def test_settings_and_cameras_have_names_too():
    cameras = [Camera.orbit((0, 0, 0), 2.0), Camera.orbit((0, 0, 0), 2.0001)]
    assert len({digest(Settings()), digest(Settings(exposure=1)), *map(digest, cameras)}) == 4
    assert digest(np.zeros((2, 3))) != digest(np.zeros((3, 2)))
    assert code_digest() == code_digest() and len(code_digest()) == 24
