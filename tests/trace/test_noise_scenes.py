"""The scenes of assets/noise: each renders and shows the effect for which it was made."""

from __future__ import annotations

import pytest
from pictures import picture

import viewer
from viewer.base.resources import resource_folder
from viewer.measure.compare.relmse import relmse
from viewer.scene.scene import Scene

FILES = sorted((resource_folder("assets") / "noise").glob("*.glb"))
SIZE = (40, 40)


def load(name: str) -> Scene:
    return viewer.load(resource_folder("assets") / "noise" / f"{name}.glb", environment=None)


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_it_renders(tracer, file):
    scene = load(file.stem)
    pixels = picture(tracer, scene, scene.cameras[0], SIZE, spp=4)
    assert pixels[..., :3].mean() > 0.01


@pytest.mark.parametrize("name, hopeless", [("small-lights", "bsdf"), ("reflections", "bsdf"),
                                            ("reflections", "lights"), ("indirect", "bsdf")])
def test_both_ways_weighed_beat_each_alone(tracer, name, hopeless):
    scene = load(name)
    reference = picture(tracer, scene, scene.cameras[0], SIZE, spp=192, seed=11)[..., :3]
    weighed, alone = (relmse(picture(tracer, scene, scene.cameras[0], SIZE, spp=8, sampling=sampling)[..., :3],
                             reference) for sampling in ("mis", hopeless))
    assert weighed < 0.8 * alone
