"""The rule that takes a quality: each part of it can decide, and only the scene and the size of the picture do."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from command_line import SCENES
from shapes import WHITE, constant, facing_floor, moved, plate, scene, sphere

from viewer.plan.first_picture import LIGHTS, TIMES, FirstPicture
from viewer.plan.instances import INSTANCED_FROM
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


def test_it_takes_standard_with_the_most_lights_that_are_foreseen_in_time():
    assert list(LIGHTS) == sorted(LIGHTS, reverse=True)
    taken = set()
    for room in (balls(1), balls(1, 2048), balls(400), balls(2000), balls(3, 2048, 200)):
        first = foreseen(room)
        fitting = [lights for lights in LIGHTS if first.standard(lights) <= TIMES * first.draft]
        assert 0 < first.draft < first.standard(0) < first.standard(LIGHTS[-1]) < first.standard(LIGHTS[0])
        assert first.lights == max(fitting, default=0)
        assert ("more than" in first.reason) == (not fitting)
        assert (f"with {LIGHTS[-1]} of {LIGHTS[0]} lights" in first.reason) == (first.lights != LIGHTS[0])
        assert f"to take {first.standard(first.lights or LIGHTS[-1]):.2f} s, " in first.reason
        assert first.reason.endswith(f"a draft's time of {first.draft:.2f} s")
        taken.add(first.lights)
    assert taken == {0, *LIGHTS}


def test_textures_and_materials_make_a_draft_slow_and_standard_no_slower_than_that():
    plain, detailed = balls(1, segments=200), balls(1, 8192, segments=200)
    assert foreseen(plain).lights < foreseen(detailed).lights == LIGHTS[0]
    for lights in LIGHTS:
        assert np.isclose(foreseen(detailed).standard(lights) - foreseen(plain).standard(lights),
                          foreseen(detailed).draft - foreseen(plain).draft)
    unused = replace(plain, materials=plain.materials * 2)
    used = replace(unused, meshes=(plain.meshes[0], replace(plain.meshes[1], material=1)))
    assert foreseen(unused) == foreseen(plain) and foreseen(used).draft > foreseen(plain).draft


def test_triangles_instances_and_strands_are_drawn_into_every_map():
    room = balls(1, 2048)
    assert foreseen(room).lights == LIGHTS[0]
    triangles = [balls(1, 2048, segments) for segments in (200, 600)]
    instances = [balls(count, 2048) for count in (400, 3000)]
    for some, many in (triangles, instances):
        assert (foreseen(some).lights, foreseen(many).lights) == (LIGHTS[-1], 0)
    points = np.zeros((400_000, 3))
    hair = Curves("hair", points, np.full(len(points), 0.01), np.array([0, len(points)]), np.zeros(1, bool))
    assert foreseen(replace(room, curves=(hair,))).lights == 0


def test_many_parts_take_longer_than_as_many_instances_that_one_call_draws():
    parts = balls(400)
    floor, ball = parts.instances[:2]
    instances = replace(parts, instances=(floor, *[replace(part, mesh=ball.mesh) for part in parts.instances[1:]]))
    blended = replace(instances, materials=(replace(WHITE, alpha_mode="blend"),))  # sorted, and drawn one by one
    quick = foreseen(instances)
    for slow in (foreseen(parts), foreseen(blended)):
        assert slow.draft > quick.draft and slow.light > quick.light
        assert slow.unshadowed - slow.draft > quick.unshadowed - quick.draft
    few, many = (replace(instances, instances=instances.instances[:1 + count])
                 for count in (INSTANCED_FROM - 1, INSTANCED_FROM))
    assert foreseen(few).draft > foreseen(many).draft


def test_without_an_environment_or_surfaces_there_are_no_shadows_to_wait_for():
    slow = balls(2000)
    assert foreseen(slow).lights == 0
    for quick in (replace(slow, environment=None), Scene("empty", environment=constant())):
        assert foreseen(quick).lights == LIGHTS[0] and foreseen(quick).light == 0


def test_large_pictures_of_simple_models_are_drafts():
    assert [foreseen(balls(1), size).lights for size in ((256, 256), (3840, 2160))] == [LIGHTS[0], 0]
    sizes = [foreseen(balls(1), (side, side)) for side in (256, 512, 1024)]
    rises = np.diff([first.standard(LIGHTS[0]) - first.draft for first in sizes]) / np.diff([256**2, 512**2, 1024**2])
    assert rises[0] > rises[1] > 0  # the points of the shadows are bounded
    assert MOST_POINTS == 1 << 17


def test_a_file_takes_the_same_quality_each_time_and_before_anything_is_decoded():
    taken = {foreseen(replace(load_scene(SCENES / "spheres.glb"), environment=environment))
             for environment in (load_environment("studio"), constant(), load_environment("sky"))}
    assert len(taken) == 1
