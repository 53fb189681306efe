"""What the site has besides docs/: pages from elsewhere in the repository, and tables that are made of the code.

MkDocs calls the functions whose names begin with `on_`; mkdocs.yml names this file.
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
ELSEWHERE = {"README.md": "index.md", "CONTRIBUTING.md": "contributing.md", "CHANGELOG.md": "changelog.md",
             "examples/README.md": "examples.md", "benchmarks/README.md": "benchmarks.md"}
"""Files of the repository outside of docs/ that are pages, by the names that they have there and in the site."""
RESULTS = "benchmarks/results"
OPTIONS = "<!-- the tables of all options -->"
_LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\[\]]*\])*)\]\(([^)\s]+)\)")


def site_name(path: str) -> str | None:
    """The name in the site of a file of the repository; None if it has no page there."""
    if path.startswith("docs/"):
        return path.removeprefix("docs/")
    if posixpath.dirname(path) == RESULTS and path.endswith(".md"):
        return f"results/{posixpath.basename(path)}"
    return ELSEWHERE.get(path)


def relinked(text: str, path: str) -> str:
    """The text of a page with links to where the site has what they lead to in the repository.

    `path` is the page's in the repository. A link to what has no page, such as a shader, becomes its words.
    """
    page = site_name(path)
    assert page is not None, path

    def link(match: re.Match[str]) -> str:
        mark, words, target = match.groups()
        name, hash_, anchor = target.partition("#")
        if not name or "://" in target:
            return match[0]
        there = site_name(posixpath.normpath(posixpath.join(posixpath.dirname(path), name)))
        if there is None:
            return words
        return f"{mark}[{words}]({posixpath.relpath(there, posixpath.dirname(page) or '.')}{hash_}{anchor})"

    return _LINK.sub(link, text)


def added_pages() -> Iterator[tuple[str, str]]:
    """The paths in the repository and the texts of the pages that docs/ does not have."""
    results = sorted(path.relative_to(ROOT).as_posix() for path in (ROOT / RESULTS).glob("*.md"))
    for path in (*ELSEWHERE, *results):
        yield path, (ROOT / path).read_text(encoding="utf-8")


def on_files(files: Any, config: Any) -> Any:
    """Add the pages from elsewhere."""
    from mkdocs.structure.files import File, InclusionLevel

    for path, text in added_pages():
        level = InclusionLevel.NOT_IN_NAV if path.startswith(RESULTS) else InclusionLevel.INCLUDED
        files.append(File.generated(config, site_name(path), content=relinked(text, path), inclusion=level))
    return files


def on_page_markdown(markdown: str, page: Any, config: Any, files: Any) -> str:
    """Relink the pages of docs/, and fill in the tables."""
    if page.file.generated_by:
        return markdown
    if OPTIONS in markdown:
        from viewer.cli import cli
        from viewer.commands.document import options_page

        markdown = markdown.replace(OPTIONS, options_page(cli.commands))
    return relinked(markdown, f"docs/{page.file.src_uri}")
