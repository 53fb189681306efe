"""The shadow of a model on the ground below it, by paths: alpha = 1 - (light with the model) / (light without it).

Both are what a grey ground reflects upwards at the points that the pixels' centres see, with the same random numbers,
so that the shadow is 0 where the model changes nothing. The ground is not part of the picture: it neither lights the
model nor is it seen in it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..image.display import DisplayPass
from ..image.image import Image
from ..scene.camera import Camera
from ..scene.color import LUMINANCE
from ..scene.frame import Frame
from ..scene.ground import ground_height
from ..scene.material import Material
from ..scene.mesh import Mesh
from ..scene.scene import Instance, Scene
from ..settings import Settings
from .paths.run import run
from .paths.surface_rays import TO_SURFACE, SurfaceRays
from .tracer import Tracer

REACH = 20.0
"""In radii of the scene: shadows end so far from its middle."""
_GREY = Material(name="ground", base_color=(0.2, 0.2, 0.2, 1.0), metallic=0.0, perceptual_roughness=1.0, specular=0.0)


def above_ground(settings: Settings) -> Settings:
    """The settings by which the model is traced that `with_ground` lays over its shadow."""
    return settings if settings.ground == "off" else replace(settings, background="none")


def with_ground(tracer: Tracer, image: Image, scene: Scene, camera: Camera, settings: Settings) -> Image:
    """The picture, traced with `above_ground(settings)`, over the ground's shadow and the background of `settings`; as
    it is if there is no ground."""
    if settings.ground == "off":
        return image
    shadow = ground_shadow(tracer, scene, camera, settings, image.size)
    behind = np.zeros((*shadow.shape, 4), np.float32)
    if settings.background == "env" and scene.environment is not None:
        sky = Scene("sky", environment=scene.environment)
        behind = tracer.render(sky, camera, replace(settings, ground="off", denoise="off", spp=16), image.size).linear
    behind = behind * (1 - shadow[..., None])
    behind[..., 3] += shadow
    linear = (image.linear + (1 - image.linear[..., 3:]) * behind).astype(np.float32)
    shown = _displayed(tracer, linear, settings)
    if isinstance(settings.background, tuple):
        linear += (1 - linear[..., 3:]) * np.array([*settings.background, 1], np.float32)
    return replace(image, linear=linear, srgb=shown)


def ground_shadow(tracer: Tracer, scene: Scene, camera: Camera, settings: Settings,
                  size: tuple[int, int]) -> NDArray[np.float64]:
    """The alpha of the shadow at the pixels' centres, (H, W), row 0 at the top."""
    shadow = np.zeros(size[::-1])
    points, is_seen = _points(scene, camera, size)
    if not is_seen.any() or not (scene.instances or scene.curves):
        return shadow
    dark = tuple(replace(material, emissive=(0.0, 0.0, 0.0)) for material in scene.materials)
    placed = _with_plate(replace(scene, materials=dark, animations=(), rig=None, variants=()))
    alone = _with_plate(replace(scene, meshes=(), instances=(), materials=(), curves=(), volumes=(), animations=(),
                                rig=None, variants=()), scene)
    settings = replace(settings, ground="off", denoise="off", exposure=0.0, spp=settings.most_spp, clamp=0.0)
    lit, unshadowed = (_reflected(tracer, each, points[is_seen], settings) for each in (placed, alone))
    hidden = unshadowed - lit
    if all(light.kind == "directional" for light in scene.lights):  # alike everywhere: the mean has hardly any noise
        unshadowed = np.full_like(unshadowed, unshadowed.mean())
    shadow[is_seen] = np.clip(hidden / np.maximum(unshadowed, 1e-30), 0, 1) * (unshadowed > 0)
    return shadow


def _points(scene: Scene, camera: Camera, size: tuple[int, int]) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """The points of the ground at the pixels' centres, (H, W, 3) world, and which pixels see it from above."""
    frame = Frame(scene, camera, size)
    x, y = ((2 * np.arange(count) + 1) / count - 1 for count in size)
    ndc = np.stack(np.broadcast_arrays(x[None, :], -y[:, None], 1.0), axis=-1)
    direction, origin = ndc @ frame.ray.T, ndc @ frame.ray_origin.T * frame.unit + camera.eye
    with np.errstate(divide="ignore", invalid="ignore"):
        way = (ground_height(scene) - origin[..., 1]) / direction[..., 1]
        points = origin + way[..., None] * direction
    away = np.linalg.norm((points - scene.center)[..., [0, 2]], axis=-1)
    return points, (direction[..., 1] < 0) & (way > 0) & (away < REACH * scene.radius)


def _with_plate(shown: Scene, below: Scene | None = None) -> Scene:
    """`shown` with a plate that is the ground below it, or below another scene."""
    below = below or shown
    half, (x, _, z) = 1.5 * REACH * below.radius, below.center
    corners = np.array([[-half, 0, -half], [-half, 0, half], [half, 0, half], [half, 0, -half]])
    up = np.array([[0, 1, 0]] * 4)
    place = np.eye(4)
    place[:3, 3] = x, ground_height(below), z
    plate = Mesh("ground", corners, len(shown.materials), indices=np.array([0, 1, 2, 0, 2, 3]), normals=up)
    return replace(shown, meshes=(*shown.meshes, plate), materials=(*shown.materials, _GREY),
                   instances=(*shown.instances, Instance(len(shown.meshes), place, "ground")))


def _reflected(tracer: Tracer, scene: Scene, points: NDArray[np.float64], settings: Settings) -> NDArray[np.float64]:
    """The luminance that the ground reflects upwards at these points, (N,)."""
    up = np.broadcast_to([0.0, 1.0, 0.0], points.shape)
    rays = SurfaceRays(tracer.context.gl, TO_SURFACE, (points - scene.center) / scene.radius, up, up)
    try:
        path_render = tracer.begin_at(scene, rays, settings)
        try:
            run(path_render, 0.0)
            sums = rays.rows(path_render.film.read_sums()[0][::-1]).astype(np.float64)
        finally:
            path_render.release()
    finally:
        rays.release()
    return sums[:, :3] @ LUMINANCE / np.maximum(sums[:, 3], 1.0)


def _displayed(tracer: Tracer, linear: NDArray[np.float32], settings: Settings) -> NDArray[np.uint8]:
    context = tracer.context
    context.make_current()
    height, width = linear.shape[:2]
    display = DisplayPass(context.gl, tracer.programs)
    texture = context.gl.texture((width, height), 4, np.ascontiguousarray(linear[::-1]), dtype="f4")
    try:
        target = display.target((width, height))
        display.draw(texture, settings, target, 0)
        pixels = np.frombuffer(target.read(components=4), np.uint8).reshape(height, width, 4)
        return np.ascontiguousarray(pixels[::-1])
    finally:
        texture.release()
        display.release()
