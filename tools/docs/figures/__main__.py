# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`python -m tools.docs.figures [NN ...]`: figures of these sheets, of all without numbers."""

from __future__ import annotations

import sys

from tools.docs.figures import PICTURES, write_figures

write_figures(PICTURES, sys.argv[1:])
