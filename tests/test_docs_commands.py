"""The commands of the pages are commands that there are, with options and settings that there are."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import pytest
from test_docs import PAGES, ROOT

from viewer import cli
from viewer.errors import UsageError
from viewer.jobs.assemble import make_settings
from viewer.jobs.camera_options import check_camera_options
from viewer.scene.model_files import MODEL_ENDINGS

PAGE = pytest.mark.parametrize("page", [*PAGES, ROOT / "CHANGELOG.md"],
                               ids=lambda page: page.relative_to(ROOT).as_posix())


def commands(page: Path, program: str) -> Iterator[list[str]]:
    """What follows `program` in indented lines, in blocks of shell and between backticks; without forms such as
    `view MODEL [options]`."""
    text = re.sub(r"\\\n\s*", "", page.read_text(encoding="utf-8"))
    text = re.sub(r"```python\n.*?```", "", text, flags=re.DOTALL)
    inline = re.findall(rf"`{program} ([^`\n]+(?:\n[^`\n]+)?)`", re.sub(r"^    .*$", "", text, flags=re.MULTILINE))
    for line in [*re.findall(rf"^(?: {{4,}}|\$ )(?:[A-Z_]+=\S+ )*{program} (.+)$", text, re.MULTILINE), *inline]:
        line = re.sub(r"((^|\s)#|\s{2,}).*", "", line)  # comments, and words in a second column
        if not re.search(r"[\[…]|\.\.\.", line):
            yield shlex.split(line)


@PAGE
def test_pbr_viewer(page: Path) -> None:
    without_pbr = rf"(?<!-m )(?<![-\w./])viewer (?:{'|'.join(cli.cli.commands)})\b"
    assert re.findall(without_pbr, page.read_text(encoding="utf-8")) == [], "the command is pbr-viewer"
    for name, *arguments in commands(page, "pbr-viewer"):
        if name.startswith("-") or name.isupper():
            continue
        if Path(name).suffix in MODEL_ENDINGS:
            name, arguments = "view", [name, *arguments]
        shown = f"pbr-viewer {shlex.join([name, *arguments])}"
        assert name in cli.cli.commands, shown
        wanted = {p.name for p in cli.cli.commands[name].params if p.param_type_name == "argument" and p.required}
        given = [argument for argument in arguments if not argument.startswith("-")]
        if wanted and not given:
            continue  # only an option of a command is spoken of
        if name in ("render", "report") and not {"-o", "--output"} & set(arguments):
            arguments = [*arguments, "-o", "out.png"]
        try:
            with cli.cli.commands[name].make_context(name, list(arguments)) as context:
                options = context.params
            if "assignments" in options:
                settings = make_settings(options)
                if name == "render" and settings.time_budget is None and settings.error is None:
                    settings.check_used()
            if "orbit" in options:
                check_camera_options(options, takes_several=name == "render")
        except (cli.click.ClickException, UsageError) as error:
            pytest.fail(f"{shown}: {error}")


@PAGE
def test_make_and_python(page: Path) -> None:
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    unknown = {line[0] for line in commands(page, "make") if line[0].islower()} - targets
    assert not unknown, f"make {unknown}"
    for module in (line[1] for line in commands(page, "python") if line[0] == "-m"):
        assert find_spec(module), f"python -m {module}"


@pytest.mark.parametrize("name", ["README.md", "docs/first-steps.md", "docs/from-pyrender.md"])
def test_what_the_first_pages_show_of_python_runs(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    [block] = re.findall(r"```python\n(.*?)```", (ROOT / name).read_text(encoding="utf-8"), re.DOTALL)
    assert block.count("(1280, 720)") >= 1
    (tmp_path / "assets").mkdir()
    (tmp_path / "assets" / "demo.glb").write_bytes((ROOT / "assets" / "scenes" / "spheres.glb").read_bytes())
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("viewer.app.open_window", lambda *arguments, **more: None)
    exec(compile(block.replace("(1280, 720)", "(16, 9)"), name, "exec"), {})
    assert (tmp_path / "demo.png").exists()


@PAGE
def test_blocks_of_python_are_python(page: Path) -> None:
    for block in re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL):
        compile(block, str(page), "exec")
