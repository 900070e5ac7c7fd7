# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Style and borders as a test: `python -m tools.style.tidy` prints what is wrong and where.

Each rule is one function from the tracked files to complaints. ARCHITECTURE.md names the rule
that enforces each invariant.
"""

from __future__ import annotations

import ast
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from tools.style.borders import border_complaints
from tools.style.constants import second_copies

ROOT = Path(__file__).resolve().parents[2]
WORDS = Path(__file__).resolve().with_name("words.toml")
FILE_LINES = 500
FUNCTION_LINES = 70
COLUMNS = 100
BLOB_BYTES = 2_500_000
SOURCE = {".rs", ".py", ".pyi", ".ads", ".adb", ".gpr", ".cgpr", ".S", ".s", ".ld", ".c", ".h"}
SOURCE |= {".sh", ".mk", ".ts", ".js", ".css"}
COLUMN_FREE = {".md", ".json", ".toml", ".lock"}
Complaint = tuple[Path, int, str]


def tracked_files() -> list[Path]:
    """Files git knows, as they are in the working tree."""
    command = ["git", "-C", str(ROOT), "ls-files", "-z", "--cached", "--others"]
    output = subprocess.run(
        [*command, "--exclude-standard"], capture_output=True, check=True, text=True
    ).stdout
    return [ROOT / name for name in output.split("\0") if name and (ROOT / name).is_file()]


def is_source(path: Path) -> bool:
    """Hand-written source: generated C is checked by regeneration instead."""
    script = path.suffix == "" and path.read_bytes()[:2] == b"#!"
    named = path.name in {"Makefile"}
    return (path.suffix in SOURCE or script or named) and "generated" not in path.parts


def header(path: Path, lines: list[str]) -> Iterator[Complaint]:
    """Two SPDX lines at the head of each source file."""
    head = "\n".join(lines[:4])
    for line in ("SPDX-FileCopyrightText: 2026 Ravenbrick", "SPDX-License-Identifier: Apache-2.0"):
        if line not in head:
            yield path, 1, f"the head lacks '{line}'"


def lengths(path: Path, lines: list[str]) -> Iterator[Complaint]:
    """Limits of lines and columns."""
    count = len(lines) - (lines[-1] == "")
    if count > FILE_LINES:
        yield path, count, f"{count} lines; at most {FILE_LINES}"
    for number, line in enumerate(lines, 1):
        if len(line) > COLUMNS and "://" not in line:
            yield path, number, f"{len(line)} columns; at most {COLUMNS}"
        if line.rstrip("\r\n") != line.rstrip():
            yield path, number, "blanks at the end of the line"


@cache
def words(table: str) -> dict[re.Pattern[str], str]:
    """Patterns of a table of words.toml, and what to write instead."""
    content = tomllib.loads(WORDS.read_text())[table]
    return {re.compile(pattern, re.IGNORECASE): say for pattern, say in content.items()}


def banned_words(path: Path, lines: list[str]) -> Iterator[Complaint]:
    """Words and names of words.toml."""
    if path in (WORDS, ROOT / "CHANGELOG.md"):
        return
    tables = ["everywhere"] + ["markdown"] * (path.suffix == ".md")
    patterns = {p: say for table in tables for p, say in words(table).items()}
    for number, line in enumerate(lines, 1):
        for pattern, instead in patterns.items():
            if found := pattern.search(line):
                yield path, number, f"'{found.group().strip()}': write '{instead}'"


def python_functions(path: Path, lines: list[str]) -> Iterator[Complaint]:
    """Length of Python functions, from the first statement: lists of options do not count."""
    if path.suffix != ".py":
        return
    for node in ast.walk(ast.parse("\n".join(lines))):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            length = (node.end_lineno or node.lineno) - node.body[0].lineno + 1
            if length > FUNCTION_LINES:
                yield path, node.lineno, f"{node.name}: {length} lines; at most {FUNCTION_LINES}"


def _indented_functions(
    path: Path, lines: list[str], start: str, ends: tuple[str, ...]
) -> Iterator[Complaint]:
    opened: list[tuple[str, int]] = []
    for number, line in enumerate(lines, 1):
        match = re.match(start, line)
        if match and not line.rstrip().endswith(";"):
            opened.append((match.group(1), number))
        elif opened and any(line.startswith(opened[-1][0] + end) for end in ends):
            _, first = opened.pop()
            if number - first + 1 > FUNCTION_LINES:
                yield path, first, f"{number - first + 1} lines; at most {FUNCTION_LINES}"


def rust_functions(path: Path, lines: list[str]) -> Iterator[Complaint]:
    """Length of Rust functions, by rustfmt's indentation."""
    if path.suffix == ".rs":
        yield from _indented_functions(
            path, lines, r"( *)(?:pub(?:\([a-z]+\))? )?(?:const )?fn ", ("}",)
        )


def rust_tests_are_run(path: Path, _: list[str]) -> Iterator[Complaint]:
    """A file of tests is a module of the program `main.rs` beside it, or named in Cargo.toml."""
    program = path.with_name("main.rs")
    if path.suffix == ".rs" and path.parent.name == "tests" and program.is_file():
        text = program.read_text() + (path.parents[1] / "Cargo.toml").read_text()
        ways = {f"mod {path.stem};", f'name = "{path.stem}"'}
        if path != program and not ways & set(text.split("\n")):
            yield path, 1, "never run: neither main.rs beside it nor Cargo.toml names it"


def machine_code(path: Path, lines: list[str]) -> Iterator[Complaint]:
    """Machine code insertions and assembly only in runtime/arm7tdmi (and start-up)."""
    relative = path.relative_to(ROOT)
    if path.suffix in {".ads", ".adb"} and relative.parts[:2] != ("runtime", "arm7tdmi"):
        for number, line in enumerate(lines, 1):
            if "Machine_Code" in line:
                yield path, number, "machine code belongs in runtime/arm7tdmi"
    if path.suffix in {".S", ".s"} and relative.parts[0] not in {"runtime", "verification"}:
        yield path, 1, "assembly belongs in runtime/arm7tdmi"


def run_time_knows_no_driver(path: Path, lines: list[str]) -> Iterator[Complaint]:
    """Invariant 2: nothing in runtime/ names a package of drivers/."""
    if path.relative_to(ROOT).parts[0] == "runtime" and path.suffix in {".ads", ".adb"}:
        for number, line in enumerate(lines, 1):
            if re.match(r"\s*with NXT\b", line):
                yield path, number, "the run-time knows nothing of the drivers"


def named_paths() -> Iterator[Complaint]:
    """Files and folders that the guides through the tree name exist."""
    tops = {path.relative_to(ROOT).parts[0] for path in tracked_files()}
    for name in ("ARCHITECTURE.md", "CONTRIBUTING.md", "README.md"):
        for number, line in enumerate((ROOT / name).read_text().split("\n"), 1):
            for path in re.findall(r"`([\w.-]+/[\w./-]*)`", line):
                built = path.startswith(("build/", "out/", "docs/_build"))
                if path.split("/")[0] in tops and not built and not (ROOT / path).exists():
                    yield ROOT / name, number, f"there is no {path}"


def newest_release() -> Iterator[Complaint]:
    """The version is that of the changelog's newest release."""
    changelog, init = ROOT / "CHANGELOG.md", ROOT / "host" / "src" / "ravenbrick" / "__init__.py"
    version = re.findall(r'^__version__ = "(.+)"', init.read_text(), re.MULTILINE)
    releases = re.findall(r"^## (\d\S*)", changelog.read_text(), re.MULTILINE)
    if releases[:1] != version:
        yield changelog, 1, f"the newest release is not the version, {version[0]}"


SOUNDNESS = Path("docs") / "internals" / "timing-soundness.md"
TEST_FOLDERS = ("virtual-brick/crates/wcet", "host/tests")


def named_tests(root: Path) -> Iterator[Complaint]:
    """Each rule of the soundness argument names a test, and each named test exists."""
    page = root / SOUNDNESS
    text, _, _ = page.read_text().partition("## Assumptions")
    for number, line in enumerate(text.split("\n"), 1):
        names = re.findall(r"`([\w./]+)::(\w+)`", line)
        if line.startswith("| ") and not line.startswith("| Rule |") and not names:
            yield page, number, "this rule names no test; write `file::test`"
        for file, test in names:
            sources = [root / folder / file for folder in TEST_FOLDERS]
            found = [path.read_text() for path in sources if path.exists()]
            if not any(re.search(rf"^\s*(fn|def) {test}\(", each, re.MULTILINE) for each in found):
                yield page, number, f"there is no test {file}::{test}"


UNSAFE = ROOT / "virtual-brick" / "crates" / "jit" / "src" / "code_memory.rs"


def no_unsafe(path: Path, lines: list[str]) -> Iterator[Complaint]:
    """Invariant 9: no `unsafe` in the workspace but in the file that calls JIT code."""
    if path.suffix == ".rs" and path != UNSAFE:
        for number, line in enumerate(lines, 1):
            if re.search(r"\bunsafe (?:fn|impl|\{)", line):
                yield path, number, "unsafe code"


def blobs(path: Path) -> Iterator[Complaint]:
    """No large file by accident."""
    size = path.stat().st_size
    if size > BLOB_BYTES:
        yield path, 1, f"{size} bytes; at most {BLOB_BYTES}"


LINE_RULES = (
    header,
    lengths,
    python_functions,
    rust_functions,
    rust_tests_are_run,
    machine_code,
    run_time_knows_no_driver,
    no_unsafe,
)


def complaints() -> Iterator[Complaint]:
    """All complaints, in the order of the files."""
    yield from border_complaints(ROOT)
    yield from newest_release()
    yield from named_paths()
    yield from named_tests(ROOT)
    for path in sorted(tracked_files()):
        yield from blobs(path)
        if path.suffix in SOURCE | COLUMN_FREE or is_source(path):
            yield from banned_words(path, path.read_text().split("\n"))
        if is_source(path) or path.suffix == ".toml":
            yield from second_copies(path, path.read_text().split("\n"))
        if is_source(path):
            lines = path.read_text().split("\n")
            for rule in LINE_RULES:
                yield from rule(path, lines)


def main() -> int:
    """Print the complaints; 1 when there is one."""
    found = list(complaints())
    for path, line, text in found:
        print(f"{path.relative_to(ROOT)}:{line}: {text}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
