"""Deployments, the readings of their stations, and the pipeline."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._calibration import Calibration
from ._finding import Finding, findings_by_code, lines
from ._keywords import Method, Settings
from ._keywords import settings as checked
from ._tables import Array, Table, html_page, text_table

if TYPE_CHECKING:
    from typing_extensions import Unpack

__all__ = ["Deployment", "Pipeline", "Track"]


@dataclass(frozen=True, repr=False, eq=False)
class Track:
    """Readings of one station in order of time; n is their number.

    Attributes:
        station: its number, from 1.
        name: how the files or `station_names` call it; None if that is its number.
        time_s: shape (n,), synchronised time (s).
        range_m: shape (n,), without the prism constant (m).
        azimuth_rad: shape (n,), clockwise seen from above (rad).
        zenith_rad: shape (n,), 0 straight up (rad).
        position_m: shape (n, 3), x, y, z in the station's own frame, prism constant included (m).
        prism_constant_m: added to every range (m).
    """

    station: int
    name: str | None
    time_s: Array
    range_m: Array
    azimuth_rad: Array
    zenith_rad: Array
    position_m: Array
    prism_constant_m: float

    @property
    def table(self) -> Table:
        """Columns for pandas or polars."""
        x_m, y_m, z_m = self.position_m.T
        return {
            "time_s": self.time_s,
            "range_m": self.range_m,
            "azimuth_rad": self.azimuth_rad,
            "zenith_rad": self.zenith_rad,
            "x_m": x_m,
            "y_m": y_m,
            "z_m": z_m,
        }

    def __len__(self) -> int:
        return len(self.time_s)

    def __repr__(self) -> str:
        span_s = self.time_s[-1] - self.time_s[0] if len(self) else 0.0
        return f"<Track of station {self.station}: {len(self)} readings in {span_s:.0f} s>"


@dataclass(frozen=True, repr=False, eq=False)
class Pipeline:
    """Triplets: the positions of the stations' prisms at n common instants.

    Attributes:
        time_s: shape (n,) (s).
        interval: shape (n,), number of the interval from 0.
        points_m: shape (n, N, 3): instant, station, and x, y, z in the station's own frame (m).
        speed_m_per_s: shape (n,), speed of prism 1 (m/s).
        fates: for each station, an array with the fate of each reading in words: "kept", "rejected: range rate", …
        intervals: number of intervals.
    """

    time_s: Array
    interval: NDArray[np.uint32]
    points_m: Array
    speed_m_per_s: Array
    fates: tuple[NDArray[np.str_], ...]
    intervals: int

    @property
    def table(self) -> Table:
        """Columns for pandas or polars."""
        table: Table = {"time_s": self.time_s, "interval": self.interval, "speed_m_per_s": self.speed_m_per_s}
        for station in range(self.points_m.shape[1]):
            for axis, name in enumerate("xyz"):
                table[f"{name}{station + 1}_m"] = self.points_m[:, station, axis]
        return table

    def __len__(self) -> int:
        return len(self.time_s)

    def __repr__(self) -> str:
        kept = ", ".join(f"{np.count_nonzero(fate == 'kept')}/{len(fate)}" for fate in self.fates)
        return f"<Pipeline: {len(self)} triplets in {self.intervals} intervals; readings kept: {kept}>"

    def _repr_html_(self) -> str:
        rows = [["station", "readings", "kept"]]
        for station, fate in enumerate(self.fates, start=1):
            rows.append([str(station), str(len(fate)), str(np.count_nonzero(fate == "kept"))])
        return html_page(f"Pipeline: {len(self)} triplets in {self.intervals} intervals", rows)


class Deployment:
    """One field session of robotic total stations. `resect.open` reads it."""

    def __init__(self, handle: _native.DeploymentHandle) -> None:
        self._handle = handle
        self._about: dict[str, Any] = handle.about()

    @property
    def name(self) -> str:
        """Name of the folder, or as `deployment.toml` gives it."""
        return str(self._about["name"])

    @cached_property
    def tracks(self) -> tuple[Track, ...]:
        """Readings of stations 1, 2, …; a missing station has an empty track."""
        stations = range(self._about["stations"])
        return tuple(Track(station + 1, **self._handle.track(station)) for station in stations)

    @property
    def inter_prism_m(self) -> Array | None:
        """Distances of prisms 12, 13, 23, 14, 24, 34, … as measured on the vehicle (m); None if no file has them."""
        distances_m = self._about["inter_prism_m"]
        return None if distances_m is None else np.array(distances_m)

    @cached_property
    def findings(self) -> dict[str, tuple[Finding, ...]]:
        """Findings of reading, by their code."""
        return findings_by_code(self._about["findings"])

    def run_pipeline(self, **settings: Unpack[Settings]) -> Pipeline:
        """Filters, splits and interpolates the readings.

        Args:
            **settings: settings by their names in a settings file, such as `tau_s_seconds=2.0` or `rate_hz=5.0`.

        Raises:
            ResectError: if a setting is unknown or out of its range.
        """
        arrays = self._handle.run_pipeline(checked(settings))
        names = np.array(arrays.pop("fate_names"))
        fates = tuple(names[codes] for codes in arrays.pop("fates"))
        return Pipeline(fates=fates, **arrays)

    def calibrate(self, method: Method | None = None, **settings: Unpack[Settings]) -> Calibration:
        """Calibrates the stations, and evaluates the answer.

        Args:
            method: the joint estimate by default, or one of the paper's methods by its name or letter: "two-point" (A),
                "static-gcp" (B), "dynamic-gcp" (C), "inter-prism" (D).
            **settings: settings by their names in a settings file, such as `tau_s_seconds=2.0` or `prior="search"`.

        Raises:
            ResectError: if the data does not allow the method, or if a setting is unknown or out of its range.
        """
        return Calibration(self._handle.calibrate(checked(settings, method, ("method",))))

    def _rows(self) -> list[list[str]]:
        rows = [["station", "readings", "from (s)", "to (s)"]]
        for track in self.tracks:
            ends_s = [f"{track.time_s[end]:.1f}" for end in (0, -1)] if len(track) else ["–", "–"]
            rows.append([str(track.station), str(len(track)), *ends_s])
        return rows

    def __repr__(self) -> str:
        return "\n".join([f"Deployment {self.name}", text_table(self._rows()), *lines(self.findings)])

    def _repr_html_(self) -> str:
        return html_page(f"Deployment {self.name}", self._rows(), lines(self.findings))
