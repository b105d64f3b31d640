"""Calibrations with their transforms, covariance and findings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from . import _arguments as arguments
from ._answer import Answer
from ._finding import Finding, findings_by_code, lines
from ._keywords import plain
from ._tables import Array, Table, columns, html_page, text_table, with_sigma
from ._trajectory import Trajectory

if TYPE_CHECKING:
    from . import _native

__all__ = ["Calibration", "Transform"]

ROW_NAMES = ("group", "subject", "name", "symbol", "unit", "value", "sigma", "prior_sigma", "significant")

TRACE_NAMES = (
    "phase",
    "cost",
    "squared_length",
    "largest_step_sigmas",
    "share",
    "matrix_reused",
    "downweighted",
    "range_m",
    "horizontal_angle_rad",
    "vertical_angle_rad",
    "stamp_s",
    "horizontal_jerk_m_per_s3",
    "vertical_jerk_m_per_s3",
    "events",
)


@dataclass(frozen=True, repr=False, eq=False)
class Transform:
    """Transform from the frame of station 2, 3, … to the frame of station 1.

    Attributes:
        station: number of the station, from 2.
        translation_m: shape (3,), x, y, z in the frame of station 1 (m).
        yaw_rad: rotation about the vertical (rad).
        tilt_rad: angle between the verticals (rad); 0 for level stations.
        matrix: shape (4, 4); it maps homogeneous coordinates of the station's frame to station 1's.
        sigma_translation_m: shape (3,), standard deviations (m); None if they are not determined.
        sigma_yaw_rad: standard deviation (rad); None if it is not determined.
    """

    station: int
    translation_m: Array
    yaw_rad: float
    tilt_rad: float
    matrix: Array
    sigma_translation_m: Array | None
    sigma_yaw_rad: float | None

    @classmethod
    def _of(cls, values: dict[str, Any]) -> Transform:
        sigma = values["sigma"]
        return cls(
            station=values["from"],
            translation_m=np.array(values["translation_m"]),
            yaw_rad=values["yaw_rad"],
            tilt_rad=values["tilt_rad"],
            matrix=np.array(values["matrix"]),
            sigma_translation_m=None if sigma is None else np.array(sigma["translation_m"]),
            sigma_yaw_rad=None if sigma is None else sigma["yaw_rad"],
        )

    def _cells(self) -> list[str]:
        sigmas = [None] * 3 if self.sigma_translation_m is None else list(self.sigma_translation_m)
        lengths = [with_sigma(value, sigma) for value, sigma in zip(self.translation_m, sigmas)]
        return [f"T1{self.station}", *lengths, with_sigma(self.yaw_rad, self.sigma_yaw_rad, 1e3)]

    def __repr__(self) -> str:
        return text_table([TRANSFORM_HEADER, self._cells()])

    def _repr_html_(self) -> str:
        return html_page(f"Station 1 from station {self.station}", [TRANSFORM_HEADER, self._cells()])


def significance(row: dict[str, Any]) -> bool | None:
    """Returns the significance of a row; None if the row has no expected value, or no σ."""
    # A distance of prisms that nobody measured would be compared with zero.
    has_expected = row["group"] in ("survey", "clocks", "instruments") or (
        row["group"] == "distances" and row["reference"] is not None
    )
    return bool(row["significant"]) if has_expected and row["sigma"] is not None else None


TRANSFORM_HEADER = ["", "x (m)", "y (m)", "z (m)", "yaw (mrad)"]


class Calibration(Answer):
    """A calibration by one method, with its uncertainty, verdict and findings. `Deployment.calibrate` returns it.

    `str(calibration)` is the text that `resect calibrate` prints.
    """

    def __init__(self, handle: _native.AnalysisHandle) -> None:
        self._handle = handle

    @cached_property
    def _json(self) -> dict[str, Any]:  # type: ignore[override]
        return self._handle.json()

    @cached_property
    def _text(self) -> str:  # type: ignore[override]
        return self._handle.text()

    @property
    def deployment(self) -> str:
        """Name of the deployment."""
        return str(self._json["deployment"])

    @property
    def method(self) -> str:
        """Method of the answer: the published one if the joint estimate failed."""
        return str(self._json["method"])

    @property
    def verdict(self) -> str:
        """Reliability: "good", "weak", "ambiguous" or "degenerate"."""
        return str(self._json["diagnosis"]["verdict"])

    @property
    def is_independently_checked(self) -> bool:
        """True if independent data that would expose a bias agrees with the answer."""
        return bool(self._json["diagnosis"]["independently_checked"])

    @property
    def recommendation(self) -> str:
        """The answer to use, in words for people; for scripts, see `recommended_method` and `reason`."""
        return str(self._json["recommendation"]["text"])

    @property
    def recommended_method(self) -> str | None:
        """Method of the answer to use; None if no answer can be used. Stable, for scripts."""
        method: str | None = self._json["recommendation"]["answer"]
        return method

    @property
    def reason(self) -> str:
        """Code of the reason of `recommended_method`, such as "good". Stable, for scripts."""
        return str(self._json["recommendation"]["reason"])

    @cached_property
    def transforms(self) -> tuple[Transform, ...]:
        """`station1_from_station2`, `station1_from_station3`, …, of the drive."""
        return tuple(Transform._of(values) for values in self._json["transforms"])

    @cached_property
    def survey_transforms(self) -> tuple[Transform, ...] | None:
        """The transforms when the control points were measured; None if the answer does not use control points."""
        transforms = self._json.get("survey_transforms")
        if transforms is None:
            return None
        return tuple(Transform._of(values) for values in transforms)

    @property
    def station1_from_station2(self) -> Transform:
        """Transform from the frame of station 2 to station 1's."""
        return self.transforms[0]

    @property
    def station1_from_station3(self) -> Transform:
        """Transform from the frame of station 3 to station 1's."""
        return self.transforms[1]

    @cached_property
    def covariance(self) -> Array | None:
        """Shape (4(N - 1), 4(N - 1)) of N stations: x, y, z, yaw of station 2, then of station 3, … (m, rad), in the frame of station 1.

        None if a direction is not determined.
        """
        covariance = self._json["covariance"]
        return None if covariance is None else np.array(covariance)

    @cached_property
    def findings(self) -> dict[str, tuple[Finding, ...]]:
        """Findings about the data and the answer, by their code."""
        return findings_by_code(self._json["diagnosis"]["findings"])

    @cached_property
    def doubts(self) -> dict[str, tuple[Finding, ...]]:
        """Findings that limit the verdict, by their code; empty without any."""
        return findings_by_code(self._json["diagnosis"]["doubts"])

    @property
    def table(self) -> Table:
        """Every number of the answer with its unit, σ and prior σ: columns for pandas or polars.

        `significant` is 1 or 0 for estimates that have an expected value: changes since the survey, clocks, instruments
        and measured distances. It is NaN for transforms, noise levels and metrics, where significance has no meaning.
        """
        return columns([{**row, "significant": significance(row)} for row in self._json["rows"]], ROW_NAMES)

    @property
    def residuals(self) -> Table:
        """Errors of the inter-prism distances (mm) at each triplet: columns for pandas or polars.

        For one prism they are the distances between its positions by two stations.
        """
        return self._handle.residuals()

    @cached_property
    def _trace(self) -> dict[str, Any]:
        return self._handle.trace() or {"status": None, "steps": []}

    @property
    def solver_status(self) -> str | None:
        """Code of the outcome of the joint estimate's solver, such as "converged"; None for other methods."""
        status: str | None = self._trace["status"]
        return status

    @property
    def trace(self) -> Table:
        """Steps of the joint estimate's solver: columns for pandas or polars, empty for other methods.

        `cost`, `squared_length` and `largest_step_sigmas` are in σ² and σ, and NaN where the solver does not compute them.
        `events` are in words, separated by semicolons.
        """
        return columns([{**row, "events": "; ".join(row["events"])} for row in self._trace["steps"]], TRACE_NAMES)

    def trajectory(
        self,
        rate: float | None = None,
        *,
        times_s: Sequence[float] | Array | None = None,
        max_error_m: float | None = None,
        max_sigma_m: float | None = None,
        max_sigma_rad: float | None = None,
        lever_arm_m: Sequence[float] | Array | None = None,
        frame: Literal["station1", "control-points"] = "station1",
    ) -> Trajectory:
        """Returns the poses of the vehicle, or the positions of the one prism that all stations follow.

        Args:
            rate: poses per second, evenly spaced (Hz); by default ten wherever the joint estimate has a motion.
            times_s: times of the poses (s), instead of a rate.
            max_error_m: poses with a larger inter-prism error are left out (m); 0.02 by default.
            max_sigma_m: poses with a larger σ in position are left out (m); 0.05 by default.
            max_sigma_rad: poses with a larger σ in orientation are left out (rad); 0.0524 (3°) by default.
            lever_arm_m: origin of a sensor in the vehicle's frame (m), whose poses are returned.
            frame: frame of the poses: station 1's, or the one in which the control points were surveyed.

        Raises:
            ResectError: if the answer has no poses at these times or in this frame.
        """
        lever_m, times = plain(lever_arm_m), plain(times_s)
        options = {
            "rate": arguments.optional_number("rate", plain(rate)),
            "times_s": None if times is None else arguments.numbers("times_s", times),
            "max_error_m": arguments.optional_number("max_error_m", plain(max_error_m)),
            "max_sigma_m": arguments.optional_number("max_sigma_m", plain(max_sigma_m)),
            "max_sigma_rad": arguments.optional_number("max_sigma_rad", plain(max_sigma_rad)),
            "lever_arm_m": None if lever_m is None else arguments.numbers("lever_arm_m", lever_m, 3),
            "frame": arguments.choice("frame", frame, ("station1", "control-points")),
        }
        return Trajectory._of(self._handle.trajectory(options))

    def _rows(self) -> list[list[str]]:
        return [TRANSFORM_HEADER, *(transform._cells() for transform in self.transforms)]

    def _remarks(self) -> list[str]:
        return [self.recommendation, *lines(self.findings)]

    def __repr__(self) -> str:
        return f"{super().__repr__()}\n{self.recommendation}"
