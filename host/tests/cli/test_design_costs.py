# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick design --costs` and `--plots`: what a choice costs, and pictures of other loops."""

from __future__ import annotations

from pathlib import Path

import pytest

from ravenbrick.cli.costs import project_costs
from ravenbrick.errors import DesignError

SCRIPT = """\
from ravenbrick.codegen import NumberChoice
from ravenbrick.model import (Diagram, FixedPointOptions, Gain, Inport, Outport, UnitDelay)

def number_choice():
    diagram = Diagram("functional", 0.004)
    blocks = (Inport("In"), Gain("Half", gain=0.5), UnitDelay("Last"), Outport("Out"))
    diagram.connect_chain(*(diagram.add(block) for block in blocks))
    return NumberChoice(diagram, FixedPointOptions({"In": 8.0}))
"""


def test_fixed_point_stands_beside_single_precision(tmp_path: Path) -> None:
    """Cycles, bytes, share of the period; fixed point takes fewer and always the same."""
    (tmp_path / "design.py").write_text(SCRIPT)
    single, tunable, constant = project_costs(tmp_path)
    assert single["form"].startswith("single precision")
    assert constant["most_cycles"] <= tunable["most_cycles"] < single["most_cycles"]
    assert 0 < single["share"] < 0.001
    assert constant["error_bound"] is None


@pytest.mark.parametrize(
    ("script", "message"),
    [
        ("x = 1\n", "neither design() that returns"),
        ("raise RuntimeError('no motor')\n", "no motor"),
        (SCRIPT.replace("gain=0.5", "gain=0.5").replace('"In": 8.0', '"Out": 8.0'), "'Out'"),
    ],
)
def test_what_stands_in_the_way_is_said(script: str, message: str, tmp_path: Path) -> None:
    """The script's own words, or what is missing in it."""
    (tmp_path / "design.py").write_text(script)
    with pytest.raises(DesignError, match=message.replace("(", r"\(").replace(")", r"\)")):
        project_costs(tmp_path)
