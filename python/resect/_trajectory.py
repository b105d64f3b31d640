"""Trajectories with covariance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ._tables import Array, Table, html_page, text_table

__all__ = ["Trajectory"]

ROTATIONS = ("rx", "ry", "rz")


@dataclass(frozen=True, repr=False, eq=False)
class Trajectory:
    """Poses of the vehicle, or positions of a single prism, at n instants.

    Attributes:
        frame: frame of the poses, in words.
        time_s: shape (n,), time of station 1 (s).
        position_m: shape (n, 3), origin of the vehicle in `frame` (m).
        covariance: shape (n, 6, 6): position (m), then rotation vector θ in `frame` (rad). The true orientation is
            exp(θ) times the estimated one. Shape (n, 3, 3) for a single prism.
        quaternion_xyzw: shape (n, 4), rotation from the vehicle's frame to `frame`; None for a single prism.
        velocity_m_per_s: shape (n, 3), of the origin in `frame` (m/s); None if only poses are known.
        rate_rad_per_s: shape (n, 3), rotation rate in `frame` (rad/s); None if only positions are known.
        inter_prism_error_m: shape (n,), largest error of an inter-prism distance around the instant (m); None for a
            single prism.
        vehicle: origin and axes of the vehicle's frame, in words; None for a single prism.
        dropped: number of requested poses that are missing, for any reason.
    """

    frame: str
    time_s: Array
    position_m: Array
    covariance: Array
    quaternion_xyzw: Array | None = None
    velocity_m_per_s: Array | None = None
    rate_rad_per_s: Array | None = None
    inter_prism_error_m: Array | None = None
    vehicle: str | None = None
    dropped: int = 0

    @classmethod
    def _of(cls, arrays: dict[str, Any]) -> Trajectory:
        return cls(**arrays)

    @property
    def sigma_position_m(self) -> Array:
        """Shape (n, 3): standard deviations of the position (m)."""
        variances: Array = np.einsum("nii->ni", self.covariance)[:, :3]
        return np.sqrt(np.maximum(variances, 0.0))

    @property
    def sigma_rotation_rad(self) -> Array | None:
        """Shape (n, 3): standard deviations of the rotation vector (rad); None for a single prism."""
        if self.quaternion_xyzw is None:
            return None
        variances: Array = np.einsum("nii->ni", self.covariance)[:, 3:]
        return np.sqrt(np.maximum(variances, 0.0))

    @property
    def table(self) -> Table:
        """Columns for pandas or polars: the covariance as standard deviations."""
        table: Table = {"time_s": self.time_s}
        parts: list[tuple[tuple[str, ...], Array | None]] = [
            (("x_m", "y_m", "z_m"), self.position_m),
            (("qx", "qy", "qz", "qw"), self.quaternion_xyzw),
            (("sigma_x_m", "sigma_y_m", "sigma_z_m"), self.sigma_position_m),
            (tuple(f"sigma_{name}_rad" for name in ROTATIONS), self.sigma_rotation_rad),
            (("vx_m_per_s", "vy_m_per_s", "vz_m_per_s"), self.velocity_m_per_s),
            (("wx_rad_per_s", "wy_rad_per_s", "wz_rad_per_s"), self.rate_rad_per_s),
        ]
        for names, values in parts:
            if values is not None:
                table.update(zip(names, values.T))
        if self.inter_prism_error_m is not None:
            table["inter_prism_error_m"] = self.inter_prism_error_m
        return table

    def __len__(self) -> int:
        return len(self.time_s)

    def _rows(self) -> list[list[str]]:
        sigma_mm = 1e3 * float(np.median(np.sqrt(np.mean(self.sigma_position_m**2, axis=1))))
        rows = [
            ["poses" if self.quaternion_xyzw is not None else "positions", str(len(self))],
            ["from, to (s)", f"{self.time_s[0]:.1f}, {self.time_s[-1]:.1f}"],
            ["median σ of the position (mm)", f"{sigma_mm:.1f}"],
        ]
        if (turns := self.sigma_rotation_rad) is not None:
            sigma_mrad = 1e3 * float(np.median(np.sqrt(np.mean(turns**2, axis=1))))
            rows.append(["median σ of the orientation (mrad)", f"{sigma_mrad:.2f}"])
        return [*rows, ["left out", str(self.dropped)]]

    def __repr__(self) -> str:
        return f"Trajectory, {self.frame}\n{text_table(self._rows())}"

    def _repr_html_(self) -> str:
        return html_page(f"Trajectory, {self.frame}", [["", ""], *self._rows()])
