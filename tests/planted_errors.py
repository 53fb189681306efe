"""Errors that tests of single features are to notice, each with these tests (break_features.py)."""

from __future__ import annotations

from dataclasses import dataclass

from mutations import Mutation


@dataclass(frozen=True)
class PlantedError(Mutation):
    """`file` is one of the project; some of `tests`, what pytest takes, fail."""

    tests: tuple[str, ...]


PIXEL_LOBE = ("tests/shaders/test_pixel_lobe.py", "tests/raster/test_lights.py", "tests/raster/test_normal_spread.py",
              "tests/raster/test_clearcoat.py")
DEEP_MEDIA = ("tests/shaders/test_deep_walk.py", "tests/shaders/test_endless.py", "tests/trace/test_deep_media.py")
GUIDE = ("tests/trace/test_caustic_rays.py", "tests/trace/test_guided_surfaces.py",
         "tests/trace/test_caustic_guide.py")
BACKGROUND = ("tests/shaders/test_bspline.py", "tests/trace/test_background_pictures.py")
CANDIDATES = ("tests/trace/test_light_candidates.py",)
ENCLOSED = ("tests/raster/test_enclosed.py",)
TRANSMISSION = ("tests/raster/test_transmission.py",)
DEFERRED = ("tests/raster/test_deferred_maps.py", "tests/raster/test_deferred.py")
MIXTURE = ("tests/estimate/test_combining.py", "tests/estimate/test_mixture.py")
GROUND = ("tests/raster/test_ground_map.py", "tests/estimate/test_ground.py")
ADAPTIVE = ("tests/trace/test_distribution.py", "tests/trace/test_schedule.py")

_LOBE = "shaders/bsdf/pixel_lobe.glsl"
_GLASS = "shaders/raster/glass_reflectance.glsl"
_LIGHT = "shaders/raster/shade_light.glsl"
_WALK = "shaders/media/deep_walk.glsl"
_ENDLESS = "shaders/trace/endless.glsl"
_DEEP = "viewer/trace/scene/deep_media.py"
_RAYS = "viewer/trace/scene/caustic_rays.py"
_GUIDE = "viewer/trace/scene/caustic_guide.py"
_GUIDE_GLSL = "shaders/trace/caustic_guide.glsl"
_LAYERED = "shaders/trace/layered.glsl"
_BSPLINE = "shaders/light/bspline.glsl"
_MAP = "viewer/gpu/smooth_map.py"
_LIGHTS = "viewer/trace/scene/lights.py"
_ENCLOSED = "viewer/raster/enclosed.py"
_AROUND = "shaders/raster/arriving_light.glsl"
_CHOOSE = "shaders/raster/choose.frag"
_SECOND = "shaders/raster/resolve_second.frag"
_DEFERRED_GLSL = "shaders/raster/deferred.glsl"
_BOXES = "viewer/raster/pixel_boxes.py"
_NUMBERS = "viewer/raster/numbered_triangles.py"
_GROUND, _GROUND_LIGHT = "viewer/raster/ground_map.py", "shaders/raster/ground_light.frag"
_COMBINE = "viewer/trace/denoise/combine.py"
_FAST = "viewer/trace/denoise/fast.py"
_SHARES = "viewer/trace/paths/distribution.py"
_SCHEDULE = "viewer/trace/paths/schedule.py"

PLANTED_ERRORS = [
    # highlights of lamps, averaged over their pixel
    PlantedError("a pixel's spread twice as wide", _LOBE, "a2 * (a2 + INV_PI * (dot(x, x)",
                 "a2 * (a2 + INV_PI * (2.0 * dot(x, x)", PIXEL_LOBE),
    PlantedError("the product of a pixel's two spreads lost", _LOBE, "(dot(xxy, xxy) + dot(xxz, xxz)",
                 "(dot(xxz, xxz)", PIXEL_LOBE),
    PlantedError("the product of a spread and the stretch lost", _LOBE, " + dot(yxz, yxz));", ");", PIXEL_LOBE),
    PlantedError("the tail of a lobe as wide as the pixel", _LOBE, "facet_alpha * facet_alpha / width);", "1.0);",
                 PIXEL_LOBE),
    PlantedError("the share of a lobe's tail by its square root", _LOBE, "facet_alpha * facet_alpha / width);",
                 "facet_alpha / sqrt(width));", PIXEL_LOBE),
    PlantedError("the masking of a spread lobe that of the lobe alone", _LOBE,
                 "alpha = min(alpha * sqrt(width / area), 1.0);", "", PIXEL_LOBE),
    PlantedError("a spread lobe wider than a hemisphere", _LOBE, "alpha = min(alpha * sqrt(width / area), 1.0);",
                 "alpha = alpha * sqrt(width / area);", PIXEL_LOBE),
    PlantedError("a half vector in the plane of the surface", _LOBE, "max(dot(n, h), 1e-4)", "dot(n, h)", PIXEL_LOBE),
    PlantedError("the stretch of a lobe not less what is common", _LOBE, "max(alpha.x * alpha.x - a2, 0.0)",
                 "max(alpha.x * alpha.x, 0.0)", PIXEL_LOBE),
    PlantedError("a coat's highlight averaged with the normals below", _LIGHT, "coat_x = D_DX(h - view.coat.n)",
                 "coat_x = D_DX(h - p.n)", PIXEL_LOBE),
    PlantedError("a coat's highlight as wide as the base", _LIGHT, "vec2 alphas = vec2(p.coat_alpha);",
                 "vec2 alphas = p.alphas;", PIXEL_LOBE),
    PlantedError("the tail of a bumpy lobe that of its spread", _LIGHT, "d_over_pixel(p.alphas, p.facet_alpha,",
                 "d_over_pixel(p.alphas, sqrt(p.alphas.x * p.alphas.y),", PIXEL_LOBE),
    PlantedError("half of a pixel's axes for its spread", _LIGHT, "slopes_y = D_DY(h - p.n);", "slopes_y = vec3(0.0);",
                 PIXEL_LOBE),

    # long steps deep in white media
    PlantedError("half of the light of a long step lost", _WALK, "vec3 large = 2.0 * x * exp(-x)",
                 "vec3 large = x * exp(-x)", DEEP_MEDIA),
    PlantedError("spheres that reach to the surface", _WALK,
                 "room = room_about(p.origin, medium) - record.w;\n        if", "room = room_about(p.origin, medium);\n"
                 "        if", DEEP_MEDIA),
    PlantedError("a first step that is not as long as it may be", _WALK, "first.y * (2.0 * u.z - 1.0)",
                 "first.y * (u.z - 1.0)", DEEP_MEDIA),
    PlantedError("long steps absorb nothing", _WALK, "p.throughput *= over_sinh(room * record.rgb);", "", DEEP_MEDIA),
    PlantedError("a first long step absorbs nothing", _WALK, "p.throughput *= over_sinh(abs(way) * record.rgb);", "",
                 DEEP_MEDIA),
    PlantedError("long steps pass lamps by", _WALK, "if (light.w >= 0.0) room = min(room, distance(p, light.xyz));", "",
                 DEEP_MEDIA),
    PlantedError("long steps leave the fog", _WALK, ", MEDIA_REACH - length(p));", ", MEDIA_REACH);", DEEP_MEDIA),
    PlantedError("long steps above the base of fog", _WALK, "room = min(room, scene_float4(u_fog).x - p.y);", "",
                 DEEP_MEDIA),
    PlantedError("light that long steps find as if it had been asked for", _WALK, "    p.pdf = 0.0; //", "    //",
                 DEEP_MEDIA),
    PlantedError("long steps in a hemisphere", _WALK, "float z = 1.0 - 2.0 * u.x", "float z = 1.0 - u.x", DEEP_MEDIA),
    PlantedError("collisions as many as the mean free path grows", _ENDLESS, "exp2(min(2.0 * doublings(p), 80.0))",
                 "exp2(min(doublings(p), 80.0))", DEEP_MEDIA),
    PlantedError("endless paths do not hurry", _ENDLESS,
                 "\n         + float(max(p.steps - HURRIES_FROM, 0)) / float(HURRIES_EVERY)", "", DEEP_MEDIA),
    PlantedError("endless paths absorb less and less", _ENDLESS, "m.albedo = albedo_left(m.albedo, p);", "",
                 DEEP_MEDIA),
    PlantedError("a margin by the free path alone where light goes on", _DEEP, "MARGIN * path * max(1.0, mean)",
                 "MARGIN * path", DEEP_MEDIA),
    PlantedError("the decay of light in mean free paths", _DEEP, "for albedo in medium.albedo]) * extinction",
                 "for albedo in medium.albedo])", DEEP_MEDIA),
    PlantedError("long steps where channels scatter apart", _DEEP, "if not (extinction > 0).all() or not (is_even",
                 "if not (extinction > 0).all() or not (True", DEEP_MEDIA),
    PlantedError("long steps in media that have no room for them", _DEEP, "record[0, 3] * LEAST_DEPTH <",
                 "record[0, 3] * 0.0 <", DEEP_MEDIA),

    # the guide to caustics
    PlantedError("photons towards small casters carry too little", _RAYS,
                 "sums[-1] * np.pi * radius**2 / share / PHOTONS", "sums[-1] * np.pi * radius**2 / PHOTONS", GUIDE),
    PlantedError("photons of the back of a double-sided lamp lost", _RAYS,
                 "np.where(is_double_sided, np.abs(cosine), np.maximum(cosine, 0.0))", "np.maximum(cosine, 0.0)",
                 GUIDE),
    PlantedError("photons of an environment that is turned the other way", _RAYS, "/ width - 0.5) - rotation",
                 "/ width - 0.5) + rotation", GUIDE),
    PlantedError("photons leave the back of mirrored lamps", _RAYS,
                 "placed[:, ::-1] if instance.is_mirrored else placed", "placed", GUIDE),
    PlantedError("photons straight from a lamp count", _RAYS, "ends = is_receiver[instance] & (last >= 0)",
                 "ends = is_receiver[instance]", GUIDE),
    PlantedError("photons are refracted as if they left the glass", _RAYS, "np.where(is_inside, ior, 1 / ior)",
                 "np.where(is_inside, 1 / ior, ior)", GUIDE),
    PlantedError("photons are reflected half", _RAYS, "direction + 2 * c[:, None] * h))",
                 "direction + c[:, None] * h))", GUIDE),
    PlantedError("normals of photons not turned with the body", _RAYS,
                 "unit_vectors(smooth @ normal_matrix(scene.instances[placed.source].transform).T)",
                 "unit_vectors(smooth)", GUIDE),
    PlantedError("photons of a cone twice as wide", _RAYS, "* cosine * 2 * np.pi * spread / share",
                 "* cosine * 4 * np.pi * spread / share", GUIDE),
    PlantedError("the guide's places without their area", _GUIDE, "irradiance = weights.sum(axis=1) / np.maximum(area",
                 "irradiance = weights.sum(axis=1) / np.maximum(1.0 + 0.0 * area", GUIDE),
    PlantedError("places of few photons are guided", _GUIDE, "shares[counts < _LEAST_PHOTONS * _COPIES] = 0.0", "pass",
                 GUIDE),
    PlantedError("the second caster has the first one's cells", _GUIDE, "first += len(cells[-1])", "pass", GUIDE),
    PlantedError("the second caster has the first one's places", _GUIDE_GLSL,
                 "(k * GUIDE_PLACES + place.y) * GUIDE_PLACES", "place.y * GUIDE_PLACES", GUIDE),
    PlantedError("the guide's share not that of rough light", _GUIDE_GLSL, "    g.share *= share;\n", "", GUIDE),
    PlantedError("samples of the guide weighed as beside none", _LAYERED,
                 "f.w = mix(f.w, guide_pdf(b.guide, wi), b.guide.share);", "", GUIDE),
    PlantedError("a coat's mirror loses what is guided", _LAYERED, "s.weight /= 1.0 - share;", "", GUIDE),
    PlantedError("samples beside the guide are of its number", _LAYERED, "(u.z - share) / (1.0 - share)", "u.z", GUIDE),

    # the background by B-splines
    PlantedError("B-splines mirrored within a texel", _BSPLINE, "vec4(w0.x, w1.x, w2.x, w3.x)",
                 "vec4(w3.x, w2.x, w1.x, w0.x)", BACKGROUND),
    PlantedError("a row of a buffer of texels too short", _BSPLINE, "+ 3 + EXACT_TEXELS;", "+ 3;", BACKGROUND),
    PlantedError("B-splines a texel to the side", _BSPLINE, "+ int(first.x) + 1;", "+ int(first.x) + 2;", BACKGROUND),
    PlantedError("B-splines without the map's unit", _BSPLINE, "return sum * shape.z;", "return sum;", BACKGROUND),
    PlantedError("codes of texels cut off instead of rounded", _MAP, "codes -= (exponent << 23) - _HALF",
                 "codes -= exponent << 23", BACKGROUND),
    PlantedError("a peak that rounds up overflows", _MAP, "view(np.int32)) + _HALF", "view(np.int32))", BACKGROUND),
    PlantedError("pairs of texels swapped", _MAP, "codes[:, 1:] << 16 | codes[:, :-1]",
                 "codes[:, :-1] << 16 | codes[:, 1:]", BACKGROUND),
    PlantedError("small texels of a map negative", _MAP, "np.maximum(codes, 0, out=codes)", "codes", BACKGROUND),
    PlantedError("the background without the environment's intensity", "shaders/raster/background.frag",
                 "equirect_uv(d)) * u_environment_intensity;\n#else", "equirect_uv(d));\n#else", BACKGROUND),
    PlantedError("the background of paths without the environment's intensity", "shaders/trace/background.glsl",
                 "return bspline(u_background, u_background_shape, uv) * u_environment_intensity;",
                 "return bspline(u_background, u_background_shape, uv);", BACKGROUND),

    # one of two light samples
    PlantedError("candidates are the same", "shaders/trace/light_candidates.glsl", "fract(u.xy + 0.5 * float(k))",
                 "u.xy", CANDIDATES),
    PlantedError("a candidate counts that is not chosen", "shaders/trace/light_candidates.glsl", "own = brings;",
                 "own = sum;", CANDIDATES),
    PlantedError("rooms with glass have two candidates", _LIGHTS, "1 + (not has_glass and is_room)}", "1 + is_room}",
                 CANDIDATES),
    PlantedError("rooms without emitters are rooms", _LIGHTS, "0 < geometry.emitters <=", "geometry.emitters <=",
                 CANDIDATES),
    PlantedError("rooms under an environment are rooms", _LIGHTS, "is_room = scene.environment is None and",
                 "is_room =", CANDIDATES),
    PlantedError("rooms of as many emitters as are chosen by power are none", _LIGHTS,
                 "geometry.emitters <= MOST_BY_POWER", "geometry.emitters < MOST_BY_POWER", CANDIDATES),

    # the inside of hollow glass
    PlantedError("a wall mirrors at one face", _ENCLOSED, "2.0 * single / (1.0 + single)", "single", ENCLOSED),
    PlantedError("what a wall mirrors is transmitted as well", _ENCLOSED,
                 "passed = (1.0 - metallic) * (1.0 - mirrored) *", "passed = (1.0 - metallic) *", ENCLOSED),
    PlantedError("what a wall mirrors is scattered as well", _ENCLOSED,
                 "(mirrored + (1.0 - mirrored) * (1.0 - transmitted)", "(mirrored + (1.0 - transmitted)", ENCLOSED),
    PlantedError("a wall over its opening", _ENCLOSED, "(opening + (1.0 - opening) * passed)", "(opening + passed)",
                 ENCLOSED),
    PlantedError("what is reflected inside leaves by no opening", _ENCLOSED,
                 "np.maximum(1.0 - (1.0 - opening) * returned", "np.maximum(1.0 - returned", ENCLOSED),
    PlantedError("a metal wall transmits", _ENCLOSED, "passed = (1.0 - metallic) *", "passed = 1.0 *", ENCLOSED),
    PlantedError("metalness of a wall from the wrong channel", _ENCLOSED, 'mapped("metallic_roughness", 2)',
                 'mapped("metallic_roughness", 1)', ENCLOSED),
    PlantedError("a wall of glass reflects at one face", _GLASS, "F = 2.0 * F / (1.0 + F);", "F = F;", TRANSMISSION),
    PlantedError("what is left of glass that transmits half is glass, too", _GLASS, "mix(s.f0, f0, transmission)", "f0",
                 TRANSMISSION),
    PlantedError("glass of an index near 1 has a rim", _GLASS, "min(max3(F) / max(w, 1e-6), s.f90)", "s.f90",
                 TRANSMISSION),
    PlantedError("lamps are reflected by glass as at the angle of view", "shaders/raster/pbr.frag",
                 "view.dielectric.f0 = lamp_f0;", "", TRANSMISSION),
    PlantedError("glass reflects alike at all angles", _GLASS, "mu = 1.0 - pow(w, 0.2)", "mu = 0.29", TRANSMISSION),
    PlantedError("a wall's map of transmission ignored", _ENCLOSED,
                 'material.transmission * mapped("transmission", 0)', "material.transmission", ENCLOSED),
    PlantedError("walls that face the inside enclose, too", "viewer/scene/mesh.py", " and np.vdot(a, areas) > 0 else",
                 " else", ENCLOSED),
    PlantedError("outer sides of walls in the light inside", _AROUND, "    if (!IS_FRONT) {\n        around *=",
                 "    if (IS_FRONT) {\n        around *=", ENCLOSED),
    PlantedError("the inner sides of walls mirror what is outside", _AROUND,
                 "for (int k = 0; k < 2; ++k) light[k] *= u_light_inside;", "", ENCLOSED),
    PlantedError("one colour of light inside of walls", _AROUND, "around *= u_light_inside;",
                 "around *= u_light_inside.r;", ENCLOSED),

    # deferred surfaces
    PlantedError("two objects of one plane are one surface", _CHOOSE,
                 "other >> TRIANGLE_BITS == first >> TRIANGLE_BITS && are_alike", "are_alike", DEFERRED),
    PlantedError("planes are alike whatever lies between them", _CHOOSE, "> 0.9 && max(apart.x, apart.y)",
                 "> 0.9 && 0.0 * max(apart.x, apart.y)", DEFERRED),
    PlantedError("triangles are alike whichever way they face", _CHOOSE, "return dot(a.xyz, b.xyz) > 0.9 &&",
                 "return", DEFERRED),
    PlantedError("sample 0 decides which surface is the first", _CHOOSE,
                 "for (int k = 1; k < SAMPLES - 1; ++k) first = last", "for (int k = 1; k < 1; ++k) first = last",
                 DEFERRED),
    PlantedError("a background before what is drawn over it", _SECOND,
                 "bits = bits.x == 0u ? bits.yx : bits;", "", DEFERRED),
    PlantedError("second surfaces in front of what is drawn over them", _SECOND, "* (1.0 - over.a);", ";", DEFERRED),
    PlantedError("fronts of mirrored deferred meshes are backs", _DEFERRED_GLSL,
                 "determinant * u_handedness > 0.0", "determinant > 0.0", DEFERRED),
    PlantedError("faces of mirrored deferred meshes are turned", _DEFERRED_GLSL,
                 "deferred_face = u_handedness * cross", "deferred_face = cross", DEFERRED),
    PlantedError("bitangents of mirrored deferred meshes are turned", _DEFERRED_GLSL, "tangent.w * u_handedness",
                 "tangent.w", DEFERRED),
    PlantedError("texture levels of deferred surfaces by the wrong edges", _DEFERRED_GLSL,
                 "deferred_uv0_slope = uv0_edge * slope;", "deferred_uv0_slope = 4.0 * uv0_edge * slope;", DEFERRED),
    PlantedError("orthographic rays of deferred surfaces do not move", _DEFERRED_GLSL,
                 "slope[k] += vec2(dot(moved, dxe), dot(d, cross(moved, edge[0])));", "", DEFERRED),
    PlantedError("second texture coordinates from the first vertex's", _DEFERRED_GLSL,
                 "v_uv1 = uv1 + uv1_edge * b;", "v_uv1 = uv1 + uv1_edge * b.yx;", DEFERRED),
    PlantedError("deferred triangles continued as far as they go", _DEFERRED_GLSL,
                 "max(vec3(1.0 - b.x - b.y, b), -1.0)", "vec3(1.0 - b.x - b.y, b)", DEFERRED),
    PlantedError("boxes of pixels without their margin", _BOXES, "pixels.max(axis=0) + 1, (x + width",
                 "pixels.max(axis=0), (x + width", DEFERRED),
    PlantedError("rows of pixels as wide as their lower edges", _BOXES, "np.maximum(reach[:-1], reach[1:])",
                 "reach[:-1]", DEFERRED),
    PlantedError("deferred triangles numbered from 0", _NUMBERS, "<< TRIANGLE_BITS | (count + 1)",
                 "<< TRIANGLE_BITS | count", DEFERRED),
    PlantedError("planes of deferred triangles where they were", _NUMBERS,
                 ", scene.instances[draw.instance].transform.tobytes())", ", b\"\")", DEFERRED),
    PlantedError("deferred surfaces without vertex colours", "viewer/plan/deferral.py", '("HAS_COLOR", "INDIRECT"',
                 '("INDIRECT"', DEFERRED),

    # the mixture of paths with a picture of the raster
    PlantedError("halves are measured by themselves", _COMBINE, "share * first * (truth[1] - base[0])",
                 "share * first * (truth[0] - base[0])", MIXTURE),
    PlantedError("steps are measured with their noise", _COMBINE, "np.maximum(size - noise, 1e-12)",
                 "np.maximum(size, 1e-12)", MIXTURE),
    PlantedError("gains are not doubted", _COMBINE, "np.clip((gains - doubt) /", "np.clip(gains /", MIXTURE),
    PlantedError("the noise of both halves in common forgotten", _COMBINE,
                 "\n            + both * (first - second) * (base[0] - base[1]))", ")", MIXTURE),
    PlantedError("light comes back that one half alone has lost", _COMBINE, "np.where(first * second > 0,",
                 "np.where(first * second > -1e30,", MIXTURE),
    PlantedError("spikes are fitted", _COMBINE, "return np.minimum(picture, _most(picture))", "return picture",
                 MIXTURE),
    PlantedError("the raster's picture upside down", _FAST, "None if guide is None else guide[::-1]", "guide", MIXTURE),
    PlantedError("halves of different size swapped", _FAST, "share = parts[0].count", "share = parts[1].count",
                 MIXTURE),
    PlantedError("emission counts twice in the raster's picture", _FAST, "(light(clean, whole.emission),) * 2",
                 "(light(clean, 0 * whole.emission),) * 2", MIXTURE),
    PlantedError("emission left out after the mixture", _FAST, "picture + whole.emission)", "picture)", MIXTURE),
    PlantedError("light comes back where nothing is hit", _FAST, ", share, whole.hits > 0)", ", share)", MIXTURE),

    # adaptive samples
    PlantedError("the variance of n samples over n", _SHARES, " * (count / (count - 1))", "", ADAPTIVE),
    PlantedError("the deviation of the sum of channels", _SHARES, "+ dtype.type(EPSILON)) / 3",
                 "+ dtype.type(EPSILON))", ADAPTIVE),
    PlantedError("pixels decide by their own noise", _SHARES, "        beside[step:] += rows[:-step]\n",
                 "        beside[step:] += rows[:-step]\n        beside += values\n", ADAPTIVE),
    PlantedError("noise around is not relative", _SHARES, "/ np.sqrt(mean_around**2 + dtype.type(EPSILON))", "",
                 ADAPTIVE),
    PlantedError("pixels that nothing is known of get few samples", _SHARES, "relative, 2 * mean_of_all)",
                 "relative, 0 * mean_of_all)", ADAPTIVE),
    PlantedError("what is left of a step is lost", _SHARES, "np.floor(steps.cumsum() + 1e-3)",
                 "np.floor(steps).cumsum()", ADAPTIVE),
    PlantedError("samples on their way do not count", _SCHEDULE, "np.maximum(tiles[..., 1], 1) * arrived",
                 "np.maximum(tiles[..., 1], 1)", ADAPTIVE),
    PlantedError("a neighbour's noise counts in full", _SCHEDULE, "np.maximum(variance, around / 4)",
                 "np.maximum(variance, around)", ADAPTIVE),
    PlantedError("a tile's target by the square of its deviations", _SCHEDULE, "worst / square * mean / target**2",
                 "worst / mean / target**2", ADAPTIVE),
    PlantedError("pixels are done after the pilot", _SCHEDULE, "[:height, :width] * deviation, LEAST)",
                 "[:height, :width] * deviation, PILOT)", ADAPTIVE),
    PlantedError("rounds grow without bound", _SCHEDULE, "min(GROWTH * total, limit)", "limit", ADAPTIVE),
    # the map of the ground
    PlantedError("shadows on the ground end below the model", _GROUND, "np.maximum(shift, 0)", "0.0 * shift", GROUND),
    PlantedError("no margin for the filter of shadows on the ground", _GROUND, "margin = 0.02", "margin = 0.0", GROUND),
    PlantedError("the ground sees the tiles beside a light's own", _GROUND_LIGHT, "is_outside ? 0.0 : ", "", GROUND),
    PlantedError("the ground's map is turned", _GROUND_LIGHT, "vec3(from_map(s.x), from_map(s.y), 1.0)",
                 "vec3(from_map(s.y), from_map(s.x), 1.0)", GROUND),
    PlantedError("all lights of the ground have the same strength", "viewer/raster/ground.py",
                 "luminance / max(self._light, 1e-300)", "luminance * 0 + 1 / len(luminance)", GROUND),
    PlantedError("the ground's map of another environment", "viewer/raster/ground.py", "sky.rotation, ", "", GROUND),
]
