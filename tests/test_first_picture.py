"""The rule that takes a quality: each part of it can decide, and only the scene and the size of the picture do."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from command_line import SCENES
from shapes import WHITE, constant, facing_floor, moved, plate, scene, sphere

from viewer.plan.first_picture import TIMES, FirstPicture
from viewer.raster.visibility import MOST_POINTS
from viewer.scene.curves import Curves
from viewer.scene.environment_files import load_environment
from viewer.scene.load import load_scene
from viewer.scene.material import Texture
from viewer.scene.scene import Scene
from viewer.scene.texture_image import TextureImage

SIZE = (640, 360)


def balls(count: int, texels: int = 0, segments: int = 12) -> Scene:
    """So many balls on a floor, of one material, with a texture of texels x texels."""
    ball = sphere(segments=segments)
    room = scene((plate(half=2.0), facing_floor()), *[(ball, moved((k, 0.5, 0), 0.5)) for k in range(count)],
                 environment=constant())
    if not texels:
        return room
    image = TextureImage("t", b"", texels, texels, "PNG")
    return replace(room, materials=(replace(WHITE, base_color_texture=Texture(image)),))


def foreseen(room: Scene, size: tuple[int, int] = SIZE) -> FirstPicture:
    return FirstPicture.of(room, size)


def test_it_takes_standard_where_its_first_picture_is_foreseen_in_time():
    taken = set()
    for room in (balls(1), balls(1, 2048), balls(400), balls(3, segments=200), balls(3, 2048, 200)):
        first = foreseen(room)
        assert 0 < first.draft < first.standard
        assert first.quality == ("standard" if first.standard <= TIMES * first.draft else "draft")
        assert ("not within" in first.reason) == (first.quality == "draft")
        taken.add(first.quality)
    assert len(taken) == 2


def test_textures_and_materials_make_a_draft_slow_and_standard_no_slower_than_that():
    plain, detailed = balls(1, segments=200), balls(1, 8192, segments=200)
    assert foreseen(plain).quality == "draft" and foreseen(detailed).quality == "standard"
    assert np.isclose(foreseen(detailed).standard - foreseen(plain).standard,
                      foreseen(detailed).draft - foreseen(plain).draft)
    unused = replace(plain, materials=plain.materials * 2)
    used = replace(unused, meshes=(plain.meshes[0], replace(plain.meshes[1], material=1)))
    assert foreseen(unused) == foreseen(plain) and foreseen(used).draft > foreseen(plain).draft


def test_triangles_instances_and_strands_are_drawn_into_every_map():
    room = balls(1, 2048)
    assert foreseen(room).quality == "standard"
    assert foreseen(balls(1, 2048, segments=600)).quality == "draft"
    assert foreseen(balls(400, 2048)).quality == "draft"
    points = np.zeros((400_000, 3))
    hair = Curves("hair", points, np.full(len(points), 0.01), np.array([0, len(points)]), np.zeros(1, bool))
    assert foreseen(replace(room, curves=(hair,))).quality == "draft"


def test_without_an_environment_or_surfaces_there_are_no_shadows_to_wait_for():
    slow = balls(400)
    assert foreseen(slow).quality == "draft"
    assert foreseen(replace(slow, environment=None)).quality == "standard"
    assert foreseen(Scene("empty", environment=constant())).quality == "standard"


def test_large_pictures_of_simple_models_are_drafts():
    assert [foreseen(balls(1), size).quality for size in ((256, 256), (3840, 2160))] == ["standard", "draft"]
    sizes = [foreseen(balls(1), (side, side)) for side in (256, 512, 1024)]
    rises = np.diff([first.standard - first.draft for first in sizes]) / np.diff([256**2, 512**2, 1024**2])
    assert rises[0] > rises[1] > 0  # the points of the shadows are bounded
    assert MOST_POINTS == 1 << 17


def test_a_file_takes_the_same_quality_each_time_and_before_anything_is_decoded():
    taken = {foreseen(replace(load_scene(SCENES / "spheres.glb"), environment=environment))
             for environment in (load_environment("studio"), constant(), load_environment("sky"))}
    assert len(taken) == 1
