"""Proves the golden images: breaks the shaders, one term at a time, and lists which images notice.

    python tests/golden/break_shaders.py [NAME...]

Every mutation is planted in a temporary copy of the shaders and all cases are drawn with it and judged with the limits
of the tests. Exits with status 1 where one goes unnoticed. Takes minutes: no part of the test run.
"""

from __future__ import annotations

import sys
from pathlib import Path

from cases import CASES, SIZE

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from mutations import Mutation, try_all

from viewer.gpu.context import open_context
from viewer.measure.compare.golden import Limits, judge
from viewer.raster.renderer import Renderer

MUTATIONS = [
    Mutation("D without 1/pi", "bsdf/ggx.glsl", "return k * k * INV_PI;", "return k * k;"),
    Mutation("D with alpha for alpha squared", "bsdf/ggx.glsl", "s2 + alpha * alpha * NoH", "s2 + alpha * NoH"),
    Mutation("G separable", "bsdf/ggx.glsl", "return 0.5 / (NoL * t_v + NoV * t_l);",
             "return 1.0 / ((NoV + t_v) * (NoL + t_l));"),
    Mutation("separable G as if correlated", "bsdf/ggx.glsl", "return 1.0 / ((NoV + t_v) * (NoL + t_l));",
             "return 0.5 / (NoL * t_v + NoV * t_l);"),
    Mutation("Beckmann's D without 1/pi", "bsdf/pixel_lobe.glsl", "/ det) / width;", "/ det) / (INV_PI * width);"),
    Mutation("Beckmann's G without shadowing", "bsdf/beckmann.glsl",
             "(1.0 + lambda_beckmann(NoV, alpha) + lambda_beckmann(NoL, alpha))",
             "(1.0 + lambda_beckmann(NoV, alpha))"),
    Mutation("Blinn-Phong's D with (s + 8) / 8", "bsdf/blinn_phong.glsl", "(s + 2.0) * 0.5", "(s + 8.0) * 0.125"),
    Mutation("V-cavity without its factor of 2", "bsdf/v_cavity.glsl",
             "2.0 * NoH * min(NoV, NoL)", "NoH * min(NoV, NoL)"),
    Mutation("F with exponent 4", "bsdf/fresnel.glsl", "return x2 * x2 * x;", "return x2 * x2;"),
    Mutation("F without the difference of indices", "bsdf/fresnel.glsl",
             "float r_s = delta / (sum_s * sum_s);", "float r_s = 1.0 / (sum_s * sum_s);"),
    Mutation("sRGB as pow 1/2.2", "display/srgb.glsl",
             "return mix(high, low, lessThanEqual(c, vec3(0.0031308)));",
             "return pow(c, vec3(1.0 / 2.2));"),
    Mutation("sRGB left out", "display/srgb.glsl", "return mix(high, low, lessThanEqual(c, vec3(0.0031308)));",
             "return c;"),
    Mutation("ACES without its pre-exposure", "display/tonemap.glsl", "min(c, 1e6) / 0.6", "min(c, 1e6)"),
    Mutation("AgX encoded once more", "display/tonemap.glsl", "return pow(clamp(outset * c, 0.0, 1.0), vec3(2.2));",
             "return clamp(outset * c, 0.0, 1.0);"),
    Mutation("neutral without desaturation", "display/tonemap.glsl", "desaturation = 0.15", "desaturation = 0.0"),
    Mutation("normal map's green flipped", "raster/normal.glsl", "texel.y * axes[1]", "-texel.y * axes[1]"),
    Mutation("normal map's red flipped", "raster/normal.glsl", "texel.x * axes[0]", "-texel.x * axes[0]"),
    Mutation("back faces keep their normal", "raster/normal.glsl",
             "if (!IS_FRONT) n = -n;", "if (!gl_FrontFacing) n = n;"),
    Mutation("environment mirrored", "light/equirect.glsl", "vec2(0.5 + turns(d.z, d.x)", "vec2(0.5 - turns(d.z, d.x)"),
    Mutation("environment upside down", "light/equirect.glsl", "return y < 0.0 ? 1.0 - c : c;",
             "return y < 0.0 ? c : 1.0 - c;"),
    Mutation("environment's rotation reversed", "light/environment_rotation.glsl",
             "s = u_environment_rotation.y;", "s = -u_environment_rotation.y;"),
    Mutation("reflection at the wrong roughness", "raster/shade_environment.glsl",
             "vec3 d = reflected_direction(p, n, lookup.x);",
             "vec3 d = reflected_direction(p, n, lookup.x); lookup.y *= 0.5;"),
    Mutation("alpha cutoff ignored", "raster/alpha_mask.glsl", "return min(count, samples) / samples;",
             "return 1.0;"),
    Mutation("alpha not premultiplied", "raster/material.glsl",
             "o_color = vec4(radiance * covered, covered);", "o_color = vec4(radiance, covered);"),
    Mutation("vertex colours ignored", "material/uniforms.glsl", "m.base_color *= v_color;", ""),
    Mutation("emission left out", "raster/pbr.frag", "radiance += m.emissive;", ""),
    Mutation("shadow bias reversed", "light/shadow.glsl", "vec4(p + offset, 1.0)", "vec4(p - offset, 1.0)"),
    Mutation("no shadow", "light/shadow.glsl", "return smoothed_shadow(tile.texel.zw + texel, c.z);", "return 1.0;"),
    Mutation("cube faces swapped", "light/shadow.glsl", "return d.y > 0.0 ? 2 : 3;", "return d.y > 0.0 ? 3 : 2;"),
    Mutation("nothing hides the environment", "raster/arriving_light.glsl", "around *= visible.rgb;", ""),
    Mutation("lights fall off with 1/d", "light/attenuation.glsl", "/ max(d2, least);", "/ sqrt(max(d2, least));"),
    Mutation("spot's cone not squared", "light/attenuation.glsl", "return a * a;", "return a;"),
    Mutation("range ignored", "light/attenuation.glsl", "clamp(1.0 - x * x, 0.0, 1.0)", "1.0"),
    Mutation("occlusion ignored (PBR)", "raster/arriving_light.glsl", "around *= occlusion;",
             "around *= 1.0;"),
    Mutation("occlusion ignored (Phong)", "raster/phong.frag", "(INV_PI * occlusion)", "INV_PI"),
    Mutation("1 - E forgotten on the light's side", "bsdf/layer/interface.glsl",
             "face.scaled_transmittance * interface_transmittance(face, dfg_light)", "face.scaled_transmittance"),
    Mutation("1 - E not over its mean", "bsdf/layer/interface.glsl",
             " / max(interface_transmittance(face, mean), 1e-4)", ""),
    Mutation("1 - E forgotten under the environment", "bsdf/surface.glsl",
             "interface_entering(v.dielectric, v.dfg) * (mean_light", "(mean_light"),
    Mutation("multiple scattering mixed before metalness", "bsdf/surface_view.glsl",
             "v.metal = make_interface(s.base_color,",
             "v.dielectric = v.metal = make_interface(mix(s.f0, s.base_color, s.metallic),"),
    Mutation("multiple scattering left out under the environment", "bsdf/layer/interface.glsl",
             "vec3 multiple = face.F_ms * energy_loss(dfg);", "vec3 multiple = vec3(0.0);"),
    Mutation("multiple scattering left out under lights", "bsdf/multiscatter.glsl",
             "return F_mean * F_mean *", "return 0.0 * F_mean * F_mean *"),
    Mutation("Lambert without 1/pi", "bsdf/lambert.glsl", "return albedo * INV_PI;", "return albedo;"),
    Mutation("Phong's exponent off by a factor of 4", "raster/phong.frag",
             "max(2.0 / (alpha * alpha) - 2.0, 0.0)", "max(0.5 / (alpha * alpha) - 2.0, 0.0)"),
    Mutation("normals not turned with the mesh", "raster/surface_vertex.glsl", "normal_matrix() * a_normal",
             "a_normal"),
    Mutation("glass does not refract", "raster/transmission.glsl", "exit += m.thickness * d;", "exit += 0.0 * d;"),
    Mutation("glass has no colour", "raster/through_surface.glsl",
             "return throughput * entering_tint(m.base_color.rgb) *", "return throughput *"),
    Mutation("glass absorbs nothing", "raster/transmission.glsl", "transmittance = exp(-u_absorption * m.thickness);",
             "transmittance = vec3(1.0);"),
    Mutation("rough glass is clear", "raster/backdrop.glsl", ".x)) * blur;", ".x)) * 0.0;"),
    Mutation("black behind glass where nothing is drawn", "raster/transmission.glsl",
             "behind.rgb += (1.0 - behind.a) *", "behind.rgb += 0.0 *"),
    Mutation("traced glass has no critical angle", "raster/refraction_step.frag", "R = f_dielectric(mu, eta)",
             "R = f_dielectric(mu, s.ior)"),
    Mutation("traced glass absorbs nothing", "raster/refraction_step.frag",
             "throughput *= exp(-s.absorption * s.distance)", "throughput *= 1.0"),
    Mutation("traced glass hides what is opaque", "raster/refraction_step.frag", "throughput * seen.rgb *",
             "0.0 * seen.rgb *"),
    Mutation("transmission scatters, too", "raster/through_surface.glsl",
             "s.base_color *= 1.0 - m.transmission;", "s.base_color *= 1.0;"),
    Mutation("stretched across the tangent", "bsdf/facets.glsl", "return vec2(s.alpha_t, s.alpha);",
             "return vec2(s.alpha, s.alpha_t);"),
    Mutation("anisotropy turned the other way", "bsdf/anisotropy.glsl", "s * d.x + c * d.y", "-s * d.x + c * d.y"),
    Mutation("anisotropy's strength not squared", "bsdf/anisotropy.glsl",
             "m.anisotropy_strength * m.anisotropy_strength", "m.anisotropy_strength"),
    Mutation("mirrored bitangent for anisotropy", "raster/normal.glsl",
             "vec3 b = cross(front_normal(), t) * v_tangent.w;", "vec3 b = cross(front_normal(), t);"),
    Mutation("the stretched lobe is one narrow lobe", "raster/stretched_light.glsl",
             "float a = sqrt(max(alpha.x * alpha.x - alpha_narrow * alpha_narrow, 0.0));", "float a = 0.0;"),
    Mutation("diffuse not scaled by 1 - max(f0)", "bsdf/specular_glossiness.glsl", "m.base_color.rgb *= 1.0 - max",
             "m.base_color.rgb *= 1.0 - 0.0 * max"),
    Mutation("glossiness for roughness", "bsdf/specular_glossiness.glsl",
             "1.0 - (1.0 - m.perceptual_roughness) * texel.a", "(1.0 - m.perceptual_roughness) * texel.a"),
    Mutation("rough diffuse light not sent back", "bsdf/eon.glsl", "s > 0.0 ? s / max(NoL, NoV) : s", "min(s, 0.0)"),
    Mutation("rough diffuse without multiple scattering", "bsdf/eon.glsl",
             "f += eon_multiple_albedo(rho, sigma) *", "f += 0.0 *"),
    Mutation("rough diffuse lit along the normal", "raster/shade_environment.glsl",
             "environment_irradiance_over_pi(diffuse_axis(s, p.n, p.v, p.NoV))", "environment_irradiance_over_pi(p.n)"),
    Mutation("film's thickness from the channel of its weight", "bsdf/iridescence_thickness.glsl",
             "iridescence_thickness_maximum, texel.g", "iridescence_thickness_maximum, texel.r"),
    Mutation("film's thickness with its ends swapped", "bsdf/iridescence_thickness.glsl",
             "iridescence_thickness_maximum, texel.g", "iridescence_thickness_maximum, 1.0 - texel.g"),
    Mutation("film's map of thickness ignored", "bsdf/iridescence_thickness.glsl",
             "iridescence_thickness_maximum, texel.g", "iridescence_thickness_maximum, 1.0"),
    Mutation("film as thick as it is for light from above", "bsdf/film.glsl",
             "film_spectrum(2e-3 * film.thickness * g,", "film_spectrum(2e-3 * film.thickness * film.ior,"),
    Mutation("thin glass with a film reflects at one face", "bsdf/film.glsl",
             "R * (1.0 + film.walls) / (1.0 + film.walls * R)", "R"),
    Mutation("sheen takes nothing from the cloth", "bsdf/layer/sheen.glsl", "return sheen + s.throughput * below;",
             "return sheen + below;"),
    Mutation("sheen without masking", "bsdf/charlie.glsl",
             "(1.0 + charlie_lambda(NoV, a) + charlie_lambda(NoL, a))", "1.0"),
    Mutation("sheen's sine without its power", "bsdf/charlie.glsl", "pow(max(s2, 1e-30), 0.5 / a)", "s2"),
    Mutation("sheen reflects no environment", "raster/shade_environment.glsl", "s.albedo * around",
             "vec3(0.0)"),
    Mutation("coat takes nothing from what lies below", "bsdf/layer/coat.glsl", "coat + c.throughput * below",
             "coat + below"),
    Mutation("coat takes nothing from emission", "raster/pbr.frag", "radiance *= view.coat.throughput;", ""),
    Mutation("coat follows the bumps below", "raster/seen_surface.glsl",
             "vec3 n_coat = coat_normal(p.n_geometric);", "vec3 n_coat = p.n;"),
    Mutation("coat without bumps of its own", "raster/normal.glsl",
             "return mapped_normal(clearcoat_normal_texel().xyz, u_clearcoat_normal_scale);", "return n;"),
    Mutation("coat as rough as what lies below", "bsdf/surface_of.glsl",
             "m.clearcoat_roughness * m.clearcoat_roughness", "alphas.y"),
    Mutation("coat reflects no environment", "bsdf/layer/coat.glsl", "return single * float(SHOW_SPECULAR) +",
             "return 0.0 * single +"),
    Mutation("coat reflects no light", "raster/shade_light.glsl", "* irradiance * coat_NoL;", "* 0.0;"),
    Mutation("highlights are no means over their pixels", "bsdf/pixel_lobe.glsl", "float a2 = alpha.y * alpha.y,",
             "x = y = vec3(0.0); float a2 = alpha.y * alpha.y,"),
    Mutation("one index for all colours", "raster/transmission.glsl", "vec3 ior = ior_of_bands(m.ior, m.dispersion);",
             "vec3 ior = vec3(m.ior);"),
    Mutation("traced paths leave with one index for all colours", "raster/refraction_step.frag",
             "glass.w = ior_of_bands(", "ior_of_bands("),
    Mutation("no light from behind", "raster/shade_light.glsl",
             "radiance += (1.0 - p.returned) *", "radiance += 0.0 *"),
    Mutation("environment not seen through", "raster/shade_environment.glsl",
             "radiance += surface_transmitted(s, view) * through;", ""),
    Mutation("what light passes through tinted by the base colour", "bsdf/layer/diffuse.glsl",
             "return s.diffuse_transmission * s.diffuse_transmission_color *",
             "return s.diffuse_transmission * s.base_color *"),
    Mutation("reflected as if nothing passed through", "bsdf/layer/diffuse.glsl",
             "return (1.0 - s.diffuse_transmission) * float(SHOW_DIFFUSE);", "return float(SHOW_DIFFUSE);"),
    Mutation("wax absorbs nothing", "raster/pbr.frag", "crossed_solid(s, exp(-u_absorption * m.thickness), p.returned)",
             "crossed_solid(s, vec3(1.0), p.returned)"),
    Mutation("wax shadows itself", "raster/shade_light.glsl", "v_position - p.behind * p.n_geometric", "v_position"),
    Mutation("highlights of hair lean the other way", "bsdf/fibre/fibre.glsl",
             "vec2 t1 = vec2(cos(f.tilt), sin(f.tilt));", "vec2 t1 = vec2(cos(f.tilt), -sin(f.tilt));"),
    Mutation("hair too smooth", "bsdf/fibre/fibre.glsl", "return max(root * root, MIN_FIBRE_VARIANCE);",
             "return max(0.25 * root * root, MIN_FIBRE_VARIANCE);"),
    Mutation("fibres of a yarn do not shadow each other", "raster/yarn.frag", "float seen = exp(-depth) * past;",
             "float seen = past;"),
    Mutation("yarns twisted the other way", "raster/yarn_points.glsl", "float angle = normal.w +",
             "float angle = -normal.w +"),
    Mutation("hair lets no light through", "raster/light_through_fibres.glsl",
             "ThroughFibres(share / one_minus_exp(depth)", "ThroughFibres(vec3(0.0)"),
    Mutation("light between hairs from all inclinations alike", "raster/curve_light.glsl",
             "gathered[p] = max(1.0 + dot(inclined, vec4(3.0, 5.0, 7.0, 9.0) * legendre * widened), 0.0);",
             "gathered[p] = 1.0;"),
    Mutation("highlight of hair on the wrong cone (Phong)", "bsdf/kajiya_kay.glsl",
             "theta_i.x * theta_o.x - theta_i.y * theta_o.y", "theta_i.x * theta_o.x + theta_i.y * theta_o.y"),
    Mutation("media scatter light back that goes on", "raster/in_scattered.glsl",
             "any_phase(medium.of_lights.a, -l, -ray.direction)", "any_phase(medium.of_lights.a, -l, ray.direction)"),
    Mutation("media keep nothing of a light from what lies in them", "raster/lit_media.glsl", "return exp(-depth);",
             "return 1.0;"),
    Mutation("no shafts of shadow in media", "raster/light_in_media.glsl", "* unshadowed_by_meshes(i, p);", ";"),
    Mutation("media hide nothing that lies behind them", "raster/in_media.glsl",
             "return radiance * haze.transmittance + haze.light;", "return radiance + haze.light;"),
    Mutation("media do not dim what is scattered in them", "raster/media_march.frag",
             "exp(-path.depth) * one_minus_exp(depth)", "one_minus_exp(depth)"),
    Mutation("media scatter light only once", "raster/in_scattered.glsl", "vec3 sum = around.scattered;",
             "vec3 sum = vec3(0.0);"),
    Mutation("light in solids spreads twice as far", "raster/spread_subsurface.frag",
             "vec3 s = texelFetch(u_profiles, pixel, 0).rgb;", "vec3 s = 0.5 * texelFetch(u_profiles, pixel, 0).rgb;"),
    Mutation("light in solids does not spread", "raster/spread_subsurface.frag", "o_light = vec4(sum / weights, 1.0);",
             "o_light = vec4(texelFetch(u_gathered, pixel, 0).rgb, 1.0);"),
    Mutation("light in solids spreads to other ones", "raster/spread_subsurface.frag",
             "if (there.w != here.w) continue;", ""),
    Mutation("solids let no light through", "raster/interior.glsl", "other = 0.5 * (even - odd);",
             "other = vec3(0.0);"),
    Mutation("yarns of a weave do not hide light from each other", "bsdf/weave/woven_view.glsl",
             "return lean > slope * m.horizon ? 0.0 : clamp(1.0 + lean, 0.0, 1.0);", "return 1.0;"),
    Mutation("yarns of a weave are straight", "bsdf/weave/weave.glsl", "float bend = -along * shape.z;",
             "float bend = 0.0;"),
    Mutation("warp and weft exchanged", "bsdf/weave/weave.glsl", "& 1) == 1) == is_front;", "& 1) == 1) != is_front;"),
    Mutation("woven fibres let no light through to others", "bsdf/weave/woven_view.glsl",
             "is_through ? abs(lambda_o - lambda_i) : max(lambda_o, lambda_i)", "abs(lambda_o - lambda_i)"),
    Mutation("exposure ignored", "display/display.frag", "? u_exposure / alpha", "? 1.0 / alpha"),
]


def caught_by(renderer: Renderer) -> list[str]:
    """The golden images that the renderer's pictures do not match."""
    caught = []
    for case in CASES:
        scene, camera = case.load()
        for mode in ("pbr", "phong"):
            name = f"{case.name}-{mode}"
            picture = renderer.display(scene, camera, case.with_mode(mode), SIZE)
            if judge(picture, Path(__file__).parent / "golden" / f"{name}.png", Limits(), name) is not None:
                caught.append(name)
    return caught


def main(names: list[str]) -> int:
    with open_context() as context:
        renderer = Renderer(context)
        unbroken = caught_by(renderer)
        renderer.release()
        if unbroken:
            print(f"without any mutation these differ already: {', '.join(unbroken)}", file=sys.stderr)
            return 1

        def noticed_by(_: Mutation) -> list[str]:
            renderer = Renderer(context)
            try:
                return caught_by(renderer)
            finally:
                renderer.release()

        return try_all(MUTATIONS, names, noticed_by)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
