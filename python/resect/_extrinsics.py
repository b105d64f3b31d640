"""Extrinsic calibration of two bodies by their trajectories."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from ._answer import Answer
from ._finding import Finding, findings_by_code, lines
from ._tables import Array

__all__ = ["Extrinsics"]


class Extrinsics(Answer):
    """Pose of a body or an antenna in another body, with σ and verdict. `resect.extrinsics` returns it.

    `str(extrinsics)` is the text that `resect extrinsics` prints.
    """

    def __init__(self, values: dict[str, Any]) -> None:
        super().__init__(values)
        self._copies: dict[str, str] = values["copies"]

    @property
    def verdict(self) -> str:
        """Verdict on the calibration: good, weak, ambiguous or degenerate."""
        return str(self._json["verdict"])

    @property
    def because(self) -> str:
        """Reason of the verdict."""
        return str(self._json["because"])

    @property
    def advice(self) -> tuple[str, ...]:
        """Motions that would determine more."""
        return tuple(self._json["next"])

    @cached_property
    def matrix(self) -> Array:
        """Shape (4, 4): it maps homogeneous coordinates of the other body to the body's frame (m).

        The rotation is the identity for an antenna.
        """
        x, y, z, w = self._json["body_from_other"]["quaternion_xyzw"]
        matrix = np.eye(4)
        matrix[:3, :3] = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
        matrix[:3, 3] = self._json["body_from_other"]["translation_m"]
        return matrix

    @property
    def translation_m(self) -> Array:
        """Shape (3,): the other body's origin in the body's frame (m)."""
        return np.array(self._json["body_from_other"]["translation_m"])

    @property
    def translation_sigma_m(self) -> Array | None:
        """Shape (3,): standard deviations (m); None if the drive does not show them."""
        sigma = self._json["body_from_other"]["translation_sigma_m"]
        return None if sigma is None else np.array(sigma)

    @property
    def rotation_sigma_rad(self) -> Array | None:
        """Shape (3,): standard deviations about the body's axes (rad); None for an antenna."""
        sigma = self._json["body_from_other"]["rotation_sigma_rad"]
        return None if sigma is None else np.array(sigma)

    @property
    def time_offset_s(self) -> float:
        """Offset that is added to the times of the other body (s)."""
        return float(self._json["time_offset_s"])

    @property
    def time_offset_sigma_s(self) -> float | None:
        """Standard deviation of the time offset (s); None if it was given."""
        sigma = self._json["time_offset_sigma_s"]
        return None if sigma is None else float(sigma)

    @cached_property
    def findings(self) -> dict[str, tuple[Finding, ...]]:
        """Findings about both trajectories, by their code."""
        return findings_by_code(self._json["findings"])

    @property
    def copies(self) -> dict[str, str]:
        """The transform as text for other programs: `urdf`, `ros2`, `ros1`, `matrix`, `numpy` and `quaternion`."""
        return self._copies

    def _title(self) -> str:
        return f"{self._json['other']} in {self._json['body']} · verdict: {self.verdict}"

    def _rows(self) -> list[list[str]]:
        sigma_m = self.translation_sigma_m
        rows = [["", "value", "σ"]]
        for axis, name in enumerate("xyz"):
            sigma = "–" if sigma_m is None else f"{1e3 * sigma_m[axis]:.2f}"
            rows.append([f"lever arm, {name} (mm)", f"{1e3 * self.translation_m[axis]:+.2f}", sigma])
        offset_sigma = self.time_offset_sigma_s
        sigma = "–" if offset_sigma is None else f"{1e3 * offset_sigma:.2f}"
        rows.append(["time offset (ms)", f"{1e3 * self.time_offset_s:+.2f}", sigma])
        return rows

    def _remarks(self) -> list[str]:
        return lines(self.findings)
