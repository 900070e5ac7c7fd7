# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The documentation site: `make docs`. Pages below reference/generated/ are written here."""

from __future__ import annotations

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

from tools.reference_pages import write_pages  # noqa: E402

write_pages(HERE / "reference" / "generated", HERE / "pictures" / "generated")

project = "Ravenbrick"
copyright = "2026 Ravenbrick contributors"
extensions = ["myst_parser"]
source_suffix = {".md": "markdown"}
exclude_patterns = ["_build"]
html_theme = "furo"
html_title = "Ravenbrick"
myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 3
highlight_language = "none"
nitpicky = True
