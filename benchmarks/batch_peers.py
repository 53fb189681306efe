"""Another program's loop over many models, for `benchmarks.batch`; it runs in that program's own environment.

    python batch_peers.py pyrender|f3d|open3d LIST SIZE OUT TOLD HDR

LIST names a model a line; OUT is a folder for the pictures; HDR lights them in F3D (Open3D takes no such file and has
light of its own; pyrender has no image-based light). Each model is framed by its bounding sphere. The file TOLD gets a
line of JSON a model when its picture is on disk.
"""

import json
import math
import os
import sys
from pathlib import Path

FOV, AZIMUTH, ELEVATION = 40.0, 35.0, 15.0


def pyrender_pictures(size, hdr):
    """pyrender with trimesh, four samples a pixel; it has no image-based light: ambient light and three lamps."""
    os.environ.setdefault("PYOPENGL_PLATFORM", "egl")
    import numpy as np
    import pyrender
    import trimesh
    from PIL import Image

    renderer = pyrender.OffscreenRenderer(size, size)

    def draw(model, picture):
        loaded = trimesh.load(model, force="scene")
        scene = pyrender.Scene.from_trimesh_scene(loaded, ambient_light=[0.35] * 3, bg_color=[0.4, 0.4, 0.4, 1.0])
        low, high = loaded.bounds
        center, away = (low + high) / 2, distance(low, high)
        eyes = [eye(center, away, AZIMUTH + turn) for turn in (0, -70, 14, 84)]
        camera = pyrender.PerspectiveCamera(math.radians(FOV), znear=away * 0.01, zfar=away * 10)
        scene.add(camera, pose=pose(np, eyes[0], center))
        for place in eyes[1:]:
            scene.add(pyrender.DirectionalLight(intensity=3.0), pose=pose(np, place, center))
        pixels, _ = renderer.render(scene)
        Image.fromarray(pixels).save(picture, compress_level=1)

    return draw


def pose(np, place, center):
    z = np.subtract(place, center)
    z /= np.linalg.norm(z)
    x = np.cross([0, 1, 0], z)
    x /= np.linalg.norm(x)
    matrix = np.eye(4)
    matrix[:3, 0], matrix[:3, 1], matrix[:3, 2], matrix[:3, 3] = x, np.cross(z, x), z, place
    return matrix


def f3d_pictures(size, hdr):
    """F3D with image-based light; it frames the model itself."""
    import f3d

    f3d.Log.set_verbose_level(f3d.Log.VerboseLevel.ERROR)
    engine = f3d.Engine.create_egl()
    engine.options.update({"render.hdri.ambient": True, "render.hdri.file": hdr, "render.effect.tone_mapping": True,
                           "render.effect.antialiasing.mode": "fxaa", "render.grid.enable": False, "ui.axis": False})
    engine.window.size = size, size

    def draw(model, picture):
        engine.scene.clear()
        engine.scene.add(model)
        camera = engine.window.camera
        camera.view_angle = FOV
        camera.reset_to_bounds()
        camera.azimuth(AZIMUTH)
        camera.elevation(ELEVATION)
        engine.window.render_to_image(False).save(picture)

    return draw


def open3d_pictures(size, hdr):
    """Open3D's OffscreenRenderer (Filament) with the image-based light that comes with it."""
    os.environ.setdefault("EGL_PLATFORM", "surfaceless")
    os.environ.setdefault("OPEN3D_CPU_RENDERING", "true")
    import numpy as np
    import open3d

    renderer = open3d.visualization.rendering.OffscreenRenderer(size, size)
    scene = renderer.scene
    scene.scene.enable_indirect_light(True)
    scene.scene.set_indirect_light_intensity(37500)
    scene.scene.enable_sun_light(False)

    def draw(model, picture):
        scene.clear_geometry()
        scene.add_model("model", open3d.io.read_triangle_model(model))
        box = scene.bounding_box
        low, high = np.asarray(box.min_bound), np.asarray(box.max_bound)
        center = (low + high) / 2
        place = eye(center, distance(low, high), AZIMUTH)
        renderer.setup_camera(FOV, *(np.float32(point) for point in (center, place, (0, 1, 0))))
        open3d.io.write_image(picture, renderer.render_to_image())

    return draw


def distance(low, high):
    """From which the sphere about the box fills the view."""
    return 0.8 * math.dist(low, high) / 2 / math.sin(math.radians(FOV / 2))


def eye(center, away, azimuth):
    turned, raised = math.radians(azimuth), math.radians(ELEVATION)
    direction = math.cos(raised) * math.sin(turned), math.sin(raised), math.cos(raised) * math.cos(turned)
    return [float(middle) + away * step for middle, step in zip(center, direction)]


def main():
    program, names, size, out, told, hdr = sys.argv[1:7]
    draw = {"pyrender": pyrender_pictures, "f3d": f3d_pictures, "open3d": open3d_pictures}[program](int(size), hdr)
    with Path(told).open("w") as lines:
        for number, model in enumerate(Path(names).read_text().splitlines()):
            error = None
            try:
                draw(model, str(Path(out) / f"{number}.png"))
            except Exception as problem:  # whatever a library raises for a file that it cannot use
                error = f"{type(problem).__name__}: {problem}"[:200]
            print(json.dumps({"model": model, "error": error}), file=lines, flush=True)


if __name__ == "__main__":
    main()
