from __future__ import annotations

import pytest


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    """Tests here neither read nor fill the user's cache."""
    monkeypatch.setenv("PBR_VIEWER_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"
