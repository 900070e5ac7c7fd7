# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""ChibiOS/RT's own test suite beside the scores that its authors measured on an AT91SAM7X256.

The images are built from the tags of its repository for the AT91SAM7S256, which has the same core,
memories and clock. Their compiler is newer than the authors': GCC 12 in place of 4.5 and 4.6.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import partial

from ravenbrick.brick.firmware import FirmwareBrick

from verification.firmware.witnesses.library import check, images

__all__ = ["CASES", "PUBLISHED", "deviations", "far", "measured", "results"]

# Operations per second of the cases 11.1 to 11.12, at 48.055 MHz from flash with one wait state:
# docs/reports/AT91SAM7X-48-{ARM,THUMB}.txt of the tags ver_2.2.0 and ver_2.4.0.
CASES = (
    "messages #1", "messages #2", "messages #3", "context switch", "threads, full cycle",
    "threads, create only", "mass reschedule, 5 threads", "round robin context switching",
    "I/O Queues throughput", "virtual timers set/reset", "semaphores wait/signal",
    "mutexes lock/unlock",
)  # fmt: skip
PUBLISHED = {
    "ChibiOS 2.2.0 ARM": (
        114671, 89883, 89883, 380272, 65956, 95636, 27232, 211348, 239264, 264214, 449036, 322036,
    ),
    "ChibiOS 2.2.0 Thumb": (
        106526, 87601, 87601, 405776, 68821, 104432, 28624, 212112, 258636, 323178, 364428, 256808,
    ),
    "ChibiOS 2.4.0 ARM": (
        116919, 89887, 89887, 380288, 64709, 93398, 26941, 203272, 272700, 263496, 449056, 322048,
    ),
    "ChibiOS 2.4.0 Thumb": (
        107489, 88253, 88253, 402392, 67753, 101772, 28388, 199720, 289356, 323198, 364448, 256824,
    ),
}  # fmt: skip
LIMIT = 0.12
# In ARM code GCC 12 saves registers only where chSemWait sleeps (shrink-wrapping, since GCC 4.7).
OTHER_CODE = frozenset({"semaphores wait/signal"})
SUITE_S = 60
LAST_LINE = "Final result"
REPORT = re.compile(
    r"Test Case [\d.]+ \((?P<case>[^)]*)\)\n"
    r"(?P<lines>(?:--- (?!Result)[^\n]*\n)*)--- Result: (?P<result>\w+)"
)
SCORE = re.compile(r"--- Score : (\d+)")


def serial_output(brick: FirmwareBrick) -> str:
    """What the suite sends on the chip's first serial line until it ends."""
    brick.device.record_buses()
    text = bytearray()
    while LAST_LINE.encode() not in text:
        assert brick.seconds < SUITE_S, "the suite does not end"
        brick.run(1.0)
        for _, event in brick.device.bus_log():
            if event.startswith("usart0 out "):
                text.append(int(event[-2:], 16))
    return text.decode("ascii").replace("\r", "")


def results(report: str) -> dict[str, tuple[str, int | None]]:
    """Result of each case, and its score if it has one."""
    found = {}
    for case in REPORT.finditer(report):
        score = SCORE.search(case["lines"])
        name = case["case"].removeprefix("Benchmark, ")
        found[name] = (case["result"], int(score[1]) if score else None)
    return found


def measured(brick: FirmwareBrick) -> dict[str, int]:
    """The scores of a run in which all cases succeed."""
    found = results(serial_output(brick))
    assert len(found) > len(CASES), "the suite has not begun"
    failed = [case for case, (result, _) in found.items() if result != "SUCCESS"]
    assert not failed, f"fails: {', '.join(failed)}"
    return {case: score for case in CASES if (score := found[case][1]) is not None}


def deviations(name: str, scores: Mapping[str, float]) -> dict[str, float]:
    """By how much each score differs from the published one, as a share of that."""
    return {
        case: scores[case] / published - 1.0
        for case, published in zip(CASES, PUBLISHED[name], strict=True)
    }


def far(name: str, shares: Mapping[str, float]) -> dict[str, str]:
    """The deviations that neither the limit nor the newer compiler explains, in words."""
    explained = OTHER_CODE if name.endswith("ARM") else frozenset()
    return {
        case: f"{case} {share:+.1%}"
        for case, share in shares.items()
        if abs(share) > LIMIT and case not in explained
    }


def scores_as_published(name: str) -> str:
    """All cases succeed, and the scores are near those from silicon."""
    shares = deviations(name, measured(images()[name].brick()))
    assert not far(name, shares), "; ".join(far(name, shares).values())
    near = [share for share in shares.values() if abs(share) <= LIMIT]
    seen = f"{len(near)} of {len(shares)} scores within {min(near):+.1%} and {max(near):+.1%}"
    others = (f"{case} {share:+.1%}" for case, share in shares.items() if abs(share) > LIMIT)
    return "; ".join([seen, *others])


for _name in PUBLISHED:
    check(_name, "scores")(partial(scores_as_published, _name))
