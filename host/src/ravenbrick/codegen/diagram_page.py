# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A page with a diagram's picture beside its C: pointing at a block marks its lines, and back."""

from __future__ import annotations

import re
from collections.abc import Mapping
from html import escape

from ravenbrick.codegen.c.generator import generate_c
from ravenbrick.model import Diagram, diagram_svg

__all__ = ["diagram_page", "lines_of_blocks"]

_BLOCK = re.compile(r"'<Root>/(\w+)'")
_STYLE = """
body { margin: 0; font: 14px sans-serif; display: flex; height: 100vh; }
main { flex: 3; overflow: auto; } aside { flex: 2; overflow: auto; border-left: 1px solid #bbb; }
pre { margin: 0; padding: 8px 0; font-size: 12px; line-height: 1.35; }
pre span { display: block; padding: 0 12px; min-height: 1.35em; }
pre span[data-blocks] { cursor: pointer; } pre .chosen { background: #fff3c4; }
""".strip()
_SCRIPT = """
const parts = [...document.querySelectorAll('[data-blocks]')];
const names = part => part.dataset.blocks.split(' ');
const choose = (wanted, scroll) => {
  let first = null;
  for (const part of parts) {
    const found = names(part).some(name => wanted.includes(name));
    part.classList.toggle('chosen', found);
    if (found && scroll && part.tagName === scroll && !first) first = part;
  }
  if (first) first.scrollIntoView({block: 'nearest', inline: 'nearest'});
};
for (const part of parts) {
  const other = part.tagName === 'SPAN' ? 'g' : 'SPAN';
  part.addEventListener('mouseenter', () => choose(names(part), null));
  part.addEventListener('click', () => choose(names(part), other));
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


def diagram_page(diagram: Diagram, values: Mapping[str, str] | None = None) -> str:
    """HTML that needs nothing else; `values` are shown on blocks and lines, by path."""
    svg = diagram_svg(diagram, values)
    source = generate_c(diagram, only_used=True).files[f"{diagram.name}.c"]
    paths = diagram.flat().paths
    rows = []
    for line, block in zip(source.split("\n"), lines_of_blocks(source), strict=True):
        path = escape(paths.get(block, block))
        mark = f' data-blocks="{path}"' if block else ""
        rows.append(f"<span{mark}>{escape(line)}</span>")
    return "\n".join([
        "<!DOCTYPE html>", '<html lang="en"><head><meta charset="utf-8">',
        f"<title>{escape(diagram.name)}</title><style>{_STYLE}</style></head><body>",
        f"<main>{svg}</main>", f"<aside><pre>{''.join(rows)}</pre></aside>",
        f"<script>{_SCRIPT}</script>", "</body></html>", "",
    ])  # fmt: skip
