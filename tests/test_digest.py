"""Names of what a result depends on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapes

from viewer.base.digest import code_digest, digest, files_digest
from viewer.scene.camera import Camera
from viewer.scene.environment import Environment
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


def test_an_environment_whose_file_is_known_is_not_decoded():
    def decode() -> np.ndarray:
        raise AssertionError("the file was decoded")

    first, second = (Environment("studio", decode, digest=name) for name in ("a", "b"))
    assert digest(first) != digest(second) and digest(first) == digest(replace(first, name="other"))


def test_files_are_known_by_name_and_content(tmp_path):
    one, other = tmp_path / "one.py", tmp_path / "other.py"
    one.write_text("x = 1")
    other.write_text("x = 1")
    before = files_digest([one])
    assert before == files_digest([one]) != files_digest([other])
    one.write_text("x = 2")
    assert files_digest([one]) != before
