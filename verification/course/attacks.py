# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Hostile and broken submissions to the first lab: each with what its student is told.

`SECRET` stands for what must not leave the host: files and variables of the campaign hold it.
"""

from __future__ import annotations

import io
import os
import re
import struct
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from verification.support.submissions import SOURCES, write_submission

__all__ = ["ATTACKS", "COMPILER", "FILES", "SECRET", "Attack", "Place"]

SECRET = "ravenbrick-canary-4711"
TASKS = SOURCES["tasks.adb"]
TOUCH = "with NXT.Touch_Sensors;\n"
MISSING = r"No such file|Permission denied|can't open|cannot open|not found|no include path"


@dataclass(frozen=True)
class Place:
    """What an attack may know of the host: the files that it is after, and where it lies."""

    secret_file: Path
    rubric: Path
    solutions: Path


@dataclass(frozen=True)
class Attack:
    """One submission: what it tries, how it is made at a path, and what the report says.

    `says` is a pattern of the first lost check; `at_most` the most points that it may get.
    """

    name: str
    tries: str
    make: Callable[[Path, Place], object]
    says: str
    at_most: float = 0.0
    design: bool = False


def _ada(text: str) -> Callable[[Path, Place], object]:
    """A declaration in the tasks; {secret}, {rubric} and {solutions} are paths in all texts."""
    return _body("package body Tasks is\n", f"package body Tasks is\n{text}")


def _asm(template: str) -> Callable[[Path, Place], object]:
    """The tasks with a machine-code insertion in the first statement."""

    def make(path: Path, place: Place) -> object:
        text = TASKS.replace(TOUCH, TOUCH + "with System.Machine_Code;\n")
        insertion = f"System.Machine_Code.Asm ({_filled(template, place)}, Volatile => True);"
        return write_submission(path, text.replace("Presses.Add;", insertion))

    return make


def _c(text: str) -> Callable[[Path, Place], object]:
    """A C file beside the tasks."""
    return lambda path, place: write_submission(path, **{"extra.c": _filled(text, place)})


def _file(name: str, text: str) -> Callable[[Path, Place], object]:
    return lambda path, place: write_submission(path, **{name: _filled(text, place)})


def _design(text: str) -> Callable[[Path, Place], object]:
    def make(path: Path, place: Place) -> None:
        write_submission(path)
        (path / "design.py").write_text(_filled(text, place))

    return make


def _files(others: dict[str, str]) -> Callable[[Path, Place], object]:
    """Further files, by their paths from src/."""

    def make(path: Path, place: Place) -> None:
        write_submission(path)
        for name, text in others.items():
            (path / "src" / name).parent.mkdir(parents=True, exist_ok=True)
            (path / "src" / name).write_text(text)

    return make


def _body(old: str, new: str) -> Callable[[Path, Place], object]:
    assert old in TASKS
    return lambda path, place: write_submission(path, TASKS.replace(old, new))


def _filled(text: str, place: Place) -> str:
    text = text.replace("{secret}", str(place.secret_file))
    return text.replace("{rubric}", str(place.rubric)).replace("{solutions}", str(place.solutions))


def _late(hides: str) -> Callable[[Path, Place], object]:
    """A job that takes two periods at each press, after C that hides it from who observes it."""
    c = f"{hides}\nvoid late(void) {{ hide(); for (volatile int i = 0; i < 120000; i++); }}\n"
    late = 'procedure Late with Import, Convention => C, External_Name => "late";\n'
    text = TASKS.replace("package body Tasks is\n", f"package body Tasks is\n   {late}")
    text = re.sub(r"( +)Presses\.Add;\n", r"\g<0>\1Late;\n", text)
    return lambda path, place: write_submission(path, text, **{"extra.c": c})


def _moved_work(path: Path, place: Place) -> None:
    """The job of the control task, late, in a task of its own; the control task only waits."""
    _late("void hide(void) {}")(path, place)
    body, specification = path / "src" / "tasks.adb", path / "src" / "tasks.ads"
    waits = "delay until Next; Next := Next + Control_Period;"
    empty = f"task body Control_Task is Next : Time := First_Release; begin loop {waits} end loop;"
    text = body.read_text().replace("Control_Task", "Worker_Task")
    body.write_text(text.replace("task body W", f"{empty} end Control_Task; task body W"))
    worker = "   task Worker_Task with Priority => 2, Storage_Size => 2048;\n"
    text = specification.read_text().replace("   task Control_", f"{worker}   task Control_", 1)
    specification.write_text(text)


def _answers(text: str) -> Callable[[Path, Place], object]:
    def make(path: Path, place: Place) -> None:
        write_submission(path)
        (path / "answers.toml").write_text(text)

    return make


def _zip_of(*members: tuple[str, str | bytes]) -> Callable[[Path, Place], object]:
    """An archive with the sources between members of these names and contents."""

    def make(path: Path, place: Place) -> None:
        with zipfile.ZipFile(path.with_suffix(".zip"), "w") as archive:
            for name, text in (*((f"src/{n}", t) for n, t in SOURCES.items()), *members):
                archive.writestr(name, text)

    return make


def _zip(path: Path, change: Callable[[bytes], bytes] = bytes, **others: str) -> None:
    with zipfile.ZipFile(path.with_suffix(".zip"), "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in (SOURCES | others).items():
            archive.writestr(f"src/{name}", text)
    file = path.with_suffix(".zip")
    file.write_bytes(change(file.read_bytes()))


def _encrypted(content: bytes) -> bytes:
    """Flag bit 0 in each header (APPNOTE 4.4.4)."""
    changed = bytearray(content)
    for mark, offset in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        for found in re.finditer(re.escape(mark), content):
            changed[found.start() + offset] |= 1
    return bytes(changed)


def _other_method(content: bytes) -> bytes:
    changed = bytearray(content)
    for mark, offset in ((b"PK\x03\x04", 8), (b"PK\x01\x02", 10)):
        for found in re.finditer(re.escape(mark), content):
            changed[found.start() + offset] = 99
    return bytes(changed)


def _bad_deflate(content: bytes) -> bytes:
    start = content.index(b"PK\x03\x04") + 60
    return content[:start] + b"\xff" * 40 + content[start + 40 :]


def _bomb(path: Path, place: Place) -> None:
    with zipfile.ZipFile(path.with_suffix(".zip"), "w", zipfile.ZIP_DEFLATED) as archive:
        with archive.open("src/big.c", "w", force_zip64=True) as member:
            for _ in range(300):
                member.write(bytes(1_000_000))


def _many_bombs(path: Path, place: Place) -> None:
    with zipfile.ZipFile(path.with_suffix(".zip"), "w", zipfile.ZIP_DEFLATED) as archive:
        for number in range(400):
            archive.writestr(f"src/a{number}.c", bytes(900_000))


def _same_name(path: Path, place: Place) -> None:
    """Each has its own header and data (APPNOTE 4.3.6), so that nothing overlaps."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("src/a.c", bytes(1_000_000))
    local, mark, head = stream.getvalue().partition(b"PK\1\2")
    head = mark + head.partition(b"PK\5\6")[0]
    count = 10_000
    heads = [head[:42] + struct.pack("<L", n * len(local)) + head[46:] for n in range(count)]
    sizes = count * len(head), count * len(local)
    end = struct.pack("<4s4H2LH", b"PK\5\6", 0, 0, count, count, *sizes, 0)
    path.with_suffix(".zip").write_bytes(b"".join([local * count, *heads, end]))


def _deep(path: Path, place: Place) -> None:
    """Deeper than anybody means."""
    path.mkdir()
    start = os.open(".", os.O_RDONLY)
    try:
        os.chdir(path)
        for _ in range(400):
            os.mkdir("deeper")
            os.chdir("deeper")
    finally:
        os.fchdir(start)
        os.close(start)


def _many_files(path: Path, place: Place) -> None:
    write_submission(path)
    (path / "notes").mkdir()
    for number in range(12_000):
        (path / "notes" / f"{number}").touch()


def _many_entries(path: Path, place: Place) -> None:
    """A central directory (APPNOTE 4.3.12) alone."""
    head = struct.pack("<4s4B4H3L5H2L", b"PK\1\2", 20, 0, 20, *[0] * 8, 1, *[0] * 6) + b"a"
    heads = 300_000 * head
    end = struct.pack("<4s4H2LH", b"PK\5\6", 0, 0, 0xFFFF, 0xFFFF, len(heads), 0, 0)
    path.with_suffix(".zip").write_bytes(heads + end)


def _odd_times(path: Path, place: Place) -> None:
    write_submission(path)
    for number, file in enumerate(sorted((path / "src").iterdir())):
        os.utime(file, (4_102_444_800 * (number % 2),) * 2)


def _bad_name(path: Path, place: Place) -> None:
    """Not UTF-8: the folder's own name, and one inside."""
    folder = Path(os.fsdecode(os.fsencode(path) + b"-\xff\xfe"))
    write_submission(folder)
    (folder / os.fsdecode(b"\xe9\x80.txt")).touch()


def _source_link(path: Path, place: Place) -> None:
    write_submission(path)
    (path / "src" / "tasks.adb").unlink()
    (path / "src" / "tasks.adb").symlink_to(place.secret_file)


def _folder_link(path: Path, place: Place) -> None:
    path.mkdir()
    (path / "src").symlink_to(place.secret_file.parent)


def _pipe(path: Path, place: Place) -> None:
    os.mkfifo(path.with_suffix(".zip"))


def _own_project(path: Path, place: Place) -> None:
    write_submission(path)
    (path / "robot.gpr").write_text('project Robot is for Main use ("evil.adb"); end Robot;')
    (path / "Makefile").write_text(f"all:\n\tcat {place.secret_file}\n")
    (path / "robot.toml").write_text("schema_version = 9\n")
    (path / "src" / "gnat.adc").write_text("pragma Restrictions (No_Tasking);")


_WAITS = """extern volatile unsigned *ravenbrick_running_thread;
extern const unsigned ravenbrick_thread_layout[];
void hide(void) {
  volatile unsigned *thread = ravenbrick_running_thread;
  thread[ravenbrick_thread_layout[8] / 4] += 420480;
  thread[ravenbrick_thread_layout[7] / 4] = 2;
}"""
# What the run-time writes for its caller may be words of its own, and its code may be replaced.
_SAYS_IT_WAITS = """extern volatile unsigned *ravenbrick_running_thread;
WRITE
void hide(void) {
  volatile unsigned *thread = ravenbrick_running_thread;
  unsigned kept[3] = {thread[4], thread[5], thread[7]};
  thread[10] += 420480;
  write(thread);
  thread[4] = kept[0]; thread[5] = kept[1]; thread[7] = kept[2];
}"""
_BY_SPLIT = """void ada__real_time__split(volatile void *to, unsigned long long time);
static void write(volatile unsigned *thread) { ada__real_time__split(thread + 4, 2); }"""
_BY_CODE = """extern unsigned ravenbrick_start_board[];
static void write(volatile unsigned *thread) {
  volatile unsigned *code = ravenbrick_start_board;
  code[0] = 0xE5801000; code[1] = 0xE12FFF1E;  /* str r1, [r0]; bx lr */
  ((void (*)(volatile unsigned *, unsigned)) code)(thread + 6, 2);
}"""
COMPILER = [
    Attack("linker-option", "pragma Linker_Options", _ada(
        'pragma Linker_Options ("-Wl,-plugin,src/evil.so");\n'), r"tasks.*linker option.*plugin"),
    Attack("linker-brackets", "the same in bracket notation", _ada(
        'pragma Linker_["4F"]ptions ("-Wl,-plugin,src/evil.so");\n'), r"linker option.*plugin"),
    Attack("linker-library", "a library of the host", _ada(
        'pragma Linker_Options ("/usr/lib/x86_64-linux-gnu/libc.so.6");\n'), "linker option"),
    Attack("asm-include", "the assembler reads a file", _asm('".include ""{secret}"""'), MISSING),
    Attack("asm-incbin", "the same, the word in two parts", _asm(
        '".inc" & "bin ""{secret}"""'), MISSING),
    Attack("asm-rubric", "the assembler reads the rubric", _asm(
        '".inc" & "bin ""{rubric}"""'), MISSING),
    Attack("c-include", "an include of a file", _c('#include "{secret}"\n'), MISSING),
    Attack("c-digraph", "a digraph", _c('%:include "{secret}"\n'), MISSING),
    Attack("c-comment", "a comment in the directive", _c('#/**/include "{secret}"\n'), MISSING),
    Attack("c-splice", "a line splice in the directive", _c(
        '#inc\\\nlude "{secret}"\n'), MISSING),
    Attack("c-macro", "a macro as the name", _c(
        '#define F "{secret}"\n#include F\n'), MISSING),
    Attack("c-import", "#import", _c('#import "{secret}"\n'), MISSING),
    Attack("c-passwd", "the accounts of the host", _c('#include "/etc/passwd"\n'), MISSING),
    Attack("c-rubric", "the rubric with its tolerances", _c('#include "{rubric}"\n'), MISSING),
    Attack("c-solutions", "the solutions", _c('#include "{solutions}"\n'), MISSING),
    Attack("c-oracle", "asks which files there are", _c(
        '#if __has_include("{secret}")\n#error it is there\n#else\n#error none\n#endif\n'),
        r"error none|Permission denied"),
    Attack("c-environment", "the variables of the compiler", _c(
        '#include "/proc/self/environ"\n'), "", 99),
    Attack("c-other-process", "the variables of the grader", _c(
        '#include "/proc/1/environ"\n'), r"extra\.c|environ|error"),
    Attack("c-messages", "messages without end", _c(
        '#pragma message "' + "x" * 4000 + '"\n#include __FILE__\n#include __FILE__\n'),
        "messages never end|nested|took more"),
    Attack("c-expansion", "a macro that doubles 40 times", _c(
        "#define A0 1+1\n"
        + "".join(f"#define A{n + 1} A{n}+A{n}\n" for n in range(40))
        + "int x = A40;\n"), "took more|memory|exhausted|error"),
    Attack("c-large", "an object of 1.5 GB", _c("char x[1500000000] = {1};\n"), "."),
    Attack("ada-power", "a static number of 10 ** 400_000_000", _ada(
        "   Big : constant := 10 ** 400_000_000;\n"), "took more|storage|memory|tasks.adb"),
    Attack("ada-digits", "a literal of 20,000 digits", _ada(
        f"   Big : constant Integer := {'9' * 20_000};\n"), "tasks.adb"),
    Attack("kernel-unit", "a unit of the kernel", _file(
        "ravenbrick-threads.ads", "package Ravenbrick.Threads is\nend Ravenbrick.Threads;\n"), "."),
    Attack("run-time-unit", "a unit of Ada's library", _file(
        "a-reatim.ads", "package Ada.Real_Time is\nend Ada.Real_Time;\n"), "."),
    Attack("system-unit", "package System", _file(
        "system.ads", "package System is\n   pragma Pure;\nend System;\n"), "."),
    Attack("kernel-symbol", "a symbol of the kernel", _c(
        "int ravenbrick__threads__running_thread;\n"), "a name of the run-time"),
    Attack("kernel-words", "the table by which threads are observed", _c(
        "const int ravenbrick_thread_layout[11] = {1, 64, 0, 4, 8, 12, 16, 20, 24, 28, 32};\n"),
        "a name of the run-time"),
    Attack("local-words", "the word of the running thread, known in one file only", _c(
        "static volatile int ravenbrick_running_thread __attribute__((used));\n"),
        "a name of the run-time"),
    Attack("local-function", "a late job whose function is called as one of the kernel", _late(
        _WAITS.replace("void hide", "static __attribute__((noinline)) void ravenbrick_hide")
        + "\nvoid hide(void) { ravenbrick_hide(); }"), "a name of the run-time"),
    Attack("odd-names", "symbols of the kernel in files that no check reads", _files(
        dict.fromkeys(("-x.c", "it's.c", "b__x.c"), "int ravenbrick__threads__x;\n")), "", 99),
    Attack("driver-unit", "a body of a driver", _file(
        "nxt-motor_controls.adb", "package body NXT.Motor_Controls is\nend NXT.Motor_Controls;\n"),
        "cannot belong to several projects"),
    Attack("driver-symbol", "a symbol of a driver", _c(
        "int nxt__touch_sensors__pressed(void *sensor) { return 1; }\n"), "", 99),
    Attack("library-symbol", "memcpy, which the kernel calls", _c(
        "void *memcpy(void *to, const void *from, unsigned n) { for (;;); }\n"), "defined twice"),
    Attack("source-reference", "errors that seem to be in another file", _body(
        "with Ada.Real_Time;", 'pragma Source_Reference (1, "/etc/passwd");\nwith Ada.Real_Tim;'),
        "Source_Reference|passwd:1"),
    Attack("debug-noise", "debug information that is none", _c("__asm__(\"" + "".join(
        f".section .debug_{name},\\\"\\\",%progbits\\n.fill 4000,1,0xff\\n"
        for name in ("info", "abbrev", "line", "frame")) + ".text\");\n"), "", 99),
    Attack("terminal", "commands to the reader's terminal", _c(
        "#error \x1b]0;owned\x07\x1b[2J\u202e\x9b31m\n"), "error .*owned"),
    Attack("markup", "a page that runs in the reader's browser", _c(
        "#error <script src=//example.org> ![](http://example.org) \\\\<b>\n"), "script"),
    Attack("mounts", "where the grader's files lie", _c(
        '#include "/proc/self/mountinfo"\n'), "", 99),
    Attack("endless-file", "a device that never ends", _c('#include "/dev/zero"\n'), "."),
    Attack("long-line", "an error of 19,000 letters", _c(f"#error {'y' * 19_000}\n"), "yyy"),
    Attack("own-project", "its own project file, Makefile, robot.toml", _own_project, "", 99),
]  # fmt: skip
FILES = [
    Attack("zip-noise", "bytes that are no archive", lambda path, place: path.with_suffix(
        ".zip").write_bytes(bytes(range(256)) * 40), "cannot be read.*not a zip"),
    Attack("zip-empty", "an empty file", lambda path, place: path.with_suffix(
        ".zip").touch(), "cannot be read"),
    Attack("zip-cut", "half of an archive", lambda path, place: _zip(
        path, lambda content: content[: len(content) // 2]), "cannot be read"),
    Attack("zip-deflate", "corrupt compressed data", lambda path, place: _zip(
        path, _bad_deflate), "cannot be read"),
    Attack("zip-encrypted", "a password", lambda path, place: _zip(
        path, _encrypted), "password"),
    Attack("zip-method", "an unknown compression", lambda path, place: _zip(
        path, _other_method), "cannot be read.*compression"),
    Attack("zip-bomb", "300 MB in 300 KB", _bomb, "too large"),
    Attack("zip-many-bombs", "400 files of 900 KB in 360 KB", _many_bombs, "more than 8 MB"),
    Attack("zip-same-name", "10,000 files of 1 MB under one name, in 10 MB", _same_name,
        "more than 8 MB"),
    Attack("rar", "another kind of archive", lambda path, place: path.with_suffix(
        ".rar").write_bytes(b"Rar!"), "submit a .zip"),
    Attack("named-pipe", "a pipe instead of an archive", _pipe, "not a file"),
    Attack("link", "a link to the root folder", lambda path, place: path.symlink_to("/"), "link"),
    Attack("link-folder", "src/ is a link", _folder_link, "no Ada or C"),
    Attack("link-source", "a source is a link to a secret", _source_link, "body"),
    Attack("deep", "400 folders deep", _deep, "deep"),
    Attack("many-files", "12,000 files", _many_files, "more than"),
    Attack("bad-names", "names that are not UTF-8", _bad_name, "", 99),
    Attack("many-entries", "300,000 names in 18 MB", _many_entries, "more than 10000"),
    Attack("zip-doubles", "names twice, as another case, folder or system writes them", _zip_of(
        ("src/tasks.adb", "no"), ("src/Tasks.adb", "no"), ("SRC/tasks.adb", "no"),
        ("zz\\src\\tasks.adb", "no"), ("src/t\u0430sks.adb", "no"),
        ("__MACOSX/src/._tasks.adb", b"\0\5\x16\7\xff")), "", 99),
    Attack("long-name", "a name of 255 bytes", lambda path, place: write_submission(
        path.with_name(path.name + "\u20ac" * ((255 - len(path.name)) // 3))), "", 99),
    Attack("times", "files of 1980 and of 2100", _odd_times, "", 99),
    Attack("own-files", "own scenarios, facts, rubric and image", _files({
        "../scenarios/press.toml": "no", "../timing.toml": "no", "../lab-01.toml": "no",
        "../build/blank/ram/blank.elf": "no", "tasks.ali": "no", "tasks.o": "no"}), "", 99),
    Attack("long-key", "an answer whose name has 30,000 parts", _answers(
        f"{'a.' * 30_000}presses = 2\n"), "more than 50 parts", 99),
    Attack("many-answers", "answers of 300 KB", _answers("# no\n" * 60_000), "larger than", 99),
    Attack("long-number", "an answer of 400 digits", _answers(
        f"presses = {'9' * 400}\n"), "too large", 99),
    Attack("longer-number", "an answer of 10,000 digits", _answers(
        f"presses = {'9' * 10_000}\n"), "answers.toml", 99),
    Attack("not-a-number", "an answer nan", _answers("presses = nan\n"), "nan", 99),
    Attack("nested-answers", "10,000 brackets", _answers(
        f"presses = {'[' * 10_000}\n"), "answers.toml", 99),
]  # fmt: skip
BRICK = [
    Attack("endless-loop", "a task that never waits", _body(
        "Now := NXT", "loop null; end loop;\n         Now := NXT"), "rad/s|missed|presses", 5),
    Attack("wild-write", "a write to no memory", _body(
        "Presses.Add;", "declare X : Integer with Import, Address => "
        "System'To_Address (16#7000_0000#); begin X := 1; end;"), ".", 5),
    Attack("late", "a job that takes two periods", _late("void hide(void) {}"), "missed", 9),
    Attack("forged-state", "a late job that says it waits", _late(
        _WAITS), "only the run-time writes", 5),
    Attack("borrowed-writer", "the same, written by a function of the run-time", _late(
        _SAYS_IT_WAITS.replace("WRITE", _BY_SPLIT)), "only the run-time writes", 5),
    Attack("replaced-code", "the same, written by code that replaces the run-time's", _late(
        _SAYS_IT_WAITS.replace("WRITE", _BY_CODE)), "only the run-time writes", 5),
    Attack("moved-clock", "a late job after a restart of the clock", _late(
        "#define PIT_MR (*(volatile unsigned *)0xFFFFFD30)\n"
        "void hide(void) {\n  unsigned mode = PIT_MR;\n  PIT_MR = 0;\n"
        "  for (volatile int i = 0; i < 60; i++);\n  PIT_MR = mode;\n}"), "missed|clock", 9),
    Attack("renamed-tasks", "tasks that robot.toml does not name", lambda path, place: (
        write_submission(path, TASKS.replace("Control_Task", "Other_Task"), **{
            "tasks.ads": SOURCES["tasks.ads"].replace("Control_Task", "Other_Task")})),
        "'other_task' is none of the assignment's", 9),
    Attack("moved-work", "a late job of a task that robot.toml does not name, beside an empty one",
        _moved_work, "'worker_task' is none of the assignment's", 9),
    Attack("constant", "prints the count of the public scenario", _body(
        "Put_Noupdate (Presses.Count);", "Put_Noupdate (Integer'(2));"), "presses 2", 9),
]  # fmt: skip
DESIGN = [
    Attack("design-files", "reads the secret and the rubric", _design(
        "import sys\nfor f in ('{secret}', '{rubric}', '{solutions}', '/etc/shadow'):\n"
        "    try:\n        print(open(f).read())\n"
        "    except OSError as e: print(f, e)\nsys.exit('done')\n"), MISSING, design=True),
    Attack("design-write", "writes beside the secret", _design(
        "open('{secret}.new', 'w').write('x')\n"), "Error", design=True),
    Attack("design-network", "connects to a server", _design(
        "import socket\nsocket.create_connection(('1.1.1.1', 53), 5)\n"), "not permitted",
        design=True),
    Attack("design-forks", "a fork bomb", _design(
        "import os\nwhile True: os.fork()\n"), "unavailable", design=True),
    Attack("design-session", "a child in its own session holds the pipes", _design(
        "import os, time\nif os.fork() == 0:\n    os.setsid()\n    time.sleep(10_000)\n"),
        "", 99, True),
    Attack("design-output", "output without end", _design(
        "while True: print('x' * 10_000)\n"), "never end", design=True),
    Attack("design-sleep", "waits for ever", _design(
        "import time\ntime.sleep(100_000)\n"), "took more", design=True),
    Attack("design-memory", "takes 20 GB", _design(
        "x = [bytearray(1 << 30) for _ in range(20)]\n"), "MemoryError", design=True),
    Attack("design-disk", "fills the disk", _design(
        "for n in range(100):\n    open(f'f{n}', 'wb').write(bytes(50_000_000))\n"),
        "No space", design=True),
    Attack("design-memory-files", "takes 20 GB in files that are only in memory", _design(
        "import os\nfor n in range(400):\n    os.write(os.memfd_create('m'), bytes(50_000_000))\n"),
        "not permitted", design=True),
    Attack("design-deleted", "fills the disk with files that it has deleted", _design(
        "import os, time\nkept = []\nfor n in range(100):\n    kept.append(open('f', 'wb'))\n"
        "    os.remove('f')\n    kept[-1].write(bytes(50_000_000))\ntime.sleep(5)\n"),
        "No space", design=True),
    Attack("design-kill", "kills all that it may", _design(
        "import os\nos.kill(-1, 9)\nos.kill(1, 9)\n"), "", 99, True),
    Attack("design-root", "becomes root", _design(
        "import os\nos.setuid(0)\nopen('/root/x', 'w')\n"), "Error", design=True),
    Attack("design-link", "leaves links as generated sources", _design(
        "import os\nos.makedirs('generated', exist_ok=True)\n"
        "os.symlink('{secret}', 'generated/a.c')\n"), "", 99, True),
    Attack("design-result", "writes its own marks into every pipe", _design(
        "import os, glob\nfor f in glob.glob('/proc/[0-9]*/fd/*'):\n"
        "    try: os.write(os.open(f, os.O_WRONLY | os.O_NONBLOCK), b'[]')\n"
        "    except OSError: pass\n"), "", 99, True),
]  # fmt: skip
ATTACKS = (*COMPILER, *FILES, *BRICK, *DESIGN)
