"""shaders/media/deep_walk.glsl: long steps of random numbers at even distances, in float64 once they are made."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss, legvander

from viewer.scene.medium import Medium
from viewer.scene.phase import spectrum
from viewer.trace.scene.deep_media import decay, first_step

ALBEDO = 0.999
MARGIN, ROOM = 2.0, 30.0
"""In mean free paths: how far spheres stay from surfaces, and the radius of the only one that there is room for."""
MU, WEIGHTS = leggauss(6)
"""Cosines of the path's directions to the z axis"""
U_X, U_Z = 64, 16
DEFINES = {"HAS_FOG": 0, "HAS_PUNCTUAL": 0, "CLEARANCE_STEPS": 1.0}
WALK = """
struct Path { vec3 origin, direction, throughput; float pdf; int steps, medium; };
struct Sample { vec3 u; };
const int FLIGHT_GROUP = 0;
uniform vec4 record, first;
uniform float room;
int times = 0;
int innermost(int medium) { return medium; }
vec4 vertex_numbers(Sample s, Path p, int group) { return vec4(s.u, 0.0); }
#define scene_float4(i) ((i) % 2 == 0 ? record : first)
#define clear_radius(p) (times++ < 2 ? room : 0.0)
#include "media/deep_walk.glsl"
Path walked(vec4 i) {
    Path p = Path(vec3(0.0), vec3(sqrt(1.0 - i.w * i.w), 0.0, i.w), vec3(1.0), 0.5, 0, 1);
    walk_deep(p, Sample(i.xyz));
    return p;
}
vec4 come(vec4 i) { Path p = walked(i); return vec4(p.origin, p.throughput.r); }
vec4 goes(vec4 i) { Path p = walked(i); return vec4(p.direction, p.pdf); }
"""


@pytest.mark.parametrize("g", [0.6, -0.5])
def test_a_long_step_finds_the_light_of_a_plane_wave(evaluate, g):
    """exp(kappa z), whose f_0 = 1, f_1 = (1 - albedo) / kappa and f_2 = (3 (1 - albedo c_1) f_1 / kappa - 1) / 2
    (viewer/trace/scene/deep_media.py): f_0 but for the sum over z, the others but for what is as small as kappa^2."""
    moments = spectrum(Medium(g=g), 128)
    kappa = decay(ALBEDO, moments)
    mean, half = first_step(ALBEDO, moments)
    uniforms = {"record": np.array([kappa, 0, 0, MARGIN]), "first": np.array([mean, half, 0, 0]),
                "room": np.array(ROOM + MARGIN)}
    x, z, mu = (m.ravel() for m in np.meshgrid((np.arange(U_X) + 0.5) / U_X, (np.arange(U_Z) + 0.5) / U_Z, MU))
    inputs = np.column_stack([x, np.full(len(x), 0.3), z, mu])
    come = evaluate("media/clearance", "come(i)", inputs, WALK, DEFINES, **uniforms)
    f1 = (1 - ALBEDO) / kappa
    f2 = (3 * (1 - ALBEDO * moments[1]) * f1 / kappa - 1) / 2
    radiance = (come[:, 3] * np.exp(kappa * come[:, 2])).reshape(-1, len(MU)).mean(axis=0)
    found = WEIGHTS / 2 * radiance @ legvander(MU, 2)
    assert (np.abs(found / [1, f1, f2] - 1) < [3e-4, 3e-3, 1e-2]).all()
    start = (mean + half * (2 * z - 1))[:, None] * np.column_stack([np.sqrt(1 - mu**2), 0 * mu, mu])
    assert np.linalg.norm(come[:, :3] - start, axis=1) == pytest.approx(ROOM, rel=1e-5)


def test_after_a_long_step_a_path_goes_anywhere(evaluate):
    """And counts light that it finds in full, since none was asked for there."""
    x, y, mu = (m.ravel() for m in np.meshgrid((np.arange(U_X) + 0.5) / U_X, (np.arange(U_Z) + 0.5) / U_Z, MU))
    uniforms = {"record": np.array([0, 0, 0, MARGIN]), "first": np.zeros(4), "room": np.array(ROOM + MARGIN)}
    goes = evaluate("media/clearance", "goes(i)", np.column_stack([x, y, 0 * x, mu]), WALK, DEFINES, **uniforms)
    assert np.linalg.norm(goes[:, :3], axis=1) == pytest.approx(1, abs=1e-5)
    assert goes[:, :3].T @ goes[:, :3] / len(goes) == pytest.approx(np.eye(3) / 3, abs=1e-3)
    assert np.abs(goes[:, :3].mean(axis=0)).max() < 1e-5 and (goes[:, 3] == 0).all()
