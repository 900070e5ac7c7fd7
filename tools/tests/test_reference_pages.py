# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Reference pages made from the program itself."""

from __future__ import annotations

import re

from ravenbrick.cli import __all__ as commands

from tools.reference_pages import SCHEMAS, command_page, schema_page


def test_the_page_of_commands_has_every_command_with_its_example() -> None:
    """A new command is on the page without anybody writing it."""
    page = command_page()
    shown = re.findall(r"^## ravenbrick (\S+)$", page, re.MULTILINE)
    wanted = [name.removesuffix("_command") for name in commands if name.endswith("_command")]
    assert {"grade", "new", "run"} <= set(shown) and len(shown) >= len(wanted)
    assert "| `--rubric` | The rubric, a TOML file. |" in page


def test_pages_of_files_have_nested_fields_with_units() -> None:
    """Quantities with their unit, lists with brackets."""
    page = schema_page(*SCHEMAS["robot-toml"])
    assert "| `motors.NAME.resistance` | quantity in ohm | yes |" in page
    assert "| `tasks[].period_us` | integer |" in page
    assert "`checks[].stack_share_at_most`" in schema_page(*SCHEMAS["rubric-toml"])
