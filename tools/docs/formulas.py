# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Formulas of the documentation, typeset when it is built: SVG to see, MathML to hear.

Neither the site nor the PDF needs a network, a font of the reader or LaTeX.
"""

from __future__ import annotations

import re
from functools import cache
from typing import Any

import ziamath
from latex2mathml.converter import convert
from markdown_it import MarkdownIt
from mdit_py_plugins.dollarmath import dollarmath_plugin

__all__ = ["FORMULA_STYLE", "formula", "markdown", "setup"]

POINTS_PER_EM = 24  # the size at which ziamath draws
FORMULA_STYLE = """
.formula { white-space: nowrap; position: relative }
.formula svg { overflow: visible; fill: currentColor }
div.formula { text-align: center; margin: 1em 0; overflow-x: auto; overflow-y: hidden }
.formula math { position: absolute; width: 1px; height: 1px; overflow: hidden;
                clip-path: inset(50%) }
"""


class FormulaError(ValueError):
    """LaTeX that cannot be typeset; the text quotes it."""


@cache
def formula(latex: str, display: bool) -> str:
    """The formula as an element of HTML in the colour and size of the text around it."""
    ziamath.config.svg2 = False
    ziamath.config.math.color = "currentColor"
    try:
        typeset = ziamath.Latex(latex, size=POINTS_PER_EM, inline=not display)
        spoken = convert(latex, display="block" if display else "inline")
        svg = typeset.svg()
    except Exception as error:
        raise FormulaError(f"'{latex.strip()}' cannot be typeset: {error}") from error
    width, height = (float(v) for v in re.findall(r'(?:width|height)="([\d.]+)"', svg)[:2])
    below = height - float(re.findall(r'viewBox="\S+ -?([\d.]+)', svg)[0])
    style = f"width:{width / POINTS_PER_EM:.3f}em;height:{height / POINTS_PER_EM:.3f}em"
    if not display:
        style += f";vertical-align:{-below / POINTS_PER_EM:.3f}em"
    svg = re.sub(
        r'<svg [^>]*?(viewBox="[^"]*")[^>]*>',
        rf'<svg xmlns="http://www.w3.org/2000/svg" \1 style="{style}" aria-hidden="true">',
        svg,
        count=1,
    )
    tag = "div" if display else "span"
    return f'<{tag} class="formula">{svg}{spoken}</{tag}>'


def markdown() -> MarkdownIt:
    """A renderer of Markdown with tables and formulas, as Sphinx reads them."""
    reader = MarkdownIt("commonmark").enable("table")
    return reader.use(
        dollarmath_plugin,
        allow_space=False,
        renderer=lambda text, options: formula(text, options["display_mode"]),
    )


def _visit(translator: Any, node: Any) -> None:
    from docutils import nodes

    display = node.tagname == "math_block"
    translator.body.append(formula(node.astext(), display))
    raise nodes.SkipNode


def _add_style(_app: Any, _page: str, _template: str, context: dict[str, Any], _tree: Any) -> None:
    if 'class="formula"' in context.get("body", ""):
        context["metatags"] += f"<style>{FORMULA_STYLE}</style>"


def setup(app: Any) -> None:
    """Called by Sphinx: formulas of pages are typeset by this module."""
    app.add_html_math_renderer("drawn", (_visit, None), (_visit, None))
    app.connect("html-page-context", _add_style)
