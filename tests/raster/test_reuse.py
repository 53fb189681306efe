"""One renderer for many scenes, many renderers for one: the same pixels, and nothing is left behind."""

from __future__ import annotations

import ctypes
import gc
import io
import weakref
from collections import Counter
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from contexts import open_or_skip
from PIL import Image as PngImage
from shapes import facing_floor, lopsided, moved, orthographic, plate, scene, sphere

import viewer
from viewer.base.resources import resource_folder
from viewer.gpu import programs
from viewer.gpu.context import Context
from viewer.raster import textures
from viewer.raster.geometry import MeshBuffers
from viewer.raster.renderer import Renderer
from viewer.scene import decoding
from viewer.scene.light import Light
from viewer.scene.material import Material, Texture
from viewer.scene.scene import Scene
from viewer.scene.texture_image import TextureImage, open_texture_image
from viewer.settings import Settings

SIZE = (48, 48)
SETTINGS = Settings(antialias="msaa-4")
NAMES = ["textures", "alpha", "lights", "normal-map", "unlit"]


@pytest.fixture(scope="module")
def shots():
    loaded = [viewer.load(resource_folder("assets") / "scenes" / f"{name}.glb", environment=None) for name in NAMES]
    scenes = [replace(s, environment=lopsided() if k % 2 else None) for k, s in enumerate(loaded)]
    return [(s, s.cameras[0]) for s in scenes]


def test_a_picture_of_another_size_makes_no_opengl_error(renderer):
    """The framebuffer of the first is gone while it is the one in use."""
    for size in (SIZE, (16, 24)):
        renderer.draw(scene(plate()), orthographic(), SETTINGS, size, half=False, still=True)
    assert renderer.context.gl.error == "GL_NO_ERROR"


def test_two_renders_are_identical(renderer, shots):
    for model, camera in shots:
        for mode in ("pbr", "phong"):
            settings = replace(SETTINGS, mode=mode)
            a, b = (renderer.render(model, camera, settings, SIZE) for _ in range(2))
            assert np.array_equal(a.linear, b.linear) and np.array_equal(a.srgb, b.srgb)


def test_a_renderer_that_forgets_frees_the_scene_and_draws_it_again_alike(renderer):
    """Before the next model is loaded: memory never holds two."""
    path, camera = resource_folder("assets") / "scenes" / "textures.glb", orthographic()
    model = viewer.load(path, environment=None)
    first = renderer.render(model, camera, SETTINGS, SIZE).linear
    mesh = weakref.ref(model.meshes[0])
    assert renderer.texture_bytes > 0
    del model
    assert mesh() is not None
    renderer.forget()
    gc.collect()
    assert mesh() is None and renderer.texture_bytes == 0 and renderer.context.gl.error == "GL_NO_ERROR"
    np.testing.assert_array_equal(renderer.render(viewer.load(path, environment=None), camera, SETTINGS, SIZE).linear,
                                  first)


def test_a_scene_looks_the_same_after_all_the_others(renderer, shots):
    first = [renderer.render(*shot, SETTINGS, SIZE).linear for shot in shots]
    for order in ((4, 2, 0, 1, 3), (1, 3, 4, 0, 2)):
        for k in order:
            assert np.array_equal(renderer.render(*shots[k], SETTINGS, SIZE).linear, first[k])


def test_two_renderers_in_turn(renderer, shots, context):
    """On one context, drawing alternately."""
    other = Renderer(context)
    for shot in shots[:3]:
        assert np.array_equal(renderer.display(*shot, SETTINGS, SIZE).srgb, other.display(*shot, SETTINGS, SIZE).srgb)
    other.release()
    assert np.array_equal(renderer.display(*shots[0], SETTINGS, SIZE).srgb, picture_of(renderer, shots[0]))


def test_two_back_ends_in_turn(renderer, shots, context):
    with open_or_skip("osmesa" if context.backend != "osmesa" else "egl") as elsewhere:
        other = Renderer(elsewhere)
        for shot in shots[:3]:
            here, there = (each.display(*shot, SETTINGS, SIZE).srgb.astype(int) for each in (renderer, other))
            assert np.abs(here - there).max() <= 2
        other.release()
    assert np.array_equal(renderer.display(*shots[0], SETTINGS, SIZE).srgb, picture_of(renderer, shots[0]))


def picture_of(renderer, shot) -> np.ndarray:
    return renderer.display(*shot, SETTINGS, SIZE).srgb


def objects(context: Context) -> dict[str, int]:
    """How many objects of each kind OpenGL holds. (Mesa's names count upwards, so a few thousand are all there are.)"""
    context.make_current()
    counts = {}
    for kind in ("Texture", "Buffer", "Renderbuffer", "Framebuffer", "VertexArray", "Sampler", "Program"):
        exists = ctypes.CFUNCTYPE(ctypes.c_ubyte, ctypes.c_uint)(context._loader.load_opengl_function(f"glIs{kind}"))
        counts[kind] = sum(exists(name) for name in range(1, 10000))
    return counts


def test_twenty_scenes_one_after_the_other_leave_nothing_behind(renderer, shots, context):
    def draw(k: int) -> None:
        model, camera = shots[k % len(shots)]
        # A new environment, lights and size each time, as somebody does who tries things out.
        model = replace(model, lights=(*model.lights, Light.from_angles(k, 0.5, 1.0)), instances=tuple(model.instances))
        renderer.display(model, camera, replace(SETTINGS, mode=("pbr", "phong")[k // 5 % 2]), (40 + k % 3, 40))

    for k in range(10):
        draw(k)
    before = objects(context)
    for k in range(10, 30):
        draw(k)
    assert objects(context) == before  # what the last scene, the same in both cases, keeps for the next frame


def test_release_frees_everything(context):
    before = objects(context)
    for _ in range(2):
        renderer = Renderer(context)
        model = scene(sphere(), plate(1), materials=[Material(), Material(alpha_mode="blend")],
                      lights=(Light.from_angles(0.1, 0.5, 1.0),), environment=lopsided())
        renderer.display(model, orthographic(), SETTINGS, SIZE)
        assert objects(context) != before
        renderer.release()
        after = objects(context)
        assert after["Program"] <= before["Program"] + 1  # the one used last lives on until another is
        assert after | {"Program": 0} == before | {"Program": 0}


@pytest.fixture
def work(monkeypatch) -> Counter[str]:
    """Counts images decoded, textures and vertex attributes uploaded, and programs compiled."""
    counts: Counter[str] = Counter()

    def count(owner: object, name: str, what: str) -> None:
        real = getattr(owner, name)

        def counted(*args, **kwargs):
            counts[what] += 1
            return real(*args, **kwargs)

        monkeypatch.setattr(owner, name, counted)

    count(decoding, "decode_levels", "decoded")
    count(textures, "mipmapped_texture", "textures")
    count(MeshBuffers, "_data", "attributes")
    count(programs, "compile_program", "programs")
    return counts


def checker(tint: int) -> TextureImage:
    pixels = np.indices((16, 16)).sum(axis=0)[..., None] % 2 * np.uint8([tint, 255 - tint, 90]) + np.uint8(40)
    file = io.BytesIO()
    PngImage.fromarray(pixels.astype(np.uint8)).save(file, "PNG")
    return open_texture_image(file.getvalue(), "checker")


def textured(k: int) -> Material:
    return Material(base_color_texture=Texture(checker(50 * k)), metallic=0.0)


def changed_scenes() -> dict[str, tuple[Scene, dict[str, int]]]:
    """Scenes derived from the first one, "before", each with the work that it may cause."""
    left, right = moved((-1.1, 0, 0)), moved((1.1, 0, 0), 0.8)
    before = scene((plate(0), left), (plate(1), right), materials=[textured(0), textured(1)], environment=lopsided(),
                   lights=(Light.from_angles(0.3, 0.5, 1.0),))
    turned = [replace(instance, transform=instance.transform @ np.diag([1.0, -1.0, 1.0, 1.0]))
              for instance in before.instances]
    new_mesh = {"attributes": 4}  # positions, normals, texture coordinates, indices
    bent = before.meshes[0].positions * np.float32([1, 0.5, 1]) + np.float32([0, 0, 0.2])
    pose = replace(before.meshes[0], positions=bent, normals=np.float32([[0.6, 0, 0.8]] * 4))
    return {
        "before": (before, {}),
        "lights": (replace(before, lights=()), {"programs": 1}),  # one without code for lights
        "instances": (replace(before, instances=before.instances[1:]), {}),
        "order": (replace(before, instances=before.instances[::-1]), {}),
        "transforms": (replace(before, instances=tuple(turned)), {}),
        "mesh": (replace(before, meshes=(plate(0, 0.5), before.meshes[1])), new_mesh),
        "pose": (replace(before, meshes=(pose, before.meshes[1]), instances=tuple(turned)), {"attributes": 2}),
        "factor": (replace(before, materials=(replace(before.materials[0], perceptual_roughness=0.2),
                                              before.materials[1])), {}),
        "image": (replace(before, materials=(before.materials[0], textured(2))), {"decoded": 1, "textures": 1}),
    }


@pytest.mark.parametrize("change", ["lights", "instances", "order", "transforms", "mesh", "pose", "factor", "image"])
def test_what_two_scenes_share_is_neither_decoded_nor_uploaded_nor_compiled_again(context, work, change):
    scenes = changed_scenes()
    camera, (before, _), (after, allowed) = orthographic(height=5.0), scenes["before"], scenes[change]
    renderer, fresh = Renderer(context), Renderer(context)
    first = renderer.display(before, camera, SETTINGS, SIZE).srgb
    held = renderer.texture_bytes
    assert work["decoded"] == work["textures"] == 2 and work["attributes"] == 8 and work["programs"] > 0
    work.clear()
    second = renderer.display(after, camera, SETTINGS, SIZE).srgb
    assert dict(work) == allowed
    assert change == "order" or not np.array_equal(second, first)
    assert np.array_equal(second, fresh.display(after, camera, SETTINGS, SIZE).srgb)
    assert np.array_equal(renderer.display(before, camera, SETTINGS, SIZE).srgb, first)
    assert renderer.texture_bytes == held
    renderer.release()
    fresh.release()


@pytest.mark.parametrize("settings", [
    {}, {"environment_shadows": "16"}, {"ambient_occlusion": "gtao"}, {"mode": "phong"}])
def test_shadows_follow_what_moves(renderer, context, settings):
    """A ball over a floor, in three poses, under a directional light, a spot light and an environment."""
    chosen = Settings.of(antialias="none", **settings)
    lamp = Light("spot", intensity=9.0, position=(0.0, 3.0, 0.0), direction=(0.0, -1.0, 0.0), outer_cone=1.0)
    first = scene((sphere(0, 24), moved((0, 0.5, 0), 0.4)), (plate(0, 2.0), facing_floor()),
                  lights=(Light.from_angles(0.6, 0.8, 2.0), lamp), environment=lopsided())
    poses = [first]
    for k in (1, 2):
        ball = replace(first.meshes[0], positions=first.meshes[0].positions * np.float32([1 + k, 1, 1]))
        placed = replace(first.instances[0], transform=moved((0.3 * k, 0.6, 0), 0.4))
        poses.append(replace(first, meshes=(ball, first.meshes[1]), instances=(placed, first.instances[1]),
                             lights=(first.lights[0], replace(lamp, position=(0.2 * k, 3.0, 0.0)))))
    camera = orthographic(0.4, 0.7, height=4.0)
    pictures = [renderer.render(pose, camera, chosen, SIZE).linear for pose in poses]
    for pose, picture in zip([*poses, poses[1]], [*pictures, renderer.render(poses[1], camera, chosen, SIZE).linear]):
        one = Renderer(context)
        assert np.array_equal(picture, one.render(pose, camera, chosen, SIZE).linear)
        one.release()
    assert not any(np.array_equal(a, b) for a, b in pairwise(pictures))


def test_an_environment_that_comes_back_is_baked_again(renderer):
    """Under two environments in turn, in scenes of one layout and in one scene."""
    first = scene(sphere(), materials=[Material()], environment=lopsided())
    second = replace(first, environment=lopsided(), instances=tuple(replace(i) for i in first.instances))
    relit = first.relit(environment=second.environment)
    pictures = [renderer.render(model, orthographic(), SETTINGS, SIZE).linear
                for model in (first, second, first, relit, first)]
    for picture in pictures[1:]:
        assert np.array_equal(picture, pictures[0])


def test_light_that_is_baked_anew_for_a_pose_compiles_nothing(context, work):
    materials = [Material(base_color=(0.9, 0.2, 0.1, 1.0), metallic=0.0, perceptual_roughness=0.3),
                 Material(metallic=0.0)]
    before = scene(plate(0), (plate(1), facing_floor(y=-1.0)), materials=materials, environment=lopsided())
    after = replace(before, instances=(replace(before.instances[0], transform=moved((0.3, -0.2, -0.4))),
                                       before.instances[1]))
    settings, renderer = replace(SETTINGS, indirect="baked", reflections="traced"), Renderer(context)
    renderer.render(before, orthographic(0.3, 0.4, height=4.0), settings, SIZE)
    assert work["programs"] > 5
    work.clear()
    renderer.render(after, orthographic(0.3, 0.4, height=4.0), settings, SIZE)
    assert not work
    renderer.release()


def test_indirect_light_follows_the_instances(context):
    """Its buffers are those of instances, the meshes' buffers stay."""
    materials = [Material(base_color=(0.9, 0.2, 0.1, 1.0), metallic=0.0), Material(metallic=0.0)]
    before = scene(plate(0), (plate(1), facing_floor(y=-1.0)), materials=materials, environment=lopsided())
    moving = replace(before.instances[0], transform=moved((0.3, -0.2, -0.4)))
    after = replace(before, instances=(before.instances[1], moving))
    camera, settings = orthographic(0.3, 0.4, height=4.0), replace(SETTINGS, indirect="baked")
    renderer, fresh = Renderer(context), Renderer(context)
    for model in (before, after, before):
        assert np.array_equal(renderer.render(model, camera, settings, SIZE).linear,
                              fresh.render(model, camera, settings, SIZE).linear)
        fresh.release()
        fresh = Renderer(context)
    renderer.release()
    fresh.release()


def test_a_renderer_that_is_gone_leaves_no_error_to_the_next(context):
    model = scene(sphere())
    for _ in range(2):  # the second begins where the first was released
        own = Renderer(context)
        own.render(model, orthographic(), SETTINGS, (8, 8))
        own.release()
        assert context.gl.error == "GL_NO_ERROR"
