"""Paths that lie in the order of their classes (viewer/trace/paths/arrangement.py): each keeps its home, and pictures
and layers are those of paths that never move, to the bit."""

from __future__ import annotations

import numpy as np
import pytest
from needs import needs
from shapes import WHITE, constant, facing_floor, lopsided, plate, scene, sphere

import viewer
from viewer.base.resources import resource_folder
from viewer.gpu.float_target import float_target
from viewer.scene.camera import Camera
from viewer.scene.material import Material
from viewer.settings import Settings
from viewer.trace.layout import NO_KIND, TILE
from viewer.trace.paths import coverage, gathered, path_render, wavefront, wavefront_maker
from viewer.trace.paths.arrangement import Arrangement
from viewer.trace.paths.run import run
from viewer.trace.rays.embree import EmbreeIntersector
from viewer.trace.rays.intersect import CLASS_OF_IDLE
from viewer.trace.tracer import Tracer

pytestmark = needs("embree")
GRID = 2, 3
LAMP = Material(emissive=(9.0, 9.0, 9.0), double_sided=True)


@pytest.mark.parametrize("height", [48, 24, 16])
@pytest.mark.parametrize("seed", range(4))
def test_each_path_keeps_its_home(context, seed, height):
    """Paths of blocks that begin, perhaps at few of their homes, are sorted and end, followed by the home that each has
    in a column of its own. There are places for all homes, or for few."""
    context.make_current()
    rng = np.random.default_rng(seed)
    arrangement = Arrangement(context.gl, GRID, height, finds_places=False)
    width, homes = GRID[0] * TILE, GRID[0] * GRID[1] * TILE**2
    block_of = np.empty(homes, int)
    block_of[arrangement.homes_of] = np.arange(GRID[0] * GRID[1])[:, None]
    path = np.full(width * height, -1)  # the home of the path in each texel, -1: idle
    for _ in range(30):
        blocks = np.flatnonzero(~arrangement.alive)[:rng.integers(0, 4)]
        chosen = rng.random((len(blocks), TILE**2)) < rng.choice([0.01, 0.3, 1], (len(blocks), 1))
        fits = chosen.sum(axis=1).cumsum() <= arrangement.room
        blocks, chosen = blocks[fits], chosen[fits]
        if len(blocks):
            row, rows = arrangement.begin(blocks, chosen)
            begun, wanted = arrangement.homes(row, rows), arrangement.homes_of[blocks][chosen]
            assert (path[row * width:] == -1).all() and np.isin(wanted, begun).all()
            assert np.isin(begun, arrangement.homes_of[blocks]).all(), "no path of another block begins again"
            assert len(begun) < len(wanted) + width
            path[row * width:(row + rows) * width] = np.where(np.isin(begun, wanted), begun, -1)
        shown = path[:arrangement.rows * width]
        alive = shown >= 0
        assert (shown[alive] == arrangement.homes(0, arrangement.rows)[alive]).all()
        classes = np.where(alive, rng.integers(0, NO_KIND + 1, len(shown)), CLASS_OF_IDLE).astype(np.uint8)
        order = np.argsort(classes, kind="stable")
        blocks_alive = np.unique(block_of[shown[alive]])
        arrangement.sort(classes)
        ended = classes[order] == NO_KIND
        assert np.flatnonzero(ended).tolist() == list(range(*arrangement.ended))
        for kind in (*range(NO_KIND + 1), CLASS_OF_IDLE):
            drawn = np.zeros((height, width), int)
            for x, y, columns, rows in arrangement.rectangles(kind):
                drawn[y:y + rows, x:x + columns] += 1
            own = (classes[order] == kind)[:arrangement.next_rows * width]
            assert np.flatnonzero(drawn).tolist() == np.flatnonzero(own).tolist() and drawn.max() <= 1
        path[:] = -1
        path[:len(shown)] = shown[order]
        path[:len(shown)][ended & (rng.random(len(order)) < 0.6)] = -1  # those that have no sample left
        arrangement.advance()
        arrangement.find_alive()
        assert (np.flatnonzero(arrangement.alive) == blocks_alive).all()
        assert (path[arrangement.rows * width:] == -1).all()
        assert len(np.unique(arrangement.homes(0, height))) == width * height
    arrangement.release()


@pytest.mark.parametrize("layers", [(), ("albedo", "normal")])
def test_pictures_are_those_of_paths_that_never_move(context, monkeypatch, layers):
    scene = viewer.load(resource_folder("assets") / "scenes" / "glass.glb", environment=None)
    scene = scene.relit(environment=lopsided(), lights=scene.lights)
    camera = Camera.framing(scene.center, scene.radius, 1.0)
    pictures = []
    monkeypatch.setattr(path_render, "LAST_INTERVAL", 1)  # so that blocks are added in one order: as they are done
    monkeypatch.setattr(coverage, "coverage", lambda *seen: None)
    for tells in (True, False):
        monkeypatch.setattr(EmbreeIntersector, "tells_classes", tells)
        tracer = Tracer(context, intersector="embree")
        render = tracer.begin(scene, camera, Settings.of(mode="path", spp=6), (40, 24), layers)
        assert render.plan.is_sorted == render.plan.knows_classes == tells == ("classify" not in render.plan.programs)
        run(render, 0.0)
        image = render.image()
        pictures.append([image.linear, *image.layers.values()])
        render.release()
        tracer.release()
    assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(*pictures, strict=True))


@pytest.mark.parametrize("layers", [(), ("albedo",)])
def test_adaptive_samples_all_come_home(context, monkeypatch, layers):
    """Pixels have the samples that the schedule gave them, each once. With more homes than places the picture is the
    same, but for the order in which blocks are added, and takes fewer iterations."""
    monkeypatch.setattr(wavefront_maker, "SOFTWARE_SIDE", 4)
    monkeypatch.setattr(coverage, "coverage", lambda *seen: None)  # all pixels are traced, so that both begin alike
    model = scene(sphere(segments=32), (plate(1), facing_floor(0.1, y=1.4)), materials=[WHITE, LAMP],
                  environment=constant(0.1))
    camera = Camera.framing(model.center, model.radius, 1.0)
    tracer, films, iterations = Tracer(context, intersector="embree"), [], []
    for more in (1, 2):
        monkeypatch.setattr(wavefront_maker, "MORE_HOMES", more)
        path_render = tracer.begin(model, camera, Settings.of(mode="path", spp=64, error=1e-5), (56, 40), layers)
        given: dict[tuple[int, ...], list[int]] = {}
        next_work = path_render._schedule.next

        def spied(count, is_last, next_work=next_work, given=given):
            work = next_work(count, is_last)
            for item in work:
                for y, x in np.argwhere(np.ones((TILE, TILE)) if item.pixels is None else item.pixels):
                    pixel = given.setdefault((item.tile_y * TILE + y, item.tile_x * TILE + x), [])
                    pixel += range(item.first, item.first + item.samples)
            return work

        path_render._schedule.next = spied
        run(path_render, 0.0)
        count = path_render.film.read_sums()[0][::-1, :, 3]
        for (y, x), numbers in given.items():
            assert sorted(numbers) == list(range(len(numbers)))
            assert y >= 40 or x >= 56 or count[y, x] == len(numbers)
        assert count.sum() == 64 * 56 * 40 and count.max() > 2 * count.min()
        assert path_render.bad_samples == 0
        films.append(path_render.film.read())
        iterations.append(sum(traced.iterations for traced in path_render._wavefronts))
        path_render.release()
    tracer.release()
    np.testing.assert_allclose(films[1], films[0], rtol=1e-5, atol=1e-5)
    assert iterations[1] == iterations[0] if layers else iterations[1] < 0.9 * iterations[0]


def test_pixels_without_geometry_take_no_place(context, monkeypatch):
    """So the samples of the others are in flight at once, and the picture is that of blocks with all their pixels."""
    model = scene(sphere(segments=32), (plate(1), facing_floor(0.1, y=1.4)), materials=[WHITE, LAMP],
                  environment=constant(0.1))
    camera = Camera.framing(model.center, model.radius, 1.0)
    tracer, pictures, most = Tracer(context, intersector="embree"), [], []
    for side in (4, 16):  # a larger one holds all pixels
        monkeypatch.setattr(wavefront_maker, "SOFTWARE_SIDE", side)
        path_render = tracer.begin(model, camera, Settings.of(mode="path", spp=16), (48, 48))
        begun, shown = [], []
        while not path_render.is_done:
            path_render.step(0.0)
            begun.append(max(int(traced.wavefront.is_busy.sum()) for traced in path_render._wavefronts))
            shown.append(path_render.samples)
            assert len(shown) < 1000
        assert path_render.bad_samples == 0 and shown[-1] == 16 and (np.diff(shown) >= 0).all()
        most.append(max(begun))
        pictures.append(path_render.read_radiance())
        assert not path_render._sky.covered.all()
        path_render.release()
    tracer.release()
    assert most[0] > 4 * 4, "more blocks than it has texels for"
    np.testing.assert_allclose(*pictures, rtol=1e-5, atol=1e-5)


def test_a_graphics_card_with_embree_keeps_all_samples(context, monkeypatch):
    """Its wavefronts are larger, and their blocks are looked at more seldom; so paths are not sorted there."""
    scene = viewer.load(resource_folder("assets") / "scenes" / "glass.glb", environment=None)
    scene = scene.relit(environment=lopsided(), lights=scene.lights)
    camera = Camera.framing(scene.center, scene.radius, 1.0)
    monkeypatch.setattr(context, "renderer", "a graphics card")
    tracer = Tracer(context, intersector="embree")
    path_render = tracer.begin(scene, camera, Settings.of(mode="path", spp=200, error=0.05), (40, 24))
    run(path_render, 0.0)
    assert path_render.bad_samples == 0
    path_render.release()
    tracer.release()


def test_nothing_is_read_of_what_textures_held_before(tracer, monkeypatch):
    """OpenGL does not say what new textures hold, and those of a sorted wavefront are not cleared."""
    scene = viewer.load(resource_folder("assets") / "scenes" / "glass.glb", environment=None)
    scene = scene.relit(environment=lopsided(), lights=scene.lights)
    camera = Camera.framing(scene.center, scene.radius, 1.0)

    def full(gl, size):
        texture = float_target(gl, size)
        texture.write(np.full((*size, 4), np.nan, np.float32))
        return texture

    pictures = []
    for target in (float_target, full):
        monkeypatch.setattr(wavefront, "float_target", target)
        monkeypatch.setattr(gathered, "float_target", target)
        pictures.append(tracer.render(scene, camera, Settings.of(mode="path", spp=3), (24, 16)).linear)
    assert np.isfinite(pictures[1]).all() and np.array_equal(*pictures)
