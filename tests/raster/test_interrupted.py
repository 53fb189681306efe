"""A picture that is broken off, as by Ctrl-C in a notebook, changes nothing of the next one."""

from __future__ import annotations

from typing import Any

import moderngl
import numpy as np
import pytest

import viewer
from viewer.base.resources import resource_folder
from viewer.gpu.context import Context
from viewer.raster.kept_maps import KeptMaps
from viewer.raster.renderer import Renderer
from viewer.raster.shadows import Atlas
from viewer.settings import Settings

CASES = {
    "masks": ("alpha", {"antialias": "msaa-4"}),
    "ground": ("lights", {"antialias": "deferred-4", "ground": "shadow", "environment_shadows": "16"}),
    "occlusion": ("glass", {"ambient_occlusion": "gtao"}),
    "traced": ("glass", {"refraction": "traced"}),
}


@pytest.mark.parametrize("case", CASES)
def test_the_next_picture_is_whole(case: str, context: Context, monkeypatch: pytest.MonkeyPatch) -> None:
    model, options = CASES[case]
    scene = viewer.load(resource_folder("assets") / f"scenes/{model}.glb", environment="studio")
    camera, settings = scene.framing_camera(1.0), Settings(mode="pbr", **options)
    draws, last = 0, -1
    draw = moderngl.VertexArray.render

    def count(self: moderngl.VertexArray, *arguments: Any, **named: Any) -> None:
        nonlocal draws
        draws += 1
        if draws - 1 == last:
            raise KeyboardInterrupt
        draw(self, *arguments, **named)

    def picture(renderer: Renderer) -> np.ndarray:
        return renderer.render(scene, camera, settings, (16, 16)).linear

    monkeypatch.setattr(moderngl.VertexArray, "render", count)
    monkeypatch.setattr(KeptMaps, "_name", lambda *_: None)  # else a second renderer draws less
    expected = picture(Renderer(context))
    number = draws
    for last in np.linspace(0, number - 1, 12).astype(int).tolist():
        renderer, draws = Renderer(context), 0
        with pytest.raises(KeyboardInterrupt):
            picture(renderer)
        np.testing.assert_array_equal(picture(renderer), expected, f"after draw {last} of {number}")


def test_shadow_maps_that_are_broken_off_leave_no_offset(context: Context, monkeypatch: pytest.MonkeyPatch) -> None:
    """It would count for all pictures until the next maps are drawn, and those on disk are not drawn."""
    scene = viewer.load(resource_folder("assets") / "scenes/lights.glb", environment="studio")
    renderer, camera = Renderer(context, use_cache=False), scene.framing_camera(1.0)

    def interrupt(self: Atlas, number: int) -> tuple[int, int]:
        raise KeyboardInterrupt

    monkeypatch.setattr(Atlas, "corner", interrupt)
    with pytest.raises(KeyboardInterrupt):
        renderer.render(scene, camera, Settings(environment_shadows="16"), (16, 16))
    assert context.gl.polygon_offset == (0.0, 0.0)
