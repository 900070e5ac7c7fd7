# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The examples show what the guide says they show."""

from __future__ import annotations

import pytest

from examples.devices.pictures import EXAMPLES, GUIDE, HERE, PICTURES, guide, picture, run


@pytest.mark.parametrize("name", EXAMPLES)
def test_an_example_makes_its_picture(name: str) -> None:
    """Byte for byte that of the guide."""
    assert picture(run(name)) == (PICTURES / f"{name}.svg").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_power_button_switches_an_example_off(name: str) -> None:
    """Held for 3 s; programs without motors, sensors and buttons name NXT.AVR for it."""
    brick = run(name)
    pressed_ms = EXAMPLES[name].at_ms + 1
    brick.set(pressed_ms, "button.orange", 1)
    assert brick.run_to_end(pressed_ms + 3_030).reason == "power_off"


def test_the_guide_lists_every_example() -> None:
    """Each folder with a program is in it, and it is up to date."""
    folders = {path.parent.name for path in HERE.glob("*/*.adb")}
    assert folders == set(EXAMPLES)
    assert guide() == GUIDE.read_text(encoding="utf-8")
