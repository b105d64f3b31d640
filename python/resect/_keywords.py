"""Keyword arguments with their types, and their conversion to plain data."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any, Literal, TypedDict, Union

import numpy as np

Path = Union[str, "os.PathLike[str]"]
Method = Literal["two-point", "static-gcp", "dynamic-gcp", "inter-prism", "joint"]


class Settings(TypedDict, total=False):
    """Settings of pipeline and calibration, with the names and defaults of a settings file (`--config`)."""

    outlier_filter: bool
    interval_filter: bool
    tau_r_m_per_s: float
    tau_a_deg_per_s: float
    tau_e_deg_per_s: float
    tau_s_seconds: float
    tau_l_seconds: float
    interpolation: Literal["linear", "gp", "wnoa"]
    rate_hz: float
    prior: Literal["closed-form", "search"]
    alignment: Literal["level", "rigid"]
    inter_prism_sigma_m: float
    # Names separated by commas: "drive,control-points,rig".
    evidence: str | Mapping[str, bool]
    # Standard deviations of instrument errors before the drive.
    clock_offset_s: float
    clock_drift: float
    clock_wander_s: float
    latency_s: float
    lean_rad: float
    range_offset_m: float
    range_scale: float
    index_rad: float
    collimation_rad: float
    settling_rad: float
    settling_m: float
    ranges_wander: bool


class Overrides(TypedDict, total=False):
    """Keys of `deployment.toml`, which take precedence over the folder's own."""

    name: str
    tracks: str | Sequence[str]
    topics: Sequence[str]
    stations: Sequence[int]
    azimuth: Literal["clockwise", "counter-clockwise"]
    prism_constant_m: float | Sequence[float]
    ranges_include_prism_constant: bool
    inter_prism_m: Sequence[float]
    prisms: Literal[1, 3]
    prisms_m: Sequence[Sequence[float]]
    gnss: Sequence[str]
    control_points: Sequence[str]
    surveys: Sequence[str]
    span_s: Sequence[float]
    masked: Sequence[Mapping[str, float]]
    columns: Mapping[str, Any]


def plain(value: Any) -> Any:
    """Returns numpy values, paths and tuples as plain data, without keys whose value is None."""
    if isinstance(value, (np.generic, np.ndarray)):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, Mapping):
        return {name: plain(own) for name, own in value.items() if own is not None}
    if isinstance(value, (list, tuple)):
        return [plain(own) for own in value]
    return value


def extras(
    rig: Path | None, gcp: Path | Sequence[Path], drives: Path | Sequence[Path], overrides: Mapping[str, Any]
) -> dict[str, Any]:
    """Returns further files and overrides as the native functions read them."""
    points = each(gcp)
    found: dict[str, Any] = plain(
        {
            "rig": rig,
            "gcp": points,
            "gcp_instead": bool(points),
            "drives": each(drives),
            "corrections": overrides,
        }
    )
    return found


def each(paths: Path | Sequence[Path]) -> list[Path]:
    """Returns one path, or several, as a list."""
    return [paths] if isinstance(paths, (str, os.PathLike)) else list(paths)
