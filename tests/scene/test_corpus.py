"""Every model of the shared corpus loads as its index says, and no malformed file does harm."""

from __future__ import annotations

import json
import resource
import subprocess
import sys

import numpy as np
import pytest
from needs import CORPUS, needs

from viewer.errors import InputError
from viewer.scene.gltf.extensions import _WITHOUT_EFFECT, SUPPORTED
from viewer.scene.load import load_scene
from viewer.scene.schema import needs_tangents

INDEX = json.loads((CORPUS / "INDEX.json").read_text()) if (CORPUS / "INDEX.json").is_file() else {}
TRIANGLES = {"SimpleInstancing": 125 * 12, "CubeVisibility": 2 * 12}
"""In the scene, where the index has the triangles of all nodes, each drawn once."""
pytestmark = needs("corpus")


@pytest.mark.parametrize("model", INDEX.get("models", []), ids=lambda model: model["name"])
def test_model(model):
    missing = [name for name in model["extensions_required"] if name not in SUPPORTED and name not in _WITHOUT_EFFECT]
    if missing:
        with pytest.raises(InputError, match=missing[0]):
            load_scene(CORPUS / model["path"])
        return
    scene = load_scene(CORPUS / model["path"])
    assert scene.triangle_count == TRIANGLES.get(model["name"], model["triangles_in_scene"])
    assert scene.instances and json.dumps(scene.facts)
    for mesh in scene.meshes:
        count = len(mesh.positions)
        assert mesh.positions.dtype == np.float32 and np.isfinite(mesh.positions).all()
        assert mesh.indices is None or (mesh.indices.dtype == np.uint32 and mesh.indices.max() < count)
        assert all(uv.shape == (count, 2) and np.isfinite(uv).all() for uv in mesh.uvs)
        if mesh.topology == "triangles":
            np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-3)
            assert (mesh.tangents is not None) == needs_tangents(scene.materials[mesh.material])
        if mesh.tangents is not None:
            np.testing.assert_allclose(np.linalg.norm(mesh.tangents[:, :3], axis=1), 1, atol=1e-3)
            assert set(np.unique(mesh.tangents[:, 3])) <= {-1, 1}


@pytest.mark.parametrize("mesh", INDEX.get("meshes", []), ids=lambda mesh: mesh["name"])
def test_mesh(mesh):
    scene = load_scene(CORPUS / mesh["path"])
    assert scene.triangle_count == mesh["triangles_or_faces"]
    assert not scene.warnings


_LOAD_ALL = """
import sys
from viewer.errors import InputError
from viewer.scene.load import load_scene
for line in sys.stdin:
    path = line.rstrip("\\n")
    try:
        scene = load_scene(path)
        for texture in (m.base_color_texture for m in scene.materials):
            if texture:
                texture.image.decode()
        verdict = "loads"
    except InputError as error:
        verdict = "error" if str(error).startswith(path.rsplit("/", 1)[0]) else f"unnamed: {error}"
    except BaseException as error:
        verdict = f"crash: {error!r}"
    print(verdict, flush=True)
"""


def test_malformed_files_do_no_harm():
    """All in one process, within 1.5 GB of address space and 60 s; a crash would end the list early."""
    items = [item for item in INDEX["malformed"] if not item["path"].endswith(".hdr")]
    limit = 3 << 29
    done = subprocess.run([sys.executable, "-c", _LOAD_ALL], text=True, capture_output=True, timeout=60,
                          input="".join(f"{CORPUS / item['path']}\n" for item in items),
                          preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
    verdicts = done.stdout.splitlines()
    assert len(verdicts) == len(items), done.stderr[-2000:]
    wrong = [(item["path"], verdict) for item, verdict in zip(items, verdicts)
             if verdict not in ("loads", "error") or (item["expect"] == "error" and verdict != "error")
             or (item["expect"] == "must load" and verdict != "loads")]
    assert not wrong
    assert done.stderr == ""
