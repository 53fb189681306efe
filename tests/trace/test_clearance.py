"""The grid that tells paths inside of dense solids how far the surfaces are, at least."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from harness import evaluate
from shapes import WHITE, constant, moved, orthographic, plate, scene, sphere
from test_scattering import box, fog

from viewer.gpu.buffer_texture import BufferTexture
from viewer.gpu.programs import set_uniform
from viewer.settings import Settings
from viewer.trace.layout import CLEARANCE_STEPS
from viewer.trace.scene import clearance, encode
from viewer.trace.scene.clearance import clearance_texels, has_clearance
from viewer.trace.scene.geometry import trace_geometry
from viewer.trace.tracer import Tracer

WAX = fog((20.0, 12.0, 30.0), 0.8, 0.3, ior=1.4)


@pytest.fixture(scope="module")
def wax():
    """A ball with a small ball of glass in it, over a floor that cuts through it."""
    return scene(sphere(0), (sphere(1), moved((0.3, 0.1, 0.0), 0.25)), (plate(2), moved((0.0, 0.0, -0.6), 3.0)),
                 materials=[WAX, replace(WAX, scatter_color=(0.0, 0.0, 0.0), ior=1.5), WHITE], environment=constant())


def grid_of(geometry) -> tuple[np.ndarray, np.ndarray, float]:
    texels = clearance_texels(geometry)
    x, y, z = texels[1, :3].astype(int)
    steps = texels[2:].copy().view(np.uint8).ravel()[: x * y * z].reshape(z, y, x)
    *low, rate = texels[0].view(np.float32)
    return steps / CLEARANCE_STEPS / rate, np.array(low), 1 / float(rate)


def test_no_surface_is_nearer(wax, monkeypatch):
    """Points all over the triangles, against every cell: none is nearer to any point of it than the grid says."""
    monkeypatch.setattr(clearance, "MOST_CELLS", 1 << 13)
    geometry = trace_geometry(wax)
    radius, low, side = grid_of(geometry)
    rng = np.random.default_rng(3)
    points = []
    for instance in geometry.instances:
        mesh = geometry.meshes[instance.mesh]
        corners = (mesh.positions @ instance.transform[:, :3].T + instance.transform[:, 3])[mesh.triangles]
        weights = rng.dirichlet((1, 1, 1), (len(corners), max(8000 // len(corners), 1)))
        points.append(np.einsum("tnk,tkc->tnc", weights, corners).reshape(-1, 3))
    points = np.concatenate(points)
    z, y, x = np.nonzero(radius > 0)
    nearest = np.full(len(z), np.inf)
    for k, cell in enumerate(np.stack([x, y, z], axis=1)):
        corner = low + cell * side
        outside = np.maximum(np.maximum(corner - points, points - corner - side), 0)
        nearest[k] = np.sqrt((outside**2).sum(axis=1).min())
    told = radius[z, y, x]
    assert len(told) > 500 and (told <= nearest + 1e-6).all()
    assert (nearest - told).mean() < 1.5 * side  # and it is not much less


def test_ways_are_clear_up_to_the_surface(context, tmp_path, wax):
    """From near the middle of a ball: a way within it is clear, one to its surface is not, nor one from outside."""
    geometry = trace_geometry(replace(wax, instances=wax.instances[:1], meshes=wax.meshes[:1]))
    texels = clearance_texels(geometry)
    radius = np.linalg.norm(geometry.meshes[0].positions, axis=1).max() * geometry.instances[0].transform[0, 0]
    rng = np.random.default_rng(5)
    directions = rng.normal(size=(64, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    ways = np.repeat([0.5, 0.8, 1.001, 3e38], 16) * radius
    rows = np.concatenate([0.1 * radius * directions, np.zeros((64, 1)), directions, ways[:, None]], axis=1)
    rows[:8, :3] *= 30

    texture = BufferTexture(context, texels)

    def bind(program):
        texture.bind(program, "u_scene", 0)
        set_uniform(program, "u_clearance", 0)

    found = evaluate(context, tmp_path, "media/clearance.glsl", "o0 = vec4(is_clear(f0.xyz, f1.xyz, f1.w));",
                     rows.astype(np.float32), bind=bind)[:, 0, 0]
    texture.release()
    assert (found == np.concatenate([np.zeros(8), np.ones(24), np.zeros(32)])).all()


def test_pictures_are_the_same_with_it(context, wax, monkeypatch):
    """Collisions that need no rays are those that would have been found with them."""
    camera, rays, pictures = orthographic(0.4, 0.3, height=2.2), [], []
    for there in (True, False):
        monkeypatch.setattr(encode, "has_clearance", lambda geometry, there=there: there)
        tracer = Tracer(context)
        path_render = tracer.begin(wax, camera, Settings.of(mode="path", spp=8, fresnel="exact"), (24, 24))
        while not path_render.is_done:
            path_render.step(1.0)
        rays.append(path_render.rays)
        pictures.append(path_render.image().linear)
        path_render.release()
        tracer.release()
    assert rays[0] < 0.6 * rays[1]
    assert np.abs(pictures[0] - pictures[1]).max() < 1e-4


@pytest.mark.parametrize("model, expected", [
    (scene(sphere(), materials=[WAX], environment=constant()), True),
    (scene(sphere(), materials=[fog(2.0, 0.5)], environment=constant()), False),  # lights are asked at each collision
    (scene(box((1.0, 1.0, 1.0)), materials=[replace(WAX, scatter_color=(0.0, 0.0, 0.0))]), False),
])
def test_only_media_behind_refraction_have_it(model, expected):
    assert has_clearance(trace_geometry(model)) is expected
