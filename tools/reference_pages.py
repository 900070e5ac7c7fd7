# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Pages and pictures of the documentation that are made from the program at every build."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import typer

ROOT = Path(__file__).resolve().parent.parent
SCHEMAS = {
    "robot-toml": ("robot", "robot.toml"),
    "scenario-toml": ("scenario", "Scenarios"),
    "rubric-toml": ("rubric", "Rubrics"),
}


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|").replace("<", "\\<").replace("[", "\\[")


def command_page() -> str:
    """Every command with its arguments and options, from the program itself."""
    from ravenbrick.cli import app

    group = typer.main.get_command(app)
    lines = ["# Commands", "", "`ravenbrick COMMAND --help` says the same."]
    commands: dict[str, Any] = vars(group)["commands"]
    for name, found in sorted(commands.items()):
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
    lines += ["| Field | Kind | Must be there | Meaning |", "|---|---|---|---|"]
    return "\n".join([*lines, *_fields(root, root, "")]) + "\n"


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
    for name, text in texts.items():
        file = pages / f"{name}.md"
        if not file.is_file() or file.read_text("utf-8") != text:
            file.write_text(text, encoding="utf-8")
    if not (pictures / "step.svg").is_file():
        draw_step(pictures / "step.svg")
