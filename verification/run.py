# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Run every suite against outside truth and write `verification/results.{json,md}`.

`python -m verification.run [AREA ...]` runs all suites or those of the named areas. A suite that
fails is written down with what passed, and the command ends with 1. The environment variable ACATS
names the folder of the Ada conformity suite, which is no part of the project.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree as ElementTree
from collections import Counter
from collections.abc import Callable
from pathlib import Path

from tools.docs import tables
from tools.docs.tables import Row, merge_rows
from verification.acats import campaign
from verification.control import blocks, identification
from verification.plant import points as plant_points
from verification.timing import suites

ROOT = Path(__file__).resolve().parent.parent
RESULTS = ROOT / "verification" / "results.json"
CARGO = "cargo"
LOCKED = "--locked"
CRATES = ROOT / "virtual-brick"
CAMPAIGN_SECONDS = 100
PUBLIC_CASES = 38_000
NXT_FIRMWARE = Path("/usr/share/nxt-firmware/nxt_firmware.bin")


def suite_row(
    area: str, suite: str, case_count: int, passed: int, excluded: list[Row] | None = None
) -> Row:
    """One row of the results file."""
    return {
        "area": area,
        "suite": suite,
        "case_count": case_count,
        "passed": passed,
        "excluded": excluded or [],
    }


def single_step() -> Row:
    """The processor against the vectors of an independent core: state, writes and cycles."""
    vectors = ROOT / "verification" / "processor" / "arm7tdmi-single-step.tar.xz"
    row = cargo_example("arm7tdmi", "single_step", str(vectors))
    excluded = [
        {"count": 0, "reason": f"no case, but of {e['class']} the {e['comparison']}: {e['reason']}"}
        for e in row["excluded"]
    ]
    return {**row, "excluded": excluded}


def cargo_example(package: str, example: str, *arguments: str) -> Row:
    """The summary that an example of a crate prints as its last line."""
    command = [CARGO, "run", LOCKED, "--quiet", "--release", "-p", package]
    command += ["--example", example, "--", *arguments]
    result = subprocess.run(command, cwd=CRATES, capture_output=True, text=True)
    if not result.stdout.strip():
        raise SystemExit(f"{example}: no result\n{result.stderr[-2000:]}")
    row: Row = json.loads(result.stdout.strip().splitlines()[-1])
    return row


def public_single_step() -> Row:
    """SingleStepTests/ARM7TDMI, whose files lie outside: see verification/processor/README.md."""
    folder = os.environ.get("ARM7TDMI_SINGLE_STEP_TESTS")
    suite = "single-step, public"
    if not folder:
        reason = (
            "the environment variable ARM7TDMI_SINGLE_STEP_TESTS does not name the folder with "
            "the suite's files (verification/processor/README.md)"
        )
        return suite_row("cpu", suite, PUBLIC_CASES, 0, [{"count": PUBLIC_CASES, "reason": reason}])
    return cargo_example("arm7tdmi", "public_single_step", folder)


def gba_tests() -> Row:
    """jsmolka/gba-tests, whose two programs lie outside: see verification/processor/README.md."""
    folder = os.environ.get("JSMOLKA_GBA_TESTS")
    suite = "jsmolka/gba-tests: arm.gba, thumb.gba"
    if not folder:
        reason = (
            "the environment variable JSMOLKA_GBA_TESTS does not name the folder with arm.gba and "
            "thumb.gba (verification/processor/README.md)"
        )
        return suite_row("cpu", suite, 2, 0, [{"count": 2, "reason": reason}])
    row = cargo_example("arm7tdmi", "gba_tests", folder)
    return suite_row("cpu", suite, row["case_count"], row["passed"])


def engines() -> Row:
    """Random programs with code of the host, in blocks and step by step, for a time."""
    row = cargo_example("virtual-brick", "compare_engines", str(CAMPAIGN_SECONDS))
    return suite_row(row["area"], row["suite"], row["case_count"], row["passed"])


def fuzz() -> Row:
    """Damaged files, random programs, registers and inputs, hostile peers, each for a time."""
    from verification.fuzz.campaign import campaign

    rows = campaign()
    seconds, count = sum(r["seconds"] for r in rows), sum(r["case_count"] for r in rows)
    given = "images, configurations, programs, registers, inputs, snapshots, peers"
    suite = f"fuzz for {seconds} s: {given}"
    return suite_row("peripherals", suite, count, count - sum(r["findings"] for r in rows))


def published_points() -> Row:
    """Values of the plant with a published band; writes its page."""
    count, good, excluded = plant_points.outcome(plant_points.measure())
    suite = "published points within their bands, four parameter sets"
    return suite_row("plant", suite, count, good, excluded)


def cargo_suite(area: str, suite: str, package: str, *options: str) -> Callable[[], Row]:
    """The tests of a crate; `options` of `cargo test` may choose among them."""

    def run() -> Row:
        command = [CARGO, "test", LOCKED, "-p", package, *options]
        result = subprocess.run(command, cwd=CRATES, capture_output=True, text=True)
        counts = re.findall(r"test result: \S+ (\d+) passed; (\d+) failed", result.stdout)
        passed = sum(int(p) for p, _ in counts)
        failed = sum(int(f) for _, f in counts)
        if result.returncode != 0 and failed == 0:
            raise SystemExit(f"{suite}: did not build\n{result.stderr[-2000:]}")
        return suite_row(area, suite, passed + failed, passed)

    return run


def third_party(path: Path, package: str, run: Callable[[], Row]) -> Callable[[], Row]:
    """A suite that runs the file of a Debian package; excluded as a whole while it is absent."""

    def run_when_present() -> Row:
        if path.exists():
            return run()
        row = run()
        reason = f"{path} is absent: install the Debian package {package}"
        return {**row, "passed": 0, "excluded": [{"count": row["case_count"], "reason": reason}]}

    return run_when_present


def pytest_suite(area: str, suite: str, *paths: str) -> Callable[[], Row]:
    """Python tests under the paths; skipped ones are excluded with their reasons."""

    def run() -> Row:
        with tempfile.TemporaryDirectory() as folder:
            report = Path(folder) / "report.xml"
            command = [sys.executable, "-m", "pytest", "-q", f"--junitxml={report}", *paths]
            everything = {**os.environ, "RAVENBRICK_LONG": "1"}
            subprocess.run(command, cwd=ROOT, capture_output=True, text=True, env=everything)
            root = ElementTree.parse(report).getroot()
        cases = list(root.iter("testcase"))
        skipped = Counter(
            node.get("message", "no reason given") for c in cases for node in c.findall("skipped")
        )
        failed = [c for c in cases if c.find("failure") is not None or c.find("error") is not None]
        excluded = [{"count": n, "reason": reason} for reason, n in sorted(skipped.items())]
        passed = len(cases) - len(failed) - sum(skipped.values())
        return suite_row(area, suite, len(cases), passed, excluded)

    return run


def block_costs() -> Row:
    """Every block and the paper's controller in C and Ada on the virtual brick; writes its page."""
    count, good = blocks.main()
    return suite_row("control", "blocks: C and Ada on the virtual brick", count, good)


def page_suite() -> Row:
    """Elements on an imitation of a browser, then the page itself in headless Chromium."""
    name = "page: elements, and end to end in Chromium"
    built = subprocess.run([str(ROOT / "tools" / "page")], capture_output=True, text=True)
    if built.returncode != 0:
        reason = (built.stderr.strip().splitlines() or ["make page failed"])[-1]
        return suite_row("tools", name, 1, 0, [{"count": 1, "reason": reason}])
    count = passed = 0
    for options in ([], ["--config", "vitest.e2e.config.ts"]):
        with tempfile.TemporaryDirectory() as folder:
            report = Path(folder) / "report.json"
            command = ["npx", "--no-install", "vitest", "run", *options]
            command += ["--reporter=json", f"--outputFile={report}"]
            subprocess.run(command, cwd=ROOT / "web", capture_output=True, text=True)
            results: Row = json.loads(report.read_text())
        count += results["numTotalTests"]
        passed += results["numPassedTests"]
    return suite_row("tools", name, count, passed)


def identified_motors() -> Row:
    """Hidden motors on the virtual brick: each parameter's interval in at least 95 of 100 runs."""
    count, good = identification.main()
    return suite_row("control", "identification: true value inside in 95 of 100 runs", count, good)


def grade_campaign() -> Row:
    """200 submissions: two workers and a Dask cluster give the results of one worker."""
    from verification.course import grade_campaign as campaign

    answer = campaign.main()
    count, same = answer["count"], answer["same"]
    excluded = [] if len(same) == 2 else [{"count": count, "reason": campaign.NO_DASK}]
    suite = "grade: 200 submissions on 2 workers and Dask as on 1"
    return suite_row("course", suite, 2 * count, sum(same.values()), excluded)


def site_suite() -> Row:
    """The documentation site and its links."""
    from verification.course import site

    return suite_row("course", site.SUITE, *site.measure())


def acats(suite: str, kind: str) -> Callable[[], Row]:
    """Tests of the Ada conformity suite: programs that run, are adapted, or must be refused."""
    kinds = dict.fromkeys(campaign.REJECTED, "refused") | dict.fromkeys(campaign.ADAPTED, "adapted")

    def run() -> Row:
        try:
            outcomes = [o for o in campaign.whole() if kinds.get(o.chapter, "run") == kind]
        except campaign.SuiteMissingError as missing:
            return suite_row("runtime", suite, 0, 0, [{"count": 0, "reason": str(missing)}])
        passed = sum(o.status == "passed" for o in outcomes)
        reasons = Counter(o.reason for o in outcomes if o.status == "excluded")
        excluded = [{"count": n, "reason": reason} for reason, n in reasons.most_common()]
        return suite_row("runtime", suite, len(outcomes), passed, excluded)

    return run


RESTRICTIONS = "runtime/tests/test_restrictions.py"
HOST_TESTS = "host/tests"
BLOCKS = (f"{HOST_TESTS}/model/test_blocks.py", f"{HOST_TESTS}/codegen/test_block_c.py")
FIXED_POINT = (
    f"{HOST_TESTS}/model/test_fixed_point.py",
    f"{HOST_TESTS}/codegen/test_fixed_point_c.py",
    f"{HOST_TESTS}/codegen/test_frama_c.py",
    f"{HOST_TESTS}/control/test_limit_cycles.py",
    f"{HOST_TESTS}/control/test_peak_gain.py",
)
FIRMWARE = f"{HOST_TESTS}/firmware"
MISRA = (f"{HOST_TESTS}/codegen/test_misra.py",)
SLX = (
    f"{HOST_TESTS}/model/test_simulink.py",
    f"{HOST_TESTS}/model/test_simulink_blocks.py",
    f"{HOST_TESTS}/cli/test_import.py",
    "verification/control/test_simulink_model.py",
)
NXTWAY = (f"{HOST_TESTS}/control/test_nxtway.py",)
DIGEST = (
    f"{HOST_TESTS}/page/test_digest.py",
    f"{HOST_TESTS}/page/test_page.py::test_a_drive_in_the_browser_is_the_drive_of_the_command_line",
)
GDB = (f"{HOST_TESTS}/cli/test_debug.py", f"{HOST_TESTS}/cli/test_debug_programs.py")
IDE = f"{HOST_TESTS}/cli/test_ide.py"
TRAPS = (
    f"{HOST_TESTS}/image/test_build.py",
    f"{HOST_TESTS}/image/test_build_errors.py",
    f"{HOST_TESTS}/cli/test_failures.py",
    f"{HOST_TESTS}/cli/test_first_lines.py",
    f"{HOST_TESTS}/cli/test_interrupt.py",
    f"{HOST_TESTS}/cli/test_debugging_build.py",
    f"{HOST_TESTS}/cli/test_doctor.py",
    f"{HOST_TESTS}/cli/test_vs_code.py",
    f"{HOST_TESTS}/trace/test_report.py",
    "tools/tests/test_setup.py",
    "tools/tests/test_environment.py",
)
PATHS = (f"{HOST_TESTS}/image/test_paths.py", "tools/tests/test_paths.py")
WHEEL = "tools/tests/test_dist.py"
GRADERS = (f"{HOST_TESTS}/project/test_criteria.py", f"{HOST_TESTS}/cli/test_grading.py")
STIMULI = f"{HOST_TESTS}/project/test_stimuli.py"
EXPORT = (f"{HOST_TESTS}/trace/test_export.py", f"{HOST_TESTS}/trace/test_real_runs.py")


def other_control() -> list[str]:
    """Control tests that have no suite of their own, with the controller on the brick."""
    named = {*BLOCKS, *FIXED_POINT, *MISRA, *NXTWAY, *SLX}
    found = (ROOT / HOST_TESTS).glob("[cm]o*/test_*.py")
    files = {path.relative_to(ROOT).as_posix() for path in found}
    return [*sorted(files - named), "examples/vehicle/tests/test_controller_on_the_brick.py"]


ENCODER_STRESS = "drivers/tests/test_encoder_stress.py"
COMPATIBILITY = "drivers/tests/test_compatibility.py"
NXT_PYTHON = "drivers/tests/test_nxt_python.py"
SCRIPTED = ("drivers/tests/test_scripted.py", "drivers/tests/test_bus_log.py")
COLOR_AS_LEGO = "drivers/tests/test_color_as_lego.py"
BROWN_OUT = "drivers/tests/test_brown_out.py"
BRICK_TELEMETRY = ("drivers/tests/test_telemetry.py", "drivers/tests/test_frames.py")


def other_drivers() -> list[str]:
    """Drivers' tests that have no suite of their own."""
    files = {path.relative_to(ROOT).as_posix() for path in ROOT.glob("drivers/tests/test_*.py")}
    named = {ENCODER_STRESS, COMPATIBILITY, NXT_PYTHON, COLOR_AS_LEGO, BROWN_OUT}
    return sorted(files - named - {*SCRIPTED, *BRICK_TELEMETRY})


LAB_SHEETS = "tools/tests/test_lessons.py"

SUITES: list[tuple[str, Callable[[], Row]]] = [
    ("cpu", single_step),
    ("cpu", public_single_step),
    ("cpu", gba_tests),
    ("cpu", engines),
    ("cpu", cargo_suite("cpu", "instructions, exceptions, silicon cycle table", "arm7tdmi")),
    ("peripherals", cargo_suite("peripherals", "registers and behaviour", "at91sam7s")),
    ("peripherals", cargo_suite("peripherals", "board devices", "nxt")),
    ("peripherals", fuzz),
    (
        "firmware",
        third_party(
            NXT_FIRMWARE,
            "nxt-firmware",
            cargo_suite(
                "firmware",
                "nxt-firmware 1.29.2: menu, buttons, motor, power-off",
                "virtual-brick",
                "--release",
                "--test=nxt_firmware",
            ),
        ),
    ),
    (
        "firmware",
        third_party(
            NXT_FIRMWARE,
            "nxt-firmware",
            cargo_suite(
                "firmware",
                "nxt-firmware 1.29.2: direct commands over USB",
                "virtual-brick",
                "--release",
                "--test=nxt_firmware_usb",
            ),
        ),
    ),
    (
        "firmware",
        pytest_suite(
            "firmware",
            "nxt-python 3.5.1 as client of nxt-firmware, Bluetooth and USB",
            f"{FIRMWARE}/test_nxt_python.py",
        ),
    ),
    (
        "firmware",
        pytest_suite(
            "firmware",
            "two bricks with nxt-firmware joined by Bluetooth",
            f"{FIRMWARE}/test_two_bricks.py",
        ),
    ),
    (
        "firmware",
        pytest_suite(
            "firmware",
            "images of six firmware families boot to their picture",
            "verification/firmware/test_images.py",
        ),
    ),
    (
        "firmware",
        pytest_suite(
            "firmware",
            "boot monitor: load-and-go and flashing as libnxt does them",
            f"{FIRMWARE}/test_boot_monitor.py",
        ),
    ),
    (
        "firmware",
        pytest_suite(
            "firmware",
            "nxc: a program compiled with nbc on nxt-firmware",
            f"{FIRMWARE}/test_nxc.py",
        ),
    ),
    ("plant", cargo_suite("plant", "published motor points, body", "plant")),
    ("plant", published_points),
    (
        "plant",
        pytest_suite(
            "plant",
            "FMI 2 and FMI 3 units as the body",
            f"{HOST_TESTS}/brick/test_fmu_body.py",
        ),
    ),
    (
        "peripherals",
        pytest_suite(
            "peripherals",
            "USB/IP for host tools, hostile peers on the sockets",
            f"{HOST_TESTS}/brick/test_live_sockets.py",
        ),
    ),
    (
        "peripherals",
        pytest_suite(
            "peripherals",
            "snapshot files: restored runs, damaged files",
            f"{HOST_TESTS}/brick/test_snapshot.py",
        ),
    ),
    ("runtime", pytest_suite("runtime", "behaviours on the virtual brick", "runtime/tests")),
    ("drivers", pytest_suite("drivers", "drivers on the virtual brick", *other_drivers())),
    (
        "drivers",
        pytest_suite("drivers", "encoder counts at 2,000 deg/s on three motors", ENCODER_STRESS),
    ),
    (
        "drivers",
        pytest_suite("drivers", "source compatibility: every operation of GNAT GPL", COMPATIBILITY),
    ),
    (
        "drivers",
        pytest_suite(
            "drivers",
            "source compatibility: course programs for GNAT GPL, unchanged",
            "verification/compatibility",
        ),
    ),
    (
        "drivers",
        pytest_suite(
            "drivers", "power-cut at every step of 36 savings to flash", "verification/power_cut"
        ),
    ),
    (
        "drivers",
        pytest_suite("drivers", "nxt-python: direct commands over USB and Bluetooth", NXT_PYTHON),
    ),
    (
        "drivers",
        pytest_suite("drivers", "scripted peripherals: exact logs of every bus", *SCRIPTED),
    ),
    (
        "drivers",
        pytest_suite(
            "drivers",
            "colours: LEGO's firmware and NXT.Color_Sensors name the same",
            COLOR_AS_LEGO,
        ),
    ),
    (
        "drivers",
        pytest_suite("drivers", "brown-out and dead battery at each moment of a saving", BROWN_OUT),
    ),
    ("runtime", pytest_suite("runtime", "restriction programs are refused", RESTRICTIONS)),
    ("runtime", acats("ACATS: programs that the profiles admit", "run")),
    ("runtime", acats("ACATS: tests adapted to library level", "adapted")),
    ("runtime", acats("ACATS: restriction programs are refused", "refused")),
    (
        "runtime",
        pytest_suite(
            "runtime", "no drift in 24 h of virtual time", "verification/runtime/test_drift.py"
        ),
    ),
    ("control", pytest_suite("control", "blocks: definition, simulation, C", *BLOCKS)),
    ("control", block_costs),
    ("control", identified_motors),
    ("control", pytest_suite("control", "fixed-point: C, proofs, error bounds", *FIXED_POINT)),
    ("control", pytest_suite("control", "misra: C:2012 by cppcheck", *MISRA)),
    ("control", pytest_suite("control", "nxtway: published gains", *NXTWAY)),
    (
        "control",
        pytest_suite(
            "control",
            "coder: public models of Embedded Coder on the brick",
            "verification/control/test_coder_models.py",
        ),
    ),
    ("control", pytest_suite("control", "slx: Simulink models, written and public", *SLX)),
    ("control", pytest_suite("control", "paper's loop, tuning, generated C", *other_control())),
    (
        "timing",
        pytest_suite("timing", "textbook cases, random task sets", "host/tests/schedule"),
    ),
    ("tools", pytest_suite("tools", "digest: native = Python = Node.js = browser", *DIGEST)),
    ("tools", pytest_suite("tools", "gdb: debugger, forwards and backwards", *GDB)),
    ("tools", pytest_suite("tools", "gdb: files for VS Code and OpenOCD, by their schemas", IDE)),
    ("tools", pytest_suite("tools", "trap: the first line after each mistake", *TRAPS)),
    ("tools", pytest_suite("tools", "wheel: used without the tree", WHEEL)),
    ("tools", pytest_suite("tools", "paths: spaces, quotes, letters, links, length", *PATHS)),
    ("tools", pytest_suite("tools", "run --expect, stimuli", *GRADERS, STIMULI)),
    ("tools", pytest_suite("tools", "perfetto: read by its library", *EXPORT, "-k", "perfetto")),
    ("tools", pytest_suite("tools", "vcd: read by its library", *EXPORT, "-k", "vcd")),
    ("tools", pytest_suite("tools", "mcap: read by its library", *EXPORT, "-k", "mcap")),
    ("tools", pytest_suite("tools", "csv and parquet: read back", *EXPORT, "-k", "csv or parquet")),
    ("tools", page_suite),
    ("timing", suites.random_sets),
    ("timing", lambda: suites.wcet_benchmarks("arm", "O1")),
    ("timing", lambda: suites.wcet_benchmarks("thumb", "O2")),
    ("timing", lambda: suites.input_search("arm", "O1")),
    ("timing", lambda: suites.input_search("thumb", "O2")),
    ("timing", suites.kernel_services),
    ("timing", suites.integer_program),
    ("timing", suites.program_campaign),
    ("timing", suites.lowest_tasks),
    ("timing", suites.timing_events),
    ("timing", suites.examples),
    ("course", pytest_suite("course", "the paper's vehicle, whole drive", "examples/vehicle")),
    ("course", pytest_suite("course", "bench, line, balancer", "examples/test_examples.py")),
    (
        "course",
        pytest_suite(
            "course",
            "template: from new to a run, files by their schemas",
            "host/tests/cli/test_new.py",
            "host/tests/cli/test_template_files.py",
        ),
    ),
    (
        "course",
        pytest_suite(
            "course",
            "nxtway: published gains on the run-time, a minute under pushes",
            "examples/test_nxtway.py",
            *NXTWAY,
        ),
    ),
    ("course", pytest_suite("course", "lab sheets executed, solutions graded", LAB_SHEETS)),
    ("course", pytest_suite("course", "grade: rubrics, sandbox, reports", "host/tests/grading")),
    ("course", grade_campaign),
    ("course", site_suite),
    (
        "course",
        pytest_suite(
            "course",
            "telemetry: host, brick, link losses",
            *BRICK_TELEMETRY,
            "host/tests/telemetry",
            "examples/test_live.py",
        ),
    ),
    (
        "course",
        pytest_suite(
            "course",
            "upload: bus, failures in words, libnxt on the virtual brick",
            "host/tests/hardware/test_upload.py",
            "host/tests/hardware/test_upload_replay.py",
        ),
    ),
]


def main(areas: list[str]) -> int:
    """Run, write results and tables; 1 when a case failed."""
    unknown = sorted(set(areas) - set(tables.AREAS))
    if unknown:
        print(f"no such area: {', '.join(unknown)}; there are {', '.join(tables.AREAS)}")
        return 2
    chosen = [run for area, run in SUITES if not areas or area in areas]
    failed = 0
    for number, run in enumerate(chosen, 1):
        start = time.monotonic()
        row = run()
        judged = row["case_count"] - sum(e["count"] for e in row["excluded"])
        failed += judged - row["passed"]
        name = f"{row['area']}: {row['suite']}"
        seconds = time.monotonic() - start
        print(f"[{number}/{len(chosen)}] {name}: {row['passed']} of {judged} ({seconds:.0f} s)")
        merge_rows(RESULTS, [row], ("area", "suite"))
    tables.main([])
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
