"""The grid on the ground and the axes of the world."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shapes import facing_floor, moved, orthographic, plate, scene, sphere

import viewer
from viewer.errors import UsageError
from viewer.plan.legend import legend
from viewer.plan.planner import plan_scene
from viewer.raster.grid import BLUE, GREEN, GREY, OPACITY, RED, axes_lines
from viewer.scene.camera import Camera
from viewer.scene.ground_grid import GroundGrid
from viewer.scene.material import Material
from viewer.settings import Settings

UNLIT = Material(unlit=True)
DOWN = orthographic(elevation=np.pi / 2, height=5.0, distance=20.0)
SIZE = (200, 200)  # 40 pixels a unit from above


def ball(scale: float = 1.0, offset: tuple[float, float, float] = (0.0, 0.0, 0.0)):
    return scene((sphere(segments=16), moved(offset, scale)), materials=(UNLIT,))


@pytest.mark.parametrize(("radius", "spacing"), [(1.0, 1.0), (0.99, 0.1), (5.0, 1.0), (37.0, 10.0), (2e-7, 1e-7)])
def test_lines_are_a_power_of_ten_apart(radius, spacing):
    model = ball(radius)
    grid = GroundGrid.under(replace(model))
    assert grid.spacing == pytest.approx(spacing) and 2 <= 2 * model.radius / grid.spacing <= 20.001
    assert grid.middle[1] == pytest.approx(-radius)
    assert f"Grid: {spacing:g} m" in legend(model, DOWN, Settings(grid="on"))[0]


def lined(radiance, model, camera=DOWN, **settings) -> np.ndarray:
    return radiance(model, camera, SIZE, **({"background": "none", "grid": "on"} | settings))


def test_lines_are_at_whole_multiples_and_the_axes_have_their_colours(radiance):
    """From above, over a small ball: radius 0.5, so that lines are 0.1 apart, 4 pixels."""
    seen = lined(radiance, ball(0.5), replace(DOWN, height=2.0))  # 10 pixels between lines
    row, column = seen[103], seen[:, 103]  # beside the axes, behind the ball in the middle
    lines = np.flatnonzero(row[:, 3] > 0.1)
    assert {*range(9, 41, 10), *range(10, 41, 10)} <= set(lines) and not set(lines) & {*range(15, 46, 10)}
    # Two pixels share a line that lies between them
    assert row[29:31, 3].sum() == pytest.approx(OPACITY * 1.0, rel=0.25)
    assert np.allclose(seen[25, 99:101, :3].sum(0) / seen[25, 99:101, 3].sum(), BLUE, atol=1e-3)  # x = 0: the z axis
    assert np.allclose(seen[99:101, 175, :3].sum(0) / seen[99:101, 175, 3].sum(), RED, atol=1e-3)
    assert np.allclose(column[29:31, :3].sum(0) / column[29:31, 3].sum(), GREY, atol=1e-3)


def test_the_grid_is_behind_surfaces_and_before_nothing(radiance):
    floor = scene((plate(), facing_floor(1.0)), materials=(UNLIT,))
    with_grid, without = (lined(radiance, floor, grid=grid) for grid in ("on", "off"))
    covered = without[..., 3] == 1
    covered[150:, :50] = False  # the axes
    assert np.array_equal(with_grid[covered], without[covered]) and covered.sum() > 5000
    assert with_grid[~covered].max() > 0


def test_far_from_the_origin_and_past_the_far_plane_it_is_the_same(radiance):
    camera = Camera.orbit((0, 0, 0), 6.0, 0.4, 0.2)
    far = np.array([3e6, 0.0, -7e6])
    there = replace(camera, pose=camera.pose + np.pad(far[:, None], ((0, 1), (3, 0))))
    near_picture = lined(radiance, ball(), camera)
    assert (near_picture[:90, :, 3] > 0).any()  # higher than the ball is the ground behind it
    no_axes = np.abs(lined(radiance, ball(1.0, tuple(far)), there)[..., 3] - near_picture[..., 3])
    assert np.median(no_axes) < 1e-3 and (no_axes > 0.5).mean() < 0.02  # the axes' own lines are opaque


@pytest.mark.parametrize("exposure", [-2.0, 3.0])
def test_exposure_leaves_it_as_it_is(renderer, exposure):
    model, plain = ball(0.5), Settings(grid="on", background="none", tonemap="none")
    codes = [renderer.display(model, DOWN, replace(plain, exposure=e), SIZE).srgb.astype(int) for e in (0.0, exposure)]
    is_line = codes[0][..., 3] > 8
    is_line[:, 80:] = False  # the ball
    assert np.abs(codes[0] - codes[1])[is_line].max() <= 2 and is_line.sum() > 500


def test_the_axes_point_where_the_world_does():
    lines = dict(axes_lines(Camera.orbit((0, 0, 0), 5.0, 0.0, 0.0), 200))
    arms = {axis: strokes[0, 1] - strokes[0, 0] for axis, strokes in lines.items()}
    assert arms[0][0] == pytest.approx(11) and arms[1][1] == pytest.approx(11)
    assert np.allclose([arms[0][1], arms[1][0], *arms[2]], 0, atol=1e-9)
    assert axes_lines(Camera.orbit((0, 0, 0), 5.0, 2.8, -0.1), 200)[0][0] == 2  # away from the eye
    assert all(strokes.min() > 0 and strokes.max() < 60 for strokes in lines.values())


def test_the_axes_are_drawn_over_all(radiance):
    wall = scene((plate(half=9.0), np.eye(4)), materials=(replace(UNLIT, base_color=(0, 0, 0, 1)),))
    seen = lined(radiance, wall, orthographic(0.3, 0.2))[150:, :50, :3].reshape(-1, 3)
    for color in (RED, GREEN, BLUE):
        assert np.abs(seen - color).max(axis=1).min() < 0.01


def test_without_it_there_is_no_pass_and_mode_path_refuses_it():
    model = ball()
    plain, lined = (plan_scene(model, Settings(grid=grid), (), samples=1, half_target=True, orthographic=False)
                    for grid in ("off", "on"))
    assert plain.programs == lined.programs and not any("grid" in line for line in plain.used)
    assert plain.to_json()["passes"] == [name for name in lined.to_json()["passes"] if name != "grid"]
    with pytest.raises(UsageError, match="grid has no effect in mode path"):
        viewer.render(model, (8, 8), mode="path", grid="on")
