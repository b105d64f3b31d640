"""Bad input is a ResectError with one line; never a panic."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, get_type_hints

import numpy as np
import pytest
import resect
from conftest import SAMPLES
from resect._keywords import OVERRIDE_CHECKS, Overrides, Settings

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


def is_line(call: Callable[[], Any], line: str) -> None:
    refused(call, line)
    with pytest.raises(resect.ResectError) as error:
        call()
    assert str(error.value) == line


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        ({"prism_constant": 0.01}, ("unknown override `prism_constant`", "prism_constant_m")),
        ({"prism_constant_m": NAN}, ("prism_constant_m is NaN",)),
        ({"prism_constant_m": "10 mm"}, ("prism_constant_m",)),
        ({"prism_constant_m": object()}, ("prism_constant_m",)),
        ({"stations": [1, 1, 2]}, ("stations",)),
        ({"stations": np.array([7, 8, 9])}, ()),
        ({"inter_prism_m": [0.0, NAN, 1.0]}, ("inter_prism_m",)),
        ({"prisms": 2}, ("prisms", "[1, 2, 2]")),
        ({"tracks": "missing.csv"}, ("missing.csv",)),
        ({"columns": {"tim": "t"}}, ("columns: unknown field `tim`", "time")),
        ({"columns": {"length_unit": "mile"}}, ("columns:", "mile")),
        ({"span_s": [NAN, INFINITY]}, ()),
        ({"azimuth": "left"}, ("clockwise",)),
        ({"rig": WARTHOG / "nowhere"}, ("nowhere",)),
        ({"gcp": [WARTHOG / "nowhere.txt"]}, ("nowhere.txt",)),
        ({"drives": [WARTHOG / "nowhere"]}, ("nowhere",)),
        ({"masked": [{"station": 9}]}, ()),
        ({"prism_changes": [{"station": 2, "time_s": 1.0}]}, ("prism_changes", "station")),
        ({"prism_changes": [{"station": 2, "time_s": 1.0, "prism": 9}]}, ("prism_changes", "prism 9")),
        ({"stations": [1 << 70, 2, 3]}, ("stations",)),
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
        ({"times_s": [0.0, 1e300]}, ("times_s lies outside of the drive",)),
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
    refused(lambda: resect.evaluate(truth, simulated, truth_station=9), "truth_station is 9; give the number of a station, 1 to 8")
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


@pytest.mark.parametrize(
    ("options", "line"),
    [
        ({"lever_arm_m": [0.1, 0.2]}, "lever_arm_m has 2 numbers; give three, in metres"),
        ({"lever_arm_m": 1.0}, "lever_arm_m is 1.0; give three numbers, in metres"),
        ({"lever_arm_m": [0.1, "0.2", 0.3]}, "lever_arm_m has a value that is '0.2'; give three numbers, in metres"),
        ({"rate": "10"}, "rate is '10'; give a number, in hertz"),
        ({"rate": True}, "rate is True; give a number, in hertz"),
        ({"rate": 1 << 2000}, "rate is too large; give a number, in hertz"),
        ({"times_s": "abc"}, "times_s is 'abc'; give a list of numbers, in seconds"),
        ({"times_s": [[1.0]]}, "times_s has a value that is of type list; give a list of numbers, in seconds"),
        ({"max_error_m": "2\ncm"}, "max_error_m is '2\\ncm'; give a number, in metres"),
        ({"frame": 3}, "frame is 3; give station1 or control-points"),
    ],
    ids=str,
)
def test_a_mistyped_option_of_a_trajectory(answer: resect.Calibration, options: dict[str, Any], line: str) -> None:
    is_line(lambda: answer.trajectory(**options), line)


@pytest.mark.parametrize(
    ("options", "line"),
    [
        ({"body": [0.1, 0.2]}, "body has 2 numbers; give three, in metres"),
        ({"body": 3}, "body is 3; give found, same, or three numbers in metres"),
        ({"time_offset_s": "0"}, "time_offset_s is '0'; give a number, in seconds"),
        ({"align": None}, "align is None; give none, rigid or similarity"),
        ({"as_evo": "yes"}, "as_evo is 'yes'; give True or False"),
        ({"truth_station": "1"}, "truth_station is '1'; give the number of a station, 1 to 8"),
        ({"truth_topic": 3}, "truth_topic is 3; give a name"),
    ],
    ids=str,
)
def test_a_mistyped_option_of_an_evaluation(options: dict[str, Any], line: str) -> None:
    # Before the files are read: there is no such estimate.
    is_line(lambda: resect.evaluate("nowhere.tum", WARTHOG, **options), line)


def test_other_mistyped_arguments() -> None:
    path = "give a path: a string or a pathlib.Path"
    seeds = "give a whole number from 0 to 2**64 - 1"
    is_line(lambda: resect.open(3), f"path is 3; {path}")
    is_line(lambda: resect.open(WARTHOG, rig=3), f"rig is 3; {path}")
    is_line(lambda: resect.open(WARTHOG, gcp=[3]), "gcp has a value that is 3; give a path, or a list of paths")
    is_line(lambda: resect.evaluate(3, "x"), "estimate is 3; give a path, or a list of paths")
    is_line(lambda: resect.evaluate("x", 3), f"against is 3; {path}")
    is_line(lambda: resect.plan(3), f"source is 3; {path}")
    is_line(lambda: resect.plan(preset=3), "preset is 3; give a name")
    is_line(lambda: resect.plan(preset="circle", seed=0.5), f"seed is 0.5; {seeds}")
    is_line(lambda: resect.plan(preset="circle", way=3), f"way is 3; {path}")
    is_line(lambda: resect.plan(preset="circle", target_mm="5"), "target_mm is '5'; give a number, in millimetres")
    is_line(lambda: resect.simulate(3), "preset is 3; give a name")
    is_line(lambda: resect.simulate("circle", seed=-1), f"seed is -1; {seeds}")
    is_line(lambda: resect.simulate("circle", seed=1 << 64), f"seed is {1 << 64}; {seeds}")
    is_line(lambda: resect.simulate("circle", seed="one"), f"seed is 'one'; {seeds}")
    is_line(lambda: resect.simulate("circle", field_errors=2), "field_errors is 2; give True or False")
    simulation = resect.simulate("circle")
    is_line(lambda: simulation.true_trajectory("1"), "rate is '1'; give a number, in hertz")
    is_line(lambda: simulation.write(3), f"folder is 3; {path}")


@pytest.mark.parametrize(
    ("overrides", "line"),
    [
        ({"name": 3}, "name is 3; give a name"),
        ({"tracks": 3}, "tracks is 3; give a name, or a list of names"),
        ({"topics": "a"}, "topics is 'a'; give a list of names"),
        ({"stations": 3}, "stations is 3; give a list of whole numbers"),
        ({"stations": [1, 2, 3.0]}, "stations has a value that is 3.0; give a list of whole numbers"),
        ({"stations": [1 << 70, 2, 3]}, "stations has a value that is too large; give a list of whole numbers"),
        ({"azimuth": "left"}, "azimuth is 'left'; give clockwise or counter-clockwise"),
        ({"prism_constant_m": "0.01"}, "prism_constant_m is '0.01'; give one number, or one for each station, in metres"),
        ({"prism_constant_m": ["1"]}, "prism_constant_m has a value that is '1'; give a list of numbers, in metres"),
        ({"ranges_include_prism_constant": 1}, "ranges_include_prism_constant is 1; give True or False"),
        ({"inter_prism_m": 0.9}, "inter_prism_m is 0.9; give a list of numbers, in metres"),
        ({"prisms": "2"}, "prisms is '2'; give a number of prisms, or the prism of each station"),
        ({"prisms_m": [[0, 0]]}, "prisms_m is not a list of points; give [[x, y, z], [x, y, z], …], in metres"),
        ({"gnss": "a"}, "gnss is 'a'; give three names"),
        ({"control_points": "a"}, "control_points is 'a'; give a list of names"),
        ({"surveys": 3}, "surveys is 3; give a list of names"),
        ({"span_s": [1.0]}, "span_s has 1 number; give two, in seconds"),
        (
            {"masked": [{"station": 9}]},
            'masked is not a list of readings; give a list such as [{"station": 1, "time_s": 12.5}]',
        ),
        ({"masked": [{"station": "1", "time_s": 0.0}]}, "station of masked is '1'; give the number of a station"),
        ({"columns": 3}, "columns is 3; give a dictionary with the keys of [columns] in deployment.toml"),
        ({"columns": {"time": 3}}, "columns: time is 3; give a name"),
    ],
    ids=str,
)
def test_a_mistyped_override(overrides: dict[str, Any], line: str) -> None:
    is_line(lambda: resect.open(WARTHOG, **overrides), line)


def test_each_override_and_setting_refuses_another_type(warthog: resect.Deployment) -> None:
    for name in get_type_hints(Overrides):
        refused(lambda name=name: resect.open(WARTHOG, **{name: object()}), f"{name} is", "; give ")
    for name in get_type_hints(Settings):
        refused(lambda name=name: warthog.calibrate(**{name: object()}), f"{name} is of type object; give ")


@pytest.mark.parametrize(
    ("settings", "line"),
    [
        ({"method": 3}, 'method is 3; give a name, such as "joint", or a letter from "A" to "D"'),
        (
            {"method": "E"},
            "unknown method `E`; methods are two-point (A), static-gcp (B), dynamic-gcp (C), inter-prism (D), joint",
        ),
        ({"tau_s_seconds": "2"}, "tau_s_seconds is '2'; give a number, in seconds"),
        ({"rate_hz": [5.0]}, "rate_hz is of type list; give a number, in hertz"),
        ({"interpolation": "cubic"}, "interpolation is 'cubic'; give linear, gp or wnoa"),
        ({"ranges_wander": 1}, "ranges_wander is 1; give True or False"),
        ({"evidence": 3}, "evidence is 3; give some of drive, control-points, rig, in a string or a list"),
        ({"evidence": {"rig": 1}}, "evidence: rig is 1; give True or False"),
        ({"evidence": ["drives"]}, 'unknown evidence "drives"; name some of drive, control-points, rig'),
    ],
    ids=str,
)
def test_a_mistyped_setting(warthog: resect.Deployment, settings: dict[str, Any], line: str) -> None:
    is_line(lambda: warthog.calibrate(**settings), line)


def test_an_unknown_name_has_the_nearest_one_first(warthog: resect.Deployment) -> None:
    for name, near in {
        "tau_s": "tau_s_seconds",
        "clock_offset": "clock_offset_s",
        "intrepolation": "interpolation",
        "methods": "method",
    }.items():
        line = f"unknown setting `{name}`; did you mean {near}? All settings: outlier_filter, "
        refused(lambda name=name: warthog.calibrate(**{name: 1}), line)
    for name, near in {"prism_constant": "prism_constant_m", "controlpoints": "control_points", "rigs": "rig"}.items():
        line = f"unknown override `{name}`; did you mean {near}? All overrides: name, "
        refused(lambda name=name: resect.open(WARTHOG, **{name: 1}), line)
    # Arguments of the call are near names too.
    refused(lambda: resect.evaluate("x", WARTHOG, time_offset=1), "did you mean time_offset_s?")
    refused(lambda: resect.plan(WARTHOG, target=1), "did you mean target_mm?")
    refused(lambda: warthog.run_pipeline(xyz=None), "unknown setting `xyz`; settings are outlier_filter, ")


def test_times_outside_of_the_drive(answer: resect.Calibration, warthog: resect.Deployment) -> None:
    times_s = [track.time_s[end] for track in warthog.tracks for end in (0, -1)]
    drive = f"{min(times_s):.1f} to {max(times_s):.1f} s"
    line = f"span_s contains no reading; the drive is {drive}"
    is_line(lambda: resect.open(WARTHOG, span_s=[0.0, 1.0]), line)
    outside = f"times_s lies outside of the drive, which is {drive}"
    is_line(lambda: answer.trajectory(times_s=[min(times_s) - 1, max(times_s) + 1]), outside)
    # One time within is enough, and a span with readings is used.
    middle_s = float(answer.trajectory().time_s[100])
    assert answer.trajectory(times_s=[0.0, middle_s]).time_s.tolist() == [middle_s]
    assert resect.open(WARTHOG, span_s=[middle_s - 50, middle_s + 50]).run_pipeline().time_s.size > 100


def test_an_error_is_a_value_error_that_can_be_imported() -> None:
    assert issubclass(resect.ResectError, ValueError)
    assert f"{resect.ResectError.__module__}.{resect.ResectError.__qualname__}" == "resect.ResectError"


def test_typed_keywords_are_those_that_are_read(warthog: resect.Deployment) -> None:
    # The native functions list their names.
    with pytest.raises(resect.ResectError) as error:
        warthog._handle.run_pipeline({"no_setting": 1})
    names = str(error.value).partition("settings are ")[2].split(", ")
    assert set(names) - {"method"} == set(get_type_hints(Settings))
    with pytest.raises(resect.ResectError) as error:
        resect._native.open(WARTHOG, {"corrections": {"no_override": 1}})
    words = str(error.value).partition("expected one of ")[2].partition(";")[0]
    # `rig` is an argument of its own.
    assert {word.strip("` ") for word in words.split(",")} - {"rig"} == set(get_type_hints(Overrides))
    assert set(OVERRIDE_CHECKS) == set(get_type_hints(Overrides))
