# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick import` as people and scripts call it."""

from __future__ import annotations

import json
from pathlib import Path

from typer.testing import CliRunner
from verification.support.codegen.simulink_files import block, line, single_file, whole_model

from ravenbrick.cli.app import app
from ravenbrick.errors import ExitCode


def invoke(*arguments: object):  # type: ignore[no-untyped-def]
    """Run the command with --json."""
    return CliRunner().invoke(app, ["import", *map(str, arguments), "--json"])


def test_a_model_becomes_c(tmp_path: Path) -> None:
    """Files are named in the answer and lie where they should."""
    model = whole_model(tmp_path / "pi.slx")
    settings = ("--set", "Kp_value=0.5", "--set", "Ki=2")
    done = invoke(model, "--sample-time", 0.01, *settings, "--output", tmp_path / "out")
    assert done.exit_code == ExitCode.OK, done.output
    answer = json.loads(done.output)
    assert {row["name"] for row in answer["blocks"]} >= {"Kp", "I", "Lim_it"}
    assert (tmp_path / "out" / "pi.c").is_file()


def test_what_cannot_be_imported_is_listed_and_nothing_is_written(tmp_path: Path) -> None:
    """Exit code of a failed design; the block by its path."""
    root = block("Inport", "u", 1) + block("DataStoreRead", "M", 2) + line("1#out:1", "2#in:1")
    model = single_file(tmp_path / "m.slx", root)
    done = invoke(model, "--sample-time", 0.01, "--output", tmp_path / "out")
    assert done.exit_code == ExitCode.DESIGN_FAILED
    detail = json.loads(done.output)["detail"]
    assert "M (DataStoreRead): this type of block is not supported" in detail
    assert not (tmp_path / "out").exists()


def test_wrong_arguments_are_named(tmp_path: Path) -> None:
    """No file, no number."""
    done = invoke(tmp_path / "none.slx", "--sample-time", 0.01, "--output", tmp_path)
    assert done.exit_code == ExitCode.USAGE
    model = whole_model(tmp_path / "pi.slx")
    done = invoke(model, "--sample-time", 0.01, "--set", "Kp", "--output", tmp_path)
    assert "--set Kp: give a name and a number" in done.output


def test_generated_c_leads_to_bind(tmp_path: Path) -> None:
    """The folder, or a file of it."""
    header = tmp_path / "functional_ert_rtw" / "functional.h"
    header.parent.mkdir()
    header.write_text("")
    for model in (header, header.parent):
        done = invoke(model, "--sample-time", 0.01, "--output", tmp_path / "out")
        assert done.exit_code == ExitCode.USAGE
        assert f"'ravenbrick bind {header.parent} binding.toml'" in done.output
