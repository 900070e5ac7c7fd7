# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The Python environment .venv as it is: what in it is to be repaired, and the repairs.

`tools/setup` runs this file with the environment's Python; it needs the standard library only.
`check FILE… [native]` prints a line for each thing that is wrong: `:all`, `:place`, `:link`,
`:brick`, or a requirement of the files; `:native` says that the brick has JIT code. `forget`
makes pip install again what it left half done. `link` makes the package and the programs of the
environment work from where it lies.
"""

from __future__ import annotations

import re
import shlex
import shutil
import sys
import sysconfig
from collections import defaultdict
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
VENV = ROOT / ".venv"
HOST = ROOT / "host" / "src"
SITE = Path(sysconfig.get_path("purelib"))
LINK = SITE / "ravenbrick.pth"
# Relative to the packages' folder, so that it holds in a tree that was moved or copied.
LINKED = "../../../../host/src\n"
PROGRAM = VENV / "bin" / "ravenbrick"
# A shell finds the Python beside the program, wherever that is; Python sees a string.
HEAD = """#!/bin/sh
'''exec' "$(dirname "$(readlink -f "$0")")/python" "$0" "$@"
' '''
"""
# How the module venv names the folder in bin/activate, and what a shell takes for any name.
SPELLINGS = (f'VIRTUAL_ENV="{VENV}"\n', f"VIRTUAL_ENV={shlex.quote(str(VENV))}\n")
# Guarded, because a worker process of `ravenbrick sweep` reads the program again.
MAIN = """import sys
from ravenbrick.cli import main
if __name__ == "__main__":
    sys.exit(main())
"""


def plain(name: str) -> str:
    """The name of a package in the one spelling that all others mean."""
    return re.sub(r"[-_.]+", "-", name).lower()


def described() -> dict[str, list[Path]]:
    """The folders that describe installed packages; of one that is being replaced there are two."""
    found = defaultdict(list)
    for folder in SITE.glob("*.dist-info"):
        found[plain(folder.name.partition("-")[0])].append(folder)
    return found


def whole(folder: Path) -> bool:
    """pip writes the file INSTALLER when all others are there."""
    return (folder / "INSTALLER").is_file()


def wrong_packages(files: list[str]) -> Iterator[str]:
    """Requirements that no whole package meets."""
    found = described()
    for file in files:
        for requirement in re.findall(r"^[\w.-]+==\S+", Path(file).read_text(), re.MULTILINE):
            name, version = requirement.split("==")
            folders = found[plain(name)]
            wanted = f"-{version}.dist-info"
            if len(folders) != 1 or not folders[0].name.endswith(wanted) or not whole(folders[0]):
                yield requirement


def wrong_place() -> Iterator[str]:
    """The environment is not whole, or was made in another folder."""
    activate = VENV / "bin" / "activate"
    if not activate.is_file() or not (SITE / "pip").is_dir():
        yield from (":all", ":brick")
        return
    if not any(spelling in activate.read_text() for spelling in SPELLINGS):
        yield ":place"


def wrong_link() -> bool:
    """The command is not that of this tree."""
    try:
        return LINK.read_text() != LINKED or PROGRAM.read_text() != HEAD + MAIN
    except OSError:
        return True


def wrong_brick(native: bool) -> Iterator[str]:
    """The module is absent, was built from other sources, or lacks the JIT code asked for."""
    sys.path.append(str(HOST))
    digest = import_module("ravenbrick.sources").brick_digest(ROOT)
    try:
        module = import_module("virtual_brick")
        if module.JIT:
            yield ":native"
        if module.SOURCES != digest or native > module.JIT:
            yield ":brick"
    except (ImportError, AttributeError):
        yield ":brick"


def check(words: list[str]) -> Iterator[str]:
    """All that is wrong."""
    yield from wrong_place()
    if wrong_link():
        yield ":link"
    yield from wrong_brick("native" in words)
    yield from wrong_packages([word for word in words if word != "native"])


def forget() -> None:
    """Remove the descriptions of packages that are not whole, or that there are two of."""
    for folders in described().values():
        for folder in folders:
            if len(folders) > 1 or not whole(folder):
                shutil.rmtree(folder)


def link() -> None:
    """Make the package importable, and the programs independent of where the tree lies."""
    for old in (*SITE.glob("__editable__.ravenbrick-*.pth"), *SITE.glob("ravenbrick-*.dist-info")):
        shutil.rmtree(old) if old.is_dir() else old.unlink()
    activate = VENV / "bin" / "activate"
    activate.write_text(activate.read_text().replace(*SPELLINGS))
    LINK.write_text(LINKED)
    PROGRAM.write_text(HEAD + MAIN)
    PROGRAM.chmod(0o755)
    for program in PROGRAM.parent.iterdir():
        if program.is_file() and not program.is_symlink():
            content = program.read_bytes()
            own = re.match(rb"#!.*/\.venv/bin/python.*\n|#!/bin/sh\n'''exec' .*\n' '''\n", content)
            if own:
                program.write_bytes(HEAD.encode() + content[own.end() :])


if __name__ == "__main__":
    if sys.argv[1] == "check":
        print("\n".join(check(sys.argv[2:])))
    else:
        {"forget": forget, "link": link}[sys.argv[1]]()
