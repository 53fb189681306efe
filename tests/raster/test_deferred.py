"""Surfaces that are shaded after all triangles are drawn: OpenGL's multisampling, but of at most two a pixel."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shapes import constant, facing_floor, lopsided, moved, orthographic, plate, scene, sphere

from viewer.raster.numbered_triangles import triangle_planes
from viewer.raster.pixel_boxes import around, cell_corners, pixel_box, pixel_rows
from viewer.scene.camera import Camera
from viewer.scene.frame import Frame
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.mesh import Mesh
from viewer.settings import Settings

SIZE = (40, 32)
SMOOTH = Material(metallic=1.0, perceptual_roughness=0.3, base_color=(0.9, 0.5, 0.2, 1))
ROUGH = Material(metallic=0.0, perceptual_roughness=0.8, base_color=(0.2, 0.4, 0.8, 1), double_sided=True)
SUN = Light("directional", intensity=2.0, direction=(-0.3, -1, -0.4), angular_radius=0.01)
CAMERA = Camera.look_at((1.8, 1.6, 3.2), (0, 0, 0), fov_y=0.8)


def still_life():
    """Smooth and creased surfaces before each other, one of them mirrored."""
    return scene((sphere(0, 24), moved((-0.5, 0.2, 0))), (sphere(1, 16), moved((0.7, 0.1, 0.3), (-0.6, 0.6, 0.6))),
                 (plate(1), facing_floor(1.5, -0.6)), materials=(SMOOTH, ROUGH), lights=(SUN,), environment=lopsided())


def drawn(renderer, model, camera, antialias: str, **settings: object) -> np.ndarray:
    """Linear radiance (H, W, 4)."""
    renderer.draw(model, camera, Settings.of(**{"antialias": antialias} | settings), SIZE, half=False)
    return renderer.read_radiance()


@pytest.mark.parametrize("settings", [{}, {"background": "none"}, {"mode": "phong"}, {"grid": "on"},
                                      {"environment_shadows": "16"}], ids=str)
def test_it_is_the_picture_of_multisampling(renderer, settings):
    model = still_life()
    pictures = []
    for antialias in ("deferred-4", "msaa-4", "none"):
        drawn(renderer, model, CAMERA, antialias, **settings)
        pictures.append(renderer.read_display(Settings.of(**settings)).astype(float))
    deferred, multisampled, none = pictures
    error, jagged = (np.abs(picture - multisampled)[..., :3].mean() for picture in (deferred, none))
    assert 0 < error < 0.2 * jagged, (error, jagged)
    assert np.array_equal(deferred[..., 3], multisampled[..., 3])  # what is covered is not chosen


def test_only_what_may_be_is_deferred(renderer):
    glass = replace(ROUGH, transmission=1.0, thickness=0.2)
    cut, blended = replace(ROUGH, alpha_mode="mask"), replace(ROUGH, alpha_mode="blend", base_color=(1, 1, 1, 0.5))
    model = scene(*((sphere(k, 16), moved((k - 1.5, 0, 0), 0.6)) for k in range(4)),
                  materials=(SMOOTH, glass, cut, blended), environment=constant())
    deferred = drawn(renderer, model, CAMERA, "deferred-4")
    assert [draw.is_deferred for draw in renderer.plan.draws] == [True, False, False, False]
    assert not renderer.plan.is_over_layers  # a solid takes its picture before the background
    multisampled = drawn(renderer, model, CAMERA, "msaa-4")
    assert not renderer.plan.has_deferred
    np.testing.assert_allclose(deferred, multisampled, atol=0.02)
    drawn(renderer, still_life(), CAMERA, "deferred-4")
    assert renderer.plan.is_over_layers and not renderer.plan.has_surfaces
    drawn(renderer, still_life(), CAMERA, "deferred-4", plan="everything")
    assert not renderer.plan.has_deferred


def test_where_buffers_of_texels_are_small_it_multisamples(renderer, monkeypatch):
    """OpenGL 3.3 grants 65536."""
    monkeypatch.setattr("viewer.raster.renderer.most_texels", lambda context: 1 << 16)
    few = drawn(renderer, still_life(), CAMERA, "deferred-4")
    assert not renderer.plan.has_deferred
    assert np.array_equal(few, drawn(renderer, still_life(), CAMERA, "msaa-4"))


@pytest.mark.parametrize("background", ["env", "none"])
def test_what_is_drawn_over_them(renderer, background):
    """Behind surfaces that blend, are cut or transmit light, background and deferred surfaces are mixed at one sample a
    pixel."""
    cut = replace(ROUGH, alpha_mode="mask", base_color=(0.9, 0.1, 0.1, 1))
    blended = replace(ROUGH, alpha_mode="blend", base_color=(0.1, 0.9, 0.1, 0.4))
    pane = replace(ROUGH, transmission=0.9)
    model = scene((sphere(0, 16), moved((0.2, 0, -0.8))), (sphere(1, 16), moved((0.5, 0.3, 0.6), 0.4)),
                  (sphere(2, 16), moved((-0.6, 0, 0.5), 0.7)), (plate(3, 0.4), moved((0.1, -0.5, 1.2))),
                  materials=(SMOOTH, cut, blended, pane), environment=lopsided())
    for part in (None, (3, 5, 21, 17)):  # of another picture's target, too
        pictures = []
        for antialias in ("msaa-4", "none", "deferred-4"):
            settings = Settings.of(antialias=antialias, background=background)
            renderer.draw(model, CAMERA, settings, SIZE, half=False)
            renderer.draw(model, Camera.look_at((1.7, 1.7, 3.2), (0, 0, 0), fov_y=0.8), settings, SIZE, half=False,
                          part=part)
            pictures.append(renderer.read_radiance())
        assert renderer.plan.is_over_layers and renderer.plan.has_surfaces
        msaa, none, deferred = pictures
        error, jagged = (np.abs(picture - msaa).mean() for picture in (deferred, none))
        assert error < 0.2 * jagged, (error, jagged)
        np.testing.assert_allclose(np.median(np.abs(deferred - msaa)), 0, atol=1e-6)


@pytest.mark.parametrize("settings", [{"ground": "shadow"}, {"ground": "shadow", "background": "none"},
                                      {"fog": 0.2, "background": "none"},
                                      {"ground": "shadow", "fog": 0.2, "background": "none"}], ids=str)
def test_what_is_drawn_behind_is_drawn_once_a_pixel(renderer, settings):
    model = replace(still_life(), environment=lopsided())
    msaa, none, deferred = (drawn(renderer, model, CAMERA, antialias, **settings)
                            for antialias in ("msaa-4", "none", "deferred-4"))
    assert renderer.plan.is_over_layers and renderer.plan.has_behind
    without = drawn(renderer, model, CAMERA, "deferred-4", **settings | {"ground": "off", "fog": 0.0})
    assert np.abs(without - deferred).max() > 0.01 * without.max()
    error, jagged = (np.abs(picture - msaa).mean() for picture in (deferred, none))
    assert error < 0.2 * jagged, (error, jagged)
    np.testing.assert_allclose(np.median(np.abs(deferred - msaa)), 0, atol=1e-6)
    drawn(renderer, model, Camera.look_at((0, 1, -4), (0, 0, 0)), "deferred-4")
    again = drawn(renderer, model, CAMERA, "deferred-4", **settings)
    assert np.array_equal(again, deferred)  # with nothing of the picture before


@pytest.mark.parametrize("bits", [22, 3])
def test_a_crease_is_two_surfaces_and_a_bend_is_one(renderer, monkeypatch, bits):
    """Two halves of a roof, each lit by itself. Where they meet at a small angle one of them stands for both.

    The numbers of their triangles, 1 and 2, 5 and 6, fill 3 bits, and differ in the first alone."""
    for module in ("deferred", "numbered_triangles"):
        monkeypatch.setattr(f"viewer.raster.{module}.TRIANGLE_BITS", bits)
    camera = orthographic(0.0, 0.0, 2.0)
    edge = 1 / SIZE[1] + 1e-4  # near a pixel's middle, where the planes of both halves meet
    for slope, middle in ((2.0, 0.5), (0.05, None)):
        model = roof(slope, edge)
        line = drawn(renderer, model, camera, "deferred-4", background="none", shadows="off")[SIZE[1] // 2, :, 0]
        msaa = drawn(renderer, model, camera, "msaa-4", background="none", shadows="off")[SIZE[1] // 2, :, 0]
        assert np.abs(line - msaa).max() < (1e-4 if middle else 0.6 * np.ptp(msaa))
        at = SIZE[0] // 2
        mixed = (line[at - 2:at + 2] - line[at + 4]) / (line[at - 4] - line[at + 4])
        between = (mixed > 0.1) & (mixed < 0.9)
        assert between.any() == (middle is not None)


@pytest.mark.parametrize("part", [0.25, 0.75])
def test_the_side_of_a_bend_that_most_samples_show_stands_for_both(renderer, part):
    """The lower half of a roof covers `part` of a row of pixels: one sample of four (the first, the last) or three."""
    model = roof(0.05, 2 / SIZE[1] * part, across=False)
    picture = drawn(renderer, model, orthographic(0.0, 0.0, 2.0), "deferred-4", background="none", shadows="off")
    line, at = picture[:, SIZE[0] // 2, 0], SIZE[1] // 2 - 1
    above, row, below = line[at - 1:at + 2]
    assert abs(above - below) > 0.01
    assert abs(row - (below if part > 0.5 else above)) < 0.1 * abs(above - below)


def roof(slope: float, edge: float, across: bool = True):
    """Two halves that meet at x = `edge`, or y without `across`, lit from the side."""
    positions = np.float32([[-1, -1, -slope], [edge, -1, 0], [edge, 1, 0], [-1, 1, -slope],
                            [1, -1, -slope], [1, 1, -slope]])
    positions = positions if across else positions[:, [1, 0, 2]] * np.float32([-1, 1, 1])
    sides = [positions[k] for k in ([0, 1, 2, 3], [1, 4, 5, 2])]
    normals = [np.cross(side[1] - side[0], side[2] - side[0]) for side in sides]
    mesh = Mesh("roof", np.concatenate(sides), 0, indices=np.uint32([0, 1, 2, 0, 2, 3, *[0] * 6, 4, 5, 6, 4, 6, 7]),
                normals=np.float32([n / np.linalg.norm(n) for n in normals for _ in range(4)]))
    light = Light("directional", intensity=1.0, direction=(1, 0, -0.2) if across else (0, 1, -0.2))
    return scene(mesh, materials=(replace(ROUGH, perceptual_roughness=1.0, specular=0.0, base_color=(1, 1, 1, 1)),),
                 lights=(light,))


def test_parts_and_poses(renderer):
    """A part is that of the whole picture, the rest stays, and what moves is drawn where it is."""
    model, other = still_life(), scene((sphere(0, 24), moved((0.4, 0, 0))), materials=(SMOOTH,),
                                       environment=lopsided())
    settings = Settings.of(antialias="deferred-4")
    whole = {}
    for shown in (model, other):
        renderer.draw(shown, CAMERA, settings, SIZE)
        whole[shown] = renderer.read_display(settings)
    renderer.draw(model, CAMERA, settings, SIZE)
    renderer.draw(other, CAMERA, settings, SIZE, part=(0, 0, 20, 32))
    both = renderer.read_display(settings)
    assert np.array_equal(both[:, :20], whole[other][:, :20]) and np.array_equal(both[:, 20:], whole[model][:, 20:])
    mesh = model.meshes[0]
    pushed = replace(model, meshes=(replace(mesh, positions=mesh.positions + np.float32([0.1, 0.2, 0]),
                                            normals=mesh.normals[:, [1, 2, 0]]), *model.meshes[1:]))
    before, after = (drawn(renderer, shown, CAMERA, "deferred-4") for shown in (model, pushed))
    right = drawn(renderer, pushed, CAMERA, "msaa-4")
    assert np.abs(after - right).mean() < 0.05 * np.abs(before - right).mean()


def test_highlights_are_numbers_at_outlines(renderer):
    """The neighbour of a pixel there shows nothing that derivatives could be made of."""
    lamps = replace(SUN, angular_radius=0.0), Light("point", intensity=3.0, position=(0.5, 1.0, 1.0))
    model = scene((sphere(0, 24), moved((0.0, 0.2, 0))), materials=(replace(SMOOTH, clearcoat=1.0),), lights=lamps)
    deferred, multisampled = (drawn(renderer, model, CAMERA, antialias) for antialias in ("deferred-4", "msaa-4"))
    assert np.isfinite(deferred).all()
    assert deferred[..., :3].mean() == pytest.approx(multisampled[..., :3].mean(), rel=0.05)


def test_frames_before_and_after_are_as_ever(renderer):
    """It leaves no state behind that others do not expect, as those that draw shadow maps and G-buffers."""
    model, settings = still_life(), {"environment_shadows": "16", "background": "none"}
    before = drawn(renderer, model, CAMERA, "none", **settings)
    drawn(renderer, still_life(), CAMERA, "deferred-4", background="none")
    assert np.array_equal(drawn(renderer, still_life(), CAMERA, "none", **settings), before)


def test_as_many_objects_as_numbers_have_bits_for(renderer):
    """The last of 64 objects, whose number has all of its six bits, is drawn as if it were alone. The others are in
    it."""
    ball, specks = (sphere(0, 24), np.eye(4)), [(plate(1, 0.01), np.eye(4)) for _ in range(63)]
    alone, last = (drawn(renderer, scene(*others, ball, materials=(SMOOTH, ROUGH), environment=lopsided()), CAMERA,
                         "deferred-4") for others in ([], specks))
    assert [draw.is_deferred for draw in renderer.plan.draws] == 64 * [True]
    np.testing.assert_allclose(last, alone, atol=1e-5)


def test_two_objects_of_one_plane_are_two_surfaces(renderer):
    """Their planes are alike, and neither stands for the other where their edges meet within a pixel."""
    white, black = (replace(ROUGH, specular=0.0, base_color=(level,) * 3 + (1,)) for level in (0.8, 0.05))
    model = scene((plate(0), moved((-1.01, 0, 0))), (plate(1), moved((0.99, 0, 0))), materials=(white, black),
                  environment=constant())
    deferred, multisampled = (drawn(renderer, model, orthographic(), antialias, background="none")
                              for antialias in ("deferred-4", "msaa-4"))
    assert ((multisampled[..., 0] > 0.2) & (multisampled[..., 0] < 0.7)).any()
    np.testing.assert_allclose(deferred, multisampled, atol=2e-3)


@pytest.mark.parametrize("hole", [(3, 4, 5, 2), (2, 3, 8, 6), (2, 5, 3, 4), (0, 0, 0, 0)], ids=str)
def test_around_a_hole(hole):
    covered = np.zeros((12, 14), int)
    for x, y, width, height in (*around(hole, (2, 3, 8, 6)), hole):
        covered[y:y + height, x:x + width] += 1
    right = np.zeros_like(covered)
    right[3:9, 2:10] = 1
    assert np.array_equal(covered, right)


def test_rows_hold_what_is_drawn():
    """All points of two bodies, one of them mirrored; and they leave out corners."""
    model, rng = still_life(), np.random.default_rng(0)
    frame, box = Frame(model, CAMERA, (400, 320)), (20, 30, 350, 280)
    corners, points = [], []
    for instance in model.instances[:2]:
        mesh, matrix = model.meshes[instance.mesh], instance.transform
        corners.append(cell_corners(mesh.positions) @ matrix[:3, :3].T + matrix[:3, 3])
        weights = rng.dirichlet((0.3, 0.3, 0.3), len(mesh.indices) // 3)
        on_triangles = np.einsum("tk,tkc->tc", weights, mesh.positions[mesh.indices.reshape(-1, 3)])
        points.append(on_triangles @ matrix[:3, :3].T + matrix[:3, 3])
    clip = np.concatenate([(np.concatenate(points) - CAMERA.eye) / frame.unit,
                           np.ones((sum(map(len, points)), 1))], axis=1) @ frame.view_projection.T
    x, y = np.floor((clip[:, :2] / clip[:, 3:] + 1) / 2 * frame.size).astype(int).T
    drawn_over = np.zeros((320, 400), int)
    for left, bottom, width, height in pixel_rows(frame, np.concatenate(corners), box):
        drawn_over[bottom:bottom + height, left:left + width] += 1
    is_within = (x >= 20) & (x < 370) & (y >= 30) & (y < 310)
    assert drawn_over.max() == 1 and is_within.sum() > 500 and drawn_over[y[is_within], x[is_within]].all()
    assert drawn_over.sum() == drawn_over[30:310, 20:370].sum() < 0.8 * 350 * 280
    near = Camera.look_at((0.7, 0.1, 0.3), (0, 0, 0), fov_y=0.8)
    assert pixel_rows(Frame(model, near, SIZE), np.concatenate(corners), (3, 4, 20, 9)) == [(3, 4, 20, 9)]


def test_planes_and_boxes():
    model = still_life()
    mesh, matrix = model.meshes[1], model.instances[1].transform
    triangles = mesh.indices.reshape(-1, 3)
    planes = triangle_planes(mesh.positions, triangles, matrix, model).astype(np.float64)
    points = (mesh.positions @ matrix[:3, :3].T + matrix[:3, 3] - model.center) / model.radius
    corners = points[triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    sized = area > 1e-9  # not those at the poles, which have none
    np.testing.assert_allclose(np.linalg.norm(planes[sized, :3], axis=1), 1, rtol=1e-6)
    off = (points[triangles] * planes[:, None, :3]).sum(axis=2) + planes[:, None, 3]
    assert np.abs(off[sized]).max() < 1e-5
    frame = Frame(model, CAMERA, SIZE)
    x, y, width, height = pixel_box(frame, 1, (0, 0, *SIZE))
    clip = np.concatenate([(points * model.radius + model.center - CAMERA.eye) / frame.unit,
                           np.ones((len(points), 1))], axis=1) @ frame.view_projection.T
    pixels = (clip[:, :2] / clip[:, 3:] + 1) / 2 * SIZE
    assert (pixels >= (x, y)).all() and (pixels <= (x + width, y + height)).all() and width * height < 0.5 * 40 * 32
    clip = np.concatenate([(frame.scene.corners[1] - CAMERA.eye) / frame.unit, np.ones((8, 1))],
                          axis=1) @ frame.view_projection.T
    corners = (clip[:, :2] / clip[:, 3:] + 1) / 2 * SIZE  # and a pixel more, since OpenGL rounds them
    assert (corners >= (x + 1, y + 1)).all() and (corners <= (x + width - 1, y + height - 1)).all()
    assert pixel_box(frame, 1, (0, 0, 1, 1))[2:] == (0, 0)
    within = Camera.look_at((0.7, 0.1, 0.3), (0, 0, 0), fov_y=0.8)
    assert pixel_box(Frame(model, within, SIZE), 1, (3, 4, 20, 9)) == (3, 4, 20, 9)
