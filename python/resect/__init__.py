"""Calibration of robotic total stations, and ground truth trajectories with covariance.

    import resect

    deployment = resect.open("2022-07-11-2")
    calibration = deployment.calibrate()
    calibration.verdict                     # "good"
    calibration.station1_from_station2      # a Transform with σ
    trajectory = calibration.trajectory(rate=10.0)

Lengths are metres, angles radians, times seconds. `station1_from_station2` maps the frame of station 2 to that of
station 1. The numbers are those of the program `resect`, which this package installs as well. Every error is a
`ResectError` with one line; an argument of another form is one too.
"""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable, Sequence
from importlib.metadata import version
from typing import TYPE_CHECKING, Any, Literal

from . import _arguments as arguments
from . import _native
from ._calibration import Calibration, Transform
from ._deployment import Deployment, Pipeline, Track
from ._evaluation import Evaluation
from ._extrinsics import Extrinsics
from ._finding import Finding
from ._keywords import Method, Overrides, Path, Settings, extras, plain
from ._keywords import settings as checked
from ._native import ResectError
from ._planning import Prediction
from ._simulation import Simulation
from ._trajectory import Trajectory

if TYPE_CHECKING:
    from typing_extensions import Unpack

__all__ = [
    "Calibration",
    "Deployment",
    "Evaluation",
    "Extrinsics",
    "Finding",
    "Pipeline",
    "Prediction",
    "ResectError",
    "Simulation",
    "Track",
    "Trajectory",
    "Transform",
    "evaluate",
    "extrinsics",
    "open",
    "plan",
    "simulate",
]
__version__ = version("resect")


def open(
    path: Path,
    *,
    rig: Path | None = None,
    gcp: Path | Sequence[Path] = (),
    drives: Path | Sequence[Path] = (),
    **overrides: Unpack[Overrides],
) -> Deployment:
    """Opens a deployment: a folder, a file of tracks with the rest of its folder, or a bag.

    Args:
        path: folder or file with the stations' tracks.
        rig: folder or file with the inter-prism distances, instead of the folder's.
        gcp: files of control points, instead of those of the folder.
        drives: further drives with unmoved stations, which are solved together.
        **overrides: keys of `deployment.toml`, such as `prism_constant_m=0.0346` or `stations=[2, 1, 3]`.

    Raises:
        ResectError: if there is no such deployment, a file is not valid, or an override is unknown.
    """
    return Deployment(_native.open(arguments.path("path", path), extras(rig, gcp, drives, overrides)))


def evaluate(
    estimate: Path | Sequence[Path],
    against: Path | Deployment,
    *,
    align: Literal["none", "rigid", "similarity"] = "rigid",
    time_offset_s: float | None = None,
    body: Literal["found", "same"] | Sequence[float] = "found",
    as_evo: bool = False,
    convention: str = "xyzw",
    rig: Path | None = None,
    truth_topic: str | None = None,
    truth_convention: str = "xyzw",
    truth_solutions: Literal["best", "float", "all"] = "best",
    truth_station: int | None = None,
    method: Method | None = None,
    **settings: Unpack[Settings],
) -> Evaluation:
    """Evaluates trajectories of other systems, with the σ of the ground truth.

    Args:
        estimate: one or several files: TUM, EuRoC, KITTI, CSV or bags.
        against: ground truth: a deployment, its path, or a trajectory.
        align: alignment of an estimate's frame: none, rotation and translation, or a scale as well.
        time_offset_s: offset that is added to an estimate's times (s); estimated by default.
        body: body frame of an estimate in the vehicle: estimated, the vehicle's, or its known origin (m).
        as_evo: assume what evo assumes: equal clocks, one body frame, nearest stamps.
        convention: convention of the estimates' files, in the words of `resect evaluate --convention`, such as "wxyz,mm".
        rig: as in `open`, if `against` is the path of a deployment.
        truth_topic: topic of the ground truth in a bag of several trajectories.
        truth_convention: convention of the ground truth's file.
        truth_solutions: solutions of a GNSS receiver that are the ground truth: the best kind, float ones too, or all.
        truth_station: only this station of a deployment is the ground truth.
        method: method of the calibration that is the ground truth, as in `Deployment.calibrate`.
        **settings: settings of that calibration, as in `Deployment.calibrate`.

    Raises:
        ResectError: if no estimate can be compared with the ground truth.
    """
    # All arguments are checked before a long reading.
    given = checked(settings, method, _names_of(evaluate))
    estimates = arguments.paths("estimate", estimate)
    options = {
        "align": arguments.choice("align", align, ("none", "rigid", "similarity")),
        "time_offset_s": arguments.optional_number("time_offset_s", plain(time_offset_s)),
        "body": _body_frame(plain(body)),
        "as_evo": arguments.truth("as_evo", plain(as_evo)),
        "convention": arguments.word("convention", convention),
        "truth_station": plain(truth_station),
    }
    if truth_station is not None:
        arguments.whole_number("truth_station", options["truth_station"], 1, 8, "the number of a station, 1 to 8")
    if isinstance(against, Deployment):
        truth = against._handle
    else:
        of_truth = {
            "topic": None if truth_topic is None else arguments.word("truth_topic", truth_topic),
            "solutions": arguments.choice("truth_solutions", truth_solutions, ("best", "float", "all")),
            "convention": arguments.word("truth_convention", truth_convention),
        }
        truth = _native.open_truth(arguments.path("against", against), of_truth, extras(rig, (), (), {}))
    return Evaluation(_native.evaluate(estimates, truth, options, given))


def extrinsics(
    body: Path,
    other: Path,
    *,
    topics: Sequence[str | None] = (None, None),
    conventions: Sequence[str] = ("xyzw", "xyzw"),
    time_offset_s: float | None = None,
    free_scale: bool = False,
) -> Extrinsics:
    """Estimates the pose of a body or an antenna in another body from their trajectories.

    Args:
        body: trajectory of the body, with orientations.
        other: trajectory of the other body, or positions of an antenna or a prism.
        topics: topic of each file, for bags.
        conventions: convention of each file, in the words of `resect evaluate --convention`.
        time_offset_s: offset that is added to the times of `other` (s); estimated by default.
        free_scale: estimate the ratio of lengths without its prior of 3 %, for a single camera.

    Raises:
        ResectError: if the two do not fit each other.
    """
    paths = [arguments.path("body", body), arguments.path("other", other)]
    of_topics = arguments.items("topics", topics, lambda topic: topic is None or arguments.is_word(topic), "name", 2)
    of_conventions = arguments.words("conventions", conventions, 2)
    bodies = [
        {"path": path, "topic": topic, "convention": convention}
        for path, topic, convention in zip(paths, of_topics, of_conventions, strict=True)
    ]
    offset_s = arguments.optional_number("time_offset_s", plain(time_offset_s))
    return Extrinsics(_native.extrinsics(bodies, offset_s, arguments.truth("free_scale", plain(free_scale))))


def plan(
    source: Path | Deployment | None = None,
    *,
    preset: str | None = None,
    seed: int = 1,
    way: Path | None = None,
    target_mm: float | None = None,
    method: Method | None = None,
    **settings: Unpack[Settings],
) -> Prediction:
    """Predicts the accuracy of a drive before it is driven, and improves it.

    Args:
        source: a plan (TOML), or a past deployment or its path, whose stations, rig and path become the plan.
        preset: a preset of `simulate`, instead of a source.
        seed: seed of the preset's drive.
        way: file with the path to drive, instead of the plan's: CSV, PLY or GeoJSON.
        target_mm: largest acceptable root mean square error at the far end (mm), instead of the plan's.
        method: method for a past deployment, as in `Deployment.calibrate`.
        **settings: settings for a past deployment, as in `Deployment.calibrate`.

    Raises:
        ResectError: if the plan is not valid, or the stations never track together.
    """
    given = checked(settings, method, _names_of(plan))
    options = {
        "preset": None if preset is None else arguments.word("preset", preset),
        "seed": arguments.seed(plain(seed)),
        "way": None if way is None else arguments.path("way", way),
        "target_mm": arguments.optional_number("target_mm", plain(target_mm)),
    }
    past, file = None, None
    if isinstance(source, Deployment):
        past = source._handle
    elif source is not None and _is_plan(arguments.path("source", source)):
        file = source
    elif source is not None:
        past = open(source)._handle
    return Prediction(_native.plan(past, {"file": file, **options}, given))


def simulate(preset: str, *, seed: int = 1, field_errors: bool = False) -> Simulation:
    """Simulates a deployment with known ground truth.

    Args:
        preset: the drive and its surroundings, such as "warthog" or "hd2-tunnel"; an unknown name lists all.
        seed: the same seed gives the same readings.
        field_errors: add all errors of real instruments, drawn from the seed with the sizes seen in the field.

    Raises:
        ResectError: if the preset is unknown, or the seed is not a whole number from 0.
    """
    seed = arguments.seed(plain(seed))
    has_errors = arguments.truth("field_errors", plain(field_errors))
    return Simulation(_native.simulate(arguments.word("preset", preset), seed, has_errors), f"{preset}, seed {seed}")


def _is_plan(path: Path) -> bool:
    """Returns true for a TOML file, as the program recognises a plan."""
    return os.path.isfile(path) and os.path.splitext(path)[1] == ".toml"


def _names_of(function: Callable[..., Any]) -> list[str]:
    """Returns the arguments of a function that are keywords."""
    every = inspect.signature(function).parameters.values()
    return [one.name for one in every if one.kind is inspect.Parameter.KEYWORD_ONLY]


def _body_frame(value: Any) -> str | list[float]:
    """Returns the body frame of an estimate: a word, or its origin in the vehicle (m)."""
    if isinstance(value, list):
        return arguments.numbers("body", value, 3)
    if value in ("found", "same"):
        return str(value)
    arguments.refuse("body", arguments.in_words(value), "found, same, or three numbers in metres")
