"""Rendered white furnaces: under radiance 1 from everywhere a white ball cannot be seen, and no ball exceeds 1."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...raster.renderer import Renderer
from ...scene.camera import Camera
from ...scene.furnace import whitened
from ...scene.light import Light
from ...scene.material import CLEARCOAT, IRIDESCENCE, SHEEN, Material
from ...scene.schema import MAPS
from ...settings import Settings
from .checks import Check
from .scenes import ball_cosines, constant, orthographic, plate, scene, sphere

SIZE = 96
GRAZING = 0.05
"""Cosine of the view below which the bound does not hold; the deviation there is in the note."""
FURNACE_BOUND = 5e-3
ROUGHNESS = (0.0, 0.1, 0.25, 0.5, 0.75, 1.0)
MATERIALS = {
    "white metal": Material(metallic=1.0),
    "white plastic": Material(metallic=0.0),
    "half metal": Material(metallic=0.5),
    "white paper": Material(metallic=0.0, diffuse_transmission=0.4),
    "white plaster": Material(metallic=0.0, diffuse_roughness=1.0),
    "glass-like plastic, IOR 2.4": Material(metallic=0.0, ior=2.4),
    "white velvet": Material(metallic=0.0, sheen_color=(1.0, 1.0, 1.0), sheen_roughness=0.5),
    "white plastic with a film": Material(metallic=0.0, iridescence=1.0, iridescence_ior=1.6),
    "smoothly coated metal": Material(metallic=1.0, clearcoat=1.0),
    "roughly coated plastic": Material(metallic=0.0, clearcoat=1.0, clearcoat_roughness=0.6),
}


@dataclass(frozen=True, eq=False)
class FurnacePicture:
    """The ball in its furnace, (SIZE, SIZE, 3) radiance, and its deviation from 1 where NoV >= GRAZING."""

    pixels: np.ndarray
    maximum: float
    mean: float
    grazing: float
    """The largest deviation of the whole picture, the ball's rim included."""


def furnace_picture(renderer: Renderer, material: Material, **settings: object) -> FurnacePicture:
    """A ball of `material` in the white furnace, one sample a pixel; `settings` as those of `viewer.render`."""
    camera = orthographic()
    options = Settings.of(**{"antialias": "none"} | settings)
    ball = scene([sphere(segments=192)], [material], environment=constant())
    pixels = renderer.render(ball, camera, options, (SIZE, SIZE)).linear[..., :3].astype(np.float64)
    deviation = np.abs(pixels - 1).max(axis=-1)
    inside = ball_cosines(camera, SIZE) >= GRAZING
    seen = deviation[inside]
    return FurnacePicture(pixels, float(seen.max()), float(seen.mean()), float(deviation.max()))


def check_furnaces(renderer: Renderer) -> Iterator[Check]:
    """The renderer's materials at every roughness, and some without compensation for multiple scattering."""
    for name, material in MATERIALS.items():
        for ndf in ("ggx", "beckmann"):
            for roughness in ROUGHNESS:
                picture = furnace_picture(renderer, replace(material, perceptual_roughness=roughness), ndf=ndf)
                yield _row("furnace picture", f"{name}, {ndf}, roughness {roughness:g}", picture)
    for roughness in (0.5, 0.75, 1.0):
        picture = furnace_picture(renderer, Material(perceptual_roughness=roughness), multiscatter="off")
        case = f"white metal, single scattering, roughness {roughness:g}"
        yield _row("furnace picture", case, picture, expected=True)


def check_renderer_balance(renderer: Renderer) -> Iterator[Check]:
    """Under lights: a furnace made of many lights, and whether more light leaves than arrives from one direction."""
    for roughness in (0.5, 0.75, 1.0):
        for NoV in (1.0, 0.5, GRAZING):
            light = lit_furnace(renderer, Material(perceptual_roughness=roughness), NoV)
            yield Check("furnace of lights", f"white metal, roughness {roughness:g}, NoV {NoV:g}", abs(light - 1),
                        FURNACE_BOUND)
    plastic = Material(metallic=0.0, perceptual_roughness=0.5)
    for NoV in (1.0, 0.5, GRAZING):
        light = lit_furnace(renderer, plastic, NoV)
        yield Check("furnace of lights", f"white plastic, roughness 0.5, NoV {NoV:g}", abs(light - 1), FURNACE_BOUND)
    for name, metallic in (("white metal", 1.0), ("white plastic", 0.0)):
        for roughness in (0.25, 0.5, 1.0):
            material = Material(metallic=metallic, perceptual_roughness=roughness)
            yield check_balance(renderer, f"{name}, roughness {roughness:g}", material)


def lit_furnace(renderer: Renderer, material: Material, NoV: float) -> float:
    """Radiance of a plate under 4096 directional lights from everywhere (a Fibonacci lattice), 128 a picture."""
    count = 4096
    y = 1 - (2 * np.arange(count) + 1) / count
    turn = np.arange(count) * np.pi * (3 - np.sqrt(5))
    towards = np.stack([np.sqrt(1 - y**2) * np.cos(turn), y, np.sqrt(1 - y**2) * np.sin(turn)], axis=-1)
    # Only those above the plate, which faces +Z, give light.
    above = towards[towards[:, 2] > 0]
    camera = replace(Camera.orbit((0, 0, 0), 5.0, 0.0, float(np.arcsin(NoV)) - np.pi / 2), height=0.01)
    total = 0.0
    floor = scene([plate()], [material])
    for first in range(0, len(above), 128):
        lights = tuple(Light("directional", intensity=4 * np.pi / count, direction=tuple(-d))
                       for d in above[first : first + 128])
        options = Settings.of(antialias="none", shadows="off", background="none")
        total += float(renderer.render(floor.relit(lights=lights), camera, options, (2, 2)).linear[0, 0, 0])
    return total


def check_material(renderer: Renderer, name: str, material: Material, settings: Settings) -> Iterator[Check]:
    """A material's factors, without its maps: furnace as white and in its own colour, balance, no negative light.

    Glass is checked as the rasterizer draws it: the light that it reflects and the light that it transmits, which
    comes from a picture of what lies behind it. In a furnace that picture is white everywhere, so that the two have to
    add up to 1. The hemisphere balance is over the side that the light comes from and counts reflection alone.
    """
    bare = _factors(material)
    options: dict[str, object] = {"ndf": settings.ndf, "masking": settings.masking, "fresnel": settings.fresnel,
               "multiscatter": settings.multiscatter}
    # In its own colours it absorbs by design, but even then it may not glow.
    yield _row("furnace picture", f"{name}, as white", furnace_picture(renderer, whitened(bare), **options))
    own = furnace_picture(renderer, bare, **options)
    yield Check("no gain", f"{name}, furnace", float(own.pixels.max() - 1), FURNACE_BOUND,
                note=f"darkest {own.pixels.min():.3f}")
    yield Check("not negative", f"{name}, lights to grazing", max(0.0, -min(_lit_minima(renderer, bare, options))), 0.0)
    if material.perceptual_roughness >= 0.2:  # the pixels of the pictures would miss a smoother lobe
        balance = check_balance(renderer, name, bare, **options)
        yield replace(balance, expected=_may_gain(material, settings) and not balance.passed)


def _may_gain(material: Material, settings: Settings) -> bool:
    """Whether light of one direction is known to gain energy.

    Lobes with another lobe's masking, or none, gain at grazing angles, and the diffuse base is scaled for Schlick's
    Fresnel alone. What a clear coat, a film, and fibres over an interface let through depends on the viewer's direction
    alone.
    """
    if any(layer.is_on(material) for layer in (CLEARCOAT, IRIDESCENCE, SHEEN)):
        return True
    borrowed = settings.ndf == "blinn-phong" and settings.masking != "v-cavity"
    return borrowed or settings.masking == "none" or settings.fresnel == "exact"


def check_balance(renderer: Renderer, name: str, material: Material, **settings: object) -> Check:
    """The light that leaves in all directions, of light from one direction: the worst of three directions."""
    leaves = {NoL: hemisphere_balance(renderer, material, NoL, **settings) for NoL in (1.0, 0.5, 0.1)}
    worst = max(leaves, key=leaves.__getitem__)
    note = f"{leaves[worst]:.4f} of the light from NoL {worst:g} leaves"
    return Check("hemisphere balance", f"{name}, under a light", leaves[worst] - 1, BALANCE_BOUND, note=note)


BALANCE_BOUND = 0.01
"""How exactly the pixels of the pictures sample the integral."""


def hemisphere_balance(renderer: Renderer, material: Material, NoL: float, **settings: object) -> float:
    """Integral of f(o, i) NoV over the hemisphere of o, from pictures: the largest of the three channels.

    The eye stands above a wide plate under one directional light, so that every ray of a cube of views sees the plate
    from another direction o, and radiance is f(o, i) NoL times the light's intensity.
    """
    towards = np.array([np.sqrt(1 - NoL**2), 0.0, NoL])
    light = Light("directional", intensity=1.0, direction=tuple(-towards))
    lit = scene([plate(half=100.0)], [material], lights=[light])
    options = Settings.of(**{"antialias": "none", "shadows": "off", "background": "none"} | settings)
    size = 192
    x = (np.arange(size) + 0.5) / size * 2 - 1
    solid_angle = (2 / size) ** 2 / (1 + x[:, None] ** 2 + x[None, :] ** 2) ** 1.5
    total = np.zeros(3)
    for forward in ((0, 0, -1), (1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0)):
        camera = Camera.look_at((0, 0, 1), np.array((0, 0, 1)) + forward, up=(0, 0, 1), fov_y=np.pi / 2)
        radiance = renderer.render(lit, camera, options, (size, size)).linear[..., :3].astype(np.float64)
        rays = camera.forward - x[:, None, None] * camera.pose[:3, 1] + x[None, :, None] * camera.pose[:3, 0]
        NoV = np.maximum(-(rays / np.linalg.norm(rays, axis=-1, keepdims=True))[..., 2], 0)
        total += (radiance * (solid_angle * NoV)[..., None]).sum(axis=(0, 1))
    return float((total / NoL).max())


def _lit_minima(renderer: Renderer, material: Material, options: dict[str, object]) -> Iterator[float]:
    for angle in (0.0, 0.8, 1.5, 1.57, 2.2):
        light = Light.from_angles(angle, 0.3, 1.0)
        lit = scene([sphere()], [material], lights=[light])
        settings = Settings.of(**{"antialias": "none", "shadows": "off", "background": "none"} | options)
        picture = renderer.render(lit, orthographic(), settings, (SIZE, SIZE)).linear
        yield float(np.nan_to_num(picture, nan=-np.inf).min())


def _factors(material: Material) -> Material:
    """`material` without maps, covering all of its surface, and emitting nothing."""
    no_maps: dict[str, Any] = {f"{name}_texture": None for name in MAPS}
    return replace(material, **no_maps, base_color=(*material.base_color[:3], 1.0), emissive=(0.0, 0.0, 0.0),
                   alpha_mode="opaque", unlit=False)


def _row(check: str, case: str, picture: FurnacePicture, expected: bool = False) -> Check:
    note = f"mean {picture.mean:.1e}; at the rim {picture.grazing:.1e}"
    return Check(check, case, picture.maximum, FURNACE_BOUND, expected, note)
