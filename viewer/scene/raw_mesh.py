"""What the readers of mesh files make, before it has the attributes that renderers need."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..base.counted import counted
from .arrays import rows_of
from .color import srgb_to_linear
from .frames import with_creased_normals, with_flat_normals, with_grouped_normals, with_tangents
from .material import AlphaMode, Material, Texture
from .mesh import ELEMENT_SIZES, Mesh, Topology, drawn_positions
from .mtl import PLAIN
from .polygons import triangulate
from .schema import needs_tangents, tangent_texture
from .texture_image import TextureImage

FAR = 8.0
"""Half extents from the origin from which on a model is placed by its instances, so that float32 keeps its digits."""


@dataclass(frozen=True, eq=False)
class RawMesh:
    """Triangles, lines or points of one material.

    positions (N, 3) float64, perhaps not finite; indices (M,) integers, every one in 0..N-1, or None for 0..N-1;
    normals (N, 3) of any length; uvs (N, 2), v upwards; colors (N, 4) linear.
    """

    name: str
    positions: np.ndarray
    topology: Topology = "triangles"
    indices: np.ndarray | None = None
    normals: np.ndarray | None = None
    uvs: np.ndarray | None = None
    colors: np.ndarray | None = None
    material: Material = PLAIN
    is_faceted: bool = False
    """Whether normals that lack are those of the facets, and not smooth."""
    smoothing: np.ndarray | None = None
    """The smoothing group of each triangle, (T,) integers, for normals that lack; 0 for none. Without it, edges are
    smooth that are not sharp."""

    def picked(self, source: np.ndarray) -> RawMesh:
        """With vertex k a copy of vertex source[k]; the indices are left as they are."""
        return replace(self, positions=self.positions[source], normals=rows_of(self.normals, source),
                       uvs=rows_of(self.uvs, source), colors=rows_of(self.colors, source))


@dataclass(frozen=True, eq=False)
class RawModel:
    """All that a file holds, and the images that its materials use."""

    meshes: list[RawMesh]
    images: Sequence[TextureImage] = ()


def cut_polygons(positions: np.ndarray, corners: np.ndarray, sizes: np.ndarray,
                 warnings: list[str]) -> tuple[np.ndarray, np.ndarray]:
    """The corners (3 T,) of the triangles that polygons are cut into, as numbers of corners, and their polygons (T,).

    As `polygons.triangulate`, but polygons of fewer than three corners are left out, with a warning.
    """
    chosen = np.flatnonzero(sizes >= 3)
    kept = np.arange(len(corners))
    if len(chosen) < len(sizes):
        warnings.append(f"{len(sizes) - len(chosen)} faces with fewer than three corners; they are left out")
        kept = np.flatnonzero(np.repeat(sizes >= 3, sizes))
    triangles, polygon, uncut = triangulate(positions, corners[kept], sizes[chosen])
    if uncut:
        warnings.append(f"{uncut} concave polygons of too many corners; they are cut in any way")
    return kept[triangles.ravel()], chosen[polygon]


def finite_part(mesh: RawMesh, warnings: list[str]) -> RawMesh | None:
    """The mesh without what has a vertex that is not finite, with a warning; None where nothing is left."""
    corners = ELEMENT_SIZES[mesh.topology]
    finite = np.isfinite(mesh.positions).all(axis=1)
    if not finite.all():
        indices = np.arange(len(finite)) if mesh.indices is None else mesh.indices
        indices = indices[: len(indices) // corners * corners].reshape(-1, corners)
        whole = finite[indices].all(axis=1)
        if not whole.all():
            lost = np.count_nonzero(~whole)
            warnings.append(f"{lost} {mesh.topology[:None if lost > 1 else -1]} with a position that is not a finite "
                            f"number; {'they are' if lost > 1 else 'it is'} left out")
        source, renumbered = np.unique(indices[whole], return_inverse=True)
        smoothing = None if mesh.smoothing is None else mesh.smoothing[whole]
        mesh = replace(mesh.picked(source), indices=renumbered.ravel(), smoothing=smoothing)
    return mesh if len(mesh.positions if mesh.indices is None else mesh.indices) >= corners else None


def shared_center(meshes: Sequence[RawMesh]) -> np.ndarray:
    """What is taken off all positions, (3,) float64: the middle of a model far from the origin, 0 for others."""
    drawn = [drawn_positions(mesh.positions, mesh.indices) for mesh in meshes]
    low = np.min([positions.min(axis=0) for positions in drawn], axis=0)
    high = np.max([positions.max(axis=0) for positions in drawn], axis=0)
    center = low / 2 + high / 2
    return center if np.abs(center).max() > FAR * (high - low).max() / 2 else np.zeros(3)


def finished(mesh: RawMesh, center: np.ndarray, material: int) -> Mesh:
    """The mesh about `center`, as the renderers take it, with the normals and tangents that it lacks.

    Normals of the file are used if every one has a length.
    """
    positions = (mesh.positions - center if center.any() else mesh.positions).astype(np.float32)
    indices = None if mesh.indices is None else mesh.indices.astype(np.uint32)
    uvs = () if mesh.uvs is None else ((np.nan_to_num(mesh.uvs) * (1, -1) + (0, 1)).astype(np.float32),)
    colors = None if mesh.colors is None else mesh.colors.astype(np.float32)
    made = Mesh(mesh.name, positions, material, mesh.topology, indices, uvs=uvs, colors=colors)
    if mesh.topology != "triangles":
        return made
    length = np.zeros((0, 1)) if mesh.normals is None else np.linalg.norm(mesh.normals, axis=1, keepdims=True)
    if mesh.normals is not None and ((length > 0) & np.isfinite(length)).all():
        made = replace(made, normals=(mesh.normals / length).astype(np.float32))
    elif mesh.smoothing is not None:
        made = with_grouped_normals(made, mesh.smoothing)
    else:
        made = with_flat_normals(made) if mesh.is_faceted else with_creased_normals(made)
    return with_tangents(made, tangent_texture(mesh.material)) if needs_tangents(mesh.material) else made


def colored(material: Material, colors: np.ndarray | None) -> Material:
    """The material under vertex colours, which are all the colour there is and may be translucent."""
    if colors is None:
        return material
    # Alpha 254/255 comes from rounding and does not mean a translucent surface.
    mode: AlphaMode = "blend" if colors[:, 3].min(initial=1) < 0.99 else "opaque"
    return replace(material, base_color=(1.0, 1.0, 1.0, 1.0), alpha_mode=mode)


def textured(material: Material, image: TextureImage) -> Material:
    """The material with an image for all its colour."""
    return replace(material, base_color=(1.0, 1.0, 1.0, 1.0), base_color_texture=Texture(image))


def linear_colors(columns: np.ndarray, full: float | None = None, warnings: list[str] | None = None) -> np.ndarray:
    """sRGB colours with linear alpha, (N, 3 or 4) numbers, as (N, 4) float32 linear.

    `full` is the number that means 1; without it, it is 255 where any number is above 1, else 1. NaN and infinity count
    as full, which is told in `warnings`.
    """
    columns = np.asarray(columns, np.float64)
    lost = int(np.count_nonzero(~np.isfinite(columns).all(axis=1)))
    if lost and warnings is not None:
        warnings.append(f"{counted(lost, 'colour')} with a number that is not finite; it counts as full")
    if full is None:
        full = 255.0 if columns.max(initial=0, where=np.isfinite(columns)) > 1 else 1.0
    scaled = np.clip(np.nan_to_num(columns / full, nan=1.0, posinf=1.0), 0, 1)
    out = np.ones((len(columns), 4), np.float32)
    out[:, :3] = srgb_to_linear(scaled[:, :3])
    out[:, 3:] = scaled[:, 3:4] if columns.shape[1] == 4 else 1
    return out
