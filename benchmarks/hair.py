"""Hair and fur of the rasterizer against paths, by the light and by the depth in them: `python -m benchmarks.hair`.

The locks are those of two cases of another renderer (truth_cases.py), without their floor and lamp, and that of
`assets/curves`; the fur is that of `assets/curves`, and the same with roots placed by chance, and with straight strands
of one radius. Errors are over the pixels that strands cover; the depth is the third of these pixels from above.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import viewer
from viewer.estimate.neighbourhood import EPSILON
from viewer.gpu.context import open_context
from viewer.raster.renderer import Renderer
from viewer.scene.camera import Camera
from viewer.scene.curves import Curves
from viewer.scene.environment_presets import make_preset
from viewer.scene.light import Light
from viewer.scene.scene import Scene
from viewer.settings import Settings
from viewer.trace.tracer import Tracer

from . import tracing, truth_cases
from .shot import REPOSITORY

ASSETS = REPOSITORY / "assets/curves"
SIZE = (64, 64)
BOUNCES = 64
COLUMNS = {"strands": "strands", "light": "light", "relMSE": "relmse:.4f", "the reference's noise": "floor:.4f",
           "mean over path, RGB": "mean", "upper third": "upper:.2f", "middle": "middle:.2f", "lower": "lower:.2f"}


def _sun(azimuth: float, elevation: float, lux: float) -> Light:
    return Light.from_angles(math.radians(azimuth), math.radians(elevation), lux)


SUN, BEHIND = _sun(30, 40, 3), _sun(160, 30, 3)
LIGHTS: dict[str, tuple[str | None, tuple[Light, ...]]] = {
    "all around": ("furnace", ()), "sun": (None, (SUN,)), "sun from behind": (None, (BEHIND,)),
    "studio": ("studio", ()), "sun and studio": ("studio", (SUN,))}
FUR, BLOND = {"hair_melanin": (0.6, 0.2)}, {
    "hair_melanin": (0.02, 0.08), "hair_roughness": (0.25, 0.35), "hair_tilt": 2.5, "hair_ior": 1.55}


@dataclass(frozen=True, eq=False)
class Strands:
    """What stands in the picture, how it is seen, what it is, and samples a pixel of the reference for each light."""

    scene: Scene
    camera: Camera
    settings: dict[str, object]
    spp: dict[str, int]


def _of_case(name: str, settings: dict[str, object], spp: dict[str, int]) -> Strands:
    case = truth_cases.load_case(name)
    scene = viewer.Scene(name, curves=case.scene.curves)
    return Strands(scene, case.camera, settings, spp)


def _framed(curves: Curves, settings: dict[str, object], spp: dict[str, int]) -> Strands:
    scene = viewer.Scene(curves.name, curves=(curves,))
    return Strands(scene, scene.framing_camera(SIZE[0] / SIZE[1]), settings, spp)


def _asset(name: str) -> Curves:
    return viewer.load(ASSETS / name, environment=None).curves[0]


def fur_by_chance() -> Curves:
    """The tuft of fur, its roots moved to places by chance on their disk; all of a strand moves as its root parts."""
    fur = _asset("fur.curves")
    points = fur.points.reshape(440, 6, 3).astype(np.float64)
    rng = np.random.default_rng(5)
    size, angle = np.sqrt(rng.uniform(0, 1, 440)), rng.uniform(0, 2 * np.pi, 440)
    roots = 0.0065 * np.stack([size * np.cos(angle), 0 * size, size * np.sin(angle)], axis=1)
    t = np.linspace(0, 1, 6)[:, None]
    points += (roots - points[:, 0])[:, None] * (1 + 0.7 * t + 0.6 * t**2)
    return replace(fur, name="fur by chance", points=points.reshape(-1, 3))


def straight(fur: Curves) -> Curves:
    """Upright strands of one radius and length from the same roots."""
    roots = fur.points.reshape(440, 6, 3)[:, :1]
    points = roots + np.linspace(0, 1, 6)[:, None] * np.array([0, 0.016, 0])
    return replace(fur, name=f"{fur.name}, straight", points=points.reshape(-1, 3), radii=np.full(440 * 6, 1e-4))


SEVERAL = {"sun": 512, "sun from behind": 512, "all around": 256}
KINDS: dict[str, Callable[[], Strands]] = {
    "brown": lambda: _of_case("hair-lock", {"hair_melanin": (1.3, 0.0)}, SEVERAL),
    "black": lambda: _of_case("hair-lock", {"hair_melanin": (8.0, 0.0)}, SEVERAL),
    "blond": lambda: _of_case("hair-blond", BLOND, {"sun": 2048, "sun from behind": 2048, "all around": 256}),
    "lock": lambda: _framed(_asset("lock.hair"), {"hair_melanin": (0.3, 0.1)}, {"studio": 256, "sun": 1024}),
    "fur": lambda: _framed(_asset("fur.curves"), FUR, {
        "sun and studio": 256, "studio": 256, "all around": 192, "sun": 384, "sun from behind": 1024}),
    "fur by chance": lambda: _framed(fur_by_chance(), FUR, {"sun and studio": 256, "all around": 192, "sun": 384}),
    "fur, straight": lambda: _framed(straight(_asset("fur.curves")), FUR, {
        "sun and studio": 256, "all around": 192, "sun": 384}),
    "fur by chance, straight": lambda: _framed(straight(fur_by_chance()), FUR, {
        "sun and studio": 256, "all around": 192, "sun": 384})}


def main() -> None:
    options = _parse()
    rows: list[dict[str, object]] = []
    with open_context() as context:
        renderer, tracer = Renderer(context), Tracer(context)
        for name in options.only or KINDS:
            strands = KINDS[name]()
            for light, spp in strands.spp.items():
                halves = _references(tracer, strands, light, spp, options.references and
                                     options.references / f"{name} {light} {spp}.npy".replace(",", ""))
                if not options.prepare:
                    rows.append({"strands": name, "light": light} | _compared(
                        _raster(renderer, strands, light), halves))
        facts = tracing.conditions(tracer) | {"samples a pixel of the rasterizer": "16, by ssaa-16"}
        renderer.release()
        tracer.release()
    if rows:
        tracing.keep("hair", facts, rows, ["# Hair and fur of the rasterizer against paths", "",
                                           *tracing.table(rows, COLUMNS)], options.results)


def _lit(strands: Strands, light: str) -> Scene:
    preset, lights = LIGHTS[light]
    return replace(strands.scene, lights=lights, environment=None if preset is None else make_preset(preset))


def _raster(renderer: Renderer, strands: Strands, light: str) -> np.ndarray:
    settings = Settings.of(background="none", antialias="ssaa-16", **strands.settings)
    return renderer.render(_lit(strands, light), strands.camera, settings, SIZE).linear.astype(np.float64)


def _references(tracer: Tracer, strands: Strands, light: str, spp: int, kept: Path | None) -> np.ndarray:
    """Two pictures of different seeds, (2, H, W, 4)."""
    if kept is not None and kept.exists():
        return np.load(kept)
    pictures = []
    for seed in (1, 2):
        settings = Settings.of(mode="path", background="none", bounces=BOUNCES, spp=spp // 2, seed=seed,
                               **strands.settings)
        pictures.append(tracer.render(_lit(strands, light), strands.camera, settings, SIZE).linear)
    both = np.stack(pictures)
    if kept is not None:
        kept.parent.mkdir(parents=True, exist_ok=True)
        np.save(kept, both)
    return both


def _compared(raster: np.ndarray, halves: np.ndarray) -> dict[str, object]:
    """Over the pixels that strands cover in part: relMSE less that of the reference's noise, and ratios of means."""
    path = halves.mean(axis=0).astype(np.float64)
    shown = path[..., 3] > 0
    ours, theirs = raster[shown][:, :3], path[shown][:, :3]
    noise = np.square(halves[0] - halves[1])[shown][:, :3] / 4
    floor = float((noise / (theirs**2 + EPSILON)).mean())
    error = float((np.square(ours - theirs) / (theirs**2 + EPSILON)).mean())
    rows = np.nonzero(shown)[0]  # from above
    thirds = np.searchsorted(np.quantile(rows, (1 / 3, 2 / 3)), rows)
    depths = [float(ours[thirds == k, 1].sum() / theirs[thirds == k, 1].sum()) for k in range(3)]
    mean = " ".join(f"{a / b:.2f}" for a, b in zip(ours.mean(axis=0), theirs.mean(axis=0), strict=True))
    return {"relmse": error - floor, "floor": floor, "mean": mean, "upper": depths[0], "middle": depths[1],
            "lower": depths[2]}


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.hair", description=__doc__)
    parser.add_argument("only", nargs="*", metavar="STRANDS", help=", ".join(KINDS))
    parser.add_argument("--references", type=Path, metavar="DIR", help="keep references there, and take those that are")
    parser.add_argument("--prepare", action="store_true", help="make the references and no more")
    parser.add_argument("--results", type=Path, default=REPOSITORY / "benchmarks/results")
    return parser.parse_args()


if __name__ == "__main__":
    main()
