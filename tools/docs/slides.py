# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Slides of the lecturer's pages: `python -m tools.docs.slides FOLDER`.

The part "Slides" of a page becomes one HTML file that needs nothing beside it: a heading of the
third level begins a slide. Printed, each slide is a page.
"""

from __future__ import annotations

import re
import sys
from base64 import b64encode
from html import escape
from pathlib import Path

from tools.docs.formulas import FORMULA_STYLE, markdown
from tools.docs.lessons import find, part, teaching_page

STYLE = (
    FORMULA_STYLE
    + """
@page { size: 254mm 143mm; margin: 0 }
* { box-sizing: border-box }
html { font: 3.2vmin/1.4 system-ui, "Segoe UI", Roboto, "Liberation Sans", sans-serif;
       scroll-snap-type: y proximity; background: #fff; color: #222 }
body { margin: 0 }
section { min-height: 100vh; padding: 5vmin 7vmin; scroll-snap-align: start;
          border-bottom: 1px solid #ccc; position: relative }
section > footer { position: absolute; right: 4vmin; bottom: 2vmin; font-size: 60%; color: #5c6066 }
h1 { font-size: 7vmin; margin-top: 25vh } h2 { font-size: 5vmin; margin: 0 0 3vmin }
li { margin: .4em 0 }
section:not(:has(img, pre, table)) { font-size: 150% }
section:not(:has(img, pre, table)) > footer { font-size: 40% }
img { width: 100%; height: auto; max-height: 55vh; object-fit: contain; display: block;
      margin: 2vmin auto }
pre { font-size: 70%; background: #f3f3f1; padding: 2vmin; white-space: pre-wrap }
table { border-collapse: collapse } td, th { border: 1px solid #999; padding: .3em .8em }
@media print { html { font-size: 5mm } section { height: 143mm; min-height: 0; border: 0;
       break-after: page; overflow: hidden } h1 { font-size: 11mm; margin-top: 40mm }
       h2 { font-size: 8mm } img { max-height: 80mm } }
"""
)
KEYS = """
addEventListener("keydown", (event) => {
  const step = { ArrowRight: 1, PageDown: 1, " ": 1, ArrowLeft: -1, PageUp: -1 }[event.key];
  if (!step) return;
  event.preventDefault();
  const slides = [...document.querySelectorAll("section")];
  const now = slides.findIndex((slide) => slide.getBoundingClientRect().bottom > innerHeight / 2);
  slides[Math.min(Math.max(now + step, 0), slides.length - 1)].scrollIntoView();
});
"""


def _embedded(html: str, folder: Path) -> str:
    """Pictures become part of the page."""

    def data(match: re.Match[str]) -> str:
        content = b64encode((folder / match[1]).read_bytes()).decode("ascii")
        kind = "svg+xml" if match[1].endswith(".svg") else "png"
        return f'src="data:image/{kind};base64,{content}"'

    return re.sub(r'src="(?!data:)([^"]+)"', data, html)


def deck(page: Path) -> str:
    """The slides of a lecturer's page as HTML; empty when it has none."""
    text = page.read_text("utf-8")
    slides = re.split(r"^### ", part(text, "Slides"), flags=re.MULTILINE)[1:]
    if not slides:
        return ""
    title = text.partition("\n")[0].lstrip("# ").removesuffix(": for the lecturer")
    shown = [f"<h1>{escape(title)}</h1>"]
    shown += [_embedded(markdown().render(f"## {slide}"), page.parent) for slide in slides]
    sections = "\n".join(
        f"<section>{slide}<footer>{number} / {len(shown)}</footer></section>"
        for number, slide in enumerate(shown, 1)
    )
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width">'
        f"<title>{escape(title)}: slides</title><style>{STYLE}</style></head>"
        f"<body><main>{sections}</main><script>{KEYS}</script></body></html>\n"
    )


def main(folder: str) -> int:
    """Write a file for each sheet that has slides."""
    place, count = Path(folder), 0
    place.mkdir(parents=True, exist_ok=True)
    for sheet in find([]):
        if html := deck(teaching_page(sheet)):
            (place / f"{sheet.stem}.html").write_text(html, encoding="utf-8")
            count += 1
    print(f"{count} decks in {folder}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
