"""Our pictures against those of another renderer: they differ only by noise.

Every picture is made in two halves of different seeds, which tell its noise; the references come with theirs.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from needs import needs
from pictures import halves
from shapes import WHITE, facing_floor, lopsided, moved, plate, scene, sphere

from benchmarks import mitsuba_scene, truth_cases
from viewer.measure.compare.relmse import Halves
from viewer.scene.camera import Camera
from viewer.scene.light import Light
from viewer.scene.material import Material

REDUCTIONS, BLOCK = (3, 4), 8
# Samples a pixel, and how far the mean may be off; caustics through smooth glass converge slowly.
CASES = {"diffuse-sphere": (32, 0.005), "mirror-0.16": (48, 0.007), "cornell-box": (64, 0.007),
         "glass-rough-0.25": (64, 0.010), "glass-smooth": (96, 0.020), "aniso-metal": (96, 0.007),
         "caustic-sphere": (48, 0.005),
         "cloud": (64, 0.005), "smoke-absorbing": (48, 0.005)}


def check(both: Halves, reference: np.ndarray, reference_floor: float, mean: float) -> None:
    found = both.against(reference, reference_floor)
    assert found.mean_sigma < mean / 2.5  # so that the noise is smaller than the bound
    assert abs(found.mean_ratio - 1) < mean
    assert found.excess < 1.5
    scores = both.block_scores(reference, reference_floor, BLOCK)
    # The 90th percentile of a normal distribution is 1.64; noise of few bright paths has longer tails.
    assert np.percentile(np.abs(scores), 90) < 2.8
    assert abs(np.median(scores)) < 0.4


@needs("truth")
@pytest.mark.parametrize("name", CASES)
def test_a_scene_that_another_renderer_solved(tracer, name):
    whole = truth_cases.load_case(name)
    case = whole.small(next(n for n in REDUCTIONS if whole.size[0] % n == 0))
    spp, mean = CASES[name]
    both = halves(tracer, case.scene, case.camera, case.size, spp=spp, **case.settings)
    check(both, case.reference, case.floor, mean)


@needs("mitsuba")
def test_a_scene_of_everything_against_mitsuba(tracer):
    """A metal, a rough glass and an emissive ball in an asymmetric environment with a lamp, by both renderers."""
    materials = [WHITE, Material(perceptual_roughness=0.4),
                 Material(metallic=0.0, perceptual_roughness=0.5, transmission=1.0, thickness=1.0, ior=1.4),
                 replace(WHITE, base_color=(0, 0, 0, 1), emissive=(4.0, 2.0, 1.0))]
    balls = [(sphere(k, 96), moved((1.1 * k - 2.2, 0.5, 0), 0.5)) for k in (1, 2, 3)]
    model = scene((plate(half=3.0), facing_floor()), *balls, materials=materials, environment=lopsided(),
                  lights=(Light("point", (1.0, 0.9, 0.8), 3.0, (0.5, 2.0, 1.5)),))
    camera = Camera.look_at((0, 2, 4.5), (0, 0.3, 0))
    both = halves(tracer, model, camera, (48, 48), spp=64, fresnel="exact", masking="smith-separable",
                  multiscatter="off")
    theirs = mitsuba_scene.convert(model, camera, (48, 48))
    other = Halves(*(mitsuba_scene.render(theirs, 96, seed) for seed in (1, 2)))
    check(both, other.mean, other.floor(other.mean), 0.01)
