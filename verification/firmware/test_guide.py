# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The scripts of the guide about firmware pass on the images that it names."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from ravenbrick.brick.firmware_script import FirmwareScript
from ravenbrick.image.elf import FLASH

from verification.firmware.witnesses.library import ImageAbsentError, images
from verification.support.paths import ROOT

GUIDE = ROOT / "docs" / "guides" / "firmware.md"


@pytest.mark.parametrize(
    ("image", "script", "tests"), [("LEGO 1.29.2", "lego", 4), ("Pybricks 4.0.0b5", "pybricks", 2)]
)
def test_the_scripts_of_the_guide_pass(image: str, script: str, tests: int, tmp_path: Path) -> None:
    block = rf"<!-- script: {script} -->\n```python\n(.*?)```"
    found = re.search(block, GUIDE.read_text(), re.DOTALL)
    assert found is not None
    path = tmp_path / "script.py"
    path.write_text(found[1])
    try:
        content = images()[image].content
    except ImageAbsentError as error:
        pytest.skip(str(error))
    results = list(FirmwareScript(path).run(content, FLASH.begin, {}))
    assert [result.failure for result in results] == [None] * tests
