# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Many submissions: in parallel, resumable, the same results whatever the number of workers."""

from __future__ import annotations

import hashlib
import json
import os
import secrets
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import asdict
from pathlib import Path
from typing import Any

from ravenbrick.atomic_write import atomic_write
from ravenbrick.errors import UsageError
from ravenbrick.grading.build import prepare_base
from ravenbrick.grading.isolation import find_isolation, isolation_named
from ravenbrick.grading.rubric import Rubric
from ravenbrick.grading.sandbox import allow_sessions, end_sessions
from ravenbrick.grading.submission import Submission, states
from ravenbrick.grading.work import Job, failed_result, grade_one
from ravenbrick.image.locks import locked
from ravenbrick.installation import optional_module

__all__ = ["campaign_secret", "on_cluster", "run_campaign"]

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


def _stamp(job: Job, submission: Submission) -> str:
    """Changes with the rubric, with how it is graded and with any file of the submission."""
    given = (job.rubric_digest, job.isolation, job.secret, job.design, job.class_key)
    how = (*given, list(states(submission)))
    return hashlib.sha256(repr(how).encode("utf-8", "replace")).hexdigest()


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
    work: Callable[[dict[str, Any]], Result],
    jobs: dict[str, dict[str, Any]],
    address: str,
    failed: Callable[[str, str], Result] | None = None,
) -> Iterator[tuple[str, Result]]:
    """On the workers of a Dask scheduler, which must see the same folders.

    A job that takes its workers with it gives the result of `failed`, or raises without one.
    """
    distributed = optional_module("distributed", "distributed", "cluster", "work on a cluster")
    try:
        client = distributed.Client(address, timeout=20)
    except (OSError, ValueError) as error:
        raise UsageError(f"no Dask scheduler answers at '{address}' ({error})") from None
    with client:
        futures = {client.submit(work, values, pure=False): name for name, values in jobs.items()}
        for future in distributed.as_completed(futures):
            name = futures[future]
            if failed and future.status == "error":
                yield name, failed(name, f"{future.exception()}")
            else:
                yield name, future.result()


def _remove_unfinished(folder: Path) -> None:
    """What a killed campaign had not finished writing."""
    for file in folder.rglob("*.part"):
        file.unlink(missing_ok=True)


def campaign_secret(folder: Path, given: str | None) -> str:
    """What hidden seeds are drawn from: given, or drawn once for this folder."""
    file = folder / "secret"
    if given is None and file.is_file():
        return file.read_text("utf-8")
    secret = secrets.token_hex(16) if given is None else given
    atomic_write(file, secret)
    file.chmod(0o600)
    return secret


def run_campaign(
    rubric: Rubric,
    submissions: list[Submission],
    folder: Path,
    workers: int,
    dask: str | None = None,
    design: bool = False,
    border: str | None = None,
    secret: str | None = None,
    progress: Callable[[float], None] = lambda share: None,
    class_key: bytes | None = None,
) -> list[Result]:
    """Results in the order of the submissions; `folder` keeps them and the images.

    Hidden seeds are drawn from `secret`, by default one that `folder` keeps. With `class_key` each
    submission is graded by the variant of its name. Raises `IsolationError` where submissions
    cannot be isolated, by default by what is found.
    """
    if class_key is not None and rubric.individual is None:
        raise UsageError(
            f"the rubric '{rubric.name}' has no table [individual]; grade without the class key"
        )
    isolation = isolation_named(border) if border else find_isolation()
    folder = folder.resolve()
    with locked(folder, "that grades into this folder"):
        _remove_unfinished(folder)
        drawn_from = campaign_secret(folder, secret)
        if rubric.needs_image:
            prepare_base(isolation, rubric, folder / "cache")
        jobs = {
            s.name: Job(
                rubric=str(rubric.path.resolve()),
                rubric_digest=rubric.digest,
                submission=s.name,
                path=os.path.abspath(s.path),
                cache=str(folder / "cache"),
                isolation=isolation.name,
                secret=drawn_from,
                design=design,
                class_key=class_key.hex() if class_key else "",
            )
            for s in submissions
        }
        return _run(rubric, submissions, jobs, folder, workers, dask, progress)


def _run(
    rubric: Rubric,
    submissions: list[Submission],
    jobs: dict[str, Job],
    folder: Path,
    workers: int,
    dask: str | None,
    progress: Callable[[float], None],
) -> list[Result]:
    """Grade what has no result yet."""
    results = folder / "results" / rubric.name
    stamps = {s.name: _stamp(jobs[s.name], s) for s in submissions}
    done = {s.name: _kept(results, s, stamps[s.name]) for s in submissions}
    waiting = {name: job for name, job in jobs.items() if done[name] is None}
    by_name = {s.name: s for s in submissions}
    if dask and waiting:
        plain = {name: asdict(job) for name, job in waiting.items()}
        stream = on_cluster(
            _on_cluster, plain, dask, lambda name, why: failed_result(jobs[name], rubric, why)
        )
    else:
        stream = _with_threads(waiting, max(workers, 1))
    for count, (name, result) in enumerate(stream, len(jobs) - len(waiting) + 1):
        done[name] = result
        if "defect" not in result:
            _keep(results, by_name[name], stamps[name], result)
        progress(count / len(jobs))
    return [finished for s in submissions if (finished := done[s.name]) is not None]
