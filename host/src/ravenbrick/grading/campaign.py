# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Many submissions: in parallel, resumable, the same results whatever the number of workers."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import asdict
from pathlib import Path
from typing import Any

from ravenbrick.atomic_write import atomic_write
from ravenbrick.errors import UsageError
from ravenbrick.grading.rubric import Rubric
from ravenbrick.grading.sandbox import allow_sessions, end_sessions
from ravenbrick.grading.submission import Submission
from ravenbrick.grading.work import Job, grade_one, prepare_base
from ravenbrick.installation import optional_module

__all__ = ["on_cluster", "run_campaign"]

Result = dict[str, Any]


def _stored(results: Path, submission: Submission) -> Path:
    return results / f"{submission.name}.json"


def _kept(results: Path, submission: Submission, digest: str) -> Result | None:
    """A result of an interrupted campaign with the same rubric and the same files."""
    try:
        kept: Result = json.loads(_stored(results, submission).read_text("utf-8"))
    except (OSError, ValueError):
        return None
    return kept["result"] if kept.get("of") == digest else None


def _keep(results: Path, submission: Submission, digest: str, result: Result) -> None:
    content = json.dumps({"of": digest, "result": result}, indent=1)
    atomic_write(_stored(results, submission), content)


def _stamp(rubric: Rubric, submission: Submission) -> str:
    """Changes with the rubric and with any file of the submission."""
    files = [submission.path]
    if submission.path.is_dir():
        files = sorted(path for path in submission.path.rglob("*") if path.is_file())
    states = [(str(f), f.stat().st_size, f.stat().st_mtime_ns) for f in files]
    return f"{rubric.digest} {states}"


def _with_threads(jobs: dict[str, Job], workers: int) -> Iterator[tuple[str, Result]]:
    """Each thread only waits for the processes of its submission."""
    allow_sessions()
    with ThreadPoolExecutor(workers) as pool:
        futures = {pool.submit(grade_one, job): name for name, job in jobs.items()}
        try:
            for future in as_completed(futures):
                yield futures[future], future.result()
        except BaseException:
            end_sessions()
            pool.shutdown(cancel_futures=True)
            raise


def _on_cluster(values: dict[str, Any]) -> Result:
    return grade_one(Job(**values))


def on_cluster(
    work: Callable[[dict[str, Any]], Result], jobs: dict[str, dict[str, Any]], address: str
) -> Iterator[tuple[str, Result]]:
    """On the workers of a Dask scheduler, which must see the same folders."""
    distributed = optional_module("distributed", "distributed", "cluster", "work on a cluster")
    try:
        client = distributed.Client(address, timeout=20)
    except (OSError, ValueError) as error:
        raise UsageError(f"no Dask scheduler answers at '{address}' ({error})") from None
    with client:
        futures = {client.submit(work, values, pure=False): name for name, values in jobs.items()}
        for future, result in distributed.as_completed(futures, with_results=True):
            yield futures[future], result


def run_campaign(
    rubric: Rubric,
    submissions: list[Submission],
    folder: Path,
    workers: int,
    dask: str | None = None,
    design: bool = False,
    progress: Callable[[float], None] = lambda share: None,
) -> list[Result]:
    """Results in the order of the submissions; `folder` keeps them and the images."""
    folder = folder.resolve()
    results, cache = folder / "results" / rubric.name, folder / "cache"
    stamps = {s.name: _stamp(rubric, s) for s in submissions}
    done = {s.name: _kept(results, s, stamps[s.name]) for s in submissions}
    waiting = [s for s in submissions if done[s.name] is None]
    if waiting and rubric.needs_image:
        prepare_base(rubric, cache)
    jobs = {
        s.name: Job(str(rubric.path.resolve()), s.name, str(s.path.resolve()), str(cache), design)
        for s in waiting
    }
    by_name = {s.name: s for s in submissions}
    plain = {name: asdict(job) for name, job in jobs.items()}
    if dask and jobs:
        stream = on_cluster(_on_cluster, plain, dask)
    else:
        stream = _with_threads(jobs, max(workers, 1))
    for count, (name, result) in enumerate(stream, len(submissions) - len(waiting) + 1):
        done[name] = result
        if "defect" not in result:
            _keep(results, by_name[name], stamps[name], result)
        progress(count / len(submissions))
    return [finished for s in submissions if (finished := done[s.name]) is not None]
