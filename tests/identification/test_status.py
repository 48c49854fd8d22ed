"""Statuses order themselves, keep every reason, and read like strings."""

from __future__ import annotations

import json

import numpy as np
import pytest

from jackettwin.findings import Finding
from jackettwin.identification import ModalEstimate
from jackettwin.identification.status import ModeStatus, worse

PLAIN = ModalEstimate(0.3, 0.01, np.ones(2, complex), 1.0, 0.0, 1.0)
TONE = Finding("steady_tone_near", params={"frequency_hz": 0.31})
ORDER = Finding("rotor_order_passes", params={"order": 3})


def test_a_status_is_a_string_in_code_and_in_json():
    assert PLAIN.status == "ok"
    assert json.dumps(PLAIN.status) == '"ok"'
    assert PLAIN.status_reason is None


def test_the_worse_status_wins_and_every_reason_stays():
    mode = PLAIN.flagged(ModeStatus.DOUBTFUL, TONE).flagged(ModeStatus.DAMPING_UNKNOWN, ORDER)
    assert mode.status == "doubtful"
    assert [finding.code for finding in mode.reasons] == ["steady_tone_near", "rotor_order_passes"]
    assert "0.31 Hz" in mode.status_reason and "3P" in mode.status_reason
    assert PLAIN.status == "ok"


@pytest.mark.parametrize("status", list(ModeStatus))
def test_what_is_no_mode_says_so(status):
    assert status.is_a_mode != status.value.startswith("not a mode")
    assert worse(status, ModeStatus.OK) is status
