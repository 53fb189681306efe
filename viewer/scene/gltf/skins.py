"""glTF's skins."""

from __future__ import annotations

import numpy as np

from ..rig import Skin
from .accessors import Accessors
from .element import Element
from .nodes import Nodes


class Skins:
    """The file's skins, each read once."""

    def __init__(self, root: Element, nodes: Nodes, accessors: Accessors) -> None:
        self.items = root.array("skins")
        self._nodes, self._accessors = nodes, accessors
        self._read: dict[int, Skin] = {}

    def skin(self, index: int) -> Skin:
        """Raises InputError for a skin without joints, with too few matrices, or that takes vertices nowhere."""
        if index not in self._read:
            skin = self._read[index] = self._one(self.items[index])
            if not np.isfinite(skin.matrices(self._nodes.world)).all():
                raise self.items[index].error("the joint matrices must be finite", "inverseBindMatrices")
        return self._read[index]

    def _one(self, skin: Element) -> Skin:
        joints = skin.indices("joints", len(self._nodes.items))
        if not joints:
            raise skin.error("a skin needs joints", "joints")
        accessor = skin.index("inverseBindMatrices", len(self._accessors.items), None)
        if accessor is None:
            return Skin(np.array(joints), np.tile(np.eye(4), (len(joints), 1, 1)))
        stored = self._accessors.floats(accessor, "MAT4")
        if len(stored) < len(joints):
            raise skin.error(f"{len(stored)} matrices for {len(joints)} joints", "inverseBindMatrices")
        matrices = stored[:len(joints)].reshape(-1, 4, 4).transpose(0, 2, 1).astype(np.float64)
        return Skin(np.array(joints), matrices)
