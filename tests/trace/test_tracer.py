"""The tracer as a whole: it is deterministic, takes all samples and compiles only the code that a scene needs."""

from __future__ import annotations

import gc
import json
import weakref
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from pictures import halves, picture
from shapes import WHITE, constant, facing_floor, moved, orthographic, plate, scene, sphere

from viewer.gpu import programs
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.settings import Settings
from viewer.trace.rays import bvh4, bvh_shader
from viewer.trace.tracer import Tracer

VIEW = orthographic(0.5, 0.4, height=3.0)
METAL = Material(perceptual_roughness=0.4, base_color=(0.9, 0.6, 0.3, 1))
GLOW = Material(emissive=(2.0, 3.0, 4.0), double_sided=True)


def still_life():
    """A metal ball on a white floor under an emissive plate, in grey light."""
    lifted = facing_floor(0.5, y=1.4)
    return scene(sphere(segments=32), (plate(1, 3.0), facing_floor(y=-1.0)), (plate(2), lifted),
                 materials=[METAL, WHITE, GLOW], environment=constant(0.5))


@pytest.fixture(scope="module")
def model():
    return still_life()


def render_path(tracer, model, size, seconds=0.25, **settings):
    path_render = tracer.begin(model, VIEW, Settings.of(mode="path", **settings), size)
    while not path_render.is_done:
        path_render.step(seconds)
    assert path_render.bad_samples == 0
    return path_render


def test_the_same_input_gives_the_same_pixels(tracer, model):
    """The pixels do not depend on the length of the steps or on the tracer."""
    first, second = (render_path(tracer, model, (50, 40), seconds, spp=8).image().linear for seconds in (0.0, 1.0))
    np.testing.assert_array_equal(first, second)
    fresh = Tracer(tracer.context)
    np.testing.assert_array_equal(fresh.render(model, VIEW, Settings.of(mode="path", spp=8), (50, 40)).linear, first)
    fresh.release()


def test_another_seed_is_other_noise(tracer, model):
    both = halves(tracer, model, VIEW, (32, 32), spp=64)
    assert not np.array_equal(both.first, both.second)
    assert both.first.mean() == pytest.approx(both.second.mean(), rel=0.02)


@pytest.mark.parametrize("size", [(1, 1), (17, 33), (300, 20), (3, 200)])
@pytest.mark.parametrize("spp", [1, 13])
def test_every_pixel_gets_its_samples(tracer, model, size, spp):
    path_render = render_path(tracer, model, size, spp=spp)
    total, squares = path_render.film.read_sums()
    assert (total[..., 3] == spp).all()
    assert (squares[..., 3] == spp).all()
    assert path_render.samples == spp
    assert path_render.image().linear.shape == (size[1], size[0], 4)


def test_a_picture_can_be_taken_at_any_time(tracer, model):
    path_render = tracer.begin(model, VIEW, Settings.of(mode="path", spp=64), (40, 30))
    assert path_render.image().linear[..., :3].max() == 0
    seen = [0.0]
    while not path_render.is_done:
        path_render.step(0.0)
        if path_render.samples > seen[-1]:
            seen.append(path_render.samples)
            assert path_render.rays >= seen[-1] * 40 * 30
    assert seen[-1] == 64 and len(seen) > 4
    assert np.isfinite(path_render.image().linear).all()


def test_the_estimated_error_is_that_of_the_picture(tracer, model):
    """The estimate is compared with the deviation of ten pictures.

    Low-discrepancy samples make the true error smaller.
    """
    pictures = [render_path(tracer, model, (32, 32), spp=16, seed=seed) for seed in range(10)]
    light = np.stack([path_render.image().linear[..., :3].astype(np.float64) for path_render in pictures])
    spread = np.sqrt((light.var(axis=0, ddof=1) / (light.mean(axis=0)**2 + 0.01)).mean())
    estimate = np.mean([path_render.error for path_render in pictures])
    assert 0.8 * spread < estimate < 3 * spread


def test_the_bvh_gives_the_same_picture(tracer, model):
    """Both intersectors agree, except for rays at an edge, which may hit either triangle."""
    settings = Settings.of(mode="path", spp=4)
    other = Tracer(tracer.context, intersector="bvh")
    found, expected = (each.render(model, VIEW, settings, (48, 32)).linear for each in (other, tracer))
    other.release()
    assert np.isclose(found, expected, rtol=1e-3).all(axis=-1).mean() > 0.97
    assert found[..., :3].mean() == pytest.approx(expected[..., :3].mean(), rel=0.01)


@pytest.mark.parametrize("settings", [{"sampling": "bsdf"}, {"sampling": "lights"}])
def test_each_way_to_find_light_finds_as_much(tracer, model, settings):
    """With roughness 0.4 and a wide lamp, each technique alone has little enough noise for a comparison."""
    expected = halves(tracer, model, VIEW, (24, 24), spp=128)
    found = halves(tracer, model, VIEW, (24, 24), spp=256, **settings)
    both = found.against(expected.mean, expected.floor(expected.mean))
    assert both.mean_sigma < 0.006
    assert both.mean_ratio == pytest.approx(1, abs=0.02)
    assert both.excess < 1.6


def test_the_background_is_the_rasters(tracer):
    model = scene(sphere(segments=32), environment=constant(0.7))
    shown = picture(tracer, model, VIEW, spp=4)
    np.testing.assert_allclose(shown[0, 0], (0.7, 0.7, 0.7, 1), rtol=1e-6)
    none = picture(tracer, model, VIEW, spp=4, background="none")
    np.testing.assert_array_equal(none[0, 0], 0)
    np.testing.assert_allclose(none[16, 16], shown[16, 16], rtol=1e-6)
    color = picture(tracer, model, VIEW, spp=4, background=(0.1, 0.2, 0.3))
    np.testing.assert_allclose(color[0, 0], (0.1, 0.2, 0.3, 1), rtol=1e-6)
    np.testing.assert_allclose(color[16, 16], shown[16, 16], rtol=1e-6)


def test_unlit_surfaces_look_as_they_are(tracer):
    model = scene(plate(), materials=[Material(unlit=True, base_color=(0.2, 0.5, 0.8, 1))], environment=constant())
    shown = picture(tracer, model, orthographic(0, 0, height=1.0), (8, 8), spp=2)
    np.testing.assert_allclose(shown[..., :3], np.broadcast_to((0.2, 0.5, 0.8), (8, 8, 3)), rtol=1e-6)


def test_a_clamp_takes_indirect_light_alone(tracer):
    """A wall beside the floor reflects the sun's light."""
    wall = np.eye(4)
    wall[:3, 3] = 0, 0, -1
    lamp = Light("directional", intensity=3.0, direction=(0, -1, -0.3))
    model = scene((plate(), facing_floor(y=-1.0)), (plate(), wall), lights=(lamp,))
    whole, direct = (picture(tracer, model, VIEW, spp=64, bounces=bounces).mean() for bounces in (8, 1))
    clamped, tight = (picture(tracer, model, VIEW, spp=64, bounces=8, clamp=clamp).mean() for clamp in (1e3, 1e-9))
    assert clamped == pytest.approx(whole, rel=1e-6)
    assert tight == pytest.approx(direct, rel=1e-6)
    assert direct < 0.95 * whole


def test_the_plan_tells_what_is_left_out(tracer, model):
    plan = tracer.begin(model, VIEW, Settings.of(mode="path", spp=1), (8, 8)).plan
    assert json.loads(json.dumps(plan.to_json())) == plan.to_json()
    text = "\n".join(plan.left_out)
    for line in ("textures", "transmission: no surface has it", "normal maps", "absorption in volumes",
                 "point, spot"):
        assert line in text
    for line in ("emission", "from an environment", "emissive triangles"):
        assert line not in text
    assert "glass" not in plan.programs and "layers" not in plan.programs
    dark = replace(model, environment=None, instances=model.instances[:2])
    plan = tracer.begin(dark, VIEW, Settings.of(mode="path", spp=1), (8, 8)).plan
    assert any(line.startswith("shadow rays") for line in plan.left_out)
    assert dict(plan.programs["surface"].switches)["HAS_LIGHTS"] == 0


def test_an_empty_scene_is_its_background(tracer):
    empty = scene(environment=constant(0.3))
    shown = picture(tracer, empty, VIEW, (20, 10), spp=2)
    np.testing.assert_allclose(shown, np.broadcast_to((0.3, 0.3, 0.3, 1), (10, 20, 4)), rtol=1e-6)


def poses(count: int = 3):
    """The still life with a ball that grows long and rises, twice, one of the two in the shadow of the plate."""
    first = still_life()
    again = replace(first.instances[0], transform=moved((0.9, -0.5, 0.4), 0.3))
    first = replace(first, instances=(*first.instances, again), lights=(Light.from_angles(0.4, 0.9, 2.0),))
    yield first
    for k in range(1, count):
        ball = replace(first.meshes[0], positions=first.meshes[0].positions * np.float32([1, 1 + 0.2 * k, 1]))
        raised = replace(first.instances[0], transform=moved((0.1 * k, 0.2 * k, 0), 0.6))
        metal = replace(first.materials[0], base_color=(0.2, 0.3 * k, 0.9, 1.0))
        yield replace(first, meshes=(ball, *first.meshes[1:]), instances=(raised, *first.instances[1:]),
                      materials=(metal, *first.materials[1:]))


@pytest.mark.parametrize("intersector", ["embree", "bvh"])
def test_a_pose_is_traced_as_by_a_tracer_that_has_seen_no_other(context, monkeypatch, intersector):
    """Refitted trees find the same hits; textures are not uploaded and programs not compiled again."""
    settings = Settings.of(mode="path", spp=4, bounces=3)
    ours, work = Tracer(context, intersector=intersector), Counter()
    for owner, name in ((programs, "compile_program"), (bvh_shader, "compile_program"), (bvh4, "build")):
        real = getattr(owner, name)
        monkeypatch.setattr(owner, name, lambda *args, real=real, name=name, **kwargs: (
            work.update([name]), real(*args, **kwargs))[1])
    pictures = []
    for pose in poses():
        pictures.append(ours.render(pose, VIEW, settings, (32, 32)).linear)
        if len(pictures) == 1:
            assert work["compile_program"] and work["build"] == (3 if intersector == "bvh" else 0)
            work.clear()
    assert not work, "the next poses compile and build nothing"
    for pose, found in zip(poses(), pictures, strict=True):
        fresh = Tracer(context, intersector=intersector)
        np.testing.assert_array_equal(fresh.render(pose, VIEW, settings, (32, 32)).linear, found)
        fresh.release()
    assert not np.array_equal(pictures[0], pictures[1]) and not np.array_equal(pictures[1], pictures[2])
    ours.release()


def test_a_tracer_that_forgets_frees_the_scene_and_traces_it_again_alike(tracer):
    """Before the next model is loaded: memory never holds two."""
    model, settings = still_life(), Settings.of(mode="path", spp=2)
    first = tracer.render(model, VIEW, settings, (16, 16)).linear
    mesh = weakref.ref(model.meshes[0])
    del model
    gc.collect()
    assert mesh() is not None
    tracer.forget()
    gc.collect()
    assert mesh() is None and tracer.context.gl.error == "GL_NO_ERROR"
    np.testing.assert_array_equal(tracer.render(still_life(), VIEW, settings, (16, 16)).linear, first)
