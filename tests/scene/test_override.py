"""Scenes in one material."""

from __future__ import annotations

import numpy as np
import pytest
from command_line import SCENES
from test_gltf_variants import BOTH, varied
from test_pose import morphing

import viewer
from viewer.errors import UsageError

CLAY = viewer.Material(base_color=(0.3, 0.3, 0.3, 1.0), metallic=0.0)


def test_all_meshes_have_it_and_no_colours_of_vertices():
    model = viewer.load(SCENES / "vertex-colors.glb")
    made = model.with_material(CLAY)
    assert any(mesh.colors is not None for mesh in model.meshes)
    assert made.materials == (CLAY,) and made.images == ()
    assert all(mesh.colors is None and mesh.material == 0 for mesh in made.meshes)
    assert made.instances is model.instances and made.environment is model.environment
    np.testing.assert_array_equal(made.bounds, model.bounds)
    with pytest.raises(UsageError, match="material is of type str, not a Material"):
        model.with_material("clay")


def test_animations_and_variants_do_not_bring_the_others_back():
    model = morphing()[0].with_material(CLAY)
    later = model.at(0.5)
    assert (later.meshes[0].positions != model.meshes[0].positions).any()
    assert later.materials == (CLAY,) and {mesh.material for mesh in later.meshes} == {0}
    assert varied(*BOTH).load().with_material(CLAY).variants == ()


def test_the_option_shows_its_colour(run, folder):
    outcome = run("render", SCENES / "spheres.glb", "-o", "a.png", "--material", "#0000ff", "--env", "furnace",
                  "--size", "32", "--background", "none", "-q")
    assert (outcome.status, outcome.err) == (0, "")
    pixels = viewer.Image.open("a.png").srgb.astype(int)
    inside = pixels[pixels[..., 3] == 255]
    assert len(inside) > 50 and (inside[:, 2] > inside[:, 0] + 60).all()
