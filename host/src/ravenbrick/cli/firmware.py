# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick firmware`: any firmware image under a test script."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Annotated, Any

import typer

from ravenbrick.brick.firmware_script import FirmwareScript
from ravenbrick.cli.app import JsonOption, command
from ravenbrick.cli.build import ImageChoice
from ravenbrick.cli.console import Reporter
from ravenbrick.cli.timing_profile import TimingProfile, TimingProfileOption
from ravenbrick.errors import CriteriaError
from ravenbrick.image.elf import read_binary

__all__ = ["firmware_command"]


@command("ravenbrick firmware my_firmware.bin tests/firmware.py --json")
def firmware_command(
    image: Annotated[Path, typer.Argument(help="Raw binary image of the firmware.")],
    script: Annotated[Path, typer.Argument(help="Python file with functions test_*(brick).")],
    at: Annotated[ImageChoice, typer.Option(help="Load address.")] = ImageChoice.FLASH,
    only: Annotated[str, typer.Option(help="Part of the names of the tests to run.")] = "",
    timing_profile: TimingProfileOption = TimingProfile.NOMINAL,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    loaded = read_binary(image, at.kind)
    reporter = Reporter(json_output)
    results = []
    settings = timing_profile.settings
    for result in FirmwareScript(script).run(loaded.content, loaded.entry, settings, only):
        word = "passed" if result.failure is None else "FAILED"
        reporter.print(f"{word}  {result.name}  ({result.seconds:.1f} s on the brick)")
        if result.failure is not None:
            reporter.print(f"        {result.failure}")
        results.append(result)
    failed = [result for result in results if result.failure is not None]
    answer = {
        "image": str(image),
        "sha256": hashlib.sha256(loaded.content).hexdigest(),
        "tests": [result.as_json() for result in results],
    }
    if failed:
        error = CriteriaError(
            f"{len(failed)} of {len(results)} tests failed: {failed[0].name}: {failed[0].failure}"
        )
        error.data = answer
        raise error
    return answer
