"""Tests a shader of one's own, toon.glsl, with the fixtures that installing pbr-viewer gives to pytest.

    pytest examples/test_toon.py                    does it still draw what is stored in examples/golden?
    pytest examples/test_toon.py --golden-update    store what it draws now

The function is called for every pixel of a picture of a sphere: no window, no mesh, no program around it.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

TOON = Path(__file__).with_name("toon.glsl")
LIGHT, VIEW = np.array([-0.48, 0.6, 0.64]), np.array([0, 0, 1])


def test_a_sphere_looks_as_it_did(gl, golden):
    y, x = np.mgrid[1:-1:64j, -1:1:64j]
    squared = x * x + y * y
    normals = np.stack([x, y, np.sqrt(np.maximum(1 - squared, 0))], axis=-1)
    shaded = gl.call(TOON, "toon", color=[0.2, 0.5, 0.9], n=normals, l=LIGHT, v=VIEW, steps=3)
    golden(np.where(squared[..., None] < 1, shaded, 0))


def test_light_has_as_many_steps_as_asked(gl):
    angle = np.linspace(0, 1.5, 50)
    normals = np.stack([np.sin(angle), 0 * angle, np.cos(angle)], axis=-1)
    shaded = gl.call(TOON, "toon", color=1, n=normals, l=VIEW, v=normals, steps=4)
    assert np.allclose(np.unique(shaded.round(6)), np.array([1, 2, 3, 4]) / 4 / np.pi)
