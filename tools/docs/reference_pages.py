# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Pages and pictures of the documentation that every build generates from the program."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
SCHEMAS = {
    "robot-toml": ("robot", "robot.toml"),
    "scenario-toml": ("scenario", "Scenarios"),
    "rubric-toml": ("rubric", "Rubrics"),
}


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|").replace("<", "\\<").replace("[", "\\[")


def command_page() -> str:
    """Every command with its arguments and options, from the program itself."""
    from ravenbrick.cli.app import COMMANDS, load

    lines = ["# Commands", "", "`ravenbrick COMMAND --help` prints the same texts."]
    for name in sorted(COMMANDS):
        found = load(name)
        lines += ["", f"## ravenbrick {name}", "", _cell(found.help or ""), ""]
        lines += ["| Argument | Meaning | Default |", "|---|---|---|"]
        for parameter in found.params:
            label = ", ".join(parameter.opts) or parameter.name
            if parameter.param_type_name == "argument":
                label = parameter.name.upper()
            default = parameter.default
            shown = "" if default in (None, False) or callable(default) else f"{default}"
            if isinstance(default, int) and label == "--workers":
                shown = "one per processor"
            lines.append(f"| `{label}` | {_cell(parameter.help or '')} | {_cell(shown)} |")
        example = re.sub(r"^Example: ", "", found.epilog or "")
        lines += ["", "```text", example, "```"]
    return "\n".join(lines) + "\n"


def _resolved(node: dict[str, Any], root: dict[str, Any]) -> dict[str, Any]:
    if "$ref" in node:
        name = node["$ref"].rpartition("/")[2]
        merged = _resolved(root["$defs"][name], root)
        return {**merged, **{k: v for k, v in node.items() if k != "$ref"}}
    return node


def _quantity(node: dict[str, Any]) -> str | None:
    for part in node.get("allOf", ()):
        unit = part.get("properties", {}).get("unit", {})
        if "const" in unit:
            return f"quantity in {unit['const']}"
        if "enum" in unit:
            return f"quantity in {' or '.join(unit['enum'])}"
    return None


def _kind(node: dict[str, Any]) -> str:
    if "enum" in node:
        return ", ".join(f"`{value}`" for value in node["enum"])
    if "const" in node:
        return f"`{node['const']}`"
    return _quantity(node) or str(node.get("type", ""))


def _fields(node: dict[str, Any], root: dict[str, Any], path: str) -> Iterator[str]:
    node = _resolved(node, root)
    if node.get("type") == "array":
        yield from _fields(node.get("items", {}), root, f"{path}[]")
        return
    required = node.get("required", ())
    named = dict(node.get("properties", {}))
    for pattern, value in node.get("patternProperties", {}).items():
        named[pattern.strip("^$")] = value
    if isinstance(node.get("additionalProperties"), dict):
        named["NAME"] = node["additionalProperties"]
    for name, value in named.items():
        field = _resolved(value, root)
        where = f"{path}.{name}" if path else name
        must = "yes" if name in required else ""
        yield f"| `{where}` | {_kind(field)} | {must} | {_cell(field.get('description', ''))} |"
        if _quantity(field) is None:
            yield from _fields(field, root, where)


def schema_page(name: str, title: str) -> str:
    """Every field of a file, from its schema."""
    from ravenbrick.schemas import schema

    root = schema(name)
    lines = [f"# {title}", "", root["description"], ""]
    lines += ["A *quantity* is a table with `value`, `unit`, `tolerance` and `source`.", ""]
    lines += ["| Field | Kind | Required | Meaning |", "|---|---|---|---|"]
    return "\n".join([*lines, *_fields(root, root, "")]) + "\n"


PACKAGE = re.compile(r"^(?:private )?(?:package|generic|function|procedure)\b", re.M)
UNIT = re.compile(r"^(private )?package (?!body)([\w.]+)", re.M)
# Units for drivers and compiler, not for programs.
INNER_UNITS = ("NXT.Registers", "System.", "Ravenbrick.")


def _public_part(text: str) -> tuple[str, str]:
    """Opening comment and visible declarations of a specification."""
    body = text.split("\n", 3)[-1]
    found = PACKAGE.search(body)
    assert found is not None
    comment = re.findall(r"^--  ?(.*)$", body[: found.start()], re.M)
    visible = re.split(r"^private$", body[found.start() :], maxsplit=1, flags=re.M)[0]
    return " ".join(comment), visible.rstrip()


def _specifications(folders: tuple[str, ...]) -> Iterator[tuple[str, str]]:
    """Name and text of each unit that programs may name, by name."""
    found = {}
    for folder in folders:
        for file in (ROOT / folder).rglob("*.ads"):
            text = file.read_text("utf-8")
            unit = UNIT.search(text)
            if unit is not None and not unit.group(1) and not unit.group(2).startswith(INNER_UNITS):
                found[unit.group(2)] = text
    yield from sorted(found.items())


def package_page(title: str, opening: str, *folders: str) -> str:
    """Every public package below the folders, with its purpose and its declarations."""
    lines = [f"# {title}", "", opening]
    for name, text in _specifications(folders):
        comment, visible = _public_part(text)
        lines += ["", f"## {name}", "", _cell(comment), "", "```ada", visible, "```"]
    return "\n".join(lines) + "\n"


def trace_page() -> str:
    """A recording's events and their layout, from the program's own types."""
    from ravenbrick.trace.recording import EVENT_TYPE, EventKind

    lines = ["# Events of a recording", ""]
    lines += [
        "[Recordings](../trace.md) explains the events.",
        "",
        "| Number | Kind |",
        "|---:|---|",
    ]
    lines += [f"| {kind.value} | {kind.name.lower().replace('_', ' ')} |" for kind in EventKind]
    lines += ["", f"An event has {EVENT_TYPE.itemsize} bytes, little-endian:", ""]
    lines += ["| Field | Offset | Kind |", "|---|---:|---|"]
    assert EVENT_TYPE.fields is not None
    for name, (kind, offset, *_) in EVENT_TYPE.fields.items():
        lines.append(f"| `{name}` | {offset} | {kind.name} |")
    return "\n".join(lines) + "\n"


def draw_step(file: Path) -> None:
    """The motor bench's step response, continuous and sampled, as its design computes them."""
    import matplotlib

    matplotlib.use("svg")
    import matplotlib.pyplot as plt
    from ravenbrick.control import LoopSpecification, finish_design, pi_by_lambda, pi_with_estimator
    from ravenbrick.model import NXT_MOTOR, SpeedLoop

    loop = SpeedLoop.of_motor(NXT_MOTOR, 116.0)
    wanted = LoopSpecification(0.4, 0.005, 0.004, 8, 0.0023)
    design = finish_design(
        "step", loop, wanted, pi_by_lambda(loop, 0.4), pi_with_estimator(loop, wanted), 8.0
    )
    figure, axes = plt.subplots(figsize=(7, 3), layout="constrained")
    continuous, run = design.continuous_response, design.encoder_response
    axes.plot(continuous.time, continuous.output, label="continuous design")
    axes.plot(run.fine_time, run.speed / run.set_point, label="sampled, with encoder counts")
    axes.set(xlabel="time in s", ylabel="speed / set-point", xlim=(0, 0.8))
    axes.legend()
    axes.grid(alpha=0.3)
    figure.savefig(file, metadata={"Date": None})
    plt.close(figure)


def write_pages(pages: Path, pictures: Path) -> None:
    """Write what is generated; a page that did not change keeps its time."""
    pages.mkdir(parents=True, exist_ok=True)
    pictures.mkdir(parents=True, exist_ok=True)
    texts = {"commands": command_page()}
    texts |= {file: schema_page(name, title) for file, (name, title) in SCHEMAS.items()}
    texts["drivers"] = package_page(
        "Drivers: all packages", "The specifications in `drivers/src`.", "drivers/src"
    )
    texts["run-time"] = package_page(
        "Run-time: all packages",
        "The specifications in `runtime/language`. All other units of Ada's library come from the "
        "compiler.",
        "runtime/language",
    )
    texts["trace-events"] = trace_page()
    for name, text in texts.items():
        file = pages / f"{name}.md"
        if not file.is_file() or file.read_text("utf-8") != text:
            file.write_text(text, encoding="utf-8")
    if not (pictures / "step.svg").is_file():
        draw_step(pictures / "step.svg")
