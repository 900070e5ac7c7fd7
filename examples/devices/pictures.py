# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Runs each example on a virtual brick and makes its picture and the list of examples.

`python -m examples.devices.pictures` writes docs/pictures/devices/ and docs/guides/devices.md.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import virtual_brick

from tools.docs.pictures.lcd import lcd_svg
from verification.support.bricks.observe import Brick, bench
from verification.support.bricks.programs import gprbuild

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
BUILD = Path(os.environ.get("RAVENBRICK_BUILD", ROOT / "build"))
PICTURES = ROOT / "docs" / "pictures" / "devices"
GUIDE = ROOT / "docs" / "guides" / "devices.md"


@dataclass(frozen=True)
class Example:
    """A program, the packages that it shows, its surroundings and when its picture is taken."""

    device: str
    packages: str
    seen: str
    at_ms: float
    sensors: dict[str, str] = field(default_factory=dict)
    inputs: tuple[tuple[float, str, float], ...] = ()
    outside: Callable[[Brick], None] | None = None


def bluetooth_peer(brick: Brick) -> None:
    """A computer connects and sends two messages."""
    device, computer = brick.device, "00:1A:7D:00:00:01"
    device.bluetooth_send(0, computer, "in_range", name="computer")
    device.bluetooth_send(brick.cycles(900), computer, "page", name="computer", pin="1234")
    for at_ms in (1_500, 1_700):
        device.bluetooth_send(brick.cycles(at_ms), computer, "data", b"Hello, brick!")


def usb_host(brick: Brick) -> None:
    """A host finds the brick and sends it three packets."""
    brick.set(0, "usb.plugged", 1)
    packets = [(400 + 50 * n, "out", 1, bytes(8)) for n in range(3)]
    steps = [
        (250, "reset", 0, b""),
        (300, "control", 0, bytes([0, 5, 5, 0, 0, 0, 0, 0])),
        (350, "control", 0, bytes([0, 9, 1, 0, 0, 0, 0, 0])),
        *packets,
    ]
    for number, (at_ms, kind, endpoint, data) in enumerate(steps):
        limit = brick.cycles(1_000)
        brick.device.usb_transfer(brick.cycles(at_ms), number, limit, kind, endpoint, data, 0)


EXAMPLES = {
    "text_display": Example(
        "display", "`NXT.Display`, `NXT.Display.Drawing`", "text and drawings", 150
    ),
    "buttons": Example(
        "buttons", "`NXT.Buttons`", "the left one held", 500, inputs=((300, "button.left", 1),)
    ),
    "motors": Example(
        "motors", "`NXT.Motor_Controls`, `NXT.Motor_Encoders`", "degrees after each move", 2_800
    ),
    "regulated_motors": Example(
        "regulated motors", "`NXT.Regulated_Motors`", "a speed, then an angle", 3_500
    ),
    "touch": Example(
        "touch sensor",
        "`NXT.Touch_Sensors`",
        "pressed three times",
        1_000,
        {"1": "touch"},
        tuple((300 + 50 * n, "touch.1", 1 - n % 2) for n in range(6)),
    ),
    "light": Example(
        "light sensor",
        "`NXT.Light_Sensors`",
        "bright ground",
        600,
        {"3": "light"},
        ((10, "light.3.reflectance", 0.7),),
    ),
    "sound_level": Example(
        "sound sensor",
        "`NXT.Sound_Sensors`",
        "85 dB of 1 kHz",
        900,
        {"2": "sound"},
        ((10, "sound.2", 85.0), (10, "sound.2.frequency", 1_000.0)),
    ),
    "ultrasonic": Example(
        "ultrasonic sensor",
        "`NXT.Ultrasonic_Sensors`",
        "a wall at 42 cm",
        1_000,
        {"4": "ultrasonic"},
        ((10, "distance.4", 0.425),),
    ),
    "color_of_things": Example(
        "colour sensor",
        "`NXT.Color_Sensors`",
        "a yellow thing",
        500,
        {"3": "color"},
        ((10, "color.3.red", 0.9), (10, "color.3.green", 0.7), (10, "color.3.blue", 0.2)),
    ),
    "who_is_there": Example(
        "any I2C sensor", "`NXT.I2C_Sensors`", "an ultrasonic sensor", 600, {"4": "ultrasonic"}
    ),
    "loudspeaker": Example("sound", "`NXT.Audio`", "the notes played", 900),
    "battery_level": Example(
        "battery and power", "`NXT.Battery`, `NXT.Power`", "a pack of 8 V", 400
    ),
    "storage": Example("flash storage", "`NXT.Parameters`", "the first start", 200),
    "name_of_brick": Example(
        "name, watchdog, reset",
        "`NXT.Brick_Name`, `NXT.Watchdog`, `NXT.Power`",
        "a brick that was switched on",
        200,
    ),
    "serial_line": Example("RS485", "`NXT.RS485`", "a text that came back", 150),
    "bluetooth_echo": Example(
        "Bluetooth",
        "`NXT.Bluetooth`",
        "a computer sends two messages",
        2_000,
        outside=bluetooth_peer,
    ),
    "usb_packets": Example("USB", "`NXT.USB`", "a host sends three packets", 800, outside=usb_host),
}


def image_file(name: str) -> Path:
    """Where the example's image for RAM is."""
    return BUILD / "devices" / name / "ram" / f"{name}.elf"


@cache
def build(name: str) -> bytes:
    """The example's image for RAM."""
    gprbuild(HERE / "device.gpr", DEVICE=name)
    return image_file(name).read_bytes()


def surroundings(example: Example) -> dict[str, Any]:
    """The configuration of the brick that an example runs on."""
    sensors = {port: {"kind": kind} for port, kind in example.sensors.items()}
    return bench() | {"sensors": sensors}


def run(name: str) -> Brick:
    """The example at the time of its picture."""
    example = EXAMPLES[name]
    configuration = json.dumps(surroundings(example))
    brick = Brick(virtual_brick.VirtualBrick(configuration, build(name)))
    for at_ms, quantity, value in example.inputs:
        brick.set(at_ms, quantity, value)
    if example.outside:
        example.outside(brick)
    brick.run(example.at_ms)
    return brick


def picture(brick: Brick) -> str:
    """The display as a drawing."""
    return lcd_svg(brick.picture())


def guide() -> str:
    """The list of examples."""
    lines = [
        "# One program for each device",
        "",
        "Generated by `python -m examples.devices.pictures`; do not edit. Each program has its",
        "own folder in [examples/devices](../../examples/devices). This command builds one of",
        "them:",
        "",
        "```",
        "gprbuild --config=tools/ravenbrick.cgpr -P examples/devices/device.gpr -XDEVICE=touch",
        "```",
        "",
        "The pictures are displays of the virtual brick, and a test compares them.",
        "",
        "| Device | Program | Packages | Display |",
        "|---|---|---|---|",
    ]
    for name, example in EXAMPLES.items():
        source = f"[{name}](../../examples/devices/{name}/{name}.adb)"
        image = f"![{example.seen}](../pictures/devices/{name}.svg)"
        lines.append(
            f"| {example.device} | {source} | {example.packages} | {image}<br>{example.seen} |"
        )
    lines += [
        "",
        "## Run them here",
        "",
        "Each brick repeats the inputs of its picture; after that, its sensors, buttons and",
        "motors are yours. The programs for Bluetooth and USB wait for a computer at the other",
        "end, which a page does not have: [Bluetooth and USB](bluetooth-and-usb.md) shows how",
        "they meet one.",
    ]
    for name, example in EXAMPLES.items():
        if example.outside is None:
            device = example.device[:1].upper() + example.device[1:]
            caption = f"{device}: {example.seen}."
            lines += ["", f"```{{brick}} devices/{name} picture", ":folded:", caption, "```"]
    return "\n".join([*lines, ""])


def main() -> None:
    """Write pictures and guide."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    for name in EXAMPLES:
        (PICTURES / f"{name}.svg").write_text(picture(run(name)), encoding="utf-8")
    GUIDE.write_text(guide(), encoding="utf-8")


if __name__ == "__main__":
    main()
