# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Programs as GNAT GPL compiled them, and the same sources with this run-time and these drivers.

RAVENBRICK_ADA_LABB names a clone of xdawax/ADA_LABB with its history, which holds the binaries of
`images.toml` and what they were compiled from. Both drive through the same phases, in which light,
distance and buttons change, and give each motor the same duty. Single frames differ: GNAT's drivers
send a fifth of the frames, some half-way through a change of two motors, and before the first
frame from the co-processor they say "pressed" (docs/guides/drivers.md).
"""

from __future__ import annotations

import io
import os
import subprocess
import tarfile
from pathlib import Path
from statistics import mode

import pytest
from ravenbrick.brick.firmware import FirmwareBrick

from verification.firmware.images import USER_RAM
from verification.firmware.witnesses.library import ImageAbsentError, switched_on
from verification.firmware.witnesses.others import GNAT, GNAT_SENSORS, gnat_brick, gnat_duties
from verification.support.bricks.programs import gprbuild

HERE = Path(__file__).resolve().parent
HISTORY = os.environ.get("RAVENBRICK_ADA_LABB", "")
# The folder at the first commit that holds the binary.
SOURCES = {
    "GNAT event_program 3a8587": "d83be67:task2",
    "GNAT event_program 5f20d0": "8b7cb13:task2_2",
    "GNAT event_program 90ff35": "895c9e0:task2_3",
    "GNAT schedule_program 24ad2c": "148dae4:task3",
    "GNAT schedule_program 1a710f": "64296c8:task3",
    "GNAT schedule_program 5d14fb": "7724810:task3",
    "GNAT line_follower 6d5acb": "fddf0eb:task4",
    "GNAT helloworld 7820b4": "8d2d106:Lab2_part2",
    "GNAT topdog 86c6f0": "447a939:Lab2_part3",
    "GNAT topdog 378385": "9a7ae70:Lab2_part3",
    "GNAT topdog 9adf04": "bdfccfd:Lab2_part4",
    "GNAT topdog 3d48d6": "a5c54d8:Lab2_part4",
    "GNAT topdog 472c1c": "f883c0a:Lab2_part4",
    "GNAT topdog 64f7d2": "d28f01a:Lab2_part4",
    "GNAT topdog 2edde5": "ed6d5fc:Lab2_part4",
}
LEFT_OUT = {
    "GNAT event_program 45f77d": "the sources beside this binary do not compile: no operand",
}
# GNAT's link queues the changes of motors and sends one with each frame. This program makes more
# changes than there are frames: it drives on for 2.5 s after 4 s of driving. It is compared when
# the queue is empty, in each second phase of a distance.
QUEUED = "GNAT topdog 472c1c"
# In phases of 0.7 s three programs change at other instants, though to the same duties.
PHASE_S = 2.0
NEED_THUMB = ("GNAT schedule_program 24ad2c", "GNAT line_follower 6d5acb")


def unpack(name: str, folder: Path) -> None:
    """The program's Ada files, without those of its editor and binder and a second program."""
    command = ["git", "-C", HISTORY, "archive", SOURCES[name]]
    archive = subprocess.run(command, capture_output=True, check=True).stdout
    with tarfile.open(fileobj=io.BytesIO(archive)) as files:
        for member in files:
            left_out = member.name.startswith((".", "b~")) or member.name == "task2.adb"
            content = files.extractfile(member) if member.isfile() else None
            if content and member.name.endswith((".adb", ".ads")) and not left_out:
                (folder / member.name).write_bytes(content.read())


def rebuilt(name: str, folder: Path) -> FirmwareBrick:
    """A brick with our build of the program's sources."""
    sources, main = folder / "sources", name.split()[1]
    sources.mkdir()
    unpack(name, sources)
    gprbuild(
        HERE / "course.gpr",
        CODE="thumb" if name in NEED_THUMB else "arm",
        SOURCES=sources,
        MAIN=main,
        OBJECTS=folder,
    )
    objcopy = ["arm-none-eabi-objcopy", "-O", "binary", f"{main}.elf", f"{main}.bin"]
    subprocess.run(objcopy, cwd=folder, check=True)
    content = (folder / f"{main}.bin").read_bytes()
    return switched_on(content, USER_RAM, sensors=GNAT_SENSORS[main])


def usual_duties(brick: FirmwareBrick, name: str) -> list[list[int]]:
    """Of A, B and C at the end of each phase: the most frequent one of its last quarter."""
    phases = gnat_duties(brick, name, PHASE_S)
    assert all(phases), "a phase without a good frame"
    ends = [phase[len(phase) * 3 // 4 :] for phase in phases]
    return [[mode(duty[i] for duty in end) for i in range(3)] for end in ends]


@pytest.mark.skipif(not HISTORY, reason="RAVENBRICK_ADA_LABB names no clone of xdawax/ADA_LABB")
@pytest.mark.parametrize("name", GNAT)
def test_motors_get_the_duty_of_our_build_of_the_same_sources(name: str, tmp_path: Path) -> None:
    """At the end of each phase."""
    if name in LEFT_OUT:
        pytest.skip(LEFT_OUT[name])
    try:
        expected = usual_duties(gnat_brick(name), name)
    except ImageAbsentError as error:
        pytest.skip(str(error))
    compared = slice(1, None, 2) if name == QUEUED else slice(None)
    assert usual_duties(rebuilt(name, tmp_path), name)[compared] == expected[compared]
