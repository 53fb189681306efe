"""shaders/trace/material.glsl, viewer/trace/scene/materials.py: factors, maps and vertex colours are multiplied."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from images import image_of, noise
from interactions import ask, bend, random_hits
from shapes import moved, plate, scene, sphere

from viewer.scene.color import srgb_to_linear
from viewer.scene.material import Material, Sampler, Texture, UVTransform
from viewer.scene.medium import VACUUM
from viewer.trace.scene.encode import geometry_switches, unused_maps
from viewer.trace.scene.geometry import trace_geometry
from viewer.trace.scene.materials import trace_material

COUNT = 500
FRONT = (0.36, 0.48, 0.8)
PIXELS = {name: noise(5, 3, 4, k) for k, name in enumerate(("base", "mr", "emissive", "specular", "tint", "through"))}
NEAREST = Sampler("clamp", "clamp", "nearest")


def texture(name: str, **options) -> Texture:
    return Texture(image_of(PIXELS[name], name), NEAREST, **options)


def texels(name: str, uv: np.ndarray, is_srgb: bool = False) -> np.ndarray:
    """(N, 4) linear values of the nearest texels."""
    pixels = PIXELS[name] / 255
    if is_srgb:
        pixels[..., :3] = srgb_to_linear(pixels[..., :3])
    column, row = np.clip(np.floor(uv * (5, 3)).astype(int), 0, (4, 2)).T
    return pixels[row, column]


def asked(context, tmp_path, material: Material, mesh=None, wo=FRONT, count: int = COUNT) -> dict[str, np.ndarray]:
    one = scene(mesh or plate(), materials=(material,))
    hits = random_hits(trace_geometry(one), count)
    hits.wo[:] = wo
    return ask(context, tmp_path, one, hits)


def close(found: np.ndarray, expected: np.ndarray) -> None:
    """Colours are linear halves where OpenGL is software."""
    np.testing.assert_allclose(found, np.broadcast_to(expected, found.shape), rtol=6e-4, atol=1e-6)


def test_all_maps_are_multiplied_out(context, tmp_path):
    material = Material(
        base_color=(0.9, 0.8, 0.7, 0.6), base_color_texture=texture("base"), metallic=0.8, perceptual_roughness=0.7,
        metallic_roughness_texture=texture("mr"), emissive=(1, 2, 30), emissive_texture=texture("emissive"), ior=1.4,
        specular=0.9, specular_texture=texture("specular"), specular_color=(0.5, 1, 1.5),
        specular_color_texture=texture("tint"), transmission=0.75, transmission_texture=texture("through"),
        alpha_mode="blend")
    colors = np.random.default_rng(1).uniform(0, 1, (4, 4)).astype(np.float32)
    found = asked(context, tmp_path, material, replace(plate(), colors=colors))
    uv, color = found["uv0"], found["color"]
    base = texels("base", uv, True) * material.base_color * color
    close(found["base_color"], base[:, :3])
    close(found["coverage"], base[:, 3])
    close(found["coverage_at"], base[:, 3])
    close(found["metallic"], 0.8 * texels("mr", uv)[:, 2])
    close(found["perceptual_roughness"], 0.7 * texels("mr", uv)[:, 1])
    close(found["emission"], texels("emissive", uv, True)[:, :3] * (1, 2, 30))
    close(found["emission_at"], found["emission"])
    close(found["ior"], 1.4)
    close(found["specular"], 0.9 * texels("specular", uv)[:, 3])
    close(found["specular_color"], texels("tint", uv, True)[:, :3] * (0.5, 1, 1.5))
    close(found["transmission"], 0.75 * texels("through", uv)[:, 0])
    assert not found["is_unlit"].any() and found["is_thin"].all() and not found["is_double_sided"].any()


def test_specular_and_glossiness_are_converted(context, tmp_path):
    """Appendix B of KHR_materials_pbrSpecularGlossiness, in float64; other materials of the scene stay as they are."""
    old = Material(base_color=(0.9, 0.8, 0.7, 1), base_color_texture=texture("base"), metallic=0.0,
                   perceptual_roughness=0.25, specular_color=(20.0, 5.0, 10.0),
                   specular_glossiness_texture=texture("specular"))
    new = Material(base_color=(0.9, 0.8, 0.7, 1), metallic=0.0, perceptual_roughness=0.25)
    one = scene((plate(0), moved((-3, 0, 0))), (plate(1), moved((3, 0, 0))), materials=(old, new))
    hits = random_hits(trace_geometry(one), COUNT)
    hits.wo[:] = FRONT
    found = ask(context, tmp_path, one, hits)
    here = hits.instance == 0
    uv = found["uv0"][here]
    texel = texels("specular", uv, True)
    f0 = np.array([0.8, 0.2, 0.4]) * texel[:, :3]
    close(found["specular_color"][here] * 0.04, f0)
    close(found["perceptual_roughness"][here], 1 - 0.75 * texel[:, 3])
    diffuse = texels("base", uv, True)[:, :3] * (0.9, 0.8, 0.7)
    np.testing.assert_allclose(found["base_color"][here], diffuse * (1 - f0.max(axis=1))[:, None], rtol=2e-3)
    close(found["base_color"][~here], (0.9, 0.8, 0.7))
    close(found["perceptual_roughness"][~here], 0.25)


def test_an_image_is_sampled_once_for_all_that_read_it(context, tmp_path):
    shared = texture("base")
    material = Material(base_color_texture=shared, emissive=(1, 1, 1), emissive_texture=shared, metallic=0.5,
                        specular_color_texture=texture("tint"), metallic_roughness_texture=texture("mr"))
    both = replace(material, specular_color_texture=None)
    assert len(trace_material(both, plate()).color_maps) == 1
    for each in (both, material):
        found = asked(context, tmp_path, each)
        for name in ("base_color", "emission", "emission_at"):
            close(found[name], texels("base", found["uv0"], True)[:, :3])
        assert not (found["specular_color"] == 1).all() or each is both


def test_materials_do_not_mix(context, tmp_path):
    materials = [Material(base_color=(k / 10, 1, 1, 1), base_color_texture=texture(name) if k % 2 else None,
                          metallic_roughness_texture=texture("mr") if k % 3 == 0 else None, emissive=(0, 0, k))
                 for k, name in enumerate(("base", "emissive", "tint", "through", "specular", "base"), 1)]
    one = scene(*((plate(k), moved((3 * k, 0, 0))) for k in range(6)), materials=materials)
    hits = random_hits(trace_geometry(one), COUNT)
    hits.wo[:] = FRONT
    found = ask(context, tmp_path, one, hits)
    for k, material in enumerate(materials):
        here = hits.instance == k
        uv = found["uv0"][here]
        name = ("base", "emissive", "tint", "through", "specular", "base")[k]
        expected = texels(name, uv, True)[:, 0] if material.base_color_texture else np.ones(len(uv))
        close(found["base_color"][here, 0], expected * (k + 1) / 10)
        close(found["metallic"][here], texels("mr", uv)[:, 2] if material.metallic_roughness_texture else 1)
        close(found["emission"][here, 2], k + 1)


@pytest.mark.parametrize("mode, cutoff", [("opaque", 0.5), ("mask", 0.5), ("mask", 0.2), ("blend", 0.5)])
def test_alpha(context, tmp_path, mode, cutoff):
    material = Material(base_color=(1, 1, 1, 0.9), base_color_texture=texture("base"), alpha_mode=mode,
                        alpha_cutoff=cutoff)
    found = asked(context, tmp_path, material)
    alpha = 0.9 * texels("base", found["uv0"])[:, 3]
    expected = {"opaque": np.ones(COUNT), "mask": (alpha >= cutoff).astype(float), "blend": alpha}[mode]
    close(found["coverage"], expected)
    close(found["coverage_at"], expected)


def test_emission_is_of_the_front_unless_double_sided(context, tmp_path):
    for double_sided in (False, True):
        material = Material(emissive=(1, 2, 3), double_sided=double_sided)
        back = asked(context, tmp_path, material, wo=(0.36, 0.48, -0.8))
        close(back["emission"], np.array([1, 2, 3]) * double_sided)
        assert (back["is_double_sided"] == double_sided).all() and not back["is_front"].any()
        close(asked(context, tmp_path, material)["emission"], (1, 2, 3))


def test_texture_transforms_and_the_second_uv_set(context, tmp_path):
    transform = UVTransform((0.1, 0.2), math.radians(30), (0.5, 0.7))
    second = np.random.default_rng(3).uniform(0, 1, (4, 2)).astype(np.float32)
    mesh = replace(plate(), uvs=(*plate().uvs, second))
    material = Material(base_color_texture=texture("base", uv_set=1), emissive=(1, 1, 1),
                        emissive_texture=texture("emissive", transform=transform))
    found = asked(context, tmp_path, material, mesh)
    matrix = transform.matrix()
    moved_uv = found["uv0"] @ matrix[:, :2].T + matrix[:, 2]

    def off_edges(uv):
        return np.abs(uv * (5, 3) - np.rint(uv * (5, 3))).min(axis=1) > 1e-4

    sure = off_edges(moved_uv) & off_edges(found["uv1"])
    assert sure.mean() > 0.9
    close(found["base_color"][sure], texels("base", found["uv1"], True)[sure, :3])
    close(found["emission"][sure], texels("emissive", moved_uv, True)[sure, :3])


def test_a_map_whose_uv_set_a_mesh_lacks_is_not_there_for_it(context, tmp_path):
    bare = replace(plate(), uvs=())
    one = scene((plate(), np.eye(4)), (bare, moved((3, 0, 0))),
                materials=(Material(base_color_texture=texture("base")),))
    hits = random_hits(trace_geometry(one), COUNT)
    found = ask(context, tmp_path, one, hits)
    close(found["base_color"][hits.instance == 1], 1)
    first = hits.instance == 0
    close(found["base_color"][first], texels("base", found["uv0"], True)[first, :3])


@pytest.mark.parametrize("hand", [1, -1])
def test_normal_maps(context, tmp_path, hand):
    pixels = noise(5, 3, 3, 9) // 2 + 64
    pixels[..., 2] |= 0xC0
    PIXELS["normal"] = np.concatenate([pixels, np.full((3, 5, 1), 255, np.uint8)], axis=2)
    mesh = plate()
    tangents = np.float32([[0, 1, 0, -1]] * 4)
    material = Material(normal_texture=texture("normal"), normal_scale=0.6)
    placed = scene((replace(mesh, tangents=tangents), np.diag([hand, 1, 1, 1.0])), materials=(material,))
    hits = random_hits(trace_geometry(placed), COUNT)
    hits.wo[:] = FRONT
    found = ask(context, tmp_path, placed, hits)
    assert found["is_front"].all()
    texel = texels("normal", found["uv0"])[:, :3] * (255 / 127.5) - 1
    texel[:, :2] *= 0.6
    # bitangent = w cross(n, t) = -cross(+z, +y) = +x, which is mirrored with the mesh
    expected = texel[:, :1] * (0, 1, 0) + texel[:, 1:2] * (hand, 0, 0) + texel[:, 2:] * (0, 0, 1)
    expected /= np.linalg.norm(expected, axis=1, keepdims=True)
    expected = bend(expected, np.broadcast_to([0.0, 0.0, 1.0], expected.shape), hits.wo.astype(np.float64))
    np.testing.assert_allclose(found["n"], expected, atol=1e-5)
    along = expected * -expected[:, 1:2] + (0, 1, 0)
    np.testing.assert_allclose(found["t"], along / np.linalg.norm(along, axis=1, keepdims=True), atol=1e-5)


def test_only_volumes_absorb():
    glass = Material(transmission=1.0, metallic=0.0, thickness=1.0, attenuation_distance=2.0,
                     attenuation_color=(0.5, 0.0, 1.0))
    ball = sphere(segments=8)
    medium = trace_material(glass, ball).medium
    np.testing.assert_allclose(medium.sigma_t, [-math.log(0.5) / 2, -math.log(1e-6) / 2, 0])
    assert medium.sigma_a == medium.sigma_t and not medium.scatters
    thin = trace_material(replace(glass, thickness=0.0), ball)
    assert thin.is_thin and thin.medium == VACUUM
    assert trace_material(replace(glass, attenuation_distance=math.inf), ball).medium == VACUUM
    assert trace_material(replace(glass, transmission=0.0), ball).medium == VACUUM


def test_instances_filled_with_the_same_share_a_medium():
    glass = Material(transmission=1.0, metallic=0.0, thickness=1.0, attenuation_distance=2.0,
                     attenuation_color=(0.5, 0.25, 1.0))
    materials = [glass, Material(), replace(glass, perceptual_roughness=0.3),
                 replace(glass, attenuation_color=(0.1, 1, 1))]
    meshes = [(replace(sphere(segments=8), material=k), np.eye(4)) for k in range(4)]
    geometry = trace_geometry(scene(*meshes, materials=materials))
    assert [instance.medium for instance in geometry.instances] == [1, 0, 1, 2]
    assert geometry.media[0] == VACUUM and len(geometry.media) == 3


def test_absorption_reaches_the_shader_by_tracer_units(context, tmp_path):
    glass = Material(transmission=1.0, metallic=0.0, thickness=0.1, attenuation_distance=2.0,
                     attenuation_color=(0.5, 0.25, 1.0))
    found = asked(context, tmp_path, glass)  # a plate of half side 1: radius sqrt(2)
    close(found["transmittance"], np.array([0.5, 0.25, 1.0]) ** (math.sqrt(2) / 2))
    assert (found["medium"] == 1).all()
    close(found["transmission"], 1)
    assert not found["is_thin"].any()


METAL = Material(metallic=1.0)


@pytest.mark.parametrize("material, name, number", [
    (Material(emissive_texture=texture("base")), "color_maps", 0),  # the factor is 0
    (Material(emissive=(1, 0, 0), emissive_texture=texture("base")), "color_maps", 1),
    (replace(METAL, specular_texture=texture("base")), "data_maps", 0),  # metals have no such parameter
    (replace(METAL, metallic=0.5, specular_texture=texture("base")), "data_maps", 1),
    (replace(METAL, transmission=1.0, transmission_texture=texture("base")), "data_maps", 0),
    (Material(metallic=0.0, transmission_texture=texture("base")), "data_maps", 0),
    (Material(metallic=0.0, perceptual_roughness=0.0, metallic_roughness_texture=texture("mr")), "data_maps", 0),
    (Material(unlit=True, metallic_roughness_texture=texture("mr")), "data_maps", 0),
    (Material(occlusion_texture=texture("base")), "data_textures", 0),
    (Material(normal_texture=texture("base"), normal_scale=0.0), "data_textures", 0),
    (Material(normal_texture=texture("base")), "data_textures", 1),
])
def test_maps_that_make_no_difference_are_not_read(material, name, number):
    assert len(getattr(trace_material(material, plate()), name)) == number


def test_switches_say_what_is_there():
    def switches(material: Material, mesh=None) -> set[str]:
        one = scene(mesh or plate(), materials=(material,))
        found = geometry_switches(one, trace_geometry(one))
        return {name for name, on in found.items() if on} - {"METALNESS"}

    assert switches(Material()) == set()
    assert switches(Material(base_color_texture=texture("base"))) == {"HAS_TEXTURES", "HAS_COLOR_MAPS"}
    assert switches(Material(normal_texture=texture("base"))) == {
        "HAS_TEXTURES", "HAS_DATA_MAPS", "HAS_NORMAL_MAP", "HAS_TANGENT"}
    assert switches(Material(normal_texture=texture("base")), replace(plate(), tangents=None)) == set()
    assert switches(Material(emissive=(0, 0, 1), unlit=True)) == {"HAS_EMISSION", "HAS_UNLIT"}
    assert switches(Material(alpha_mode="blend", base_color=(1, 1, 1, 0.5))) == {"HAS_SEE_THROUGH"}
    assert switches(Material(metallic=0.5, specular_color=(1, 0, 0))) == {"SPECULAR_TINTED"}
    assert switches(Material(specular_color=(1, 0, 0))) == set()  # metal has no such reflection
    assert switches(Material(), replace(plate(), colors=np.ones((4, 4), np.float32))) == {"HAS_COLOR"}
    uvs = plate().uvs * 2
    moved_map = texture("base", uv_set=1, transform=UVTransform((0.5, 0)))
    assert switches(Material(base_color_texture=moved_map), replace(plate(), uvs=uvs)) == {
        "HAS_TEXTURES", "HAS_COLOR_MAPS", "HAS_UV1", "HAS_UV_TRANSFORM"}
    glass = switches(Material(metallic=0.0, transmission=1.0, thickness=1.0, attenuation_distance=1.0,
                              attenuation_color=(0.5, 1, 1)))
    assert {"HAS_TRANSMISSION", "HAS_VOLUME"} <= glass


def test_maps_left_out_are_counted():
    one = scene(plate(), materials=(Material(base_color_texture=texture("base"), occlusion_texture=texture("mr")),))
    assert unused_maps(one, trace_geometry(one)) == ["1 material map, not decoded: no path depends on it"]
