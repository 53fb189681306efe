"""Random hits of real models: finite numbers, orthonormal frames, no reflection below the surface."""

from __future__ import annotations

import numpy as np
import pytest
from interactions import ask, random_hits
from needs import CORPUS, needs

from viewer.scene.load import load_scene
from viewer.trace.scene.geometry import trace_geometry

MODELS = CORPUS / "models"
NAMES = ("AlphaBlendModeTest/AlphaBlendModeTest.glb", "FlightHelmet/FlightHelmet.gltf", "MultiUVTest/MultiUVTest.glb",
         "TextureTransformTest/TextureTransformTest.gltf", "TransmissionTest/TransmissionTest.glb",
         "UnlitTest/UnlitTest.glb", "VertexColorTest/VertexColorTest.glb")


@needs("corpus")
@pytest.mark.parametrize("name", NAMES)
def test_hits_give_numbers(context, tmp_path, name):
    scene = load_scene(MODELS / name)
    hits = random_hits(trace_geometry(scene), 2000)
    found = ask(context, tmp_path, scene, hits)
    assert all(np.isfinite(values).all() for values in found.values())
    assert np.linalg.norm(found["position"], axis=1).max() < 1 + 1e-6
    frame = np.stack([found["t"], found["b"], found["n"]], axis=1)
    assert np.abs(frame @ frame.transpose(0, 2, 1) - np.eye(3)).max() < 1e-5
    cos = np.einsum("ij,ij->i", found["n"], hits.wo)
    mirrored = 2 * cos[:, None] * found["n"] - hits.wo
    assert cos.min() > 0 and np.einsum("ij,ij->i", mirrored, found["n_geometric"]).min() > 0
    np.testing.assert_allclose(found["coverage_at"], found["coverage"], atol=1e-6)
    np.testing.assert_allclose(found["emission_at"][found["is_front"]], found["emission"][found["is_front"]], rtol=1e-6)
    assert found["base_color"].min() >= 0 and found["coverage"].min() >= 0 and found["coverage"].max() <= 1
