"""The textures of the state of paths (shaders/trace/state.glsl): as few as a scene needs, and enough."""

from __future__ import annotations

import numpy as np
import pytest
from shapes import WHITE, constant, facing_floor, lopsided, moved, plate, scene, sphere

import viewer
from viewer.base.resources import resource_folder
from viewer.scene.camera import Camera
from viewer.scene.material import Material
from viewer.settings import Settings
from viewer.trace.paths.run import run
from viewer.trace.plan import TracePlan
from viewer.trace.tracer import Tracer

ASSETS = resource_folder("assets")


@pytest.mark.parametrize("name, textures", [("scenes/alpha.glb", 5), ("noise/many-lights.glb", 6),
                                            ("curves/fur.curves", 6), ("scenes/glass.glb", 7)])
def test_scenes_have_the_textures_that_they_need(context, name, textures):
    """Where surfaces are opaque, also with holes, shadow rays begin where paths do, and paths have no medium."""
    model = viewer.load(ASSETS / name, environment=None)
    tracer = Tracer(context)
    camera = Camera.framing(model.center, model.radius, 1.0)
    render = tracer.begin(model, camera, Settings.of(mode="path", spp=1), (16, 16))
    assert render.plan.state_textures == textures
    render.release()
    tracer.release()


def test_without_a_place_for_the_shadow_ray_the_picture_is_the_same(context, monkeypatch):
    """Shadow rays of paths that go on and that end, holes that paths pass, and paths that meet a lamp behind one."""
    lamp, veil = Material(emissive=(9.0, 9.0, 9.0)), Material(alpha_mode="blend", base_color=(1.0, 0.5, 0.2, 0.5))
    model = scene(sphere(segments=32), (plate(1), facing_floor(0.3, y=1.6)), (plate(2), moved((0, 0, 1.3), 0.8)),
                  materials=[WHITE, lamp, veil], environment=constant(0.1)).relit(environment=lopsided())
    camera = Camera.framing(model.center, model.radius, 1.0)
    pictures = []
    for textures in (5, 6):
        if textures > 5:
            monkeypatch.setattr(TracePlan, "state_textures", textures)
        tracer = Tracer(context)
        render = tracer.begin(model, camera, Settings.of(mode="path", spp=4), (32, 24))
        assert render.plan.state_textures == textures
        run(render, 0.0)
        pictures.append(render.read_radiance())
        render.release()
        tracer.release()
    assert pictures[0][..., :3].std() > 0.05
    assert np.array_equal(*pictures)
