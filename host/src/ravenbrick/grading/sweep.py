# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""One scenario with many motors within their tolerances: in parallel, resumable, one result."""

from __future__ import annotations

import hashlib
import json
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass, replace
from multiprocessing import active_children, get_context
from pathlib import Path
from typing import Any

from ravenbrick.atomic_write import atomic_write
from ravenbrick.brick.run import VirtualTarget
from ravenbrick.errors import RavenbrickError
from ravenbrick.grading.campaign import on_cluster
from ravenbrick.grading.variants import drawn_motor
from ravenbrick.image.elf import read_image
from ravenbrick.project.robot import Robot, read_robot
from ravenbrick.project.scenario import Scenario, read_scenario
from ravenbrick.trace.measures import check_survival, evaluate_criteria, measure_run

__all__ = ["Variant", "draw", "run_sweep"]

Result = dict[str, Any]


@dataclass(frozen=True)
class Variant:
    """What a worker needs, as plain values; `deviations` by motor port and parameter."""

    number: int
    project: str
    scenario: str
    image: str
    seed: int
    deviations: dict[str, dict[str, float]]


def draw(robot: Robot, scenario: Scenario, number: int) -> dict[str, dict[str, float]]:
    """Parameters of each motor, uniform within the tolerances of robot.toml, never below 0.

    A function of the scenario's seed and the number alone.
    """
    seed = f"{scenario.seed} {number}"
    return {port: drawn_motor(robot, port, seed) for port in sorted(robot.motor_ports)}


def run_variant(variant: Variant) -> Result:
    """Run and judge; what goes wrong in the run is in the result."""
    robot = read_robot(Path(variant.project))
    read = read_scenario(Path(variant.scenario), robot)
    scenario = replace(read, seed=variant.seed, deviations=variant.deviations)
    result = {"number": variant.number, "deviations": variant.deviations}
    try:
        recording = VirtualTarget().run(robot, scenario, read_image(Path(variant.image)))
        check_survival(scenario, recording)
        measures = measure_run(robot, scenario, recording)
        rows = [r.as_json() for r in evaluate_criteria(scenario, measures)]
    except RavenbrickError as error:
        return {**result, "met": False, "problem": error.sentence, "criteria": []}
    return {**result, "met": all(row["met"] for row in rows), "criteria": rows}


def _on_cluster(values: dict[str, Any]) -> Result:
    return run_variant(Variant(**values))


def _in_processes(variants: dict[str, Variant], workers: int) -> Iterator[tuple[str, Result]]:
    """An interruption is for this process, which ends its workers."""
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        try:
            # The workers inherit what is blocked when they are started.
            before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
            try:
                futures = {pool.submit(run_variant, v): key for key, v in variants.items()}
            finally:
                signal.pthread_sigmask(signal.SIG_SETMASK, before)
            for future in as_completed(futures):
                yield futures[future], future.result()
        except BaseException:
            for worker in active_children():
                worker.terminate()
            pool.shutdown(cancel_futures=True)
            raise


def _key(variant: Variant, content: str) -> str:
    return hashlib.sha256(f"{asdict(variant)} {content}".encode()).hexdigest()[:32]


def _kept(file: Path) -> Result | None:
    """A result of an interrupted sweep; none when it cannot be read."""
    try:
        kept: Result = json.loads(file.read_text("utf-8"))
    except (OSError, ValueError):
        return None
    return kept


def run_sweep(
    robot: Robot,
    scenario: Scenario,
    image: Path,
    count: int,
    folder: Path,
    workers: int,
    dask: str | None = None,
    progress: Callable[[float], None] = lambda share: None,
) -> list[Result]:
    """Results of variants 0 to `count` - 1; `folder` keeps them, by all that they depend on."""
    files = (image, robot.document.path, scenario.document.path)
    content = " ".join(hashlib.sha256(file.read_bytes()).hexdigest() for file in files)
    project, file, elf = (
        str(path.resolve()) for path in (robot.directory, scenario.document.path, image)
    )
    variants: dict[str, Variant] = {}
    for number in range(count):
        drawn = draw(robot, scenario, number)
        variant = Variant(number, project, file, elf, scenario.seed + number, drawn)
        variants[_key(variant, content)] = variant
    folder.mkdir(parents=True, exist_ok=True)
    kept = {key: folder / f"{key}.json" for key in variants}
    done = {key: result for key, file in kept.items() if (result := _kept(file)) is not None}
    waiting = {key: variant for key, variant in variants.items() if key not in done}
    if dask and waiting:
        plain = {key: asdict(variant) for key, variant in waiting.items()}
        stream = on_cluster(_on_cluster, plain, dask)
    else:
        stream = _in_processes(waiting, max(workers, 1))
    for key, result in stream:
        done[key] = result
        atomic_write(kept[key], json.dumps(result))
        progress(len(done) / count)
    return sorted(done.values(), key=lambda result: int(result["number"]))
