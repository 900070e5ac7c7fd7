# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The notebook of the paper's design runs from top to bottom and says what the project claims."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tools.docs.notebook import notebook_page, run_notebook

ROOT = Path(__file__).resolve().parents[2]
NOTEBOOK = ROOT / "docs" / "notebooks" / "paper-design.ipynb"


def test_the_notebook_runs_from_top_to_bottom() -> None:
    """Gains, settling time and bounds of the paper's loop; two pictures with named axes."""
    cells, names = run_notebook(NOTEBOOK)
    assert names["gains"].proportional == pytest.approx(0.361074, abs=1e-6)
    assert names["gains"].integral == pytest.approx(9.758762, abs=1e-6)
    assert names["sampled"].settling_time() == pytest.approx(0.4, abs=1e-5)
    assert 0 < names["proof"].closed_loop.rounding < 1.051e-3
    figures = [cell.value for cell in cells if hasattr(cell.value, "savefig")]
    assert len(figures) == 2
    first = next(cell for cell in cells if hasattr(cell.value, "savefig"))
    assert first.text.startswith("%matplotlib inline\n")  # else a notebook prints "<Figure size"
    for axis in (axis for figure in figures for axis in figure.axes):
        assert axis.get_ylabel().endswith(")")
    assert any("all come to rest" in cell.printed for cell in cells)


def test_nothing_computed_is_kept_in_the_file() -> None:
    """Outputs are made when it runs."""
    for cell in json.loads(NOTEBOOK.read_text())["cells"]:
        assert cell["cell_type"] == "markdown" or (
            cell["outputs"] == [] and cell["execution_count"] is None
        )


def test_an_error_names_the_cell(tmp_path: Path) -> None:
    """As it would stop there."""
    cell = {"cell_type": "code", "source": ["1 / 0"]}
    (tmp_path / "bad.ipynb").write_text(json.dumps({"cells": [cell]}))
    with pytest.raises(ZeroDivisionError) as caught:
        run_notebook(tmp_path / "bad.ipynb")
    assert "bad.ipynb, cell 0" in str(caught.traceback[-1].path)


def test_a_page_shows_code_output_and_pictures(tmp_path: Path) -> None:
    """In their order, with the line that makes a notebook show pictures."""
    source = ["%matplotlib inline\n", "from matplotlib.figure import Figure\n"]
    source += ["print('seen')\n", "Figure()"]
    head = {"cell_type": "markdown", "source": ["# Head"]}
    cells = [head, {"cell_type": "code", "source": source}]
    (tmp_path / "small.ipynb").write_text(json.dumps({"cells": cells}))
    page = notebook_page(tmp_path / "small.ipynb", tmp_path, "pictures")
    assert (
        page.index("# Head")
        < page.index("%matplotlib")
        < page.index("Figure()")
        < page.index("```text\nseen")
    )
    assert "](pictures/small-1.svg)" in page
    assert (tmp_path / "small-1.svg").is_file()
