"""Small files that demand much work: what they would make of a few bytes is counted before it is made."""

from __future__ import annotations

import numpy as np
import pytest
from gltf_builder import GltfBuilder

from viewer.errors import InputError


@pytest.fixture(autouse=True)
def few_elements(monkeypatch):
    """As much work as for a file of 16 kB, not for one of 4 MB."""
    monkeypatch.setattr("viewer.scene.gltf.buffers.MIN_CLAIM", 1 << 16)


def zeros(builder: GltfBuilder, count: int, kind: str) -> int:
    """An accessor without bytes in the file."""
    return builder.add("accessors", {"componentType": 5126, "count": count, "type": kind})


@pytest.mark.parametrize("samplers", [1, 9])
def test_channels_that_share_key_frames(samplers):
    """Each channel's are checked, and kept."""
    builder = GltfBuilder()
    builder.node(mesh=builder.triangle())
    shared = {"input": zeros(builder, 4000, "SCALAR"), "output": zeros(builder, 4000, "VEC3")}
    channels = [{"sampler": k % samplers, "target": {"node": 0, "path": "translation"}} for k in range(9)]
    builder.add("animations", {"samplers": [shared] * samplers, "channels": channels})
    with pytest.raises(InputError, match=r"animations\[0\].samplers\[\d\]: \d+ elements in all are too many for "):
        builder.load()
    builder.json["animations"][0]["channels"] = channels[:6]
    assert len(builder.load().animations[0].tracks) == 6


def test_pointers_to_weights_of_a_mesh_that_many_nodes_show():
    builder = GltfBuilder(extensionsUsed=["KHR_animation_pointer"])
    place = builder.accessor(np.eye(3))
    mesh = builder.mesh({"POSITION": place}, targets=[{"POSITION": place}])
    for _ in range(40):
        builder.node(mesh=mesh)
    sampler = {"input": builder.accessor([0, 1]), "output": builder.accessor([0, 1])}
    channel = {"sampler": 0, "target": {"path": "pointer", "extensions": {
        "KHR_animation_pointer": {"pointer": f"/meshes/{mesh}/weights"}}}}
    builder.add("animations", {"samplers": [sampler], "channels": [channel] * 40})
    with pytest.raises(InputError, match=r"animations\[0\].channels\[\d+\]: \d+ elements in all are too many for "):
        builder.load()
    builder.json["animations"][0]["channels"] = [channel]
    assert len(builder.load().animations[0].tracks) == 40
