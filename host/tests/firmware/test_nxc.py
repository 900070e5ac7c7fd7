# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""An NXC program, compiled with `nbc`, runs on the brick's own firmware."""

from __future__ import annotations

import struct
import wave
from pathlib import Path

import numpy as np
import pytest
from verification.support.bricks.nxt_firmware import (
    brick_at_the_menu,
    compile_nxc,
    encoder,
    picture,
    run_ms,
)

from ravenbrick.brick.links.peers import UsbComputer
from ravenbrick.brick.sound_file import save_sound

PROGRAM = """
task main()
{
  SetSensorTouch(IN_1);
  ResetTachoCount(OUT_A);
  TextOut(0, LCD_LINE1, "wait");
  until (Sensor(IN_1) == 1);
  PlayTone(880, 300);
  RotateMotor(OUT_A, 60, 360);
  ClearScreen();
  TextOut(0, LCD_LINE1, "Ravenbrick");
  NumOut(0, LCD_LINE3, Sensor(IN_1));
  if (MotorTachoCount(OUT_A) >= 360) TextOut(0, LCD_LINE5, "turned");
  while (true);
}
"""


RESULT = [
    "█▀▀▀▄                         █             ▀         █",
    "█▄▄▄▀  ▀▀▀▄ █   █ ▄▀▀▀▄ █▀▀▄  █▀▀▀▄ ▀▄▀▀▄   █   ▄▀▀▀▄ █ ▄▀",
    "█  ▀▄ ▄▀▀▀█ ▀▄ ▄▀ █▀▀▀  █  █  █   █  █      █   █   ▄ █▀▄",
    "▀   ▀  ▀▀▀▀   ▀    ▀▀▀  ▀  ▀  ▀▀▀▀  ▀▀▀     ▀▀   ▀▀▀  ▀  ▀",
    *[""] * 4,
    " ▄█",
    "  █",
    "  █",
    " ▀▀▀",
    *[""] * 4,
    " ▄                                █",
    "▀█▀▀  █  █  ▀▄▀▀▄ █▀▀▄  ▄▀▀▀▄ ▄▀▀▀█",
    " █ ▄  █ ▄█   █    █  █  █▀▀▀  █   █",
    "  ▀    ▀ ▀  ▀▀▀   ▀  ▀   ▀▀▀   ▀▀▀▀",
]


def upload(computer: UsbComputer, name: str, content: bytes) -> None:
    """By the system commands of LEGO's communication protocol: open, write, close."""
    filename = name.encode().ljust(20, b"\0")

    def ask(telegram: bytes) -> bytes:
        computer.write(1, telegram)
        reply = computer.read(2)
        assert reply[:3] == bytes([2, telegram[1], 0]), reply.hex()
        return reply

    handle = ask(b"\x01\x89" + filename + struct.pack("<I", len(content)))[3]
    for start in range(0, len(content), 60):
        ask(bytes([1, 0x83, handle]) + content[start : start + 60])
    ask(bytes([1, 0x84, handle]))
    computer.write(1, b"\x80\x00" + filename)


def heard_tone(path: Path) -> tuple[float, float]:
    """Length in s and frequency in Hz of the one tone in a sound file."""
    with wave.open(str(path)) as file:
        assert (file.getnchannels(), file.getsampwidth()) == (1, 2)
        rate = file.getframerate()
        samples = np.frombuffer(file.readframes(1 << 24), "<i2").astype(float)
    sounding = np.flatnonzero(samples)
    tone = samples[sounding[0] : sounding[-1] + 1]
    spectrum = np.abs(np.fft.rfft(tone - tone.mean()))
    seconds = len(tone) / rate
    return seconds, float(spectrum.argmax()) / seconds


def test_it_drives_a_motor_reads_sensor_and_encoder_plays_and_writes(tmp_path: Path) -> None:
    program = compile_nxc(PROGRAM)
    brick = brick_at_the_menu()
    computer = UsbComputer(brick)
    computer.enumerate()
    upload(computer, "proof.rxe", program)
    run_ms(brick, 800)
    waiting = picture(brick)
    assert encoder(brick, "A") == 0, "waits for the touch sensor"
    brick.schedule_input(brick.cycles, "touch.1", 1)
    run_ms(brick, 3000)
    assert 360 <= encoder(brick, "A") < 450
    save_sound(brick, tmp_path / "kept" / "tone.wav")
    seconds, hertz = heard_tone(tmp_path / "kept" / "tone.wav")
    assert seconds == pytest.approx(0.3, abs=0.01)
    assert hertz == pytest.approx(880, rel=0.02)
    assert waiting != picture(brick)
    assert picture(brick) == RESULT + [""] * (32 - len(RESULT)), "\n".join(picture(brick))
