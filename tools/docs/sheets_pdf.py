# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The lab sheets as one PDF, without the solutions: `python -m tools.docs.sheets_pdf FILE`."""

from __future__ import annotations

import re
import sys
from pathlib import Path

from weasyprint import HTML

from tools.docs.formulas import FORMULA_STYLE, markdown
from tools.docs.lessons import SHEETS, captioned, find
from tools.docs.site.bricks import printed

STYLE = (
    FORMULA_STYLE
    + """
.formula math { display: none } img { max-width: 100% } em > img { display: block }
@page { size: A4; margin: 22mm 20mm; @bottom-center { content: counter(page); font-size: 9pt } }
body { font: 10.5pt/1.45 "DejaVu Serif", serif }
h1 { break-before: page; font: bold 17pt sans-serif }
h2 { font: bold 12pt sans-serif; break-after: avoid }
table { break-inside: avoid; break-before: avoid }
pre { font: 8pt/1.35 "DejaVu Sans Mono", monospace; background: #f3f3f1; padding: 6pt;
      white-space: pre-wrap; overflow-wrap: anywhere }
code { font-family: "DejaVu Sans Mono", monospace; font-size: 88% }
table { border-collapse: collapse } td, th { border: 0.4pt solid #999; padding: 2pt 5pt }
"""
)


def sheets_html() -> str:
    """All sheets in order; links between pages become text."""
    caption = "\n`{file}`\n\n```{language}"
    texts = [captioned(printed(sheet.read_text("utf-8")), caption) for sheet in find([])]
    body = "\n".join(markdown().render(text) for text in texts)
    body = re.sub(r'<a href="(?!https?:)[^"]*">(.*?)</a>', r"\1", body)
    return f'<html lang="en"><head><title>Lab sheets</title><style>{STYLE}</style></head>{body}'


def main(file: str) -> int:
    """Write the PDF."""
    path = Path(file)
    path.parent.mkdir(parents=True, exist_ok=True)
    HTML(string=sheets_html(), base_url=f"{SHEETS}/").write_pdf(path)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
