# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Each function of each witness; those whose images are absent are skipped with their source."""

from __future__ import annotations

import pytest

from verification.firmware.witnesses.campaign import KNOWN_FAILURES, outcome
from verification.firmware.witnesses.library import CHECKS, FUNCTIONS, Check, images
from verification.firmware.witnesses.link import commands, transfers


@pytest.mark.long("boots a firmware image")
@pytest.mark.parametrize("check", CHECKS, ids=lambda check: f"{check.witness}, {check.function}")
def test_it_works_as_on_real_bricks(check: Check) -> None:
    row = outcome(check)
    if row["outcome"] == "absent":
        pytest.skip(row["seen"])
    if row["outcome"] == "failed" and (check.witness, check.function) in KNOWN_FAILURES:
        pytest.xfail(KNOWN_FAILURES[check.witness, check.function])
    assert row["outcome"] == "passed", row["seen"]


def test_each_image_has_a_digest_of_its_own_and_a_source() -> None:
    known = list(images().values())
    assert len({image.sha256 for image in known}) == len(known)
    assert all(len(image.sha256) == 64 and image.published for image in known)
    assert {check.function for check in CHECKS} <= set(FUNCTIONS)


def test_frames_are_taken_from_the_bus_log_as_the_source_of_the_co_processor_says() -> None:
    good = bytes([0, 8, 50, 0, 0, 0, 0, 0])
    frame = good + bytes([~sum(good) & 0xFF])

    def sent(data: bytes) -> list[tuple[int, str]]:
        return [(0, "twi S 02a"), *((0, f"twi {byte:02X}a") for byte in data), (0, "twi P")]

    split = sent(frame[:7]) + sent(frame[7:])
    doubled = sent(frame[:1] + frame[:8])
    cut_before = sent(frame)[3:]
    assert commands(sent(frame) + split + doubled + cut_before) == [frame]
    assert len(list(transfers(split))) == 2
