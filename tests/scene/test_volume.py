"""A volume in a scene: its box, what frames it, and what cannot be one."""

from __future__ import annotations

import math
import pickle
from dataclasses import replace

import numpy as np
import pytest
from shapes import moved, scene, sphere

from viewer.base.digest import digest
from viewer.errors import UsageError
from viewer.plan.media import MAX_VOLUMES
from viewer.plan.warnings import picture_warnings
from viewer.scene.camera import Camera
from viewer.scene.environment_presets import make_preset
from viewer.scene.frame import Frame
from viewer.scene.framing import MARGIN
from viewer.scene.light import Light
from viewer.scene.medium import Medium
from viewer.scene.scene import Scene
from viewer.scene.volume import Volume, mean_collisions, volume_medium
from viewer.settings import Settings

BOX = [[-1, -2, -3], [2, 4, 7]]
SHEARED = np.array([[2, 1, 0, 5], [0, -1, 0, 3], [0.5, 0, 3, -2], [0, 0, 0, 1]], float)


def ramp(shape=(4, 3, 2), dtype=np.float32) -> np.ndarray:
    return np.arange(math.prod(shape), dtype=dtype).reshape(shape)


def smoky(*volumes: Volume) -> Scene:
    return Scene("smoky", volumes=volumes or (Volume.in_box(ramp(), BOX),))


def test_a_box_has_a_voxel_centre_half_a_voxel_from_each_face():
    volume = Volume.in_box(ramp(), BOX)
    np.testing.assert_allclose(volume.index_to_world @ [0, 0, 0, 1], [-1 + 0.75, -2 + 1, -3 + 1.25, 1])
    np.testing.assert_allclose(volume.index_to_world @ [1, 2, 3, 1], [2 - 0.75, 4 - 1, 7 - 1.25, 1])
    np.testing.assert_allclose([volume.corners.min(axis=0), volume.corners.max(axis=0)], BOX)


def test_corners_follow_every_axis():
    corners = Volume("sheared", ramp(), SHEARED).corners
    low, high = SHEARED @ [-0.5, -0.5, -0.5, 1], SHEARED @ [1.5, 2.5, 3.5, 1]
    np.testing.assert_allclose(corners[[0, 7]], [low[:3], high[:3]])
    np.testing.assert_allclose(corners[1] - corners[0], 2 * SHEARED[:3, 0])
    np.testing.assert_allclose(corners[2] - corners[0], 3 * SHEARED[:3, 1])
    np.testing.assert_allclose(corners[4] - corners[0], 4 * SHEARED[:3, 2])


@pytest.mark.parametrize("given, held", [(np.float16, np.float16), (np.float32, np.float32), (np.float64, np.float32),
                                         (np.uint8, np.float32)])
def test_half_floats_stay_half(given, held):
    volume = Volume.in_box(ramp(dtype=given), BOX)
    assert volume.density.dtype == held and not volume.density.flags.writeable and volume.maximum == 23


@pytest.mark.parametrize("changes, problem", [
    ({"density": np.zeros((2, 2))}, "Volume.density is (2, 2) float64, not (N, N, N) float32"),
    ({"density": np.zeros((2, 0, 2))}, "Volume.density is (2, 0, 2): it has no voxels"),
    ({"density": np.where(ramp() == 23, np.nan, 0)}, "NaN"),
    ({"density": np.where(ramp() == 9, -2, 0)}, "Volume.density[1, 1, 1] is -2: a density is not negative"),
    ({"index_to_world": np.eye(3)}, "Volume.index_to_world is (3, 3) float64"),
    ({"index_to_world": np.eye(4) + 1}, "its last row is [1.0, 1.0, 1.0, 2.0]"),
    ({"index_to_world": moved((0, 0, 0), (1, 0, 1))}, "it makes the grid flat"),
    ({"name": 3}, "Volume.name is of type int, not text"),
])
def test_what_is_no_volume_is_refused(changes, problem):
    with pytest.raises(UsageError) as error:
        Volume(**{"name": "v", "density": ramp(), "index_to_world": np.eye(4)} | changes)
    assert problem in str(error.value)


@pytest.mark.parametrize("density, box", [(ramp(), [[0, 0, 0], [1, 0, 1]]), (ramp(), [[1, 1, 1], [0, 2, 2]]),
                                          (np.zeros((2, 2)), BOX), (np.zeros((0, 2, 2)), BOX)])
def test_a_box_or_a_grid_without_room_is_refused(density, box):
    with pytest.raises(UsageError):
        Volume.in_box(density, box)


@pytest.mark.parametrize("volumes, problem", [
    ((ramp(),), "Scene.volumes[0] is of type ndarray, not a Volume (Volume.in_box makes one of an array)"),
    (Volume.in_box(ramp(), BOX), "Scene.volumes is of type Volume, not a tuple of volumes")])
def test_a_scene_of_other_things_than_volumes_is_refused(volumes, problem):
    with pytest.raises(UsageError) as error:
        Scene("smoky", volumes=volumes)
    assert str(error.value) == problem


@pytest.mark.parametrize("scale", [1e-12, 1e12])
def test_its_size_does_not_matter(scale):
    shown = smoky(Volume("tiny", ramp(), moved((1, 2, 3), scale)))
    assert shown.radius == pytest.approx(scale * math.sqrt(29) / 2, rel=1e-3 if scale < 1 else 1e-12)


def test_a_scene_of_a_volume_alone_is_framed_by_its_box():
    shown = smoky()
    np.testing.assert_allclose(shown.bounds, BOX)
    assert shown.radius == pytest.approx(math.sqrt(9 + 36 + 100) / 2)
    camera = shown.framing_camera(1.5, 0.7, 0.4)
    local = (shown.volumes[0].corners - camera.eye) @ camera.pose[:3, :3]
    seen = np.abs(local[:, :2] / (-local[:, 2:] * math.tan(camera.fov_y / 2) * (1.5, 1)))
    assert seen.max() == pytest.approx(1 - 2 * MARGIN, abs=1e-6)


def test_what_frames_a_model_and_a_volume_has_both():
    ball = sphere(segments=24)
    shown = replace(scene(ball, (ball, moved((0, 50, 0), 0.0))), volumes=(Volume.in_box(ramp(), BOX),))
    np.testing.assert_allclose(shown.bounds, BOX)
    np.testing.assert_allclose(shown.farthest(np.array([1.0, 1, 1])) + shown.center, BOX[1])
    outside = replace(shown, volumes=(Volume.in_box(ramp(), [[3, 0, 0], [4, 1, 1]]),))
    np.testing.assert_allclose(outside.bounds, [[-1, -1, -1], [4, 1, 1]], atol=0.01)
    np.testing.assert_allclose(outside.farthest(np.array([-1.0, 0, 0])) + outside.center, [-1, 0, 0], atol=0.01)
    only_flat = replace(scene((ball, moved((0, 50, 0), 0.0))), volumes=shown.volumes)
    np.testing.assert_allclose(only_flat.bounds, BOX)


def test_the_depth_range_holds_the_volume():
    shown = smoky()
    camera = Camera.look_at((0, 0, 100), (0, 0, 0))
    low, high = Frame(shown, camera, (8, 8), is_depth_reversed=True).depth_range
    assert low * shown.radius == pytest.approx(93, rel=1e-3) and high * shown.radius == pytest.approx(103, rel=1e-3)


def test_it_pickles_prints_and_is_part_of_the_scenes_digest():
    shown = smoky(Volume("smoke", ramp(dtype=np.float16), SHEARED))
    twin = pickle.loads(pickle.dumps(shown))
    assert digest(twin) == digest(shown) and not twin.volumes[0].density.flags.writeable
    assert repr(twin.volumes[0]) == "<Volume 'smoke': 2 x 3 x 4 voxels, float16, up to 23>"
    assert "1 volumes" in repr(twin)
    denser = smoky(Volume("smoke", ramp(dtype=np.float16) + np.float16(1), SHEARED))
    assert digest(denser) != digest(shown) and denser.layout == shown.layout
    assert not denser.has_surfaces_of(shown) and shown.relit(lights=()).has_surfaces_of(shown)
    assert smoky().layout != Scene("empty").layout


def test_the_medium_of_the_settings():
    settings = Settings.of(volume_density=3, volume_albedo=(0.1, 0.2, 0.3), volume_g=-0.5, volume_emission=2)
    assert volume_medium(settings) == Medium((3, 3, 3), (0.1, 0.2, 0.3), -0.5, emission=(2, 2, 2))


@pytest.mark.parametrize("mode", ["pbr", "phong", "path"])
def test_every_mode_draws_volumes(mode):
    assert not any("volumes" in line for line in picture_warnings(smoky(), Settings(mode=mode)))


def test_a_volume_that_emits_is_not_black():
    assert "will be black" in picture_warnings(smoky(), Settings())[0]
    glowing = Settings(volume_emission=(0.0, 1.0, 0.0))
    assert picture_warnings(smoky(), glowing) == []
    assert "will be black" in picture_warnings(scene(sphere(segments=12)), glowing)[0]
    thin = replace(glowing, volume_density=0.0)
    assert picture_warnings(smoky(), thin) == [] == picture_warnings(smoky(), replace(glowing, mode="path"))
    black, missing = picture_warnings(smoky(), replace(thin, mode="path"))
    assert "will be black" in black and "mode path does not show the emission of volumes" in missing
    assert picture_warnings(smoky(), Settings(mode="path", volume_density=0.0)) == [black]
    black, empty = picture_warnings(smoky(Volume.in_box(np.zeros((2, 2, 2)), BOX)), glowing)
    assert "will be black" in black and empty == "volume 'density' is 0 everywhere: there is nothing to draw"


def test_a_mean_cosine_beside_droplets_is_told_to_have_no_effect():
    lit = replace(smoky(), lights=(Light("directional"),))
    foggy = replace(scene(sphere(segments=12)), lights=lit.lights)
    both = Settings(volume_g=0.5, volume_droplets=20.0, fog_g=-0.5, fog_droplets=20.0)
    assert ["volume_g has no effect" in line for line in picture_warnings(lit, both)] == [True]
    assert ["fog_g has no effect" in line for line in picture_warnings(foggy, replace(both, fog=1.0))] == [True]
    assert picture_warnings(foggy, both) == []  # there is neither
    for alone in (replace(both, volume_g=0.0), replace(both, volume_droplets=0.0)):
        assert picture_warnings(lit, alone) == []


def test_volumes_that_do_not_fit_into_a_program_are_told():
    lit = replace(smoky(), lights=(Light("directional"),))
    crowd = replace(lit, volumes=lit.volumes * (MAX_VOLUMES + 1))
    assert picture_warnings(crowd, Settings()) == ["only the first 8 of 9 volumes are shown; mode path shows them all"]
    assert picture_warnings(crowd, Settings(mode="path")) == []
    assert picture_warnings(replace(crowd, volumes=crowd.volumes[1:]), Settings()) == []


def test_volumes_in_which_paths_collide_often_are_warned_of():
    """4 V / S of a box: 2 / 3 of the side of a cube, of any medium that absorbs nothing."""
    cube = Volume.in_box(np.full((2, 3, 4), 0.5, np.float32), [[0, 0, 0], [2, 2, 2]])
    assert mean_collisions(cube, Medium((30.0,) * 3, (1.0,) * 3)) == pytest.approx(30 * 0.5 * 4 / 3)
    assert mean_collisions(cube, Medium((3000.0,) * 3, (0.9, 0.8, 0.5))) == pytest.approx(10)
    model = Scene("cube", volumes=(cube,), environment=make_preset("furnace"))
    white = {"volume_density": 1000.0, "volume_albedo": (1.0, 1.0, 1.0)}
    [line] = picture_warnings(model, Settings.of(mode="path", **white))
    assert "volume 'density'" in line and "collide up to 667 times" in line
    assert not picture_warnings(model, Settings.of(**white))
    assert not picture_warnings(model, Settings.of(mode="path", volume_density=1000.0))
