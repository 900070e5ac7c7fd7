# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Results are written whole or not at all."""

from __future__ import annotations

import resource
from pathlib import Path

import pytest

from ravenbrick.atomic_write import atomic_write


def test_text_and_bytes_are_written_into_folders_that_are_made(tmp_path: Path) -> None:
    path = tmp_path / "new" / "folder" / "file.txt"
    atomic_write(path, "Grüße\n")
    assert path.read_bytes() == "Grüße\n".encode()
    atomic_write(path, b"\0")
    assert path.read_bytes() == b"\0"


def test_what_does_not_fit_leaves_the_old_file_and_nothing_else(tmp_path: Path) -> None:
    """A limit on the size of files stands for a full disk."""
    path = tmp_path / "results.json"
    atomic_write(path, "old")
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1_000, limits[1]))
    try:
        with pytest.raises(OSError, match=r"results\.json"):
            atomic_write(path, "x" * 2_000)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert path.read_text() == "old" and list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("name", ["folder", "file/below"])
def test_the_error_names_what_was_asked_for(name: str, tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match=name) as refused:
        atomic_write(tmp_path / name, "")
    assert refused.value.filename == str(tmp_path / name)


def test_a_link_stays_a_link_and_a_device_is_written_to(tmp_path: Path) -> None:
    link = tmp_path / "link"
    link.symlink_to(tmp_path / "file")
    atomic_write(link, "new")
    assert link.is_symlink() and (tmp_path / "file").read_text() == "new"
    with pytest.raises(OSError, match=r"/dev/full"):
        atomic_write(Path("/dev/full"), "new")


def test_a_file_with_a_mode_has_no_other_while_it_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    modes = []
    write = Path.write_bytes

    def watched(path: Path, data: bytes) -> int:
        written = write(path, data)
        modes.append(path.stat().st_mode & 0o777)
        return written

    monkeypatch.setattr(Path, "write_bytes", watched)
    atomic_write(tmp_path / "key", "secret", mode=0o600)
    assert [*modes, (tmp_path / "key").stat().st_mode & 0o777] == [0o600, 0o600]
    atomic_write(tmp_path / "key", "secret", mode=0o640)
    assert (tmp_path / "key").stat().st_mode & 0o777 == 0o640
