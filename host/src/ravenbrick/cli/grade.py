# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick grade`: submissions against a rubric."""

from __future__ import annotations

import os
from dataclasses import asdict
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from ravenbrick.atomic_write import atomic_write
from ravenbrick.cli.app import JsonOption, command
from ravenbrick.cli.console import Reporter
from ravenbrick.errors import CriteriaError, RavenbrickError, UsageError
from ravenbrick.grading.adapters import ADAPTERS
from ravenbrick.grading.campaign import campaign_secret, run_campaign
from ravenbrick.grading.isolation import TRUST
from ravenbrick.grading.league import league_of, pseudonym, races_of
from ravenbrick.grading.rubric import Rubric, read_rubric
from ravenbrick.grading.submission import find_submissions
from ravenbrick.grading.variants import read_key
from ravenbrick.report.league import league_page

__all__ = ["grade_command"]


class Form(StrEnum):
    """Forms of the report."""

    TEXT = "text"
    GRADESCOPE = "gradescope"
    NBGRADER = "nbgrader"
    MOODLE = "moodle"
    CANVAS = "canvas"
    GITHUB = "github"


def _league(
    rubric: Rubric, results: list[dict[str, Any]], file: Path, secret: str | None
) -> dict[str, Any]:
    """Write the league table, with pseudonyms of this secret or, without one, with names."""
    names = [result["submission"] for result in results]
    if secret is not None:
        names = [pseudonym(name, secret) for name in names]
        for result, name in zip(results, names, strict=True):
            result["pseudonym"] = name
    league = league_of(rubric, results, names)
    lines = {check.name: check.value.line for check in rubric.checks if check.kind == "race"}
    texts = {
        race: f"Deviation: root mean square distance of {signal} from {value:g}."
        for race, (signal, value) in lines.items()
    }
    atomic_write(file, league_page(rubric.description or rubric.name, texts, league.entries))
    return asdict(league)


@command("ravenbrick grade submissions/ --rubric docs/lessons/rubrics/lab-01.toml")
def grade_command(
    submissions: Annotated[
        list[Path],
        typer.Argument(help="Folders with src/, .zip files, or folders that contain these."),
    ],
    rubric: Annotated[Path, typer.Option(help="Rubric (TOML).")],
    output: Annotated[
        Path, typer.Option(help="Folder for results and images; the next campaign uses them again.")
    ] = Path("out/grade"),
    workers: Annotated[
        int, typer.Option(min=1, help="Number of submissions graded at the same time.")
    ] = os.cpu_count() or 1,
    dask: Annotated[str | None, typer.Option(help="Address of a Dask scheduler.")] = None,
    run_design: Annotated[
        bool, typer.Option("--run-design", help="Run each submission's design.py in the sandbox.")
    ] = False,
    trust: Annotated[
        bool,
        typer.Option(
            "--trust-submissions",
            envvar="RAVENBRICK_TRUST_SUBMISSIONS",
            help="Grading without a sandbox: submissions can do what you can do.",
        ),
    ] = False,
    secret: Annotated[
        str | None,
        typer.Option(
            help="Text that hidden seeds are drawn from (default: one for each --output)."
        ),
    ] = None,
    class_key: Annotated[
        Path | None,
        typer.Option(help="Class key: each submission is graded by the numbers of its student."),
    ] = None,
    form: Annotated[Form, typer.Option("--format", help="Format of the report.")] = Form.TEXT,
    report: Annotated[
        Path | None, typer.Option(help="File for the report (default: print it).")
    ] = None,
    league: Annotated[
        Path | None, typer.Option(help="File for the league table, a page (rubric with races).")
    ] = None,
    league_names: Annotated[
        bool, typer.Option("--league-names", help="Names in the league table, not pseudonyms.")
    ] = False,
    at_least: Annotated[
        float, typer.Option(min=0, max=1, help="Minimum score for each submission, 0 to 1.")
    ] = 0.0,
    json_output: JsonOption = False,
) -> dict[str, Any]:
    chosen = read_rubric(rubric)
    found = find_submissions(submissions)
    if form is Form.GRADESCOPE and len(found) != 1:
        raise UsageError("Gradescope accepts the results of one submission only; name one")
    if league is not None:
        races_of(chosen)
    reporter = Reporter(json_output)
    with reporter.step(f"grade {len(found)} by '{chosen.name}'") as step:
        results = run_campaign(
            chosen, found, output, workers, dask, run_design,
            TRUST if trust else None, secret, step.progress,
            class_key=read_key(class_key) if class_key else None,
        )  # fmt: skip
        mean = sum(result["points"] for result in results) / len(results)
        step.note = f"{mean:.4g} of {chosen.points:g} points on average"
    table: dict[str, Any] = {}
    if league is not None:
        drawn_from = None if league_names else campaign_secret(output, secret)
        table["league"] = _league(chosen, results, league, drawn_from)
    text = ADAPTERS[form.value](results)
    if report is not None:
        atomic_write(report, text)
    elif form is not Form.TEXT or len(results) == 1:
        reporter.print(text)
    else:
        rows = [[r["submission"], f"{r['points']:g}"] for r in results]
        reporter.table(("submission", f"of {chosen.points:g}"), rows)
    defects = [f"{r['submission']}: {r['defect']}" for r in results if "defect" in r]
    if defects:
        raise RavenbrickError(f"the grader failed on {defects[0]}", detail="\n".join(defects[1:]))
    low = [r["submission"] for r in results if r["points"] < at_least * r["of"]]
    if low:
        error = CriteriaError(
            f"{len(low)} of {len(results)} have a lower score than --at-least: {low[0]}"
        )
        error.data = {"results": results}
        raise error
    return {"rubric": chosen.name, "of": chosen.points, "results": results, **table}
