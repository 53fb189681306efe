"""Which scenes are convex."""

from __future__ import annotations

import numpy as np
import pytest
from little_scenes import NOTHING_MUCH
from shapes import facing_floor, moved, plate, scene, sphere

from viewer.scene.convex import is_convex

BALL = sphere(segments=24)
CONVEX = {
    "a ball": scene(BALL),
    "a mirrored ball": scene((BALL, moved((0, 0, 0), (-1, 1, 1)))),
    "a tiny ball far away": scene((BALL, moved((1e3, 0, 0), 1e-3))),
    "a plate": scene(plate()),
    "two plates back to back": scene(plate(), (plate(), moved((0, 0, -1)) @ np.diag([1.0, -1, -1, 1]))),
}
CONCAVE = {
    "two balls": scene(BALL, (BALL, moved((3, 0, 0)))),
    "a corner": scene((plate(), facing_floor()), (plate(), moved((0, 1, -1)))),
    "a ball on a plate": scene(BALL, (plate(half=3.0), facing_floor(1.0, -1.0))),
    "nothing": NOTHING_MUCH["empty"],
    "lines": NOTHING_MUCH["no triangles"],
}


@pytest.mark.parametrize("name", CONVEX)
def test_convex(name):
    assert is_convex(CONVEX[name])


@pytest.mark.parametrize("name", CONCAVE)
def test_not_convex(name):
    assert not is_convex(CONCAVE[name])


def test_too_much_to_look_at_is_not_looked_at():
    assert not is_convex(scene(sphere(segments=200)))
