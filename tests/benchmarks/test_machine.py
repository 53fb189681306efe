"""A measurement that is stopped keeps what it has."""

from __future__ import annotations

import os
import signal

import pytest

from benchmarks.machine import until_stopped


def test_a_signal_ends_the_block_alone(capsys: pytest.CaptureFixture[str]) -> None:
    rows = []
    with until_stopped():
        for k in range(3):
            rows.append(k)
            os.kill(os.getpid(), signal.SIGTERM)
    assert rows == [0] and "what was measured by then is kept" in capsys.readouterr().err
    assert signal.getsignal(signal.SIGTERM) == signal.SIG_DFL
