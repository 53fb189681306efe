"""The pages name files that exist and links that lead somewhere; what is written from the code agrees with it."""

from __future__ import annotations

import ast
import re
import shlex
import tomllib
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from PIL import Image as Pillow

import viewer.api
from viewer import cli
from viewer.image.image import Image
from viewer.material.document import table
from viewer.material.glsl import files
from viewer.scene.gltf.extensions import SUPPORTED

ROOT = Path(__file__).resolve().parents[1]
PAGES = [*sorted((ROOT / "docs").glob("*.md")),
         *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "benchmarks/README.md", "examples/README.md"))]
TOP = r"(?:viewer|shaders|tests|docs|assets|benchmarks|examples)/[\w./-]*"
SHADER = r"(?:bsdf|material|media|light|sample|raster|trace|display)/[\w./]+\.(?:glsl|frag|vert)"
LINK = r"\]\(([^)\s]+)\)"


def named_files(text: str) -> Iterator[str]:
    """Paths as they are written, from the root or, of shaders, from shaders/."""
    for found in re.finditer(rf"(?<![\w./-])(?:{TOP}|{SHADER})", text):
        yield found.group().rstrip(".")


def anchors(text: str) -> set[str]:
    """Those of the headings: lower case, without punctuation, dashes for spaces."""
    titles = re.findall(r"^#+ (.+)$", text, re.MULTILINE)
    return {re.sub(r"[^\w -]", "", title).lower().replace(" ", "-") for title in titles}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_named_files_exist(page: Path) -> None:
    names = set(named_files(page.read_text(encoding="utf-8")))
    assert [name for name in sorted(names) if not any((at / name).exists() for at in (ROOT, ROOT / "shaders"))] == []


@pytest.mark.parametrize("page", [*PAGES, ROOT / "CHANGELOG.md"], ids=lambda page: page.relative_to(ROOT).as_posix())
def test_links_lead_somewhere(page: Path) -> None:
    broken = []
    for link in re.findall(LINK, page.read_text(encoding="utf-8")):
        name, _, anchor = link.partition("#")
        if "://" in link:
            continue
        target = page.parent / name if name else page
        if not target.exists() or (anchor and anchor not in anchors(target.read_text(encoding="utf-8"))):
            broken.append(link)
    assert broken == []


def test_the_site_has_a_place_for_every_page() -> None:
    """Else give it a title in the `nav` of mkdocs.yml."""
    nav = (ROOT / "mkdocs.yml").read_text(encoding="utf-8").partition("\nnav:\n")[2]
    named = re.findall(r": ([\w/-]+\.md)$", nav, re.MULTILINE)
    assert [page.name for page in PAGES if page.parent.name == "docs" and page.name not in named] == [], \
        "these pages are not in the nav of mkdocs.yml"
    assert [name for name in named if named.count(name) > 1] == []


def test_what_follows_from_the_declaration_of_materials_is_current() -> None:
    """Else run `python -m viewer.material`."""
    assert (ROOT / "docs" / "materials.md").read_text(encoding="utf-8") == table()
    for name, text in files().items():
        assert (ROOT / "shaders" / "material" / name).read_text(encoding="utf-8") == text, name


EXCEPTIONS: set[tuple[str, str]] = set()
"""The page names them."""


def imported_folders(file: Path) -> Iterator[str]:
    """The folders of viewer/ from which a file imports, inside of functions, too."""
    here = file.relative_to(ROOT).parent.parts
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.level:
            path = [*here[:len(here) - node.level + 1], *(node.module or "").split(".")]
            names = [path[1]] if len(path) > 1 and path[1] else [alias.name for alias in node.names]
            yield from (name for name in names if (ROOT / "viewer" / name).is_dir())


def test_folders_import_from_those_above_them_in_the_table() -> None:
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    order = re.findall(r"^\| `viewer/(\w+)/` \|", page, re.MULTILINE)
    assert sorted(order) == sorted(p.name for p in (ROOT / "viewer").iterdir() if (p / "__init__.py").exists())
    upward = set()
    for k, folder in enumerate(order):
        for file in (ROOT / "viewer" / folder).rglob("*.py"):
            upward |= {(file.relative_to(ROOT).as_posix(), name)
                       for name in imported_folders(file) if name not in order[:k + 1]}
    assert upward == EXCEPTIONS


def test_the_readme_lists_every_extension_that_is_read() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    short = {name: "_" + name.removeprefix("KHR_materials_") for name in SUPPORTED}
    assert [name for name in sorted(SUPPORTED) if f"`{name}`" not in text and f"`{short[name]}`" not in text] == []


def test_the_readme_shows_what_make_demo_renders(tmp_path: Path) -> None:
    """The same settings, size and framing; what `--quality high` adds is not asked for, which takes long."""
    made = dict(re.findall(r"^(LOOK|QUALITY) \?= (.+)$", (ROOT / "Makefile").read_text(), re.MULTILINE))
    spaced = re.sub(r"[\\\s]+", " ", (ROOT / "README.md").read_text(encoding="utf-8"))
    assert f"pbr-viewer render assets/demo.glb -o demo.png {made['LOOK']} {made['QUALITY']} " in spaced
    shown = Image.open(ROOT / "docs" / "images" / "demo.jpg")
    assert shown.size == viewer.api.DEFAULT_SIZE
    small = np.asarray(Pillow.fromarray(shown.srgb[..., :3]).resize((160, 90), Pillow.Resampling.BOX)) / 255
    demo, out = str(ROOT / "assets" / "demo.glb"), str(tmp_path / "small.png")
    with pytest.raises(SystemExit):
        cli.main(["render", demo, "-o", out, "--size", "160x90", *shlex.split(made["LOOK"])])
    drawn = Image.open(out).srgb[..., :3] / 255
    assert np.abs(small - drawn).mean() < 0.025


def test_extras_that_are_named_are_there() -> None:
    """By the errors that they cure, the pages, and the script that installs them for tests."""
    known = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    places = [*PAGES, *(ROOT / "viewer").rglob("*.py"), ROOT / "tests" / "needs.py"]
    texts = "\n".join(place.read_text(encoding="utf-8") for place in places)
    named = {name for names in re.findall(r"pbr-viewer\[([\w,]+)\]", texts) for name in names.split(",")}
    assert {"cad", "film", "formats", "oidn", "usd", "vdb"} <= named <= set(known)


def test_no_two_files_of_tests_have_one_name() -> None:
    """pytest imports them without their folders, and runs none of a second file of the same name."""
    counts = Counter(file.name for file in (ROOT / "tests").rglob("*.py"))
    assert [name for name, count in counts.items() if count > 1 and name != "conftest.py"] == []
