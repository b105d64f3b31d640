#!/usr/bin/env python3
"""Adjusts the polar readings of control points in a folder with scipy, which shares no code with resect. Prints the transforms as JSON.

    adjust_control_points.py FOLDER [--prism-constant M] [--iterations N]

Observation equations are those of textbooks: range, direction and zenith angle of each reading. Constants and priors are those of
`calibration/joint/survey.rs` and `calibration/instrument.rs`; robust weights and noise levels are estimated as described there.
"""

import argparse
import json
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

ARCSECOND = np.pi / 180 / 3600
EARTH_RADIUS = 6.371e6
REFRACTION = 0.13
# Standard deviations of a range, an angle, the target across the sight, and a surveyed coordinate (m, rad).
RANGE, RANGE_SHARE, ANGLE, TARGET, SURVEYED = 1e-3, 1e-6, 6e-6, 3e-4, 2e-3
# Standard deviations of the priors: lean (that of a drive, and its change since the survey), scale, vertical index, collimation, prism
# constant of the target, zero of the ranges of a station.
LEAN, SCALE, INDEX, COLLIMATION, CONSTANT, ZERO = 2 * 2**0.5 * ARCSECOND, 7e-6, 4 * ARCSECOND, 3 * ARCSECOND, 5e-3, 1e-3
# Cauchy's loss, its consistency with normal errors, and the numbers by which the stated noise counts.
LOSS_SCALE, CONSISTENCY, STATED = 2.4, 0.70, 12.0
LEAST_REDUNDANCY = 0.05
READINGS = {"theodolite_number", "marker_number", "status", "elevation", "azimuth", "distance"}
PILLARS = {"marker_number", "distance_m", "height_m"}


def read_tables(folder, columns):
    """Name and rows of each file with these columns."""
    for path in sorted(path for path in folder.iterdir() if path.suffix in (".txt", ".csv")):
        lines = [line.split(",") for line in path.read_text().splitlines() if line.strip()]
        names = [name.strip() for name in lines[0]]
        if columns <= set(names):
            yield path.name, [dict(zip(names, map(float, line))) for line in lines[1:]]


class Survey:
    """Readings of all sets of control points, as arrays."""

    def __init__(self, folder, prism_constant):
        pillars = {}
        for _, rows in read_tables(folder, PILLARS):
            pillars = {row["marker_number"]: [row["distance_m"], 0.0, row["height_m"]] for row in rows}
        markers, readings, surveyed, self.sets = {}, {}, {}, 0
        for file, rows in read_tables(folder, READINGS):
            for row in rows:
                if row["status"] == 0 and row["distance"] > 0:
                    key = (self.sets, row["marker_number"])
                    marker = markers.setdefault(key, len(markers))
                    station = int(row["theodolite_number"]) - 1
                    readings.setdefault((marker, station), (row["distance"] + prism_constant, row["azimuth"], row["elevation"]))
                    if "two_points" in file.lower() and row["marker_number"] in pillars:
                        surveyed[marker] = (self.sets, pillars[row["marker_number"]])
            self.sets += 1
        # Fewer than two coordinates determine nothing but the frame.
        count = [sum(owner == index for owner, _ in surveyed.values()) for index in range(self.sets)]
        surveyed = {marker: value for marker, value in surveyed.items() if count[value[0]] > 1}
        self.markers = len(markers)
        self.marker, self.station = np.array(list(readings)).T
        self.range, self.azimuth, self.zenith = np.array(list(readings.values())).T
        self.surveyed = np.array(sorted(surveyed), dtype=int)
        self.frame = np.array([surveyed[marker][0] for marker in self.surveyed], dtype=int)
        self.known = np.array([surveyed[marker][1] for marker in self.surveyed]).reshape(-1, 3)
        across = np.hypot(ANGLE * self.range, TARGET)
        self.sigma = np.array([RANGE + RANGE_SHARE * self.range, across, across]).T

    def cartesian(self):
        """Points of the readings in the stations' own frames: x along azimuth zero, azimuth clockwise, z up."""
        horizontal = self.range * np.sin(self.zenith)
        return np.array([horizontal * np.cos(self.azimuth), -horizontal * np.sin(self.azimuth), self.range * np.cos(self.zenith)]).T


def yawed(yaw, points):
    """Points rotated about z."""
    cos, sin = np.cos(yaw), np.sin(yaw)
    return np.array([cos * points[..., 0] - sin * points[..., 1], sin * points[..., 0] + cos * points[..., 1], points[..., 2]]).T


def align_level(to, points):
    """Least-squares translation and yaw that map points."""
    a, b = to - to.mean(0), points - points.mean(0)
    yaw = np.arctan2((b[:, 0] * a[:, 1] - b[:, 1] * a[:, 0]).sum(), (b[:, 0] * a[:, 0] + b[:, 1] * a[:, 1]).sum())
    return np.append(to.mean(0) - yawed(yaw, points.mean(0)), yaw)


def wrapped(angle):
    return (angle + np.pi) % (2 * np.pi) - np.pi


class Adjustment:
    """Unknowns in one vector: poses of stations 2 and 3, leans, instruments in units of their priors, markers, frames of surveyed sets."""

    PRIORS = 6 + 3 * 4 + 1

    def __init__(self, survey):
        self.survey = survey
        points = survey.cartesian()
        own = [dict(zip(survey.marker[survey.station == k], points[survey.station == k])) for k in range(3)]
        shared = [sorted(own[0].keys() & own[k].keys()) for k in range(3)]
        poses = [align_level(np.array([own[0][m] for m in shared[k]]), np.array([own[k][m] for m in shared[k]])) for k in (1, 2)]
        # Plumb lines lean away from station 1 by the curvature of the earth.
        self.lean_mean = np.zeros((3, 2))
        for k, (x, y, _, yaw) in enumerate(poses, 1):
            self.lean_mean[k] = yawed(-yaw, np.array([-y, x, 0.0]))[:2] / EARTH_RADIUS
        placed = [{}, {}, {}]
        for k in range(3):
            x, y, z, yaw = poses[k - 1] if k else np.zeros(4)
            placed[k] = {m: yawed(yaw, p) + [x, y, z] for m, p in own[k].items()}
        markers = np.array([np.mean([at[m] for at in placed if m in at], axis=0) for m in range(survey.markers)])
        frames = np.zeros((survey.sets, 4))
        for index in set(survey.frame):
            mine = survey.frame == index
            frames[index] = align_level(markers[survey.surveyed[mine]], survey.known[mine])
        self.x = np.concatenate([np.ravel(poses), np.zeros(self.PRIORS), markers.ravel(), frames.ravel()])
        self.weights = np.ones(len(survey.range))
        # Of the noise along the sights, to their right and up.
        self.factors = np.ones(3)

    def parts(self, x):
        poses, priors, rest = np.split(x, [8, 8 + self.PRIORS])
        markers, frames = np.split(rest, [3 * self.survey.markers])
        return poses.reshape(2, 4), priors, markers.reshape(-1, 3), frames.reshape(-1, 4)

    def misclosures(self, x):
        """Observed less computed range, direction and zenith angle, in m along and across the sight."""
        survey = self.survey
        poses, priors, markers, _ = self.parts(x)
        lean = self.lean_mean + LEAN * priors[:6].reshape(3, 2)
        scale, index, collimation = SCALE * priors[6:9], INDEX * priors[9:12], COLLIMATION * priors[12:15]
        offset = ZERO * priors[15:18] + CONSTANT * priors[18]
        out = np.empty((len(survey.range), 3))
        for k in range(3):
            mine = survey.station == k
            position, yaw = (poses[k - 1, :3], poses[k - 1, 3]) if k else (np.zeros(3), 0.0)
            leaning = Rotation.from_rotvec([*lean[k], 0.0])
            own = leaning.inv().apply(yawed(-yaw, markers[survey.marker[mine]] - position))
            distance = np.linalg.norm(own, axis=1)
            horizontal = np.hypot(own[:, 0], own[:, 1])
            elevation = np.arctan2(own[:, 2], horizontal)
            observed, sine = survey.range[mine], np.sin(survey.zenith[mine])
            out[mine, 0] = observed - (distance + offset[k]) / (1 - scale[k])
            azimuth = np.arctan2(-own[:, 1], own[:, 0]) + collimation[k] / np.cos(elevation)
            out[mine, 1] = wrapped(survey.azimuth[mine] - azimuth) * observed * sine
            # Refraction bends the sight towards the earth: the target seems higher.
            seen = elevation - index[k] + REFRACTION * observed / (2 * EARTH_RADIUS)
            out[mine, 2] = (np.pi / 2 - survey.zenith[mine] - seen) * observed
        return out

    def sigma(self):
        return self.survey.sigma * self.factors

    def whitened(self, x):
        survey = self.survey
        _, priors, markers, frames = self.parts(x)
        readings = self.misclosures(x) / self.sigma() * np.sqrt(self.weights)[:, None]
        own = frames[survey.frame]
        known = np.array([yawed(yaw, point) + [a, b, c] for (a, b, c, yaw), point in zip(own, survey.known)]).reshape(-1, 3)
        surveyed = (markers[survey.surveyed] - known) / SURVEYED
        # Frames without surveyed coordinates are held.
        held = np.delete(frames, np.unique(survey.frame), axis=0)
        return np.concatenate([readings.ravel(), priors, surveyed.ravel(), held.ravel()])

    def solve(self):
        """Solves with the weights; returns normalised squares and redundancy numbers of the readings."""
        found = least_squares(self.whitened, self.x, jac="3-point", method="trf", xtol=1e-15, ftol=1e-15, gtol=1e-15, x_scale="jac")
        self.x = found.x
        self.covariance = np.linalg.inv(found.jac.T @ found.jac)
        numbers = 3 * len(self.survey.range)
        rows = found.jac[:numbers]
        redundancy = 1 - np.einsum("ij,jk,ik->i", rows, self.covariance, rows)
        return (self.misclosures(self.x) / self.sigma()) ** 2, redundancy.reshape(-1, 3).clip(0, 1)

    def reweight(self, squares, redundancy):
        """Estimates noise factors, then robust weights, from residuals by the former factors and weights."""
        weights = self.weights[:, None] ** 2
        factors = self.factors.copy()
        for axis in range(3):
            square = STATED / factors[axis] ** 2 + (weights[:, 0] * squares[:, axis]).sum() / CONSISTENCY
            factors[axis] *= np.sqrt(square / (STATED + (weights[:, 0] * redundancy[:, axis]).sum()))
        mean = (squares / redundancy.clip(LEAST_REDUNDANCY)).mean(1)
        self.weights = 1 / (1 + mean / LOSS_SCALE**2)
        self.factors = factors


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path)
    parser.add_argument("--prism-constant", type=float, default=0.010)
    parser.add_argument("--iterations", type=int, default=100)
    arguments = parser.parse_args()
    adjustment = Adjustment(Survey(arguments.folder, arguments.prism_constant))
    for iteration in range(arguments.iterations):
        before = adjustment.x[:8].copy()
        squares, redundancy = adjustment.solve()
        if iteration > 0 and np.abs(adjustment.x[:8] - before).max() < 1e-8:
            break
        adjustment.reweight(squares, redundancy)
    poses = adjustment.parts(adjustment.x)[0]
    sigma = np.sqrt(np.diag(adjustment.covariance)[:8]).reshape(2, 4)
    transforms = [
        {"from": k + 2, "to": 1, "translation_m": list(pose[:3]), "yaw_rad": wrapped(pose[3]), "sigma": list(deviation)}
        for k, (pose, deviation) in enumerate(zip(poses, sigma))
    ]
    print(json.dumps({"transforms": transforms, "noise_factors": list(adjustment.factors), "iterations": iteration}))


main()
