"""The plan that leaves nothing out, and the one that shares programs, draw what the plan of what is needed draws."""

from __future__ import annotations

import json
import sys
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from needs import CORPUS, needs
from shapes import lopsided

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "golden"))
from cases import CASES, Case

import viewer
from viewer.base.resources import resource_folder
from viewer.plan import planner as planning
from viewer.plan.sharing import share_programs
from viewer.raster.renderer import Renderer
from viewer.scene.camera import Camera
from viewer.scene.gltf.extensions import SUPPORTED
from viewer.scene.light import Light
from viewer.scene.scene import Scene
from viewer.settings import Settings

SIZE = (24, 24)
SUN = Light.from_angles(0.5, 0.7, 2.0)
SCENES = sorted({case.scene for case in CASES if "." not in case.scene})
SMALL_FILES = 100_000
"""Bytes: of a model's folder, so that all of them take seconds."""
MOST = 2e-3
"""Relative: x 1 + 0 is exact, but a power of 1, and normals made unit length once more, are not quite. On the corpus
it is at most 2e-5, and almost 1e-3 of Phong's highlights of high exponents."""


def loaded(name: str) -> Scene:
    return viewer.load(resource_folder("assets") / "scenes" / f"{name}.glb", environment=None)


def lit(scene: Scene, number: int) -> Scene:
    """In turn: all lights, none but the sun, none but the environment, none but the scene's own."""
    environment = lopsided() if number % 2 == 0 else None
    return scene.relit(environment=environment, lights=(*scene.lights, SUN) if number % 4 < 2 else scene.lights)


def assert_same(renderer: Renderer, scene: Scene, camera: Camera | None = None, **settings: object) -> None:
    camera = camera or Camera.framing(scene.center, scene.radius, 1.0)
    needed, all_on = (renderer.render(scene, camera, Settings.of(antialias="msaa-4", plan=plan, **settings), SIZE)
                      for plan in ("needed", "everything"))
    assert renderer.plan.is_everything
    assert np.abs(needed.srgb.astype(int) - all_on.srgb).max() <= 1
    difference = np.abs(needed.linear - all_on.linear) / (np.abs(needed.linear) + 1e-2)
    assert difference.max() < (MOST if renderer.context.is_software else 3 * MOST), scene.name


def of_scene(number: int) -> Case:
    """A case of the golden images, which have compiled what is needed: in turn the scene's first, second and so on."""
    cases = [case for case in CASES if case.scene == SCENES[number]]
    return cases[number % len(cases)]


@pytest.mark.parametrize("number", range(len(SCENES)), ids=SCENES)
def test_scenes(renderer, number):
    case = of_scene(number)
    for mode in ("pbr", "phong")[: 1 + (number % 3 == 0)]:
        assert_same(renderer, *case.load(), mode=mode, **case.used(mode))


@pytest.mark.parametrize("number", range(4))
def test_lights(renderer, number):
    assert_same(renderer, lit(loaded("two-sided"), number))


@pytest.mark.parametrize("settings", [{"lobes": "uniform-diffuse"}, {"environment_shadows": "64"}, {"shadows": "off"},
                                      {"indirect": "baked"}],
                         ids=lambda settings: next(iter(settings)))
def test_settings(renderer, settings):
    assert_same(renderer, lit(loaded("alpha"), 0), **settings)


def small_models() -> list[Path]:
    """Of the corpus: the models that can be read."""
    if not (CORPUS / "INDEX.json").is_file():
        return []
    models = json.loads((CORPUS / "INDEX.json").read_text())["models"]
    paths = [CORPUS / model["path"] for model in models if set(model["extensions_required"]) <= set(SUPPORTED)]
    return [path for path in paths
            if sum(file.stat().st_size for file in path.parent.iterdir() if file.is_file()) < SMALL_FILES]


@needs("corpus")
@pytest.mark.parametrize("path", small_models(), ids=lambda path: path.stem)
def test_corpus(renderer, path):
    assert_same(renderer, lit(viewer.load(path, environment=None), 0))


def test_it_makes_what_nothing_uses(renderer):
    scene = loaded("unlit")
    assert_same(renderer, scene)
    facts = renderer.plan.to_json()
    assert {"shadows", "solid transmission", "thin-walled transmission", "blend"} <= set(facts["passes"])
    assert renderer.plan.environment and renderer.plan.dfg and renderer.plan.reflections and facts["lights"] == 3


@pytest.mark.parametrize("name", ["textures", "specular-ior", "two-sided", "vertex-colors", "emissive"])
def test_shared_programs(renderer, monkeypatch, name):
    scene = lit(loaded(name), 0)
    camera, settings = Camera.framing(scene.center, scene.radius, 1.0), Settings(antialias="msaa-4")
    own = renderer.render(scene, camera, settings, SIZE).linear
    count = len(renderer.plan.programs)
    monkeypatch.setattr(planning, "share_programs", partial(share_programs, always=True))
    shared = Renderer(renderer.context)
    picture = shared.render(scene, camera, settings, SIZE).linear
    assert len(shared.plan.programs) < count or name == "vertex-colors"
    shared.release()
    assert (np.abs(picture - own) / (np.abs(own) + 1e-2)).max() < 1e-5
