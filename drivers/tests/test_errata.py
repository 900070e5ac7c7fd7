# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Drivers on a chip with the faults of its silicon, each alone."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from verification.support.bricks.observe import Brick

ERRATA = (
    "twi_nack_lost",
    "twi_locked_by_low_line",
    "twi_disable_freezes",
    "twi_received_byte_overwritten",
    "spi_reset_needs_two",
    "adc_channel_read_clears_drdy",
)
FAULT_MS = 300
NOBODY = (0, b"", 0)
BEFORE_FAILURE_MS = 399
WILLING = (99, b"", 0)
LAST_DRIVEN = "S 02a 00a 08a 00a 3Ca C4a 00a 07a 00a F0a P"
STOPPED = "S 02a 00a 08a 00a 00a 00a 00a 07a 00a F0a P"


def only(erratum: str) -> dict[str, bool]:
    """A chip with one fault."""
    return {name: name == erratum for name in ERRATA}


@pytest.mark.parametrize("erratum", [name for name in ERRATA if name.startswith("twi")])
def test_the_link_runs_and_recovers_from_a_held_clock(
    brick: Callable[..., Brick], erratum: str
) -> None:
    """The co-processor holds the clock low for 200 ms, across several resets of the interface."""
    device = brick("link", sensors={"2": {"kind": "touch"}}, errata=only(erratum))
    device.set(FAULT_MS, "fault.twi_stuck", 1)
    device.set(FAULT_MS + 200, "fault.twi_stuck", 0)
    device.run(FAULT_MS - 10)
    assert (device.integer("errors"), device.integer("losses")) == (0, 0)
    device.run(FAULT_MS + 190)
    losses = device.integer("losses")
    assert losses > 1
    device.run(FAULT_MS + 700)
    assert device.integer("losses") <= losses + 2


def test_the_display_is_set_up_although_a_reset_needs_two_writes(
    brick: Callable[..., Brick],
) -> None:
    """The same picture with and without the fault."""
    pictures = []
    for errata in (only("spi_reset_needs_two"), only("")):
        device = brick("display_text", errata=errata)
        device.run(FAULT_MS)
        pictures.append(device.device.lcd())
    assert pictures[0] == pictures[1]
    assert any(pictures[0])


def test_the_converter_needs_no_flag_that_the_silicon_loses(brick: Callable[..., Brick]) -> None:
    """The colour sensor's light and dark readings are the same."""
    readings = []
    for errata in (only("adc_channel_read_clears_drdy"), only("")):
        device = brick("color", sensors={"2": {"kind": "color"}}, errata=errata)
        device.set(10, "color.2", 0.5)
        device.run(2 * FAULT_MS)
        readings.append(device.integers("parts"))
    assert readings[0] == readings[1]
    assert any(readings[0])


def test_a_failed_program_stops_the_motors_although_a_refusal_is_lost(
    brick: Callable[..., Brick],
) -> None:
    """The polled frame after a failure is refused twice at the address and sent a third time."""
    device = brick("last_chance", errata=only("twi_nack_lost"))
    device.run(BEFORE_FAILURE_MS)
    device.device.record_buses()
    device.device.script_twi([WILLING, NOBODY, NOBODY, WILLING])
    device.run_to_end(2 * FAULT_MS)
    events = [event.partition(" ") for _, event in device.device.bus_log()]
    bus = " ".join(words for name, _, words in events if name == "twi")
    assert bus.endswith(f"{LAST_DRIVEN} S 02n P S 02n P {STOPPED}"), bus
