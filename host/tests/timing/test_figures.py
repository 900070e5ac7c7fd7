# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Bars, marks and words of the pictures lie where the numbers say."""

from __future__ import annotations

import math
from typing import Any, cast

import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from verification.support.recordings import preempted

from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.timing.chain import ChainDelay
from ravenbrick.timing.results import figures
from ravenbrick.timing.results.figures import (
    TERMS,
    margin_figure,
    spreads_figure,
    terms_figure,
)
from ravenbrick.timing.results.phase_margin import Loop

MS = MASTER_CLOCK.cycles_of_ms(1)


def task(name: str, deadline_us: int, observed: int | None, **terms: int) -> dict[str, Any]:
    """A row of the results; its bound is the sum of its terms."""
    return {
        "name": name,
        "deadline_us": deadline_us,
        "terms": {key: 0 for key, _, _ in TERMS} | terms,
        "response_bound_cycles": sum(terms.values()),
        "observed": None if observed is None else {"response_cycles": observed},
    }


def bars(axis: Axes) -> list[tuple[float, float, float]]:
    """Begin, width and height of each bar, as drawn."""
    found = [cast(Rectangle, patch) for patch in axis.patches]
    return [(bar.get_x(), bar.get_width(), bar.get_height()) for bar in found]


def marks(axis: Axes) -> list[float]:
    """Where the upright lines stand."""
    lines = [[float(x) for x in cast(Any, line.get_xdata())] for line in axis.lines]
    return [xs[0] for xs in lines if len(set(xs)) == 1]


def test_a_bound_is_the_row_of_its_terms_beside_its_share_of_the_deadline() -> None:
    """Of two tasks, the second late; one without a bound has no row."""
    rows = [
        task("brake", 4_000, MS, own_cycles=MS, blocking_cycles=MS),
        task("late", 1_000, None, own_cycles=2 * MS, interference_cycles=2 * MS),
        {"name": "unbounded", "terms": None},
    ]
    shares, times = terms_figure({"tasks": rows}).axes
    assert [label.get_text() for label in shares.get_yticklabels()] == ["late", "brake"]
    # Own, interference and blocking, each for both tasks from below.
    assert bars(shares) == [
        (0, 50, 0.5), (0, 50, 0.5), (50, 50, 0.5), (50, 0, 0.5), (100, 0, 0.5), (50, 50, 0.5),
    ]  # fmt: skip
    assert marks(shares) == [50]
    assert [width for _, width, _ in bars(times)] == pytest.approx([400, 50], rel=1e-4)
    assert marks(times) == pytest.approx([25, 100], rel=1e-4)
    words = [text.get_text() for text in times.texts]
    assert words == ["4000 of 1000 us", "2000 of 4000 us"]
    colours = [cast(Rectangle, bar).get_facecolor() for bar in times.patches]
    assert colours[0] != colours[1]


def test_the_window_of_a_run_shows_who_had_the_processor_when() -> None:
    """Cycles of the events: two handlers, a preemption; nothing lies outside of the window."""
    (axis,) = Figure().subplots(1, 1, squeeze=False)[0]
    recording = preempted()
    lanes = {thread.name: lane for lane, thread in enumerate(recording.threads)}
    figures._observed(axis, recording, lanes | {"interrupts": 2}, 1000, 5000.0, "the run")
    hertz = MASTER_CLOCK.hertz / 1e6
    found = [
        (round(bar.get_y() + 0.3), round(bar.get_x() * hertz), round(bar.get_width() * hertz))
        for bar in cast(list[Rectangle], axis.patches)
    ]
    assert [one for one in found if one[0] == 2] == [(2, 500, 100), (2, 1005, 95)]
    assert [one for one in found if one[0] == 1] == [(1, 1130, 910)]
    ends = [begin + width for _, begin, width in found]
    begins = [begin for _, begin, _ in found]
    assert begins[0] >= 0 and ends[-1] == 5000 and ends[:-1] <= begins[1:]
    assert sum(width for _, _, width in found) >= 4990
    assert "worst window of the run" in axis.get_title()


def test_spreads_show_each_count_where_it_was_seen() -> None:
    """With the bound; tasks that the long run did not see are left out."""
    seen = {
        "response_time_cycles": {"bins": [[MS, 7], [2 * MS, 3]]},
        "release_latency_cycles": {"bins": [[MS // 2, 10]]},
    }
    rows = [task("brake", 4_000, None, own_cycles=3 * MS), task("other", 1_000, None)]
    (axis,) = spreads_figure({"tasks": rows, "long_run": {"tasks": {"brake": seen}}}).axes
    begins, widths, heights = zip(*bars(axis), strict=True)
    assert begins == pytest.approx([1_000, 2_000, 500], rel=1e-4)
    assert widths == pytest.approx([1, 1, 1]) and heights == (7, 3, 10)
    assert marks(axis) == pytest.approx([3_000], rel=1e-4)
    assert axis.get_ylabel().startswith("brake\n")


def test_the_phase_margin_is_told_at_the_designed_and_at_the_bounded_delay() -> None:
    """60 degrees at 10 rad/s: 10 ms more cost 5.7; the band is what was seen."""
    chain = ChainDelay("turn", ("read", "drive"), None, 12 * MS, 3 * MS, 8 * MS, None, 9)
    figure = margin_figure(Loop(((10.0, 60.0),), 0.002), chain)
    (axis,) = figure.axes
    words = {str(line.get_label()) for line in axis.lines}
    assert words >= {"designed: 2.00 ms, 60.0 degrees", "bound: 12.00 ms, 54.3 degrees"}
    ((begin, width, _),) = bars(axis)
    assert (begin, width) == pytest.approx((3, 5), rel=1e-4)
    assert marks(axis) == pytest.approx([2, 2, 12, 12], rel=1e-4)  # lines, and dots on them
    margins = next(line for line in axis.lines if "another delay" in str(line.get_label()))
    curve = [float(y) for y in cast(Any, margins.get_ydata())]
    delays = [float(x) for x in cast(Any, margins.get_xdata())]
    lost = [math.degrees(10 * (delay - 2) / 1000) for delay in delays]
    assert curve == pytest.approx([60 - degrees for degrees in lost], rel=1e-9) and len(curve) > 50
    assert axis.get_xlim() == pytest.approx((0, 14.4), rel=1e-4)
