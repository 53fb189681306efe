"""One small report that several tests look at."""

from __future__ import annotations

from pathlib import Path

import pytest
from quick_report import MODEL, QUICK

from viewer import cli


@pytest.fixture(scope="session")
def report_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What `pbr-viewer report` wrote."""
    folder = tmp_path_factory.mktemp("report") / "spheres"
    with pytest.raises(SystemExit) as ended:
        cli.main(["report", str(MODEL), "-o", str(folder), *QUICK])
    assert not ended.value.code
    return folder
