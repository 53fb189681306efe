"""Scenes another renderer has solved already: scene.glb, case.json and reference.exr in a folder each."""

from __future__ import annotations

import json
from collections import defaultdict
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import viewer
from viewer.image.image import Image
from viewer.measure.compare.relmse import reduced
from viewer.scene.camera import Camera
from viewer.scene.environment import Environment
from viewer.scene.environment_presets import PRESETS
from viewer.scene.light import Light
from viewer.scene.scene import Scene
from viewer.settings import Settings

from .mitsuba_scene import from_mitsuba
from .shot import REPOSITORY

FOLDER = REPOSITORY.parent / "shared" / "truth"
ENVIRONMENTS = REPOSITORY.parent / "shared" / "corpus" / "environments"


@dataclass(frozen=True, eq=False)
class Case:
    """`reference` is linear radiance (H, W, 3) float64; `floor` the relMSE of its own noise at `spp` samples."""

    name: str
    scene: Scene
    camera: Camera
    settings: dict[str, object]
    reference: np.ndarray
    floor: float
    spp: int

    @property
    def size(self) -> tuple[int, int]:
        height, width = self.reference.shape[:2]
        return width, height

    def small(self, factor: int) -> Case:
        """In 1/factor of the size, by a box filter; the noise of factor^2 pixels goes into one."""
        return replace(self, reference=reduced(self.reference, factor), floor=self.floor / factor**2)

    def with_settings(self, **more: object) -> Settings:
        return Settings.of(mode="path", **(self.settings | more))


_BUILT = ("aniso-metal", "caustic-ring", "caustic-sphere", "cloud", "fog-g07", "fog-point",
          "hair-blond", "hair-lock", "milk-rough", "smoke-absorbing", "wax")
"""Cases that are marked `todo` for a feature that is there by now."""


def names(folder: Path = FOLDER) -> list[str]:
    """The cases in `folder`, without those marked `todo`: they need features that are not there yet."""
    return sorted(name for file in folder.glob("*/case.json")
                  if (name := file.parent.name) in _BUILT or not json.loads(file.read_text()).get("todo"))


def load_case(name: str, folder: Path = FOLDER, environments: Path = ENVIRONMENTS) -> Case:
    """Raises FileNotFoundError and InputError."""
    case = json.loads((folder / name / "case.json").read_text())
    options = _options(case.get("options", []))
    named = case["env"] in ("none", *PRESETS)
    scene = viewer.load(folder / name / case.get("model", "scene.glb"),
                        environment=case["env"] if named else environments / case["env"])
    for file in options["--with"]:
        scene = viewer.join(scene, viewer.load(folder / name / file))
    if scene.environment is not None and named:
        intensity = float(options["--env-intensity"][0]) if options["--env-intensity"] else 1.0
        scene = scene.relit(environment=replace(scene.environment, intensity=intensity))
    elif scene.environment is not None:  # as the other renderer read it: 2.5 % of irradiance for a sun near the zenith
        scene = scene.relit(environment=Environment(case["env"], from_mitsuba(scene.environment.radiance)))
    if options["--light"]:
        suns = (tuple(map(float, sun.split(","))) for sun in options["--light"])
        scene = scene.relit(lights=tuple(Light.from_angles(*np.radians(angles), lux) for *angles, lux in suns))
    camera = Camera.look_at(case["eye"], case["target"], fov_y=np.radians(case["fov"]))
    reference = Image.open(folder / name / "reference.exr").linear[..., :3].astype(np.float64)
    settings = case["set"] | {"background": case["background"]} | dict(map(_setting, options["--set"]))
    return Case(name, scene, camera, settings, reference, case["relmse_floor"], case["spp"])


def _options(words: list[str]) -> defaultdict[str, list[str]]:
    """The values of each option, given as one word or as two."""
    found: defaultdict[str, list[str]] = defaultdict(list)
    rest = iter(words)
    for word in rest:
        option, equals, value = word.partition("=")
        found[option].append(value if equals else next(rest))
    return found


def _setting(assignment: str) -> tuple[str, object]:
    name, _, value = assignment.partition("=")
    try:
        numbers = tuple(map(float, value.split(",")))
    except ValueError:
        return name.replace("-", "_"), value  # a word
    return name.replace("-", "_"), numbers if len(numbers) > 1 else numbers[0]
