# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The documentation site: `make docs`. Pages below reference/generated/ are written here.

With the tag `teaching` it is the lecturer's, which `make teaching` builds.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

from sphinx.util import logging

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

from tools.docs.figures import write_figures  # noqa: E402
from tools.docs.lessons import captioned  # noqa: E402
from tools.docs.notebook import notebook_page  # noqa: E402
from tools.docs.reference_pages import write_pages  # noqa: E402

write_pages(HERE / "reference" / "generated", HERE / "pictures" / "generated")
write_figures()
(HERE / "guides" / "paper-design.md").write_text(
    notebook_page(
        HERE / "notebooks" / "paper-design.ipynb",
        HERE / "pictures" / "generated",
        "../pictures/generated",
    ),
    encoding="utf-8",
)

project = "Ravenbrick"
copyright = "2026 Ravenbrick contributors"
extensions = ["myst_parser", "tools.docs.formulas", "tools.docs.site.directive"]
source_suffix = {".md": "markdown"}
FOR_LECTURERS = tags.has("teaching")  # noqa: F821 (Sphinx defines it)
exclude_patterns = ["_build"] if FOR_LECTURERS else ["_build", "teaching"]
html_theme = "furo"
# The pages' sources are not a part of the site.
html_theme_options = {"top_of_page_buttons": []}
html_title = "Ravenbrick for lecturers" if FOR_LECTURERS else "Ravenbrick"
html_math_renderer = "drawn"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_js_files = ["site.js"]
myst_enable_extensions = ["colon_fence", "dollarmath"]
myst_heading_anchors = 3
highlight_language = "none"
nitpicky = True

OUTWARDS = re.compile(r"\[([^\]]+)\]\((\.\./[^)#]+)[^)]*\)")


def name_files_of_the_tree(app: Any, docname: str, source: list[str]) -> None:
    """Links to files beside docs/, which the site does not have, become their paths."""
    page = Path(app.srcdir, docname).parent

    def named(match: re.Match[str]) -> str:
        target = (page / match.group(2)).resolve()
        if target.is_relative_to(HERE):
            return match.group(0)
        if not target.exists():
            logging.getLogger(__name__).warning("no file %s", match.group(2), location=docname)
        return f"{match.group(1)} (`{target.relative_to(HERE.parent)}`)"

    source[0] = OUTWARDS.sub(named, source[0])


def show_lessons(app: Any, docname: str, source: list[str]) -> None:
    """File names above the fences of sheets; for lecturers also their pages and slides."""
    folder, _, name = docname.rpartition("/")
    if folder in ("lessons", "teaching"):
        source[0] = captioned(source[0], "```{code-block} {language}\n:caption: {file}")
    if folder == "teaching":
        link = f'## Slides\n\n<p><a href="../slides/{name}.html">Slides to show and print</a></p>\n'
        source[0] = source[0].replace("## Slides\n", link)
    if docname == "index" and FOR_LECTURERS:
        # Before the students' pages, with the syllabus first.
        own = "```{toctree}\n:maxdepth: 1\n:caption: For the lecturer\n:glob:\nteaching/index\n"
        own += "teaching/syllabus\nteaching/[0-9]*\n```\n\n"
        first = source[0].index("```{toctree}")
        source[0] = source[0][:first] + own + source[0][first:]


def setup(app: Any) -> None:
    """Called by Sphinx."""
    app.connect("source-read", name_files_of_the_tree)
    app.connect("source-read", show_lessons)
