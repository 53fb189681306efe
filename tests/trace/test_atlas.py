"""The atlas of images (viewer/trace/scene/atlas.py, shaders/trace/atlas.glsl): each texel is at its place, and
filtering is right."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import moderngl
import numpy as np
import pytest
from harness import evaluate
from images import image_of, noise
from shapes import orthographic, plate, scene

from viewer.gpu.buffer_texture import BufferTexture
from viewer.gpu.programs import set_uniform
from viewer.scene.color import srgb_to_linear
from viewer.scene.material import Material, Sampler, Texture, UVTransform
from viewer.scene.texture_image import TextureImage
from viewer.settings import Settings
from viewer.trace.scene.atlas import MAX_TEXELS, Atlas, layout_atlas
from viewer.trace.scene.materials import map_texels
from viewer.trace.scene.scene_buffer import SceneBufferBuilder

LIMIT = 4096
HALF = 2.0**-11
"""The relative rounding error of a half float."""


def header(width: int, height: int) -> TextureImage:
    """An image that has only a size."""
    return TextureImage("header", b"", width, height, "PNG")


def assert_packed(layout, limit: int) -> None:
    taken = np.zeros(layout.size[::-1], np.uint8)
    for image, (x, y, width, height) in layout.pages.items():
        halvings = layout.halvings[image]
        assert (width, height) == (max(image.width >> halvings, 1), max(image.height >> halvings, 1))
        assert x + width <= layout.size[0] <= limit and y + height <= layout.size[1] <= limit
        taken[y:y + height, x:x + width] += 1
    assert taken.max(initial=0) <= 1


def filled(layout) -> float:
    return sum(w * h for _, _, w, h in layout.pages.values()) / (layout.size[0] * layout.size[1])


@pytest.mark.parametrize("sides, least", [
    ([(1024, 1024)] * 4, 1.0), ([(512, 512)] * 16 + [(2048, 1024)], 1.0), ([(256, 256)] * 100, 0.95),
    ([(2048, 2048), (1024, 1024), (1024, 512), (64, 64)], 0.75), ([(1, 1)], 1.0), ([(4000, 16), (16, 4000)], 0.003)])
def test_pages_fill_the_atlas(sides, least):
    layout = layout_atlas([header(*side) for side in sides], LIMIT)
    assert_packed(layout, LIMIT)
    assert not any(layout.halvings.values()) and not layout.warnings
    assert filled(layout) >= least


def test_any_sizes_lie_side_by_side():
    random = np.random.default_rng(2)
    layout = layout_atlas([header(*side) for side in random.integers(1, 300, (150, 2)).tolist()], LIMIT)
    assert_packed(layout, LIMIT)
    assert filled(layout) > 0.85


def test_an_image_used_twice_has_one_page():
    image = header(8, 8)
    assert layout_atlas([image, image, header(8, 8)], LIMIT).size in ((16, 8), (8, 16))


def test_the_largest_are_halved_until_all_fit():
    large, small = [header(256, 256) for _ in range(5)], header(100, 50)
    layout = layout_atlas([*large, small], 512)
    assert_packed(layout, 512)
    assert [layout.halvings[image] for image in large] == [1] * 5 and layout.halvings[small] == 0
    (warning,) = layout.warnings
    assert warning == "5 texture images traced at reduced size: all have to fit into one texture"
    wide = layout_atlas([header(1000, 3)], 300)
    assert wide.pages[next(iter(wide.pages))] == (0, 0, 250, 1)


def test_a_texture_of_gigabytes_is_not_asked_for():
    layout = layout_atlas([header(4096, 4096) for _ in range(40)], 16384)
    assert set(layout.halvings.values()) == {2} and layout.size[0] * layout.size[1] <= MAX_TEXELS


def test_no_images_are_no_trouble():
    assert layout_atlas([], LIMIT).size == (1, 1)


@pytest.mark.parametrize("is_srgb", [False, True])
def test_pages_hold_what_the_files_say(context, is_srgb):
    stored = [noise(7, 5, count, count) for count in (1, 2, 3, 4)]
    images = [image_of(pixels) for pixels in stored]
    atlas = Atlas(context, images, is_srgb)
    texture = atlas.upload()
    width, height = atlas.layout.size
    found = evaluate_texels(context, texture, width, height)
    for image, pixels in zip(images, stored):
        x, y, w, h = atlas.layout.pages[image]
        grey = pixels.shape[2] < 3
        color = np.repeat(pixels[..., :1], 3, axis=2) if grey else pixels[..., :3]
        alpha = pixels[..., -1:] if pixels.shape[2] in (2, 4) else np.full((5, 7, 1), 255)
        expected = np.concatenate([srgb_to_linear(color / 255) if is_srgb else color / 255, alpha / 255], axis=2)
        np.testing.assert_allclose(found[y:y + h, x:x + w], expected, rtol=HALF if is_srgb else 0, atol=2e-7)


def test_sixteen_bits_are_kept(context):
    deep, flat = noise(4, 3, 3, 1, np.uint16), noise(4, 3, 3, 2)
    for is_srgb in (False, True):
        images = [image_of(deep), image_of(flat)]
        atlas = Atlas(context, images, is_srgb)
        found = evaluate_texels(context, atlas.upload(), *atlas.layout.size)
        for image, pixels in zip(images, (deep, flat)):
            x, y, w, h = atlas.layout.pages[image]
            value = pixels / np.iinfo(pixels.dtype).max
            if is_srgb:
                value = srgb_to_linear(value)
            np.testing.assert_allclose(found[y:y + h, x:x + w, :3], value, rtol=HALF if is_srgb else 0, atol=2e-7)


@pytest.mark.parametrize("is_srgb, dtype", [(False, np.uint8), (True, np.uint8), (True, np.uint16)])
def test_a_reduced_image_is_the_mean_of_its_texels(context, monkeypatch, is_srgb, dtype):
    monkeypatch.setitem(context.gl.info, "GL_MAX_TEXTURE_SIZE", 32)
    pixels = noise(64, 64, 4, dtype=dtype)
    atlas = Atlas(context, [image_of(pixels)], is_srgb)
    assert len(atlas.layout.warnings) == 1 and atlas.layout.size == (32, 32)
    found = evaluate_texels(context, atlas.upload(), 32, 32)
    value = pixels / np.iinfo(dtype).max
    if is_srgb:
        value[..., :3] = srgb_to_linear(value[..., :3])
    # Half a step of the 8 bits that store the mean; for sRGB the step is up to 2.3 times as wide
    np.testing.assert_allclose(found, value.reshape(32, 2, 32, 2, 4).mean(axis=(1, 3)), atol=0.51 * 2.3 / 255)


@pytest.mark.parametrize("limit", [64, 32])
def test_what_alpha_hides_has_the_colours_of_what_is_seen(context, monkeypatch, limit):
    """White cut out of black is all white, at full size and at half of it; another image keeps its colours."""
    monkeypatch.setitem(context.gl.info, "GL_MAX_TEXTURE_SIZE", limit)
    pixels = np.zeros((64, 64, 4), np.uint8)
    pixels[::3, ::3] = 255
    image = image_of(pixels)
    for covering in ({image}, set()):
        found = evaluate_texels(context, Atlas(context, [image], True, covering).upload(), limit, limit)
        assert (found[..., :3] == 1).all() == bool(covering)
        assert 0 < found[..., 3].mean() < 0.15 and (found[..., 3] == 0).any()


def test_what_materials_hide_counts_in_paths(tracer):
    """Some texels of a map hide black; of the same map as an opaque colour it is seen."""
    pixels = np.zeros((4, 4, 4), np.uint8)
    pixels[1:3, 1:3] = 255
    for mode, least in (("blend", 1.0), ("opaque", 0.0)):
        material = Material(base_color_texture=Texture(image_of(pixels)), unlit=True, alpha_mode=mode)
        picture = tracer.render(scene(plate(), materials=[material]), orthographic(height=2.0),
                                Settings.of(mode="path", spp=4, background="none"), (16, 16)).linear
        seen = picture[picture[..., 3] > 0]
        assert (seen[:, :3] / seen[:, 3:]).min() == pytest.approx(least, abs=1e-3)


def test_a_broken_image_is_its_neutral_colour(context):
    good = image_of(noise(64, 64), "wood.png")
    broken = TextureImage("wood.png", good.data[:len(good.data) // 2], 64, 64, "PNG", neutral=(0.0, 1.0, 0.2, 1.0))
    found = evaluate_texels(context, Atlas(context, [broken], False).upload(), 64, 64)
    np.testing.assert_allclose(found, np.full((64, 64, 4), broken.neutral), atol=1e-6)
    assert broken.problems[0].startswith("wood.png: cannot be decoded")


def evaluate_texels(context, texture, width: int, height: int) -> np.ndarray:
    """All texels as a shader reads them, (H, W, 4), fetched one row at a time."""
    import moderngl

    program = context.gl.program(
        vertex_shader="#version 330 core\nvoid main() { gl_Position = vec4(vec2(gl_VertexID == 1, gl_VertexID == 2)"
                      " * 4.0 - 1.0, 0.0, 1.0); }",
        fragment_shader="#version 330 core\nuniform sampler2D t; out vec4 o;"
                        "void main() { o = texelFetch(t, ivec2(gl_FragCoord.xy), 0); }")
    target = context.gl.framebuffer([context.gl.texture((width, height), 4, dtype="f4")])
    target.use()
    texture.use(0)
    context.gl.vertex_array(program, []).render(moderngl.TRIANGLES, 3)
    return np.frombuffer(target.read(components=4, dtype="f4"), "f4").reshape(height, width, 4).astype(np.float64)


def wrapped(index: np.ndarray, size: int, wrap: str) -> np.ndarray:
    """OpenGL 3.3, section 3.8.8, table 3.17 on texel numbers."""
    if wrap == "repeat":
        return index % size
    if wrap == "clamp":
        return np.clip(index, 0, size - 1)
    folded = index % (2 * size)
    return np.where(folded < size, folded, 2 * size - 1 - folded)


def filtered(pixels: np.ndarray, uv: np.ndarray, sampler: Sampler) -> np.ndarray:
    """(N, C) from (H, W, C) linear values, OpenGL 3.3, section 3.8.9."""
    height, width = pixels.shape[:2]
    x = uv * (width, height)
    if sampler.mag_filter == "nearest":
        column, row = np.floor(x).astype(int).T
        return pixels[wrapped(row, height, sampler.wrap_t), wrapped(column, width, sampler.wrap_s)]
    low = np.floor(x - 0.5)
    weight = x - 0.5 - low
    out = 0.0
    for dx, dy in itertools.product((0, 1), (0, 1)):
        column = wrapped(low[:, 0].astype(int) + dx, width, sampler.wrap_s)
        row = wrapped(low[:, 1].astype(int) + dy, height, sampler.wrap_t)
        share = np.where(dx, weight[:, 0], 1 - weight[:, 0]) * np.where(dy, weight[:, 1], 1 - weight[:, 1])
        out = out + share[:, None] * pixels[row, column]
    return out


SAMPLERS = [Sampler(s, t, mag) for s, t, mag in
            itertools.product(("repeat", "clamp", "mirror"), ("repeat", "clamp", "mirror"), ("linear", "nearest"))]


def binder(table: BufferTexture, atlas: moderngl.Texture) -> Callable[[moderngl.Program], None]:
    """A function that binds a scene buffer, whose first section is the maps, and the atlas with their images."""
    def bind(program: moderngl.Program) -> None:
        table.bind(program, "u_scene", 0)
        atlas.use(1)
        set_uniform(program, "u_data_atlas", 1)
        set_uniform(program, "u_maps", 0)
    return bind


@pytest.mark.parametrize("size", [(1, 1), (1, 3), (4, 2), (7, 5)])
def test_filters_and_wraps_are_opengls(context, tmp_path, size):
    pixels = noise(*size)
    others = [image_of(noise(8, 9, 4, seed)) for seed in range(3)]
    image = image_of(pixels)
    atlas = Atlas(context, [others[0], image, *others[1:]], False)
    texture = atlas.upload()
    transform = UVTransform((0.3, -0.2), 0.7, (1.5, 0.8))
    records = [Texture(image, sampler, uv_set, moved)
               for sampler in SAMPLERS for uv_set, moved in ((0, None), (1, transform))]
    buffer = SceneBufferBuilder()
    buffer.add("maps", np.concatenate([map_texels(record, 1, atlas.layout.pages[image]) for record in records]))
    bind = binder(buffer.texture(context), texture)
    random = np.random.default_rng(4)
    # Multiples of 1/64 are exact. The filter `nearest` is then tested away from the edges of texels only.
    uv = (random.integers(-200, 200, (len(records), 60, 4)) + 0.37) / 64
    number = np.repeat(np.arange(len(records), dtype=np.uint32), 60)
    rows = np.concatenate([number[:, None], np.zeros((len(number), 3), np.uint32),
                           uv.reshape(-1, 4).astype(np.float32).view(np.uint32)], axis=1)
    switches = {"HAS_COLOR_MAPS": 0, "HAS_DATA_MAPS": 1, "HAS_UV1": 1, "HAS_UV_TRANSFORM": 1}
    found = evaluate(context, tmp_path, "trace/atlas.glsl",
                     "o0 = sample_atlas(u_data_atlas, texture_map(int(i0.x), f1.xy, f1.zw));", rows, 1, switches, bind)
    for record, given, texels in zip(records, uv.astype(np.float32), found[:, 0].reshape(len(records), 60, 4)):
        at = given[:, 2 * record.uv_set:2 * record.uv_set + 2].astype(np.float64)
        if record.transform is not None:
            matrix = record.transform.matrix().astype(np.float32).astype(np.float64)
            at = at @ matrix[:, :2].T + matrix[:, 2]
        expected = filtered(pixels / 255, at, record.sampler)
        close = np.abs(texels - expected).max(axis=1) < 1e-5
        if record.sampler.mag_filter == "nearest":  # near an edge, either texel is right
            edge = np.abs(at * size - np.rint(at * size)).min(axis=1)
            close |= edge < 1e-5
        assert close.all(), (record, at[~close][:3], texels[~close][:3], expected[~close][:3])


def test_coordinates_at_and_beyond_all_edges_stay_on_the_page(context, tmp_path):
    white = image_of(np.full((4, 4, 4), 255, np.uint8))
    black = [image_of(np.zeros((4, 4, 4), np.uint8)) for _ in range(8)]
    atlas = Atlas(context, [*black[:4], white, *black[4:]], False)
    texture = atlas.upload()
    buffer = SceneBufferBuilder()
    buffer.add("maps", np.concatenate([map_texels(Texture(white, s), 0, atlas.layout.pages[white]) for s in SAMPLERS]))
    bind = binder(buffer.texture(context), texture)
    tiny = np.float32(1e-45)
    above, below = np.nextafter(np.float32(1), np.float32([2, 0]))
    edges = np.float32([0, -0.0, 1, above, below, tiny, -tiny, -1e-9, 2, -1, 1e6, -1e6, 1e30, -1e30, np.inf, -np.inf,
                        np.nan])
    number, u, v = np.meshgrid(np.arange(len(SAMPLERS)), edges, edges, indexing="ij")
    rows = np.zeros((number.size, 4), np.uint32)
    rows[:, 0], rows[:, 1], rows[:, 2] = number.ravel(), u.ravel().view(np.uint32), v.ravel().view(np.uint32)
    switches = {"HAS_COLOR_MAPS": 0, "HAS_DATA_MAPS": 1, "HAS_UV1": 0, "HAS_UV_TRANSFORM": 0}
    found = evaluate(context, tmp_path, "trace/atlas.glsl",
                     "TextureMap m = texture_map(int(i0.x), f0.yz, vec2(0.0)); Footprint f = footprint(m);"
                     "o0 = vec4(f.low, f.high) - m.corner.xyxy;", rows, 1, switches, bind)
    assert found.min() >= 0 and found.max() <= 3
