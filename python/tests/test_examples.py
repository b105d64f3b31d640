"""The examples run, and the types of package and examples are consistent."""

from __future__ import annotations

import csv
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT, SAMPLES

EXAMPLES = ROOT / "python/examples"


def run_example(name: str, *arguments: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(EXAMPLES / name), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, encoding="utf-8", check=False)


def test_a_folder_of_deployments_becomes_a_table(tmp_path: Path) -> None:
    table = tmp_path / "table.csv"
    result = run_example("calibrate_folder.py", SAMPLES, table)
    assert result.returncode == 0, result.stderr
    with table.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["verdict"] for row in rows if row["station"] == "2"] == ["good", "good"]
    assert len(rows) == 4


def test_a_folder_that_is_no_deployment_is_a_row_with_the_reason(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    result = run_example("calibrate_folder.py", tmp_path, tmp_path / "table.csv")
    assert result.returncode == 0, result.stderr
    assert "empty" in result.stderr


def test_residuals_become_a_picture(tmp_path: Path) -> None:
    result = run_example("plot_residuals.py", SAMPLES / "warthog", tmp_path / "residuals.png")
    assert result.returncode == 0, result.stderr
    assert (tmp_path / "residuals.png").stat().st_size > 10_000


def test_the_readme_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = (ROOT / "python/README.md").read_text(encoding="utf-8")
    blocks = [block.partition("```")[0] for block in text.split("```python\n")[1:]]
    assert blocks
    monkeypatch.chdir(tmp_path)
    (tmp_path / "FOLDER").symlink_to(SAMPLES / "warthog")
    exec("\n".join(blocks), {})


def test_types_are_consistent() -> None:
    checked = ["--package", "resect"], [str(EXAMPLES)]
    for arguments in checked:
        command = [sys.executable, "-m", "mypy", "--config-file", str(ROOT / "python/pyproject.toml"), *arguments]
        result = subprocess.run(command, capture_output=True, text=True, check=False, cwd=EXAMPLES)
        assert result.returncode == 0, result.stdout
