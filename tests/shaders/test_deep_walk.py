"""shaders/media/deep_walk.glsl: long steps of random numbers at even distances, in float64 once they are made."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss, legvander

from viewer.scene.medium import Medium
from viewer.scene.phase import spectrum
from viewer.trace.layout import MEDIA_REACH
from viewer.trace.scene.deep_media import decay, first_step

ALBEDO = 0.999
MARGIN, ROOM = 2.0, 30.0
"""In mean free paths: how far spheres stay from surfaces, and the radius of the only one that there is room for."""
MU, WEIGHTS = leggauss(6)
"""Cosines of the path's directions to the z axis"""
U_X, U_Z = 64, 16
DEFINES = {"HAS_FOG": 0, "HAS_PUNCTUAL": 0, "CLEARANCE_STEPS": 1.0}
PATHS = """
struct Path { vec3 origin, direction, throughput; float pdf; int steps, medium; };
struct Sample { vec3 u; };
const int FLIGHT_GROUP = 0;
int innermost(int medium) { return medium; }
vec4 vertex_numbers(Sample s, Path p, int group) { return vec4(s.u, 0.0); }
"""
WALK = PATHS + """
uniform vec4 record, first;
uniform float room;
int times = 0;
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


ROOM_ABOUT = PATHS + """
const int u_punctual = 0, u_punctual_count = 1, u_fog = 1;
uniform float around, beside;
uniform vec4 lamp;
#define scene_float4(i) ((i) == 0 ? lamp : vec4(0.25))
#define clear_radius(p) around
#define beside_clearance(p) beside
#include "media/deep_walk.glsl"
"""


def room_about(evaluate, points, medium: int, lamp=(0.0, 0.0, 0.0, -1.0), fog=0, **lengths: float):
    """Of points, (N, 3), of which surfaces are `around` far or their grid is `beside` far; the base of the fog lies at
    a height of 0.25."""
    defines = DEFINES | {"HAS_FOG": fog, "HAS_PUNCTUAL": 1, "MEDIA_REACH": MEDIA_REACH}
    rows = np.column_stack([points, np.full(len(points), float(medium))])
    uniforms = {name: np.array(value) for name, value in lengths.items()} | {"lamp": np.array(lamp)}
    return evaluate("media/clearance", "vec4(room_about(i.xyz, int(i.w)))", rows, ROOM_ABOUT, defines, **uniforms)[:, 0]


@pytest.mark.parametrize("lamp", [(0.3, 0.0, 0.0, 5.0), (0.3, 0.0, 0.0, 0.0), (0.3, 0.0, 0.0, -1.0)])
def test_long_steps_end_before_lamps(evaluate, lamp):
    """Not before suns, whose fourth number is below 0."""
    found = room_about(evaluate, [(0.1, 0.0, 0.0), (-0.9, 0.0, 0.0)], 1, around=0.8, lamp=lamp)
    assert found == pytest.approx([0.2, 0.8] if lamp[3] >= 0 else [0.8, 0.8], abs=1e-6)


@pytest.mark.parametrize("fog, beside, expected", [(1, 0.0, (0.2, 0.2, 0.05)), (1, 0.4, (0.4, 0.4, 0.05)),
                                                   (2, 0.0, (0.1, -0.1, 0.05)), (2, 0.4, (0.1, -0.1, 0.05))])
def test_long_steps_stay_in_the_fog(evaluate, fog, beside, expected):
    """Within its sphere, beside all surfaces by how far their grid is, and below the base where it thins out above."""
    points = [(0.0, 0.15, 0.0), (0.0, 0.35, 0.0), (MEDIA_REACH - 0.05, 0.0, 0.0)]
    found = room_about(evaluate, points, 0, fog=fog, around=0.2, beside=beside)
    assert found == pytest.approx(expected, abs=1e-5)
