import math
from dataclasses import replace

import numpy as np
import pytest
from gltf_builder import GltfBuilder, png_bytes
from images import image_of

from viewer.errors import InputError
from viewer.material.fold import without_constant_maps
from viewer.scene.material import Material, Sampler, Texture, UVTransform


def read(material: dict, builder: GltfBuilder | None = None, **top_level):
    builder = builder or GltfBuilder()
    builder.json.update(top_level)
    builder.node(mesh=builder.triangle(material=builder.add("materials", material)))
    scene = builder.load()
    return scene.materials[scene.meshes[0].material], scene.warnings


def test_defaults():
    assert read({})[0] == Material()
    builder = GltfBuilder()
    builder.node(mesh=builder.triangle())
    assert builder.load().materials == (Material(),)


def test_factors_and_extensions():
    material, warnings = read({
        "name": "m", "emissiveFactor": [1, 0.5, 0], "alphaMode": "MASK", "alphaCutoff": 0.3, "doubleSided": True,
        "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.6,
                                 "roughnessFactor": 0.7},
        "extensions": {"KHR_materials_unlit": {}, "KHR_materials_emissive_strength": {"emissiveStrength": 4},
                       "KHR_materials_ior": {"ior": 1.8},
                       "KHR_materials_specular": {"specularFactor": 0.9, "specularColorFactor": [2, 1, 0]}}})
    assert material == Material("m", (0.1, 0.2, 0.3, 0.4), metallic=0.6, perceptual_roughness=0.7, emissive=(4, 2, 0),
                                ior=1.8, specular=0.9, specular_color=(2, 1, 0), alpha_mode="mask", alpha_cutoff=0.3,
                                double_sided=True, unlit=True)
    assert not warnings


def test_emission_beyond_float32_is_clamped():
    material, warnings = read({"emissiveFactor": [1, 0.5, 0], "extensions": {
        "KHR_materials_emissive_strength": {"emissiveStrength": 1e200}}})
    assert material.emissive == (1e30, 5e29, 0)
    assert len(warnings) == 1 and "emissiveStrength" in warnings[0] and "1e+200" in warnings[0]


def test_transmission_and_volume():
    builder = GltfBuilder()
    a, b = builder.texture(), builder.texture()
    material, warnings = read({"extensions": {
        "KHR_materials_transmission": {"transmissionFactor": 0.9, "transmissionTexture": {"index": a, "texCoord": 1}},
        "KHR_materials_volume": {"thicknessFactor": 2.5, "thicknessTexture": {"index": b}, "attenuationDistance": 0.25,
                                 "attenuationColor": [0.1, 0.5, 1]}}}, builder)
    assert (material.transmission, material.transmission_texture.uv_set) == (0.9, 1)
    assert (material.thickness, material.thickness_texture.uv_set) == (2.5, 0)
    assert (material.attenuation_distance, material.attenuation_color) == (0.25, (0.1, 0.5, 1))
    assert warnings == (
        "meshes[0].primitives[0].attributes: the material needs TEXCOORD_1, which is missing; 0, 0 is used",)
    assert read({"extensions": {"KHR_materials_transmission": {}, "KHR_materials_volume": {}}})[0] == Material()


def test_specular_glossiness():
    """It replaces metallic-roughness. Without its map it is a dielectric of that model; with it shaders convert."""
    fields = {"diffuseFactor": [0.5, 0.4, 0.3, 0.2], "specularFactor": [0.2, 0.5, 0.1], "glossinessFactor": 0.7}
    other = {"baseColorFactor": [1, 0, 1, 1], "metallicFactor": 1, "roughnessFactor": 0.9}
    material, warnings = read({"pbrMetallicRoughness": other,
                               "extensions": {"KHR_materials_pbrSpecularGlossiness": fields}})
    assert not warnings and material.metallic == 0
    np.testing.assert_allclose(material.base_color, (0.25, 0.2, 0.15, 0.2))
    np.testing.assert_allclose(material.perceptual_roughness, 0.3)
    np.testing.assert_allclose(np.multiply(0.04, material.specular_color), fields["specularFactor"])
    builder = GltfBuilder()
    textures = {name: {"index": builder.texture()} for name in ("diffuseTexture", "specularGlossinessTexture")}
    material, _ = read({"extensions": {"KHR_materials_pbrSpecularGlossiness": fields | textures}}, builder)
    assert material.base_color_texture is not None and material.specular_glossiness_texture is not None
    np.testing.assert_allclose(material.base_color, fields["diffuseFactor"])
    folded = without_constant_maps(material)
    np.testing.assert_allclose(folded.base_color, (0.25, 0.2, 0.15, 0.2))
    assert folded.specular_glossiness_texture is None
    plain = read({"extensions": {"KHR_materials_pbrSpecularGlossiness": {}}})[0]
    assert plain.base_color == (0, 0, 0, 1) and plain.perceptual_roughness == 0
    np.testing.assert_allclose(np.multiply(0.04, plain.specular_color), 1)


@pytest.mark.parametrize("fields, problem", [
    ({"diffuseFactor": [1, 1, 1]}, "diffuseFactor: must have 4 numbers"),
    ({"specularFactor": "1"}, "specularFactor"), ({"glossinessFactor": None}, "glossinessFactor: must be a number"),
    ({"specularGlossinessTexture": {"index": 3}}, "specularGlossinessTexture.index")])
def test_broken_specular_glossiness_is_one_line(fields, problem):
    with pytest.raises(InputError) as caught:
        read({"extensions": {"KHR_materials_pbrSpecularGlossiness": fields}})
    assert problem in str(caught.value) and "\n" not in str(caught.value)


def test_dispersion():
    assert read({"extensions": {"KHR_materials_dispersion": {"dispersion": 2.04}}})[0].dispersion == 2.04
    material, warnings = read({"extensions": {"KHR_materials_dispersion": {"dispersion": -1}}})
    assert material.dispersion == 0 and "dispersion: -1 is out of range" in warnings[0]


def test_diffuse_transmission():
    builder = GltfBuilder()
    fields = {"diffuseTransmissionFactor": 0.6, "diffuseTransmissionTexture": {"index": builder.texture()},
              "diffuseTransmissionColorFactor": [0.1, 0.2, 0.3],
              "diffuseTransmissionColorTexture": {"index": builder.texture()}}
    material, _ = read({"extensions": {"KHR_materials_diffuse_transmission": fields}}, builder)
    assert (material.diffuse_transmission, material.diffuse_transmission_color) == (0.6, (0.1, 0.2, 0.3))
    assert material.diffuse_transmission_texture is not None
    assert material.diffuse_transmission_color_texture is not None
    assert read({"extensions": {"KHR_materials_diffuse_transmission": {}}}) == (Material(), ())


@pytest.mark.parametrize("name", ["multiscatterColorFactor", "multiscatterColor", "scatterAlbedo"])
def test_scattering_in_volumes_is_read_by_all_its_names(name):
    material, warnings = read({"extensions": {"KHR_materials_volume_scatter": {
        name: [0.1, 0.2, 0.3], "scatterAnisotropy": -0.5}}})
    assert (material.scatter_color, material.scatter_anisotropy) == ((0.1, 0.2, 0.3), -0.5)
    assert warnings == ()
    assert read({"extensions": {"KHR_materials_volume_scatter": {}}}) == (Material(), ())


def scatter(**more: object) -> dict:
    return {"KHR_materials_scatter": {"scatterStrengthFactor": 0.5, "multiscatterColorFactor": [0.2, 0.4, 0.8],
                                      "scatterAnisotropy": 0.5, **more},
            "KHR_materials_transmission": {"transmissionFactor": 1.0}}


def read_plastic(builder: GltfBuilder | None = None, **extensions: dict) -> tuple[Material, list[str]]:
    """A dielectric with these extensions, and the warnings beside those of missing texture coordinates."""
    material, warnings = read({"pbrMetallicRoughness": {"metallicFactor": 0.0}, "extensions": extensions}, builder)
    return material, [line for line in warnings if "TEXCOORD" not in line]


SOLID = {"KHR_materials_volume": {"thicknessFactor": 1.0, "attenuationDistance": 1.0,
                                  "attenuationColor": [0.5, 0.5, 0.5]}}


def test_scattering_of_a_solid_fills_it_with_a_medium():
    material, warnings = read_plastic(**scatter(), **SOLID)
    assert warnings == [] and not material.scatters_thinly and not material.transmits_diffusely
    # Kulla and Conty 2017, for a colour of 0.4
    s = 4.09712 + 4.20863 * 0.4 - (9.59217 + 41.6808 * 0.4 + 17.7126 * 0.16) ** 0.5
    assert material.medium.albedo[2] == pytest.approx((1 - s * s) / (1 - 0.5 * s * s), rel=1e-12)
    assert material.medium.g == 0.5 and material.medium.sigma_t == pytest.approx([math.log(2)] * 3)
    assert not material.without_medium_scattering.medium.scatters
    # Where no direction is preferred both extensions mean the same.
    fields = {"multiscatterColorFactor": [0.1, 0.5, 0.9], "scatterStrengthFactor": 1.0}
    glass = SOLID | {"KHR_materials_transmission": {"transmissionFactor": 1.0}}
    old, new = (read_plastic(**glass, **{f"KHR_materials_{name}": fields})[0] for name in ("volume_scatter", "scatter"))
    assert old.medium == new.medium and old.medium.scatters


def test_scattering_of_a_thin_wall():
    builder = GltfBuilder()
    maps = {name: {"index": builder.texture()} for name in ("scatterStrengthTexture", "multiscatterColorTexture")}
    material, warnings = read_plastic(builder, **scatter(**maps))
    assert warnings == [] and material.scatters_thinly and not material.medium.scatters
    assert (material.scatter_strength, material.multiscatter_color) == (0.5, (0.2, 0.4, 0.8))
    assert material.multiscatter_anisotropy == 0.5 and material.scatter_strength_texture is not None
    assert material.multiscatter_color_texture is not None and material.without_medium_scattering == material
    plain, warnings = read_plastic(**(scatter() | {"KHR_materials_scatter": {}}))
    assert warnings == [] and not plain.scatters_thinly  # the strength is 0 unless the file says more


@pytest.mark.parametrize("change, words", [
    ({"KHR_materials_transmission": {}}, "no effect without light that KHR_materials_transmission lets through"),
    ({"KHR_materials_unlit": {}}, "cannot be combined with KHR_materials_unlit"),
    ({"KHR_materials_pbrSpecularGlossiness": {}}, "cannot be combined with KHR_materials_pbrSpecularGlossiness"),
    ({"KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.5}},
     "takes the place of KHR_materials_diffuse_transmission"),
    ({"KHR_materials_volume": {"thicknessFactor": 1.0}}, "the maps of scattering are left out"),
])
def test_scattering_that_cannot_be_shown_is_warned_of(change, words):
    builder = GltfBuilder()
    material, warnings = read_plastic(builder, **(scatter(scatterStrengthTexture={"index": builder.texture()})
                                                  | change))
    assert len(warnings) == 1 and "materials[0].extensions.KHR_materials_scatter" in warnings[0]
    assert words in warnings[0] and material.diffuse_transmission == 0
    assert material.scatters_thinly == ("takes the place" in words)


def test_diffuse_roughness():
    builder = GltfBuilder()
    fields = {"diffuseRoughnessFactor": 0.6, "diffuseRoughnessTexture": {"index": builder.texture()}}
    material, _ = read({"extensions": {"KHR_materials_diffuse_roughness": fields}}, builder)
    assert material.diffuse_roughness == 0.6 and material.diffuse_roughness_texture is not None
    assert read({"extensions": {"KHR_materials_diffuse_roughness": {}}}) == (Material(), ())
    material, warnings = read({"extensions": {"KHR_materials_diffuse_roughness": {"diffuseRoughnessFactor": 2}}})
    assert material.diffuse_roughness == 1 and "diffuseRoughnessFactor: 2 is out of range" in warnings[0]


def test_anisotropy():
    builder = GltfBuilder()
    texture = builder.texture()
    material, warnings = read({"extensions": {"KHR_materials_anisotropy": {
        "anisotropyStrength": 0.6, "anisotropyRotation": -1.5, "anisotropyTexture": {"index": texture}}}}, builder)
    assert (material.anisotropy_strength, material.anisotropy_rotation) == (0.6, -1.5)
    assert material.anisotropy_texture is not None
    assert warnings == (
        "meshes[0].primitives[0].attributes: the material needs TEXCOORD_0, which is missing; 0, 0 is used",)
    assert read({"extensions": {"KHR_materials_anisotropy": {}}}) == (Material(), ())


def test_sheen():
    builder = GltfBuilder()
    a, b = builder.texture(), builder.texture()
    material, _ = read({"extensions": {"KHR_materials_sheen": {
        "sheenColorFactor": [0.1, 0.2, 0.3], "sheenColorTexture": {"index": a}, "sheenRoughnessFactor": 0.7,
        "sheenRoughnessTexture": {"index": b, "texCoord": 1}}}}, builder)
    assert (material.sheen_color, material.sheen_roughness) == ((0.1, 0.2, 0.3), 0.7)
    assert material.sheen_color_texture is not None and material.sheen_roughness_texture.uv_set == 1
    assert read({"extensions": {"KHR_materials_sheen": {}}}) == (Material(), ())


def test_clearcoat():
    builder = GltfBuilder()
    a, b, c = builder.texture(), builder.texture(), builder.texture()
    material, _ = read({"extensions": {"KHR_materials_clearcoat": {
        "clearcoatFactor": 0.8, "clearcoatTexture": {"index": a}, "clearcoatRoughnessFactor": 0.3,
        "clearcoatRoughnessTexture": {"index": b},
        "clearcoatNormalTexture": {"index": c, "texCoord": 1, "scale": 0.5}}}}, builder)
    assert (material.clearcoat, material.clearcoat_roughness, material.clearcoat_normal_scale) == (0.8, 0.3, 0.5)
    assert material.clearcoat_texture is not None and material.clearcoat_roughness_texture is not None
    assert material.clearcoat_normal_texture.uv_set == 1
    assert read({"extensions": {"KHR_materials_clearcoat": {}}}) == (Material(), ())
    _, warnings = read({"extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": 2}}})
    assert warnings == (
        "materials[0].extensions.KHR_materials_clearcoat.clearcoatFactor: 2 is out of range; 1 is used",)


def test_iridescence():
    builder = GltfBuilder()
    a, b = builder.texture(), builder.texture()
    fields = {"iridescenceFactor": 0.9, "iridescenceTexture": {"index": a}, "iridescenceIor": 1.6,
              "iridescenceThicknessMinimum": 500, "iridescenceThicknessMaximum": 200}
    material, _ = read({"extensions": {"KHR_materials_iridescence": {
        **fields, "iridescenceThicknessTexture": {"index": b, "texCoord": 1}}}}, builder)
    assert (material.iridescence, material.iridescence_ior) == (0.9, 1.6)
    assert (material.iridescence_thickness_minimum, material.iridescence_thickness_maximum) == (500, 200)
    assert material.iridescence_texture is not None and material.iridescence_thickness_texture.uv_set == 1
    assert read({"extensions": {"KHR_materials_iridescence": {}}}) == (Material(), ())
    assert material.has_film and not replace(material, iridescence_ior=1.0).has_film


def test_a_film_as_thick_everywhere_needs_no_map():
    texel = Texture(image_of(np.full((1, 1, 3), 51, np.uint8)))
    film = Material(iridescence=1.0, iridescence_thickness_minimum=500.0, iridescence_thickness_texture=texel)
    folded = without_constant_maps(film)
    assert folded.iridescence_thickness_texture is None
    assert folded.iridescence_thickness_maximum == pytest.approx(480.0)


def test_anisotropy_without_tangents_or_coordinates_is_left_out_and_said():
    _, warnings = read({"extensions": {"KHR_materials_anisotropy": {"anisotropyStrength": 2}}})
    assert warnings == (
        "materials[0].extensions.KHR_materials_anisotropy.anisotropyStrength: 2 is out of range; 1 is used",
        "meshes[0].primitives[0].attributes: anisotropy needs tangents or texture coordinates; it is left out")


@pytest.mark.parametrize("volume, place", [
    ({"attenuationDistance": 0}, "attenuationDistance"), ({"attenuationColor": [0, 2, 0]}, "attenuationColor"),
    ({"thicknessFactor": -1}, "thicknessFactor")])
def test_volumes_out_of_range_are_clamped(volume, place):
    material, warnings = read({"extensions": {"KHR_materials_volume": volume}})
    assert len(warnings) == 1 and place in warnings[0]
    assert material.attenuation_distance > 0 and material.thickness == 0 and max(material.attenuation_color) == 1


@pytest.mark.parametrize("extension, problem", [
    ({"KHR_materials_transmission": 1}, "KHR_materials_transmission: must be an object"),
    ({"KHR_materials_transmission": {"transmissionFactor": "1"}}, "transmissionFactor: must be a number"),
    ({"KHR_materials_transmission": {"transmissionTexture": {"index": 3}}}, "transmissionTexture.index"),
    ({"KHR_materials_volume": {"attenuationColor": [1, 1]}}, "attenuationColor: must have 3 numbers"),
    ({"KHR_materials_volume": {"attenuationDistance": 10**400}}, "attenuationDistance: must be a finite number"),
    ({"KHR_materials_volume": {"thicknessTexture": []}}, "thicknessTexture: must be an object")])
def test_broken_transmission_is_one_line(extension, problem):
    with pytest.raises(InputError) as caught:
        read({"extensions": extension})
    assert problem in str(caught.value) and "\n" not in str(caught.value)


def test_ior_zero_is_kept_and_others_below_one_are_not():
    assert read({"extensions": {"KHR_materials_ior": {"ior": 0}}})[0].ior == 0
    material, warnings = read({"extensions": {"KHR_materials_ior": {"ior": 0.5}}})
    assert material.ior == 1 and "ior" in warnings[0]


def test_values_out_of_range_are_clamped_with_a_warning():
    material, warnings = read({"pbrMetallicRoughness": {"roughnessFactor": 3}, "alphaMode": "GLASS"})
    assert material.perceptual_roughness == 1 and material.alpha_mode == "opaque"
    assert len(warnings) == 2 and "materials[0].pbrMetallicRoughness.roughnessFactor" in warnings[0]


def test_textures_samplers_and_transforms():
    builder = GltfBuilder()
    texture = builder.texture(wrapS=33071, wrapT=33648, magFilter=9728.0, minFilter=9985)
    transform = {"offset": [0.1, 0.2], "rotation": 0.3, "scale": [2, 3], "texCoord": 0}
    material, _ = read({"normalTexture": {"index": texture, "scale": 0.5, "texCoord": 1,
                                          "extensions": {"KHR_texture_transform": transform}},
                        "occlusionTexture": {"index": texture, "strength": 0.25}}, builder)
    normal = material.normal_texture
    assert normal.sampler == Sampler("clamp", "mirror", "nearest", "linear", "nearest")
    assert normal.transform == UVTransform((0.1, 0.2), 0.3, (2, 3)) and normal.uv_set == 0
    assert (material.normal_scale, material.occlusion_strength) == (0.5, 0.25)
    assert material.occlusion_texture.image.data is normal.image.data


def test_a_choice_of_another_type_is_told_in_the_words_of_json():
    with pytest.raises(InputError, match=r"materials\[0\].alphaMode: must be a string, not a number"):
        read({"alphaMode": 3})
    with pytest.raises(InputError, match=r"samplers\[0\].wrapS: must be an integer, not a string"):
        builder = GltfBuilder()
        read({"normalTexture": {"index": builder.texture(wrapS="repeat")}}, builder)
    builder = GltfBuilder()
    warnings = read({"normalTexture": {"index": builder.texture(wrapS=-1)}}, builder)[1]
    assert any("samplers[0].wrapS: -1 is unknown; 10497 is used" in line for line in warnings)


def test_texture_transform_turns_as_in_the_khronos_test_model():
    """TextureTransformTest: the tip of the arrow, at 45 degrees below the u axis, is seen 22.5 degrees further down."""
    angle = np.pi / 8
    matrix = UVTransform(rotation=angle).matrix()
    seen = np.array([np.cos(np.pi / 4 + angle), np.sin(np.pi / 4 + angle)])
    np.testing.assert_allclose(matrix[:, :2] @ seen, [np.sqrt(0.5)] * 2, atol=1e-12)
    full = UVTransform((0.5, 0.25), np.pi / 2, (2, 3)).matrix()
    np.testing.assert_allclose(full, [[0, 3, 0.5], [-2, 0, 0.25]], atol=1e-12)


def test_webp_source_is_preferred():
    builder = GltfBuilder()
    texture = builder.texture(np.zeros((1, 1, 3), np.uint8))
    other = builder.add("images", {"bufferView": builder.view(png_bytes(np.zeros((2, 2, 3), np.uint8)))})
    builder.json["textures"][texture]["extensions"] = {"EXT_texture_webp": {"source": other}}
    material, _ = read({"emissiveTexture": {"index": texture}}, builder)
    assert material.emissive_texture.image.width == 2


@pytest.mark.parametrize("texture", [{}, {"extensions": {"MSFT_texture_dds": {"source": 0}}}])
def test_textures_without_an_image_we_read_are_left_out(texture):
    material, warnings = read({"emissiveTexture": {"index": 0}}, textures=[texture], images=[{"uri": "a.dds"}])
    assert material.emissive_texture is None and "textures[0]" in warnings[0]


def test_third_uv_set_is_left_out():
    builder = GltfBuilder()
    material, warnings = read({"emissiveTexture": {"index": builder.texture(), "texCoord": 2}}, builder)
    assert material.emissive_texture is None and "UV set 2" in warnings[0]


def test_required_extension_is_named():
    with pytest.raises(InputError, match=r"extensionsRequired\[0\].*ACME_mesh"):
        read({}, extensionsUsed=["ACME_mesh"], extensionsRequired=["ACME_mesh"])


def test_used_extensions_are_one_warning_each():
    names = ["ACME_layers", "ACME_layers", "KHR_xmp", "MSFT_lod", "KHR_materials_ior", "ACME_x", "pbrMetallicRoughness"]
    warnings = read({}, extensionsUsed=names)[1]
    assert len(warnings) == 2 and "ACME_layers" in warnings[0] and "ACME_x" in warnings[1]


@pytest.mark.parametrize("asset, problem", [
    ({"version": "1.0"}, "glTF 1.0"), ({"version": ""}, "glTF of no number is"), ({}, "missing"),
    ({"version": "2.1", "minVersion": "2.1"}, "needs glTF 2.1"),
    (None, "object"), ({"version": 2}, "string")])
def test_versions(asset, problem):
    with pytest.raises(InputError, match=f"asset.*{problem}"):
        read({}, asset=asset)
