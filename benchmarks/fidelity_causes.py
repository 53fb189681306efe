"""Why our path-traced pictures differ from the references of benchmarks.fidelity: python -m benchmarks.fidelity_causes.

For each scenario: the score of our picture, then encoded as each reference is, then also compressed as it is, then also
with what the references do otherwise undone (`UNDONE`). Three more tables: how each path tracer encodes, how light its
pictures are, and whether all look from the same place. References are those of fidelity.json. Pictures are kept in
--pictures as .npz files.
"""

from __future__ import annotations

import argparse
import io
import json
import os
import statistics
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from PIL import Image

import viewer
from viewer.gpu.context import open_context
from viewer.scene.camera import Camera
from viewer.scene.color import linear_to_srgb
from viewer.scene.scene import Scene

from . import corpus, fidelity, machine, shot, tracing
from .encodings import Picture, coded_as, radiance, shown, srgb_coded

OPTIONS: dict[str, Any] = {"mode": "path", "spp": 24, "denoise": "oidn", "tonemap": "aces"}
STEPS = ("plain", "encoded", "compressed", "undone")
LEVELS = (0.005, 0.01, 0.015, 0.02, 0.03, 0.05, 0.1, 0.2, 0.5)
"""Of radiance, between which the light of engines is compared."""


def geometric_normals(scene: Scene) -> Scene:
    """With the normals of the moved surface, smooth over vertices of one place."""
    meshes = []
    for mesh in scene.meshes:
        corners = np.asarray(mesh.indices).reshape(-1, 3)
        p = mesh.positions.astype(np.float64)
        facets = np.cross(p[corners[:, 1]] - p[corners[:, 0]], p[corners[:, 2]] - p[corners[:, 0]])
        _, place = np.unique(np.round(p, 5), axis=0, return_inverse=True)
        total = np.zeros((place.max() + 1, 3))
        for k in range(3):
            np.add.at(total, place.ravel()[corners[:, k]], facets)
        normals = total[place.ravel()]
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
        meshes.append(replace(mesh, normals=normals.astype(np.float32)))
    return replace(scene, meshes=tuple(meshes))


Change = tuple[str, Callable[[Scene], Scene], dict[str, Any]]
UNDONE: dict[str, Change] = {
    "GlamVelvetSofa": ("without the light of the file", lambda scene: replace(scene, lights=()), {}),
    "MorphPrimitivesTest": ("normals of the moved surface", geometric_normals, {}),
    "OrientationTest": ("single scattering by facets", lambda scene: scene, {"multiscatter": "off"}),
}
CAUSES = {
    "AlphaBlendModeTest": "WebP mixes the colours of the stripes",
    "Box": "Cycles and V-Ray have the exact Fresnel curve, we that of glTF (Schlick's)",
    "BoxAnimated": "three-gpu-pathtracer is darker on rough dielectrics, as in all scenarios",
    "Fox": "three-gpu-pathtracer is darker on rough dielectrics, as in all scenarios",
    "GlamVelvetSofa": "Blender divides the lux of the file by 683 lm/W, so that its light is not seen",
    "MorphPrimitivesTest": "Blender computes normals anew where the file keeps them; V-Ray shows what we do",
    "OrientationTest": "V-Ray and three-gpu-pathtracer lose light between facets of rough metal; Cycles loses some",
    "TextureLinearInterpolationTest": "V-Ray and three-gpu-pathtracer show emission darker than all others",
}
"""What is known beside encoding and compression."""


def main() -> None:
    options = _parse()
    scorer = fidelity.load_scorer()
    known = {row["scenario"]: row for row in json.loads((options.results / "fidelity.json").read_text())["rows"]}
    rows: list[dict[str, Any]] = []
    light: dict[tuple[str, str, int], list[float]] = {}
    with machine.until_stopped():
        for name, row in known.items():
            if "," not in name and options.only in name:
                scenario = _scenario(scorer, name, row)
                rows.append(_row(scorer, scenario, name, row, options.pictures, light))
                print(json.dumps(rows[-1]), flush=True)
    with open_context() as context:
        facts = machine.here() | {"renderer": context.renderer, "load average": os.getloadavg()[0]}
    tracing.keep("fidelity_causes", facts, rows, _page(scorer, rows, light), options.results)


def _scenario(scorer: ModuleType, name: str, row: dict[str, Any]) -> fidelity.Scenario:
    folder = corpus.FOLDER / "fidelity" / f"khronos-{name}"
    facts = json.loads((folder / "scenario.json").read_text())
    pictures = {engine: scorer.load(folder / f"{engine}-golden.thumb.webp") for engine in scorer.PATH_TRACED
                if (folder / f"{engine}-golden.thumb.webp").is_file()}
    pictures = {e: p for e, p in pictures.items() if p[1].shape[::-1] == tuple(facts["golden_size"])}
    return fidelity.Scenario(facts, pictures, tuple(row["references"]), row["floor"], row["third"])


def _row(scorer: ModuleType, scenario: fidelity.Scenario, name: str, known: dict[str, Any], pictures: Path,
         light: dict[tuple[str, str, int], list[float]]) -> dict[str, Any]:
    ours = _drawn(scenario, pictures / f"{name}.npz")
    plain = shown(*ours)
    undone = ours
    if name in UNDONE:
        undone = _drawn(scenario, pictures / f"{name}-undone.npz", *UNDONE[name][1:])
    score: dict[str, list[float]] = {step: [] for step in STEPS}
    for engine in scenario.references:
        reference = scenario.pictures[engine]
        encoded = coded_as(plain, engine)
        steps = {"plain": plain, "encoded": encoded, "compressed": _compressed(encoded)}
        if name in UNDONE:
            steps["undone"] = _compressed(coded_as(shown(*undone), engine))
        for step, picture in steps.items():
            score[step].append(float(scorer.distance(reference, picture)[0]))
    if name != "GlamVelvetSofa":  # its light is ours alone
        for engine, picture in scenario.pictures.items():
            _compare_levels(picture, engine, ours, light)
    means = {step: statistics.fmean(values) for step, values in score.items() if values}
    return {"scenario": name, "references": scenario.references, "floor": known["floor"], **means,
            "by reference": score,
            "multiples": {e: round(_multiple(p, e, ours), 4) for e, p in scenario.pictures.items()},
            "shifts": {e: _shift(p, ours) for e, p in scenario.pictures.items()}}


def _drawn(scenario: fidelity.Scenario, file: Path, change: Callable[[Scene], Scene] = lambda scene: scene,
           more: dict[str, Any] | None = None) -> Picture:
    """Our linear picture, not associated with its alpha, at the size of the references."""
    facts = scenario.facts
    if not file.is_file():
        scene = viewer.load(corpus.FOLDER / facts["model"]["path"],
                            environment=corpus.FOLDER / facts["environment"]["path"])
        camera = Camera.look_at(facts["camera"]["eye"], facts["camera"]["target"],
                                fov_y=np.radians(facts["camera"]["fovy_deg"]))
        background = "none" if facts["background"].startswith("transparent") else "env"
        width, height = facts["golden_size"]
        image = viewer.render(change(scene), (width, height), camera, background=background, **OPTIONS | (more or {}))
        file.parent.mkdir(parents=True, exist_ok=True)
        image.save(file)
    rgba = np.load(file)["rgba"]
    alpha = np.clip(rgba[..., 3], 0, 1)
    return rgba[..., :3] / np.maximum(alpha, 1e-6)[..., None], alpha


def _compressed(picture: Picture) -> Picture:
    """As WebP of the references' quality, whose colours have half the resolution of its brightness."""
    file = io.BytesIO()
    Image.fromarray((np.clip(picture[0], 0, 1) * 255 + 0.5).astype(np.uint8)).save(file, "WEBP", quality=90)
    return np.asarray(Image.open(file).convert("RGB"), np.float32) / 255, picture[1]


def _even(picture: Picture, ours: Picture) -> np.ndarray:
    """Where both are opaque, ours changes little from pixel to pixel, and no channel is near white."""
    rgb = shown(*ours)[0]
    steep = np.hypot(*np.gradient(rgb.mean(axis=2))) > 0.02
    return (picture[1] > 0.998) & (ours[1] > 0.998) & ~steep & (np.maximum(rgb, picture[0]).max(axis=2) < 0.97)


def _multiple(picture: Picture, engine: str, ours: Picture) -> float:
    """The engine's light as a multiple of ours: the median over even parts."""
    own = ours[0].mean(axis=2)
    even = _even(picture, ours) & (own > LEVELS[0])
    light = radiance(srgb_coded(picture, engine)).mean(axis=2)
    return float(np.median(light[even] / own[even])) if even.any() else 1.0


def _compare_levels(picture: Picture, engine: str, ours: Picture,
                    light: dict[tuple[str, str, int], list[float]]) -> None:
    """Adds the engine's light as a multiple of ours, level by level, for each way in which it may be encoded."""
    even = _even(picture, ours)
    own = ours[0].mean(axis=2)
    level = np.digitize(own, LEVELS)
    power = np.clip(picture[0], 0, 1) ** 2.2
    down = np.clip(picture[0] + 0.5 / 255, 0, 1) ** 2.2
    ways = {"sRGB": picture[0], "pow": linear_to_srgb(power), "pow, rounded down": linear_to_srgb(down)}
    for way, rgb in ways.items():
        other = radiance((rgb, picture[1])).mean(axis=2)
        for k in range(1, len(LEVELS)):
            if (seen := even & (level == k)).sum() > 300:
                light.setdefault((engine, way, k), []).append(float(np.median(other[seen] / own[seen])))


def _shift(picture: Picture, ours: Picture) -> list[float] | None:
    """How far the silhouette lies right and below of ours, in pixels, and how much larger it is, in percent: the least
    squares of alpha' = alpha - (x, y, s r) grad alpha, whose gradient is the mean of both."""
    alpha = ours[1].astype(np.float64)
    down, right = np.gradient((alpha + picture[1]) / 2)
    height, width = alpha.shape
    y, x = np.mgrid[:height, :width] - np.array([height - 1, width - 1]).reshape(2, 1, 1) / 2
    change = picture[1] - alpha
    edge = (np.hypot(down, right) > 0.1) & (np.abs(change) < 0.6)
    if edge.sum() < 100:
        return None
    terms = np.stack([right[edge], down[edge], (right * x + down * y)[edge]], axis=1)
    found = -np.linalg.lstsq(terms, change[edge], rcond=None)[0]
    return [round(float(found[0]), 3), round(float(found[1]), 3), round(float(found[2]) * 100, 3)]


def _page(scorer: ModuleType, rows: list[dict[str, Any]],
          light: dict[tuple[str, str, int], list[float]]) -> list[str]:
    return ["# Fidelity: why path-traced pictures differ", "",
            "Scores of our path-traced pictures of [fidelity.md](fidelity.md), step by step: as they are; encoded as",
            "each reference is; also compressed as it is (WebP, whose colours have half the resolution); also with",
            "what the references do otherwise undone. Ours have 24 samples a pixel, denoised, at the size of the",
            "references.", "",
            *_steps(rows), "",
            "## How path tracers encode", "",
            "The light of each path tracer as a multiple of ours, by the level of light, where its picture is decoded",
            "as sRGB, as pow(1 / 2.2), and as that rounded down: the median over scenarios. Of light decoded rightly",
            "the multiple hardly depends on the level.", "",
            *_levels(scorer, light), "",
            "## Light", "",
            "The light of path tracers as a multiple of ours, decoded as they encode.", "",
            *_multiples(scorer, rows), "",
            "## Camera", "",
            "How far the silhouettes of path tracers lie right and below of ours, in pixels, and how much larger they",
            "are, in percent.", "",
            *_shifts(scorer, rows), ""]


def _steps(rows: list[dict[str, Any]]) -> list[str]:
    head = ["scenario", "references", "they differ by", *STEPS, "cause"]
    lines = [head, ["---"] * len(head)]
    lines += [[row["scenario"], ", ".join(row["references"]), f"{row['floor']:.3f}",
               *(f"{row[step]:.3f}" if step in row else "" for step in STEPS),
               CAUSES.get(row["scenario"], "") + (f" (undone: {UNDONE[row['scenario']][0]})"
                                                  if row["scenario"] in UNDONE else "")] for row in rows]
    scored = [row for row in rows if row["scenario"] != "EmissiveStrengthTest"]  # a real-time engine lacks it
    if scored:
        means = (statistics.fmean(row.get(step, row["compressed"]) for row in scored) for step in STEPS)
        floor = statistics.fmean(row["floor"] for row in scored)
        lines.append([f"mean ({len(scored)})", "", f"{floor:.3f}", *(f"{mean:.4f}" for mean in means), ""])
    return _lines(lines)


def _levels(scorer: ModuleType, light: dict[tuple[str, str, int], list[float]]) -> list[str]:
    spans = [f"{a:g} to {b:g}" for a, b in pairwise(LEVELS)]
    lines = [["engine", "decoded as", *spans], ["---"] * (len(spans) + 2)]
    for engine in scorer.PATH_TRACED:
        for way in ("sRGB", "pow", "pow, rounded down"):
            found = [light.get((engine, way, k), []) for k in range(1, len(LEVELS))]
            lines.append([engine, way, *(f"{statistics.median(f):.2f}" if f else "" for f in found)])
    return _lines(lines)


def _multiples(scorer: ModuleType, rows: list[dict[str, Any]]) -> list[str]:
    lines = [["scenario", *scorer.PATH_TRACED], ["---"] * (len(scorer.PATH_TRACED) + 1)]
    lines += [[row["scenario"], *(f"{row['multiples'][e]:.2f}" if e in row["multiples"] else ""
                                  for e in scorer.PATH_TRACED)] for row in rows]
    return _lines(lines)


def _shifts(scorer: ModuleType, rows: list[dict[str, Any]]) -> list[str]:
    lines = [["scenario", *scorer.PATH_TRACED], ["---"] * (len(scorer.PATH_TRACED) + 1)]
    for row in rows:
        found = [row["shifts"].get(engine) for engine in scorer.PATH_TRACED]
        if any(found):
            lines.append([row["scenario"], *(f"{f[0]:+.2f} {f[1]:+.2f} {f[2]:+.2f} %" if f else "" for f in found)])
    return _lines(lines)


def _lines(cells: list[list[str]]) -> list[str]:
    return ["| " + " | ".join(line) + " |" for line in cells]


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fidelity_causes", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", metavar="NAME", help="scenarios whose name has this in it")
    parser.add_argument("--pictures", type=Path, default=Path("fidelity-causes"), metavar="DIR",
                        help="keep pictures there, and take those that are")
    parser.add_argument("--results", type=Path, default=shot.REPOSITORY / "benchmarks/results")
    return parser.parse_args()


if __name__ == "__main__":
    main()
