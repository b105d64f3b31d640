"""Forty deployments by each way of parallel Python, with the results of a serial run; Ctrl-C."""

from __future__ import annotations

import json
import multiprocessing
import os
import signal
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
import resect

COUNT = 40
WORKERS = 4
# A call that never returns fails the test instead of stopping the whole run.
LONGEST_S = 120.0
HAS_FORK = "fork" in multiprocessing.get_all_start_methods()


def calibrate(seed: int) -> str:
    """Simulates and calibrates a deployment; every digit of its answer."""
    answer = resect.simulate("warthog", seed=seed).deployment.calibrate()
    return json.dumps(answer.to_dict(), sort_keys=True)


def threads_of_a_call(_: int = 0) -> int:
    """Number of threads of the pool. A thread has its name only once it runs, so the largest of several counts is taken."""
    resect.simulate("figure-eight", seed=1)
    count = 0
    for _ in range(20):
        names = [file.read_text() for file in Path("/proc/self/task").glob("*/comm")]
        count = max(count, sum(name.startswith("resect") for name in names))
        time.sleep(0.01)
    return count


def by_processes(method: str, work: Callable[[int], Any], numbers: Iterable[int]) -> list[Any]:
    with multiprocessing.get_context(method).Pool(WORKERS) as pool:
        return pool.map_async(work, numbers, chunksize=1).get(LONGEST_S)


def by_executor(numbers: Iterable[int]) -> list[str]:
    method = "fork" if HAS_FORK else "spawn"
    with ProcessPoolExecutor(WORKERS, multiprocessing.get_context(method)) as pool:
        return list(pool.map(calibrate, numbers, timeout=LONGEST_S))


def by_threads(numbers: Iterable[int]) -> list[str]:
    with ThreadPoolExecutor(WORKERS) as pool:
        return list(pool.map(calibrate, numbers, timeout=LONGEST_S))


def by_joblib(numbers: Iterable[int]) -> list[str]:
    import joblib

    parallel = joblib.Parallel(n_jobs=WORKERS, timeout=LONGEST_S)
    return list(parallel(joblib.delayed(calibrate)(number) for number in numbers))


def by_dask(numbers: Iterable[int]) -> list[str]:
    import distributed

    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=2, dashboard_address=None) as cluster,  # type: ignore[no-untyped-call]
        distributed.Client(cluster) as client,  # type: ignore[no-untyped-call]
    ):
        return list(client.gather(client.map(calibrate, numbers), asynchronous=False))


WAYS: dict[str, Callable[[Iterable[int]], list[str]]] = {
    "fork": lambda numbers: by_processes("fork", calibrate, numbers),
    "spawn": lambda numbers: by_processes("spawn", calibrate, numbers),
    "executor": by_executor,
    "threads": by_threads,
    "joblib": by_joblib,
    "dask": by_dask,
}


@pytest.fixture(scope="module")
def serial() -> list[str]:
    """Answers one after another; this process has used its threads before a fork copies it."""
    return [calibrate(number) for number in range(COUNT)]


@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize("way", WAYS)
def test_parallel_answers_are_those_of_a_serial_run(way: str, serial: list[str]) -> None:
    if way == "fork" and not HAS_FORK:
        pytest.skip("this system has no fork")
    assert WAYS[way](range(COUNT)) == serial


@pytest.mark.skipif(not HAS_FORK, reason="this system has no fork")
@pytest.mark.filterwarnings("default")
def test_plans_are_made_after_a_fork() -> None:
    here = str(resect.plan(preset="warthog", seed=3))
    assert by_processes("fork", plan_text, [3, 3]) == [here, here]


def plan_text(seed: int) -> str:
    return str(resect.plan(preset="warthog", seed=seed))


@pytest.mark.skipif(not os.path.isdir("/proc/self/task"), reason="the threads are counted on Linux only")
@pytest.mark.filterwarnings("default")
def test_workers_have_one_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("RAYON_NUM_THREADS", raising=False)
    assert threads_of_a_call() == os.cpu_count()
    for method in ("fork", "spawn"):
        assert set(by_processes(method, threads_of_a_call, range(4))) == {1}
    monkeypatch.setenv("RAYON_NUM_THREADS", "3")
    assert set(by_processes("spawn", threads_of_a_call, range(4))) == {3}


LONG_CALL = """
import sys, time
import resect
print("begins", flush=True)
try:
    while True:
        resect.plan(preset="hd2-tunnel", seed=1)
except KeyboardInterrupt:
    print(time.time(), flush=True)
resect.simulate("figure-eight", seed=1)
print("goes on", flush=True)
"""


@pytest.mark.skipif(os.name == "nt", reason="the signal is sent as Linux and macOS do")
@pytest.mark.parametrize("after_s", [0.05, 0.3, 0.7])
def test_ctrl_c_ends_a_call_within_a_tenth_of_a_second(after_s: float) -> None:
    # Other processes on the same cores delay some answers, but not most.
    delays_s = [ctrl_c_ends_a_call_after_s(after_s) for _ in range(5)]
    assert statistics.median(delays_s) < 0.1, delays_s


def ctrl_c_ends_a_call_after_s(after_s: float) -> float:
    with subprocess.Popen([sys.executable, "-c", LONG_CALL], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "begins\n"
        time.sleep(after_s)
        sent_s = time.time()
        process.send_signal(signal.SIGINT)
        ended_s = float(process.stdout.readline())
        assert process.stdout.readline() == "goes on\n"
    assert process.returncode == 0
    return ended_s - sent_s
