# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Each function of each witness; those whose images are absent are skipped with their source."""

from __future__ import annotations

import pytest

from verification.firmware.witnesses.campaign import outcome
from verification.firmware.witnesses.chibios import CASES, PUBLISHED, deviations, results
from verification.firmware.witnesses.library import CHECKS, FUNCTIONS, Check, images
from verification.firmware.witnesses.link import commands, transfers


@pytest.mark.long("boots a firmware image")
@pytest.mark.parametrize("check", CHECKS, ids=lambda check: f"{check.witness}, {check.function}")
def test_it_works_as_on_real_bricks(check: Check) -> None:
    row = outcome(check)
    if row["outcome"] == "absent":
        pytest.skip(row["seen"])
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


def test_scores_are_read_case_by_case_and_compared_with_the_published_ones() -> None:
    report = (
        "--- Test Case 11.4 (Benchmark, context switch)\n--- Score : 380288 ctxswc/S\n"
        "--- Result: SUCCESS\n----\n--- Test Case 11.13 (Benchmark, RAM footprint)\n"
        "--- System: 364 bytes\n--- Thread: 72 bytes\n--- Result: FAILURE (#1)\n"
    )
    expected = {"context switch": ("SUCCESS", 380288), "RAM footprint": ("FAILURE", None)}
    assert results(report) == expected
    published = PUBLISHED["ChibiOS 2.4.0 ARM"]
    scores = dict(zip(CASES, (1.1 * score for score in published), strict=True))
    found = deviations("ChibiOS 2.4.0 ARM", scores)
    assert found == pytest.approx(dict.fromkeys(CASES, 0.1))
