"""Path-traced pictures of media: white ones must vanish in a furnace, and extreme ones must be finite and their own.

Each case is shown twice: as a volume, a grid of densities, and as the medium in a body that does not refract.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from ...image.image import Image
from ...scene.camera import Camera
from ...scene.light import Light
from ...scene.material import Material
from ...scene.scene import Scene
from ...scene.volume import Volume
from ...settings import Settings
from ...trace.tracer import Tracer
from ..compare.difference import compare
from .checks import Check
from .extremes import not_finite
from .scenes import constant, placed, scene, sphere

FURNACE_BOUND = 0.02
"""Of the mean of a picture; its noise is a quarter of this."""
_SIZE = (8, 8)
_ACROSS = 2.0
"""The width of what is shown at scale 1: a ball of this diameter, or a cube."""


@dataclass(frozen=True)
class _Case:
    """The optical depth across the whole, where the density of the grid is 1; its albedo; g. `thickness` flattens it
    along z. The albedo is that of a single scattering in volumes, and that of all scattering in bodies."""

    tau: float
    albedo: float
    g: float = 0.0
    scale: float = 1.0
    thickness: float = 1.0

    def __str__(self) -> str:
        words = [f"optical depth {self.tau:g}", f"albedo {self.albedo:g}", f"g {self.g:g}"]
        return ", ".join(words + [f"thickness {self.thickness:g}"] * (self.thickness != 1))

    @property
    def sigma_t(self) -> float:
        """Per world unit."""
        return self.tau / (_ACROSS * self.scale)


def _as_volume(case: _Case) -> tuple[Scene, dict[str, object]]:
    """A cube of rough densities about 1."""
    density = np.random.default_rng(5).uniform(0, 2, (5, 4, 6)).astype(np.float32)
    half = case.scale * _ACROSS / 2 * np.array([1, 1, case.thickness])
    grid = Volume.in_box(density, np.stack([-half, half]))
    shown = Scene("check", (), (), (), volumes=(grid,))
    return shown, {"volume_density": case.sigma_t, "volume_albedo": (case.albedo,) * 3, "volume_g": case.g}


def _as_body(case: _Case) -> tuple[Scene, dict[str, object]]:
    """A ball of a homogeneous medium."""
    filled = Material(metallic=0.0, perceptual_roughness=0.0, transmission=1.0, thickness=1.0, ior=1.0,
                      scatter_color=(case.albedo,) * 3, scatter_anisotropy=case.g,
                      attenuation_color=(float(np.exp(-1)),) * 3,
                      attenuation_distance=1 / case.sigma_t if case.tau > 0 else np.inf)
    flat = np.diag([1, 1, case.thickness, 1]) @ placed((0, 0, 0), case.scale)
    return scene([sphere(0, 48)], [filled], transforms=[flat]), {"fresnel": "exact"}


_KINDS: dict[str, Callable[[_Case], tuple[Scene, dict[str, object]]]] = {"volume": _as_volume, "body": _as_body}
_FURNACES = [_Case(tau, 1.0, g) for tau, g in ((0, 0), (1e-6, 0), (1, 0.9), (1, -0.9), (5, 0), (5, 0.99), (5, -0.99))]
_EXTREMES = [_Case(0, 0.5), _Case(1e-6, 0.5, 0.99), _Case(1, 0, 0), _Case(1, 0.9, -0.99), _Case(1e4, 0, 0),
             _Case(1e4, 0.5, 0.9), _Case(1, 0.5, 0.6, thickness=1e-6), _Case(1e4, 0.5, thickness=1e-6)]


def check_media_furnaces(tracer: Tracer) -> Iterator[Check]:
    """What absorbs nothing has the radiance 1 of its surroundings, seen from outside and from inside."""
    for name, make in _KINDS.items():
        for case in _FURNACES:
            shown, settings = make(case)
            lit = shown.relit(environment=constant())
            for place, camera in (("outside", _outside(1.0)), ("inside", Camera.look_at((0.1, 0, 0), (0, 0, 1)))):
                picture = _picture(tracer, lit, camera, spp=64, bounces=255, **settings)
                off = abs(float(picture.linear[..., :3].mean()) - 1)
                yield Check("white medium in a furnace", f"{name} seen from {place}, {case}", off, FURNACE_BOUND)


def check_media_extremes(tracer: Tracer) -> Iterator[Check]:
    """From no density to opaque: finite, and with every sample; at every scale the same picture."""
    lights = (Light("point", intensity=2.0, position=(1.5, 1.0, 0.5)), Light("directional", direction=(0, 0, -1)))
    for name, make in _KINDS.items():
        for case in _EXTREMES:
            shown, settings = make(case)
            lit = shown.relit(environment=constant(), lights=lights)
            for place, z in (("outside", 3.0), ("the boundary", case.thickness), ("inside", 0.0)):
                picture = _picture(tracer, lit, Camera.look_at((0, 0, z), (0.1, 0, z - 1)), spp=4, **settings)
                yield not_finite(f"{name} seen from {place}, {case}", picture)
                yield Check("no sample lost", f"{name} seen from {place}, {case}", _lost(picture), 0)
        yield from _check_scales(tracer, name, make, lights)


def _check_scales(tracer: Tracer, name: str, make: Callable[[_Case], tuple[Scene, dict[str, object]]],
                  lights: tuple[Light, ...]) -> Iterator[Check]:
    def view(scale: float) -> Image:
        shown, settings = make(_Case(2.0, 0.8, 0.3, scale))
        lamp = Light("point", intensity=2 * scale**2, position=tuple(scale * np.array([1.5, 1.0, 0.5])))
        lit = shown.relit(environment=constant(), lights=(lamp, *lights[1:]))
        return _picture(tracer, lit, _outside(scale), spp=16, **settings)

    usual = view(1.0)
    for scale in (1e-6, 1e-3, 1e3, 1e6):
        picture = view(scale)
        yield not_finite(f"{name}, scale {scale:g}", picture)
        yield Check("same picture", f"{name}, scale {scale:g}", compare(usual, picture).flip, 2e-3, note="mean FLIP")


def _outside(scale: float) -> Camera:
    return Camera.look_at(scale * np.array([0.5, 1.0, 3.0]), (0, 0, 0), fov_y=0.5)


def _picture(tracer: Tracer, shown: Scene, camera: Camera, **settings: object) -> Image:
    return tracer.render(shown, camera, Settings.of(mode="path", **settings), _SIZE)


def _lost(picture: Image) -> float:
    return float(str(picture.stats["bad_samples"]))
