# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The tables of suites: entries are checked, and name what exists."""

from __future__ import annotations

from pathlib import Path

import pytest

from verification.commands import function_of
from verification.support.paths import ROOT
from verification.table import BENCHMARKS, SUITES, TableError, chosen, read_suites

ENTRY = """[[suite]]
area = "cpu"
name = "one"
truth = "outside"
compared_with = "vectors"
call = "module:function"
minutes = 1
"""


@pytest.mark.parametrize("table", [SUITES, BENCHMARKS])
def test_every_command_names_what_exists(table: Path) -> None:
    """Functions, test files and crates."""
    for suite in read_suites(table):
        if suite.kind == "call":
            assert callable(function_of(str(suite.command)))
        elif suite.kind == "pytest":
            paths = [word.partition("::")[0] for word in suite.command if word[0] != "-"]
            assert all((ROOT / path).exists() for path in paths), suite.name
        else:
            assert (ROOT / "virtual-brick" / "crates" / str(suite.command).split()[0]).is_dir()


@pytest.mark.parametrize(
    ("old", "new", "cause"),
    [
        ('truth = "outside"', 'truth = "inside"', "'one': truth = 'inside': 'outside' or 'own'"),
        ("minutes = 1", 'minutes = 1\npytest = ["tools"]', "'one': one of pytest, cargo_test"),
        ("minutes = 1", "minutes = 1\nlasts = 2", "'one'.*lasts"),
        ("minutes = 1\n", f"minutes = 1\n{ENTRY}", "'one' stands twice"),
    ],
)
def test_a_wrong_entry_is_refused_by_its_name(
    tmp_path: Path, old: str, new: str, cause: str
) -> None:
    """The message names file, entry and cause."""
    table = tmp_path / "suites.toml"
    table.write_text(ENTRY.replace(old, new))
    with pytest.raises(TableError, match=f"suites.toml: {cause}"):
        read_suites(table)


def test_a_missing_file_or_variable_is_told_with_what_to_do(tmp_path: Path) -> None:
    """The suite is not run; it keeps its last result."""
    table = tmp_path / "suites.toml"
    needs = '[{ file = "/no/such", install = "install the Debian package nbc" }]'
    table.write_text(f"{ENTRY}needs = {needs}\n")
    (suite,) = read_suites(table)
    assert suite.missing() == "/no/such is absent: install the Debian package nbc"


def test_suites_are_chosen_by_area_and_by_a_part_of_the_name() -> None:
    """A word that matches none is refused with the areas."""
    suites = read_suites(SUITES)
    assert {suite.area for suite in chosen(suites, ["plant"])} == {"plant"}
    assert [suite.name for suite in chosen(suites, ["TEXTBOOK"])] == ["published textbook cases"]
    assert chosen(suites, []) == suites
    with pytest.raises(TableError, match=r"--only weather: .*the areas are cpu, "):
        chosen(suites, ["weather"])
