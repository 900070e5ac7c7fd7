# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Put an image on a real brick through libnxt's programs, and say clearly what went wrong."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Literal

from ravenbrick.errors import ConnectionFailedError, ToolMissingError
from ravenbrick.hardware.usb_bricks import UDEV_RULE, BrickMode, UsbBrick
from ravenbrick.image.build import Tool
from ravenbrick.image.raw_binary import FlatImage
from ravenbrick.installation import advice_for_packages

__all__ = ["LOADERS", "brick_to_load", "load"]

LOADERS: dict[Literal["ram", "flash"], Tool] = {
    "ram": Tool("fwexec", "loads an image into the brick's RAM and starts it", "libnxt"),
    "flash": Tool("fwflash", "writes the brick's flash", "libnxt"),
}
_TIMEOUT_S = 120

_ENTER_MONITOR = (
    "bring it into its boot monitor: press the reset button in the hole below the USB socket, at "
    "the upper left corner of the back, with a paper clip for five seconds until the brick clicks"
)
# What the loaders print, and what it means.
_SYMPTOMS = (
    (
        "not found",
        "the loader sees no brick; check the cable and the battery, then " + _ENTER_MONITOR,
    ),
    ("not running in reset mode", "the brick runs its firmware; " + _ENTER_MONITOR),
    (
        "while connecting",
        f"the brick cannot be opened; install {UDEV_RULE} of the folder that 'ravenbrick home' "
        "prints (docs/guides/real-brick.md)",
    ),
    (
        "handshake",
        "the boot monitor does not answer; take out the battery for a moment and try again",
    ),
    ("Sending file", "the transfer broke off; use another cable or socket, then try again"),
    ("Error jumping", "the image is loaded but was not started; try again"),
)


def brick_to_load(bricks: Sequence[UsbBrick]) -> UsbBrick:
    """The one brick that waits for an image; raises `ConnectionFailedError` saying why not."""
    waiting = [brick for brick in bricks if brick.mode is BrickMode.BOOT_MONITOR]
    if len(waiting) > 1:
        raise ConnectionFailedError(
            f"{len(waiting)} bricks wait in their boot monitors; leave only one plugged in"
        )
    if not waiting and bricks:
        raise ConnectionFailedError(f"a brick is there, {bricks[0].mode.words}; {_ENTER_MONITOR}")
    if not waiting:
        raise ConnectionFailedError(
            "no brick on the USB; plug it in with its cable, switch it on, then " + _ENTER_MONITOR
        )
    if not waiting[0].usable:
        raise ConnectionFailedError(
            f"{waiting[0].node} may not be opened by this user; install {UDEV_RULE} of the folder "
            "that 'ravenbrick home' prints (docs/guides/real-brick.md); plug the brick in again"
        )
    return waiting[0]


def _explain(tool: Tool, output: str) -> ConnectionFailedError:
    text = next((words for symptom, words in _SYMPTOMS if symptom in output), None)
    return ConnectionFailedError(
        text or f"'{tool.program}' failed; what it said is below", detail=output.strip()
    )


def load(
    image: FlatImage,
    kind: Literal["ram", "flash"],
    find_tool: Callable[[str], str | None] = shutil.which,
) -> str:
    """Run the loader and return what it printed.

    Raises `ToolMissingError` and `ConnectionFailedError`. An interrupted flash leaves the brick
    in its boot monitor, which is in the processor's ROM region of the chip and cannot be lost.
    """
    tool = LOADERS[kind]
    program = find_tool(tool.program)
    if program is None:
        raise ToolMissingError(
            f"'{tool.program}' ({tool.purpose}) is not installed; "
            f"{advice_for_packages([tool.package])}"
        )
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "image.bin"
        file.write_bytes(image.content)
        places = [f"0x{image.address:x}", f"0x{image.entry:x}"] if kind == "ram" else []
        try:
            done = subprocess.run(
                [program, str(file), *places],
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                timeout=_TIMEOUT_S,
                check=False,
            )
        except subprocess.TimeoutExpired:
            raise ConnectionFailedError(
                f"'{tool.program}' did not finish within {_TIMEOUT_S} s; unplug the brick, "
                "take out its battery for a moment and try again"
            ) from None
    if done.returncode != 0:
        raise _explain(tool, done.stdout)
    return done.stdout.strip()
