# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The report of runs, and what all HTML reports share: templates, style sheet, charts as SVG."""
