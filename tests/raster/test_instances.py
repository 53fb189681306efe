"""Many instances of a mesh, which one call draws: the pictures are those of a call for each."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shapes import lopsided, scene

import viewer.plan.instances
import viewer.raster.instances
from viewer.plan.layers import plan_layers
from viewer.plan.planner import plan_scene
from viewer.raster.geometry import MeshBuffers
from viewer.scene.camera import Camera
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Instance, Scene
from viewer.scene.transform import handedness, normal_matrix, normals_and_hands
from viewer.settings import Settings

COUNT = 70
PLAIN = Settings(antialias="none", shadows="off")
RNG = np.random.default_rng(4)
CORNERS = np.float32([[0, 0, 1], [0.9, 0, -0.4], [-0.4, 0.8, -0.4], [-0.4, -0.8, -0.4]]) + np.float32([3, 0, 0])
FACES = np.uint32([0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2])
SPIKE = Mesh("spike", CORNERS, 0, indices=FACES, normals=CORNERS - np.float32([3, 0, 0]), uvs=(CORNERS[:, :2],),
             tangents=np.float32([[0, 1, 0, 1]] * 4), colors=RNG.random((4, 4), np.float32))
SUN = Light.from_angles(0.4, 0.6, 2.0)
SHINY = Material(metallic=0.6, perceptual_roughness=0.3, anisotropy_strength=0.7)
CASES = {"plain": {}, "phong": {"mode": "phong"}, "shadows of the sky": {"environment_shadows": "64"},
         "shadow on the ground": {"ground": "shadow"}, "traced reflections": {"reflections": "traced"},
         "everything": {"plan": "everything"}, "normals": {"show": "normal"}}


def transforms(count: int = COUNT) -> np.ndarray:
    """Turned, stretched, sheared and, every third, mirrored, about places within 4 of the origin."""
    linear = np.linalg.qr(RNG.normal(size=(count, 3, 3)))[0] @ (np.eye(3) + RNG.uniform(-0.3, 0.3, (count, 3, 3)))
    linear[::3] *= np.sign(np.linalg.det(linear[::3]))[:, None, None] * -1
    out = np.tile(np.eye(4), (count, 1, 1))
    out[:, :3, :3] = linear * 0.6
    out[:, :3, 3] = RNG.uniform(-4, 4, (count, 3))
    return out


def crowd(material: Material = SHINY, places: np.ndarray | None = None) -> Scene:
    """The spikes, and among them a mesh that is there once."""
    alone = replace(SPIKE, name="alone")
    model = scene(SPIKE, alone, materials=(material,), lights=(SUN,), environment=lopsided())
    found = [Instance(0, place) for place in (transforms() if places is None else places)]
    found.insert(5, Instance(1, np.diag([2.0, 2, 2, 1])))
    return replace(model, instances=tuple(found))


CROWD = crowd()
EYES = {"all": np.array([0.0, 3, 16]), "within": np.array([0.5, 0.2, 0.1])}


def camera(eye: np.ndarray) -> Camera:
    return Camera.look_at(eye, np.array([0.0, 0, -4]), fov_y=1.0)


@pytest.fixture
def one_by_one(monkeypatch):
    """Draws with a call for each instance from when it is called."""
    return lambda: monkeypatch.setattr("viewer.plan.instances.INSTANCED_FROM", COUNT + 2)


def planned(model: Scene, **settings: object):
    return plan_scene(model, Settings.of(**settings), model.lights, samples=4, half_target=False, orthographic=False)


@pytest.mark.parametrize("settings", CASES.values(), ids=CASES)
def test_one_call_gives_the_pictures_of_many(renderer, one_by_one, settings):
    wanted, size = Settings.of(**settings), (48, 48)
    at_once = [renderer.render(CROWD, camera(eye), wanted, size).linear for eye in EYES.values()]
    model = crowd(places=np.stack([i.transform for i in CROWD.instances if i.mesh == 0]))  # not what was prepared
    one_by_one()
    for picture, eye in zip(at_once, EYES.values(), strict=True):
        other = renderer.render(model, camera(eye), wanted, size).linear
        # The depths of shadow maps are rounded after one more product: a few points of their rims change sides.
        assert (np.abs(picture - other) > 1e-5).any(axis=-1).sum() <= (8 if "shadow" in str(settings) else 0)
        assert np.ptp(picture[..., :3]) > 0.1


def test_fragments_are_counted_in_the_order_in_which_they_are_drawn(renderer, one_by_one):
    counts = [renderer.render(CROWD, camera(EYES["all"]), Settings(show="overdraw"), (48, 48)).linear]
    model = crowd(places=np.stack([i.transform for i in CROWD.instances if i.mesh == 0]))
    one_by_one()
    counts.append(renderer.render(model, camera(EYES["all"]), Settings(show="overdraw"), (48, 48)).linear)
    np.testing.assert_array_equal(*(picture[..., :3].any(axis=-1) for picture in counts))
    assert not np.array_equal(*counts)  # a mesh is drawn after another, and not in turn


@pytest.mark.parametrize("mode", ["pbr", "path"])
def test_layers_tell_each_instance(renderer, one_by_one, mode):
    names = ["instance", "material", "normal", "depth", "albedo"]
    seen = [renderer.layers(CROWD, camera(EYES["all"]), Settings(mode=mode), (64, 64), names)]
    one_by_one()
    model = crowd(places=np.stack([i.transform for i in CROWD.instances if i.mesh == 0]))
    seen.append(renderer.layers(model, camera(EYES["all"]), Settings(mode=mode), (64, 64), names))
    for name in names:
        np.testing.assert_array_equal(seen[0][name], seen[1][name])
    assert len(np.unique(seen[0]["instance"])) > 30 and 6 in seen[0]["instance"]


def test_what_has_moved_is_drawn_where_it_is(renderer, monkeypatch):
    """Others are mirrored then, so that other calls draw them; a part of a call has 12 instances."""
    monkeypatch.setattr("viewer.raster.instances.MOST_VERTICES", 50)
    drawn = []
    real = MeshBuffers.draw_instances
    monkeypatch.setattr(MeshBuffers, "draw_instances",
                        lambda self, program, part, count: drawn.append(count) or real(self, program, part, count))
    places = transforms()
    for k, moved in enumerate((places, places + np.eye(4)[0][:, None] * (0, 0, 0, 0.5), places[::-1], -places)):
        moved = moved.copy()
        moved[:, 3] = 0, 0, 0, 1
        model = crowd(places=moved)
        drawn.clear()
        found = renderer.render(model, camera(EYES["all"]), PLAIN, (48, 48)).linear
        mirrored = sum(handedness(place) < 0 for place in moved)
        assert len(drawn) == -(-mirrored // 12) + -(-(COUNT - mirrored) // 12) and sum(drawn) <= COUNT
        renderer.render(crowd(Material()), camera(EYES["all"]), PLAIN, (48, 48))
        again = renderer.render(model, camera(EYES["all"]), PLAIN, (48, 48)).linear
        np.testing.assert_array_equal(found, again, err_msg=str(k))


def test_what_one_call_draws():
    kinds = planned(CROWD).kinds
    assert [(len(draw.instances), draw.program["INSTANCED"]) for draw in kinds] == [(COUNT, 1), (0, 0)]
    assert planned(CROWD).count(kinds[0]) == COUNT
    assert f"2 draws with 2 programs, of {COUNT} instances at once" in planned(CROWD).used
    glass = Material(metallic=0.0, transmission=1.0, thickness=1.0)
    for material, settings in ((Material(alpha_mode="blend"), {}), (glass, {}), (Material(), {"indirect": "baked"})):
        assert not any(draw.instances for draw in planned(crowd(material), **settings).draws)
    few = replace(CROWD, instances=CROWD.instances[:viewer.plan.instances.INSTANCED_FROM])
    assert not any(draw.instances or draw.program["INSTANCED"] for draw in planned(few).draws)
    assert not any(draw.instances for draw in plan_layers(CROWD, Settings(), ["motion"], False).draws)


def test_matrices_of_normals_are_those_of_each_instance():
    places = np.concatenate([transforms(40), np.zeros((1, 4, 4)), np.diag([1e-20, 3, 1, 1])[None]])
    normals, hands = normals_and_hands(places)
    np.testing.assert_array_equal(hands, [handedness(place) for place in places])
    np.testing.assert_array_equal(normals, [normal_matrix(place) for place in places])
    assert (hands < 0).any() and (hands > 0).any()


def test_places_are_rounded_last(context):
    """A million units from the origin, where float32 has steps of 1/16, they stand as they do at the origin."""
    read = []
    places = transforms()
    for offset in (0.0, 1e6):
        moved = places.copy()
        moved[:, :3, 3] += offset
        model = scene(*[(SPIKE, place) for place in moved])
        model = replace(model, meshes=(SPIKE,), instances=tuple(replace(i, mesh=0) for i in model.instances))
        buffers = MeshBuffers(context, SPIKE)
        [part, *_] = buffers.instances(model, tuple(range(COUNT)))
        assert part.show(EYES["all"] + offset) == part.count
        read.append(np.frombuffer(part._buffers[1].read(), np.float32).copy())
        buffers.release()
    np.testing.assert_allclose(read[0], read[1], rtol=2e-7, atol=1e-9)
