"""What a plan draws and looks up, in words."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

from ..base.counted import counted
from ..material.use import texture_bytes
from ..scene.parameter import Feature
from ..scene.schema import MAPS, SWITCHED
from .curves import FIBRE_PIXELS, PLY_PIXELS
from .model import Plan


def used_lines(plan: Plan) -> tuple[str, ...]:
    """What the plan draws and looks up, in lines."""
    lines = []
    if plan.draws:
        shared = any(draw.blank_maps for draw in plan.kinds) and not plan.is_everything
        at_once = sum(len(draw.instances) for draw in plan.draws)
        lines.append(f"{counted(len(plan.draws), 'draw')} with {counted(len(plan.programs), 'program')}"
                     + f", of {counted(at_once, 'instance')} at once" * bool(at_once)
                     + ", some shared to compile fewer" * shared)
    if plan.lights:
        kinds = Counter(light.kind for light in plan.lights)
        tiles = f"; {counted(plan.shadow_layer_count, 'shadow map tile')}" * bool(plan.shadow_layer_count)
        lines.append("lights: " + ", ".join(f"{count} {kind}" for kind, count in kinds.items()) + tiles)
    if plan.environment or plan.ambient:
        parts = ["prefiltered levels"] * plan.reflections + ["irradiance map"] * plan.environment
        lines.append("light from the environment: " + ", ".join(parts or ["an ambient colour"]))
    if plan.has_visibility and plan.ambient_occlusion:
        lines.append("ambient occlusion, from the depth buffer")
    elif plan.has_visibility:
        lines.append(f"shadows of the environment, from {counted(plan.environment_shadows, 'light')} sampled from it"
                     + "; surfaces that block one reflect the mean colour of all" * plan.estimates_indirect
                     + "; glass colours them" * plan.tints_sky)
    if plan.has_traced_reflections:
        lines.append("traced reflections of the model: rays from each shaded point, lit by light baked at the vertices")
    if plan.has_traced_refraction:
        lines.append("traced refraction in solid glass: two paths per shaded point")
    if plan.has_indirect:
        lines.append("indirect light, path traced once at the vertices")
    if plan.media is not None:
        media = ["fog"] * plan.media.has_fog + [counted(plan.media.volumes, "volume")] * (plan.media.volumes > 0)
        lines.append(" and ".join(media) + ", by ray marching"
                     + "; multiple scattering by a diffusion equation" * plan.media.scatters_again)
    inside = sum(plan.count(draw) * draw.has_subsurface for draw in plan.kinds)
    if inside:
        lines.append(f"subsurface scattering in {counted(inside, 'solid')}, by the thickness behind each point"
                     + ", and spread over the surface in screen space" * plan.spreads_subsurface)
    if plan.curves is not None:
        shown = "strips that face the camera" if not plan.curves.are_yarns else (
            f"yarns, as tubes, from {PLY_PIXELS:g} pixels on as plies and from {FIBRE_PIXELS:g} as fibres")
        lines.append(f"{counted(plan.curves.strands, 'strand')} of curves, as {shown}, with "
                     f"{counted(len(plan.curves.programs), 'program')}; at least {plan.curves.megabytes:.3g} MB"
                     + "; light from fibre to fibre, by a diffusion equation" * plan.curves.scatters_again)
    count = sum(plan.count(draw) * (draw.program.get("WOVEN") == 1) for draw in plan.kinds)
    if count:
        lines.append(f"yarns of {counted(count, 'woven surface')}")
    # A shared program may have a feature for another material's sake.
    lines += feature_lines({feature: sum(
        plan.count(draw) for draw in plan.kinds if draw.program.get(feature.switch) and feature.is_on(draw.surface))
        for feature in SWITCHED})
    if plan.grid:
        lines.append("a grid on the ground, and the axes of the world")
    if plan.wireframe:
        lines.append("the edges of all triangles, as lines over the picture")
    textures = {(draw.material, name): texture for draw in plan.kinds for name in draw.maps
                if (texture := MAPS[name].texture(draw.surface))}
    if textures:
        images = {texture.image for texture in textures.values()}
        lines.append(f"{counted(len(textures), 'map')} from {counted(len(images), 'image')}, about "
                     f"{sum(map(texture_bytes, images)) / 1e6:.3g} MB with mipmaps")
    return tuple(lines)


def feature_lines(surfaces: Mapping[Feature, int]) -> list[str]:
    """A line for each feature of materials that any surface shows; `surfaces` has how many do."""
    return [f"{feature.title} of {counted(count, 'surface')}" for feature, count in surfaces.items() if count]
