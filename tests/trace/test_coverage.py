"""Pixels that no geometry can touch are found, resolved once and never traced; all others are as they were."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from pictures import picture
from shapes import WHITE, constant, moved, orthographic, plate, scene, sphere
from strands import strands

from viewer.scene.camera import Camera
from viewer.scene.environment import Environment
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Scene
from viewer.settings import Settings
from viewer.trace.paths import coverage as coverage_module
from viewer.trace.paths import curve_runs as runs_module
from viewer.trace.paths.camera_rays import projection
from viewer.trace.paths.coverage import LastCoverage, coverage
from viewer.trace.paths.schedule import PILOT
from viewer.trace.paths.sky import MOST_POINTS, points_of
from viewer.trace.scene.curves import trace_curves
from viewer.trace.scene.geometry import trace_geometry

SIZE = (60, 44)
VIEW = Camera.look_at((3.0, 2.0, 4.0), (0, 0, 0), fov_y=0.6)


def noise() -> Environment:
    return Environment("noise", np.random.default_rng(3).random((32, 64, 3), np.float32), rotation=0.7, intensity=1.5)


def soup() -> Scene:
    """Triangles of all sizes: dust, slivers, and some that reach far beyond the picture."""
    rng = np.random.default_rng(8)
    size = 10 ** rng.uniform(-3, 0.3, (60, 1, 1))
    corners = rng.normal(0, 0.3, (60, 1, 3)) + size * rng.normal(size=(60, 3, 3))
    corners[:30, 2] = corners[:30, 1] + 1e-5  # slivers
    return scene(Mesh("soup", corners.reshape(-1, 3).astype(np.float32), 0))


def covered_by_samples(model: Scene, camera: Camera, size: tuple[int, int], each: int) -> np.ndarray:
    """Which pixels (H, W) have a triangle at any of `each` points along each axis or at a point of an edge."""
    geometry = trace_geometry(model)
    matrix, offset, _ = projection(model, camera, size)
    covered = np.zeros((size[1], size[0]), bool)
    points = [(np.arange(each * side) + 0.5) / each for side in size]
    for instance in geometry.instances:
        mesh = geometry.meshes[instance.mesh]
        x, y, w = ((mesh.positions @ instance.transform[:, :3].T + instance.transform[:, 3]) @ matrix.T + offset).T
        pixels = np.stack([(x / w + 1) * size[0] / 2, (y / w + 1) * size[1] / 2], axis=1)
        for corners in pixels[mesh.triangles]:
            a, b, c = corners
            (ux, uy), (vx, vy) = b - a, c - a
            area = ux * vy - uy * vx
            inside = np.ones((len(points[1]), len(points[0])), bool)
            for p, q in ((a, b), (b, c), (c, a)):
                inside &= ((q - p)[0] * (points[1][:, None] - p[1]) - (q - p)[1] * (points[0] - p[0])) * area >= 0
            covered |= inside.reshape(size[1], each, size[0], each).any(axis=(1, 3))
            along = np.concatenate([p + (q - p) * np.linspace(0, 1, 400)[:, None] for p, q in ((a, b), (b, c), (c, a))])
            cells = np.floor(along).astype(int)
            cells = cells[((cells >= 0) & (cells < size)).all(axis=1)]
            covered[cells[:, 1], cells[:, 0]] = True
    return covered


@pytest.mark.parametrize("camera", [VIEW, orthographic(0.5, 0.4, height=3.0),
                                    replace(VIEW, principal=(0.7, 0.45), pixel_aspect=1.4)],
                         ids=["perspective", "orthographic", "shifted"])
def test_no_triangle_is_in_a_pixel_that_is_not_covered(camera):
    """And what is covered is hardly more than the neighbourhood of what is."""
    model = soup()
    found, seen = coverage(trace_geometry(model), model, camera, SIZE), covered_by_samples(model, camera, SIZE, 3)
    assert found is not None and not (seen & ~found).any()
    padded = np.pad(seen, 3)
    near = np.any([padded[y:y + SIZE[1], x:x + SIZE[0]] for y in range(7) for x in range(7)], axis=0)
    assert not (found & ~near).any() and 0.2 < found.mean() < 0.9


@pytest.mark.parametrize("runs", [1 << 18, 20])
@pytest.mark.parametrize("camera", [VIEW, orthographic(0.5, 0.4, height=3.0)], ids=["perspective", "orthographic"])
def test_no_curve_is_in_a_pixel_that_is_not_covered(monkeypatch, runs, camera):
    """Each segment with a box of its own, or several with one. Points on the spheres that touch a segment from within
    are looked for."""
    monkeypatch.setattr(runs_module, "_RUNS", runs)
    model = Scene("strands", curves=strands())
    geometry, rng = trace_geometry(model, curves=trace_curves(model)), np.random.default_rng(4)
    found = coverage(geometry, model, camera, SIZE)
    first = geometry.curves.first.astype(int)
    a, b = (geometry.curves.points[rows][:, None] for rows in (first, first + 1))
    center = a + rng.random((1, 500, 1)) * (b - a)
    out = rng.normal(size=(len(first), 500, 3))
    points = center[..., :3] + center[..., 3:] * out / np.linalg.norm(out, axis=-1, keepdims=True)
    matrix, offset, _ = projection(model, camera, SIZE)
    x, y, w = (points.reshape(-1, 3) @ matrix.T + offset).T
    cells = np.floor(np.stack([(x / w + 1) * SIZE[0] / 2, (y / w + 1) * SIZE[1] / 2], axis=1)).astype(int)
    cells = cells[((cells >= 0) & (cells < SIZE)).all(axis=1)]
    assert found is not None and found[cells[:, 1], cells[:, 0]].all() and found.mean() < 0.95


def test_each_few_pixels_are_those_of_the_whole_picture():
    model = soup()
    whole = coverage(trace_geometry(model), model, VIEW, (61, 47))
    assert whole is not None
    some = coverage(trace_geometry(model), model, VIEW, (61, 47), every=3)
    np.testing.assert_array_equal(some, whole[1::3, 1::3][:15, :20])


@pytest.mark.parametrize("unit", [1e-6, 1e6])
def test_a_scene_of_a_micron_and_one_of_a_thousand_kilometres(unit):
    model, place = scene(sphere(segments=16)), np.array([3.0, -2.0, 5.0]) * unit
    other = scene((sphere(segments=16), moved(place, unit)))
    eye = np.array([0.3, 1.0, 4.0])
    expected = coverage(trace_geometry(model), model, Camera.look_at(eye, (0, 0, 0), fov_y=0.8), SIZE)
    camera = Camera.look_at(place + unit * eye, place, fov_y=0.8)
    assert expected is not None and 0.1 < expected.mean() < 0.9
    np.testing.assert_array_equal(coverage(trace_geometry(other), other, camera, SIZE), expected)


@pytest.mark.parametrize("chunk, most", [(1 << 20, 2), (1000, 40)])
def test_many_instances_are_counted_together(monkeypatch, chunk, most):
    """Each count goes over the whole picture, which took milliseconds for each instance."""
    rng, ball = np.random.default_rng(5), sphere(segments=8)
    places = [moved(place, 0.2) for place in rng.normal(0, 0.5, (60, 3))]
    parts = [scene((ball, place)) for place in places]
    model = replace(parts[0], instances=tuple(replace(part.instances[0]) for part in parts))
    geometry, calls, bincount = trace_geometry(model), [], np.bincount
    alone = [coverage(replace(geometry, instances=[instance]), model, VIEW, SIZE) for instance in geometry.instances]
    monkeypatch.setattr(coverage_module, "_CHUNK", chunk)
    monkeypatch.setattr(np, "bincount", lambda *given, **named: calls.append(1) or bincount(*given, **named))
    found = coverage(geometry, model, VIEW, SIZE)
    np.testing.assert_array_equal(found, np.any(alone, axis=0))
    assert 2 <= len(calls) <= most and 0.1 < found.mean() < 0.9


def test_the_last_answer_is_kept_until_something_else_is_asked(monkeypatch):
    model, calls = soup(), []
    geometry, other = trace_geometry(model), Camera.look_at((0.0, 2.0, 6.0), (0, 0, 0), fov_y=0.6)
    monkeypatch.setattr(coverage_module, "coverage", lambda *asked: calls.append(asked) or coverage(*asked))
    last = LastCoverage()
    asked = (geometry, model, VIEW, SIZE), (geometry, model, other, SIZE), (geometry, model, other, SIZE, 2)
    for each in asked:
        for _ in range(2):
            np.testing.assert_array_equal(last(*each), coverage(*each))
    assert calls == [(*each, 1)[:5] for each in asked]


def test_where_nothing_is_known_all_is_traced():
    """A triangle behind the eye, one at the eye, and a picture that triangles fill."""
    behind = scene(plate(), (plate(), moved((0, 0, 9))))
    filled = scene(plate(half=9.0))
    for model, camera in ((behind, Camera.look_at((0, 0, 5), (0, 0, 0))), (filled, orthographic(0, 0, height=1.0)),
                          (filled, Camera.look_at((0, 0, 1e-4), (0, 0, 0)))):
        assert coverage(trace_geometry(model), model, camera, SIZE) is None
    empty = Scene("empty", environment=constant())
    assert not coverage(trace_geometry(empty), empty, VIEW, SIZE).any()


@pytest.mark.parametrize("background", ["env", "none"])
def test_pixels_with_triangles_are_bit_identical_and_the_others_exact(tracer, monkeypatch, background):
    """Two samples are added in two steps, whose order does not matter. Without triangles a pixel has the mean of very
    many samples."""
    model = scene((sphere(segments=24), moved((0, 0, 0), 0.7)), materials=[WHITE], environment=noise())
    covered = coverage(trace_geometry(model), model, VIEW, SIZE)[::-1]
    assert 0.1 < covered.mean() < 0.5
    resolved = picture(tracer, model, VIEW, SIZE, spp=2, background=background)
    monkeypatch.setattr(tracer, "_coverage", lambda *_: None)
    traced = picture(tracer, model, VIEW, SIZE, spp=2, background=background)
    np.testing.assert_array_equal(resolved[covered], traced[covered])
    many = picture(tracer, Scene("empty", environment=model.environment), VIEW, SIZE, spp=256)[~covered]
    if background == "none":
        assert not resolved[~covered].any()
    else:
        np.testing.assert_allclose(resolved[~covered], many, atol=2e-3)
        assert np.abs(traced[~covered] - many).max() > 0.02


def test_samples_errors_and_layers_count_resolved_pixels(tracer):
    """Adaptive pictures too, whose film has two parts for the denoiser: each pixel has samples, none is bad, and what
    was not traced has no error."""
    model = scene((sphere(segments=24), moved((0, 0, 0), 0.7)), materials=[WHITE], environment=noise())
    covered = coverage(trace_geometry(model), model, VIEW, SIZE)[::-1]
    settings = Settings.of(mode="path", spp=96, error=1e-3, denoise="fast")
    image = tracer.render(model, VIEW, settings, SIZE, layers=("samples", "variance", "albedo", "distance"))
    samples = image.layers["samples"]
    assert image.stats["bad_samples"] == 0 and samples.min() >= PILOT and samples.max() > samples.min()
    assert image.stats["spp"] == pytest.approx(samples.mean()) == pytest.approx(96, abs=0.01)
    assert np.isfinite(image.linear).all() and (image.linear[..., 3] == 1).all()
    assert image.layers["variance"][~covered].max() < 1e-6 < image.layers["variance"][covered].max()
    assert not image.layers["albedo"][~covered].any() and np.isinf(image.layers["distance"][~covered]).all()
    assert image.stats["rays"] < 2.5 * covered.sum() * image.layers["samples"].max()


def test_a_picture_without_triangles_is_done_at_once(tracer):
    """With the error that was asked for, and within a time budget, which a picture without noise never uses up."""
    empty = Scene("empty", environment=noise())
    for more in ({"spp": 4096}, {"error": 0.01}, {"time_budget": 0.05}):
        image = tracer.render(empty, VIEW, Settings.of(mode="path", **more), (40, 30))
        assert image.stats["rays"] == 0 and image.stats["spp"] > 0 and image.stats["bad_samples"] == 0


def test_more_points_where_a_pixel_crosses_more_of_the_map():
    assert [points_of(rows, 0.01) for rows in (0, 100, 300, 10_000)] == [2, 3, 4, MOST_POINTS]
