"""Images without the mip levels that a picture does not read."""

from __future__ import annotations

import io
import math
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image as Pillow

from viewer.plan.smaller_images import SmallerImages, halvings
from viewer.raster.renderer import Renderer
from viewer.scene.camera import Camera
from viewer.scene.decoding import decode_levels
from viewer.scene.environment import Environment
from viewer.scene.material import Material, Sampler, Texture, UVTransform
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Instance, Scene
from viewer.scene.texture_image import TextureImage, open_texture_image
from viewer.settings import Settings

SIDE = 1024
CORNERS = np.float32([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
UVS = np.float32([[0, 1], [1, 1], [1, 0], [0, 0]])
INDICES = np.uint32([0, 1, 2, 0, 2, 3])


def png(side: int = SIDE, height: int | None = None) -> TextureImage:
    """Noise, so that each level differs from the others."""
    noise = np.random.default_rng(1).integers(0, 256, (height or side, side, 3), dtype=np.uint8)
    file = io.BytesIO()
    Pillow.fromarray(noise).save(file, "PNG", compress_level=0)
    return open_texture_image(file.getvalue(), "noise")


IMAGE = png()


def square(image: TextureImage = IMAGE, transform: np.ndarray | None = None, texture: Texture | None = None,
           **material) -> Scene:
    """A square of 2 x 2 in the plane z = 0 that faces +Z, with the whole image on it."""
    mesh = Mesh("square", CORNERS, 0, indices=INDICES, uvs=(UVS,))
    return Scene("square", (mesh,), (Material(base_color_texture=texture or Texture(image), **material),),
                 (Instance(0, np.eye(4) if transform is None else transform),))


def camera(pixels: float, size: int = 64) -> Camera:
    """It looks at the square from +Z, which covers so many pixels of a picture of `size` in a row."""
    return Camera.look_at((0, 0, size / pixels), (0, 0, 0), fov_y=math.pi / 2)


@pytest.mark.parametrize(("pixels", "count"), [(1100, 0), (600, 0), (500, 1), (260, 1), (250, 2), (125, 3), (20, 3)])
@pytest.mark.parametrize("orthographic", [False, True])
def test_a_level_is_left_out_where_no_pixel_reads_it(pixels, count, orthographic):
    eye = camera(pixels)
    if orthographic:
        eye = eye.orthographic(64 / pixels)
    assert halvings(square(), eye, (64, 64)) == {IMAGE: count}


def test_what_leaves_all_levels():
    near, eye = camera(1100), camera(250)
    assert halvings(square(), eye, (64, 64)) == {IMAGE: 2}
    behind = np.eye(4)
    behind[2, 3] = 1.0  # farther than the eye
    unmipped = Texture(IMAGE, Sampler(mip_filter=None))
    blended = replace(square(), materials=(replace(square().materials[0], alpha_mode="blend"),))
    elsewhere = Texture(IMAGE, uv_set=1)
    for scene in (square(transform=behind), square(texture=unmipped), blended, square(texture=elsewhere)):
        assert halvings(scene, eye, (64, 64)) == {IMAGE: 0}
    assert halvings(square(), near, (64, 64)) == {IMAGE: 0}
    small, odd = png(512), png(SIDE, 1026)
    assert halvings(square(small), eye, (64, 64)) == {small: 0} and halvings(square(odd), eye, (64, 64)) == {odd: 1}


def test_the_density_of_texels_follows_transforms_and_sides():
    eye = camera(500)
    tiled = Texture(IMAGE, transform=UVTransform(scale=(2.0, 2.0)))
    assert halvings(square(texture=tiled), eye, (64, 64)) == {IMAGE: 2}
    assert halvings(square(transform=np.diag([0.5, 0.5, 1, 1])), eye, (64, 64)) == {IMAGE: 2}
    nearer = camera(1100)
    away, mirrored = np.diag([-1.0, 1, -1, 1]), np.diag([-1.0, 1, 1, 1])
    assert halvings(square(transform=away), nearer, (64, 64)) == {IMAGE: 3}  # its back is not drawn
    assert halvings(square(transform=mirrored), nearer, (64, 64)) == {IMAGE: 0}
    assert halvings(square(transform=away, double_sided=True), nearer, (64, 64)) == {IMAGE: 0}


def test_what_is_near_may_be_hardly_a_pixel():
    def scene(side: float) -> Scene:
        """A square at level 1.5, and before it a small one at level -0.5, which would lose 0.64 of its contrast."""
        part = Mesh("part", CORNERS * np.float32(side), 0, indices=INDICES, uvs=(UVS * np.float32(side / 4),))
        whole = square()
        return replace(whole, meshes=(*whole.meshes, part), instances=(*whole.instances, Instance(1, np.eye(4))))

    eye = Camera.look_at((0, 0, 1), (0, 0, 0), fov_y=math.pi / 2)  # the square covers 360 x 360 pixels of the picture
    assert halvings(scene(0.027), eye, (360, 360)) == {IMAGE: 1}
    assert halvings(scene(0.029), eye, (360, 360)) == {IMAGE: 0}  # 10.4 x 10.4 pixels


@pytest.mark.parametrize("encoding", ["srgb", "linear", "normal"])
def test_the_other_levels_are_the_same(encoding):
    levels = decode_levels(IMAGE, "RGB", encoding)
    fewer = decode_levels(IMAGE.smaller(2), "RGB", encoding)
    assert len(fewer) == len(levels) - 2 and fewer[0].shape[:2] == (256, 256)
    for one, other in zip(fewer, levels[2:], strict=True):
        np.testing.assert_array_equal(one, other)


def test_both_tell_that_an_image_is_broken():
    broken = TextureImage("broken", IMAGE.data[:9999], SIDE, SIDE, "PNG")
    levels = decode_levels(broken.smaller(1), "RGB", "srgb")
    assert levels[0].shape[:2] == (512, 512) and len(broken.problems) == 1


def test_images_are_kept_until_a_picture_needs_larger_ones():
    scene, smaller = square(), SmallerImages()
    first = smaller.of(scene, camera(250), (64, 64))
    again = smaller.of(scene, camera(20), (64, 64))
    assert [image.halvings for image in first.images] == [2] and again.has_surfaces_of(first)
    nearer = smaller.of(scene, camera(500), (64, 64))
    assert [image.halvings for image in nearer.images] == [1]
    assert smaller.of(scene, camera(1100), (64, 64)).images == (IMAGE,)
    assert scene.images == (IMAGE,)


def test_the_picture_is_the_same(context):
    sky = Environment("white", np.ones((16, 32, 3), np.float32))
    scene, eye = replace(square(), environment=sky), camera(230, 128)
    smaller = SmallerImages().of(scene, eye, (128, 128))
    assert [image.halvings for image in smaller.images] == [2]
    renderer = Renderer(context, use_cache=False)
    try:
        pictures = [renderer.display(each, eye, Settings(), (128, 128)).srgb.astype(int) for each in (scene, smaller)]
    finally:
        renderer.release()
    assert np.ptp(pictures[0]) > 20 and np.abs(pictures[0] - pictures[1]).max() <= 1
