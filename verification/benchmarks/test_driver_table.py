# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The table of devices is complete and up to date."""

from __future__ import annotations

import json
import re

from verification.benchmarks.driver_table import COSTS, DEVICES, PAGE, page
from verification.support.paths import ROOT

SOURCES = ROOT / "drivers" / "src"
WITHOUT_DEVICE = {
    "NXT.Bytes",
    "NXT.Filtering",
    "NXT.Fonts",
    "NXT.Malloc",
    "NXT.Priorities",
    "NXT.Registers",
    "NXT.Shared_State",
}
PUBLIC_PACKAGE = re.compile(r"^(?:generic|package)\b", re.MULTILINE)


def test_the_page_is_generated() -> None:
    """From the list and the measured costs."""
    known = json.loads(COSTS.read_text(encoding="utf-8"))
    assert page(known) == PAGE.read_text(encoding="utf-8")


def test_every_package_drives_a_device() -> None:
    """Each public child of NXT is in the list, or serves others."""
    public = {
        path.stem.upper().replace("NXT-", "NXT.")
        for path in SOURCES.rglob("nxt-*.ads")
        if "-" not in path.stem[4:] and PUBLIC_PACKAGE.search(path.read_text(encoding="utf-8"))
    }
    listed = {name.upper() for device in DEVICES for name in device.packages}
    assert public == listed | {name.upper() for name in WITHOUT_DEVICE}


def test_every_test_and_every_cost_is_named() -> None:
    """Tests exist, and each measured operation belongs to one device."""
    for device in DEVICES:
        for name in device.tests:
            assert (ROOT / "drivers" / "tests" / f"test_{name}.py").is_file(), name
    known = json.loads(COSTS.read_text(encoding="utf-8"))
    for row in known["operations"]:
        owners = [device.name for device in DEVICES if row["name"].startswith(device.operations)]
        assert len(owners) == 1, row["name"]
    assert {row["name"] for row in known["tasks"]} == {d.task for d in DEVICES if d.task}
