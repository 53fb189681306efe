"""The guide to caustics where there are two casters, and how surfaces share their samples with it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from guided import ABOVE, LAMP, METAL, Guided, with_ball
from needs import needs
from test_light_sampling import FLOOR

from viewer.base.resources import resource_folder
from viewer.scene.material import Material
from viewer.scene.scene import Instance
from viewer.trace.scene.caustic_guide import place_of

pytestmark = needs("embree")
SWITCHES = """#define TRANSMITS 0
#define REFRACTS 0
#define PHOTONS 0
#include "trace/state.glsl"
"""
COATED = Material("coated", metallic=0.0, perceptual_roughness=0.5, clearcoat=1.0)


@pytest.fixture(scope="module")
def pair(context, tmp_path_factory) -> Guided:
    """Two balls, each with a floor's light of its own."""
    one = with_ball(METAL, FLOOR, (LAMP, ABOVE))
    beside = one.instances[-1].transform.copy()
    beside[:3, 3] = -0.9, -0.6, 0.7
    scene = replace(one, instances=(*one.instances, Instance(one.instances[-1].mesh, beside)))
    guided = Guided(context, tmp_path_factory.mktemp("pair"), scene)
    assert guided.guide.count == 2
    return guided


def shares(guided: Guided, points: np.ndarray) -> np.ndarray:
    """Of each caster at each point in tracer space, (casters, points)."""
    away = [points - table.caster.center for table in guided.tables]
    return np.array([table.shares[place_of(a / np.linalg.norm(a, axis=1, keepdims=True))]
                     for table, a in zip(guided.tables, away, strict=True)])


@pytest.mark.parametrize("k", [0, 1])
def test_each_of_two_casters_has_its_own_directions(pair, k) -> None:
    """Where it has the larger share, of which rough light gets its part."""
    x, z = (values.ravel() for values in np.meshgrid(*[np.linspace(-1.4, 1.4, 57)] * 2))
    floor = pair.to_tracer(np.stack([x, np.full(x.size, -1.0), z], axis=1))
    own = shares(pair, floor)
    best = np.argmax(own[k] - own[1 - k])
    p, caster = floor[best], pair.tables[k].caster
    assert own[k, best] > own[1 - k, best]
    direction = np.random.default_rng(2).normal(size=(4000, 3))
    direction *= 0.5 * caster.radius / np.linalg.norm(direction, axis=1, keepdims=True)
    direction += caster.center - p
    direction = (direction / np.linalg.norm(direction, axis=1, keepdims=True)).astype(np.float32)
    found = pair.run("Guide g = guide_at(f1.xyz, mat3(1.0), 0.5); o0 = vec4(guide_pdf(g, f0.xyz), g.share, 0.0, 0.0);",
                     np.column_stack([direction, np.zeros(len(direction)), np.tile(p, (len(direction), 1))]))[:, 0]
    expected = pair.density(p, direction.astype(np.float64), k)
    assert (expected > 0).mean() > 0.5
    assert np.mean(np.abs(found[:, 0] - expected) <= 1e-4 * expected) > 0.998
    assert found[:, 1] == pytest.approx(0.5 * own[k, best], rel=1e-6)


def test_a_surface_shares_its_samples_with_the_guide(context, tmp_path) -> None:
    """Of a floor under a smooth coat. Where the pdf is that of the samples, the mean of cos / pdf is the integral of
    the cosine, pi; and the mirror carries what it does without a guide."""
    guided = Guided(context, tmp_path, with_ball(METAL, (COATED, FLOOR[1]), (LAMP, ABOVE)))
    layered = (resource_folder("shaders") / "trace/layered.glsl").read_text()
    functions = SWITCHES + layered.replace("trace/shade.glsl", "trace/surface_sides.glsl")
    p = guided.to_tracer(np.array([-0.3, -1.0, 0.1]))
    count = 1 << 16
    u = np.random.default_rng(1).random((count, 3))
    u[:, 2] = (np.arange(count) + 0.5) / count
    found = guided.run(f"""Interaction i = interact(Hit(0, 0, vec2(0.3)), normalize(vec3(0.6, 0.7, 0.2)));
        i.position = vec3({p[0]:.9f}, {p[1]:.9f}, {p[2]:.9f});
        mat3 frame;
        vec3 wo;
        float worth;
        Bsdf b = bsdf_towards(i, material_at(i), normalize(vec3(0.6, 0.7, 0.2)), frame, wo), plain = b;
        plain.guide.share = 0.0;
        BsdfSample s = bsdf_sample(b, wo, f0.xyz, worth), without = bsdf_sample(plain, wo, f0.xyz, worth);
        o0 = vec4(s.wi.z, s.pdf, s.weight.g, s.flags & DELTA);
        o1 = vec4(bsdf_eval_pdf(b, wo, s.wi).w, without.weight.g, without.flags & DELTA, b.guide.share);
        o2 = vec4(guide_at(i.position, frame, 1.0).share, facet_probability(b.surface, b.view), 0.0, 0.0);
        """, u, 3, functions)
    cos, pdf, weight, is_mirror = found[:, 0].T
    beside, plain, was_mirror, share = found[:, 1].T
    assert share == pytest.approx(found[:, 2, 0] * (1 - found[:, 2, 1])) and share[0] > 0.05
    is_mirror, was_mirror = is_mirror > 0, was_mirror > 0
    is_rough = ~is_mirror & (pdf > 0)  # few samples of the lobes go below the surface
    assert is_rough.sum() > 0.9 * count and pdf[is_rough] == pytest.approx(beside[is_rough], rel=1e-4)
    ratio = np.where(is_rough, cos, 0.0) / np.where(is_rough, pdf, 1.0)
    assert ratio.mean() == pytest.approx(np.pi, abs=4 * ratio.std() / np.sqrt(count))
    assert ratio.std() / np.sqrt(count) < 0.01
    assert is_mirror.mean() == pytest.approx(pdf[is_mirror].mean(), rel=1e-3) and is_mirror.mean() < was_mirror.mean()
    assert weight[is_mirror].sum() == pytest.approx(plain[was_mirror].sum(), rel=1e-3)
