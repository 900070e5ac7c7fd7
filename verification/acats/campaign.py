# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Build and run the tests, write the table `results.md`.

`python -m verification.acats.campaign [TEST ...]` runs all tests or those whose names begin so.
Verdicts are kept in the build folder, so that an interrupted campaign continues; the outcome of
each test is in `build/verification/acats/results.json`.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import re
import sys
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path

from verification.acats.adaptation import MEMORY, Adaptation, AdaptationError, adaptations
from verification.acats.build import Builder, BuildError, Image, Memory
from verification.acats.execution import Verdict, execute
from verification.acats.judgement import is_only_ravenscar, judge, judge_refused
from verification.acats.suite import EXECUTED, REJECTED, AcatsTest, Suite, SuiteMissingError
from verification.acats.table import table
from verification.commands import Counts
from verification.support.bricks.runtime_programs import RUNTIMES, make_runtime
from verification.support.paths import BUILD

__all__ = ["REJECTED", "Outcome", "SuiteMissingError", "adapted", "run", "whole"]

HERE = Path(__file__).resolve().parent
TABLE = HERE / "results.md"
WORKERS = 2
PROFILES = {"ravenscar": "arm", "jorvik": "jorvik", "jorvik-priority": "jorvik-priority"}
"""Names of the run-times in `RUNTIMES`."""
ADAPTED = ("adapted",)
"""In place of a chapter: programs that the folder `adaptations` makes from tests."""
WORK = BUILD / "verification" / "acats"
LESS_HEAP = Memory(heap_bytes=4_096)
"""Of a test that does not fit otherwise."""
DOES_NOT_FIT = re.compile(r"will not fit in region|overflowed by")


@dataclass(frozen=True)
class Outcome:
    """A test's line of the results: `status` is passed, failed or excluded."""

    test: str
    chapter: str
    profile: str
    status: str
    reason: str


class Profile:
    """A run-time with the builder for it and what its tests have shown so far."""

    def __init__(self, suite: Suite, name: str) -> None:
        self.name = name
        make_runtime(PROFILES[name])
        self.rts = RUNTIMES[PROFILES[name]]
        self.builder = Builder(suite, self.rts, WORK / name)
        self.builder.prepare()
        self.tight = Builder(suite, self.rts, WORK / name, LESS_HEAP)
        self.digest = self._digest()
        self.record = WORK / f"{name}.jsonl"
        self.known: dict[str, BuildError | Verdict] = {}
        if self.record.exists():
            for line in self.record.read_text().splitlines():
                entry = json.loads(line)
                if entry["digest"] == self.digest:
                    refused, ran = entry["refused"], entry["ran"]
                    self.known[entry["test"]] = BuildError(*refused) if refused else Verdict(**ran)

    def _digest(self) -> str:
        digest = hashlib.sha256()
        own = [HERE / f"{name}.py" for name in ("suite", "build", "execution")]
        kinds = ("*.a", "*.ads", "*.ld")
        paths = [path for kind in kinds for path in self.rts.rglob(kind)]
        paths += (HERE / "support").iterdir()
        for path in [*sorted(paths), *own]:
            digest.update(path.read_bytes())
        return digest.hexdigest()

    def _image(self, test: AcatsTest) -> Image:
        """Raises BuildError."""
        try:
            return self.builder.build(test)
        except BuildError as refusal:
            if not DOES_NOT_FIT.search(str(refusal)):
                raise
            return self.tight.build(test)

    def _found(self, test: AcatsTest) -> BuildError | Verdict:
        """Build and run, and note what happened."""
        if test.name in self.known:
            return self.known[test.name]
        found: BuildError | Verdict
        try:
            image = self._image(test)
            found = replace(execute(image.elf), removed_handlers=image.removed_handlers)
        except BuildError as refusal:
            found = refusal
        refused = [found.step, found.reasons] if isinstance(found, BuildError) else None
        ran = None if isinstance(found, BuildError) else asdict(found)
        entry = {"test": test.name, "digest": self.digest, "refused": refused, "ran": ran}
        with self.record.open("a") as file:
            file.write(json.dumps(entry) + "\n")
        return found

    def outcome(self, test: AcatsTest) -> Outcome:
        """The judgement on what happened."""
        judgement = judge_refused if test.chapter in REJECTED else judge
        return Outcome(test.name, test.chapter, self.name, *judgement(test, self._found(test)))


def _one(ravenscar: Profile, jorvik: Profile, test: AcatsTest) -> Outcome:
    """With the smaller profile when it admits the test, else with the larger one."""
    outcome = ravenscar.outcome(test)
    return jorvik.outcome(test) if is_only_ravenscar(outcome.reason) else outcome


def run(names: list[str], workers: int) -> list[Outcome]:
    """Outcomes of the tests whose names begin with one of `names`, of all when there is none."""
    suite = Suite.fetched()
    WORK.mkdir(parents=True, exist_ok=True)
    ravenscar, jorvik = Profile(suite, "ravenscar"), Profile(suite, "jorvik")
    tests = [
        test
        for test in suite.tests((*EXECUTED, *REJECTED))
        if not names or test.name.startswith(tuple(names))
    ]
    outcomes = []
    start = time.monotonic()
    with ThreadPoolExecutor(workers) as pool:
        waiting = [pool.submit(_one, ravenscar, jorvik, test) for test in tests]
        for number, future in enumerate(as_completed(waiting), 1):
            outcomes.append(future.result())
            if sys.stdout.isatty() or number % 200 == 0 or number == len(tests):
                failed = sum(o.status == "failed" for o in outcomes)
                seconds = time.monotonic() - start
                end = "\r" if number < len(tests) else "\n"
                text = f"[{number}/{len(tests)}] {failed} failed, {seconds:.0f} s"
                print(text, end=end, file=sys.stderr, flush=True)
    return sorted(outcomes, key=lambda o: o.test)


def _adapted_one(suite: Suite, rule: Adaptation, test: AcatsTest) -> Outcome:
    """Build and run one adapted program."""
    folder = WORK / "adapted" / rule.name
    builder = Builder(suite, RUNTIMES[PROFILES[rule.profile]], folder, MEMORY)
    builder.shared = WORK / rule.profile / "shared"
    try:
        image = builder.build(rule.apply(suite, test, folder / "sources"))
    except (BuildError, AdaptationError) as refusal:
        return Outcome(rule.name, *ADAPTED, rule.profile, "failed", str(refusal))
    found = execute(image.elf)
    if rule.expected:
        passed = found.word == "raised" and bool(re.match(rule.expected, found.text))
    else:
        passed = found.word == "passed"
    reason = rule.what if passed else f"{found.word}: {found.text}".replace("\n", " ")
    return Outcome(rule.name, *ADAPTED, rule.profile, "passed" if passed else "failed", reason)


def adapted() -> list[Outcome]:
    """Outcomes of the adapted tests; their packages are prepared as for the others."""
    suite = Suite.fetched()
    for name in PROFILES:
        Profile(suite, name)
    tests = {test.name: test for test in suite.tests(EXECUTED)}
    return [_adapted_one(suite, rule, tests[rule.test]) for rule in adaptations()]


def write(outcomes: list[Outcome]) -> None:
    """The results and their table."""
    rows = [asdict(o) for o in outcomes]
    lines = ",\n".join(json.dumps(row, sort_keys=True) for row in rows)
    (WORK / "results.json").write_text(f"[\n{lines}\n]\n")
    TABLE.write_text(table(rows))


@cache
def whole() -> list[Outcome]:
    """Run all tests and write the results and their table."""
    outcomes = [*run([], WORKERS), *adapted()]
    write(outcomes)
    return outcomes


def suite(kind: str) -> Counts:
    """Programs that run ("run"), are adapted ("adapted") or must be refused ("refused")."""
    kinds = dict.fromkeys(REJECTED, "refused") | dict.fromkeys(ADAPTED, "adapted")
    outcomes = [o for o in whole() if kinds.get(o.chapter, "run") == kind]
    reasons = Counter(o.reason for o in outcomes if o.status == "excluded")
    excluded = [{"count": n, "reason": reason} for reason, n in reasons.most_common()]
    return Counts(len(outcomes), sum(o.status == "passed" for o in outcomes), excluded)


def main(arguments: list[str]) -> int:
    """Run the campaign; 1 when a test failed, 2 when the suite is not there."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("tests", nargs="*", help="prefixes of test names (default: all tests)")
    parser.add_argument("--workers", type=int, default=WORKERS)
    parser.add_argument("--json", action="store_true", help="print the outcomes as JSON")
    options = parser.parse_args(arguments)
    try:
        outcomes = run(options.tests, options.workers) if options.tests else whole()
    except SuiteMissingError as missing:
        print(missing, file=sys.stderr)
        return 2
    failed = [o for o in outcomes if o.status == "failed"]
    if options.json:
        print(json.dumps([asdict(o) for o in outcomes]))
    else:
        for outcome in failed:
            print(f"{outcome.test}: {outcome.reason}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
