# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0

from __future__ import annotations

from pathlib import Path

import pytest

from ravenbrick.errors import ProjectFileError
from ravenbrick.schemas.located_toml import dotted, read_toml

TEXT = '''\
# head
title = "a # b [c] = d"
[body]
size = 1
long = """
[not.a.table]
key = 1
"""
"quoted key" = { inner = 2, other = { deep = 3 } }
list = [
    1,
    { x = 4 }, # comment ]
    'lit]eral',
]
a.b.c = 5
[[tasks]]
name = "one"
[[tasks]]
name = "two"
[tasks.more]
depth = 6
[[tasks.sub]]
y = 7
'''

LINES = {
    ("title",): 2,
    ("body",): 3,
    ("body", "size"): 4,
    ("body", "long"): 5,
    ("body", "quoted key", "inner"): 9,
    ("body", "quoted key", "other", "deep"): 9,
    ("body", "list"): 10,
    ("body", "list", 1, "x"): 12,
    ("body", "list", 2): 13,
    ("body", "a", "b", "c"): 15,
    ("tasks", 0, "name"): 17,
    ("tasks", 1): 18,
    ("tasks", 1, "name"): 19,
    ("tasks", 1, "more", "depth"): 21,
    ("tasks", 1, "sub", 0, "y"): 23,
}


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A file with every form of key."""
    file = tmp_path / "all.toml"
    file.write_text(TEXT)
    return file


@pytest.mark.parametrize(("key", "line"), LINES.items(), ids=lambda value: str(value))
def test_each_form_of_key_is_found_on_its_line(
    path: Path, key: tuple[str | int, ...], line: int
) -> None:
    """The line of a key is where the key is written."""
    assert read_toml(path, missing="").lines[key] == line


def test_a_key_that_is_not_there_has_the_line_of_the_table_around_it(path: Path) -> None:
    """A missing field is reported at its table."""
    document = read_toml(path, missing="")
    assert document.line_of(("tasks", 1, "more", "absent")) == 20
    assert document.line_of(("nowhere", "at all")) == 1


def test_a_path_is_written_with_dots_and_indices() -> None:
    """Names of fields read as in the documentation."""
    assert dotted(("tasks", 2, "period_us")) == "tasks[2].period_us"


def test_a_syntax_error_names_line_and_field(tmp_path: Path) -> None:
    """What TOML does not allow is reported where it stands."""
    file = tmp_path / "broken.toml"
    file.write_text('name = "x"\nport = = 3\n')
    with pytest.raises(ProjectFileError, match=r"broken\.toml:2: port: not valid TOML") as caught:
        read_toml(file, missing="")
    assert caught.value.line == 2


def test_an_unclosed_text_at_the_end_names_the_last_line(tmp_path: Path) -> None:
    """An error that shows only at the end of the file still has a line."""
    file = tmp_path / "open.toml"
    file.write_text('name = "x"\nother = """abc\n')
    with pytest.raises(ProjectFileError, match=r"open\.toml:2"):
        read_toml(file, missing="")


def test_text_that_is_not_utf8_names_the_line(tmp_path: Path) -> None:
    """A byte of another encoding is reported on its line."""
    file = tmp_path / "latin.toml"
    file.write_bytes(b'a = 1\nb = "\xe9"\n')
    with pytest.raises(ProjectFileError, match=r"latin\.toml:2: not UTF-8"):
        read_toml(file, missing="")


def test_a_byte_order_mark_is_no_part_of_the_text(tmp_path: Path) -> None:
    """Some editors write one."""
    file = tmp_path / "marked.toml"
    file.write_bytes(b"\xef\xbb\xbfa = 1\r\nb = 2\r\n")
    found = read_toml(file, missing="")
    assert found.values == {"a": 1, "b": 2} and found.line_of(("b",)) == 2


def test_brackets_without_end_are_an_error_of_the_file(tmp_path: Path) -> None:
    file = tmp_path / "deep.toml"
    file.write_text("a = " + "[" * 100_000)
    with pytest.raises(ProjectFileError, match="nested too deeply"):
        read_toml(file, missing="")


def test_whole_numbers_beyond_64_bits_are_named(tmp_path: Path) -> None:
    """TOML has none; what reads the values would fail far away from the file."""
    file = tmp_path / "large.toml"
    file.write_text(f"a = {2**63 - 1}\n[[b]]\nc = [1, {2**63}]\n")
    with pytest.raises(ProjectFileError, match=r"large\.toml:3: b\[0\]\.c\[1\]: is too large"):
        read_toml(file, missing="")


def test_a_list_of_tables_has_the_line_of_its_first(tmp_path: Path) -> None:
    file = tmp_path / "tables.toml"
    file.write_text("a = 1\n\n[[tasc]]\nb = 2\n\n[[tasc]]\nb = 3\n")
    assert read_toml(file, missing="").line_of(("tasc",)) == 3
