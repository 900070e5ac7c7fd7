# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Reference pages made from the program itself."""

from __future__ import annotations

import re
from pathlib import Path

from ravenbrick.cli.app import COMMANDS

from tools.docs.reference_pages import SCHEMAS, command_page, package_page, schema_page, trace_page
from tools.docs.site_links import check_site


def test_the_page_of_commands_has_every_command_with_its_example() -> None:
    """A new command is on the page without anybody writing it."""
    page = command_page()
    shown = re.findall(r"^## ravenbrick (\S+)$", page, re.MULTILINE)
    assert shown == sorted(COMMANDS)
    assert "| `--rubric` | Rubric (TOML). |" in page


def test_pages_of_files_have_nested_fields_with_units() -> None:
    """Quantities with their unit, lists with brackets."""
    page = schema_page(*SCHEMAS["robot-toml"])
    assert "| `motors.NAME.resistance` | quantity in ohm |" in page
    assert "| `tasks[].period_us` | integer |" in page
    assert "`checks[].stack_share_at_most`" in schema_page(*SCHEMAS["rubric-toml"])


def test_pages_of_packages_have_what_programs_may_name() -> None:
    """Public declarations with their comments; no private part, no registers."""
    drivers = package_page("Drivers", "", "drivers/src")
    assert "## NXT.Telemetry\n" in drivers and "procedure Publish (Group" in drivers
    assert "NXT.Registers" not in drivers and "Sample_Slot is record" not in drivers
    run_time = package_page("Run-time", "", "runtime/language")
    assert "## Ada.Real_Time\n\nMonotonic time (Ada RM D.8)." in run_time
    assert "function Clock return Time" in run_time


def test_the_page_of_events_has_every_kind_and_the_layout() -> None:
    """As recordings are written."""
    page = trace_page()
    assert "| 8 | motor command |" in page
    assert "An event has 24 bytes" in page and "| `value` | 16 | int64 |" in page


def test_links_that_lead_nowhere_are_found(tmp_path: Path) -> None:
    """Files and places on pages; what leads outside is only counted."""
    (tmp_path / "a.html").write_text(
        '<p id="here"><a href="b.html#there">1</a><a href="#here">2</a><a href="c.html">3</a>'
        '<a href="b.html#nowhere">4</a><a href="https://example.org">5</a><a href="../x">6</a>'
    )
    (tmp_path / "b.html").write_text('<p id="there">')
    report = check_site(tmp_path)
    assert report.followed == 5 and report.outside == {"https://example.org"}
    assert [line.split(": ")[1] for line in report.broken] == ["c.html", "b.html#nowhere", "../x"]
