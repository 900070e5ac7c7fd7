# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The fuzzing campaign: every target for the same time, first its corpus, then mutated content.

`python -m verification.fuzz.campaign [SECONDS [SEED]]` runs each target for so many seconds of a
processor, so that it may run beside other work (`chrt --idle 0`), and adds its cases and time to
`verification/fuzz/results.json` as it ends; another campaign waits for its end. Of that
docs/reference/fuzzing.md is made. A target with a finding counts anew in the next campaign. Inputs
with a finding are kept in build/fuzz/findings; `--repeat FILE` runs such a file again.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import random
import resource
import shutil
import subprocess
import sys
import threading
import traceback
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context, parent_process
from pathlib import Path
from typing import Any

from ravenbrick.image.locks import locked

from tools.docs import tables
from verification.commands import Counts, NoResultError
from verification.fuzz.targets import Target, targets
from verification.processor_time import processor_s
from verification.support.paths import ROOT

RESULTS = ROOT / "verification" / "fuzz" / "results.json"
CORPUS = Path(__file__).resolve().parent / "corpus"
BUILD = ROOT / "build" / "fuzz"
PROGRAM = BUILD / "corpus" / "image" / "program.elf"
Row = dict[str, Any]
TARGET_SECONDS = 20
CAMPAIGN = "that runs the fuzzing campaign"
COUNTED = ("seconds", "case_count", "findings")
GROWTH_MAX_KB = 512 * 1024
# Of the Rust targets.
INPUTS = {
    "damaged image": "ELF files with and without debug information, mutated; run if accepted",
    "damaged configuration": "JSON with wrong bytes; a brick is run if it is accepted",
    "random program": "random words as ARM and Thumb code",
    "random register writes": "programs that write random values to all peripherals",
    "random inputs": "inputs of random names, values and instants, not-a-numbers among them",
}


def build_image() -> None:
    """The image with debug information; built in the folder with the corpus of the Rust targets."""
    folder = PROGRAM.parents[1]
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(CORPUS / "configuration", folder / "configuration")
    PROGRAM.parent.mkdir()
    options = ["-g", "-Og", "-mcpu=arm7tdmi", "-nostdlib", "-Wl,-Ttext=0x202000"]
    source = str(Path(__file__).resolve().parent / "program.c")
    subprocess.run(["arm-none-eabi-gcc", *options, "-o", str(PROGRAM), source], check=True)


def run_rust_target(name: str, seconds: int, seed: int) -> Row:
    """A target of the Rust facade; its cases are those of consecutive seeds."""
    command = ["setpriv", "--pdeathsig", "KILL"]  # it ends with this process
    command += ["cargo", "run", "--locked", "--quiet", "--release", "-p", "virtual-brick"]
    command += ["--example", "fuzz", "--", str(seconds), str(seed << 32)]
    command += [str(BUILD / "corpus"), name]
    crates = ROOT / "virtual-brick"
    done = subprocess.run(command, cwd=crates, capture_output=True, text=True)
    if not done.stdout.strip():
        raise NoResultError(f"fuzz: no result\n{done.stderr[-2000:]}")
    print(done.stderr, end="", file=sys.stderr)
    (row,) = json.loads(done.stdout)
    return {
        "target": name,
        "input": INPUTS[name],
        "corpus": row["corpus"],
        "seconds": seconds,
        "case_count": row["case_count"],
        "findings": row["case_count"] - row["passed"],
    }


def _passes(target: Target, content: bytes) -> bool:
    """Whether a case passed; an input with a finding is kept."""
    try:
        target.case(content)
    except KeyboardInterrupt:
        raise
    except BaseException:
        # A panic of the compiled module is not an `Exception`.
        folder = BUILD / "findings"
        folder.mkdir(parents=True, exist_ok=True)
        file = folder / f"{target.name.replace(', ', '-').replace(' ', '-')}-{_name(content)}.bin"
        file.write_bytes(content)
        cause = traceback.format_exc(limit=-1).strip()
        print(f"{target.name}: {file}\n{cause}", file=sys.stderr)
        return False
    return True


def _name(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:8]


def fuzz_target(target: Target, seconds: float, seed: int) -> Row:
    """Corpus, then mutated content until the time of the processor is over."""
    numbers = random.Random(seed)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    end = processor_s() + seconds
    results = [_passes(target, content) for content in target.corpus]
    while processor_s() < end:
        content = target.mutate(numbers, numbers.choice(target.corpus))
        results.append(_passes(target, content))
    growth = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    if growth > GROWTH_MAX_KB:
        print(f"{target.name}: memory grew by {growth} KB", file=sys.stderr)
        results.append(False)
    return {
        "target": target.name,
        "input": target.input,
        "corpus": len(target.corpus),
        "seconds": round(seconds),
        "case_count": len(results),
        "findings": results.count(False),
    }


def _run(group: str | int, seconds: int, seed: int) -> Row:
    """The row of a Rust target by its name, or of a Python target by its number."""
    if isinstance(group, str):
        return run_rust_target(group, seconds, seed)
    target = targets(PROGRAM)[group]()
    try:
        return fuzz_target(target, seconds, seed)
    finally:
        target.close()


def _end_with_campaign() -> None:
    """However it ends, its processes do not go on."""
    campaign = parent_process()
    assert campaign is not None

    def wait() -> None:
        campaign.join()
        os._exit(1)

    threading.Thread(target=wait, daemon=True).start()


def added(row: Row, held: list[Row]) -> list[Row]:
    """The rows held, by name, with what a target's run adds to its own."""
    rows = {one["target"]: one for one in held}
    before = rows.get(row["target"], {})
    if before.get("findings"):
        before = {}  # They were corrected since, so that earlier cases say nothing.
    rows[row["target"]] = row | {name: row[name] + before.get(name, 0) for name in COUNTED}
    return [rows[name] for name in sorted(rows)]


def campaign(seconds: int = TARGET_SECONDS, seed: int = 1, processors: int = 1) -> list[Row]:
    """Every target; the rows, each of which is written as it comes, added to those held."""
    build_image()
    held = tables.read_rows(RESULTS)
    groups = [*INPUTS, *range(len(targets(PROGRAM)))]
    random.Random(seed).shuffle(groups)  # a campaign may be stopped
    # A process for each group: what one leaves in memory is not another's.
    spawned = get_context("spawn")
    with ProcessPoolExecutor(
        processors, spawned, _end_with_campaign, max_tasks_per_child=1
    ) as pool:
        rows = []
        for done in as_completed(pool.submit(_run, group, seconds, seed) for group in groups):
            row = done.result()
            print("{target}: {case_count} cases, {findings} findings".format(**row), flush=True)
            held = added(row, held)
            tables.write_rows(RESULTS, held)
            rows.append(row)
    ran = {row["target"] for row in rows}
    tables.write_rows(RESULTS, [row for row in held if row["target"] in ran])
    return rows


def suite() -> Counts:
    """Cases of all targets, and those that were handled.

    RAVENBRICK_FUZZ_HOURS: so many hours of a processor, divided among the targets.
    """
    hours = float(os.environ.get("RAVENBRICK_FUZZ_HOURS", 0))
    with locked(BUILD, CAMPAIGN):
        build_image()
        groups = len(INPUTS) + len(targets(PROGRAM))
        rows = campaign(round(3_600 * hours / groups) or TARGET_SECONDS)
    count = sum(row["case_count"] for row in rows)
    return Counts(count, count - sum(row["findings"] for row in rows))


def repeat_finding(file: Path) -> int:
    """Run a kept input again with the target in its name; raises as the target does."""
    build_image()
    for make in targets(PROGRAM):
        target = make()
        if file.name.startswith(target.name.replace(", ", "-").replace(" ", "-")):
            target.case(file.read_bytes())
            print("passed")
            return 0
    raise SystemExit(f"{file}: no target in its name")


def main() -> int:
    """The campaign, its page; 1 when something was found."""
    parser = argparse.ArgumentParser(description="Give invalid input to every reader and peer.")
    parser.add_argument("seconds", nargs="?", type=int, default=TARGET_SECONDS, help="each target")
    parser.add_argument("seed", nargs="?", type=int, default=1)
    parser.add_argument("--processors", type=int, default=1)
    parser.add_argument("--repeat", type=Path, metavar="FILE", help="run a kept input again")
    chosen = parser.parse_args()
    with locked(BUILD, CAMPAIGN):
        if chosen.repeat:
            return repeat_finding(chosen.repeat)
        rows = campaign(chosen.seconds, chosen.seed, chosen.processors)
    tables.main([])
    return 1 if any(row["findings"] for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
