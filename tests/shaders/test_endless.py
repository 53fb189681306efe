"""shaders/trace/endless.glsl: media of paths that have collided very often."""

from __future__ import annotations

import numpy as np
import pytest

from viewer.trace import layout

ALBEDO = 1 - 2**-20
STUBS = """
struct Path { int steps, medium; };
struct Medium { vec3 sigma_t, albedo; };
int innermost(int medium) { return medium; }
Medium medium_of(int medium) { return Medium(vec3(8.0), vec3(ALBEDO)); }
#include "trace/endless.glsl"
vec4 around(float steps) {
    Medium m = medium_around(Path(int(steps), 1));
    return vec4(m.sigma_t.r, m.albedo.r, 0.0, 0.0);
}
"""


def test_light_decays_as_fast_as_before(evaluate):
    """kappa^2 = 3 sigma_t^2 (1 - albedo) where little is absorbed, the same however far apart collisions are."""
    doublings = np.array([0, 0, 1, 2, 5, 10])
    steps = [0, layout.THINS_FROM, *(layout.THINS_FROM + layout.THINS_EVERY * doublings[2:])]
    names = ("THINS_FROM", "THINS_EVERY", "HURRIES_FROM", "HURRIES_EVERY")
    defines = {name: getattr(layout, name) for name in names} | {"ALBEDO": ALBEDO}
    found = evaluate("bsdf/constants", "around(i.x)", np.column_stack([steps, *[np.zeros(6)] * 3]), STUBS, defines)
    assert found[:, 0] == pytest.approx(8 * 0.5**doublings, rel=1e-5)
    assert found[:, 0] ** 2 * (1 - found[:, 1]) == pytest.approx(64 * (1 - ALBEDO), rel=1e-5)
