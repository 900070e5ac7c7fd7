# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Functions of leJOS, nxtOSEK, NxOS, Pybricks, pbLua and of programs built with GNAT GPL."""

from __future__ import annotations

import struct
from functools import partial
from typing import Any

import nxt.brick
from ravenbrick.brick.firmware import FirmwareBrick

from verification.firmware.images import FLASH, lejos_flash
from verification.firmware.witnesses.library import check, images, switched_on
from verification.firmware.witnesses.link import commands, count_frames
from verification.firmware.witnesses.pybricks import PybricksHub, compiled


def lejos_brick() -> FirmwareBrick:
    """As its own tool flashes it."""
    machine, menu = (images()[f"leJOS NXJ, {part}"] for part in ("virtual machine", "menu"))
    return switched_on(lejos_flash(machine.content, menu.content), FLASH)


def lejos_runs(brick: FirmwareBrick) -> None:
    """Upload the Java program over USB and start it."""
    brick.expect_text("Run Default", within=8)
    content = images()["leJOS NXJ, Proof.nxj"].content
    telegrams = brick.usb_telegrams()
    brick.run(0.5)
    name = b"Proof.nxj".ljust(20, b"\0")

    def ask(telegram: bytes) -> bytes:
        telegrams.send(telegram)
        reply = b""
        while not reply:  # leJOS ends its answer with an empty packet
            reply = telegrams.recv()
        assert reply[:3] == bytes([2, telegram[1], 0]), reply.hex()
        return reply

    handle = ask(b"\x01\x81" + name + struct.pack("<I", len(content)))[3]
    for at in range(0, len(content), 60):
        ask(bytes([1, 0x83, handle]) + content[at : at + 60])
    ask(bytes([1, 0x84, handle]))
    telegrams.send(b"\x80\x00" + name)


@check("leJOS NXJ", "motor")
def lejos_turns_a_motor() -> str:
    """Motor.A.rotate(360) of a Java program, and its print."""
    brick = lejos_brick()
    lejos_runs(brick)
    brick.expect_text("angle 36", within=8)
    assert 355 <= brick.encoder("A") <= 365, brick.encoder("A")
    return f"Java: 360 degrees asked for, {brick.encoder('A')} turned"


@check("leJOS NXJ", "LCD")
def lejos_prints() -> str:
    """LCD.drawString of a Java program."""
    brick = lejos_brick()
    lejos_runs(brick)
    brick.expect_text("Java begins", within=8)
    return "Java prints"


@check("leJOS NXJ", "sensor")
def lejos_senses_and_sounds() -> str:
    """The Java program waits for the touch sensor, then plays a tone."""
    brick = lejos_brick()
    lejos_runs(brick)
    brick.expect_text("angle 36", within=8)
    brick.run(0.5)
    assert not any("pressed" in line for line in brick.lines)
    brick.set("touch.1", 1)
    brick.expect_text("done", within=4)
    return "Java: goes on when the touch sensor is pressed"


@check("leJOS NXJ", "sound")
def lejos_sounds() -> str:
    """Sound.playTone(880, 300) of the Java program."""
    brick = lejos_brick()
    lejos_runs(brick)
    brick.expect_text("angle 36", within=8)
    brick.run(0.5)
    began = brick.seconds
    brick.set("touch.1", 1)
    brick.expect_text("done", within=4)
    seconds, hertz = brick.tone(began)
    assert abs(seconds - 0.3) < 0.02 and abs(hertz - 880) < 18, (seconds, hertz)
    return f"Java: 880 Hz for 0.3 s asked for, {hertz:.0f} Hz for {seconds:.2f} s heard"


@check("leJOS NXJ", "files")
def lejos_keeps_files() -> str:
    """A file written over USB is read again when it is started."""
    brick = lejos_brick()
    lejos_runs(brick)
    brick.expect_text("Java begins", within=8)
    return "Proof.nxj written over USB and started"


@check("leJOS NXJ", "USB")
def lejos_speaks_usb() -> str:
    """nxt-python over USB at the menu."""
    brick = lejos_brick()
    brick.expect_text("Run Default", within=8)
    info = nxt.brick.Brick(brick.usb_telegrams()).get_device_info()
    assert info[0] == "Rover"
    return f"nxt-python: name {info[0]}"


@check("leJOS NXJ", "Bluetooth")
def lejos_speaks_bluetooth() -> str:
    """nxt-python over Bluetooth at the menu, with the PIN that leJOS asks for."""
    brick = lejos_brick()
    brick.expect_text("Run Default", within=8)
    brick.run(2.0)
    info = nxt.brick.Brick(brick.bluetooth_telegrams()).get_device_info()
    assert info[0] == "Rover"
    return f"nxt-python: name {info[0]}"


@check("leJOS NXJ", "link")
def lejos_link() -> str:
    """Every frame to the co-processor is good at the menu."""
    brick = lejos_brick()
    brick.run(2.0)
    counted = count_frames(brick, 1.5)
    assert counted.bad == 0 and counted.good > 500, str(counted)
    return str(counted)


@check("nxtOSEK Hello World", "LCD")
def osek_says_hello() -> str:
    """The right arrow runs the program."""
    brick = images()["nxtOSEK Hello World"].brick()
    brick.expect_text("ENTR", within=5)
    brick.press("right")
    brick.expect_text("Hello World")
    return "Hello World"


@check("nxtOSEK Hello World", "buttons")
def osek_stops() -> str:
    """The left arrow stops the program."""
    brick = images()["nxtOSEK Hello World"].brick()
    brick.expect_text("ENTR", within=5)
    brick.press("right")
    brick.expect_text("Hello World")
    brick.press("left")
    brick.run(1.0)
    assert not any("Hello" in line for line in brick.lines)
    return "the left arrow ends the program"


@check("nxtOSEK Hello World", "switches off")
def osek_switches_off() -> str:
    """The grey button, before the program runs."""
    brick = images()["nxtOSEK Hello World"].brick()
    brick.expect_text("ENTR", within=5)
    with brick.switched_off():
        brick.press("grey", 0.5)
        brick.run(3.0)
    return f"off at {brick.seconds:.1f} s"


@check("nxtOSEK Hello World", "link")
def osek_link() -> str:
    """Every frame to the co-processor is good."""
    brick = images()["nxtOSEK Hello World"].brick()
    brick.run(1.5)
    counted = count_frames(brick, 1.5)
    assert counted.bad <= 1 and counted.good > 500, str(counted)
    return str(counted)


@check("ET Robocon line tracer (nxtOSEK)", "Bluetooth")
def robocon_address() -> str:
    """The program asks the Bluetooth module for its address and shows it."""
    brick = images()["ET Robocon line tracer"].brick()
    brick.expect_text("0016530A0B0C", within=10)
    return "shows the module's address"


@check("ET Robocon line tracer (nxtOSEK)", "switches off")
def robocon_switches_off() -> str:
    """The grey button at the main screen."""
    brick = images()["ET Robocon line tracer"].brick()
    brick.run(7.0)
    with brick.switched_off():
        brick.press("grey", 0.5)
        brick.run(3.0)
    return f"off at {brick.seconds:.1f} s"


@check("ET Robocon balancer (nxtOSEK)", "sensor")
def robocon_calibrates() -> str:
    """A press of the touch sensor stores the light over white, then over black."""
    return f"shows {' and '.join(robocon_calibrated()[1])}"


@check("ET Robocon balancer (nxtOSEK)", "motor")
def robocon_turns_its_tail() -> str:
    """After the calibration the program moves the motor on port A, the robot's tail."""
    brick, _ = robocon_calibrated()
    brick.run(1.0)
    assert brick.duty("A") == 0.0
    for _ in range(3):
        press_touch(brick)
    brick.run(1.0)
    assert 0.14 < brick.duty("A") < 0.16 and brick.encoder("A") > 100, brick.duty("A")
    return f"duty {brick.duty('A'):.0%} of A, turned {brick.encoder('A')} degrees"


def press_touch(brick: FirmwareBrick) -> None:
    """Press and release the touch sensor on port 4."""
    for pressed in (1, 0):
        brick.set("touch.4", pressed)
        brick.run(0.5)


def robocon_calibrated() -> tuple[FirmwareBrick, list[str]]:
    """The balancer after both calibrations, and what it showed."""
    kinds = {"1": "gyro", "2": "ultrasonic", "3": "light", "4": "touch"}
    brick = images()["ET Robocon balancer"].brick(
        sensors={n: {"kind": k} for n, k in kinds.items()}
    )
    brick.run(4.0)
    brick.press("right")
    shown = []
    for name, light in (("WHITE", 0.9), ("BLACK", 0.2)):
        brick.set("light.3", light)
        brick.expect_text(name)
        brick.run(0.5)
        shown += [line for line in brick.lines if name in line]
        press_touch(brick)
    return brick, shown


def nxos_moves() -> tuple[FirmwareBrick, bytes]:
    """Its test system turns motor A by 90 degrees when a computer says so."""
    brick = images()["NxOS, commands over USB"].brick()
    brick.expect_text("Waiting command", within=8)
    computer = brick.usb()
    assert computer.enumerate() == (0x0694, 0xFF00)
    computer.write(1, b"Al\0")
    return brick, computer.read(2)


@check("NxOS", "USB")
def nxos_answers() -> str:
    """It enumerates as NxOS and answers a command."""
    _, answer = nxos_moves()
    assert answer == b"Ok", answer
    return "answers Ok"


@check("NxOS", "motor")
def nxos_turns_a_motor() -> str:
    """It stops the motor at full speed, so the motor turns further."""
    brick, _ = nxos_moves()
    brick.run(1.0)
    assert 90 <= brick.encoder("A") <= 180 and brick.duty("A") == 0.0, brick.encoder("A")
    return f"90 degrees asked for at full speed, {brick.encoder('A')} turned"


@check("NxOS", "LCD")
def nxos_waits() -> str:
    """What its test system shows."""
    brick = images()["NxOS, commands over USB"].brick()
    brick.expect_text("Waiting command", within=8)
    return "Waiting command"


@check("NxOS", "link")
def nxos_link() -> str:
    """Every frame to the co-processor is good."""
    brick = images()["NxOS, commands over USB"].brick()
    brick.run(2.0)
    counted = count_frames(brick, 1.5)
    assert counted.bad <= 1 and counted.good > 200, str(counted)
    return str(counted)


SCRIPT = """
from pybricks.nxtdevices import Motor, TouchSensor
from pybricks.parameters import Port
touch = TouchSensor(Port.S1)
print("waits")
while not touch.pressed():
    pass
motor = Motor(Port.A)
motor.run_angle(300, 360)
print("angle", motor.angle())
"""


def pybricks_script(name: str) -> tuple[FirmwareBrick, str]:
    """Run the script over USB, with the touch sensor pressed after a second."""
    brick = images()[name].brick()
    brick.run(5.0)
    hub = PybricksHub(brick)
    hub.download(compiled(SCRIPT))
    hub.start()
    hub.expect("waits")
    brick.run(1.0)
    assert brick.encoder("A") == 0
    brick.set("touch.1", 1)
    return brick, hub.expect("angle", within=6.0)


def pybricks_prints(name: str) -> str:
    """What a script prints comes over USB."""
    return f"prints '{pybricks_script(name)[1].strip()}'"


def pybricks_senses(name: str) -> str:
    """`TouchSensor.pressed` of a script."""
    pybricks_script(name)
    return "the script goes on when the touch sensor is pressed"


def pybricks_motor(name: str) -> str:
    """`Motor.run_angle` of a script."""
    brick, _ = pybricks_script(name)
    assert 355 <= brick.encoder("A") <= 366, brick.encoder("A")
    return f"Python: 360 degrees asked for, {brick.encoder('A')} turned"


def pybricks_link(name: str) -> str:
    """Every frame to the co-processor is good."""
    brick = images()[name].brick()
    brick.run(4.0)
    counted = count_frames(brick, 1.5)
    assert counted.bad <= 1 and counted.good > 200, str(counted)
    return str(counted)


for _name in ("Pybricks 4.0.0b4", "Pybricks 4.0.0b5"):
    check(_name, "USB")(partial(pybricks_prints, _name))
    check(_name, "sensor")(partial(pybricks_senses, _name))
    check(_name, "motor")(partial(pybricks_motor, _name))
    check(_name, "link")(partial(pybricks_link, _name))


# Request of the class CDC: the terminal is there (DTR, RTS).
SET_CONTROL_LINE_STATE = bytes([0x21, 0x22, 3, 0, 0, 0, 0, 0])


@check("pbLua 2.0.0 RC2", "LCD")
def pblua_menu() -> str:
    """Its menu of consoles."""
    brick = images()["pbLua 2.0.0 RC2"].brick()
    brick.expect_text("USB Console", within=8)
    assert "Rover" in brick.lines
    return "menu of consoles, name of the Bluetooth module"


@check("pbLua 2.0.0 RC2", "link")
def pblua_link() -> str:
    """Every frame to the co-processor is good."""
    brick = images()["pbLua 2.0.0 RC2"].brick()
    brick.run(3.0)
    counted = count_frames(brick, 1.5)
    assert counted.bad <= 1 and counted.good > 500, str(counted)
    return str(counted)


@check("pbLua 2.0.0 RC2", "USB")
def pblua_console() -> str:
    """A line typed at the console over USB, a serial line of the class CDC, and its answer."""
    brick = images()["pbLua 2.0.0 RC2"].brick()
    brick.expect_text("USB Console", within=8)
    computer = brick.usb()
    brick.press("orange")
    computer.enumerate()
    computer.control(SET_CONTROL_LINE_STATE)
    computer.write(1, b"print(6*7)\r")
    printed = b""
    while b"\n42" not in printed:
        printed += computer.read(2)
    return "print(6*7) answers 42"


# What the programs' sources plug in, by the names of their images.
GNAT_SENSORS: dict[str, dict[str, Any]] = {
    "event_program": {"1": {"kind": "touch"}, "3": {"kind": "light"}},
    "schedule_program": {"2": {"kind": "touch"}, "3": {"kind": "ultrasonic"}},
    "line_follower": {"2": {"kind": "touch"}, "3": {"kind": "ultrasonic"}},
    "helloworld": {"1": {"kind": "light"}, "2": {"kind": "touch"}},
    "topdog": {"1": {"kind": "light"}, "2": {"kind": "touch"}, "3": {"kind": "ultrasonic"}},
}
GNAT = tuple(name for name in images() if name.startswith("GNAT "))


def gnat_brick(name: str) -> FirmwareBrick:
    """A brick with a program built with GNAT GPL in 2018 by students, and its sensors."""
    return images()[name].brick(sensors=GNAT_SENSORS[name.split()[1]])


def gnat_link(name: str) -> str:
    """Most write frames are good; with an ultrasonic sensor their handler comes late at times."""
    brick = gnat_brick(name)
    brick.run(0.2)
    counted = count_frames(brick, 2.5)
    assert counted.good > 60 and counted.good > counted.bad, str(counted)
    return str(counted)


def gnat_duties(
    brick: FirmwareBrick, name: str, seconds: float = 0.7
) -> list[list[tuple[int, ...]]]:
    """Duties of A, B and C (%) in the good frames of each phase of a drive.

    Phase by phase light and distance change, and the touch sensor is held and released, these
    `seconds` each; then come the arrows.
    """
    brick.device.record_buses()
    sensors = {kind["kind"]: port for port, kind in GNAT_SENSORS[name.split()[1]].items()}
    phases = []

    def phase_ends() -> None:
        frames = commands(brick.device.bus_log())
        phases.append([struct.unpack("3b", data[2:5]) for data in frames])

    for level, metres in ((0.1, 0.1), (0.9, 1.0), (0.4, 0.15)):
        if "light" in sensors:
            brick.set(f"light.{sensors['light']}", level)
        if "ultrasonic" in sensors:
            brick.set(f"distance.{sensors['ultrasonic']}", metres)
        for pressed in (1, 0):
            brick.set(f"touch.{sensors['touch']}", pressed)
            brick.run(seconds)
            phase_ends()
    for button in ("right", "left"):
        brick.press(button, 0.5, 0.5)
        phase_ends()
    return phases


def gnat_motor(name: str) -> str:
    """The touch sensor is held, light and distance change, arrows are pressed: a motor turns."""
    brick = gnat_brick(name)
    duties = [duty for phase in gnat_duties(brick, name) for duty in phase]
    largest = [max((abs(d[i]) for d in duties), default=0) for i in range(3)]
    turned = [brick.encoder(port) for port in "ABC"]
    assert max(largest) > 0, "no frame drives a motor"
    assert any(abs(n) > 20 for n in turned), f"no motor turns: {turned}, duties {largest} %"
    return f"largest duty of A, B, C: {largest} %, turned {turned} degrees"


def gnat_distance(name: str) -> str:
    """The programs that only measure show the distance in centimetres."""
    brick = gnat_brick(name)
    brick.set("distance.3", 0.3)
    brick.expect_text("30")
    return "shows 30 at 0.3 m"


def gnat_switches_off(name: str) -> str:
    """The programs with a button task call Power_Down when the orange button is pressed."""
    brick = gnat_brick(name)
    brick.run(3.0)
    with brick.switched_off():
        brick.press("orange", 1.0, 1.0)
    return f"off at {brick.seconds:.1f} s"


# Of these two, their authors wrote that they compile, no more.
UNFINISHED = ("GNAT schedule_program 5d14fb", "GNAT event_program 90ff35")
MEASURING = ("GNAT topdog 64f7d2", "GNAT topdog 2edde5")
for _name in GNAT:
    check(_name, "link")(partial(gnat_link, _name))
    if _name in MEASURING:
        check(_name, "sensor")(partial(gnat_distance, _name))
    elif _name not in UNFINISHED:
        check(_name, "motor")(partial(gnat_motor, _name))
for _name in (name for name in GNAT if name.split()[1] in ("helloworld", "topdog")):
    check(_name, "switches off")(partial(gnat_switches_off, _name))
