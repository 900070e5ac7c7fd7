# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The process in which `verification.run` runs suites, one after another.

`python -m verification.job TABLE NAME ...` prints one line of JSON for each suite on standard
output; all that a suite prints goes to standard error.
"""

from __future__ import annotations

import json
import os
import sys
import time
import traceback
from dataclasses import asdict
from pathlib import Path
from typing import Any

from verification.built_examples import build_example
from verification.commands import NoResultError, NotRunError, counts_of, function_of
from verification.processor_time import processor_s
from verification.table import BENCHMARKS, Suite, read_suites

__all__ = ["answer"]


def _result(suite: Suite, figures: bool) -> dict[str, Any]:
    for example in (*(("vehicle",) if suite.kind == "pytest" else ()), *suite.examples):
        build_example(example)  # the tests take the vehicle as built, as with `make test`
    if figures:
        found = function_of(str(suite.command))(*suite.arguments)
        return {"figures": [asdict(figure) for figure in found]}
    counts = counts_of(suite.kind, suite.command, suite.arguments)
    return {"counts": asdict(counts), "judged": counts.judged}


def answer(suite: Suite, figures: bool = False) -> dict[str, Any]:
    """Its counts or figures, or the `error` that ended it, or what is `absent`; and its time.

    Beside what is absent, the counts that are `held` of an earlier `date`, if the suite has some.
    """
    start, used = time.monotonic(), processor_s()
    found: dict[str, Any]
    try:
        found = _result(suite, figures)
    except NotRunError as error:
        found = {"absent": str(error)}
        if error.held is not None:
            found |= {"held": asdict(error.held), "date": error.date}
    except (NoResultError, SystemExit) as error:
        found = {"error": str(error)}
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        # A panic of the compiled module is not an `Exception`.
        traceback.print_exc()
        found = {"error": f"{type(error).__name__}: {error}"}
    elapsed, processor = time.monotonic() - start, processor_s() - used
    return {**found, "elapsed_s": round(elapsed, 1), "processor_s": round(processor, 1)}


def main(arguments: list[str]) -> int:
    """The answers of the suites; 0, whatever they are."""
    table, names = Path(arguments[0]), arguments[1:]
    with os.fdopen(os.dup(1), "w") as answers:
        os.dup2(2, 1)
        suites = {suite.name: suite for suite in read_suites(table)}
        for name in names:
            print(json.dumps(answer(suites[name], table == BENCHMARKS)), file=answers, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
