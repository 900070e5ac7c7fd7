# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Paths from above, over the picture on the floor and between the walls."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ravenbrick.project.robot import Floor, Robot
from ravenbrick.report.chart import COLOURS, SERIES, Drawing, Panel
from ravenbrick.trace.recording import Recording

__all__ = ["moved", "path_drawing"]

Floats = NDArray[np.float64]
WIDTH, LEFT, TOP, LEAST, MOST = 930, 62, 26, 150, 520
PNG_SIZE = slice(16, 24)
# A robot that shakes on the spot has no path.
LEAST_WAY = 0.1


def moved(recording: Recording) -> bool:
    """Whether the body went somewhere; m."""
    if not {"body.x", "body.y"} <= set(recording.signals):
        return False
    values = [recording.signals[name].values for name in ("body.x", "body.y")]
    return any(v.size > 0 and float(np.ptp(v)) >= LEAST_WAY for v in values)


def _floor_size(floor: Floor) -> tuple[float, float] | None:
    """Width and height of the picture, in m; None for one that cannot be shown."""
    content = floor.image.read_bytes() if floor.image.is_file() else b""
    if content[:8] != b"\x89PNG\r\n\x1a\n":
        return None
    width, height = np.frombuffer(content[PNG_SIZE], ">u4").tolist()
    return width * floor.pixel.value, height * floor.pixel.value


def _draw_floor(panel: Panel, floor: Floor, width: float, height: float) -> None:
    left, top = float(panel.at_x(floor.corner[0])), float(panel.at_y(floor.corner[1] + height))
    right, bottom = float(panel.at_x(floor.corner[0] + width)), float(panel.at_y(floor.corner[1]))
    content = b64encode(floor.image.read_bytes()).decode("ascii")
    panel.drawing.add(
        f'<image x="{left:.1f}" y="{top:.1f}" width="{right - left:.1f}" '
        f'height="{bottom - top:.1f}" opacity="0.35" href="data:image/png;base64,{content}"/>'
    )


def _extent(robot: Robot, paths: Sequence[tuple[Floats, Floats]]) -> tuple[Floats, Floats]:
    """Least and greatest x, then y, of all that is shown; m."""
    x, y = ([np.concatenate([path[axis] for path in paths])] for axis in (0, 1))
    size = _floor_size(robot.floor) if robot.floor is not None else None
    if robot.floor is not None and size is not None:
        corner = robot.floor.corner
        x.append(np.array([corner[0], corner[0] + size[0]]))
        y.append(np.array([corner[1], corner[1] + size[1]]))
    ends = [end for wall in robot.walls for end in (wall.begin, wall.end)]
    x.append(np.array([end[0] for end in ends]))
    y.append(np.array([end[1] for end in ends]))
    low_high = (np.array([np.min(v), np.max(v)]) for v in (np.concatenate(x), np.concatenate(y)))
    first, second = low_high
    return first, second


def path_drawing(robot: Robot, runs: Sequence[tuple[str, Recording]]) -> Drawing:
    """In m, both axes to the same scale, a dot every 2 s; `runs`: a label for each."""
    paths = [(r.signal("body.x")[1], r.signal("body.y")[1]) for _label, r in runs]
    x, y = _extent(robot, paths)
    margin = 0.06 * max(float(np.ptp(x)), float(np.ptp(y)), 0.1)
    around = np.array([-margin, margin])
    x, y = x + around, y + around
    scale = min((WIDTH - LEFT - 14) / np.ptp(x), MOST / np.ptp(y))
    height = max(float(scale * np.ptp(y)), LEAST)
    half_x, half_y = (WIDTH - LEFT - 14) / scale / 2, height / scale / 2
    middle_x, middle_y = float(np.mean(x)), float(np.mean(y))
    drawing = Drawing(WIDTH, TOP + height + 40, "Path from above")
    panel = Panel(
        drawing, LEFT, TOP, WIDTH - LEFT - 14, height,
        (middle_x - half_x, middle_x + half_x), (middle_y - half_y, middle_y + half_y),
    )  # fmt: skip
    panel.x_axis("x (m); a dot every 2 s")
    size = _floor_size(robot.floor) if robot.floor is not None else None
    if robot.floor is not None and size is not None:
        _draw_floor(panel, robot.floor, *size)
    panel.y_axis("y (m)")
    for wall in robot.walls:
        ends = np.array([wall.begin, wall.end])
        panel.line(ends[:, 0], ends[:, 1], COLOURS["text"], 4, ordered=False)
    for number, ((_label, recording), (xs, ys)) in enumerate(zip(runs, paths, strict=True)):
        colour = SERIES[number % len(SERIES)]
        panel.line(xs[::10], ys[::10], colour, 2.2, ordered=False)
        times = recording.signal("body.x")[0]
        at = np.searchsorted(times, np.arange(0.0, times[-1], 2.0))
        _dots(panel, xs[at], ys[at], colour)
    _dots(panel, np.zeros(1), np.zeros(1), COLOURS["setpoint"], 4.5)
    start = float(panel.at_x(0)) + 7, float(panel.at_y(0)) - 7
    drawing.text(*start, "start", size=11)
    panel.legend([(label, SERIES[n % len(SERIES)], "") for n, (label, _r) in enumerate(runs)])
    return drawing


def _dots(panel: Panel, x: Floats, y: Floats, colour: str, radius: float = 3) -> None:
    for a, b in zip(panel.at_x(x).tolist(), panel.at_y(y).tolist(), strict=True):
        panel.drawing.add(f'<circle cx="{a:.1f}" cy="{b:.1f}" r="{radius:g}" fill="{colour}"/>')
