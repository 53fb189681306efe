"""Solids of glass that touch or overlap: against closed forms in float64, and against solids that are one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from pictures import picture
from shapes import WHITE, constant, facing_floor, moved, orthographic, plate, scene, sphere
from test_glass import box

import viewer
from viewer.base.resources import resource_folder
from viewer.measure.compare.relmse import reduced
from viewer.plan.warnings import sample_warnings
from viewer.scene.camera import Camera
from viewer.scene.environment import Environment
from viewer.scene.equirect import texel_directions
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Scene
from viewer.settings import Settings
from viewer.trace.scene.geometry import trace_geometry
from viewer.trace.scene.grown import grown
from viewer.trace.scene.nested import GROWTH, with_priorities
from viewer.trace.scene.nesting import Nesting
from viewer.trace.scene.traced_scene import plan_without_device
from viewer.trace.tracer import Tracer

GLASS = Material(metallic=0.0, perceptual_roughness=0.0, transmission=1.0, thickness=1.0, ior=1.5)
WATER = replace(GLASS, ior=1.33, attenuation_distance=0.4, attenuation_color=(0.9, 0.6, 0.2))
ICE = replace(GLASS, ior=1.31)
FAR_SIDE = Environment("far side", (texel_directions(32, 64)[..., 2:] < 0).repeat(3, axis=-1).astype(np.float32))
"""Light comes from the half space z < 0 alone, which is behind what a camera on +z sees."""


def reflectance(cosine: float, ior: float) -> tuple[float, float]:
    """Of an interface with the relative index `ior` behind it, and the cosine behind."""
    inside = 1 - (1 - cosine**2) / ior**2
    if inside <= 0:
        return 1.0, 0.0
    inside = float(np.sqrt(inside))
    s, p = (cosine - ior * inside) / (cosine + ior * inside), (ior * cosine - inside) / (ior * cosine + inside)
    return (s * s + p * p) / 2, inside


def stack(layers: list[tuple[float, float, np.ndarray]], cosine: float) -> tuple[np.ndarray, np.ndarray]:
    """Reflectance and transmittance (3,) of layers in air, each its index, thickness and extinction (3,), by adding one
    after the other (Stokes 1862): R = R1 + T1 R2 T1' / (1 - R1' R2), T = T1 T2 / (1 - R1' R2)."""
    back, front, through, reverse = np.zeros(3), np.zeros(3), np.ones(3), np.ones(3)
    ior = 1.0
    for index, thickness, sigma in (*layers, (1.0, 0.0, np.zeros(3))):
        r, inside = reflectance(cosine, index / ior)
        a = np.exp(-sigma * thickness / max(inside, 1e-9))
        shared = 1 / (1 - back * r)
        front = front + through * r * reverse * shared
        back = (r + (1 - r) ** 2 * back * shared) * a**2
        through, reverse = through * (1 - r) * shared * a, reverse * (1 - r) * shared * a
        ior, cosine = index, inside
    return front, through


@pytest.mark.parametrize("intersector", ["embree", "bvh"])
@pytest.mark.parametrize("overlap", [0.0, 0.01])
def test_water_between_glass_walls(context, intersector, overlap):
    """Walls that touch the water, or overlap it, seen at an angle. Behind the gap of air that would be there otherwise,
    the stack reflects more, and beyond the critical angle all."""
    water = box(3.0, 3.0, 0.1)
    wall = box(3.2, 3.2, 0.05)
    place = 0.15 - overlap
    order = [(wall, moved((0, 0, place))), (water, np.eye(4)), (wall, moved((0, 0, -place)))]
    parts = [(replace(mesh, material=k % 2), matrix) for k, (mesh, matrix) in enumerate(order)]
    model = scene(*parts, materials=[GLASS, WATER], environment=FAR_SIDE)
    tracer = Tracer(context, intersector=intersector)
    angle = 0.9
    seen = picture(tracer, model, orthographic(0.0, angle, height=0.2), (8, 8), spp=64, bounces=24)[..., :3]
    tracer.release()
    sigma = -np.log([0.9, 0.6, 0.2]) / 0.4
    nothing = np.zeros(3)
    _, through = stack([(1.5, 0.1, nothing), (1.33, 0.2 - 2 * overlap, sigma), (1.5, 0.1, nothing)], np.cos(angle))
    assert seen.mean(axis=(0, 1)) == pytest.approx(through, rel=0.012)


def test_nested_balls_in_a_furnace(tracer):
    """Ice in water in glass, all white, in uniform light: whatever is bent, 1 is seen everywhere. Balls that have not
    one middle reflect some light to and fro more often than `bounces` allows. That is lost, but the rest does not weigh
    more for it: with a Russian roulette that ended some paths early, others would weigh more than 1."""
    white = replace(WATER, attenuation_distance=float("inf"))

    def seen(*offsets: tuple[float, float, float]) -> np.ndarray:
        balls = [(sphere(k, 64), moved(offset, radius))
                 for k, (offset, radius) in enumerate(zip(offsets, (1.0, 0.7, 0.4), strict=True))]
        model = scene(*balls, materials=[GLASS, white, ICE], environment=constant())
        return picture(tracer, model, orthographic(0.3, 0.2), (24, 24), spp=32, bounces=64)[..., :3]

    concentric, apart = seen(*[(0, 0, 0)] * 3), seen((0, 0, 0), (0.25, 0.1, 0), (0.5, 0.2, 0.05))
    assert np.abs(reduced(concentric, 6) - 1).max() < 0.03
    assert concentric.mean() == pytest.approx(1.0, abs=3e-3)
    assert apart.mean() == pytest.approx(1.0, abs=5e-3)
    assert apart.max() < 1.001


def test_blocks_of_one_glass_are_one_block(tracer):
    """Two halves that touch, and a ball of the same water within: nothing is seen of either."""
    whole = box(1.0, 0.8, 0.6)
    half = box(0.5, 0.8, 0.6)
    kept = {"environment": FAR_SIDE, "materials": [WATER]}
    view = orthographic(0.5, 0.4, height=3.0)
    found, expected = (picture(tracer, scene(*parts, **kept), view, (24, 16), spp=64)[..., :3] for parts in (
        [(half, moved((-0.5, 0, 0))), (half, moved((0.5, 0, 0))), (sphere(0, 32), moved((0.2, 0, 0), 0.3))], [whole]))
    assert found.mean(axis=(0, 1)) == pytest.approx(expected.mean(axis=(0, 1)), rel=0.01)
    assert np.abs(found - expected).mean() < 0.02 * expected.mean()


def test_a_bubble_in_water_bends_as_air(tracer):
    """A ball of index 1 in a block of water, against a block with a hole: the same triangles, the inner ones facing
    inwards."""
    block, bubble = box(1.0, 1.0, 1.0), sphere(1, 48)
    assert bubble.indices is not None and bubble.normals is not None
    inside_out = bubble.indices.reshape(-1, 3)[:, ::-1].ravel()
    inverted = replace(bubble, material=0, indices=inside_out, normals=-bubble.normals)
    view = orthographic(0.2, 0.3, height=2.5)
    found, expected = (picture(tracer, scene(block, (inner, moved((0, 0, 0), 0.5)), environment=FAR_SIDE,
                                             materials=[WATER, replace(GLASS, ior=1.0)]),
                               view, (24, 24), spp=64)[..., :3] for inner in (bubble, inverted))
    assert found.mean(axis=(0, 1)) == pytest.approx(expected.mean(axis=(0, 1)), rel=0.01)
    assert np.abs(found - expected).mean() < 0.03 * expected.mean()


def test_a_camera_in_water_sees_through_a_ball_of_air(tracer):
    """From inside of both, every way out is along a normal: (1 - R) of the water's boundary, with its reflections."""
    air = replace(GLASS, ior=1.0)
    water = replace(WATER, attenuation_distance=float("inf"))
    model = scene((sphere(0, 96), np.eye(4)), (sphere(1, 96), moved((0, 0, 0), 0.5)), materials=[water, air],
                  environment=constant())
    seen = picture(tracer, model, Camera.look_at((0, 0, 0), (0, 0.3, -1), fov_y=1.0), (8, 8), spp=64, bounces=64)
    assert seen[..., :3].mean() == pytest.approx(1.0, abs=5e-3)


def layers_over_floor(*heights: float) -> Scene:
    """A lamp over a grey floor; between them flat boxes 0.2 high about these heights, with about the index of air."""
    lamp = Light("point", intensity=10.0, position=(0.2, 2.4, 0.1))
    grey = replace(WHITE, base_color=(0.5, 0.5, 0.5, 1.0))
    clear = replace(GLASS, ior=1.0)
    layers = [(replace(box(1.5, 0.1, 1.5), material=1 + k), moved((0, y, 0))) for k, y in enumerate(heights)]
    return scene((plate(0, half=3.0), facing_floor()), *layers, materials=[grey, clear, replace(clear, ior=1.0 + 1e-6)],
                 lights=(lamp,))


def test_photons_go_through_nested_solids(tracer):
    """A lamp over a slab of two layers that touch: with the index of air they are nothing to light."""
    view = Camera.look_at((0, 0.8, 0.8), (0, 0, 0.1), fov_y=np.radians(36))
    found, expected = (picture(tracer, layers_over_floor(*heights), view, (6, 4), spp=256, bounces=8,
                               caustics="photons")[..., :3] for heights in ((1.0, 1.2), ()))
    assert found.mean() == pytest.approx(expected.mean(), rel=0.02)


def test_photons_behind_displaced_boundaries_are_lost(tracer):
    """From above, what they light is seen through both layers alone, and the boundary that is not there is no end."""
    above = Camera.look_at((0, 4, 0.5), (0, 0, 0), fov_y=np.radians(20))
    settings = Settings.of(mode="path", spp=64, caustics="photons")
    image = tracer.render(layers_over_floor(1.0, 1.2), above, settings, (24, 16))
    assert image.stats["photons_lost"] > 0.99


def test_the_tumbler_of_the_assets():
    """Water displaces nothing, glass displaces water, and ice, whose two cubes are one solid, displaces both."""
    model = viewer.load(resource_folder("assets") / "glass" / "tumbler.glb", environment=None)
    ordered = with_priorities(trace_geometry(model))
    assert [index for index, _ in ordered.indices] == [1.0, 1.33, 1.5, 1.31]


def test_smaller_solids_displace_larger_ones():
    """Numbers of media are in the order of volumes, whatever the order in the file; instances of one material that
    overlap are one solid; what touches nothing keeps its mesh."""
    cube = box(0.5, 0.5, 0.5)
    model = scene((replace(cube, material=1), moved((0, 0, 0), 0.2)), (cube, np.eye(4)),
                  (cube, moved((0.9, 0, 0))), (replace(cube, material=2), moved((9, 0, 0))),
                  materials=[WATER, ICE, GLASS])
    plain = trace_geometry(model)
    ordered = with_priorities(plain)
    assert [i.medium for i in ordered.instances] == [3, 1, 1, 2]
    assert [index for index, _ in ordered.indices] == [1.0, 1.33, 1.5, 1.31]
    assert ordered.meshes[ordered.instances[3].mesh] is plain.meshes[plain.instances[3].mesh]
    apart = replace(model, instances=(model.instances[1], model.instances[3]))
    alone = trace_geometry(apart)
    assert with_priorities(alone) is alone
    for scene_, has in ((model, 1), (apart, 0)):
        plan = plan_without_device(scene_, Settings.of(mode="path"))
        assert plan.programs["glass"]["HAS_NESTED"] == has
        assert ("solids of glass that touch or overlap" in plan.used) == has


def test_many_bubbles_are_few_media(count: int = 400):
    """Bubbles and beads of glass, of mixed sizes, in water that touches its glass: a path can be in all three."""
    rng = np.random.default_rng(5)
    cube = box(0.5, 0.5, 0.5)
    places = np.stack(np.meshgrid(*[np.linspace(-0.4, 0.4, 8)] * 3), axis=-1).reshape(-1, 3)[:count]
    sizes = rng.uniform(0.01, 0.05, count)
    air = replace(GLASS, ior=1.0)
    inner = [(replace(cube, material=k % 2), moved(place, size))
             for k, (place, size) in enumerate(zip(places, sizes, strict=True))]
    outer = [(replace(cube, material=2), np.eye(4)), (replace(cube, material=3), moved((0, 0, 0), 1.2))]
    ordered = with_priorities(trace_geometry(scene(*inner, *outer, materials=[air, ICE, WATER, GLASS])))
    media = [instance.medium for instance in ordered.instances]
    assert media[-2:] == [2, 1]
    assert [ordered.indices[medium][0] for medium in media] == [1.0, 1.31] * (count // 2) + [1.33, 1.5]
    assert len(ordered.indices) == len(ordered.media) == 5
    assert ordered.nesting.of([1, 2, 3]) != ordered.nesting.of([2, 3])
    assert ordered.depth == 3 <= ordered.nesting.most


def test_more_glass_in_glass_than_a_path_carries_is_told(count: int = 100):
    """Each of another index. Beside one another, as many are no reason for a warning."""
    cube, glasses = box(0.5, 0.5, 0.5), [replace(GLASS, ior=1.2 + 0.005 * k) for k in range(count)]

    def lines(*transforms: np.ndarray) -> list[str]:
        parts = [(replace(cube, material=k), transform) for k, transform in enumerate(transforms)]
        plan = plan_without_device(scene(*parts, materials=glasses), Settings.of(mode="path"))
        return sample_warnings({"samples": 1, "plan": plan.to_json()})

    (line,) = lines(*(moved((0, 0, 0), 1 + 0.1 * k) for k in range(count)))
    assert line.startswith(f"solids of glass lie in one another {count} deep, but a path can be inside 3 at once")
    assert not lines(*(moved((0.99 * k, 0, 0)) for k in range(count)))


@pytest.mark.parametrize("is_mirrored", [False, True])
def test_faces_grow_by_the_same_distance(is_mirrored):
    """A box, whose corners are three vertices each, stays closed, under any transform."""
    mesh: Mesh = box(1.0, 0.5, 0.25)
    geometry = trace_geometry(scene(mesh, materials=[GLASS]))
    (normalised,) = geometry.meshes
    transform = np.diag([-2.0 if is_mirrored else 2.0, 0.5, 4.0]) @ np.eye(3, 4)
    before, after = (m.positions @ transform[:, :3].T for m in (
        normalised, grown(normalised, transform, is_mirrored, GROWTH)))
    np.testing.assert_allclose(after - before, GROWTH * np.sign(before), atol=4e-7)


def test_the_highest_number_is_the_medium_of_a_path():
    """Whatever the order of entry; and what is left is gone, wherever it stood."""
    nesting = Nesting(4, has_order=True)
    inside = np.array([nesting.of(media) for media in ([], [2], [3, 1], [1, 3, 2], [2, 2])])
    assert nesting.innermost(inside).tolist() == [0, 2, 3, 3, 2]
    left = nesting.cross(inside, np.array([1, 2, 3, 3, 2]), np.zeros(5, bool))
    assert nesting.innermost(left).tolist() == [0, 0, 1, 2, 2]
