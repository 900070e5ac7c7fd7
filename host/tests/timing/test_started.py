# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What is read of a program that has been elaborated."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest

from ravenbrick.errors import ImageFileError
from ravenbrick.target.elf_image import ElfImage
from ravenbrick.timing.started import attached_handlers


def test_a_task_as_urgent_as_a_handler_is_refused_by_name() -> None:
    threads = [
        SimpleNamespace(name="main", base_priority=30),
        SimpleNamespace(name="siren", base_priority=31),
    ]
    brick = SimpleNamespace(threads=lambda: threads)
    image = ElfImage(Path("robot.elf"), b"", "ram", 0, (), {})
    with pytest.raises(ImageFileError, match=r"the task 'siren' .* 31, .* at most 30"):
        attached_handlers(brick, image)
