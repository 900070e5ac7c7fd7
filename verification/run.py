# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Run the suites of `suites.toml`, or the benchmarks, and write their results.

`python -m verification.run` runs all suites, two at a time on two processors, and writes
`verification/results.{json,md}`; `--benchmarks` measures the parts of `benchmarks/suites.toml`, one
at a time, into `benchmarks/results.{json,md}`. Data from outside is fetched first. A suite that
cannot run here, or that fails, does not keep the others from running; it keeps its last result,
marked with the date and the reason. Exit code 1: a case failed or a suite gave no result; 2: no
suite has the name.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import sys
import textwrap
import threading
import time
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from tools.docs import tables
from tools.docs.tables import OPTIONAL_KEYS, merge_rows, read_rows
from verification.jobs import Answer, begin_order, grouped, run_jobs
from verification.outside import FetchError, fetch
from verification.table import BENCHMARKS, SUITES, Suite, TableError, chosen, read_suites

Row = dict[str, Any]
REASON_LENGTH = 240


def today() -> str:
    """The date of a row."""
    return time.strftime("%Y-%m-%d", time.gmtime())


def short(text: str) -> str:
    """A reason in one line of the table, cut between two words."""
    return textwrap.shorten(text, REASON_LENGTH, placeholder=" …")


def why_not(answer: Answer) -> str:
    """Why there is no result; empty when there is one."""
    if "error" in answer:
        return f"failed: {answer['error']}"
    return f"not run: {answer['absent']}" if "absent" in answer else ""


def suite_row(suite: Suite, answer: Answer, last: Row | None) -> Row:
    """The row of a suite: its counts, or those of an earlier day with the reason why."""
    head: Row = {"area": suite.area, "suite": suite.name}

    def counted(counts: Row) -> Row:
        needed = {key: counts[key] for key in ("case_count", "passed", "excluded")}
        return {**head, **needed, **{key: counts[key] for key in OPTIONAL_KEYS if counts.get(key)}}

    if "counts" in answer:
        counts, judged = answer["counts"], answer["judged"]
        passed = counts["passed"] == judged
        failures = counts["failures"] or [f"{judged - counts['passed']} of {judged}"]
        # Skipped tests lack data or a program: the last run, which had more of it, says more.
        reasons = "; ".join(str(e["reason"]) for e in counts["excluded"])
        if passed and reasons and last and last["passed"] > judged and suite.kind == "pytest":
            return {**last, "note": short(f"{today()}: only {judged} cases can run: {reasons}")}
        return {
            **counted(counts),
            "date": today(),
            **{key: answer[key] for key in ("elapsed_s", "processor_s")},
            "note": "" if passed else short(f"failed: {'; '.join(failures)}"),
        }
    empty: Row = {"case_count": 0, "passed": 0, "excluded": [], "elapsed_s": 0, "processor_s": 0}
    kept = last or {**head, **empty, "date": ""}
    if "held" in answer and answer["date"] >= kept["date"]:
        kept = {**empty, **counted(answer["held"]), "date": answer["date"]}
    return {**kept, "note": short(f"{today()}: {why_not(answer)}")}


@dataclass
class Campaign:
    """A run: shows progress, writes each row when it is there, and counts."""

    table: Path
    suites: list[Suite]
    rows: list[Row] = field(default_factory=list)
    failed: dict[str, str] = field(default_factory=dict)
    kept: dict[str, str] = field(default_factory=dict)
    processor_s: float = 0.0
    done: int = 0

    def __post_init__(self) -> None:
        self.lock = threading.RLock()
        self.start = time.monotonic()
        self.results = self.table.with_name("results.json")
        self.last = {row.get("suite", ""): row for row in read_rows(self.results)}

    def minutes(self, suite: Suite) -> float:
        """How long the suite took last time, or is thought to take."""
        row = self.last.get(suite.name, {})
        return row["elapsed_s"] / 60 if row.get("elapsed_s") else suite.minutes

    def show(self, suite: Suite, text: str) -> None:
        """A line of progress."""
        number = self.suites.index(suite) + 1
        about = f", about {self.minutes(suite):.1f} min" if text == "begins" else ""
        head = f"[{number}/{len(self.suites)}] {suite.area}: {suite.name}"
        with self.lock:
            print(f"{head}: {text}{about}", file=sys.stderr, flush=True)

    def answered(self, suite: Suite, answer: Answer) -> None:
        """Keep and show the answer of a suite."""
        with self.lock:
            self.done += 1
            self.processor_s += answer.get("processor_s", 0.0)
            if self.table == BENCHMARKS:
                rows = answer.get("figures", [])
                text = "; ".join(f"{r['figure']}: {r['value']:.5g} {r['unit']}" for r in rows)
                note = why_not(answer)
            else:
                rows = [suite_row(suite, answer, self.last.get(suite.name))]
                judged = answer.get("judged", 0)
                text = f"{answer['counts']['passed']} of {judged}" if "counts" in answer else ""
                note = rows[0]["note"]
            if note:
                failed = "failed: " in note
                (self.failed if failed else self.kept)[suite.name] = note
                text = f"{text}\n{_causes(answer)}"
            took = f"{answer.get('elapsed_s', 0):.0f} s"
            self.show(suite, f"{text} ({took}; {self.done} of {len(self.suites)} done)")
            self.rows += rows
            key = ("figure", "peer") if self.table == BENCHMARKS else ("suite",)
            merge_rows(self.results, rows, key)
            tables.main([])

    def summary(self) -> str:
        """A line for each area, and one for each suite that failed or did not run."""
        minutes = (time.monotonic() - self.start) / 60
        passed = self.done - len(self.failed) - len(self.kept)
        lines = [
            f"{self.done} suites in {minutes:.0f} min, {self.processor_s / 60:.0f} min of a "
            f"processor: {passed} passed, {len(self.failed)} failed, {len(self.kept)} not run"
        ]
        for area in dict.fromkeys(suite.area for suite in self.suites):
            rows = [r for r in self.rows if r.get("area") == area]
            if rows:
                cases, good = (sum(r[key] for r in rows) for key in ("case_count", "passed"))
                left = sum(e["count"] for r in rows for e in r["excluded"])
                lines.append(
                    f"  {area:<12} {len(rows):>2} suites {cases:>7} cases {good:>7} passed "
                    f"{left:>5} excluded {sum(r['elapsed_s'] for r in rows) / 60:>6.1f} min"
                )
        lines += [f"FAILED {name}: {note}" for name, note in self.failed.items()]
        lines += [f"not run, last result kept: {name}: {note}" for name, note in self.kept.items()]
        return "\n".join(lines)


def _causes(answer: Answer) -> str:
    """What failed or is absent, with the first lines of the cause, and the log."""
    counts = answer.get("counts", {})
    lines = counts.get("failures") or answer.get("error", answer.get("absent", "")).splitlines()
    if not lines:
        lines = [str(e["reason"]) for e in counts.get("excluded", [])]
    lines = [line[:200] for line in lines[:10]]
    lines += [f"all output: {answer['log']}"] if "log" in answer else []
    return "\n".join(f"    {line}" for line in [*lines, ""])


def fetch_data(suites: list[Suite]) -> dict[str, str]:
    """Fetch data from outside that is absent; why not, by the data's name."""
    absent = {d.name: d for s in suites for d in s.data() if not d.compiled and d.place() is None}
    reasons = {}
    for name, data in absent.items():
        print(f"fetching {name}: {data.sources()}", file=sys.stderr, flush=True)
        try:
            fetch(data)
        except FetchError as error:
            reasons[name] = str(error)
            print(f"  not fetched: {error}", file=sys.stderr, flush=True)
    return reasons


def run_suites(table: Path, suites: list[Suite], processors: int) -> Campaign:
    """Run what can run; the others keep their rows."""
    campaign = Campaign(table, suites)
    ready = []
    for suite in suites:
        if reason := suite.missing():
            campaign.answered(suite, {"absent": reason})
        else:
            ready.append(suite)
    jobs = begin_order(grouped(ready), campaign.minutes)
    run_jobs(table, jobs, processors, campaign.show, campaign.answered)
    return campaign


def list_text(suites: list[Suite], minutes: dict[str, float]) -> str:
    """One line for each suite: area, truth, minutes, name, what it is compared with."""
    lines = []
    for suite in suites:
        lacks = f"; not here: {reason}" if (reason := suite.missing()) else ""
        lines.append(
            f"{suite.area:<12} {suite.truth:<8} {minutes[suite.name]:>5.1f} min  {suite.name} "
            f"({suite.compared_with}{lacks})"
        )
    return "\n".join(lines)


def options_of(arguments: list[str] | None) -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(prog="python -m verification.run", description=__doc__)
    parser.add_argument(
        "--benchmarks", action="store_true", help="run benchmarks instead of suites"
    )
    parser.add_argument(
        "--only", nargs="+", default=[], metavar="WORD", help="areas, or parts of suite names"
    )
    parser.add_argument("--list", action="store_true", help="list the suites without running them")
    parser.add_argument("--json", action="store_true", help="result as JSON on standard output")
    parser.add_argument("--offline", action="store_true", help="fetch no data from outside")
    parser.add_argument(
        "--processors", type=int, default=os.cpu_count() or 1, help="suites at a time"
    )
    return parser.parse_args(arguments)


def main(arguments: list[str] | None = None) -> int:
    """Run, write results and tables; returns the exit code."""
    options = options_of(arguments)
    table = BENCHMARKS if options.benchmarks else SUITES
    try:
        suites = chosen(read_suites(table), options.only)
    except TableError as error:
        print(error, file=sys.stderr)
        return 2
    if options.list:
        about = Campaign(table, suites)
        minutes = {suite.name: about.minutes(suite) for suite in suites}
        listed = [{**asdict(s), "minutes": minutes[s.name]} for s in suites]
        print(json.dumps(listed) if options.json else list_text(suites, minutes))
        return 0
    if not options.offline:
        fetch_data(suites)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))
    campaign = run_suites(table, suites, 1 if options.benchmarks else options.processors)
    print(json.dumps(campaign.rows, indent=1) if options.json else campaign.summary())
    return 1 if campaign.failed else 0


if __name__ == "__main__":
    sys.exit(main())
