"""What the path tracer uses of a scene: its triangles, instances, materials and media.

Tracer space has the axes of the world, `scene.center` at the origin and `scene.radius` as the unit. So all geometry
lies in the unit ball. Everything is computed in float64 and rounded once. Tracer space does not depend on the camera.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from ...material.fold import without_constant_maps
from ...material.use import supported
from ...scene.fog import Fog
from ...scene.material import Material
from ...scene.medium import VACUUM, Medium, scaled
from ...scene.mesh import Mesh
from ...scene.scene import Scene
from ...scene.transform import handedness
from ...scene.triangles import triangles_of
from ..kinds import BOUNDARY, SURFACE, Kind, kind_of
from .curves import TraceCurves
from .fog import TraceFog, trace_fog
from .materials import TraceMaterial, trace_material
from .nesting import Nesting

DENSEST_FOG = 2.0**14
"""Extinction of fog per tracer unit; that of denser fog counts as this."""


@dataclass(frozen=True, eq=False)
class TraceMesh:
    """Triangles relative to the centre of their box, divided by half its longest side.

    `positions` is (N, 3) float32 in [-1, 1]; `triangles` is (M, 3) uint32, numbers of vertices; `source` is the mesh's
    number in `scene.meshes`. `to_mesh` (4, 4) takes positions back to the mesh: all axes have one factor, which keeps
    normals.
    """

    positions: np.ndarray
    triangles: np.ndarray
    source: int = -1
    to_mesh: np.ndarray = field(default_factory=lambda: np.eye(4))


@dataclass(frozen=True, eq=False)
class TraceInstance:
    """A mesh placed in tracer space by `transform`, (3, 4) float64, from the mesh's normalised positions.

    `see_through`: the coverage of its triangles may be below 1, so that rays may pass. `is_pane`: shadow rays pass it,
    dimmed (`TraceMaterial.is_pane`). `has_open_back`: rays of the camera pass it from behind. `material` and `medium`,
    that of the inside, are numbers in `TraceGeometry.materials` and `.media`; `source` is the instance's number in
    `scene.instances`. `first_emitter` is the number of its first triangle among all emissive triangles, and its other
    triangles follow in their order; it is -1 if the instance does not emit.
    """

    mesh: int
    transform: np.ndarray
    kind: Kind = SURFACE
    see_through: bool = False
    material: int = 0
    medium: int = 0
    is_pane: bool = False
    has_open_back: bool = False
    source: int = -1
    first_emitter: int = -1

    @property
    def is_mirrored(self) -> bool:
        """Whether the transform makes counter-clockwise triangles clockwise."""
        return handedness(self.transform) < 0


@dataclass(frozen=True, eq=False)
class TraceGeometry:
    """The scene's triangles. Lines and points are left out.

    `media` has the medium outside of all solids, and then those of the instances' insides. `emitters` is the number of
    emissive triangles, `left_out_instances` the number of instances of lines or points. `unit` is the length of one
    unit of tracer space, in world units. `has_grids`: the scene has volumes with grids of densities. `fog` says where
    the medium outside is, if that is fog. `curves` are those of the scene, if it has any. `indices` has the index of
    refraction and the dispersion of each medium, if solids of glass may touch or overlap (nested.py), and `depth` how
    many of these lie in one another.
    """

    meshes: list[TraceMesh]
    instances: list[TraceInstance]
    materials: list[TraceMaterial]
    media: tuple[Medium, ...] = (VACUUM,)
    emitters: int = 0
    left_out_instances: int = 0
    unit: float = 1.0
    has_grids: bool = False
    fog: TraceFog | None = None
    curves: TraceCurves | None = None
    indices: tuple[tuple[float, float], ...] = ()
    depth: int = 0

    @property
    def scatters(self) -> bool:
        """Whether any medium scatters light, or a grid or fog may."""
        return self.has_grids or self.fog is not None or any(medium.scatters for medium in self.media)

    @property
    def nesting(self) -> Nesting:
        """How the media that a path is inside of are numbers."""
        return Nesting(len(self.media), bool(self.indices))

    @property
    def has_panes(self) -> bool:
        """Whether light goes straight on through any surface (`TraceMaterial.is_pane`)."""
        return any(instance.is_pane for instance in self.instances)

    @property
    def open_media(self) -> frozenset[int]:
        """The numbers of the media that no boundary which refracts keeps apart from the outside."""
        return frozenset({0, *(instance.medium for instance in self.instances if instance.kind == BOUNDARY)})

    @property
    def triangle_count(self) -> int:
        """Number of triangles of all instances."""
        return sum(len(self.meshes[instance.mesh].triangles) for instance in self.instances)

    def has_triangles_of(self, other: TraceGeometry) -> bool:
        """Whether no triangle of the other has moved or is of another kind. Materials may differ."""
        pairs = list(zip(self.instances, other.instances, strict=False))
        return ((len(self.meshes), len(self.instances)) == (len(other.meshes), len(other.instances))
                and all(a is b for a, b in zip(self.meshes, other.meshes, strict=True))
                and all(a.mesh == b.mesh and a.kind is b.kind for a, b in pairs)
                and np.array_equal([a.transform for a, _ in pairs], [b.transform for _, b in pairs]))


def trace_geometry(
    scene: Scene, before: tuple[Scene, TraceGeometry] | None = None, *, scattering: bool = True, fog: Fog | None = None,
    curves: TraceCurves | None = None,
) -> TraceGeometry:
    """The triangles of `scene`, each mesh once, however often it is placed. Maps of one colour become factors.

    Meshes that the scene `before` has, too, are those of its geometry. Without `scattering` all extinction of
    solids is absorption, and volumes are left out. `fog` fills what is outside of all solids, and `curves` are those of
    the scene; without them it has none.
    """
    known = {} if before is None else {before[0].meshes[mesh.source]: mesh for mesh in before[1].meshes}
    meshes: dict[int, tuple[TraceMesh, int]] = {}
    materials: dict[tuple[int, int, bool], int] = {}
    placed: list[TraceInstance] = []
    used_materials: list[TraceMaterial] = []
    outside = VACUUM if fog is None else _resolved(fog.medium, scene.radius)
    media: dict[tuple[Medium, bool, bool], int] = {(outside, False, False): 0}
    emitters = 0
    surfaces = [without_constant_maps(material if scattering else material.without_medium_scattering)
                for material in scene.materials]
    volumes = scene.volumes if scattering else ()
    scatters = bool(volumes or fog) or any(surfaces[mesh.material].medium.scatters for mesh in scene.meshes)
    for number, instance in enumerate(scene.instances):
        mesh = scene.meshes[instance.mesh]
        if not mesh.triangle_count:
            continue
        if instance.mesh not in meshes:
            traced_mesh = known.get(mesh)
            if traced_mesh is None or traced_mesh.source != instance.mesh:
                traced_mesh = _normalise(mesh, instance.mesh)
            meshes[instance.mesh] = traced_mesh, len(meshes)
        normalised, index = meshes[instance.mesh]
        key = mesh.material, len(mesh.uvs), mesh.tangents is not None
        if key not in materials:
            materials[key] = len(used_materials)
            used_materials.append(trace_material(supported(surfaces[mesh.material], mesh), mesh, scatters))
        material, traced = surfaces[mesh.material], used_materials[materials[key]]
        is_emitter = any(material.emissive) and not material.unlit
        # A solid without volumes or fog in it has a medium of its own, even if that is the vacuum.
        displaces_volumes = bool(volumes) and traced.is_solid and not traced.is_boundary
        inside = traced.medium, displaces_volumes, fog is not None
        placed.append(TraceInstance(
            mesh=index,
            transform=_to_tracer(scene, instance.transform) @ normalised.to_mesh,
            kind=kind_of(traced),
            see_through=_is_see_through(material, mesh),
            material=materials[key],
            is_pane=traced.is_pane,
            has_open_back=kind_of(traced) == SURFACE and not material.double_sided,
            medium=media.setdefault(inside, len(media)) if traced.is_solid or fog is None else 0,
            source=number,
            first_emitter=emitters if is_emitter else -1,
        ))
        emitters += len(normalised.triangles) if is_emitter else 0
    ordered = [mesh for mesh, _ in meshes.values()]
    return TraceGeometry(ordered, placed, used_materials, tuple(key[0] for key in media), emitters,
                         len(scene.instances) - len(placed), scene.radius, bool(volumes),
                         None if fog is None else trace_fog(scene, fog), curves)


def _resolved(fog: Medium, unit: float) -> Medium:
    """`fog` with an extinction that float32 resolves: then its mean free path is a 16,384th of the scene's radius."""
    factor = min(1.0, DENSEST_FOG / (unit * max(*fog.sigma_t, 1e-300)))
    return replace(fog, sigma_t=scaled(fog.sigma_t, factor)) if factor < 1 else fog


def _normalise(mesh: Mesh, source: int) -> TraceMesh:
    low, high = mesh.bounds
    half = float((high - low).max()) / 2 or 1.0
    center = (low + high) / 2
    # Vertices that no triangle uses may lie outside of the box.
    positions = np.clip((mesh.positions - center) / half, -1, 1).astype(np.float32)
    to_mesh = np.diag([half, half, half, 1.0])
    to_mesh[:3, 3] = center
    return TraceMesh(positions, triangles_of(mesh), source, to_mesh)


def _to_tracer(scene: Scene, transform: np.ndarray) -> np.ndarray:
    """The (3, 4) matrix from mesh to tracer space, for a `transform` from mesh to world."""
    moved = transform[:3].copy()
    moved[:, 3] -= scene.center
    return moved / scene.radius


def _is_see_through(material: Material, mesh: Mesh) -> bool:
    """Whether the coverage of any point may be below 1.

    This decodes no texture: a texture with an alpha channel counts as varying.
    """
    if material.alpha_mode == "opaque":
        return False
    texture = material.base_color_texture
    varies = texture is not None and texture.uv_set < len(mesh.uvs) and texture.image.has_alpha
    varies |= mesh.colors is not None
    enough = 1.0 if material.alpha_mode == "blend" else material.alpha_cutoff
    return varies or material.base_color[3] < enough
