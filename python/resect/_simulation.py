"""Simulated deployments with known ground truth."""

from __future__ import annotations

from functools import cached_property

from . import _arguments as arguments
from . import _native
from ._calibration import Transform
from ._deployment import Deployment
from ._keywords import Path, plain
from ._trajectory import Trajectory

__all__ = ["Simulation"]


class Simulation:
    """A simulated deployment with its ground truth. `resect.simulate` returns it."""

    def __init__(self, handle: _native.SimulationHandle, name: str) -> None:
        self._handle = handle
        self._name = name

    @cached_property
    def deployment(self) -> Deployment:
        """The simulated readings, with the numbers of the files that `write` writes."""
        return Deployment(self._handle.deployment())

    @cached_property
    def true_transforms(self) -> tuple[Transform, ...]:
        """The true `station1_from_station2`, `station1_from_station3`, … at set-up."""
        return tuple(Transform._of(values) for values in self._handle.transforms())

    def true_trajectory(self, rate: float = 10.0) -> Trajectory:
        """Returns the true poses of the vehicle in the frame of station 1 at set-up, with a covariance of zero.

        Args:
            rate: poses per second (Hz).

        Raises:
            ResectError: if the rate is out of its range.
        """
        return Trajectory._of(self._handle.trajectory(arguments.number("rate", plain(rate))))

    def write(self, folder: Path) -> None:
        """Writes the files of the deployment, and its ground truth as truth.toml."""
        self._handle.write(arguments.path("folder", folder))

    def __repr__(self) -> str:
        return f"<Simulation of {self._name}>"
