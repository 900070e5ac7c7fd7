# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Schedulability of task sets on one processor: analysis, assignment, simulation."""
