"""Scenes made for growth have what they are asked to have, and the powers told of it are right."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.growth import exponents, power
from benchmarks.growth_scenes import write
from viewer.scene.load import load_scene


def test_triangles(tmp_path: Path) -> None:
    assert load_scene(write("triangles", 10_000, tmp_path)).triangle_count == pytest.approx(10_000, rel=0.02)


def test_materials_differ(tmp_path: Path) -> None:
    scene = load_scene(write("materials", 30, tmp_path))
    assert len(scene.instances) == len({id(scene.materials[mesh.material]) for mesh in scene.meshes}) == 30
    assert len({(m.alpha_mode, m.normal_texture is None, m.metallic) for m in scene.materials}) > 8


def test_lights(tmp_path: Path) -> None:
    assert [light.kind for light in load_scene(write("lights", 4, tmp_path)).lights] == [
        "spot", "point", "directional", "spot"]


def test_instances(tmp_path: Path) -> None:
    scene = load_scene(write("instances", 30, tmp_path))
    assert len(scene.instances) == 30 and len(scene.meshes) == 1 and not scene.warnings


def test_a_scene_that_is_there_is_not_made_again(tmp_path: Path) -> None:
    (tmp_path / "lights-7.glb").write_bytes(b"kept")
    assert write("lights", 7, tmp_path).read_bytes() == b"kept"


@pytest.mark.parametrize("p", [0.0, 1.0, 2.0])
def test_the_power_of_a_power(p: float) -> None:
    fewer, more = ({"count": n, "load_s": 0.3 * n**p} for n in (200, 1_000))
    assert power(fewer, more, "load_s") == pytest.approx(p, abs=1e-12)


def test_powers_are_of_the_last_two_counts_that_a_program_managed() -> None:
    rows = [{"program": "a", "count": n, "load_s": s, "ready_s": 1.0, "rss_mb": n} for n, s in
            ((1, 9.0), (10, 1.0), (100, 10.0))] + [{"program": "a", "count": 1_000, "error": "over 30 s"}]
    rows += [{"program": "b", "count": 1, "load_s": 1.0}]
    assert exponents(rows)[2:] == ["| a, 10 to 100 | 1.00 | 0.00 | nan | 1.00 |"]
