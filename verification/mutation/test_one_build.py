# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from verification.mutation import campaign
from verification.mutation.campaign import judged
from verification.mutation.mutants import mutants_of
from verification.mutation.one_build import CHOICE, VARIABLE, combined, one_build, refused_in
from verification.mutation.rooms import Room

SOURCE = """const LIMIT: u32 = 4;

fn below(value: u32) -> bool {
    let text = "} fn {";
    value + 1 < LIMIT && !text.is_empty()
}

const fn more(value: u32) -> u32 {
    value + 2
}

const fn fixed() -> [u32; 1 + 1] {
    [more(0), 8]
}

fn main() {
    print!("{} {} {:?}", below(2), more(5), fixed());
}
"""


def test_a_function_holds_its_mutants_and_what_is_fixed_stays() -> None:
    """By hand: constants and types choose nothing; lines of errors tell the mutant."""
    numbered = dict(enumerate(mutants_of("a.rs", SOURCE), 1))
    made = combined("a.rs", SOURCE, numbered)
    inside = {n: m.line for n, m in numbered.items() if m.line in (5, 9, 13, 17)}
    assert set(made.lines) == set(inside)
    assert "\nfn more(" in made.text and "\nfn fixed() -> [u32; 1 + 1] {" in made.text
    lines = made.text.splitlines()
    for number, (first, last) in made.lines.items():
        held = "\n".join(lines[first - 1 : last])
        assert numbered[number].key.split(" => ")[1] in held
    assert lines[0] == "const LIMIT: u32 = 4;"
    number, (first, last) = next(iter(made.lines.items()))
    report = "{}[E1]: what\n  --> crates/a.rs:{}:7\n"
    files = {"virtual-brick/crates/a.rs": made}
    assert refused_in(report.format("error", first + 1), files) == {number}
    assert refused_in(report.format("warning", first + 1), files) == set()
    assert refused_in(report.format("error", 1), files) == set()
    called = "error[E0015]: cannot call non-const method `A::<u8>::more::<B<u8>>` in constants\n"
    assert {inside[n] for n in refused_in(called, files)} == {9}


@pytest.mark.skipif(shutil.which("rustc") is None, reason="needs rustc")
def test_a_chosen_mutant_does_as_the_one_that_is_built_by_itself(tmp_path: Path) -> None:
    """The Rust compiler takes both, and their programs print the same."""

    def built(name: str, text: str) -> Path:
        (tmp_path / f"{name}.rs").write_text(text)
        command = ["rustc", "--edition=2021", "-Awarnings", f"{name}.rs"]
        subprocess.run(command, cwd=tmp_path, check=True)
        return tmp_path / name

    def printed(program: Path, number: int = 0) -> str:
        environment = {**os.environ, VARIABLE: str(number)}
        run = subprocess.run([program], env=environment, check=True, capture_output=True)
        return run.stdout.decode()

    numbered = dict(enumerate((m for m in mutants_of("a.rs", SOURCE) if m.line in (5, 13)), 1))
    together = built("together", combined("a.rs", SOURCE, numbered).text + CHOICE)
    assert printed(together) == "true 7 [2, 8]" and len(numbered) > 3
    for number, mutant in numbered.items():
        alone = built("alone", mutant.applied(SOURCE))
        assert printed(together, number) == printed(alone), mutant.key


class Crate:
    """In place of a scratch copy: the compiler refuses `<<`, a test notices what `-` changes."""

    def __init__(self, tree: Path) -> None:
        self.tree, self.folder, self.log, self.builds = tree, tree, tree / "log", 0

    def said(self) -> str:
        """Of the last run."""
        return ""

    def __enter__(self) -> Crate:
        return self

    def __exit__(self, *_error: object) -> None:
        pass

    def run(self, command: str, _limit_s: float) -> tuple[bool, float]:
        """A build, or a test of what is chosen."""
        lines = (self.tree / "src" / "lib.rs").read_text().splitlines()
        bad = [number for number, line in enumerate(lines, 1) if "<<" in line]
        self.log.write_text("".join(f"error: no\n --> src/lib.rs:{n}:1\n" for n in bad))
        if command == "build":
            self.builds += 1
            return not bad, 1.0
        self.log.write_text("1 passed\n")
        chosen = command.partition("=")[2].partition(";")[0]
        text = "\n".join(lines)
        body = text.partition(f"chosen_mutant({chosen})")[2] or text.rpartition(" else ")[2]
        return " - " not in body.partition("}")[0], 1.0


def test_refused_mutants_leave_the_build_and_the_files_are_as_before(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One build more for those that are refused, then one for each that is left out."""
    source = "fn f(a: u32) -> u32 {\n    a >> 3 + 4\n}\n"
    (tmp_path / "src").mkdir()
    (tmp_path / "src" / "lib.rs").write_text(source)
    room = Room("made", "src", "src", "build", "test", one_build=True)
    mutants, scratch = room.mutants(tmp_path), Crate(tmp_path)
    given: Any = scratch
    with one_build(room, given, mutants, 1) as tests:
        assert {m.text for m in mutants} - {m.text for m in tests} == {"<<"}
        assert scratch.builds == 2
    assert (tmp_path / "src" / "lib.rs").read_text() == source
    monkeypatch.setattr(campaign, "ROOT", tmp_path)
    monkeypatch.setattr(campaign, "OUTCOMES", tmp_path / "outcomes")
    monkeypatch.setattr(campaign, "Scratch", lambda _name: scratch)
    outcomes = {m.text: outcome for m, outcome in judged(room, 60, 1, float("inf"))}
    assert outcomes == {"-": "killed", "4": "survived", "5": "survived"}
