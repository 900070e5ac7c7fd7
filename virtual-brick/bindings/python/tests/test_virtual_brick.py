# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The module as a Python program sees it."""

import ast
import json
import os
import select
import signal
import socket
import struct
import sys
import threading
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
import virtual_brick
from ravenbrick.sources import brick_digest
from virtual_brick import ConfigurationError, ImageError, InputError, VirtualBrick

from verification.support.elf_files import RAM, Elf
from verification.support.gdb_replies import whole_reply

COUNTER = 0x0020_8000
MILLISECOND = 48_055

# LDR r1, =COUNTER; MSR CPSR_c, #0x13; then for ever: r0 += 1, store it.
COUNTING = [0xE59F100C, 0xE321F013, 0xE2800001, 0xE5810000, 0xEAFFFFFC, COUNTER]
HALTING = [0xE1A00000, 0xEAFFFFFE]


def configuration(**changes: Any) -> str:
    """A brick with a touch sensor and nothing else plugged in."""
    fields: dict[str, Any] = {
        "battery": {"kind": "li_ion", "voltage": 8.0},
        "sensors": {"1": {"kind": "touch"}},
    }
    return json.dumps(fields | changes)


def elf(words: list[int]) -> bytes:
    """A program with one function and one object."""
    return Elf().words(RAM, words).function("start", RAM).object("counter", COUNTER, 4).build()


def counting() -> VirtualBrick:
    """A brick that counts for ever."""
    return VirtualBrick(configuration(), elf(COUNTING))


def test_a_run_reaches_its_instant() -> None:
    """A run stops at the first instruction boundary at or after the wanted cycle."""
    brick = counting()
    stop = brick.run_until(MILLISECOND)
    assert (stop.reason, stop.message) == ("reached", "")
    assert MILLISECOND <= stop.at_cycles < MILLISECOND + 4
    assert brick.cycles == stop.at_cycles
    assert RAM <= brick.program_counter < RAM + 4 * len(COUNTING)


def test_a_run_over_instants_ends_at_the_last_or_where_the_run_does() -> None:
    """The stop and the index of the instant that was reached; the run is the same."""
    instants = [MILLISECOND * count for count in range(1, 9)]
    brick, whole = counting(), counting()
    stop, index = brick.run_until_picture(instants, 0, 4)
    assert (stop.reason, index) == ("reached", 3)
    assert instants[3] <= brick.cycles < instants[3] + 4
    whole.run_until(instants[3])
    assert brick.trace_digest() == whole.trace_digest()
    assert brick.run_until_picture(instants, 4, 8)[1] == 7
    with pytest.raises(IndexError):
        brick.run_until_picture(instants, 8, 9)
    stop, index = VirtualBrick(configuration(), elf([0xE7FFFFFF])).run_until_picture(instants, 2, 8)
    assert (stop.reason != "reached", index) == (True, 2)


def test_the_clock_is_an_exact_fraction() -> None:
    """The master clock is 18.432 MHz times 73 over 28."""
    assert counting().clock_hz == (336_384_000, 7)


def test_memory_and_symbols_are_read() -> None:
    """A symbol gives address and size; memory and scalars are read from there."""
    brick = counting()
    brick.run_until(MILLISECOND)
    address, size = brick.symbol("counter")
    assert (address, size) == (COUNTER, 4)
    (value,) = struct.unpack("<I", brick.read_memory(address, size))
    assert value > 1_000
    assert brick.read_int("counter", "u32") == value
    assert brick.read_float("counter", "u32") == float(value)
    assert brick.nearest_code(RAM + 8) == ("start", 8)


def test_a_variable_is_read_as_it_is_now_and_by_the_kind_that_is_asked_for() -> None:
    """Its place is known from the first time; its value is not."""
    brick = counting()
    seen = []
    for until in (50_000, 100_000):
        brick.run_until(until)
        (word,) = struct.unpack("<I", brick.read_memory(COUNTER, 4))
        assert brick.read_int("counter", "u32") == word
        assert brick.read_int("counter", "u8") == word % 256
        seen.append(word)
    assert 0 < seen[0] < seen[1]


def test_variables_lie_where_the_program_of_the_snapshot_has_them() -> None:
    """A snapshot may be of a brick with another program."""
    brick, words = counting(), [*COUNTING[:-1], COUNTER + 64]
    other = Elf().words(RAM, words).function("start", RAM).object("counter", COUNTER + 64, 4)
    another = VirtualBrick(configuration(), other.build())
    for one, until in ((brick, 50_000), (another, 100_000)):
        one.run_until(until)
    counts = [one.read_int("counter", "u32") for one in (brick, another)]
    assert 0 < counts[0] < counts[1]
    brick.restore(another.snapshot())
    assert brick.read_int("counter", "u32") == counts[1]


def test_a_scalar_without_a_known_type_needs_a_kind() -> None:
    """Without debug information and kind the error tells what to give."""
    with pytest.raises(ImageError, match="give its kind"):
        counting().read_int("counter")
    with pytest.raises(ImageError, match="unknown kind `i24`"):
        counting().read_int("counter", "i24")  # type: ignore[arg-type]


def test_a_probe_is_sampled_into_a_signal() -> None:
    """A probe gives one growing value per millisecond."""
    brick = counting()
    brick.add_probe("counter", "u32")
    brick.run_until(10 * MILLISECOND + 1)
    cycles, values = brick.signals()["probe.counter"]
    instants = struct.unpack(f"<{len(cycles) // 8}Q", cycles)
    samples = struct.unpack(f"<{len(values) // 8}d", values)
    assert len(instants) == len(samples) >= 10
    assert list(samples) == sorted(samples) and samples[-1] > samples[1] > samples[0] == 0.0
    assert all(late - early >= MILLISECOND - 8 for early, late in pairwise(instants))


def test_an_unknown_symbol_is_an_image_error() -> None:
    """The error names similar symbols."""
    with pytest.raises(ImageError, match="similar: counter"):
        counting().symbol("Count")


def test_memory_outside_the_chip_is_an_address_error() -> None:
    """Only RAM and flash can be read."""
    with pytest.raises(virtual_brick.AddressError, match="0x80000000"):
        counting().read_memory(0x8000_0000, 4)


def test_a_loop_with_interrupts_masked_halts() -> None:
    """The stop names the place."""
    stop = VirtualBrick(configuration(), elf(HALTING)).run_until(MILLISECOND)
    assert stop.reason == "halted"
    assert "start + 0x4" in stop.message
    assert repr(stop).startswith('Stop(reason="halted", at_cycles=')


def test_a_refused_image_is_an_image_error() -> None:
    """Anything that is not an ARM executable raises."""
    with pytest.raises(ImageError, match="not an ELF file"):
        VirtualBrick(configuration(), b"nonsense")
    with pytest.raises(ImageError, match="truncated"):
        VirtualBrick(configuration(), elf(COUNTING)[:40])


def test_a_refused_configuration_names_the_field() -> None:
    """The path of the field is in the text."""
    with pytest.raises(ConfigurationError, match=r"battery\.voltage"):
        VirtualBrick(configuration(battery={"kind": "aa", "voltage": "high"}), elf(COUNTING))
    with pytest.raises(ConfigurationError, match="wheels"):
        VirtualBrick(configuration(wheels=2), elf(COUNTING))


def test_inputs_are_checked_when_scheduled() -> None:
    """Unknown names, past instants and values that are not numbers raise."""
    brick = counting()
    brick.run_until(100)
    for at, name, value in [(200, "touch.3", 1.0), (99, "touch.1", 1.0), (200, "touch.1", 1e999)]:
        with pytest.raises(InputError, match=name):
            brick.schedule_input(at, name, value)


def test_an_applied_input_is_an_event() -> None:
    """The event holds the index of the name and the bits of the number."""
    brick = counting()
    brick.schedule_input(1_000, "touch.1", 1.0)
    brick.run_until(2_000)
    kinds = {name: number for number, name in VirtualBrick.event_kinds().items()}
    records = list(struct.iter_unpack("<QIIq", brick.events()))
    (at_cycles, _, subject, value) = next(r for r in records if r[1] == kinds["input"])
    assert 1_000 <= at_cycles < 1_004
    assert brick.input_names()[subject] == "touch.1"
    assert struct.unpack("<d", struct.pack("<q", value)) == (1.0,)


def test_the_digest_does_not_depend_on_how_the_run_is_cut() -> None:
    """One long run and many short ones give the same trace; another input another one."""
    whole, cut, other = counting(), counting(), counting()
    for brick in (whole, cut, other):
        brick.schedule_input(70_000, "touch.1", 1.0)
    other.schedule_input(80_000, "touch.1", 0.0)
    for cycles in range(0, 200_000, 777):
        cut.run_until(cycles)
    for brick in (whole, cut, other):
        brick.run_until(200_000)
    assert whole.trace_digest() == cut.trace_digest() != other.trace_digest()
    assert len(whole.trace_digest()) == 64


def test_a_restored_run_repeats_itself() -> None:
    """Going back to a snapshot and on again gives the same trace."""
    brick = counting()
    brick.run_until(50_000)
    snapshot = brick.snapshot()
    brick.run_until(150_000)
    digest, counter = brick.trace_digest(), brick.read_int("counter", "u32")
    brick.restore(snapshot)
    assert brick.cycles < 50_004
    brick.run_until(150_000)
    assert (brick.trace_digest(), brick.read_int("counter", "u32")) == (digest, counter)


def test_other_python_threads_run_during_a_run() -> None:
    """The interpreter lock is released: another thread gets its turn only out of a run."""
    brick = counting()
    turn = threading.Event()
    longest = 60_000 * MILLISECOND

    def run_until_turn() -> None:
        while not turn.is_set() and brick.cycles < longest:
            brick.run_until(brick.cycles + 10 * MILLISECOND)

    interval = sys.getswitchinterval()
    sys.setswitchinterval(1_000.0)
    try:
        runner = threading.Thread(target=run_until_turn)
        runner.start()
        turn.set()
        runner.join()
    finally:
        sys.setswitchinterval(interval)
    assert brick.cycles < longest


@pytest.mark.skipif(not hasattr(os, "fork"), reason="the system has no fork")
@pytest.mark.filterwarnings("ignore:.*multi-threaded, use of fork:DeprecationWarning")
def test_a_brick_runs_on_alike_in_a_forked_process_and_ends_there() -> None:
    """A fork copies the brick, but not the thread that compiles its JIT code."""
    brick = counting()
    brick.run_until(MILLISECOND)
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            brick.run_until(100 * MILLISECOND)
            digest = brick.trace_digest()
            del brick
            os.write(writing, digest.encode())
        finally:
            os._exit(0)
    os.close(writing)
    brick.run_until(100 * MILLISECOND)
    try:
        assert select.select([reading], [], [], 300)[0], "the forked process does not end"
        assert os.read(reading, 64).decode() == brick.trace_digest()
    finally:
        os.close(reading)
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)


def test_the_picture_has_a_byte_per_pixel() -> None:
    """The display is dark before the program turns it on."""
    assert counting().lcd() == bytes(64 * 100)


def test_a_program_without_the_run_time_has_no_threads_and_says_why() -> None:
    """The reason names the missing symbol."""
    brick = counting()
    assert brick.threads() == [] == brick.thread_names()
    assert "ravenbrick_running_thread" in str(brick.threads_unobserved)


def test_the_stub_file_names_exactly_what_the_module_has() -> None:
    """Classes and their public members are the same in the stub and in the module."""
    tree = ast.parse((Path(__file__).parents[1] / "virtual_brick.pyi").read_text())
    for stub in (node for node in tree.body if isinstance(node, ast.ClassDef)):
        members = {item.name for item in stub.body if isinstance(item, ast.FunctionDef)}
        built = getattr(virtual_brick, stub.name)
        present = {name for name in vars(built) if not name.startswith("_")}
        assert {name for name in members if not name.startswith("_")} == present, stub.name
    classes = {node.name for node in tree.body if isinstance(node, ast.ClassDef)}
    exported = {name for name, item in vars(virtual_brick).items() if isinstance(item, type)}
    assert classes == exported


def test_the_module_was_built_from_the_sources_of_this_tree() -> None:
    """Else the tests say nothing about the sources; 'make setup' builds it again."""
    assert virtual_brick.SOURCES == brick_digest(Path(__file__).parents[4])
    assert isinstance(virtual_brick.JIT, bool)


def test_the_debugger_serves_gdb_and_leaves_the_brick_where_the_session_ended() -> None:
    brick = counting()
    replies: list[bytes] = []

    def client(port: int) -> None:
        with socket.create_connection(("127.0.0.1", port), timeout=300) as gdb:
            for packet in (b"$?#3f", b"$s#73"):
                gdb.sendall(packet)
                replies.append(whole_reply(gdb))
            gdb.sendall(b"$k#6b")

    clients: list[threading.Thread] = []

    def listening(port: int) -> None:
        clients.append(threading.Thread(target=client, args=(port,)))
        clients[0].start()

    brick.serve_debugger(on_listening=listening, once=True)
    clients[0].join()
    assert b"T05" in replies[0]
    assert b"T05" in replies[1]
    assert 0 < brick.cycles < 100


def test_the_debugger_stops_when_asked_and_refuses_what_is_no_address() -> None:
    counting().serve_debugger(should_stop=lambda: True)
    with pytest.raises(ValueError):
        counting().serve_debugger(address="nowhere")
    with socket.create_server(("127.0.0.1", 0)) as taken, pytest.raises(OSError):
        counting().serve_debugger(taken.getsockname()[1])
    with pytest.raises(RuntimeError, match="of the caller"):
        counting().serve_debugger(should_stop=lambda: refuse())


def refuse() -> bool:
    raise RuntimeError("of the caller")
