"""Lines on stderr that a terminal only prints."""

from __future__ import annotations

import pytest

from viewer.base.messages import one_line, say_error
from viewer.errors import ContextError, InputError


@pytest.mark.parametrize("text, line", [
    ("a  b\n\tc ", "a b c"), ("caf\xe9 \u8336", "caf\xe9 \u8336"), ("\x1b[31m\x07", "\\x1b[31m\\x07"),
    ("\udcff", "\\udcff"), ("\u202egnp.exe", "\\u202egnp.exe"), ("", ""),
])
def test_one_line(text, line):
    assert one_line(text) == line


def test_errors_are_one_line_and_those_of_contexts_one_for_each_attempt(capsys):
    say_error(InputError("a\nb.glb", "nodes[0]", "is\nbad"))
    say_error(ContextError("no context:\negl: \x1b no\nfix: it"))
    assert capsys.readouterr().err == (
        "pbr-viewer: a b.glb: nodes[0]: is bad\npbr-viewer: no context:\negl: \\x1b no\nfix: it\n")
