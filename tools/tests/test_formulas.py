# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Formulas and slides of the documentation, where `make docs` installed what they need."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("ziamath", reason="'make docs' installs it")

from tools.docs.formulas import FormulaError, formula, markdown
from tools.docs.slides import deck


def test_a_formula_is_drawn_for_the_eye_and_written_for_screen_readers() -> None:
    """Both in one element, in the colour of the text, with nothing to load."""
    html = formula(r"\dot{x} = \begin{bmatrix} 0 & 1 \\ 2 & 3 \end{bmatrix} x", True)
    assert html.startswith('<div class="formula"><svg')
    assert 'aria-hidden="true"' in html and "<math" in html and "<mtable" in html
    assert "currentColor" in html and "href" not in html


def test_a_formula_that_cannot_be_typeset_is_quoted() -> None:
    """So that its author finds it."""
    with pytest.raises(FormulaError, match=r"'\\left\(' cannot be typeset"):
        formula(r"\left(", False)


def test_prices_are_no_formulas() -> None:
    """A dollar before a blank or after a backslash is a dollar."""
    assert "svg" not in markdown().render("5 $ or \\$5 and \\$6")
    assert "svg" in markdown().render("a gain $K$ of 2")


def test_a_deck_has_a_slide_for_each_heading_and_loads_nothing(tmp_path: Path) -> None:
    """The picture is inside."""
    (tmp_path / "p.svg").write_text("<svg/>")
    page = tmp_path / "90-x.md"
    page.write_text(
        "# 90. X: for the lecturer\n\n## Slides\n\n### One\n\n- $a$\n\n### Two\n\n![p](p.svg)\n"
    )
    html = deck(page)
    assert html.count("<section>") == 3 and "<h2>Two</h2>" in html
    assert 'src="data:image/svg+xml;base64,' in html and "p.svg" not in html
