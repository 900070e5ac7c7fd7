# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A race: a scenario with a robot, and perhaps a track, that the seed draws; and its measures."""

from __future__ import annotations

import math
import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ravenbrick.errors import RavenbrickError
from ravenbrick.grading.variants import Individual, own_robot
from ravenbrick.project.robot import Robot
from ravenbrick.trace.measures import RunMeasures
from ravenbrick.trace.recording import Recording

__all__ = ["MEASURES", "Race", "Track", "mean_measures", "race_of"]

# Each with whether the larger one wins.
MEASURES: Mapping[str, bool] = {
    "time_s": False,
    "deviation": False,
    "energy_j": False,
    "deadline_margin": True,
}
# More digits than these never decide a place.
DIGITS = 4
WHITE, BLACK = 0.9, 0.08
SUPERSAMPLES = 4
# Largest share of the second and third harmonic in the radius; with these the track is convex.
HARMONICS = {2: 0.1, 3: 0.04}
MARGIN_M = 0.2
FLOOR_FILE = "floor.png"

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Track:
    """A black line around a convex area, `width` (m) wide; the mean radius (m) is drawn."""

    least: float
    most: float
    width: float

    def floor(self, robot: Robot, seed: int, folder: Path) -> Robot:
        """The robot on a drawn track, whose picture is written into the folder.

        The robot starts in the direction of the line, its first sensor that looks at the floor
        above the left edge.
        """
        assert robot.floor is not None
        ahead = next((s.mount.x for s in robot.sensor_ports.values() if s.mount), 0.0)
        curve = _drawn_curve(self.least, self.most, f"track {seed}")
        pixel = robot.floor.pixel.value
        size = 2 * curve.largest + 2 * MARGIN_M
        count = math.ceil(size / pixel) * SUPERSAMPLES
        # From the centre of the curve, in the directions of the robot.
        along = pixel / SUPERSAMPLES * (np.arange(count) + 0.5) - size / 2
        line = curve.distance(along[None, :] + 1j * along[:, None]) < self.width / 2
        side = count // SUPERSAMPLES
        share = line.reshape(side, SUPERSAMPLES, side, SUPERSAMPLES).mean(axis=(1, 3))
        image = folder / FLOOR_FILE
        _save(image, WHITE + (BLACK - WHITE) * share[::-1])
        begin = complex(ahead, -self.width / 2)
        centre = begin - curve.begin
        corner = (centre.real - size / 2, centre.imag - size / 2)
        return replace(robot, floor=replace(robot.floor, image=image, corner=corner, outside=WHITE))


@dataclass(frozen=True)
class _Curve:
    """The middle of a line around its centre: `radius` (m) times 1 + sum of a cos(n angle + p).

    It is turned by `turn` (rad), so that it goes along x where its own angle is `start`.
    """

    radius: float
    waves: tuple[tuple[int, float, float], ...]
    start: float

    @property
    def largest(self) -> float:
        """No point is farther from the centre; m."""
        return self.radius * (1 + sum(HARMONICS.values()))

    @property
    def turn(self) -> float:
        """Direction of the curve at `start` before it is turned; rad."""
        return self.start + math.atan2(self._radius(self.start), self._slope(self.start))

    @property
    def begin(self) -> complex:
        """Where it goes along x; m."""
        return complex(self._radius(self.start) * np.exp(1j * (self.start - self.turn)))

    def distance(self, points: NDArray[np.complex128]) -> Floats:
        """Of points to the curve, right near the curve; m."""
        angle = np.angle(points) + self.turn
        radius = self._radius(angle)
        across: Floats = np.abs(np.abs(points) - radius)
        across /= np.hypot(1, self._slope(angle) / radius)
        return across

    def _radius(self, angle: Any) -> Any:
        return self.radius * (1 + sum(a * np.cos(n * angle + p) for n, a, p in self.waves))

    def _slope(self, angle: Any) -> Any:
        return -self.radius * sum(a * n * np.sin(n * angle + p) for n, a, p in self.waves)


def _drawn_curve(least: float, most: float, seed: str) -> _Curve:
    dice = random.Random(seed)
    radius = dice.uniform(least, most)
    waves = ((n, dice.uniform(0, a), dice.uniform(0, math.tau)) for n, a in HARMONICS.items())
    return _Curve(radius, tuple(waves), dice.uniform(0, math.tau))


@dataclass(frozen=True)
class Race:
    """From `from_ms` until `finish` (signal, value) is reached, near `line` (signal, value)."""

    from_ms: int
    finish: tuple[str, float]
    line: tuple[str, float]
    track: Track | None = None

    def robot(self, robot: Robot, seed: int, folder: Path) -> Robot:
        """A robot drawn within its tolerances, on a track of the seed."""
        everything = Individual(motors=tuple(robot.motor_ports), battery=True, sensors=True)
        drawn = own_robot(robot, everything, f"race {seed}")
        return self.track.floor(drawn, seed, folder) if self.track else drawn

    def measure(self, robot: Robot, recording: Recording, run: RunMeasures) -> dict[str, float]:
        """The four measures of a run; raises `RavenbrickError` where it did not finish."""
        begin = self.from_ms / 1000
        times, values = _signal(recording, self.finish[0])
        reached = times[(times >= begin) & (values >= self.finish[1])]
        if not reached.size:
            raise RavenbrickError(f"it did not finish: {self.finish[0]} stayed below the finish")
        end = float(reached[0])
        times, values = _signal(recording, self.line[0])
        off = values[(times >= begin) & (times <= end)] - self.line[1]
        found = {
            "time_s": end - begin,
            "deviation": math.sqrt(math.fsum(off * off) / off.size),
            "energy_j": math.fsum(_energy(recording, p, begin, end) for p in robot.motor_ports),
            "deadline_margin": _margin(run),
        }
        return {name: float(f"{value:.{DIGITS}g}") for name, value in found.items()}


def _save(file: Path, picture: Floats) -> None:
    from matplotlib.image import imsave  # slow to load, and few races have a track

    imsave(file, picture, cmap="gray", vmin=0.0, vmax=1.0)


def _signal(recording: Recording, name: str) -> tuple[Floats, Floats]:
    if name not in recording.signals:
        known = ", ".join(sorted(recording.signals))
        raise RavenbrickError(f"the signal '{name}' was not recorded; recorded: {known}")
    return recording.signal(name)


def _energy(recording: Recording, port: str, begin: float, end: float) -> float:
    """What the terminals of a motor took, J; a sample holds until the next one."""
    times, voltage = _signal(recording, f"motor.{port}.voltage")
    _, current = _signal(recording, f"motor.{port}.current")
    edges = np.clip(np.append(times, end), begin, end)
    return math.fsum(voltage * current * np.diff(edges))


def _margin(run: RunMeasures) -> float:
    """Least share of its deadline that a task had left; raises where one was missed."""
    late = [task.name for task in run.tasks if task.deadline_misses]
    if late:
        raise RavenbrickError(f"the task '{late[0]}' missed a deadline")
    shares = [
        1 - task.response_time_cycles_max / task.deadline_cycles
        for task in run.tasks
        if task.deadline_cycles and task.response_time_cycles_max is not None
    ]
    return min(shares, default=1.0)


def race_of(table: Mapping[str, Any], robot: Robot) -> Race:
    """The table `race` of a check; raises `ValueError`."""
    drawn, track = table.get("track"), None
    if drawn is not None:
        if robot.floor is None:
            raise ValueError("there is no [floor] in robot.toml; remove 'track'")
        track = Track(float(drawn["least_m"]), float(drawn["most_m"]), float(drawn["width_m"]))
        if track.most < track.least:
            raise ValueError(f"most_m = {track.most:g} is less than least_m = {track.least:g}")
    (finish, line) = (
        (entry["signal"], float(entry["value"])) for entry in (table["finish"], table["line"])
    )
    return Race(table["from_ms"], finish, line, track)


def mean_measures(rows: Sequence[Mapping[str, float]]) -> dict[str, float]:
    """Means of the runs of a race."""
    return {
        name: float(f"{math.fsum(row[name] for row in rows) / len(rows):.{DIGITS}g}")
        for name in MEASURES
    }
