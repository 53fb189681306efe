"""The package's own golden images: every scene of assets/scenes in both modes, and every pass for a second back end.

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
from viewer.errors import ContextError
from viewer.gpu.context import create_context
from viewer.plan.planner import plan_scene
from viewer.raster.renderer import Renderer

PICTURES = [(mode, case) for mode in ("pbr", "phong") for case in CASES]
ON_OSMESA = {
    "pbr": ("glass-traced", "subsurface", "hair", "interlaced", "environment-shadows", "alpha", "lights"),
    "phong": ("tiny", "knitted", "lines-points", "cloud", "fog"),
}
"""What OSMesa draws where EGL draws all. Both compile shaders by the same code of Mesa; what differs is their contexts,
so every pass and every kind of program, primitive and coverage is drawn with both."""


@pytest.fixture(scope="module")
def renderer() -> Iterator[Renderer]:
    """By EGL, or where there is none by OSMesa."""
    try:
        context = create_context("egl")
    except ContextError:
        context = open_or_skip("osmesa")
    with context:
        renderer = Renderer(context, use_cache=False)
        yield renderer
        renderer.release()


@pytest.fixture(scope="module")
def on_osmesa() -> Iterator[Renderer]:
    with open_or_skip("osmesa") as context:
        renderer = Renderer(context, use_cache=False)
        yield renderer
        renderer.release()


def check(renderer: Renderer, golden, mode: str, case: Case) -> None:
    scene, camera = case.load()
    renderer.context.make_current()
    picture = renderer.display(scene, camera, case.with_mode(mode), SIZE)
    assert renderer.context.gl.error == "GL_NO_ERROR"
    # The goldens are llvmpipe's; a graphics card has other pixels along the edges of masks and triangles.
    golden(picture, f"{case.name}-{mode}", **({} if renderer.context.is_software else {"flip": 0.008}))


@pytest.mark.parametrize(("mode", "case"), PICTURES, ids=lambda value: getattr(value, "name", value))
def test_scene(renderer: Renderer, golden, mode: str, case: Case) -> None:
    check(renderer, golden, mode, case)


@pytest.mark.parametrize(("mode", "case"), [(m, case) for m, case in PICTURES if case.name in ON_OSMESA[m]],
                         ids=lambda value: getattr(value, "name", value))
def test_osmesa(on_osmesa: Renderer, golden, mode: str, case: Case) -> None:
    check(on_osmesa, golden, mode, case)


def kinds(mode: str, case: Case) -> set[object]:
    """The passes of a picture, the fragment shaders of what they draw, and its primitives and how they cover pixels."""
    scene, _ = case.load()
    plan = plan_scene(scene, case.with_mode(mode), scene.lights, samples=4, half_target=True, orthographic=False)
    told = plan.to_json()
    return {*told["passes"], *(scene.meshes[draw.mesh].topology for draw in plan.draws),
            *(draw.alpha_mode for draw in plan.draws), *(program["fragment"] for program in told["programs"]),
            *(program.fragment for program in (plan.media.programs if plan.media else ())),
            *(name for name in ("environment_shadows", "has_traced_refraction") if getattr(plan, name))}


def test_osmesa_draws_every_pass() -> None:
    found = {name: set().union(*(kinds(mode, case) for mode, case in PICTURES if case.name in names[mode]))
             for name, names in (("osmesa", ON_OSMESA), ("all", {mode: [c.name for c in CASES] for mode in ON_OSMESA}))}
    assert found["osmesa"] == found["all"] and len(found["all"]) > 20


def test_every_scene_has_a_golden_image() -> None:
    scenes = {path.stem for path in (resource_folder("assets") / "scenes").glob("*.glb")}
    assert {case.scene for case in CASES if "." not in case.scene} == scenes


@pytest.mark.parametrize("mutation", MUTATIONS, ids=lambda mutation: mutation.name)
def test_what_break_shaders_breaks_is_still_there(mutation: Mutation) -> None:
    """Where this fails, the shader was rewritten: write the mutation anew in break_shaders.py, and run it."""
    mutation.check(resource_folder("shaders"))
