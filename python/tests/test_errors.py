"""Bad input is a ResectError with one line, or a TypeError of the call; never a panic."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, get_type_hints

import numpy as np
import pytest
import resect
from conftest import SAMPLES
from resect._keywords import Overrides, Settings

NAN, INFINITY = float("nan"), float("inf")
WARTHOG = SAMPLES / "warthog"


def refused(call: Callable[[], Any], *words: str) -> None:
    with pytest.raises(resect.ResectError) as error:
        call()
    line = str(error.value)
    assert line and "\n" not in line
    assert "a fault of resect" not in line, line
    for word in words:
        assert word in line, line


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        ({"prism_constant": 0.01}, ("unknown field `prism_constant`", "prism_constant_m")),
        ({"prism_constant_m": NAN}, ("prism_constant_m is NaN",)),
        ({"prism_constant_m": "10 mm"}, ("overrides",)),
        ({"prism_constant_m": object()}, ("corrections",)),
        ({"stations": [1, 1, 2]}, ("stations",)),
        ({"stations": [1, 2]}, ("overrides",)),
        ({"stations": np.array([7, 8, 9])}, ()),
        ({"inter_prism_m": [0.0, NAN, 1.0]}, ("inter_prism_m",)),
        ({"prisms": 2}, ("prisms must be 1",)),
        ({"tracks": "missing.csv"}, ("missing.csv",)),
        ({"columns": {"time": 3}}, ()),
        ({"span_s": [NAN, INFINITY]}, ()),
        ({"azimuth": "left"}, ("clockwise",)),
        ({"rig": WARTHOG / "nowhere"}, ("nowhere",)),
        ({"gcp": [WARTHOG / "nowhere.txt"]}, ("nowhere.txt",)),
        ({"drives": [WARTHOG / "nowhere"]}, ("nowhere",)),
        ({"masked": [{"station": 9}]}, ()),
        ({"stations": [1 << 70, 2, 3]}, ("corrections",)),
    ],
    ids=str,
)
def test_overrides(overrides: dict[str, Any], words: tuple[str, ...]) -> None:
    refused(lambda: resect.open(WARTHOG, **overrides), *words)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"method": "best"}, ("best", "two-point", "inter-prism")),
        ({"tau_s": 2.0}, ("unknown setting `tau_s`", "tau_s_seconds")),
        ({"thresholds": {}}, ("unknown setting `thresholds`",)),
        ({"tau_s_seconds": NAN}, ("tau_s",)),
        ({"tau_s_seconds": -1}, ("tau_s",)),
        ({"tau_s_seconds": "2"}, ("tau_s_seconds",)),
        ({"tau_s_seconds": [1.0]}, ("tau_s_seconds",)),
        ({"rate_hz": INFINITY}, ("rate",)),
        ({"rate_hz": 1e300}, ("rate",)),
        ({"outlier_filter": 1}, ("outlier_filter",)),
        ({"interpolation": "cubic"}, ("interpolation", "linear")),
        ({"prior": None, "alignment": "free"}, ("alignment",)),
        ({"evidence": "rig"}, ("control-points",)),
        ({"evidence": "drives"}, ("drives",)),
        ({"evidence": {"rigs": True}}, ("rigs",)),
        ({"clock_offset_s": NAN}, ("clock_offset_s",)),
        ({"inter_prism_sigma_m": NAN}, ("inter_prism_sigma_m",)),
        ({"errors": {"latency_s": 1.0}}, ("unknown setting `errors`",)),
    ],
    ids=str,
)
def test_settings(warthog: resect.Deployment, settings: dict[str, Any], words: tuple[str, ...]) -> None:
    refused(lambda: warthog.calibrate(**settings), *words)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"rate": 0.0}, ("rate is 0 Hz",)),
        ({"rate": -1.0}, ("rate is -1 Hz",)),
        ({"rate": NAN}, ("rate is NaN Hz",)),
        ({"rate": 1e9}, ("10000 at most",)),
        ({"rate": 1.0, "times_s": [1.0]}, ("exclude each other",)),
        ({"times_s": [NAN]}, ("not finite",)),
        ({"times_s": []}, ("no pose",)),
        ({"times_s": [0.0, 1e300]}, ("no pose",)),
        ({"max_error_m": 0.0}, ("max_error_m",)),
        ({"max_error_m": NAN}, ("max_error_m",)),
        ({"lever_arm_m": [0.0, NAN, 0.0]}, ("lever_arm_m",)),
        ({"frame": "map"}, ("control-points",)),
    ],
    ids=str,
)
def test_trajectories(answer: resect.Calibration, options: dict[str, Any], words: tuple[str, ...]) -> None:
    refused(lambda: answer.trajectory(**options), *words)


def test_trajectories_that_the_data_does_not_have() -> None:
    prism = resect.simulate("single-prism").deployment
    refused(lambda: prism.calibrate().trajectory(lever_arm_m=[1.0, 0.0, 0.0]), "lever arm")
    refused(lambda: prism.calibrate("dynamic-gcp").trajectory(), 'method="joint"')
    tunnel = resect.open(SAMPLES / "hd2-tunnel").calibrate()
    refused(lambda: tunnel.trajectory(frame="control-points"), "control point")


def test_files(tmp_path: Path) -> None:
    for name, content in {
        "empty.csv": b"",
        "zeros.csv": bytes(4096),
        "half.csv": (WARTHOG / "inter_prism.csv").read_bytes()[:100],
        "text.csv": b"no table\n" * 100,
        "image.bag": b"#ROSBAG V2.0\n" + bytes(100),
        "image.mcap": b"\x89MCAP0\r\n" + bytes(100),
    }.items():
        file = tmp_path / name
        file.write_bytes(content)
        refused(lambda file=file: resect.open(file).calibrate(), file.stem)
        refused(lambda file=file: resect.evaluate(file, WARTHOG))
        refused(lambda file=file: resect.evaluate(WARTHOG / "inter_prism.csv", file))
    refused(lambda: resect.open(""))
    refused(lambda: resect.open("a\nb"), "a\\nb")
    refused(lambda: resect.open("a\0b"))
    # Readings that are not numbers are counted, and leave nothing to calibrate.
    folder = tmp_path / "nan"
    folder.mkdir()
    header, *rows = (WARTHOG / "inter_prism.csv").read_text(encoding="utf-8").splitlines()
    empty_rows = [row.rpartition(",")[0] + ",nan" for row in rows]
    (folder / "inter_prism.csv").write_text("\n".join([header, *empty_rows]), encoding="utf-8")
    refused(lambda: resect.open(folder).calibrate())
    # One station alone has a track, and no calibration.
    alone = tmp_path / "alone"
    alone.mkdir()
    first = [row for row in rows if row.split(",")[1] == "1"]
    (alone / "inter_prism.csv").write_text("\n".join([header, *first]), encoding="utf-8")
    refused(lambda: resect.open(alone).calibrate())


def test_evaluations(simulated: Path) -> None:
    truth = simulated.parent / "truth.tum"
    refused(lambda: resect.evaluate("nowhere.tum", simulated), "nowhere.tum")
    refused(lambda: resect.evaluate([], simulated))
    refused(lambda: resect.evaluate(truth, "nowhere"), "nowhere")
    refused(lambda: resect.evaluate(truth, simulated, align="best"), "align", "similarity")
    refused(lambda: resect.evaluate(truth, simulated, body="mine"), "found, same")
    refused(lambda: resect.evaluate(truth, simulated, body=[0.0, NAN, 0.0]), "body")
    refused(lambda: resect.evaluate(truth, simulated, time_offset_s=NAN), "time_offset_s")
    refused(lambda: resect.evaluate(truth, simulated, time_offset_s=1e300))
    refused(lambda: resect.evaluate(truth, simulated, truth_station=4), "stations are 1, 2, 3")
    refused(lambda: resect.evaluate(truth, truth, truth_station=1), "truth_station")
    refused(lambda: resect.evaluate(truth, truth, truth_topic="/odom", tau=1.0), "unknown setting")


def test_plans_and_simulations(tmp_path: Path, warthog: resect.Deployment) -> None:
    refused(lambda: resect.plan("nowhere.toml"), "nowhere.toml")
    refused(lambda: resect.plan(), "one source")
    refused(lambda: resect.plan(warthog, preset="circle"), "one source")
    refused(lambda: resect.plan(preset="spiral"), "spiral", "figure-eight")
    refused(lambda: resect.plan(preset="circle", target_mm=NAN), "target_mm")
    refused(lambda: resect.plan(preset="circle", way=tmp_path / "nowhere.csv"), "nowhere.csv")
    (tmp_path / "plan.toml").write_text("stations_m = 3\n")
    refused(lambda: resect.plan(tmp_path / "plan.toml"), "plan.toml:1")
    refused(lambda: resect.simulate("spiral"), "figure-eight")
    simulation = resect.simulate("circle")
    refused(lambda: simulation.true_trajectory(0.0), "rate is 0 Hz")
    refused(lambda: simulation.true_trajectory(NAN), "rate is NaN Hz")
    (tmp_path / "file").write_text("")
    refused(lambda: simulation.write(tmp_path / "file"), "file")


def test_wrong_types_are_errors_of_the_call(answer: resect.Calibration) -> None:
    calls: list[Callable[[], Any]] = [
        lambda: resect.open(3),
        lambda: resect.evaluate(3, "x"),
        lambda: answer.trajectory("fast"),
        lambda: answer.trajectory(lever_arm_m=[1.0, 2.0]),
        lambda: answer.trajectory(times_s=[[1.0]]),
        lambda: resect.simulate("circle", seed="one"),
        lambda: resect.simulate(3),
    ]
    for call in calls:
        with pytest.raises((TypeError, ValueError)) as error:
            call()
        assert "panic" not in str(error.value).lower()
    with pytest.raises((OverflowError, TypeError)):
        resect.simulate("circle", seed=-1)


def test_an_error_is_a_value_error_that_can_be_imported() -> None:
    assert issubclass(resect.ResectError, ValueError)
    assert f"{resect.ResectError.__module__}.{resect.ResectError.__qualname__}" == "resect.ResectError"


def test_typed_keywords_are_those_that_are_read(warthog: resect.Deployment) -> None:
    with pytest.raises(resect.ResectError) as error:
        warthog.run_pipeline(no_setting=1)
    names = str(error.value).partition("settings are ")[2].split(", ")
    assert set(names) - {"method"} == set(get_type_hints(Settings))
    with pytest.raises(resect.ResectError) as error:
        resect.open(WARTHOG, no_override=1)
    words = str(error.value).partition("expected one of ")[2].partition(";")[0]
    # `rig` is an argument of its own.
    assert {word.strip("` ") for word in words.split(",")} - {"rig"} == set(get_type_hints(Overrides))
