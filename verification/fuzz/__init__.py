# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Fuzzing: what no honest user gives the virtual brick (docs/reference/fuzzing.md)."""
