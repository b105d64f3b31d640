"""Predictions for drives before they are driven."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from ._answer import Answer
from ._finding import Finding, findings_by_code, lines
from ._tables import Array, Table, columns

__all__ = ["Prediction"]


class Prediction(Answer):
    """Expected accuracy of a planned drive, and its improvements. `resect.plan` returns it.

    `str(prediction)` is the text that `resect plan` prints.
    """

    @property
    def verdict(self) -> str:
        """Verdict on a calibration from such a drive."""
        return str(self._json["verdict"])

    @cached_property
    def findings(self) -> dict[str, tuple[Finding, ...]]:
        """Reasons of the verdict, and notes, by their code."""
        return findings_by_code(self._json["findings"])

    @cached_property
    def covariance(self) -> Array | None:
        """Shape (4(N - 1), 4(N - 1)) of N stations: x, y, z, yaw of station 2, then of station 3, … (m, rad), along the axes of the plan.

        None if a direction is not determined.
        """
        held = self._json["held"]
        return None if held is None else np.array(held["covariance"])

    @property
    def table(self) -> Table:
        """The vehicle along the route, about once a second: columns for pandas or polars, in the plan's frame."""
        rows = []
        for at in self._json["way"]["vehicle"]:
            x_m, y_m, z_m = at["position_m"]
            rows.append({**at, "x_m": x_m, "y_m": y_m, "z_m": z_m})
        return columns(rows, ("time_s", "x_m", "y_m", "z_m", "position_sigma_m", "rotation_sigma_rad"))

    @property
    def improvements(self) -> Table:
        """Improvements, the largest first: σ at the far end before and after (m), and the additional time (s)."""
        return columns(self._json["improvements"], ("kind", "sentence", "before_m", "after_m", "more_s"))

    def _rows(self) -> list[list[str]]:
        rows = [["", "σ x (mm)", "σ y (mm)", "σ z (mm)", "σ yaw (mrad)"]]
        for station, sigma in enumerate((self._json["held"] or {}).get("sigma", []), start=2):
            numbers = [*sigma["translation_m"], sigma["yaw_rad"]]
            rows.append([f"T1{station}", *(f"{1e3 * number:.2g}" for number in numbers)])
        return rows

    def _remarks(self) -> list[str]:
        return [*lines(self.findings), *(one["sentence"] for one in self._json["improvements"])]
