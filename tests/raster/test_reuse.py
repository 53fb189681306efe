"""One renderer for many scenes, many renderers for one: the same pixels, and nothing is left behind."""

from __future__ import annotations

import ctypes
from dataclasses import replace

import numpy as np
import pytest
from shapes import lopsided, orthographic, plate, scene, sphere

import viewer
from viewer.base.resources import resource_folder
from viewer.errors import ContextError
from viewer.gpu.context import Context, create_context
from viewer.raster.renderer import Renderer
from viewer.scene.camera import Camera
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.settings import Settings

SIZE = (48, 48)
SETTINGS = Settings(antialias="msaa-4")
NAMES = ["textures", "alpha", "lights", "normal-map", "unlit"]


@pytest.fixture(scope="module")
def shots():
    loaded = [viewer.load(resource_folder("assets") / "scenes" / f"{name}.glb", environment=None) for name in NAMES]
    scenes = [replace(s, environment=lopsided() if k % 2 else None) for k, s in enumerate(loaded)]
    return [(s, s.cameras[0]) for s in scenes]


def test_two_renders_are_identical(renderer, shots):
    for model, camera in shots:
        for mode in ("pbr", "phong"):
            settings = replace(SETTINGS, mode=mode)
            a, b = (renderer.render(model, camera, settings, SIZE) for _ in range(2))
            assert np.array_equal(a.linear, b.linear) and np.array_equal(a.srgb, b.srgb)


def test_a_scene_looks_the_same_after_all_the_others(renderer, shots):
    first = [renderer.render(*shot, SETTINGS, SIZE).linear for shot in shots]
    for order in ((4, 2, 0, 1, 3), (1, 3, 4, 0, 2)):
        for k in order:
            assert np.array_equal(renderer.render(*shots[k], SETTINGS, SIZE).linear, first[k])


def test_two_renderers_in_turn(renderer, shots, context):
    """Two on one context, and one on another back end, drawing alternately."""
    other = Renderer(context)
    try:
        elsewhere = create_context("osmesa" if context.backend != "osmesa" else "egl")
    except ContextError:
        elsewhere = None
    third = Renderer(elsewhere) if elsewhere else other
    for shot in shots[:3]:
        pictures = [each.display(*shot, SETTINGS, SIZE).srgb for each in (renderer, other, third)]
        assert np.array_equal(pictures[0], pictures[1])
        assert np.abs(pictures[0].astype(int) - pictures[2]).max() <= 2
    other.release()
    if elsewhere is not None:
        third.release()
        elsewhere.release()
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


def test_fifty_scenes_one_after_the_other_leave_nothing_behind(renderer, shots, context):
    def draw(k: int) -> None:
        model, camera = shots[k % len(shots)]
        # A new environment, lights and size each time, as somebody does who tries things out.
        model = replace(model, lights=(*model.lights, Light.from_angles(k, 0.5, 1.0)), instances=tuple(model.instances))
        renderer.display(model, camera, replace(SETTINGS, mode=("pbr", "phong")[k // 5 % 2]), (40 + k % 3, 40))

    for k in range(10):
        draw(k)
    before = objects(context)
    for k in range(10, 60):
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


def test_what_scenes_share_is_not_uploaded_again(renderer):
    model = scene(sphere(), environment=lopsided())
    camera = Camera.framing(model.center, model.radius, 1.0)
    renderer.display(model, camera, SETTINGS, SIZE)
    surfaces = renderer._surfaces
    lit = replace(model, lights=(Light.from_angles(0.1, 0.5, 1.0),))
    picture = renderer.display(lit, camera, SETTINGS, SIZE).srgb
    assert not np.array_equal(picture, picture_of(renderer, (model, camera)))
    assert renderer._surfaces is surfaces


def test_a_renderer_that_is_gone_leaves_no_error_to_the_next(context):
    model = scene(sphere())
    for _ in range(2):  # the second begins where the first was released
        own = Renderer(context)
        own.render(model, orthographic(), SETTINGS, (8, 8))
        own.release()
        assert context.gl.error == "GL_NO_ERROR"
