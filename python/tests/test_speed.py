"""Durations of a joint estimate by call: `pytest python/tests -k speed -s` prints a line for each drive."""

from __future__ import annotations

import statistics
import time
from pathlib import Path

import pytest
import resect
from conftest import FIELD_RUN, field_drives

REPEATS = 21
# 24 ms on an idle machine; tests share theirs with others.
LONGEST_OF_FIELD_RUN_MS = 60.0


@pytest.mark.parametrize("folder", field_drives(), ids=lambda folder: folder.name)
def test_speed_of_a_joint_estimate(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # With it, the JSON has no durations.
    monkeypatch.delenv("SOURCE_DATE_EPOCH")
    deployment = resect.open(folder)
    calls_ms, overheads_ms = [], []
    for _ in range(REPEATS):
        began_s = time.perf_counter()
        answer = deployment.calibrate()
        calls_ms.append(1e3 * (time.perf_counter() - began_s))
        own_ms = answer.to_dict()["time_ms"]
        overheads_ms.append(calls_ms[-1] - (own_ms["total"] - own_ms["load"]))
    fastest_ms, overhead_ms = min(calls_ms), statistics.median(overheads_ms)
    print(
        f"\n{folder.name}: fastest {fastest_ms:.1f} ms, median {statistics.median(calls_ms):.1f} ms by call;", end=" "
    )
    print(f"{overhead_ms:.2f} ms of it outside of pipeline, estimate and evaluation")
    assert overhead_ms < 1.0
    if folder == FIELD_RUN:
        assert fastest_ms < LONGEST_OF_FIELD_RUN_MS
