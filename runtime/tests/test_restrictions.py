# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Programs that violate a restriction of a profile are refused before they run."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

from verification.support.bricks.runtime_programs import RUNTIMES, make_runtime

REJECTED = Path(__file__).parent / "rejected"
SAME = "same"
ACCEPTED = None
RUNTIME_OF = {"ravenscar": "arm", "jorvik": "jorvik"}

# What the compiler says under Ravenscar, and under Jorvik where it says something else
PROGRAMS: dict[str, tuple[str | None, str | None]] = {
    "abort_statement.adb": ("No_Abort_Statements", SAME),
    "allocated_task.ads": ("No_Task_Allocators", SAME),
    "asynchronous_control.adb": ("No_Asynchronous_Control", SAME),
    "complex_barrier.adb": ("Simple_Barriers", ACCEPTED),
    "dates.adb": ("No_Calendar", ACCEPTED),
    "dispatching_domains.adb": ("not a predefined library unit", SAME),
    "dynamic_attachment.adb": ("No_Dynamic_Attachment", SAME),
    "dynamic_priority.adb": ("No_Dynamic_Priorities", SAME),
    "execution_timers.adb": ("not a predefined library unit", SAME),
    "group_budgets.adb": ("not a predefined library unit", SAME),
    "impure_barrier.adb": ("Simple_Barriers", "Pure_Barriers"),
    "local_object.adb": ("No_Local_Protected_Objects", SAME),
    "local_task.adb": ("No_Task_Hierarchy", SAME),
    "priority_queuing.adb": (ACCEPTED, "queuing policy incompatible"),
    "propagated_handler.adb": ("No_Exception_Propagation", SAME),
    "protected_allocator.ads": ("No_Protected_Type_Allocators", SAME),
    "relative_delay.adb": ("No_Relative_Delay", ACCEPTED),
    "requeue_statement.adb": ("No_Requeue_Statements", SAME),
    "select_statement.adb": ("No_Select_Statements", SAME),
    "size_unknown.adb": ("No_Implicit_Heap_Allocations", "No_Implicit_Task_Allocations"),
    "specific_handler.adb": ("No_Specific_Termination_Handlers", SAME),
    "task_attributes.adb": ("No_Task_Attributes_Package", SAME),
    "task_entry.ads": ("Max_Task_Entries", SAME),
    "terminate_alternative.adb": ("No_Terminate_Alternatives", SAME),
    "timing_event.adb": ("No_Local_Timing_Events", SAME),
    "two_entries.adb": ("not allowed in configurable run-time mode", ACCEPTED),
    "unsized_object.ads": (
        "No_Implicit_Heap_Allocations",
        "No_Implicit_Protected_Object_Allocations",
    ),
}


def compiled(program: str, profile: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """The compiler's answer to one program."""
    runtime = RUNTIME_OF[profile]
    make_runtime(runtime)
    return subprocess.run(
        ["arm-linux-gnueabi-gcc-12", "-c", f"--RTS={RUNTIMES[runtime]}", "-gnatA",
         "-mcpu=arm7tdmi", "-mfloat-abi=soft", "-gnatw.X", str(REJECTED / program)],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )  # fmt: skip


@pytest.mark.parametrize("profile", RUNTIME_OF)
@pytest.mark.parametrize("program", PROGRAMS)
def test_a_violation_of_the_profile_does_not_compile(
    program: str, profile: str, tmp_path: Path
) -> None:
    """The compiler says which rule is violated, and admits what Jorvik does."""
    ravenscar, jorvik = PROGRAMS[program]
    reason = ravenscar if profile == "ravenscar" or jorvik is SAME else jorvik
    result = compiled(program, profile, tmp_path)
    if reason is ACCEPTED:
        assert result.returncode == 0, result.stderr
    else:
        assert result.returncode != 0
        assert reason.lower() in result.stderr.lower()


def test_every_program_of_the_folder_is_tested() -> None:
    """No file is left out, but for specifications of bodies and the heap."""
    bodies = {path.name for path in REJECTED.glob("*.adb")}
    alone = {path.name for path in REJECTED.glob("*.ads")} - {f"{name[:-1]}s" for name in bodies}
    assert bodies | alone == set(PROGRAMS) | {"heap.adb"}


def test_an_allocator_does_not_link(tmp_path: Path) -> None:
    """Without a stated size there is no heap: the allocation subprogram asks for it."""
    assert compiled("heap.adb", "ravenscar", tmp_path).returncode == 0
    library = RUNTIMES["arm"] / "adalib" / "libgnat.a"
    symbols = subprocess.run(
        ["arm-none-eabi-nm", str(tmp_path / "heap.o"), str(library)],
        capture_output=True, text=True, check=True,
    ).stdout  # fmt: skip
    assert "U __gnat_malloc" in symbols
    assert "U ravenbrick_heap_size" in symbols
    assert not re.search(r"[ABDT] ravenbrick_heap_size", symbols)
