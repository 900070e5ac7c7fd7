# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Fuzzing targets: every reader of a file that a person can be handed, and telemetry on a line.

A reader takes a damaged file or raises an error of ours with a sentence, within `CASE_S` seconds
of a processor and `PATIENCE` times as long by the clock; the campaign bounds its memory.
"""

from __future__ import annotations

import functools
import io
import json
import random
import signal
import tempfile
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from types import FrameType

import numpy as np
from matplotlib.figure import Figure
from ravenbrick.brick.links.live import LiveRecord
from ravenbrick.clock import Clock
from ravenbrick.codegen import read_coder_model
from ravenbrick.errors import RavenbrickError
from ravenbrick.grading.answers import parse_wanted, read_answers
from ravenbrick.grading.rubric import read_rubric
from ravenbrick.grading.student_folder import read_class
from ravenbrick.grading.submission import Submission, SubmissionError, read_files
from ravenbrick.image.elf import read_image
from ravenbrick.image.memory import memory_report
from ravenbrick.open_data.data_record import read_data_record
from ravenbrick.project.robot import read_robot
from ravenbrick.project.scenario import read_scenario
from ravenbrick.project.stimuli.run_file import read_run_file
from ravenbrick.schedule.task_file import read_task_file
from ravenbrick.self_test.record import read_record
from ravenbrick.simulink.file import read_simulink
from ravenbrick.simulink.workspace import read_workspace
from ravenbrick.telemetry import messages, replay
from ravenbrick.telemetry.frames import FRAME_END, LONGEST_CONTENT, FrameReader, frame
from ravenbrick.telemetry.picture import signals_figure
from ravenbrick.telemetry.window import LiveFigure
from ravenbrick.timing.facts.facts import read_facts
from ravenbrick.timing.results.bounds_file import read_bounds
from ravenbrick.trace.design import read_design
from ravenbrick.trace.recording import EVENT_TYPE, Recording, Signal, Stop

from verification.fuzz.mutation import mutate_bytes
from verification.support.paths import ROOT

__all__ = ["FileReader", "file_readers", "write_anew"]

CASE_S, PATIENCE = 10.0, 60
TIMERS = (
    (signal.SIGPROF, signal.ITIMER_PROF, CASE_S),
    (signal.SIGALRM, signal.ITIMER_REAL, PATIENCE * CASE_S),
)
EXAMPLE = ROOT / "examples" / "vehicle"
LESSONS = ROOT / "docs" / "lessons"
WORDS = (b"nan", b"-inf", b"1e400", b"9" * 400, b"9" * 5000, b"[" * 2000, b"-1", b"0", b"\xff\xfe")
# What a text is cut into, to have its parts changed one by one.
SEPARATORS = b" =,\n\"'[]{}:<>"


def mutate_text(numbers: random.Random, content: bytes) -> bytes:
    """A word replaced by an odd one, or lines doubled or lost, or bytes changed."""
    kind = numbers.randrange(4)
    if kind == 0 or not content:
        return mutate_bytes(numbers, content)
    if kind == 1:
        lines = content.splitlines(keepends=True)
        at = numbers.randrange(len(lines))
        lines[at : at + 1] = lines[at : at + 1] * numbers.choice((0, 2, 200))
        return b"".join(lines)
    begin = numbers.randrange(len(content))
    while begin > 0 and content[begin - 1] not in SEPARATORS:
        begin -= 1
    end = begin
    while end < len(content) and content[end] not in SEPARATORS:
        end += 1
    return content[:begin] + numbers.choice(WORDS) + content[end:]


def mutate_archive(numbers: random.Random, content: bytes) -> bytes:
    """A member of an archive changed and packed again, or bytes of the archive itself."""
    if numbers.randrange(4) == 0:
        return mutate_bytes(numbers, content)
    packed = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(content)) as old, zipfile.ZipFile(packed, "w") as new:
        names = old.namelist()
        chosen = numbers.choice(names)
        for name in names:
            data = old.read(name)
            new.writestr(name, mutate_text(numbers, data) if name == chosen else data)
    return packed.getvalue()


def write_anew(path: Path, content: bytes) -> None:
    """Write a file that may be there: ext4 waits for the disk where content replaces old one."""
    path.unlink(missing_ok=True)
    path.write_bytes(content)


def _timed_out(number: int, _frame: FrameType | None) -> None:
    clock = "of a processor" if number == signal.SIGPROF else "by the clock"
    limit_s = next(limit_s for each, _, limit_s in TIMERS if each == number)
    raise TimeoutError(f"took more than {limit_s:.0f} s {clock}")


@dataclass
class FileReader:
    """One reader; `read` gets a file with the content, named as a person's would be."""

    name: str
    input: str
    corpus: list[bytes]
    read: Callable[[Path], object]
    file: str
    mutate: Callable[[random.Random, bytes], bytes] = mutate_text

    def __post_init__(self) -> None:
        """A folder of its own for the file."""
        self._folder = tempfile.TemporaryDirectory()
        self._path = Path(self._folder.name) / self.file
        self._path.parent.mkdir(parents=True, exist_ok=True)

    def case(self, content: bytes) -> None:
        """Read it; anything else than acceptance or a sentence is a finding."""
        write_anew(self._path, content)
        before = [signal.signal(number, _timed_out) for number, _, _ in TIMERS]
        for _, timer, limit_s in TIMERS:
            signal.setitimer(timer, limit_s)
        try:
            self.read(self._path)
        except RavenbrickError as error:
            assert error.sentence.strip(), "an error without a sentence"
        except SubmissionError as error:
            assert str(error).strip(), "an error without a sentence"
        finally:
            for (number, timer, _), handler in zip(TIMERS, before, strict=True):
                signal.setitimer(timer, 0)
                signal.signal(number, handler)

    def close(self) -> None:
        self._folder.cleanup()


def _recording() -> bytes:
    cycles = np.arange(50, dtype=np.uint64)
    signals = {"motor.B.angle": Signal(cycles, np.linspace(0.0, 1.0, 50))}
    stop = Stop("reached", 100, "end")
    events = np.zeros(3, dtype=EVENT_TYPE)
    clock = Clock(Fraction(48_054_857))
    made = Recording("step", clock, stop, events, signals, (), (), "0" * 64)
    with tempfile.TemporaryDirectory() as folder:
        made.save(Path(folder) / "r.npz")
        return (Path(folder) / "r.npz").read_bytes()


def _conversation(name: str = "speed", unit: str = "rad/s") -> bytes:
    """What a program with two signals and a parameter says."""
    m = messages
    said: list[m.Message] = [
        m.Hello(m.VERSION, 2, 1, 1_000, "vehicle"),
        m.SignalDescription(0, 0, m.Kind.REAL, name, unit),
        m.SignalDescription(0, 1, m.Kind.WHOLE, "count", ""),
        m.ParameterDescription(0, 0.0, 2.0, 1.0, "kp", unit),
        m.Answer(0, m.Verdict.ACCEPTED, 1.5),
        m.Status(4, 0, 0),
    ]
    said += [m.Sample(0, n, 1_000 + 4_000 * n, (b"\0\0\x80\x3f", b"\1\0\0\0")) for n in range(8)]
    data = FRAME_END + b"".join(frame(m.encode(message)) for message in said)
    return data


def _spooled(path: Path, data: bytes) -> None:
    """Bytes of a line as a record, in pieces, as they come."""
    from ravenbrick.telemetry.spool import Direction, Entry, Spool

    path.unlink(missing_ok=True)
    with Spool(path) as spool:
        spool.add(Entry(Direction.CONNECTED, 0, b""))
        for begin in range(0, len(data), 50):
            spool.add(Entry(Direction.RECEIVED, begin, data[begin : begin + 50]))


def mutate_messages(numbers: random.Random, content: bytes) -> bytes:
    """Messages with wrong fields in right frames, in another order, doubled or lost."""

    contents = FrameReader().feed(content)
    said = [bytes(one) for one in contents]
    for _ in range(numbers.randint(1, 6)):
        at = numbers.randrange(len(said))
        kind = numbers.randrange(4)
        if kind == 0:
            said[at] = mutate_bytes(numbers, said[at])
        elif kind == 1:
            said.insert(numbers.randrange(len(said)), said[at])
        elif kind == 2 and len(said) > 1:
            del said[at]
        else:
            odd = numbers.choice((b"\0\0\xc0\x7f", b"\0\0\x80\x7f", b"\xff" * 4, b"\0\0\0\x80"))
            place = numbers.randrange(1, max(2, len(said[at]) - 3))
            said[at] = said[at][:place] + odd + said[at][place + 4 :]
    return FRAME_END + b"".join(frame(one[:LONGEST_CONTENT]) for one in said if one)


def _monitored(path: Path) -> None:
    """What `ravenbrick monitor` does with the bytes of a line: record, replay, picture, export."""
    data = path.read_bytes()
    record = path.with_suffix(".spool")
    _spooled(record, data)
    session = replay(record)
    session.pending(100.0)
    figure = Figure()
    LiveFigure(figure, session, lambda _text: None).refresh()
    figure.canvas.draw()
    for run in session.runs:
        run.recording()
        signals_figure(run).canvas.draw()


def _texts(*paths: Path) -> list[bytes]:
    return [path.read_bytes() for path in paths]


def _elf(path: Path) -> None:
    memory_report(read_image(path), read_robot(EXAMPLE))


def _submission(path: Path) -> None:
    read_files(Submission("fuzz", path), ("src", "generated"))


def _answered(path: Path) -> None:
    parse_wanted("gain between 1 and 2").judge(read_answers(path.read_bytes()))


def _archive() -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in sorted((ROOT / "examples" / "blank" / "src").iterdir()):
            archive.writestr(f"lab/src/{file.name}", file.read_bytes())
    return packed.getvalue()


def _live_record() -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        LiveRecord("step").save(Path(folder) / "r.json")
        return (Path(folder) / "r.json").read_bytes()


RUN_FILE = {
    "format": "ravenbrick run",
    "version": 1,
    "configuration": {},
    "inputs": [{"at_cycles": 5, "name": "touch.1", "value": 1.0}],
    "until_ms": 100,
    "digest": "0" * 64,
}
BOUNDS = b"""{"image_sha256": "", "tasks": [{"name": "a", "response_bound_cycles": 9},
 {"name": "b", "response_bound_cycles": null}], "worst_paths": {}}"""
FIGURES = b"""{"figures": {"gain": 1.5}, "diagram": "<svg/>", "estimators": [],
 "sampled": {"time": [0, 1], "value": [0, 1.5], "settling_time": 1, "overshoot": 0}}"""
DATA = ROOT / "data" / "virtual"
RECORD = b'{"self_test": 1}\n{"row": "loop", "value": 5, "unit": "cycles"}\n{"finished": 1}\n'
TASKS = b"""schema_version = 1
[[tasks]]
name = "a"
period_us = 4000
deadline_us = 4000
execution_us = 500
priority = 3
"""


def _texts_of_projects(robot: Path) -> list[FileReader]:
    scenarios = sorted((robot / "scenarios").glob("*.toml"))
    rubric = (LESSONS / "rubrics" / "lab-16-2.toml").read_bytes()
    rubric = rubric.replace(b"../../../examples", str(ROOT / "examples").encode())
    read = read_robot(robot)
    rows: list[tuple[str, list[bytes], Callable[[Path], object]]] = [
        ("robot.toml", _texts(robot / "robot.toml"), lambda path: read_robot(path.parent)),
        ("scenario.toml", _texts(*scenarios), lambda path: read_scenario(path, read)),
        ("rubric.toml", [rubric], read_rubric),
        ("tasks.toml", [TASKS], read_task_file),
        ("answers.toml", [b"gain = 1.5\nname = 'x'\n"], _answered),
    ]
    return [FileReader(f"reader, {n}", f"{n}, mutated", c, read, n) for n, c, read in rows]


def _facts(path: Path) -> None:
    """`timing.toml` beside a right robot.toml."""
    for name in ("robot.toml",):
        (path.parent / name).write_bytes((EXAMPLE / name).read_bytes())
    read_facts(read_robot(path.parent))


def file_readers(image: Path) -> list[Callable[[], FileReader]]:
    """Makers of one target for each kind of file."""
    models = sorted((ROOT / "examples" / "paper" / "models").glob("*.slx"))
    plain, bounded = mutate_bytes, read_image(image)
    rows: list[tuple[str, str, list[bytes], Callable[[Path], object], Callable[..., bytes]]] = [
        ("model.slx", "Simulink archives", _texts(*models), read_simulink, mutate_archive),
        ("model.mdl", "old Simulink models", [MODEL], read_simulink, mutate_text),
        ("data.m", "variables of MATLAB", [VARIABLES], read_workspace, mutate_text),
        ("run.npz", "recordings of runs", [_recording()], Recording.load, mutate_archive),
        ("line.bin", "telemetry of a brick", [_conversation(), _conversation("$x_{", "$\\q")],
         _monitored, mutate_messages),
        ("record.rbt", "telemetry records", [_record()], replay, plain),
        ("live.json", "records of live runs", [_live_record()], LiveRecord.load, mutate_text),
        ("page.json", "runs saved in the page", [json.dumps(RUN_FILE).encode()],
         read_run_file, mutate_text),
        ("brick.jsonl", "records of self-tests", [RECORD], read_record, mutate_text),
        ("timing.json", "bounds of an image", [BOUNDS],
         lambda path: read_bounds(path, bounded), mutate_text),
        ("design.json", "figures of a design", [FIGURES], read_design, mutate_text),
        ("class.csv", "lists of a class", [b"id,name\nanna,Anna\nbob.2,Bob\n"],
         read_class, mutate_text),
        ("data.json", "records of open data", _texts(*sorted(DATA.glob("*.json"))),
         read_data_record, mutate_text),
        ("image.elf", "images", [image.read_bytes()], _elf, plain),
        ("student.zip", "submissions", [_archive()], _submission, mutate_archive),
        ("timing.toml", "flow facts", _texts(EXAMPLE / "timing.toml"), _facts, mutate_text),
        ("model/model.h", "headers of generated C", _texts(
            ROOT / "examples" / "paper" / "models" / "functional.h"
        ) if (ROOT / "examples" / "paper" / "models" / "functional.h").is_file() else [HEADER],
         lambda path: read_coder_model(path.parent), mutate_text),
    ]  # fmt: skip
    made = [
        FileReader(f"reader, {Path(file).name}", f"{words}, mutated", corpus, read, file, mutate)
        for file, words, corpus, read, mutate in rows
    ]
    return [functools.partial(_same, one) for one in [*made, *_texts_of_projects(EXAMPLE)]]


def _same(reader: FileReader) -> FileReader:
    return reader


def _record() -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "r.rbt"
        _spooled(path, _conversation())
        return path.read_bytes()


MODEL = b"""Model {
  Name "m"
  System {
    Name "m"
    Block { BlockType Constant Name "c" Value "1" }
    Block { BlockType Gain Name "g" Gain "2*[1 2]" }
    Block { BlockType Outport Name "o" }
    Line { SrcBlock "c" SrcPort 1 DstBlock "g" DstPort 1 }
    Line { SrcBlock "g" SrcPort 1 DstBlock "o" DstPort 1 }
  }
}
"""
VARIABLES = b"a = 3;\nb = [1 2; 3 4] * a;\nc.d = sqrt(b(1, 2)) + 1e3; % words\n"
HEADER = b"""#ifndef RTW_HEADER_model_h_
#define RTW_HEADER_model_h_
#include "rtwtypes.h"
typedef struct { real_T In1; int16_T In2[4]; } ExtU_model_T;
typedef struct { real_T Out1; } ExtY_model_T;
extern ExtU_model_T model_U;
extern ExtY_model_T model_Y;
extern void model_initialize(void);
extern void model_step(void);
#endif
"""
