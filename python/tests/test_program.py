"""The numbers and lines of the module are those of the program."""

from __future__ import annotations

import csv
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import resect
from conftest import SAMPLES, complaint, deployments, printed, run


@pytest.mark.parametrize("folder", deployments(), ids=lambda folder: folder.name)
def test_a_calibration_is_the_object_that_the_program_prints(folder: Path) -> None:
    answer = resect.open(folder).calibrate()
    expected = printed("calibrate", folder)
    assert answer.to_dict() == expected
    assert answer.verdict == expected["diagnosis"]["verdict"]
    assert answer.transforms[1].matrix.tolist() == expected["transforms"][1]["matrix"]
    survey = [transform.matrix.tolist() for transform in answer.survey_transforms or ()]
    assert survey == [transform["matrix"] for transform in expected.get("survey_transforms", ())]
    assert answer.covariance is not None
    assert answer.covariance.tolist() == expected["covariance"]
    assert list(answer.findings) == list(dict.fromkeys(f["code"] for f in expected["diagnosis"]["findings"]))
    assert answer.table["value"].tolist() == [row["value"] for row in expected["rows"]]


def test_the_wheel_contains_the_program_of_its_version() -> None:
    assert run("--version").stdout.split()[:2] == ["resect", resect.__version__]


def test_methods_and_settings_are_those_of_the_program(warthog: resect.Deployment) -> None:
    for method in ("two-point", "static-gcp", "inter-prism", "joint"):
        expected = printed("calibrate", SAMPLES / "warthog", "--method", method, "--tau-s", "2", "--alignment", "rigid")
        answer = warthog.calibrate(method, tau_s_seconds=2, alignment="rigid")
        assert answer.to_dict() == expected, method
    by_drive = printed("calibrate", SAMPLES / "warthog", "--evidence", "drive,rig")
    assert warthog.calibrate(evidence="drive,rig").to_dict() == by_drive
    same: list[Any] = [
        {"control_points": False},
        {"control-points": False},
        ["drive", "rig"],
        ("rig", "drive"),
        np.array(["drive", "rig"]),
    ]
    for evidence in same:
        assert warthog.calibrate(evidence=evidence).to_dict() == by_drive, evidence
    by_points = printed("calibrate", SAMPLES / "warthog", "--evidence", "drive,control-points")
    for evidence in ("drive, control_points", ["drive", "control_points"], ["control-points", "drive"]):
        assert warthog.calibrate(evidence=evidence).to_dict() == by_points, evidence


def test_methods_have_letters(warthog: resect.Deployment) -> None:
    for letter, name in zip("ABD", ("two-point", "static-gcp", "inter-prism")):
        expected = warthog.calibrate(name).to_dict()
        assert expected["method"] == name
        for method in (letter, letter.lower()):
            assert warthog.calibrate(method).to_dict() == expected
    prism = resect.simulate("single-prism").deployment
    assert prism.calibrate("c").method == prism.calibrate("C").method == "dynamic-gcp"


def test_doubts_and_the_recommendation_are_those_of_the_program(warthog: resect.Deployment) -> None:
    circle = resect.simulate("circle").deployment
    answers = [warthog.calibrate(), circle.calibrate(), circle.calibrate("inter-prism")]
    for answer in answers:
        expected = answer.to_dict()
        doubts = expected["diagnosis"]["doubts"]
        assert [one.message for found in answer.doubts.values() for one in found] == [one["message"] for one in doubts]
        assert all(one.severity != "note" for found in answer.doubts.values() for one in found)
        assert answer.recommended_method == expected["recommendation"]["answer"]
        assert answer.reason == expected["recommendation"]["reason"]
    assert not answers[0].doubts and (answers[0].recommended_method, answers[0].reason) == ("joint", "good")
    assert (answers[1].recommended_method, answers[1].reason) == ("joint", "doubtful")
    assert list(answers[1].doubts) == ["drive-circle"]
    assert (answers[2].recommended_method, answers[2].reason) == (None, "degenerate")
    assert len(answers[2].doubts) < len(answers[2].findings)


def test_files_and_overrides_are_those_of_the_program(tmp_path: Path) -> None:
    tunnel, warthog = SAMPLES / "hd2-tunnel", SAMPLES / "warthog"
    alone = tmp_path / "alone"
    alone.mkdir()
    shutil.copy(tunnel / "inter_prism.csv", alone)
    by_rig = printed("calibrate", alone, "--rig", tunnel)
    assert resect.open(alone, rig=tunnel).calibrate().to_dict() == by_rig
    points = warthog / "GCP_raw_2.txt"
    assert resect.open(warthog, gcp=points).calibrate().to_dict() == printed("calibrate", warthog, "--gcp", points)
    assert resect.open(warthog, gcp=points).calibrate().to_dict() != printed("calibrate", warthog)
    with pytest.raises(resect.ResectError) as error:
        resect.open(warthog, drives=[tunnel]).calibrate()
    same_line(str(error.value), complaint("calibrate", warthog, "--drive", tunnel), {})
    header, *rows = (warthog / "inter_prism.csv").read_text(encoding="utf-8").splitlines()
    halves = [tmp_path / "morning", tmp_path / "noon"]
    for folder, own_rows in zip(halves, (rows[:1500], rows[1500:])):
        shutil.copytree(warthog, folder)
        (folder / "inter_prism.csv").write_text("\n".join([header, *own_rows]), encoding="utf-8")
    both = resect.open(halves[0], drives=halves[1]).calibrate().to_dict()
    assert both == printed("calibrate", halves[0], "--drive", halves[1])
    assert len(both["details"]["joint"]["drives"]) == 2
    # Keywords replace keys of a file.
    overrides = {"prism_constant_m": [0.01, 0.02, 0.03], "stations": (1, 3, 2), "control_points": []}
    changed = tmp_path / "changed"
    shutil.copytree(warthog, changed)
    lines = 'name = "changed"\nprism_constant_m = [0.01, 0.02, 0.03]\nstations = [1, 3, 2]\ncontrol_points = []\n'
    (changed / "deployment.toml").write_text(lines)
    by_keywords = resect.open(warthog, name="changed", **overrides)
    assert by_keywords.name == "changed"
    by_file = resect.open(changed)
    for own, other in zip(by_keywords.tracks, by_file.tracks):
        assert own.range_m.tolist() == other.range_m.tolist()
        assert own.prism_constant_m == other.prism_constant_m
    assert [track.prism_constant_m for track in by_keywords.tracks] == [0.01, 0.02, 0.03]


def test_the_trace_is_that_of_the_program(warthog: resect.Deployment, answer: resect.Calibration) -> None:
    expected = printed("calibrate", SAMPLES / "warthog", "--trace")["trace"]
    assert answer.solver_status == expected["status"] == "converged"
    assert answer.trace["phase"].tolist() == [step["phase"] for step in expected["steps"]]
    assert answer.trace["events"].tolist() == ["; ".join(step["events"]) for step in expected["steps"]]
    lengths = [np.nan if step["squared_length"] is None else step["squared_length"] for step in expected["steps"]]
    np.testing.assert_equal(answer.trace["squared_length"], lengths)
    published = warthog.calibrate("inter-prism")
    assert published.solver_status is None and len(published.trace["phase"]) == 0


def test_the_text_is_that_of_the_program(answer: resect.Calibration) -> None:
    assert run("calibrate", SAMPLES / "warthog").stdout.startswith(str(answer))


def rows_of(path: Path) -> dict[str, np.ndarray]:
    with path.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}


@pytest.mark.parametrize("folder", deployments(), ids=lambda folder: folder.name)
def test_a_trajectory_is_the_file_that_the_program_writes(folder: Path, tmp_path: Path) -> None:
    answer = resect.open(folder).calibrate()
    for rate in (None, 5.0):
        file = tmp_path / "drive.csv"
        result = run("trajectory", folder, "--out", file, *(["--pose-rate", rate] if rate else []))
        assert result.returncode == 0, result.stderr
        expected = rows_of(file)
        trajectory = answer.trajectory(rate)
        table = trajectory.table
        # The shortest drive of the field, 20221205-2, has poses at 60 triplets.
        assert len(trajectory) == len(expected["timestamp_s"]) >= 60
        # The file has microseconds, micrometres and seven significant digits of the covariance.
        assert np.allclose(table["time_s"], expected["timestamp_s"], rtol=0, atol=1e-6)
        for name in set(table) & set(expected):
            assert np.allclose(table[name], expected[name], rtol=0, atol=1e-6), name
        places = np.triu_indices(trajectory.covariance.shape[1])
        names = [name for name in expected if name.startswith("cov_")]
        covariance = np.array([expected[name] for name in names]).T
        assert np.allclose(trajectory.covariance[:, places[0], places[1]], covariance, rtol=1e-6, atol=1e-15)


def test_poses_of_a_sensor_in_the_frame_of_the_control_points(answer: resect.Calibration, tmp_path: Path) -> None:
    file, times = tmp_path / "drive.csv", tmp_path / "times.csv"
    triplets = answer.trajectory()
    times_s = [round(float(time_s), 6) for time_s in triplets.time_s[100:200:10]]
    times.write_text("\n".join(map(str, times_s)))
    flags = ("--lever-arm", "1,0,0.5", "--frame", "control-points", "--max-error", 8, "--at", times)
    lever_m = np.array([1.0, 0.0, 0.5])
    options = {"lever_arm_m": lever_m, "max_error_m": 0.008, "times_s": np.array(times_s)}
    result = run("trajectory", SAMPLES / "warthog", *flags, "--out", file)
    assert result.returncode == 0, result.stderr
    trajectory = answer.trajectory(frame="control-points", **options)
    expected = rows_of(file)
    assert trajectory.frame in result.stdout
    assert np.allclose(trajectory.position_m[:, 0], expected["x_m"], rtol=0, atol=1e-6)
    assert np.allclose(trajectory.sigma_position_m[:, 2], expected["sigma_z_m"], rtol=0, atol=1e-6)
    # A lever arm and another frame do change the poses.
    assert not np.allclose(trajectory.position_m, answer.trajectory(**options).position_m, atol=0.1)
    assert not np.allclose(trajectory.position_m, triplets.position_m[100:200:10], atol=0.1)


def test_an_evaluation_is_the_object_that_the_program_prints(simulated: Path) -> None:
    estimate = simulated.parent / "truth.tum"
    evaluation = resect.evaluate(estimate, simulated)
    assert evaluation.to_dict() == printed("evaluate", estimate, "--against", simulated)
    assert str(evaluation) == run("evaluate", estimate, "--against", simulated).stdout
    assert resect.evaluate([estimate], resect.open(simulated)).to_dict() == evaluation.to_dict()
    flags = ("--align", "none", "--body", "0.3,0.2,-1.5", "--time-offset", "0")
    options = {"align": "none", "body": (0.3, 0.2, -1.5), "time_offset_s": 0.0}
    expected = printed("evaluate", estimate, "--against", simulated, *flags)
    assert resect.evaluate(estimate, simulated, **options).to_dict() == expected
    as_evo = printed("evaluate", estimate, "--against", estimate, "--as-evo")
    assert resect.evaluate(estimate, estimate, as_evo=True).to_dict() == as_evo
    station = printed("evaluate", estimate, "--against", simulated, "--truth-station", 2)
    assert resect.evaluate(estimate, simulated, truth_station=2).to_dict() == station
    file = simulated.parent / "errors.csv"
    result = run("evaluate", estimate, "--against", simulated, "--csv", file)
    assert result.returncode == 0, result.stderr
    with file.open(encoding="utf-8") as lines:
        rows = list(csv.DictReader(lines))
    errors = evaluation.errors["truth"]
    for axis, name in enumerate("xyz"):
        for array, column in (("true_position_m", f"true_{name}_m"), ("position_error_m", f"error_{name}_m")):
            expected = [float(row[column]) for row in rows]
            assert np.allclose(errors[array][:, axis], expected, rtol=0, atol=1e-6), column
    turns_rad = np.linalg.norm(errors["rotation_error_rad"], axis=1)
    assert np.allclose(turns_rad, [float(row["error_rotation_rad"]) for row in rows], rtol=0, atol=1e-8)
    sigmas_m = [[float(row[f"sigma_{name}_m"]) for name in "xyz"] for row in rows]
    assert np.allclose(errors["truth_sigma_m"], np.sqrt(np.mean(np.square(sigmas_m), axis=1)), rtol=0, atol=1e-6)
    rmse_m = np.sqrt(np.mean(np.sum(errors["position_error_m"] ** 2, axis=1)))
    assert rmse_m == pytest.approx(evaluation.table["position_rmse_m"][0], rel=1e-12)
    assert errors["rotation_error_rad"].shape == errors["true_position_m"].shape


def test_a_prediction_is_the_object_that_the_program_prints(warthog: resect.Deployment, tmp_path: Path) -> None:
    assert resect.plan(preset="l-shape", seed=2).to_dict() == printed("plan", "--preset", "l-shape", "--seed", 2)
    past = printed("plan", SAMPLES / "warthog", "--target", 5)
    prediction = resect.plan(warthog, target_mm=5.0)
    assert prediction.to_dict() == past
    assert resect.plan(SAMPLES / "warthog", target_mm=5.0).to_dict() == past
    assert str(prediction) == run("plan", SAMPLES / "warthog", "--target", 5).stdout
    file = tmp_path / "plan.toml"
    assert run("plan", "--preset", "circle", "--out", file).returncode == 0
    assert resect.plan(file).to_dict() == printed("plan", file)


def test_a_simulation_writes_the_files_of_the_program(simulated: Path, tmp_path: Path) -> None:
    simulation = resect.simulate("warthog", seed=1)
    simulation.write(tmp_path / "written")
    for file in simulated.iterdir():
        assert (tmp_path / "written" / file.name).read_bytes() == file.read_bytes(), file.name
    truth = np.loadtxt(simulated.parent / "truth.tum")
    poses = simulation.true_trajectory(10.0)
    assert np.allclose(truth[:, 1:4], poses.position_m, rtol=0, atol=1e-8)
    assert np.allclose(truth[:, 4:], poses.quaternion_xyzw, rtol=0, atol=1e-8)
    # In memory as from disk.
    in_memory = simulation.deployment.calibrate()
    from_disk = resect.open(simulated).calibrate()
    assert in_memory.table["value"].tolist() == from_disk.table["value"].tolist()
    for true, found in zip(simulation.true_transforms, in_memory.transforms):
        assert np.all(np.abs(found.translation_m - true.translation_m) < 5 * found.sigma_translation_m)
    drawn = resect.simulate("warthog", field_errors=True).deployment.tracks[0]
    assert not np.array_equal(drawn.range_m, simulation.deployment.tracks[0].range_m)


def same_line(error: str, line: str, keywords: dict[str, str]) -> None:
    """Compares an error with the program's line, whose flags are keyword arguments here."""
    for flag, keyword in keywords.items():
        line = line.replace(flag, keyword)
    assert error == line
    assert "\n" not in error


def test_an_error_is_the_line_of_the_program(simulated: Path, tmp_path: Path, answer: resect.Calibration) -> None:
    tunnel, truth = SAMPLES / "hd2-tunnel", simulated.parent / "truth.tum"
    empty = tmp_path / "empty.csv"
    empty.write_text("")
    for path in (tmp_path / "nowhere", empty, tmp_path):
        with pytest.raises(resect.ResectError) as error:
            resect.open(path)
        same_line(str(error.value), complaint("calibrate", path), {})
    for method in ("static-gcp", "two-point", "dynamic-gcp"):
        with pytest.raises(resect.ResectError) as error:
            resect.open(tunnel).calibrate(method)
        line = complaint("calibrate", tunnel, "--method", method)
        same_line(str(error.value), line, {"--gcp": "gcp", "--method joint": 'method="joint"', "--rig": "rig"})
    alone = tmp_path / "alone"
    alone.mkdir()
    shutil.copy(tunnel / "inter_prism.csv", alone)
    with pytest.raises(resect.ResectError) as error:
        resect.open(alone).calibrate()
    line = complaint("calibrate", alone)
    assert "--rig" in line
    same_line(str(error.value), line, {"--rig": "rig", "--gcp": "gcp"})
    with pytest.raises(resect.ResectError) as error:
        resect.open(SAMPLES / "warthog").calibrate("inter-prism").trajectory(5.0)
    line = complaint("trajectory", SAMPLES / "warthog", "--method", "inter-prism", "--pose-rate", 5)
    same_line(str(error.value), line, {"--method joint": 'method="joint"'})
    with pytest.raises(resect.ResectError) as error:
        answer.trajectory(max_error_m=1e-8)
    line = complaint("trajectory", SAMPLES / "warthog", "--max-error", 1e-5)
    assert "above 0.00001 mm" in line
    same_line(str(error.value).partition(", or raise")[0], line.partition(", or raise")[0], {})
    assert str(error.value).endswith("(max_error_m)")
    shifted = tmp_path / "other.tum"
    shifted.write_text("\n".join(f"{time} {time * time} 0 0 0 0 0 1" for time in range(20)))
    with pytest.raises(resect.ResectError) as error:
        resect.evaluate(shifted, simulated)
    line = complaint("evaluate", shifted, "--against", simulated)
    same_line(str(error.value), line, {"--time-offset": "time_offset_s", "--align none": 'align="none"'})
    with pytest.raises(resect.ResectError) as error:
        resect.evaluate(truth, tmp_path / "nowhere")
    same_line(str(error.value), complaint("evaluate", truth, "--against", tmp_path / "nowhere"), {})
