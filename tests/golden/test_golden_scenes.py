"""The package's own golden images: every scene of assets/scenes in both modes, one picture for both back ends.

That each of them fails when its shader is broken is shown by break_shaders.py.
"""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from break_shaders import MUTATIONS
from cases import CASES, SIZE, Case
from contexts import open_or_skip
from mutations import Mutation

from viewer.base.resources import resource_folder
from viewer.raster.renderer import Renderer


@pytest.fixture(scope="module", params=["egl", "osmesa"])
def renderer(request) -> Iterator[Renderer]:
    with open_or_skip(request.param) as context:
        renderer = Renderer(context, use_cache=False)
        yield renderer
        renderer.release()


@pytest.mark.parametrize(("mode", "case"), [(mode, case) for mode in ("pbr", "phong") for case in CASES],
                         ids=lambda value: getattr(value, "name", value))
def test_scene(renderer: Renderer, golden, mode: str, case: Case) -> None:
    scene, camera = case.load()
    picture = renderer.display(scene, camera, case.with_mode(mode), SIZE)
    assert renderer.context.gl.error == "GL_NO_ERROR"
    golden(picture, f"{case.name}-{mode}")


def test_every_scene_has_a_golden_image() -> None:
    scenes = {path.stem for path in (resource_folder("assets") / "scenes").glob("*.glb")}
    assert {case.scene for case in CASES if "." not in case.scene} == scenes


@pytest.mark.parametrize("mutation", MUTATIONS, ids=lambda mutation: mutation.name)
def test_what_break_shaders_breaks_is_still_there(mutation: Mutation) -> None:
    """Where this fails, the shader was rewritten: write the mutation anew in break_shaders.py, and run it."""
    mutation.check(resource_folder("shaders"))
