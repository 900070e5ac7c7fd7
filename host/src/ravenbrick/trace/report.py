# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The report: one HTML file with everything inside, and the pictures beside it as PNG."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from html import escape
from importlib import resources
from pathlib import Path

from matplotlib.figure import Figure

from ravenbrick.trace.design import Design
from ravenbrick.trace.dynamics import handler_dynamics, task_dynamics
from ravenbrick.trace.motion import SPEED_FILTER
from ravenbrick.trace.plots import (
    cyclic_begin_cycles,
    dynamics_figure,
    first_release_cycles,
    lcd_figure,
    path_figure,
    schedule_figure,
    speeds_figure,
    step_response_figure,
    tasks_figure,
)
from ravenbrick.trace.plots.style import data_uri, png_bytes
from ravenbrick.trace.plots.tasks import TASK_COLUMNS, task_cells
from ravenbrick.trace.summary import Evidence, Run, summary
from ravenbrick.whole_file import write_whole

__all__ = ["figures_of", "write_report"]

Cells = Sequence[str]


def figures_of(evidence: Evidence) -> Iterator[tuple[str, Figure]]:
    """Name (of the PNG) and figure of each picture there is evidence for."""
    record = evidence.step_record
    if record is not None:
        yield "step-response", step_response_figure(evidence.design, record)
    drive, open_loop = evidence.drive, evidence.open_loop
    paths = [
        (label, colour, run.scenario, run.recording, run.measures)
        for label, colour, run in (
            ("with the controller", "with", drive),
            ("without the controller", "without", open_loop),
        )
        if run is not None and run.measures.path is not None
    ]
    if drive is not None:
        yield "speeds", speeds_figure(evidence.robot, drive.scenario, drive.recording)
    if paths:
        yield "path", path_figure(paths)
    if drive is not None:
        recording = drive.recording
        begin, cyclic = (
            first_release_cycles(recording),
            cyclic_begin_cycles(evidence.robot, recording),
        )
        yield "schedule", schedule_figure(evidence.robot, recording, begin)
        yield "schedule-cyclic", schedule_figure(evidence.robot, recording, cyclic)
        tasks = task_dynamics(evidence.robot, recording)
        yield "dynamics", dynamics_figure(recording.clock, tasks, handler_dynamics(recording))
        yield "tasks", tasks_figure(drive.recording, drive.measures)
        for number, picture in enumerate(drive.recording.pictures, 1):
            yield f"lcd-{number}", lcd_figure(picture)


def _table(head: Cells, rows: Sequence[Cells]) -> str:
    cells = "".join(f"<th>{escape(cell)}</th>" for cell in head)
    body = "".join(
        "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows
    )
    return f'<div class="scroll"><table><tr>{cells}</tr>{body}</table></div>'


def _image(content: bytes, caption: str, description: str = "") -> str:
    source = data_uri(content, "image/png")
    alternative = escape(description or caption, quote=True)
    return (
        f'<figure><img src="{source}" alt="{alternative}">'
        f"<figcaption>{escape(caption)}</figcaption></figure>"
    )


def _length(metres: float | None) -> str:
    return "not measured" if metres is None else f"{1000 * metres:.3g} mm"


def _key_figures(evidence: Evidence) -> str:
    figures: list[tuple[str, str]] = []
    step, drive = evidence.step_record, evidence.drive
    if step is not None:
        settled = step.measures.settling_time
        figures.append(
            (f"{1000 * settled:.0f} ms" if settled is not None else "never", "settling time (2 %)")
        )
        figures.append((f"{100 * step.measures.overshoot:.2f} %", "overshoot"))
    for run, label in ((drive, "with"), (evidence.open_loop, "without")):
        if run is not None and run.measures.path is not None and run.scenario.straight is not None:
            figures.append(
                (
                    _length(run.measures.path.lateral_deviation),
                    f"off the line in {run.scenario.straight.distance:g} m, {label} controller",
                )
            )
    if drive is not None:
        misses = sum(task.deadline_misses for task in drive.measures.tasks)
        figures.append((str(misses), "deadlines missed"))
        figures.append((f"{100 * drive.measures.utilization.busy:.1f} %", "processor used"))
    boxes = "".join(f"<div><b>{escape(v)}</b><span>{escape(t)}</span></div>" for v, t in figures)
    return f'<div class="figures">{boxes}</div>'


def _step_section(evidence: Evidence, images: dict[str, bytes]) -> str:
    record = evidence.step_record
    if record is None:
        return ""
    rows = []
    design = evidence.design
    if design is not None:
        for name, response in (
            ("continuous design", design.continuous),
            ("sampled simulation", design.sampled),
        ):
            rows.append((name, _ms(response.settling_time), f"{100 * response.overshoot:.2f} %"))
    for run in evidence.runs:
        for motor, step in run.measures.steps.items():
            settling = _ms(step.measures.settling_time)
            overshoot = f"{100 * step.measures.overshoot:.2f} %"
            name = f"on the brick, motor {motor} (scenario '{run.scenario.name}')"
            rows.append((name, settling, overshoot))
    return (
        "<h2>Step response</h2>"
        "<p>One count of the encoder is 1°, so the difference of two counts 4 ms apart knows only "
        "multiples of 250 °/s (pale). The speed on the brick is therefore measured as the "
        f"{escape(SPEED_FILTER)}.</p>"
        + _image(images["step-response"], "Step of the speed set-point on the bench")
        + _table(("", "settling time (2 %)", "overshoot"), rows)
        + _estimator_table(design)
    )


def _estimator_table(design: Design | None) -> str:
    """What the design found for each way of getting a speed from counts; volts."""
    if design is None or not design.estimators:
        return ""
    rows = [
        (
            estimator.name,
            f"{estimator.quantum:.3f} V",
            _ms(estimator.settling_time),
            f"{100 * estimator.ripple:.2f} %",
            f"{estimator.control_peak_to_peak:.3f} V",
        )
        for estimator in design.estimators
    ]
    head = ("speed from counts", "one count", "settling time", "ripple", "control peak to peak")
    return (
        "<p>Ways to get the speed from counts, simulated in the loop with the same design:</p>"
        + _table(head, rows)
    )


def _ms(seconds: float | None) -> str:
    return "never" if seconds is None else f"{1000 * seconds:.1f} ms"


def _drive_section(images: dict[str, bytes]) -> str:
    text = "<h2>The drive</h2>"
    if "speeds" in images:
        text += _image(images["speeds"], "Speeds of both wheels and their set-points")
    if "path" in images:
        text += _image(
            images["path"],
            "Path from above. Both runs: same image, same motors, same inputs; the second with "
            "the set-point passed to the motors as it is",
        )
    return text


def _schedule_section(run: Run, images: dict[str, bytes]) -> str:
    measures, recording = run.measures, run.recording
    shares = measures.utilization
    rows = [
        task_cells(recording, task, share)
        for task, share in zip(measures.tasks, measures.shares, strict=True)
    ]
    return (
        "<h2>Tasks and schedule</h2>"
        "<p>Times in cycles of the processor's clock of 48.054857 MHz, observed from outside "
        "without instrumentation. Response time: nominal release to completion. Release jitter: "
        "spread of the times from nominal release to first execution.</p>"
        + _table(TASK_COLUMNS, rows)
        + f"<p>Interrupt handlers take {100 * shares.interrupts:.2f} % of the processor, the "
        f"kernel outside of tasks {100 * shares.kernel:.2f} %; it sleeps for "
        f"{100 * shares.idle:.2f} %.</p>"
        + _image(images["schedule"], "The first 50 ms from the first release on")
        + _image(
            images["schedule-cyclic"],
            "50 ms from the instant at which the last cyclic task begins its cycle",
        )
        + _image(
            images["dynamics"],
            "All jobs and all calls of interrupt handlers of the run; counts on a logarithmic "
            "scale. Blocked: the processor was with tasks of lower base priority between release "
            "and completion",
        )
    )


def _lcd_section(run: Run, images: dict[str, bytes]) -> str:
    text = '<h2>The LCD</h2><div class="pictures">'
    for number, picture in enumerate(run.recording.pictures, 1):
        at = run.recording.clock.seconds(picture.at_cycles)
        read = " / ".join(line for line in picture.text if line)
        text += _image(images[f"lcd-{number}"], f"after {at:.3f} s", read)
    return text + "</div>"


def _memory_section(evidence: Evidence) -> str:
    memory = evidence.memory
    if memory is None:
        return ""
    free = memory.available - memory.used
    sizes = [
        ("code and constants (text)", str(memory.text)),
        ("initialised data (data)", str(memory.data)),
        ("zeroed data and stacks (bss)", str(memory.bss)),
        (f"used of {memory.available}", str(memory.used)),
        ("free", str(free)),
    ]
    stacks = [
        (
            task.name,
            *(
                ("unknown" if n is None else str(n))
                for n in (task.storage_size_bytes, task.used_bytes)
            ),
        )
        for task in memory.tasks
    ]
    parts = [
        (name, *(str(part[k]) for k in ("text", "data", "bss")))
        for name, part in memory.parts.items()
    ]
    text = f"<h2>Memory ({escape(memory.kind)} image)</h2>" + _table(("", "bytes"), sizes)
    text += _table(("stack of", "Storage_Size", "high-water mark"), stacks)
    return text + (_table(("part", "text", "data", "bss"), parts) if parts else "")


def _runs_section(evidence: Evidence) -> str:
    rows = []
    for run in evidence.runs:
        recording = run.recording
        met = all(result.met for result in run.criteria)
        seconds = recording.clock.seconds(recording.stop.at_cycles)
        rows.append(
            (
                run.scenario.name,
                f"{seconds:.6f} s ({recording.stop.reason.replace('_', ' ')})",
                str(run.scenario.seed),
                "met" if met else "not met",
                recording.digest[:16],
            )
        )
    text = "<h2>Runs</h2>"
    text += _table(("scenario", "ended after", "seed", "criteria", "trace digest"), rows)
    if evidence.same_digest_twice is not None:
        answer = "the same digest" if evidence.same_digest_twice else "ANOTHER digest"
        text += f"<p>The drive was run twice; the second run gave {answer}.</p>"
    if evidence.drive is not None:
        text += f"<p>Whole digest: <code>{escape(evidence.drive.recording.digest)}</code></p>"
    return text


def _page(evidence: Evidence, images: dict[str, bytes]) -> str:
    css = resources.files("ravenbrick.trace").joinpath("report.css").read_text("utf-8")
    robot = evidence.robot
    sections = [_key_figures(evidence), _step_section(evidence, images), _drive_section(images)]
    if evidence.drive is not None:
        sections += [
            _schedule_section(evidence.drive, images),
            _lcd_section(evidence.drive, images),
        ]
    sections += [_memory_section(evidence), _runs_section(evidence)]
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{escape(robot.name)}: report</title><style>\n{css}</style></head>\n<body>"
        f"<h1>{escape(robot.name)}</h1>"
        f'<p class="lead">{escape(robot.description)}. Measured on the virtual brick.</p>\n'
        + "\n".join(section for section in sections if section)
        + "\n</body></html>\n"
    )


def write_report(evidence: Evidence, folder: Path) -> Path:
    """Write report.html, summary.json and the PNGs into a folder; returns the report's file."""
    images: dict[str, bytes] = {}
    for name, figure in figures_of(evidence):
        images[name] = png_bytes(figure)
        write_whole(folder / f"{name}.png", images[name])
    write_whole(folder / "summary.json", json.dumps(summary(evidence), indent=1) + "\n")
    report = folder / "report.html"
    write_whole(report, _page(evidence, images))
    return report
