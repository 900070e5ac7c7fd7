# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Signals of a simulation by name, and what a picture of the diagram says of them."""

from __future__ import annotations

import numpy as np
import pytest

from ravenbrick.errors import DesignError
from ravenbrick.model.simulation.recording import Recording, Signal

TIMES = np.array([0.0, 1.0, 1.0, 2.0])


def signal(path: str, values: list[float], *, held: bool = False) -> Signal:
    return Signal(path, TIMES[: len(values)], np.array(values), "V", held)


RECORDING = Recording(
    {
        one.path: one
        for one in (
            signal("loop/left/u", [0.5, -2.0, 3.0, 1.25]),
            signal("loop/right/u", [0.0, 0.0]),
            signal("loop/y", []),
            signal("plant/y", [1.0]),
        )
    }
)


def test_a_signal_is_found_by_its_path_or_its_only_end() -> None:
    assert RECORDING["left/u"] is RECORDING["loop/left/u"]
    for name, sentence in {
        "u": "several signals are called 'u'; there are: loop/left/u, loop/right/u",
        "z": "no signal is called 'z'; there are: loop/left/u, .*plant/y",
    }.items():
        with pytest.raises(DesignError, match=sentence):
            RECORDING[name]
    assert [one.path for one in RECORDING.matching("loop/*/u", "plant/y", "left/u")] == [
        *("loop/left/u", "loop/right/u", "plant/y")
    ]


def test_the_picture_says_least_largest_and_last_value_of_a_diagrams_signals() -> None:
    """Of that diagram alone; a signal without values has none."""
    assert RECORDING.ranges("loop") == {
        "left/u": "-2 to 3 V, at the end 1.25",
        "right/u": "0 to 0 V, at the end 0",
    }


def test_a_value_at_a_jump_is_the_one_after_it() -> None:
    """A held signal keeps its value, another goes straight from one to the next."""
    values = [0.5, -2.0, 3.0, 1.0]
    straight, held = signal("a", values), signal("a", values, held=True)
    assert [straight.at(at) for at in (0.0, 0.5, 1.0, 1.5, 2.0)] == [0.5, -0.75, 3.0, 2.0, 1.0]
    assert [held.at(at) for at in (-1.0, 0.0, 0.5, 1.0, 1.5, 2.0)] == [0.5, 0.5, 0.5, 3.0, 3.0, 1.0]
