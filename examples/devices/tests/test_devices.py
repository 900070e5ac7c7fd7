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


def test_the_guide_lists_every_example() -> None:
    """Each folder with a program is in it, and it is up to date."""
    folders = {path.parent.name for path in HERE.glob("*/*.adb")}
    assert folders == set(EXAMPLES)
    assert guide() == GUIDE.read_text(encoding="utf-8")
