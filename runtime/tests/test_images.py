# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Images in RAM and flash, in ARM and Thumb state: behaviour, size and costs."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import pytest
from elftools.elf.constants import SH_FLAGS
from elftools.elf.elffile import ELFFile

from verification.support.bricks.runtime_programs import (
    CYCLES_PER_MS,
    IDLE,
    Runner,
    assert_repeats,
    build,
)

RAM = 0x0020_0000


def states_of(elf: Path) -> dict[str, str]:
    """State of each function: bit 0 of a symbol tells Thumb code (ARM IHI 0044F 5.5.3)."""
    with elf.open("rb") as file:
        symbols = list(ELFFile(file).get_section_by_name(".symtab").iter_symbols())
    return {
        symbol.name: "thumb" if symbol["st_value"] & 1 else "arm"
        for symbol in symbols
        if symbol["st_info"]["type"] == "STT_FUNC"
    }


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

    @pytest.mark.parametrize("state", ["arm", "thumb"])
    def test_the_flash_image_says_that_its_variables_change(self, state: str) -> None:
        """The analysis of execution times takes what is not writable for constants."""
        with build("entries", "flash", state, state).open("rb") as file:
            elf = ELFFile(file)
            flags = {s.name: s["sh_flags"] for s in elf.iter_sections() if s["sh_addr"] >= RAM}
        assert set(flags) == {".low", ".data", ".code_in_ram", ".bss"}
        changing = {name for name, bits in flags.items() if bits & SH_FLAGS.SHF_WRITE}
        assert changing == {".low", ".data", ".bss"}

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

    @pytest.mark.parametrize("state", ["arm", "thumb"])
    def test_the_footprint_program_works(self, run: Runner, state: str) -> None:
        """Two turns of each period of 2 ms."""
        result = run("footprint", cycles=101 * CYCLES_PER_MS, code=state, runtime=state)
        assert 98 <= result.brick.read_int("turns", "u32") <= 101
