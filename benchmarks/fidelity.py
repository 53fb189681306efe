"""How near our pictures come to those of other engines: python -m benchmarks.fidelity [--pictures DIR] [--only NAME].

`--versions path everything` draws and scores these again, and keeps what the results have of the others.

The scenarios are those of the corpus, and so is the scorer, `score_fidelity.py`: mean FLIP over interior pixels,
against the two path tracers of a scenario that agree best. Each version of ours is scored twice: as it is, and encoded
as the reference is. Most engines encode by pow(1 / 2.2), and some round codes down, where we encode as sRGB says and
round to the nearest code. `benchmarks.fidelity_causes` shows which do, by their pictures.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import os
import statistics
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

import viewer
from viewer.gpu.context import open_context
from viewer.scene.camera import Camera

from . import corpus, machine, shot, tracing
from .encodings import Picture, coded_as, radiance, srgb_coded

VERSIONS: dict[str, dict[str, Any]] = {
    "default": {"quality": "auto"},
    "draft": {"quality": "draft"},
    "standard": {"quality": "standard"},
    "gtao": {"ambient_occlusion": "gtao"},
    "16 lights": {"environment_shadows": "16"},
    "64 lights": {"environment_shadows": "64"},
    "everything": {"environment_shadows": "64", "indirect": "baked", "reflections": "traced", "refraction": "traced"},
    "path": {"mode": "path", "spp": 64},
    "path, denoised": {"mode": "path", "spp": 8, "denoise": "oidn"},
}
SCALE = {"path": 1 / 3}
"""Of the size that the scenario names; the scorer reduces to a third of it. Others have `DEFAULT_SCALE`."""
DEFAULT_SCALE = 0.5
RULE = 2
"""Of these encodings, by which a score in brackets and light were found. Results without a number are of the first one,
which knew the first two engines of `encodings.POWER_CODED` and no rounding."""
LIGHT_OF = "path, denoised"
"""The version whose light that of other engines is a multiple of."""
LIGHTLESS = {"khronos-GlamVelvetSofa": ("default", "path")}
"""Scenarios whose references leave out the lights of the file, and the versions that are also drawn without them."""

@dataclass(frozen=True, eq=False)
class Scenario:
    """One scenario, with all engines' pictures of it. `references` are the path tracers that agree best."""

    facts: dict[str, Any]
    pictures: dict[str, Picture]
    references: tuple[str, ...]
    floor: float
    third: float | None
    """The distance of the nearest other path tracer."""

    @property
    def name(self) -> str:
        return str(self.facts["scenario"])


def main() -> None:
    options = _parse()
    scorer = load_scorer()
    kept: dict[str, dict[str, Any]] = {}
    before = options.results / "fidelity.json"
    if (options.versions or options.kept) and before.is_file():
        kept = {row["scenario"]: row for row in json.loads(before.read_text())["rows"]}
    rows: list[dict[str, Any]] = []
    loads: list[float] = []
    with machine.until_stopped():
        for scenario in _agreed(scorer, options.only):
            for without_lights in (False, True) if scenario.name in LIGHTLESS else (False,):
                rows.append(_row(scorer, scenario, options, without_lights, kept))
                loads.append(round(os.getloadavg()[0], 1))
                print(json.dumps(rows[-1]), flush=True)
    if not rows:
        raise SystemExit("no scenario was reached, so the results are as they were")
    rows = joined(kept, rows)
    with open_context() as context:
        facts = machine.here() | {"renderer": context.renderer, "load average": f"{min(loads)} to {max(loads)}"}
    tracing.keep("fidelity", facts, rows, _page(scorer, rows), options.results)


def joined(kept: dict[str, dict[str, Any]], rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The rows, and those of the results before whose scenarios were not asked for, or not reached."""
    return list((kept | {row["scenario"]: row for row in rows}).values())


def load_scorer() -> ModuleType:
    path = corpus.FOLDER.parent / "tools/score_fidelity.py"
    spec = importlib.util.spec_from_file_location("score_fidelity", path)
    if spec is None or spec.loader is None or not path.is_file():
        raise SystemExit(f"{path}: the scorer of the corpus is not there")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _agreed(scorer: ModuleType, only: str) -> Iterator[Scenario]:
    """The scenarios with two path tracers that agree, by name."""
    for path in sorted((corpus.FOLDER / "fidelity").glob("*/scenario.json")):
        facts = json.loads(path.read_text())
        if only not in facts["scenario"]:
            continue
        found = {e: path.parent / f"{e}-golden.thumb.webp" for e in (*scorer.REAL_TIME, *scorer.PATH_TRACED)}
        pictures = {engine: scorer.load(file) for engine, file in found.items() if file.is_file()}
        pictures = {e: p for e, p in pictures.items() if p[1].shape[::-1] == tuple(facts["golden_size"])}
        traced = [engine for engine in scorer.PATH_TRACED if engine in pictures]
        pairs = [(scorer.distance(pictures[a], pictures[b])[0], a, b) for k, a in enumerate(traced)
                 for b in traced[k + 1:]]
        floor, *pair = min((p for p in pairs if p[0] is not None), default=(1.0,))
        if floor < scorer.AGREE:
            # An engine whose picture is hardly opaque shares too few pixels with them for a distance.
            pictures = {e: p for e, p in pictures.items()
                        if all(scorer.distance(pictures[r], p)[0] is not None for r in pair)}
            thirds = [statistics.fmean(scorer.distance(pictures[r], pictures[e])[0] for r in pair)
                      for e in traced if e in pictures and e not in pair]
            yield Scenario(facts, pictures, tuple(pair), floor, min(thirds, default=None))


def _row(scorer: ModuleType, scenario: Scenario, options: argparse.Namespace, without_lights: bool,
         kept: dict[str, dict[str, Any]]) -> dict[str, Any]:
    label = scenario.name.removeprefix("khronos-") + ", without the file's lights" * without_lights
    own = [_score(scorer, scenario, srgb_coded(scenario.pictures[e], e)) for e in scenario.references]
    row: dict[str, Any] = {"scenario": label, "references": scenario.references, "floor": scenario.floor,
                           "third": scenario.third, "own": min(own, key=lambda score: score["plain"]),
                           "engines": {e: statistics.fmean(_distance(scorer, scenario, r, scenario.pictures[e])
                                                           for r in scenario.references)
                                       for e in scorer.REAL_TIME if e in scenario.pictures}}
    for version in LIGHTLESS[scenario.name] if without_lights else VERSIONS:
        file = options.pictures / version / f"{scenario.name}{'-lightless' * without_lights}.png"
        is_left = options.versions and version not in options.versions
        if is_left or (options.kept and not file.is_file()):
            names = (version, "light") if version == LIGHT_OF else (version,)
            row |= {name: kept[label][name] for name in names if name in kept.get(label, {})}
            continue
        if not file.is_file():
            _draw(scenario, version, file, without_lights)
        ours = scorer.load(file, tuple(scenario.facts["golden_size"]))
        row[version] = _score(scorer, scenario, ours)
        if version == LIGHT_OF:
            row["light"] = _light(scenario, ours)
    return row


def _draw(scenario: Scenario, version: str, file: Path, without_lights: bool) -> None:
    facts = scenario.facts
    scene = viewer.load(corpus.FOLDER / facts["model"]["path"],
                        environment=corpus.FOLDER / facts["environment"]["path"])
    if without_lights:
        scene = replace(scene, lights=())
    camera = Camera.look_at(facts["camera"]["eye"], facts["camera"]["target"],
                            fov_y=np.radians(facts["camera"]["fovy_deg"]))
    scale = SCALE.get(version, DEFAULT_SCALE)
    width, height = (max(1, round(side * scale)) for side in facts["render_size"])
    background = "none" if facts["background"].startswith("transparent") else "env"
    image = viewer.render(scene, (width, height), camera, background=background, tonemap="aces", **VERSIONS[version])
    file.parent.mkdir(parents=True, exist_ok=True)
    image.save(file)


def _score(scorer: ModuleType, scenario: Scenario, picture: Picture) -> dict[str, float]:
    """Mean distance to the references, as the picture is and encoded as each of them is; and the `RULE` of that."""
    return {"rule": RULE} | {way: statistics.fmean(_distance(scorer, scenario, engine, picture if way == "plain"
                                                         else coded_as(picture, engine))
                                               for engine in scenario.references) for way in ("plain", "alike")}


def _distance(scorer: ModuleType, scenario: Scenario, engine: str, picture: Picture) -> float:
    return float(scorer.distance(scenario.pictures[engine], picture)[0])


def _light(scenario: Scenario, ours: Picture) -> dict[str, float]:
    """How much light each engine's picture has: the median over opaque pixels, as a multiple of that of ours."""
    own = radiance(ours).sum(axis=2)
    found = {}
    for engine, picture in scenario.pictures.items():
        light = radiance(srgb_coded(picture, engine)).sum(axis=2)
        opaque = (picture[1] > 0.998) & (ours[1] > 0.998)
        found[engine] = float(np.median(light[opaque] / np.maximum(own[opaque], 1e-4)))
    return found


def _light_table(scorer: ModuleType, rows: list[dict[str, Any]]) -> list[str]:
    engines = [*scorer.PATH_TRACED, *scorer.REAL_TIME]
    lines = [["scenario", *engines], ["---"] * (len(engines) + 1)]
    lines += [[row["scenario"], *(_marked([row], LIGHT_OF, f"{row['light'][e]:.2f}") if e in row["light"] else ""
                                  for e in engines)]
              for row in rows if "light" in row]
    return ["| " + " | ".join(line) + " |" for line in lines]


def _page(scorer: ModuleType, rows: list[dict[str, Any]]) -> list[str]:
    return ["# Fidelity: our pictures and other engines'", "",
            "Mean FLIP over interior pixels against the two path tracers that agree best; less is better. A number in",
            "brackets is of the same picture, encoded as each reference is. The rank is that of our default among four",
            "real-time engines, the best of which would be 1 and the last 5. *A reference's own* is what a renderer",
            "would score that agrees with the better of both references in all but the encoding, sRGB. *Third*",
            "is the nearest path tracer that is not a reference. Other engines drew at the scenario's size, we at half",
            "of it, and paths that are not denoised at a third. All are reduced to a third of it. Numbers in italics",
            "take Cycles and V-Ray alone for engines that encode by pow(1 / 2.2), and none for one that rounds codes",
            "down: they are older than what [fidelity_causes.md](fidelity_causes.md) shows of the others.", "",
            *_table(scorer, rows), "",
            "How much light the pictures of the engines have, before the tone curve: the median over opaque pixels, as",
            "a multiple of that of *path, denoised*.", "",
            *_light_table(scorer, rows), ""]


def _table(scorer: ModuleType, rows: list[dict[str, Any]]) -> list[str]:
    head = ["scenario", "references differ by", "a reference's own", "third", "rank", *VERSIONS, *scorer.REAL_TIME]
    lines = [head, ["---"] * len(head)]
    for row in rows:
        engines = row["engines"]
        own = row.get("default")
        rank = str(1 + sum(score < own["plain"] for score in engines.values())) if own else ""
        lines.append([row["scenario"], f"{row['floor']:.3f}", _marked([row], "own", f"{row['own']['plain']:.3f}"),
                      f"{row['third']:.3f}" if row["third"] else "", rank, *(_cell([row], v, 3) for v in VERSIONS),
                      *(f"{engines[e]:.3f}" if e in engines else "" for e in scorer.REAL_TIME)])
    full = [row for row in rows if len(row["engines"]) == len(scorer.REAL_TIME) and "without" not in row["scenario"]]
    complete = [row for row in full if VERSIONS.keys() <= row.keys()]
    groups = {"mean": full, "mean of those that all versions have": complete}
    for label, group in groups.items():
        if group:
            engines = (f"{statistics.fmean(row['engines'][e] for row in group):.3f}" for e in scorer.REAL_TIME)
            floor = f"{statistics.fmean(row['floor'] for row in group):.3f}"
            own = _marked(group, "own", f"{statistics.fmean(row['own']['plain'] for row in group):.3f}")
            thirds = [row["third"] for row in group if row["third"]]
            lines.append([f"{label} ({len(group)})", floor, own,
                          f"{statistics.fmean(thirds):.3f} ({len(thirds)})" if thirds else "", "",
                          *(_cell(group, version, 4) for version in VERSIONS), *engines])
    return ["| " + " | ".join(line) + " |" for line in lines]


def _cell(rows: list[dict[str, Any]], version: str, digits: int) -> str:
    """The means of the scores of one version, in italics where any is of an older rule; empty if a row lacks it."""
    if not all(version in row for row in rows):
        return ""
    plain, alike = (f"{statistics.fmean(row[version][way] for row in rows):.{digits}f}" for way in ("plain", "alike"))
    return f"{plain} ({_marked(rows, version, alike)})"


def _marked(rows: list[dict[str, Any]], version: str, number: str) -> str:
    return number if all(row[version].get("rule") == RULE for row in rows) else f"*{number}*"


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fidelity", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", metavar="NAME", help="scenarios whose name has this in it")
    parser.add_argument("--pictures", type=Path, default=Path("fidelity-pictures"), metavar="DIR",
                        help="keep pictures there, and take those that are")
    parser.add_argument("--versions", nargs="+", choices=VERSIONS, metavar="VERSION",
                        help="draw and score these, and keep what the results have of the others")
    parser.add_argument("--kept", action="store_true", help="draw none; score those that are in --pictures")
    parser.add_argument("--results", type=Path, default=shot.REPOSITORY / "benchmarks/results")
    return parser.parse_args()


if __name__ == "__main__":
    main()
