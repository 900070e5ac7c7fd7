# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick simulate` as people and scripts call it: figures, picture, sentences of errors."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import control
import pytest
from typer.testing import CliRunner
from verification.support.codegen.simulink_files import block, line, single_file

from ravenbrick.cli.app import app
from ravenbrick.errors import ExitCode

FIGURE_4 = Path(__file__).resolve().parents[3] / "examples" / "paper" / "models" / "figure4.slx"


def invoke(*arguments: object) -> Any:
    """Run the command."""
    return CliRunner().invoke(app, ["simulate", *map(str, arguments)])


def test_figure_4_settles_as_the_paper_says(tmp_path: Path) -> None:
    """About 400 ms, nearly no overshoot; the picture has both signals of the scope."""
    picture = tmp_path / "loop.svg"
    done = invoke(FIGURE_4, "--out", picture, "--json")
    assert done.exit_code == ExitCode.OK, done.output
    answer = json.loads(done.output)
    step = {signal["name"]: signal["step"] for signal in answer["signals"]}
    assert step["voltage step"] is None
    assert step["voltage"]["settling_time"] == pytest.approx(0.4, abs=0.01)
    assert step["voltage"]["overshoot"] < 0.001
    assert answer["stop"] == 1.0 and answer["continuous_states"] == 2
    assert "<svg" in picture.read_text()


def test_the_table_shows_the_figures_and_gains_can_be_set() -> None:
    """A gain given on the command line comes before the model's own."""
    done = invoke(FIGURE_4, "--set", "Ki=40", "--stop", "0.6")
    assert done.exit_code == ExitCode.OK, done.output
    row = next(text for text in done.output.splitlines() if text.startswith("voltage  "))
    loop = control.feedback(control.tf([0.361, 40], [1, 0]) * control.tf([1.00217], [0.037, 1]), 1)
    expected = control.step_info(loop)["Overshoot"]
    assert float(row.split()[4].rstrip("%")) == pytest.approx(expected, abs=0.1)


def test_an_algebraic_loop_is_solved_and_counted(tmp_path: Path) -> None:
    """A loop of a sum and a gain, inside a subsystem: two thirds of the step."""
    inner = block("Inport", "u", 1) + block("Sum", "Error", 2, Inputs="+-")
    inner += block("Gain", "K", 3, Gain="2") + block("Outport", "y", 4)
    inner += line("1#out:1", "2#in:1") + line("2#out:1", "3#in:1")
    inner += line("3#out:1", "2#in:2", "4#in:1")
    root = block("Step", "r", 1) + block("SubSystem", "Loop", 2, f"<System>{inner}</System>")
    root += block("Scope", "S", 3) + line("1#out:1", "2#in:1") + line("2#out:1", "3#in:1")
    done = invoke(single_file(tmp_path / "m.slx", root), "--stop", 2, "--json")
    assert done.exit_code == ExitCode.OK
    answer = json.loads(done.stdout)
    assert answer["algebraic_loops"] == 1
    assert answer["signals"][0]["values"][-1] == pytest.approx(2 / 3)


def test_unsupported_blocks_are_named_by_path(tmp_path: Path) -> None:
    """One of another kind, one of a toolbox, a delay without a sample time."""
    root = block("Step", "r", 1) + block("MATLABSystem", "M", 2) + block("ForIterator", "T", 3)
    root += block("UnitDelay", "D", 4) + block("Scope", "S", 5)
    root += line("1#out:1", "2#in:1", "3#in:1", "4#in:1") + line("4#out:1", "5#in:1")
    done = invoke(single_file(tmp_path / "m.slx", root), "--stop", 2)
    assert done.exit_code == ExitCode.DESIGN_FAILED
    assert "3 of 5 blocks cannot be simulated" in done.output
    assert "M (MATLABSystem): it stands for something outside the model" in done.output
    assert "T (ForIterator): this type of block is not supported" in done.output
    assert "D (UnitDelay): a discrete block whose sample time is inherited" in done.output


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (("--stop", "0"), "--stop must be > 0 s"),
        (("--out", "x.gif"), "expected a file that ends with .svg, .png, .pdf"),
        (("--set", "Kp"), "--set Kp: give a name and a number"),
        (("--sample-time", "-1"), "--sample-time must be > 0 s"),
    ],
)
def test_wrong_options_are_named(options: tuple[str, ...], sentence: str) -> None:
    """One sentence, exit code of the command line."""
    done = invoke(FIGURE_4, *options)
    assert done.exit_code == ExitCode.USAGE
    assert sentence in done.output


def test_an_unknown_inport_is_named() -> None:
    """With those that there are."""
    done = invoke(FIGURE_4.with_name("figure5.slx"), "--input", "speed=1")
    assert done.exit_code == ExitCode.DESIGN_FAILED
    assert "there is no inport 'speed'; there are: input_voltage, real_voltage" in done.output
