# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Observable behaviour of the run-time: each program of this folder on the virtual brick."""

from __future__ import annotations

import json
import math
import os
import struct
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import virtual_brick
from elftools.elf.elffile import ELFFile

from verification.benchmarks.runtime.footprints import linked_bytes
from verification.support.bricks.runtime_programs import (
    BENCH,
    CYCLES_PER_MS,
    CYCLES_PER_SECOND,
    IDLE,
    PROGRAMS,
    UNITS_PER_SECOND,
    Run,
    Runner,
    build,
    is_in,
)

# A halted program is one that the last-chance handler stopped
RUNNING = "reached"
RAM = 0x0020_0000


FIGURES = (
    "stopwatch", "protected_call", "round_trip", "suspend_to_next", "entry_opened",
    "to_handler", "to_task", "to_handler_max", "to_task_max", "interrupts",
)  # fmt: skip


@pytest.fixture(scope="module")
def periodic(run: Runner) -> Run:
    """Four cyclic tasks for 2 s."""
    return run("periodic", cycles=2_000 * CYCLES_PER_MS)


@pytest.fixture(scope="module")
def figures(run: Runner) -> dict[str, int]:
    """What the program that measures itself found."""
    result = run("figures")
    return dict(zip(FIGURES, result.words("results", len(FIGURES)), strict=True))


@pytest.fixture(scope="module")
def stress() -> Callable[[int], Run]:
    """The program of contending tasks and handlers for 4 s, from a seed put into its image."""

    def run_seeded(seed: int) -> Run:
        elf = build("stress").read_bytes()
        standing = (0x5EED_0001).to_bytes(4, "little")
        assert elf.count(standing) == 1
        brick = virtual_brick.VirtualBrick(
            json.dumps(BENCH), elf.replace(standing, seed.to_bytes(4, "little"))
        )
        return Run(brick, brick.run_until(4_000 * CYCLES_PER_MS))

    return run_seeded


def states_of(elf: Path) -> dict[str, str]:
    """State of each function: bit 0 of a symbol tells Thumb code (ARM IHI 0044F 5.5.3)."""
    with elf.open("rb") as file:
        symbols = list(ELFFile(file).get_section_by_name(".symtab").iter_symbols())
    return {
        symbol.name: "thumb" if symbol["st_value"] & 1 else "arm"
        for symbol in symbols
        if symbol["st_info"]["type"] == "STT_FUNC"
    }


def line_of(program: str, mark: str) -> int:
    """Line of the source of `program` that holds `mark`."""
    source = (PROGRAMS / program / f"{program}.adb").read_text().split("\n")
    return 1 + source.index(next(text for text in source if mark in text))


def assert_repeats(journal: str, pattern: str, at_least: int) -> None:
    """`journal` is `pattern` over and over, cut anywhere, and holds it `at_least` times."""
    assert journal.count(pattern) >= at_least
    assert (pattern * (len(journal) // len(pattern) + 1)).startswith(journal)


def releases_and_starts(result: Run, symbol: str) -> list[tuple[int, int]]:
    """Nominal release and first selection of each job of a task after its first."""
    index = result.thread_index(symbol)
    starts = result.events("thread_running", index)["at"]
    releases = result.events("release", index)["value"][1:]
    positions = np.searchsorted(starts, releases)
    return [
        (int(release), int(starts[position]))
        for release, position in zip(releases, positions, strict=True)
        if position < len(starts)
    ]


def is_alone(result: Run, release: int) -> bool:
    """No other task has a release near, so that no handler or other release is in the way."""
    distances = np.abs(result.events("release")["value"] - release)
    return int((distances < 6_000).sum()) == 1


class TestDispatching:
    def test_a_released_task_of_higher_priority_runs_at_once(self, run: Runner) -> None:
        """Releases nest by priority, and each releaser goes on when the released has blocked."""
        result = run("preemption")
        assert result.stop.reason == RUNNING
        journal = result.journal()
        assert journal.startswith("s")
        assert_repeats(journal[1:55], "lmhHML", 9)

    def test_equal_priorities_run_in_the_order_of_their_release(self, run: Runner) -> None:
        """Three equals run first in, first out, and a delay until the past passes the turn."""
        journal = run("fifo").journal()
        assert journal.startswith("123.")
        assert_repeats(journal[3:], ".cabcabcab", 5)

    def test_a_task_that_yields_lets_its_equals_run(self, run: Runner) -> None:
        """Ada.Dispatching.Yield passes the turn round."""
        assert run("yield").journal() == 10 * "abc"

    def test_a_preempted_task_goes_on_before_its_equals(self, run: Runner) -> None:
        """A busy task that is preempted 190 times never leaves the processor to its equal."""
        result = run("preempted_first")
        assert result.brick.read_int("ticks", "u32") > 190
        assert result.brick.read_int("first", "u32") > 100_000
        assert result.brick.read_int("second", "u32") == 0

    def test_sequential_elaboration_starts_tasks_last(self, run: Runner) -> None:
        """Under the sequential policy tasks start after all elaboration, highest first."""
        assert run("sequential").journal() == "e21mn"


class TestTime:
    PERIODS_UNITS = (28_908, 42_048, 147_168, 1_051_200)
    TASKS = ("cyclic__one", "cyclic__two", "cyclic__three", "cyclic__four")

    def test_periods_do_not_drift(self, periodic: Run) -> None:
        """Each nominal release is the epoch plus a whole number of periods, exactly."""
        for task, period in zip(self.TASKS, self.PERIODS_UNITS, strict=True):
            releases = periodic.events("release", periodic.thread_index(task))["value"][1:]
            start = 5 * UNITS_PER_SECOND // 1_000
            assert len(releases) > 30
            cycles = [math.ceil((start + job * period) * 16 / 7) for job in range(len(releases))]
            epoch = int(releases[0]) - cycles[0]
            assert [int(release) - epoch for release in releases] == cycles

    def test_six_tasks_released_together_have_started_within_1800_cycles(self, run: Runner) -> None:
        """From the common release until the lowest runs; each higher one delays itself again."""
        result = run("six_tasks")
        jobs = [releases_and_starts(result, f"six__t{number}") for number in range(1, 7)]
        assert len(jobs[-1]) >= 15
        for round_of_six in list(zip(*jobs, strict=False))[1:]:
            starts = [start for _, start in round_of_six]
            assert len({release for release, _ in round_of_six}) == 1
            assert starts == sorted(starts)
            assert starts[-1] - round_of_six[0][0] <= 1_800

    def test_no_job_is_lost(self, periodic: Run) -> None:
        """Two seconds hold as many jobs as periods."""
        jobs = periodic.words("jobs", 4)
        for count, period in zip(jobs, self.PERIODS_UNITS, strict=True):
            assert count == (1_995 * UNITS_PER_SECOND // 1_000 - 10_000) // period + 1

    def test_a_task_never_wakes_up_early(self, periodic: Run) -> None:
        """The clock has always reached the wake-up time after a delay."""
        assert all(late >= 0 for late in periodic.words("lateness", 4, "<i4"))

    def test_a_task_that_wakes_up_alone_starts_within_320_cycles(self, periodic: Run) -> None:
        """From the nominal release to the switch, with the 16 cycles of the clock's tick."""
        latencies = [
            start - release
            for release, start in releases_and_starts(periodic, "cyclic__one")
            if is_alone(periodic, release)
        ]
        assert len(latencies) > 1_000
        assert min(latencies) > 0
        assert max(latencies) <= 320

    def test_waking_up_from_idle_varies_by_at_most_20_cycles_and_a_tick(
        self, periodic: Run
    ) -> None:
        """The processor is stopped before, so that only the phases of the counters vary."""
        running = periodic.events("thread_running")
        latencies = []
        for release, start in releases_and_starts(periodic, "cyclic__one"):
            before = running[running["at"] < start][-1]
            if before["subject"] == IDLE and is_alone(periodic, release):
                latencies.append(start - release)
        assert len(latencies) > 1_000
        assert max(latencies) - min(latencies) <= 20 + 16

    def test_the_idle_processor_stops(self, run: Runner) -> None:
        """With nothing to do for seconds, the alarm alone runs the processor, once in 1.4 s."""
        result = run("preemption", cycles=10 * round(CYCLES_PER_SECOND))
        wake_ups = result.events("processor_resumed")
        last_job = result.events("completion")["at"].max()
        assert len(wake_ups[wake_ups["at"] > last_job]) <= 10 / 1.384 + 1

    def test_timing_events_are_set_moved_and_cancelled(self, run: Runner) -> None:
        """In the past at once, else in the order of their times; a moved one once, later."""
        assert_repeats(run("timing_events").journal(), "rspors3c.", 11)

    def test_a_timing_event_repeats_itself_without_drift(self, run: Runner) -> None:
        """Its handler sets it again, 400 us later each time, and is never 1 000 cycles late."""
        result = run("timing_events", cycles=103 * CYCLES_PER_MS)
        assert 248 <= result.brick.read_int("repeated", "u32") <= 251
        assert 0 < result.brick.read_int("latest", "i32") <= 1_000 * 7 / 16

    def test_the_clock_survives_the_wrap_of_the_counter(self, run: Runner) -> None:
        """The 32-bit count wraps at 1 430 s; readings every 100 s go on rising evenly."""
        result = run("long_run", cycles=round(2_050 * CYCLES_PER_SECOND))
        assert result.brick.read_int("jobs", "u32") == 20
        for index, reading in enumerate(result.words("readings", 20, "<i8"), start=1):
            assert 0 <= reading - index * 100 * UNITS_PER_SECOND <= 400


class TestProtectedObjects:
    def test_the_ceiling_keeps_out_tasks_up_to_it(self, run: Runner) -> None:
        """Inside the object, only a task above the ceiling preempts; the others by priority."""
        assert_repeats(run("ceiling").journal(), "(12a)lb;", 20)

    def test_a_caller_above_the_ceiling_gets_program_error(self, run: Runner) -> None:
        """The task at the ceiling passes, the one above stops the program."""
        result = run("ceiling_violation")
        assert result.journal() == "ta"
        assert result.failure() == ("Program_Error: ceiling violated", 0)
        *_, failed, violated = result.words("ravenbrick_failure", 4)
        assert is_in(result, "low_ceiling__above_ceiling", failed)
        assert is_in(result, "low_ceiling__object", violated)

    def test_blocking_in_a_protected_action_gets_program_error(self, run: Runner) -> None:
        """A delay is detected even when the ceiling is the caller's own priority."""
        result = run("blocking_in_action")
        assert result.journal() == "s"
        assert result.failure() == ("Program_Error: blocking in protected action", 0)

    def test_the_opener_of_an_entry_executes_its_body(self, run: Runner) -> None:
        """The waiting task goes on at once when it is higher than the opener, else afterwards."""
        result = run("entries")
        assert_repeats(result.journal(), "wpg1lpgh2", 5)

    def test_entry_parameters_reach_the_caller(self, run: Runner) -> None:
        """The consumer has received the sum of what both producers sent."""
        result = run("entries", cycles=104 * CYCLES_PER_MS)
        assert result.brick.read_int("received", "i32") == 10 * 1 + 9 * 2

    def test_a_second_task_on_an_entry_gets_program_error(self, run: Runner) -> None:
        """Max_Entry_Queue_Length is 1."""
        result = run("second_waiter")
        assert result.journal() == "12"
        assert result.failure() == ("Program_Error: second caller of entry", 0)

    def test_a_suspension_object_keeps_one_release(self, run: Runner) -> None:
        """Set twice it lets one pass and is false again; a second task may not wait."""
        result = run("second_suspended")
        assert result.journal() == "01002"
        assert result.failure() == ("Program_Error: second task suspended", 0)


class TestInterrupts:
    def test_a_higher_level_interrupts_a_handler(self, run: Runner) -> None:
        """Handlers nest by level only; the released task runs after the outermost."""
        assert_repeats(run("nested_interrupts").journal(), "([]|t)s;[](|t)s.", 8)

    def test_an_interrupt_ceiling_keeps_out_handlers_up_to_it(self, run: Runner) -> None:
        """A higher handler comes through, equal and lower ones wait until the object is left."""
        assert_repeats(run("interrupt_ceiling").journal(), "(h)l,[]hl;", 15)

    @pytest.mark.parametrize("seed", [1, 3, 5, 7])
    def test_objects_shared_at_random_instants_keep_their_rules(
        self, stress: Callable[[int], Run], seed: int
    ) -> None:
        """Tasks and handlers contend for nine objects of six ceilings; `checks.ads` has the rules.

        A mask that outlives the protected action it belongs to shows here within a second.
        """
        result = stress(seed)
        assert result.stop.reason == RUNNING
        assert result.words("violations", 6) == [0] * 6
        assert min(result.words("touched", 6)) >= 100
        requests = result.brick.read_int("requests", "u32")
        assert requests - result.brick.read_int("served", "u32") in (0, 1)

    def test_a_handler_opens_an_entry_for_the_waiting_task(self, run: Runner) -> None:
        """Each interrupt of 100 runs the server once, at once, with the handler's data."""
        result = run("handler_entry", cycles=102 * CYCLES_PER_MS)
        journal = result.journal()
        assert journal.startswith("b")
        assert_repeats(journal[1:], "is", 99)
        assert result.brick.read_int("served", "u32") >= 100


class TestFailures:
    def test_a_range_violation_reaches_the_hook_with_file_and_line(self, run: Runner) -> None:
        """The hook of the drivers is called once, then the processor halts."""
        result = run("range_check")
        source = (PROGRAMS / "range_check" / "failing_task.adb").read_text()
        line = 1 + source.split("\n").index(
            next(text for text in source.split("\n") if "the failing line" in text)
        )
        assert result.journal() == "0123456789!"
        assert result.failure() == ("failing_task.adb", line)
        assert result.text_at(result.brick.read_int("hook_message", "u32")) == "failing_task.adb"
        assert result.brick.read_int("hook_line", "i32") == line
        assert result.stop.reason == "halted"

    def test_a_raise_statement_gives_its_message(self, run: Runner) -> None:
        """Without a hook the processor halts all the same."""
        result = run("raise_statement")
        assert result.failure() == ("words of the programmer", 0)
        assert result.stop.reason == "halted"

    @pytest.mark.parametrize(
        ("program", "journal"),
        [("failed_assertion", "a"), ("failed_contract", "a"), ("failed_precondition", "9")],
    )
    def test_a_failed_assertion_tells_file_and_line(
        self, run: Runner, program: str, journal: str
    ) -> None:
        """pragma Assert, Post and Pre, when the assertion policy has them checked."""
        result = run(program)
        assert result.journal() == journal
        assert result.failure() == (f"{program}.adb", line_of(program, "the failing line"))
        assert result.stop.reason == "halted"

    def test_the_message_of_an_assertion_takes_the_place_of_its_file(self, run: Runner) -> None:
        """The compiler passes nothing else, even when the message ends with a number."""
        assert run("assertion_message").failure() == ("journal has 1", 0)

    def test_a_local_handler_takes_an_exception(self, run: Runner) -> None:
        """A handled exception goes on after the handler, an unhandled one halts."""
        result = run("local_handler")
        assert result.journal() == "acd"
        text, line = result.failure() or ("", 0)
        assert text == "local_handler.adb"
        assert line == 24


class TestMemory:
    def test_stacks_have_the_requested_size(self, run: Runner) -> None:
        """The control blocks tell the Storage_Size of each task; the linker's map has it, too."""
        result = run("stacks")
        threads = result.brick.threads()
        sizes = {thread.base_priority: thread.stack_size for thread in threads}
        assert sizes == {7: 4096, 10: 400, 11: 3_000, 13: 512, 3: 600, 4: 600}
        assert result.brick.read_int("asked_bytes", "u32") == 3_000
        for thread in threads[1:]:
            assert 40 <= thread.stack_used <= thread.stack_size

    def test_the_high_water_mark_sees_deep_use(self, run: Runner) -> None:
        """2000 bytes of local data show in the task that has them, not in the others."""
        used = {t.base_priority: t.stack_used for t in run("stacks").brick.threads()}
        assert 2_000 <= used[11] <= 2_200
        assert used[10] <= 200

    def test_a_task_that_ends_is_terminated(self, run: Runner) -> None:
        """So is the environment task after the main procedure; the others go on."""
        states = {t.base_priority: t.state for t in run("stacks").brick.threads()}
        assert states == {7: 5, 10: 2, 11: 2, 13: 5, 3: 2, 4: 2}

    def test_arithmetic_of_tasks_does_not_mix(self, run: Runner) -> None:
        """Two tasks compute in floating point while one preempts the other 500 times."""
        result = run("arithmetic", cycles=300 * CYCLES_PER_MS)
        assert result.brick.read_int("rounds", "u32") == 500

        expected_float = 0.0
        for index in range(1, 501):
            square = struct.unpack("f", struct.pack("f", float(index) ** 2))[0]
            term = struct.unpack("f", struct.pack("f", 1.0 / square))[0]
            expected_float = struct.unpack("f", struct.pack("f", expected_float + term))[0]
        assert result.brick.read_float("sum_of_floats", "f32") == expected_float

        expected_double = 0.0
        for index in range(2_000):
            expected_double += (-4.0 if index % 2 else 4.0) / (2 * index + 1)
        assert result.brick.read_float("sum_of_doubles", "f64") == expected_double
        assert result.brick.read_int("product", "i64") == math.factorial(20)
        address, _ = result.brick.symbol("text")
        assert result.brick.read_memory(address, 12) == b"< 1234.....>"


class TestTermination:
    def test_the_fall_back_handler_is_called_by_each_task_that_ends(self, run: Runner) -> None:
        """At the end of its body, with its identity and the cause Normal; then it is terminated."""
        assert run("termination").journal().startswith("s+Sl+Lt")


class TestTaggedTypes:
    def test_calls_dispatch_over_a_library_level_hierarchy(self, run: Runner) -> None:
        """Overriding, interface and membership need no table of names."""
        result = run("tagged_types")
        assert result.words("areas", 2) == [90, 200]
        assert result.words("kinds", 2) == [1, 2]


class TestImages:
    @pytest.mark.parametrize("image", ["ram", "flash"])
    @pytest.mark.parametrize("code", ["arm", "thumb"])
    @pytest.mark.parametrize("runtime", ["arm", "thumb"])
    def test_both_images_and_both_states_behave_alike(
        self, run: Runner, image: str, code: str, runtime: str
    ) -> None:
        """The same program from RAM and from flash, it and the run-time in either state."""
        journal = run("entries", image=image, code=code, runtime=runtime).journal()
        assert_repeats(journal, "wpg1lpgh2", 5)

    @pytest.mark.parametrize(
        ("program", "pattern", "at_least"),
        [
            ("nested_interrupts", "([]|t)s;[](|t)s.", 8),
            ("interrupt_ceiling", "(h)l,[]hl;", 15),
            ("ceiling", "(12a)lb;", 20),
        ],
    )
    def test_the_run_time_in_thumb_state_dispatches_alike(
        self, run: Runner, program: str, pattern: str, at_least: int
    ) -> None:
        """Handlers, masks and ceilings, the program in Thumb state, too."""
        journal = run(program, code="thumb", runtime="thumb").journal()
        assert_repeats(journal, pattern, at_least)

    def test_the_flash_image_has_time_critical_code_in_ram(self, run: Runner) -> None:
        """Dispatching, delays, locks and entries; what is the program's own stays in flash."""
        brick = run("entries", image="flash").brick
        for symbol in (
            "ravenbrick__threads__block",
            "ravenbrick__delays__delay_until",
            "system__tasking__protected_objects__single_entry__service_entry",
        ):
            assert brick.symbol(symbol)[0] >= RAM
        assert brick.symbol("rendezvous_free__consumerTKB")[0] < RAM

    def test_a_unit_may_be_in_the_other_state(self, run: Runner) -> None:
        """One unit of an ARM program compiled with -mthumb: the program behaves alike."""
        options = ("-XMIXED=yes",)
        journal = run("entries", code="arm", image="flash", options=options).journal()
        assert_repeats(journal, "wpg1lpgh2", 5)
        states = states_of(build("entries", "flash", "arm", options=options))
        assert states["rendezvous_free__consumerTKB"] == "thumb"
        assert states["main"] == "arm"

    def test_a_failure_is_told_by_the_run_time_in_thumb_state(self, run: Runner) -> None:
        """Down to the hook of the program, which is Thumb code, too."""
        result = run("range_check", code="thumb", runtime="thumb")
        assert result.journal() == "0123456789!"

    def test_a_program_is_idle_between_its_jobs(self, run: Runner) -> None:
        """The observer sees the idle processor as no thread at all."""
        result = run("entries")
        running = result.events("thread_running")["subject"]
        assert (running == IDLE).any()
        assert all(a != b for a, b in pairwise(running.tolist()))


class TestFootprint:
    """Tasks, delay until, protected entry, suspension object and interrupts in one program."""

    @pytest.mark.parametrize(("state", "limit_bytes"), [("arm", 6_800), ("thumb", 4_600)])
    def test_kernel_and_language_layer_fit(self, state: str, limit_bytes: int) -> None:
        """Linked code and constants of the run-time, the compiler's helpers included."""
        elf = build("footprint", code=state, runtime=state)
        assert 2_000 < linked_bytes(elf) <= limit_bytes

    @pytest.mark.parametrize("state", ["arm", "thumb"])
    def test_the_weighed_program_works(self, run: Runner, state: str) -> None:
        """Two turns of each period of 2 ms."""
        result = run("footprint", cycles=101 * CYCLES_PER_MS, code=state, runtime=state)
        assert 98 <= result.brick.read_int("turns", "u32") <= 101


class TestFigures:
    """Costs in cycles of programs in RAM and ARM state; goals of the run-time."""

    @pytest.mark.parametrize(
        ("figure", "limit_cycles"),
        [("suspend_to_next", 90), ("entry_opened", 300), ("to_handler", 80), ("to_task", 300)],
    )
    def test_a_primitive_costs_at_most_its_goal(
        self, figures: dict[str, int], figure: str, limit_cycles: int
    ) -> None:
        """As measured by the program itself, less the reading of the stopwatch."""
        assert 0 < figures[figure] - figures["stopwatch"] <= limit_cycles

    def test_a_protected_procedure_costs_at_most_60_cycles(self, figures: dict[str, int]) -> None:
        """Lock and unlock without contention, less a plain call, mean of 100."""
        assert 0 < figures["protected_call"] <= 60 * 100


def test_jorvik_queues(run: Runner) -> None:
    """Several entries, served in the order of declaration, their callers in the order of calls."""
    result = run("jorvik_queues", runtime="jorvik")
    assert result.failure() is None
    assert result.journal() == "a1b23ldce"


by_priority = pytest.param(
    "jorvik-priority",
    "hmlwsp21",
    marks=pytest.mark.skipif(
        not os.environ.get("RAVENBRICK_LONG"),
        reason="builds a library of its own: RAVENBRICK_LONG=1 runs it",
    ),
)


@pytest.mark.parametrize(("runtime", "order"), [("jorvik", "mwlhsp12"), by_priority])
def test_entries_are_served_by_the_policy(run: Runner, runtime: str, order: str) -> None:
    """By the order of declarations and calls, or by the callers' priorities (RM D.4).

    Then a call opens the entry whose barrier asks how many wait on its own (RM 9.5.3), and the
    members of a family are served by their index or by priority.
    """
    result = run("entry_order", runtime=runtime)
    assert result.failure() is None
    assert result.journal() == order


def test_library_units_without_a_heap(run: Runner) -> None:
    """Storage pools, elementary functions, images, packed arrays, atomics and strings of C."""
    result = run("library_units")
    assert result.failure() is None
    assert result.journal() == "abcdefghij"
    angle = 0.5
    expected = (math.sin(angle), math.exp(angle), math.atan2(angle, 2.0), angle**1.5)
    *values, cycles, _ = result.words("results", 6)
    assert values == [pytest.approx(1e6 * value, abs=1) for value in expected]
    assert 500 < cycles < 5_000
