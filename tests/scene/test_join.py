"""Scenes that are joined into one."""

from __future__ import annotations

import json

import numpy as np
import pytest
from click.testing import CliRunner
from gltf_builder import GltfBuilder
from shapes import WHITE, moved, plate, scene, sphere
from test_gltf_variants import BOTH, varied
from test_pose import family
from test_volume_files import vol

import viewer
from viewer.cli import cli
from viewer.errors import InputError, UsageError
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.scene import Scene
from viewer.scene.volume import Volume

RED = Material(base_color=(1.0, 0.0, 0.0, 1.0))
SMOKE = Scene("smoke", volumes=(Volume.in_box(np.ones((2, 3, 4)), [[5, 5, 5], [6, 7, 8]]),), warnings=("thin",),
              facts={"format": "VOL", "grids": [{"name": "density"}]})


def pair() -> Scene:
    one = scene(sphere(segments=12), (plate(1), moved((0, 3, 0))), materials=(WHITE, RED), lights=(Light("point"),))
    two = scene((plate(1), moved((0, -4, 0))), materials=(WHITE, RED), lights=(Light("spot"),))
    return viewer.join(one, two, SMOKE)


def test_what_belongs_together_stays_together():
    joined = pair()
    assert [joined.materials[joined.meshes[i.mesh].material] for i in joined.instances] == [WHITE, RED, RED]
    assert [i.transform[1, 3] for i in joined.instances] == [0, 3, -4]
    assert [light.kind for light in joined.lights] == ["point", "spot"]
    assert joined.volumes == SMOKE.volumes and joined.name == "test" and joined.warnings == ("smoke: thin",)
    np.testing.assert_allclose(joined.bounds, [[-1, -5, -1], [6, 7, 8]], atol=0.05)
    assert joined.facts == {"grids": [{"name": "density"}], "with": ["test", "smoke"]}


def test_a_model_in_a_volume_and_a_volume_in_a_model_are_the_same():
    ball = scene(sphere(segments=12))
    one, two = viewer.join(ball, SMOKE), viewer.join(SMOKE, ball)
    np.testing.assert_array_equal(one.bounds, two.bounds)
    assert one.volumes == two.volumes and one.instances[0].transform.tolist() == two.instances[0].transform.tolist()


def test_what_is_joined_stands_still_while_the_model_moves():
    mover = family()
    still = scene((sphere(segments=12), moved((1, 2, 3))), lights=(Light("point", position=(7, 8, 9)),))
    alone, joined = mover.at(1), viewer.join(mover, still).at(1)
    count = len(mover.instances)
    assert any((a.transform != b.transform).any() for a, b in zip(alone.instances, mover.instances))
    for a, b in zip(alone.instances, joined.instances):
        np.testing.assert_array_equal(a.transform, b.transform)
    assert [i.transform.tolist() for i in joined.instances[count:]] == [moved((1, 2, 3)).tolist()]
    assert joined.lights[-1].position == (7, 8, 9)


def test_animations_of_what_is_joined_are_not_played_and_that_is_said():
    joined = viewer.join(scene(plate()), family())
    assert joined.at(1) is joined
    assert joined.warnings == (f"{family().name}: its animations are not played; only those of test are",)


def test_variants_are_those_of_the_model():
    model = varied(*BOTH).load()
    name = model.variants[1].name
    joined = viewer.join(model, scene(plate(), materials=(RED,)))
    chosen = joined.with_variant(name)
    assert chosen.materials == (*model.with_variant(name).materials, RED)
    assert joined.materials == (*model.materials, RED)


def test_only_scenes_are_joined():
    with pytest.raises(UsageError, match="scene"):
        viewer.join(scene(plate()), "smoke.vdb")


def written(tmp_path) -> tuple[str, str]:
    builder = GltfBuilder()
    builder.node(mesh=builder.triangle(), translation=[9, 0, 0])
    (tmp_path / "model.glb").write_bytes(builder.glb())
    return str(tmp_path / "model.glb"), str(vol(tmp_path / "cloud.vol"))


def test_with_on_the_command_line(tmp_path):
    model, cloud = written(tmp_path)
    for first, second in ((model, cloud), (cloud, model)):
        result = CliRunner().invoke(cli, ["info", first, "--with", second, "--json", "-"], catch_exceptions=False)
        told = json.loads(result.stdout)
        assert len(told["grids"]) == told["instances"] == 1 and told["bounds_m"][1][0] == 10
    picture = tmp_path / "out.png"
    words = ["render", model, "--with", cloud, "--with", model, "-o", str(picture), "--size", "16"]
    ran = CliRunner().invoke(cli, words)
    assert ran.exit_code == 0 and picture.exists()


def test_a_file_that_cannot_be_joined_is_named(tmp_path):
    model, _ = written(tmp_path)
    (tmp_path / "bad.vol").write_bytes(b"VOL")
    result = CliRunner().invoke(cli, ["info", model, "--with", str(tmp_path / "bad.vol")])
    assert isinstance(result.exception, InputError) and str(result.exception).startswith(str(tmp_path / "bad.vol"))
