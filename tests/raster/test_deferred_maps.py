"""What deferred surfaces interpolate within a triangle, against what OpenGL does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from images import image_of, noise
from shapes import facing_floor, lopsided, moved, orthographic, plate, scene

from viewer.plan.model import Draw
from viewer.plan.planner import plan_scene
from viewer.raster.numbered_triangles import NumberedTriangles
from viewer.scene.light import Light
from viewer.scene.material import Material, Texture
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Scene
from viewer.settings import Settings

SIZE = (40, 32)
BUMPS = Texture(image_of((np.array([128, 160, 230]) + noise(4, 4, 3, 5) / 8).astype(np.uint8)))


def test_maps_of_a_mirrored_mesh(renderer):
    """Two plates, one with normals and one whose normals cancel, seen at an angle without perspective: a bump map that
    is the other way up without handedness, a map whose levels of detail the derivatives choose, and one by other
    texture coordinates."""
    square = plate(half=0.5)
    square = replace(square, uvs=(3 * square.uvs[0], square.uvs[0] @ np.float32([[0.9, 0.2], [0.1, 0.5]])))
    flat = replace(square, normals=np.zeros_like(square.normals))
    ramp = np.linspace(0, 255, 32).astype(np.uint8)
    material = Material(metallic=0.0, perceptual_roughness=0.6, normal_texture=BUMPS,
                        base_color_texture=Texture(image_of(noise(64, 64, 3, 2))), emissive=(0.5, 0.5, 0.5),
                        emissive_texture=Texture(image_of(np.stack(np.broadcast_arrays(ramp, ramp[:, None], 40), -1)
                                                          .astype(np.uint8)), uv_set=1))
    model = scene(*((mesh, moved((x, 0, 0), (-1.0, 1.0, 1.0))) for mesh, x in ((square, -0.55), (flat, 0.55))),
                  materials=(material,), environment=lopsided())
    pictures = []
    for antialias in ("deferred-4", "msaa-4"):
        settings = Settings.of(antialias=antialias, background="none", shadows="off")
        renderer.draw(model, orthographic(0.5, 0.4, 1.6), settings, SIZE, half=False)
        pictures.append(renderer.read_radiance())
        assert [draw.is_deferred for draw in renderer.plan.draws] == 2 * [antialias == "deferred-4"]
    deferred, multisampled = pictures
    is_whole = (deferred[..., 3] == 1) & (multisampled[..., 3] == 1)
    assert is_whole.sum() > 400 and np.abs(deferred - multisampled)[is_whole].max() < 1e-5


def test_edge_on_triangles_end_where_they_do(renderer):
    """A plate, seen at 1e-3, goes through one sample of the pixels of a row, in whose middle it would be 23 times its
    side away from the lamp above it: it is not continued to there."""
    white = Material(metallic=0.0, perceptual_roughness=1.0, specular=0.0, base_color=(1, 1, 1, 1))
    lamp = Light("point", intensity=1.0, position=(0.0, 0.5, 0.0))
    model = scene((plate(half=0.5), facing_floor(1.0, 2 / SIZE[1] / 8)), materials=(white,), lights=(lamp,))
    settings = Settings.of(antialias="deferred-4", background="none", shadows="off")
    renderer.draw(model, orthographic(0.0, 1e-3), settings, SIZE, half=False)
    assert renderer.plan.draws[0].is_deferred
    pixels = renderer.read_radiance()
    seen = pixels[pixels[..., 3] > 0]
    assert len(seen) > 10
    assert (seen[:, 0] / seen[:, 3]).min() > 0.49 / (0.5**2 + 1**2 + 0.5**2) ** 1.5 / np.pi  # half a side beyond it


def of_two(second: Mesh) -> tuple[Scene, list[Draw]]:
    """A plate and another mesh in its middle, and what of both is deferred."""
    model = scene(plate(), second)
    plan = plan_scene(model, Settings(), (), samples=4, half_target=True, orthographic=False, deferred=True)
    return model, [draw for draw in plan.draws if draw.is_deferred]


def test_colours_of_vertices_are_not_deferred():
    coloured = replace(plate(), colors=np.ones((4, 4), np.float32))
    assert len(of_two(plate())[1]) == 2 and len(of_two(coloured)[1]) == 1


def test_planes_are_those_of_where_triangles_are(context):
    """In a scene whose extent stays."""
    small = plate(half=0.1)
    model, draws = of_two(small)
    triangles = NumberedTriangles(context, model, draws)
    assert triangles.fits(model, draws)
    placed = replace(model, instances=(model.instances[0], replace(model.instances[1], transform=moved((0.2, 0, 0)))))
    assert placed.radius == model.radius and not triangles.fits(placed, draws)
    triangles.release()
