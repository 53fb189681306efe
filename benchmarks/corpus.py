"""Models and environments of the corpus of real data, where it lies beside the checkout."""

from __future__ import annotations

from pathlib import Path

from .shot import REPOSITORY

FOLDER = REPOSITORY.parent / "shared" / "corpus"


def model(name: str) -> Path:
    """The first .glb, else .gltf, in the model's folder, or the file of that name; raises FileNotFoundError."""
    if Path(name).is_file():
        return Path(name)
    found = [path for kind in ("*.glb", "*.gltf") for path in sorted((FOLDER / "models" / name).rglob(kind))]
    if not found:
        raise FileNotFoundError(f"{name}: neither a file nor a model of the corpus")
    return found[0]


def environment(name: str) -> str:
    """The file of the corpus of that name; else the name, which may be a file's or that of an environment of ours."""
    path = FOLDER / "environments" / f"{name}.hdr"
    return str(path) if path.is_file() else name


def present(names: tuple[str, ...]) -> list[str]:
    """Those of the names that the corpus has a model for."""
    return [name for name in names if (FOLDER / "models" / name).is_dir()]
