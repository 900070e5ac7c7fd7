# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Runs the code of a notebook from top to bottom, and makes a page of it with what it gave."""

from __future__ import annotations

import ast
import contextlib
import io
import json
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Cell:
    """A cell: its `text`; of code also what it `printed` and the `value` of its last expression."""

    is_code: bool
    text: str
    printed: str = ""
    value: Any = None


def run_notebook(path: Path) -> tuple[list[Cell], dict[str, Any]]:
    """All cells in order in one namespace, and the namespace; an error stops it.

    Lines for the notebook itself, which begin with `%`, are left out.
    """
    content = json.loads(path.read_text(encoding="utf-8"))
    names: dict[str, Any] = {"__name__": "__main__"}
    cells = []
    for number, cell in enumerate(content["cells"]):
        text = "".join(cell["source"])
        if cell["cell_type"] != "code":
            cells.append(Cell(False, text))
            continue
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            value = _run(text, f"{path.name}, cell {number}", names)
        cells.append(Cell(True, text, printed.getvalue(), value))
    return cells, names


def _run(text: str, place: str, names: dict[str, Any]) -> Any:
    tree = ast.parse(re.sub("^%.*", "", text, flags=re.MULTILINE), place)
    last = tree.body[-1] if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    if last is not None:
        tree.body.pop()
    exec(compile(tree, place, "exec"), names)
    if last is None:
        return None
    return eval(compile(ast.Expression(last.value), place, "eval"), names)


def notebook_page(path: Path, pictures: Path, reference: str) -> str:
    """Markdown with the code, what it printed, and its figures as files in `pictures`.

    `reference` is the way from the page to that folder.
    """
    from ravenbrick.control import write_figure

    lines: list[str] = []
    for number, cell in enumerate(run_notebook(path)[0]):
        if not cell.is_code:
            lines += [cell.text, ""]
            continue
        lines += ["```python", cell.text, "```", ""]
        if cell.printed:
            lines += ["```text", cell.printed.rstrip(), "```", ""]
        if hasattr(cell.value, "savefig"):
            file = pictures / f"{path.stem}-{number}.svg"
            write_figure(cell.value, file)
            lines += [f"![Picture of cell {number}]({reference}/{file.name})", ""]
    return "\n".join(lines)
