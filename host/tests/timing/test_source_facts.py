# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Loop bounds that stand in Ada sources, and the facts that come with the drivers."""

from __future__ import annotations

import os
import tomllib
from pathlib import Path

import pytest
from verification.support.projects import VEHICLE

from ravenbrick.errors import ImageFileError, ProjectFileError
from ravenbrick.image.build import manifest_file
from ravenbrick.image.manifest import BuildManifest
from ravenbrick.project.robot import read_robot
from ravenbrick.timing.facts.facts import read_facts
from ravenbrick.timing.facts.source_facts import check_age, loop_statements, statements_text

SOURCE = Path("worker.adb")
TEXT = """\
package body Worker is  --  for the loop of a "task
   procedure Work (Last : Positive) is
   begin
      for Item in 1 .. Last
      loop
         pragma Annotate (Ravenbrick, Iterations, 1_000, "no ""more"" of them");
         Put ("end loop");
         while Busy loop
            Wait;
         end loop;
         pragma Assert (Item > 0);
         Named :
         loop
            pragma Annotate (Ravenbrick, Iterations, 7);
            exit Named when Done;
         end loop Named;
      end loop;
   end Work;
end Worker;
"""


def test_a_pragma_bounds_the_loop_statement_that_it_stands_in() -> None:
    outer, silent, inner = loop_statements(SOURCE, TEXT)
    assert (outer.iterations, outer.reason, outer.depth) == (1000, 'no "more" of them', 0)
    assert outer.lines() == [4, 5, 6, 7, 11, 12, 17]
    assert (silent.iterations, silent.lines(), silent.depth) == (None, [8, 9, 10], 1)
    assert (inner.iterations, inner.reason, inner.lines()) == (7, "", [13, 14, 15, 16])


def test_statements_are_told_with_their_lines_also_those_that_say_nothing() -> None:
    told = tomllib.loads(statements_text(SOURCE, loop_statements(SOURCE, TEXT)))["statement"]
    assert [row.get("iterations") for row in told] == [1000, None, 7]
    assert told[1] == {"file": "worker.adb", "lines": [8, 9, 10], "depth": 1}


def test_a_count_of_ports_with_a_device_is_that_of_the_robot() -> None:
    """At least one, and never more than the pragma says."""
    text = TEXT.replace('"no ""more"" of them"', '"sensors", "ultrasonic"').replace("1_000", "4")
    (loop, *_) = loops = loop_statements(SOURCE, text)
    assert (loop.iterations, loop.device) == (4, "ultrasonic")
    for ports, most in ((0, 1), (1, 1), (3, 3), (5, 4)):
        devices = ["touch", *("ultrasonic",) * ports]
        told = tomllib.loads(statements_text(SOURCE, loops, devices))["statement"]
        assert told[0]["iterations"] == most
    assert tomllib.loads(statements_text(SOURCE, loops))["statement"][0]["iterations"] == 4


@pytest.mark.parametrize(
    "pragma",
    [
        "pragma Annotate (Ravenbrick, Iterations, Last);",
        "pragma Annotate (Ravenbrick, Turns, 3);",
        'pragma Annotate (Ravenbrick, Iterations, "3");',
    ],
)
def test_a_pragma_that_is_not_understood_is_named_with_its_line(pragma: str) -> None:
    text = TEXT.replace("pragma Annotate (Ravenbrick, Iterations, 7);", pragma)
    with pytest.raises(ProjectFileError, match=r"worker\.adb:14: pragma Annotate: is not under"):
        loop_statements(SOURCE, text)


def test_a_pragma_outside_of_loops_is_refused_and_those_of_other_tools_are_not() -> None:
    ours = "   pragma Annotate (Ravenbrick, Iterations, 7);\n"
    with pytest.raises(ProjectFileError, match=r"worker\.adb:1: .*expected, in a loop"):
        loop_statements(SOURCE, ours)
    other = 'pragma Annotate (GNATprove, Intentional, "overflow", "never");'
    assert loop_statements(SOURCE, other) == []


def test_facts_of_the_drivers_come_with_every_project_and_its_own_come_first(
    tmp_path: Path,
) -> None:
    text = (VEHICLE / "robot.toml").read_text().replace("coprocessor_task", "exchange")
    (tmp_path / "robot.toml").write_text(text)
    alone = read_facts(read_robot(tmp_path))
    assert {load.file.rpartition("drivers/")[2] for load in alone.interrupts} == {"timing.toml"}
    assert all(load.task is None for load in alone.interrupts)
    (tmp_path / "timing.toml").write_text(
        'schema_version = 1\n[[mode]]\nname = "link up"\nreason = "mine"\n'
        '[[outside]]\nsymbol = "search"\ntask = "exchange"\n'
        'period_us = 2_000\nreason = "seconds"\n'
    )
    both = read_facts(read_robot(tmp_path))
    assert [mode.reason for mode in both.modes] == ["mine"]
    assert both.name == str(tmp_path / "timing.toml")
    assert both.outside == '[[avoided]]\nsymbol = "search"\nreason = "seconds"\n'
    assert [load.period_us for load in both.outside_of("Exchange")] == [2_000]
    assert len(both.shared) == 1


def test_a_source_saved_anew_is_not_newer_than_its_image_but_a_changed_one_is(
    tmp_path: Path,
) -> None:
    """Building would change nothing for the first one."""
    source, elf = tmp_path / "worker.adb", tmp_path / "worker.elf"
    source.write_text(TEXT)
    elf.write_bytes(b"")
    BuildManifest.now({}, [tmp_path], []).write(manifest_file(elf))
    later_s = elf.stat().st_mtime + 10
    os.utime(source, (later_s, later_s))
    check_age(source, elf)
    source.write_text(TEXT.replace("7", "8"))
    os.utime(source, (later_s, later_s))
    with pytest.raises(ImageFileError, match=r"is older than .*worker\.adb"):
        check_age(source, elf)
