"""The ways of rays in fog that thins out with height, and beside volumes: GLSL and numpy against float64."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from fog_truth import density
from harness import evaluate
from shapes import moved, scene, sphere

from viewer.scene.fog import Fog, fog_of
from viewer.scene.volume import Volume
from viewer.settings import Settings
from viewer.trace.layout import MEDIA_REACH
from viewer.trace.scene.fog import mean_density
from viewer.trace.scene.geometry import trace_geometry
from viewer.trace.scene.scene_data import SceneData


def test_the_mean_density_is_the_integral():
    rng = np.random.default_rng(1)
    ends = rng.normal(size=(50, 2)) * np.logspace(-6, 1.5, 50)[:, None]
    x, w = np.polynomial.legendre.leggauss(200)
    for y0, y1 in ends:
        pieces = np.unique(np.clip([min(y0, y1), 0, max(y0, y1)], min(y0, y1), max(y0, y1)))
        total = sum((np.exp(-np.maximum((a + b) / 2 + (b - a) / 2 * x, 0)) * w).sum() * (b - a) / 2
                    for a, b in pairwise(pieces))
        assert mean_density(np.array(y0), np.array(y1)) == pytest.approx(total / abs(y1 - y0), rel=1e-9)


def test_distances_invert_the_optical_depth(context, tmp_path):
    """Over slopes from level to steep, up and down, through the base, from 1e-6 to 1e6 scale heights a unit."""
    rng = np.random.default_rng(2)
    count = 20000
    y = np.where(rng.random(count) < 0.5, 1, -1) * 10 ** rng.uniform(-6, 1.3, count)
    k = np.where(rng.random(count) < 0.5, 1, -1) * 10 ** rng.uniform(-6, 6, count)
    k[:200] = 0.0
    t = 10 ** rng.uniform(-6, 0.9, count)
    y, k = (values.astype(np.float32).astype(float) for values in (y, k))
    s = (t * mean_density(y, y + k * t)).astype(np.float32)
    rows = np.stack([y, k, s], axis=1).astype(np.float32)
    found = evaluate(context, tmp_path, "media/height_fog.glsl",
                     "o0 = vec4(distance_to_dense(f0.x, f0.y, f0.z));", rows)[:, 0, 0]
    # Where the rest of a rising way has next to no density, rounding of s decides about the end.
    above = np.where(k > 0, np.exp(-np.maximum(y, 0)) / np.maximum(k, 1e-30) + np.maximum(-y, 0) / np.maximum(k, 1e-30),
                     np.inf)
    sure = s < above * (1 - 1e-5)
    assert sure.mean() > 0.7
    back = found * mean_density(y, y + k * found)
    assert np.abs(back / s - 1)[sure].max() < 1e-4
    assert np.median(np.abs(back / s - 1)[sure]) < 3e-7
    assert np.isfinite(found).all() and (found >= 0).all()
    beyond = evaluate(context, tmp_path, "media/height_fog.glsl", "o0 = vec4(distance_to_dense(f0.x, f0.y, f0.z));",
                      np.float32([[0.0, 2.0, 0.6], [-1.0, 2.0, 1.2], [3.0, 1.0, 0.1]]))[:, 0, 0]
    assert (beyond > 1e38).all()  # the fog ahead is not that deep


@pytest.mark.parametrize("height", [0.0, 0.3])
@pytest.mark.parametrize("volumes", [0, 3])
def test_the_ways_of_rays(context, tmp_path, height, volumes):
    """Lengths by GLSL and by numpy against the midpoint rule, and the distances of lengths, which are their inverse."""
    turned = moved((0.2, 0.1, -0.3), (0.04, 0.06, 0.05))
    turned[:3, :3] = turned[:3, :3] @ np.array([[0.8, -0.6, 0.0], [0.6, 0.8, 0.1], [0, 0, 1]])
    boxes = (Volume("turned", np.ones((6, 7, 8), np.float32), turned),
             *(Volume.in_box(np.ones((1, 2, 3), np.float32), box)
               for box in ([[-0.9, -0.5, -0.5], [0.1, 0.5, 0.5]], [[0.0, -0.2, -0.2], [0.4, 0.9, 0.2]])))[:volumes]
    model = replace(scene((sphere(segments=8), moved((0.3, 0.2, 0.1)))), volumes=boxes)
    settings = Settings.of(fog=1.0, fog_height=height)
    fog = fog_of(model, settings)
    geometry = trace_geometry(model, fog=fog)
    data = SceneData(context, model, geometry)
    data.upload()
    rng = np.random.default_rng(3)
    o, d = rng.uniform(-1, 1, (150, 3)), rng.normal(size=(150, 3))
    o[:40] *= 5  # some begin outside of the ball
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    d[-20:] = np.eye(3)[rng.integers(0, 3, 20)]
    ends = np.sort(rng.uniform(0, 5, (150, 2)), axis=1)
    rows = np.zeros((150, 16), np.float32)
    rows[:, 0:3], rows[:, 4:7], rows[:, 8:10] = o, d, ends
    body = """
        vec2 span = media_span(f0.xyz, f1.xyz);
        float all = fog_length(f0.xyz, f1.xyz, 0.0, 100.0), part = fog_length(f0.xyz, f1.xyz, f2.x, f2.y);
        o0 = vec4(part, all, fog_length(f0.xyz, f1.xyz, 0.0, fog_distance(f0.xyz, f1.xyz, 0.7 * all)),
                  fog_distance(f0.xyz, f1.xyz, 1.01 * all + 1e-3));"""
    switches = data.switches | {"HAS_SCATTERING": 1, "HAS_VOLUME": 1}
    found = evaluate(context, tmp_path, "media/medium.glsl", body, rows, switches=switches, bind=data.bind)[:, 0]
    data.release()

    starts, way = model.center + model.radius * o, model.radius * (ends[:, 1] - ends[:, 0])
    first = starts + model.radius * ends[:, :1] * d
    count = 20000
    expected = np.array([_depth(fog, boxes, *ray, count) for ray in zip(first, d, way, strict=True)]) / model.radius
    assert found[:, 0] == pytest.approx(expected, abs=5 * 20 / count)
    inside = np.linalg.norm(o, axis=1) < 1.8
    numpys = geometry.fog.length(o, d, ends[:, 0], np.minimum(ends[:, 1], _exit(o, d)))
    assert numpys[inside] == pytest.approx(found[inside, 0], abs=2e-5)
    assert found[:, 2] == pytest.approx(0.7 * found[:, 1], rel=2e-4, abs=1e-5)
    assert (found[:, 3] > 1e38).all()


def _exit(o: np.ndarray, d: np.ndarray) -> np.ndarray:
    b = (o * d).sum(axis=1)
    return np.maximum(-b + np.sqrt(np.maximum(b * b - (o * o).sum(axis=1) + MEDIA_REACH**2, 0)), 0)


def _depth(fog: Fog, boxes: Sequence[Volume], start: np.ndarray, direction: np.ndarray, way: float,
           count: int) -> float:
    """The optical depth of the fog beside the boxes, by the midpoint rule."""
    points = start + (np.arange(count) + 0.5)[:, None] / count * way * direction
    free = density(fog, points)
    for box in boxes:
        index = (points - box.index_to_world[:3, 3]) @ np.linalg.inv(box.index_to_world[:3, :3]).T
        size = np.array(box.density.shape[::-1])
        free = free * ~((index > -0.5) & (index < size - 0.5)).all(axis=1)
    return float(free.mean() * way)
