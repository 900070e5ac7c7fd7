# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Functions of LEGO's firmware and of the enhanced NBC/NXC firmware, with LEGO's own programs."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from typing import Any

import nxt.brick
from ravenbrick.brick.firmware import FirmwareBrick

from verification.firmware.witnesses.library import check, images
from verification.firmware.witnesses.link import count_frames
from verification.support.bricks.nxt_firmware import compile_nxc

NAMES = ("LEGO 1.29.2", "LEGO 1.29.8", "NBC/NXC 1.28", "NBC/NXC 1.32")
SENSORS = {
    "1": {"kind": "touch"},
    "2": {"kind": "sound"},
    "3": {"kind": "light"},
    "4": {"kind": "ultrasonic"},
}
PROGRAM = """
task main()
{
  SetSensorTouch(IN_1);
  TextOut(0, LCD_LINE1, "wait");
  until (Sensor(IN_1) == 1);
  PlayTone(880, 300);
  RotateMotor(OUT_A, 60, 360);
  TextOut(0, LCD_LINE3, "turned");
  while (true);
}
"""


@cache
def _menu(name: str) -> Any:
    brick = images()[name].brick(sensors=SENSORS)
    brick.expect_text("My Files", within=10)
    return brick.device.snapshot()


def at_the_menu(name: str) -> FirmwareBrick:
    """A brick whose firmware shows its menu."""
    brick = images()[name].brick(sensors=SENSORS)
    brick.device.restore(_menu(name))
    return brick


def _upload(remote: nxt.brick.Brick, name: str, content: bytes) -> None:
    with remote.open_file(name, "wb", len(content)) as file:
        file.write(content)


def _start(brick: FirmwareBrick, program: str) -> None:
    remote = nxt.brick.Brick(brick.usb_telegrams())
    resources = ("faceopen.ric", "faceclosed.ric", "! Attention.rso", "Woops.rso")
    for name in (*resources, program):
        _upload(remote, name, images()[name].content)
    remote.start_program(program)


def _nxc(brick: FirmwareBrick) -> None:
    """Upload and start the program, and press the touch sensor."""
    remote = nxt.brick.Brick(brick.usb_telegrams())
    _upload(remote, "proof.rxe", compile_nxc(PROGRAM))
    remote.start_program("proof.rxe")
    brick.expect_text("wait")
    assert brick.encoder("A") == 0, "the motor turns before the sensor is pressed"
    brick.set("touch.1", 1)
    brick.run(0.3)


def shows_its_menu(name: str) -> str:
    """The menu, then the entry right of it."""
    brick = at_the_menu(name)
    brick.press("right")
    brick.expect_text("NXT Program")
    return "menu moves to NXT Program"


def speaks(name: str, way: str) -> str:
    """nxt-python reads name and version, and drives a motor."""
    brick = at_the_menu(name)
    telegrams = brick.usb_telegrams() if way == "USB" else brick.bluetooth_telegrams()
    remote = nxt.brick.Brick(telegrams)
    assert remote.get_device_info()[0] == "Rover"
    version = ".".join(str(part) for part in remote.get_firmware_version()[1])
    motor = remote.get_motor(nxt.motor.Port.A)
    motor.run(60)
    brick.run(1.0)
    motor.brake()
    brick.run(1.5)
    tacho = motor.get_tacho().tacho_count
    assert tacho == brick.encoder("A") > 300, tacho
    return f"nxt-python: version {version}, tacho {tacho}"


def keeps_files(name: str) -> str:
    """A file is written, found and read back."""
    brick = at_the_menu(name)
    remote = nxt.brick.Brick(brick.usb_telegrams())
    content = compile_nxc(PROGRAM)
    _upload(remote, "proof.rxe", content)
    assert ("proof.rxe", len(content)) in list(remote.find_files("*.rxe"))
    with remote.open_file("proof.rxe", "rb") as file:
        assert file.read() == content
    return f"{len(content)} bytes read back"


def turns_a_motor(name: str) -> str:
    """RotateMotor of an NXC program."""
    brick = at_the_menu(name)
    _nxc(brick)
    brick.expect_text("turned")
    assert 355 <= brick.encoder("A") < 450, brick.encoder("A")
    return f"NXC: 360 degrees asked for, {brick.encoder('A')} turned"


def senses(name: str) -> str:
    """An NXC program waits for the touch sensor."""
    brick = at_the_menu(name)
    _nxc(brick)
    brick.run(0.5)
    assert brick.encoder("A") > 0
    return "NXC: goes on when the touch sensor is pressed"


def sounds(name: str) -> str:
    """PlayTone of an NXC program."""
    brick = at_the_menu(name)
    began = brick.seconds
    _nxc(brick)
    brick.run(1.0)
    seconds, hertz = brick.tone(began)
    assert abs(seconds - 0.3) < 0.01 and abs(hertz - 880) < 18, (seconds, hertz)
    return f"NXC: 880 Hz for 0.3 s asked for, {hertz:.0f} Hz for {seconds:.2f} s heard"


def link_is_clean(name: str) -> str:
    """Every frame to the co-processor is good while a program turns a motor."""
    brick = at_the_menu(name)
    _nxc(brick)
    counted = count_frames(brick, 1.5)
    assert counted.bad <= 1 and counted.good > 500 and counted.greetings == 0, str(counted)
    return str(counted)


def switches_off(name: str) -> str:
    """The grey button at the menu asks; the orange one says yes."""
    brick = at_the_menu(name)
    brick.press("grey")
    brick.run(1.0)
    with brick.switched_off():
        brick.press("orange")
        brick.run(4.0)
    return f"off at {brick.seconds:.1f} s"


def _demo(program: str) -> Callable[[], str]:
    def run() -> str:
        brick = at_the_menu("LEGO 1.29.2")
        began = brick.seconds
        _start(brick, program)
        brick.run(6.0)
        turned = [brick.encoder(port) for port in "BC"]
        heard, _ = brick.tone(began)
        assert min(turned) > 500 and heard > 0.2, (turned, heard)
        return f"{program}: B and C turn {turned[0]} and {turned[1]} degrees, {heard:.1f} s sound"

    return run


def _try_program(program: str, text: str) -> Callable[[], str]:
    def run() -> str:
        brick = at_the_menu("LEGO 1.29.2")
        _start(brick, program)
        brick.expect_text(text)
        return f"{program}: {text}"

    return run


def _try_touch() -> str:
    brick = at_the_menu("LEGO 1.29.2")
    _start(brick, "Try-Touch.rtm")
    brick.expect_text("1 - Touch Sensor")
    brick.run(3.0)
    began = brick.seconds
    brick.run(1.0)
    assert brick.tone(began)[0] == 0, "a sound before the sensor is pressed"
    brick.set("touch.1", 1)
    brick.run(1.0)
    heard, _ = brick.tone(began)
    assert heard > 0.3, "no sound when the sensor is pressed"
    return f"Try-Touch.rtm: {heard:.1f} s of sound when the sensor is pressed"


def _try_color() -> str:
    brick = images()["LEGO 1.29.2"].brick(sensors={"3": {"kind": "color"}})
    brick.expect_text("My Files", within=10)
    _start(brick, "Try-Color.rtm")
    brick.expect_text("3 - Color sensor")
    turned = []
    for seen in ("green", "red"):
        for part in ("red", "green", "blue"):
            brick.set(f"color.3.{part}", 0.9 if part == seen else 0.05)
        brick.run(1.0)
        before = brick.encoder("B"), brick.encoder("C")
        brick.run(1.0)
        turned.append([brick.encoder("B") - before[0], brick.encoder("C") - before[1]])
    assert min(turned[0]) > 300 and turned[1] == [0, 0], turned
    return f"Try-Color.rtm: B and C turn {turned[0][0]} degrees in 1 s at green, none at red"


for _name in NAMES:
    for _function, _run in {
        "LCD": shows_its_menu,
        "buttons": shows_its_menu,
        "files": keeps_files,
        "motor": turns_a_motor,
        "sensor": senses,
        "sound": sounds,
        "link": link_is_clean,
        "switches off": switches_off,
    }.items():
        check(_name, _function)(partial(_run, _name))
    for _way in ("USB", "Bluetooth"):
        check(_name, _way)(partial(speaks, _name, _way))
for _program in ("DemoV2.rxe", "Demo.rxe"):
    check(f"LEGO's {_program}", "motor")(_demo(_program))
check("LEGO's Try-Touch.rtm", "sensor")(_try_touch)
check("LEGO's Try-Motor.rtm", "LCD")(_try_program("Try-Motor.rtm", "A - Motor"))
check("LEGO's Try-Sound.rtm", "LCD")(_try_program("Try-Sound.rtm", "2 - Sound sensor"))
check("LEGO's Try-Light.rtm", "LCD")(_try_program("Try-Light.rtm", "3 - Light sensor"))
check("LEGO's Try-Ultrasonic.rtm", "LCD")(_try_program("Try-Ultrasonic.rtm", "4 - Ultrasonic"))
check("LEGO's Try-Color.rtm", "motor")(_try_color)
