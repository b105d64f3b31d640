"""Extrinsic calibrations of simulated bodies, and conventions of files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import resect

LEVER_M = np.array([0.30, -0.20, 0.45])
OFFSET_S = 0.25


def rotated(quaternion_xyzw: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Returns a vector of the body in the world, at each orientation."""
    v, w = quaternion_xyzw[:, :3], quaternion_xyzw[:, 3:]
    twice = 2 * np.cross(v, vector)
    return np.asarray(vector + w * twice + np.cross(v, twice))


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """A body that tilts by hand, its antenna with another clock, and the body with w first."""
    rng = np.random.default_rng(5)
    t = np.arange(0.0, 240.0, 0.1)
    half = [0.15 * np.sin(0.9 * t), 0.15 * np.sin(0.7 * t + 1), 0.5 * np.sin(0.11 * t)]
    (sr, sp, sy), (cr, cp, cy) = np.sin(half), np.cos(half)
    quaternion = np.stack(
        [sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy, cr * cp * cy + sr * sp * sy],
        axis=1,
    )
    position = np.stack([8 * np.sin(0.07 * t), 6 * np.sin(0.14 * t), 0.2 * np.sin(0.5 * t)], axis=1)
    antenna = position + rotated(quaternion, LEVER_M) + rng.normal(scale=0.003, size=position.shape)
    noisy = position + rng.normal(scale=0.003, size=position.shape)
    folder = tmp_path_factory.mktemp("bodies")
    tables = {
        "body": (t, noisy, quaternion),
        "antenna": (t - OFFSET_S, antenna, np.tile([0.0, 0.0, 0.0, 1.0], (len(t), 1))),
        "first": (t, noisy, quaternion[:, [3, 0, 1, 2]]),
    }
    for name, (times, points, turns) in tables.items():
        columns = np.column_stack([1.7e9 + times, points, turns] if name != "antenna" else [1.7e9 + times, points])
        header = "timestamp,x,y,z" if name == "antenna" else ""
        path = folder / (f"{name}.csv" if name == "antenna" else f"{name}.tum")
        np.savetxt(path, columns, fmt="%.9f", delimiter="," if name == "antenna" else " ", header=header, comments="")
        text = path.read_text(encoding="utf-8")
        path.write_text(text.lstrip("\n"), encoding="utf-8")
    return {name: folder / (f"{name}.csv" if name == "antenna" else f"{name}.tum") for name in tables}


def test_the_antenna_of_a_body_is_found_within_sigma(files: dict[str, Path]) -> None:
    extrinsics = resect.extrinsics(files["body"], files["antenna"])
    sigma = extrinsics.translation_sigma_m
    assert sigma is not None and extrinsics.verdict == "good", str(extrinsics)
    assert np.all(np.abs(extrinsics.translation_m - LEVER_M) < 4 * sigma), str(extrinsics)
    assert np.all(sigma < 0.005)
    offset_sigma = extrinsics.time_offset_sigma_s
    assert offset_sigma is not None and abs(extrinsics.time_offset_s - OFFSET_S) < 4 * offset_sigma
    assert np.allclose(extrinsics.matrix[:3, 3], extrinsics.translation_m) and np.allclose(extrinsics.matrix[:3, :3], np.eye(3))
    assert extrinsics.rotation_sigma_rad is None
    assert "<joint" in extrinsics.copies["urdf"] and extrinsics.because
    assert str(extrinsics).startswith("pose of antenna")


def test_conventions_are_given_by_the_words_of_the_program(files: dict[str, Path]) -> None:
    extrinsics = resect.extrinsics(files["first"], files["antenna"], conventions=("wxyz", "xyzw"))
    assert extrinsics.verdict == "good", str(extrinsics)
    evaluation = resect.evaluate(files["first"], files["body"], convention="wxyz")
    assert evaluation.to_dict()["estimates"][0]["ape_rotation_rad"]["rmse"] < 1e-6
    evaluation = resect.evaluate(files["body"], files["first"], truth_convention="wxyz")
    assert evaluation.to_dict()["estimates"][0]["ape_rotation_rad"]["rmse"] < 1e-6


def test_errors_name_the_argument(files: dict[str, Path]) -> None:
    body, antenna = files["body"], files["antenna"]
    for wrong, words in [
        (lambda: resect.extrinsics(antenna, body), "has no orientations"),
        (lambda: resect.extrinsics(body, antenna, conventions=("wxzy", "xyzw")), "conventions"),
        (lambda: resect.extrinsics(body, antenna, topics=("/odom", None)), "no topics"),
        (lambda: resect.extrinsics(body, antenna, time_offset_s=float("nan")), "time_offset_s"),
        (lambda: resect.evaluate(body, antenna, truth_solutions="fixed"), "truth_solutions"),  # type: ignore[arg-type]
    ]:
        with pytest.raises(resect.ResectError, match=words):
            wrong()
