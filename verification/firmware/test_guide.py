# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The scripts of the guide about firmware pass on the images that it names."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
from ravenbrick.brick.firmware_script import FirmwareScript, ScriptResult
from ravenbrick.image.elf import FLASH

from verification.firmware.witnesses.library import ImageAbsentError, images
from verification.support.paths import ROOT

GUIDE = ROOT / "docs" / "guides" / "firmware.md"


def results(image: str, script: str, folder: Path) -> list[ScriptResult]:
    """Run a script of the guide on an image."""
    block = rf"<!-- script: {script} -->\n```python\n(.*?)```"
    found = re.search(block, GUIDE.read_text(), re.DOTALL)
    assert found is not None
    path = folder / "script.py"
    path.write_text(found[1])
    try:
        content = images()[image].content
    except ImageAbsentError as error:
        pytest.skip(str(error))
    return list(FirmwareScript(path).run(content, FLASH.begin, {}))


@pytest.mark.parametrize(
    ("image", "script", "tests"), [("LEGO 1.29.2", "lego", 4), ("Pybricks 4.0.0b5", "pybricks", 2)]
)
def test_the_scripts_of_the_guide_pass(image: str, script: str, tests: int, tmp_path: Path) -> None:
    assert [result.failure for result in results(image, script, tmp_path)] == [None] * tests


def test_two_bugs_of_the_debian_package_are_shown(tmp_path: Path) -> None:
    """Mended in 1.29.5 and 1.29.6, the package has 1.29.2."""
    if shutil.which("nbc") is None:
        pytest.skip("nbc is absent: install the Debian package nbc")
    shown = results("LEGO 1.29.2", "conversions", tmp_path)
    assert all("begin" in result.lcd for result in shown), "a program did not run"
    assert [result.lcd[-1] for result in shown] == ["0", "0"]
    assert all(result.failure is not None for result in shown)
