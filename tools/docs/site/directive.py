# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The Sphinx directive `brick`: a running brick in a page of the site.

    ```{brick} lab06 share
    Three tasks share a resource.
    ```

The first word is a folder of examples/, or the project that the steps above it create; the second
one is its scenario, or `picture` for a program in devices/. The content is the caption. `:run:`
runs it at once, `:folded:` shows it on request only.
"""

from __future__ import annotations

import html
import re
from pathlib import PurePosixPath
from typing import Any

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.util.docutils import SphinxDirective

from tools.docs.site.bricks import PAGE_FOLDER, Shown, shown_on

__all__ = ["setup"]

COUNT = "bricks"
CODE = re.compile("`([^`]+)`")
FRAME = """<figure class="brick">
<iframe src="{embedded}" title="{title}" loading="{loading}" allow="clipboard-write"></iframe>
<figcaption>{caption}<a href="{page}">Open the full page</a></figcaption>
</figure>"""
FOLDED = '<details class="brick"><summary>Run it here: {title}</summary>{frame}</details>'


def _frame(shown: Shown, page: str, caption: str, options: str = "") -> str:
    title = html.escape(f"Virtual brick: {shown.title}")
    address = f"{page}?brick={shown.name}"
    if shown.project != shown.example:
        address += f"&as={shown.project}"
    return FRAME.format(
        embedded=html.escape(f"{address}&embed{options}"),
        page=html.escape(address),
        title=title,
        loading="eager" if "run" in options else "lazy",
        caption=CODE.sub(r"<code>\1</code>", f"{html.escape(caption)} ") if caption else "",
    )


class BrickDirective(SphinxDirective):
    """A frame with the page of `ravenbrick view`, small, for one project and scenario."""

    required_arguments = 2
    option_spec = {"folded": directives.flag, "run": directives.flag}  # noqa: RUF012
    has_content = True

    def run(self) -> list[nodes.Node]:
        """The frame; an unknown project or scenario is an error at this line."""
        try:
            # Other hooks insert lines, so the place in the file is known by its number only.
            number = int(self.env.current_document.get(COUNT) or 0)
            shown = shown_on(self.env.doc2path(self.env.docname))[number]
        except ValueError as error:
            raise self.error(str(error)) from None
        self.env.current_document[COUNT] = number + 1
        up = "../" * len(PurePosixPath(self.env.docname).parent.parts)
        run = "&run" if "run" in self.options else ""
        frame = _frame(shown, f"{up}{PAGE_FOLDER}/index.html", " ".join(self.content), run)
        if "folded" in self.options:
            frame = FOLDED.format(title=html.escape(shown.title), frame=frame)
        return [nodes.raw("", frame, format="html")]


def setup(app: Any) -> dict[str, bool]:
    """Called by Sphinx."""
    app.add_directive("brick", BrickDirective)
    return {"parallel_read_safe": True}
