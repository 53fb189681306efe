"""The information that `pbr-viewer info` prints: about a model and its plan, or about the package."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from importlib.metadata import version
from typing import TYPE_CHECKING

import numpy as np

from ..bake.environment import bake_environment
from ..plan.media import lights_of_volumes, most_of_volumes
from ..plan.model import Plan
from ..plan.planner import environment_use, plan_scene
from ..quality import DRAFT, Quality
from ..ranges import Several, WeaveName
from ..scene.curve_segments import segments
from ..scene.curves import Curves
from ..scene.decoding import Decoder
from ..scene.environment import Environment
from ..scene.scene import Scene
from ..scene.yarn.fibres import FIBRE_BYTES, yarn_fibres
from ..scene.yarn.spun import yarn_kind
from ..settings import RANGES, Settings, setting_choices, setting_meanings

if TYPE_CHECKING:
    from ..trace.plan import TracePlan

Facts = dict[str, object]


def describe_scene(scene: Scene, settings: Settings, quality: Quality = DRAFT) -> Facts:
    """The content of the scene and its plan at a quality, in types that JSON can store. No OpenGL context is opened.

    Images are decoded to find out whether they can be; `scene.all_warnings` says of those that cannot.
    """
    for _ in Decoder(((image,) for image in scene.images), lambda image: image.decode("R")).results():
        pass
    low, high = scene.bounds
    settings = quality.applied(settings)
    plan = _plan(scene, settings)
    environment = scene.environment
    return {
        "name": scene.name,
        **scene.facts,
        "instances": len(scene.instances),
        "primitives": dict(Counter(mesh.topology for mesh in scene.meshes)),
        "triangles": scene.triangle_count,
        "vertices": sum(len(mesh.positions) for mesh in scene.meshes),
        "bounds_m": [low.tolist(), high.tolist()],
        "radius_m": scene.radius,
        "materials": [_material_line(scene, k) for k in range(len(scene.materials))],
        "curves": [_curves_facts(curves) for curves in scene.curves],
        **({"yarns": [_yarn_facts(curves, settings) for curves in scene.curves]} if settings.yarn != "off" else {}),
        "lights": [f"{light.kind} {light.name or '(unnamed)'}, {light.intensity:g} {_unit(light.kind)}"
                   for light in scene.lights],
        "cameras": [camera.name or "(unnamed)" for camera in scene.cameras],
        "variants": [variant.name for variant in scene.variants[1:]],
        "animations": [f"{animation.name}, {animation.duration:.6g} s: {animation.moves}"
                       for animation in scene.animations],
        "environment": _environment_line(environment) if environment is not None else "none",
        "warnings": list(scene.all_warnings),
        "plan": quality.facts(settings) | plan.to_json(),
    }


def describe_package() -> Facts:
    """The formats that this program reads and writes, and the folder of its cache, in types that JSON can store."""
    from ..bake.cache import cache_folder
    from ..image.film import FILM_FORMATS
    from ..image.image import WRITABLE
    from ..scene.environment_files import FORMATS
    from ..scene.environment_presets import PRESETS
    from ..scene.load import CURVE_FORMATS, VOLUME_FORMATS, optional_formats
    from ..scene.mesh_formats import mesh_formats

    return {
        "version": version("pbr-viewer"),
        "models": " ".join(sorted({"gltf", "glb"} | optional_formats() | mesh_formats())),
        "volumes": " ".join(VOLUME_FORMATS),
        "curves": " ".join(CURVE_FORMATS),
        "environments": " ".join([*PRESETS, "none", *(f"*{suffix}" for suffix in FORMATS)]),
        "pictures": " ".join(WRITABLE),
        "films": " ".join(FILM_FORMATS),
        "cache": str(cache_folder() or "off"),
    }


def settings_table() -> list[dict[str, object]]:
    """The settings for --set: name, choices or the range of a number, default and meaning of each."""
    default, choices = Settings(), setting_choices()
    return [{"name": name, **({"choices": list(choices[name])} if name in choices else _range(name)),
             "default": getattr(default, name), "meaning": meaning} for name, meaning in setting_meanings().items()]


def _range(name: str) -> Facts:
    numbers = RANGES[name]
    if isinstance(numbers, WeaveName):
        return {"form": str(numbers)}
    return {"range": [numbers.low, numbers.high], "whole": numbers.is_whole}


def _placeholder(name: str) -> str:
    numbers = RANGES[name]
    if isinstance(numbers, WeaveName):
        return "WEAVE[,MATERIAL]"
    return numbers.names if isinstance(numbers, Several) else "N"


def format_settings() -> str:
    """`settings_table` as text, two lines each."""
    default, choices, lines = Settings(), setting_choices(), []
    for name, meaning in setting_meanings().items():
        values = "|".join(choices[name]) if name in choices else f"{_placeholder(name)}, {RANGES[name]}"
        value = getattr(default, name)
        value = "none" if value is None else value
        shown = ",".join(f"{part:g}" for part in value) if isinstance(value, tuple) else value
        lines += [f"--set {name.replace('_', '-')}={values}", f"      {meaning}; default: {shown}"]
    return "\n".join(lines)


def format_facts(facts: Facts, indent: str = "") -> str:
    """The facts as text: one line for each; lists and nested facts follow below their name."""
    lines = []
    for name, value in facts.items():
        label = indent + name.replace("_", " ")
        if value in ([], {}, None):
            lines.append(f"{label}: none")
        elif isinstance(value, dict):
            lines += [f"{label}:", format_facts(value, indent + "  ")]
        elif isinstance(value, list) and any(isinstance(item, (str, dict)) for item in value):
            lines.append(f"{label}:")
            lines += [f"{indent}  - {_one_line(item) or '(unnamed)'}" for item in value]
        else:
            lines.append(f"{label}: {_one_line(value)}")
    return "\n".join(lines)


def _one_line(value: object) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{name} {_one_line(item)}" for name, item in value.items())
    if isinstance(value, list):
        return "  ".join(_one_line(item) for item in value)
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _plan(scene: Scene, settings: Settings) -> Plan | TracePlan:
    """The plan as for a picture, with a perspective camera and the samples of a still picture."""
    if settings.mode == "path":
        from ..trace.scene.traced_scene import plan_without_device

        return plan_without_device(scene, settings)
    is_lit, is_reflected = environment_use(scene, settings)
    suns = bake_environment(scene.environment, settings.ndf, levels=is_reflected).suns \
        if is_lit and scene.environment is not None else ()
    others = [*scene.lights, *suns]
    lights = [*others, *lights_of_volumes(scene, settings, most_of_volumes(settings, others))]
    plan = plan_scene(scene, settings, lights, half_target=True, orthographic=False,
                      samples=settings.samples(is_software=False, is_still=True),
                      deferred=settings.defers(is_software=False, is_still=True))
    if settings.mode == "pbr" and settings.caustics == "photons":
        from ..raster.caustics import plan_lines

        used, left_out = plan_lines(scene, settings)
        plan = replace(plan, used=(*plan.used, *used), left_out=(*plan.left_out, *left_out))
    return plan


def _material_line(scene: Scene, index: int) -> str:
    material = scene.materials[index]
    words = [material.name or f"material {index}", material.alpha_mode]
    words += ["unlit"] * material.unlit + ["double-sided"] * material.double_sided
    words += [f"metallic {material.metallic:g}", f"roughness {material.perceptual_roughness:g}"]
    words += [f"transmission {material.transmission:g}"] * (material.transmission > 0)
    words += [f"thickness {material.thickness:g}"] * (material.transmission > 0 and material.thickness > 0)
    return ", ".join(words)


def _curves_facts(curves: Curves) -> Facts:
    """`segments` is the number of straight ones that are drawn, and `length` theirs."""
    pieces = segments(curves)
    length = np.linalg.norm(pieces.ends[:, 1, :3] - pieces.ends[:, 0, :3], axis=1).sum(dtype=np.float64)
    return {"name": curves.name, "kind": curves.kind, "strands": curves.strand_count,
            "closed": int(np.count_nonzero(curves.closed)), "points": len(curves.points), "segments": len(pieces),
            "length": float(length), "radii": [float(curves.radii.min()), float(curves.radii.max())],
            "colors": curves.colors is not None}


def _yarn_facts(curves: Curves, settings: Settings) -> Facts:
    """What becomes of a set of curves as yarns."""
    kind = yarn_kind(settings)
    made = yarn_fibres(curves, kind)
    own = kind.plies * kind.fibres * curves.strand_count
    return {"name": curves.name, "kind": settings.yarn, "yarns": curves.strand_count,
            "plies": kind.plies * curves.strand_count, "fibres": own, "hairs": made.strand_count - own,
            "segments": int(made.spans.sum()), "megabytes": float(made.spans.sum()) * FIBRE_BYTES / 1e6}


def _unit(kind: str) -> str:
    return "lx" if kind == "directional" else "cd"


def _environment_line(environment: Environment) -> str:
    radiance = environment.radiance
    height, width = radiance.shape[:2]
    return f"{environment.name}, {width} x {height}, radiance up to {float(radiance.max()):.6g}"
