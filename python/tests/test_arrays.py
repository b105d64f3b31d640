"""Shapes, units and tables; representations; work beside other threads."""

from __future__ import annotations

import inspect
import threading
import time
from pathlib import Path

import numpy as np
import pandas as pd
import polars as pl
import pytest
import resect
from conftest import SAMPLES


def tables(deployment: resect.Deployment, answer: resect.Calibration, truth: Path) -> dict[str, dict[str, np.ndarray]]:
    evaluation = resect.evaluate(truth, deployment)
    prediction = resect.plan(preset="l-shape")
    return {
        "track": deployment.tracks[1].table,
        "pipeline": deployment.run_pipeline().table,
        "answer": answer.table,
        "residuals": answer.residuals,
        "trajectory": answer.trajectory(10.0).table,
        "evaluation": evaluation.table,
        "route": prediction.table,
        "improvements": prediction.improvements,
    }


def test_pandas_and_polars_accept_every_table(
    warthog: resect.Deployment, answer: resect.Calibration, simulated: Path
) -> None:
    for name, table in tables(resect.open(simulated), answer, simulated.parent / "truth.tum").items():
        by_pandas, by_polars = pd.DataFrame(table), pl.DataFrame(table)
        assert by_pandas.shape == by_polars.shape, name
        assert len(by_pandas) > 0, name
        for column, values in table.items():
            assert values.ndim == 1, (name, column)
            equal_nan = values.dtype.kind == "f"
            assert np.array_equal(by_pandas[column].to_numpy(), values, equal_nan=equal_nan), (name, column)
            assert np.array_equal(by_polars[column].to_numpy(), values, equal_nan=equal_nan), (name, column)


def test_readings_become_positions(warthog: resect.Deployment) -> None:
    for track in warthog.tracks:
        range_m = track.range_m + track.prism_constant_m
        across_m = range_m * np.sin(track.zenith_rad)
        assert np.allclose(np.linalg.norm(track.position_m, axis=1), range_m, rtol=0, atol=1e-9)
        assert np.allclose(track.position_m[:, 2], range_m * np.cos(track.zenith_rad), rtol=0, atol=1e-9)
        assert np.allclose(np.hypot(*track.position_m[:, :2].T), across_m, rtol=0, atol=1e-9)
        assert np.all(np.diff(track.time_s) > 0)


def test_a_track_without_readings_is_empty(tmp_path: Path) -> None:
    header, *rows = (SAMPLES / "warthog/inter_prism.csv").read_text(encoding="utf-8").splitlines()
    first = [row for row in rows if row.split(",")[1] == "1"]
    (tmp_path / "inter_prism.csv").write_text("\n".join([header, *first]), encoding="utf-8")
    three = resect.open(tmp_path, stations=[1, 2, 3])
    assert [len(track) for track in three.tracks][1:] == [0, 0]
    assert all(track.position_m.shape == (len(track), 3) for track in three.tracks)
    assert three.run_pipeline().points_m.shape == (0, 3, 3)
    assert "–" in repr(three)
    assert three._repr_html_()


def test_one_station_has_a_track_and_no_transform(tmp_path: Path) -> None:
    header, *rows = (SAMPLES / "warthog/inter_prism.csv").read_text(encoding="utf-8").splitlines()
    first = [row for row in rows if row.split(",")[1] == "1"]
    (tmp_path / "inter_prism.csv").write_text("\n".join([header, *first]), encoding="utf-8")
    alone = resect.open(tmp_path)
    pipeline = alone.run_pipeline()
    assert pipeline.points_m.shape == (len(pipeline), 1, 3)
    answer = alone.calibrate()
    assert list(answer.transforms) == []
    assert alone._repr_html_() and answer._repr_html_()
    assert len(answer.trajectory()) > 1000


def test_two_stations_of_three(warthog: resect.Deployment) -> None:
    two = resect.open(SAMPLES / "warthog", stations=[1, 2])
    assert two.run_pipeline().points_m.shape[1:] == (2, 3)
    [pose] = two.calibrate().transforms
    [of_three, _] = warthog.calibrate().transforms
    assert np.allclose(pose.translation_m, of_three.translation_m, atol=3 * max(pose.sigma_translation_m))


def test_triplets_and_fates_of_readings(warthog: resect.Deployment) -> None:
    pipeline = warthog.run_pipeline()
    count = len(pipeline)
    assert pipeline.points_m.shape == (count, 3, 3)
    assert [len(fate) for fate in pipeline.fates] == [len(track) for track in warthog.tracks]
    assert {"kept", "rejected: range rate"} <= set(np.concatenate(pipeline.fates))
    # The stations see prisms whose distances are those of the rig, once in one frame.
    answer = warthog.calibrate()
    points = [pipeline.points_m[:, 0]]
    for station, transform in enumerate(answer.transforms, start=1):
        points.append(pipeline.points_m[:, station] @ transform.matrix[:3, :3].T + transform.translation_m)
    distances_m = [np.linalg.norm(points[a] - points[b], axis=1) for a, b in ((0, 1), (0, 2), (1, 2))]
    assert np.allclose(np.median(distances_m, axis=1), warthog.inter_prism_m, rtol=0, atol=0.003)
    assert len(warthog.run_pipeline(rate_hz=5.0)) == pytest.approx(count / 2, rel=0.02)
    without = warthog.run_pipeline(outlier_filter=False)
    assert "rejected: range rate" not in set(np.concatenate(without.fates))


def test_covariance_and_standard_deviations_agree(answer: resect.Calibration) -> None:
    assert answer.covariance is not None
    sigma = np.sqrt(np.diagonal(answer.covariance)).reshape(2, 4)
    for own, transform in zip(sigma, answer.transforms):
        assert np.allclose(own[:3], transform.sigma_translation_m, rtol=1e-9)
        assert own[3] == pytest.approx(transform.sigma_yaw_rad, rel=1e-9)
    trajectory = answer.trajectory(2.0)
    # Evenly spaced, except for gaps, which are multiples.
    steps = np.diff(trajectory.time_s) / 0.5
    assert np.allclose(steps, np.round(steps), rtol=0, atol=1e-5)
    assert np.median(steps) == pytest.approx(1.0)
    assert trajectory.covariance.shape == (len(trajectory), 6, 6)
    assert np.allclose(trajectory.covariance, trajectory.covariance.transpose(0, 2, 1), rtol=0, atol=1e-12)
    assert np.allclose(np.linalg.norm(trajectory.quaternion_xyzw, axis=1), 1.0)
    assert np.allclose(trajectory.sigma_rotation_rad[:, 2] ** 2, trajectory.covariance[:, 5, 5])


def test_significance_is_missing_where_it_has_no_meaning(answer: resect.Calibration) -> None:
    for table in (answer.table, resect.open(SAMPLES / "warthog").calibrate("inter-prism").table):
        by_pandas, by_polars = pd.DataFrame(table), pl.DataFrame(table)
        estimated = np.isin(table["group"], ["survey", "clocks", "instruments", "distances"])
        assert np.array_equal(np.isnan(table["significant"]), ~estimated)
        assert np.array_equal(by_pandas["significant"].isna(), ~estimated)
        assert np.array_equal(by_polars["significant"].is_nan().to_numpy(), ~estimated)
    assert estimated.sum() == 0
    drawn = resect.simulate("warthog", field_errors=True).deployment.calibrate()
    far = drawn.table["significant"] == 1
    assert [bool(row["significant"]) for row in drawn.to_dict()["rows"]] == far.tolist()
    assert 0 < far.sum() < len(far)
    assert len(pl.DataFrame(drawn.table).filter(pl.col("significant") == 1)) == far.sum()
    # A distance that nobody measured has no expected value.
    from resect._calibration import significance

    distance = {"group": "distances", "significant": True, "sigma": 1e-3, "reference": None}
    assert significance(distance) is None
    assert significance({**distance, "reference": {"name": "measured", "value": 0.9}}) is True


def test_columns_of_pandas_and_polars_are_arguments(answer: resect.Calibration) -> None:
    times_s = answer.trajectory().time_s[100:110]
    for column in (times_s, list(times_s), tuple(times_s), pd.Series(times_s), pl.Series(times_s)):
        assert np.array_equal(answer.trajectory(times_s=column).time_s, times_s)


def test_one_prism_has_positions_without_orientation() -> None:
    answer = resect.simulate("single-prism").deployment.calibrate()
    trajectory = answer.trajectory(1.0)
    assert trajectory.quaternion_xyzw is None
    assert trajectory.sigma_rotation_rad is None
    assert trajectory.covariance.shape == (len(trajectory), 3, 3)
    assert "sigma_rx_rad" not in trajectory.table
    assert 0 < np.median(answer.residuals["error_12_mm"]) < 10
    assert "positions" in repr(trajectory)


def test_findings_are_found_by_their_code(answer: resect.Calibration) -> None:
    assert all(one.code == code for code, found in answer.findings.items() for one in found)
    every = [one for found in answer.findings.values() for one in found]
    assert len(every) == len(answer.to_dict()["diagnosis"]["findings"]) > 0
    assert {one.severity for one in every} <= {"note", "warning", "problem"}


def test_notebooks_and_terminals_show_verdict_and_table(
    answer: resect.Calibration, warthog: resect.Deployment, simulated: Path
) -> None:
    first, header, two, three, *_ = repr(answer).splitlines()
    assert first.split(" · ")[1:] == ["the joint estimate", "verdict: GOOD"]
    assert header.split() == ["x", "(m)", "y", "(m)", "z", "(m)", "yaw", "(mrad)"]
    assert two.startswith("T12") and three.startswith("T13") and "±" in two
    evaluation = resect.evaluate(simulated.parent / "truth.tum", simulated)
    shown = [answer, warthog, answer.trajectory(), evaluation, resect.plan(preset="circle")]
    parts = [answer.transforms[0], warthog.run_pipeline()]
    for one in [*shown, *parts]:
        html = one._repr_html_()
        assert html.count("<table>") == html.count("</table>") == 1, html
        assert "verdict" in html or one in parts or isinstance(one, (resect.Deployment, resect.Trajectory))
        assert "object at 0x" not in repr(one)
    for one in [*warthog.tracks, warthog.run_pipeline(), resect.simulate("circle"), answer.transforms[0]]:
        assert "object at 0x" not in repr(one)
    # Names of files are no markup.
    assert "&lt;b&gt;" in resect.open(SAMPLES / "warthog", name="<b>")._repr_html_()


def test_numbers_have_the_digits_of_their_sigma() -> None:
    from resect._tables import with_sigma

    assert with_sigma(1.23456, 0.0123) == "1.235 ± 0.012"
    assert with_sigma(-1234.5, 56.0) == "-1234 ± 56"
    assert with_sigma(0.1, None) == "0.1000"
    assert with_sigma(0.00123456, 0.0000123, 1e3) == "1.235 ± 0.012"


def test_other_threads_go_on_during_long_work(warthog: resect.Deployment) -> None:
    thread = threading.Thread(target=resect.plan, args=(warthog,))
    turns_s = [time.perf_counter()]
    thread.start()
    while thread.is_alive():
        time.sleep(0.001)
        turns_s.append(time.perf_counter())
    # Work that keeps the lock leaves turns at its start and end only, for some milliseconds.
    shares = (np.array(turns_s) - turns_s[0]) / (turns_s[-1] - turns_s[0])
    assert len(np.unique(np.floor(100 * shares))) > 20


def test_the_module_is_small_and_documented() -> None:
    public = [getattr(resect, name) for name in resect.__all__]
    functions = [one for one in public if inspect.isfunction(one)]
    classes = [one for one in public if inspect.isclass(one)]
    assert len(functions) + len(classes) == len(public)
    methods = []
    for one in classes:
        # What a class inherits is documented as well; `object` and `Exception` aside.
        members = {name: member for base in one.__mro__ if base.__module__.startswith("resect") for name, member in vars(base).items()}
        for name, member in members.items():
            # Fields of a dataclass are described by their class.
            if not name.startswith("_") and (inspect.isroutine(member) or hasattr(member, "__doc__")):
                is_field = name in getattr(one, "__dataclass_fields__", {})
                assert is_field or inspect.getdoc(member), (one, name)
                methods += [member] if inspect.isfunction(member) and member not in methods else []
        for name in getattr(one, "__dataclass_fields__", {}):
            assert f"{name}:" in one.__doc__ or f"`{name}`" in one.__doc__, (one, name)
        assert inspect.getdoc(one), one
    assert all(inspect.getdoc(one) for one in functions)
    assert len(public) + len(methods) <= 25, [getattr(one, "__name__", one) for one in [*public, *methods]]
