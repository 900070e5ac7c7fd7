# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from verification.support.recordings import preempted

from ravenbrick.clock import MASTER_CLOCK
from ravenbrick.errors import ProjectFileError, ScenarioError, ToolMissingError
from ravenbrick.project.robot import Robot
from ravenbrick.project.scenario import input_check, read_scenario, scenario_path
from ravenbrick.project.stimuli import Channels, TimedInput, read_stimulus
from ravenbrick.trace.export import Format, export
from ravenbrick.trace.recording import Stop

Edit = Callable[[str, str, str], int]
VCD = """$timescale 10 us $end
$scope module bench $end
$var wire 1 ! button $end
$var real 64 " angle $end
$var reg 4 % count $end
$upscope $end
$enddefinitions $end
#0
x!
r0 "
b0000 %
#100
1!
r0.5 "
#115
0!
b1111 %
"""


def read(path: Path, robot: Robot, delay_ms: int = 0, **names: str) -> list[tuple[int, str, float]]:
    """Cycle, name and value of each input of a file."""
    renamed = {key.replace("__", "."): value for key, value in names.items()}
    channels = Channels(input_check(robot), renamed)
    inputs = read_stimulus(path, MASTER_CLOCK, channels, delay_ms)
    return [(timed.at_cycles, timed.name, timed.value) for timed in inputs]


@pytest.mark.parametrize(
    ("unit", "times"),
    [
        ("time_s", ("1", "1.15")),
        ("time_ms", ("1000", "1150.0")),
        ("time_us", ("1e6", "1150000")),
        ("at_cycles", ("48054858", "55263086")),
    ],
)
def test_csv_gives_the_same_cycles_as_a_scenario(
    tmp_path: Path, robot: Robot, unit: str, times: tuple[str, str]
) -> None:
    """Each unit of time is exact; empty cells, comments and repeated values change nothing."""
    file = tmp_path / "in.csv"
    begin, end = times
    file.write_text(
        f"# recorded by hand\n{unit}, touch.1, motor.A.hand_angle\n"
        f"0,0,\n{begin},1,\n\n{begin},,0.25\n{end},0,0.25\n"
    )
    assert read(file, robot) == [
        (48_054_858, "touch.1", 1.0),
        (48_054_858, "motor.A.hand_angle", 0.25),
        (MASTER_CLOCK.cycles_of_ms(1150), "touch.1", 0.0),
    ]


@pytest.mark.parametrize(
    ("text", "line", "problem"),
    [
        ("seconds,touch.1\n", 1, "the first column must be one of time_s"),
        ("time_s,touch.9\n", 1, "touch.9: there is no touch sensor on sensor port 9"),
        ("time_s,touch.1,touch.1\n", 1, "the column is defined twice"),
        ("time_s,touch.1\n1,1\n2,yes\n", 3, "touch.1: is 'yes'; expected a number"),
        ("time_s,touch.1\n1,1\n# x\n0.5,0\n", 4, "time: 0.5 s comes after 1 s"),
        ("time_s,touch.1\n1,1,0\n", 2, "3 cells; the head has 2 columns"),
        ("time_s,touch.1\n-1,1\n", 2, "is -1; expected at least 0"),
        ("time_s,touch.1\n1,1e999\n", 2, "expected a finite number"),
        ("time_s,touch.1\n1e999999999999,1\n", 2, "expected a finite number"),
        ("time_s,touch.1\n1,nan\n", 2, "expected a finite number"),
        ("", 1, "the first column must be one of"),
    ],
)
def test_a_wrong_csv_names_file_and_line(
    tmp_path: Path, robot: Robot, text: str, line: int, problem: str
) -> None:
    """Exit code 3."""
    file = tmp_path / "in.csv"
    file.write_text(text)
    with pytest.raises(ProjectFileError) as caught:
        read(file, robot)
    assert f"{file}:{line}: " in caught.value.sentence
    assert problem in caught.value.sentence


def test_vcd_variables_are_mapped_to_inputs(tmp_path: Path, robot: Robot) -> None:
    """Wires, reals and vectors; x drives nothing; the delay comes before the file's time."""
    pytest.importorskip("vcd", reason="pyvcd is an extra")
    file = tmp_path / "in.vcd"
    file.write_text(VCD)
    found = read(file, robot, 500, bench__button="touch.1", bench__angle="motor.A.hand_angle")
    assert found == [
        (MASTER_CLOCK.cycles_of_us(501_000), "touch.1", 1.0),
        (MASTER_CLOCK.cycles_of_us(501_000), "motor.A.hand_angle", 0.5),
        (MASTER_CLOCK.cycles_of_us(501_150), "touch.1", 0.0),
    ]
    counted = read(file, robot, bench__count="motor.B.load_torque")
    assert counted == [(MASTER_CLOCK.cycles_of_us(1150), "motor.B.load_torque", 15.0)]


@pytest.mark.parametrize(
    ("old", "new", "line", "problem"),
    [
        ("#100", "#oops", 12, "not valid VCD"),
        ('r0.5 "', 'q0.5 "', 14, "not valid VCD"),
        ("#115", "#99", 16, "time: 0.00099 s comes after 0.001 s"),
    ],
)
def test_a_wrong_vcd_names_file_and_line(
    tmp_path: Path, robot: Robot, old: str, new: str, line: int, problem: str
) -> None:
    """Syntax and order of time are checked with the line."""
    pytest.importorskip("vcd", reason="pyvcd is an extra")
    file = tmp_path / "in.vcd"
    file.write_text(VCD.replace(old, new, 1))
    with pytest.raises(ProjectFileError) as caught:
        read(file, robot, bench__button="touch.1")
    assert problem in caught.value.sentence
    assert caught.value.line in (line, line - 1)


def test_a_vcd_variable_that_is_no_input_names_its_declaration(
    tmp_path: Path, robot: Robot
) -> None:
    """Without a mapping, every variable must be called like an input."""
    pytest.importorskip("vcd", reason="pyvcd is an extra")
    file = tmp_path / "in.vcd"
    file.write_text(VCD)
    with pytest.raises(ProjectFileError, match=r"in\.vcd:3: bench\.button: unknown input"):
        read(file, robot)
    with pytest.raises(ProjectFileError, match=r"bench\.lever: there is no such column"):
        read(file, robot, bench__lever="touch.1")


def test_an_exported_vcd_plays_the_inputs_of_its_run_again(tmp_path: Path, robot: Robot) -> None:
    """The inputs come back at the same cycles; signals in the file are not inputs."""
    pytest.importorskip("vcd", reason="pyvcd is an extra")
    inputs = (
        TimedInput(48_054_858, "touch.1", 1.0),
        TimedInput(55_263_086, "touch.1", 0.0),
        TimedInput(480_548_573, "motor.A.hand_angle", -1 / 3),
    )
    recording = replace(preempted(), inputs=inputs, stop=Stop("reached", 500_000_000, ""))
    (file,) = export(recording, Format.VCD, tmp_path / "run.vcd")
    assert read(file, robot) == [(i.at_cycles, i.name, i.value) for i in inputs]


def test_a_vcd_without_its_library_says_what_to_install(
    tmp_path: Path, robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Exit code 4."""
    file = tmp_path / "in.vcd"
    file.write_text(VCD)
    monkeypatch.setitem(sys.modules, "vcd.reader", None)
    with pytest.raises(ToolMissingError, match="needs the Python package 'pyvcd'"):
        read(file, robot)


def test_a_scenario_takes_its_stimuli_from_files_beside_it(
    project: Path, robot: Robot, edit: Edit
) -> None:
    """They join the scenario's own inputs in the order of time."""
    edit("scenarios/drive.toml", "[straight]", '[[stimuli]]\nfile = "hand.csv"\n\n[straight]')
    (project / "scenarios" / "hand.csv").write_text("time_s,motor.A.hand_angle\n2,0.1\n3,0\n")
    scenario = read_scenario(scenario_path(project, "drive"), robot)
    instants = [timed.at_cycles for timed in scenario.timed_inputs()]
    assert instants == sorted(instants)
    assert len(instants) == len(scenario.inputs) + 2
    assert scenario.stimuli[0].place.endswith("hand.csv:2")


def test_a_stimulus_file_that_is_not_there_names_the_line_of_the_scenario(
    project: Path, robot: Robot, edit: Edit
) -> None:
    """Exit code 9."""
    line = edit("scenarios/drive.toml", "[straight]", '[[stimuli]]\nfile = "no.csv"\n\n[straight]')
    with pytest.raises(ScenarioError, match=rf"drive\.toml:{line + 1}: stimuli\[0\]\.file"):
        read_scenario(scenario_path(project, "drive"), robot)


def test_a_stimulus_beyond_the_duration_names_its_own_line(
    project: Path, robot: Robot, edit: Edit
) -> None:
    """What would come after the end is refused before the run."""
    edit("scenarios/drive.toml", "[straight]", '[[stimuli]]\nfile = "late.csv"\n\n[straight]')
    (project / "scenarios" / "late.csv").write_text("time_s,touch.1\n2,1\n20.001,0\n")
    with pytest.raises(ScenarioError, match=r"late\.csv:3: touch\.1: 20\.001 s is beyond"):
        read_scenario(scenario_path(project, "drive"), robot)
