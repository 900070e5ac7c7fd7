# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The table of devices: which package drives one, which tests show it, what an operation costs.

`python -m verification.benchmarks.driver_table` writes docs/reference/drivers.md from the list
here and from
docs/reference/driver-costs.json.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

from ravenbrick.clock import MASTER_CLOCK

from verification.support.paths import ROOT

COSTS = ROOT / "docs" / "reference" / "driver-costs.json"
PAGE = ROOT / "docs" / "reference" / "drivers.md"
CYCLES_PER_US = float(MASTER_CLOCK.hertz) / 1e6
SUSPENDED_FROM_CYCLES = 20_000


@dataclass(frozen=True)
class Device:
    """A device; `operations` begin with a name of the cost table, `task` is one of its tasks."""

    name: str
    packages: tuple[str, ...]
    tests: tuple[str, ...]
    operations: tuple[str, ...] = ()
    task: str = ""


DEVICES = (
    Device(
        "co-processor link",
        ("NXT.AVR", "NXT.AVR_IO", "NXT.TWI"),
        ("link", "messages", "scripted"),
        ("AVR.",),
        "coprocessor_task",
    ),
    Device(
        "motors",
        ("NXT.Motor_Controls", "NXT.Motors"),
        ("motors",),
        ("Motor_Controls.",),
    ),
    Device(
        "encoders",
        ("NXT.Motor_Encoders",),
        ("motors", "encoder_stress"),
        ("Motor_Encoders.",),
    ),
    Device(
        "regulated motors",
        ("NXT.Regulated_Motors",),
        ("regulated_motors",),
        ("Regulated_Motors.",),
        "regulator_task",
    ),
    Device(
        "display",
        ("NXT.Display", "NXT.Graph", "NXT.LCD", "NXT.SPI"),
        ("display", "scripted"),
        ("Display.",),
    ),
    Device("buttons", ("NXT.Buttons",), ("inputs",), ("Buttons.",)),
    Device(
        "battery",
        ("NXT.Battery", "NXT.Low_Battery"),
        ("inputs", "low_battery"),
        ("Battery.",),
    ),
    Device(
        "power, boot monitor",
        ("NXT.Power", "NXT.Forced_Power_Off"),
        ("power", "power_button", "end", "brown_out"),
        ("Power.",),
    ),
    Device("watchdog", ("NXT.Watchdog",), ("power",), ("Watchdog.",)),
    Device("loudspeaker", ("NXT.Audio",), ("audio",), ("Audio.",)),
    Device("touch sensor", ("NXT.Touch_Sensors",), ("inputs",), ("Touch_Sensors.",)),
    Device("light sensor", ("NXT.Light_Sensors",), ("sensors",), ("Light_Sensors.",)),
    Device("sound sensor", ("NXT.Sound_Sensors",), ("sensors",), ("Sound_Sensors.",)),
    Device(
        "ultrasonic sensor",
        ("NXT.Ultrasonic_Sensors",),
        ("ultrasonic",),
        ("Ultrasonic_Sensors.",),
    ),
    Device("any I2C sensor", ("NXT.I2C_Sensors", "NXT.I2C_Ports"), ("bus_log", "ultrasonic")),
    Device(
        "colour sensor",
        ("NXT.Color_Sensors",),
        ("color", "color_as_lego", "scripted"),
        ("Color_Sensors.",),
    ),
    Device("sensor ports", ("NXT.Sensor_Ports",), ("color", "inputs"), ("Sensor_Ports.",)),
    Device("RS485", ("NXT.RS485",), ("rs485", "scripted"), ("RS485.",)),
    Device(
        "Bluetooth",
        ("NXT.Bluetooth", "NXT.Bluetooth_Line", "NXT.Bluetooth_Messages"),
        ("bluetooth", "scripted"),
        ("Bluetooth.",),
    ),
    Device("USB", ("NXT.USB",), ("nxt_python", "bluetooth"), ("USB.",)),
    Device(
        "direct commands",
        ("NXT.Direct_Commands",),
        ("nxt_python",),
        ("Direct_Commands.",),
    ),
    Device(
        "telemetry",
        ("NXT.Telemetry", "NXT.Frames"),
        ("telemetry", "frames"),
        ("Telemetry.",),
        "server_task",
    ),
    Device(
        "flash storage",
        ("NXT.Parameters",),
        ("parameters", "brown_out", "scripted"),
        ("Parameters.",),
    ),
    Device("brick name", ("NXT.Brick_Name",), ("power",), ("Brick_Name.",)),
    Device("unhandled exceptions", ("NXT.Last_Chance",), ("end",)),
)


def _belongs(operation: str, device: Device) -> bool:
    return operation.startswith(device.operations)


def _short(row: dict[str, Any]) -> str:
    return str(row["name"]).split(".", 1)[1]


def _costs(device: Device, known: dict[str, Any]) -> tuple[str, str]:
    """Cycles of each operation; what blocks: suspension of the caller, and masking."""
    rows = [row for row in known["operations"] if _belongs(row["name"], device)]
    cycles = [f"{_short(row)}: {row['task_cycles']}" for row in rows]
    cycles += [
        f"task each {row['period_ms']:g} ms: {row['longest_cycles']}"
        for row in known["tasks"]
        if row["name"] == device.task
    ]
    masked = max((row["masked_cycles"] for row in rows), default=0)
    blocking = [f"masks {masked}"] if masked else []
    blocking += [
        f"{_short(row)} suspends {row['returns_after_cycles'] / CYCLES_PER_US:.0f} us"
        for row in rows
        if row["returns_after_cycles"] - row["task_cycles"] > SUSPENDED_FROM_CYCLES
    ]
    return "<br>".join(cycles) or "-", "<br>".join(blocking) or "none"


def page(known: dict[str, Any]) -> str:
    """The page."""
    lines = [
        "# Devices and their drivers",
        "",
        "Generated by `python -m verification.benchmarks.driver_table` from",
        "[driver-costs.json](driver-costs.json); do not edit. Cycles are processor time of the",
        "calling task at 48.05 MHz; [Costs of driver operations](driver-costs.md) describes the",
        "measurement and has the interrupts. *Masks* is the longest time in cycles for which",
        "interrupts of some priority are delayed. *Suspends* means that the caller waits while",
        "other tasks run.",
        "",
        "| Device | Package | Tests in `drivers/tests` | Cycles per operation | Blocking |",
        "|---|---|---|---|---|",
    ]
    for device in DEVICES:
        packages = ", ".join(f"`{name}`" for name in device.packages)
        tests = ", ".join(f"`test_{name}`" for name in device.tests)
        cycles, blocking = _costs(device, known)
        lines.append(f"| {device.name} | {packages} | {tests} | {cycles} | {blocking} |")
    return "\n".join([*lines, ""])


def main() -> None:
    """Write the page."""
    known = json.loads(COSTS.read_text(encoding="utf-8"))
    PAGE.write_text(page(known), encoding="utf-8")


if __name__ == "__main__":
    main()
