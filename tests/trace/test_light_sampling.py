"""Light samples: how often each light is chosen, and that estimates agree with float64."""

from __future__ import annotations

import io

import numpy as np
import pytest
from harness import evaluate
from PIL import Image

from viewer.measure.check.chi_squared import critical_value, statistic
from viewer.plan.bsdf_switches import bsdf_switches
from viewer.scene.environment import Environment
from viewer.scene.light import BRIGHTEST, Light
from viewer.scene.material import Material, Texture
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Instance, Scene
from viewer.scene.texture_image import open_texture_image
from viewer.settings import Settings
from viewer.trace.scene.emitters import find_emitters
from viewer.trace.scene.geometry import trace_geometry
from viewer.trace.scene.lights import LEAST_SHARE, SceneLights, light_table
from viewer.trace.scene.punctual import LightColumns
from viewer.trace.scene.scene_data import SceneData

QUAD = np.array([[-1, 0, -1], [-1, 0, 1], [1, 0, 1], [1, 0, -1]], np.float32)  # counter-clockwise from +Y
QUAD_INDICES = np.array([0, 1, 2, 0, 2, 3], np.uint32)


def scene_of(*placed: tuple[Material, np.ndarray], **others) -> Scene:
    """The quad with each of the materials, placed by each of the (4, 4) matrices."""
    uv = np.array([[0.1, 0.1], [0.1, 0.9], [0.9, 0.9], [0.9, 0.1]], np.float32)
    normals = np.tile(np.array([0, 1, 0], np.float32), (4, 1))
    meshes = tuple(Mesh("quad", QUAD, k, indices=QUAD_INDICES, uvs=(uv,), normals=normals) for k in range(len(placed)))
    instances = tuple(Instance(k, transform) for k, (_, transform) in enumerate(placed))
    return Scene("lights", meshes, tuple(material for material, _ in placed), instances, **others)


def place(x: float, y: float, z: float, scale=(1.0, 1.0, 1.0), turn: float = 0.0) -> np.ndarray:
    """Scaled, turned about Z, moved."""
    c, s = np.cos(turn), np.sin(turn)
    matrix = np.eye(4)
    matrix[:3, :3] = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) * scale
    matrix[:3, 3] = x, y, z
    return matrix


FLOOR = (Material("floor"), place(0, -1, 0, (3, 1, 3)))


class Lit:
    """A scene's lights on the GPU."""

    def __init__(self, context, folder, scene: Scene, **settings) -> None:
        self.context, self.folder, self.scene, self.geometry = context, folder, scene, trace_geometry(scene)
        self.data = SceneData(context, scene, self.geometry)
        self.lights = SceneLights(context, scene, self.geometry, self.data.buffer, Settings(**settings))
        self.data.upload()

    def run(self, body: str, inputs: np.ndarray) -> np.ndarray:
        def bind(program) -> None:
            self.data.bind(program)
            self.lights.use_textures()
            self.lights.set_uniforms(program)
        switches = self.data.switches | self.lights.switches | bsdf_switches(Settings())
        return evaluate(self.context, self.folder, "trace/lights.glsl", body, inputs.astype(np.float32), 2, switches,
                        bind)

    def samples(self, p, count: int = 100000, seed: int = 1) -> dict[str, np.ndarray]:
        """Light samples for one point (3,) in the world; distances are in tracer units."""
        x, y, z = self.to_tracer(np.asarray(p, np.float64))
        u = np.random.default_rng(seed).integers(0, 1 << 24, (count, 3)) / 2**24
        found = self.run(f"LightSample s = sample_light(vec3({x:.9f}, {y:.9f}, {z:.9f}), vec3(0.0), f0.xyz);"
                         "o0 = vec4(s.direction, s.distance); o1 = vec4(s.radiance, s.is_delta ? -s.pdf : s.pdf);", u)
        return {"direction": found[:, 0, :3], "distance": found[:, 0, 3], "radiance": found[:, 1, :3],
                "pdf": np.abs(found[:, 1, 3]), "is_delta": found[:, 1, 3] < 0}

    def to_tracer(self, p: np.ndarray) -> np.ndarray:
        return (p - self.scene.center) / self.scene.radius

    def irradiance(self, p, normal, count: int = 200000) -> tuple[float, float]:
        """The irradiance of a plane (green channel), and its standard deviation."""
        s = self.samples(p, count)
        cos = np.maximum(s["direction"] @ np.asarray(normal, np.float64), 0)
        estimates = np.where(s["pdf"] > 0, s["radiance"][:, 1] * cos / np.where(s["pdf"] > 0, s["pdf"], 1), 0)
        return float(estimates.mean()), float(estimates.std() / np.sqrt(count))


def rectangle_irradiance(corners: np.ndarray, p: np.ndarray, normal: np.ndarray, radiance: float) -> float:
    """The irradiance of a plane from a polygon above its horizon, by the angles of the edges (Lambert 1760)."""
    v = corners - p
    v = v / np.linalg.norm(v, axis=1, keepdims=True)
    following = np.roll(v, -1, axis=0)
    axis = np.cross(v, following)
    axis /= np.linalg.norm(axis, axis=1, keepdims=True)
    angle = np.arccos(np.clip((v * following).sum(axis=1), -1, 1))
    return radiance / 2 * abs(float((angle[:, None] * axis).sum(axis=0) @ normal))


@pytest.mark.parametrize("scale", [1.0, 1e-6, 1e6])
def test_point_light(context, tmp_path, scale):
    """Irradiance is I / d^2 at any scale, with the window of the range."""
    floor = Material("floor"), np.diag([scale, scale, scale, 1.0])
    light = Light("point", (1, 0.5, 0.25), 7 * scale**2, (0.3 * scale, 2 * scale, 0.1 * scale), range=5 * scale)
    lit = Lit(context, tmp_path, scene_of(floor, lights=(light,)))
    s = lit.samples((0, 0, 0), 100)
    d = np.array(light.position)
    distance = np.linalg.norm(d)
    assert s["is_delta"].all() and (s["pdf"] == 1).all()
    assert np.allclose(s["direction"], d / distance, atol=1e-6)
    assert np.allclose(s["distance"] * lit.scene.radius, distance, rtol=1e-6)
    expected = 7 * scale**2 / distance**2 * (1 - (distance / 5 / scale) ** 4)
    assert np.allclose(s["radiance"], np.multiply(expected, (1, 0.5, 0.25)), rtol=1e-5)
    beyond = Lit(context, tmp_path, scene_of(floor, lights=(light,))).samples((4 * scale, -4 * scale, 0), 10)
    assert (beyond["pdf"] == 0).all()


def test_directional_and_spot(context, tmp_path):
    spot = Light("spot", intensity=10, position=(0, 3, 0), direction=(0, -1, 0), inner_cone=0.2, outer_cone=0.5)
    sun = Light("directional", intensity=2, direction=(0.6, -0.8, 0))
    lit = Lit(context, tmp_path, scene_of(FLOOR, lights=(spot, sun)))
    s = lit.samples((0.9, 0, 0))
    is_sun = s["distance"] > 3.9
    sun_distance = s["distance"][is_sun]  # no two shadow rays are the same
    assert (sun_distance >= 4).all() and (sun_distance <= 4.04).all()
    assert np.allclose(s["direction"][is_sun], (-0.6, 0.8, 0), atol=1e-6) and np.allclose(s["radiance"][is_sun], 2)
    angle = np.arctan2(0.9, 3)
    attenuation = ((np.cos(angle) - np.cos(0.5)) / (np.cos(0.2) - np.cos(0.5))) ** 2
    assert np.allclose(s["radiance"][~is_sun], 10 / 9.81 * attenuation, rtol=1e-4)
    assert s["pdf"][is_sun][0] + s["pdf"][~is_sun][0] == pytest.approx(1, abs=1e-6)
    assert is_sun.mean() == pytest.approx(s["pdf"][is_sun][0], abs=0.01)
    assert (lit.samples((2.9, 0, 0), 2000)["distance"] >= 4)[lit.samples((2.9, 0, 0), 2000)["pdf"] > 0].all()


def test_no_lights(context, tmp_path):
    """Without lights, or if none reaches the scene, their code is left out and a line says so."""
    counts = {"FIRST_CANDIDATES", "LATER_CANDIDATES"}  # of light samples, which are not 0 without lights
    lit = Lit(context, tmp_path, scene_of(FLOOR))
    assert {name for name, value in lit.lights.switches.items() if value} == counts and not lit.lights.left_out
    far = Light("point", position=(100, 0, 0), range=10)
    black = Environment("black", np.zeros((4, 8, 3), np.float32))
    lit = Lit(context, tmp_path, scene_of(FLOOR, lights=(far, Light("directional", intensity=0)), environment=black))
    assert {name for name, value in lit.lights.switches.items() if value} == counts and len(lit.lights.left_out) == 2
    assert (lit.samples((0, 0, 0), 10)["pdf"] == 0).all()
    off = Environment("off", np.ones((4, 8, 3), np.float32), intensity=0.0)
    assert not Lit(context, tmp_path, scene_of(FLOOR, environment=off)).lights.switches["HAS_ENVIRONMENT"]


def test_many_lights(context, tmp_path):
    """1e5 lights of many powers are each chosen as often as their probability says. The probabilities sum to 1."""
    random = np.random.default_rng(3)
    candela = random.exponential(size=100000) ** 3 + 1e-9
    positions = np.c_[(np.arange(100000) + 0.5) * 1e-5, np.full(100000, 2.0), np.zeros(100000)]
    lights = tuple(Light("point", intensity=float(i), position=tuple(p)) for i, p in zip(candela, positions.tolist()))
    lit = Lit(context, tmp_path, scene_of(FLOOR, lights=lights))
    s = lit.samples((0, -1, 0), 200000)
    world = s["direction"] * s["distance"][:, None] * lit.scene.radius + (0, -1, 0)
    group = np.clip((world[:, 0] * 100).astype(int), 0, 99)
    expected = np.bincount(np.arange(100000) // 1000, LightColumns.of(lights, lit.scene).powers)
    observed = np.bincount(group, minlength=100)
    value, degrees = statistic(observed.astype(float), expected / expected.sum() * len(group))
    assert value < critical_value(degrees, 1)
    estimates = s["radiance"][:, 0] / s["pdf"]
    exact = (candela / ((positions - (0, -1, 0)) ** 2).sum(axis=1)).sum()
    assert estimates.mean() == pytest.approx(exact, rel=2e-3)


def test_light_table():
    texels = light_table(np.array([1.0, 0.0, 3.0, 2.0, 2.0]), 0.5)
    probability = texels[:, 2].view(np.float32)
    assert len(texels) == 6 and np.allclose(probability, [1 / 16, 0, 3 / 16, 1 / 8, 1 / 8, 0], rtol=1e-6)
    assert (texels[:, 3].view(np.float32) == probability[texels[:, 1]]).all()


@pytest.mark.parametrize("is_mirrored", [False, True])
def test_emitter(context, tmp_path, is_mirrored):
    """A lamp above a plane, scaled and rotated, gives the irradiance of Lambert's formula, and emitter_pdf is its
    pdf."""
    lamp = place(0.5, 2, 0.2, (-0.7 if is_mirrored else 0.7, 1, 0.4), np.pi + 0.3)
    lit = Lit(context, tmp_path, scene_of(FLOOR, (Material("lamp", emissive=(3, 5, 2)), lamp)))
    assert lit.lights.switches["HAS_EMITTERS"] and not lit.lights.switches["HAS_PUNCTUAL"]
    corners = QUAD @ lamp[:3, :3].T + lamp[:3, 3]
    expected = rectangle_irradiance(corners, np.zeros(3), np.array([0, 1, 0]), 5)
    found, error = lit.irradiance((0, 0, 0), (0, 1, 0))
    assert error < 0.01 * expected and abs(found - expected) < 4.5 * error
    s = lit.samples((0, 0, 0))
    assert not s["is_delta"].any()
    # As the density integrates to 1, the mean of 1 / pdf is the solid angle.
    omega = (1 / s["pdf"]).mean()
    p = s["direction"] * s["distance"][:, None]
    area = 4 * 0.7 * 0.4 / lit.scene.radius**2
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    cos = np.abs(s["direction"] @ (normal / np.linalg.norm(normal)))
    assert np.allclose(s["pdf"], (p**2).sum(axis=1) / (area * cos), rtol=1e-4)
    assert omega == pytest.approx((area * cos / (p**2).sum(axis=1)).mean(), rel=1e-4)
    again = lit.run("o0 = vec4(emitter_pdf(1, f0.x, vec3(0.0), vec3(0.0), f0.y, f0.z)); o1 = f0;",
                    np.c_[np.full(len(cos), area / 2), s["distance"], cos])[:, 0, 0]
    assert np.allclose(again, s["pdf"], rtol=1e-4)


def test_emitter_sides(context, tmp_path):
    """The back emits only for double-sided materials. Unlit triangles and those without area are no lights."""
    up = place(0, 2, 0)  # emits upwards, away from the floor
    lamp, both = Material(emissive=(1, 1, 1)), Material(emissive=(1, 1, 1), double_sided=True)
    assert (Lit(context, tmp_path, scene_of(FLOOR, (lamp, up))).samples((0, 0, 0), 100)["pdf"] == 0).all()
    assert (Lit(context, tmp_path, scene_of(FLOOR, (both, up))).samples((0, 0, 0), 100)["pdf"] > 0).all()
    unlit, flat = Material(emissive=(1, 1, 1), unlit=True), place(0, 2, 0, (0, 1, 0))
    for nothing in ((unlit, up), (lamp, flat)):
        assert not Lit(context, tmp_path, scene_of(FLOOR, nothing)).lights.switches["HAS_EMITTERS"]
    alone = Lit(context, tmp_path, scene_of(FLOOR, (lamp, up)), lobes="specular")
    assert not alone.lights.switches["HAS_EMITTERS"]


def test_mixture(context, tmp_path):
    """Environment, sun, point light and lamp together give the sum of each alone.

    Densities include the choice of light.
    """
    lamp = Material(emissive=(2, 2, 2)), place(0, 2, 0, (0.5, 1, 0.5), np.pi)
    sun = Light("directional", intensity=1.5, direction=(0, -1, 0))
    point = Light("point", intensity=4, position=(-1, 1, 0))
    environment = Environment("sky", np.full((8, 16, 3), 0.3, np.float32))
    lit = Lit(context, tmp_path, scene_of(FLOOR, lamp, lights=(sun, point), environment=environment))
    corners = QUAD @ lamp[1][:3, :3].T + lamp[1][:3, 3]
    expected = (rectangle_irradiance(corners, np.zeros(3), np.array([0, 1, 0]), 2) + 1.5 + 4 / 2 / np.sqrt(2)
                + 0.3 * np.pi)
    found, error = lit.irradiance((0, 0, 0), (0, 1, 0))
    assert error < 0.01 * expected and abs(found - expected) < 4.5 * error
    s = lit.samples((0, 0, 0))
    is_environment = ~s["is_delta"] & (s["distance"] == 4)
    share = is_environment.mean()
    assert LEAST_SHARE - 0.01 < share < 1 - LEAST_SHARE + 0.01
    pdf = lit.run("o0 = vec4(environment_pdf(f0.xyz)); o1 = f0;", s["direction"][is_environment])[:, 0, 0]
    assert np.allclose(pdf, s["pdf"][is_environment], rtol=1e-5)
    assert share == pytest.approx(pdf[0] * 4 * np.pi, abs=0.01)


def test_share_of_a_weak_environment(context, tmp_path):
    sun = Light("directional", intensity=1e6, direction=(0, -1, 0))
    weak = Environment("weak", np.full((4, 8, 3), 1e-6, np.float32))
    s = Lit(context, tmp_path, scene_of(FLOOR, lights=(sun,), environment=weak)).samples((0, 0, 0))
    assert s["is_delta"].mean() == pytest.approx(1 - LEAST_SHARE, abs=0.01)


@pytest.mark.parametrize("radius", [1e-3, 0.5])
def test_light_radius(context, tmp_path, radius):
    """A light with a radius: a surface that faces all of it has the irradiance of a point light.

    Samples are on its near side.
    """
    light = Light("point", intensity=6, position=(0.0, 2.0, 0.0))
    lit = Lit(context, tmp_path, scene_of(FLOOR, lights=(light,)), light_radius=radius)
    assert lit.lights.switches["LIGHT_RADIUS"]
    found, error = lit.irradiance((0, 0, 0), (0, 1, 0))
    assert found == pytest.approx(6 / 4, abs=4.5 * error + 1e-5)
    s = lit.samples((0, 0, 0), 10000)
    points = s["direction"] * s["distance"][:, None] * lit.scene.radius
    assert np.abs(np.linalg.norm(points - (0, 2, 0), axis=1) - radius).max() < 2e-4
    assert (points[:, 1] <= 2).all() and s["is_delta"].all()
    assert (lit.samples((0, 2 - radius / 2, 0), 10)["pdf"] == 0).all()


def picture(pixels: np.ndarray) -> Texture:
    stream = io.BytesIO()
    Image.fromarray(pixels).save(stream, "PNG")
    return Texture(open_texture_image(stream.getvalue(), "emissive.png"))


@pytest.mark.parametrize("side", [64, 3000])
def test_textured_emitters(side):
    """A triangle's power follows the texture: 0 where it is black, else by the mean over the triangle's box."""
    pixels = np.zeros((side, side, 3), np.uint8)
    pixels[: side // 2] = 255
    uv = np.array([[[0.1, 0.1], [0.4, 0.1], [0.1, 0.4]], [[0.1, 0.6], [0.4, 0.6], [0.1, 0.9]],
                   [[0.1, 0.3], [0.4, 0.3], [0.1, 0.7]], [[5.1, -2.9], [5.4, -2.9], [5.1, -2.6]],
                   [[0.5, 0.1], [1.5, 0.1], [0.5, 0.4]]], np.float32)
    positions = np.tile(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32), (5, 1))
    material = Material(emissive=(1.0, 1.0, 1.0), emissive_texture=picture(pixels))
    mesh = Mesh("five", positions, 0, normals=positions * 0 + np.float32([0, 0, 1]), uvs=(uv.reshape(-1, 2),))
    scene = Scene("textured", (mesh,), (material,), (Instance(0, np.eye(4)),))
    records, found = find_emitters(scene, trace_geometry(scene))
    found /= np.pi * 0.5 / scene.radius**2
    assert records[:, 1].tolist() == [0, 1, 2, 3, 4]
    assert found[[0, 3, 4]] == pytest.approx([1, 1, 0.5], abs=1e-6) and found[1] == 0
    assert 0.4 < found[2] < 0.6


def test_million_emitters():
    """Emitters are found without a loop over triangles. Their powers sum to that of the area."""
    n = 707
    x, y = np.meshgrid(np.linspace(-1, 1, n + 1), np.linspace(-1, 1, n + 1), indexing="ij")
    positions = np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3).astype(np.float32)
    a = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    indices = np.stack([a, a + n + 1, a + 1, a + 1, a + n + 1, a + n + 2], axis=1).ravel().astype(np.uint32)
    normals = np.tile(np.array([0, 0, 1], np.float32), (len(positions), 1))
    scene = Scene("many", (Mesh("grid", positions, 0, indices=indices, normals=normals),),
                  (Material(emissive=(2, 2, 2)),), (Instance(0, np.eye(4)),))
    records, found = find_emitters(scene, trace_geometry(scene))
    assert len(records) == 2 * n * n and found.sum() == pytest.approx(np.pi * 2 * 4 / 2, rel=1e-5)


def test_extreme_powers(context, tmp_path):
    """Lights and scenes of any size give finite numbers.

    The brightest light gets the samples, the environment its share.
    """
    lights = tuple(Light("point", intensity=i, position=(0, 2e-9, 0)) for i in (1e300, 1e-300, 1.0))
    floor = Material("floor"), np.diag([1e-9, 1e-9, 1e-9, 1.0])
    sky = Environment("sky", np.full((2, 4, 3), 1e-30, np.float32))
    s = Lit(context, tmp_path, scene_of(floor, lights=lights, environment=sky)).samples((0, 0, 0), 10000)
    assert np.isfinite(s["radiance"]).all() and np.isfinite(s["pdf"]).all()
    assert s["is_delta"].mean() == pytest.approx(1 - LEAST_SHARE, abs=0.03)


def test_a_light_beyond_float32_leaves_room_for_highlights():
    lights = tuple(Light(kind, intensity=1e200) for kind in ("directional", "point", "spot"))
    assert (LightColumns.of(lights, scene_of(FLOOR)).texels[1::3, :3] == np.float32(BRIGHTEST)).all()
