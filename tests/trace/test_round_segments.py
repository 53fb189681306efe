"""Rays meet round segments where the union of the spheres along them is, in float32 and for thin fibres, too."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from curve_twins import closeness, depth, entry, random_rays
from harness import evaluate

from viewer.gpu.context import Context

COUNT = 4_000
ENTER = "float along; o0 = vec4(segment_entry(f0.xyz, f1.xyz, f2, f3, along), along, 0.0, 0.0);"


def glsl(context: Context, folder: Path, body: str, *columns: np.ndarray) -> np.ndarray:
    rows = np.zeros((len(columns[0]), 16), np.float32)
    for k, values in enumerate(columns):
        rows[:, 4 * k : 4 * k + values.shape[1]] = values
    return evaluate(context, folder, "trace/curve.glsl", body, rows)[:, 0]


def entries(context: Context, folder: Path, o: np.ndarray, d: np.ndarray, segments: np.ndarray) -> np.ndarray:
    return glsl(context, folder, ENTER, o, d, segments[:, 0], segments[:, 1])


@pytest.mark.parametrize("radius", [0.3, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6])
def test_rays_enter_where_the_spheres_are(context: Context, tmp_path: Path, radius: float) -> None:
    o, d, segments = random_rays(COUNT, radius)
    found = entries(context, tmp_path, o, d, segments)
    t, _ = entry(o, d, segments)
    # A coordinate of float32 is known to 1e-7 of the scene's radius. Where a ray grazes, that moves its hit by more.
    slack = 4e-7 + 1e-3 * radius
    gap = closeness(o, d, segments)
    is_hit = found[:, 0] < 1e29
    np.testing.assert_array_equal(is_hit[gap < -slack], True)
    np.testing.assert_array_equal(is_hit[gap > slack], False)
    clear = (gap < -slack) & np.isfinite(t)
    assert clear.mean() > 0.1
    hit = o[clear] + found[clear, :1] * d[clear].astype(np.float64)
    assert abs(depth(hit, segments[clear])).max() < 2 * slack
    center = segments[clear, 0] + found[clear, 1:2] * (segments[clear, 1] - segments[clear, 0]).astype(np.float64)
    assert abs(np.linalg.norm(hit - center[:, :3], axis=1) - center[:, 3]).max() < 4 * slack


def test_a_ray_from_inside_has_entered_before(context: Context, tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    _, d, segments = random_rays(COUNT, 0.01, seed=3)
    along = rng.uniform(0, 1, (COUNT, 1))
    center = segments[:, 0] + along * (segments[:, 1] - segments[:, 0])
    o = (center[:, :3] + 0.95 * center[:, 3:] * d[::-1]).astype(np.float32)
    assert (depth(o, segments) > 1e-5).all()
    assert (entries(context, tmp_path, o, d, segments)[:, 0] < 0).all()


def test_degenerate_segments_are_spheres_or_nothing(context: Context, tmp_path: Path) -> None:
    o, d = np.float32([[0.003, 0, 2]] * 5), np.float32([[0, 0, -1]] * 5)
    segments = np.float32([[[0, 0, 0, 0.1], [0, 0, 0, 0.1]],          # no length
                           [[0, 0, 0, 0.1], [0, 0, 0.05, 0.01]],      # one sphere in the other
                           [[0, 0, 0, 0.1], [0.05, 0, 0.0, 0.05]],    # they touch from within
                           [[0, 1e-6, 0, 0], [1, 1e-6, 0, 0]],        # no radius
                           [[0, 0, 0, 0.1], [0, 0, 1e-38, 0.1]]])     # hardly any length
    found = entries(context, tmp_path, o, d, segments)
    assert np.isfinite(found).all()
    near = 2 - np.sqrt(0.1**2 - 0.003**2)
    np.testing.assert_allclose(found[[0, 1, 2, 4], 0], near, rtol=1e-6)
    assert found[3, 0] > 1e29


def test_a_segment_hides_points_in_its_spheres(context: Context, tmp_path: Path) -> None:
    rng = np.random.default_rng(5)
    _, _, segments = random_rays(COUNT, 0.05, seed=5)
    p = (segments[:, 0, :3] + rng.uniform(0, 1, (COUNT, 1)) * (segments[:, 1, :3] - segments[:, 0, :3])
         + 0.05 * rng.normal(size=(COUNT, 3))).astype(np.float32)
    inside = glsl(context, tmp_path, "o0 = vec4(hides(f1, f2, f0.xyz));", p, segments[:, 0], segments[:, 1])
    deep = depth(p, segments)
    clear = abs(deep) > 1e-4
    np.testing.assert_array_equal(inside[clear, 0] > 0, deep[clear] > 0)
