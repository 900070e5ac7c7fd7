# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`python confinement.py FILTER FOLDER PATH ... --list PATH ... -- COMMAND`.

Gives up rights and becomes the command, which with its children reads the paths, writes the
folder, lists the last paths, and nothing else (landlock(7)); the system calls that lead around that
are refused by the filter (seccomp(2)). It runs alone, before anything else can be read, so it needs
only the standard library.
"""

from __future__ import annotations

import ctypes
import os
import stat
import sys

CREATE_RULESET, ADD_RULE, RESTRICT_SELF = 444, 445, 446  # the same on every architecture
VERSION = 1 << 0
BENEATH = 1
NO_NEW_PRIVS, SET_SECCOMP, MODE_FILTER = 38, 22, 2
INSTRUCTION = 8  # bytes, of a filter

EXECUTE, WRITE_FILE, READ_FILE, READ_DIR = (1 << bit for bit in range(4))
REFER, TRUNCATE, IOCTL = 1 << 13, 1 << 14, 1 << 15
# Kinds of files that are made: no devices and no sockets.
MAKE_CHAR, MAKE_SOCK, MAKE_BLOCK = 1 << 6, 1 << 9, 1 << 11
FIRST_RIGHTS = (1 << 13) - 1
READ = EXECUTE | READ_FILE | READ_DIR
OF_FILES = EXECUTE | WRITE_FILE | READ_FILE | TRUNCATE | IOCTL
# Of the network (bind and connect), and abstract sockets and signals to processes outside.
ALL_NETWORK = ALL_SCOPES = 3
DEVICES = ("/dev/null", "/dev/zero", "/dev/random", "/dev/urandom")


class Ruleset(ctypes.Structure):
    """struct landlock_ruleset_attr."""

    _fields_ = (
        ("files", ctypes.c_uint64),
        ("network", ctypes.c_uint64),
        ("scope", ctypes.c_uint64),
    )


class Beneath(ctypes.Structure):
    """struct landlock_path_beneath_attr."""

    _pack_ = 1
    _fields_ = (("rights", ctypes.c_uint64), ("parent", ctypes.c_int32))


class Program(ctypes.Structure):
    """struct sock_fprog."""

    _fields_ = (("length", ctypes.c_ushort), ("filter", ctypes.c_char_p))


LIBC = ctypes.CDLL(None, use_errno=True)


def _checked(result: int, what: str) -> int:
    if result < 0:
        sys.exit(f"{what}: {os.strerror(ctypes.get_errno() or -result)}")
    return result


def _allow(ruleset: int, path: str, rights: int) -> None:
    place = os.open(path, os.O_PATH | os.O_CLOEXEC)
    if not stat.S_ISDIR(os.fstat(place).st_mode):
        rights &= OF_FILES
    rule = Beneath(rights, place)
    done = LIBC.syscall(ADD_RULE, ruleset, BENEATH, ctypes.byref(rule), 0)
    _checked(done, f"a Landlock rule for '{path}'")
    os.close(place)


def _restrict_files(folder: str, readable: list[str], listed: list[str]) -> None:
    version = LIBC.syscall(CREATE_RULESET, None, 0, VERSION)
    _checked(version, "the kernel has no Landlock (5.13 or later with it among its LSMs)")
    files = FIRST_RIGHTS
    for since, right in ((2, REFER), (3, TRUNCATE), (5, IOCTL)):
        files |= right if version >= since else 0
    rules = Ruleset(files, ALL_NETWORK * (version >= 4), ALL_SCOPES * (version >= 6))
    size = 8 if version < 4 else 16 if version < 6 else 24
    ruleset = _checked(LIBC.syscall(CREATE_RULESET, ctypes.byref(rules), size, 0), "Landlock")
    for path in readable:
        _allow(ruleset, path, READ)
    for path in listed:
        _allow(ruleset, path, READ_DIR)
    for path in DEVICES:
        _allow(ruleset, path, (READ_FILE | WRITE_FILE | IOCTL) & files)
    _allow(ruleset, folder, files & ~(MAKE_CHAR | MAKE_SOCK | MAKE_BLOCK))
    _checked(LIBC.syscall(RESTRICT_SELF, ruleset, 0), "Landlock")


def _restrict_calls(filter_file: str) -> None:
    with open(filter_file, "rb") as file:
        text = file.read()
    program = Program(len(text) // INSTRUCTION, text)
    done = LIBC.prctl(SET_SECCOMP, MODE_FILTER, ctypes.byref(program), 0, 0)
    _checked(done, "the filter of system calls")


def main() -> None:
    """Restrict this process, and become the command."""
    mark = sys.argv.index("--")
    filter_file, folder, *paths = sys.argv[1:mark]
    lists = paths.index("--list")
    command = sys.argv[mark + 1 :]
    _checked(LIBC.prctl(NO_NEW_PRIVS, 1, 0, 0, 0), "no new privileges")
    place = os.path.abspath(filter_file)
    _restrict_files(folder, [*paths[:lists], place], paths[lists + 1 :])
    _restrict_calls(place)
    os.chdir(folder)
    os.execvp(command[0], command)


if __name__ == "__main__":
    main()
