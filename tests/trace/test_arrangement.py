"""Paths that lie in the order of their classes (viewer/trace/paths/arrangement.py): each keeps its home, and pictures
and layers are those of paths that never move, to the bit."""

from __future__ import annotations

import numpy as np
import pytest
from needs import needs
from shapes import lopsided

import viewer
from viewer.base.resources import resource_folder
from viewer.scene.camera import Camera
from viewer.settings import Settings
from viewer.trace.layout import NO_KIND, TILE
from viewer.trace.paths.arrangement import Arrangement
from viewer.trace.paths.run import run
from viewer.trace.rays.embree import EmbreeIntersector
from viewer.trace.rays.intersect import CLASS_OF_IDLE
from viewer.trace.tracer import Tracer

pytestmark = needs("embree")
GRID = 2, 3
COUNT = GRID[0] * GRID[1] * TILE**2


@pytest.mark.parametrize("seed", range(4))
def test_each_path_keeps_its_home(context, seed):
    """Paths of blocks that begin, are sorted and end, followed by the home that each has in a column of its own."""
    context.make_current()
    rng = np.random.default_rng(seed)
    arrangement = Arrangement(context.gl, GRID, finds_places=False)
    width = GRID[0] * TILE
    block_of = np.empty(COUNT, int)
    block_of[arrangement.homes_of] = np.arange(GRID[0] * GRID[1])[:, None]
    path = np.full(COUNT, -1)  # the home of the path in each texel, -1: idle
    for _ in range(30):
        blocks = np.flatnonzero(~arrangement.alive)[:arrangement.room][:rng.integers(0, 4)]
        if len(blocks):
            row, rows = arrangement.begin(blocks)
            begun = arrangement.homes(row, rows)
            assert (path[row * width:] == -1).all() and np.isin(arrangement.homes_of[blocks], begun).all()
            path[row * width:(row + rows) * width] = begun
        shown = path[:arrangement.rows * width]
        alive = shown >= 0
        assert (shown[alive] == arrangement.homes(0, arrangement.rows)[alive]).all()
        classes = np.where(alive, rng.integers(0, NO_KIND + 1, len(shown)), CLASS_OF_IDLE).astype(np.uint8)
        order = np.argsort(classes, kind="stable")
        blocks_alive = np.unique(block_of[shown[alive]])
        arrangement.sort(classes, order)
        ended, row = classes[order] == NO_KIND, np.arange(len(order)) // width
        first, rows = arrangement.ended_rows
        assert ((row[ended] >= first) & (row[ended] < first + rows)).all()
        path[:] = -1
        path[:len(shown)] = shown[order]
        path[:len(shown)][ended & (rng.random(len(order)) < 0.6)] = -1  # those that have no sample left
        arrangement.advance()
        arrangement.find_alive()
        assert (np.flatnonzero(arrangement.alive) == blocks_alive).all()
        assert (path[arrangement.rows * width:] == -1).all()
        assert (np.sort(arrangement.homes(0, GRID[1] * TILE)) == np.arange(COUNT)).all()
    arrangement.release()


@pytest.mark.parametrize("layers", [(), ("albedo", "normal")])
def test_pictures_are_those_of_paths_that_never_move(context, monkeypatch, layers):
    scene = viewer.load(resource_folder("assets") / "scenes" / "glass.glb", environment=None)
    scene = scene.relit(environment=lopsided(), lights=scene.lights)
    camera = Camera.framing(scene.center, scene.radius, 1.0)
    pictures = []
    for tells in (True, False):
        monkeypatch.setattr(EmbreeIntersector, "tells_classes", tells)
        tracer = Tracer(context, intersector="embree")
        path_render = tracer.begin(scene, camera, Settings.of(mode="path", spp=6), (40, 24), layers)
        assert path_render.plan.is_sorted == tells
        run(path_render, 0.0)
        image = path_render.image()
        pictures.append([image.linear, *image.layers.values()])
        path_render.release()
        tracer.release()
    assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(*pictures, strict=True))


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
