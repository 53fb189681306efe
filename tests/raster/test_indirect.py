"""Indirect light in the raster, against the path tracer and where there is none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shapes import WHITE, constant, facing_floor, moved, orthographic, scene, sphere

from viewer.gpu.context import Context
from viewer.raster.renderer import Renderer
from viewer.scene.light import Light
from viewer.scene.mesh import Mesh
from viewer.settings import Settings
from viewer.trace.tracer import Tracer

SIZE = (32, 32)
VIEW = orthographic(0.0, 0.6, height=3.0)
SUN = Light("directional", direction=(0.0, -0.8, -0.6), intensity=3.0)
RED = replace(WHITE, base_color=(0.8, 0.1, 0.1, 1.0))


def tiles(material: int, side: int = 8) -> Mesh:
    """A square from -1 to 1 that faces +Z, in so many by so many parts."""
    at = np.linspace(-1, 1, side + 1)
    x, y = np.meshgrid(at, at)
    positions = np.float32(np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3))
    corner = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).ravel()
    quads = np.stack([corner, corner + 1, corner + side + 2, corner, corner + side + 2, corner + side + 1], axis=1)
    return Mesh("tiles", positions, material, indices=quads.astype(np.uint32).ravel(),
                normals=np.float32([[0, 0, 1]] * len(positions)))


def corner(side: int = 8, **changes):
    """A white floor before a red wall."""
    parts = (tiles(0, side), facing_floor()), (tiles(1, side), moved((0, 1, -1)))
    return scene(*parts, materials=(WHITE, RED), **changes)


@pytest.fixture(scope="module")
def truth(context: Context):
    tracer = Tracer(context)
    yield lambda model: tracer.render(model, VIEW, Settings(mode="path", spp=64, background="none"), SIZE).linear
    tracer.release()


def error(radiance, reference: np.ndarray, model, **settings) -> float:
    found = radiance(model, VIEW, SIZE, background="none", **settings)
    inside = reference[..., 3] > 0.999
    return float(np.sqrt(np.mean((found - reference)[inside, :3] ** 2)))


@pytest.mark.parametrize("side", [1, 8])
def test_a_wall_tints_the_floor(radiance, truth, side):
    """Also where both are but two triangles, which are divided then."""
    model = corner(side, lights=(SUN,))
    reference = truth(model)
    assert error(radiance, reference, model, indirect="baked") < 0.35 * error(radiance, reference, model)


@pytest.mark.parametrize("lights", ["off", "64"])
def test_under_an_environment(radiance, truth, lights):
    model = corner(environment=constant())
    reference = truth(model)
    without, found = (error(radiance, reference, model, indirect=indirect, environment_shadows=lights)
                      for indirect in ("off", "baked"))
    assert found < 0.6 * without


def test_light_is_found_anew_under_other_lights(renderer: Renderer, radiance):
    model = corner(lights=(SUN,))
    first = radiance(model, VIEW, SIZE, indirect="baked")
    np.testing.assert_array_equal(radiance(model, VIEW, SIZE, indirect="baked"), first)
    brighter = model.relit(lights=(replace(SUN, intensity=6.0),))
    np.testing.assert_allclose(radiance(brighter, VIEW, SIZE, indirect="baked"), 2 * first - [0, 0, 0, 1] * (
        first > 0), rtol=1e-2, atol=1e-3)
    assert renderer.times["indirect light"] > 0


def test_nothing_is_baked_where_none_sees_another(renderer: Renderer, radiance):
    ball = scene(sphere(segments=24), lights=(SUN,))
    pictures = [radiance(ball, VIEW, SIZE, indirect=indirect) for indirect in ("off", "baked")]
    np.testing.assert_array_equal(*pictures)
    assert not renderer.plan.has_indirect
    assert "baked indirect light: the scene is convex: no surface sees another" in renderer.plan.left_out


def test_each_instance_has_its_own(radiance):
    """The same plate under a low roof and in the open."""
    lamp = Light("directional", direction=(0.0, -0.3, -1.0), intensity=3.0)
    roof = moved((-2, 0.4, 0)) @ np.diag([1.0, -1.0, -1.0, 1.0]) @ facing_floor()
    model = scene((tiles(0), moved((-2, 0, 0)) @ facing_floor()), (tiles(0), moved((2, 0, 0)) @ facing_floor()),
                  (tiles(0), roof), lights=(lamp,))
    view = orthographic(0.0, np.pi / 2 - 1e-3, height=6.0)
    change = np.subtract(*(radiance(model, view, SIZE, indirect=i)[..., :3].sum(axis=2) for i in ("baked", "off")))
    assert np.abs(change[:, 17:]).max() < 1e-3


def test_backs_get_no_light_of_fronts(radiance):
    sheet = replace(WHITE, double_sided=True)
    model = replace(corner(lights=(SUN,)), materials=(sheet, sheet))
    below = orthographic(0.0, -0.9, height=3.0)
    pictures = [radiance(model, below, SIZE, indirect=indirect) for indirect in ("off", "baked")]
    np.testing.assert_array_equal(*pictures)


def test_no_mode_but_pbr_has_it(renderer: Renderer, radiance):
    radiance(corner(lights=(SUN,)), VIEW, SIZE, indirect="baked", mode="phong")
    assert not renderer.plan.has_indirect
