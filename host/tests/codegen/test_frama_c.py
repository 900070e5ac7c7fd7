# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Frama-C on the fixed-point C: Eva for all inputs and any number of steps, WP for one step."""

from __future__ import annotations

import shutil

import pytest
from host.tests.codegen.paper_pi import fixed_pi, plant

from ravenbrick.codegen import check_with_frama_c, frama_c_goals, generate_fixed_c
from ravenbrick.errors import DesignError, ToolMissingError
from ravenbrick.model import Rounding

MISSING = [tool for tool in ("frama-c", "why3", "z3") if shutil.which(tool) is None]
INSTALLED = pytest.mark.skipif(
    bool(MISSING),
    reason=f"{', '.join(MISSING)} not installed (Debian: frama-c-base why3 z3)",
)


@INSTALLED
@pytest.mark.parametrize("tunable", [True, False], ids=["tunable", "constant gains"])
def test_the_paper_s_controller_raises_no_alarm_and_all_goals_are_proved(tunable: bool) -> None:
    """No overflow, no invalid access, the state stays in its range, nothing else is written."""
    code = generate_fixed_c(fixed_pi(Rounding.ZERO), plant(), only_used=True, tunable=tunable)
    result = check_with_frama_c(code.files, "functional")
    assert result.alarms == 0
    assert result.proved == result.goals > 30


@INSTALLED
def test_an_overflow_is_found() -> None:
    """By both: four times the gain does not fit."""
    files = dict(generate_fixed_c(fixed_pi(Rounding.ZERO), plant(), only_used=True).files)
    text = files["functional.c"]
    assert "functional_P.Kp * Error" in text
    files["functional.c"] = text.replace("functional_P.Kp * Error", "functional_P.Kp * Error * 4")
    result = check_with_frama_c(files, "functional")
    assert result.alarms > 0
    assert result.proved < result.goals


def test_the_goals_state_what_was_proved() -> None:
    """Ranges of state and output, and the values of the gains."""
    text = frama_c_goals(fixed_pi(Rounding.ZERO))
    assert "requires -603979776 <= work->Integral_DSTATE <= 603979776;" in text
    assert "ensures -18432 <= y->correctedvoltage <= 18432;" in text
    assert "requires functional_P.Kp == 11832;" in text
    assert "functional_P" not in frama_c_goals(fixed_pi(), tunable=False)


def test_what_is_missing_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    """With the packages to install."""
    monkeypatch.setenv("PATH", "")
    with pytest.raises(ToolMissingError, match="apt-get install frama-c-base why3 z3"):
        check_with_frama_c({}, "functional")


@INSTALLED
def test_c_that_frama_c_cannot_read_is_an_error() -> None:
    """In its own words."""
    with pytest.raises(DesignError, match="failed on the generated C"):
        check_with_frama_c({"functional_goals.h": "int main(void) {"}, "functional")
