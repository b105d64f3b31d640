"""Keyword arguments with their types, and their conversion to plain data."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache, partial
from typing import Any, Literal, TypedDict, Union, get_args, get_origin, get_type_hints

import numpy as np

from . import _arguments as arguments

Path = Union[str, "os.PathLike[str]"]
# Names, or the paper's letters in either case.
Method = Literal[
    "two-point", "static-gcp", "dynamic-gcp", "inter-prism", "joint", "A", "B", "C", "D", "a", "b", "c", "d"
]


class Settings(TypedDict, total=False):
    """Settings of pipeline and calibration, with the names and defaults of a settings file (`--config`)."""

    outlier_filter: bool
    interval_filter: bool
    # The joint estimate takes all readings, not only those of the kept intervals.
    all_readings: bool
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
    # Names separated by commas, or a list of them: "drive,control-points,rig".
    evidence: str | Sequence[str] | Mapping[str, bool]
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
    refraction: float
    settling_rad: float
    settling_m: float
    ranges_wander: bool


class Overrides(TypedDict, total=False):
    """Keys of `deployment.toml`, which take precedence over the folder's own."""

    name: str
    tracks: str | Sequence[str]
    topics: Sequence[str]
    stations: Sequence[int]
    station_names: Sequence[str]
    azimuth: Literal["clockwise", "counter-clockwise"]
    prism_constant_m: float | Sequence[float]
    ranges_include_prism_constant: bool
    inter_prism_m: Sequence[float]
    # A number of prisms, or the prism of each station.
    prisms: int | Sequence[int]
    prism_changes: Sequence[Mapping[str, float]]
    prisms_m: Sequence[Sequence[float]]
    gnss: Sequence[str]
    control_points: Sequence[str]
    surveys: Sequence[str]
    span_s: Sequence[float]
    masked: Sequence[Mapping[str, float]]
    columns: Mapping[str, Any]


Check = Callable[[str, Any], Any]


def plain(value: Any) -> Any:
    """Returns numpy values, columns, paths and tuples as plain data, without keys whose value is None."""
    # Arrays and numbers of numpy, and columns of pandas and polars.
    if hasattr(value, "__array__") and not isinstance(value, type):
        return np.asarray(value).tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, Mapping):
        return {name: plain(own) for name, own in value.items() if own is not None}
    if isinstance(value, (list, tuple, range)):
        return [plain(own) for own in value]
    return value


def settings(given: Mapping[str, Any], method: Any = None, others: Iterable[str] = ()) -> dict[str, Any]:
    """Returns settings as the native functions read them; `others` are the further arguments of the call."""
    checks = setting_checks()
    arguments.known("setting", given, list(checks), others)
    found = {name: checks[name](name, own) for name, own in plain(given).items()}
    if method is not None:
        found["method"] = arguments.word("method", plain(method), METHOD_FORM)
    return found


def extras(
    rig: Path | None, gcp: Path | Sequence[Path], drives: Path | Sequence[Path], overrides: Mapping[str, Any]
) -> dict[str, Any]:
    """Returns further files and overrides as the native functions read them."""
    arguments.known("override", overrides, list(OVERRIDE_CHECKS), ("rig", "gcp", "drives"))
    points = arguments.paths("gcp", gcp)
    found: dict[str, Any] = plain(
        {
            "rig": None if rig is None else arguments.path("rig", rig),
            "gcp": points,
            "gcp_instead": bool(points),
            "drives": arguments.paths("drives", drives),
        }
    )
    corrections = {name: OVERRIDE_CHECKS[name](name, own) for name, own in plain(overrides).items()}
    return {**found, "corrections": corrections}


METHOD_FORM = 'a name, such as "joint", or a letter from "A" to "D"'


@cache
def setting_checks() -> dict[str, Check]:
    """Returns the check of each setting, by its type."""
    checks: dict[str, Check] = {}
    for name, hint in get_type_hints(Settings).items():
        if get_origin(hint) is Literal:
            checks[name] = partial(arguments.choice, choices=get_args(hint))
        else:
            checks[name] = {bool: arguments.truth, float: arguments.number}.get(hint, evidence)
    return checks


EVIDENCE = ("drive", "control-points", "rig")


def evidence(name: str, value: Any) -> str | dict[str, bool]:
    """Returns groups of readings as "drive,rig", or as a table of switches; `control_points` is `control-points`."""
    form = f"some of {', '.join(EVIDENCE)}, in a string or a list"
    if isinstance(value, dict):
        switches = {str(group).strip().replace("_", "-"): own for group, own in value.items()}
        arguments.known(f"{name} group", switches, EVIDENCE)
        return {group.replace("-", "_"): arguments.truth(f"{name}: {group}", own) for group, own in switches.items()}
    groups = value.split(",") if isinstance(value, str) else value
    if not isinstance(groups, list) or not all(isinstance(group, str) for group in groups):
        arguments.refuse(name, arguments.in_words(value), form)
    return ",".join(group.strip().replace("_", "-") for group in groups)


def name_or_names(name: str, value: Any) -> str | list[str]:
    """Returns one name, or several."""
    if isinstance(value, (str, list)):
        return value if isinstance(value, str) else arguments.words(name, value)
    arguments.refuse(name, arguments.in_words(value), "a name, or a list of names")


def prism_constants_m(name: str, value: Any) -> float | list[float]:
    """Returns one prism constant, or one for each station."""
    if isinstance(value, list):
        return arguments.numbers(name, value)
    if arguments.is_number(value):
        return float(value)
    arguments.refuse(name, arguments.in_words(value), "one number, or one for each station, in metres")


def prisms_m(name: str, value: Any) -> list[list[float]]:
    """Returns the positions of prisms."""

    def is_point(point: Any) -> bool:
        return isinstance(point, list) and len(point) == 3 and all(map(arguments.is_number, point))

    if not isinstance(value, list) or not all(map(is_point, value)):
        arguments.refuse(name, "is not a list of points", "[[x, y, z], [x, y, z], …], in metres")
    return value


def followed_prisms(name: str, value: Any) -> int | list[int]:
    """Returns a number of prisms, or the prism of each station."""
    form = "a number of prisms, or the prism of each station"
    if isinstance(value, list):
        return [arguments.whole_number(f"a value of {name}", own, 0, 255, form) for own in value]
    return arguments.whole_number(name, value, 0, 255, form)


def prism_changes(name: str, value: Any) -> list[dict[str, Any]]:
    """Returns changes of the prisms that stations follow."""
    form = 'a list such as [{"station": 2, "time_s": 12.5, "prism": 3}]'
    changes: list[Any] = value if isinstance(value, list) else [None]
    for change in changes:
        if not isinstance(change, dict) or set(change) != {"station", "time_s", "prism"}:
            arguments.refuse(name, "is not a list of changes", form)
        arguments.whole_number(f"station of {name}", change["station"], 0, 255, "the number of a station")
        arguments.whole_number(f"prism of {name}", change["prism"], 0, 255, "the number of a prism")
        arguments.number(f"{name}: time_s", change["time_s"])
    return changes


def masked(name: str, value: Any) -> list[dict[str, Any]]:
    """Returns readings to leave out."""
    form = 'a list such as [{"station": 1, "time_s": 12.5}]'
    readings: list[Any] = value if isinstance(value, list) else [None]
    for reading in readings:
        if not isinstance(reading, dict) or set(reading) != {"station", "time_s"}:
            arguments.refuse(name, "is not a list of readings", form)
        arguments.whole_number(f"station of {name}", reading["station"], 0, 255, "the number of a station")
        arguments.number(f"{name}: time_s", reading["time_s"])
    return readings


def columns(name: str, value: Any) -> dict[str, Any]:
    """Returns the meaning of columns; the native functions check the keys."""
    if not isinstance(value, dict):
        arguments.refuse(name, arguments.in_words(value), "a dictionary with the keys of [columns] in deployment.toml")
    for key, own in value.items():
        check = arguments.number if key == "utc_offset_hours" else arguments.word
        check(f"{name}: {key}", own)
    return value


OVERRIDE_CHECKS: dict[str, Check] = {
    "name": arguments.word,
    "tracks": name_or_names,
    "topics": arguments.words,
    "stations": partial(arguments.items, is_item=arguments.is_station_number, kind="whole number"),
    "station_names": arguments.words,
    "azimuth": partial(arguments.choice, choices=("clockwise", "counter-clockwise")),
    "prism_constant_m": prism_constants_m,
    "ranges_include_prism_constant": arguments.truth,
    "inter_prism_m": arguments.numbers,
    "prisms": followed_prisms,
    "prism_changes": prism_changes,
    "prisms_m": prisms_m,
    "gnss": partial(arguments.words, count=3),
    "control_points": arguments.words,
    "surveys": arguments.words,
    "span_s": partial(arguments.numbers, count=2),
    "masked": masked,
    "columns": columns,
}
