"""Interactions by shaders/trace/material.glsl for given hits, and the same computed in float64 from the scene."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from harness import evaluate

from viewer.gpu.context import Context
from viewer.scene.scene import Scene
from viewer.scene.triangles import triangles_of
from viewer.trace.scene.geometry import TraceGeometry, trace_geometry
from viewer.trace.scene.scene_data import SceneData

_INTERACTION = """Hit hit = Hit(int(i0.x), int(i0.y), f0.zw);
Interaction i = interact(hit, f1.xyz);
SurfaceMaterial m = material_at(i);
"""
_FIRST = _INTERACTION + """o0 = vec4(i.position, i.area); o1 = vec4(i.n_geometric, float(i.is_front));
o2 = vec4(i.n, float(i.emitter)); o3 = vec4(i.t, float(i.material)); o4 = vec4(i.b, i.medium); o5 = vec4(i.uv0, i.uv1);
o6 = i.color;"""
_SECOND = _INTERACTION + """o0 = vec4(m.inputs.base_color.rgb, m.coverage);
o1 = vec4(m.inputs.metallic, m.inputs.perceptual_roughness, m.inputs.ior, m.inputs.specular);
o2 = vec4(m.inputs.specular_color, m.inputs.transmission);
o3 = vec4(m.emission, coverage_at(hit)); o4 = vec4(m.is_thin, m.is_unlit, m.is_double_sided, 0.0);
o5 = vec4(emission_at(hit), 0.0);"""


@dataclass
class Hits:
    instance: np.ndarray
    triangle: np.ndarray
    barycentric: np.ndarray
    wo: np.ndarray

    def rows(self) -> np.ndarray:
        rows = np.zeros((len(self.instance), 7), np.uint32)
        rows[:, 0], rows[:, 1] = self.instance, self.triangle
        rows[:, 2:4] = self.barycentric.view(np.uint32)
        rows[:, 4:] = self.wo.view(np.uint32)
        return rows


def random_hits(geometry: TraceGeometry, count: int, seed: int = 0) -> Hits:
    random = np.random.default_rng(seed)
    instance = random.integers(0, len(geometry.instances), count)
    sizes = np.array([len(geometry.meshes[i.mesh].triangles) for i in geometry.instances])
    triangle = random.integers(0, sizes[instance])
    u, v = random.uniform(size=(2, count))
    u, v = np.where(u + v > 1, (1 - u, 1 - v), (u, v))
    wo = random.normal(size=(count, 3))
    wo /= np.linalg.norm(wo, axis=1, keepdims=True)
    return Hits(instance, triangle, np.stack([u, v], 1).astype(np.float32), wo.astype(np.float32))


def ask(context: Context, folder: Path, scene: Scene, hits: Hits) -> dict[str, np.ndarray]:
    """The members of Interaction and SurfaceMaterial by their names, and coverage_at, emission_at."""
    data = SceneData(context, scene, trace_geometry(scene))
    data.upload()
    arguments = hits.rows(), 7, data.switches, data.bind
    a = evaluate(context, folder, "trace/material.glsl", _FIRST, *arguments)
    b = evaluate(context, folder, "trace/material.glsl", _SECOND, *arguments)
    medium = a[:, 4, 3:].astype(np.uint32)
    c = evaluate(context, folder, "media/medium.glsl", "o0 = vec4(transmittance(int(i0.x), 1.0), 0.0);", medium, 1,
                 data.switches, data.bind)
    data.release()
    return {
        "position": a[:, 0, :3], "area": a[:, 0, 3], "n_geometric": a[:, 1, :3], "is_front": a[:, 1, 3] > 0,
        "n": a[:, 2, :3], "emitter": a[:, 2, 3], "t": a[:, 3, :3], "material": a[:, 3, 3], "b": a[:, 4, :3],
        "uv0": a[:, 5, :2], "uv1": a[:, 5, 2:], "color": a[:, 6],
        "base_color": b[:, 0, :3], "coverage": b[:, 0, 3], "metallic": b[:, 1, 0], "perceptual_roughness": b[:, 1, 1],
        "ior": b[:, 1, 2], "specular": b[:, 1, 3], "specular_color": b[:, 2, :3], "transmission": b[:, 2, 3],
        "emission": b[:, 3, :3], "coverage_at": b[:, 3, 3], "transmittance": c[:, 0, :3],
        "medium": a[:, 4, 3], "is_thin": b[:, 4, 0] > 0, "is_unlit": b[:, 4, 1] > 0,
        "is_double_sided": b[:, 4, 2] > 0, "emission_at": b[:, 5, :3],
    }


def expect(scene: Scene, geometry: TraceGeometry, hits: Hits) -> dict[str, np.ndarray]:
    """The Interaction in float64, computed from the scene without normal maps. `front` is the geometric normal of the
    front side, `shading` the interpolated normal before it is bent."""
    names = ("position", "front", "shading", "area", "uv0", "uv1", "color")
    out: dict[str, list] = {name: [] for name in names}
    for k, t, (u, v) in zip(hits.instance, hits.triangle, hits.barycentric.astype(np.float64)):
        instance = scene.instances[geometry.instances[k].source]
        mesh = scene.meshes[instance.mesh]
        corner = triangles_of(mesh)[t]
        weights = np.array([1 - u - v, u, v])
        matrix = instance.transform[:3, :3]
        world = mesh.positions[corner].astype(np.float64) @ matrix.T + instance.transform[:3, 3]
        tracer = (world - scene.center) / scene.radius
        normal = np.cross(tracer[1] - tracer[0], tracer[2] - tracer[0]) * np.sign(np.linalg.det(matrix))
        area = np.linalg.norm(normal)
        front = normal / area if area > 0 else np.zeros(3)
        shading = front
        if mesh.normals is not None and np.linalg.det(matrix) != 0:
            shading = np.linalg.inv(matrix).T @ (weights @ mesh.normals[corner].astype(np.float64))
            shading = shading / np.linalg.norm(shading)
        out["position"].append(weights @ tracer)
        out["front"].append(front)
        out["shading"].append(shading)
        out["area"].append(area / 2)
        for name in ("uv0", "uv1"):
            known = len(mesh.uvs) > int(name[-1])
            out[name].append(weights @ mesh.uvs[int(name[-1])][corner] if known else np.zeros(2))
        out["color"].append(np.ones(4) if mesh.colors is None else weights @ mesh.colors[corner].astype(np.float64))
    return {name: np.array(values) for name, values in out.items()}


def bend(n: np.ndarray, g: np.ndarray, o: np.ndarray) -> np.ndarray:
    """bend_normal of shaders/trace/shading_normal.glsl, (N, 3) each."""
    cos = np.einsum("ij,ij->i", g, o)[:, None]
    lift = np.minimum(0.9 * cos, 0.01)
    r = 2 * np.einsum("ij,ij->i", n, o)[:, None] * n - o
    height = np.einsum("ij,ij->i", r, g)[:, None]
    flat = r - height * g
    length = np.linalg.norm(flat, axis=1, keepdims=True)
    raised = flat / np.maximum(length, 1e-300) * np.sqrt(1 - lift**2) + lift * g
    half = o + np.where(height >= lift, r, raised)
    bent = half / np.linalg.norm(half, axis=1, keepdims=True)
    return np.where((cos < 1e-6) | ((height < lift) & (length < 1e-6)), g, bent)
