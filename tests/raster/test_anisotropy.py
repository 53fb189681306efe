"""Brushed surfaces where their tangents or their numbers are extreme, and meshes that lack what a shared map needs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from images import image_of, noise
from shapes import moved, plate, scene, sphere

from viewer.measure.check.furnace import hemisphere_balance
from viewer.raster.renderer import Renderer
from viewer.scene.camera import Camera
from viewer.scene.environment_presets import make_preset
from viewer.scene.light import Light
from viewer.scene.material import Material, Texture
from viewer.scene.mesh import Mesh
from viewer.settings import Settings

CAMERA = Camera.look_at((1.0, 1.0, 3.0), (0, 0, 0))
SUN = Light.from_angles(0.4, 0.6, 3.0)


def shown(renderer: Renderer, mesh: Mesh, material: Material) -> np.ndarray:
    model = scene(mesh, materials=(material,), lights=(SUN,), environment=make_preset("studio"))
    return renderer.render(model, CAMERA, Settings.of(background="none"), (48, 48)).linear


def with_tangent(mesh: Mesh, tangent) -> Mesh:
    return replace(mesh, tangents=np.tile(np.float32([*tangent, 1]), (len(mesh.positions), 1)))


@pytest.mark.parametrize("tangent", [(0, 0, 1), (0, 0, 0), (1e-30, 0, 0)], ids=str)
def test_a_tangent_that_says_no_direction_is_replaced(renderer, tangent):
    """Parallel to the normal, or of no length: as bright as with any other tangent, not a highlight everywhere."""
    material = Material(base_color=(0.9, 0.8, 0.7, 1), perceptual_roughness=0.3, anisotropy_strength=0.9)
    found = shown(renderer, with_tangent(plate(), tangent), material)
    directions = [shown(renderer, with_tangent(plate(), (np.cos(a), np.sin(a), 0)), material)
                  for a in np.linspace(0, np.pi, 8, endpoint=False)]
    assert np.isfinite(found).all()
    middle = [picture[24, 24, :3].sum() for picture in directions]
    assert 0.5 * min(middle) < found[24, 24, :3].sum() < 2 * max(middle)


@pytest.mark.parametrize("roughness", [0.0, 1e-3, 1.0])
@pytest.mark.parametrize("strength", [1e-4, 1.0])
def test_extremes_are_finite(renderer, roughness, strength):
    ball = sphere()
    x, _, z = ball.positions.T
    tangents = np.stack([z, 0 * x, -x, np.ones_like(x)], axis=1)  # zero at the poles
    picture = shown(renderer, replace(ball, tangents=tangents.astype(np.float32)),
                    Material(perceptual_roughness=roughness, anisotropy_strength=strength))
    assert np.isfinite(picture).all() and picture[..., :3].max() > 0


@pytest.mark.parametrize(("roughness", "rotation"), [(0.2, np.pi / 2), (0.4, 0.0)])
def test_white_brushed_metal_reflects_all(renderer, roughness, rotation):
    """Of a light 7 degrees above its plane, all around. The isotropic albedo of the mean alpha lost up to 0.27."""
    white = Material(base_color=(1, 1, 1, 1), metallic=1.0, perceptual_roughness=roughness, anisotropy_strength=0.9,
                     anisotropy_rotation=rotation)
    assert hemisphere_balance(renderer, white, np.sin(np.radians(7))) == pytest.approx(1, abs=1e-2)


def test_a_mesh_without_coordinates_is_not_drawn_with_the_map_of_the_one_before(renderer):
    """Many materials, so that programs are shared; two meshes have one material, and one of them no coordinates."""
    image = Texture(image_of(noise(8, 8, 3, 1), "mr"))
    mapped = Material(perceptual_roughness=0.9, metallic_roughness_texture=image)
    others = [Material(metallic=0.1 * k, perceptual_roughness=0.5, double_sided=bool(k % 2),
                       emissive=(0.1 * (k % 3), 0, 0)) for k in range(1, 8)]
    bare = replace(plate(0, 0.4), uvs=())
    meshes = [(plate(0, 0.4), moved((-0.5, 0, 0))), (bare, moved((0.5, 0, 0)))]
    meshes += [(plate(k, 0.1), moved((0.25 * k - 1, 0.8, 0))) for k in range(1, 8)]
    light = {"lights": (SUN,), "environment": make_preset("studio")}
    settings = Settings.of(background="none")
    whole = renderer.render(scene(*meshes, materials=(mapped, *others), **light), CAMERA, settings, (64, 64)).linear
    assert renderer.plan is not None and len(renderer.plan.programs) < 8
    alone = renderer.render(scene(meshes[1], materials=(mapped,), **light), CAMERA, settings, (64, 64)).linear
    inside = alone[..., 3] > 0.999
    np.testing.assert_allclose(whole[inside], alone[inside], rtol=2e-3, atol=1e-4)
