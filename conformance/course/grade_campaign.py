# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Many generated submissions on one worker, two workers and a local Dask cluster.

`python -m conformance.course.grade_campaign [COUNT]` prints one JSON object: how many results of
each way equal those of one worker, and seconds. Images are built before and kept for all ways,
so `build_seconds` has the builds in it and the others only runs and judgement.
"""

from __future__ import annotations

import importlib.util
import json
import shutil
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ravenbrick.grading.campaign import run_campaign
from ravenbrick.grading.rubric import read_rubric
from ravenbrick.grading.submission import find_submissions

from host.tests.grading.submissions import RUBRIC, variant, write_submission

COUNT = 200
WORKERS = 2
NO_DASK = "the package distributed is not installed: pip install -r tools/requirements-cluster.txt"


def _local_cluster(use: Callable[[str], Any]) -> Any:
    import distributed

    with distributed.LocalCluster(
        n_workers=WORKERS, threads_per_worker=1, host="127.0.0.1", dashboard_address=None
    ) as cluster:
        return use(cluster.scheduler_address)


def measure(count: int = COUNT) -> dict[str, Any]:
    """Grade `count` different submissions in each way."""
    rubric = read_rubric(RUBRIC)
    answer: dict[str, Any] = {"count": count}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for number in range(count):
            write_submission(folder / "all" / f"student-{number:03}", variant(number))
        submissions = find_submissions([folder / "all"])

        def graded(label: str, **options: Any) -> list[dict[str, Any]]:
            shutil.rmtree(folder / "out" / "results", ignore_errors=True)
            start = time.monotonic()
            results = run_campaign(rubric, submissions, folder / "out", **options)
            answer[f"{label}_seconds"] = time.monotonic() - start
            return results

        graded("build", workers=WORKERS)
        single = graded("one_worker", workers=1)
        answer["points"] = sorted({result["points"] for result in single})
        ways = {"two_workers": graded("two_workers", workers=WORKERS)}
        if importlib.util.find_spec("distributed") is not None:
            ways["dask"] = _local_cluster(lambda address: graded("dask", workers=1, dask=address))
        for label, results in ways.items():
            answer[f"{label}_same"] = sum(a == b for a, b in zip(single, results, strict=True))
    return answer


if __name__ == "__main__":
    print(json.dumps(measure(int(sys.argv[1]) if len(sys.argv) > 1 else COUNT)))
