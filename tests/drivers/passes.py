"""The programs that no plan names: passes over whole pictures, intersection, and the window's panel."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import product

from compiled import Sources

from viewer.gpu.source import assemble
from viewer.trace.defines import shader_defines, surface_defines
from viewer.trace.paths.wavefront import LAYERS, SUMS
from viewer.trace.rays.bvh import CURVES_LEAF, INSTANCE_TEXELS, NODE_TEXELS, TRIANGLE_TEXELS
from viewer.trace.rays.bvh4 import LEAF_SHIFT
from viewer.trace.rays.intersect import SHADOW_REACH

_FULLSCREEN = "display/fullscreen.vert"
_OVER_PICTURES: dict[str, dict[str, tuple[float, ...]]] = {
    "display/display.frag": {"TONEMAP": (0, 1, 2, 3), "DITHER": (0, 1), "BACKDROP": (0, 1)},
    "display/enlarge.frag": {},
    "raster/resolve.frag": {"SAMPLES": (1, 4, 8), "SUPERSAMPLING": (1, 2)},
    "raster/triangles.frag": {},
    "raster/choose.frag": {"TRIANGLE_BITS": (22,), "OBJECTS": (1 << 20,), "FAR": (0, 1), "SAMPLES": (2, 4),
                           "BACKGROUND": (0, 1)},
    "raster/choose_second.frag": {"TRIANGLE_BITS": (22,), "OBJECTS": (1 << 20,), "FAR": (0, 1), "SAMPLES": (2, 4),
                                  "NOTHING": (0.5,)},
    "raster/resolve_second.frag": {"SAMPLES": (2, 4), "OVER": (0, 1)},
    "raster/background.frag": {"HALF_TARGET": (0, 1), "SMOOTH": (0, 1), "MEDIA": (0, 1)},
    "raster/media_sky.frag": {"HALF_TARGET": (0, 1)},
    "raster/backdrop.frag": {"LEVEL": (0, 1)},
    "raster/caustics.frag": {},
    "raster/overdraw.frag": {"SHOW": (-1,), "COLORS": (8,)},
    "raster/visibility.frag": {},
    "raster/ambient_occlusion.frag": {"IS_ORTHOGRAPHIC": (0, 1)},
    "raster/environment_shadows.frag": {
        "LIGHTS": (16, 64), "ESTIMATED": (0, 1), "IS_ORTHOGRAPHIC": (0, 1), "TINTED": (0, 1)},
    "raster/reflection_rays.frag": {"IS_ORTHOGRAPHIC": (0, 1)},
    "raster/reflected_light.frag": {"REFLECTS": (1,), "ENVIRONMENT_ROTATED": (0, 1)},
    "raster/reflected_mean.frag": {},
    "raster/spread_subsurface.frag": {"POINTS": (18, 48)},
    "raster/refraction_step.frag": {"REFLECTS": (1,), "HAS_ENVIRONMENT": (0, 1), "ENVIRONMENT_ROTATED": (0, 1),
                                    "BANDS": (0, 1)},
    "trace/film/mean.frag": {}, "trace/film/add.frag": {}, "trace/film/join.frag": {},
    "trace/film/error.frag": {}, "trace/count_rays.frag": {},
    "trace/denoise/prepare.frag": {}, "trace/denoise/variance.frag": {}, "trace/denoise/wavelet.frag": {},
    "trace/denoise/resolve.frag": {},
}
"""The values of the switches of each pass that one triangle draws."""
_SKY = dict.fromkeys(("HAS_FOG", "HAS_TRANSMISSION", "HAS_SCATTERING", "HAS_PANES", "HAS_NESTED", "HAS_GRIDS",
                      "HAS_LIGHT_TREE", "HAS_SEE_THROUGH", "DISPERSIVE", "ENVIRONMENT_ROTATED", "SAMPLING", "RAYS"), 0)
"""Switches of what resolves pixels without triangles: such pixels see none of these."""


def passes() -> list[Sources]:
    programs = [_program(_FULLSCREEN, file, shader_defines(dict(zip(choices, values, strict=True))))
                for file, choices in _OVER_PICTURES.items() for values in product(*choices.values())]
    programs += [_program("trace/film/resolve.vert", "trace/film/resolve.frag", shader_defines({"COUNT": count}))
                 for count in (SUMS, LAYERS)]
    for background in (0, 1, 2):
        defines = shader_defines(_SKY | {"BACKGROUND": background})
        programs += [_program("trace/film/sky.vert", "trace/film/sky.frag", defines),
                     *(_program("trace/blocks.vert", "trace/begin_sums.frag", defines | {"CHOOSES_PIXELS": chooses})
                       for chooses in (0, 1)),
                     _program(_FULLSCREEN, "trace/sky.frag", defines | {"HAS_ENVIRONMENT": int(background > 0)})]
    programs += [_program(f"raster/{name}.vert", f"raster/{name}.frag", {}) for name in ("line", "grid", "triangles")]
    return [*programs, _program("app/gui.vert", "app/gui.frag", {})]


def intersections(switches: Mapping[str, int]) -> Iterator[Sources]:
    """Of the BVH in a shader and of shadow rays through surfaces with holes, for a scene of these switches."""
    tree = {"BVH_WIDTH": 4096, "NODE_TEXELS": NODE_TEXELS, "TRIANGLE_TEXELS": TRIANGLE_TEXELS,
            "BVH_INSTANCE_TEXELS": INSTANCE_TEXELS, "LEAF_SHIFT": LEAF_SHIFT, "STACK": 64, "SHADOW_REACH": SHADOW_REACH,
            "CURVES_SHIFT": CURVES_LEAF >> LEAF_SHIFT & 7}
    see_through = bool(switches["HAS_SEE_THROUGH"])
    for has_instances in (0, 1):
        defines = surface_defines(switches) | tree | {"HAS_INSTANCES": has_instances, "HAS_SEE_THROUGH": see_through}
        has_along = switches["HAS_SCATTERING"] or switches["HAS_PANES"]
        kind = "_transmittance" if has_along else "_see_through" * see_through
        yield _program(_FULLSCREEN, f"trace/intersect{kind}.frag", defines)
    if see_through or switches["HAS_PANES"]:
        yield _program(_FULLSCREEN, "trace/see_through.frag", surface_defines(switches))


def _program(vertex: str, fragment: str, defines: Mapping[str, float]) -> Sources:
    return {"vertex": assemble(vertex, defines), "fragment": assemble(fragment, defines)}
