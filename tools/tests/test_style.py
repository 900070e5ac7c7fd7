# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Borders and words: what crosses them is named with its file and line."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from tools.style import tidy
from tools.style.borders import border_complaints
from tools.style.constants import second_copies
from tools.style.tidy import ROOT, SOUNDNESS, banned_words, named_tests, rust_tests_are_run

BORDERS = """
[crates]
core = []
board = ["core"]
[bindings]
[rooms]
model = []
brick = ["model"]
"""


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A tree without complaints: two crates and two rooms."""
    (tmp_path / "tools" / "style").mkdir(parents=True)
    (tmp_path / "tools" / "style" / "borders.toml").write_text(BORDERS)
    for crate, known in (("core", ""), ("board", "core = {}")):
        folder = tmp_path / "virtual-brick" / "crates" / crate
        folder.mkdir(parents=True)
        (folder / "Cargo.toml").write_text(f"[dependencies]\n{known}\n")
    for room in ("model", "brick"):
        folder = tmp_path / "host" / "src" / "ravenbrick" / room
        folder.mkdir(parents=True)
        (folder / "__init__.py").write_text("")
    return tmp_path


def test_a_crate_that_knows_a_later_one_is_refused(tree: Path) -> None:
    assert list(border_complaints(tree)) == []
    manifest = tree / "virtual-brick" / "crates" / "core" / "Cargo.toml"
    manifest.write_text("[target.unix.dependencies]\nboard = {}\n")
    assert list(border_complaints(tree)) == [(manifest, 1, "the crate core must not know board")]


@pytest.mark.parametrize(
    "text", ["import ravenbrick.brick.run", "def f():\n    from ravenbrick import brick"]
)
def test_a_room_that_imports_a_later_one_is_refused(tree: Path, text: str) -> None:
    path = tree / "host" / "src" / "ravenbrick" / "model" / "motor.py"
    path.write_text(text)
    line = len(text.split("\n"))
    assert list(border_complaints(tree)) == [(path, line, "the room model must not know brick")]


def test_a_border_that_makes_a_circle_is_refused(tree: Path) -> None:
    file = tree / "tools" / "style" / "borders.toml"
    file.write_text(BORDERS.replace("model = []", 'model = ["brick"]'))
    assert list(border_complaints(tree)) == [
        (file, 1, "[rooms] model: 'brick' is not an earlier part")
    ]


def test_files_of_a_crate_that_know_each_other_say_why(tree: Path) -> None:
    source = tree / "virtual-brick" / "crates" / "core" / "src"
    part = source / "inner" / "part.rs"
    part.parent.mkdir(parents=True)
    (source / "whole.rs").write_text(
        "use crate::{\n    error::Error,\n    inner::{part::Part},\n};\n"
    )
    part.write_text("#[cfg(test)]\nuse super::super::whole::Whole;\n")
    assert list(border_complaints(tree)) == []
    user = "fn used() -> crate::whole::Whole {}\n"
    part.write_text(f"#[cfg(test)]\nmod tests;\n{user}")
    ((_, _, complaint),) = border_complaints(tree)
    assert "inner/part.rs → whole.rs" in complaint
    part.write_text(f"// A whole keeps what is found here, so each knows the other.\n{user}")
    assert list(border_complaints(tree)) == []


def test_a_banned_word_is_refused_with_what_to_write_instead() -> None:
    path, word = ROOT / "README.md", "Set".ljust(4) + "Point"
    assert list(banned_words(path, [f"the {word} is reached"])) == [
        (path, 1, f"'{word}': write 'set-point'")
    ]
    assert list(banned_words(path, ["the set-point is reached"])) == []


def test_a_guide_that_names_a_missing_folder_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    subprocess.run(["git", "init", "--quiet", tmp_path], check=True)
    for name in ("ARCHITECTURE.md", "CONTRIBUTING.md", "README.md"):
        (tmp_path / name).write_text("`host/src` and `host/<room>`, `build/x`\n")
    (tmp_path / "host" / "src").mkdir(parents=True)
    (tmp_path / "host" / "src" / "a.py").touch()
    monkeypatch.setattr(tidy, "ROOT", tmp_path)
    assert list(tidy.named_paths()) == []
    guide = tmp_path / "README.md"
    guide.write_text("first\n`host/gone/`\n")
    assert list(tidy.named_paths()) == [(guide, 2, "there is no host/gone/")]


def test_a_file_of_rust_tests_that_is_never_run_is_refused(tmp_path: Path) -> None:
    """Named in main.rs, or a program of its own."""
    folder = tmp_path / "tests"
    folder.mkdir()
    lost = folder / "lost.rs"
    assert list(rust_tests_are_run(lost, [""])) == []
    (tmp_path / "Cargo.toml").write_text('[[test]]\nname = "alone"\n')
    (folder / "main.rs").write_text("mod found;\n")
    for name in ("found", "alone", "main"):
        assert list(rust_tests_are_run(folder / f"{name}.rs", [""])) == []
    ((path, _, text),) = rust_tests_are_run(lost, [""])
    assert path == lost
    assert "never run" in text


@pytest.mark.parametrize(
    ("message", "code"),
    [
        ("Short subject\n\nA reason.\n", 0),
        (f"{'x' * 73}\n\nA reason.\n", 1),
        ("Short subject\n", 1),
        ("Short subject\nno empty line\n", 1),
        ("Short subject\n\nA reason.\n# comment\n", 0),
    ],
)
def test_commit_messages_have_a_short_subject_and_a_body(
    tmp_path: Path, message: str, code: int
) -> None:
    file = tmp_path / "message"
    file.write_text(message)
    program = ROOT / "tools" / "style" / "commit_message"
    assert subprocess.run([program, file], capture_output=True).returncode == code


@pytest.mark.parametrize(
    ("line", "refused"),
    [
        ("resistance = 6.8562", True),
        ("k = 317.39e-3", True),
        ("inertia: 0.0010368,", True),
        ("cycles = 68562", False),
        ("x = 16.8562", False),
        ("gain = 0.317", False),
    ],
)
def test_a_constant_of_the_catalogue_is_refused_elsewhere(line: str, refused: bool) -> None:
    """In whatever unit it is written; whole numbers and short ones are met by chance."""
    assert bool(list(second_copies(Path("robot.toml"), ["", line]))) == refused


def test_a_rule_of_the_soundness_argument_without_an_existing_test_is_refused(
    tmp_path: Path,
) -> None:
    page = tmp_path / SOUNDNESS
    page.parent.mkdir(parents=True)
    tests = tmp_path / "host" / "tests" / "timing" / "test_a.py"
    tests.parent.mkdir(parents=True)
    tests.write_text("def test_of_it() -> None: ...\n")
    rows = ["| Rule |", "|---|", "| it `timing/test_a.py::test_of_it` |", "| none |"]
    page.write_text("\n".join([*rows, "| other `timing/test_a.py::test_gone` |"]))
    found = [(line, text) for _, line, text in named_tests(tmp_path)]
    assert found == [
        (4, "this rule names no test; write `file::test`"),
        (5, "there is no test timing/test_a.py::test_gone"),
    ]
