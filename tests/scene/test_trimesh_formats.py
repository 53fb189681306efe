"""3MF and COLLADA, which trimesh reads where the packages of an extra are installed."""

from __future__ import annotations

import zipfile

import numpy as np
import pytest
from needs import needs

from viewer.errors import InputError
from viewer.scene import mesh_formats, trimesh_formats
from viewer.scene.load import load_scene

COLLADA = """<?xml version="1.0"?>%s
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset/>
<library_effects><effect id="e"><profile_COMMON><technique sid="t"><phong><diffuse><color>1 0 0 1</color></diffuse>
</phong></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="red"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="9">0 0 0 1 0 0 0 0 2</float_array><technique_common>
<accessor source="#a" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1" material="m"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><translate>%s 0 0</translate><instance_geometry url="#g">
<bind_material><technique_common><instance_material symbol="m" target="#red"/></technique_common></bind_material>
</instance_geometry></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>"""
MODEL_3MF = """<?xml version="1.0"?>
<model unit="millimeter" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">
<resources><object id="1" type="model"><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/>
<vertex x="0" y="0" z="2"/></vertices><triangles><triangle v1="0" v2="1" v3="2"/></triangles></mesh></object>
</resources><build><item objectid="1" transform="1 0 0 0 1 0 0 0 1 5 0 0"/></build></model>"""


def written(path, content):
    if path.suffix == ".dae":
        path.write_text(content)
    else:
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("a.dae" if path.suffix == ".zae" else "3D/3dmodel.model", content)
    return path


@needs("formats")
@pytest.mark.parametrize("name", ["a.dae", "a.zae", "a.3mf"])
def test_a_triangle(tmp_path, name):
    scene = load_scene(written(tmp_path / name, MODEL_3MF if name == "a.3mf" else COLLADA % ("", 5)))
    assert scene.triangle_count == 1 and not scene.warnings
    np.testing.assert_allclose(scene.bounds, [[5, 0, 0], [6, 0, 2]])
    if name != "a.3mf":  # trimesh reads no colours of 3MF
        assert scene.materials[0].base_color == (1, 0, 0, 1)


@needs("formats")
def test_errors_of_code_are_not_told_as_such(tmp_path):
    (tmp_path / "a.dae").write_text("<COLLADA/>")
    with pytest.raises(InputError, match=r"a\.dae: cannot be read as DAE: it is broken$"):
        load_scene(tmp_path / "a.dae")


@needs("formats")
def test_no_other_file_is_read_and_nothing_vast_unpacked(tmp_path, monkeypatch):
    (tmp_path / "number").write_text("5")
    entity = f'<!DOCTYPE x [<!ENTITY e SYSTEM "{(tmp_path / "number").as_uri()}">]>'
    with pytest.raises(InputError, match=r"a\.dae: cannot be read as DAE: "):
        load_scene(written(tmp_path / "a.dae", COLLADA % (entity, "&e;")))
    monkeypatch.setattr(trimesh_formats, "_MOST_UNPACKED", 1000)
    with pytest.raises(InputError, match=r"a\.3mf: unpacks to \d{4} bytes; the limit is 1000"):
        load_scene(written(tmp_path / "a.3mf", MODEL_3MF + " " * 2500))


@pytest.mark.parametrize("name", ["a.dae", "a.3mf"])
def test_without_the_packages_the_error_says_what_to_install(tmp_path, monkeypatch, name):
    monkeypatch.setattr(mesh_formats, "trimesh_formats", lambda: {"xyz"})
    with pytest.raises(InputError, match=r"(DAE|3MF) needs packages .* pip install 'pbr-viewer\[formats\]'"):
        load_scene(written(tmp_path / name, MODEL_3MF))
