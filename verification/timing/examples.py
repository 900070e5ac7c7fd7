# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Bounds of all examples versus observations, as a page.

`python -m verification.timing.examples [NAME ...] [--worst-case-search N] [--hours 1]` builds and
analyses the named examples (default: all), keeps the figures in
`build/verification/timing-bounds.json` and writes `docs/reference/timing-bounds.md` from them. What
the campaigns found is added from `random_sets.json` and `program_campaign.json`.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from typing import Any

from ravenbrick.timing.results.phase_margin import margin_words

from verification.built_examples import build_example, ravenbrick
from verification.support.paths import ROOT
from verification.timing.unreached_bounds import MISSED, REACHED, UNEXPLAINED

__all__ = ["EXAMPLES", "analysed", "judge", "keep", "page"]

KEPT = ROOT / "build" / "verification" / "timing-bounds.json"
PAGE = ROOT / "docs" / "reference" / "timing-bounds.md"
EXAMPLES = {
    "blank": "press",
    "motor-bench": "monitored",
    "line-follower": "lap",
    "balancer": "let-go",
    "vehicle": "drive",
    "paper": "monitored",
    "remote-vehicle": "drive",
    "remote-joystick": "steer",
}
PARTS = (
    ("net execution time", "own_cycles", "execution_cycles"),
    ("interference", "interference_cycles", "interference_cycles"),
    ("interrupts", "interrupts_cycles", "interrupt_cycles"),
    ("blocking", "blocking_cycles", "blocking_cycles"),
    ("overheads", "overheads_cycles", None),
    ("release jitter", "release_jitter_cycles", None),
)
HEAD = ("task", "deadline (us)", *(p[0] for p in PARTS), "response", "ratio", "stack", "of")
SEARCHED = ("unvaried_cycles", "undisturbed_cycles", "response_cycles")
Row = dict[str, Any]


def _spread(found: dict[str, Any]) -> dict[str, Any]:
    """A spread of a long run without its bins."""
    return {key: value for key, value in found.items() if key != "bins"}


def _short(answer: dict[str, Any]) -> dict[str, Any]:
    """What the page needs."""
    keys = ("scenario", "schedulable", "effort", "tasks", "interrupts", "chains", "overestimation")
    result = {key: answer[key] for key in keys}
    if "worst_case_search" in answer:
        search = answer["worst_case_search"]
        searched = {
            name: [found[key] for key in SEARCHED] for name, found in search["tasks"].items()
        }
        result["search"] = {"variants": search["variants"], "tasks": searched}
    if "long_run" in answer:
        run = answer["long_run"]
        tasks = {
            name: {
                "response": _spread(found["response_time_cycles"]),
                "latency": _spread(found["release_latency_cycles"]),
                "deadline_misses": found["deadline_misses"],
            }
            for name, found in run["tasks"].items()
        }
        result["long_run"] = {"seconds": run["seconds"], "tasks": tasks}
    return result


def analysed(names: Sequence[str], options: Sequence[str] = ()) -> dict[str, dict[str, Any]]:
    """Build and analyse these examples."""
    for name in {*names, *(("remote-vehicle", "remote-joystick") if _remote(names) else ())}:
        build_example(name)
    found = {}
    for name in names:
        scenario = ("--scenario", EXAMPLES[name])
        found[name] = _short(ravenbrick("analyse", f"examples/{name}", *scenario, *options))
        print(f"{name}: analysed", file=sys.stderr, flush=True)
    return found


def _remote(names: Sequence[str]) -> bool:
    return any(name.startswith("remote") for name in names)


def judge(results: dict[str, dict[str, Any]]) -> tuple[int, int]:
    """Comparisons of a bound with an observation, and those in which the bound holds."""
    pairs = []
    for result in results.values():
        for task in result["tasks"]:
            seen = task["observed"]
            pairs += [
                (task["execution_bound_cycles"], seen["execution_cycles"]),
                (task["response_bound_cycles"], seen["response_cycles"]),
                (task["stack_bound_bytes"], seen["stack_bytes"]),
                (task["stack_bytes"], task["stack_bound_bytes"] or sys.maxsize),
            ]
            pairs += [
                (mode[f"{what}_bound_cycles"], mode[f"{what}_max_seen_cycles"])
                for mode in task["modes"]
                for what in ("execution", "response")
            ]
        for chain in result["chains"]:
            pairs.append((chain["edge_bound_cycles"], chain["edge_max_cycles"]))
    shown = [(bound, seen) for bound, seen in pairs if seen is not None]
    good = sum(bound is not None and seen <= bound for bound, seen in shown)
    return len(shown), good


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cells) + " |"


def _pair(bound: Any, seen: Any) -> str:
    return f"{'-' if bound is None else bound} / {'-' if seen is None else seen}"


def _task_row(task: dict[str, Any]) -> list[str]:
    terms, seen = task["terms"] or {}, task["observed"] or {}
    cells = [task["name"], str(task["deadline_us"])]
    for _, key, seen_key in PARTS:
        cells.append(_pair(terms.get(key), seen.get(seen_key)) if seen_key else str(terms.get(key)))
    cells.append(_pair(task["response_bound_cycles"], seen.get("response_cycles")))
    cells.append(f"{task['ratio']:.2f}" if task["ratio"] else "-")
    cells.append(_pair(task["stack_bound_bytes"], seen.get("stack_bytes")))
    return [*cells, str(task["stack_bytes"])]


def _mode_row(mode: dict[str, Any]) -> list[str]:
    own = _pair(mode["execution_bound_cycles"], mode["execution_max_seen_cycles"])
    cells = [f"- {mode['name']}", "", own]
    cells += [""] * (len(PARTS) - 1)
    cells.append(_pair(mode["response_bound_cycles"], mode["response_max_seen_cycles"]))
    return [*cells, f"{mode['ratio']:.2f}" if mode["ratio"] else "-", "", ""]


def _search_lines(search: dict[str, Any]) -> list[str]:
    text = "; ".join(
        f"{name} {' / '.join(map(str, found))}" for name, found in search["tasks"].items()
    )
    return [
        "",
        f"Worst-case search over {search['variants']} variants. Longest responses in the scenario "
        f"itself / in variants with an undisturbed link / in all variants: {text}.",
    ]


def _long_lines(run: dict[str, Any], tasks: Sequence[dict[str, Any]]) -> list[str]:
    bounds = {task["name"]: task["response_bound_cycles"] for task in tasks}
    lines = ["", f"The run repeated for {run['seconds']:.0f} s of virtual time:", ""]
    head = ("task", "jobs", "response min", "mean", "max", "bound", "ratio", "latency max")
    lines += [_line((*head, "misses")), _line(["---"] + ["---:"] * len(head))]
    for name, found in run["tasks"].items():
        response = found["response"]
        cells = [name, response["count"], response["min"], round(response["mean"])]
        ratio = f"{bounds[name] / response['max']:.2f}"
        cells += [response["max"], bounds[name], ratio, found["latency"]["max"]]
        lines.append(_line([str(cell) for cell in (*cells, found["deadline_misses"])]))
    return lines


def _example(name: str, result: dict[str, Any]) -> list[str]:
    lines = ["", f"## {name}, scenario `{result['scenario']}`", ""]
    lines += [_line(HEAD), _line(["---"] + ["---:"] * (len(HEAD) - 1))]
    for task in result["tasks"]:
        lines.append(_line(_task_row(task)))
        lines += [_line(_mode_row(mode)) for mode in task["modes"]]
    handlers = ", ".join(f"{row['source']} {row['bound_cycles']}" for row in result["interrupts"])
    verdict = "All deadlines are met." if result["schedulable"] else "A deadline can be missed."
    lines += ["", f"{verdict} Bounds of complete handler calls: {handlers}."]
    for chain in result["chains"]:
        edge, margins = chain["edge_max_cycles"], chain["phase_margin"]
        lines.append(
            f"From {chain['name']}: at most {chain['edge_bound_cycles']} cycles"
            + ("" if edge is None else f", observed {edge}")
            + f"; from the sample at most {chain['sample_bound_cycles']}, "
            f"observed {chain['sample_min_cycles']} to {chain['sample_max_cycles']}"
            + (f"; {margin_words(margins)}." if margins else ".")
        )
    lines += ["", *(f"- {line}." for line in result["overestimation"])]
    if "search" in result:
        lines += _search_lines(result["search"])
    if "long_run" in result:
        lines += _long_lines(result["long_run"], result["tasks"])
    return lines


def _efforts(results: dict[str, dict[str, Any]]) -> list[str]:
    lines = ["", "## Effort of the analysis", ""]
    lines += [_line(("example", "text bytes", "seconds of a processor")), "| --- | ---: | ---: |"]
    rows = sorted(results.items(), key=lambda item: item[1]["effort"]["text_bytes"])
    for name, result in rows:
        effort = result["effort"]
        lines.append(_line((name, str(effort["text_bytes"]), f"{effort['seconds']:.1f}")))
    return lines


def _programs(found: dict[str, Any]) -> list[str]:
    """What the generated programs showed."""
    mean, most = (found[f"lowest_task_ratio_{key}"] for key in ("mean", "max"))
    within = found["lowest_task_within_5_percent"]
    lines = [
        f"{found['programs']} generated Ada programs with {found['tasks']} tasks: "
        f"{len(found['above_bound'])} responses above their bounds. All tasks are released",
        "together once; the bound of the least urgent task is then above its response by",
        f"{mean - 1:.2%} on average and {most - 1:.2%} at most.",
        "",
        "| least urgent task: bound over response | programs |",
        "| --- | ---: |",
        f"| at most 1.05 at the common release | {within} |",
    ]
    far = found["lowest_task_beyond"]
    for reason, text in (
        (REACHED, "at most 1.05 in a run with other phases, found by a search"),
        (
            MISSED,
            "the response ends just before a release of a more urgent task, the bound after it",
        ),
        (UNEXPLAINED, "not explained"),
    ):
        chosen = [one for one in far if one["reason"] == reason]
        if chosen or reason == UNEXPLAINED:
            lines.append(_line((text, str(len(chosen)))))
    missed = [one for one in far if one["reason"] == MISSED]
    if missed:
        longer, ratio = (max(one[key] for one in missed) for key in ("longer", "ratio"))
        lines += [
            "",
            "Reason for the last distances: if the job is longer by at most "
            f"{longer:.2%} of the response, it reaches",
            f"that release on the brick too, and its bound is then at most {ratio - 1:.2%} above "
            "the response.",
        ]
    return lines


def _campaigns() -> list[str]:
    lines = ["", "## Campaigns", ""]
    file = ROOT / "verification" / "timing" / "program_campaign.json"
    if file.is_file():
        found = json.loads(file.read_text())
        lines += _programs(found)
    file = ROOT / "verification" / "timing" / "random_sets.json"
    if file.is_file():
        found = json.loads(file.read_text())
        lines += ["", f"{found['sets']} random task sets, tasks compared:", ""]
        lines += ["| with | equal | different |", "| --- | ---: | ---: |"]
        counts = found["counts"]
        for key in sorted(key for key in counts if key.endswith(" different")):
            name = key.removesuffix(" different")
            lines.append(_line((name, str(counts.get(f"{name} equal", 0)), str(counts[key]))))
        if "simulator tasks" in counts:
            lines.append(
                f"| SimSo, from the critical instant | {counts.get('simso equal', 0)} | "
                f"{counts['simulator tasks'] - counts.get('simso equal', 0)} |"
            )
            lines += ["", f"Runs of SimSo above a bound: {counts['simso above bound']}."]
        lines += [f"- {text}" for text in found["different"]]
    return lines


def page(results: dict[str, dict[str, Any]]) -> str:
    """The page of all kept figures."""
    count, good = judge(results)
    lines = [
        "<!-- SPDX-FileCopyrightText: 2026 Ravenbrick contributors -->",
        "<!-- SPDX-License-Identifier: Apache-2.0 -->",
        "# Bounds versus observations",
        "",
        "Generated by `python -m verification.timing.examples`. Cells are bound / largest",
        "observed value, in cycles of 48.054857 MHz, stacks in bytes. The largest values of a row",
        "need not belong to one job. Bounds hold for any inputs, also while a link is set up.",
        "The rows below a task are its modes, observed in variants with an undisturbed link",
        "([guide](../guides/timing-analysis.md)).",
        "",
        f"{good} of {count} observed values are within their bounds.",
    ]
    for name, result in results.items():
        lines += _example(name, result)
    return "\n".join([*lines, *_efforts(results), *_campaigns()]) + "\n"


def keep(found: dict[str, dict[str, Any]]) -> dict[str, dict[str, Any]]:
    """Bring figures into the kept ones; returns all, and writes the page when none is missing."""
    kept = json.loads(KEPT.read_text()) if KEPT.is_file() else {}
    results = {name: {**kept, **found}[name] for name in EXAMPLES if name in {**kept, **found}}
    KEPT.parent.mkdir(parents=True, exist_ok=True)
    KEPT.write_text(json.dumps(results, indent=1) + "\n")
    if missing := sorted(set(EXAMPLES) - set(results)):
        print(f"page not written: no figures of {', '.join(missing)}", file=sys.stderr)
    else:
        PAGE.write_text(page(results))
    return results


def main() -> int:
    """Analyse, keep, write; 1 when an observation exceeds a bound."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", choices=[*EXAMPLES, []])
    parser.add_argument("--worst-case-search", type=int, default=40)
    parser.add_argument("--hours", type=float, default=0.0)
    parser.add_argument("--page", action="store_true", help="only rewrite the page")
    chosen = parser.parse_args()
    options = (
        [f"--worst-case-search={chosen.worst_case_search}"] if chosen.worst_case_search else []
    )
    options += [f"--hours={chosen.hours}"] if chosen.hours else []
    names = [] if chosen.page else chosen.names or list(EXAMPLES)
    count, good = judge(keep(analysed(names, options)))
    print(f"{good} of {count} observed values are within their bounds")
    return 0 if good == count else 1


if __name__ == "__main__":
    sys.exit(main())
