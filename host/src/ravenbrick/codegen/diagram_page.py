# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A page with a diagram's picture beside its C and Ada: pointing at a block marks its lines, and

back.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from html import escape

from ravenbrick.codegen.ada.generator import generate_ada
from ravenbrick.codegen.c.generator import generate_c
from ravenbrick.errors import DesignError
from ravenbrick.model import Diagram, diagram_svg

__all__ = ["ada_lines_of_blocks", "diagram_page", "lines_of_blocks"]

_BLOCK = re.compile(r"'<Root>/(\w+)'")
_ADA_BLOCK = re.compile(r" {6,}--  [^:]+: (\w+)$")
_ADA_FIELD = re.compile(r" {6}--  of (\w+)$")
_STYLE = """
body { margin: 0; font: 14px sans-serif; display: flex; height: 100vh; }
main { flex: 3; overflow: auto; }
aside { flex: 2; min-width: 0; display: flex; flex-direction: column; border-left: 1px solid #bbb; }
section { flex: 1; overflow: auto; border-bottom: 1px solid #bbb; }
h2 { position: sticky; top: 0; margin: 0; padding: 4px 12px; font-size: 13px; background: #eee; }
pre { margin: 0; padding: 8px 0; font-size: 12px; line-height: 1.35; }
pre span { display: block; padding: 0 12px; min-height: 1.35em; }
pre span[data-blocks] { cursor: pointer; } pre .chosen { background: #fff3c4; }
@media (max-width: 900px) { body { flex-direction: column; } aside { flex: 3; min-height: 0; } }
""".strip()
_SCRIPT = """
const parts = [...document.querySelectorAll('[data-blocks]')];
const names = part => part.dataset.blocks.split(' ');
const pane = part => part.closest('section, main');
const choose = (wanted, from) => {
  const seen = new Set(from ? [pane(from)] : []);
  for (const part of parts) {
    const found = names(part).some(name => wanted.includes(name));
    part.classList.toggle('chosen', found);
    if (!found || !from || seen.has(pane(part))) continue;
    seen.add(pane(part));
    part.scrollIntoView({block: 'nearest', inline: 'nearest'});
  }
};
for (const part of parts) {
  part.addEventListener('mouseenter', () => choose(names(part), null));
  part.addEventListener('click', () => choose(names(part), part));
}
""".strip()


def lines_of_blocks(source: str) -> list[str]:
    """For each line of generated C the block that it belongs to; empty for those of none."""
    found, block = [], ""
    for line in source.split("\n"):
        named = _BLOCK.findall(line)
        inside = line.startswith("  ")
        if named and inside and line.lstrip().startswith("/*"):
            block = named[0]
        elif not inside and line.strip():
            block = ""
        found.append(named[0] if named and not block else block if line.strip() else "")
    return found


def ada_lines_of_blocks(source: str) -> list[str]:
    """For each line of generated Ada the block that it belongs to; empty for those of none."""
    found: list[str] = []
    block = ""
    for line in source.split("\n"):
        title, field = _ADA_BLOCK.match(line), _ADA_FIELD.match(line)
        if title:
            block = title[1]
        elif field:
            found[-1] = field[1]
        elif line.strip() and not line.startswith(" " * 6):
            block = ""
        found.append(field[1] if field else block if line.strip() else "")
    return found


def _listing(title: str, source: str, blocks: list[str], paths: Mapping[str, str]) -> str:
    rows = []
    for line, block in zip(source.split("\n"), blocks, strict=True):
        path = escape(paths.get(block, block))
        mark = f' data-blocks="{path}"' if block else ""
        rows.append(f"<span{mark}>{escape(line)}</span>")
    return f'<section tabindex="0"><h2>{title}</h2><pre>{"".join(rows)}</pre></section>'


def _ada_listing(diagram: Diagram, paths: Mapping[str, str]) -> str:
    """Body, then specification; the reason where there is no Ada."""
    try:
        files = generate_ada(diagram).files
    except DesignError as error:
        return f'<section tabindex="0"><h2>Ada</h2><p>{escape(str(error))}</p></section>'
    source = "\n".join(files[name] for name in sorted(files))
    return _listing("Ada", source, ada_lines_of_blocks(source), paths)


def diagram_page(diagram: Diagram, values: Mapping[str, str] | None = None) -> str:
    """HTML that needs nothing else; `values` are shown on blocks and lines, by path."""
    svg = diagram_svg(diagram, values)
    source = generate_c(diagram, only_used=True).files[f"{diagram.name}.c"]
    paths = diagram.flat().paths
    return "\n".join([
        "<!DOCTYPE html>", '<html lang="en"><head><meta charset="utf-8">',
        f"<title>{escape(diagram.name)}</title><style>{_STYLE}</style></head><body>",
        f"<main>{svg}</main>",
        f'<aside>{_listing("C", source, lines_of_blocks(source), paths)}',
        f"{_ada_listing(diagram, paths)}</aside>",
        f"<script>{_SCRIPT}</script>", "</body></html>", "",
    ])  # fmt: skip
