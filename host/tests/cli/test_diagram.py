# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick diagram` as people and scripts call it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from ravenbrick.cli.app import app
from ravenbrick.codegen.diagram_page import ada_lines_of_blocks, diagram_page, lines_of_blocks
from ravenbrick.errors import ExitCode
from ravenbrick.model import CustomFunction, Diagram, Inport, Outport

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"
DESIGN = f"{EXAMPLES / 'vehicle' / 'design.py'}:design"


def invoke(*arguments: object) -> Any:
    """Run the command."""
    return CliRunner().invoke(app, ["diagram", *map(str, arguments)])


def test_a_design_becomes_picture_page_and_text(tmp_path: Path) -> None:
    """The text, read again, gives the same picture."""
    files = [tmp_path / f"d.{suffix}" for suffix in ("svg", "html", "toml")]
    done = invoke(DESIGN, *(f"--out={path}" for path in files), "--json")
    assert done.exit_code == ExitCode.OK, done.output
    assert json.loads(done.output)["blocks"] == 12
    again = tmp_path / "again.svg"
    assert invoke(files[2], "--out", again).exit_code == ExitCode.OK
    assert again.read_text() == files[0].read_text()
    page = files[1].read_text()
    assert '<span data-blocks="Cut_Off">  Cut_Off = Saturated - Demand;</span>' in page
    ada = '<span data-blocks="Cut_Off">      Cut_Off := Saturated - Demand;</span>'
    assert ada in page.partition("<h2>Ada</h2>")[2]
    assert '<g class="block" data-blocks="Cut_Off"' in page


def test_lines_of_c_belong_to_the_block_of_the_comment_above() -> None:
    """Until the next one, or the end of the function."""
    source = "{\n  /* Gain: '<Root>/A' */\n  A = 2.0F * u;\n\n  /* Sum: '<Root>/B' */\n  B = A;\n}"
    assert lines_of_blocks(source) == ["", "A", "A", "", "B", "B", ""]


def test_lines_of_ada_belong_to_the_block_of_the_comment_above() -> None:
    """A component of a record, too, whose comment follows; until the end of the procedure."""
    source = (
        "--  Input digest: 12\n   type Work_Area is record\n      Z_DSTATE : Float;\n"
        "      --  of Z\n   end record;\n   begin\n      --  Unit delay: Z\n"
        "      Z := Work.Z_DSTATE;\n\n      --  Sum: Error\n      Error := U - Z;\n   end Step;"
    )
    blocks = ["", "", "Z", "Z", "", "", "Z", "Z", "", "Error", "Error", ""]
    assert ada_lines_of_blocks(source) == blocks


def test_a_page_says_why_there_is_no_ada() -> None:
    """A function that is given in C only: the C is there all the same."""
    diagram = Diagram("cube", 0.004)
    cube = CustomFunction("Cube", function=lambda x: x * x * x, c="return x * x * x;")
    diagram.connect_chain(diagram.add(Inport("In")), diagram.add(cube), diagram.add(Outport("out")))
    c, _, ada = diagram_page(diagram).partition("<h2>Ada</h2>")
    assert 'data-blocks="Cube"' in c
    assert "<p>" in ada and "Cube" in ada and "data-blocks" not in ada.partition("</section>")[0]


def test_a_simulink_model_is_drawn(tmp_path: Path) -> None:
    """With the names of its blocks."""
    picture = tmp_path / "figure.svg"
    done = invoke(EXAMPLES / "paper" / "models" / "figure4.slx", "--out", picture)
    assert done.exit_code == ExitCode.OK, done.output
    assert "PI_Controller" in picture.read_text()


@pytest.mark.parametrize(
    ("source", "out", "sentence"),
    [
        ("missing.toml", "d.svg", "missing.toml: there is no such file"),
        (DESIGN, "d.png", "expected a file that ends with .svg, .html, .toml"),
        (
            DESIGN.replace(":design", ":other"),
            "d.svg",
            "design.py has no 'other'; expected FILE.py",
        ),
        (DESIGN.replace(":design", ":PROJECT"), "d.svg", "is no diagram, but PosixPath"),
    ],
)
def test_wrong_sources_are_explained(source: str, out: str, sentence: str, tmp_path: Path) -> None:
    """In one sentence."""
    done = invoke(source, "--out", tmp_path / out)
    assert done.exit_code != ExitCode.OK
    assert sentence in " ".join(done.output.split())
