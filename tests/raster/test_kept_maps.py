"""Shadow maps of the environment that are read from disk show what drawing them would show."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from needs import skip
from shapes import WHITE, facing_floor, lopsided, moved, orthographic, plate, scene, sphere

from viewer.bake.cache import SHADOWS
from viewer.gpu.context import Context
from viewer.raster.renderer import Renderer
from viewer.raster.shadows import Atlas
from viewer.scene.scene import Scene
from viewer.settings import Settings

VIEW = orthographic(0.4, 0.9, height=3.0)


@pytest.fixture
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, context: Context) -> Callable[[], list[Path]]:
    """The entries of shadow maps in a cache of the test's own."""
    if not context.is_software:
        skip("llvmpipe")
    monkeypatch.setenv("PBR_VIEWER_CACHE", str(tmp_path))
    return lambda: sorted(tmp_path.glob(f"{SHADOWS}*"))


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[Atlas]:
    """The atlases that have been drawn."""
    atlases: list[Atlas] = []
    draw = Atlas.draw

    def counted(atlas: Atlas, *arguments: object) -> None:
        atlases.append(atlas)
        draw(atlas, *arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(Atlas, "draw", counted)
    return atlases


@pytest.fixture
def picture(context: Context) -> Iterator[Callable[..., np.ndarray]]:
    """`picture(scene, ...)`: the linear pixels of each scene, of a renderer of its own for all."""
    def draw(*scenes: Scene, use_cache: bool = True, **settings: object) -> np.ndarray:
        renderer = Renderer(context, use_cache)
        options = Settings.of(**{"antialias": "none", "environment_shadows": "16"} | settings)
        pixels = [renderer.render(each, VIEW, options, (32, 32)).linear for each in scenes]
        renderer.release()
        return np.array(pixels)

    yield draw
    assert context.gl.error == "GL_NO_ERROR"


def ball(height: float = 0.8, rotation: float = 0.0, **of_material: object) -> Scene:
    """A ball over a floor."""
    environment = replace(lopsided(), rotation=rotation)
    return scene((sphere(), moved((0, height, 0), 0.5)), (plate(0, half=2.0), facing_floor()),
                 materials=[replace(WHITE, **of_material)], environment=environment)


def test_a_second_renderer_reads_what_the_first_has_drawn(kept, drawn, picture):
    first = picture(ball())
    assert len(drawn) == len(kept()) == 1
    assert np.array_equal(picture(ball()), first)
    assert len(drawn) == 1


@pytest.mark.parametrize("damage", [lambda whole: whole[:-5], lambda whole: b"", lambda whole: whole[:-3] + b"abc"])
def test_a_damaged_entry_is_drawn_again(kept, drawn, picture, damage):
    first = picture(ball())
    [path] = kept()
    path.write_bytes(damage(path.read_bytes()))
    assert np.array_equal(picture(ball()), first)
    assert len(drawn) == 2
    assert np.array_equal(picture(ball()), first)
    assert len(drawn) == 2


@pytest.mark.parametrize("other", [ball(height=0.9), ball(rotation=0.5),
                                   replace(ball(), instances=ball().instances[:1])])
def test_what_differs_is_drawn(kept, drawn, picture, other):
    picture(ball())
    assert np.array_equal(picture(other), picture(other, use_cache=False))
    assert len(kept()) == 2


def test_a_mesh_that_is_another_shape_is_drawn(kept, drawn, picture):
    picture(ball())
    mesh = ball().meshes[0]
    bent = mesh.positions.copy()
    bent[np.abs(bent).max(axis=1) < 0.9] *= 0.5  # its bounds are the same
    other = replace(ball(), meshes=(replace(mesh, positions=bent), *ball().meshes[1:]))
    assert np.array_equal(picture(other), picture(other, use_cache=False))
    assert len(kept()) == 2


def test_more_lights_have_an_entry_of_their_own(kept, drawn, picture):
    picture(ball())
    assert np.array_equal(picture(ball(), environment_shadows="64"),
                          picture(ball(), environment_shadows="64", use_cache=False))
    assert len(kept()) == 2


def test_colours_share_an_entry(kept, drawn, picture):
    picture(ball())
    picture(ball(base_color=(1, 0, 0, 1)))
    assert len(drawn) == len(kept()) == 1


def test_what_lets_light_through_by_its_image_is_not_kept(kept, drawn, picture):
    picture(ball(alpha_mode="mask"))
    picture(ball(transmission=1.0))
    assert kept() == []


def test_a_renderer_keeps_its_first_maps_only(kept, drawn, picture):
    picture(ball(), ball(height=0.9), ball(height=1.0))
    assert len(drawn) == 3
    assert len(kept()) == 1


def test_without_a_cache_nothing_is_kept(kept, drawn, picture, monkeypatch):
    picture(ball(), use_cache=False)
    monkeypatch.setenv("PBR_VIEWER_CACHE", "off")
    picture(ball())
    assert len(drawn) == 2
    assert kept() == []
