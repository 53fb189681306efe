"""Explains a plan in text: what of the scene is used, what is left out and why, and what that saves."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypedDict

from ..base.counted import counted
from ..material.fold import without_constant_maps
from ..material.use import texture_bytes
from ..scene.light import Light
from ..scene.scene import Scene
from ..scene.schema import MAPS
from ..settings import Settings
from .left_out import ATTRIBUTE_BYTES, is_any_lit, left_out_lines
from .model import Plan
from .used import used_lines

_LEVELS_MB = sum((512 >> k) * (1024 >> k) * 6 for k in range(6)) / 1e6  # three half floats per texel
_LEVELS_BAKE_S = 0.11
"""Seconds on one core, with the map in memory. With the cache on disk it is needed only once."""
_DFG_MB = 64 * 128 * 16 / 1e6


class Explanation(TypedDict):
    used: tuple[str, ...]
    left_out: tuple[str, ...]
    saved: dict[str, float]


def explain(plan: Plan, scene: Scene, settings: Settings, lights: Sequence[Light]) -> Explanation:
    """The fields `used`, `left_out` and `saved` of the plan. `lights` are all lights, including those left out."""
    if plan.is_everything:
        return {"used": used_lines(plan), "left_out": ("nothing, as requested",), "saved": {}}
    images, left_out = _unused_images(plan, scene)
    bakes = _skipped_bakes(plan, settings)
    saved = {
        "texture_mb": round(sum(map(texture_bytes, images)) / 1e6 + sum(mb for _, mb, _ in bakes), 3),
        "buffer_mb": round(_unused_attributes(plan, scene) / 1e6, 3),
        "bake_s": round(sum(seconds for _, _, seconds in bakes), 2),
    }
    return {"used": used_lines(plan), "saved": saved,
            "left_out": (*left_out_lines(plan, scene, settings, lights), *(line for line, _, _ in bakes), *left_out)}


def _skipped_bakes(plan: Plan, settings: Settings) -> list[tuple[str, float, float]]:
    """The tables for image-based lighting that are not baked: a line, MB of texture and seconds of baking for each."""
    if not is_any_lit(plan.kinds) or (plan.reflections and plan.dfg):
        return []
    if settings.mode == "phong":
        reason = "mode phong does not use them"
    elif plan.dfg:
        reason = "there is no environment" if not plan.environment else "reflections are not shown"
    else:
        reason = "no surface reflects"
    names = ["prefiltered environment"] * (not plan.reflections) + ["DFG table"] * (not plan.dfg)
    megabytes = _LEVELS_MB * (not plan.reflections) + _DFG_MB * (not plan.dfg)
    seconds = _LEVELS_BAKE_S * (not plan.reflections and (plan.environment or plan.ambient))
    line = f"{' and '.join(names)}: {reason}; saves {megabytes:.3g} MB"
    return [(line + f" and about {seconds:g} s of baking" * bool(seconds), megabytes, seconds)]


def _unused_images(plan: Plan, scene: Scene) -> tuple[set, list[str]]:
    """The images that no program samples, and lines about the maps that are not sampled."""
    sampled = {(draw.material, name) for draw in plan.kinds for name in draw.maps}
    all_maps = {(k, name): texture.image for k, m in enumerate(scene.materials) for name in MAPS
                if (texture := MAPS[name].texture(m))}
    folded = {k: without_constant_maps(scene.materials[k]) for k, _ in all_maps.keys() - sampled}
    constant = {(k, name) for k, name in all_maps.keys() - sampled if MAPS[name].texture(folded[k]) is None}
    given_up = {(draw.material, name) for draw in plan.kinds for name in MAPS
                if f"{name.upper()}_MAP" in draw.given_up}
    unused = all_maps.keys() - sampled - constant - given_up
    images = {all_maps[key] for key in unused | constant} - {all_maps[key] for key in sampled}
    lines = []
    if unused:
        saved = sum(map(texture_bytes, images)) / 1e6
        lines.append(f"{counted(len(unused), 'material map')}, not decoded: no pixel depends on "
                     f"{'them' if len(unused) > 1 else 'it'}; saves {saved:.3g} MB")
    if constant:
        lines.append(f"{counted(len(constant), 'material map')} of one colour: folded into factors")
    return images, lines


def _unused_attributes(plan: Plan, scene: Scene) -> int:
    """The bytes of the vertex attributes that no program reads, of the meshes that are drawn."""
    read: dict[int, set[str]] = {}
    for draw in plan.kinds:
        read.setdefault(draw.mesh, set()).update(draw.attributes)
    return sum(size * len(scene.meshes[mesh].positions) for mesh, names in read.items()
               for name, size in ATTRIBUTE_BYTES.items() if name not in names)
