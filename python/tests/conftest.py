"""Data of the tests: the samples of the repository, and the field data where it is there."""

from __future__ import annotations

import json
import os
import subprocess
import sysconfig
from pathlib import Path
from typing import Any

import pytest
import resect

ROOT = Path(__file__).parents[2]
DATASETS = ROOT.parent / "shared" / "datasets"
SAMPLES = ROOT / "crates/resect-io/assets/samples"
PROGRAM = Path(sysconfig.get_path("scripts")) / ("resect.exe" if os.name == "nt" else "resect")
FIELD_RUN = DATASETS / "2022-07-11-2"
# Outputs without durations, so that they can be compared.
os.environ["SOURCE_DATE_EPOCH"] = "1657500000"


def field_drives() -> list[Path]:
    """The drives of the field, each with another instrument or place; empty without the data."""
    if not FIELD_RUN.is_dir():
        return []
    return [FIELD_RUN, *sorted(path for path in (DATASETS / "real").iterdir() if path.is_dir())]


def deployments() -> list[Path]:
    return [*sorted(path for path in SAMPLES.iterdir() if path.is_dir()), *field_drives()]


def run(*arguments: object) -> subprocess.CompletedProcess[str]:
    """Runs the program that the wheel installed."""
    command = [str(PROGRAM), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, encoding="utf-8", check=False)


def printed(*arguments: object) -> Any:
    """Returns the JSON that the program prints."""
    result = run(*arguments, "--json")
    assert result.returncode == 0, result.stderr
    return json.loads(result.stdout)


def complaint(*arguments: object) -> str:
    """Returns the line with which the program refuses its arguments."""
    result = run(*arguments)
    assert result.returncode != 0, result.stdout
    return result.stderr.strip().removeprefix("resect: ")


@pytest.fixture(scope="session")
def warthog() -> resect.Deployment:
    return resect.open(SAMPLES / "warthog")


@pytest.fixture(scope="session")
def answer(warthog: resect.Deployment) -> resect.Calibration:
    return warthog.calibrate()


@pytest.fixture(scope="session")
def simulated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of simulated readings, with the true poses beside it as truth.tum."""
    folder = tmp_path_factory.mktemp("simulated") / "warthog"
    result = run("simulate", "--preset", "warthog", "--out", folder, "--true-poses", folder.parent / "truth.tum")
    assert result.returncode == 0, result.stderr
    return folder
