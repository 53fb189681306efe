"""The site of the documentation: its pages, its links, and what of it is made of the code."""

from __future__ import annotations

import importlib.util
import os
import re
import subprocess
import sys
from types import ModuleType

import pytest
from click.testing import CliRunner
from needs import needs
from test_docs import ROOT

import viewer
from viewer.cli import cli
from viewer.commands.document import options_page
from viewer.settings import setting_choices, setting_meanings


@pytest.fixture(scope="module")
def hooks() -> ModuleType:
    spec = importlib.util.spec_from_file_location("site_hooks", ROOT / "docs" / "site" / "hooks.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(("path", "text", "expected"), [
    ("README.md", "![a](docs/images/demo.jpg) [b](docs/choices.md#fog) [c](CONTRIBUTING.md)",
     "![a](images/demo.jpg) [b](choices.md#fog) [c](contributing.md)"),
    ("docs/quality.md", "[a](report.md) [b](../README.md#x) [`c`](../benchmarks/results/reach.md)",
     "[a](report.md) [b](index.md#x) [`c`](results/reach.md)"),
    ("benchmarks/results/reach.md", "[a](../../docs/choices.md) [b](media.md)", "[a](../choices.md) [b](media.md)"),
    ("docs/curves.md", "[a](../viewer/scene/curves.py) [b](#c) [d](https://example.org/)",
     "a [b](#c) [d](https://example.org/)"),
])
def test_links_lead_to_the_same_in_the_site(hooks, path, text, expected):
    assert hooks.relinked(text, path) == expected


def test_every_option_and_setting_is_in_the_tables():
    texts = re.split(r"^## .+$", options_page(cli.commands), flags=re.MULTILINE)[1:]
    sections = dict(zip([*cli.commands, "--set"], texts, strict=True))
    for name, command in cli.commands.items():
        shown = CliRunner().invoke(command, ["--help"], terminal_width=200).output
        told = {*re.findall(r"^ +(?:-\w, )?(--[a-z-]+)", shown, re.MULTILINE)} - {"--help"}
        assert told, name
        assert [option for option in sorted(told) if f"`{option}" not in sections[name]] == [], name
        assert command.help.split()[0] in sections[name]
    rows = re.findall(r"^\| `([\w-]+)` \| (.+) \| `(.+)` \| .+ \|$", sections["--set"], re.MULTILINE)
    assert [row[0].replace("-", "_") for row in rows] == list(setting_meanings())
    assert {row[0]: row[1] for row in rows}["ndf"] == ", ".join(f"`{name}`" for name in setting_choices()["ndf"])
    assert {row[0]: row[2] for row in rows}["volume-albedo"] == "0.9,0.9,0.9"


def test_the_page_on_python_has_every_public_name():
    page = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    assert sorted(re.findall(r"^::: viewer\.(\w+)$", page, re.MULTILINE)) == sorted(viewer.__all__)


def test_each_picture_of_the_gallery_stands_below_its_command():
    page = (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8")
    shown = re.findall(r"^    pbr-viewer render .* -o (\w+)\.png .*\n\n!\[.+\]\(images/gallery/(\w+)\.webp\)$", page,
                       re.MULTILINE)
    files = sorted((ROOT / "docs" / "images" / "gallery").iterdir())
    assert [name for name, _ in shown] == [picture for _, picture in shown]
    assert sorted(name for name, _ in shown) == [file.stem for file in files]
    assert page.count("![") == len(shown) and sum(file.stat().st_size for file in files) < 1.5e6


@needs("docs")
def test_it_builds_without_a_warning_and_asks_for_nothing_from_the_network(tmp_path):
    done = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "-q", "-d", str(tmp_path)], cwd=ROOT, capture_output=True, text=True,
        env={**os.environ, "NO_MKDOCS_2_WARNING": "1", "PYTHONPATH": str(ROOT)})
    assert done.returncode == 0, done.stderr
    pages = {page.relative_to(tmp_path).as_posix(): page.read_text(encoding="utf-8")
             for page in tmp_path.rglob("*.html")}
    assert {"index.html", "contributing.html", "results/reach.html", "options.html"} <= set(pages)
    for name, text in pages.items():
        assert re.findall(r"""(?:<link[^>]*href|src)=["']?(?:https?:)?//[^"' >]+""", text) == [], name
    assert "--turntable FRAMES" in pages["options.html"]
    assert re.search(r"framing_camera.*azimuth", pages["python.html"], re.DOTALL)


@needs("docs")
def test_the_files_for_the_host_of_the_repository_are_yaml_of_the_right_form():
    import yaml

    files = {path.name: yaml.safe_load(path.read_text(encoding="utf-8"))
             for path in (ROOT / ".github").rglob("*.yml")}
    job = files["ci.yml"]["jobs"]["test"]
    assert [step["run"] for step in job["steps"] if "run" in step][-1] == ".ci/run"
    classifiers = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert job["strategy"]["matrix"]["python"] == re.findall(r"Python :: (3\.\d+)", classifiers)
    for name in ("bug.yml", "picture.yml", "feature.yml"):
        form = files[name]
        assert form["name"] and form["description"]
        fields = [field for field in form["body"] if field["type"] != "markdown"]
        assert all(field["attributes"]["label"] for field in fields) and len({f["id"] for f in fields}) == len(fields)
