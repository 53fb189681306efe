"""The Python API: load a scene, render it, show it in a window.

Any thread may render. Each has its own OpenGL context, which is opened when the thread first renders and released when
it ends. A process that is forked after that cannot render; start processes with the method "spawn"
(`multiprocessing.set_start_method`).
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import replace
from os import PathLike, fspath
from time import perf_counter
from typing import TYPE_CHECKING, Any

from .base.expect import expect, expect_path, expect_size
from .errors import UsageError
from .quality import Quality, check_quality
from .ranges import Range
from .scene.camera import Camera
from .scene.scene import Scene
from .settings import LAYERS, RANGES, Settings
from .shared import shared_chooser, shared_renderer, shared_tracer

if TYPE_CHECKING:
    from .image.image import Image
    from .raster.layers import Following
    from .web.notebook import NotebookView

DEFAULT_SIZE = (1280, 720)


def load(path: str | PathLike[str], environment: str | PathLike[str] | None = "studio", *,
         scene: int | str | None = None, variant: str | None = None, up: str = "y") -> Scene:
    """Load a model file as a scene, lit by an environment.

    `environment` is an HDR or EXR file, the name of a built-in environment (studio, sky, furnace) or None. For a glTF
    file, `scene` selects one of its scenes, by number or name, and `variant` selects one of its material variants
    (KHR_materials_variants; `Scene.variants` lists them, and `Scene.with_variant` selects another). `up` is the axis of
    the file that points upwards, x, y, z, -x, -y or -z: the scene is turned so that this axis becomes +Y. The scene's
    `all_warnings` list the parts of the file that are not supported.

    Raises InputError for a file that cannot be used. The pixels of an environment are decoded when they are first
    needed, so `render` may raise its InputError. Raises UsageError for an argument that is not a path.
    """
    from .scene.environment_files import load_environment
    from .scene.load import load_scene
    from .scene.upright import up_matrix, upright

    up_matrix(up)  # an error about it comes before the file is read
    expect_path(path, "path")
    expect(scene, (int, str, type(None)), "scene", "the number or the name of a scene")
    expect(variant, (str, type(None)), "variant", "the name of a variant")
    if environment is not None:
        expect_path(environment, "environment")
    spec = environment if environment is None else fspath(environment)
    return replace(upright(load_scene(path, scene, variant), up), environment=load_environment(spec))


def join(scene: Scene, *others: Scene) -> Scene:
    """`scene` together with the models and volumes of `others`, in the same coordinate system.

    The environment, the animations and the variants are those of `scene`; animations of `others` are not played.
    """
    from .scene.join import join

    for given in (scene, *others):
        _expect_scene(given, None)
    return join(scene, *others)


def render(
    scene: Scene,
    size: tuple[int, int] = DEFAULT_SIZE,
    camera: Camera | None = None,
    *,
    time: float | None = None,
    animation: str | int | None = None,
    backend: str = "auto",
    aov: Sequence[str] = (),
    fps: float = 25.0,
    next_camera: Camera | None = None,
    tell_error: float | None = None,
    quality: str | None = None,
    **settings: Any,
) -> Image:
    """Render a picture of `scene`; `size` is (width, height) in pixels.

    By default the camera frames the scene. `time`, in seconds, shows the scene at this time of an animation: of the
    first one, or of the one with this name or number (`Scene.at`). A scene without animations does not change.
    `settings` are fields of `viewer.Settings`, for example ``mode="phong", exposure=1.0, background="#336699"`` or
    ``mode="path", spp=256``. `backend` is auto, egl, osmesa or window (a hidden window).

    With `time_budget` or `error`, and without `mode`, both renderers make the best picture in that time, or one with
    at most that error (docs/budget.md). `Image.stats` says how it was made, and has its error.

    `aov` selects layers with numbers for each pixel, which are added to `Image.layers`: albedo, normal, depth,
    position, instance, material, motion, uv, and in mode path variance and samples (docs/layers.md). Motion is to the
    picture 1 / `fps` seconds later, seen from `next_camera` if it is given. Without `time`, only the camera moves.

    In mode pbr, `quality` is draft, standard or high, which trade time against error (docs/quality.md); given
    `settings` keep their values. The default, auto, is standard, with 64 or otherwise 16 lights of the environment, if
    a new process is estimated to load and draw the scene in at most twice the time of a draft. Otherwise it is draft.
    The choice depends only on the scene and `size`. Further pictures of the same scene take more than twice the time
    of a draft: for many pictures, use draft.

    With `tell_error`, a number of seconds of path tracing, `Image.stats["estimated_error"]` has the error of a picture
    of mode pbr or phong (docs/tell-error.md), and the layer "error" shows where it is wrong.

    A texture that cannot be decoded is left out, with a UserWarning. Other warnings say that the picture will be black
    because nothing lights the scene, that settings have no effect on it, and that mode path has left out samples.
    Raises UsageError for arguments of the wrong type, an invalid size or a setting that does not exist, InputError for
    an environment that cannot be decoded, and ContextError if there is no OpenGL.
    """
    from .plan.unused import unused_settings
    from .plan.warnings import camera_warnings, picture_warnings, sample_warnings

    _expect_scene(scene, camera)
    fps = Range(1e-3, 1e6).number(fps, f"fps={fps!r}: it")
    expect(next_camera, (Camera, type(None)), "next_camera", "a Camera")

    def following(shown: Scene, by: Camera) -> Following:
        return shown if time is None else shown.at(time + 1 / fps, animation or 0), next_camera or by

    scene = _at(scene, time, animation)
    known = scene.all_warnings
    started = perf_counter()
    image = _rendered(scene, size, camera, backend, _checked_layers(aov), tell_error, quality, settings, following)
    image = replace(image, stats={"wall_s": {"render": perf_counter() - started}, **image.stats})
    lost = [line for line in scene.all_warnings if line not in known]
    chosen = Settings.of(**settings)
    known_before = [*picture_warnings(scene, chosen), *unused_settings(scene, chosen)]
    if camera is not None and "choice" not in image.stats:
        known_before += camera_warnings(scene, chosen, camera)
    for line in [*lost, *known_before, *sample_warnings(image.stats)]:
        warnings.warn(line, stacklevel=2)
    return image


def _rendered(scene: Scene, size: tuple[int, int], camera: Camera | None, backend: str, aov: Sequence[str],
              tell_error: float | None, quality: str | None, settings: dict[str, Any],
              following: Callable[[Scene, Camera], Following]) -> Image:
    chosen, size = Settings.of(**settings), expect_size(size, "size")
    point = Quality.of(quality, settings, chosen, scene, size)
    chosen.check_ground()
    is_open = "mode" not in settings and not (chosen.time_budget is None and chosen.error is None)
    check_quality(quality, chosen, is_open)
    if not is_open:
        chosen.check_used()
    if camera is None:
        camera = scene.framing_camera(size[0] / size[1])
    if tell_error is not None:
        tell_error = RANGES["time_budget"].number(tell_error, f"tell_error={tell_error!r}: it")
        if is_open or chosen.mode == "path":
            raise UsageError("tell_error is for pictures of the real-time modes; others tell their error themselves")
        chosen.check_told("tell_error")
    if is_open:
        chosen.check_open()
        image, choice = shared_chooser(backend).make(scene, camera, chosen, size, aov,
                                                     following=following(scene, camera))
        return replace(image, stats={**image.stats, "choice": choice.to_json()})
    chosen.check_layers(aov)
    if chosen.mode == "path":
        from .estimate.layers import traced_layers
        from .estimate.mixture import draw_guide
        from .trace.ground import above_ground, with_ground

        started, layers = perf_counter(), traced_layers(aov, scene, chosen)
        guide = draw_guide(shared_renderer(backend), scene, camera, chosen, size)
        tracer = shared_tracer(backend)
        image = tracer.render(scene, camera, above_ground(chosen), size, layers, guide, started)
        image = with_ground(tracer, image, scene, camera, chosen)
        return _with_layers(image, scene, camera, chosen, backend, aov, following)
    renderer = shared_renderer(backend)
    renderer.times.clear()
    chosen = point.applied(chosen)
    image = renderer.render(scene, camera, chosen, size)
    image = _with_layers(image, scene, camera, chosen, backend, aov, following)
    plan = point.facts(chosen) | dict(image.stats["plan"])  # type: ignore[call-overload]
    image = replace(image, stats={"prepare_s": dict(renderer.times), **image.stats, "plan": plan})
    return image if tell_error is None else _with_error(image, scene, camera, chosen, backend, tell_error)


def _with_layers(image: Image, scene: Scene, camera: Camera, settings: Settings, backend: str, names: Sequence[str],
                 following: Callable[[Scene, Camera], Following]) -> Image:
    if not names:
        return image
    from .estimate.layers import with_layers

    return with_layers(image, shared_renderer(backend), scene, camera, settings, names, following(scene, camera))


def _with_error(image: Image, scene: Scene, camera: Camera, settings: Settings, backend: str,
                seconds: float) -> Image:
    """The picture that the shared renderer has drawn last, with its error."""
    from .estimate.measure import measure_error

    radiance = shared_renderer(backend).read_radiance()
    error = measure_error(shared_tracer(backend), radiance, scene, camera, settings, image.size, seconds)
    assert error is not None
    for note in error.notes:
        warnings.warn(note, stacklevel=4)
    return replace(image, stats={**image.stats, "estimated_error": error.to_json()},
                   layers={**image.layers, "error": error.map})


def show(
    scene: Scene, size: tuple[int, int] = DEFAULT_SIZE, camera: Camera | None = None, *, time: float | None = None,
    animation: str | int | None = None, quality: str | None = None, **settings: Any,
) -> Image | NotebookView | None:
    """Show `scene` in a window and wait until it is closed. In a notebook, return what a cell shows as its result: a
    view to turn by the mouse and the keys of the window (docs/notebook.md), or a picture without the extra [notebook].

    The arguments are those of `render`, but the window denoises path-traced pictures by default (`denoise="off"`
    prevents it), with `time_budget` or `error` by mixing them with the real-time picture, and a picture has its
    `quality` only at rest. It traces until the picture has converged or until `spp`, `time_budget` or `error` is
    reached. Raises ContextError if no window can be opened.
    """
    _expect_scene(scene, camera)
    scene = _at(scene, time, animation)
    from .interact.window_settings import window_settings

    chosen = window_settings(Settings.of(**{"denoise": "fast", **settings}), settings.__contains__)
    size = expect_size(size, "size")
    point = Quality.of(quality, settings, replace(chosen, mode="pbr"), scene, size)  # for the keys of the mode
    from .web.cell import in_notebook, view_in_cell

    if in_notebook():
        view = view_in_cell(scene, chosen, camera, size, point)
        return render(scene, size, camera, quality=quality, **settings) if view is None else view
    from .app import open_window

    open_window(scene, chosen, camera, size, quality=point)
    return None


def _at(scene: Scene, time: float | None, animation: str | int | None) -> Scene:
    expect(time, (int, float, type(None)), "time", "a number of seconds")
    expect(animation, (str, int, type(None)), "animation", "an animation's name or number")
    if time is None and animation is None:
        return scene
    return scene.at(time or 0.0, 0 if animation is None else animation)


def _expect_scene(scene: object, camera: object) -> None:
    expect(scene, Scene, "scene", "a Scene (viewer.load makes one)")
    expect(camera, (Camera, type(None)), "camera", "a Camera")


def _checked_layers(names: Sequence[str]) -> Sequence[str]:
    expect(names, (list, tuple), "aov", "a list of layers' names")
    for name in names:
        if name not in LAYERS:
            raise UsageError(f"aov={names!r}: there is no layer {name!r}; choose from {', '.join(LAYERS)}")
    return names
