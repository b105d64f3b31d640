"""Evaluation of trajectories of other systems."""

from __future__ import annotations

from functools import cached_property
from typing import Any

from ._answer import Answer
from ._finding import Finding, findings_by_code, lines
from ._tables import Array, Table, columns

__all__ = ["Evaluation"]

SIZES = ("rmse", "mean", "median", "std", "min", "max")


class Evaluation(Answer):
    """Errors of estimates against a ground truth. `resect.evaluate` returns it.

    `str(evaluation)` is the text that `resect evaluate` prints.
    """

    def __init__(self, values: dict[str, Any]) -> None:
        super().__init__(values)
        self._errors: dict[str, dict[str, Array]] = values["errors"]

    @property
    def names(self) -> list[str]:
        """Names of the estimates."""
        return [estimate["name"] for estimate in self._json["estimates"]]

    @property
    def errors(self) -> dict[str, dict[str, Array]]:
        """Errors of each estimate by its name, at the n times at which both are known.

        Arrays: `time_s` (n,) (s); `true_position_m` and `position_error_m` (n, 3) in the ground truth's frame (m);
        `rotation_error_rad` (n, 3), if there are orientations (rad); `truth_sigma_m` (n,), if the ground truth has a σ
        (m).
        """
        return self._errors

    @cached_property
    def findings(self) -> dict[str, tuple[Finding, ...]]:
        """Findings about the estimates and their alignment, by their code."""
        return findings_by_code(one for estimate in self._json["estimates"] for one in estimate["findings"])

    @property
    def table(self) -> Table:
        """APE of each estimate: columns for pandas or polars, in metres and radians."""
        rows = []
        for estimate in self._json["estimates"]:
            row = {"name": estimate["name"], "count": estimate["ape_position_m"]["count"]}
            row |= {f"position_{size}_m": estimate["ape_position_m"][size] for size in SIZES}
            turn = estimate["ape_rotation_rad"] or {}
            row |= {f"rotation_{size}_rad": turn.get(size) for size in SIZES}
            row |= {name: estimate[name] for name in ("time_offset_s", "ground_truth_sigma_m")}
            rows.append(row)
        return columns(rows, rows[0])

    def _rows(self) -> list[list[str]]:
        rows = [["estimate", "APE rmse (mm)", "median (mm)", "max (mm)", "rotation rmse (mrad)"]]
        for estimate in self._json["estimates"]:
            ape, turn = estimate["ape_position_m"], estimate["ape_rotation_rad"]
            lengths = [f"{1e3 * ape[size]:.1f}" for size in ("rmse", "median", "max")]
            rows.append([estimate["name"], *lengths, "–" if turn is None else f"{1e3 * turn['rmse']:.2f}"])
        return rows

    def _title(self) -> str:
        verdict = self._json["verdict"]
        suffix = "" if verdict is None else f" · verdict: {verdict}"
        return f"Evaluation against {self._json['ground_truth']['name']}{suffix}"

    def _remarks(self) -> list[str]:
        return lines(self.findings)
