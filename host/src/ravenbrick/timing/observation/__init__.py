# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Observed times of tasks: in a run, in long runs, in the worst-case search."""
