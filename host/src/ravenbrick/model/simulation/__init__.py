# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Diagrams over time: sampled ones bit for bit, continuous ones by SciPy's solvers, both closed."""
