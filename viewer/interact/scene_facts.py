"""Facts about a model, in words and numbers."""

from __future__ import annotations

from pathlib import Path

from ..scene.scene import Scene


def scene_facts(scene: Scene) -> list[tuple[str, str]]:
    """A summary of a model: pairs of a name and a value."""
    extent = scene.bounds[1] - scene.bounds[0]
    textures = {id(t.image) for m in scene.materials for t in vars(m).values() if hasattr(t, "image")}
    facts = [
        ("Triangles", f"{scene.triangle_count:,}"),
        ("Instances", f"{len(scene.instances):,} of {len(scene.meshes):,} meshes"),
        ("Materials", f"{len(scene.materials)}, {len(textures)} images"),
        ("Volumes", str(len(scene.volumes))),
        ("Strands", f"{sum(curves.strand_count for curves in scene.curves):,}"),
        ("Size", " × ".join(f"{side:.3g}" for side in extent) + " m"),
        ("Lights", str(len(scene.lights))),
        ("Cameras", str(len(scene.cameras))),
        ("Animations", str(len(scene.animations))),
    ]
    names = {name.lower() for name, _ in facts}
    return facts + [(name.replace("_", " ").capitalize(), _text(value)) for name, value in scene.facts.items()
                    if value and name not in names]


def _text(value: object) -> str:
    if isinstance(value, (list, tuple)):
        return ("\n" if any(isinstance(item, dict) for item in value) else ", ").join(map(_text, value))
    if isinstance(value, dict) and "active_voxels" in value:  # a grid of a volume file
        voxels = value["active_voxels"]  # None for a type that is not read
        return f"{_text(value['name'])}, {value['type']}" + (f", {voxels:,} voxels" if voxels is not None else "")
    if isinstance(value, dict):  # an image, as the readers describe it
        return f"{_text(Path(value['name']).name)}, {value['width']} × {value['height']}, {value['format']}"
    return str(value) or "(unnamed)"
