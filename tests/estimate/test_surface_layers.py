"""Layers of both renderers: what surface a pixel shows, against rays in float64 (docs/layers.md)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from command_line import SCENES
from images import image_of
from shapes import constant, moved, orthographic, plate, scene, sphere

import viewer
from viewer.errors import UsageError
from viewer.raster.curves import halves
from viewer.scene.camera import Camera
from viewer.scene.curves import Curves
from viewer.scene.frame import Frame
from viewer.scene.material import Material, Texture
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Instance, Scene
from viewer.scene.triangles import triangles_of
from viewer.settings import SURFACE_LAYERS

MODEL = SCENES / "arm.glb"
SIZE = (24, 20)
RED = Material(base_color=(0.8, 0.1, 0.1, 1.0), metallic=0.0, perceptual_roughness=0.6)
UNLIT = Material(base_color=(0.2, 0.4, 0.6, 1.0), unlit=True)


def turned(degrees: float, axis: int = 1) -> np.ndarray:
    matrix, (c, s) = np.eye(4), (np.cos(np.radians(degrees)), np.sin(np.radians(degrees)))
    a, b = [k for k in range(3) if k != axis]
    matrix[a, a], matrix[a, b], matrix[b, a], matrix[b, b] = c, -s, s, c
    return matrix


def second_uv(mesh: Mesh) -> Mesh:
    return replace(mesh, uvs=(np.zeros_like(mesh.uvs[0]), mesh.uvs[0] * 3))


def model(scale: float = 1.0, offset=(0.0, 0.0, 0.0)) -> Scene:
    """A plate that is turned, one with its colour by the second UV set, and a coarse ball without light."""
    textured = replace(RED, base_color_texture=Texture(image_of(np.full((8, 16, 3), 200, np.uint8)), uv_set=1))
    place = moved(offset, scale)
    return scene((plate(), place @ turned(25) @ moved((-0.4, 0, 0))),
                 (second_uv(plate(1)), place @ moved((0.7, 0.3, -0.8)) @ turned(-30, 0)),
                 (sphere(2, segments=10), place @ moved((0.2, -0.5, 0.6), 0.4)),
                 materials=(RED, textured, UNLIT), environment=constant())


def rays(camera: Camera, size: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Where the rays through the pixels' centres begin, and their directions, 1 long along the view, (N, 3) each."""
    x, y = ((2 * np.arange(count) + 1) / count - 1 for count in size)
    y, x = (grid.ravel() for grid in np.meshgrid(-y, x, indexing="ij"))
    right, up = camera.pose[:3, 0], camera.pose[:3, 1]
    half = np.tan(camera.fov_y / 2) if camera.height is None else camera.height / 2
    across = (x * size[0] / size[1])[:, None] * half * right + y[:, None] * half * up
    if camera.height is None:
        return np.broadcast_to(camera.eye, across.shape), camera.forward + across
    return camera.eye + across, np.broadcast_to(camera.forward, across.shape)


def twin(shown: Scene, camera: Camera, size: tuple[int, int]) -> dict[str, np.ndarray]:
    """The layers by rays and triangles in float64 (Moeller and Trumbore 1997), and how surely a pixel is inside of a
    triangle: its least barycentric coordinate."""
    origin, direction = rays(camera, size)
    found = {"depth": np.full(len(origin), np.inf), "inside": np.full(len(origin), 1.0)}
    found |= {name: np.zeros(len(origin), np.uint32) for name in ("instance", "material")}
    found |= {name: np.zeros((len(origin), count)) for name, count in (("position", 3), ("normal", 3), ("uv", 2))}
    for number, instance in enumerate(shown.instances):
        mesh = shown.meshes[instance.mesh]
        world = mesh.positions.astype(np.float64) @ instance.transform[:3, :3].T + instance.transform[:3, 3]
        normals = mesh.normals @ np.linalg.inv(instance.transform[:3, :3])
        texture = shown.materials[mesh.material].base_color_texture
        chosen = 0 if texture is None else texture.uv_set
        uv = mesh.uvs[chosen] if chosen < len(mesh.uvs) else np.zeros((len(world), 2))
        for corners in triangles_of(mesh):
            a, b, c = world[corners]
            p = np.cross(direction, c - a)
            determinant = p @ (b - a)
            with np.errstate(divide="ignore", invalid="ignore"):
                u = ((origin - a) * p).sum(axis=1) / determinant
                q = np.cross(origin - a, b - a)
                v, depth = (direction * q).sum(axis=1) / determinant, q @ (c - a) / determinant
            least = np.minimum(np.minimum(u, v), 1 - u - v)
            hit = (least > 0) & (determinant > 0) & (depth > 0) & (depth < found["depth"])
            near = np.abs(least) < 0.02  # another triangle's edge, whoever is in front
            found["inside"][near & np.isfinite(depth)] = 0.0
            weights = np.stack([1 - u - v, u, v], axis=1)[hit]
            found["depth"][hit] = depth[hit]
            found["position"][hit] = origin[hit] + depth[hit, None] * direction[hit]
            normal = weights @ normals[corners]
            found["normal"][hit] = normal / np.linalg.norm(normal, axis=1, keepdims=True)
            found["uv"][hit] = weights @ uv[corners]
            found["instance"][hit], found["material"][hit] = number + 1, mesh.material + 1
    width, height = size
    return {name: values.reshape(height, width, *values.shape[1:]) for name, values in found.items()}


@pytest.mark.parametrize(("scale", "offset", "height"), [
    (1.0, (0, 0, 0), None), (1.0, (0, 0, 0), 3.0), (1e-6, (1e-3, 0, 0), None), (30.0, (1e6, -2e5, 3e5), None)])
def test_layers_are_those_of_the_first_surface_at_the_pixels_centre(context, scale, offset, height):
    """At a micron, and 1000 km from the origin, too: depth and position lose nothing but what float32 loses on the way
    from the camera."""
    shown = model(scale, offset)
    camera = shown.framing_camera(SIZE[0] / SIZE[1], 0.4, 0.3)
    camera = camera if height is None else replace(camera, height=height * scale)
    layers = viewer.render(shown, SIZE, camera, aov=SURFACE_LAYERS).layers
    expected = twin(shown, camera, SIZE)
    inside = expected["inside"] > 0
    assert inside.mean() > 0.6 and len(np.unique(expected["instance"][inside])) == 4
    assert list(layers) == list(SURFACE_LAYERS)
    assert {name: layer.dtype for name, layer in layers.items() if layer.dtype != np.float32} == {
        "position": np.float64, "instance": np.uint32, "material": np.uint32}
    for name in ("instance", "material"):
        np.testing.assert_array_equal(layers[name][inside], expected[name][inside])
    reach = np.linalg.norm(camera.eye - shown.center)
    direction = rays(camera, SIZE)[1]  # at grazing angles shading normals are bent to the camera's side
    grazing = -(expected["normal"] * (direction / np.linalg.norm(direction, axis=1)[:, None]).reshape(
        *SIZE[::-1], 3)).sum(axis=2) < 0.5
    inside &= ~((expected["instance"] == 3) & grazing)
    for name, bound in (("depth", 1e-6 * reach), ("position", 1e-6 * reach), ("normal", 1e-5), ("uv", 1e-5)):
        np.testing.assert_allclose(layers[name][inside], expected[name][inside], rtol=0, atol=bound, err_msg=name)
    empty = expected["instance"] == 0
    assert np.isposinf(layers["depth"][inside & empty]).all()
    assert all((layers[name][inside & empty] == 0).all() for name in SURFACE_LAYERS if name != "depth")
    assert not layers["motion"].any() and not any(np.isnan(layer).any() for layer in layers.values())


def test_all_modes_have_the_same_layers_where_a_pixel_is_inside_of_one_surface():
    """Albedo and normal of mode path are means over samples, which know nothing of the raster's shaders."""
    kinds = [RED, replace(RED, metallic=1.0), Material(base_color=(0.2, 0.5, 0.3, 1), metallic=0.0, clearcoat=1.0),
             replace(RED, emissive=(0.1, 0.2, 0.0)), UNLIT, replace(RED, transmission=1.0),
             replace(RED, sheen_color=(0.4, 0.4, 0.9), sheen_roughness=0.5), replace(RED, perceptual_roughness=0.2)]
    plates = [(plate(k, 0.49), moved((k % 4 - 1.5, 0.5 - k // 4, 0))) for k in range(len(kinds))]
    shown = scene(*plates, materials=kinds, environment=constant())
    camera, size = orthographic(0.3, 0.2, height=3.6, distance=9.0), (40, 30)
    made = {mode: viewer.render(shown, size, camera, mode=mode, spp=16 if mode == "path" else None,
                                aov=SURFACE_LAYERS).layers for mode in ("pbr", "phong", "path")}
    inside = made["pbr"]["instance"] > 0  # and so are the pixels around
    for axis, way in ((0, 1), (0, -1), (1, 1), (1, -1)):
        inside &= np.roll(made["pbr"]["instance"], way, axis) == made["pbr"]["instance"]
    assert len(np.unique(made["pbr"]["instance"][inside])) == len(kinds)
    for name in SURFACE_LAYERS:
        np.testing.assert_array_equal(made["phong"][name], made["pbr"][name])
        if name in ("albedo", "normal"):
            np.testing.assert_allclose(made["path"][name][inside], made["pbr"][name][inside], atol=2e-3)
        else:
            np.testing.assert_array_equal(made["path"][name], made["pbr"][name])


def test_what_covers_more_than_half_of_a_pixel_counts_and_points_only_where_they_are_shown():
    base = RED.base_color[:3]
    kinds = [replace(RED, base_color=(*base, alpha), alpha_mode=mode) for mode, alpha in (
        ("blend", 0.4), ("blend", 0.6), ("mask", 0.4), ("mask", 0.6))]
    point = Mesh("points", np.float32([[2.0, 0, 0]]), 4, topology="points")
    shown = scene(*((plate(k, 0.45), moved((k - 1.5, 0, 0))) for k in range(4)), (point, np.eye(4)),
                  materials=[*kinds, UNLIT], environment=constant())
    camera, size = orthographic(height=3.0), (64, 32)
    raster, traced = (viewer.render(shown, size, camera, mode=mode, spp=None if mode == "pbr" else 1,
                                    aov=["instance"]).layers["instance"] for mode in ("pbr", "path"))
    assert set(np.unique(raster)) == {0, 2, 4, 5} and set(np.unique(traced)) == {0, 2, 4}


def test_ids_are_whole_however_many_there_are():
    for number in (1, 0xFFFF, 0x10000, (1 << 24) + 1, (1 << 32) - 1):
        low, high = np.float32(halves(number)).astype(np.uint32)
        assert low | high << 16 == number


def test_motion_leads_to_where_the_surface_is_at_the_next_time(renderer):
    """A plate that turns, one that bends, and one that stands, by a camera that stands and by one that moves."""
    shown = scene((plate(), moved((-1.2, 0, 0), 0.5)), (plate(), moved((1.2, 0, 0), 0.5)),
                  (plate(), moved((0, 0, -0.5), 0.5)), materials=(RED,), environment=constant())
    bent = shown.meshes[1].positions + np.float32([[0, 0, 0], [0, 0.2, 0.3], [0, 0, 0], [0.1, 0, 0]])
    there = [moved((-1.2, 0, 0), 0.5) @ turned(20, 2), *(i.transform for i in shown.instances[1:])]
    then = replace(shown, meshes=(shown.meshes[0], replace(shown.meshes[1], positions=bent), shown.meshes[2]),
                   instances=tuple(Instance(k, matrix) for k, matrix in enumerate(there)))
    still = Camera.look_at((0.3, 0.4, 4.0), (0, 0, 0))
    for camera in (still, Camera.look_at((0.6, 0.4, 3.8), (0, 0.1, 0))):
        layers = renderer.layers(shown, still, viewer.Settings(), SIZE, ("motion", "instance", "position"),
                                    (then, camera))
        expected = twin(shown, still, SIZE)
        for number in range(3):
            its = (expected["instance"] == number + 1) & (expected["inside"] > 0)
            if number == 2 and camera is still:
                assert its.any() and (layers["motion"][its] == 0).all()
            moves = followed(shown, then, number, expected["position"][its])
            pixels = on_screen(moves, camera) - on_screen(expected["position"][its], still)
            np.testing.assert_allclose(layers["motion"][its], pixels, atol=2e-4)
        assert not layers["motion"][layers["instance"] == 0].any()


def followed(shown: Scene, then: Scene, number: int, points: np.ndarray) -> np.ndarray:
    """Where these points of a plate are at the next time, by their place in its triangles."""
    world = [s.meshes[number].positions @ s.instances[number].transform[:3, :3].T
             + s.instances[number].transform[:3, 3] for s in (shown, then)]
    moved_to = np.zeros_like(points)
    for corners in triangles_of(shown.meshes[number]):
        a, b, c = world[0][corners]
        weights = np.linalg.lstsq(np.stack([b - a, c - a], axis=1), (points - a).T, rcond=None)[0].T
        weights = np.column_stack([1 - weights.sum(axis=1), weights])
        inside = (weights > -1e-6).all(axis=1)
        moved_to[inside] = weights[inside] @ world[1][corners]
    return moved_to


def on_screen(points: np.ndarray, camera: Camera) -> np.ndarray:
    """The pixels, from the upper left, at which a camera sees these points, (N, 2)."""
    local = (points - camera.eye) @ camera.pose[:3, :3]
    half = SIZE[1] / 2 / np.tan(camera.fov_y / 2)
    return np.stack([SIZE[0] / 2 - local[:, 0] / local[:, 2] * half, SIZE[1] / 2 + local[:, 1] / local[:, 2] * half], 1)


def test_a_curve_has_layers_and_moves(renderer):
    """A straight rod: its number is that after all instances, and it moves as its points do."""
    points = np.float32([[-1, 0, 0], [0, 0, 0], [1, 0, 0]])
    rod = Curves("rod", points, np.full(3, 0.2), np.array([0, 3]), np.array([False]))
    shown = replace(scene((plate(), moved((0, 9, 0))), environment=constant()), curves=(rod,))
    then = replace(shown, curves=(replace(rod, points=points + np.float32([0, 0.25, 0])),))
    camera, size = orthographic(height=2.0), (32, 32)
    found = renderer.layers(shown, camera, viewer.Settings(), size, SURFACE_LAYERS, (then, camera))
    seen = found["instance"] > 0
    assert (found["instance"][seen] == 2).all() and (found["material"][seen] == 2).all()
    assert seen.mean() == pytest.approx(0.2, abs=0.03)
    np.testing.assert_allclose(found["motion"][seen], [[0, -4.0]] * seen.sum(), atol=1e-3)
    middle = found["depth"][15, 16]
    assert middle == pytest.approx(np.linalg.norm(camera.eye) - 0.2, abs=0.01)
    np.testing.assert_allclose(found["position"][15, 16], [0, 0, 0.2], atol=0.04)
    assert found["normal"][15, 16] @ [0, 0, 1] > 0.97 and 0 < found["albedo"][seen].max() <= 1
    same = renderer.layers(shown, camera, viewer.Settings(), size, ("motion",))
    assert not same["motion"].any()


def test_a_picture_without_layers_has_no_program_for_them(context):
    from viewer.raster.renderer import Renderer

    renderer, camera = Renderer(context), orthographic()
    before = renderer.render(model(), camera, viewer.Settings(), SIZE)
    count = len(renderer.programs)
    assert any("(--aov): not requested" in line for line in renderer.plan.left_out)
    renderer.layers(model(), camera, viewer.Settings(), SIZE, ("depth", "instance"))
    assert len(renderer.programs) == count + 1
    again = renderer.render(model(), camera, viewer.Settings(), SIZE)
    np.testing.assert_array_equal(before.linear, again.linear)
    renderer.release()
    layered = viewer.render(model(), SIZE, aov=["depth"]).stats["plan"]
    assert "surface layers" in layered["passes"]
    assert not any("(--aov): not requested" in line for line in layered["left_out"])


def test_files_of_the_command_line_have_the_layers_and_motion_of_the_next_frame(run, folder):
    """An arm that bends; the camera that a turntable turns; and one for which nothing moves."""
    asked = ("render", MODEL, "--size", "24", "--env", "furnace", "--aov", "motion,depth,instance", "-o")
    moves = {"spins.npz": ("--time", "0.5", "--fps", "10"), "turns.npz": ("--turntable", "36"), "stands.npz": ()}
    found = {}
    for name, more in moves.items():
        outcome = run(*asked, name, *more)
        assert (outcome.status, outcome.err) == (0, "")
        found[name] = dict(np.load(folder / name))
        assert set(found[name]) == {"rgba", "motion", "depth", "instance"}
    seen = found["turns.npz"]["instance"] > 0
    assert np.abs(found["turns.npz"]["motion"][seen]).max() > 0.5 and not found["stands.npz"]["motion"].any()
    longest = np.abs(found["spins.npz"]["motion"]).max()
    run(*asked, "slow.npz", "--time", "0.5", "--fps", "20")
    assert longest > 0.2 and np.abs(np.load(folder / "slow.npz")["motion"]).max() == pytest.approx(longest / 2, rel=0.2)


def test_layers_that_a_mode_lacks_are_refused():
    with pytest.raises(UsageError, match="variance and samples: only mode path has samples, not mode phong"):
        viewer.render(model(), SIZE, mode="phong", aov=["variance", "depth", "samples"])


def test_depth_of_a_medium_where_there_is_no_surface_is_the_mean_of_where_rays_collide():
    """In mode path alone: light that enters fog of sigma_t goes 1 / sigma_t on the mean."""
    shown = scene(*((plate(0, 0.5), moved((x, 0, 0))) for x in (-9.0, 9.0)), materials=(RED,), environment=constant())
    camera = Camera.look_at((0, 0, 4.0), (0, 0, 0), fov_y=0.2)
    foggy = {"fog": 3.0, "fog_albedo": (0.1, 0.1, 0.1), "bounces": 1, "mode": "path", "spp": 64}
    depth = viewer.render(shown, (6, 6), camera, aov=["depth"], **foggy).layers["depth"]
    assert depth.mean() == pytest.approx(1 / 3, rel=0.05)
    assert np.isinf(viewer.render(shown, (6, 6), camera, aov=["depth"], fog=3.0).layers["depth"]).all()
    assert Frame(shown, camera, (6, 6)).shows_as(Frame(shown, camera, (6, 6)))
