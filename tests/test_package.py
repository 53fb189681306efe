"""What `import viewer` offers."""

from __future__ import annotations

import subprocess
import sys

import pytest

import viewer


@pytest.mark.parametrize("name", viewer.__all__)
def test_every_promised_name_is_there(name):
    assert getattr(viewer, name).__name__ == name


def test_a_wrong_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no attribute 'lode'"):
        viewer.lode  # noqa: B018


def test_importing_it_imports_nothing_heavy():
    code = "import sys, viewer; print({'numpy', 'PIL', 'moderngl'} & set(sys.modules))"
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert shown.stdout.strip() == "set()"
