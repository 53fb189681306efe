from __future__ import annotations

import json
import signal
import sys

import pytest
from needs import needs

from viewer.errors import ContextError
from viewer.gpu import probe
from viewer.gpu.context import open_context
from viewer.jobs import doctor


def test_agrees_with_open_context() -> None:
    findings = doctor.diagnose()
    json.dumps([finding.to_json() for finding in findings])
    try:
        open_context().release()
        status = 0
    except ContextError:
        status = 3
    assert doctor.exit_status(findings) == status
    for finding in findings:
        assert finding.works == (finding.problem == "") == (finding.fix == "")
        assert not finding.works or (finding.renderer and finding.version)
    text = doctor.format_findings(findings)
    assert all(finding.backend in text for finding in findings)


def test_nothing_works(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "probe", lambda *_: {"problem": "no display"})
    findings = doctor.diagnose()
    assert doctor.exit_status(findings) == 3
    assert all(finding.fix for finding in findings)
    assert "no picture can be made" in doctor.format_findings(findings)


def test_missing_device_has_a_reason() -> None:
    problem = probe.probe("egl", 99)["problem"]
    assert problem
    assert "Traceback" not in problem and "\n" not in problem


@needs("posix")
def test_a_crash_of_the_driver_is_a_finding(monkeypatch: pytest.MonkeyPatch, tmp_path) -> None:
    crashing = tmp_path / "python"
    crashing.write_text(f"#!/bin/sh\nkill -{signal.SIGSEGV.value} $$\n")
    crashing.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(crashing))
    assert probe.probe("egl", 0) == {"problem": "the driver crashed (SIGSEGV)"}
