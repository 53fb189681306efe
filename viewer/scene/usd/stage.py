"""What is drawn of a stage, as arrays and JSON; runs in the other process."""

from __future__ import annotations

import json
import os
from collections import Counter
from typing import Any

import numpy as np

Arrays = dict[str, np.ndarray]
_SILENT = {"", "Xform", "Scope", "Material", "Shader", "NodeGraph", "GeomSubset", "SkelRoot"}
"""Types of which nothing has to be said: they draw nothing themselves."""


def read(data: bytes, path: str, folder: str) -> Arrays:
    """The meshes and curves of the file at `path` in world coordinates: metres, +Y up.

    "json" has what `load.load_usd` makes a scene of; "0.points" and so on are the arrays of part 0. `data` is not used:
    OpenUSD reads files. Raises ValueError for what is broken, or asks for files outside of `folder`.
    """
    os.environ["PXR_WORK_THREAD_LIMIT"] = "1"  # each thread would reserve memory
    os.environ.pop("PXR_AR_DEFAULT_SEARCH_PATH", None)
    from pxr import Tf, Usd

    from .layers import open_stage

    warnings: list[str] = []
    try:
        stage = open_stage(path, folder, warnings)
        return _Reader(stage, Usd.TimeCode.EarliestTime(), warnings).read()
    except (Tf.ErrorException, UnicodeDecodeError) as error:
        raise ValueError("is broken") from error


class _Reader:
    def __init__(self, stage: Any, time: Any, warnings: list[str]) -> None:
        from pxr import UsdGeom

        self.stage, self.time, self.warnings = stage, time, warnings
        self.arrays: Arrays = {}
        self.parts: list[dict[str, Any]] = []
        self.materials: dict[str, dict[str, Any]] = {}
        self.left_out: Counter[str] = Counter()
        self.cages = 0
        self.moves = False
        self.transforms = UsdGeom.XformCache(time)
        unit = UsdGeom.GetStageMetersPerUnit(stage)
        if not 0 < unit < np.inf:
            raise ValueError(f"has metersPerUnit = {unit:g}")
        self.to_world = np.diag([unit, unit, unit, 1.0])
        if UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.z:
            self.to_world = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1.0]]) @ self.to_world

    def read(self) -> Arrays:
        from pxr import Usd, UsdGeom

        prims = iter(Usd.PrimRange(self.stage.GetPseudoRoot(), Usd.TraverseInstanceProxies()))
        for prim in prims:
            imageable = UsdGeom.Imageable(prim)
            if imageable and (imageable.ComputePurpose() in (UsdGeom.Tokens.guide, UsdGeom.Tokens.proxy)
                              or imageable.ComputeVisibility(self.time) == UsdGeom.Tokens.invisible):
                prims.PruneChildren()
            elif prim.IsA(UsdGeom.Mesh) or prim.IsA(UsdGeom.BasisCurves):
                self._drawn(prim)
            elif prim.GetTypeName() not in _SILENT:
                self.left_out[str(prim.GetTypeName())] += 1
                if prim.IsA(UsdGeom.PointInstancer):
                    prims.PruneChildren()  # what it places is drawn nowhere else
        self._say()
        told = {"parts": self.parts, "materials": list(self.materials.values()), "warnings": self.warnings}
        self.arrays["json"] = np.frombuffer(json.dumps(told).encode(), np.uint8)
        return self.arrays

    def _say(self) -> None:
        for kind, count in self.left_out.items():
            self.warnings.append(f"{count} {kind[:80]}: not read; left out")
        if self.cages:
            self.warnings.append(f"{self.cages} subdivision surfaces: their cages are drawn")
        if self.moves:
            self.warnings.append("the file is animated; its first moment is shown")

    def _drawn(self, prim: Any) -> None:
        from pxr import UsdGeom

        matrix = self._matrix(prim, UsdGeom.PointBased(prim).GetPointsAttr())
        if not np.isfinite(matrix).all():
            self.warnings.append(f"{prim.GetName()[:80]}: its transform is not of finite numbers; left out")
        elif prim.IsA(UsdGeom.Mesh):
            self._mesh(prim, matrix)
        else:
            self._strands(prim, matrix)

    def _mesh(self, prim: Any, matrix: np.ndarray) -> None:
        from pxr import UsdGeom

        from .meshes import read_mesh

        mesh = UsdGeom.Mesh(prim)
        is_left = (mesh.GetOrientationAttr().Get(self.time) == UsdGeom.Tokens.leftHanded) != (
            np.linalg.det(matrix[:3, :3]) < 0)
        for material, arrays, is_cage in read_mesh(prim, self.time, self._uv_name):
            self.cages += is_cage
            arrays["points"] = arrays["points"] @ matrix[:3, :3].T + matrix[:3, 3]
            if "normals" in arrays:
                arrays["normals"] = arrays["normals"] @ np.linalg.pinv(matrix[:3, :3])
            is_two_sided = bool(mesh.GetDoubleSidedAttr().Get(self.time))
            self._add({"kind": "mesh", "name": prim.GetName(), "material": self._material(material),
                       "is_left": bool(is_left), "is_two_sided": is_two_sided}, arrays)

    def _strands(self, prim: Any, matrix: np.ndarray) -> None:
        from pxr import UsdShade

        from .strands import read_strands

        kind, is_closed, arrays = read_strands(prim, self.time)
        if len(arrays["offsets"]) < 2:
            self.warnings.append(f"{prim.GetName()[:80]}: no strand has enough points; left out")
            return
        arrays["points"] = arrays["points"] @ matrix[:3, :3].T + matrix[:3, 3]
        arrays["radii"] = arrays.pop("widths") / 2 * abs(np.linalg.det(matrix[:3, :3])) ** (1 / 3)
        bound, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()
        self._add({"kind": kind, "name": prim.GetName(), "is_closed": is_closed,
                   "material": self._material(str(bound.GetPath()) if bound else "")}, arrays)

    def _matrix(self, prim: Any, points: Any) -> np.ndarray:
        """Prim to world, (4, 4), for columns."""
        from pxr import UsdGeom

        self.moves |= points.ValueMightBeTimeVarying()
        above = prim
        while not self.moves and above and not above.IsPseudoRoot():
            xform = UsdGeom.Xformable(above)
            self.moves |= bool(xform) and xform.TransformMightBeTimeVarying()
            above = above.GetParent()
        return self.to_world @ np.array(self.transforms.GetLocalToWorldTransform(prim)).T

    def _material(self, path: str) -> int | None:
        """The number of a material, which is read when it is first used."""
        from pxr import UsdShade

        from .shading import read_material

        if not path:
            return None
        if path not in self.materials:
            self.materials[path] = read_material(UsdShade.Material(self.stage.GetPrimAtPath(path)), self.warnings)
        return list(self.materials).index(path)

    def _uv_name(self, path: str) -> str:
        """The name of the texture coordinates that a material reads its textures at."""
        number = self._material(path)
        uv = None if number is None else self.materials[path]["uv"]
        return uv["name"] if uv else "st"

    def _add(self, part: dict[str, Any], arrays: Arrays) -> None:
        for name, array in arrays.items():
            self.arrays[f"{len(self.parts)}.{name}"] = array
        self.parts.append(part | {"arrays": list(arrays)})
